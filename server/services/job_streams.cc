#include "server/services/job_streams.h"

#include <algorithm>
#include <deque>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/simulation/toolpath/toolpath_level.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"
#include "proto/bridge/framing.h"
#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

// Events read from the log at once; all that a watcher ever holds.
constexpr int kReadAhead = 64;

// A watcher must not wait for events that are numbered otherwise by now: it has its number of
// another cell, or the store was put back from a backup. It is told, and never set somewhere else
// in silence.
Status CheckPosition(std::int64_t after, std::int64_t last) {
  if (after < 0) return InvalidArgument("after_sequence is below 0");
  if (after <= last) return {};
  return InvalidArgument("after_sequence is " + std::to_string(after) +
                         ", the last event of the job is " + std::to_string(last) +
                         ": begin anew, with a snapshot");
}

// A snapshot first, then the job's events in order, then positions while nothing else is to be
// told; the end of the job ends the stream.
class JobWatch final : public PullStream<v1::WatchJobResponse> {
 public:
  JobWatch(const JobStreamNeeds& needs, const v1::WatchJobRequest& request)
      : PullStream(needs.executor, needs.open), needs_(needs), request_(request) {}

 private:
  Next Make(v1::WatchJobResponse& message, grpc::Status& status) override {
    message.set_instance_id(needs_.instance_id);
    if (!begun_) {
      begun_ = true;
      return MakeSnapshot(message, status);
    }
    if (read_ahead_.empty() && !ReadEvents(status)) return Next::kEnd;
    if (!read_ahead_.empty()) {
      storage::EventRecord event = std::move(read_ahead_.front());
      read_ahead_.pop_front();
      cursor_ = event.sequence;
      message.set_sequence(event.sequence);
      *message.mutable_event() = ToProto(event);
      ended_ = message.event().has_ended();
      return Next::kMessage;
    }
    if (ended_ || Gone(status)) return Next::kEnd;
    if (!request_.events_only()) {
      if (const auto progress = needs_.feed.LatestAfter(JobName(job_), progress_seen_)) {
        progress_seen_ = progress->version;
        message.mutable_progress()->ParseFromString(*progress->bytes);
        return Next::kMessage;
      }
    }
    return Next::kNothing;
  }

  Next MakeSnapshot(v1::WatchJobResponse& message, grpc::Status& status) {
    Result<v1::Job> job = needs_.book.Get(request_.name());
    if (!job) {
      status = ToGrpcStatus(job.error());
      return Next::kEnd;
    }
    job_ = *ParseJobName(request_.name());
    // Subscribed before the log is read: what comes in between wakes us again.
    subscription_ = needs_.feed.Subscribe(JobName(job_), [this] { Wake(); });
    cursor_ = request_.has_after_sequence() ? request_.after_sequence() : job->last_sequence();
    if (const Status there = CheckPosition(cursor_, job->last_sequence()); !there) {
      status = ToGrpcStatus(there.error());
      return Next::kEnd;
    }
    final_sequence_ = job->has_end_time() ? job->last_sequence() : -1;
    message.set_sequence(cursor_);
    *message.mutable_snapshot() = std::move(*job);
    return Next::kMessage;
  }

  bool ReadEvents(grpc::Status& status) {
    auto events = needs_.feed.JobEvents(job_, cursor_, kReadAhead);
    if (!events) {
      status = ToGrpcStatus(events.error());
      return false;
    }
    for (storage::EventRecord& event : *events) read_ahead_.push_back(std::move(event));
    return true;
  }

  // The job had ended before, and the client has its last event already.
  bool Gone(grpc::Status&) const { return final_sequence_ >= 0 && cursor_ >= final_sequence_; }

  bool MakeGoodbye(v1::WatchJobResponse& message) override {
    message.set_instance_id(needs_.instance_id);
    message.set_sequence(begun_ ? cursor_ : request_.after_sequence());
    *message.mutable_reconnect() = ServerStopped();
    return true;
  }

  void Closed() override { subscription_.reset(); }

