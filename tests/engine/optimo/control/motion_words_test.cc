#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// What the words of motion and process do when a program runs, each by itself (appendix 1). New
// machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing::motion_words {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;

constexpr double kExact = 1e-6;
constexpr double kReal_mm = 1e-4;  // literals have seven digits

// Steps 1 to 3: LIN at 50 mm/s; the next two go 100 mm along X, and from there along Y.
const std::string kSlow = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
const std::string kAlongX = "MOVE (121.02,2201.2,-350.,0.,0.)";
const std::string kAlongY = "MOVE (121.02,2301.2,-350.,0.,0.)";
const motion::MachinePoint kCorner{121.02, 2201.2, -350.0};
// motion.md 5.2: from rest to v in 2 sqrt(v / j), j = 40000 mm/s3, up to 100 mm/s.
double Ramp(double speed_mm_s) { return 2.0 * std::sqrt(speed_mm_s / 40000.0); }
const double kHundred_s = 100.0 / 50.0 + Ramp(50.0) + kSettle_s;

machine::InputChange On(double at_s, int input) {
  return {At(at_s), InputKind::kLogical, input, 1.0};
}

// mm of tip path.
double Length(const Ran& ran) {
  double length_mm = 0.0;
  for (const Ran::Part& part : ran.parts) length_mm += part.done.travelled - part.done.from;
  return length_mm;
}

std::vector<std::string> Told(const Ran& ran) {
  std::vector<std::string> told = ran.told;
  std::erase_if(told, [](const std::string& what) { return what.starts_with("compiling"); });
  return told;
}

// OPT-W.01, OPT-W.41, OPT-W.30, OPT-2.34: 100 mm at ACCEL 50, where run-up to 50 mm/s takes 0.1 s;
// at SPEED 20; and a corner at OVERSH 50, 0.480 mm away (case C13). SPEED is 70 by itself: 350 mm/s
// with a run-up of 350/2000 + 2000/40000 s.
TEST(MotionWords, SpeedAccelAndOversh) {
  const auto seconds = [](const std::string& modal) {
    return RunText("COORD ABSOL\nPATH LIN\n" + modal + kAlongX + "\n").time_s;
  };
  EXPECT_NEAR(seconds("SPEED 10\n"), kHundred_s, kExact);
  EXPECT_NEAR(seconds("SPEED 10\nACCEL 50\n"), 2.0 + 0.1 + kSettle_s, kExact);
  EXPECT_NEAR(seconds("SPEED 20\n"), 1.0 + Ramp(100.0) + kSettle_s, kExact);
  EXPECT_NEAR(seconds("DECLARE CREEP = 20\nSPEED CREEP\n"), seconds("SPEED 20\n"), kExact);
  EXPECT_NEAR(seconds("VR[64]=10.\nSPEED VR[64]+10.\n"), seconds("SPEED 20\n"), kExact);
  EXPECT_NEAR(seconds(""), 100.0 / 350.0 + 0.175 + 0.05 + kSettle_s, kExact);
  const std::string corner = kAlongX + "/FLY\n" + kAlongY + "\n";
  EXPECT_NEAR(RunText(kSlow + "OVERSH 50\n" + corner).DistanceTo(kCorner), 0.480425, kReal_mm);
  EXPECT_NEAR(RunText(kSlow + corner).DistanceTo(kCorner), 1.358847515, kReal_mm);
}

// OPT-W.06, OPT-W.57: the third coordinate is that of the tip or of the column, 300 mm above it.
TEST(MotionWords, CoordAbsolAndRobot) {
  EXPECT_NEAR(RunText("COORD ABSOL\nMOVE (500.,500.,-350.,0.,0.)\n").end.tip.tip.z(), -350.0,
              kReal_mm);
  EXPECT_NEAR(RunText("COORD ROBOT\nMOVE (500.,500.,-350.,0.,0.)\n").end.tip.tip.z(), -650.0,
              kReal_mm);
}

