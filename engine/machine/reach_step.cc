#include "engine/machine/reach_step.h"

#include <algorithm>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::machine {
namespace {

constexpr SimTime kSlice = std::chrono::minutes(10);  // of virtual time, between two questions
// Behind the step: whoever finds no clean one so near has more to think of.
constexpr std::uint64_t kStepsBehindMax = 1'000'000;

Error Unreachable(Detail detail) {
  return {ErrorCode::kCellStepUnreachable, std::move(detail), {}};
}

Detail ToldStep(const Place& place) {
  return Told("program", place.program) + "/" + Told("step", place.step);
}

// What a run to a step comes to on its way.
class StepLog final : public StepWatcher {
 public:
  explicit StepLog(StepReach& reach) : reach_(reach) {}

  void OnStepDue(const StepFacts& facts) override {
    last_ = facts.place;
    const ProgramStep at{facts.place.program, facts.place.step};
    const std::uint64_t occurrence = reach_.counts.Count(at);
    if (facts.clean()) reach_.clean_before = StepTarget{.at = at, .occurrence = occurrence};
  }
  const Place& last() const { return last_; }

 private:
  StepReach& reach_;
  Place last_{};
};

// What comes behind the step, and the first clean one of it.
class LogBehind final : public StepWatcher, public RunObserver {
 public:
  // `target`: none: all that comes is behind. `passes`: the run does, and was halted.
  LogBehind(StepCounts counts, const std::optional<StepTarget>& target, bool passes)
      : counts_(std::move(counts)), target_(target), passes_(passes), halted_on_way_(passes) {}

  void OnStepDue(const StepFacts& facts) override {
    const ProgramStep at{facts.place.program, facts.place.step};
    const StepTarget here{.at = at, .occurrence = counts_.Count(at)};
    if (target_) {
      if (here != *target_) {
        if (facts.clean()) before_ = here;
        return;
      }
      target_.reset();
      passes_ = passes_ || !facts.stands;
      return;
    }
    ++steps_;
    // Up to the next motion it stands because it was halted, and the whole run passes.
    if (!clean_ && facts.clean() && !halted_on_way_) clean_ = here;
  }
  void OnMotion(const MotionDone& done) override {
    halted_on_way_ = false;
    if (done.beam_on && !beam_over_) beam_way_mm_ += done.travelled - done.from;
  }
  void OnSignal(const SignalChange& change) override {
    if (change.signal == Signal::kBeam && change.value == 0.0) beam_over_ = true;
  }

  void NoBeam() { beam_over_ = true; }
  bool done() const { return steps_ >= kStepsBehindMax || (clean_ && beam_over_); }
  StepsBehind behind() const {
    return {.passes = passes_,
            .clean_before = before_,
            .clean_after = clean_,
            .beam_way_mm = beam_way_mm_};
  }

 private:
  StepCounts counts_;
  std::optional<StepTarget> target_;  // to come
  bool passes_;
  bool halted_on_way_;
  std::uint64_t steps_ = 0;
  std::optional<StepTarget> before_{};
  std::optional<StepTarget> clean_{};
  double beam_way_mm_ = 0.0;
  bool beam_over_ = false;
};

SimTime Later(SimTime time, SimTime by) { return time > kForever - by ? kForever : time + by; }

// Why the step was not reached.
Error NotReached(WayEnd end, const Run& run, const StepTarget& target, const Place& last) {
  Detail text = "step " + Told("program", target.at.program) + "/" + Told("step", target.at.step);
  if (target.occurrence > 1)
    text += " is not reached for the " + Told("occurrence", target.occurrence) + ". time";
  else
    text += " is not reached";
  text += ": ";
  switch (end) {
    case WayEnd::kFinished: {
      const std::optional<ErrorCode>& code = run.outcome().code;
      text +=
          code ? "the run ends with " + Told("code", CodeText(*code)) : Detail("the program ends");
      break;
    }
    case WayEnd::kWaitsForEver:
      text += "the program waits for what does not come";
      break;
    case WayEnd::kGivenUp:
    case WayEnd::kDone:
      text += "it takes longer than is looked for";
      break;
  }
  return Unreachable(std::move(text) + "; the last step reached is " + ToldStep(last));
}

}  // namespace

std::uint64_t StepCounts::Count(const ProgramStep& at) {
  const auto slot = static_cast<std::size_t>(at.program);
  const auto step = static_cast<std::size_t>(at.step);
  if (at.program < 0 || at.step < 0 || slot >= counts_.size() || step >= kCountedMax) return 1;
  std::vector<std::uint32_t>& of_slot = counts_[slot];
  if (step >= of_slot.size()) of_slot.resize(step + 1);
  return ++of_slot[step];
}

