// What two programs do differently, as the wire and the command tell it
// (proto/rmlcell/v1/program.proto).
#include "proto/bridge/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/core/number_text.h"
#include "engine/optimo/language/compiler.h"

namespace rmlcell::bridge {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

ComparedProgram TextOf(const std::string& text, const std::string& file_name = "a.S") {
  return {.file_name = file_name, .bytes = machine::Bytes::Of(text)};
}

ComparisonOutcome Compared(const std::string& before, const std::string& after,
                           const ComparisonOptions& options = {}) {
  const auto outcome = ComparePrograms(TextOf(before), TextOf(after), options);
  EXPECT_TRUE(outcome);
  return *outcome;
}

// One step of data, one of outputs, one of time: what each says stands in its own fields.
TEST(Comparison, EachChangeHasItsFields) {
  const ComparisonOutcome outcome =
      Compared("OL[11]=ON\nVR[1]=2.\nDELAY 1\n", "VR[1]=2.\nWORKDEF 2,0 (11)\nDELAY 2\n");
  EXPECT_TRUE(outcome.ok);
  const v1::DiffProgramsResponse& diff = outcome.response;
  EXPECT_FALSE(diff.equal());
  EXPECT_THAT(diff.aspects(),
              ElementsAre(v1::DIFF_ASPECT_TIME, v1::DIFF_ASPECT_POWER, v1::DIFF_ASPECT_OUTPUTS));
  ASSERT_EQ(diff.steps_size(), 3);
  EXPECT_EQ(diff.steps_dropped(), 0);
  EXPECT_EQ(diff.steps(0).step_before(), 1);
  EXPECT_EQ(diff.steps(0).step_after(), 0);
  EXPECT_EQ(diff.steps(0).before(), "LET OL[11] = ON");
  EXPECT_EQ(diff.steps(0).after(), "");
  EXPECT_THAT(diff.steps(0).aspects(), ElementsAre(v1::DIFF_ASPECT_OUTPUTS));
  EXPECT_EQ(diff.steps(1).step_before(), 0);
  EXPECT_EQ(diff.steps(1).step_after(), 2);
  EXPECT_EQ(diff.steps(1).before(), "");
  EXPECT_EQ(diff.steps(1).after(), "WORKDEF 2,0 (11)");
  EXPECT_THAT(diff.steps(1).aspects(), ElementsAre(v1::DIFF_ASPECT_POWER));
  EXPECT_EQ(diff.steps(2).step_before(), 3);
  EXPECT_EQ(diff.steps(2).step_after(), 3);
  EXPECT_THAT(diff.steps(2).what(), ElementsAre("DELAY 1 -> DELAY 2"));
  EXPECT_EQ(diff.steps(2).target_moved_mm(), 0.0);
  EXPECT_TRUE(outcome.diagnostics[0].empty());
  EXPECT_EQ(outcome.dropped[0].count() + outcome.dropped[1].count(), 0U);
}

// Whose machine the programs were compared on, and who changed what of it.
TEST(Comparison, NamesTheMachine) {
  const v1::DiffProgramsResponse diff =
      Compared("DELAY 1\n", "DELAY 1\n",
               {.parameters = {{"GAS_CHANNELS", "3"}}, .parameters_of = "mine.toml"})
          .response;
  EXPECT_EQ(diff.profile_changed_by(), "mine.toml");
  ASSERT_EQ(diff.profile_changes_size(), 1);
  EXPECT_EQ(diff.profile_changes(0).name(), "GAS_CHANNELS");
  EXPECT_EQ(diff.profile_changes(0).value(), "3");
}

TEST(Comparison, OfPathDataAndFlow) {
  const auto aspects = [](const std::string& before, const std::string& after) {
    const ComparisonOutcome outcome = Compared(before, after);
    EXPECT_EQ(outcome.response.steps_size(), 1);
    std::vector<int> named(outcome.response.aspects().begin(), outcome.response.aspects().end());
    return named;
  };
  EXPECT_THAT(aspects("PATH LIN\nMOVE (1,2,3,0,0)\n", "PATH LIN\nMOVE (4,6,3,0,0)\n"),
              ElementsAre(v1::DIFF_ASPECT_PATH));
  EXPECT_THAT(aspects("VR[1]=2.\n", "VR[1]=3.\n"), ElementsAre(v1::DIFF_ASPECT_DATA));
  EXPECT_THAT(aspects("GOTO 20\n10 VI[2]=1\n20 VI[3]=1\n", "GOTO 10\n10 VI[2]=1\n20 VI[3]=1\n"),
              ElementsAre(v1::DIFF_ASPECT_FLOW));
  // (3, 4, 0): 5 mm.
  const v1::DiffProgramsResponse moved =
      Compared("MOVE (1,2,3,0,0)\n", "MOVE (4,6,3,0,0)\n").response;
  EXPECT_DOUBLE_EQ(moved.steps(0).target_moved_mm(), 5.0);
}

TEST(Comparison, TheSameInOtherWords) {
  const ComparisonOutcome outcome =
      Compared("SPEED 5\nDELAY 1\n", "speed 5.0 ; slow\nDELAY 1.\nENDTASK\n");
  EXPECT_TRUE(outcome.ok);
  EXPECT_TRUE(outcome.response.equal());
  EXPECT_TRUE(outcome.response.compared_runs());
  EXPECT_EQ(outcome.response.steps_size(), 0);
  EXPECT_EQ(outcome.response.aspects_size(), 0);
  EXPECT_EQ(outcome.response.figures_size(), 0);
  EXPECT_EQ(outcome.response.picture_svg(), "");  // not asked for
}

// The name decides units and form: an object is what was made of its source, inches are converted
// first (OPT-2.04).
TEST(Comparison, InchesAndObjects) {
  const auto equal = [](const ComparedProgram& before, const ComparedProgram& after) {
    const auto outcome = ComparePrograms(before, after, {});
    return outcome && outcome->ok && outcome->response.equal() && outcome->response.compared_runs();
  };
  const ComparedProgram metric = TextOf("DELAY 1\nVR[1]=12.7\n");
  EXPECT_FALSE(equal(TextOf("DELAY 1\nVR[1]=.5\n"), metric));
  const std::string object = optimo::Compile(*metric.bytes, {}, {}).object;
  EXPECT_TRUE(equal(metric, TextOf(object, "a.O")));
  EXPECT_TRUE(equal(TextOf(object, "a.O"), metric));
  const auto inches = ComparePrograms(metric, TextOf("DELAY 1\nVR[1]=.5\n", "b.SI"), {});
  ASSERT_TRUE(inches);
  EXPECT_FALSE(inches->ok);
  ASSERT_EQ(inches->diagnostics[1].size(), 1U);
  EXPECT_EQ(inches->diagnostics[1][0].code, ErrorCode::kSourceIsInch);
}

// Beyond so many, changed steps are only counted.
TEST(Comparison, ManyChanges) {
  const std::string before = "VI[1]=1\nVI[2]=1\nVI[3]=1\n";
  const std::string after = "VI[1]=2\nVI[2]=2\nVI[3]=2\n";
  for (const std::size_t most : {std::size_t{0}, std::size_t{2}, std::size_t{3}, std::size_t{4}}) {
    const v1::DiffProgramsResponse diff = Compared(before, after, {.changes_max = most}).response;
    EXPECT_EQ(diff.steps_size(), static_cast<int>(std::min<std::size_t>(most, 3))) << most;
    EXPECT_EQ(diff.steps_dropped(), 3 - diff.steps_size()) << most;
    EXPECT_FALSE(diff.equal());
    EXPECT_THAT(diff.aspects(), ElementsAre(v1::DIFF_ASPECT_DATA));
  }
}

// A second more of DELAY is a second more of the cycle.
TEST(Comparison, FiguresOfBothRuns) {
  const v1::DiffProgramsResponse diff = Compared("DELAY 1\n", "DELAY 2\n").response;
  EXPECT_TRUE(diff.compared_runs());
  const auto cycle = std::ranges::find(diff.figures(), "cycle_time",
                                       &v1::DiffProgramsResponse::FigureChange::name);
  ASSERT_NE(cycle, diff.figures().end());
  EXPECT_EQ(cycle->unit(), "s");
  EXPECT_NEAR(cycle->after() - cycle->before(), 1.0, 1e-9);
  EXPECT_GE(cycle->before(), 1.0);
}

// A program that halts, waits or goes on for ever has no figures, whichever of the two it is.
TEST(Comparison, OfRunsThatDoNotEndByThemselves) {
  const auto runs = [](const std::string& before, const std::string& after,
                       const ComparisonOptions& options = {}) {
    const ComparisonOutcome outcome = Compared(before, after, options);
    EXPECT_TRUE(outcome.ok);
    EXPECT_TRUE(outcome.response.compared_runs() || outcome.response.figures_size() == 0);
    return outcome.response.compared_runs();
  };
  const std::string ends = "DELAY 1\n";
  const std::string halts = "DELAY 2\nSTOP\n";
  const std::string goes_on = "10 VI[2] = VI[3]\nGOTO 10\n";
  EXPECT_TRUE(runs(ends, "DELAY 2\n"));
  EXPECT_FALSE(runs(ends, halts));
  EXPECT_FALSE(runs(halts, ends));
  EXPECT_FALSE(runs(ends, goes_on, {.steps_max = 100}));
  EXPECT_FALSE(runs("DELAY 1\nDELAY 2\n", "DELAY 1\nDELAY 2\n", {.steps_max = 1}));
  EXPECT_FALSE(runs(goes_on, ends, {.go_on = [] { return false; }}));
  EXPECT_TRUE(runs(ends, "DELAY 2\n", {.steps_max = 100, .go_on = [] { return true; }}));
}

// What the figures leave out: a stream that ends inside a command is run up to there, one that
// halts is not compared. Work of 4 mm, and 7 mm with the second stroke.
TEST(Comparison, NotesSayWhatTheFiguresLeaveOut) {
  const std::string begin = "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD400,0;";
  const auto diff = [&](const std::string& after) {
    const auto outcome = ComparePrograms(TextOf(begin + "PU;!MC0;", "a.rml"),
                                         TextOf(begin + after, "folder/b.rml"), {});
    EXPECT_TRUE(outcome);
    return outcome->response;
  };
  EXPECT_TRUE(diff("PU;!MC0;").notes().empty());
  const v1::DiffProgramsResponse torn = diff("PU;PD400,");
  EXPECT_TRUE(torn.compared_runs());
  EXPECT_THAT(torn.notes(),
              ElementsAre("b.rml: the data ends inside a command: the last one is not "
                          "carried out"));
  const v1::DiffProgramsResponse halted = diff("PU;!NR;!MC0;");
  EXPECT_FALSE(halted.compared_runs());
  EXPECT_THAT(halted.notes(), ElementsAre("b.rml: stopped at 1/8, CELL-E9308"));
}

// An object that does not fit into the memory of the control cannot run (OPT-1.08); its steps are
// compared all the same.
TEST(Comparison, OfObjectsThatAreTooLong) {
  std::string lines;
  for (int i = 0; i < 8000; ++i) lines += "VI[1]=1\n";
  const auto object = [](const std::string& text) {
    return TextOf(optimo::Compile(text, {}, {.object_limit = 0}).object, "a.O");
  };
  const auto outcome = ComparePrograms(object(lines), object(lines + "VI[2]=1\n"), {});
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->ok);
  EXPECT_FALSE(outcome->response.compared_runs());
  ASSERT_EQ(outcome->response.steps_size(), 1);
  EXPECT_EQ(outcome->response.steps(0).step_after(), 8001);
  // The picture says of the one that cannot run that it did not, whichever of them it is.
  const ComparedProgram runs = TextOf("VI[1]=1\n");
  const ComparedProgram long_one = object(lines);
  for (const bool first : {true, false}) {
    const auto one_runs =
        ComparePrograms(first ? runs : long_one, first ? long_one : runs, {.picture = true});
    ASSERT_TRUE(one_runs);
    EXPECT_TRUE(one_runs->ok);
    EXPECT_NE(one_runs->response.picture_svg().find("OPT-E7106"), std::string::npos);
  }
}

