// Two servers over one database (StoreBed::other): what one writes the other has, no job goes to
// both, hints and orders come over.
#include <gmock/gmock.h>

#include <set>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using std::chrono::hours;

std::optional<std::int64_t> Next(Store& store, const std::string& worker,
                                 const std::string& server) {
  const std::vector<LeasedJob> leased = Must(store.AcquireJobs(
      {.worker = worker, .server = server, .kinds = {"SIMULATE"}, .duration = hours(1)}));
  if (leased.empty()) return std::nullopt;
  return leased.front().job.id;
}

TEST_P(StoreConformance, WhatOneServerWritesTheOtherHas) {
  PutMachine("optimo-1");
  EXPECT_EQ(Must(other().GetMachine("optimo-1")).id, "optimo-1");
  const JobRecord job = Submit();
  EXPECT_EQ(Must(other().GetJob(job.id)).state, JobState::kQueued);
  Must(other().HoldBack(job.id, {}));
  EXPECT_TRUE(Must(store().GetJob(job.id)).held);
}

TEST_P(StoreConformance, NoJobGoesToTwoServers) {
  std::set<std::int64_t> submitted;
  for (int i = 0; i < 12; ++i) submitted.insert(Submit().id);
  std::vector<std::int64_t> given;
  for (int i = 0; i < 12; ++i) {
    const auto job = i % 3 == 0 ? Next(other(), "b/1", "b") : Next(store(), "a/1", "a");
    ASSERT_TRUE(job);
    given.push_back(*job);
  }
  EXPECT_FALSE(Next(other(), "b/1", "b"));
  EXPECT_FALSE(Next(store(), "a/1", "a"));
  EXPECT_EQ(std::set<std::int64_t>(given.begin(), given.end()), submitted);
  EXPECT_EQ(given.size(), submitted.size());
}

// A lease that one server let run out is lost, whichever server took it away.
TEST_P(StoreConformance, ALeaseIsOneForBothServers) {
  Submit();
  const LeasedJob leased = Acquire("w1");
  clock().Advance(kLease + std::chrono::milliseconds(1));
  EXPECT_EQ(Must(other().Expire(PolicyOfTests())).size(), 1U);
  EXPECT_EQ(CodeOf(store().Finish(leased.lease, {})), ErrorCode::kCellLeaseLost);
}

// Within a second, or the watcher would not know.
TEST_P(StoreConformance, AHintComesOver) {
  std::atomic<int> hints{0};
  const auto watch = other().Watch([&] { ++hints; });
  Submit();
  EXPECT_TRUE(Eventually([&] { return hints > 0; }));
}

TEST_P(StoreConformance, AnOrderReachesTheServerThatHasTheJob) {
  const JobRecord job = Submit();
  ASSERT_EQ(Next(store(), "a/1", "a"), job.id);
  EXPECT_TRUE(other().PutOrder(job.id, "b", "stop"));
  EXPECT_TRUE(Must(other().TakeOrders("b")).empty());
  const std::vector<TakenOrder> taken = Must(store().TakeOrders("a"));
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken.front().payload, "stop");
  EXPECT_TRUE(Must(store().TakeOrders("a")).empty());
}

}  // namespace
}  // namespace rmlcell::storage
