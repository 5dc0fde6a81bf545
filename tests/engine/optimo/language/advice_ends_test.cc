// Where advice ends: at the longest program, at the three coordinates of a
// target, at a hole without an axis; and where a text begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/formatter.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::advice_ends {
namespace {

// How often this is said of a program.
auto CountOf(std::string_view text, int number, std::string_view rule) {
  const Compilation compiled = Compile(text, "", {.object_limit = 0, .advice = true});
  return std::ranges::count_if(compiled.diagnostics, [&](const Diagnostic& d) {
    return Lookup(d.code).number == number && d.rule == rule;
  });
}

// OPT-3.34: the longest program whose flow is followed, and one step more.
TEST(AdviceEnds, AProgramOfTheMostInstructionsIsFollowed) {
  std::string text = "WORK 0,0/ON\n";
  for (std::size_t n = 1; n < kFlowInstructionsMax; ++n) text += "ACCEL 5\n";
  EXPECT_EQ(CountOf(text, 7408, "OPT-3.34"), 1);
  EXPECT_EQ(CountOf(text + "ACCEL 5\n", 7408, "OPT-3.34"), 0);
}

// OPT-2.51: where the tip goes to is known whatever the head does, and not
// without one of X, Y, Z.
TEST(AdviceEnds, ATargetIsOfThreeCoordinates) {
  const std::string begin = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n",
                    end = "MOVE (20.,0.,0.,0.,0.)\n";
  for (const char* target : {"0.9,0.,0.,0.,0.", "0.,0.9,0.,VR[1],0.", "0.,0.,0.9,VR[1],VR[2]"})
    EXPECT_EQ(CountOf(begin + "MOVE (" + target + ")/FLY\n" + end, 7314, "OPT-2.51"), 1) << target;
  for (const char* target : {"VR[1],0.,0.9,0.,0.", "0.9,VR[1],0.,0.,0.", "0.9,0.,VR[1],0.,0."})
    EXPECT_EQ(CountOf(begin + "MOVE (" + target + ")/FLY\n" + end, 7314, "OPT-2.51"), 0) << target;
}

// OPT-5.48: an axis of any length has an angle, none has none.
TEST(AdviceEnds, AHoleWithoutAnAxisHasNoAngle) {
  const auto count = [](const std::string& via, const std::string& angles = "0.,0.") {
    return CountOf(
        "COORD ABSOL\nPATH HOLE (5.)\nMOVE (20.,2.,3.,0.,0.)/VIA (" + via + "," + angles + ")\n",
        7033, "OPT-5.48");
  };
  EXPECT_EQ(count("20.,2.,3."), 0);
  EXPECT_EQ(count("21.,2.,3."), 1);  // 1 mm of it, 90 degrees off
  EXPECT_EQ(count("22.,2.,3."), 1);
  EXPECT_EQ(count("20.,2.,4."), 0);
  // OPT-2.29: its head angles do not count.
  EXPECT_EQ(count("22.,2.,3.", "VR[1],VR[2]"), 1);
  EXPECT_EQ(count("22.,2.,VR[1]"), 0);
}

// What another program had in its last place, one behind the end of this one,
// is no part of it.
TEST(AdviceEnds, BehindTheLastInstructionStandsNothing) {
  struct Row {
    std::string text;    // of the program
    std::string behind;  // of the other one
    int number;
    std::string_view rule;
    int with, without;  // it is said so often
  };
  const std::string absol = "COORD ABSOL\nPATH LIN\nSPEED 30\nMOVE (0.,0.,0.,0.,0.)\n";
  const std::string robot = "COORD ROBOT\nPATH PTP\nMOVE (9.,0.,0.,0.,0.)\n";
  const std::string sub = "900 SYSDEF (1.,0.,0.,0.,0.,0.)\n" + absol;
  const Row rows[] = {
      {absol + "MOVE (9.,0.,0.,0.,0.)\n", "WORK 0,0/ON", 7033, "OPT-5.46", 1, 0},
      {absol, "RETURN", 7504, "OPT-7.22", 1, 0},
      {absol + "MOVE (9.,0.,0.,0.,0.)/FLY\n", "MOVE (8.,0.,0.,0.,0.)", 7032, "OPT-2.47", 0, 1},
      {sub + robot, "GOSUB 900", 7033, "OPT-7.109", 1, 0}};
  for (const Row& row : rows) {
    std::string first;
    for (int lines = 0; lines < 100; ++lines, first += "ACCEL 5\n") {
      const std::string text = first + row.text;
      EXPECT_EQ(CountOf(text + row.behind, row.number, row.rule), row.with) << text;
      EXPECT_EQ(CountOf(text, row.number, row.rule), row.without) << text;
    }
  }
}

// OPT-1.03: line ends are those of the text, whatever stands before it in
// memory.
TEST(AdviceEnds, ATextThatBeginsWithALineEndHasItsOwn) {
  const std::string_view text = "\r\n     STOP\n";
  EXPECT_EQ(Format(text.substr(1)).text, "\n     STOP\n");
  EXPECT_FALSE(Format(text.substr(1)).changed);
  EXPECT_EQ(Format(text).text, "\r\n     STOP\r\n");
}

}  // namespace
}  // namespace rmlcell::optimo::advice_ends