// The picture names both by the last part of their names, and says where a run ended early.
TEST(Comparison, ThePicture) {
  const std::string line = "COORD ABSOL\nPATH LIN\nMOVE (100.,100.,-100.,0.,0.)\n";
  const auto outcome =
      ComparePrograms(TextOf(line + "MOVE (200.,100.,-100.,0.,0.)\n", "old/here/one.S"),
                      TextOf(line + "STOP\n", "C:\\new\\two.S"), {.picture = true});
  ASSERT_TRUE(outcome);
  const std::string& picture = outcome->response.picture_svg();
  EXPECT_THAT(picture, HasSubstr("<svg"));
  EXPECT_THAT(picture, HasSubstr("<title>one.S → two.S</title>"));
  EXPECT_THAT(picture, Not(HasSubstr("here/one.S")));
  EXPECT_THAT(picture, Not(HasSubstr("new\\two.S")));
  EXPECT_THAT(picture, HasSubstr("two.S: stopped at 1/4, OPT-E7507"));
  EXPECT_THAT(picture, Not(HasSubstr("one.S: ")));  // it ran to its end
}

// A figure that changed stands there as it was before and as it is after.
TEST(Comparison, ThePictureHasTheFiguresOfBoth) {
  const std::string line = "COORD ABSOL\nPATH LIN\nMOVE (100.,100.,-100.,0.,0.)\n";
  const v1::DiffProgramsResponse diff =
      Compared(line + "DELAY 1\n", line + "DELAY 2\n", {.picture = true}).response;
  const auto cycle = std::ranges::find(diff.figures(), "cycle_time",
                                       &v1::DiffProgramsResponse::FigureChange::name);
  ASSERT_NE(cycle, diff.figures().end());
  EXPECT_LT(cycle->before(), cycle->after());
  EXPECT_THAT(diff.picture_svg(), HasSubstr(TrimmedText(cycle->before(), 3) + " → " +
                                            TrimmedText(cycle->after(), 3) + " s"));
}

