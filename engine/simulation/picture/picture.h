#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/report/report.h"

// Pictures of a run as SVG, drawn from the exact path: an arc of the program is an arc of the
// picture.
namespace rmlcell::simulation {

class PartShape;
class PathSketch;

// Path elements kept while a run goes on: 2 MB, and as much while they are drawn. Longer programs
// are drawn coarser, by a tolerance that is below a pixel for all but fillings.
inline constexpr std::size_t kSketchElementsMax = 20'000;
// Elements written to a picture: a browser draws this many smoothly.
inline constexpr std::size_t kPictureElementsMax = 200'000;

enum class PictureView { kXY, kXZ, kYZ, kDirection };

struct PictureOptions {
  // Up to four. Empty: XY for a mill; XY, direction, XZ and YZ for a machine with five axes.
  std::vector<PictureView> views;
  motion::MachineVector direction{1.0, -1.0, 0.8};  // of kDirection: from the part towards the eye
  int width_px = 1600;  // of the whole picture; its height follows. Below 640 all of it is smaller
  bool machine_frame = false;  // rulers count from the zero of the machine, not of the work
};

// Collects what a picture needs, in bounded memory.
class PictureRecorder final : public machine::RunObserver {
 public:
  explicit PictureRecorder(const machine::MachineShape& shape);
  ~PictureRecorder() override;

  void OnMotion(const machine::MotionDone& done) override;
  // The same for who has the shape of what was ridden.
  void Add(const machine::MotionDone& done, PartShape& shape);
  void OnLost(const machine::LostWay& way) override;
  void OnWait(const machine::Wait& wait) override;
  void OnSignal(const machine::SignalChange& change) override;

  // A standalone SVG document: no script, nothing from outside. Title and notes come from the
  // report.
  std::string Svg(const RunReport& report, const PictureOptions& options) const;

  std::uint64_t elements() const;
  const PathSketch& sketch() const;
  bool exact() const;  // false: drawn coarser because of kSketchElementsMax

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rmlcell::simulation
