// A run that begins at a command. LIVE-6
#include <algorithm>
#include <utility>

#include "engine/rml1/entry.h"
#include "engine/rml1/machine_state.h"
#include "engine/rml1/run.h"
#include "engine/rml1/state_items.h"

namespace rmlcell::rml1 {
namespace {

// Where the machine of these bytes stands, as far as its travel reaches.
Point PlaceOf(std::string_view machine_state, const Profile& profile) {
  const Result<MachineState> now = ReadMachineState(machine_state, profile);
  RMLCELL_CHECK(now);
  Device device(profile);
  device.Restore(now->registers, now->at);
  return device.carriage().physical();
}

}  // namespace

Status MillRun::HaltBefore(const machine::StepTarget& target) {
  int command = target.at.step;
  if (target.byte_offset >= 0) {
    const Result<int> found = CommandAt(stream(), target.byte_offset, state_.device);
    if (!found) return found.error();
    command = *found;
  }
  const bool of_stream = target.byte_offset >= 0 || target.at.program == setup_.main_program;
  if (command < 1 || !of_stream || target.occurrence != 1) {
    return Error{ErrorCode::kCellStepUnreachable,
                 "a stream has commands from 1 on, and comes to each of them once",
                 {}};
  }
  state_.halts.entry = command;
  return {};
}

void MillRun::ForgetTarget() {
  state_.halts.entry = 0;
  state_.reached.reset();
}

machine::StepFacts MillRun::FactsBefore(const machine::Place& place) const {
  const Registers& registers = state_.device.registers();
  return {.place = place,
          .stands = !Moves(),
          .tool_down = registers.tool_down || registers.IsBelowSurface(state_.tool.z)};
}

void MillRun::HaltAtTarget() {
  State& s = state_;
  machine::Place place = s.place;
  place.step = s.halts.entry;
  place.line = 0;
  place.byte_offset = -1;
  s.reached = FactsBefore(place);
  s.reached->inside_command = s.device.pending();
  s.reached->may_pass = s.halts.entry > 1;
  BeginHalt(HaltCause::kEntry);
}

std::vector<machine::StateItem> MillRun::items() const {
  return ItemsOf(state_.device, profile(),
                 {.at = ToolAt(TipNow()), .spindle_turns = SpindleTurns()}, "as the program means");
}

std::vector<machine::ApproachMotion> MillRun::PlanApproach(std::string_view machine_state,
                                                           machine::ApproachWay /*way*/) const {
  std::vector<machine::ApproachMotion> motions;
  const Point from = PlaceOf(machine_state, profile());
  for (const Action& action :
       PlanEntry(profile(), state_.device.registers(), SpindleTurns(), from, state_.tool)) {
    if (action.kind != Action::Kind::kMotion) continue;
    const motion::TipPose tip = PoseOf(profile(), action.to);
    motions.push_back({.path = NameOfApproach(action),
                       .to = {.column = tip.tip, .a_rad = tip.a_rad, .b_rad = 0.0},
                       .feed_mm_s = action.rapid ? 0.0 : action.speed_mm_s,
                       .beyond = OutsideOf(profile(), action.to)});
  }
  return motions;
}

// The device has done all that lies before; the tool stands elsewhere, and the spindle stands. What
// is planned ahead begins with the way there.
void MillRun::Enter(const machine::EntryOrder& order) {
  RMLCELL_CHECK(state_.reached);
  State& s = state_;
  const Point from = PlaceOf(order.machine_state, profile());
  const bool turns = SpindleTurns();
  const std::vector<Action> way = PlanEntry(profile(), s.device.registers(), turns, from, s.tool);
  s.place = s.reached->place;
  s.physical.ForgetTotals();
  ForgetTarget();
  s.override_percent = std::clamp(order.override_percent, kOverrideMin, kOverrideMax);
  s.tool = from;
  s.scout = Scout(s.device, s.sender);
  s.ahead = LookAhead(profile(), from, s.override_percent);
  s.ride = motion::PathRide(motion::HoldRamp::kPlannedAnew);
  s.approach.assign(way.begin(), way.end());
  for (const Action& action : way) {
    if (action.kind == Action::Kind::kMotion) s.ahead.Add(action);
    s.ahead.EndChain();
  }
  s.approaching = true;
  s.approach_begun = s.now;
  s.halts_at_entry = order.halt_at_entry;
  s.spindle_to_come = turns;
  s.step_over = false;
  s.rest_left = false;
  s.wait_left = SimTime::zero();
  s.busy = Busy::kNothing;
  s.halt = s.halt_wanted = HaltCause::kNone;
  s.next_input = 0;
  s.phase = machine::RunPhase::kRunning;
  s.clock.Set(s.now);
}

void MillRun::GoOnApproaching() {
  State& s = state_;
  if (std::exchange(s.step_over, false) && s.halts.after_each) return BeginHalt(HaltCause::kSingle);
  if (!s.approach.empty()) {
    const Action action = s.approach.front();
    s.approach.pop_front();
    if (action.kind == Action::Kind::kSpindleStart) s.spindle_to_come = false;
    s.step_over = action.kind == Action::Kind::kMotion;
    return Begin(action);
  }
  s.approaching = false;
  s.approached = s.now - s.approach_begun;
  observer_.OnEntered(s.now);
  if (s.halts_at_entry) BeginHalt(HaltCause::kEntry);
}

}  // namespace rmlcell::rml1