// On which machine both ran, and what was changed of it.
TEST(Comparison, ThePictureNamesItsMachine) {
  const std::string line = "COORD ABSOL\nPATH LIN\nMOVE (100.,100.,-100.,0.,0.)\n";
  const v1::DiffProgramsResponse changed =
      Compared(
          line, line,
          {.picture = true, .parameters = {{"GAS_CHANNELS", "3"}}, .parameters_of = "mine.toml"})
          .response;
  EXPECT_EQ(changed.family(), "optimo");
  EXPECT_THAT(changed.picture_svg(),
              HasSubstr("changed: GAS_CHANNELS 3 (profile: 2); by mine.toml"));
  const v1::DiffProgramsResponse own =
      Compared(line, line, {.picture = true, .own = {.name = "The old one"}}).response;
  EXPECT_EQ(own.machine_name(), "The old one");
  EXPECT_THAT(own.picture_svg(), HasSubstr("The old one, based on "));
  EXPECT_THAT(own.picture_svg(), Not(HasSubstr("changed: ")));
}

// What runs in another slot stops there.
TEST(Comparison, EachRunsInItsSlot) {
  ComparedProgram halts = TextOf("DELAY 1\nSTOP\n", "b.S");
  halts.slot = 7;
  const auto outcome = ComparePrograms(TextOf("DELAY 1\n"), halts, {});
  ASSERT_TRUE(outcome) << outcome.error().detail;
  EXPECT_THAT(outcome->response.notes(), ElementsAre("b.S: stopped at 7/2, OPT-E7507"));
}

