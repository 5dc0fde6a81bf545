#include "engine/rml1/machine_state.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

constexpr std::string_view kHeader = "rml1 machine state 1\n";

// Every value of the state as a number, in the order of writing.
struct Field {
  std::string_view key;
  double low;
  double high;
  double (*read)(const MachineState&);
  void (*write)(MachineState&, double);
};

constexpr double kFar = 1e9;  // device units, degrees
constexpr std::array kFields = {
    Field{"x", -kFar, kFar, [](const MachineState& s) { return s.at.x; },
          [](MachineState& s, double v) { s.at.x = v; }},
    Field{"y", -kFar, kFar, [](const MachineState& s) { return s.at.y; },
          [](MachineState& s, double v) { s.at.y = v; }},
    Field{"z", -kFar, kFar, [](const MachineState& s) { return s.at.z; },
          [](MachineState& s, double v) { s.at.z = v; }},
    Field{"a", -kFar, kFar, [](const MachineState& s) { return s.at.a; },
          [](MachineState& s, double v) { s.at.a = v; }},
    Field{"z0", -kFar, 0.0, [](const MachineState& s) { return s.registers.z0; },
          [](MachineState& s, double v) { s.registers.z0 = v; }},
    Field{"z1", -kFar, 0.0, [](const MachineState& s) { return s.registers.z1; },
          [](MachineState& s, double v) { s.registers.z1 = v; }},
    Field{"z2", 0.0, kFar, [](const MachineState& s) { return s.registers.z2; },
          [](MachineState& s, double v) { s.registers.z2 = v; }},
    Field{"xy_speed", 1e-3, 1e5, [](const MachineState& s) { return s.registers.xy_speed; },
          [](MachineState& s, double v) { s.registers.xy_speed = v; }},
    Field{"z_speed", 1e-3, 1e5, [](const MachineState& s) { return s.registers.z_speed; },
          [](MachineState& s, double v) { s.registers.z_speed = v; }},
    Field{"dwell_ms", 0.0, 32767.0,
          [](const MachineState& s) { return static_cast<double>(s.registers.dwell_ms); },
          [](MachineState& s, double v) { s.registers.dwell_ms = static_cast<int>(v); }},
    Field{"rpm", 0.0, 1e6,
          [](const MachineState& s) { return static_cast<double>(s.registers.rpm); },
          [](MachineState& s, double v) { s.registers.rpm = static_cast<int>(v); }},
    Field{"absolute", 0.0, 1.0,
          [](const MachineState& s) { return s.registers.absolute ? 1.0 : 0.0; },
          [](MachineState& s, double v) { s.registers.absolute = v != 0.0; }},
    Field{"tool_down", 0.0, 1.0,
          [](const MachineState& s) { return s.registers.tool_down ? 1.0 : 0.0; },
          [](MachineState& s, double v) { s.registers.tool_down = v != 0.0; }},
    Field{"rotation", 0.0, 1.0,
          [](const MachineState& s) { return s.registers.rotation ? 1.0 : 0.0; },
          [](MachineState& s, double v) { s.registers.rotation = v != 0.0; }},
    Field{"spindle_on", 0.0, 1.0,
          [](const MachineState& s) { return s.registers.spindle_on ? 1.0 : 0.0; },
          [](MachineState& s, double v) { s.registers.spindle_on = v != 0.0; }},
};

Error Bad(Detail detail) {
  return {ErrorCode::kCellBadText, "machine state: " + std::move(detail), {}};
}

// "origin 100 250\n", and nothing behind it.
Result<Point> ReadOrigin(std::string_view text) {
  constexpr std::string_view kOrigin = "origin ";
  if (!text.starts_with(kOrigin) || text.find('\n') + 1 != text.size())
    return Bad("more lines than expected");
  text.remove_prefix(kOrigin.size());
  text.remove_suffix(1);
  const std::size_t blank = std::min(text.find(' '), text.size() - 1);
  const std::optional<double> x = ParseDouble(text.substr(0, blank));
  const std::optional<double> y = ParseDouble(text.substr(blank + 1));
  if (!x || !y || !(std::abs(*x) <= kFar && std::abs(*y) <= kFar))
    return Bad(Told("name", "origin") + " is out of range");
  return Point{.x = *x, .y = *y};
}

}  // namespace

std::string WriteMachineState(const MachineState& state) {
  std::string text(kHeader);
  for (const Field& field : kFields) {
    text += field.key;
    text += ' ';
    text += ShortestText(field.read(state));
    text += '\n';
  }
  if (state.origin)
    text += "origin " + ShortestText(state.origin->x) + " " + ShortestText(state.origin->y) + "\n";
  return text;
}

void UseOrigin(const std::optional<Point>& origin, Profile& profile) {
  if (!origin) return;
  profile.origin_by_panel = true;
  profile.origin_x = origin->x;
  profile.origin_y = origin->y;
}

std::optional<Point> OriginOf(const Profile& profile) {
  if (!profile.origin_by_panel) return std::nullopt;
  return Point{.x = profile.origin_x, .y = profile.origin_y};
}

Result<MachineState> ReadMachineState(std::string_view text, const Profile& profile) {
  if (!text.starts_with(kHeader))
    return Bad("it does not begin with '" + std::string(kHeader.substr(0, kHeader.size() - 1)) +
               "'");
  text.remove_prefix(kHeader.size());
  MachineState state{.registers = Registers(profile), .at = {}};
  for (const Field& field : kFields) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    const std::size_t blank = line.find(' ');
    if (end == std::string_view::npos || blank != field.key.size() ||
        !line.starts_with(field.key)) {
      return Bad("no line '" + Told("name", field.key) + "'");
    }
    const std::optional<double> value = ParseDouble(line.substr(blank + 1));
    if (!value || !(*value >= field.low && *value <= field.high)) {
      return Bad(Told("name", field.key) + " is out of range");
    }
    field.write(state, *value);
    text.remove_prefix(end + 1);
  }
  if (text.empty()) return state;
  Result<Point> origin = ReadOrigin(text);
  if (!origin) return origin.error();
  state.origin = *origin;
  return state;
}

}  // namespace rmlcell::rml1
