// Memory of a long program that nobody looks at goes back to the system, and its bytes stay.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>
#include <vector>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/program_stream.h"
#include "proto/bridge/sha256.h"
#include "proto/bridge/spooled_bytes.h"
#include "proto/bridge/ticket.h"

namespace rmlcell::bridge {
namespace {

constexpr std::size_t kThreeMegabytes = 3'000'000;

// Of the mapping that this byte lies in, kB that are in memory; -1: it lies in none.
long ResidentKb(const char* byte) {
  std::ifstream maps("/proc/self/smaps");
  bool inside = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    char dash = 0;
    std::istringstream range(line);
    if (range >> std::hex >> begin >> dash >> end && dash == '-')
      inside = reinterpret_cast<std::uintptr_t>(byte) >= begin &&
               reinterpret_cast<std::uintptr_t>(byte) < end;
    if (inside && line.starts_with("Rss:")) return std::stol(line.substr(4));
  }
  return -1;
}

std::string Letters() {
  std::string text(kThreeMegabytes, 'a');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
  return text;
}

void ExpectGivenBack(const machine::Bytes& bytes, const std::string& text) {
  ASSERT_TRUE(*bytes == text);  // it is all looked at
  EXPECT_GE(ResidentKb(bytes->data()), static_cast<long>(kThreeMegabytes / 1024));
  bytes.Release();
  EXPECT_EQ(ResidentKb(bytes->data()), 0);
  EXPECT_TRUE(*bytes == text);
}

TEST(GivenBack, WhatWasSpooled) {
  const std::string text = Letters();
  SpooledBytes spooled;
  spooled.append(text);
  ExpectGivenBack(spooled.Finish(), text);
}

TEST(GivenBack, WhatIsReadAsItComes) {
  const std::string text = Letters();
  const std::string path = testing::TempDir() + "given_back." + std::to_string(::getpid());
  std::ofstream(path, std::ios::binary) << text;
  auto opened = ProgramStream::Open(path, std::int64_t{1} << 22, nullptr);
  ASSERT_TRUE(opened);
  ASSERT_NE(opened->stream, nullptr);
  opened->bytes.ReadAll();
  ExpectGivenBack(opened->bytes, text);
  std::filesystem::remove(path);
}

// LIVE-5.02: the digest of a program is made of all its bytes, and keeps none of them in memory.
TEST(GivenBack, WhatADigestWasMadeOf) {
  const std::string text = Letters();
  SpooledBytes spooled;
  spooled.append(text);
  std::map<int, machine::StoredProgram> stored;
  stored[10].object = spooled.Finish();
  const machine::MachineFamily& family = *families::FindFamily("rml1");
  const machine::Parameters parameters = *machine::MakeParameters(family, "", {});
  const std::map<std::string, std::string> digests = DigestsOf({.family = family,
                                                                .parameters = parameters,
                                                                .programs = stored,
                                                                .schedules = {},
                                                                .main_program = 10});
  EXPECT_EQ(digests.at("program"), BytesOfHex(Sha256Hex(text)).value_or("none"));
  EXPECT_EQ(ResidentKb(stored[10].object->data()), 0);
}

// Where nobody has the bytes any more there is no memory of them at all.
TEST(GivenBack, WhatNobodyHasAnyMore) {
  const std::string text = Letters();
  const std::string path = testing::TempDir() + "nobody_has." + std::to_string(::getpid());
  std::ofstream(path, std::ios::binary) << text;
  const char* begin = nullptr;
  {
    SpooledBytes spooled;
    spooled.append(text);
    const machine::Bytes bytes = spooled.Finish();
    begin = bytes->data();
    EXPECT_GE(ResidentKb(begin), 0);
  }
  EXPECT_EQ(ResidentKb(begin), -1);
  {
    auto opened = ProgramStream::Open(path, std::int64_t{1} << 22, nullptr);
    ASSERT_TRUE(opened);
    begin = opened->bytes->data();
    EXPECT_GE(ResidentKb(begin), 0);
  }
  EXPECT_EQ(ResidentKb(begin), -1);
  std::filesystem::remove(path);
}

// The program that comes through a pipe in these parts, each of which waits until the one before it
// was taken.
Result<ProgramStream::Opened> OpenedInParts(const std::vector<std::string>& parts) {
  const std::string path = testing::TempDir() + "slow_pipe." + std::to_string(::getpid());
  std::filesystem::remove(path);
  EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] {
    const int pipe = ::open(path.c_str(), O_WRONLY);
    for (const std::string& part : parts) {
      for (int left = 1; left > 0 && ::ioctl(pipe, FIONREAD, &left) == 0;)
        std::this_thread::yield();
      EXPECT_EQ(::write(pipe, part.data(), part.size()), static_cast<ssize_t>(part.size()));
    }
    ::close(pipe);
  });
  auto opened = ProgramStream::Open(path, 100'000, nullptr);
  writer.join();
  std::filesystem::remove(path);
  return opened;
}

// They stand one behind the other, and at first no more is read than a beginning.
TEST(SlowPipe, ComesInPartsAndIsWhole) {
  const auto brief = OpenedInParts({"12345", "678", "90"});
  ASSERT_TRUE(brief);
  EXPECT_EQ(*brief->bytes, "1234567890");
  const std::string rest(40'000, ';');
  auto longer = OpenedInParts({"12345", rest});
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->bytes->size(), ProgramStream::kBeginning);
  longer->bytes.ReadAll();
  EXPECT_TRUE(*longer->bytes == "12345" + rest);
}

}  // namespace
}  // namespace rmlcell::bridge
