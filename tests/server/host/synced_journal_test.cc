// When a journal is on the disk, and when it is made shorter (live.md 3.21, 3.22).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/host/journal.h"
#include "server/host/journal_writer.h"
#include "tests/storage/quiet_process.h"

namespace {

std::atomic<int> data_synced = 0;
std::atomic<bool> disk_fails = false;

}  // namespace

// In place of that of the library, for all of this program: what was synced is counted, and fails
// where a test wants that.
extern "C" int fdatasync(int file) {
  ++data_synced;
  if (disk_fails) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fdatasync, file));
}

namespace rmlcell::server {
namespace {

class SyncedJournal : public testing::Test {
 protected:
  SyncedJournal() { std::filesystem::remove(path_); }
  ~SyncedJournal() override {
    disk_fails = false;
    std::filesystem::remove(path_);
  }
  static v1::JournalEntry Said(std::int64_t sequence, std::size_t bytes) {
    v1::JournalEntry entry;
    entry.set_fence(3);
    entry.set_sequence(sequence);
    entry.mutable_event()->mutable_message()->set_text(std::string(bytes, 't'));
    return entry;
  }
  std::unique_ptr<Journal> Open() { return std::move(Journal::Open(path_)->journal); }

  const std::string path_ = testing::TempDir() + "/synced-journal-" + std::to_string(::getpid());
};

// LIVE-3.21: what is written is synced each time, and so is what takes the place of a file.
TEST_F(SyncedJournal, WhatIsWrittenIsOnTheDisk) {
  const auto journal = Open();
  int before = data_synced;
  ASSERT_TRUE(journal->Write({Said(1, 10), Said(2, 10)}));
  EXPECT_EQ(data_synced, before + 1);
  before = data_synced;
  ASSERT_TRUE(journal->Replace({Said(2, 10)}));
  EXPECT_EQ(data_synced, before + 1);
  before = data_synced;
  ASSERT_TRUE(journal->Write({}));
  EXPECT_EQ(data_synced, before);
}

// LIVE-3.21: what the disk did not take is not there, whatever was written of it.
TEST_F(SyncedJournal, WhatCannotBeSyncedIsNotThere) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({Said(1, 10)}));
  const auto size = std::filesystem::file_size(path_);
  disk_fails = true;
  for (const Status& done : {journal->Write({Said(2, 10)}), journal->Replace({Said(3, 10)})}) {
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, ErrorCode::kCellJournal);
    EXPECT_THAT(done.error().detail, testing::HasSubstr(std::strerror(EIO)));
  }
  EXPECT_EQ(std::filesystem::file_size(path_), size);
  EXPECT_EQ(journal->bytes(), static_cast<std::int64_t>(size));
  EXPECT_FALSE(std::filesystem::exists(path_ + ".new"));
}

// LIVE-3.21: it is tried again until it is there, and not without a rest between.
TEST_F(SyncedJournal, IsTriedAgainAfterARest) {
  JournalWriter writer(Open());
  disk_fails = true;
  std::promise<void> written;
  writer.Write({Said(1, 10)}, {}, [&written] { written.set_value(); });
  while (!writer.trouble()) std::this_thread::yield();
  EXPECT_TRUE(ComesToRest());
  disk_fails = false;
  written.get_future().wait();
}

// What the store has is dropped when it has it, and not with what is written next.
TEST_F(SyncedJournal, IsShortenedWhenTheStoreHasIt) {
  auto journal = Open();
  ASSERT_TRUE(journal->Write({Said(1, Journal::kBytesKept), Said(2, 10)}));
  JournalWriter writer(std::move(journal));
  std::promise<void> written;
  writer.Write({Said(3, 10)}, {}, [&written] { written.set_value(); });
  written.get_future().wait();
  EXPECT_TRUE(ComesToRest());  // it waits for more
  writer.Stored(3, 1);
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (std::filesystem::file_size(path_) > 1'000U && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_LT(std::filesystem::file_size(path_), 1'000U);
}

}  // namespace
}  // namespace rmlcell::server
