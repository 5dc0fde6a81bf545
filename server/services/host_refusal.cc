#include "server/services/host_refusal.h"

#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include "proto/bridge/findings.h"

namespace rmlcell::server {

grpc::Status RefusalOf(const v1::HostOrderAnswer& answer) {
  const v1::ErrorDetail& refusal = answer.refusal();
  const auto found = FindByText(refusal.code());
  const ErrorCode code = found.empty() ? ErrorCode::kCellInternal : found.front()->code;
  google::rpc::Status status = bridge::ToRpcStatus({code, refusal.message(), {}});
  // It is not asked wrongly: the machine does not stand for it now.
  const Severity severity = Lookup(code).severity;
  if (severity == Severity::kAlarm || severity == Severity::kFatal ||
      severity == Severity::kMessage)
    status.set_code(grpc::StatusCode::FAILED_PRECONDITION);
  google::rpc::PreconditionFailure all;
  for (const v1::StartBlocker& one : answer.start_blockers()) {
    auto& violation = *all.add_violations();
    violation.set_type(one.code());
    violation.set_subject(answer.machine_refusal().machine());
    violation.set_description(one.message());
  }
  if (!all.violations().empty()) status.add_details()->PackFrom(all);
  if (answer.has_machine_refusal()) status.add_details()->PackFrom(answer.machine_refusal());
  return {static_cast<grpc::StatusCode>(status.code()), status.message(),
          status.SerializeAsString()};
}

}  // namespace rmlcell::server
