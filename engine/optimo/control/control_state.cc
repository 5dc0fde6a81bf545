#include "engine/optimo/control/control_state.h"

namespace rmlcell::optimo {

ControlState::ControlState(const OptimoParameters& parameters, const MachineState& kept)
    : ride(parameters.limits), actuators(parameters.laser) {
  situation.tool = kept.tool;
  situation.simulated_until = kept.simul;
  ride.axes = ride.planned_axes = kept.axes;
  actuators.outputs = kept.outputs;
  if (kept.door_open) actuators.beam = actuators.beam.DoorOpened();
  counter.selected = kept.selected;
  data.area = kept.data;
  halts.breakpoint = kept.breakpoint;
  moves.work_offset = kept.work_offset;
  moves.zeroed = actuators.zeroed = kept.zeroed;
}

MachineState ControlState::Kept() const {
  return {.data = data.area,
          .outputs = actuators.outputs,
          .axes = ride.axes,
          .tool = situation.tool,
          .work_offset = moves.work_offset,
          .zeroed = actuators.zeroed,
          .door_open = actuators.beam.door_open(),
          .selected = counter.selected,
          .breakpoint = halts.breakpoint,
          .simul = simul};
}

}  // namespace rmlcell::optimo