  JobStreamNeeds needs_;
  v1::WatchJobRequest request_;
  std::int64_t cursor_ = 0;
  std::int64_t job_ = 0;
  std::int64_t final_sequence_ = -1;
  std::uint64_t progress_seen_ = 0;
  bool begun_ = false;
  bool ended_ = false;
  std::deque<storage::EventRecord> read_ahead_;
  std::unique_ptr<EventFeed::Subscription> subscription_;
};

// Products that are a series of frames (proto/bridge/framing.h), some frames a message.
template <class Response>
class FramesStream : public PullStream<Response> {
 public:
  using typename PullStream<Response>::Next;
  FramesStream(const JobStreamNeeds& needs, std::string job_name, std::string artifact)
      : PullStream<Response>(needs.executor, needs.open),
        needs_(needs),
        job_name_(std::move(job_name)),
        artifact_(std::move(artifact)) {}

 protected:
  // Adds one frame; false: the message is full with it.
  virtual bool Add(std::string_view frame, Response& message) = 0;

  // What goes before the first frame, of so many bytes; false: nothing.
  virtual bool AddHeader(std::int64_t /*bytes*/, Response& /*message*/) { return false; }

  // All frames, as they are stored.
  virtual Result<std::string> Read(std::int64_t job) {
    return needs_.book.ReadArtifact(job, artifact_);
  }

  const std::string& job_name() const { return job_name_; }
  JobBook& book() const { return needs_.book; }

 private:
  Next Make(Response& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      const Result<std::int64_t> job = ParseJobName(job_name_);
      Result<std::string> bytes = job ? Read(*job) : Result<std::string>(job.error());
      if (!bytes) {
        status = ToGrpcStatus(bytes.error());
        return Next::kEnd;
      }
      bytes_ = std::move(*bytes);
      rest_ = bytes_;
      if (AddHeader(static_cast<std::int64_t>(bytes_.size()), message)) return Next::kMessage;
    }
    bool any = false;
    while (const auto frame = bridge::TakeFrame(rest_)) {
      any = true;
      if (!Add(*frame, message)) break;
    }
    return any ? Next::kMessage : Next::kEnd;
  }

  JobStreamNeeds needs_;
  std::string job_name_;
  std::string artifact_;
  bool begun_ = false;
  std::string bytes_;
  std::string_view rest_;
};

// A toolpath that is coarser than the stored one by some levels of detail.
std::string AtLevel(std::string_view frames, double stored_mm, int level) {
  std::string coarse;
  simulation::ToolpathLevel made(simulation::LevelTolerance(stored_mm, level) - stored_mm,
                                 [&](std::string_view block) {
                                   bridge::AddFrame(block, coarse);
                                   return true;
                                 });
  while (const auto frame = bridge::TakeFrame(frames)) {
    const Result<simulation::ToolpathBlock> block = simulation::DecodeToolpathBlock(*frame);
    if (!block) break;  // ends where the stored one does
    made.Take(*block);
  }
  made.Finish();
  return coarse;
}

class ToolpathStream final : public FramesStream<v1::StreamJobToolpathResponse> {
 public:
  ToolpathStream(const JobStreamNeeds& needs, std::string job_name, int level)
      : FramesStream(needs, std::move(job_name), "toolpath"), level_(level) {}

 private:
  Result<std::string> Read(std::int64_t job) override {
    if (level_ < 0 || level_ > simulation::kToolpathLevelMax) {
      return InvalidArgument("level is " + std::to_string(level_) + ", allowed are 0 to " +
                             std::to_string(simulation::kToolpathLevelMax));
    }
    Result<std::string> stored = FramesStream::Read(job);
    if (!stored) return stored;
    const Result<v1::Job> made_by = book().Get(job_name());
    if (!made_by) return made_by.error();
    const double asked = made_by->simulation().toolpath_tolerance_mm();
    const double used = asked > 0.0 ? asked : simulation::ToolpathOptions().tolerance_mm;
    tolerance_mm_ = std::clamp(used, simulation::kToolpathToleranceMin_mm,
                               simulation::kToolpathToleranceMax_mm);  // as the recorder does
    const Result<std::string> report = book().ReadArtifact(job, "report");
    if (report) report_.ParseFromString(*report);
    return level_ == 0 ? stored : AtLevel(*stored, tolerance_mm_, level_);
  }

