#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/followed.h"
#include "server/jobs/job_book.h"
#include "server/services/job_streams.h"

namespace rmlcell::server {

// A job whose worker is followed while it makes something: looked for until the job begins.
template <class Running>
class FollowedJob {
 public:
  using Finder = std::function<std::shared_ptr<Running>(std::int64_t job)>;

  enum class State {
    kOver,   // what it left is in the store
    kWaits,  // its events wake; look again after kBegunLookedForAfter, too
    kRuns,
  };
  static constexpr std::chrono::milliseconds kBegunLookedForAfter{500};

  FollowedJob(EventFeed& feed, JobBook& book, Finder find)
      : feed_(feed), book_(book), find_(std::move(find)) {}

  // Until it is not kWaits. Errors: CellNotFound, also of a job that `makes` nothing while it runs:
  // what is said of it then.
  Result<State> Look(const std::string& name, std::string_view makes,
                     const std::function<bool(const v1::Job&)>& makes_it,
                     const std::function<void()>& wake) {
    Result<v1::Job> job = book_.Get(name);
    if (!job) return job.error();
    id_ = *ParseJobName(name);
    // One that ends now is over at the next look at it.
    if (job->has_end_time()) return State::kOver;
    if (!makes_it(*job))
      return Error{ErrorCode::kCellNotFound, JobName(id_) + " makes no " + std::string(makes), {}};
    if (!begun_) begun_ = feed_.Subscribe(JobName(id_), wake);
    running_ = find_(id_);
    if (running_ == nullptr) return State::kWaits;
    begun_.reset();
    follower_ = running_->Follow(wake);
    job_ = *std::move(job);
    return State::kRuns;
  }

  Error BeginsAnew() const {
    return {ErrorCode::kCellUnavailable,
            "the attempt of " + JobName(id_) + " was lost: follow the job again",
            {}};
  }

  // Of one that runs.
  const v1::Job& job() const { return job_; }
  Running* running() const { return running_.get(); }  // null: not found yet

  // Nothing wakes any more.
  void Leave() {
    begun_.reset();
    follower_.reset();
  }

 private:
  EventFeed& feed_;
  JobBook& book_;
  Finder find_;
  std::int64_t id_ = 0;
  v1::Job job_;
  std::shared_ptr<Running> running_;
  std::unique_ptr<EventFeed::Subscription> begun_;
  std::unique_ptr<Followed::Follower> follower_;
};

}  // namespace rmlcell::server
