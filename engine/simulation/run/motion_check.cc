#include "engine/simulation/run/motion_check.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "engine/machine/observer.h"
#include "engine/simulation/report/finding_list.h"
#include "engine/simulation/run/drive.h"

namespace rmlcell::simulation {
namespace {

bool Contains(std::span<const ErrorCode> codes, ErrorCode code) {
  return std::ranges::find(codes, code) != codes.end();
}

// What one run tells about its motion, and which programs take part.
class MotionListener final : public machine::RunObserver {
 public:
  explicit MotionListener(const machine::CheckCodes& codes) : codes_(codes) {}

  void OnStep(SimTime /*at*/, const machine::Place& place,
              std::string_view /*instruction*/) override {
    if (place.program != last_program_) reached_.insert(place.program);
    last_program_ = place.program;
  }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    if (!Contains(codes_.of_motion, diagnostic.code)) return;
    Diagnostic told = diagnostic;
    // With what comes from outside the speed may be another.
    if (Contains(codes_.by_speed, told.code)) told.severity = Severity::kWarning;
    findings_.Add(at, told);
  }

  const FindingList& findings() const { return findings_; }
  const std::set<int>& reached() const { return reached_; }

 private:
  const machine::CheckCodes& codes_;
  FindingList findings_;
  std::set<int> reached_;
  int last_program_ = -1;
};

struct CheckedRun {
  explicit CheckedRun(const machine::FamilyInfo& info) : listener(info.check) {}

  MotionListener listener;
  std::string cut_short;
  machine::Outcome outcome;
  SimTime ended_at{0};
  bool for_sure = false;  // it failed, and so does every other
};

// Whether every run of these programs fails as this one did. That a program or FUNCTION is missing
// tells of what was given to the check; and what hangs on a variable, an input or a parameter that
// nothing has set may be another time otherwise: a program that others call is checked alone, too.
bool FailsForSure(const machine::FamilyInfo& info, const machine::Run& run) {
  if (run.relies_on_what_was()) return false;
  const machine::Outcome& outcome = run.outcome();
  if (outcome.kind != machine::OutcomeKind::kFailed || !outcome.code) return false;
  // That the travel is left is told by itself, with its axis.
  return *outcome.code != info.travel_left && !Contains(info.check.not_given, *outcome.code);
}

Diagnostic DiagnosticOf(const machine::Outcome& outcome) {
  return {.code = *outcome.code,
          .severity = Lookup(*outcome.code).severity,
          .detail = outcome.detail,
          .where = {.line = outcome.place.line},
          .program = outcome.place.program,
          .step = outcome.place.step};
}

// Empty: the program was followed to its end.
std::string WhyCutShort(const machine::FamilyInfo& info, const machine::Outcome& outcome) {
  if (!outcome.code || *outcome.code == info.travel_left) return {};
  const CatalogueEntry& entry = Lookup(*outcome.code);
  std::string text = "not at all";
  if (outcome.place.step > 0) text = "only up to step " + std::to_string(outcome.place.step);
  if (outcome.place.line > 0) text += ", line " + std::to_string(outcome.place.line);
  text += ": " + CodeText(entry.code) + ' ';
  text += outcome.detail.empty() ? std::string(entry.when) : outcome.detail;
  return text;
}

Status RunForCheck(const machine::MachineFamily& family, machine::RunSetup setup,
                   CheckedRun& checked) {
  setup.mode = machine::Mode::kCycle;
  setup.forecast = true;
  setup.budget = {.steps = kCheckStepsMax, .virtual_time = kCheckTimeMax};
  std::vector<SimTime> input_times;
  for (const machine::InputChange& input : setup.inputs) input_times.push_back(input.at);
  const auto run = family.NewRun(std::move(setup), checked.listener);
  if (!run) return run.error();
  // No report is made: that would take more time than the run.
  Drive drive(**run, input_times);
  while (drive.Step(kCheckTimeMax) != machine::RunPhase::kFinished) {
    if (drive.phase() == machine::RunPhase::kHalted && !drive.Start()) {
      drive.End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
    }
  }
  checked.outcome = (*run)->outcome();
  checked.for_sure = FailsForSure(family.info(), **run);
  checked.ended_at = (*run)->state().time;
  checked.cut_short = WhyCutShort(family.info(), checked.outcome);
  return {};
}

}  // namespace

Result<MotionCheck> CheckMotion(const machine::MachineFamily& family,
                                const machine::RunSetup& setup, const std::set<int>& slots) {
  MotionCheck check;
  if (!family.info().checked_by_running) return check;
  std::map<int, CheckedRun> runs;
  std::set<int> called;
  for (const int slot : slots) {
    machine::RunSetup one = setup;
    one.main_program = slot;
    CheckedRun& run = runs.try_emplace(slot, family.info()).first->second;
    if (const Status ran = RunForCheck(family, std::move(one), run); !ran) return ran.error();
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
    if (!run.cut_short.empty()) check.cut_short[slot] = run.cut_short;
    for (const Finding& finding : run.listener.findings().findings()) {
      all.Add(finding.first_at, finding.diagnostic);
    }
    if (run.for_sure) all.Add(run.ended_at, DiagnosticOf(run.outcome));
    check.findings_dropped += run.listener.findings().dropped();
  };
  for (const int slot : slots) {
    if (!called.contains(slot)) take(slot);
  }
  for (const int slot : slots) {  // those that run each other in a ring
    if (!covered.contains(slot)) take(slot);
  }
  for (const Finding& finding : all.findings()) check.findings.push_back(finding.diagnostic);
  check.findings_dropped += all.dropped();
  return check;
}

}  // namespace rmlcell::simulation
