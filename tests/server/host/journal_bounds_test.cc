// The bounds of a journal to the byte, and what a disk that fails leaves of it (live.md 3.21 ff.).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

#include "proto/recording/records.h"
#include "server/host/answered_requests.h"
#include "server/host/journal_writer.h"
#include "server/host/recording_file.h"
#include "server/host/unstored_entries.h"
#include "tests/proto/bridge/small_files.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kKept = Journal::kBytesKept;
constexpr std::int64_t kMost = Journal::kBytesMax;
constexpr std::int64_t kMebibyte = std::int64_t{1} << 20;

// A process without an input: the next file that it opens is its file 0.
class NoInput {
 public:
  NoInput() { ::close(STDIN_FILENO); }
  ~NoInput() {
    if (input_ >= 0) ::dup2(input_, STDIN_FILENO);
    if (input_ >= 0) ::close(input_);
  }
  NoInput(const NoInput&) = delete;
  NoInput& operator=(const NoInput&) = delete;

 private:
  const int input_ = ::dup(STDIN_FILENO);
};

class JournalBoundsTest : public testing::Test {
 protected:
  JournalBoundsTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("rmlcell-journal-bounds-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / "mill-1.journal").string();
  }
  ~JournalBoundsTest() override { std::filesystem::remove_all(folder_); }

  // Grows `text`, which is of the entry, until its record has exactly so many bytes.
  static void Grow(const v1::JournalEntry& entry, std::string& text, std::int64_t bytes) {
    const auto size = [&entry] {
      return recording::kRecordHeadBytes + static_cast<std::int64_t>(entry.ByteSizeLong());
    };
    text.assign(static_cast<std::size_t>(bytes - size()), 'x');
    while (size() > bytes) text.pop_back();
    EXPECT_EQ(size(), bytes);
  }
  static v1::JournalEntry EventOf(std::int64_t fence, std::int64_t sequence, std::int64_t bytes) {
    v1::JournalEntry entry;
    entry.set_fence(fence);
    entry.set_sequence(sequence);
    Grow(entry, *entry.mutable_event()->mutable_message()->mutable_text(), bytes);
    return entry;
  }
  static v1::JournalEntry MarkOf(std::int64_t sequence, std::int64_t bytes) {
    v1::JournalEntry entry;
    entry.set_fence(3);
    entry.set_sequence(sequence);
    Grow(entry, *entry.mutable_mark()->mutable_state(), bytes);
    return entry;
  }
  // Answered so long behind the first moment of all.
  static v1::JournalEntry AnswerOf(std::int64_t sequence, std::chrono::microseconds at) {
    v1::JournalEntry entry;
    entry.set_fence(3);
    entry.set_sequence(sequence);
    *entry.mutable_time() = TimeUtil::MicrosecondsToTimestamp(at.count());
    entry.mutable_answered()->set_request_id("request " + std::to_string(sequence));
    return entry;
  }
  std::unique_ptr<Journal> Open() {
    auto found = Journal::Open(path_);
    EXPECT_TRUE(found) << (found ? "" : found.error().detail);
    return std::move(found->journal);
  }
  std::string Bytes() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Of all that a host would find there now; each byte belongs to an entry.
  std::vector<std::int64_t> Numbers() const {
    const std::string bytes = Bytes();
    const ReadRecords read = ReadJournal(bytes);
    EXPECT_EQ(read.ends.empty() ? 0 : read.ends.back(), static_cast<std::int64_t>(bytes.size()));
    std::vector<std::int64_t> numbers;
    for (const v1::JournalEntry& entry : read.entries) numbers.push_back(entry.sequence());
    return numbers;
  }
  bool NothingIsLeftBeside() const { return !std::filesystem::exists(path_ + ".new"); }

  std::filesystem::path folder_;
  std::string path_;
};

