#include "proto/bridge/inputs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

using machine::InputChange;
using machine::InputKind;

constexpr int kInputIndexMax = 99;
constexpr std::size_t kShownMax = 40;

Error Invalid(Detail detail) { return {ErrorCode::kCellInvalidArgument, std::move(detail), {}}; }

Error BadLine(const std::string& name, int line, int column, const Detail& what) {
  return {ErrorCode::kCellBadText, Told("file", name) + ":" + Told("line", line) + ": " + what,
          SourceSpan{.line = line, .column = column}};
}

// Of a part of this line; columns begin with 1.
int ColumnOf(std::string_view part, std::string_view line) {
  return static_cast<int>(part.data() - line.data()) + 1;
}

// "IL[20]", "ia[0]": kind and index.
std::optional<InputChange> InputNamed(std::string_view name) {
  const std::string word = UpperCase(name);
  const bool logical = word.starts_with("IL[");
  if ((!logical && !word.starts_with("IA[")) || !word.ends_with(']')) return std::nullopt;
  const auto index = ParseInteger(std::string_view(word).substr(3, word.size() - 4));
  if (!index || *index < 0 || *index > kInputIndexMax) return std::nullopt;
  return InputChange{.kind = logical ? InputKind::kLogical : InputKind::kAnalogue,
                     .index = static_cast<int>(*index)};
}

Result<InputChange> OfVariable(const v1::Variable& variable) {
  std::optional<InputChange> change = InputNamed(variable.name());
  if (!change) {
    const std::string& name = variable.name();
    return Invalid((name.size() <= kShownMax ? "'" + Told("name", name) + "'" : "a long name") +
                   " is no input: use IL[0] to IL[99] or IA[0] to IA[99]");
  }
  const v1::VariableValue& value = variable.value();
  if (change->kind == InputKind::kLogical) {
    if (!value.has_logical())
      return Invalid(Told("input", variable.name()) + " needs a logical value");
    change->value = value.logical() ? 1.0 : 0.0;
    return *change;
  }
  change->value = value.has_real()      ? value.real()
                  : value.has_integer() ? static_cast<double>(value.integer())
                                        : std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(change->value))
    return Invalid(Told("input", variable.name()) + " needs a number");
  return *change;
}

}  // namespace

Result<InputChange> ChangeOf(const v1::AppliedInput& input, double override_max) {
  const auto key = [](InputKind kind) { return InputChange{.kind = kind}; };
  switch (input.input_case()) {
    case v1::AppliedInput::kStart:
      return key(InputKind::kStart);
    case v1::AppliedInput::kResume:
      return InputChange{.kind = InputKind::kStart,
                         .value = input.resume().restore_process() ? 1.0 : 0.0};
    case v1::AppliedInput::kHold:
      return key(InputKind::kHold);
    case v1::AppliedInput::kStop:
      return key(InputKind::kStop);
    case v1::AppliedInput::kEmergencyStop:
      if (!input.emergency_stop()) break;
      return key(InputKind::kEmergencyStop);
    case v1::AppliedInput::kOverridePercent:
      if (const Status good = CheckOverride(input.override_percent(), override_max); !good)
        return good.error();
      return InputChange{.kind = InputKind::kOverride, .value = input.override_percent()};
    case v1::AppliedInput::kFromOutside:
      if (input.from_outside().has_door_open()) {
        return InputChange{.kind = InputKind::kDoor,
                           .value = input.from_outside().door_open() ? 1.0 : 0.0};
      }
      if (input.from_outside().has_input()) return OfVariable(input.from_outside().input());
      break;
    case v1::AppliedInput::INPUT_NOT_SET:
      return Invalid("an input says nothing");
    default:
      break;
  }
  return Invalid(
      "a simulation takes start, resume, hold, stop, emergency_stop, override_percent, and from_outside with input or door_open");
}

