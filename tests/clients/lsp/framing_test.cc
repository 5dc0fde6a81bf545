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

// What is wrong with a header, word by word; what is right stands beside it.
TEST(Framing, TheProblemIsNamed) {
  const auto problem = [](const std::string& header) {
    const std::vector<Frame> frames = Read(header + "\r\n\r\nok", 1000);
    if (frames.empty()) return std::string("no frame");
    return frames[0].problem.empty() ? frames[0].body : frames[0].problem;
  };
  const std::string length = "Content-Length: 2";
  EXPECT_EQ(problem(length), "ok");
  EXPECT_EQ(problem("CONTENT-LENGTH:\t2"), "ok");
  EXPECT_EQ(problem("\r\n" + length + "\r\nOther: x"), "ok");
  EXPECT_EQ(problem(length + "\r\n" + length), "ok");
  EXPECT_EQ(problem("Content-Length: twelve"), "Content-Length is no number");
  EXPECT_EQ(problem("Content-Length: 2x"), "Content-Length is no number");
  EXPECT_EQ(problem("Content-Length:"), "Content-Length is no number");
  EXPECT_EQ(problem("Content-Length: 99999999999999999999"), "Content-Length is no number");
  EXPECT_EQ(problem("Content-Length: 134217729"),
            "a message of 134217729 bytes; at most 134217728 are read");
  EXPECT_EQ(problem(length + "\r\nContent-Length: 3"), "two different Content-Length");
  EXPECT_EQ(problem("Content-Length: 0\r\nContent-Length: 2"), "two different Content-Length");
  EXPECT_EQ(problem("no colon"), "a header line without a colon");
  EXPECT_EQ(problem("Other: x"), "a header without Content-Length");
  EXPECT_EQ(problem("X: " + std::string(kHeaderBytesMax, 'x')), "a header that does not end");
  for (const std::string type : {"application/vscode-jsonrpc", "a; charset=utf-8", "a;charset=UTF8",
                                 "a; CHARSET= utf-8; b", "a; charset=\"UTF-8\"", ""}) {
    EXPECT_EQ(problem(length + "\r\nContent-Type: " + type), "ok") << type;
  }
  for (const std::string type : {"a; charset=utf-16", "a; CHARSET=latin1", "a; charset="}) {
    EXPECT_EQ(problem(length + "\r\nContent-Type: " + type), "a message that is not in UTF-8")
        << type;
  }
}

// Reading goes on at the next mark, even one that begins within another, as often as it must.
TEST(Framing, EachLossFindsTheNextMark) {
  const std::string stream = "x\n\nCContent-LContent-Length: 1\n\na" + Framed("b") +
                             "y\n\nContent-Length: z\n\n" + "Content-Length: 1\n\nc";
  for (const std::size_t piece : {1U, 5U, 1000U}) {
    std::vector<std::string> read;
    for (const Frame& frame : Read(stream, piece))
      read.push_back(frame.problem.empty() ? frame.body : "?");
    EXPECT_EQ(read, (std::vector<std::string>{"?", "a", "b", "?", "?", "c"})) << piece;
  }
}

}  // namespace
}  // namespace rmlcell::lsp