// LIVE-3.24: what the store has stays until the file has grown beyond its 4 MiB.
TEST_F(JournalBoundsTest, IsTrimmedBeyondWhatItKeeps) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(3, 1, kKept - 100), EventOf(3, 2, 100)}));
  ASSERT_EQ(journal->bytes(), kKept);
  journal->Stored(3, 1);
  EXPECT_THAT(Numbers(), ElementsAre(1, 2));
  ASSERT_TRUE(journal->Write({EventOf(3, 3, 50)}));
  journal->Stored(3, 1);
  EXPECT_THAT(Numbers(), ElementsAre(2, 3));
  EXPECT_EQ(journal->bytes(), 150);
  EXPECT_TRUE(NothingIsLeftBeside());
}

// The first entry that was there when it was opened is the first to go.
TEST_F(JournalBoundsTest, IsTrimmedAfterItWasOpenedAgain) {
  ASSERT_TRUE(Open()->Write({EventOf(3, 1, 100), EventOf(3, 2, kKept)}));
  const auto journal = Open();
  EXPECT_EQ(journal->bytes(), kKept + 100);
  journal->Stored(3, 1);
  EXPECT_THAT(Numbers(), ElementsAre(2));
  ASSERT_TRUE(journal->Replace({EventOf(3, 3, 100), EventOf(3, 4, kKept)}));
  journal->Stored(3, 3);
  EXPECT_THAT(Numbers(), ElementsAre(4));
}

// By fence first: numbers begin anew with each. What is left lies where the journal believes.
TEST_F(JournalBoundsTest, IsTrimmedByFenceAndNumber) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(2, 9, 200), EventOf(3, 1, 300), EventOf(3, 2, 400),
                              EventOf(4, 1, 80), EventOf(4, 2, kKept + 7)}));
  journal->Stored(2, 8);  // nothing that is there
  EXPECT_THAT(Numbers(), ElementsAre(9, 1, 2, 1, 2));
  journal->Stored(3, 1);
  EXPECT_THAT(Numbers(), ElementsAre(2, 1, 2));
  EXPECT_EQ(journal->bytes(), 400 + 80 + kKept + 7);
  ASSERT_TRUE(journal->Write({EventOf(4, 3, 60)}));
  journal->Stored(4, 1);
  EXPECT_THAT(Numbers(), ElementsAre(2, 3));
  EXPECT_EQ(journal->bytes(), kKept + 7 + 60);
  journal->Stored(5, 0);  // all of it
  EXPECT_EQ(journal->bytes(), 0);
  EXPECT_THAT(Numbers(), testing::IsEmpty());
}

// LIVE-3.27: the last 1,024 answers, and those of 10 minutes, by the newest that is dropped.
TEST_F(JournalBoundsTest, KeepsAnswersThatAreAskedFor) {
  const auto journal = Open();
  using std::chrono::minutes, std::chrono::microseconds, std::chrono::hours;
  ASSERT_TRUE(journal->Write({AnswerOf(1, hours(1) - microseconds(1)), AnswerOf(2, hours(1)),
                              EventOf(3, 3, 500), AnswerOf(4, hours(1) + minutes(10)),
                              EventOf(3, 5, kKept), EventOf(3, 6, 70)}));
  journal->Stored(3, 4);
  EXPECT_THAT(Numbers(), ElementsAre(2, 4, 5, 6));
  journal->Stored(3, 2);  // behind a part of them; they lie where the journal believes
  EXPECT_THAT(Numbers(), ElementsAre(2, 4, 5, 6));
  ASSERT_TRUE(journal->Write({EventOf(3, 7, 90)}));
  journal->Stored(3, 4);
  EXPECT_THAT(Numbers(), ElementsAre(2, 4, 5, 6, 7));
}

