// Contents in the embedded store: kept once, compressed, in chunks, and removed when nobody names
// them.
#include <gmock/gmock.h>

#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

// Removal happens beside the writes: waits until it is done.
void WaitUntil(const std::function<bool()>& done) { EXPECT_TRUE(Eventually(done)); }

class SqliteContents : public testing::Test {
 protected:
  Store& store() { return bed_.store(); }
  std::int64_t Count(const std::string& from) {
    return NumberIn(bed_.path(), "SELECT count(*) FROM " + from);
  }
  void PutProgram(int slot, const std::string& object) {
    Must(store().PutPrograms("m", {{.slot = slot, .object = object}}, {}));
  }

  SqliteBed bed_;
};

// The end of a job is told in no time, however large its products are and whatever the disk does:
// here the writer stands, in the answer of another call.
TEST_F(SqliteContents, WhoTellsALargeEndWaitsForNothing) {
  std::vector<Lease> leases;
  for (int i = 0; i < 2; ++i) {
    Must(store().SubmitAndWait({.machine = "m", .kind = "CHECK", .specification = "s"}));
    leases.push_back(
        Must(store().Acquire("w", {"CHECK"}, std::chrono::hours(i == 0 ? 24 : 1), {}))->lease);
  }
  std::promise<void> stands;
  std::promise<void> go_on;
  std::thread other([&] {
    store().Append(leases[0], {{.kind = "k", .payload = "p"}}, [&](Result<std::int64_t>) {
      stands.set_value();
      go_on.get_future().wait();
    });
  });
  stands.get_future().wait();
  const std::string large = Noise(3 * kMiB + 5, 1);
  auto end = std::make_shared<const JobEnd>(JobEnd{
      .artifacts = {{.name = "a", .media_type = "application/octet-stream", .bytes = large}}});
  std::promise<Result<FinishedJob>> ended;
  std::future<Result<FinishedJob>> job = ended.get_future();
  auto told = std::async(std::launch::async, [&] {
    store().SendFinish(leases[1], end, {},
                       [&](Result<FinishedJob> record) { ended.set_value(std::move(record)); });
  });
  EXPECT_EQ(told.wait_for(kPatience), std::future_status::ready);
  told.get();
  // Its lease runs out meanwhile, and the job stays its own.
  bed_.clock().Advance(std::chrono::hours(1));
  auto expired = std::async(std::launch::async, [&] {
    return store().Expire({.outcome = {.state = JobState::kFailed}});
  });
  ASSERT_EQ(expired.wait_for(kPatience), std::future_status::ready);
  EXPECT_TRUE(Must(expired.get()).empty());
  go_on.set_value();
  other.join();
  EXPECT_EQ(Must(job.get()).job.state, JobState::kSucceeded);
  EXPECT_TRUE(Must(store().ReadArtifact(leases[1].job, "a")) == large);
}

