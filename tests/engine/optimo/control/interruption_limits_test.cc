#include <gtest/gtest.h>

#include <cmath>
#include <string>

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
