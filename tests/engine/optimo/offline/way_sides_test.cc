#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/gouge.h"
#include "engine/optimo/offline/project.h"
#include "engine/optimo/offline/semantic_diff.h"
#include "engine/optimo/offline/transform.h"
#include "engine/optimo/offline/translate.h"
#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/offline/flat_leg.h"

// Ways that are just far enough, and texts that end where they end.
namespace rmlcell::optimo {
namespace {

bool IsGouged(const std::vector<Leg>& legs, const std::vector<OffsetLeg>& moved, std::size_t leg) {
  const GougeSearch search = FindGouges(legs, moved, 1.0);
  return std::ranges::any_of(search.found, [&](const Gouge& gouge) {
    return gouge.leg == leg && gouge.kind == Gouge::Kind::kTooNear;
  });
}

// gouge.h: of a path that begins on an edge what lies within two radii of the start is left out,
// and no more of it: a short piece that leads out of there counts behind it, and one that only
// passes by counts as a whole.
TEST(WaySides, PiecesAtTheBallOfAPierceOnAnEdge) {
  const auto found = [](ProgramVector from, ProgramVector to) {
    const std::vector<Leg> legs = {FlatLeg({0, 0, 0}, {30, 0, 0}), FlatLeg({30, 0, 0}, {30, 40, 0}),
                                   FlatLeg({30, 40, 0}, {10, 40, 0}),
                                   FlatLeg({10, 40, 0}, {10, 20, 0}),
                                   FlatLeg({10, 20, 0}, {15, 20, 0})};
    return IsGouged(
        legs, {{{29, 5, 0}, {}}, {{29, 39, 0}, {}}, {{11, 39, 0}, {}}, {from, {}}, {to, {}}}, 4);
  };
  EXPECT_TRUE(found({1.8, 0.5, 0}, {2.2, 0.5, 0}));   // 2 mm from the start at x = 1.936
  EXPECT_FALSE(found({1.5, 0.5, 0}, {1.9, 0.5, 0}));  // inside
  EXPECT_TRUE(found({2.2, 0.5, 0}, {1.8, 0.5, 0}));   // into it
  EXPECT_TRUE(found({2.6, 1.3, 0}, {1.8, 0.3, 0}));   // near to the edge at its border alone
  EXPECT_TRUE(found({2.1, 0.4, 0}, {2.1, 0.2, 0}));   // beside it
  EXPECT_FALSE(found({2.2, 1.5, 0}, {1.8, 1.5, 0}));  // further from the edge than the radius
}

// gouge.h: while the head keeps its direction, at the via point of an arc too, the path is looked
// at along it, at any height; where it does not, distances are those in space.
TEST(WaySides, AHeadThatTurnsAtAViaPointDoesNotKeepItsDirection) {
  for (const bool turns : {false, true}) {
    std::vector<Leg> legs = {FlatLeg({0, 0, 0}, {10, 0, 0}), FlatLeg({10, 0, 0}, {10, 1.5, 10}),
                             FlatLeg({10, 1.5, 10}, {0, 1.5, 10})};
    legs[1].via = ProgramVector(14, 0.75, 5);
    if (turns) legs[1].tool_via = {std::sin(0.3), 0.0, std::cos(0.3)};
    Prepare(legs[1]);
    ASSERT_TRUE(legs[1].is_arc);
    const std::vector<OffsetLeg> moved = {
        {{9, 1, 0}, {}}, {{9, 0.5, 10}, ProgramVector(13, 0.75, 5)}, {{5, 0.5, 10}, {}}};
    EXPECT_EQ(IsGouged(legs, moved, 2), !turns) << turns;
  }
}

// OPT-8.20: behind a hole whose middle or whose axis is no number nobody knows where the tip is.
TEST(WaySides, WhereAHoleOfVariablesEnds) {
  const auto unknown = [](const std::string& hole) {
    const Compensation made = Compensate(
        ";$rad=1\n;$left\nCOORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nPATH HOLE (5.)\n" + hole +
        "PATH LIN\nWORK 0,0/ON\nMOVE (30,0,0,0,0)\nMOVE (30,30,0,0,0)\nWORK 0,0/OFF\n");
    return std::ranges::count(made.diagnostics, ErrorCode::kCompVariable, &Diagnostic::code);
  };
  EXPECT_EQ(unknown("MOVE (10,0,0,0,0)/VIA (10,0,1,0,0)\n"), 0);
  EXPECT_EQ(unknown("MOVE (VR[1],0,0,0,0)/VIA (10,0,1,0,0)\n"), 1);
  EXPECT_EQ(unknown("MOVE (10,0,0,0,0)/VIA (VR[1],0,1,0,0)\n"), 1);
}

// OPT-E.7318: a neighbour that costs less than 1 % of the speed is not worth a word: at SPEED 10 a
// corner of 90 degrees takes 4.05 mm of either side. With 3 mm it is tighter and hardly slower,
// with half a millimetre much.
TEST(WaySides, ABlendThatIsCappedALittle) {
  const auto told = [](const std::string& length) {
    const machine::Translation made = TranslateOptimo(
        {"a.S",
         "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nMOVE (100,0,0,0,0)/FLY\nMOVE (100," +
             length + ",0,0,0)/FLY\nMOVE (200," + length + ",0,0,0)\n"},
        {});
    return std::ranges::count(made.diagnostics, ErrorCode::kFlyCapped, &Diagnostic::code);
  };
  EXPECT_EQ(told("6."), 0);
  EXPECT_EQ(told("1."), 2);
}

// OPT-8.76: a turn about Z turns A by as much and leaves B, whatever the sign of B and wherever A
// is; the second move as the first.
TEST(WaySides, ATurnAboutZTurnsA) {
  for (const std::string b : {"0.5", "-0.5"}) {
    for (const std::string a : {"2.", "-2.", "2.9", "0.2"}) {
      const std::string head = a + "," + b + ")\n";
      const std::string text = Transform("MOVE (1,2,3," + head + "MOVE (4,2,3," + head,
                                         motion::RigidMotionOf({}, 0.3, 0, 0))
                                   .text;
      std::size_t at = 0;
      for (int move = 0; move < 2; ++move) {
        at = text.find("MOVE (", at) + 6;
        for (int comma = 0; comma < 3; ++comma) at = text.find(',', at) + 1;
        EXPECT_NEAR(std::stod(text.substr(at)), std::stod(a) + 0.3, 2e-6) << text;
        at = text.find(',', at) + 1;
        EXPECT_NEAR(std::stod(text.substr(at)), std::stod(b), 2e-6) << text;
      }
    }
  }
}

// OPT-7.39: a WORK is no SYSDEF: ABSOL moves behind it are moves without one.
TEST(WaySides, AWorkIsNoSysdef) {
  machine::ProjectBundle bundle;
  bundle.programs.push_back(
      {21, {"21.S", "SYSDEF (1,2,3,0,0,0)\nCOORD ABSOL\nMOVE (1,2,3,0,0)\n"}, false});
  bundle.programs.push_back(
      {22, {"22.S", "COORD ABSOL\nWORK 0,0/ON\nMOVE (1,2,3,0,0)\nWORK 0,0/OFF\n"}, false});
  int told = 0;
  for (const Diagnostic& d : PlanTransfer(bundle, {}).diagnostics)
    told += d.code == ErrorCode::kPracticeAdvice && d.rule == "OPT-7.39" && d.program == 22;
  EXPECT_EQ(told, 1);
}

// semantic_diff.h: which condition has changed, and from what to what.
TEST(WaySides, ConditionsOfAMoveThatChanged) {
  const auto changed = [](const std::string& before, const std::string& after) {
    const ProgramDiff diff = Diff(MustCompile("5 MOVE (1,2,3,0,0)" + before + "\n").module,
                                  MustCompile("5 MOVE (1,2,3,0,0)" + after + "\n").module);
    return diff.steps.size() == 1 && diff.steps[0].what.size() == 1 ? diff.steps[0].what[0] : "";
  };
  EXPECT_EQ(changed("/START (IL[20])", "/START (IL[21])"), "/START IL[20] -> IL[21]");
  EXPECT_EQ(changed("/END (IL[20])", "/END (IL[21])"), "/END IL[20] -> IL[21]");
  EXPECT_EQ(changed("/TIME (1.,5)", "/TIME (2.,5)"), "/TIME 1.0 -> 2.0");
  EXPECT_EQ(changed("/END (IL[20])/TIME (1.,5)", "/END (IL[20])/TIME (2.,5)"), "/TIME 1.0 -> 2.0");
}

// OPT-2.04, OPT-2.51: half an inch is no short move; what is told is that the file is one in
// inches.
TEST(WaySides, AdviceOnAnInchSourceThatIsBeingWritten) {
  const std::string text =
      "COORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nMOVE (0.5,0,0,0,0)/FLY\nMOVE (5,0,0,0,0)\n";
  const auto count = [&](const std::string& name, ErrorCode code) {
    machine::CheckOptions options;
    options.advice = options.unconverted = true;
    const machine::Translation made = TranslateOptimo({name, text}, options);
    return std::ranges::count(made.diagnostics, code, &Diagnostic::code);
  };
  EXPECT_EQ(count("a.SI", ErrorCode::kShortFly), 0);
  EXPECT_EQ(count("a.SI", ErrorCode::kSourceIsInch), 1);
  EXPECT_EQ(count("a.S", ErrorCode::kShortFly), 1);
  EXPECT_EQ(count("a.S", ErrorCode::kSourceIsInch), 0);
}

// A bad object is told with the name of its file.
TEST(WaySides, ABadObjectHasAName) {
  const machine::Translation made =
      TranslateOptimo({"bad.O", std::string_view("LMR\x01 what is this", 17)}, {});
  ASSERT_EQ(made.diagnostics.size(), 1U);
  EXPECT_EQ(made.diagnostics[0].file, "bad.O");
  EXPECT_NE(made.diagnostics[0].detail, "bad.O");
  EXPECT_FALSE(std::string(made.diagnostics[0].detail).empty());
}

std::string TextAndFindings(const std::string& text, const std::vector<Diagnostic>& found) {
  std::string all = text;
  for (const Diagnostic& d : found)
    all += "\n" + std::to_string(d.where.byte_offset) + "+" + std::to_string(d.where.length) + " " +
           d.detail;
  return all;
}

// A text ends where it ends, whatever lies behind it in memory: of directives, of numbers, of
// lines.
TEST(WaySides, NothingBehindTheTextIsRead) {
  const std::string program =
      ";$dia=2.5\n;$cleft\nCOORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
      "MOVE (10.5,0,0,0,0)\nMOVE (10,10,0,0,0)\nWORK 0,0/OFF\n;$none\nVR[86]= - 12.25\n;$rad= 1";
  const auto all = [](std::string_view text) {
    const Compensation compensated = Compensate(text);
    const Conversion converted = Convert(text, Direction::kToMetric);
    const Rewriting shifted = Shift(text, {1, 2, 3, 0, 0, 0});
    return TextAndFindings(compensated.text, compensated.diagnostics) +
           TextAndFindings(converted.text, converted.diagnostics) +
           TextAndFindings(shifted.text, shifted.diagnostics);
  };
  for (std::size_t size = 1; size <= program.size(); ++size) {
    const std::string alone = program.substr(0, size);
    const std::string said = all(alone);
    for (const char behind : std::string_view("07at.=; \n")) {
      const std::string longer = alone + behind + "1=9";
      ASSERT_EQ(all(std::string_view(longer).substr(0, size)), said)
          << size << " '" << behind << "'";
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
