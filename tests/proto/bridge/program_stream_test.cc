#include "proto/bridge/program_stream.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/proto/bridge/small_files.h"

namespace rmlcell::bridge {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLimit = std::int64_t{1} << 22;

class ProgramStreamTest : public testing::Test {
 protected:
  ProgramStreamTest()
      : folder_(testing::TempDir() + "program_stream." + std::to_string(::getpid())) {
    fs::create_directories(folder_);
  }
  ~ProgramStreamTest() override { fs::remove_all(folder_); }

  static std::string Numbered(std::size_t size) {
    std::string text;
    for (std::uint64_t n = 0; text.size() < size; ++n) text += std::to_string(n) + ';';
    text.resize(size);
    return text;
  }
  std::string File(const std::string& text) {
    std::ofstream(folder_ + "/a", std::ios::binary) << text;
    return folder_ + "/a";
  }
  ProgramStream::Opened Open(const std::string& path) {
    auto opened = ProgramStream::Open(path, kLimit, [this] { ++waits_; });
    EXPECT_TRUE(opened) << opened.error().detail;
    return *std::move(opened);
  }

  const std::string folder_;
  int waits_ = 0;
};

TEST_F(ProgramStreamTest, AShortOneIsWhole) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, ProgramStream::kBeginning - 1}) {
    const std::string text = Numbered(size);
    const ProgramStream::Opened opened = Open(File(text));
    EXPECT_EQ(opened.stream, nullptr);
    EXPECT_TRUE(opened.bytes.whole());
    EXPECT_TRUE(*opened.bytes == text);
  }
}