// FIPS 180-2, appendix B.1.
TEST(Content, Sha256IsThatOfTheStandard) {
  EXPECT_EQ(HexOf(Sha256("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Content, HexadecimalIsReadStrictly) {
  EXPECT_EQ(BytesOfHex("00ff7a"), std::string("\x00\xFF\x7A", 3));
  EXPECT_EQ(BytesOfHex(""), "");
  for (const char* bad : {"0", "0g", "FF", " 00", "0x00"}) EXPECT_EQ(BytesOfHex(bad), std::nullopt);
}

TEST(Content, ChunksComeBackAsTheyWereEncoded) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{511}, std::size_t{512},
                                 std::size_t{100'000}, kChunkBytes}) {
    for (const std::string& chunk : {Noise(size, 1), PlotText(size)}) {
      const std::string encoded = Must(Encode(chunk));
      EXPECT_LE(encoded.size(), chunk.size());
      std::string content = "before ";
      Must(Decode(encoded, chunk.size(), content));
      EXPECT_TRUE(content == "before " + chunk) << size;
    }
  }
}

// Noise with an end that shrinks a little: somewhere the compressed form is exactly as long as the
// chunk itself, by whose size what is kept is told apart.
TEST(Content, ChunksComeBackWhateverCompressingGains) {
  for (const std::size_t tail : {100U, 200U, 300U}) {
    for (std::size_t repeated = 0; repeated < 60; ++repeated) {
      const std::string chunk = Noise(131'072 + tail, 1) + std::string(repeated, 'a');
      std::string content;
      Must(Decode(Must(Encode(chunk)), chunk.size(), content));
      EXPECT_TRUE(content == chunk) << tail << " " << repeated;
    }
  }
}

// Toolpaths shrink, noise is kept as it is.
TEST(Content, TextIsCompressed) {
  EXPECT_LT(Must(Encode(PlotText(kMiB))).size(), kMiB / 3);
  EXPECT_EQ(Must(Encode(Noise(kMiB, 1))).size(), kMiB);
  // What is shorter than 512 bytes is not tried.
  EXPECT_EQ(Must(Encode(std::string(511, 'a'))).size(), 511U);
  EXPECT_LT(Must(Encode(std::string(512, 'a'))).size(), 512U);
}

TEST(Content, DamagedChunkIsToldAndChangesNothing) {
  const std::string chunk = PlotText(10'000);
  const std::string encoded = Must(Encode(chunk));
  std::string content = "before";
  EXPECT_EQ(CodeOf(Decode(encoded, chunk.size() - 1, content)), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Decode(encoded, chunk.size() + 1, content)), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Decode(encoded.substr(1), chunk.size(), content)), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Decode("", chunk.size(), content)), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(content, "before");
  // With the words of zstd, where it has any.
  const Status too_short = Decode(encoded, chunk.size() + 1, content);
  ASSERT_FALSE(too_short);
  EXPECT_EQ(too_short.error().detail, "too short");
  const Status too_long = Decode(encoded, chunk.size() - 1, content);
  ASSERT_FALSE(too_long);
  EXPECT_NE(too_long.error().detail, "too short");
}

// It is moved into the file again and again, however much is written.
TEST_F(SqliteContents, TheLogDoesNotGrowWithoutEnd) {
  Must(store().PutMachine({.id = "m"}, 0));
  for (std::uint64_t seed = 0; seed < 7; ++seed) PutProgram(1, Noise(20 * kMiB, seed));
  EXPECT_LT(std::filesystem::file_size(bed_.path() + "-wal"), 100 * kMiB);
}

// Brief: the same content is kept once, rows are at most about 1 MB.
TEST_F(SqliteContents, SameContentIsKeptOnce) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::string object = Noise(3 * kMiB + 5, 1);
  for (int slot = 1; slot <= 4; ++slot) PutProgram(slot, object);
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_EQ(Count("blob_chunk"), 4);
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT refs FROM blob"), 4);
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT max(length(content)) FROM blob_chunk"),
            static_cast<std::int64_t>(kChunkBytes));
}

// store.h DeleteMachine: what its programs took is free again.
TEST_F(SqliteContents, WhatADeletedMachineKeptGoes) {
  Must(store().PutMachine({.id = "m"}, 0));
  PutProgram(1, Noise(3 * kMiB, 1));
  PutProgram(2, Noise(3 * kMiB, 2));
  Must(store().DeleteMachine("m", kAnyRevision));
  EXPECT_TRUE(Eventually([&] { return Count("blob") == 0 && Count("blob_chunk") == 0; }));
}

// store.h DeleteJob: what it was given and what it made goes with it.
TEST_F(SqliteContents, WhatADeletedJobKeptGoes) {
  const std::string large = Noise(kContentInRecordMax + 1, 1);
  Must(store().SubmitAndWait({.kind = "CHECK",
                              .specification = large + "s",
                              .attachments = {{.name = "a", .bytes = large + "a"}}}));
  const Lease lease = Must(store().Acquire("w", {"CHECK"}, std::chrono::hours(1), {}))->lease;
  Must(store().Finish(lease, {.artifacts = {{.name = "b", .bytes = large + "b"}}}));
  EXPECT_EQ(Count("blob"), 3);
  Must(store().DeleteJob(lease.job));
  WaitUntil([&] { return Count("blob") == 0 && Count("blob_chunk") == 0; });
}