// A comparison gives no advice: a process is ON at the end of both.
TEST(Comparison, GivesNoAdvice) {
  const ComparisonOutcome outcome = Compared("WORK 0,0/ON\nDELAY 1\n", "WORK 0,0/ON\nDELAY 2\n");
  EXPECT_TRUE(outcome.diagnostics[0].empty());
  EXPECT_TRUE(outcome.diagnostics[1].empty());
}

TEST(Comparison, TheNoteSaysBudgetExceededInWords) {
  ComparisonOptions options{.picture = true, .steps_max = 100};
  const std::string goes_on =
      "COORD ABSOL\nMOVE (100.,100.,-100.,0.,0.)\n10 VI[2] = VI[3]\nGOTO 10\n";
  const ComparisonOutcome outcome = Compared(goes_on, goes_on, options);
  EXPECT_THAT(outcome.response.picture_svg(), HasSubstr("budget exceeded at 1/"));
}

// Errors of a text are findings of its side; there is nothing to compare then.
TEST(Comparison, ErrorsOfATextAreItsFindings) {
  for (const bool first : {true, false}) {
    const std::string wrong = "SPEED 101\nSPEED 102\n";
    const ComparisonOutcome outcome =
        first ? Compared(wrong, "DELAY 1\n") : Compared("DELAY 1\n", wrong);
    EXPECT_FALSE(outcome.ok);
    EXPECT_EQ(outcome.diagnostics[first ? 0 : 1].size(), 2U);
    EXPECT_EQ(outcome.diagnostics[first ? 1 : 0].size(), 0U);
    EXPECT_EQ(outcome.response.ByteSizeLong(), 0U);
  }
  std::string many;
  for (int i = 0; i < 1500; ++i) many += "SPEED 101\n";
  EXPECT_EQ(Compared("DELAY 1\n", many).dropped[1].count(), 500U);
}