  bool AddHeader(std::int64_t bytes, v1::StreamJobToolpathResponse& message) override {
    v1::ToolpathHeader& header = *message.mutable_header();
    header.set_level(level_);
    header.set_level_max(simulation::kToolpathLevelMax);
    header.set_tolerance_mm(simulation::LevelTolerance(tolerance_mm_, level_));
    header.set_bytes(bytes);
    header.set_points(report_.toolpath().records());
    header.set_complete(report_.toolpath().complete());
    if (report_.has_tip_box()) *header.mutable_tip_box() = report_.tip_box();
    header.set_duration_ns(FromSeconds(report_.total().times().cycle_s()).count());
    report_.Clear();
    return true;
  }

  bool Add(std::string_view frame, v1::StreamJobToolpathResponse& message) override {
    message.set_block(std::string(frame));
    return false;
  }

  int level_;
  double tolerance_mm_ = 0.0;
  v1::RunReport report_;  // until the header has gone out
};

class TraceStream final : public FramesStream<v1::StreamJobTraceResponse> {
  using FramesStream::FramesStream;
  static constexpr int kRecordsPerMessage = 500;
  bool Add(std::string_view frame, v1::StreamJobTraceResponse& message) override {
    message.add_records()->ParseFromArray(frame.data(), static_cast<int>(frame.size()));
    return message.records_size() < kRecordsPerMessage;
  }
};

// A product as it is kept, in parts. One without bytes has no part.
class ArtifactStream final : public PullStream<v1::StreamJobArtifactResponse> {
 public:
  ArtifactStream(const JobStreamNeeds& needs, const v1::StreamJobArtifactRequest& request)
      : PullStream(needs.executor, needs.open), book_(needs.book), request_(request) {}

 private:
  static constexpr std::size_t kChunkBytes = 1 << 20;

  Next Make(v1::StreamJobArtifactResponse& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      const Result<std::int64_t> job = ParseJobName(request_.name());
      Result<std::string> bytes = !job ? Result<std::string>(job.error())
                                  : request_.artifact().empty()
                                      ? InvalidArgument("artifact is missing: its name")
                                      : book_.ReadArtifact(*job, request_.artifact());
      if (!bytes) {
        status = ToGrpcStatus(bytes.error());
        return Next::kEnd;
      }
      bytes_ = *std::move(bytes);
    }
    if (sent_ == bytes_.size()) return Next::kEnd;
    message.set_chunk(bytes_.substr(sent_, kChunkBytes));
    sent_ += message.chunk().size();
    return Next::kMessage;
  }

  JobBook& book_;
  v1::StreamJobArtifactRequest request_;
  bool begun_ = false;
  std::string bytes_;
  std::size_t sent_ = 0;
};

}  // namespace

std::shared_ptr<PullStream<v1::WatchJobResponse>> MakeJobWatch(const JobStreamNeeds& needs,
                                                               const v1::WatchJobRequest& request) {
  return std::make_shared<JobWatch>(needs, request);
}

std::shared_ptr<PullStream<v1::StreamJobToolpathResponse>> MakeToolpathStream(
    const JobStreamNeeds& needs, const std::string& job_name, int level) {
  return std::make_shared<ToolpathStream>(needs, job_name, level);
}

std::shared_ptr<PullStream<v1::StreamJobTraceResponse>> MakeTraceStream(
    const JobStreamNeeds& needs, const std::string& job_name) {
  return std::make_shared<TraceStream>(needs, job_name, "trace");
}

std::shared_ptr<PullStream<v1::StreamJobArtifactResponse>> MakeArtifactStream(
    const JobStreamNeeds& needs, const v1::StreamJobArtifactRequest& request) {
  return std::make_shared<ArtifactStream>(needs, request);
}

}  // namespace rmlcell::server