TEST_F(SqliteContents, SmallContentsLieInTheirRow) {
  Must(store().PutMachine({.id = "m"}, 0));
  PutProgram(1, Noise(kContentInRowMax, 1));
  EXPECT_EQ(Count("blob_chunk"), 0);
  PutProgram(2, Noise(kContentInRowMax + 1, 2));
  EXPECT_EQ(Count("blob_chunk"), 1);
}

// One chunk that comes piece by piece is no more than any other content.
TEST_F(SqliteContents, AnUploadOfAChunkThatShrinksLiesInItsRow) {
  const auto upload = [&](const std::string& content) {
    const auto writer = Must(store().WriteBlob(HexOf(Sha256(content)), content.size()));
    Must(writer->Append(content));
    Must(writer->Finish(std::chrono::hours(1)));
  };
  upload(std::string(kChunkBytes, 'x'));
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_EQ(Count("blob_chunk"), 0);
  upload(std::string(kChunkBytes + 1, 'x'));
  EXPECT_EQ(Count("blob_chunk"), 2);
  upload(std::string(2 * kChunkBytes, 'x'));  // two parts, and none of nothing behind them
  EXPECT_EQ(Count("blob_chunk"), 4);
}

// content.h kContentInRecordMax: on both sides.
TEST_F(SqliteContents, SmallBodiesLieInTheirRecord) {
  Must(store().PutProject({.id = "p", .body = Noise(kContentInRecordMax, 1)}, 0));
  EXPECT_EQ(Count("blob"), 0);
  Must(store().PutProject({.id = "q", .body = Noise(kContentInRecordMax + 1, 1)}, 0));
  EXPECT_EQ(Count("blob"), 1);
  EXPECT_TRUE(Must(store().GetProject("p")).body == Noise(kContentInRecordMax, 1));
}

// A content goes with the last record that names it, and not before.
TEST_F(SqliteContents, ContentGoesWithItsLastName) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::string object = Noise(12 * kMiB, 1);  // takes several slices to remove
  PutProgram(1, object);
  PutProgram(2, object);
  Must(store().PutExecutable("m", 2, 1, "executable"));
  Must(store().DeleteProgram("m", 1, kAnyRevision));
  EXPECT_TRUE(Must(store().GetProgram("m", 2)).object == object);
  PutProgram(2, "another");
  WaitUntil([&] { return Count("blob") == 1 && Count("blob_chunk") == 0; });
  EXPECT_EQ(Must(store().GetProgram("m", 2)).object, "another");
}

TEST_F(SqliteContents, EveryKindOfRecordLetsItsContentGo) {
  const std::string large = Noise(kContentInRecordMax + 1, 1);
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutProject({.id = "p", .body = large + "1"}, 0));
  Must(store().PutProject({.id = "p", .body = large + "2"}, 1));
  Must(store().DeleteProject("p", kAnyRevision));
  Must(store().PutPrograms("m", {{.slot = 1, .object = large + "o", .source = large + "s"}}, {}));
  Must(store().PutExecutable("m", 1, 1, large + "e"));
  Must(store().PutExecutable("m", 1, 1, large + "f"));
  Must(store().DeleteExecutable("m", 1));
  Must(store().DeleteProgram("m", 1, kAnyRevision));
  WaitUntil([&] { return Count("blob") == 0 && Count("blob_chunk") == 0; });
}

