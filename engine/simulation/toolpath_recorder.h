#pragma once

#include <cstdint>
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
  // What makes one run of motions: as long as it stays the same and time goes on without a pause,
  // straight neighbours are merged.
  struct Key {
    int program = 0;
    int step = 0;
    machine::MotionUse use = machine::MotionUse::kTravel;
    bool beam_on = false;
    int speed_class = 0;
    bool operator==(const Key&) const = default;
  };
  // The straight stretch that the last vertex belongs to.
  struct Stretch {
    motion::Vec3 anchor;     // its first vertex
    motion::Vec3 direction;  // unit; zero while nothing was merged
    motion::Vec3 last;       // its last vertex, which is the last point of the block
    bool open = false;       // false: the last vertex stays, whatever comes
  };

  void Vertex(const motion::Vec3& tip, SimTime at);
  bool Merges(const motion::Vec3& tip);
  void DropEmptyRun();
  void OpenRun(const Key& key, const motion::Vec3& first, std::int64_t start_us);
  void Flush();
  int SpeedClassOf(const machine::MotionDone& done) const;

  double speed_max_mm_s_;
  double chord_tolerance_mm_;
  double merge_tolerance_mm_;
  std::uint64_t bytes_max_;
  ToolpathSink sink_;
  ToolpathBlock block_;
  Key key_;
  Stretch stretch_;
  bool run_open_ = false;
  std::uint64_t points_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t blocks_ = 0;
  bool closed_ = false;
};

}  // namespace rmlcell::simulation
