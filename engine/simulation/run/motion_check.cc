#include "engine/simulation/run/motion_check.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "engine/machine/observer.h"
#include "engine/simulation/report/finding_list.h"
#include "engine/simulation/run/assumptions.h"
#include "engine/simulation/run/simulate.h"

namespace rmlcell::simulation {
namespace {

bool Contains(std::span<const ErrorCode> codes, ErrorCode code) {
  return std::ranges::find(codes, code) != codes.end();
}

machine::Place PlaceOf(const Diagnostic& finding) {
  return {.program = finding.program,
          .step = finding.step,
          .line = finding.where.line,
          .byte_offset = finding.where.byte_offset};
}

// What one run tells about its motion, and which programs take part.
class MotionListener final : public machine::RunObserver {
 public:
  MotionListener(const machine::FamilyInfo& info, const machine::InputScript& inputs)
      : info_(info), assumptions_(inputs) {}

  void OnStep(SimTime /*at*/, const machine::Place& place, std::string_view instruction) override {
    if (place.program != last_program_) reached_.insert(place.program);
    last_program_ = place.program;
    if (!info_.check.work_offset.empty() && instruction == info_.check.work_offset)
      offset_set_ = true;
  }
  void OnAssumed(const machine::Assumed& assumed) override { assumptions_.Add(assumed); }
  void OnViolation(const machine::TravelViolation& violation) override {
    if (!violation.by_work_offset) anywhere_ = true;
  }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    const machine::CheckCodes& codes = info_.check;
    if (!Contains(codes.of_motion, diagnostic.code)) return;
    Diagnostic told = diagnostic;
    // With what comes from outside the speed may be another.
    if (Contains(codes.by_speed, told.code)) told.severity = Severity::kWarning;
    const bool of_travel = told.code == info_.travel_left;
    const bool by_offset = of_travel && !std::exchange(anywhere_, false) && !offset_set_;
    const Detail assumed = by_offset ? NoOffset() : assumptions_.Text();
    if (IsError(told.severity) && !assumed.empty()) {
      told.severity = Severity::kWarning;
      told.detail += assumed;
      if (std::ranges::find(doubts_, told.code, &machine::Reason::code) == doubts_.end()) {
        doubts_.push_back({.code = told.code,
                           .verdict = machine::Verdict::kDoubtful,
                           .said = told.detail,
                           .first = PlaceOf(told)});
      }
    }
    findings_.Add(at, told);
  }

  const FindingList& findings() const { return findings_; }
  const std::set<int>& reached() const { return reached_; }
  const Assumptions& assumptions() const { return assumptions_; }
  // Errors that hang on something that was assumed: the first of each code.
  const std::vector<machine::Reason>& doubts() const { return doubts_; }

 private:
  Detail NoOffset() const {
    return ", if no " + Told("assumed", info_.check.work_offset) + " is in force before";
  }

  const machine::FamilyInfo& info_;
  FindingList findings_;
  Assumptions assumptions_;
  std::vector<machine::Reason> doubts_;
  std::set<int> reached_;
  int last_program_ = -1;
  bool offset_set_ = false;  // by the run
  bool anywhere_ = false;    // an axis leaves its travel whatever the work offset is
};

struct CheckedRun {
  CheckedRun(const machine::FamilyInfo& info, const machine::InputScript& inputs)
      : listener(info, inputs) {}

  MotionListener listener;
  std::optional<CutShort> cut_short;
  machine::Outcome outcome;
  SimTime ended_at{0};
  bool for_sure = false;     // it failed, and so does every other
  int starts = 0;            // halts that the check ended: a run waits there for somebody
  machine::Place halted_at;  // the first of them
  std::vector<machine::Reason> reasons;
};

// How a check ended, and what it knew.
struct Ending {
  const machine::FamilyInfo& info;
  const machine::Outcome& outcome;
  MemoryGiven given = MemoryGiven::kInPart;
  bool waits = false;  // for a condition that never comes true
  Detail assumed{};    // Assumptions::Text