// OPT-W.31, OPT-W.58, OPT-W.60, OPT-2.12: one target with one /VIA on every path. Straight on PTP
// and LIN, 20 mm; half a circle of radius 10. A hole of radius 5: 20 - 5 mm to its circle, then
// once around, and the word holds for the next one too, which starts on its circle.
TEST(MotionWords, PathsOfAMove) {
  const auto length = [](const std::string& path) {
    return Length(RunText("COORD ABSOL\nPATH " + path +
                          "\nMOVE (41.02,2201.2,-350.,0.,0.)/VIA (31.02,2211.2,-350.,0.,0.)\n"));
  };
  EXPECT_NEAR(length("PTP"), 20.0, kReal_mm);
  EXPECT_NEAR(length("LIN"), 20.0, kReal_mm);
  EXPECT_NEAR(length("CIR"), kPi * 10.0, kReal_mm);
  const std::string to_hole = "MOVE (41.02,2201.2,-350.,0.,0.)/VIA (41.02,2201.2,-250.,0.,0.)\n";
  EXPECT_NEAR(Length(RunText("COORD ABSOL\nPATH HOLE (5.)\n" + to_hole)), 15.0 + 2.0 * kPi * 5.0,
              kReal_mm);
  EXPECT_NEAR(Length(RunText("COORD ABSOL\nPATH HOLE (5.)\n" + to_hole + to_hole)),
              15.0 + 4.0 * kPi * 5.0, kReal_mm);
}

// OPT-2.23, OPT-2.28: one that begins on its circle has no way to it; from half a millimetre off it
// goes there first.
TEST(MotionWords, AHoleFromItsCircle) {
  const auto from = [](const std::string& x) {
    return RunText(kAbsol + "MOVE (" + x +
                   ",1000.,-400.,0.,0.)\nPATH HOLE (5.)\n"
                   "MOVE (1000.,1000.,-400.,0.,0.)/VIA (1000.,1000.,-300.,0.,0.)\n");
  };
  const Ran on = from("1005.");
  ASSERT_EQ(on.moves.size(), 2U);
  ASSERT_EQ(on.parts.size(), 2U);
  EXPECT_NEAR(on.parts[1].done.travelled, 2.0 * kPi * 5.0, 1e-9);
  const Ran off = from("1005.5");
  ASSERT_EQ(off.parts.size(), 3U);
  EXPECT_NEAR(off.parts[1].done.travelled, 0.5, 1e-9);
  EXPECT_NEAR(off.parts[2].done.travelled, 2.0 * kPi * 5.0, 1e-9);
}

// OPT-W.58, OPT-2.12: case P03, 500 mm on a slope of 3 to 4 at SPEED 30: PTP goes at 187.5 mm/s,
// LIN at 150.
TEST(MotionWords, PtpIsNotBoundToTheSpeedOfTheTip) {
  const std::string there = "COORD ABSOL\nMOVE (1000.,1000.,-300.,0.,0.)\nSPEED 30\nPATH ";
  const std::string slope = "\nMOVE (1400.,1300.,-300.,0.,0.)\n";
  EXPECT_NEAR(RunText(there + "PTP" + slope).parts.back().duration_s(), 2.791666667 + kSettle_s,
              1e-5);
  EXPECT_NEAR(RunText(there + "LIN" + slope).parts.back().duration_s(),
              500.0 / 150.0 + 0.075 + 0.05 + kSettle_s, 1e-5);
}

// OPT-2.29: a hole without /VIA is a straight line to its centre, with a warning.
TEST(MotionWords, AHoleWithoutViaIsALine) {
  const Ran ran = RunText("COORD ABSOL\nPATH HOLE (5.)\n" + kAlongX + "\n");
  EXPECT_THAT(Told(ran), ElementsAre("E7308"));
  EXPECT_NEAR(Length(ran), 100.0, kReal_mm);
  EXPECT_NEAR((ran.end.tip.tip - kCorner).norm(), 0.0, kReal_mm);
}

