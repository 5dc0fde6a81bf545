// What a Store has without writing it anew: calls that wait, and those that give their answer to a
// function, over those that it has.
#include <gmock/gmock.h>

#include "tests/server/forwarding_store.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

class StoreDefaults : public testing::Test {
 protected:
  template <class T>
  Done<T> Into(std::optional<Result<T>>& answer) {
    return [&answer](Result<T> given) { answer.emplace(std::move(given)); };
  }
  Lease Begin() {
    Must(store_.SubmitAndWait({.kind = "CHECK"}));
    return Must(store_.Acquire("w", {"CHECK"}, kLease, {}))->lease;
  }

  SqliteBed bed_;
  server::ForwardingStore store_{bed_.store()};
  std::optional<Result<JobRecord>> job_;
};

TEST_F(StoreDefaults, SubmittingAndAppendingMayWait) {
  const auto made = Must(store_.SubmitAndWait({.kind = "CHECK", .title = "t"}));
  EXPECT_EQ(made.job.title, "t");
  EXPECT_EQ(CodeOf(store_.SubmitAndWait({.kind = "CHECK", .attempts_max = 0})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Must(store_.Acquire("w", {"SIMULATE"}, kLease, {})), std::nullopt);
  const auto leased = Must(store_.Acquire("w", {"CHECK"}, kLease, {{.kind = "begun"}}));
  ASSERT_TRUE(leased);
  EXPECT_EQ(leased->job.id, made.job.id);
  EXPECT_EQ(leased->lease.worker, "w");
  EXPECT_EQ(leased->lease.until, bed_.clock().Now() + kLease);
  EXPECT_EQ(Must(store_.AppendAndWait(leased->lease, {{.kind = "e"}})), 2);
}

TEST_F(StoreDefaults, OrdersAndLossesAreAnswered) {
  Lease lease = Begin();
  store_.SendRequestCancel(lease.job, {}, Into(job_));
  EXPECT_TRUE(Must(*job_).cancel_requested);
  store_.SendRenew(lease, 2 * kLease, Into(job_));
  EXPECT_EQ(Must(*job_).state, JobState::kRunning);
  bed_.clock().Advance(kLease);
  EXPECT_TRUE(Must(store_.Expire(PolicyOfTests())).empty());
  store_.SendHandBack(lease, PolicyOfTests(), Into(job_));
  EXPECT_EQ(Must(*job_).state, JobState::kQueued);
  lease = Must(store_.Acquire("w", {"CHECK"}, kLease, {}))->lease;
  store_.SendAbandon(lease, PolicyOfTests(), Into(job_));
  EXPECT_EQ(Must(*job_).state, JobState::kCancelled);
  store_.SendAbandon(lease, PolicyOfTests(), Into(job_));
  EXPECT_EQ(CodeOf(*job_), ErrorCode::kCellLeaseLost);
}

TEST_F(StoreDefaults, AnEndMayBringTheNextJob) {
  const Lease first = Begin();
  const Lease second = Begin();
  const std::int64_t third = Must(store_.SubmitAndWait({.kind = "CHECK"})).job.id;
  const auto end = std::make_shared<const JobEnd>();
  std::optional<Result<FinishedJob>> ended;
  store_.SendFinish(first, end, {}, Into(ended));
  EXPECT_EQ(Must(*ended).job.state, JobState::kSucceeded);
  EXPECT_TRUE(Must(*ended).next.empty());
  store_.SendFinish(second, end, JobRequest{.worker = "w", .kinds = {"CHECK"}, .duration = kLease},
                    Into(ended));
  ASSERT_EQ(Must(*ended).next.size(), 1U);
  EXPECT_EQ(Must(*ended).next[0].job.id, third);
  store_.SendFinish(second, end, JobRequest{.worker = "w", .kinds = {"CHECK"}}, Into(ended));
  EXPECT_EQ(CodeOf(*ended), ErrorCode::kCellLeaseLost);
}

TEST(ProgramMemory, HasRoomUpToItsLimit) {
  const ProgramMemoryLimit limit{.bytes = 10, .full = ErrorCode::kCmosFull};
  EXPECT_TRUE(CheckRoom(std::nullopt, 0, 1'000));
  EXPECT_TRUE(CheckRoom(limit, 0, 10));
  EXPECT_TRUE(CheckRoom(limit, 12, 12));  // it was fuller than it may be, and is no more so
  EXPECT_TRUE(CheckRoom(limit, 12, 11));
  for (const std::int64_t before : {0, 10, 11}) {
    const Status refused = CheckRoom(limit, before, before + 11);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCmosFull);
    EXPECT_EQ(refused.error().detail, "the program memory has 10 bytes, and " +
                                          std::to_string(before + 11) + " would be in it");
  }
}

}  // namespace
}  // namespace rmlcell::storage
