#pragma once

#include <string>

#include "rmlcell/v1/host.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/worker.pb.h"
#include "server/services/job_streams.h"
#include "server/services/submit_stream.h"
#include "storage/store.h"

namespace rmlcell::server {

class Dispatcher;
class EventFeed;
class JobBook;
class JobResults;
class RunQueue;

// Converts, calls, converts: the rules live in server/jobs.
// GetJob is answered with bytes that are ready (ToldJobs).
class JobService final
    : public v1::JobService::WithRawCallbackMethod_GetJob<v1::JobService::CallbackService> {
 public:
  JobService(CallNeeds needs, Executor& watches, JobBook& book, JobResults& results,
             Dispatcher& dispatcher, RunQueue& runs, EventFeed& feed, OpenStreams& open,
             std::string instance_id)
      : needs_(needs),
        watches_(watches),
        book_(book),
        results_(results),
        dispatcher_(dispatcher),
        runs_(runs),
        feed_(feed),
        open_(open),
        instance_id_(std::move(instance_id)) {}

  grpc::ServerUnaryReactor* SubmitJob(grpc::CallbackServerContext* context,
                                      const v1::SubmitJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>* SubmitJobs(
      grpc::CallbackServerContext* context) override {
    return MakeSubmitStream(needs_, *context, book_, open_);
  }
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context,
                                   const grpc::ByteBuffer* request,
                                   grpc::ByteBuffer* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context,
                                     const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* context,
                                      const v1::DeleteJobRequest* request,
                                      google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* HoldJob(grpc::CallbackServerContext* context,
                                    const v1::HoldJobRequest* request,
                                    v1::HaltJobResponse* response) override;
  grpc::ServerUnaryReactor* StopJob(grpc::CallbackServerContext* context,
                                    const v1::StopJobRequest* request,
                                    v1::HaltJobResponse* response) override;
  grpc::ServerUnaryReactor* ResumeJob(grpc::CallbackServerContext* context,
                                      const v1::ResumeJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* SetJobOverride(grpc::CallbackServerContext* context,
                                           const v1::SetJobOverrideRequest* request,
                                           v1::Job* response) override;
  grpc::ServerUnaryReactor* DecideInterrupted(grpc::CallbackServerContext* context,
                                              const v1::DecideInterruptedRequest* request,
                                              v1::DecideInterruptedResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(
      grpc::CallbackServerContext* context, const v1::WatchJobRequest* request) override;
  grpc::ServerUnaryReactor* GetJobReport(grpc::CallbackServerContext* context,
                                         const v1::GetJobReportRequest* request,
                                         v1::RunReport* response) override;
  grpc::ServerWriteReactor<v1::StreamJobToolpathResponse>* StreamJobToolpath(
      grpc::CallbackServerContext* context, const v1::StreamJobToolpathRequest* request) override;
  grpc::ServerWriteReactor<v1::StreamJobHeightsResponse>* StreamJobHeights(
      grpc::CallbackServerContext* context, const v1::StreamJobHeightsRequest* request) override;
  grpc::ServerUnaryReactor* GetJobPicture(grpc::CallbackServerContext* context,
                                          const v1::GetJobPictureRequest* request,
                                          v1::GetJobPictureResponse* response) override;
  grpc::ServerUnaryReactor* GetJobArtifact(grpc::CallbackServerContext* context,
                                           const v1::GetJobArtifactRequest* request,
                                           v1::GetJobArtifactResponse* response) override;
  grpc::ServerWriteReactor<v1::StreamJobArtifactResponse>* StreamJobArtifact(
      grpc::CallbackServerContext* context, const v1::StreamJobArtifactRequest* request) override;
  grpc::ServerWriteReactor<v1::StreamJobTraceResponse>* StreamJobTrace(
      grpc::CallbackServerContext* context, const v1::StreamJobTraceRequest* request) override;

  grpc::ServerUnaryReactor* CancelJobs(grpc::CallbackServerContext* context,
                                       const v1::CancelJobsRequest* request,
                                       v1::CancelJobsResponse* response) override;
  grpc::ServerUnaryReactor* HoldJobs(grpc::CallbackServerContext* context,
                                     const v1::HoldJobsRequest* request,
                                     v1::HoldJobsResponse* response) override;
  grpc::ServerUnaryReactor* MoveJob(grpc::CallbackServerContext* context,
                                    const v1::MoveJobRequest* request, v1::Job* response) override;

  grpc::ServerUnaryReactor* ListJobFindings(grpc::CallbackServerContext* context,
                                            const v1::ListJobFindingsRequest* request,
                                            v1::ListJobFindingsResponse* response) override;
  grpc::ServerUnaryReactor* GetJobSeries(grpc::CallbackServerContext* context,
                                         const v1::GetJobSeriesRequest* request,
                                         v1::GetJobSeriesResponse* response) override;
  grpc::ServerUnaryReactor* CompareJobs(grpc::CallbackServerContext* context,
                                        const v1::CompareJobsRequest* request,
                                        v1::CompareJobsResponse* response) override;
  grpc::ServerUnaryReactor* GetStepMap(grpc::CallbackServerContext* context,
                                       const v1::GetStepMapRequest* request,
                                       v1::GetStepMapResponse* response) override;

 private:
  template <class Response>
  grpc::Status ActOn(const v1::JobChoice& jobs, std::optional<storage::JobState> state,
                     storage::QueueAct act, const Caller& caller, Response& response);
  template <class Request, class Response>
  grpc::ServerUnaryReactor* Order(grpc::CallbackServerContext* context, std::string_view method,
                                  const Request& request, v1::WorkerControl::Kind kind,
                                  Response* response);
  // Of a job that a machine runs: the order goes to its host.
  template <class Request, class Response>
  grpc::ServerUnaryReactor* OrderRun(grpc::CallbackServerContext* context, std::string_view method,
                                     const Request& request, v1::HostOrder order,
                                     Response* response);
  void ResumeAtStep(const v1::DecideInterruptedRequest& request, const std::string& machine,
                    const std::string& caller, v1::DecideInterruptedResponse& response,
                    const std::function<void(const grpc::Status&)>& end);
  void TellCancel(const storage::JobRecord& job, const Caller& caller);
  grpc::Status Give(const std::string& name, v1::Job* response);
  Status OrderWaiting(const std::string& name, v1::WorkerControl::Kind kind,
                      const std::string& caller);
  JobStreamNeeds Streams(Executor& lane) const;

  CallNeeds needs_;
  Executor& watches_;
  JobBook& book_;
  JobResults& results_;
  Dispatcher& dispatcher_;
  RunQueue& runs_;
  EventFeed& feed_;
  OpenStreams& open_;
  std::string instance_id_;
};

}  // namespace rmlcell::server
