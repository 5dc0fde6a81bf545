// Jobs that end while their machine changes hands, and what was taught at machines that nobody
// knows.
#include <gtest/gtest.h>

#include "server/base/names.h"
#include "server/machines/host_entries.h"
#include "server/machines/teach_book.h"
#include "server/records/job_messages.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;

// One in which a lease is lost between a look at it and the next call.
class LosingStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::AttemptRecord>> ListAttempts(std::int64_t job) override {
    if (attempts_fail) return Error{*attempts_fail, "attempts", {}};
    return store_.ListAttempts(job);
  }
  Result<storage::JobRecord> Finish(const storage::Lease&, const storage::JobEnd&) override {
    ++calls;
    return Error{code, "finish", {}};
  }
  Result<storage::JobRecord> HandBack(const storage::Lease&, const storage::LossPolicy&) override {
    ++calls;
    return Error{code, "hand back", {}};
  }
  std::optional<ErrorCode> attempts_fail{};
  ErrorCode code = ErrorCode::kCellLeaseLost;
  int calls = 0;
};

class JobsOfLostMachines : public testing::Test {
 protected:
  // A RUN of this machine that its host was given.
  void Given(const std::string& machine, const std::string& host = "hall/1") {
    Must(bed.store().SubmitAndWait({.machine = machine, .kind = "RUN", .attempts_max = 1}));
    ASSERT_EQ(Must(bed.store().AcquireJobs({.worker = host,
                                            .kinds = {"RUN"},
                                            .run_machines = {machine},
                                            .duration = std::chrono::hours(1)}))
                  .size(),
              1U);
  }
  static std::optional<ErrorCode> Code(const Status& status) {
    return status ? std::nullopt : std::optional(status.error().code);
  }

  ServerBed bed;
  LosingStore store{bed.store()};
};

// Whoever ended it first has told how: nothing is left to do.
TEST_F(JobsOfLostMachines, OneThatHasEndedMeanwhileIsNoError) {
  Given("mill-1");
  EXPECT_EQ(Code(EndWithoutHost(store, "mill-1")), std::nullopt);
  EXPECT_EQ(store.calls, 1);
  EXPECT_EQ(Code(GiveBackUnbegun(store, "mill-1", "hall/2", "")), std::nullopt);
  EXPECT_EQ(store.calls, 2);
}

TEST_F(JobsOfLostMachines, OtherTroubleIsHandedOn) {
  Given("mill-1");
  for (const ErrorCode code : {ErrorCode::kCellNotFound, ErrorCode::kCellStoreFailed}) {
    store.code = code;
    EXPECT_EQ(Code(EndWithoutHost(store, "mill-1")), code);
    EXPECT_EQ(Code(GiveBackUnbegun(store, "mill-1", "hall/2", "")), code);
  }
}

// A job that was removed has nobody who could have it.
TEST_F(JobsOfLostMachines, OneThatIsNotKeptIsOver) {
  Given("mill-1");
  store.attempts_fail = ErrorCode::kCellNotFound;
  EXPECT_EQ(Code(EndWithoutHost(store, "mill-1")), std::nullopt);
  EXPECT_EQ(Code(GiveBackUnbegun(store, "mill-1", "hall/2", "")), std::nullopt);
  EXPECT_EQ(store.calls, 0);
  store.attempts_fail = ErrorCode::kCellStoreFailed;
  EXPECT_EQ(Code(EndWithoutHost(store, "mill-1")), ErrorCode::kCellStoreFailed);
  EXPECT_EQ(Code(GiveBackUnbegun(store, "mill-1", "hall/2", "")), ErrorCode::kCellStoreFailed);
}

// What the host that comes was given itself stays with it.
TEST_F(JobsOfLostMachines, OneOfTheHostThatComesIsNotGivenBack) {
  Given("mill-1");
  EXPECT_EQ(Code(GiveBackUnbegun(store, "mill-1", "hall/1", "")), std::nullopt);
  EXPECT_EQ(store.calls, 0);
}

TEST(OddTeachRecords, AnEntryThatCannotBeReadIsADamageOfTheStore) {
  ServerBed bed;
  Must(bed.store().AddTeachRecord({.machine = "optimo-1", .program = 12, .entry = "\xFF"}));
  TeachBook book{bed.store()};
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellStoreCorrupt);
}

}  // namespace
}  // namespace rmlcell::server