TEST(Comparison, WhatIsNoProgramOfTheOptimo) {
  const ComparedProgram good = TextOf("DELAY 1\n");
  for (const bool first : {true, false}) {
    const auto refused = [&](const ComparedProgram& other) {
      const auto outcome =
          first ? ComparePrograms(other, good, {}) : ComparePrograms(good, other, {});
      EXPECT_FALSE(outcome);
      return outcome ? Error{} : outcome.error();
    };
    const Error mill = refused(TextOf("PU;", "part.rml"));
    EXPECT_EQ(mill.code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(mill.detail, std::string(first ? "part.rml and a.S" : "a.S and part.rml") +
                               " are programs for different machines");
    EXPECT_EQ(refused(TextOf(std::string("LMR\x01\xFF", 5), "a.O")).code,
              ErrorCode::kObjectCorrupt);
  }
}

// Streams of mills, on the mill that is named: 100 units in a mm on the SRM-20, 40 on the MDX-20.
TEST(Comparison, StreamsOfMills) {
  const ComparedProgram before = TextOf("!MC0;Z0,0,100;Z100,0,-20;!ZM0;", "a.rml");
  const ComparedProgram after = TextOf("!MC0;Z0,0,100;Z200,0,-20;!ZM0;", "b.rml");
  for (const auto& [profile, what] :
       {std::pair("srm-20", "X 1 -> 2"), std::pair("mdx-20", "X 2.5 -> 5")}) {
    const auto made = ComparePrograms(before, after, {.picture = true, .profile = profile});
    ASSERT_TRUE(made) << made.error().detail;
    EXPECT_TRUE(made->ok);
    EXPECT_TRUE(made->response.compared_runs());
    EXPECT_THAT(made->response.picture_svg(), HasSubstr("<svg"));
    ASSERT_EQ(made->response.steps(0).what_size(), 1);
    EXPECT_EQ(made->response.steps(0).what(0), what);
  }
  const auto same = ComparePrograms(before, before, {});
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->response.equal());
  EXPECT_FALSE(ComparePrograms(before, after, {.profile = "no-such"}));
}

}  // namespace
}  // namespace rmlcell::bridge
