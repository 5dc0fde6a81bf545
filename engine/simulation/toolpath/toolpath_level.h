#pragma once

#include <cstdint>

#include "engine/motion/geometry/frames.h"
#include "engine/simulation/toolpath/toolpath_writer.h"

// Levels of detail of a toolpath: each has eight times the tolerance of the one before. motion.md
// section 9.
namespace rmlcell::simulation {

inline constexpr int kToolpathLevelMax = 5;  // 0.01 mm becomes 328 mm: a dot
inline constexpr double kToolpathLevelFactor = 8.0;

// The greatest distance between path and polyline at `level`, when that of level 0 is `stored_mm`.
double LevelTolerance(double stored_mm, int level);

// Makes a toolpath coarser, in one pass and in memory of a block. Runs that follow each other
// without pause are joined where program, purpose, beam and speed class are the same: the joined
// one has the step of the first. Where one of these changes, the point stays.
class ToolpathLevel {
 public:
  // No point of the way moves by more than `tolerance_mm` away from the polyline, nor does a point
  // of the polyline lie farther than that from the way.
  ToolpathLevel(double tolerance_mm, ToolpathSink sink);

  void Take(const ToolpathBlock& block);
  void Finish();

 private:
  struct Vertex {
    ToolpathPoint point;
    std::int64_t at_us = 0;
  };

  void Follow(const ToolpathRun& run, const ToolpathBlock& block);
  void Add(const Vertex& next);
  bool Reaches(const motion::MachineVector& way) const;
  void Narrow(const motion::MachineVector& way);
  void Keep();
  void Close();

  double tolerance_um_;
  ToolpathWriter writer_;
  ToolpathRun run_;
  bool open_ = false;
  Vertex last_;           // the last one of the way
  ToolpathPoint anchor_;  // the last one that was kept
  bool moved_ = false;    // last_ is beyond anchor_
  // Directions from the anchor in which a line passes all that was left out: a cone. Half angle
  // below zero: any.
  motion::MachineVector axis_;
  double half_angle_rad_ = -1.0;
  double farthest_um_ = 0.0;  // of what was left out, from the anchor
};

}  // namespace rmlcell::simulation
