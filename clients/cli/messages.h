#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "engine/machine/family.h"
#include "rmlcell/v1/job.pb.h"

// Messages as JSON and as text for people.
namespace rmlcell::cli {

// One line; zero values are shown, since people look for them.
std::string Json(const google::protobuf::Message& message);
// The same to standard output, for what may be long: it is never held whole.
void PrintJson(const google::protobuf::Message& message);

// Positions from the work origin, where the program has one, unless the machine's are wanted.
enum class Zero { kWork, kMachine };
std::string ReportText(const v1::RunReport& report, Zero zero = Zero::kWork);
// The rows that a family gives its figures of a check; empty when it gives none.
std::string FigureRows(const machine::MachineFamily& family,
                       const std::vector<machine::Figure>& figures, const std::string& profile,
                       Zero zero = Zero::kWork);
std::string OutcomeLine(const v1::Outcome& outcome);
std::string EventLine(const v1::JobEvent& event);
std::string StateName(v1::Job::State state);  // "running"

// A finding as the local checks print it, without source line.
std::string FindingLine(const v1::Diagnostic& diagnostic);

}  // namespace rmlcell::cli
