#include "server/services/job_service.h"

#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/dispatcher.h"
#include "server/jobs/job_book.h"
#include "server/results/job_results.h"
#include "server/runs/run_queue.h"
#include "server/services/job_streams.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {

// The one method that does not go through the executor. Of callers that come together only the
// first waits here for the disk; the store answers all others from its own thread, with one commit.
grpc::ServerUnaryReactor* JobService::SubmitJob(grpc::CallbackServerContext* context,
                                                const v1::SubmitJobRequest* request,
                                                v1::Job* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const Result<Caller> caller = Admit(needs_.gate, *context, "JobService/SubmitJob", request);
  const Status good = CheckRequest(needs_, *request);
  if (!caller || !good) {
    reactor->Finish(ToGrpcStatus(caller ? good.error() : caller.error()));
    return reactor;
  }
  const auto begin = std::chrono::steady_clock::now();
  book_.Submit(*request, caller->identity,
               [reactor, response, begin, caller = *caller](Result<v1::Job> job) {
                 grpc::Status status;
                 if (job) {
                   *response = std::move(*job);
                 } else {
                   status = ToGrpcStatus(job.error());
                 }
                 LogCall("JobService/SubmitJob", caller, status,
                         std::chrono::steady_clock::now() - begin);
                 reactor->Finish(status);
               });
  return reactor;
}

grpc::ServerUnaryReactor* JobService::GetJob(grpc::CallbackServerContext* context,
                                             const grpc::ByteBuffer* request,
                                             grpc::ByteBuffer* response) {
  v1::GetJobRequest asked;
  grpc::ByteBuffer bytes(*request);
  const grpc::Status read =
      grpc::SerializationTraits<v1::GetJobRequest>::Deserialize(&bytes, &asked);
  if (!read.ok()) {
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(read);
    return reactor;
  }
  const auto give = [response](const std::string& job) {
    const grpc::Slice slice(job);
    *response = grpc::ByteBuffer(&slice, 1);
    return grpc::Status::OK;
  };
  return AnswerFromMemory(
      needs_, context, asked, "JobService/GetJob",
      [this, &asked, give](const Caller&) -> std::optional<grpc::Status> {
        const auto job = book_.GetAtOnce(asked.name());
        return job ? std::optional(give(*job)) : std::nullopt;
      },
      [this, name = asked.name(), give](const Caller&) {
        const Result<v1::Job> job = book_.Get(name);
        return job ? give(job->SerializeAsString()) : ToGrpcStatus(job.error());
      });
}

