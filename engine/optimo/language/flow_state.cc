#include "engine/optimo/language/flow_state.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::optimo {
namespace {

constexpr int kGas2Output = 8, kGas3Output = 9, kSensorOutput = 11;  // OPT-5.39
constexpr std::uint8_t kTinyMovesMax = 3;

Known Join(Known a, Known b) { return a == b ? a : Known::kMaybe; }

template <class T>
void Join(std::optional<T>& a, const std::optional<T>& b) {
  if (a != b) a.reset();
}

void StepWork(const Instruction& i, FlowState& state) {
  const ProcessSet bit = ProcessBit(i);
  const bool laser = i.numbers[0] != 2;
  if (i.Has(kOn)) {
    state.on_all |= bit;
    state.on_some |= bit;
    if (i.Has(kEnd)) {  // switches itself off, whenever that is: nobody has to (OPT-3.38)
      state.on_all &= ~bit;
      state.on_some &= ~bit;
    }
    if (laser) {
      state.beam = Known::kYes;
      state.unpierced = i.numbers[0] == 0 ? Known::kYes : Known::kNo;  // WORK 1 dwells by itself
    }
  } else {
    state.on_all &= ~bit;
    state.on_some &= ~bit;
    state.after_off = state.beam == Known::kYes ? Known::kYes : state.after_off;
    state.beam = Known::kNo;  // WORK 2 OFF, too: OPT-3.24
    state.unpierced = Known::kNo;
  }
  if (i.Has(kStart) || i.Has(kEnd)) state.beam = state.unpierced = Known::kMaybe;
}

void StepOutput(const Module& module, const Instruction& i, FlowState& state) {
  const ExprNode& target = module.Value(i, 0)[0];
  const auto variable = OwnVariable(target);
  if (i.op == Op::kLet && variable) state.set.set(*variable);
  if (i.op == Op::kAssign && target.group == VariableGroup::kVl && variable) {
    for (std::size_t v = 0; v < i.numbers[0] && *variable + v < kOwnVariables; ++v)
      state.set.set(*variable + v);
  }
  if (target.op != Node::kVariable || target.group != VariableGroup::kOl) return;
  Known value = Known::kMaybe;
  if (i.op == Op::kLet) {
    if (const auto literal = LiteralValueOf(module.Value(i, 1)))
      value = *literal != 0.0F ? Known::kYes : Known::kNo;
  }
  const int first = target.index, last = first + (i.op == Op::kAssign ? i.numbers[0] : 1) - 1;
  const auto set = [&](int output, Known& field) {
    if (first <= output && output <= last) field = value;
  };
  set(kGas2Output, state.gas_2);
  set(kGas3Output, state.gas_3);
  set(kSensorOutput, state.sensor);
}

void StepMove(const Module& module, std::uint32_t at, FlowState& state) {
  const Instruction& i = module.instructions[at];
  const auto target = state.coord == CoordType::kRobot ? std::nullopt : LiteralTarget(module, i);
  const bool fly = i.Has(kFly);
  const bool straight = state.path == PathType::kLin || state.path == PathType::kPtp;
  const bool measured = straight && target && state.target;
  const double length = measured ? Distance(*target, *state.target) : HUGE_VAL;
  state.short_fly = fly && length < kShortFly_mm ? at : kNoIndex;
  const bool tiny = fly && length < kTinyFly_mm;
  state.tiny_moves =
      tiny ? std::min<std::uint8_t>(kTinyMovesMax, static_cast<std::uint8_t>(state.tiny_moves + 1))
           : 0;
  state.target =
      i.Has(kEnd) || i.Has(kTime) || state.path == PathType::kHole ? std::nullopt : target;
  state.unpierced = Known::kNo;
  state.after_off = Known::kNo;
}

}  // namespace

std::optional<std::size_t> OwnVariable(const ExprNode& node) {
  if (node.op != Node::kVariable) return std::nullopt;
  switch (node.group) {
    case VariableGroup::kVr:
      return node.index;
    case VariableGroup::kVi:
      return 100U + node.index;
    case VariableGroup::kVl:
      return 200U + node.index;
    default:
      return std::nullopt;
  }
}

std::optional<float> LiteralValueOf(Expression value) {
  if (value.size() != 1 || value[0].op == Node::kVariable || value[0].op == Node::kName)
    return std::nullopt;
  return value[0].number;
}

std::optional<std::array<float, 3>> LiteralTarget(const Module& module, const Instruction& move) {
  std::array<float, 3> target{};
  for (std::size_t v = 0; v < target.size(); ++v) {
    const auto value = LiteralValueOf(module.Value(move, static_cast<int>(v)));
    if (!value) return std::nullopt;
    target[v] = *value;
  }
  return target;
}

double Distance(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  double sum = 0.0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    const double d = static_cast<double>(a[v]) - static_cast<double>(b[v]);
    sum += d * d;
  }
  return std::sqrt(sum);
}

FlowState FlowState::AtStart() {
  FlowState state;
  state.reached = true;
  state.speed = 70.0F;  // OPT-2.10
  return state;
}

