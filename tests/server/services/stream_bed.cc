#include "tests/server/services/stream_bed.h"

#include "server/base/names.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {

std::int64_t StreamBed::Submit(const v1::Job& specification) {
  return Must(bed.store().SubmitAndWait({.machine = "optimo-1",
                                         .kind = "CHECK",
                                         .specification = specification.SerializeAsString(),
                                         .events = {StateEvent(storage::JobState::kQueued)}}))
      .job.id;
}

void StreamBed::Say(const storage::Lease& lease, const std::vector<std::string>& texts) {
  std::vector<storage::NewEvent> events;
  for (const std::string& text : texts) {
    v1::JobEvent event;
    event.mutable_message()->set_text(text);
    events.push_back(ToRecord(event));
  }
  Must(bed.store().AppendAndWait(lease, std::move(events)));
}

void StreamBed::Finish(const storage::Lease& lease,
                       const std::vector<storage::NewArtifact>& artifacts) {
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  Must(bed.store().Finish(
      lease,
      {.outcome = OutcomeOf(outcome), .artifacts = artifacts, .events = {EndedEvent(outcome)}}));
}

std::int64_t StreamBed::Ended(const std::string& artifact, const std::string& bytes,
                              const v1::Job& specification) {
  const std::int64_t job = Submit(specification);
  Finish(bed.Lease(),
         {{.name = artifact, .media_type = "application/octet-stream", .bytes = bytes}});
  return job;
}

void StreamBed::TellSteps(std::int64_t job, int steps) {
  v1::JobProgress progress;
  progress.set_job(JobName(job));
  progress.set_steps(steps);
  const std::string bytes = progress.SerializeAsString();
  feed.Publish(JobName(job), bytes);
  EXPECT_TRUE(Eventually([&] {
    const auto told = feed.LatestAfter(JobName(job), 0);
    return told && *told->bytes == bytes;
  }));
}

OpenedStream<v1::WatchJobResponse> StreamBed::Watch(std::int64_t job, std::int64_t after,
                                                    bool events_only) {
  v1::WatchJobRequest request;
  request.set_name(JobName(job));
  request.set_after_sequence(after);
  request.set_events_only(events_only);
  return Watch(request);
}

OpenedStream<v1::WatchJobResponse> StreamBed::Watch(const v1::WatchJobRequest& request) {
  return OpenedStream<v1::WatchJobResponse>(
      [&](grpc::ClientContext* context) { return stub_->WatchJob(context, request); });
}

OpenedStream<v1::WatchCellResponse> StreamBed::WatchCell(const v1::WatchCellRequest& request) {
  return OpenedStream<v1::WatchCellResponse>(
      [&](grpc::ClientContext* context) { return cell_stub_->WatchCell(context, request); });
}

OpenedStream<v1::WatchMachineResponse> StreamBed::WatchMachine(
    const v1::WatchMachineRequest& request) {
  return OpenedStream<v1::WatchMachineResponse>(
      [&](grpc::ClientContext* context) { return machine_stub_->WatchMachine(context, request); });
}

OpenedStream<v1::StreamJobToolpathResponse> StreamBed::Toolpath(const std::string& name, int level,
                                                                bool with_levels) {
  v1::StreamJobToolpathRequest request;
  request.set_name(name);
  request.set_level(level);
  request.set_with_levels(with_levels);
  return Toolpath(request);
}

std::shared_ptr<RunningToolpath> StreamBed::Run(std::int64_t job) {
  const std::lock_guard lock(running_mutex_);
  return running_[job] = std::make_shared<RunningToolpath>();
}

std::shared_ptr<RunningHeights> StreamBed::RunMill(std::int64_t job) {
  const std::lock_guard lock(running_mutex_);
  return mills_[job] = std::make_shared<RunningHeights>();
}

OpenedStream<v1::StreamJobHeightsResponse> StreamBed::Heights(
    const v1::StreamJobHeightsRequest& request) {
  return OpenedStream<v1::StreamJobHeightsResponse>(
      [&](grpc::ClientContext* context) { return stub_->StreamJobHeights(context, request); });
}

OpenedStream<v1::StreamJobToolpathResponse> StreamBed::Toolpath(
    const v1::StreamJobToolpathRequest& request) {
  return OpenedStream<v1::StreamJobToolpathResponse>(
      [&](grpc::ClientContext* context) { return stub_->StreamJobToolpath(context, request); });
}

OpenedStream<v1::StreamJobTraceResponse> StreamBed::Trace(const std::string& name) {
  v1::StreamJobTraceRequest request;
  request.set_name(name);
  return OpenedStream<v1::StreamJobTraceResponse>(
      [&](grpc::ClientContext* context) { return stub_->StreamJobTrace(context, request); });
}

OpenedStream<v1::StreamJobArtifactResponse> StreamBed::Artifact(const std::string& name,
                                                                const std::string& artifact) {
  v1::StreamJobArtifactRequest request;
  request.set_name(name);
  request.set_artifact(artifact);
  return OpenedStream<v1::StreamJobArtifactResponse>(
      [&](grpc::ClientContext* context) { return stub_->StreamJobArtifact(context, request); });
}

}  // namespace rmlcell::server
