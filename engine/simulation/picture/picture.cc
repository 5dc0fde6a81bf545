#include "engine/simulation/picture/picture.h"

#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_page.h"

namespace rmlcell::simulation {

struct PictureRecorder::State {
  explicit State(const machine::MachineShape& machine_shape)
      : shape(machine_shape), sketch(machine_shape, kSketchElementsMax) {}

  machine::MachineShape shape;
  PathSketch sketch;
  bool beam_on = false;
  bool stands_since_beam_on = false;
};

PictureRecorder::PictureRecorder(const machine::MachineShape& shape)
    : state_(std::make_unique<State>(shape)) {}

PictureRecorder::~PictureRecorder() = default;

void PictureRecorder::OnMotion(const machine::MotionDone& done) {
  PartShape shape({done.motion->path, done.motion->head, done.from, done.travelled});
  Add(done, shape);
}

void PictureRecorder::Add(const machine::MotionDone& done, PartShape& shape) {
  state_->sketch.Add(done, shape);
  state_->stands_since_beam_on = false;
}

void PictureRecorder::OnLost(const machine::LostWay& way) { state_->sketch.AddLost(way); }

void PictureRecorder::OnSignal(const machine::SignalChange& change) {
  if (change.signal != machine::Signal::kBeam) return;
  const bool on = change.value != 0.0;
  if (on && !state_->beam_on) state_->stands_since_beam_on = true;
  state_->beam_on = on;
}

void PictureRecorder::OnWait(const machine::Wait& wait) {
  // A pierce, as the report counts it.
  const bool pierces = wait.kind == machine::WaitKind::kPierce ||
                       (wait.kind == machine::WaitKind::kDwell && state_->stands_since_beam_on);
  if (wait.beam_on && pierces && wait.end > wait.start) state_->sketch.AddPierce();
  state_->stands_since_beam_on = false;
}

std::string PictureRecorder::Svg(const RunReport& report, const PictureOptions& options) const {
  return PicturePage(state_->sketch, state_->shape, report, options);
}

std::uint64_t PictureRecorder::elements() const { return state_->sketch.elements().size(); }

const PathSketch& PictureRecorder::sketch() const { return state_->sketch; }

bool PictureRecorder::exact() const { return state_->sketch.tolerance_mm() == 0.0; }

}  // namespace rmlcell::simulation
