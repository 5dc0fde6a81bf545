// A run that begins at a step. LIVE-6
#include <utility>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

namespace rmlcell::machine {

// LIVE-2.10
Status Machine::MayStartAt(const StartAtStep& input) const {
  const Transition next = Next(state(), MachineEvent::kStartAtStep, guards());
  if (next.code) return Refusal(*next.code);
  if (const Status source = MaySource(input.source); !source) return source.error();
  if (CoverStops()) return Error{ErrorCode::kCellDoorOpen, "the cover is open", {}};
  return MayRun(family_.info(), memory_, input.program, input.brought.has_value());
}

StartBase Machine::BaseOfNow() const {
  return {.machine_state = standing_->Save(),
          .inputs = {},
          .mode = mode_,
          .override_percent = override_percent_};
}

// In SINGLE a run would halt behind each step, and pass no corner: it goes there as in CYCLE. A dry
// run that is armed waits for the next start.
RunSetup Machine::SetupTo(const StartAtStep& input) const {
  const StartBase base = input.base ? *input.base : BaseOfNow();
  RunSetup setup(parameters_);
  setup.programs = memory_.programs;
  if (input.brought) setup.programs[input.program] = *input.brought;
  setup.deleted_programs = memory_.deleted;
  setup.main_program = input.program;
  setup.schedules = memory_.schedules;
  setup.machine_state = base.machine_state;
  setup.mode = base.mode == Mode::kSingle ? Mode::kCycle : base.mode;
  setup.override_percent = base.override_percent;
  setup.simul = ProgramStep{};
  setup.inputs = base.inputs;
  setup.budget = kLiveBudget;
  return setup;
}

Result<StartPreview> Machine::Preview(const StartAtStep& input, const ReachLimits& limits,
                                      PartOnTable* part, const PartSoFar& so_far) const {
  if (const Status may = MayStartAt(input); !may) return may.error();
  return PreviewStart(family_, SetupTo(input),
                      {.target = input.target,
                       .way = input.way,
                       .off_until_work_on = input.off_until_work_on,
                       .machine_state = standing_->Save(),
                       .override_percent = override_percent_,
                       .part = part,
                       .part_so_far = so_far},
                      limits);
}

Result<std::uint64_t> Machine::OccurrenceAt(const StartAtStep& input, SimTime time,
                                            const ReachLimits& limits) const {
  return machine::OccurrenceAt(family_, SetupTo(input), input.target.at, time, limits);
}

Status Machine::Act(const StartAtStep& input) {
  if (const Status may = MayStartAt(input); !may) return may.error();
  if (input.prepared != nullptr) return Enter(input, *input.prepared);
  const Result<StartPreview> preview = Preview(input);
  if (!preview) return preview.error();
  return Enter(input, *preview);
}

// Whoever simulates it has no breakpoints, goes on at once where the program halts, and knows no
// approach: these take no time there.
void Machine::KeepForBase(const InputChange& change) {
  constexpr std::size_t kKept = 1'000;
  const RunState state = run_->state();
  const bool goes_on = change.kind == InputKind::kStart && state.phase == RunPhase::kHalted;
  const bool by_key = state.halted_by == HaltReason::kHold || state.halted_by == HaltReason::kStop;
  if (goes_on) {
    const SimTime since = halted_at_.value_or(state.time);
    if (!by_key && !state.approaching) not_in_base_ += state.time - since;
    halted_at_.reset();
  }
  // On the way to its entry keys halt what is no part of it.
  const bool key = change.kind == InputKind::kStart || change.kind == InputKind::kHold ||
                   change.kind == InputKind::kStop;
  if (!base_ || (state.approaching && key) || (goes_on && !by_key)) return;
  if (base_->inputs.size() >= kKept) return base_.reset();
  base_->inputs.push_back(change);
  base_->inputs.back().at = base_time();
}

SimTime Machine::base_time() const {
  RMLCELL_CHECK(run_ != nullptr);
  const RunState state = run_->state();
  if (state.approaching) return note_.entered->run_time;
  const bool by_key = state.halted_by == HaltReason::kHold || state.halted_by == HaltReason::kStop;
  const bool stands = state.phase == RunPhase::kHalted && halted_at_ && !by_key;
  return (stands ? *halted_at_ : state.time) - state.approached - not_in_base_;
}

// The run that went to the step had nobody who looked; this one is told of all that it does.
Status Machine::Enter(const StartAtStep& input, const StartPreview& preview) {
  if (!preview.may_begin()) return preview.refusals.front();
  Detail to_see;
  for (const StartDifference& one : preview.differences) {
    if (one.action == StartAction::kAsk && !input.acknowledged.contains(one.item))
      to_see += (to_see.empty() ? "" : ", ") + Told("item", one.item);
  }
  if (!to_see.empty())
    return Error{ErrorCode::kCellMachineState, "nobody has seen to " + std::move(to_see), {}};
  RunSetup setup = SetupTo(input);
  StartBase base{.machine_state = setup.machine_state,
                 .inputs = std::move(setup.inputs),
                 .mode = setup.mode,
                 .override_percent = setup.override_percent};
  std::erase_if(base.inputs, [&](const InputChange& one) { return one.at > preview.run_time; });
  setup.inputs.clear();  // from here on people and hosts give them
  const RunNote before = std::exchange(
      note_, {.number = note_.number + 1,
              .program = input.program,
              .source = input.source,
              .begun = now_ - preview.run_time,
              .entered = RunEntry{.at = preview.reach.target, .run_time = preview.run_time}});
  observer_.OnRunBegun(note_);
  Result<std::unique_ptr<Run>> run = family_.NewRun(std::move(setup), observer_);
  if (!run) {
    note_ = before;
    return run.error();
  }
  (*run)->Restore(*preview.reach.run->Save());
  (*run)->enterable()->Enter({.machine_state = standing_->Save(),
                              .override_percent = override_percent_,
                              .way = input.way,
                              .halt_at_entry = input.halt_at_entry});
  changed_.clear();
  if (input.brought) changed_.insert(input.program);
  run_ = *std::move(run);
  viewed_from_.reset();
  run_->SetMode(mode_);
  run_->SetBreakpoints(breakpoints_);
  base_ = std::move(base);
  not_in_base_ = SimTime(0);
  comes_along_ = input.brought.has_value();
  of_a_job_ = input.source == StartSource::kQueue;
  if (!of_a_job_) shown_ = {.program = input.program};
  return {};
}

}  // namespace rmlcell::machine
