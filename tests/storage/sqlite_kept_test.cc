// Records of what has no server yet, or is gone when a server stands still: hosts of machines and
// where these stand, contents that nobody names, orders. The store of tests/conformance/held_still
// that a server wrote has none of them (decision 0028), this one has them all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::ElementsAre;

const std::string kKept =
    std::string(RMLCELL_SOURCE_DIR) + "/tests/conformance/held_still/records.db.zst";
// Of "abc", as in RFC 6234.
constexpr const char* kAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

void Unpack(const std::string& path) {
  const std::string packed = ReadFile(kKept);
  std::string bytes(ZSTD_getFrameContentSize(packed.data(), packed.size()), '\0');
  ASSERT_EQ(ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()),
            bytes.size());
  WriteFile(path, bytes);
}

void Fill(Store& store) {
  for (const char* id : {"a", "b"})
    Must(store.PutMachine({.id = id, .family = "optimo"}, kAnyRevision));
  const MachineLease a = Must(store.TakeMachine(
      {.machine = "a", .host = "host-1", .server = "server-1", .duration = seconds(60)}));
  Must(store.RenewMachine(a, "server-2"));
  Must(store.AppendMachine(
      a, {.events = {{.kind = "moved", .payload = "to 7", .caller = "anna"}},
          .mark = MachineMark{.sequence = 5, .state = "axes", .note = "journal", .clean = false}}));
  Must(store.TakeMachine({.machine = "b",
                          .host = "host-2",
                          .server = "server-1",
                          .duration = hours(1),
                          .pinned = true}));
  const auto writer = Must(store.WriteBlob(kAbc, 3));
  Must(writer->Append("abc"));
  Must(writer->Finish(hours(24 * 365 * 100)));
  Must(store.SubmitAndWait({.kind = "SIMULATE",
                            .pool = "paced",
                            .specification = "spec",
                            .attachments = {{.name = "program", .bytes = "STOP\n"}}}));
  const auto leased = Must(store.AcquireJobs({.worker = "w",
                                              .server = "server-1",
                                              .kinds = {"SIMULATE"},
                                              .pools = {"paced"},
                                              .duration = hours(1)}));
  Must(store.PutOrder(leased.front().job.id, "server-2", "stop it"));
}

// RMLCELL_WRITE_KEPT makes it anew; only with a decision (0028).
TEST(SqliteKept, RecordsOfTheFirstContractAreRead) {
  TestDirectory directory;
  const std::string path = directory.File("cell.db");
  if (std::getenv("RMLCELL_WRITE_KEPT") != nullptr) {
    Fill(*Must(OpenSqliteStore({.path = path})));
    const std::string bytes = ReadFile(path);
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 19));
    WriteFile(kKept, packed);
    std::filesystem::remove(path);
  }
  Unpack(path);
  {
    const auto store = Must(OpenSqliteStore({.path = path}));
    const auto leases = Must(store->MachineLeases());
    ASSERT_EQ(leases.size(), 2U);
    EXPECT_EQ(leases[0].machine, "a");
    EXPECT_EQ(leases[0].host, "host-1");
    EXPECT_EQ(leases[0].server, "server-2");
    EXPECT_EQ(leases[0].renewals, 1);
    EXPECT_EQ(leases[0].duration, seconds(60));
    EXPECT_FALSE(leases[0].pinned);
    EXPECT_EQ(leases[1].host, "host-2");
    EXPECT_TRUE(leases[1].pinned);
    EXPECT_GT(leases[1].fence, leases[0].fence);
    const auto mark = Must(store->GetMachineMark("a"));
    ASSERT_TRUE(mark);
    EXPECT_EQ(mark->fence, leases[0].fence);
    EXPECT_EQ(mark->sequence, 5);
    EXPECT_EQ(mark->state, "axes");
    EXPECT_EQ(mark->note, "journal");
    EXPECT_FALSE(mark->clean);
    EXPECT_FALSE(Must(store->GetMachineMark("b")));
    EXPECT_EQ(Must(store->ReadBlob(kAbc)), "abc");
    EXPECT_EQ(Must(store->ReadArtifact(1, "program")), "STOP\n");
    EXPECT_EQ(Must(store->GetJob(1)).specification, "spec");
    const auto orders = Must(store->TakeOrders("server-1"));
    ASSERT_EQ(orders.size(), 1U);
    EXPECT_EQ(orders[0].lease.job, 1);
    EXPECT_EQ(orders[0].payload, "stop it");
    const auto events = Must(store->AllEvents(0, 100));
    const auto moved = std::ranges::find(events, "moved", &EventRecord::kind);
    ASSERT_NE(moved, events.end());
    EXPECT_EQ(moved->resource, "machines/a");
    EXPECT_EQ(moved->payload, "to 7");
    EXPECT_EQ(moved->caller, "anna");
    // The fences go on behind those that were given.
    Must(store->ReleaseMachine(leases[1]));
    const MachineLease next = Must(store->TakeMachine(
        {.machine = "b", .host = "host-3", .server = "server-1", .duration = seconds(60)}));
    EXPECT_GT(next.fence, leases[1].fence);
  }
  ExpectSound(path);
}

}  // namespace
}  // namespace rmlcell::storage
