#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "rmlcell/v1/cell.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

// What a job does not change, and a subscription may ask for.
struct JobFacts {
  std::string machine{};
  std::string family{};
  std::string kind{};
  std::string caller{};
  std::vector<std::string> labels{};
};

// The same of every job that is asked for, the newest ones in memory. Thread-safe.
class JobFactsBook {
 public:
  static constexpr std::size_t kKept = 10'000;

  explicit JobFactsBook(storage::Store& store) : store_(store) {}
  // Null: there is no such job any more.
  std::shared_ptr<const JobFacts> Of(std::int64_t job);

 private:
  storage::Store& store_;
  std::mutex mutex_;
  std::map<std::int64_t, std::shared_ptr<const JobFacts>> kept_;
};

// One subscription of a watch, checked, and what it wants of all that happens.
class CellSubscription {
 public:
  static constexpr std::size_t kIdMax = 64;

  // Errors: CellInvalidArgument; CellBadFilter; CellUnimplemented for values and the audit.
  static Result<CellSubscription> Make(const v1::Subscription& wanted);

  const std::string& id() const { return wanted_.id(); }
  const v1::Subscription& wanted() const { return wanted_; }
  // Of a subscription of jobs: what is to be listed, without a limit.
  const storage::JobQuery& query() const { return query_; }
  // Least time between two messages of what stands for now; zero: as often as the feed has news.
  std::chrono::microseconds interval() const { return interval_; }

  // Whether it asks what a job is.
  bool filtered() const { return filtered_; }

  bool WantsEvent(const storage::EventRecord& event, JobFactsBook& facts) const;
  bool WantsLatest(std::string_view resource, JobFactsBook& facts) const;

 private:
  bool WantsJob(std::int64_t job, JobFactsBook& facts) const;
  bool WantsMachine(std::string_view resource) const;

  v1::Subscription wanted_;
  std::set<std::string, std::less<>> names_;  // empty: all
  storage::JobQuery query_;
  bool filtered_ = false;
  std::chrono::microseconds interval_{0};
};

// Those of one watch: every id once, at most kSubscriptionsMax. Error: as of each;
// CellInvalidArgument.
inline constexpr std::size_t kSubscriptionsMax = 100;
Result<std::vector<CellSubscription>> MakeSubscriptions(
    const google::protobuf::RepeatedPtrField<v1::Subscription>& wanted);

}  // namespace rmlcell::server
