#include "clients/cli/simulate_options.h"

#include <algorithm>
#include <map>
#include <optional>
#include <ranges>
#include <utility>

#include "clients/cli/program_files.h"
#include "engine/core/near_words.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "proto/bridge/files.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/setup.h"

namespace rmlcell::cli {
namespace {

Result<v1::StepPlace> ParseStepPlace(const std::string& text) {
  if (text == "off") return v1::StepPlace();
  const std::size_t slash = text.find('/');
  const auto program = slash == std::string::npos ? std::optional<long long>(0)
                                                  : ParseInteger(text.substr(0, slash));
  const auto step = ParseInteger(slash == std::string::npos ? text : text.substr(slash + 1));
  if (!program || !step || *program < 0 || *program > 99 ||
      (slash != std::string::npos && *program < 1) || *step < 1 || *step > 1'000'000'000) {
    return Error{
        ErrorCode::kCellUsage, "'" + text + "': write PROGRAM/STEP, such as 45/7, or off", {}};
  }
  v1::StepPlace place;
  place.set_program(static_cast<int>(*program));
  place.set_step(static_cast<int>(*step));
  return place;
}

Result<v1::OperatingMode> ParseMode(const std::string& text) {
  const std::map<std::string_view, v1::OperatingMode> modes = {
      {"cycle", v1::OPERATING_MODE_CYCLE},
      {"remote", v1::OPERATING_MODE_REMOTE},
      {"single", v1::OPERATING_MODE_SINGLE},
      {"repeat", v1::OPERATING_MODE_REPEAT}};
  const auto found = modes.find(text);
  if (found != modes.end()) return found->second;
  const auto names = std::views::keys(modes);
  const std::vector<std::string_view> known(names.begin(), names.end());
  return Error{ErrorCode::kCellUsage,
               "'" + text + "': modes are cycle, remote, single, repeat" +
                   DidYouMean(NearestTo(text, known).words),
               {}};
}

}  // namespace

Result<v1::Budget> ParseBudget(std::string_view text) {
  v1::Budget budget;
  for (const auto letters : std::views::split(text, ',')) {
    const std::string_view part(letters.begin(), letters.end());
    const std::size_t equals = part.find('=');
    const std::string_view name = part.substr(0, equals);
    const std::string_view value =
        equals == std::string_view::npos ? std::string_view() : part.substr(equals + 1);
    const std::optional<long long> steps = ParseInteger(value);
    const std::optional<double> time_s = ParseDouble(value);
    if (name == "steps" && steps && *steps > 0) {
      budget.set_steps(*steps);
    } else if (name == "time" && time_s && *time_s > 0.0) {
      budget.set_virtual_time_ns(FromSeconds(*time_s).count());
    } else {
      return Error{
          ErrorCode::kCellUsage, "'" + std::string(part) + "': write steps=N,time=SECONDS", {}};
    }
  }
  return budget;
}

Result<v1::SimulationOptions> OptionsMessage(const SimulateOptions& options,
                                             const machine::MachineFamily& family) {
  const double override_max = family.info().override_max_percent;
  v1::SimulationOptions message;
  const Result<v1::OperatingMode> mode = ParseMode(options.mode);
  if (!mode) return mode.error();
  message.set_mode(*mode);
  if (const Status valid = bridge::CheckOverride(options.override_percent, override_max); !valid)
    return Error{ErrorCode::kCellUsage, "--override: " + valid.error().detail, {}};
  message.set_override_percent(options.override_percent);
  if (!options.simul.empty()) {
    const Result<v1::StepPlace> place = ParseStepPlace(options.simul);
    if (!place) return place.error();
    *message.mutable_simul() = *place;
  }
  if (!options.breakpoint.empty()) {
    const Result<v1::StepPlace> place = ParseStepPlace(options.breakpoint);
    if (!place) return place.error();
    *message.add_breakpoints()->mutable_step() = *place;
  }
  if (!options.inputs_file.empty()) {
    const Result<std::string> text = bridge::ReadFile(options.inputs_file, kFileBytesMax);
    if (!text) return text.error();
    if (const Status parsed =
            bridge::ParseInputFile(*text, options.inputs_file, override_max, message);
        !parsed)
      return parsed.error();
  }
  return message;
}

Result<std::vector<int>> AddExecutables(const std::vector<std::string>& executables,
                                        const machine::MachineFamily& family,
                                        std::vector<simulation::MemoryProgram>& programs) {
  std::vector<int> to_make;
  for (const std::string& text : executables) {
    const Result<SlotFile> named = ParseSlotFile(text);
    if (!named) return named.error();
    const Result<int> slot = named->Slot(family);
    if (!slot) return slot.error();
    if (named->file.empty()) {
      if (std::ranges::find(programs, *slot, &simulation::MemoryProgram::slot) == programs.end()) {
        return Error{
            ErrorCode::kCellUsage, "--executable " + text + ": there is no such program", {}};
      }
      to_make.push_back(*slot);
      continue;
    }
    Result<std::string> bytes = bridge::ReadFile(named->file, kFileBytesMax);
    if (!bytes) return bytes.error();
    if (const Status good = family.CheckExecutable(*bytes, *slot); !good) return good.error();
    const auto program = std::ranges::find(programs, *slot, &simulation::MemoryProgram::slot);
    if (program == programs.end()) {
      return Error{ErrorCode::kCellUsage,
                   "--executable " + text + ": there is no program " + std::to_string(*slot),
                   {}};
    }
    program->executable = machine::Bytes::Of(*std::move(bytes));
  }
  return to_make;
}

Status CheckPlaces(const v1::SimulationOptions& options,
                   const std::vector<simulation::MemoryProgram>& programs) {
  std::vector<const v1::StepPlace*> places = {&options.simul()};
  for (const v1::Breakpoint& breakpoint : options.breakpoints())
    places.push_back(&breakpoint.step());
  for (const v1::StepPlace* place : places) {
    const bool there = place->program() == 0 ||
                       std::ranges::find(programs, place->program(),
                                         &simulation::MemoryProgram::slot) != programs.end();
    if (there) continue;
    return Error{ErrorCode::kCellUsage,
                 "--simul, --break: there is no program " + std::to_string(place->program()),
                 {}};
  }
  return {};
}

}  // namespace rmlcell::cli
