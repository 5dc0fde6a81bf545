// A run that begins at a step. LIVE-6
#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/core/indices.h"
#include "engine/machine/step_entry.h"
#include "engine/optimo/control/control.h"
#include "engine/optimo/control/state_items.h"

namespace rmlcell::optimo {
namespace {

constexpr double kAcrossSpeed_percent = 40.0;
constexpr double kDownSpeed_percent = 10.0;

motion::PathPiece PathOf(const ApproachLeg& leg, const motion::Head& head,
                         const motion::AxisPose& from) {
  return leg.path == PathType::kPtp ? motion::PathPiece::Joint(from, leg.to)
                                    : motion::PathPiece::Line(head.TipOf(from), head.TipOf(leg.to));
}

// Straight up, across, straight down. One that stands higher than the way across comes down to it
// there: nothing is so high.
std::vector<ApproachLeg> LegsBetween(const motion::AxisPose& from, const motion::AxisPose& to,
                                     double safe_z_mm) {
  const double across_z = std::max(safe_z_mm, to.column.z());
  ApproachLeg up{.to = from, .speed_percent = kAcrossSpeed_percent};
  up.to.column.z() = std::max(from.column.z(), across_z);
  ApproachLeg across{.to = to, .speed_percent = kAcrossSpeed_percent};
  across.to.column.z() = across_z;
  const ApproachLeg down{.path = PathType::kLin, .to = to, .speed_percent = kDownSpeed_percent};
  std::vector<ApproachLeg> legs{up, across, down};
  motion::AxisPose at = from;
  std::erase_if(legs, [&](const ApproachLeg& leg) {
    return !(motion::PathPiece::Joint(std::exchange(at, leg.to), leg.to).length() > 0.0);
  });
  return legs;
}

bool IsOpen(const EntryState::TimedGosub& gosub, const ProgramCounter& counter) {
  return std::tuple(counter.call_level(), counter.level(), counter.frame().returns.size()) >=
         std::tuple(gosub.calls, gosub.level, gosub.depth);
}

}  // namespace

Status Control::HaltBefore(const machine::StepTarget& target) {
  if (target.byte_offset >= 0) {
    return Error{ErrorCode::kCellStepUnreachable, "a program of this machine has no bytes", {}};
  }
  s_.entry = {.target = target};
  return {};
}

void Control::ForgetTarget() {
  s_.entry.target.reset();
  s_.entry.reached.reset();
  s_.entry.halted.reset();
}

machine::StepFacts Control::FactsAt(const machine::Place& here) const {
  const bool in_background = std::ranges::any_of(
      s_.works.tasks, [](const WorkTask& task) { return task.stage != WorkStage::kEnd; });
  const GoesOn program = s_.ride.program;
  return {.place = here,
          .stands = !ride_.busy() && !ride_.passing(),
          .passes = ride_.passing(),
          .work_active = std::ranges::any_of(
              counter_.programs(),
              [](const ProgramContext& context) { return context.processes.any_on(); }),
          .beside = program == GoesOn::kBeside || program == GoesOn::kComes || watch_.stands() ||
                    in_background,
          .in_timed_gosub = std::ranges::any_of(
              s_.entry.timed_gosubs,
              [&](const EntryState::TimedGosub& gosub) { return IsOpen(gosub, counter_); })};
}

// A step is about to begin.
void Control::NoteStep(const machine::Place& here) {
  EntryState& entry = s_.entry;
  if (!entry.target && step_watcher_ == nullptr) return;
  std::erase_if(entry.timed_gosubs,
                [&](const EntryState::TimedGosub& gosub) { return !IsOpen(gosub, counter_); });
  if (entry.target && entry.target->at == machine::ProgramStep{here.program, here.step})
    ++entry.passes;
  if (step_watcher_ != nullptr) step_watcher_->OnStepDue(FactsAt(here));
}

void Control::NoteTimedGosub() {
  if (!s_.entry.target && step_watcher_ == nullptr) return;
  s_.entry.timed_gosubs.push_back({.calls = counter_.call_level(),
                                   .level = counter_.level(),
                                   .depth = counter_.frame().returns.size()});
}

// True: it comes to rest before the step, or stands there.
bool Control::HaltsBefore(const Instruction& i, const machine::Place& here) {
  EntryState& entry = s_.entry;
  if (!entry.target || entry.halted || waits_.condition_met()) return false;
  if (entry.target->at != machine::ProgramStep{here.program, here.step}) return false;
  if (entry.passes + 1 != entry.target->occurrence) return false;
  if (!entry.reached) {
    entry.reached = FactsAt(here);
    // A /FLY that this instruction would have ended anyway is none.
    const bool ends = ride_.passing() && NeedsStandstill(i);
    entry.reached->passes = ride_.passing() && !ends;
    entry.reached->stands = entry.reached->stands || ends;
  }
  if (StandFirst()) return true;
  entry.halted = entry.reached;
  halts_.Halt(machine::HaltReason::kBreakpoint, "ENTRY");
  return true;
}

std::vector<machine::StateItem> Control::Items() const {
  std::vector<machine::StateItem> items;
  if (!counter_.empty()) items = ItemsOf(counter_.programs(), Stack(), now().now);
  items.push_back({"clamps", "below SAFE_Z", machine::StartAction::kAsk});
  for (machine::StateItem& item : ItemsOf(Kept())) items.push_back(std::move(item));
  return items;
}

std::vector<machine::ApproachMotion> Control::PlanApproach(const MachineState& now,
                                                           machine::ApproachWay way) const {
  if (way == machine::ApproachWay::kDirect) return {};
  std::vector<machine::ApproachMotion> motions;
  motion::AxisPose from = now.axes;
  for (const ApproachLeg& leg : LegsBetween(from, ride_.planned_axes(), parameters_.safe_z_mm)) {
    const bool straight = leg.path == PathType::kLin;
    machine::ApproachMotion& made = motions.emplace_back();
    made.path = NameOfPath(leg.path);
    made.to = leg.to;
    made.feed_mm_s = straight ? leg.speed_percent / 100.0 * parameters_.limits.tip_speed_mm_s : 0.0;
    for (const BeyondTravel& one : travel_.BeyondTravelOf(PathOf(leg, ride_.head(), from))) {
      made.beyond.push_back({.axis = one.axis, .excess = one.excess, .at_target = one.at_target});
    }
    from = leg.to;
  }
  return motions;
}

// What the program has set is as it is; what stands outside is as it is now. The beam stays off
// until the next WORK ON, whatever process is ON (OPT-6.21).
void Control::Enter(const MachineState& now, const machine::EntryOrder& order) {
  RMLCELL_CHECK(s_.entry.halted);
  const machine::Place place = s_.entry.halted->place;
  const motion::AxisPose there = s_.ride.planned_axes;
  s_.entry = {.arrival = EntryState::Arrival{.begun = this->now().now,
                                             .outputs = s_.actuators.outputs,
                                             .gas_refused = s_.actuators.gas_refused,
                                             .works = std::exchange(s_.works.tasks, {}),
                                             .halts = order.halt_at_entry}};
  if (order.way == machine::ApproachWay::kSafe) {
    for (ApproachLeg& leg : LegsBetween(now.axes, there, parameters_.safe_z_mm))
      s_.entry.legs.push_back(leg);
  }
  const std::uint64_t next_tag = s_.ride.next_tag;
  s_.ride = RideState(parameters_.limits);
  s_.ride.next_tag = next_tag;
  s_.ride.axes = s_.ride.planned_axes = now.axes;
  s_.ride.override_percent = order.override_percent;
  s_.actuators = ActuatorState(parameters_.laser);
  s_.actuators.outputs = now.outputs;
  s_.actuators.zeroed = s_.moves.zeroed = now.zeroed;
  if (!s_.simul) s_.simul = now.simul;  // armed for a start of the whole program
  if (now.door_open) s_.actuators.beam = s_.actuators.beam.DoorOpened();
  s_.data.area.il_physical = now.data.il_physical;
  s_.data.area.ia_physical = now.data.ia_physical;
  s_.halts = {.breakpoint = s_.halts.breakpoint};
  s_.effects = {};
  s_.waits = {};
  s_.watch = {};
  s_.travel = {};
  s_.process_watch = {};
  s_.moves.speed_limited_told = false;
  s_.next_input = 0;
  this->now().place = place;
  this->now().phase = machine::RunPhase::kRunning;
}

// One motion after the other; HOLD, STOP and SINGLE halt it like a program.
void Control::GoOnApproaching() {
  if (halts_.due()) {
    if (StandFirst()) return;
    if (halts_.HaltHere(false)) return;
  }
  if (s_.entry.legs.empty()) return ArriveAtEntry();
  const ApproachLeg leg = s_.entry.legs.front();
  s_.entry.legs.pop_front();
  // No error of the program: its ERR has nothing to do with it.
  if (const Status appended = Append(leg); !appended)
    return Finish(machine::OutcomeKind::kFailed, appended.error().code, appended.error().detail);
  halts_.EndStep({});
}

Status Control::Append(const ApproachLeg& leg) {
  const motion::PathPiece path = PathOf(leg, ride_.head(), ride_.planned_axes());
  const bool straight = leg.path == PathType::kLin;
  const double speed = leg.speed_percent / 100.0 * ride_.override_percent() / 100.0;
  motion::MoveCommand command{.kind = straight ? motion::MoveCommand::Kind::kContour
                                               : motion::MoveCommand::Kind::kPointToPointAxes,
                              .path = path,
                              .head = ride_.head(),
                              .speed_fraction = std::min(speed, 1.0)};
  const MoveNote note{
      .place = now().place,
      .program_point = motion::ProgramPoint::AsMachine(straight ? ride_.head().TipOf(leg.to).tip
                                                                : leg.to.column),
      .program_a = leg.to.a_rad,
      .feed_mm_s = straight ? command.speed_fraction * parameters_.limits.tip_speed_mm_s : 0.0,
      .path = leg.path,
      .approach = true,
      .kind = command.kind,
      .speed_percent = leg.speed_percent};
  return ride_.Append(std::move(command), note);
}

// What the program had switched on or off is so from here, and what is left of its times begins.
// The rotary table was not moved: a person has seen to it.
void Control::ArriveAtEntry() {
  const EntryState::Arrival arrival = *s_.entry.arrival;
  s_.entry = {};
  const auto carry = [&](PassageEffect::Kind kind, std::size_t index, double value) {
    actuators_.Carry(
        {.kind = kind, .place = now().place, .index = static_cast<int>(index), .value = value});
  };
  const Indices numbers = IndicesOf(arrival.outputs.logical);
  for (const bool on : {false, true}) {  // one assist gas is off before the other is on
    for (const std::size_t n : numbers) {
      if (arrival.outputs.logical[n] == on) carry(PassageEffect::Kind::kOutput, n, on ? 1.0 : 0.0);
    }
  }
  for (const std::size_t n : numbers)
    carry(PassageEffect::Kind::kAnalogue, n, static_cast<double>(arrival.outputs.analogue[n]));
  carry(PassageEffect::Kind::kSchedule, static_cast<std::size_t>(arrival.outputs.schedule), 0.0);
  s_.actuators.gas_refused = arrival.gas_refused;
  telling_.observer().OnEntered(now().now);
  const SimTime lasted = now().now - arrival.begun;
  s_.entry.approached = lasted;
  s_.works.tasks = arrival.works;
  works_.Shift(lasted);
  counter_.Shift(lasted);
  if (arrival.halts) halts_.Halt(machine::HaltReason::kBreakpoint, "ENTRY");
}

}  // namespace rmlcell::optimo