TEST_F(ProgramStreamTest, ALongOneIsReadOn) {
  const std::string text = Numbered(1'000'000);
  ProgramStream::Opened opened = Open(File(text));
  ASSERT_NE(opened.stream, nullptr);
  machine::Bytes again = opened.bytes;
  const char* const begin = opened.bytes->data();
  EXPECT_EQ(opened.bytes->size(), ProgramStream::kBeginning);
  EXPECT_FALSE(opened.bytes.whole());
  opened.bytes.ReadOn(100'000);
  EXPECT_GE(opened.bytes->size(), 100'000U);
  EXPECT_LT(opened.bytes->size(), 200'000U);
  opened.bytes.Release();
  opened.bytes.ReadAll();
  EXPECT_TRUE(opened.bytes.whole());
  EXPECT_TRUE(*opened.bytes == text);
  EXPECT_EQ(opened.bytes->data(), begin);  // it stays where it was
  EXPECT_FALSE(again.whole());             // that is not known there yet
  again.ReadAll();
  EXPECT_TRUE(*again == text);
  EXPECT_TRUE(opened.stream->status());
  EXPECT_EQ(waits_, 0);
}

// Whoever asks for one byte more gets one part of it more, of 16 KiB.
TEST_F(ProgramStreamTest, ItIsReadOnInParts) {
  constexpr std::size_t kPart = 16'384;
  ProgramStream::Opened opened = Open(File(Numbered(200'000)));
  for (std::size_t parts = 1; parts <= 3; ++parts) {
    opened.bytes.ReadOn(opened.bytes->size() + 1);
    EXPECT_EQ(opened.bytes->size(), ProgramStream::kBeginning + parts * kPart);
  }
}

// What comes from a pipe is there before the rest of it is written.
TEST_F(ProgramStreamTest, APipeIsWaitedFor) {
  const std::string path = folder_ + "/pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const std::string text = Numbered(50'000);
  std::thread writer([&] {
    std::ofstream pipe(path, std::ios::binary);
    pipe << text.substr(0, 40'000) << std::flush;
    std::ifstream answer(folder_ + "/answer");  // a pipe, too: until the test has seen that
    std::string word;
    answer >> word;
    pipe << text.substr(40'000);
  });
  ASSERT_EQ(::mkfifo((folder_ + "/answer").c_str(), 0600), 0);
  ProgramStream::Opened opened = Open(path);
  opened.bytes.ReadOn(40'000);
  EXPECT_EQ(opened.bytes->size(), 40'000U);
  EXPECT_FALSE(opened.bytes.whole());
  std::ofstream(folder_ + "/answer") << "go on";
  opened.bytes.ReadAll();
  EXPECT_TRUE(*opened.bytes == text);
  writer.join();
}

TEST_F(ProgramStreamTest, APipeMayBeginWithASingleByte) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  const std::string text = "IN;PU;";
  ASSERT_EQ(::write(ends[1], text.data(), 1), 1);
  std::thread writer([&] {
    for (int there = 1; there > 0; std::this_thread::yield())
      EXPECT_EQ(::ioctl(ends[0], FIONREAD, &there), 0);
    EXPECT_EQ(::write(ends[1], text.data() + 1, text.size() - 1),
              static_cast<ssize_t>(text.size() - 1));
    ::close(ends[1]);
  });
  const ProgramStream::Opened opened = Open("/proc/self/fd/" + std::to_string(ends[0]));
  EXPECT_TRUE(*opened.bytes == text);
  writer.join();
  ::close(ends[0]);
}

TEST_F(ProgramStreamTest, WhatCannotBeReadIsTold) {
  const auto refused = [](const std::string& path, std::int64_t limit) {
    const auto opened = ProgramStream::Open(path, limit, nullptr);
    return opened ? std::string() : CodeText(opened.error().code) + " " + opened.error().detail;
  };
  EXPECT_EQ(refused(folder_ + "/none", kLimit), "CELL-E9022 " + folder_ + "/none");
  EXPECT_EQ(refused(folder_, kLimit), "CELL-E9022 " + folder_ + " is a directory");
  EXPECT_EQ(refused(File("12345"), 4), "CELL-E9007 " + folder_ + "/a is larger than 4 bytes");
  EXPECT_EQ(refused(File("12345"), 5), "");
  // Of a long one it is seen where it is.
  auto opened = ProgramStream::Open(File(Numbered(200'000)), 100'000, nullptr);
  ASSERT_TRUE(opened);
  opened->bytes.ReadAll();
  EXPECT_TRUE(opened->bytes.whole());
  ASSERT_FALSE(opened->stream->status());
  EXPECT_EQ(opened->stream->status().error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(opened->stream->status().error().detail, folder_ + "/a is larger than 100000 bytes");
  const std::string text = Numbered(100'000);
  opened = ProgramStream::Open(File(text), 100'000, nullptr);
  ASSERT_TRUE(opened);
  opened->bytes.ReadAll();
  EXPECT_TRUE(opened->stream->status());
  EXPECT_TRUE(*opened->bytes == text);
}

// What was told so far is to be seen before somebody waits for more.
TEST_F(ProgramStreamTest, BeforeItWaitsItSaysSo) {
  const std::string path = folder_ + "/pipe";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const std::string text = Numbered(50'000);
  const int pipe = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(pipe, 0);
  const auto put = [&](std::size_t begin, std::size_t end) {
    EXPECT_EQ(::write(pipe, text.data() + begin, end - begin), static_cast<ssize_t>(end - begin));
  };
  put(0, 40'000);
  int waits = 0;
  auto opened = ProgramStream::Open(path, kLimit, [&] {
    if (++waits > 1) return;
    put(40'000, 50'000);
    ::close(pipe);
  });
  ASSERT_TRUE(opened);
  opened->bytes.ReadOn(40'000);
  EXPECT_EQ(opened->bytes->size(), 40'000U);
  EXPECT_EQ(waits, 0);
  opened->bytes.ReadAll();
  EXPECT_TRUE(*opened->bytes == text);
  EXPECT_EQ(waits, 1);
}

// What errno says of an earlier call is nothing of a file that ends.
TEST_F(ProgramStreamTest, ItsEndIsItsEnd) {
  const std::string path = File("12345");
  errno = EINTR;
  EXPECT_EQ(*Open(path).bytes, "12345");
}

// Without room for a file it is read as any other program.
TEST_F(ProgramStreamTest, WithoutATemporaryFolderItIsWhole) {
  const std::string text = Numbered(100'000);
  const std::string path = File(text);
  ::setenv("TMPDIR", "/nowhere/at/all", 1);
  const auto opened = ProgramStream::Open(path, 100'000, nullptr);
  const auto refused = ProgramStream::Open(path, 99'999, nullptr);
  ::unsetenv("TMPDIR");
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->stream, nullptr);
  EXPECT_TRUE(opened->bytes.whole());
  EXPECT_TRUE(*opened->bytes == text);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellTooLarge);
}

// No room for the beginning, or for all that may come: as without a folder.
TEST_F(ProgramStreamTest, WithoutRoomForAllThatMayComeItIsWhole) {
  const std::string text = Numbered(100'000);
  const std::string path = File(text);
  const auto on_a_full_disk = [&] {
    const SmallFiles small(10'000);
    return ProgramStream::Open(path, kLimit, nullptr);
  };
  const auto without_limit = [&] {
    return ProgramStream::Open(path, std::numeric_limits<std::int64_t>::max(), nullptr);
  };
  for (const auto& opened : {on_a_full_disk(), without_limit()}) {
    ASSERT_TRUE(opened) << opened.error().detail;
    EXPECT_EQ(opened->stream, nullptr);
    EXPECT_TRUE(opened->bytes.whole());
    EXPECT_TRUE(*opened->bytes == text);
  }
}

// Later it ends there, and says why.
TEST_F(ProgramStreamTest, AFullDiskEndsIt) {
  ProgramStream::Opened opened = Open(File(Numbered(100'000)));
  ASSERT_NE(opened.stream, nullptr);
  {
    const SmallFiles small(40'000);
    opened.bytes.ReadAll();
  }
  EXPECT_TRUE(opened.bytes.whole());
  EXPECT_EQ(opened.bytes->size(), ProgramStream::kBeginning);
  ASSERT_FALSE(opened.stream->status());
  EXPECT_EQ(opened.stream->status().error().code, ErrorCode::kCellFileUnwritable);
  EXPECT_EQ(std::string(opened.stream->status().error().detail), "the temporary folder is full");
}

// And so does what cannot be read on: a folder stands in the place of the file by then.
TEST_F(ProgramStreamTest, WhatCannotBeReadOnIsTold) {
  const std::string path = File(Numbered(100'000));
  ProgramStream::Opened opened = Open(path);
  ASSERT_NE(opened.stream, nullptr);
  struct stat wanted {};
  ASSERT_EQ(::stat(path.c_str(), &wanted), 0);
  int file = 3;
  for (; file < 1024; ++file) {
    struct stat about {};
    if (::fstat(file, &about) == 0 && about.st_dev == wanted.st_dev &&
        about.st_ino == wanted.st_ino)
      break;
  }
  ASSERT_LT(file, 1024);
  const int folder = ::open(folder_.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_GE(folder, 0);
  EXPECT_EQ(::dup2(folder, file), file);
  ::close(folder);
  opened.bytes.ReadAll();
  EXPECT_TRUE(opened.bytes.whole());
  EXPECT_EQ(opened.bytes->size(), ProgramStream::kBeginning);
  ASSERT_FALSE(opened.stream->status());
  EXPECT_EQ(opened.stream->status().error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(std::string(opened.stream->status().error().detail), path);
}

// Also where a single byte is left: it does not seem to be whole without it.
TEST_F(ProgramStreamTest, AFullDiskEndsItBeforeItsLastByte) {
  ProgramStream::Opened opened = Open(File(Numbered(ProgramStream::kBeginning + 1)));
  ASSERT_NE(opened.stream, nullptr);
  {
    const SmallFiles small(ProgramStream::kBeginning);
    opened.bytes.ReadAll();
  }
  EXPECT_EQ(opened.bytes->size(), ProgramStream::kBeginning);
  ASSERT_FALSE(opened.stream->status());
  EXPECT_EQ(opened.stream->status().error().code, ErrorCode::kCellFileUnwritable);
}

}  // namespace
}  // namespace rmlcell::bridge
