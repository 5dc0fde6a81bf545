#include "engine/rml1/variables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

std::string EscValues(const ReceivePath::Parameters& values, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ' ';
    text += values[i] ? std::to_string(*values[i]) : "default";
  }
  return text;
}

// Where a register is read from.
struct View {
  const Device& device;
  const Profile& profile;
  const ToolNow& tool;

  const Registers& registers() const { return device.registers(); }
  const Point& logical() const { return device.carriage().logical(); }
};

// Coordinates are 4-byte values: what is behind the sixth decimal is noise of theirs.
std::string NumberText(double value) { return ShortestText(std::round(value * 1e6) / 1e6); }

// Half away from zero (RML1-9.22); 0.025 / 0.05 is a half although the quotient is a bit less.
std::string StepsText(double value, double step) {
  const double count = value / step;
  return std::to_string(std::llround(count + std::copysign(1e-9, count)));
}

std::string MmSteps(const View& v, double units) {
  return StepsText(units * (1.0 / v.profile.units_per_mm), v.profile.step_mm);
}
std::string XySpeed(const View& v) { return NumberText(v.registers().xy_speed); }
std::string ZSpeed(const View& v) { return NumberText(v.registers().z_speed); }
std::string Dwell(const View& v) { return std::to_string(v.registers().dwell_ms); }

using machine::VariableKind;

struct Register {
  std::string_view name;
  VariableKind kind;
  std::string (*read)(const View&);
  bool of_rotary = false;  // only a machine with a rotary axis has it
};

constexpr std::array kRegisters = {
    Register{"X", VariableKind::kReal,
             [](const View& v) { return NumberText(v.tool.at.x - v.profile.origin_x); }},
    Register{"Y", VariableKind::kReal,
             [](const View& v) { return NumberText(v.tool.at.y - v.profile.origin_y); }},
    Register{"Z", VariableKind::kReal,
             [](const View& v) { return NumberText(v.tool.at.z - v.registers().z0); }},
    Register{"A", VariableKind::kReal, [](const View& v) { return NumberText(v.tool.at.a); }, true},
    Register{"LX", VariableKind::kReal,
             [](const View& v) { return NumberText(v.logical().x - v.profile.origin_x); }},
    Register{"LY", VariableKind::kReal,
             [](const View& v) { return NumberText(v.logical().y - v.profile.origin_y); }},
    Register{"LZ", VariableKind::kReal,
             [](const View& v) { return NumberText(v.logical().z - v.registers().z0); }},
    Register{"VS", VariableKind::kReal, XySpeed},
    Register{"F", VariableKind::kReal, XySpeed},
    Register{"VZ", VariableKind::kReal, ZSpeed},
    Register{"V", VariableKind::kReal, ZSpeed},
    Register{"DW", VariableKind::kInteger, Dwell},
    Register{"W", VariableKind::kInteger, Dwell},
    Register{"MC", VariableKind::kLogical,
             [](const View& v) -> std::string { return v.registers().rotation ? "on" : "off"; }},
    Register{"SPINDLE", VariableKind::kLogical,
             [](const View& v) -> std::string { return v.tool.spindle_turns ? "on" : "off"; }},
    Register{"RPM", VariableKind::kInteger,
             [](const View& v) { return std::to_string(v.registers().rpm); }},
    Register{"Z0", VariableKind::kReal, [](const View& v) { return NumberText(v.registers().z0); }},
    Register{"Z1", VariableKind::kReal, [](const View& v) { return NumberText(v.registers().z1); }},
    Register{"Z2", VariableKind::kReal, [](const View& v) { return NumberText(v.registers().z2); }},
    Register{"MODE", VariableKind::kWord,
             [](const View& v) -> std::string { return v.registers().absolute ? "abs" : "rel"; }},
    Register{"TOOL", VariableKind::kWord,
             [](const View& v) -> std::string { return v.registers().tool_down ? "down" : "up"; }},
    Register{"ERR", VariableKind::kInteger,
             [](const View& v) { return std::to_string(v.device.command_errors().value()); }},
    Register{"COM", VariableKind::kInteger,
             [](const View& v) { return std::to_string(v.device.link_errors().value()); }},
    Register{"XSTEPS", VariableKind::kInteger,
             [](const View& v) { return MmSteps(v, v.tool.at.x); }},
    Register{"YSTEPS", VariableKind::kInteger,
             [](const View& v) { return MmSteps(v, v.tool.at.y); }},
    Register{"ZSTEPS", VariableKind::kInteger,
             [](const View& v) { return MmSteps(v, v.tool.at.z); }},
    Register{"ASTEPS", VariableKind::kInteger,
             [](const View& v) { return StepsText(v.tool.at.a, v.profile.rotary_step_deg); }, true},
    Register{"ESC.M", VariableKind::kWord,
             [](const View& v) { return EscValues(v.device.path().esc_m(), 6); }},
    Register{"ESC.T", VariableKind::kWord,
             [](const View& v) { return EscValues(v.device.path().esc_t(), 5); }},
};

const Register* FindRegister(const Profile& profile, std::string_view name) {
  const auto found = std::ranges::find(kRegisters, name, &Register::name);
  if (found == kRegisters.end() || (found->of_rotary && !profile.has_rotary)) return nullptr;
  return &*found;
}

}  // namespace

std::vector<machine::ModalValue> ModalRegisters(const Device& device, const Profile& profile,
                                                const ToolNow& tool) {
  std::vector<machine::ModalValue> values;
  for (const std::string_view name :
       {"VS", "VZ", "DW", "MC", "RPM", "Z0", "Z1", "Z2", "MODE", "TOOL"}) {
    values.push_back({std::string(name), ReadRegister(device, profile, tool, name)->text});
  }
  return values;
}

bool HasRegister(const Profile& profile, std::string_view name) {
  return FindRegister(profile, name) != nullptr;
}

std::optional<machine::VariableValue> ReadRegister(const Device& device, const Profile& profile,
                                                   const ToolNow& tool, std::string_view name) {
  const Register* found = FindRegister(profile, name);
  if (found == nullptr) return std::nullopt;
  return machine::VariableValue{found->kind,
                                found->read({.device = device, .profile = profile, .tool = tool})};
}

}  // namespace rmlcell::rml1
