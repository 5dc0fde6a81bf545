#include "clients/lsp/framing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rmlcell::lsp {
namespace {

std::vector<Frame> Read(std::string_view bytes, std::size_t piece) {
  MessageReader reader;
  std::vector<Frame> frames;
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    reader.Feed(bytes.substr(at, piece), frames);
  return frames;
}

TEST(Framing, BodiesAreCutHoweverTheBytesArrive) {
  const std::string stream = Framed("{}") + Framed("{\"a\":1}") + Framed("[]");
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 1000U}) {
    const std::vector<Frame> frames = Read(stream, piece);
    ASSERT_EQ(frames.size(), 3U) << piece;
    EXPECT_EQ(frames[0].body, "{}");
    EXPECT_EQ(frames[1].body, "{\"a\":1}");
    EXPECT_EQ(frames[2].body, "[]");
  }
}

TEST(Framing, TheHeaderIsReadWithoutCaseAndInAnyOrder) {
  const auto frames = Read(
      "Content-Type: application/vscode-jsonrpc; charset=utf8\r\ncontent-length:  2 \r\n\r\nok", 9);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].body, "ok");
}

TEST(Framing, LengthCountsBytesNotCharacters) {
  const auto frames = Read("Content-Length: 4\r\n\r\n\xC3\xA4\xC3\xB6" + Framed("x"), 1000);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].body, "\xC3\xA4\xC3\xB6");
  EXPECT_EQ(frames[1].body, "x");
}

TEST(Framing, ABodyOfNoBytesIsABody) {
  const auto frames = Read("Content-Length: 0\r\n\r\n" + Framed("x"), 1000);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].body, "");
  EXPECT_EQ(frames[0].problem, "");
}

// One broken message costs itself and no other.
TEST(Framing, WhatIsNoHeaderIsToldOnceAndReadingGoesOnBehindIt) {
  for (const char* broken :
       {"nonsense without end", "Content-Length: twelve\r\n\r\n{}", "Content-Length: -1\r\n\r\n",
        "Content-Length: 99999999999999999999\r\n\r\nxx", "Content-Length: 1099511627776\r\n\r\nxx",
        "Content-Type: text/plain\r\n\r\n{}", "no colon\r\n\r\n",
        "Content-Length: 2\r\nContent-Length: 3\r\n\r\nab",
        "Content-Length: 2\r\nContent-Type: text; charset=utf-16\r\n\r\nab"}) {
    std::string stream = broken;
    stream.append(kHeaderBytesMax, 'C');  // ends every header that has no end
    stream += Framed("{}");
    for (const std::size_t piece : {1U, 13U, 100000U}) {
      const std::vector<Frame> frames = Read(stream, piece);
      ASSERT_EQ(frames.size(), 2U) << broken << " in pieces of " << piece;
      EXPECT_NE(frames[0].problem, "") << broken;
      EXPECT_EQ(frames[1].body, "{}") << broken;
    }
  }
}

TEST(Framing, AHeaderOfTheLargestLengthIsReadAndOneByteMoreIsNot) {
  const std::string name = "Content-Length: 1\r\nX: ";
  const auto stream = [&](std::size_t header) {
    return name + std::string(header - name.size() - 4, 'x') + "\r\n\r\ny";
  };
  EXPECT_EQ(Read(stream(kHeaderBytesMax), 512)[0].body, "y");
  EXPECT_NE(Read(stream(kHeaderBytesMax + 1), 512)[0].problem, "");
}

TEST(Framing, ALengthBeyondTheLargestTakesNoMemory) {
  MessageReader reader;
  std::vector<Frame> frames;
  reader.Feed("Content-Length: " + std::to_string(kMessageBytesMax) + "\r\n\r\n", frames);
  EXPECT_TRUE(frames.empty());  // the largest is waited for
  frames = Read("Content-Length: " + std::to_string(kMessageBytesMax + 1) + "\r\n\r\n", 1000);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_THAT(frames[0].problem, testing::HasSubstr("at most"));
}

}  // namespace
}  // namespace rmlcell::lsp
