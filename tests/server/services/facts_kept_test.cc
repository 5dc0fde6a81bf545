// Of how many jobs the facts stay in memory.
#include <gtest/gtest.h>

#include "server/services/subscriptions.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// One with every job that is asked for.
class EveryJobStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    ++asked;
    return storage::JobRecord{.id = id, .machine = "m" + std::to_string(id)};
  }
  int asked = 0;
};

// Ten thousand, and the oldest of more is asked for anew.
TEST(FactsOfJobs, TheNewestTenThousandAreKept) {
  ServerBed bed;
  EveryJobStore store{bed.store()};
  JobFactsBook facts{store};
  const auto asks = [&](std::int64_t job) {
    const int before = store.asked;
    EXPECT_EQ(facts.Of(job)->machine, "m" + std::to_string(job));
    return store.asked - before;
  };
  for (std::int64_t job = 1; job <= 10'000; ++job) EXPECT_EQ(asks(job), 1);
  EXPECT_EQ(asks(1), 0);
  EXPECT_EQ(asks(10'001), 1);
  EXPECT_EQ(asks(2), 0);
  EXPECT_EQ(asks(1), 1);
}

}  // namespace
}  // namespace rmlcell::server
