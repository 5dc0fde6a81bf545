#include <optional>

#include "engine/core/units.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"
#include "proto/bridge/framing.h"
#include "server/jobs/running_toolpath.h"
#include "server/records/toolpath_levels.h"
#include "server/services/followed_job.h"

namespace rmlcell::server {
namespace {

// As the recorder of the job takes it.
double ToleranceOf(const v1::Job& job) {
  const double asked = job.simulation().toolpath_tolerance_mm();
  const double used = asked > 0.0 ? asked : simulation::ToolpathOptions().tolerance_mm;
  return simulation::ToolpathTolerance_mm(used);
}

// The toolpath of a job that is over: a header, then a block a message. One that is followed before
// its job is over comes as its worker makes it, and the rest of it, with the header, from the
// store.
class ToolpathStream final : public PullStream<v1::StreamJobToolpathResponse> {
 public:
  ToolpathStream(const JobStreamNeeds& needs, const v1::StreamJobToolpathRequest& request)
      : PullStream(needs.executor, needs.open),
        needs_(needs),
        request_(request),
        followed_(needs.feed, needs.book, needs.running_toolpath) {}

 private:
  using Job = FollowedJob<RunningToolpath>;

  Next Make(v1::StreamJobToolpathResponse& message, grpc::Status& status) override {
    const Result<Next> next = MakeNext(message);
    if (next) return *next;
    status = ToGrpcStatus(next.error());
    return Next::kEnd;
  }

  Result<Next> MakeNext(v1::StreamJobToolpathResponse& message) {
    if (!stored_) {
      if (const Status asked = Check(); !asked) return asked.error();
      if (request_.follow()) {
        const Result<std::optional<Next>> next = FollowOn(message);
        if (!next) return next.error();
        if (*next) return **next;
      }
      if (const Status opened = OpenStored(); !opened) return opened.error();
      stored_ = true;
      // Who follows has a header, and gets the one that tells of all of it at the end.
      if (followed_.running() == nullptr) return SendHeader(message);
    }
    for (;;) {
      if (const auto frame = bridge::TakeFrame(rest_)) {
        message.set_block(std::string(*frame));
        return Next::kMessage;
      }
      const Result<bool> more = ReadMore();
      if (!more) return more.error();
      if (!*more) break;
    }
    if (followed_.running() == nullptr || header_sent_) return Next::kEnd;
    return SendHeader(message);
  }

  Status Check() const {
    if (const Status level = CheckToolpathLevel(request_.level()); !level) return level.error();
    if (!request_.follow() || (request_.level() == 0 && !request_.with_levels())) return {};
    return InvalidArgument("follow goes with level 0, and without with_levels");
  }

  // Nothing: the job is over, and what is left of its toolpath is in the store.
  Result<std::optional<Next>> FollowOn(v1::StreamJobToolpathResponse& message) {
    if (followed_.running() == nullptr) return BeginToFollow(message);
    RunningToolpath::Part part;
    for (;;) {
      const std::size_t before = rest_.size();
      if (const auto frame = bridge::TakeFrame(rest_)) {
        message.set_block(std::string(*frame));
        taken_ += static_cast<std::int64_t>(before - rest_.size());
        return {Next::kMessage};
      }
      part = followed_.running()->Look(taken_ + static_cast<std::int64_t>(before), open_seen_);
      if (part.frames.empty()) break;
      Append(part.frames);
    }
    if (part.open_seen != open_seen_) {
      open_seen_ = part.open_seen;
      if (!part.open_block.empty()) {
        message.set_open_block(std::move(part.open_block));
        return {Next::kMessage};
      }
    }
    if (!part.ended) return {Next::kNothing};
    if (part.stored) {
      part_.clear();  // what is left of it is taken from there
      rest_ = {};
      return {std::nullopt};
    }
    return followed_.BeginsAnew();
  }

