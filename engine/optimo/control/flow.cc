#include "engine/optimo/control/flow.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kCallLevels = 4;  // OPT-7.09

}  // namespace

Status Flow::Execute(const Instruction& i) {
  switch (i.op) {
    case Op::kGoto:
      return counter_.Jump(counter_.module().Targets(i)[0]);
    case Op::kGotoTable:
      return GotoTable(i);
    case Op::kGosub:
      return counter_.Gosub(counter_.module().Targets(i)[0]);
    case Op::kIf:
      return If(i);
    case Op::kFunction:
      return CallFunction(i);
    case Op::kCall:
      return CallProgram(i);
    case Op::kErr:
      counter_.frame().error_label = counter_.module().Targets(i)[0];
      return {};
    case Op::kNoerr:
      counter_.frame().error_label.reset();
      return {};
    case Op::kTimer:
      return SetTimer(i);
    case Op::kDelay:
      return Delay(i);
    case Op::kWait:
      return WaitFor(i);
    default:
      return TellError(i);
  }
}

Status Flow::GotoTable(const Instruction& i) {
  const Result<double> value = data_.Real(counter_.module().Value(i, 0));
  if (!value) return value.error();
  const double selected = std::trunc(*value);
  const auto targets = counter_.module().Targets(i);
  if (!(selected >= 1.0 && selected <= static_cast<double>(targets.size()))) return {};
  return counter_.Jump(targets[static_cast<std::size_t>(selected) - 1]);
}

Status Flow::If(const Instruction& i) {
  const Result<Value> condition = data_.Eval(counter_.module().Value(i, 0));
  if (!condition) return condition.error();
  const auto targets = counter_.module().Targets(i);
  if (condition->truth()) return counter_.Jump(targets[0]);
  if (targets.size() > 1) return counter_.Jump(targets[1]);
  return {};
}

Status Flow::CallFunction(const Instruction& i) {
  const int slot = i.numbers[0];
  if (slot == kRotaryTableFunction && parameters_.rotary_table) {
    const Result<double> degrees =
        i.value_count > 1 ? data_.Real(counter_.module().Value(i, 1)) : Result<double>(0.0);
    if (!degrees) return degrees.error();
    if (situation_.simulating()) return {};
    effects_.Show(
        {.kind = PassageEffect::Kind::kTable, .place = situation_.place, .value = *degrees});
    return {};
  }
  const Result<const LinkedModule*> function = counter_.FindFunction(slot);
  if (!function) return function.error();
  const Result<Parameters> parameters = PassParameters(i, (*function)->module);
  if (!parameters) return parameters.error();
  counter_.EnterFunction(**function, *parameters);
  return {};
}

// Values are copied in, converted to the type that the callee defines. OPT-9.26, 9.27
Result<Flow::Parameters> Flow::PassParameters(const Instruction& i, const Module& callee) {
  Parameters parameters{};
  for (int n = 1; n < i.value_count; ++n) {
    const Result<Value> value = data_.Eval(counter_.module().Value(i, n));
    if (!value) return value.error();
    const auto at = static_cast<std::size_t>(n - 1);
    const Result<float> converted = ConvertTo(callee.parameter_types[at], *value);
    if (!converted) return converted.error();
    parameters[at] = *converted;
  }
  return parameters;
}

Result<int> Flow::ProgramNumber(Expression expression) {
  const Result<double> value = data_.Real(expression);
  if (!value) return value.error();
  const Result<int> number = TruncateToInteger(static_cast<float>(*value));
  if (!number) return number.error();
  if (!IsSlot(*number)) {
    return Error{ErrorCode::kProgramNumber, "program number is " + Told("program", *number), {}};
  }
  return *number;
}

Status Flow::CallProgram(const Instruction& i) {
  const Result<int> slot = ProgramNumber(counter_.module().Value(i, 0));
  if (!slot) return slot.error();
  const auto call = [&slot] { return "CALL " + Told("program", *slot); };
  if (counter_.program().processes.any_on()) {
    return Error{ErrorCode::kWorkActiveAtCall, call() + " with a WORK ON", {}};
  }
  if (counter_.call_level() > kCallLevels) {
    return Error{ErrorCode::kCallTooDeep, call() + " is a fifth level", {}};
  }
  const Result<Loaded> callee = counter_.Acquire(*slot, counter_.call_level() == kCallLevels);
  if (!callee) return callee.error();
  const Result<Parameters> parameters =
      PassParameters(i, (*callee)->executable.modules.front().module);
  if (!parameters) return parameters.error();
  telling_.observer().OnProgram(situation_.now, situation_.place, "call", *slot);
  counter_.Begin(*callee, *parameters);
  if (parameters_.call_time_s > 0.0 && !situation_.simulating()) {
    waits_.BeginTime(parameters_.call_time_s, machine::WaitKind::kLoad);
  }
  return {};
}

Status Flow::SetTimer(const Instruction& i) {
  if (i.Has(kDis)) {
    counter_.ClearTimer();
    return {};
  }
  const Result<double> seconds = data_.Real(counter_.module().Value(i, 0));
  if (!seconds) return seconds.error();
  if (*seconds < 0.0) {
    return Error{ErrorCode::kValueRange,
                 "TIMER is " + Told("time", *seconds, "s", ShortestText(*seconds)),
                 {}};
  }
  if (situation_.simulating()) return {};
  // A period below one cycle would never let the program go on.
  const SimTime period =
      After(situation_.now, std::max(*seconds, cycle_.seconds())) - situation_.now;
  counter_.SetTimer(counter_.module().Targets(i)[0], cycle_.TickAfter(situation_.now, *seconds),
                    period, i.Has(kAuto));
  return {};
}

Status Flow::Delay(const Instruction& i) {
  const Result<double> seconds = data_.Real(counter_.module().Value(i, 0));
  if (!seconds) return seconds.error();
  if (*seconds < 0.0) {
    return Error{ErrorCode::kValueRange,
                 "DELAY is " + Told("time", *seconds, "s", ShortestText(*seconds)),
                 {}};
  }
  if (!situation_.simulating()) waits_.BeginTime(*seconds, machine::WaitKind::kDwell);
  return {};
}

Status Flow::WaitFor(const Instruction& i) {
  if (waits_.condition_met() || situation_.simulating()) return {};
  const ExprRange expression = data_.RangeOf(counter_.module().Value(i, 0));
  const Result<bool> met = data_.Truth(expression);
  if (!met) return met.error();
  if (!*met) waits_.BeginCondition(expression);
  return {};
}

// SETERR: what a program calls an error is a message of it.
Status Flow::TellError(const Instruction& i) {
  const Result<double> value = data_.Real(counter_.module().Value(i, 0));
  if (!value) return value.error();
  const double number = std::trunc(*value);
  if (!(number >= 1.0 && number <= 9999.0)) {
    return Error{
        ErrorCode::kSeterrRange, "SETERR " + Told("value", *value, "", ShortestText(*value)), {}};
  }
  telling_.observer().OnMessage(situation_.now, situation_.place,
                                "ERROR " + std::to_string(static_cast<int>(number)));
  return {};
}

}  // namespace rmlcell::optimo