// OPT-W.26, OPT-W.61, OPT-W.60: the attributes of MOVE, each by itself.
TEST(MotionWords, AttributesOfMove) {
  EXPECT_GT(RunText(kSlow + kAlongX + "/FLY\n" + kAlongY + "\n").DistanceTo(kCorner), 1.0);
  const Ran start = RunText(kSlow + kAlongX + "/START (IL[16])\n", {.inputs = {On(3.0, 16)}});
  EXPECT_NEAR(start.time_s, 3.0 + kHundred_s, kExact);
  const Ran end = RunText(kSlow + kAlongX + "/END (IL[20])\nVI[2]=1\n",
                          {.inputs = {On(0.0, 20)}, .variables = {"VI[2]"}});
  EXPECT_NEAR(end.end.tip.tip.x(), 21.02, kReal_mm);
  EXPECT_EQ(end.time_s, 0.0);
  EXPECT_EQ(end.variables.at("VI[2]"), "1");
  // 2 s are over at 42 cycles, when 100.8 mm less half a run-up lie behind; half a run-up to rest.
  const Ran time = RunText(kSlow + "MOVE (521.02,2201.2,-350.,0.,0.)/TIME (2.,900)\nVI[3]=VI[2]\n" +
                               "ENDTASK\n900 VI[2]=5\nRETURN\n",
                           {.variables = {"VI[3]"}});
  EXPECT_NEAR(time.end.tip.tip.x(), 21.02 + 100.8, kReal_mm);
  EXPECT_EQ(time.variables.at("VI[3]"), "5");
  const Ran next = RunText(kSlow + kAlongX + "/NEXT\nOL[16]=ON\nWAIT (NOT IL[95])\nOL[16]=OFF\n");
  EXPECT_NEAR(next.First("OL[16] 1").at_s, 0.0, kExact);
  EXPECT_GE(next.First("OL[16] 0").at_s, 2.0 + Ramp(50.0));
}

// OPT-W.62, OPT-2.61: /INF changes nothing of the motion.
TEST(MotionWords, InfIsIgnored) {
  const Ran plain = RunText(kSlow + kAlongX + "\n");
  const Ran ran = RunText(kSlow + kAlongX + "/INF\n");
  EXPECT_NEAR((ran.end.tip.tip - kCorner).norm(), 0.0, kReal_mm);
  EXPECT_EQ(ran.end.time, plain.end.time);
  EXPECT_EQ(ran.told, plain.told);
}

// OPT-W.43, OPT-W.45, OPT-W.56, OPT-B.85: SYSDEF alone cancels; TCP moves the tip, not the machine,
// and a division in its list has parentheses of its own; ZERO ends with every axis at zero.
TEST(MotionWords, SysdefTcpAndZero) {
  const Ran offset = RunText("COORD ABSOL\nSYSDEF (10.,20.,30.,0,0,0)\nSYSDEF\n" + kAlongX + "\n");
  EXPECT_NEAR((offset.end.tip.tip - kCorner).norm(), 0.0, kReal_mm);
  for (const char* tool : {"TCP (0.,0.,3./0.,0.,-5.)\n", "TCP (0,0,(VR[1]/2)/0,0,-5)\n"}) {
    const Ran ran = RunText("VR[1]=6.\n" + std::string(tool));
    EXPECT_NEAR(ran.end.tip.tip.z(), -347.0, kReal_mm) << tool;
    EXPECT_TRUE(ran.moves.empty());
  }
  const Ran zero = RunText("ZERO\n");
  EXPECT_NEAR(
      zero.end.axes.column.norm() + std::abs(zero.end.axes.a_rad) + std::abs(zero.end.axes.b_rad),
      0.0, kExact);
}

// OPT-W.54, OPT-W.55, OPT-W.61, OPT-W.68: WORK and its attributes; /TIME is only accepted: no
// GOSUB, and the beam at once.
TEST(MotionWords, WorkAndItsAttributes) {
  const Ran plain = RunText("WORKDEF 0,0\nWORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n");
  EXPECT_THAT(Told(plain), ElementsAre("shutter open", "beam on 100.0", "wait dwell 1.0",
                                       "beam off", "shutter closed"));
  const Ran start =
      RunText("WORK 0,0/ON/START (IL[16])\nWORK 0,0/OFF\n", {.inputs = {On(3.0, 16)}});
  EXPECT_NEAR(start.First("beam on 100.0").at_s, 3.0, kExact);
  // Tested every cycle: 2 s are over at 42 of them.
  const Ran end = RunText("WORK 0,0/ON/END (IL[20])\nDELAY 5\n", {.inputs = {On(2.0, 20)}});
  EXPECT_NEAR(end.First("beam off").at_s, 42 * 0.048, kExact);
  const std::string pierce = "WORKDEF 1,0 (8.,75.,1.5,50.)\nWORK 1,0/ON";
  const std::string after = "\nOL[16]=ON\nDELAY 3\nWORK 1,0/OFF\n";
  EXPECT_NEAR(RunText(pierce + after).First("OL[16] 1").at_s, 1.5, kExact);
  EXPECT_NEAR(RunText(pierce + "/NEXT" + after).First("OL[16] 1").at_s, 0.0, kExact);
  const Ran time =
      RunText("WORK 0,0/ON/TIME (1.,5)\nDELAY 3\nWORK 0,0/OFF\nENDTASK\n5 VI[2]=1\nRETURN\n",
              {.variables = {"VI[2]"}});
  EXPECT_NEAR(time.First("beam on 100.0").at_s, 0.0, kExact);
  EXPECT_NEAR(time.time_s, 3.0, kExact);
  EXPECT_EQ(time.variables.at("VI[2]"), "0");
}

