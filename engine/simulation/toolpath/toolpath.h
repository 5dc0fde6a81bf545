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

inline constexpr int kToolpathVersion = 1;
inline constexpr std::size_t kToolpathBlockPoints = 4096;  // a block decodes into 48 KiB of points
inline constexpr int kSpeedClasses = 20;                   // of 5 % of the highest tip speed each

// Integers of 1 micrometre: a micrometre is below what any of the machines resolves.
struct ToolpathPoint {
  std::int32_t x_um = 0;
  std::int32_t y_um = 0;
  std::int32_t z_um = 0;

  bool operator==(const ToolpathPoint&) const = default;
};

// A stretch of path of one step, use, beam state and speed class.
struct ToolpathRun {
  int program = 0;
  int step = 0;
  machine::MotionUse use = machine::MotionUse::kTravel;
  bool beam_on = false;
  int speed_class = 0;  // 1..20: feed rate asked for, in steps of 5 %; 0: as fast as the axes can
  std::int64_t start_us = 0;      // virtual time at the first point, in whole microseconds
  std::int64_t end_us = 0;        // at the last point
  std::uint32_t first_point = 0;  // index into ToolpathBlock::points
  std::uint32_t point_count = 0;  // 2 or more; the first may be the last point of the run before

  bool operator==(const ToolpathRun&) const = default;
};

// What a block holds. Blocks can be decoded each by itself, in any order.
struct ToolpathBlock {
  std::vector<ToolpathPoint> points;  // at most kToolpathBlockPoints
  std::vector<ToolpathRun> runs;      // in order of time; points of neighbours may be shared
};

// Any bytes are safe: what is not a block is refused, memory is bounded by kToolpathBlockPoints.
// Errors: CellToolpathCorrupt (9027).
Result<ToolpathBlock> DecodeToolpathBlock(std::string_view bytes);

// Precondition: the block is as DecodeToolpathBlock gives it. The same block gives the same bytes.
std::string EncodeToolpathBlock(const ToolpathBlock& block);

}  // namespace rmlcell::simulation
