#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "rmlcell/v1/job.pb.h"
#include "server/services/pull_stream.h"

namespace rmlcell::server {

class EventFeed;
class JobBook;
class RunningHeights;
class RunningToolpath;

// What a stream of jobs works with.
struct JobStreamNeeds {
  Executor& executor;
  OpenStreams& open;
  JobBook& book;
  EventFeed& feed;
  // Of a job that runs here; null: it does not.
  std::function<std::shared_ptr<RunningToolpath>(std::int64_t job)> running_toolpath;
  std::function<std::shared_ptr<RunningHeights>(std::int64_t job)> running_heights;
  std::string instance_id;
};

std::shared_ptr<PullStream<v1::WatchJobResponse>> MakeJobWatch(const JobStreamNeeds& needs,
                                                               const v1::WatchJobRequest& request);
std::shared_ptr<PullStream<v1::StreamJobToolpathResponse>> MakeToolpathStream(
    const JobStreamNeeds& needs, const v1::StreamJobToolpathRequest& request);
std::shared_ptr<PullStream<v1::StreamJobHeightsResponse>> MakeHeightsStream(
    const JobStreamNeeds& needs, const v1::StreamJobHeightsRequest& request);
std::shared_ptr<PullStream<v1::StreamJobTraceResponse>> MakeTraceStream(
    const JobStreamNeeds& needs, const std::string& job_name);
std::shared_ptr<PullStream<v1::StreamJobArtifactResponse>> MakeArtifactStream(
    const JobStreamNeeds& needs, const v1::StreamJobArtifactRequest& request);

}  // namespace rmlcell::server
