#include "clients/cli/remote_call.h"

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {
namespace {

// What makes the program be refused, each with code, place and advice; the rest is counted. The
// message of the call says the first of it again, without its place.
void ComplainOf(const v1::ErrorDetail& detail, const std::string& message) {
  KindsShown kinds;
  std::int64_t others = detail.diagnostics_dropped();
  bool told = false;
  for (const v1::Diagnostic& diagnostic : detail.diagnostics()) {
    if (!IsError(bridge::FromProto(diagnostic).severity)) {
      ++others;
    } else if (kinds.Show(diagnostic.code(), diagnostic.place().line())) {
      if (!told && diagnostic.code() != detail.code()) Complain(message);
      told = true;
      Complain(FindingLine(diagnostic));
    }
  }
  if (!told) Complain(message);
  google::protobuf::RepeatedPtrField<v1::GatheredFindings> errors;
  std::int64_t errors_dropped = 0;
  for (const v1::GatheredFindings& kind : detail.gathered()) {
    v1::Diagnostic plain;
    plain.set_severity(kind.severity());
    if (!IsError(bridge::FromProto(plain).severity)) continue;
    *errors.Add() = kind;
    errors_dropped += kind.count();
  }
  kinds.AddUntold(errors, errors_dropped);
  others -= errors_dropped;
  std::string rest = kinds.Rest();
  for (std::size_t end; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1))
    Complain(rest.substr(0, end));
  if (others > 0) {
    Complain("and " + std::to_string(others) + (others == 1 ? " more finding" : " more findings") +
             "; rmlcell check of the file tells them");
  }
}

}  // namespace

std::shared_ptr<grpc::Channel> Connect(const Remote& remote) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc::CreateCustomChannel(remote.server, grpc::InsecureChannelCredentials(), arguments);
}

void Prepare(grpc::ClientContext& context, std::chrono::seconds patience) {
  context.set_deadline(std::chrono::system_clock::now() + patience);
}

int Refused(const grpc::Status& status, const Remote& remote) {
  google::rpc::Status rich;
  const bool detailed = rich.ParseFromString(status.error_details()) && rich.details_size() > 0;
  if (remote.json && detailed) Print(Json(rich));
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !detailed) {
    Complain("no server answers at " + remote.server + " (" + status.error_message() +
             "); start rmlcelld, or give --server");
    return kConnection;
  }
  for (const auto& any : rich.details()) {
    v1::ErrorDetail detail;
    if (any.Is<v1::ErrorDetail>() && any.UnpackTo(&detail) && !detail.diagnostics().empty()) {
      ComplainOf(detail, status.error_message());
      return kProgramErrors;
    }
  }
  Complain(status.error_message());
  return status.error_code() == grpc::StatusCode::INVALID_ARGUMENT ? kUsage : kConnection;
}

std::string FullName(const std::string& collection, const std::string& name) {
  return name.starts_with(collection + "/") ? name : collection + "/" + name;
}

void PrintProgramFindings(const v1::Findings& findings) {
  PrintRaw(FindingsText(findings));
  if (findings.verdict() == v1::VERDICT_UNSPECIFIED) return;
  Print("verdict: " + VerdictText(findings.verdict()));
  for (const v1::VerdictReason& reason : findings.reasons()) Print("  " + ReasonLine(reason));
}

}  // namespace rmlcell::cli