grpc::ServerUnaryReactor* JobService::ListJobs(grpc::CallbackServerContext* context,
                                               const v1::ListJobsRequest* request,
                                               v1::ListJobsResponse* response) {
  return Answer(needs_, context, *request, "JobService/ListJobs",
                [this, request, response](const Caller&) {
                  Result<v1::ListJobsResponse> jobs = book_.List(*request);
                  if (!jobs) return ToGrpcStatus(jobs.error());
                  *response = std::move(*jobs);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::DeleteJob(grpc::CallbackServerContext* context,
                                                const v1::DeleteJobRequest* request,
                                                google::protobuf::Empty*) {
  return Answer(needs_, context, *request, "JobService/DeleteJob",
                [this, request](const Caller& caller) {
                  if (runs_.IsToBeDecided(request->name()))
                    return ToGrpcStatus(
                        Error{ErrorCode::kCellInspect,
                              "its machine waits for a decision about it: go on with it, begin it "
                              "anew, or give it up",
                              {}});
                  const Status deleted = book_.Delete(request->name(), caller.identity);
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

JobStreamNeeds JobService::Streams(Executor& lane) const {
  return {.executor = lane,
          .open = open_,
          .book = book_,
          .feed = feed_,
          .running_toolpath = [this](std::int64_t job) { return dispatcher_.FollowToolpath(job); },
          .running_heights = [this](std::int64_t job) { return dispatcher_.FollowHeights(job); },
          .instance_id = instance_id_};
}

grpc::Status JobService::Give(const std::string& name, v1::Job* response) {
  Result<v1::Job> job = book_.Get(name);
  if (!job) return ToGrpcStatus(job.error());
  *response = *std::move(job);
  return grpc::Status::OK;
}

grpc::ServerWriteReactor<v1::WatchJobResponse>* JobService::WatchJob(
    grpc::CallbackServerContext* context, const v1::WatchJobRequest* request) {
  return OpenStream<v1::WatchJobResponse>(
      needs_, *context, *request, "JobService/WatchJob",
      [&](const Caller&) { return MakeJobWatch(Streams(watches_), *request); });
}

grpc::ServerUnaryReactor* JobService::GetJobReport(grpc::CallbackServerContext* context,
                                                   const v1::GetJobReportRequest* request,
                                                   v1::RunReport* response) {
  return Answer(needs_, context, *request, "JobService/GetJobReport",
                [this, request, response](const Caller&) {
                  Result<v1::RunReport> report = results_.Report(request->name());
                  if (!report) return ToGrpcStatus(report.error());
                  *response = *std::move(report);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::ListJobFindings(grpc::CallbackServerContext* context,
                                                      const v1::ListJobFindingsRequest* request,
                                                      v1::ListJobFindingsResponse* response) {
  return Answer(needs_, context, *request, "JobService/ListJobFindings",
                [this, request, response](const Caller&) {
                  Result<v1::ListJobFindingsResponse> findings = results_.Findings(*request);
                  if (!findings) return ToGrpcStatus(findings.error());
                  *response = *std::move(findings);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::GetJobSeries(grpc::CallbackServerContext* context,
                                                   const v1::GetJobSeriesRequest* request,
                                                   v1::GetJobSeriesResponse* response) {
  return Answer(needs_, context, *request, "JobService/GetJobSeries",
                [this, request, response](const Caller&) {
                  Result<v1::GetJobSeriesResponse> series = results_.Series(*request);
                  if (!series) return ToGrpcStatus(series.error());
                  *response = *std::move(series);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::CompareJobs(grpc::CallbackServerContext* context,
                                                  const v1::CompareJobsRequest* request,
                                                  v1::CompareJobsResponse* response) {
  return Answer(needs_.Computing(), context, *request, "JobService/CompareJobs",
                [this, request, response](const Caller&) {
                  Result<v1::CompareJobsResponse> compared = results_.Compare(*request);
                  if (!compared) return ToGrpcStatus(compared.error());
                  *response = *std::move(compared);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::GetStepMap(grpc::CallbackServerContext* context,
                                                 const v1::GetStepMapRequest* request,
                                                 v1::GetStepMapResponse* response) {
  return Answer(needs_.Computing(), context, *request, "JobService/GetStepMap",
                [this, request, response](const Caller&) {
                  Result<v1::GetStepMapResponse> map = results_.StepMap(*request);
                  if (!map) return ToGrpcStatus(map.error());
                  *response = *std::move(map);
                  return grpc::Status::OK;
                });
}

grpc::ServerWriteReactor<v1::StreamJobToolpathResponse>* JobService::StreamJobToolpath(
    grpc::CallbackServerContext* context, const v1::StreamJobToolpathRequest* request) {
  return OpenStream<v1::StreamJobToolpathResponse>(
      needs_, *context, *request, "JobService/StreamJobToolpath",
      [&](const Caller&) { return MakeToolpathStream(Streams(needs_.executor), *request); });
}

grpc::ServerWriteReactor<v1::StreamJobHeightsResponse>* JobService::StreamJobHeights(
    grpc::CallbackServerContext* context, const v1::StreamJobHeightsRequest* request) {
  return OpenStream<v1::StreamJobHeightsResponse>(
      needs_, *context, *request, "JobService/StreamJobHeights",
      [&](const Caller&) { return MakeHeightsStream(Streams(needs_.executor), *request); });
}

grpc::ServerUnaryReactor* JobService::GetJobPicture(grpc::CallbackServerContext* context,
                                                    const v1::GetJobPictureRequest* request,
                                                    v1::GetJobPictureResponse* response) {
  return Answer(needs_, context, *request, "JobService/GetJobPicture",
                [this, request, response](const Caller&) {
                  const Result<std::int64_t> id = ParseJobName(request->name());
                  if (!id) return ToGrpcStatus(id.error());
                  const Result<std::string> bytes = book_.ReadArtifact(*id, "picture.svg");
                  if (!bytes) return ToGrpcStatus(bytes.error());
                  response->set_content(*bytes);
                  response->set_media_type("image/svg+xml");
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* JobService::GetJobArtifact(grpc::CallbackServerContext* context,
                                                     const v1::GetJobArtifactRequest* request,
                                                     v1::GetJobArtifactResponse* response) {
  return Answer(
      needs_, context, *request, "JobService/GetJobArtifact",
      [this, request, response](const Caller&) {
        const Result<std::int64_t> id = ParseJobName(request->name());
        if (!id) return ToGrpcStatus(id.error());
        const auto artifact = book_.FindArtifact(*id, request->artifact());
        if (!artifact) return ToGrpcStatus(artifact.error());
        if (artifact->size > kUnaryBytes) {
          return ToGrpcStatus(Error{ErrorCode::kCellTooLarge,
                                    request->artifact() + " has " + std::to_string(artifact->size) +
                                        " bytes, one answer takes 3 MiB; use StreamJobArtifact",
                                    {}});
        }
        Result<std::string> bytes = book_.ReadArtifact(*id, request->artifact());
        if (!bytes) return ToGrpcStatus(bytes.error());
        response->set_content(*std::move(bytes));
        response->set_media_type(artifact->media_type);
        return grpc::Status::OK;
      });
}

grpc::ServerWriteReactor<v1::StreamJobArtifactResponse>* JobService::StreamJobArtifact(
    grpc::CallbackServerContext* context, const v1::StreamJobArtifactRequest* request) {
  return OpenStream<v1::StreamJobArtifactResponse>(
      needs_, *context, *request, "JobService/StreamJobArtifact",
      [&](const Caller&) { return MakeArtifactStream(Streams(needs_.executor), *request); });
}

grpc::ServerWriteReactor<v1::StreamJobTraceResponse>* JobService::StreamJobTrace(
    grpc::CallbackServerContext* context, const v1::StreamJobTraceRequest* request) {
  return OpenStream<v1::StreamJobTraceResponse>(
      needs_, *context, *request, "JobService/StreamJobTrace",
      [&](const Caller&) { return MakeTraceStream(Streams(needs_.executor), request->name()); });
}

grpc::ServerUnaryReactor* JobService::CancelJobs(grpc::CallbackServerContext* context,
                                                 const v1::CancelJobsRequest* request,
                                                 v1::CancelJobsResponse* response) {
  return Answer(needs_.Computing(), context, *request, "JobService/CancelJobs",
                [this, request, response](const Caller& caller) {
                  return ActOn(request->jobs(), {}, storage::QueueAct::kCancel, caller, *response);
                });
}

grpc::ServerUnaryReactor* JobService::HoldJobs(grpc::CallbackServerContext* context,
                                               const v1::HoldJobsRequest* request,
                                               v1::HoldJobsResponse* response) {
  return Answer(needs_.Computing(), context, *request, "JobService/HoldJobs",
                [this, request, response](const Caller& caller) {
                  const auto act =
                      request->release() ? storage::QueueAct::kRelease : storage::QueueAct::kHold;
                  return ActOn(request->jobs(), storage::JobState::kQueued, act, caller, *response);
                });
}

// Not on the lane of the store: with many jobs it takes a while, and others want a short answer.
template <class Response>
grpc::Status JobService::ActOn(const v1::JobChoice& jobs, std::optional<storage::JobState> state,
                               storage::QueueAct act, const Caller& caller, Response& response) {
  const auto names = book_.Choose(jobs, state);
  if (!names) return ToGrpcStatus(names.error());
  const auto changed = book_.ActOn(*names, act, caller.identity);
  if (!changed) return ToGrpcStatus(changed.error());
  for (const storage::JobRecord& job : *changed) TellCancel(job, caller);
  response.set_jobs(static_cast<std::int64_t>(changed->size()));
  return grpc::Status::OK;
}

grpc::ServerUnaryReactor* JobService::MoveJob(grpc::CallbackServerContext* context,
                                              const v1::MoveJobRequest* request,
                                              v1::Job* response) {
  return Answer(needs_, context, *request, "JobService/MoveJob",
                [this, request, response](const Caller& caller) {
                  Result<v1::Job> job = book_.Move(*request, caller.identity);
                  if (!job) return ToGrpcStatus(job.error());
                  *response = *std::move(job);
                  return grpc::Status::OK;
                });
}

}  // namespace rmlcell::server
