#include "server/jobs/told_jobs.h"

#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Counts how often jobs are read.
class CountedReads final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    ++reads;
    if (meanwhile) std::exchange(meanwhile, {})();
    auto job = store_.GetJob(id);
    if (afterwards) std::exchange(afterwards, {})();
    return job;
  }
  int reads = 0;
  std::function<void()> meanwhile;   // once, before the job is read
  std::function<void()> afterwards;  // once, behind that
};

class ToldJobsTest : public testing::Test {
 protected:
  ServerBed bed;
  CountedReads store{bed.store()};
  Config config;
  JobBook book{store, config};
};

// performance.md A1: a job that runs is told from memory, as long as nothing in it changes; what is
// told is never older than what was told to be done.
TEST_F(ToldJobsTest, AJobThatRunsIsReadOnceForEachChange) {
  const std::string name = JobName(bed.SubmitCheck());
  const storage::Lease lease = bed.Lease();
  EXPECT_EQ(book.GetAtOnce(name), nullptr);
  EXPECT_EQ(Must(book.Get(name)).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(Must(book.Get(name)).state(), v1::Job::STATE_RUNNING);
  ASSERT_NE(book.GetAtOnce(name), nullptr);
  EXPECT_EQ(*book.GetAtOnce(name), Must(book.Get(name)).SerializeAsString());
  EXPECT_EQ(store.reads, 1);
  bed.Append(lease, 1);
  EXPECT_EQ(book.GetAtOnce(name), nullptr);
  EXPECT_EQ(Must(book.Get(name)).last_sequence(),
            Must(bed.store().GetJob(lease.job)).last_sequence);
  EXPECT_EQ(store.reads, 2);
  Must(bed.store().Finish(lease, {.outcome = {.state = storage::JobState::kSucceeded},
                                  .artifacts = {{.name = "report", .bytes = "r"}}}));
  EXPECT_EQ(book.GetAtOnce(name), nullptr);
  EXPECT_EQ(Must(book.Get(name)).artifacts_size(), 2);  // beside the program
  v1::Job told;
  ASSERT_TRUE(told.ParseFromString(*book.GetAtOnce(name)));
  EXPECT_EQ(told.state(), v1::Job::STATE_SUCCEEDED);
  Must(bed.store().DeleteJob(lease.job, {}));
  EXPECT_EQ(book.GetAtOnce(name), nullptr);
  EXPECT_EQ(CodeOf(book.Get(name)), ErrorCode::kCellNotFound);
}

// What a job waits for, and how many are before it, changes without it.
TEST_F(ToldJobsTest, AJobThatWaitsIsReadAnew) {
  const std::int64_t first = bed.SubmitCheck();
  const std::string second = JobName(bed.SubmitCheck());
  EXPECT_EQ(Must(book.Get(second)).position_in_queue(), 1);
  EXPECT_EQ(book.GetAtOnce(second), nullptr);
  EXPECT_EQ(bed.Lease().job, first);
  EXPECT_EQ(Must(book.Get(second)).position_in_queue(), 0);
  EXPECT_EQ(store.reads, 2);
}

// A change that falls beside the reading, before it or behind it: the next answer has it.
TEST_F(ToldJobsTest, AChangeBesideTheReadingIsNotMissed) {
  const std::string name = JobName(bed.SubmitCheck());
  const storage::Lease lease = bed.Lease();
  for (std::function<void()> CountedReads::*moment :
       {&CountedReads::meanwhile, &CountedReads::afterwards}) {
    bed.Append(lease, 1);  // so that it is read
    store.*moment = [&] { bed.Append(lease, 1); };
    Must(book.Get(name));
    EXPECT_EQ(book.GetAtOnce(name), nullptr);
    EXPECT_EQ(Must(book.Get(name)).last_sequence(),
              Must(bed.store().GetJob(lease.job)).last_sequence);
    EXPECT_NE(book.GetAtOnce(name), nullptr);
  }
}

TEST(ToldJobs, OnlySoMuchIsKept) {
  ToldJobs told;
  v1::Job job;
  job.set_title(std::string(ToldJobs::kBytesMax - 10, 't'));
  told.Keep(1, 5, job);
  EXPECT_NE(told.Find(1, 5), nullptr);
  EXPECT_EQ(told.Find(1, 6), nullptr);
  EXPECT_EQ(told.Find(2, 5), nullptr);
  const auto other = static_cast<std::int64_t>(1 + ToldJobs::kJobsMax);
  EXPECT_EQ(told.Find(other, 5), nullptr);
  told.Keep(other, 5, {});
  EXPECT_EQ(told.Find(1, 5), nullptr);  // they share a place
  EXPECT_NE(told.Find(other, 5), nullptr);
  job.set_title(std::string(ToldJobs::kBytesMax + 1, 't'));
  told.Keep(3, 5, job);
  EXPECT_EQ(told.Find(3, 5), nullptr);
  while (job.ByteSizeLong() > ToldJobs::kBytesMax) job.mutable_title()->pop_back();
  ASSERT_EQ(job.ByteSizeLong(), ToldJobs::kBytesMax);
  told.Keep(3, 5, job);
  EXPECT_NE(told.Find(3, 5), nullptr);
}

}  // namespace
}  // namespace rmlcell::server
