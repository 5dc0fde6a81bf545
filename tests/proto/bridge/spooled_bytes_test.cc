#include "proto/bridge/spooled_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/proto/bridge/small_files.h"

namespace rmlcell::bridge {
namespace {

// Bytes of which no megabyte is like another.
std::string Numbered(std::size_t size) {
  std::string text;
  for (std::uint64_t n = 0; text.size() < size; ++n) text += std::to_string(n) + ';';
  text.resize(size);
  return text;
}

machine::Bytes Spooled(const std::string& text, std::size_t part) {
  SpooledBytes spooled;
  for (std::size_t at = 0; at < text.size(); at += part) {
    spooled.append(text.substr(at, part));
    EXPECT_EQ(spooled.size(), static_cast<std::int64_t>(std::min(at + part, text.size())));
  }
  return spooled.Finish();
}

// Below, at and above a megabyte, in parts that fit it and that do not.
TEST(SpooledBytes, GiveBackWhatCame) {
  for (const std::size_t size : {0U, 1U, 1'048'575U, 1'048'576U, 1'048'577U, 3'000'000U}) {
    const std::string text = Numbered(size);
    for (const std::size_t part : {65'536U, 1'000'003U, 4'000'000U}) {
      const machine::Bytes bytes = Spooled(text, part);
      ASSERT_TRUE(bytes) << size;
      EXPECT_TRUE(*bytes == text) << size << " in parts of " << part;
      bytes.Release();
      EXPECT_TRUE(*bytes == text) << size << " once more";
    }
  }
}

// While they grow: from the file, from memory, and up to where the one ends and the other begins.
TEST(SpooledBytes, GivePartsOfWhatIsThere) {
  const std::string text = Numbered(2'500'000);
  SpooledBytes spooled;
  EXPECT_EQ(*spooled.Part(0, 10), "");
  spooled.append(text.substr(0, 600'000));
  EXPECT_EQ(*spooled.Part(599'990, 100), text.substr(599'990, 10));
  spooled.append(text.substr(600'000));
  std::string together;
  while (together.size() < text.size()) {
    const std::string part = *spooled.Part(static_cast<std::int64_t>(together.size()), 300'007);
    ASSERT_FALSE(part.empty());
    ASSERT_LE(part.size(), 300'007U);
    together += part;
  }
  EXPECT_TRUE(together == text);
  EXPECT_EQ(*spooled.Part(2'500'000, 1), "");
  EXPECT_EQ(*spooled.Part(9'000'000, 1), "");
  EXPECT_TRUE(*spooled.Finish() == text);  // what was looked at is still there
}

TEST(SpooledBytes, BeginAnew) {
  SpooledBytes spooled;
  spooled.append(Numbered(2'000'000));
  const machine::Bytes first = spooled.Finish();
  EXPECT_EQ(spooled.size(), 0);
  spooled.append("second");
  EXPECT_EQ(*spooled.Finish(), "second");
  EXPECT_TRUE(*first == Numbered(2'000'000));
  // Also with one that needs a file: it is another file.
  const std::string large = Numbered(3'000'000).substr(500'000);
  spooled.append(large);
  EXPECT_TRUE(*spooled.Finish() == large);
  EXPECT_TRUE(*first == Numbered(2'000'000));
}

class NoTemporaryFolder : public testing::Test {
 protected:
  NoTemporaryFolder() { ::setenv("TMPDIR", "/nowhere/at/all", 1); }
  ~NoTemporaryFolder() override { ::unsetenv("TMPDIR"); }
};

TEST_F(NoTemporaryFolder, ThenTheyStayInMemory) {
  EXPECT_TRUE(*Spooled(Numbered(3'000'000), 65'536) == Numbered(3'000'000));
}

// A file may not grow above 2 MiB here: what is in it comes back into memory, also when it is the
// last bytes that find no room.
TEST(SpooledBytes, AFullDiskLosesNothing) {
  for (const std::size_t size : {5'000'000U, 2'500'000U}) {
    const std::string text = Numbered(size);
    machine::Bytes bytes;
    {
      const SmallFiles small(rlim_t{2} << 20);
      bytes = Spooled(text, 65'536);
    }
    EXPECT_TRUE(*bytes == text) << size;
  }
}

// Of the files without a name of this process the one that has so many bytes; -1: there is none.
int NamelessFileOf(off_t size) {
  for (int file = 3; file < 1024; ++file) {
    struct stat about {};
    if (::fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_nlink == 0 &&
        about.st_size == size)
      return file;
  }
  return -1;
}

// A part that the file does not give any more is an error, and never other bytes, or fewer.
TEST(SpooledBytes, APartThatCannotBeReadIsTold) {
  SpooledBytes spooled;
  spooled.append(std::string(2'500'000, 'x'));  // two megabytes of them lie in a file
  const int file = NamelessFileOf(off_t{2} << 20);
  ASSERT_GE(file, 0);
  ASSERT_EQ(::ftruncate(file, 1000), 0);
  EXPECT_EQ(*spooled.Part(0, 1000), std::string(1000, 'x'));
  const auto beyond = spooled.Part(0, 1001);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(std::string(beyond.error().detail), "a file of the temporary folder");
  EXPECT_EQ(*spooled.Part(std::int64_t{2} << 20, 5), "xxxxx");  // those are in memory
}

// What came back into memory takes no room of the full disk.
TEST(SpooledBytes, AFullDiskHasItsRoomBack) {
  const SmallFiles small(rlim_t{2} << 20);
  SpooledBytes spooled;
  spooled.append(std::string(2'500'000, 'x'));
  EXPECT_GE(NamelessFileOf(off_t{2} << 20), 0);
  spooled.append(std::string(2'500'000, 'x'));
  EXPECT_EQ(NamelessFileOf(off_t{2} << 20), -1);
  EXPECT_EQ(spooled.size(), 5'000'000);
}

TEST(ReadProgram, SaysWhatItCannotRead) {
  EXPECT_EQ(ReadProgram("/nowhere/a.rml", 10).error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(ReadProgram("/", 10).error().code, ErrorCode::kCellFileUnreadable);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "read_program.rml";
  std::ofstream(file) << "PU;PD1,1;PU";
  EXPECT_EQ(**ReadProgram(file, 11), "PU;PD1,1;PU");
  EXPECT_EQ(ReadProgram(file, 10).error().code, ErrorCode::kCellTooLarge);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace rmlcell::bridge