  // A program that may be on the machine all the same.
  bool LacksProgram() const {
    return given == MemoryGiven::kInPart && Contains(info.check.not_given, *outcome.code);
  }
};

// Whether every run of these programs fails as this one did. What hangs on a variable, an input or
// a parameter that nothing has set may be another time otherwise.
bool FailsForSure(const Ending& ending) {
  const machine::Outcome& outcome = ending.outcome;
  if (!outcome.code || !ending.assumed.empty()) return false;
  if (outcome.kind != machine::OutcomeKind::kFailed && !ending.waits) return false;
  // That the travel is left is told by itself, with its axis.
  return *outcome.code != ending.info.travel_left && !ending.LacksProgram();
}

ErrorCode CauseOf(const Ending& ending) {
  const ErrorCode code = *ending.outcome.code;
  if (FailsForSure(ending) || code == ErrorCode::kCellWaitsForever) return code;
  if (ending.LacksProgram()) return ErrorCode::kCellCheckLacksProgram;
  if (ending.waits) return ErrorCode::kCellCheckWaits;
  return ending.outcome.kind == machine::OutcomeKind::kFailed ? ErrorCode::kCellCheckFailsPerhaps
                                                              : ErrorCode::kCellCheckCutShort;
}

Diagnostic DiagnosticOf(const machine::Outcome& outcome) {
  return {.code = *outcome.code,
          .severity = Lookup(*outcome.code).severity,
          .detail = outcome.detail,
          .where = {.line = outcome.place.line},
          .program = outcome.place.program,
          .step = outcome.place.step};
}

// Nothing: the program was followed to its end.
std::optional<CutShort> WhyCutShort(const Ending& ending) {
  const machine::Outcome& outcome = ending.outcome;
  if (!outcome.code || *outcome.code == ending.info.travel_left) return {};
  const CatalogueEntry& entry = Lookup(*outcome.code);
  Detail text = "not at all";
  if (outcome.place.step > 0) text = "only up to step " + Told("step", outcome.place.step);
  if (outcome.place.line > 0) text += ", line " + Told("line", outcome.place.line);
  text += ": " + Told("code", CodeText(entry.code)) + ' ';
  text += Said(*outcome.code, outcome.detail);
  const ErrorCode cause = CauseOf(ending);
  if (cause == ErrorCode::kCellCheckFailsPerhaps) text += ending.assumed;
  return CutShort{.cause = cause, .text = std::move(text)};
}

// By what the figures of a run are judged. How it ended, and that it leaves the travel, is told
// with its place by the findings.
std::vector<machine::Reason> ReasonsOf(const RunReport& report, const machine::FamilyInfo& info,
                                       const MotionListener& listener) {
  std::vector<machine::Reason> reasons = listener.doubts();
  const Detail assumed = listener.assumptions().Text();
  for (machine::Reason reason : report.judgement.reasons) {
    if (reason.code == report.outcome.code || reason.code == info.travel_left) continue;
    if (reason.verdict == machine::Verdict::kBad && !assumed.empty()) {
      reason.verdict = machine::Verdict::kDoubtful;
      reason.said += assumed;
    }
    reasons.push_back(std::move(reason));
  }
  return reasons;
}

Status RunForCheck(const machine::MachineFamily& family, machine::RunSetup setup, MemoryGiven given,
                   CheckedRun& checked) {
  setup.mode = machine::Mode::kCycle;
  setup.forecast = true;
  setup.budget = {.steps = kCheckStepsMax, .virtual_time = kCheckTimeMax};
  const Result<BegunRun> begun = Begin(family, std::move(setup), {.also = &checked.listener});
  if (!begun) return begun.error();
  Simulation& simulation = *begun->simulation;
  while (simulation.Step(kCheckTimeMax) != machine::RunPhase::kFinished) {
    if (simulation.phase() != machine::RunPhase::kHalted) continue;
    const machine::Place here = simulation.state().place;
    if (simulation.StartOrEnd() && checked.starts++ == 0) checked.halted_at = here;
  }
  const RunReport report = simulation.Finish();
  checked.outcome = report.outcome;
  const Ending ending{.info = family.info(),
                      .outcome = checked.outcome,
                      .given = given,
                      .waits = checked.outcome.kind == machine::OutcomeKind::kBudgetExceeded &&
                               begun->run->waits_for_ever(),
                      .assumed = checked.listener.assumptions().Text()};
  checked.for_sure = FailsForSure(ending);
  checked.ended_at = simulation.state().time;
  checked.cut_short = WhyCutShort(ending);
  checked.reasons = ReasonsOf(report, family.info(), checked.listener);
  if (checked.starts > 0 && checked.outcome.code != ErrorCode::kCellWaitsForever) {
    checked.reasons.push_back(machine::ReasonOf(
        machine::kWaitsForKey,
        {.value = static_cast<double>(checked.starts), .first = checked.halted_at}));
  }
  return {};
}

// Two runs that call the same program may say the same of it: the more serious counts.
void AddReason(machine::Reason reason, std::vector<machine::Reason>& reasons) {
  const auto same = std::ranges::find_if(reasons, [&](const machine::Reason& other) {
    return other.code == reason.code && other.first.program == reason.first.program;
  });
  if (same == reasons.end()) {
    reasons.push_back(std::move(reason));
  } else if (std::tie(reason.verdict, reason.amount) > std::tie(same->verdict, same->amount)) {
    *same = std::move(reason);
  }
}

// What a run met in programs that it calls is about it, too: it ends with their fault.
void AddWhatIsOfOthers(const CheckedRun& run, int slot, std::vector<machine::Reason>& reasons) {
  std::vector<machine::Reason> met = run.reasons;
  std::vector<Diagnostic> errors;
  for (const Finding& finding : run.listener.findings().findings())
    errors.push_back(finding.diagnostic);
  if (run.for_sure) errors.push_back(DiagnosticOf(run.outcome));
  for (const Diagnostic& error : errors) {
    if (!IsError(error.severity)) continue;
    met.push_back({.code = error.code,
                   .verdict = machine::Verdict::kBad,
                   .said = Said(error.code, error.detail),
                   .first = PlaceOf(error)});
  }
  for (machine::Reason& reason : met) {
    const int program = reason.first.program;
    if (program == 0 || program == slot) continue;
    reason.said += ", in program " + Told("called", program);
    reason.first = {.program = slot};
    AddReason(std::move(reason), reasons);
  }
}

}  // namespace

