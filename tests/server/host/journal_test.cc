// The journal of a host: what is written is there again, whatever is torn off its end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <semaphore>

#include "proto/recording/records.h"
#include "server/host/journal_writer.h"
#include "server/host/unstored_entries.h"

namespace rmlcell::server {
namespace {

class JournalTest : public testing::Test {
 protected:
  JournalTest() {
    folder_ =
        std::filesystem::temp_directory_path() / ("rmlcell-journal-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / "mill-1.journal").string();
  }
  ~JournalTest() override { std::filesystem::remove_all(folder_); }

  static v1::JournalEntry Entry(std::int64_t fence, std::int64_t sequence, std::size_t bytes = 20) {
    v1::JournalEntry entry;
    entry.set_fence(fence);
    entry.set_sequence(sequence);
    entry.mutable_mark()->set_state(std::string(bytes, static_cast<char>('a' + sequence % 26)));
    return entry;
  }
  static v1::JournalEntry Event(std::int64_t fence, std::int64_t sequence, std::size_t bytes = 20) {
    v1::JournalEntry entry;
    entry.set_fence(fence);
    entry.set_sequence(sequence);
    entry.mutable_event()->mutable_message()->set_text(std::string(bytes, 'x'));
    return entry;
  }
  static std::vector<v1::JournalEntry> Entries(std::int64_t fence, std::int64_t from,
                                               std::int64_t to, std::size_t bytes = 20) {
    std::vector<v1::JournalEntry> entries;
    for (std::int64_t i = from; i <= to; ++i) entries.push_back(Entry(fence, i, bytes));
    return entries;
  }
  Journal::Found Open() {
    auto found = Journal::Open(path_);
    EXPECT_TRUE(found) << (found ? "" : found.error().detail);
    return *std::move(found);
  }
  static std::vector<std::int64_t> Numbers(const std::vector<v1::JournalEntry>& entries) {
    std::vector<std::int64_t> numbers;
    for (const v1::JournalEntry& entry : entries) numbers.push_back(entry.sequence());
    return numbers;
  }
  std::string Bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void Replace(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }

  std::filesystem::path folder_;
  std::string path_;
};

// LIVE-3.24
TEST_F(JournalTest, WhatIsWrittenIsThereAgain) {
  {
    const Journal::Found found = Open();
    EXPECT_TRUE(found.entries.empty());
    EXPECT_TRUE(found.journal->Write(Entries(3, 1, 4)));
    EXPECT_TRUE(found.journal->Write(Entries(3, 5, 5)));
    EXPECT_EQ(found.journal->bytes(), static_cast<std::int64_t>(Bytes().size()));
  }
  const Journal::Found again = Open();
  EXPECT_THAT(Numbers(again.entries), testing::ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(again.torn_bytes, 0);
  EXPECT_EQ(again.entries[1].SerializeAsString(), Entry(3, 2).SerializeAsString());
}

// LIVE-3.24: cut at every byte, the entries before the cut are there and nothing else, and more can
// be written behind them.
TEST_F(JournalTest, IsCutAtTheFirstTornRecord) {
  ASSERT_TRUE(Open().journal->Write(Entries(3, 1, 3)));
  const std::string whole = Bytes();
  const std::size_t record = whole.size() / 3;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    Replace(whole.substr(0, length));
    {
      const Journal::Found found = Open();
      ASSERT_EQ(found.entries.size(), length / record) << length;
      ASSERT_EQ(found.torn_bytes, static_cast<std::int64_t>(length % record)) << length;
      ASSERT_EQ(Bytes().size(), length - length % record) << length;
      ASSERT_TRUE(found.journal->Write({Entry(3, 9)}));
    }
    ASSERT_EQ(Open().entries.back().sequence(), 9) << length;
  }
}

// LIVE-3.24: a bit that changed ends it, wherever it is.
TEST_F(JournalTest, AChangedBitIsFound) {
  ASSERT_TRUE(Open().journal->Write(Entries(3, 1, 3)));
  const std::string whole = Bytes();
  const std::size_t record = whole.size() / 3;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string changed = whole;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << (bit % 8)));
    ASSERT_EQ(ReadJournal(changed).entries.size(), bit / 8 / record) << bit;
  }
}

// LIVE-3.24: a record that is whole and yet no entry ends it as well.
TEST_F(JournalTest, ARecordOfSomethingElseEndsIt) {
  const std::string first = RecordsOf({Entry(3, 1)});
  std::string all = first;
  recording::AddRecord("\x07", all);  // no field has this number
  all += RecordsOf({Entry(3, 2)});
  Replace(all);
  const Journal::Found found = Open();
  EXPECT_EQ(Numbers(found.entries), std::vector<std::int64_t>{1});
  EXPECT_EQ(found.torn_bytes, static_cast<std::int64_t>(all.size() - first.size()));
  EXPECT_EQ(Bytes(), first);
}

