#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/transform.h"
#include "tests/engine/optimo/language/marked_text.h"

// What the off-line tools say, and of what: braces stand around it. `says` begins the text.
namespace rmlcell::optimo {
namespace {

struct ToolRow {
  std::string text;
  int number;
  std::string_view rule;
  std::string_view says;
  bool ok = false;  // whether the tool gives a result all the same
};

struct Answer {
  bool ok = false;
  std::vector<Diagnostic> diagnostics;
};
using Tool = std::function<Answer(const std::string&)>;

void ExpectSaid(const Tool& tool, const ToolRow& row) {
  const Marked marked = WithoutBraces(row.text);
  const Answer answer = tool(marked.text);
  EXPECT_EQ(answer.ok, row.ok) << row.text;
  ASSERT_EQ(answer.diagnostics.size(), 1U) << row.text;
  const Diagnostic& found = answer.diagnostics[0];
  EXPECT_EQ(Lookup(found.code).number, row.number) << row.text;
  EXPECT_EQ(found.rule, row.rule) << row.text;
  EXPECT_TRUE(found.detail.starts_with(row.says)) << row.text << found.detail;
  EXPECT_EQ(found.where, marked.span)
      << row.text << found.where.line << ":" << found.where.column << "+" << found.where.length;
}

Answer Compensated(const std::string& text) {
  Compensation made = Compensate(text);
  EXPECT_EQ(made.text.empty(), !made.ok);
  return {made.ok, std::move(made.diagnostics)};
}

// OPT-8.05, OPT-8.09, OPT-8.10, OPT-8.22, OPT-8.23
TEST(ToolPlaces, OfCompensationAndItsDirectives) {
  const std::string set = ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\n",
                    on = set + "WORK 0,0/ON\n";
  const std::vector<ToolRow> rows = {
      {"SPEED 5\n{;$middle}\n", 7802, "OPT-8.05", "unknown directive"},
      {"SPEED 5\n{;$dia=x}\n", 7802, "OPT-8.05", "the amount is no number of at least 0"},
      {"{;$rad=-0.001}\n", 7802, "OPT-8.05", "the amount is no number of at least 0"},
      {on + "{;$rad=1.5}\nWORK 0,0/OFF\n", 7803, "OPT-8.09", "the amount changes"},
      {on + "{;$dia=1}\n", 7803, "OPT-8.09", "the amount changes"},
      {on + "{;$right}\n", 7803, "OPT-8.09", "the side changes"},
      {on + "{;$none}\n", 7803, "OPT-8.09", "the side changes"},
      {";$left\nPATH LIN\n{WORK 0,0/ON}\n", 7804, "OPT-8.10", "a side is set, but no amount", true},
      {on + "{CALL 2}\n", 7809, "OPT-8.22", "the path is followed from top to bottom", true},
      {on + "{IF VL[0] THEN 9}\n9\n", 7809, "OPT-8.22", "the path is followed", true},
      {on + "{GOSUB 9}\n9\n", 7809, "OPT-8.22", "the path is followed", true},
      {on + "{GOTO VI[2] (9)}\n9\n", 7809, "OPT-8.22", "the path is followed", true},
      {on + "{FUNCTION 3}\n", 7809, "OPT-8.22", "the path is followed", true},
      {on + "{RETURN}\n", 7809, "OPT-8.22", "the path is followed", true},
      {on + "{GO 3}\n", 7809, "OPT-8.22", "the path is followed", true},
      {"5 {SYSDEF (0,0,0,VR[1],0,0)}\n", 7811, "OPT-8.23", "a rotation of SYSDEF is no number",
       true},
      {"{SYSDEF (0,0,0,0,0,VR[1])}\n", 7811, "OPT-8.23", "a rotation of SYSDEF is no number", true},
  };
  for (const ToolRow& row : rows) ExpectSaid(Compensated, row);
  // The same amount or side again changes nothing, and neither do other instructions.
  for (const std::string& text :
       {on + ";$rad=1\n;$dia=2\n;$left\n", set + "WORK 0,0/ON\nWORK 0,0/OFF\n;$right\n;$rad=9\n",
        on + "SPEED 5\nVR[1]=2.\nOL[8]=ON\nDELAY 1\nWAIT IL[20]\n", set + "GOTO 9\n9\n",
        std::string("SYSDEF (VR[1],0,0,0,0,0)\nSYSDEF\n")}) {
    const Answer answer = Compensated(text);
    EXPECT_TRUE(answer.ok && answer.diagnostics.empty()) << text;
  }
}

// OPT-8.14, OPT-8.19, OPT-8.20, OPT-8.21, OPT-B.91
TEST(ToolPlaces, OfCompensatedMoves) {
  const std::string set = ";$rad=1\n;$left\n", right = ";$rad=1\n;$right\n",
                    on = set + "PATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n",
                    hole = "\nWORK 0,0/ON\nMOVE (0,0,0,0,0)/VIA (0,0,9,0,0)\n";
  const std::vector<ToolRow> rows = {
      {on + "{MOVE (VR[1],0,0,0,0)}\n", 7805, "OPT-8.20", "a coordinate is no plain number"},
      {on + "{MOVE (1,0,0,0,VR[1])}\n", 7805, "OPT-8.20", "a coordinate is no plain number"},
      {on + "PATH CIR\n{MOVE (9,0,0,0,0)/VIA (4,4,0,0,VR[1])}\n", 7805, "OPT-8.20",
       "a coordinate is no plain number"},
      {set + "PATH LIN\nWORK 0,0/ON\n{MOVE (9,0,0,0,0)}\nMOVE (9,9,0,0,0)\n", 7805, "OPT-8.20",
       "the point where this move starts is not known"},
      {set + "PATH LIN\nMOVE (0,0,0,0,0)\nTCP (0,0,0/0,0,-5)\nWORK 0,0/ON\n{MOVE (9,0,0,0,0)}\n",
       7805, "OPT-8.20", "the point where this move starts is not known"},
      {on + "COORD ROBOT\n{MOVE (1,0,0,0,0)}\n", 7810, "OPT-8.21", "a MOVE in COORD ROBOT"},
      {on + "{MOVE (10,0,0,0,0)}\nMOVE (0,0,0,0,0)\n", 7808, "OPT-8.19", "the path turns back"},
      {on + "PATH CIR\n{MOVE (1,1,0,0,0)/VIA (0.7071067811865,0.2928932188135,0,0,0)}\n", 7806,
       "OPT-8.19", "the arc of radius 1.0"},
      {on + "PATH CIR\n{MOVE (0,0,0,0,0)/VIA (9,0,0,0,0)}\n", 7305, "OPT-E.7305", ""},
      {set + "{PATH HOLE (VR[1])}" + hole, 7805, "OPT-8.20", "the radius is no plain number"},
      {right + "{PATH HOLE (1.)}" + hole, 7807, "OPT-8.14", "the hole is not larger than the beam"},
      {right + "PATH HOLE (1.001)\nWORK 0,0/ON\n{MOVE (0,0,0,0,0)/VIA (0,0,9,0,0)}\n", 7033,
       "OPT-B.91", "at holes left means larger", true},
  };
  for (const ToolRow& row : rows) ExpectSaid(Compensated, row);
}

// OPT-8.16; 7812 is ours: how near, how wide, how deep.
TEST(ToolPlaces, OfGouges) {
  const Compensation made = Compensate(
      ";$dia=3\n;$left\nPATH LIN\nMOVE (10,17.75,0,0,0)\nWORK 0,0/ON\n"
      "MOVE (10,0,0,0,0)\nMOVE (20,0,0,0,0)\nMOVE (20,19,0,0,0)\nMOVE (0,19,0,0,0)\n"
      "MOVE (0,0,0,0,0)\nMOVE (10,0,0,0,0)\nWORK 0,0/OFF\n");
  ASSERT_EQ(made.diagnostics.size(), 1U);
  EXPECT_EQ(made.diagnostics[0].rule, "OPT-8.19");
  EXPECT_EQ(made.diagnostics[0].where.line, 6);
  EXPECT_EQ(made.diagnostics[0].detail,
            "the compensated path comes within 1.250 mm of the contour, and the beam has a radius "
            "of 1.5 mm: it cuts 0.250 mm into the part");
}

// OPT-8.74, OPT-8.75, OPT-8.77, OPT-7.62
TEST(ToolPlaces, OfTransformAndShift) {
  const motion::RigidMotion up = motion::RigidMotionOf({0, 0, 1e18}, 0, 0, 0);
  const Tool transform = [&](const std::string& text) {
    Rewriting made = Transform(text, up);
    return Answer{made.ok, std::move(made.diagnostics)};
  };
  const Tool shift = [](const std::string& text) {
    Rewriting made = Shift(text, {1e18, 0, 0, 0, 0, 0});
    return Answer{made.ok, std::move(made.diagnostics)};
  };
  const std::vector<ToolRow> transformed = {
      {"SPEED 5\n{MOVE (1,2,3,4,VR[1])}\n", 7851, "OPT-8.77", "a coordinate is no plain number"},
      {"{MOVE (1,2,3,0,0)/VIA (VR[1],2,3,0,0)}\n", 7851, "OPT-8.77",
       "a coordinate is no plain number"},
      {"{MOVE (VR[1],2,3,0,0)/VIA (VR[2],2,3,0,0)}\n", 7851, "OPT-8.77",
       "a coordinate is no plain number"},
      {"{SYSDEF (1,2,3,0,VR[1],0)}\n", 7851, "OPT-8.77", "a rotation of SYSDEF"},
      {"SPEED 5\n{MOVE (1,2,9E18,0,0)}\n", 7004, "OPT-7.62", "a number would become larger"},
  };
  for (const ToolRow& row : transformed) ExpectSaid(transform, row);
  const std::vector<ToolRow> shifted = {
      {"SPEED 5\n{VR[86] = 9E18}\n", 7004, "OPT-7.62", "a number would become larger"},
      {"{LET VR[86] = 9E18}\nVR[87] = 5.\n", 7004, "OPT-7.62", "a number would become larger"},
  };
  for (const ToolRow& row : shifted) ExpectSaid(shift, row);
  // Nothing to shift belongs to the program as a whole.
  for (const std::string text :
       {"VR[85] = 1.\nVR[92] = 1.\n", "VR[86] = VR[1]\n", "VI[86] = 5\n"}) {
    const Answer none = shift(text);
    EXPECT_FALSE(none.ok);
    ASSERT_EQ(none.diagnostics.size(), 1U) << text;
    EXPECT_EQ(none.diagnostics[0].code, ErrorCode::kShiftNothing);
    EXPECT_EQ(none.diagnostics[0].rule, "OPT-8.75");
  }
}

// OPT-8.35, OPT-8.46, OPT-8.53, OPT-8.65
TEST(ToolPlaces, OfConversion) {
  const Tool convert = [](const std::string& text) {
    return Answer{true, Convert(text, Direction::kToMetric).diagnostics};
  };
  std::string sum = "VI[2] = 1";  // tokens: VI [ 2 ] = 1, then two each
  for (int n = 0; n < 98; ++n) sum += "+1";
  const std::vector<ToolRow> rows = {
      {"SPEED 5\n{VR[1] = VR[2] + 1. + 2.}\n", 7709, "OPT-8.46", "numbers left alone", true},
      {"DECLARE K = 5.\nVR[1] = {K}\n", 7710, "OPT-8.35", "a declared constant stands where", true},
      {"VR[4] = {PI}\n", 7710, "OPT-8.35", "PI stands where a measurement belongs", true},
      {"SPEED 5\nSPEED 5 {PATH} LIN\n", 7711, "OPT-8.53", "the line is copied: ", true},
      {"5 {" + sum + "}\n", 7708, "OPT-8.65", "more than 200 symbols", true},
  };
  for (const ToolRow& row : rows) ExpectSaid(convert, row);
}

}  // namespace
}  // namespace rmlcell::optimo