TEST_F(JournalBoundsTest, KeepsNoMoreAnswersThanAHostKnows) {
  constexpr auto kAnswers = static_cast<std::int64_t>(AnsweredRequests::kKept);
  std::vector<v1::JournalEntry> entries;
  for (std::int64_t i = 1; i <= kAnswers + 2; ++i)
    entries.push_back(AnswerOf(i, std::chrono::hours(1)));
  entries.push_back(EventOf(3, kAnswers + 3, kKept));
  const auto journal = Open();
  ASSERT_TRUE(journal->Write(entries));
  journal->Stored(3, kAnswers);
  EXPECT_EQ(Numbers().front(), 1);
  EXPECT_EQ(Numbers().size(), entries.size());
  journal->Stored(3, kAnswers + 1);
  EXPECT_EQ(Numbers().front(), 2);
  journal->Stored(3, kAnswers + 2);
  EXPECT_EQ(Numbers().front(), 3);
  EXPECT_EQ(Numbers().back(), kAnswers + 3);
  EXPECT_EQ(static_cast<std::int64_t>(Bytes().size()), journal->bytes());
}

// LIVE-3.24: 64 MiB to the byte.
TEST_F(JournalBoundsTest, IsFullAtItsBound) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(3, 1, kMost - 60)}));
  const Status beyond = journal->Write({EventOf(3, 2, 61)});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kCellJournal);
  EXPECT_EQ(journal->bytes(), kMost - 60);
  EXPECT_TRUE(journal->Write({EventOf(3, 3, 60)}));
  EXPECT_EQ(journal->bytes(), kMost);
  EXPECT_EQ(std::filesystem::file_size(path_), static_cast<std::uintmax_t>(kMost));
}

// LIVE-3.24: marks that have a newer one go where that is enough, wherever they lie; where it is
// not the file stays as it is.
TEST_F(JournalBoundsTest, OldMarksGoWhereThatIsEnough) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({MarkOf(1, kMebibyte), EventOf(3, 2, 200), MarkOf(3, 500),
                              EventOf(3, 4, 300), MarkOf(5, 100)}));
  ASSERT_TRUE(journal->Write({EventOf(3, 6, kMost - journal->bytes())}));
  EXPECT_FALSE(journal->Write({EventOf(3, 7, kMebibyte + 501)}));
  EXPECT_EQ(journal->bytes(), kMost);
  EXPECT_EQ(std::filesystem::file_size(path_), static_cast<std::uintmax_t>(kMost));
  {
    const SmallFiles disk(0);
    EXPECT_THAT(journal->Write({EventOf(3, 7, kMebibyte + 500)}).error().detail,
                HasSubstr(path_ + ".new"));
  }
  EXPECT_TRUE(journal->Write({EventOf(3, 8, kMebibyte + 500)}));
  EXPECT_EQ(journal->bytes(), kMost);
  EXPECT_THAT(Numbers(), ElementsAre(2, 4, 5, 6, 8));
}

// LIVE-3.21: of what does not fit nothing is left, and there is room again when there is.
TEST_F(JournalBoundsTest, AFullDiskLeavesNoHalfRecord) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(3, 1, 100)}));
  {
    const SmallFiles disk(150);
    const Status written = journal->Write({EventOf(3, 2, 60), EventOf(3, 3, 60)});
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kCellJournal);
    EXPECT_THAT(written.error().detail, HasSubstr(path_));
    EXPECT_EQ(journal->bytes(), 100);
    EXPECT_EQ(Bytes().size(), 100U);
    EXPECT_TRUE(journal->Write({EventOf(3, 4, 50)}));
  }
  EXPECT_TRUE(journal->Write({EventOf(3, 5, 70)}));
  EXPECT_THAT(Numbers(), ElementsAre(1, 4, 5));
}