v1::AppliedInput ToProto(const InputChange& change) {
  v1::AppliedInput input;
  v1::MachineInput& outside = *input.mutable_from_outside();
  switch (change.kind) {
    case InputKind::kLogical:
      outside.mutable_input()->set_name("IL[" + std::to_string(change.index) + "]");
      outside.mutable_input()->mutable_value()->set_logical(change.value != 0.0);
      break;
    case InputKind::kAnalogue:
      outside.mutable_input()->set_name("IA[" + std::to_string(change.index) + "]");
      outside.mutable_input()->mutable_value()->set_real(change.value);
      break;
    case InputKind::kDoor:
      outside.set_door_open(change.value != 0.0);
      break;
    case InputKind::kStart:
      input.mutable_resume()->set_restore_process(change.value != 0.0);
      break;
    case InputKind::kHold:
      input.set_hold(v1::HOLD_REASON_HOLD);
      break;
    case InputKind::kStop:
      input.set_stop(v1::HOLD_REASON_STOP);
      break;
    case InputKind::kEmergencyStop:
      input.set_emergency_stop(true);
      break;
    case InputKind::kOverride:
      input.set_override_percent(change.value);
      break;
    case InputKind::kVariable:
      input.mutable_variable()->set_name(change.name);
      input.mutable_variable()->mutable_value()->set_real(change.value);
      break;
  }
  return input;
}

namespace {

// ON, OPEN, TRUE, YES are 1; OFF, CLOSED, FALSE, NO are 0; else a number.
std::optional<double> ValueOf(std::string_view text) {
  const std::string word = UpperCase(text);
  if (word == "ON" || word == "OPEN" || word == "TRUE" || word == "YES") return 1.0;
  if (word == "OFF" || word == "CLOSED" || word == "FALSE" || word == "NO") return 0.0;
  return ParseDouble(text);
}

// The key of that name, or one that a value is still to be given to; nothing: there is none.
std::optional<v1::AppliedInput> Named(std::string_view what) {
  const std::string word = UpperCase(what);
  v1::AppliedInput input;
  if (word == "START" || word == "RESUME") {
    input.mutable_resume();
  } else if (word == "HOLD") {
    input.set_hold(v1::HOLD_REASON_HOLD);
  } else if (word == "STOP") {
    input.set_stop(v1::HOLD_REASON_STOP);
  } else if (word == "EMERGENCY") {
    input.set_emergency_stop(true);
  } else if (word == "OVERRIDE") {
    input.set_override_percent(0.0);
  } else if (word == "DOOR") {
    input.mutable_from_outside()->set_door_open(false);
  } else if (InputNamed(word)) {
    input.mutable_from_outside()->mutable_input()->set_name(word);
  } else {
    return std::nullopt;
  }
  return input;
}

bool NeedsValue(const v1::AppliedInput& input) {
  return input.has_override_percent() || input.has_from_outside();
}

Status SetValue(double value, v1::AppliedInput& input) {
  if (input.has_override_percent()) {
    input.set_override_percent(value);
    return {};
  }
  v1::MachineInput& outside = *input.mutable_from_outside();
  if (outside.has_input() && InputNamed(outside.input().name())->kind == InputKind::kAnalogue) {
    outside.mutable_input()->mutable_value()->set_real(value);
    return {};
  }
  if (value != 0.0 && value != 1.0)
    return Invalid("the value is " + Told("value", value, {}, ShortestText(value)) +
                   "; allowed are 0 and 1");
  if (outside.has_input()) {
    outside.mutable_input()->mutable_value()->set_logical(value == 1.0);
  } else {
    outside.set_door_open(value == 1.0);
  }
  return {};
}

}  // namespace

Status CheckOverride(double percent, double override_max) {
  if (percent > 0.0 && percent <= override_max) return {};
  return Invalid("the value is " + Told("override", percent, "%", ShortestText(percent)) +
                 "; allowed are above 0 to " +
                 Told("most", override_max, "%", ShortestText(override_max) + " %"));
}

