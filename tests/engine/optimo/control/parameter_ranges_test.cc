#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/laser_unit.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/ride/motion_place.h"

// What a machine can be set to: both ends of each range are allowed, what is beyond is not. A
// machine that is stored with such a value stays usable.
namespace rmlcell::optimo::testing::parameter_ranges {
namespace {

struct Range {
  const char* name;
  double low, high;
};

constexpr Range kRanges[] = {{"VMAX", 1, 2000},
                             {"AMAX", 10, 50'000},
                             {"JMAX", 100, 10'000'000},
                             {"AXIS_SPEED_X", 1, 5000},
                             {"AXIS_SPEED_Y", 1, 5000},
                             {"AXIS_SPEED_Z", 1, 5000},
                             {"AXIS_SPEED_A", 0.01, 100},
                             {"AXIS_SPEED_B", 0.01, 100},
                             {"AXIS_ACCEL_X", 10, 50'000},
                             {"AXIS_ACCEL_Y", 10, 50'000},
                             {"AXIS_ACCEL_Z", 10, 50'000},
                             {"AXIS_ACCEL_A", 0.1, 1000},
                             {"AXIS_ACCEL_B", 0.1, 1000},
                             {"AXIS_JERK_X", 100, 10'000'000},
                             {"AXIS_JERK_Y", 100, 10'000'000},
                             {"AXIS_JERK_Z", 100, 10'000'000},
                             {"AXIS_JERK_A", 1, 100'000},
                             {"AXIS_JERK_B", 1, 100'000},
                             {"HEAD_LENGTH", 1, 2000},
                             {"TRAVEL_X_MIN", -100'000, 100'000},
                             {"TRAVEL_X_MAX", -100'000, 100'000},
                             {"TRAVEL_Y_MIN", -100'000, 100'000},
                             {"TRAVEL_Y_MAX", -100'000, 100'000},
                             {"TRAVEL_Z_MIN", -100'000, 100'000},
                             {"TRAVEL_Z_MAX", -100'000, 100'000},
                             {"TRAVEL_A_MIN", -1000, 1000},
                             {"TRAVEL_A_MAX", -1000, 1000},
                             {"TRAVEL_B_MIN", -1000, 1000},
                             {"TRAVEL_B_MAX", -1000, 1000},
                             {"HOME_X", -100'000, 100'000},
                             {"HOME_Y", -100'000, 100'000},
                             {"HOME_Z", -100'000, 100'000},
                             {"HOME_A", -1000, 1000},
                             {"HOME_B", -1000, 1000},
                             {"MECH_ZERO_X", -100'000, 100'000},
                             {"MECH_ZERO_Y", -100'000, 100'000},
                             {"MECH_ZERO_Z", -100'000, 100'000},
                             {"MECH_ZERO_A", -1000, 1000},
                             {"MECH_ZERO_B", -1000, 1000},
                             {"SAFE_Z", -100'000, 100'000},
                             {"CYCLE", 0.001, 1},
                             {"SETTLE", 0, 1},
                             {"GAS_CHANNELS", 2, 3},
                             {"OBJECT_LIMIT", 100, 10'000'000},
                             {"EXECUTABLE_LIMIT", 100, 10'000'000},
                             {"CMOS_SIZE", 1000, 1e12},
                             {"GOSUB_DEPTH", 1, 1000},
                             {"CALL_TIME", 0, 600},
                             {"SCHEDULES", 0, 63},
                             {"LASER_POWER", 1, 100'000}};

// OPT-B.01: every number of the machine has its range.
TEST(ParameterRanges, BothEndsAreAllowed) {
  int numbers = 0;
  for (const machine::ParameterInfo& info : OptimoParameterTable()) {
    numbers += info.choices.empty() ? 1 : 0;
    if (!info.choices.empty()) {
      EXPECT_EQ(info.standard + info.minimum + info.maximum, 0.0) << info.name;
    }
    EXPECT_TRUE(info.rule.starts_with("OPT-") || info.rule.starts_with("motion.md") ||
                info.rule.starts_with("LIVE-"))
        << info.name;
    EXPECT_NE(info.text.find(' '), std::string_view::npos) << info.name;
  }
  EXPECT_EQ(numbers, static_cast<int>(std::size(kRanges)));
  for (const Range& range : kRanges) {
    machine::Parameters parameters(OptimoParameterTable());
    const double span = range.high - range.low;
    SCOPED_TRACE(range.name);
    EXPECT_TRUE(parameters.Set(range.name, range.low).ok());
    EXPECT_EQ(parameters.Number(range.name), range.low);
    EXPECT_TRUE(parameters.Set(range.name, range.high).ok());
    EXPECT_EQ(parameters.Number(range.name), range.high);
    EXPECT_FALSE(parameters.Set(range.name, range.low - 1e-7 * span).ok());
    EXPECT_FALSE(parameters.Set(range.name, range.high + 1e-7 * span).ok());
    EXPECT_EQ(parameters.Number(range.name), range.high);
  }
}

// OPT-3.39: at the programmed speed the programmed power: 75 % at 8 % of 500 mm/s.
TEST(ParameterRanges, TheRampOfAProcess) {
  const machine::PowerBySpeed power =
      RampedPower({.speed_percent = 8.0, .power_percent = 75.0}, 500.0);
  EXPECT_EQ(power.constant_percent, 0.0);
  EXPECT_NEAR(power.percent_per_mm_s * 40.0, 75.0, 1e-9);
}

// OPT-3.37, OPT-3.33: a flag is on with a process of its number of whatever kind; any of them
// counts.
TEST(ParameterRanges, FlagsOfProcesses) {
  for (int kind = 0; kind < kProcessKinds; ++kind) {
    for (int p = 0; p < kProcessesPerKind; ++p) {
      Processes processes;
      EXPECT_FALSE(processes.any_on());
      processes.on[static_cast<std::size_t>(kind)][static_cast<std::size_t>(p)] = true;
      EXPECT_TRUE(processes.any_on());
      for (int q = 0; q < kProcessesPerKind; ++q) EXPECT_EQ(processes.flag(q), q == p);
      processes.AllOff();
      EXPECT_FALSE(processes.any_on());
    }
  }
}

motion::TipPose Tip(double x, double y, double a = 0.0, double b = 0.0) {
  return {.tip = {x, y, -400.0}, .a_rad = a, .b_rad = b};
}

// Where a part of a move lies on it: on a line by its length, on an arc by the angle from its
// start, whichever way round, also behind its half; in axes by the axis that goes farthest.
TEST(ParameterRanges, PartsAreFoundOnTheirMoves) {
  const motion::PathPiece line = motion::PathPiece::Line(Tip(0, 0), Tip(30, 40));
  std::vector<motion::PathPiece> moves{line};
  for (const auto& [via, to] :
       {std::pair{Tip(200, 0), Tip(100, -100)}, std::pair{Tip(100, -100), Tip(200, 0)},
        std::pair{Tip(100, -100), Tip(100, 100)}}) {
    const auto arc = motion::PathPiece::ArcThrough(Tip(0, 0), via.tip, to);
    ASSERT_TRUE(bool(arc));
    moves.push_back(arc->path);
  }
  for (int axis = 0; axis < 5; ++axis) {
    for (const double way : {8.0, -8.0}) {
      double v[] = {1.0, 1.0, 1.0, 1.0, 1.0};
      v[axis] = way;
      moves.push_back(motion::PathPiece::Joint(
          {.column = {5, 6, 7}, .a_rad = 0.5, .b_rad = -0.5},
          {.column = {5 + v[0], 6 + v[1], 7 + v[2]}, .a_rad = 0.5 + v[3], .b_rad = -0.5 + v[4]}));
    }
  }
  for (const motion::PathPiece& move : moves) {
    const double length = move.length();
    for (const double begin : {0.0, 0.2, 0.45, 0.7, 0.9}) {
      motion::PathPiece part = move.Part(begin * length, 0.95 * length);
      const std::optional<PlaceOnMove> place = PlaceOf(part, move);
      ASSERT_TRUE(place.has_value());
      EXPECT_NEAR(place->begin, begin * length, 1e-9 * length);
      EXPECT_NEAR(place->scale, 1.0, 1e-9);
      const motion::PathPiece rest = RestOfMove(move, *place, 0.01 * length);
      EXPECT_NEAR(rest.length(), (0.99 - begin) * length, 1e-9 * length);
      EXPECT_NEAR((move.to().point - rest.to().point).norm(), 0.0, 1e-9);
      EXPECT_NEAR((move.At((begin + 0.01) * length).point - rest.from().point).norm(), 0.0, 1e-6);
      if (!move.in_axes()) continue;
      // The same part, measured by twice as much.
      part.MeasureBy(2.0 * part.length());
      const std::optional<PlaceOnMove> measured = PlaceOf(part, move);
      ASSERT_TRUE(measured.has_value());
      EXPECT_NEAR(measured->begin, begin * length, 1e-9 * length);
      EXPECT_NEAR(measured->scale, 0.5, 1e-9);
      const motion::PathPiece half = RestOfMove(move, *measured, 0.02 * length);
      EXPECT_NEAR(half.length(), 2.0 * (0.99 - begin) * length, 1e-9 * length);
      EXPECT_NEAR((move.At((begin + 0.01) * length).point - half.from().point).norm(), 0.0, 1e-6);
    }
  }
  // Of another kind, or of no length: there is no such place.
  EXPECT_FALSE(PlaceOf(moves[1], line).has_value());
  EXPECT_FALSE(PlaceOf(line.Standing(1.0), line).has_value());
}

}  // namespace
}  // namespace rmlcell::optimo::testing::parameter_ranges
