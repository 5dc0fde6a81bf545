#include "engine/optimo/control/data_access.h"

namespace rmlcell::optimo {
namespace {

constexpr int kFirstWorkFlag = 87;  // IL[87 + p], OPT-3.37
constexpr int kMotionFlag = 95;     // behind the last of them, OPT-7.68

// IL that the control itself sets.
bool IsOwnFlag(int index) { return index >= kFirstWorkFlag && index <= kMotionFlag; }

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

bool DataAccess::Connected(std::uint8_t group) const {
  return (counter_.modal().updated & group) != 0 && (counter_.modal().imaged & group) == 0 &&
         !situation_.simulating();
}

// The outside as it is now.
double DataAccess::InputNow(VariableGroup group, int index) const {
  if (group == VariableGroup::kIl) {
    if (index == kMotionFlag) return ride_.moves() || ride_.more_to_come() ? 1.0 : 0.0;
    if (IsOwnFlag(index)) {
      return counter_.program().processes.flag(index - kFirstWorkFlag) ? 1.0 : 0.0;
    }
    return s_.area.il_physical[static_cast<std::size_t>(index)] ? 1.0 : 0.0;
  }
  if (index <= 2) {
    const motion::MachinePoint point =
        counter_.modal().coord == CoordType::kAbsol ? ride_.tip().tip : ride_.axes().column;
    return index == 0 ? point.x() : index == 1 ? point.y() : point.z();
  }
  if (index == 3) return ride_.axes().a_rad;
  if (index == 4) return ride_.axes().b_rad;
  return s_.area.ia_physical[static_cast<std::size_t>(index)];
}

// Whether the run itself has given the variable its value: an instruction, a caller, the control.
bool DataAccess::IsOfTheRun(Variable variable) const {
  const int n = variable.index;
  switch (variable.group) {
    case VariableGroup::kIl:
      return IsOwnFlag(n);
    case VariableGroup::kIa:
      return false;
    case VariableGroup::kOa:
      if (n == 0) return true;
      break;
    default:
      break;
  }
  return s_.written[NumberOf(variable)];
}

float DataAccess::Read(Variable variable) {
  // What programs compute with comes first.
  if (const float* known = Known(variable)) return *known;
  const bool of_the_run = IsOfTheRun(variable);
  const float value = ValueOf(variable);
  if (!of_the_run) TellAssumed(variable, value);
  return value;
}

void DataAccess::TellAssumed(Variable variable, float value) const {
  machine::Assumed assumed{
      .group = GroupName(variable.group), .index = variable.index, .value = value};
  assumed.on_off = variable.group == VariableGroup::kVl || variable.group == VariableGroup::kIl ||
                   variable.group == VariableGroup::kOl;
  if (variable.group == VariableGroup::kIl) assumed.input = machine::InputKind::kLogical;
  if (variable.group == VariableGroup::kIa) assumed.input = machine::InputKind::kAnalogue;
  observer_.OnAssumed(assumed);
}

// An image that follows the outside is read anew with it.
float DataAccess::ValueOf(Variable variable) {
  const float value = Peek(variable);
  const auto n = static_cast<std::size_t>(variable.index);
  if (variable.group == VariableGroup::kIl) s_.area.il[n] = value != 0.0F;
  if (variable.group == VariableGroup::kIa) s_.area.ia[n] = value;
  return value;
}

float DataAccess::Peek(Variable variable) const {
  const DataArea& data = s_.area;
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
      if (Connected(kGroupIl) || IsOwnFlag(variable.index))
        return InputNow(variable.group, variable.index) != 0.0 ? 1.0F : 0.0F;
      return data.il[n] ? 1.0F : 0.0F;
    case VariableGroup::kOl:
      return data.ol[n] ? 1.0F : 0.0F;
    case VariableGroup::kIa:
      if (Connected(kGroupIa)) return static_cast<float>(InputNow(variable.group, variable.index));
      return data.ia[n];
    case VariableGroup::kOa:
      if (n == 0)
        return static_cast<float>(ride_.tip_speed_mm_s() * parameters_.cycle_s);  // OPT-7.69
      return data.oa[n];
    case VariableGroup::kPar:
      return counter_.frame().parameters[n % kParameterCount];
  }
  return 0.0F;
}

// On error nothing was written.
Status DataAccess::Write(Variable variable, float number) {
  s_.written[NumberOf(variable)] = true;
  return Put(variable, number, PassageEffects::When::kPassage);
}

// The machine follows as far as it can: a second gas waits for the first one to go off.
void DataAccess::WriteFromOutside(Variable variable, float number) {
  (void)Put(variable, number, PassageEffects::When::kNow);
}

Status DataAccess::Put(Variable variable, float number, PassageEffects::When when) {
  DataArea& data = s_.area;
  const auto n = static_cast<std::size_t>(variable.index);
  switch (variable.group) {
    case VariableGroup::kVr:
      data.vr[n] = number;
      break;
    case VariableGroup::kVi:
      data.vi[n] = number;
      break;
    case VariableGroup::kVl:
      data.vl[n] = number != 0.0F;
      break;
    case VariableGroup::kOl:
      return SetOutput(variable.index, number != 0.0F, when);
    case VariableGroup::kOa:
      data.oa[n] = number;
      if (Connected(kGroupOa)) {
        effects_.Show({.kind = PassageEffect::Kind::kAnalogue,
                       .place = situation_.place,
                       .index = variable.index,
                       .value = number},
                      when);
      }
      break;
    case VariableGroup::kPar:
      counter_.frame().parameters[n % kParameterCount] = number;
      break;
    case VariableGroup::kIl:
    case VariableGroup::kIa:
      break;  // refused by the checker (OPT-7.66)
  }
  return {};
}

// The image takes the value in any case; the machine follows unless the output is refused
// (OPT-5.38): a second gas when its turn comes, for the first may go off at the same passage.
Status DataAccess::SetOutput(int index, bool on, PassageEffects::When when) {
  s_.area.ol[static_cast<std::size_t>(index)] = on;
  if (!Connected(kGroupOl)) return {};
  if (on && index == kGas3 && parameters_.gas_channels < 3) {
    return Error{ErrorCode::kGas3NotFitted, {}, {}};
  }
  effects_.Show({.kind = PassageEffect::Kind::kOutput,
                 .place = situation_.place,
                 .index = index,
                 .value = on ? 1.0 : 0.0},
                when);
  return {};
}

void DataAccess::SetLastError(ErrorCode code) {
  s_.area.vi[99] = static_cast<float>(Lookup(code).number);
}

void DataAccess::CountExecution(bool selected_anew) {
  float& count = s_.area.vi[98];
  if (selected_anew) count = 0.0F;
  if (count < kIntegerMax) count += 1.0F;
}

Result<Value> DataAccess::Eval(Expression expression) { return Evaluate(expression, *this); }

// The variable, if the run has given it its value and reading it tells nothing.
const float* DataAccess::Known(Variable variable) const {
  if (variable.group == VariableGroup::kVr && s_.written[NumberOf(variable)])
    return &s_.area.vr[variable.index];
  if (variable.group == VariableGroup::kPar && counter_.in_function())
    return &counter_.frame().parameters[variable.index % kParameterCount];
  return nullptr;
}

// Sums and products of what is known, as Operate gives them: most of what coordinates are made of.
// Nothing: it is not as usual, and Evaluate looks at it anew.
std::optional<float> DataAccess::SumOfKnown(Expression expression) const {
  constexpr std::size_t kRoom = 8;
  float stack[kRoom];
  std::size_t top = 0;
  for (const ExprNode& node : expression) {
    if (Arity(node.op) == 0) {
      const float* number = node.op == Node::kVariable ? Known(node.variable()) : &node.number;
      if (number == nullptr || top == kRoom) return std::nullopt;
      stack[top++] = *number;
      continue;
    }
    if (top < 2) return std::nullopt;
    const float right = stack[--top];
    float& result = stack[top - 1];
    if (node.op == Node::kAdd) {
      result += right;
    } else if (node.op == Node::kSubtract) {
      result -= right;
    } else if (node.op == Node::kMultiply) {
      result *= right;
    } else {
      return std::nullopt;
    }
    if (!BecomesReal(result)) return std::nullopt;
  }
  return stack[0];
}

Result<double> DataAccess::Real(Expression expression) {
  if (const std::optional<float> sum = SumOfKnown(expression)) return static_cast<double>(*sum);
  const Result<Value> value = Evaluate(expression, *this);
  if (!value) return value.error();
  return static_cast<double>(value->number);
}

ExprRange DataAccess::RangeOf(Expression expression) const {
  return {.first = static_cast<std::uint32_t>(expression.data() - counter_.module().nodes.data()),
          .count = static_cast<std::uint32_t>(expression.size())};
}

Condition DataAccess::ConditionOf(Expression expression) const {
  return {.program = counter_.program().program,
          .module = counter_.frame().module,
          .expression = RangeOf(expression),
          .parameters = counter_.frame().parameters};
}

Result<bool> DataAccess::Truth(ExprRange range) {
  const Result<Value> value =
      Evaluate({counter_.module().nodes.data() + range.first, range.count}, *this);
  if (!value) return value.error();
  return value->truth();
}

Result<bool> DataAccess::Truth(const Condition& condition) {
  const Module& owner =
      condition.program->executable.modules[static_cast<std::size_t>(condition.module)].module;
  WithParameters variables(*this, condition.parameters);
  const Result<Value> value = Evaluate(
      {owner.nodes.data() + condition.expression.first, condition.expression.count}, variables);
  if (!value) return value.error();
  return value->truth();
}

bool DataAccess::HoldsNow(const Condition& condition) const {
  class Look final : public VariableAccess {
   public:
    explicit Look(const DataAccess& data) : data_(data) {}
    float Read(Variable variable) override { return data_.Peek(variable); }

   private:
    const DataAccess& data_;
  };
  Look look(*this);
  const Module& owner = condition.program->executable.modules.front().module;
  const Result<Value> value =
      Evaluate({owner.nodes.data() + condition.expression.first, condition.expression.count}, look);
  return !value || value->truth();
}

Status DataAccess::Execute(const Instruction& i) {
  if (i.op == Op::kLet) return Let(i);
  if (i.op == Op::kAssign) return Assign(i);
  return SetGroups(i);
}

Status DataAccess::Let(const Instruction& i) {
  const Module& module = counter_.module();
  const ExprNode& target = module.Value(i, 0).back();
  const Result<Value> value = Eval(module.Value(i, 1));
  if (!value) return value.error();
  const ValueType type = target.group == VariableGroup::kPar ? module.parameter_types[target.index]
                                                             : TypeOf(target.group);
  const Result<float> converted = ConvertTo(type, *value);
  if (!converted) return converted.error();
  return Write(target.variable(), *converted);
}

// ASSIGN v = value / n: the value in binary, least significant bit first. OPT-7.102, 7.103
// A group that ends beyond the last index is refused with the text, or with the object.
Status DataAccess::Assign(const Instruction& i) {
  const ExprNode& target = counter_.module().Value(i, 0).back();
  const Result<double> value = Real(counter_.module().Value(i, 1));
  if (!value) return value.error();
  const Result<int> number = TruncateToInteger(static_cast<float>(*value));
  if (!number) return number.error();
  const int width = i.numbers[0];
  if (*number < 0 || *number >= (1 << width)) {
    return Error{ErrorCode::kAssignGroup,
                 Told("value", *number) + " into " + Told("places", width) + " places from " +
                     ToldVariable(target.variable()),
                 {}};
  }
  for (int bit = 0; bit < width; ++bit) {
    const Variable place{target.group, static_cast<std::uint8_t>(target.index + bit)};
    if (const Status written = Write(place, static_cast<float>(*number >> bit & 1)); !written)
      return written.error();
  }
  return {};
}

// Outputs that become connected are set from their images at that moment.
Status DataAccess::SetGroups(const Instruction& i) {
  Modal& modal = counter_.modal();
  if (i.op == Op::kUpdate && i.Has(kOn)) {
    modal.updated = static_cast<std::uint8_t>(modal.updated | i.choice);
  } else if (i.op == Op::kUpdate) {
    modal.updated = static_cast<std::uint8_t>(modal.updated & ~i.choice);
  } else if (i.op == Op::kImage) {
    modal.imaged = static_cast<std::uint8_t>(modal.imaged | i.choice);
  } else {
    modal.imaged = static_cast<std::uint8_t>(modal.imaged & ~i.choice);
  }
  return ConnectOutputs(i.choice);
}

Status DataAccess::ConnectOutputs(std::uint8_t groups) {
  const DataArea& data = s_.area;
  const bool logical = (groups & kGroupOl) != 0;
  const bool analogue = (groups & kGroupOa) != 0 && Connected(kGroupOa);
  // Gas 3 makes way for gas 2, whose output comes first below.
  if (logical && !data.ol[kGas3]) {
    if (const Status off = SetOutput(kGas3, false); !off) return off.error();
  }
  for (int n = 0; n < kVariableCount; ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (logical) {
      if (const Status set = SetOutput(n, data.ol[at]); !set) return set.error();
    }
    if (!analogue) continue;
    effects_.Show({.kind = PassageEffect::Kind::kAnalogue,
                   .place = situation_.place,
                   .index = n,
                   .value = data.oa[at]},
                  PassageEffects::When::kNow);
  }
  return {};
}

}  // namespace rmlcell::optimo