Result<machine::InputChange> FromProto(const v1::ScriptedInput& scripted, double override_max) {
  if (scripted.virtual_time_ns() < 0) return Invalid("virtual_time_ns must be 0 or later");
  Result<InputChange> change = ChangeOf(scripted.input(), override_max);
  if (change) change->at = SimTime(scripted.virtual_time_ns());
  return change;
}

Result<machine::InputScript> InputsOf(const v1::SimulationOptions& options) {
  machine::InputScript inputs;
  for (const v1::ScriptedInput& scripted : options.inputs()) {
    const auto change = FromProto(scripted, std::numeric_limits<double>::infinity());
    if (!change) return change.error();
    inputs.push_back(*change);
  }
  std::ranges::stable_sort(inputs, {}, &InputChange::at);
  return inputs;
}

Status ParseInputFile(std::string_view text, const std::string& name, double override_max,
                      v1::SimulationOptions& options) {
  int line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view line = Trimmed(whole.substr(0, whole.find('#')));
    if (line.empty()) continue;
    const std::size_t blank = line.find_first_of(" \t");
    const auto at = ParseDouble(line.substr(0, blank));
    if (!at || !(*at >= 0.0) || blank == std::string_view::npos) {
      return BadLine(name, line_number, ColumnOf(line, whole),
                     "a line begins with the time in seconds, from 0: 0.5 IL[20] = 1");
    }
    const std::string_view rest = Trimmed(line.substr(blank));
    const std::size_t equals = rest.find('=');
    const std::string_view what = Trimmed(rest.substr(0, equals));
    const int column = ColumnOf(rest, whole);
    std::optional<v1::AppliedInput> input = Named(what);
    if (!input) {
      return BadLine(name, line_number, column,
                     "'" + Told("word", what.substr(0, kShownMax)) +
                         "' is none of IL[n], IA[n], DOOR, START, HOLD, STOP, EMERGENCY, OVERRIDE");
    }
    if (NeedsValue(*input) != (equals != std::string_view::npos)) {
      return BadLine(name, line_number, column,
                     Told("word", what) + (equals == std::string_view::npos ? " needs '= VALUE'"
                                                                            : " takes no value"));
    }
    v1::ScriptedInput scripted;
    if (equals != std::string_view::npos) {
      const std::string_view behind = rest.substr(equals + 1);
      const std::string_view given = Trimmed(behind);
      const auto value = ValueOf(given);
      if (!value) {
        return BadLine(name, line_number, ColumnOf(given.empty() ? behind : given, whole),
                       "the value is no number, ON, OFF, OPEN or CLOSED");
      }
      if (const Status set = SetValue(*value, *input); !set)
        return BadLine(name, line_number, column, set.error().detail);
    }
    scripted.set_virtual_time_ns(FromSeconds(*at).count());
    *scripted.mutable_input() = *std::move(input);
    if (const auto good = FromProto(scripted, override_max); !good)
      return BadLine(name, line_number, column, good.error().detail);
    *options.add_inputs() = std::move(scripted);
  }
  return {};
}

v1::Variable ToProto(const machine::NamedVariable& variable) {
  v1::Variable message;
  message.set_name(variable.name);
  message.set_text(variable.value.text);
  v1::VariableValue& value = *message.mutable_value();
  const std::string& text = variable.value.text;
  switch (variable.value.kind) {
    case machine::VariableKind::kReal:
      value.set_real(ParseDouble(text).value_or(0.0));
      break;
    case machine::VariableKind::kInteger:
      value.set_integer(ParseInteger(text).value_or(0));
      break;
    case machine::VariableKind::kLogical:
      value.set_logical(text == "1" || text == "on");
      break;
    case machine::VariableKind::kWord:
      value.set_word(text);
      break;
  }
  return message;
}

}  // namespace rmlcell::bridge
