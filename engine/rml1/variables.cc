#include "engine/rml1/variables.h"

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

}  // namespace

std::optional<std::string> ReadRegister(const Device& device, const Profile& profile,
                                        const Point& tool, std::string_view name) {
  const Registers& registers = device.registers();
  const Point& logical = device.carriage().logical();
  // Coordinates are 4-byte values: what is behind the sixth decimal is noise of theirs.
  const auto number = [](double value) { return ShortestText(std::round(value * 1e6) / 1e6); };
  const auto steps = [](double value, double step) {
    // Half away from zero (RML1-9.22); 0.025 / 0.05 is a half although the quotient is a bit less.
    const double count = value / step;
    return std::to_string(std::llround(count + std::copysign(1e-9, count)));
  };
  const double mm = 1.0 / profile.units_per_mm;
  if (name == "X") return number(tool.x - profile.origin_x);
  if (name == "Y") return number(tool.y - profile.origin_y);
  if (name == "Z") return number(tool.z - registers.z0);
  if (name == "A" && profile.has_rotary) return number(tool.a);
  if (name == "LX") return number(logical.x - profile.origin_x);
  if (name == "LY") return number(logical.y - profile.origin_y);
  if (name == "LZ") return number(logical.z - registers.z0);
  if (name == "VS" || name == "F") return number(registers.xy_speed);
  if (name == "VZ" || name == "V") return number(registers.z_speed);
  if (name == "DW" || name == "W") return std::to_string(registers.dwell_ms);
  if (name == "MC") return registers.rotation ? "on" : "off";
  if (name == "SPINDLE") return registers.spindle_on ? "on" : "off";
  if (name == "RPM") return std::to_string(registers.rpm);
  if (name == "Z0") return number(registers.z0);
  if (name == "Z1") return number(registers.z1);
  if (name == "Z2") return number(registers.z2);
  if (name == "MODE") return registers.absolute ? "abs" : "rel";
  if (name == "TOOL") return registers.tool_down ? "down" : "up";
  if (name == "ERR") return std::to_string(device.command_errors().value());
  if (name == "COM") return std::to_string(device.link_errors().value());
  if (name == "XSTEPS") return steps(tool.x * mm, profile.step_mm);
  if (name == "YSTEPS") return steps(tool.y * mm, profile.step_mm);
  if (name == "ZSTEPS") return steps(tool.z * mm, profile.step_mm);
  if (name == "ASTEPS" && profile.has_rotary) return steps(tool.a, profile.rotary_step_deg);
  if (name == "ESC.M") return EscValues(device.path().esc_m(), 6);
  if (name == "ESC.T") return EscValues(device.path().esc_t(), 5);
  return std::nullopt;
}

}  // namespace rmlcell::rml1
