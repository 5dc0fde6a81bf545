#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/observer.h"

// The tip's way as a compact polyline for viewers. Layout of the bytes: docs/toolpath.md.
// motion.md section 9.
namespace rmlcell::simulation {

inline constexpr int kToolpathVersion = 2;
inline constexpr std::size_t kToolpathBlockPoints = 4096;  // a block decodes into 112 KiB of points
inline constexpr int kSpeedClasses = 20;                   // of 5 % of the highest tip speed each
inline constexpr int kPowerClasses = 20;                   // of 5 % of the rated power each
// Times that are proportional to the way are left out where that is no farther off.
inline constexpr std::int64_t kToolpathTimeTolerance_us = 1000;

// Integers of 1 micrometre and of 1 microradian: below what any of the machines resolves.
struct ToolpathPoint {
  std::int32_t x_um = 0;
  std::int32_t y_um = 0;
  std::int32_t z_um = 0;
  std::int32_t a_urad = 0;  // of the axes that turn
  std::int32_t b_urad = 0;

  bool operator==(const ToolpathPoint&) const = default;
};

// A stretch of path of one step, use, beam state, speed and power class.
struct ToolpathRun {
  int program = 0;
  int step = 0;
  machine::MotionUse use = machine::MotionUse::kTravel;
  bool beam_on = false;
  int speed_class = 0;    // 1..20: feed rate asked for, in steps of 5 %; 0: as fast as the axes can
  int power_class = 0;    // 1..20: power of the beam, in steps of 5 %; 0: it is off
  int reached_class = 0;  // 1..20: highest speed of the tip, as speed_class; 0: not known
  std::int64_t start_us = 0;      // virtual time at the first point, in whole microseconds
  std::int64_t end_us = 0;        // at the last point
  std::uint32_t first_point = 0;  // index into ToolpathBlock::points
  std::uint32_t point_count = 0;  // 2 or more; the first may be the last point of the run before

  bool operator==(const ToolpathRun&) const = default;
};

// What a block holds. Blocks can be decoded each by itself, in any order.
struct ToolpathBlock {
  std::vector<ToolpathPoint> points;  // at most kToolpathBlockPoints
  // When each point is reached. Of a point that two runs share: by the first of them.
  std::vector<std::int64_t> reached_us;
  std::vector<ToolpathRun> runs;  // in order of time; points of neighbours may be shared
};

// Any bytes are safe: what is not a block is refused, memory is bounded by kToolpathBlockPoints.
// Errors: CellToolpathCorrupt (9027).
Result<ToolpathBlock> DecodeToolpathBlock(std::string_view bytes);

// When the point `k` of a run is reached, from 0.
inline std::int64_t TimeOf(const ToolpathBlock& block, const ToolpathRun& run, std::uint32_t k) {
  return k == 0 ? run.start_us : block.reached_us[run.first_point + k];
}

// Precondition: the block is as DecodeToolpathBlock gives it. The same block gives the same bytes.
std::string EncodeToolpathBlock(const ToolpathBlock& block);

}  // namespace rmlcell::simulation
