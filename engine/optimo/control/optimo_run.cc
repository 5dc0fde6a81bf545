#include "engine/optimo/control/optimo_run.h"

namespace rmlcell::optimo {
namespace {

class Snapshot final : public machine::RunSnapshot {
 public:
  explicit Snapshot(ControlState saved) : state(std::move(saved)) {}
  ControlState state;
};

}  // namespace

std::unique_ptr<machine::RunSnapshot> OptimoRun::Save() const {
  return std::make_unique<Snapshot>(control_.state());
}

void OptimoRun::Restore(const machine::RunSnapshot& snapshot) {
  const auto* own = dynamic_cast<const Snapshot*>(&snapshot);
  RMLCELL_CHECK(own != nullptr);
  control_.Restore(own->state);
}

std::vector<machine::ApproachMotion> OptimoRun::PlanApproach(std::string_view machine_state,
                                                             machine::ApproachWay way) const {
  const Result<MachineState> now = DecodeMachineState(machine_state);
  RMLCELL_CHECK(now);
  return control_.PlanApproach(*now, way);
}

void OptimoRun::Enter(const machine::EntryOrder& order) {
  const Result<MachineState> now = DecodeMachineState(order.machine_state);
  RMLCELL_CHECK(now);
  control_.Enter(*now, order);
}

}  // namespace rmlcell::optimo
