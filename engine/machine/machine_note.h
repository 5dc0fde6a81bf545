#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/outcome.h"
#include "engine/machine/run_setup.h"

namespace rmlcell::machine {

struct Alarm {
  std::int64_t id = 0;  // counts from 1
  ErrorCode code{};
  Detail detail{};
  SimTime at{0};  // of the machine
  Place place{};

  bool operator==(const Alarm&) const = default;
};

// The program that is selected, and where in it the control stands: what a panel points at.
struct ShownStep {
  int program = 0;            // in execution, the module that the step belongs to; 0: none
  int step = 0;               // 0: none
  std::string instruction{};  // "MOVE"; empty: none

  bool operator==(const ShownStep&) const = default;
};

// What a machine keeps beside that of its family, and that (Standing::Save).
struct MachineNote {
  SimTime time{0};
  bool on = true;
  bool emergency = false;  // the key is down
  bool cover_open = false;
  Mode mode = Mode::kRemote;
  double override_percent = 100.0;
  std::optional<ProgramStep> simulation{};
  std::vector<Breakpoint> breakpoints{};
  std::vector<Alarm> alarms{};
  std::int64_t last_alarm = 0;
  std::int64_t last_run = 0;
  ShownStep shown{};
  std::optional<ErrorCode> message{};
  std::array<int, kGates> gates{};
  std::string handbox{};  // Handbox::Save
  std::string family{};

  bool operator==(const MachineNote&) const = default;
};

std::string_view Name(Mode mode);  // "REMOTE", as lamps and notes say it

// A key and its values a line, with a version in front; the bytes of the family behind all lines.
std::string WriteMachineNote(const MachineNote& note);

// Errors: CellBadText for what WriteMachineNote never writes.
Result<MachineNote> ReadMachineNote(std::string_view text);

}  // namespace rmlcell::machine