TEST_F(JournalBoundsTest, AFullDiskLeavesTheOldFile) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(3, 1, 100), EventOf(3, 2, kKept), EventOf(3, 3, 100)}));
  {
    const SmallFiles disk(150);
    journal->Stored(3, 1);
    const Status replaced = journal->Replace({EventOf(3, 8, 200)});
    ASSERT_FALSE(replaced);
    EXPECT_EQ(replaced.error().code, ErrorCode::kCellJournal);
    EXPECT_THAT(replaced.error().detail, HasSubstr(".new"));
  }
  EXPECT_TRUE(NothingIsLeftBeside());
  EXPECT_EQ(journal->bytes(), kKept + 200);
  EXPECT_THAT(Numbers(), ElementsAre(1, 2, 3));
  journal->Stored(3, 2);
  EXPECT_THAT(Numbers(), ElementsAre(3));
  EXPECT_TRUE(journal->Replace({EventOf(3, 8, 200), EventOf(3, 9, 60)}));
  EXPECT_TRUE(journal->Write({EventOf(3, 10, 70)}));
  EXPECT_EQ(journal->bytes(), 330);
  EXPECT_THAT(Numbers(), ElementsAre(8, 9, 10));
}

// In the folder where the process is, and as file 0 of a process that has no input.
TEST_F(JournalBoundsTest, LiesWhereItsNameSays) {
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  {
    const NoInput none;
    const auto found = Journal::Open("mill-1.journal");
    EXPECT_TRUE(found && found->journal->Write({EventOf(3, 1, 100)}));
  }
  EXPECT_THAT(Numbers(), ElementsAre(1));
  {
    const auto found = Journal::Open("mill-1.journal");
    const NoInput none;
    EXPECT_TRUE(found && found->journal->Replace({EventOf(3, 2, 100)}));
    EXPECT_TRUE(found && found->journal->Write({EventOf(3, 3, 100)}));
  }
  std::filesystem::current_path(before);
  EXPECT_THAT(Numbers(), ElementsAre(2, 3));
}

// LIVE-3.21: what could not be written is tried again until it is, and the trouble is over then.
TEST_F(JournalBoundsTest, TheWriterTriesAgain) {
  std::counting_semaphore<> told(0);
  {
    JournalWriter writer(Open());
    {
      const SmallFiles disk(50);
      writer.Write({EventOf(3, 1, 100)}, {}, [&] { told.release(); });
      while (!writer.trouble()) std::this_thread::yield();
      EXPECT_EQ(writer.trouble()->code, ErrorCode::kCellJournal);
      EXPECT_FALSE(told.try_acquire());
    }
    told.acquire();
    while (writer.trouble()) std::this_thread::yield();
    EXPECT_THAT(Numbers(), ElementsAre(1));
    writer.Write({EventOf(3, 2, kKept), EventOf(3, 3, 100)}, {}, [&] { told.release(); });
    told.acquire();
    writer.Stored(3, 2);
  }
  EXPECT_THAT(Numbers(), ElementsAre(3));
  EXPECT_FALSE(told.try_acquire());  // each is told once
}

// What a call left in errno long ago says nothing of the end of a file.
TEST_F(JournalBoundsTest, IsReadToItsEndWhateverWentWrongBefore) {
  ASSERT_TRUE(Open()->Write({EventOf(3, 1, 100)}));
  errno = EINTR;
  const auto found = Journal::Open(path_);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->entries.size(), 1U);
  errno = EINTR;
  EXPECT_TRUE(found->journal->Write({EventOf(3, 2, 100)}));
  EXPECT_THAT(Numbers(), ElementsAre(1, 2));
}

// LIVE-3.21: where the new one cannot take its place nothing is left of it, and that is said.
TEST_F(JournalBoundsTest, IsNotReplacedWhereItsNameIsTaken) {
  const auto journal = Open();
  ASSERT_TRUE(journal->Write({EventOf(3, 1, 100)}));
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  const Status replaced = journal->Replace({EventOf(3, 2, 200)});
  ASSERT_FALSE(replaced);
  EXPECT_EQ(replaced.error().code, ErrorCode::kCellJournal);
  EXPECT_TRUE(NothingIsLeftBeside());
  EXPECT_EQ(journal->bytes(), 100);
}

