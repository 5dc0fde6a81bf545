// What is too much is refused as a wrong argument, on both sides of each bound.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "proto/bridge/program_stream.h"
#include "proto/bridge/setup.h"

namespace rmlcell::bridge {
namespace {

TEST(ExpandedVariables, AThousandAreTheMost) {
  EXPECT_EQ(ExpandVariables({"VR[0..998]", "A"})->size(), 1'000U);
  const auto more = ExpandVariables({"VR[0..999]", "A"});
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kCellInvalidArgument);
  const auto wrong = ExpandVariables({"VR[3..2]"});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kCellInvalidArgument);
}

// How a pipe with so many bytes ends for one that takes 80,000.
Status EndOfPipe(std::size_t size) {
  const std::string path = testing::TempDir() + "limited_pipe." + std::to_string(::getpid());
  std::filesystem::remove(path);
  EXPECT_EQ(::mkfifo(path.c_str(), S_IRUSR | S_IWUSR), 0);
  std::thread writer([&] { std::ofstream(path, std::ios::binary) << std::string(size, ';'); });
  Status status;
  if (auto opened = ProgramStream::Open(path, 80'000, {}); !opened) {
    status = opened.error();
  } else if (opened->stream != nullptr) {
    static_cast<void>(opened->stream->ReadOn({}, size + 1));
    status = opened->stream->status();
  }
  writer.join();
  std::filesystem::remove(path);
  return status;
}

// CellTooLarge with the first byte behind the limit, whatever part of the pipe it comes in.
TEST(LimitedPipe, TakesItsLimitAndNoByteMore) {
  EXPECT_TRUE(EndOfPipe(80'000));
  const Status larger = EndOfPipe(80'001);
  ASSERT_FALSE(larger);
  EXPECT_EQ(larger.error().code, ErrorCode::kCellTooLarge);
}

}  // namespace
}  // namespace rmlcell::bridge