FlowState FlowState::Nothing() {
  FlowState state;
  state.reached = true;
  Forget(kTouchesAll, state);
  state.set.set();
  return state;
}

FlowState FlowState::InErrorHandler() {
  FlowState state = Nothing();
  state.beam = state.unpierced = state.after_off = Known::kNo;
  return state;
}

bool Merge(FlowState& into, const FlowState& other) {
  if (!into.reached) {
    into = other;
    return true;
  }
  const FlowState before = into;
  Join(into.speed, other.speed);
  Join(into.path, other.path);
  Join(into.coord, other.coord);
  Join(into.target, other.target);
  into.beam = Join(into.beam, other.beam);
  into.gas_2 = Join(into.gas_2, other.gas_2);
  into.gas_3 = Join(into.gas_3, other.gas_3);
  into.sensor = Join(into.sensor, other.sensor);
  into.unpierced = Join(into.unpierced, other.unpierced);
  into.rotated = Join(into.rotated, other.rotated);
  into.after_off = Join(into.after_off, other.after_off);
  into.processes_known = into.processes_known && other.processes_known;
  into.on_all &= other.on_all;
  into.on_some |= other.on_some;
  into.defined_all &= other.defined_all;
  into.defined_some |= other.defined_some;
  if (into.short_fly != other.short_fly) into.short_fly = kNoIndex;
  into.tiny_moves = std::min(into.tiny_moves, other.tiny_moves);
  into.set &= other.set;
  return !(into == before);
}

void Step(const Module& module, std::uint32_t at, FlowState& state) {
  const Instruction& i = module.instructions[at];
  switch (i.op) {
    case Op::kSpeed:
      state.speed = LiteralValueOf(module.Value(i, 0));
      break;
    case Op::kPath:
      state.path = static_cast<PathType>(i.choice);
      break;
    case Op::kCoord:
      if (state.coord != static_cast<CoordType>(i.choice)) state.target.reset();
      state.coord = static_cast<CoordType>(i.choice);
      break;
    case Op::kMove:
      StepMove(module, at, state);
      break;
    case Op::kZero:
      state.target.reset();
      break;
    case Op::kWorkdef:
      state.defined_all |= ProcessBit(i);
      state.defined_some |= ProcessBit(i);
      break;
    case Op::kWork:
      StepWork(i, state);
      break;
    case Op::kDelay:
      state.unpierced = Known::kNo;
      break;
    case Op::kSysdef: {
      state.target.reset();
      state.rotated = Known::kNo;
      for (int v = 3; v < 6 && i.value_count == 6; ++v) {
        const auto angle = LiteralValueOf(module.Value(i, v));
        if (!angle || *angle != 0.0F) state.rotated = Known::kMaybe;
      }
      break;
    }
    case Op::kTcp:
      state.target.reset();
      break;
    case Op::kLet:
    case Op::kAssign:
      StepOutput(module, i, state);
      break;
    case Op::kFunction:
      Forget(kTouchesAll, state);
      state.set.set();
      break;
    case Op::kCall:
      state.set.set();
      // Modal values and WORKDEFs come back, processes are off (OPT-7.12, OPT-3.33).
      Forget(kTouchesOutput | kTouchesMotion | kTouchesOffset, state);
      state.beam = state.unpierced = Known::kNo;
      break;
    default:
      break;
  }
}

std::uint16_t TouchedBy(const Instruction& i) {
  switch (i.op) {
    case Op::kSpeed:
    case Op::kPath:
    case Op::kCoord:
      return kTouchesModal;
    case Op::kMove:
    case Op::kZero:
      return kTouchesMotion;
    case Op::kWork:
    case Op::kWorkdef:
      return kTouchesProcess;
    case Op::kLet:
    case Op::kAssign:
      return kTouchesOutput;
    case Op::kSysdef:
    case Op::kTcp:
      return kTouchesOffset;
    case Op::kDelay:
      return kTouchesMotion;
    case Op::kCall:
      return kTouchesOutput | kTouchesMotion | kTouchesOffset;
    case Op::kFunction:
      return kTouchesAll;
    default:
      return 0;
  }
}

void Forget(std::uint16_t touched, FlowState& state) {
  if ((touched & kTouchesModal) != 0) {
    state.speed.reset();
    state.path.reset();
    state.coord.reset();
  }
  if ((touched & kTouchesProcess) != 0) {
    state.processes_known = false;
    state.beam = state.unpierced = state.after_off = Known::kMaybe;
    state.on_all = state.on_some = 0;
  }
  if ((touched & kTouchesOutput) != 0) state.gas_2 = state.gas_3 = state.sensor = Known::kMaybe;
  if ((touched & kTouchesMotion) != 0) {
    state.target.reset();
    state.short_fly = kNoIndex;
    state.tiny_moves = 0;
    state.unpierced = state.after_off = Known::kMaybe;
  }
  if ((touched & kTouchesOffset) != 0) {
    state.target.reset();
    state.rotated = Known::kMaybe;
  }
}

}  // namespace rmlcell::optimo
