#include "server/services/cell_service.h"

#include <chrono>

#include "server/base/config.h"
#include "server/base/version.h"
#include "server/jobs/dispatcher.h"
#include "server/records/job_messages.h"
#include "server/services/open_stream.h"
#include "server/web/static_page.h"

namespace rmlcell::server {
namespace {

storage::WallTime Now() {
  return std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now());
}

}  // namespace

CellService::CellService(CallNeeds needs, CellWatchNeeds watch, const Dispatcher& dispatcher,
                         const Config& config)
    : needs_(needs),
      watch_needs_(std::move(watch)),
      dispatcher_(dispatcher),
      config_(config),
      started_at_(Now()),
      page_etag_(web::PageEtag()) {}

grpc::ServerUnaryReactor* CellService::GetCell(grpc::CallbackServerContext* context,
                                               const v1::GetCellRequest* request,
                                               v1::Cell* response) {
  return Answer(needs_, context, *request, "CellService/GetCell", [this, response](const Caller&) {
    const auto counts = watch_needs_.records.store.CountJobs();
    if (!counts) return ToGrpcStatus(counts.error());
    response->set_version(std::string(kVersion));
    response->set_instance_id(watch_needs_.instance_id);
    response->set_log_id(watch_needs_.records.store.LogId());
    *response->mutable_started_at() = ToProto(started_at_);
    *response->mutable_server_time() = ToProto(Now());
    response->set_workers(dispatcher_.workers());
    response->set_jobs_queued(counts->queued);
    response->set_jobs_running(counts->running);
    response->set_unary_program_bytes_max(kUnaryBytes);
    response->set_title(config_.cell_name);
    response->set_page_etag(page_etag_);
    response->set_program_bytes_max(config_.limit_program_bytes);
    return grpc::Status::OK;
  });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* CellService::WatchCell(
    grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) {
  return OpenCellWatch(needs_, watch_needs_, *context, *request);
}

grpc::ServerUnaryReactor* CellService::UpdateWatch(grpc::CallbackServerContext* context,
                                                   const v1::UpdateWatchRequest* request,
                                                   google::protobuf::Empty*) {
  return Answer(needs_, context, *request, "CellService/UpdateWatch",
                [this, request](const Caller& caller) {
                  const Status changed = watch_needs_.registry.Change(*request, caller.identity);
                  return changed ? grpc::Status::OK : ToGrpcStatus(changed.error());
                });
}

}  // namespace rmlcell::server
