#include "engine/machine/start_preview.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/machine/standing.h"

namespace rmlcell::machine {
namespace {

constexpr int kFirstTurningAxis = 3;

Detail ToldTarget(const StepTarget& target) {
  Detail text = Told("program", target.at.program) + "/" + Told("step", target.at.step);
  if (target.occurrence > 1) text += ", " + Told("occurrence", target.occurrence) + ". time";
  return text;
}

// Where it could begin instead.
Detail CleanSteps(const StartPreview& preview) {
  Detail text;
  if (preview.clean_before) text += "; clean before: " + ToldTarget(*preview.clean_before);
  if (preview.clean_after) text += "; clean behind: " + ToldTarget(*preview.clean_after);
  return text;
}

Error Refuse(ErrorCode code, Detail why) { return {code, std::move(why), {}}; }

// What the step itself speaks against.
std::vector<Error> RefusalsOf(const StepFacts& facts, bool off_until_work_on) {
  std::vector<Error> refusals;
  const auto refuse = [&](bool so, std::string_view why) {
    if (so) refusals.push_back(Refuse(ErrorCode::kCellStepUnreachable, std::string(why)));
  };
  refuse(facts.inside_command, "a call or an ESC sequence is unfinished there");
  refuse(facts.beside, "a motion or a WORK of /NEXT goes on there");
  refuse(facts.in_timed_gosub, "control is in a GOSUB of a timer there");
  refuse(facts.work_active && !off_until_work_on,
         "a WORK is ON there: allow that the beam stays off until the next one");
  return refusals;
}

Error RefuseTravel(const OutOfTravel& one, const Detail& motion) {
  constexpr std::array<std::string_view, 5> kAxes = {"X", "Y", "Z", "A", "B"};
  const std::string unit = one.axis < kFirstTurningAxis ? "mm" : "rad";
  return Refuse(ErrorCode::kCellApproach,
                Told("axis", kAxes[static_cast<std::size_t>(one.axis)]) +
                    (one.at_target ? " of the target" : " on the way") + " of " + motion +
                    " leaves its travel by " +
                    Told("excess", one.excess, unit, FixedText(one.excess, 3) + " " + unit));
}

std::vector<Error> RefusalsOf(const std::vector<ApproachMotion>& approach) {
  std::vector<Error> refusals;
  std::size_t number = 0;
  for (const ApproachMotion& of_approach : approach) {
    const Detail motion = "motion " + Told("motion", ++number) + " of the approach";
    for (const OutOfTravel& one : of_approach.beyond) refusals.push_back(RefuseTravel(one, motion));
    const double depth = of_approach.into_part_mm;
    if (depth <= 0.0) continue;
    refusals.push_back(Refuse(ErrorCode::kCellApproach,
                              motion + " goes " +
                                  Told("depth", depth, "mm", FixedText(depth, 3) + " mm") +
                                  " into the part"));
  }
  return refusals;
}

// The first motion of a run that begins without an approach.
class FirstMotion final : public RunObserver {
 public:
  void OnMove(const MoveDone& done) override {
    if (!done.programmed || over_) return;
    path_ = done.path;
    over_ = true;
  }
  void OnViolation(const TravelViolation& one) override {
    if (over_) return;
    beyond_.push_back({.axis = one.axis, .excess = one.excess, .at_target = one.at_target});
  }
  bool over() const { return over_ || !beyond_.empty(); }
  const std::string& path() const { return path_; }
  const std::vector<OutOfTravel>& beyond() const { return beyond_; }

