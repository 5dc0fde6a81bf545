#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "engine/machine/family.h"
#include "engine/simulation/report/report.h"

// Will the part come out right? The one answer of command, jobs, reports, pictures and pages.
namespace rmlcell::simulation {

// Of a run that is over, by the rules for every machine and those of its family.
machine::Judgement Judge(const RunReport& report);

// Of an end alone: a job that was cancelled, or needed more than its budget.
machine::Judgement JudgeOutcome(const machine::Outcome& outcome);

// Of a check, which has the figures of the family and no run.
machine::Judgement JudgeFigures(const machine::MachineFamily& family,
                                std::span<const machine::Figure> figures);

// Of a program that cannot run: its first error is why.
machine::Judgement JudgeFindings(std::span<const Diagnostic> findings);

// A rule as documents and tests list it. `figure`: what it measures; `text`: what that is.
struct VerdictRuleInfo {
  machine::VerdictRule rule;
  std::string_view unit;
  std::string_view text;
};
// The rules for every machine, in the order of judging.
std::span<const VerdictRuleInfo> CommonVerdictRules();

}  // namespace rmlcell::simulation