WayEnd GoUntil(Run& run, const std::function<bool()>& done, const ReachLimits& limits) {
  std::optional<std::pair<SimTime, std::uint64_t>> started;  // where START was given last
  while (!done()) {
    if (limits.go_on && !limits.go_on()) return WayEnd::kGivenUp;
    const SimTime before = run.state().time;
    const RunPhase phase = run.Advance(Later(before, kSlice));
    if (done()) break;
    if (phase == RunPhase::kFinished) return WayEnd::kFinished;
    if (phase == RunPhase::kRunning) {
      if (run.waits_for_ever()) return WayEnd::kWaitsForEver;
      continue;
    }
    if (run.state().time > before) continue;  // a scripted key may end the halt
    const std::pair here{before, run.steps_executed()};
    if (started == here) return WayEnd::kWaitsForEver;
    started = here;
    run.Apply({.at = before, .kind = InputKind::kStart, .index = 0, .value = 1.0});
  }
  return WayEnd::kDone;
}

Status GoUntilTime(Run& run, SimTime time, const ReachLimits& limits) {
  std::optional<std::pair<SimTime, std::uint64_t>> started;
  for (;;) {
    if (limits.go_on && !limits.go_on())
      return Unreachable("where it was cut off takes longer than is looked for");
    const SimTime before = run.state().time;
    const RunPhase phase = run.Advance(std::min(time, Later(before, kSlice)));
    const SimTime now = run.state().time;
    if (phase == RunPhase::kFinished || now >= time) break;
    if (phase == RunPhase::kRunning || now > before) continue;
    const std::pair here{now, run.steps_executed()};
    if (started == here) break;
    started = here;
    run.Apply({.at = now, .kind = InputKind::kStart, .index = 0, .value = 1.0});
  }
  return {};
}

Result<StepReach> ReachStep(const MachineFamily& family, const RunSetup& setup,
                            const StepTarget& target, const ReachLimits& limits) {
  StepReach reach;
  reach.target = target;
  reach.nobody = std::make_unique<RunObserver>();
  RunSetup bounded = setup;
  bounded.budget = {.steps = limits.steps_max, .virtual_time = RunBudget().virtual_time};
  Result<std::unique_ptr<Run>> run = family.NewRun(std::move(bounded), *reach.nobody);
  if (!run) return run.error();
  reach.run = *std::move(run);
  EnterableRun* enterable = reach.run->enterable();
  if (enterable == nullptr)
    return Error{ErrorCode::kCellNotLive, "the machine has no start at a step", {}};
  if (target.at.step < 1 && target.byte_offset < 0) {
    reach.unreachable =
        Unreachable("step " + Told("step", target.at.step) + " is none: they count from 1");
    return reach;
  }
  if (const Status goes = enterable->HaltBefore(target); !goes) {
    reach.unreachable = goes.error();
    return reach;
  }
  StepLog log(reach);
  enterable->WatchSteps(&log);
  const WayEnd end = GoUntil(
      *reach.run, [&] { return enterable->reached().has_value(); }, limits);
  enterable->WatchSteps(nullptr);
  if (end == WayEnd::kDone) {
    reach.facts = *enterable->reached();
    reach.target.at = {reach.facts.place.program, reach.facts.place.step};
  } else {
    reach.unreachable = NotReached(end, *reach.run, target, log.last());
  }
  return reach;
}

StepsBehind LookBehind(const MachineFamily& family, const RunSetup& setup, const StepReach& reach,
                       const ReachLimits& limits) {
  const bool anew = reach.facts.may_pass;
  const std::optional<StepTarget> target =
      reach.unreachable ? std::nullopt : std::optional(reach.target);
  LogBehind log(anew ? StepCounts() : reach.counts, target, reach.facts.passes);
  const Result<std::unique_ptr<Run>> run = family.NewRun(setup, log);
  RMLCELL_CHECK(run);  // as the one before
  if (!anew) {
    (*run)->Restore(*reach.run->Save());
    (*run)->enterable()->ForgetTarget();
  }
  (*run)->enterable()->WatchSteps(&log);
  const RunState state = (*run)->state();
  if (state.phase == RunPhase::kHalted)
    (*run)->Apply({.at = state.time, .kind = InputKind::kStart, .index = 0, .value = 1.0});
  if (!(*run)->state().beam_on) log.NoBeam();
  GoUntil(
      **run, [&] { return log.done(); }, limits);
  StepsBehind behind = log.behind();
  if (!anew) behind.clean_before = reach.clean_before;
  return behind;
}

Result<std::uint64_t> OccurrenceAt(const MachineFamily& family, const RunSetup& setup,
                                   const ProgramStep& at, SimTime time, const ReachLimits& limits) {
  class Passes final : public RunObserver {
   public:
    explicit Passes(const ProgramStep& at) : at_(at) {}
    void OnStep(SimTime /*at*/, const Place& place, std::string_view /*name*/) override {
      if (place.program == at_.program && place.step == at_.step) ++count;
    }
    std::uint64_t count = 0;

   private:
    const ProgramStep at_;
  };
  Passes passes(at);
  const Result<std::unique_ptr<Run>> run = family.NewRun(setup, passes);
  if (!run) return run.error();
  if (const Status went = GoUntilTime(**run, time, limits); !went) return went.error();
  return passes.count;
}

}  // namespace rmlcell::machine
