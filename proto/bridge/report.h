#pragma once

#include <span>

#include "engine/machine/variable.h"
#include "engine/simulation/report/report.h"
#include "engine/simulation/report/trace.h"

namespace rmlcell::v1 {
class JobProgress;
class Position;
class RunReport;
class TraceRecord;
}  // namespace rmlcell::v1

namespace rmlcell::bridge {

// Of a machine of a family: it names the axes that turn.
//
// The report as its message; `variables` are those that were asked for.
v1::RunReport ToProto(const machine::FamilyInfo& family, const simulation::RunReport& report,
                      std::span<const machine::NamedVariable> variables);
v1::TraceRecord ToProto(const machine::FamilyInfo& family, const simulation::TraceRecord& record);

// What was found in the text, behind what the run found. A mill finds the same again at the same
// place when it runs: that is told once.
void AddFindingsOfText(const std::vector<Diagnostic>& findings, const UntoldFindings& untold,
                       v1::RunReport& report);

// Where a run is, without the job's name.
v1::JobProgress ToProto(const machine::FamilyInfo& family, const machine::RunState& state,
                        std::uint64_t steps);

}  // namespace rmlcell::bridge
