#pragma once

#include <cstdint>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/path/part_shape.h"
#include "engine/simulation/picture/sketch_element.h"

namespace rmlcell::simulation {

struct SketchCircle {
  motion::MachinePoint centre;
  motion::MachineVector normal;  // unit; the arc runs counter-clockwise seen from its tip
  double radius_mm = 0.0;
  double sweep_rad = 0.0;
};

struct SketchDot {
  motion::MachinePoint at;
  bool pierce = false;  // else a plunge
};

// Where the tool pointed while it cut.
struct SketchTool {
  motion::MachinePoint tip;
  motion::MachineVector towards_head;  // unit
};

// The path of a run in bounded memory. Up to `elements_max` elements it is exact. After that it is
// made coarser again and again, to a tolerance that grows until half of the room is free: straight
// neighbours are merged, and what lies on top of something alike is dropped.
class PathSketch {
 public:
  PathSketch(const machine::MachineShape& shape, std::size_t elements_max);

  void Add(const machine::MotionDone& done);
  // The same for who has the shape of what was ridden.
  void Add(const machine::MotionDone& done, PartShape& shape);
  void AddPierce();  // where the tip is
  void AddLost(const machine::LostWay& way);

  const std::vector<SketchElement>& elements() const { return elements_; }
  const SketchCircle& circle(std::int32_t index) const {
    return circles_[static_cast<std::size_t>(index)];
  }
  const std::vector<SketchCircle>& circles() const { return circles_; }
  const std::vector<SketchDot>& dots() const { return dots_; }
  const std::vector<SketchTool>& tools() const { return tools_; }
  const machine::Box& box() const { return box_; }  // of everything, true extremes
  const machine::Box& cut_box() const { return cut_box_; }
  const machine::Box& lost_box() const { return lost_box_; }
  // Lines of the work that the machine left out, and their length in all.
  const std::vector<SketchElement>& lost() const { return lost_; }
  double lost_mm() const { return lost_mm_; }
  bool moved() const { return moved_; }
  // Strokes along the surface beside real cuts, which take nothing off: those of a pen alone are
  // what it draws.
  bool skims_beside_cuts() const { return skims_ && cuts_; }
  const motion::MachinePoint& start() const { return start_; }
  const motion::MachinePoint& end() const { return end_; }
  double tolerance_mm() const { return tolerance_mm_; }  // 0: exact

 private:
  void Push(const SketchElement& element);
  void PushCurve(PartShape& shape, SketchElement element);
  void AddDot(const SketchDot& dot);
  void AddTool(const machine::MotionDone& done);
  void Coarsen();
  void PackCircles();

  machine::MachineShape shape_;
  std::size_t elements_max_;
  std::vector<SketchElement> elements_;
  std::vector<SketchCircle> circles_;
  std::vector<SketchDot> dots_;
  std::vector<SketchTool> tools_;
  std::uint64_t tool_stride_ = 1;  // every n-th is kept
  std::uint64_t tool_count_ = 0;
  machine::Box box_;
  machine::Box cut_box_;
  machine::Box lost_box_;
  std::vector<SketchElement> lost_;
  double lost_mm_ = 0.0;
  double lost_tolerance_mm_ = 0.0;
  bool moved_ = false;
  bool skims_ = false;  // some element
  bool cuts_ = false;
  bool plunging_ = false;
  motion::MachinePoint start_;
  motion::MachinePoint end_;
  double tolerance_mm_ = 0.0;
};

}  // namespace rmlcell::simulation
