#include "clients/cli/remote_call.h"

#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace rmlcell::cli {
namespace {

constexpr std::chrono::seconds kUnaryDeadline{60};

}  // namespace

std::shared_ptr<grpc::Channel> Connect(const Remote& remote) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc::CreateCustomChannel(remote.server, grpc::InsecureChannelCredentials(), arguments);
}

void Prepare(grpc::ClientContext& context) {
  context.set_deadline(std::chrono::system_clock::now() + kUnaryDeadline);
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
  Complain(status.error_message());
  bool program_errors = false;
  for (const auto& any : rich.details()) {
    v1::ErrorDetail detail;
    if (!any.Is<v1::ErrorDetail>() || !any.UnpackTo(&detail)) continue;
    for (const v1::Diagnostic& diagnostic : detail.diagnostics()) {
      program_errors = true;
      Complain(FindingLine(diagnostic));
    }
    if (detail.diagnostics_dropped() > 0) {
      Complain("and " + std::to_string(detail.diagnostics_dropped()) + " more findings");
    }
  }
  if (program_errors) return kProgramErrors;
  return status.error_code() == grpc::StatusCode::INVALID_ARGUMENT ? kUsage : kConnection;
}

std::string FullName(const std::string& collection, const std::string& name) {
  return name.starts_with(collection + "/") ? name : collection + "/" + name;
}

}  // namespace rmlcell::cli