  Result<std::optional<Next>> BeginToFollow(v1::StreamJobToolpathResponse& message) {
    const Result<Job::State> state = followed_.Look(
        request_.name(), "toolpath",
        [](const v1::Job& job) { return job.kind() == v1::JOB_KIND_SIMULATE; }, [this] { Wake(); });
    if (!state) return state.error();
    if (*state == Job::State::kOver) return {std::nullopt};
    if (*state == Job::State::kWaits) {
      WakeAt(std::chrono::steady_clock::now() + Job::kBegunLookedForAfter);
      return {Next::kNothing};
    }
    v1::ToolpathHeader& header = *message.mutable_header();
    SetLevel(ToleranceOf(followed_.job()), 0, 0, header);
    return {Next::kMessage};
  }

  Status OpenStored() {
    const Result<std::int64_t> job = ParseJobName(request_.name());
    if (!job) return job.error();
    const Result<v1::Job> made_by = needs_.book.Get(request_.name());
    if (!made_by) return made_by.error();
    const double stored_mm = ToleranceOf(*made_by);
    std::size_t bytes = 0;
    if (request_.level() == 0 && !request_.with_levels()) {
      auto opened = needs_.book.OpenArtifact(*job, "toolpath");
      if (!opened) return opened.error();
      reader_ = *std::move(opened);
      bytes = reader_->size();
    } else {
      Result<std::string> whole = needs_.book.ReadArtifact(*job, "toolpath");
      if (!whole) return whole.error();
      if (request_.with_levels()) AddLevels(*whole, stored_mm, header_);
      Append(request_.level() == 0 ? *whole : ToolpathAtLevel(*whole, stored_mm, request_.level()));
      bytes = rest_.size();
    }
    SetLevel(stored_mm, request_.level(), bytes, header_);
    v1::RunReport report;
    if (const auto told = needs_.book.ReadArtifact(*job, "report")) report.ParseFromString(*told);
    header_.set_points(report.toolpath().records());
    header_.set_complete(report.toolpath().complete());
    if (report.has_tip_box()) *header_.mutable_tip_box() = report.tip_box();
    header_.set_duration_ns(FromSeconds(report.total().times().cycle_s()).count());
    return {};
  }

  // More of what is stored, behind what has gone out already. False: that was all.
  Result<bool> ReadMore() {
    while (reader_ != nullptr) {
      const Result<std::string> chunk = reader_->Next();
      if (!chunk) return chunk.error();
      if (chunk->empty()) break;
      const auto known = std::min(chunk->size(), static_cast<std::size_t>(taken_));
      taken_ -= static_cast<std::int64_t>(known);
      Append(std::string_view(*chunk).substr(known));
      if (known < chunk->size()) return true;
    }
    reader_.reset();
    return false;
  }

  void Append(std::string_view more) {
    part_ = std::string(rest_) + std::string(more);
    rest_ = part_;
  }

  Result<Next> SendHeader(v1::StreamJobToolpathResponse& message) {
    header_sent_ = true;
    *message.mutable_header() = std::move(header_);
    return Next::kMessage;
  }

  void Closed() override { followed_.Leave(); }

  const JobStreamNeeds needs_;
  const v1::StreamJobToolpathRequest request_;
  std::string part_;                             // of all frames
  std::string_view rest_;                        // of it, that has not gone out
  bool stored_ = false;                          // they come from the store: the job is over
  std::unique_ptr<storage::BlobReader> reader_;  // where they do not lie in `part_` as a whole
  v1::ToolpathHeader header_;                    // until it has gone out
  bool header_sent_ = false;

  // Before the job is over.
  Job followed_;
  std::int64_t taken_ = 0;  // bytes of frames that have gone out
  std::uint64_t open_seen_ = 0;
};

}  // namespace

std::shared_ptr<PullStream<v1::StreamJobToolpathResponse>> MakeToolpathStream(
    const JobStreamNeeds& needs, const v1::StreamJobToolpathRequest& request) {
  return std::make_shared<ToolpathStream>(needs, request);
}

}  // namespace rmlcell::server
