#include "engine/simulation/report/corner_log.h"

#include <gtest/gtest.h>

#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using motion::Passage;

CornerFigures CornersOf(const std::vector<std::pair<Passage, double>>& ends) {
  CornerLog log;
  int step = 0;
  for (const auto& [passage, deviation_mm] : ends) {
    const double x = 10.0 * ++step;
    motion::PlannedMotion planned = Planned(LineFrom({x - 10.0, 0, 0}, {x, 0, 0}));
    planned.corner = {.passage = passage, .deviation_mm = deviation_mm};
    log.Add({.place = {.program = 1, .step = step}, .motion = &planned, .travelled = 10.0});
  }
  return log.corners();
}

// motion.md 8.2: each passage counts under its own name.
TEST(CornerLog, CountsEachPassage) {
  EXPECT_EQ(CornersOf({{Passage::kStop, 0}}).stops, 1u);
  for (const Passage stop : {Passage::kStopNoSpeed, Passage::kStopNeighbour, Passage::kStopShort}) {
    EXPECT_EQ(CornersOf({{stop, 0}}).stops_with_fly, 1u);
    EXPECT_EQ(CornersOf({{stop, 0}}).stops, 0u);
  }
  EXPECT_EQ(CornersOf({{Passage::kStopReversal, 0}}).reversals, 1u);
  EXPECT_EQ(CornersOf({{Passage::kThrough, 0}}).through, 1u);
  EXPECT_EQ(CornersOf({{Passage::kBlend, 0}}).blended, 1u);
  EXPECT_EQ(CornersOf({{Passage::kBlendCapped, 0}}).capped, 1u);
}

// The largest deviation, with its place; of equal ones the first.
TEST(CornerLog, KeepsTheFirstOfTheLargestDeviations) {
  const CornerFigures corners = CornersOf({{Passage::kBlend, 0.25},
                                           {Passage::kBlend, 0.5},
                                           {Passage::kBlend, 0.5},
                                           {Passage::kBlend, 0.125}});
  EXPECT_EQ(corners.deviation_mm_max, 0.5);
  EXPECT_EQ(corners.deviation_place.step, 2);
  EXPECT_EQ(corners.deviation_point, (motion::MachineVector{20, 0, 0}));
  EXPECT_EQ(CornersOf({{Passage::kStop, 0.0}}).deviation_place.step, 0);  // none
}

// A move told in parts, or as several motions, counts once: at the end of its last one.
TEST(CornerLog, AMoveCountsOnce) {
  CornerLog log;
  motion::PlannedMotion planned = Planned(LineFrom({0, 0, 0}, {10, 0, 0}), kSlowLimits, 0.048);
  log.Add({.motion = &planned, .from = 0.0, .travelled = 4.0});
  EXPECT_EQ(log.corners().stops, 0u);
  log.Add({.motion = &planned, .from = 4.0, .travelled = 10.0});
  EXPECT_EQ(log.corners().stops, 1u);
  log.Add({.motion = &planned, .from = 10.0, .travelled = 10.0});  // its settling
  EXPECT_EQ(log.corners().stops, 1u);
  planned.ends_move = false;
  log.Add({.motion = &planned, .travelled = 10.0});
  EXPECT_EQ(log.corners().stops, 1u);
  motion::PlannedMotion standing = Planned(LineFrom({10, 0, 0}, {10, 0, 0}));
  log.Add({.motion = &standing});
  EXPECT_EQ(log.corners().stops, 2u);  // no way at all is a move, too
}

}  // namespace
}  // namespace rmlcell::simulation
