#pragma once

#include <cstdint>
#include <string>

#include "engine/machine/shape.h"
#include "engine/simulation/path/part_shape.h"
#include "engine/simulation/toolpath/toolpath_writer.h"

namespace rmlcell::simulation {

struct ToolpathOptions {
  double tolerance_mm =
      0.01;  // greatest distance between path and polyline, besides 1 um of rounding
  std::uint64_t bytes_max = 256ull << 20;  // about forty million points; a viewer takes no more
};
inline constexpr double kToolpathToleranceMin_mm =
    0.001;  // below it arcs would get points for nothing
inline constexpr double kToolpathToleranceMax_mm = 10.0;

// The tolerance that a recorder works to when it is given this one.
double ToolpathTolerance_mm(double wanted_mm);

// Turns the motions of a run into blocks, in memory of one block.
class ToolpathRecorder final : public machine::RunObserver {
 public:
  // Precondition: `sink` is not empty; the tolerance is clamped to its range.
  ToolpathRecorder(const machine::MachineShape& shape, ToolpathOptions options, ToolpathSink sink);

  void OnMotion(const machine::MotionDone& done) override;
  // The same for who has the shape of what was ridden.
  void Add(const machine::MotionDone& done, PartShape& shape);

  // Once, when the run is over: hands out what is left.
  void Finish();

  // What is not handed out yet, as a block.
  std::string OpenBlock() const { return writer_.OpenBlock(); }

  std::uint64_t points() const { return writer_.points(); }
  std::uint64_t bytes() const { return writer_.bytes(); }
  std::uint64_t blocks() const { return writer_.blocks(); }
  bool complete() const { return !writer_.closed(); }

 private:
  // The straight stretch that the last vertex belongs to.
  struct Stretch {
    motion::MachinePoint anchor;      // its first vertex
    motion::MachineVector direction;  // unit; zero while nothing was merged
    motion::MachinePoint last;        // its last vertex, which is the last point of the block
    bool open = false;                // false: the last vertex stays, whatever comes
    bool turns = false;               // A or B turn along it
  };

  void Vertex(const motion::MachinePoint& tip, const ToolpathPoint& point, SimTime at);
  bool Merges(const motion::MachinePoint& tip, const ToolpathPoint& point);
  int SpeedClassOf(double mm_s) const;

  double speed_max_mm_s_;
  double chord_tolerance_mm_;
  double merge_tolerance_mm_;
  ToolpathWriter writer_;
  Stretch stretch_;
};

}  // namespace rmlcell::simulation
