// What is known where two ways of a program come together: what both of them say, whichever is
// looked at first.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::ways_that_disagree {
namespace {

// How often these words are said of a program.
auto TimesTold(const std::string& text, std::string_view words) {
  const Compilation compiled = Compile(text, "", {.advice = true});
  EXPECT_TRUE(compiled.ok) << text;
  return std::ranges::count_if(compiled.diagnostics, [&](const Diagnostic& d) {
    return std::string_view(d.detail).find(words) != std::string_view::npos;
  });
}

struct Ways {
  std::string before;
  std::string one, other;  // what stands on either way, a line each
  std::string behind;
  std::string_view words;
  int both_one, both_other, apart;  // they are said so often
};

void ExpectTold(const Ways& ways) {
  const auto times = [&](const std::string& first, const std::string& second) {
    return TimesTold(ways.before + "IF VL[1] THEN 10\n" + first + "\nGOTO 20\n10 " + second +
                         "\n20 ACCEL 5\n" + ways.behind,
                     ways.words);
  };
  EXPECT_EQ(times(ways.one, ways.one), ways.both_one) << ways.words;
  EXPECT_EQ(times(ways.other, ways.other), ways.both_other) << ways.words;
  EXPECT_EQ(times(ways.one, ways.other), ways.apart) << ways.words;
  EXPECT_EQ(times(ways.other, ways.one), ways.apart) << ways.words;
}

const std::string kModes = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n";
const std::string kMove = "MOVE (20.,0.,0.,0.,0.)\n";
const std::string kNothing = "ACCEL 5";

// OPT-5.46, OPT-5.47, OPT-5.40
TEST(WaysThatDisagree, AboutTheBeamAndItsOutputs) {
  ExpectTold({kModes + "WORK 0,0/ON\nDELAY 1\nMOVE (9.,0.,0.,0.,0.)\nSPEED 30\n", "WORK 0,0/OFF",
              kNothing, kMove, "away from the part", 1, 0, 0});
  ExpectTold({kModes, "OL[11]=OFF", "OL[11]=ON", "WORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n",
              "the sensor OL[11] is off", 1, 0, 0});
  ExpectTold({kModes, "SPEED 100", "SPEED 50", kMove, "rapid moves take at most 70 %", 1, 0, 0});
  ExpectTold({"", "OL[8]=ON", "OL[8]=OFF", "OL[9]=ON\n", "on one path the other assist gas is on",
              0, 0, 1});
  ExpectTold({"", "OL[9]=ON", "OL[9]=OFF", "OL[8]=ON\n", "on one path the other assist gas is on",
              0, 0, 1});
}

// OPT-3.09, OPT-3.34, OPT-1.17
TEST(WaysThatDisagree, AboutProcessesAndVariables) {
  ExpectTold({"", "WORK 0,0/ON", kNothing, "",
              "on one path a process is ON at the end of the program", 0, 0, 1});
  ExpectTold({"", "WORKDEF 1,0 (8.,75.,1.,50.)", kNothing, "WORK 1,0/ON\nWORK 1,0/OFF\n",
              "on one path no WORKDEF 1,0", 0, 0, 1});
  ExpectTold({"", "VR[5]=1.", kNothing, "VR[6]=VR[5]\n", "VR[5] is read before the program sets it",
              0, 0, 1});
}

// OPT-5.45, OPT-5.48, OPT-B.59
TEST(WaysThatDisagree, AboutCoordinatesAndPaths) {
  const std::string cut = "OL[11]=ON\nWORK 0,0/ON\nDELAY 1\n" + kMove + "WORK 0,0/OFF\n";
  ExpectTold({"COORD ABSOL\n", "PATH PTP", "PATH LIN", cut, "PTP", 1, 0, 0});
  ExpectTold({kModes, "SYSDEF", "SYSDEF (0.,0.,0.,1.,0.,0.)",
              "PATH HOLE (5.)\nMOVE (20.,2.,3.,0.,0.)/VIA (22.,2.,3.,0.,0.)\n", "off the tool axis",
              1, 0, 0});
  ExpectTold({"COORD ABSOL\n", kNothing, "TIMER (5., 900)",
              "PATH PTP\n" + cut + "ENDTASK\n900 PATH LIN\nRETURN\n", "PTP", 1, 0, 0});
}

// OPT-2.51: the next move is another one on the other way.
TEST(WaysThatDisagree, AboutAShortMove) {
  const std::string words = "shorter than 1 mm, and the next move stops";
  const std::string near = kModes + "MOVE (0.5,0.,0.,0.,0.)/FLY\n",
                    far = "MOVE (50.,0.,0.,0.,0.)/FLY\n", last = "MOVE (90.,0.,0.,0.,0.)\n";
  EXPECT_EQ(TimesTold(near + last, words), 1);
  EXPECT_EQ(TimesTold(near + "IF VL[1] THEN 20\nACCEL 5\n20 " + last, words), 1);
  EXPECT_EQ(TimesTold(near + "IF VL[1] THEN 20\n" + far + "20 " + last, words), 0);
  EXPECT_EQ(TimesTold(near + "IF VL[1] THEN 10\nGOTO 20\n10 " + far + "20 " + last, words), 0);
}

// OPT-3.58, OPT-3.20, OPT-B.59: an error handler begins with the beam off. Where other ways lead
// there as well, on which it is on or was just switched off, a TIMER whose GOSUB may switch it off
// leaves it one of these three: switched on again, it may have pierced before.
TEST(WaysThatDisagree, WithAnErrorHandler) {
  const auto times = [](const std::string& still_on) {
    return TimesTold("COORD ABSOL\nPATH LIN\nSPEED 10\nERR 900\nWORK 0,0/ON\nDELAY 1\n" + still_on +
                         "WORK 0,0/OFF\n900 TIMER /DIS\nCOORD ABSOL\nPATH LIN\nWORK 0,0/ON\n" +
                         kMove +
                         "WORK 0,0/OFF\nTIMER (5.,800)\nENDTASK\n"
                         "800 IF VL[3] THEN 810\nWORK 0,0/OFF\n810 RETURN\n",
                     "switched on without a dwell");
  };
  EXPECT_EQ(times("IF VL[2] THEN 900\n"), 0);
  EXPECT_EQ(times(""), 1);
}

// OPT-5.46: what comes back along the text holds from there on, beyond the next number, too.
TEST(WaysThatDisagree, WithTheOneThatLeadsBack) {
  const auto times = [](const std::string& again) {
    return TimesTold(
        "COORD ABSOL\nPATH LIN\nSPEED 100\n10 IF VL[1] THEN 20\nACCEL 5\n20 ACCEL 5\n" + kMove +
            again + "GOTO 10\n",
        "rapid moves take at most 70 %");
  };
  EXPECT_EQ(times("SPEED 100\n"), 1);
  EXPECT_EQ(times(""), 1);
  EXPECT_EQ(times("SPEED 50\n"), 0);
}

// OPT-B.59: the time runs on while a FUNCTION does.
TEST(WaysThatDisagree, ATimerIsArmedBehindAFunction) {
  const std::string behind =
      "FUNCTION 44\nCOORD ABSOL\nPATH PTP\nOL[11]=ON\nWORK 0,0/ON\nDELAY 1\n" + kMove +
      "WORK 0,0/OFF\nENDTASK\n900 PATH LIN\nRETURN\n";
  EXPECT_EQ(TimesTold(behind, "PTP"), 1);
  EXPECT_EQ(TimesTold("TIMER (5., 900)\n" + behind, "PTP"), 0);
  EXPECT_EQ(TimesTold("TIMER (5., 900)\nTIMER /DIS\n" + behind, "PTP"), 1);
}

}  // namespace
}  // namespace rmlcell::optimo::ways_that_disagree
