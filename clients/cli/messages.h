#pragma once

#include <google/protobuf/message.h>
#include <google/protobuf/timestamp.pb.h>

#include <string>

#include "engine/machine/family.h"
#include "rmlcell/v1/job.pb.h"

// Messages as JSON and as text for people.
namespace rmlcell::v1 {
class DiffProgramsResponse;
}

namespace rmlcell::cli {

// By the clock of this place, to the second: "2026-11-27 15:25:43".
std::string When(const google::protobuf::Timestamp& time);
// "X 12.345 mm", "A 0.1000 rad".
std::string AxisText(const v1::AxisValue& axis);

// One line; zero values are shown, since people look for them.
std::string Json(const google::protobuf::Message& message);
// The same to standard output, for what may be long: it is never held whole.
void PrintJson(const google::protobuf::Message& message);

// Positions from the work origin, where the program has one, unless the machine's are wanted.
enum class Zero { kWork, kMachine };
std::string ReportText(const v1::RunReport& report, Zero zero = Zero::kWork);
// The rows that a family gives its figures of a check; empty when it gives none.
std::string FigureRows(const machine::MachineFamily& family,
                       const std::vector<machine::Figure>& figures, Zero zero = Zero::kWork);
// Which machine a check or a comparison was for, and what was changed of its profile.
std::string MachineRows(const machine::MachineFamily& family, const v1::Findings& found);
std::string MachineRows(const machine::MachineFamily& family, const v1::DiffProgramsResponse& diff);
std::string OutcomeLine(const v1::Outcome& outcome);
std::string EventLine(const v1::JobEvent& event);
std::string StateName(v1::Job::State state);  // "running"
std::string StateName(const v1::Job& job);    // of one whose program was stopped: "stopped"

// "and 95 more RML1-E2, lines 12 to 300: no command of the command set in force has this name".
std::string GatheredLine(const v1::GatheredFindings& gathered);

}  // namespace rmlcell::cli
