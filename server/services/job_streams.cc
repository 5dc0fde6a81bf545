#include "server/services/job_streams.h"

#include <deque>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "server/services/frames_stream.h"

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
    if (!read_ahead_.empty()) return MakeEvent(message);
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

  std::optional<Next> MakeAtOnce(v1::WatchJobResponse& message) override {
    if (read_ahead_.empty()) return std::nullopt;
    message.set_instance_id(needs_.instance_id);
    return MakeEvent(message);
  }

  Next MakeEvent(v1::WatchJobResponse& message) {
    const storage::EventRecord event = std::move(read_ahead_.front());
    read_ahead_.pop_front();
    cursor_ = event.sequence;
    message.set_sequence(event.sequence);
    message.set_log_id(log_id_);
    *message.mutable_event() = ToProto(event);
    ended_ = message.event().has_ended();
    return Next::kMessage;
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
    const Status of_log = request_.has_after_sequence()
                              ? needs_.book.CheckLog(job_, cursor_, request_.log_id())
                              : Status();
    if (!of_log) {
      status = ToGrpcStatus(of_log.error());
      return Next::kEnd;
    }
    log_id_ = needs_.book.LogId();
    message.set_log_id(log_id_);
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
    message.set_log_id(begun_ ? log_id_ : request_.log_id());
    *message.mutable_reconnect() = ServerStopped();
    return true;
  }

  void Closed() override { subscription_.reset(); }

  JobStreamNeeds needs_;
  v1::WatchJobRequest request_;
  std::int64_t cursor_ = 0;
  std::string log_id_;
  std::int64_t job_ = 0;
  std::int64_t final_sequence_ = -1;
  std::uint64_t progress_seen_ = 0;
  bool begun_ = false;
  bool ended_ = false;
  std::deque<storage::EventRecord> read_ahead_;
  std::unique_ptr<EventFeed::Subscription> subscription_;
};

// A product of a job that is a series of frames.
template <class Response>
class JobFrames : public FramesStream<Response> {
 public:
  JobFrames(const JobStreamNeeds& needs, std::string job_name, std::string artifact)
      : FramesStream<Response>(needs.executor, needs.open),
        book_(needs.book),
        job_name_(std::move(job_name)),
        artifact_(std::move(artifact)) {}

 protected:
  Result<std::string> Read() override {
    const Result<std::int64_t> job = ParseJobName(job_name_);
    return job ? book_.ReadArtifact(*job, artifact_) : Result<std::string>(job.error());
  }

 private:
  JobBook& book_;
  std::string job_name_;
  std::string artifact_;
};

class TraceStream final : public JobFrames<v1::StreamJobTraceResponse> {
  using JobFrames::JobFrames;
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
  Next Make(v1::StreamJobArtifactResponse& message, grpc::Status& status) override {
    if (reader_ == nullptr) {
      Result<std::unique_ptr<storage::BlobReader>> opened = Open();
      if (!opened) {
        status = ToGrpcStatus(opened.error());
        return Next::kEnd;
      }
      reader_ = *std::move(opened);
    }
    Result<std::string> chunk = reader_->Next();
    if (!chunk) status = ToGrpcStatus(chunk.error());
    if (!chunk || chunk->empty()) return Next::kEnd;
    message.set_chunk(*std::move(chunk));
    return Next::kMessage;
  }

  Result<std::unique_ptr<storage::BlobReader>> Open() {
    const Result<std::int64_t> job = ParseJobName(request_.name());
    if (!job) return job.error();
    if (request_.artifact().empty()) return InvalidArgument("artifact is missing: its name");
    return book_.OpenArtifact(*job, request_.artifact());
  }

  JobBook& book_;
  v1::StreamJobArtifactRequest request_;
  std::unique_ptr<storage::BlobReader> reader_;
};

}  // namespace

std::shared_ptr<PullStream<v1::WatchJobResponse>> MakeJobWatch(const JobStreamNeeds& needs,
                                                               const v1::WatchJobRequest& request) {
  return std::make_shared<JobWatch>(needs, request);
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
