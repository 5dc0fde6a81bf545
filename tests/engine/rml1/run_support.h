#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/run.h"
#include "tests/engine/rml1/run_record.h"

namespace rmlcell::rml1 {

// A run of one stream on a machine, with a record of all that it tells.
class TestRun {
 public:
  TestRun(const machine::Parameters& parameters, std::string stream,
          machine::InputScript inputs = {});
  explicit TestRun(machine::RunSetup setup);

  machine::Run* operator->() { return run_.get(); }
  machine::Run& operator*() { return *run_; }
  // To the end, or a halt that no script ends.
  machine::RunPhase AdvanceToEnd() {
    machine::RunPhase phase = machine::RunPhase::kRunning;
    while (phase == machine::RunPhase::kRunning) phase = run_->Advance(kForever);
    return phase;
  }
  void Press(machine::InputKind key, double value = 0.0) {
    run_->Apply({.at = run_->state().time, .kind = key, .index = 0, .value = value});
  }

  const RunRecord& seen() const { return record_; }
  RunRecord& seen() { return record_; }
  Figures figures() const { return ByName(run_->figures()); }
  double time_s() const { return ToSeconds(run_->state().time); }
  std::string variable(std::string_view name) const {
    return run_->ReadVariable(name).value_or(machine::VariableValue{.text = "none"}).text;
  }

 private:
  RunRecord record_;
  std::unique_ptr<machine::Run> run_;
};

// A setup with `stream` in slot 1.
machine::RunSetup SetupOf(const machine::Parameters& parameters, std::string stream);

machine::Parameters ParametersOf(std::string_view profile_id);
std::string ReadFile(const std::string& path);

}  // namespace rmlcell::rml1
