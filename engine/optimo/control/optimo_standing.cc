#include "engine/optimo/control/optimo_standing.h"

#include <algorithm>

#include "engine/motion/kinematics/kinematics.h"
#include "engine/optimo/control/modal_values.h"
#include "engine/optimo/control/state_items.h"
#include "engine/optimo/handbox/override_steps.h"
#include "engine/optimo/machine/situation.h"

namespace rmlcell::optimo {
machine::RunState OptimoStanding::state() const {
  machine::RunState state;
  state.phase = machine::RunPhase::kFinished;
  state.axes = s_.axes;
  state.tip = HeadOf(s_.tool, parameters_).TipOf(s_.axes);
  state.zeroed = s_.zeroed;
  state.door_open = s_.door_open;
  return state;
}

void OptimoStanding::WriteVariable(std::string_view name, double value) {
  const std::optional<Variable> variable = VariableNamed(name);
  if (!variable) return;
  const Result<float> number = Writable(*variable, value, parameters_);
  if (!number) return;
  const std::size_t n = variable->index;
  const bool on = *number != 0.0F;
  switch (variable->group) {
    case VariableGroup::kVr:
      s_.data.vr[n] = *number;
      break;
    case VariableGroup::kVi:
      s_.data.vi[n] = *number;
      break;
    case VariableGroup::kVl:
      s_.data.vl[n] = on;
      break;
    case VariableGroup::kOl: {
      s_.data.ol[n] = on;
      const bool other_gas =
          (n == kGas2 && s_.outputs.logical[kGas3]) || (n == kGas3 && s_.outputs.logical[kGas2]);
      if (!on || !other_gas) s_.outputs.logical[n] = on;
      break;
    }
    case VariableGroup::kOa:
      s_.data.oa[n] = *number;
      s_.outputs.analogue[n] = *number;
      break;
    default:
      break;  // not Writable
  }
}

std::vector<machine::ModalValue> OptimoStanding::modal_values() const {
  return ModalValuesOf(s_.tool, s_.work_offset);
}

// How high stands what is on the table nobody but a person knows.
std::vector<machine::StateItem> OptimoStanding::items() const {
  std::vector<machine::StateItem> items = ItemsOf(s_);
  items.push_back({"clamps", "not known", machine::StartAction::kAsk});
  return items;
}

void OptimoStanding::SelectProgram() {
  s_.data.vi[98] = 0.0F;
  s_.selected = 0;
}

void OptimoStanding::SetModal(std::string_view name, std::span<const double> values) {
  constexpr std::size_t kValues = 6;
  const bool all = values.size() == kValues;
  if (name == "TCP" && all) {
    s_.tool.offset = {.x_mm = values[0], .y_mm = values[1], .z_mm = values[2]};
    std::copy_n(values.begin() + 3, 3, s_.tool.reference.begin());
  } else if (name == "SYSDEF") {
    s_.work_offset = {.active = all};
    if (all) std::copy_n(values.begin(), kValues, s_.work_offset.values.begin());
  }
}

void OptimoStanding::Apply(const machine::InputChange& input) {
  const auto index = static_cast<std::size_t>(std::clamp(input.index, 0, kVariableIndexMax));
  switch (input.kind) {
    case machine::InputKind::kLogical:
      s_.data.il_physical[index] = input.value != 0.0;
      break;
    case machine::InputKind::kAnalogue:
      s_.data.ia_physical[index] = static_cast<float>(input.value);
      break;
    case machine::InputKind::kDoor:
      s_.door_open = input.value != 0.0;
      break;
    default:
      break;
  }
}

std::optional<machine::HandMotion> OptimoStanding::ByHand(double override_percent,
                                                          bool /*fast*/) const {
  const motion::MachineLimits& limits = parameters_.limits;
  machine::HandMotion how;
  how.machine = {.head = HeadOf(s_.tool, parameters_),
                 .axes = limits.axes,
                 .tip_acceleration_mm_s2 = limits.tip_acceleration_mm_s2,
                 .tip_jerk_mm_s3 = limits.tip_jerk_mm_s3};
  how.plus.head<3>().setConstant(limits.tip_speed_mm_s);
  how.plus.tail<2>() = limits.axes.speed.tail<2>();
  how.plus *= JogShareOf(override_percent);
  how.minus = how.plus;
  how.tool_z_down = s_.tool.offset.z_mm < s_.tool.reference[2];  // OPT-4.55
  return how;
}

void OptimoStanding::CyclePower() {
  s_.zeroed = false;
  s_.data.il = s_.data.ol = {};
  s_.data.ia = s_.data.oa = {};
  s_.outputs.logical = {};
  s_.outputs.analogue = {};
  s_.outputs.schedule = 0;
  s_.tool = {};
  s_.breakpoint.reset();
  s_.simul.reset();
}

}  // namespace rmlcell::optimo