Result<MotionCheck> CheckMotion(const machine::MachineFamily& family,
                                const machine::RunSetup& setup, const std::set<int>& slots,
                                MemoryGiven given) {
  MotionCheck check;
  if (!family.info().checked_by_running) return check;
  std::map<int, CheckedRun> runs;
  std::set<int> called;
  for (const int slot : slots) {
    machine::RunSetup one = setup;
    one.main_program = slot;
    CheckedRun& run = runs.try_emplace(slot, family.info(), setup.inputs).first->second;
    if (const Status ran = RunForCheck(family, std::move(one), given, run); !ran)
      return ran.error();
    for (const int program : run.listener.reached()) {
      if (program != slot) called.insert(program);
    }
  }
  FindingList all;
  std::set<int> covered;
  const auto take = [&](int slot) {
    const CheckedRun& run = runs.at(slot);
    covered.insert(run.listener.reached().begin(), run.listener.reached().end());
    covered.insert(slot);
    if (run.cut_short) check.cut_short[slot] = *run.cut_short;
    for (const Finding& finding : run.listener.findings().findings()) {
      all.Add(finding.first_at, finding.diagnostic);
    }
    for (machine::Reason reason : run.reasons) {
      if (reason.first.program == 0) reason.first.program = slot;
      AddReason(std::move(reason), check.reasons);
    }
    if (run.for_sure) all.Add(run.ended_at, DiagnosticOf(run.outcome));
    AddWhatIsOfOthers(run, slot, check.reasons);
    check.findings_dropped.Add(run.listener.findings().dropped());
  };
  for (const int slot : slots) {
    if (!called.contains(slot)) take(slot);
  }
  for (const int slot : slots) {  // those that run each other in a ring
    if (!covered.contains(slot)) take(slot);
  }
  for (const Finding& finding : all.findings()) check.findings.push_back(finding.diagnostic);
  check.findings_dropped.Add(all.dropped());
  return check;
}

}  // namespace rmlcell::simulation
