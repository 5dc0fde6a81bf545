#include "engine/optimo/control/optimo_run.h"

namespace rmlcell::optimo {
namespace {

class Snapshot final : public machine::RunSnapshot {
 public:
  explicit Snapshot(ControlState saved) : state(std::move(saved)) {}
  ControlState state;
};

}  // namespace

std::vector<machine::Figure> OptimoRun::figures() const {
  const ControlState& state = control_.state();
  return {{"lookahead_starved", "", static_cast<double>(state.ride.planner.lookahead_starved())},
          {"executables_made", "", static_cast<double>(state.counter.made_executables.size())}};
}

std::unique_ptr<machine::RunSnapshot> OptimoRun::Save() const {
  return std::make_unique<Snapshot>(control_.state());
}

void OptimoRun::Restore(const machine::RunSnapshot& snapshot) {
  const auto* own = dynamic_cast<const Snapshot*>(&snapshot);
  RMLCELL_CHECK(own != nullptr);
  control_.Restore(own->state);
}

}  // namespace rmlcell::optimo