// Zeros, which a file may have at its end after a crash, are no entry.
TEST_F(JournalTest, ZerosAreNoEntry) {
  ASSERT_TRUE(Open().journal->Write(Entries(3, 1, 2)));
  Replace(Bytes() + std::string(4'096, '\0'));
  const Journal::Found found = Open();
  EXPECT_EQ(found.entries.size(), 2U);
  EXPECT_EQ(found.torn_bytes, 4'096);
}

// LIVE-3.24: what the store has is dropped when the file has grown; the rest stays.
TEST_F(JournalTest, WhatTheStoreHasIsDropped) {
  const Journal::Found found = Open();
  Journal& journal = *found.journal;
  ASSERT_TRUE(journal.Write(Entries(2, 1, 3, 1'000)));
  journal.Stored(2, 2);
  EXPECT_EQ(Open().entries.size(), 3U);  // not worth while yet
  ASSERT_TRUE(journal.Write(Entries(3, 1, 50, 100'000)));
  journal.Stored(3, 48);
  EXPECT_LT(journal.bytes(), 250'000);
  EXPECT_THAT(Numbers(Open().entries), testing::ElementsAre(49, 50));
  ASSERT_TRUE(journal.Write(Entries(3, 51, 51)));
  EXPECT_THAT(Numbers(Open().entries), testing::ElementsAre(49, 50, 51));
}

// LIVE-3.24: not beyond its bound, and then nothing of it.
TEST_F(JournalTest, HasABound) {
  const Journal::Found found = Open();
  Status written;
  std::int64_t sequence = 0;
  while (written) written = found.journal->Write({Event(3, ++sequence, 1 << 20)});
  EXPECT_EQ(written.error().code, ErrorCode::kCellJournal);
  EXPECT_LE(found.journal->bytes(), Journal::kBytesMax);
  EXPECT_EQ(static_cast<std::int64_t>(Bytes().size()), found.journal->bytes());
}

// LIVE-3.24: where it is full older marks go first, and what happened stays.
TEST_F(JournalTest, OldMarksGoFirst) {
  const Journal::Found found = Open();
  std::vector<std::int64_t> kept;
  std::int64_t sequence = 0;
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(found.journal->Write({Event(3, ++sequence, 1 << 20)})) << i;
    kept.push_back(sequence);
    ASSERT_TRUE(found.journal->Write({Entry(3, ++sequence, 1 << 20)})) << i;
  }
  const std::int64_t newest = sequence;
  while (found.journal->Write({Event(3, ++sequence, 1 << 20)})) kept.push_back(sequence);
  EXPECT_GT(kept.size(), 60U);
  kept.push_back(newest);
  std::ranges::sort(kept);
  EXPECT_EQ(Numbers(Open().entries), kept);
  EXPECT_LE(found.journal->bytes(), Journal::kBytesMax);
  found.journal->Stored(3, newest);  // it knows where they lie
  EXPECT_EQ(Open().entries.front().sequence(), newest + 1);
}

// LIVE-3.25: events that the store has not taken are never left out, older marks may be.
TEST_F(JournalTest, WhatIsNotStoredIsKept) {
  UnstoredEntries unstored;
  std::int64_t sequence = 0;
  const auto add = [&](int count) {
    for (int i = 0; i < count; ++i) {
      unstored.Add({Event(3, sequence + 1), Entry(3, sequence + 2)});
      sequence += 2;
    }
  };
  add(150'000);
  const std::vector<v1::JournalEntry> all = unstored.all();
  EXPECT_EQ(std::ranges::count_if(all, &v1::JournalEntry::has_event), 150'000);
  EXPECT_LT(std::ranges::count_if(all, &v1::JournalEntry::has_mark), 100'000);
  EXPECT_TRUE(all.back().has_mark());
  EXPECT_TRUE(std::ranges::is_sorted(Numbers(all)));
  unstored.Stored(sequence - 2);
  EXPECT_THAT(Numbers(unstored.all()), testing::ElementsAre(sequence - 1, sequence));
  unstored.Stored(sequence);
  EXPECT_TRUE(unstored.empty());
}

// LIVE-3.22: the end of a run is stored with the mark behind it, which is never too old.
TEST_F(JournalTest, TheMarkBehindTheEndOfARunStays) {
  v1::JournalEntry over = Event(3, 3);
  over.mutable_run_over()->set_job("jobs/1");
  const std::vector<v1::JournalEntry> kept = WithoutOldMarks(
      {Entry(3, 1), Entry(3, 2), over, Entry(3, 4), Entry(3, 5), Event(3, 6), Entry(3, 7)});
  EXPECT_THAT(Numbers(kept), testing::ElementsAre(3, 4, 6, 7));
}

// LIVE-3.25: in messages that a server takes.
TEST_F(JournalTest, WhatIsToldIsToldInParts) {
  std::vector<v1::JournalEntry> entries;
  for (int i = 1; i <= 50; i += 2) {
    entries.push_back(Event(3, i, 100'000));
    entries.push_back(Entry(3, i + 1, 100'000));
  }
  const std::vector<v1::HostRequest> parts = EntriesInParts(entries, 3);
  EXPECT_EQ(parts.size(), 5U);
  std::vector<std::int64_t> told;
  for (const v1::HostRequest& part : parts) {
    EXPECT_EQ(part.entries().fence(), 3);
    EXPECT_TRUE(part.entries().entries().rbegin()->has_mark());
    EXPECT_LT(part.ByteSizeLong(), 2U << 20);
    for (const v1::JournalEntry& entry : part.entries().entries()) told.push_back(entry.sequence());
  }
  EXPECT_EQ(told, Numbers(entries));
  EXPECT_TRUE(EntriesInParts({}, 3).empty());
}

// LIVE-3.05: what another host's machine does not take is kept beside the journal.
TEST_F(JournalTest, WhatNobodyTakesIsAnOrphan) {
  UnstoredEntries unstored;
  EXPECT_EQ(*unstored.KeepAsOrphan(path_), "");
  unstored.Add({Event(3, 7), Entry(3, 8)});
  const Result<std::string> orphan = unstored.KeepAsOrphan(path_);
  ASSERT_TRUE(orphan);
  EXPECT_EQ(*orphan, path_ + ".orphan");
  std::ifstream file(*orphan, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  EXPECT_THAT(Numbers(ReadJournal(bytes).entries), testing::ElementsAre(7, 8));
  EXPECT_EQ(unstored.KeepAsOrphan((folder_ / "none" / "x").string()).error().code,
            ErrorCode::kCellJournal);
}

// LIVE-3.21: a folder that is not there.
TEST_F(JournalTest, SaysWhereItCannotBe) {
  const auto found = Journal::Open((folder_ / "none" / "x").string());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCellJournal);
  EXPECT_THAT(found.error().detail, testing::HasSubstr("none"));
}

// LIVE-3.10, LIVE-3.22: on a thread of its own, in order; who waits is told when it is on the disk.
TEST_F(JournalTest, TheWriterTellsWhenItIsWritten) {
  std::counting_semaphore<> told(0);
  std::vector<int> order;
  {
    JournalWriter writer(Open().journal);
    for (int i = 1; i <= 20; ++i) {
      writer.Write({Entry(3, i)}, {}, [&, i] {
        order.push_back(i);
        told.release();
      });
    }
    for (int i = 0; i < 20; ++i) told.acquire();
    EXPECT_FALSE(writer.trouble());
    EXPECT_EQ(Open().entries.size(), 20U);
    writer.Write({Entry(3, 21)}, {}, [] {});
  }
  EXPECT_TRUE(std::ranges::is_sorted(order));
  EXPECT_EQ(Open().entries.size(), 21U);
}

// LIVE-3.40: what is recorded is in its file in front of what is durable, once; where the journal
// has no room there is none until another run begins.
TEST_F(JournalTest, TheWriterKeepsTheRecording) {
  const auto recorded = [this] {
    std::ifstream file(path_ + ".run", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  std::counting_semaphore<> told(0);
  std::string seen;
  JournalWriter writer(Open().journal);
  writer.Write({Entry(3, 1)}, {.begins = true, .bytes = "one "}, [&] { told.release(); });
  writer.Write({Entry(3, 2)}, {.bytes = "two "}, [&] {
    seen = recorded();
    told.release();
  });
  told.acquire();
  told.acquire();
  EXPECT_EQ(seen, "one two ");
  // More than it may ever have: it is tried again and again.
  writer.Write(Entries(3, 3, 70, std::size_t{1} << 20), {.bytes = "three "}, [] {});
  while (!writer.trouble()) std::this_thread::yield();
  EXPECT_FALSE(std::filesystem::exists(path_ + ".run"));
}

}  // namespace
}  // namespace rmlcell::server