 private:
  bool over_ = false;
  std::string path_{};
  std::vector<OutOfTravel> beyond_{};
};

// A line, or the axes by themselves; that it stays inside the travel. LIVE-6.06, LIVE-6.07
std::vector<Error> RefusalsOfFirstMotion(const MachineFamily& family, const RunSetup& setup,
                                         const StepReach& reach, const StartQuestion& question,
                                         const ReachLimits& limits) {
  FirstMotion first;
  const Result<std::unique_ptr<Run>> run = family.NewRun(setup, first);
  RMLCELL_CHECK(run);
  (*run)->Restore(*reach.run->Save());
  (*run)->enterable()->Enter({.machine_state = question.machine_state,
                              .override_percent = question.override_percent,
                              .way = ApproachWay::kDirect});
  const WayEnd end = GoUntil(
      **run, [&] { return first.over(); }, limits);
  if (!first.beyond().empty()) return {RefuseTravel(first.beyond().front(), "the first motion")};
  if (end == WayEnd::kFinished && (*run)->outcome().code) {
    return {Refuse(ErrorCode::kCellApproach,
                   "the first motion cannot begin where the machine stands: " +
                       Told("code", CodeText(*(*run)->outcome().code)))};
  }
  if (end != WayEnd::kDone || first.path() == "PTP" || first.path() == "LIN") return {};
  return {Refuse(ErrorCode::kCellApproach, "the first motion is " + Told("path", first.path()) +
                                               ": without an approach it must be PTP or LIN")};
}

// What has cut it by now: in virtual time, with the inputs of the run.
Status CutPart(const MachineFamily& family, const RunSetup& setup, const StartQuestion& question,
               const ReachLimits& limits) {
  RunSetup bounded = setup;
  bounded.budget = {.steps = limits.steps_max, .virtual_time = RunBudget().virtual_time};
  const Result<std::unique_ptr<Run>> run = family.NewRun(std::move(bounded), *question.part);
  if (!run) return run.error();
  const RunState begun = (*run)->state();
  question.part->BeginAt(begun.work_origin.value_or(motion::MachinePoint(motion::MachineVector{})),
                         begun.axes.column);
  const PartSoFar& so_far = question.part_so_far;
  if (so_far.untouched) return {};
  if (so_far.cut_until) {
    if (const Status went = GoUntilTime(**run, *so_far.cut_until, limits); !went)
      return went.error();
    question.part->EndAt((*run)->state().axes.column);
    return {};
  }
  EnterableRun& enterable = *(*run)->enterable();
  if (const Status goes = enterable.HaltBefore(question.target); !goes) return goes.error();
  const WayEnd end = GoUntil(
      **run, [&] { return enterable.reached().has_value(); }, limits);
  if (end != WayEnd::kDone)
    return Refuse(ErrorCode::kCellStepUnreachable, "what cuts the part takes too long to be seen");
  return {};
}

void LookAtPart(const PartOnTable& part, const motion::MachinePoint& from,
                std::vector<ApproachMotion>& approach) {
  motion::MachinePoint at = from;
  for (ApproachMotion& motion : approach) {
    motion.into_part_mm = part.DepthOf(at, motion.to.column);
    at = motion.to.column;
  }
}

void ComparePlaces(const StartQuestion& question, const RunState& there, StartPreview& preview) {
  if (question.way == ApproachWay::kDirect) {
    for (StartDifference& one : preview.differences) {
      if (one.action == StartAction::kMove) one.action = StartAction::kNone;
    }
  }
  if (preview.reach.facts.passes)
    preview.differences.push_back({"passage", "passed", "stop", StartAction::kNone});
  if (there.override_percent != question.override_percent) {
    preview.differences.push_back({"override", ShortestText(there.override_percent),
                                   ShortestText(question.override_percent), StartAction::kNone});
  }
}

}  // namespace

std::vector<StartDifference> DifferencesOf(const std::vector<StateItem>& there,
                                           const std::vector<StateItem>& now) {
  std::map<std::string_view, const StateItem*> left;
  for (const StateItem& item : now) left[item.name] = &item;
  std::vector<StartDifference> differences;
  for (const StateItem& item : there) {
    const auto found = left.find(item.name);
    const std::string value = found == left.end() ? "" : found->second->value;
    if (found != left.end()) left.erase(found);
    if (value != item.value) differences.push_back({item.name, item.value, value, item.action});
  }
  for (const StateItem& item : now) {
    if (left.contains(item.name)) differences.push_back({item.name, "", item.value, item.action});
  }
  return differences;
}

Result<StartPreview> PreviewStart(const MachineFamily& family, const RunSetup& setup,
                                  const StartQuestion& question, const ReachLimits& limits) {
  const Result<std::unique_ptr<Standing>> standing =
      family.NewStanding(setup.parameters, question.machine_state);
  if (!standing) return standing.error();
  Result<StepReach> reach = ReachStep(family, setup, question.target, limits);
  if (!reach) return reach.error();
  StartPreview preview;
  preview.reach = *std::move(reach);
  const bool known = !preview.reach.unreachable;
  // Of a step that the run never came to there is nothing behind.
  const bool behind = known || preview.reach.run->state().phase != RunPhase::kFinished;
  const StepsBehind after = behind ? LookBehind(family, setup, preview.reach, limits)
                                   : StepsBehind{.clean_before = preview.reach.clean_before};
  preview.clean_before = after.clean_before;
  preview.clean_after = after.clean_after;
  if (known) {
    preview.reach.facts.passes = after.passes;
    const RunState state = preview.reach.run->state();
    preview.run_time = state.time;
    if (question.off_until_work_on && preview.reach.facts.work_active)
      preview.missing_cut_mm = after.beam_way_mm;
    preview.there = preview.reach.run->enterable()->items();
    preview.differences = DifferencesOf(preview.there, (*standing)->items());
    ComparePlaces(question, state, preview);
    preview.approach =
        preview.reach.run->enterable()->PlanApproach(question.machine_state, question.way);
    if (question.part != nullptr) {
      if (const Status cut = CutPart(family, setup, question, limits); !cut) return cut.error();
      preview.part_checked = true;
      LookAtPart(*question.part, (*standing)->state().axes.column, preview.approach);
    }
    preview.refusals = RefusalsOf(preview.reach.facts, question.off_until_work_on);
    const auto add = [&](std::vector<Error> more) {
      for (Error& one : more) preview.refusals.push_back(std::move(one));
    };
    add(RefusalsOf(preview.approach));
    const bool direct = question.way == ApproachWay::kDirect;
    if (direct && !preview.reach.run->enterable()->may_enter_directly()) {
      add({Refuse(ErrorCode::kCellApproach, "this machine begins behind an approach alone")});
    } else if (direct && preview.refusals.empty()) {
      add(RefusalsOfFirstMotion(family, setup, preview.reach, question, limits));
    }
  } else {
    preview.refusals = {*preview.reach.unreachable};
  }
  for (Error& refusal : preview.refusals) refusal.detail += CleanSteps(preview);
  return preview;
}

}  // namespace rmlcell::machine
