#include "server/services/call.h"

#include <grpc/grpc_security_constants.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "google/api/field_behavior.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"

namespace rmlcell::server {
namespace {

// gRPC sends details in a header, and clients take 8 KiB of headers: more findings are left out.
constexpr std::size_t kDetailsMax = 6 << 10;
// The text stands in them twice, and once in the message: with a name of a megabyte in it nothing
// would arrive.
constexpr std::size_t kErrorTextMax = 1000;

// What moves a machine is not repeated by a client that lost the answer: it says which request it
// is.
Status CheckRequestId(const google::protobuf::Message& request) {
  const auto* field = request.GetDescriptor()->FindFieldByName("request_id");
  if (field == nullptr || !request.GetReflection()->GetString(request, field).empty()) return {};
  const auto& behaviour = field->options();
  const auto& said = behaviour.GetRepeatedExtension(google::api::field_behavior);
  if (std::ranges::find(said, google::api::REQUIRED) == said.end()) return {};
  return Error{ErrorCode::kCellInvalidArgument,
               "request_id: a UUID of your making, new for each request; the same again for one "
               "that is repeated",
               {}};
}

}  // namespace

grpc::Status ToGrpcStatus(const Error& error, const std::vector<Diagnostic>& diagnostics,
                          UntoldFindings dropped) {
  std::vector<Diagnostic> shown = diagnostics;
  Error shortened = error;
  if (shortened.detail.size() > kErrorTextMax) {
    shortened.detail.resize(kErrorTextMax);
    shortened.detail += "...";
  }
  // The values of the text that have a name go first where they alone are too much: the text has
  // them.
  if (bridge::ToRpcStatus(shortened, {}, dropped).ByteSizeLong() > kDetailsMax)
    shortened.detail = Detail(std::string(shortened.detail));
  google::rpc::Status rich = bridge::ToRpcStatus(shortened, shown, dropped);
  while (rich.ByteSizeLong() > kDetailsMax && !shown.empty()) {
    const std::size_t keep = shown.size() / 2;
    for (std::size_t i = keep; i < shown.size(); ++i) dropped.Add(shown[i]);
    shown.resize(keep);
    rich = bridge::ToRpcStatus(shortened, shown, dropped);
  }
  return {static_cast<grpc::StatusCode>(rich.code()), rich.message(), rich.SerializeAsString()};
}

Status CheckRequest(const CallNeeds& needs, const google::protobuf::Message& request) {
  const auto size = static_cast<std::int64_t>(request.ByteSizeLong());
  if (size <= needs.message_bytes_max) return CheckRequestId(request);
  return Error{
      ErrorCode::kCellTooLarge,
      "the message has " + std::to_string(size) + " bytes, one call takes " +
          std::to_string(needs.message_bytes_max) +
          " (limits.message_bytes); send a large program by chunks (UploadProgram, rmlcell put), and name its slot in a job",
      {}};
}

Error LaneFull() {
  return {ErrorCode::kCellResourceExhausted,
          "too many programs wait to be translated or compared; try again when some are done",
          {}};
}

grpc::Status StatusOfThrown(std::string_view method, const std::exception& thrown) {
  spdlog::error("{}: an exception left its folder: {}", method, thrown.what());
  return ToGrpcStatus(Error{ErrorCode::kCellInternal, {}, {}});
}

CallFacts FactsOf(std::string method, const grpc::ServerContextBase& context,
                  const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  CallFacts facts{.method = std::move(method), .peer = context.peer()};
  for (const auto& [key, value] : metadata) {
    facts.metadata.emplace(std::string(key.data(), key.size()),
                           std::string(value.data(), value.size()));
  }
  if (facts.peer.starts_with(SocketUsers::kPeer)) facts.transport = Transport::kUnixSocket;
  const std::vector<grpc::string_ref> certificates =
      context.auth_context()->FindPropertyValues(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  if (!certificates.empty())
    facts.certificate.assign(certificates.front().data(), certificates.front().size());
  return facts;
}

CallFacts FactsOfCall(const Gate& gate, const grpc::ServerContextBase& context,
                      std::string_view method, const google::protobuf::Message* request) {
  CallFacts facts =
      FactsOf("/rmlcell.v1." + std::string(method), context, context.client_metadata());
  const v1::Access* access = gate.AccessOf(facts.method);
  if (access != nullptr && request != nullptr)
    facts.resource = ResourceOf(*request, access->resource_field());
  return facts;
}

Result<Caller> Admit(const Gate& gate, const grpc::ServerContextBase& context,
                     std::string_view method, const google::protobuf::Message* request) {
  return gate.Admit(FactsOfCall(gate, context, method, request));
}

void LogCall(std::string_view method, const Caller& caller, const grpc::Status& status,
             std::chrono::steady_clock::duration took) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(took).count();
  if (status.ok()) {
    spdlog::debug("{} ok in {} us, caller {} at {} request {}", method, us, caller.identity,
                  caller.peer, caller.request_id);
  } else {
    spdlog::info("{} {} in {} us, caller {} at {} request {}: {}", method,
                 static_cast<int>(status.error_code()), us, caller.identity, caller.peer,
                 caller.request_id, status.error_message());
  }
}

}  // namespace rmlcell::server
