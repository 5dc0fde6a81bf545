#include "engine/simulation/motion_check.h"

#include <utility>

#include "engine/simulation/finding_list.h"
#include "engine/simulation/simulate.h"

namespace rmlcell::simulation {
namespace {

bool IsOfMotion(ErrorCode code) {
  return code == ErrorCode::kTargetOutOfTravel || code == ErrorCode::kSpeedHeldByAxis;
}

// What one run tells about its motion, and which programs take part.
class MotionListener final : public machine::RunObserver {
 public:
  void OnStep(SimTime /*at*/, const machine::Place& place,
              std::string_view /*instruction*/) override {
    if (place.program != last_program_) reached_.insert(place.program);
    last_program_ = place.program;
  }
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override {
    if (IsOfMotion(diagnostic.code)) findings_.Add(at, diagnostic);
  }

  const FindingList& findings() const { return findings_; }
  const std::set<int>& reached() const { return reached_; }

 private:
  FindingList findings_;
  std::set<int> reached_;
  int last_program_ = -1;
};

struct CheckedRun {
  MotionListener listener;
  std::string cut_short;
};

// Empty: the program was followed to its end.
std::string WhyCutShort(const machine::Outcome& outcome) {
  if (!outcome.code || *outcome.code == ErrorCode::kTargetOutOfTravel) return {};
  const CatalogueEntry& entry = Lookup(*outcome.code);
  std::string text = "only up to step " + std::to_string(outcome.place.step);
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
  SimulationRequest request;
  request.products.also = &checked.listener;
  request.options.at_halt = AtHalt::kStart;
  request.options.slice = std::chrono::hours(1);
  const Result<SimulationResult> result = Simulate(family, std::move(setup), std::move(request));
  if (!result) return result.error();
  checked.cut_short = WhyCutShort(result->report.outcome);
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
    CheckedRun& run = runs[slot];
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
