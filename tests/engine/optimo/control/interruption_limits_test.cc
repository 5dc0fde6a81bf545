#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/engine/motion/random_chain.h"
#include "tests/engine/optimo/control/measured.h"

// Whatever changes on the way, no limit of motion.md section 1 is broken: 10.1, measured from where
// the machine was.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

machine::InputChange OverrideTo(double time_s, double percent) {
  return {FromSeconds(time_s), InputKind::kOverride, 0, percent};
}

// motion.md 6: braking for the stop at the target, with no way left for anything but to go on.
TEST(InterruptionLimits, OverrideWhileBrakingForTheTarget) {
  const std::string text = "COORD ABSOL\nPATH LIN\nSPEED 100\nMOVE (521.02,2201.2,-350.,0.,0.)\n";
  const Ran plain = RunText(text);
  for (const double percent : {10.0, 25.0, 55.0, 85.0, 145.0}) {
    for (double at = 0.01; at < plain.time_s; at += 0.017) {
      const std::string what = std::to_string(percent) + " % at " + std::to_string(at);
      const Ran ran = RunText(text, {.inputs = {OverrideTo(at, percent)}});
      ExpectWithinLimits(ran, true, what);
      // Slower is never sooner, and at 100 % of the machine there is nothing faster.
      EXPECT_GE(ran.time_s, plain.time_s - 1e-6) << what;
    }
  }
}

// The same for the motions of 3.4, 3.5 and 3.3.
TEST(InterruptionLimits, OverrideDuringPtpAndHoles) {
  for (const std::string& text :
       {std::string("COORD ROBOT\nPATH PTP\nSPEED 50\nMOVE (600.,1800.,-50.,1.,0.5)\n"),
        std::string("COORD ABSOL\nPATH PTP\nSPEED 50\nMOVE (500.,2100.,-400.,1.,0.5)\n"),
        std::string("COORD ABSOL\nPATH HOLE (15.)\nSPEED 20\n"
                    "MOVE (121.02,2201.2,-350.,0.,0.)/VIA (121.02,2201.2,-150.,0.,0.)\n")}) {
    const Ran plain = RunText(text);
    ASSERT_EQ(plain.outcome.kind, machine::OutcomeKind::kCompleted);
    for (const double percent : {10.0, 55.0, 145.0}) {
      for (int k = 0; k < 40; ++k) {
        const double at = plain.time_s * (k + 0.5) / 40.0;
        const Ran ran = RunText(text, {.inputs = {OverrideTo(at, percent)}});
        ExpectWithinLimits(ran, text.find("HOLE") != std::string::npos,
                           text + std::to_string(percent) + " % at " + std::to_string(at));
      }
    }
  }
}

// motion.md 10.1: in a bend in which the head turns, the axes spend most of what they can on the
// bend itself. Stopped and started anywhere around it.
TEST(InterruptionLimits, StopAndStartInABendThatTurnsTheHead) {
  const std::string text =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (150.,2100.,-400.,0.,1.)\n"
      "MOVE (230.,2100.,-400.,0.,1.)/FLY\nMOVE (260.,2100.,-400.,1.0,1.)\n";
  const Ran plain = RunText(text);
  for (double at = 2.4; at < plain.time_s; at += 0.011) {
    const Ran ran = RunText(text, {.inputs = {{FromSeconds(at), InputKind::kStop, 0, 1.0},
                                              {FromSeconds(9.0), InputKind::kStart, 0, 1.0}}});
    const std::string what = "STOP at " + std::to_string(at);
    EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted) << what;
    EXPECT_NEAR((plain.end.tip.tip - ran.end.tip.tip).norm(), 0.0, 1e-6) << what;
    ExpectWithinLimits(ran, true, what);
  }
}

// Random contours with passages and turning heads, changed and stopped at random times.
// motion.md 6, 10.1
TEST(InterruptionLimits, RandomProgramsKeepThemWhateverComes) {
  constexpr int kSeeds = 250;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    motion::Dice dice(static_cast<std::uint64_t>(seed));
    const bool turns = dice.Uniform(0.0, 1.0) < 0.5;
    const bool robot = dice.Uniform(0.0, 1.0) < 0.3;  // a chain of motion.md 4.5
    std::string text =
        std::string(robot ? "COORD ROBOT\nPATH PTP\nSPEED " : "COORD ABSOL\nPATH LIN\nSPEED ") +
        std::to_string(static_cast<int>(dice.Uniform(5.0, 100.0))) + "\n";
    double x = 100.0;
    double y = 2100.0;
    const int moves = static_cast<int>(dice.Uniform(2.0, 8.0));
    for (int k = 0; k <= moves; ++k) {
      x += dice.Uniform(-30.0, 60.0);
      y += dice.Uniform(-40.0, 40.0);
      const double a = turns ? dice.Uniform(-0.3, 0.3) : 0.0;
      const bool fly = k < moves && dice.Uniform(0.0, 1.0) < 0.8;
      text += "MOVE (" + std::to_string(x) + "," + std::to_string(y) + ",-400.," +
              std::to_string(a) + ",0.5)" + (fly ? "/FLY\n" : "\n");
    }
    const Ran plain = RunText(text);
    ExpectWithinLimits(plain, !robot, "undisturbed\n" + text);
    machine::InputScript inputs;
    std::string what = text;
    double at = 0.0;
    for (int k = 0; k < 3; ++k) {
      at += dice.Uniform(0.0, 0.6) * plain.time_s;
      const double kind = dice.Uniform(0.0, 4.0);
      if (kind < 2.0) {
        inputs.push_back(OverrideTo(at, 10.0 + 15.0 * std::floor(dice.Uniform(0.0, 10.0))));
        what += std::to_string(at) + " OVERRIDE " + std::to_string(inputs.back().value) + "\n";
      } else {
        const InputKind halt = kind < 3.0 ? InputKind::kStop : InputKind::kHold;
        inputs.push_back({FromSeconds(at), halt, 0, 1.0});
        what += std::to_string(at) + (kind < 3.0 ? " STOP\n" : " HOLD\n");
        at += 20.0;
        inputs.push_back({FromSeconds(at), InputKind::kStart, 0, 1.0});
        what += std::to_string(at) + " START\n";
      }
    }
    const Ran ran = RunText(text, {.inputs = inputs});
    EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted) << what;
    EXPECT_NEAR((plain.end.tip.tip - ran.end.tip.tip).norm(), 0.0, 1e-6) << what;
    ExpectWithinLimits(ran, !robot, what);
  }
}

// motion.md 8.2: a move that came to its end is told to its end, so that corners and feed rates are
// counted; arrivals are rounded to 1 ns.
TEST(InterruptionLimits, MovesAreToldToTheirEnds) {
  for (int k = 1; k <= 40; ++k) {
    const std::string x = std::to_string(21.02 + 3.37 * k);
    const Ran ran =
        RunText("COORD ABSOL\nPATH LIN\nSPEED 100\nMOVE (" + x + ",2201.2,-350.,0.,0.)\n");
    const Ran::Part& last = ran.parts.back();
    EXPECT_EQ(last.done.travelled, last.motion.path.length()) << x;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing
