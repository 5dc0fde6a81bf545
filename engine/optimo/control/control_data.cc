#include <cmath>

#include "engine/optimo/control/control.h"

// Variables, images and expressions.
namespace rmlcell::optimo {
namespace {

constexpr int kFirstWorkFlag = 87;  // IL[87 + p], OPT-3.37
constexpr int kLastWorkFlag = 94;
constexpr int kMotionFlag = 95;  // OPT-7.68

// PAR of an activation that need not be the innermost any more.
class WithParameters final : public VariableAccess {
 public:
  WithParameters(VariableAccess& others, const std::array<float, kParameterCount>& parameters)
      : others_(others), parameters_(parameters) {}
  float Read(Variable variable) override {
    if (variable.group != VariableGroup::kPar) return others_.Read(variable);
    return parameters_[variable.index % kParameterCount];
  }

 private:
  VariableAccess& others_;
  const std::array<float, kParameterCount>& parameters_;
};

}  // namespace

// UPDATE ON and no IMAGE: the images follow the outside. OPT-7.98, 7.100; in simulation nothing is
// read or written (OPT-6.24, 6.25).
bool Control::Connected(std::uint8_t group) const {
  return (modal().updated & group) != 0 && (modal().imaged & group) == 0 && !simulating();
}

// The outside as it is now.
double Control::InputNow(VariableGroup group, int index) const {
  if (group == VariableGroup::kIl) {
    if (index >= kFirstWorkFlag && index <= kLastWorkFlag) {
      return program().processes.flag(index - kFirstWorkFlag) ? 1.0 : 0.0;
    }
    if (index == kMotionFlag) return Moving() || !s_.timeline.empty() ? 1.0 : 0.0;
    return s_.machine.data.il_physical[static_cast<std::size_t>(index)] ? 1.0 : 0.0;
  }
  if (index <= 2) {
    const motion::MachinePoint point =
        modal().coord == CoordType::kAbsol ? TipNow().tip : AxesNow().column;
    return index == 0 ? point.x() : index == 1 ? point.y() : point.z();
  }
  if (index == 3) return AxesNow().a_rad;
  if (index == 4) return AxesNow().b_rad;
  return s_.machine.data.ia_physical[static_cast<std::size_t>(index)];
}

float Control::Read(Variable variable) {
  DataArea& data = s_.machine.data;
  const auto n = static_cast<std::size_t>(variable.index);
  switch (variable.group) {
    case VariableGroup::kVr:
      return data.vr[n];
    case VariableGroup::kVi:
      return data.vi[n];
    case VariableGroup::kVl:
      return data.vl[n] ? 1.0F : 0.0F;
    case VariableGroup::kIl:
      // Work and motion flags are the control's own: they hold in simulation too (OPT-6.20).
      if (Connected(kGroupIl) || (n >= kFirstWorkFlag && n <= kMotionFlag)) {
        data.il[n] = InputNow(variable.group, variable.index) != 0.0;
      }
      return data.il[n] ? 1.0F : 0.0F;
    case VariableGroup::kOl:
      return data.ol[n] ? 1.0F : 0.0F;
    case VariableGroup::kIa:
      if (Connected(kGroupIa))
        data.ia[n] = static_cast<float>(InputNow(variable.group, variable.index));
      return data.ia[n];
    case VariableGroup::kOa:
      if (n == 0) return static_cast<float>(TipSpeedNow() * parameters_.cycle_s);  // OPT-7.69
      return data.oa[n];
    case VariableGroup::kPar:
      return frame().parameters[n % kParameterCount];
  }
  return 0.0F;
}

// False: an error was raised, and nothing was written.
bool Control::Write(Variable variable, float number) {
  DataArea& data = s_.machine.data;
  const auto n = static_cast<std::size_t>(variable.index);
  switch (variable.group) {
    case VariableGroup::kVr:
      data.vr[n] = number;
      return true;
    case VariableGroup::kVi:
      data.vi[n] = number;
      return true;
    case VariableGroup::kVl:
      data.vl[n] = number != 0.0F;
      return true;
    case VariableGroup::kOl:
      return SetOutput(variable.index, number != 0.0F);
    case VariableGroup::kOa:
      data.oa[n] = number;
      if (Connected(kGroupOa)) {
        Show({.kind = PassageEffect::Kind::kAnalogue,
              .place = s_.place,
              .index = variable.index,
              .value = number});
      }
      return true;
    case VariableGroup::kPar:
      frame().parameters[n % kParameterCount] = number;
      return true;
    case VariableGroup::kIl:
    case VariableGroup::kIa:
      break;  // refused by the checker (OPT-7.66)
  }
  return true;
}

std::optional<Value> Control::Eval(Expression expression) {
  const Result<Value> value = Evaluate(expression, *this);
  if (value) return *value;
  Raise(value.error().code, value.error().detail);
  return std::nullopt;
}

std::optional<double> Control::Real(Expression expression) {
  const std::optional<Value> value = Eval(expression);
  if (!value) return std::nullopt;
  return static_cast<double>(value->number);
}

ExprRange Control::RangeOf(Expression expression) const {
  return {.first = static_cast<std::uint32_t>(expression.data() - module().nodes.data()),
          .count = static_cast<std::uint32_t>(expression.size())};
}

Condition Control::ConditionOf(Expression expression) const {
  return {.program = program().program,
          .module = frame().module,
          .expression = RangeOf(expression),
          .parameters = frame().parameters};
}

// Of the module in execution. Nothing: an error was raised.
std::optional<bool> Control::Truth(ExprRange range) {
  const std::optional<Value> value = Eval({module().nodes.data() + range.first, range.count});
  if (!value) return std::nullopt;
  return value->truth();
}

std::optional<bool> Control::Truth(const Condition& condition) {
  const Module& owner =
      condition.program->executable.modules[static_cast<std::size_t>(condition.module)].module;
  WithParameters variables(*this, condition.parameters);
  const Result<Value> value = Evaluate(
      {owner.nodes.data() + condition.expression.first, condition.expression.count}, variables);
  if (value) return value->truth();
  Raise(value.error().code, value.error().detail);
  return std::nullopt;
}

void Control::Let(const Instruction& i) {
  const ExprNode& target = module().Value(i, 0).back();
  const std::optional<Value> value = Eval(module().Value(i, 1));
  if (!value) return;
  const ValueType type = target.group == VariableGroup::kPar
                             ? module().parameter_types[target.index]
                             : TypeOf(target.group);
  const Result<float> converted = ConvertTo(type, *value);
  if (!converted) return Raise(converted.error().code, converted.error().detail);
  Write(target.variable(), *converted);
}

// ASSIGN v = value / n: the value in binary, least significant bit first. OPT-7.102, 7.103
void Control::Assign(const Instruction& i) {
  const ExprNode& target = module().Value(i, 0).back();
  const std::optional<double> value = Real(module().Value(i, 1));
  if (!value) return;
  const Result<int> number = TruncateToInteger(static_cast<float>(*value));
  if (!number) return Raise(number.error().code, number.error().detail);
  const int width = i.numbers[0];
  if (*number < 0 || (width < 16 && *number >= (1 << width)) ||
      target.index + width > kVariableCount) {
    return Raise(ErrorCode::kAssignGroup, std::to_string(*number) + " into " +
                                              std::to_string(width) + " places from " +
                                              std::string(GroupName(target.group)) + "[" +
                                              std::to_string(target.index) + "]");
  }
  for (int bit = 0; bit < width; ++bit) {
    const Variable place{target.group, static_cast<std::uint8_t>(target.index + bit)};
    if (!Write(place, static_cast<float>(*number >> bit & 1))) return;
  }
}

// UPDATE, IMAGE, REAL. Outputs that become connected are set from their images at that moment.
void Control::SetGroups(const Instruction& i) {
  if (i.op == Op::kUpdate) {
    if (i.Has(kOn)) {
      modal().updated = static_cast<std::uint8_t>(modal().updated | i.choice);
    } else {
      modal().updated = static_cast<std::uint8_t>(modal().updated & ~i.choice);
    }
  } else if (i.op == Op::kImage) {
    modal().imaged = static_cast<std::uint8_t>(modal().imaged | i.choice);
  } else {
    modal().imaged = static_cast<std::uint8_t>(modal().imaged & ~i.choice);
  }
  ConnectOutputs(i.choice);
}

std::optional<std::string> Control::ReadVariable(std::string_view name) const {
  return ReadByName(s_.machine.data, name);
}

}  // namespace rmlcell::optimo
