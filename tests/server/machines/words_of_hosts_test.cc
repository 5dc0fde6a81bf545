// What an entry of a host becomes in the logs of its machine and of its job (live.md 3.25).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/names.h"
#include "server/machines/host_entries.h"
#include "server/machines/host_words.h"
#include "server/records/job_messages.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

v1::JournalEntry EntryAt(std::int64_t sequence) {
  v1::JournalEntry entry;
  entry.set_sequence(sequence);
  entry.set_fence(3);
  entry.set_virtual_time_ns(500);
  return entry;
}

// Each kind stays what it is, with its fence and its time.
TEST(WordsOfHosts, EachKindStaysWhatItIs) {
  v1::JournalEntry entry = EntryAt(1);
  entry.mutable_applied()->set_caller("anna");
  auto event = EventOf(entry);
  ASSERT_TRUE(event && event->has_input_applied());
  EXPECT_EQ(event->input_applied().caller(), "anna");
  EXPECT_EQ(event->fence(), 3);
  EXPECT_EQ(event->virtual_time_ns(), 500);
  EXPECT_EQ(ToRecord(*event).caller, "anna");
  entry = EntryAt(2);
  entry.mutable_event()->mutable_message()->set_text("hello");
  event = EventOf(entry);
  ASSERT_TRUE(event && event->has_run());
  EXPECT_EQ(event->run().message().text(), "hello");
  entry = EntryAt(3);
  entry.mutable_run_begun()->set_run(7);
  event = EventOf(entry);
  ASSERT_TRUE(event && event->has_run_begun());
  EXPECT_EQ(event->run_number(), 7);
  entry = EntryAt(4);
  entry.mutable_run_over()->set_run(8);
  event = EventOf(entry);
  ASSERT_TRUE(event && event->has_run_over());
  EXPECT_EQ(event->run_number(), 8);
  entry = EntryAt(5);
  entry.mutable_clock_slipped();
  event = EventOf(entry);
  ASSERT_TRUE(event && event->has_clock_slipped());
  EXPECT_EQ(event->fence(), 3);
  EXPECT_FALSE(EventOf(EntryAt(6)));
}

// Fails once.
class RefusingOnce final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Status AppendMachine(const storage::MachineLease& lease,
                       const storage::MachineWrite& write) override {
    if (!std::exchange(refuses, false)) return ForwardingStore::AppendMachine(lease, write);
    return Error{ErrorCode::kCellStoreFailed, "the disk is full", {}};
  }
  bool refuses = true;
};

// Nothing is stored behind what was not.
TEST(WordsOfHosts, NothingIsStoredBehindAGap) {
  ServerBed bed;
  RefusingOnce store(bed.store());
  const storage::MachineLease lease = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "hall/1", .server = "s", .duration = std::chrono::hours(1)}));
  std::vector<v1::JournalEntry> entries = {EntryAt(1), EntryAt(2)};
  for (v1::JournalEntry& entry : entries) {
    entry.set_fence(lease.fence);
    entry.mutable_run_begun()->set_run(entry.sequence());
  }
  entries[1].set_job("jobs/99");  // of another run
  const std::int64_t before = Must(bed.store().LastPosition());
  const StoredEntries stored = StoreEntries(store, lease, entries);
  ASSERT_FALSE(stored.how);
  EXPECT_EQ(stored.how.error().code, ErrorCode::kCellStoreFailed);
  EXPECT_EQ(stored.count, 0U);
  EXPECT_EQ(Must(bed.store().LastPosition()), before);
  const StoredEntries again = StoreEntries(store, lease, entries);
  EXPECT_TRUE(again.how);
  EXPECT_EQ(again.count, 2U);
}

// What a run under way tells stands in the log of its job at once, and not with its end alone.
TEST(WordsOfHosts, ARunUnderWayTellsItsJob) {
  ServerBed bed;
  const storage::MachineLease lease = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "hall/1", .server = "s", .duration = std::chrono::hours(1)}));
  v1::Job run;
  run.set_kind(v1::JOB_KIND_RUN);
  const std::int64_t job = Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                                           .kind = "RUN",
                                                           .specification = run.SerializeAsString(),
                                                           .attempts_max = 1}))
                               .job.id;
  Must(bed.store().AcquireJobs(
      {.worker = "hall/1", .kinds = {"RUN"}, .duration = std::chrono::hours(1)}));
  v1::JournalEntry entry = EntryAt(1);
  entry.set_fence(lease.fence);
  entry.set_job(JobName(job));
  entry.set_run_time_ns(41);
  entry.mutable_event()->mutable_message()->set_text("hello");
  v1::JournalEntry mark = EntryAt(2);
  mark.set_fence(lease.fence);
  mark.set_job(JobName(job));
  mark.mutable_mark()->set_state("s");
  const std::vector<v1::JournalEntry> entries = {entry, mark};
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  ASSERT_TRUE(stored.how) << stored.how.error().detail;
  const auto told = Must(bed.store().JobEvents(job, 0, 100));
  ASSERT_FALSE(told.empty());
  const v1::JobEvent newest = ToProto(told.back());
  EXPECT_EQ(newest.message().text(), "hello");
  EXPECT_EQ(newest.virtual_time_ns(), 41);
}

}  // namespace
}  // namespace rmlcell::server