// LIVE-3.25: marks are left out from 10,000 entries on, and then when twice as many and as many
// again have come.
TEST_F(JournalBoundsTest, MarksAreLeftOutWhenThatIsWorthWhile) {
  constexpr std::size_t kMarks = UnstoredEntries::kMarksKept;
  v1::JournalEntry mark;
  mark.set_sequence(1);
  mark.mutable_mark();
  UnstoredEntries unstored;
  unstored.Add(std::vector<v1::JournalEntry>(kMarks - 1, mark));
  EXPECT_EQ(unstored.all().size(), kMarks - 1);
  unstored.Add({mark});
  EXPECT_EQ(unstored.all().size(), 1U);
  unstored.Add(std::vector<v1::JournalEntry>(kMarks, mark));
  EXPECT_EQ(unstored.all().size(), kMarks + 1);
  unstored.Add({mark});
  EXPECT_EQ(unstored.all().size(), 1U);
  unstored.Stored(1);
  EXPECT_TRUE(unstored.empty());
  unstored.Add(std::vector<v1::JournalEntry>(kMarks, mark));  // as at the beginning
  EXPECT_EQ(unstored.all().size(), 1U);
}

// Only those that are there count, not one that was taken off their end.
TEST_F(JournalBoundsTest, AMarkIsOldByOneThatIsThere) {
  std::vector<EntryKind> kinds{EntryKind::kMark, EntryKind::kMark, EntryKind::kOther};
  EXPECT_THAT(OldMarks(kinds), ElementsAre(true, false, false));
  kinds.pop_back();
  kinds.pop_back();
  EXPECT_THAT(OldMarks(kinds), ElementsAre(false));
}

class RecordingFileTest : public JournalBoundsTest {
 protected:
  static MachineRecorder::Fresh Begins(const std::string& bytes) {
    return {.begins = true, .bytes = bytes};
  }
  static MachineRecorder::Fresh More(const std::string& bytes) { return {.bytes = bytes}; }
  bool IsThere() const { return std::filesystem::exists(path_); }
};

// LIVE-3.40: one recording, which another process goes on with, until another one begins.
TEST_F(RecordingFileTest, HoldsTheNewestRecording) {
  {
    RecordingFile file(path_);
    file.Add(More("of no recording"));
    EXPECT_FALSE(IsThere());
    file.Add(Begins("one "));
    file.Add(More("two "));
    file.Add(More("three "));
  }
  EXPECT_EQ(Bytes(), "one two three ");
  RecordingFile next(path_);
  next.Add(More("four"));
  EXPECT_EQ(Bytes(), "one two three four");
  next.Add(Begins("another"));
  EXPECT_EQ(Bytes(), "another");
}

// Half of a recording is none.
TEST_F(RecordingFileTest, IsDroppedWhereItDoesNotFit) {
  RecordingFile file(path_);
  file.Add(Begins("one "));
  {
    const SmallFiles disk(10);
    file.Add(More("does not fit"));
    EXPECT_FALSE(IsThere());
  }
  file.Add(More("behind it"));
  EXPECT_FALSE(IsThere());
  std::ofstream(path_) << "of somebody else";
  file.Add(More("behind it"));
  EXPECT_EQ(Bytes(), "of somebody else");
  file.Add(Begins("another "));
  file.Add(More("one"));
  EXPECT_EQ(Bytes(), "another one");
  file.Drop();
  EXPECT_FALSE(IsThere());
}

// As file 0 of a process that has no input; it is closed again.
TEST_F(RecordingFileTest, MayBeTheFirstFileOfAProcess) {
  const NoInput none;
  {
    RecordingFile file(path_);
    file.Add(Begins("one "));
    file.Add(More("two "));
    std::filesystem::rename(path_, path_ + ".moved");
    file.Add(More("three"));  // the file that is open, and no other one
    EXPECT_FALSE(IsThere());
    file.Add(Begins("another"));
    EXPECT_EQ(Bytes(), "another");
  }
  EXPECT_EQ(::fcntl(STDIN_FILENO, F_GETFD), -1);
  path_ += ".moved";
  EXPECT_EQ(Bytes(), "one two three");
}

}  // namespace
}  // namespace rmlcell::server
