#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/machine/family.h"

namespace rmlcell::optimo::testing {

// What a run told, as words in order: "beam on 95", "shutter open", "OL[11] 1", "schedule 11", "wait pierce 1.5",
// "halt STOP", "E7408" ...
struct Ran {
  machine::Outcome outcome;
  std::vector<std::string> told;
  std::vector<machine::MoveDone> moves;
  std::map<std::string, std::string> variables;  // those asked for
  double time_s = 0.0;
  std::uint64_t steps = 0;
  machine::RunState end;

  bool Told(const std::string& what) const;
  int Count(const std::string& what) const;
};

struct RunOptions {
  std::map<int, std::string> programs;  // further ones, by slot; the first is program 1
  machine::InputScript inputs;
  machine::Mode mode = machine::Mode::kCycle;
  std::map<std::string, std::string> parameters;
  std::vector<std::string> variables;
  std::optional<machine::ProgramStep> breakpoint;
  std::optional<machine::ProgramStep> simul;
  double override_percent = 100.0;
  machine::RunBudget budget;
  SimTime slice = std::chrono::seconds(1000);  // of one Advance
};

// Compiles `main` as program 1 and runs it to its end, or until nothing more happens.
Ran RunText(const std::string& main, const RunOptions& options = {});

}  // namespace rmlcell::optimo::testing
