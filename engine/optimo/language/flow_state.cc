#include "engine/optimo/language/flow_state.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rmlcell::optimo {
namespace {

using Beams = Choice<BeamThere>;
using Sensors = Choice<Sensor>;

// What becomes of each value, in the order of the enumeration.
constexpr std::array<Beams::Values, 8> kBeamOn = {
    Beams::Bit(BeamThere::kFresh), Beams::Bit(BeamThere::kFresh), Beams::Bit(BeamThere::kFresh),
    Beams::Bit(BeamThere::kFresh), Beams::Bit(BeamThere::kOn),    Beams::Bit(BeamThere::kFresh)};
constexpr std::array<Beams::Values, 8> kBeamOnRamp = {
    Beams::Bit(BeamThere::kFreshRamp), Beams::Bit(BeamThere::kFreshRamp),
    Beams::Bit(BeamThere::kFreshRamp), Beams::Bit(BeamThere::kFreshRamp),
    Beams::Bit(BeamThere::kOn),        Beams::Bit(BeamThere::kFreshRamp)};
constexpr std::array<Beams::Values, 8> kBeamOff = {
    Beams::Bit(BeamThere::kOff),     Beams::Bit(BeamThere::kJustOff),
    Beams::Bit(BeamThere::kJustOff), Beams::Bit(BeamThere::kJustOff),
    Beams::Bit(BeamThere::kJustOff), Beams::Bit(BeamThere::kOff)};
constexpr std::array<Beams::Values, 8> kBeamDwell = {
    Beams::Bit(BeamThere::kOff), Beams::Bit(BeamThere::kJustOff), Beams::Bit(BeamThere::kOn),
    Beams::Bit(BeamThere::kOn),  Beams::Bit(BeamThere::kOn),      Beams::Bit(BeamThere::kUnknown)};
constexpr std::array<Beams::Values, 8> kBeamMove = {
    Beams::Bit(BeamThere::kOff), Beams::Bit(BeamThere::kOff), Beams::Bit(BeamThere::kOn),
    Beams::Bit(BeamThere::kOn),  Beams::Bit(BeamThere::kOn),  Beams::Bit(BeamThere::kUnknown)};
constexpr std::array<Sensors::Values, 8> kSensorSeen = {
    Sensors::Bit(Sensor::kOffSeen), Sensors::Bit(Sensor::kOffSeen), Sensors::Bit(Sensor::kOn),
    Sensors::Bit(Sensor::kUnknown)};
constexpr std::array<Choice<TinyMoves>::Values, 8> kOneMoreTiny = {
    Choice<TinyMoves>::Bit(TinyMoves::kOne), Choice<TinyMoves>::Bit(TinyMoves::kTwo),
    Choice<TinyMoves>::Bit(TinyMoves::kMore), Choice<TinyMoves>::Bit(TinyMoves::kMore)};

void Add(ProcessSet bits, Facts<ProcessSet>& to, Facts<ProcessSet>& from) {
  to.made |= bits;
  from.made &= ~bits;
  from.kept &= ~bits;
}

void StepWork(const Dwells& dwells, const Instruction& i, FlowState& state) {
  if (i.Has(kOn)) {
    if (i.Has(kEnd)) {  // switches itself off, whenever that is: nobody has to (OPT-3.38)
      Add(ProcessBit(i), state.off, state.on);
    } else {
      Add(ProcessBit(i), state.on, state.off);
    }
    if (i.numbers[0] == 0) state.beam.Map(kBeamOn);
    if (i.numbers[0] == 1) {
      const bool none = dwells.Of(i.numbers[1]) == Dwells::Kind::kNone;
      state.beam = none ? state.beam : Beams::Of(BeamThere::kOn);
      if (none) state.beam.Map(kBeamOnRamp);
    }
    if (i.numbers[0] != 2) state.sensor.Map(kSensorSeen);
  } else {
    Add(ProcessBit(i), state.off, state.on);
    state.beam.Map(kBeamOff);  // WORK 2 OFF, too: OPT-3.24
  }
  if (i.Has(kStart) || i.Has(kEnd)) state.beam = Beams::Of(BeamThere::kUnknown);
}

void StepOutput(const Module& module, const Instruction& i, FlowState& state) {
  const VariableSet set = VariablesSetBy(module, i);
  if (set.any()) {
    state.unset.made &= ~set;
    state.unset.kept &= ~set;
  }
  if (const auto gas = OutputSetBy(module, i, kGas2Output)) state.gas_2 = Choice<Output>::Of(*gas);
  if (const auto gas = OutputSetBy(module, i, kGas3Output)) state.gas_3 = Choice<Output>::Of(*gas);
  if (const auto sensor = OutputSetBy(module, i, kSensorOutput)) {
    state.sensor = Sensors::Of(*sensor == Output::kOn    ? Sensor::kOn
                               : *sensor == Output::kOff ? Sensor::kOff
                                                         : Sensor::kUnknown);
  }
}

void ForgetPath(FlowState& state) {
  state.target.Forget();
  state.short_fly.Forget();
  state.tiny_moves = Choice<TinyMoves>::Of(TinyMoves::kNone);
}

void StepMove(const Module& module, std::uint32_t at, FlowState& state) {
  const Instruction& i = module.instructions[at];
  const auto target =
      state.modes.coord() == CoordType::kRobot ? std::nullopt : LiteralTarget(module, i);
  const bool fly = i.Has(kFly);
  const auto path = state.modes.path();
  const auto before = state.target.known();
  const bool straight = path == PathType::kLin || path == PathType::kPtp;
  const double length = straight && target && before ? Distance_mm(*target, *before) : HUGE_VAL;
  state.short_fly.Forget();
  if (fly && length < kShortFly_mm) state.short_fly.Set(at);
  if (fly && length < kTinyFly_mm) {
    state.tiny_moves.Map(kOneMoreTiny);
  } else {
    state.tiny_moves = Choice<TinyMoves>::Of(TinyMoves::kNone);
  }
  state.target.Forget();
  if (target && !i.Has(kEnd) && !i.Has(kTime) && path != PathType::kHole) state.target.Set(*target);
  state.beam.Map(kBeamMove);
  state.sensor.Map(kSensorSeen);
}

void StepSysdef(const Module& module, const Instruction& i, FlowState& state) {
  state.target.Forget();
  state.turned = Choice<Turned>::Of(Turned::kNo);
  for (int v = 3; v < 6 && i.value_count == 6; ++v) {
    const auto angle = LiteralValueOf(module.Value(i, v));
    if (!angle || *angle != 0.0F) state.turned = Choice<Turned>::Of(Turned::kUnknown);
  }
}

// Its own TIMER knows the sequence numbers of its own program only (OPT-B.59).
void StepFunction(FlowState& state) {
  const Choice<Armed> timer = state.timer;
  state = FlowState::Unknown();
  state.timer = timer;
}

// Modal values and WORKDEFs come back; that no process is ON is what it needs to be made at all
// (OPT-7.12, OPT-3.33).
void StepCall(FlowState& state) {
  state.beam = Beams::Of(BeamThere::kOff);
  state.gas_2 = state.gas_3 = Choice<Output>::Of(Output::kUnknown);
  state.sensor = Sensors::Of(Sensor::kUnknown);
  state.turned = Choice<Turned>::Of(Turned::kUnknown);
  state.on = {};
  state.off = {.made = kAllProcesses};
  state.unset = {};
  ForgetPath(state);
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

VariableSet VariablesSetBy(const Module& module, const Instruction& i) {
  VariableSet set;
  if (i.op != Op::kLet && i.op != Op::kAssign) return set;
  const auto first = OwnVariable(module.Value(i, 0)[0]);
  if (!first) return set;
  const std::size_t count = i.op == Op::kAssign ? i.numbers[0] : 1U;
  for (std::size_t v = *first; v < *first + count && v < kOwnVariables; ++v) set.set(v);
  return set;
}

std::optional<Output> OutputSetBy(const Module& module, const Instruction& i, int output) {
  if (i.op != Op::kLet && i.op != Op::kAssign) return std::nullopt;
  const ExprNode& target = module.Value(i, 0)[0];
  if (target.op != Node::kVariable || target.group != VariableGroup::kOl) return std::nullopt;
  const int place = output - target.index;
  if (place < 0 || place >= (i.op == Op::kAssign ? i.numbers[0] : 1)) return std::nullopt;
  const auto value = LiteralValueOf(module.Value(i, 1));
  if (!value || *value < 0.0F) return Output::kUnknown;
  // ASSIGN: in binary, least significant bit first. OPT-7.102
  const bool on =
      i.op == Op::kLet ? *value != 0.0F : (static_cast<unsigned>(*value) >> place & 1U) != 0;
  return on ? Output::kOn : Output::kOff;
}

std::optional<float> LiteralValueOf(Expression value) {
  if (value.size() != 1 || value[0].op == Node::kVariable || value[0].op == Node::kName)
    return std::nullopt;
  return value[0].number;
}

std::optional<motion::ProgramPoint> LiteralTarget(const Module& module, const Instruction& move) {
  motion::ProgramVector target;
  for (int v = 0; v < 3; ++v) {
    const auto value = LiteralValueOf(module.Value(move, v));
    if (!value) return std::nullopt;
    target[v] = static_cast<double>(*value);
  }
  return motion::ProgramPoint::FromOrigin(target);
}

double Distance_mm(const motion::ProgramPoint& a, const motion::ProgramPoint& b) {
  return (a.from_origin() - b.from_origin()).norm();
}

FlowState FlowState::AtStart() {
  FlowState state;
  state.reached = true;
  state.modes = Modes::AtStart();
  state.beam = Beams::Of(BeamThere::kOff);
  state.gas_2 = state.gas_3 = Choice<Output>::Of(Output::kOff);
  state.sensor = Sensors::Of(Sensor::kOff);
  state.turned = Choice<Turned>::Of(Turned::kNo);
  state.timer = Choice<Armed>::Of(Armed::kNo);
  state.tiny_moves = Choice<TinyMoves>::Of(TinyMoves::kNone);
  state.off.made = state.undefined.made = kAllProcesses;
  state.unset.made.set();
  state.speed.Set(70.0F);  // OPT-2.10
  return state;
}

FlowState FlowState::Unknown() {
  FlowState state;
  state.reached = true;
  state.modes = Modes::Unknown();
  state.beam = Beams::Of(BeamThere::kUnknown);
  state.gas_2 = state.gas_3 = Choice<Output>::Of(Output::kUnknown);
  state.sensor = Sensors::Of(Sensor::kUnknown);
  state.turned = Choice<Turned>::Of(Turned::kUnknown);
  state.timer = Choice<Armed>::Of(Armed::kYes);  // when there is one
  state.tiny_moves = Choice<TinyMoves>::Of(TinyMoves::kNone);
  state.on.made = state.defined.made = kNotFollowed;
  return state;
}

FlowState FlowState::InErrorHandler() {
  FlowState state = Unknown();
  state.beam = Beams::Of(BeamThere::kOff);
  state.on = {};
  state.off = {.made = kAllProcesses};
  return state;
}

FlowState FlowState::Kept() {
  FlowState state;
  state.reached = true;
  state.modes = Modes::Kept();
  state.beam = Beams::Kept();
  state.gas_2 = state.gas_3 = Choice<Output>::Kept();
  state.sensor = Sensors::Kept();
  state.turned = Choice<Turned>::Kept();
  state.timer = Choice<Armed>::Kept();
  state.tiny_moves = Choice<TinyMoves>::Kept();
  state.on.kept = state.off.kept = state.defined.kept = state.undefined.kept = ~ProcessSet{0};
  state.unset.kept.set();
  state.speed = Single<float>::Kept();
  state.target = Single<motion::ProgramPoint>::Kept();
  state.short_fly = Single<std::uint32_t>::Kept();
  return state;
}

bool FlowState::BeamIsOn() const {
  return beam.IsAmong(Beams::Bits({BeamThere::kFresh, BeamThere::kFreshRamp, BeamThere::kOn}));
}

void FlowState::Then(const FlowState& next) {
  modes.Then(next.modes);
  beam.Then(next.beam);
  gas_2.Then(next.gas_2);
  gas_3.Then(next.gas_3);
  sensor.Then(next.sensor);
  turned.Then(next.turned);
  timer.Then(next.timer);
  tiny_moves.Then(next.tiny_moves);
  on.Then(next.on);
  off.Then(next.off);
  defined.Then(next.defined);
  undefined.Then(next.undefined);
  unset.Then(next.unset);
  speed.Then(next.speed);
  target.Then(next.target);
  short_fly.Then(next.short_fly);
}

void FlowState::ForgetDifferences(const FlowState& other) {
  const FlowState unknown = Unknown();
  const auto forget = [&](auto field) {
    if (!(this->*field == other.*field)) this->*field = unknown.*field;
  };
  forget(&FlowState::modes);
  forget(&FlowState::beam);
  forget(&FlowState::gas_2);
  forget(&FlowState::gas_3);
  forget(&FlowState::sensor);
  forget(&FlowState::turned);
  forget(&FlowState::tiny_moves);
  forget(&FlowState::speed);
  forget(&FlowState::target);
  forget(&FlowState::short_fly);
  if (!(on == other.on && off == other.off)) {
    on = unknown.on;
    off = unknown.off;
  }
  if (!(defined == other.defined && undefined == other.undefined)) {
    defined = unknown.defined;
    undefined = unknown.undefined;
  }
  timer.Join(other.timer);  // what was armed may have come, or not yet
  unset.made &= other.unset.made;
}

bool FlowState::Join(const FlowState& other) {
  if (!other.reached) return false;
  if (!reached) {
    *this = other;
    return true;
  }
  const FlowState before = *this;
  modes.Join(other.modes);
  beam.Join(other.beam);
  gas_2.Join(other.gas_2);
  gas_3.Join(other.gas_3);
  sensor.Join(other.sensor);
  turned.Join(other.turned);
  timer.Join(other.timer);
  tiny_moves.Join(other.tiny_moves);
  on.Join(other.on);
  off.Join(other.off);
  defined.Join(other.defined);
  undefined.Join(other.undefined);
  unset.Join(other.unset);
  speed.Join(other.speed);
  target.Join(other.target);
  short_fly.Join(other.short_fly);
  return !(*this == before);
}

void Step(const Module& module, const Dwells& dwells, std::uint32_t at, FlowState& state) {
  const Instruction& i = module.instructions[at];
  switch (i.op) {
    case Op::kInvalid:
      state = FlowState::Unknown();
      break;
    case Op::kSpeed:
      state.speed.Forget();
      if (const auto speed = LiteralValueOf(module.Value(i, 0))) state.speed.Set(*speed);
      break;
    case Op::kPath:
      state.modes.SetPath(static_cast<PathType>(i.choice));
      break;
    case Op::kCoord:
      if (state.modes.coord() != static_cast<CoordType>(i.choice)) state.target.Forget();
      state.modes.SetCoord(static_cast<CoordType>(i.choice));
      break;
    case Op::kMove:
      StepMove(module, at, state);
      break;
    case Op::kZero:
    case Op::kTcp:
      state.target.Forget();
      break;
    case Op::kWorkdef:
      Add(ProcessBit(i), state.defined, state.undefined);
      break;
    case Op::kWork:
      StepWork(dwells, i, state);
      break;
    case Op::kDelay:
      if (LiteralValueOf(module.Value(i, 0)) != 0.0F) state.beam.Map(kBeamDwell);
      break;
    case Op::kWait:
    case Op::kPause:
    case Op::kStop:
      state.beam.Map(kBeamDwell);  // the machine stands still, for how long is not known
      break;
    case Op::kSysdef:
      StepSysdef(module, i, state);
      break;
    case Op::kLet:
    case Op::kAssign:
      StepOutput(module, i, state);
      break;
    case Op::kFunction:
      StepFunction(state);
      break;
    case Op::kTimer:
      state.timer = Choice<Armed>::Of(i.target_count > 0 ? Armed::kYes : Armed::kNo);
      break;
    case Op::kCall:
      StepCall(state);
      break;
    default:
      break;
  }
}

}  // namespace rmlcell::optimo