// What each kind of write leaves behind goes by itself: nothing else has to be written after it.
TEST(SqliteGarbage, EveryWriteThatDropsAContentHasItSwept) {
  const std::string large = Noise(kContentInRecordMax + 1, 1);
  using Change = std::function<void(Store&)>;
  const std::vector<std::pair<std::string, Change>> changes = {
      {"project", [](Store& store) { Must(store.PutProject({.id = "p"}, kAnyRevision)); }},
      {"no project", [](Store& store) { Must(store.DeleteProject("p", kAnyRevision)); }},
      {"program",
       [](Store& store) { Must(store.PutPrograms("m", {{.slot = 1, .object = "new"}}, {})); }},
      {"no program", [](Store& store) { Must(store.DeleteProgram("m", 1, kAnyRevision)); }},
      {"executable", [](Store& store) { Must(store.PutExecutable("m", 2, 1, "new")); }},
      {"no executable", [](Store& store) { Must(store.DeleteExecutable("m", 2)); }},
  };
  for (const auto& [what, change] : changes) {
    SqliteBed bed;
    Must(bed.store().PutMachine({.id = "m"}, 0));
    Must(bed.store().PutProject({.id = "p", .body = large + "p"}, 0));
    Must(bed.store().PutPrograms(
        "m", {{.slot = 1, .object = large + "o"}, {.slot = 2, .object = "o"}}, {}));
    Must(bed.store().PutExecutable("m", 2, 1, large + "e"));
    const std::string has_large = "SELECT count(*) FROM blob WHERE size > 1000";
    // What was set up has been swept before: nobody else's sweep takes the content away.
    Must(bed.store().PutProject({.id = "q", .body = large + "q"}, 0));
    Must(bed.store().DeleteProject("q", 1));
    ASSERT_TRUE(Eventually([&] { return NumberIn(bed.path(), has_large) == 3; }));
    change(bed.store());
    EXPECT_TRUE(Eventually([&] { return NumberIn(bed.path(), has_large) == 2; })) << what;
  }
}

// What a refused write had brought along goes again.
TEST_F(SqliteContents, RefusedWriteLeavesNothing) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::string object = Noise(3 * kMiB, 1);
  EXPECT_EQ(CodeOf(store().PutPrograms("m", {{.slot = 1, .object = object, .expected = 3}}, {})),
            ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().PutPrograms("none", {{.slot = 1, .object = object}}, {})),
            ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().Finish({.job = 1}, {.artifacts = {{.name = "r", .bytes = object}}})),
            ErrorCode::kCellLeaseLost);
  WaitUntil([&] { return Count("blob") == 0 && Count("blob_chunk") == 0; });
}

// What a process had written ahead when it was killed goes at the next start.
TEST_F(SqliteContents, LeftoversOfAKilledProcessGoAtTheNextStart) {
  Must(store().PutMachine({.id = "m"}, 0));
  PutProgram(1, Noise(2 * kMiB, 1));
  bed_.Close();
  ExecuteIn(bed_.path(),
            "INSERT INTO blob (id, sha256, size, refs, holds) VALUES (77, NULL, 5000000, 0, 1);"
            "INSERT INTO blob_chunk VALUES (77, 0, zeroblob(1000000)), (77, 1, zeroblob(1000000));"
            "UPDATE blob SET holds = 1 WHERE id = 1");
  bed_.Reopen();
  WaitUntil([&] { return Count("blob") == 1 && Count("blob_chunk") == 2; });
  EXPECT_EQ(NumberIn(bed_.path(), "SELECT holds FROM blob"), 0);
  EXPECT_TRUE(Must(store().GetProgram("m", 1)).object == Noise(2 * kMiB, 1));
}

// A large program goes in piece by piece: small writes get in between. The answer of each asks for
// the next one, so that one waits at any time, whichever thread stands still.
TEST_F(SqliteContents, LargeProgramDoesNotHoldUpSmallWrites) {
  Must(store().PutMachine({.id = "m"}, 0));
  const std::string object = Noise(64 * kMiB, 1);
  std::atomic<bool> done = false;
  std::atomic<int> between = 0;
  std::promise<void> over;
  std::function<void()> write_small;
  write_small = [&] {
    store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>& made) {
      EXPECT_TRUE(made);
      if (done || !made) return over.set_value();
      ++between;
      write_small();
    });
  };
  write_small();
  PutProgram(1, object);
  done = true;
  over.get_future().wait();
  EXPECT_GE(between, 8);  // of at least 16 pieces of 4 MiB
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
