#include "engine/optimo/control/state_items.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "engine/core/indices.h"
#include "engine/core/number_text.h"
#include "engine/optimo/control/modal_values.h"

namespace rmlcell::optimo {
namespace {

using machine::StartAction;
using machine::StateItem;

// Motions arrive within rounding of where they go.
std::string PlaceText(double value) { return ShortestText(std::round(value * 1e6) / 1e6 + 0.0); }

std::string PoseText(const motion::AxisPose& axes) {
  return "X " + PlaceText(axes.column.x()) + " Y " + PlaceText(axes.column.y()) + " Z " +
         PlaceText(axes.column.z()) + " A " + PlaceText(axes.a_rad) + " B " + PlaceText(axes.b_rad);
}

std::string ValueText(float value) { return ShortestText(static_cast<double>(value)); }
std::string ValueText(bool value) { return value ? "1" : "0"; }

class Items {
 public:
  void Add(std::string name, std::string value, StartAction action = StartAction::kSet) {
    items_.push_back({std::move(name), std::move(value), action});
  }
  template <class Values>
  void AddAll(std::string_view group, const Values& values, StartAction action) {
    for (const std::size_t n : IndicesOf(values))
      Add(std::string(group) + "[" + std::to_string(n) + "]", ValueText(values[n]), action);
  }
  void Add(std::vector<machine::ModalValue> values) {
    for (machine::ModalValue& value : values) Add(std::move(value.name), std::move(value.value));
  }
  std::vector<StateItem> Take() { return std::move(items_); }

 private:
  std::vector<StateItem> items_;
};

int GasOf(const Bits& outputs) { return outputs[kGas3] ? 3 : outputs[kGas2] ? 2 : 1; }

// "FUNCTION or program / step", the outermost first.
std::string StackText(std::span<const machine::Place> stack) {
  std::string text;
  for (const machine::Place& place : stack) {
    text += (text.empty() ? "" : " ") + std::to_string(place.program) + "/" +
            std::to_string(place.step);
  }
  return text;
}

std::string WorkText(const WorkDefinition& definition) {
  return PlaceText(definition.speed_percent) + ", " + PlaceText(definition.power_percent) + ", " +
         PlaceText(definition.delay_s) + ", " + PlaceText(definition.peak_percent) + ", " +
         std::to_string(definition.schedule);
}

// What waits for it has its own of all this: `prefix` tells which one.
void AddProgram(const ProgramContext& program, const std::string& prefix, SimTime now,
                Items& items) {
  for (machine::ModalValue& value : ModalValuesOf(program.modal))
    items.Add(prefix + value.name, std::move(value.value));
  std::string handlers;
  for (const std::size_t n : IndicesOf(program.frames)) {
    const Frame& frame = program.frames[n];
    handlers += (handlers.empty() ? "" : ", ") +
                (frame.error_label ? std::to_string(*frame.error_label) : std::string("OFF"));
    const std::string level = n == 0 ? "" : " of FUNCTION level " + std::to_string(n);
    for (const std::size_t i : IndicesOf(frame.parameters)) {
      if (frame.parameters[i] == 0.0F) continue;  // as all are that nobody passed
      items.Add(prefix + "PAR[" + std::to_string(i) + "]" + level, ValueText(frame.parameters[i]));
    }
  }
  items.Add(prefix + "ERR", handlers);
  std::string timer = "OFF";
  if (program.timer) {
    const SimTime left = program.timer->left.value_or(program.timer->due - now);
    timer = std::to_string(program.timer->label) + " in " + ShortestText(ToSeconds(left)) + " s";
    if (program.timer->repeats)
      timer += ", each " + ShortestText(ToSeconds(program.timer->period)) + " s";
  }
  items.Add(prefix + "TIMER", timer);
  std::string on;
  for (const std::size_t kind : IndicesOf(program.processes.on)) {
    for (const std::size_t p : IndicesOf(program.processes.on[kind])) {
      const std::string name = std::to_string(kind) + "," + std::to_string(p);
      const auto& definition = program.processes.definitions[kind][p];
      if (definition) items.Add(prefix + "WORKDEF " + name, WorkText(*definition));
      if (program.processes.on[kind][p]) on += (on.empty() ? "" : " ") + name;
    }
  }
  items.Add(prefix + "WORK", on.empty() ? "OFF" : on);
}

}  // namespace

std::vector<StateItem> ItemsOf(const MachineState& state) {
  Items items;
  items.Add("pose", PoseText(state.axes), StartAction::kMove);
  items.Add(ModalValuesOf(state.tool, state.work_offset));
  items.Add("schedule", std::to_string(state.outputs.schedule), StartAction::kSwitch);
  items.Add("gas", std::to_string(GasOf(state.outputs.logical)), StartAction::kSwitch);
  items.Add("table", PlaceText(state.outputs.table_deg), StartAction::kAsk);
  items.AddAll("VR", state.data.vr, StartAction::kSet);
  items.AddAll("VI", state.data.vi, StartAction::kSet);
  items.AddAll("VL", state.data.vl, StartAction::kSet);
  items.AddAll("IL", state.data.il, StartAction::kSet);
  items.AddAll("OL", state.data.ol, StartAction::kSet);
  items.AddAll("IA", state.data.ia, StartAction::kSet);
  items.AddAll("OA", state.data.oa, StartAction::kSet);
  items.AddAll("input IL", state.data.il_physical, StartAction::kNone);
  items.AddAll("input IA", state.data.ia_physical, StartAction::kNone);
  items.AddAll("output OL", state.outputs.logical, StartAction::kSwitch);
  items.AddAll("output OA", state.outputs.analogue, StartAction::kSwitch);
  return items.Take();
}

std::vector<StateItem> ItemsOf(std::span<const ProgramContext> programs,
                               std::span<const machine::Place> stack, SimTime now) {
  Items items;
  items.Add("stack", StackText(stack));
  AddProgram(programs.back(), "", now, items);
  for (const std::size_t n : IndicesOf(programs.first(programs.size() - 1)))
    AddProgram(programs[n], "caller " + std::to_string(n + 1) + " ", now, items);
  return items.Take();
}

}  // namespace rmlcell::optimo
