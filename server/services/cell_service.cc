#include "server/services/cell_service.h"

#include <chrono>

#include "server/base/config.h"
#include "server/base/version.h"
#include "server/jobs/dispatcher.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

storage::WallTime Now() {
  return std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now());
}

}  // namespace

CellService::CellService(CallNeeds needs, storage::Store& store, const Dispatcher& dispatcher,
                         const Config& config, std::string instance_id)
    : needs_(needs),
      store_(store),
      dispatcher_(dispatcher),
      config_(config),
      instance_id_(std::move(instance_id)),
      started_at_(Now()) {}

grpc::ServerUnaryReactor* CellService::GetCell(grpc::CallbackServerContext* context,
                                               const v1::GetCellRequest* request,
                                               v1::Cell* response) {
  return Answer(needs_, context, *request, "CellService/GetCell", [this, response](const Caller&) {
    const auto counts = store_.CountJobs();
    if (!counts) return ToGrpcStatus(counts.error());
    response->set_version(std::string(kVersion));
    response->set_instance_id(instance_id_);
    *response->mutable_started_at() = ToProto(started_at_);
    *response->mutable_server_time() = ToProto(Now());
    response->set_workers(dispatcher_.workers());
    response->set_jobs_queued(counts->queued);
    response->set_jobs_running(counts->running);
    response->set_unary_program_bytes_max(kUnaryBytes);
    response->set_program_bytes_max(config_.limit_program_bytes);
    return grpc::Status::OK;
  });
}

}  // namespace rmlcell::server
