// A STOP where the override has just changed: the machine comes to rest and goes on within the
// limits that are in force then, on one move, in a chain, in the axes.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::after_the_override {
namespace {

using machine::InputKind;

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// The override changes at `change`, STOP comes `later`, and START ten seconds behind it.
Ran Stopped(const std::string& text, double before, double change, double percent, double later) {
  RunOptions options;
  options.override_percent = before;
  options.inputs = {{At(change), InputKind::kOverride, 0, percent},
                    {At(change + later), InputKind::kStop},
                    {At(change + later + 10.0), InputKind::kStart}};
  return RunText(text, options);
}

// OPT-4.38, OPT-4.18: a single move that was begun slower: it has the limits of its new speed, and
// a STOP keeps them, where the head turns and on a small circle, too.
TEST(AfterTheOverride, AMoveHasTheLimitsOfItsNewSpeed) {
  const std::string begin = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\n";
  for (const std::string move :
       {"SPEED 60\nMOVE (1600.,1000.,-400.,0.,0.)\n", "SPEED 80\nMOVE (1400.,1000.,-400.,3.,1.5)\n",
        "PATH CIR\nSPEED 40\nMOVE (1000.,1060.,-400.,0.,0.)/VIA (1030.,1030.,-400.,0.,0.)\n"}) {
    const std::string text = begin + move;
    const double from = BeginOf(text);
    for (const double later : {0.05, 0.15, 0.25, 0.4}) {
      const Ran ran = Stopped(text, 50.0, from + 0.25, 100.0, later);
      SCOPED_TRACE(move + std::to_string(later));
      EXPECT_EQ(ran.Count("halt STOP"), 1);
      for (const Ran::Part& part : ran.parts)
        EXPECT_LE(part.motion.speed.peak_speed(), part.motion.limits.speed * (1.0 + 1e-9));
      ExpectWithinLimits(ran, false, text);
    }
  }
}

// OPT-4.38, OPT-4.18: a chain of passages in the axes is measured anew with the override, and a
// STOP runs from what was planned before into what comes now.
TEST(AfterTheOverride, AStopInAChainOfTheAxes) {
  const std::string text =
      "MOVE (21.02,2201.2,-50.,0.,0.)\nDELAY 1\nSPEED 50\n"
      "MOVE (321.02,2201.2,-50.,0.,0.)/FLY\nMOVE (321.02,1901.2,-50.,0.5,0.)/FLY\n"
      "MOVE (621.02,1901.2,-50.,1.,0.5)/FLY\nMOVE (621.02,1601.2,-50.,0.,0.)\n";
  for (const double percent : {25.0, 55.0, 145.0}) {
    for (const double change : {1.3, 1.9, 2.6, 3.3}) {
      for (const double later : {1e-3, 0.02, 0.06, 0.1, 0.2, 0.4}) {
        const Ran ran = Stopped(text, 100.0, change, percent, later);
        SCOPED_TRACE(std::to_string(percent) + " " + std::to_string(change) + " " +
                     std::to_string(later));
        EXPECT_EQ(ran.Count("halt STOP"), 1);
        ExpectWithinLimits(ran, false, text);
        EXPECT_NEAR(ran.end.axes.column.y(), 1601.2, 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::after_the_override
