#pragma once

#include <string>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/family.h"

namespace google::rpc {
class Status;
}
namespace rmlcell::simulation {
struct CheckedProgram;
}
namespace rmlcell::v1 {
class Diagnostic;
class DiffProgramsResponse;
class ErrorDetail;
class Findings;
class Figure;
class GatheredFindings;
class SourcePlace;
class ErrorExplanation;
class Outcome;
class RunReport;
}  // namespace rmlcell::v1

namespace rmlcell::bridge {

v1::Diagnostic ToProto(const Diagnostic& diagnostic);
v1::GatheredFindings ToProto(const GatheredFindings& gathered);
// Those that a message does not list: their number, and their kinds. The message is Findings, a
// RunReport or an ErrorDetail.
void SetUntold(const UntoldFindings& untold, v1::Findings& message);
void SetUntold(const UntoldFindings& untold, v1::RunReport& message);
// Of an error, which must be short, code, number and places of the first kinds.
void SetUntold(const UntoldFindings& untold, v1::ErrorDetail& message);
// Text from programs and file names may hold any bytes; protobuf strings must be UTF-8. What is not
// becomes
// "?".
std::string Utf8(const std::string& text);

v1::Figure ToProto(const machine::Figure& figure);
v1::SourcePlace ToProto(const machine::Place& place);
v1::Outcome ToProto(const machine::Outcome& outcome);
// With what was judged of it; the message has verdict and reasons: an Outcome, or Findings.
v1::Outcome ToProto(const machine::Outcome& outcome, const machine::Judgement& judgement);
void SetJudgement(const machine::Judgement& judgement, v1::Outcome& message);
void SetJudgement(const machine::Judgement& judgement, v1::Findings& message);
// Which machine it was; the message has profile and changes: a RunReport, Findings, or a
// comparison.
void SetMachine(const machine::MachineUsed& machine, v1::RunReport& message);
void SetMachine(const machine::MachineUsed& machine, v1::Findings& message);
void SetMachine(const machine::MachineUsed& machine, v1::DiffProgramsResponse& message);
v1::ErrorExplanation Explain(const CatalogueEntry& entry);

// The findings of a translation or a transfer.
v1::Findings FindingsOf(bool ok, const std::vector<Diagnostic>& diagnostics,
                        const UntoldFindings& dropped, const std::vector<machine::Figure>& figures);

// The findings of a check: of the translation, then of the motion, with what is judged of them.
v1::Findings FindingsOf(const simulation::CheckedProgram& check,
                        const machine::Judgement& judgement);

// Back to engine values, for those that print findings which came over the wire. Unknown codes
// become CellInternal with the code in the text: a newer server may know more.
Diagnostic FromProto(const v1::Diagnostic& diagnostic);

// The value of google.rpc.Code that an error stands for: 3 INVALID_ARGUMENT, 5 NOT_FOUND ...
int RpcCode(ErrorCode code);

// Of the catalogue and of all texts for people, as BCP 47 has it.
inline constexpr std::string_view kLanguage = "en";

// Ours alone, without findings.
v1::ErrorDetail ToErrorDetail(const Error& error);

// Status with ErrorInfo (reason = constant name, domain "rmlcell"), our ErrorDetail, which carries
// the findings when there are any, and LocalizedMessage, the same text with its language.
google::rpc::Status ToRpcStatus(const Error& error, const std::vector<Diagnostic>& diagnostics = {},
                                const UntoldFindings& dropped = {});

// "OPT-E348: radius is 0; give PATH HOLE a radius above zero". Of a request that is wrong the
// detail alone: "CELL-E9003: 'foo' is no tool: write flat:3".
std::string ErrorText(const Error& error);

}  // namespace rmlcell::bridge
