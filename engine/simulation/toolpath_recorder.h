#pragma once

#include <functional>
#include <string_view>

#include "engine/machine/shape.h"
#include "engine/simulation/toolpath.h"

namespace rmlcell::simulation {

struct ToolpathOptions {
  double tolerance_mm =
      0.01;  // greatest distance between path and polyline, besides 1 um of rounding
  std::uint64_t bytes_max = 256ull << 20;  // about forty million points; a viewer takes no more
};
inline constexpr double kToolpathToleranceMin_mm =
    0.001;  // below it arcs would get points for nothing
inline constexpr double kToolpathToleranceMax_mm = 10.0;

// Takes one encoded block; the bytes are valid during the call. False: no more.
using ToolpathSink = std::function<bool(std::string_view block)>;

// Turns the motions of a run into blocks, in memory of one block.
class ToolpathRecorder final : public machine::RunObserver {
 public:
  // Precondition: `sink` is not empty; the tolerance is clamped to its range.
  ToolpathRecorder(const machine::MachineShape& shape, ToolpathOptions options, ToolpathSink sink);

  void OnMotion(const machine::MotionDone& done) override;

  // Once, when the run is over: hands out what is left.
  void Finish();

  std::uint64_t points() const { return points_; }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t blocks() const { return blocks_; }
  bool complete() const { return !closed_; }

 private:
  void AddPoint(const motion::Vec3& tip);
  void Flush();

  machine::MachineShape shape_;
  ToolpathOptions options_;
  ToolpathSink sink_;
  ToolpathBlock block_;
  std::uint64_t points_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t blocks_ = 0;
  bool closed_ = false;
};

}  // namespace rmlcell::simulation
