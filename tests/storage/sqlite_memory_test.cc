// What the embedded store does where memory is short.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <zstd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/change_counts.h"
#include "tests/storage/sqlite_bed.h"

namespace {

// So many bytes at once, or more, are not to be had in this program; 0: all are.
std::atomic<std::size_t> g_too_many_bytes = 0;
// Whether zstd finds no room for its tables.
std::atomic<bool> g_no_tables = false;

}  // namespace

// Stands before that of the library, and asks it while there is room.
ZSTD_CCtx* ZSTD_createCCtx() {
  using Make = ZSTD_CCtx* (*)();
  static const auto make = reinterpret_cast<Make>(dlsym(RTLD_NEXT, "ZSTD_createCCtx"));
  return g_no_tables ? nullptr : make();
}

// Not inlined: a compiler that sees both of them takes them for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  const std::size_t too_many = g_too_many_bytes;
  void* const block = too_many != 0 && size >= too_many ? nullptr : std::malloc(size);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}
[[gnu::noinline]] void operator delete(void* pointer) noexcept { std::free(pointer); }
[[gnu::noinline]] void operator delete(void* pointer, std::size_t) noexcept { std::free(pointer); }

namespace rmlcell::storage {
namespace {

class ShortMemory {
 public:
  explicit ShortMemory(std::size_t too_many_bytes) { g_too_many_bytes = too_many_bytes; }
  ~ShortMemory() { g_too_many_bytes = 0; }
  ShortMemory(const ShortMemory&) = delete;
  ShortMemory& operator=(const ShortMemory&) = delete;
};

// store.h, errors everywhere: the end of a job whose product finds no room on its way fails as a
// whole and is told so, the job is still its holder's, and the same end is good later.
TEST(SqliteMemory, AnEndThatFindsNoRoomIsToldAndMayComeAgain) {
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.SubmitAndWait({.kind = "CHECK"}));
  const Lease lease = Must(store.Acquire("w", {"CHECK"}, kLease, {}))->lease;
  const std::string large = Noise(kChunkBytes + 1, 1);
  const auto end =
      std::make_shared<const JobEnd>(JobEnd{.artifacts = {{.name = "large", .bytes = large}}});
  const auto finish = [&]() -> std::optional<ErrorCode> {
    const auto ended = std::make_shared<std::promise<std::optional<ErrorCode>>>();
    auto answer = ended->get_future();
    store.SendFinish(lease, end, {},
                     [ended](const Result<FinishedJob>& job) { ended->set_value(CodeOf(job)); });
    if (answer.wait_for(kPatience) != std::future_status::ready) return ErrorCode::kCellInternal;
    return answer.get();
  };
  {
    const ShortMemory short_memory(kChunkBytes);  // a part is compressed into more than it has
    EXPECT_EQ(finish(), ErrorCode::kCellStoreFailed);
  }
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kRunning);
  EXPECT_EQ(finish(), std::nullopt);
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kSucceeded);
  EXPECT_TRUE(Must(store.ReadArtifact(lease.job, "large")) == large);
}

// What `work` gives on a thread that finds no room to compress: a thread has its tables for good.
template <class Work>
std::optional<ErrorCode> WithoutTables(Work work) {
  std::optional<ErrorCode> code;
  g_no_tables = true;
  std::thread([&] { code = CodeOf(work()); }).join();
  g_no_tables = false;
  return code;
}

// content.h Encode: out of memory is an error, and what cannot be compressed is not stored, neither
// whole nor the parts of it that could be.
TEST(SqliteMemory, WhatCannotBeCompressedIsNotStored) {
  constexpr auto kNoRoom = ErrorCode::kCellStoreFailed;
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.PutMachine({.id = "m"}, 0));
  const std::string small = PlotText(1'000);
  const std::string large = PlotText(2 * kChunkBytes + 1'000);
  EXPECT_EQ(WithoutTables([&] { return Encode(small); }), kNoRoom);
  for (const std::string& content : {small, large}) {
    const auto put = [&] { return store.PutPrograms("m", {{.slot = 1, .object = content}}, {}); };
    EXPECT_EQ(WithoutTables(put), kNoRoom) << content.size();
    const std::string name = HexOf(Sha256(content));
    const auto writer = Must(store.WriteBlob(name, content.size()));
    Must(writer->Append(content));
    EXPECT_EQ(WithoutTables([&] { return writer->Finish(std::chrono::hours(1)); }), kNoRoom)
        << content.size();
    EXPECT_EQ(CodeOf(store.ReadBlob(name)), ErrorCode::kCellNotFound) << content.size();
  }
  EXPECT_TRUE(Must(store.ListPrograms("m", 0, 9)).empty());
  Must(store.PutPrograms("m", {{.slot = 1, .object = large}}, {}));
  EXPECT_TRUE(Must(store.GetProgram("m", 1)).object == large);
}

// change_counts.h: where there is no room to note which jobs change, all of them count as changed;
// the next change is one of its job alone again.
TEST(SqliteMemory, JobsThatCannotBeNotedCountAsChanged) {
  const TestDirectory directory;
  const std::string path = directory.File("x.db");
  ExecuteIn(path, "CREATE TABLE job (id INTEGER PRIMARY KEY)");
  sqlite::Database database =
      Must(sqlite::Database::Open(path, sqlite::Database::Access::kReadWrite, {}));
  sqlite::ChangeCounts counts(database);
  const std::uint64_t first = counts.OfJob(1);
  const std::uint64_t last = counts.OfJob(2'000);
  {
    const ShortMemory short_memory(4'096);  // the numbers of 512 jobs
    Must(database.Execute(
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000)"
        " INSERT INTO job SELECT i FROM n"));
  }
  counts.BeforeCommit();
  EXPECT_EQ(counts.OfJob(1), 0U);
  EXPECT_EQ(counts.OfJob(2'000), 0U);
  counts.AfterCommit();
  EXPECT_GT(counts.OfJob(1), first);
  EXPECT_GT(counts.OfJob(2'000), last);
  const std::uint64_t before = counts.OfJob(2'000);
  const std::uint64_t new_before = counts.OfJob(2'001);
  Must(database.Execute("INSERT INTO job VALUES (2001)"));
  counts.BeforeCommit();
  counts.AfterCommit();
  EXPECT_EQ(counts.OfJob(2'000), before);
  EXPECT_GT(counts.OfJob(2'001), new_before);
}

std::int64_t BytesInUse() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<std::int64_t>(heap.uordblks + heap.hblkhd);
}

// A server runs for months: what a sum needs goes with it, and the tables of a thread with the
// thread.
TEST(SqliteMemory, SumsAndTablesGoWithWhoHasThem) {
  EXPECT_EQ(Sha256("x").size(), kSha256Bytes);  // what is made once for all
  std::int64_t before = BytesInUse();
  for (int i = 0; i < 20'000; ++i) static_cast<void>(Sha256("x"));
  EXPECT_LT(BytesInUse() - before, 1'000'000);
  const std::string text = PlotText(kChunkBytes);
  const auto compress = [&] { std::thread([&] { Must(Encode(text)); }).join(); };
  compress();
  before = BytesInUse();
  for (int i = 0; i < 16; ++i) compress();
  EXPECT_LT(BytesInUse() - before, 8'000'000);
}

}  // namespace
}  // namespace rmlcell::storage