// OPT-W.09, OPT-W.50, OPT-W.47, OPT-W.63: DELAY takes its time, WAIT until its condition holds; a
// TIMER makes its GOSUB between two instructions, /AUTO again and again, /DIS no more. 1 s is over
// at 21 cycles, 2 s at 42, 3 s at 63.
TEST(MotionWords, WordsThatTakeTime) {
  EXPECT_NEAR(RunText("DELAY .5\n").time_s, 0.5, kExact);
  EXPECT_NEAR(RunText("WAIT IL[16]\n", {.inputs = {On(2.5, 16)}}).time_s, 2.5, kExact);
  const std::string handler = "ENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n";
  const std::string seconds = "DELAY 1.1\nDELAY 1.1\nDELAY 1.1\nVI[3]=VI[2]\n";
  ExpectValues(
      {{"TIMER (1.,900)\n" + seconds + handler, "VI[3]", "1"},
       {"TIMER (1.,900)/AUTO\n" + seconds + handler, "VI[3]", "3"},
       {"TIMER (1.,900)/AUTO\nDELAY 1.1\nTIMER /DIS\n" + seconds + handler, "VI[3]", "1"}});
}

// OPT-2.20, OPT-7.28: a MOVE to where the tip is already is told like any other, as it is
// programmed and where the machine stands: SYSDEF puts (21, 2001, -50) of the program to (121,
// 2201, -350).
TEST(MotionWords, AMoveOnTheSpotIsTold) {
  const std::string move = "MOVE (21.,2001.,-50.,.5,.25)";
  for (const auto& [path, feed_mm_s] : {std::pair("LIN", 50.0), {"PTP", 0.0}}) {
    const Ran ran = RunText("COORD ABSOL\nSYSDEF (100.,200.,-300.,0.,0.,0.)\nPATH " +
                            std::string(path) + "\nSPEED 10\n" + move + "\n" + move + "\n");
    ASSERT_EQ(ran.moves.size(), 2U) << path;
    const machine::MoveDone& first = ran.moves[0];
    const machine::MoveDone& second = ran.moves[1];
    EXPECT_EQ(second.at, first.at) << path;  // it takes no time
    EXPECT_NEAR(ToSeconds(second.at), ran.time_s, kExact) << path;
    EXPECT_EQ(second.place.step, 6) << path;
    EXPECT_NEAR((second.tip.tip - motion::MachinePoint(121.0, 2201.0, -350.0)).norm(), 0.0,
                kReal_mm);
    EXPECT_EQ(second.axes.column, first.axes.column) << path;
    EXPECT_NEAR(second.axes.a_rad, 0.5, kExact) << path;
    EXPECT_NEAR(second.axes.b_rad, 0.25, kExact) << path;
    EXPECT_EQ(second.program_point, motion::ProgramPoint(21.0, 2001.0, -50.0)) << path;
    EXPECT_EQ(second.rotary_a, 0.5) << path;
    EXPECT_EQ(second.feed_mm_s, feed_mm_s) << path;
    EXPECT_EQ(second.path, path);
    EXPECT_EQ(first.path, path);
  }
}

// OPT-W.32, OPT-W.42: PAUSE and STOP halt until START.
TEST(MotionWords, WordsThatHalt) {
  for (const std::string word : {"PAUSE", "STOP"}) {
    const Ran ran = RunText(word + "\nOL[16]=ON\n", {.inputs = {{At(4.0), InputKind::kStart}}});
    EXPECT_THAT(Told(ran), ElementsAre("halt " + word, "wait operator 4.0", "OL[16] 1"));
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::motion_words
