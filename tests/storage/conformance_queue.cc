// Which jobs a worker is given by any Store.
#include <gtest/gtest.h>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

// store.h Acquire: the oldest of the kinds asked for, or nothing.
TEST_P(StoreConformance, OldestJobOfTheKindsIsLeased) {
  const std::int64_t run = Submit("RUN").id;
  const std::int64_t check = Submit("CHECK").id;
  const std::int64_t first = Submit("SIMULATE").id;
  const std::int64_t second = Submit("SIMULATE").id;
  const auto acquire = [&](const std::vector<std::string>& kinds) {
    const std::optional<LeasedJob> leased = Must(store().Acquire("w", kinds, kLease, {}));
    return leased ? leased->job.id : 0;
  };
  EXPECT_EQ(acquire({}), 0);
  EXPECT_EQ(acquire({"TURN"}), 0);
  EXPECT_EQ(acquire({"SIMULATE"}), first);
  EXPECT_EQ(acquire({"SIMULATE", "CHECK"}), check);
  EXPECT_EQ(acquire({"CHECK"}), 0);
  EXPECT_EQ(acquire({"SIMULATE", "RUN", "CHECK"}), run);
  EXPECT_EQ(acquire({"RUN", "SIMULATE"}), second);
  EXPECT_EQ(acquire({"RUN", "SIMULATE", "CHECK"}), 0);
}

// store.h JobRequest: a worker takes jobs of its pool and of no other one.
TEST_P(StoreConformance, JobsAreLeasedFromTheirPool) {
  const auto submit = [&](const std::string& pool, const std::string& kind) {
    return Must(store().SubmitAndWait({.kind = kind, .pool = pool})).job.id;
  };
  const auto take = [&](const std::string& pool, const std::vector<std::string>& kinds) {
    const auto leased = Must(
        store().AcquireJobs({.worker = "w", .kinds = kinds, .pools = {pool}, .duration = kLease}));
    return leased.empty() ? 0 : leased.front().job.id;
  };
  const std::int64_t paced = submit("paced", "SIMULATE");
  const std::int64_t check = submit("", "CHECK");
  const std::int64_t second = submit("paced", "SIMULATE");
  Reopen();
  EXPECT_EQ(Must(store().GetJob(paced)).pool, "paced");
  EXPECT_EQ(Must(store().GetJob(check)).pool, "");
  EXPECT_EQ(take("paced", {"CHECK"}), 0);
  EXPECT_EQ(take("other", {"SIMULATE", "CHECK"}), 0);
  EXPECT_EQ(take("", {"SIMULATE", "CHECK"}), check);
  EXPECT_EQ(take("", {"SIMULATE", "CHECK"}), 0);
  EXPECT_EQ(take("paced", {"SIMULATE", "CHECK"}), paced);
  EXPECT_EQ(take("paced", {"SIMULATE", "CHECK"}), second);
}

// The oldest of all pools that are asked for.
TEST_P(StoreConformance, AWorkerMayTakeJobsOfSeveralPools) {
  std::vector<std::int64_t> jobs;
  for (const char* pool : {"b", "a", "c", "b", "a"})
    jobs.push_back(Must(store().SubmitAndWait({.kind = "CHECK", .pool = pool})).job.id);
  const auto leased = Must(store().AcquireJobs(
      {.worker = "w", .kinds = {"CHECK"}, .pools = {"a", "b"}, .count = 9, .duration = kLease}));
  std::vector<std::int64_t> taken;
  for (const LeasedJob& one : leased) taken.push_back(one.job.id);
  EXPECT_EQ(taken, (std::vector<std::int64_t>{jobs[0], jobs[1], jobs[3], jobs[4]}));
  EXPECT_TRUE(Must(store().AcquireJobs({.worker = "w", .kinds = {"CHECK"}, .pools = {}})).empty());
}

// store.h JobRequest: as many as are asked for, oldest first, each with a lease and events of its
// own.
TEST_P(StoreConformance, SeveralJobsAreLeasedAtOnce) {
  std::vector<std::int64_t> jobs;
  for (int i = 0; i < 5; ++i) jobs.push_back(Submit(i % 2 == 0 ? "SIMULATE" : "CHECK").id);
  const auto take = [&](int count) {
    return Must(store().AcquireJobs({.worker = "w",
                                     .kinds = {"CHECK", "SIMULATE"},
                                     .count = count,
                                     .duration = kLease,
                                     .events = {{.kind = "running"}}}));
  };
  EXPECT_TRUE(take(0).empty());
  const std::vector<LeasedJob> three = take(3);
  ASSERT_EQ(three.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(three[i].job.id, jobs[i]);
    EXPECT_EQ(three[i].lease.job, jobs[i]);
    EXPECT_EQ(KindsOf(EventsOf(jobs[i])).back(), "running");
    EXPECT_TRUE(i == 0 || three[i].lease.fence > three[i - 1].lease.fence);
  }
  EXPECT_EQ(Must(store().CountJobs()).running, 3);
  ASSERT_EQ(take(9).size(), 2U);  // there are no more
  EXPECT_TRUE(take(1).empty());
}

}  // namespace
}  // namespace rmlcell::storage
