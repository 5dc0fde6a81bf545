// What all tools for streams have in common.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "engine/machine/program_file.h"
#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/stream_diff.h"
#include "engine/rml1/offline/work_check.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// A machine that cannot be is told, and not taken for another one.
TEST(StreamTools, AMachineThatCannotBe) {
  machine::Parameters wrong = ParametersOf("t1");
  ASSERT_TRUE(wrong.Set("X_MIN", 300.0));
  const auto code = [](const auto& made) {
    return made ? ErrorCode::kCellUsage : made.error().code;
  };
  constexpr ErrorCode kRange = ErrorCode::kCellParameterRange;
  EXPECT_EQ(code(Explain("PU;", wrong, [](const ExplainedPhrase&) { return true; })), kRange);
  EXPECT_EQ(code(MoveStream("PU;", wrong, {1, 0, 0})), kRange);
  EXPECT_EQ(code(ScaleStream("PU;", wrong, 40, 100)), kRange);
  EXPECT_EQ(code(CompareStreams({.object = "PU;"}, {.object = "PD;"}, wrong)), kRange);
  EXPECT_EQ(code(TileStream("PU;", wrong, {})), kRange);
  EXPECT_EQ(code(ToGcode("PU;", wrong)), kRange);
  EXPECT_EQ(code(FromGcode("G0 X1\n", wrong)), kRange);
}

// RML1-E8007: prose is no stream, and nothing has no bytes.
TEST(StreamTools, WhatIsNoStream) {
  const machine::Parameters t1 = ParametersOf("t1");
  const auto code = [](const auto& made) {
    return made ? ErrorCode::kCellUsage : made.error().code;
  };
  const std::string prose(300, '$');
  EXPECT_EQ(code(MoveStream(prose, t1, {1, 0, 0})), ErrorCode::kRml1NoProgram);
  EXPECT_EQ(code(ScaleStream(prose, t1, 40, 100)), ErrorCode::kRml1NoProgram);
  EXPECT_EQ(code(TileStream(prose, t1, {})), ErrorCode::kRml1NoProgram);
  EXPECT_EQ(code(ToGcode(prose, t1)), ErrorCode::kRml1NoProgram);
  // A tenth of the bytes may be foreign: 30 of 300.
  std::string stream;
  for (int i = 0; i < 90; ++i) stream += "PU;";
  EXPECT_EQ(code(ScaleStream(stream + std::string(30, '$'), t1, 40, 100)), ErrorCode::kCellUsage);
  EXPECT_EQ(code(ScaleStream(stream + std::string(31, '$'), t1, 40, 100)),
            ErrorCode::kRml1NoProgram);
  EXPECT_EQ(code(MoveStream("", t1, {1, 0, 0})), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(code(ScaleStream("", t1, 40, 100)), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(code(ToGcode("", t1)), ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(code(FromGcode("", t1)), ErrorCode::kCellEmptyProgram);
}

// So many findings are told; the next ones are counted, and of G-code that is wrong no more is read
// then.
TEST(StreamTools, FindingsHaveABound) {
  std::string stream;
  std::string text;
  for (std::size_t i = 0; i < machine::kDiagnosticsMax + 5; ++i) {
    stream += "PU1;";
    text += "G99\n";
  }
  const auto gcode = ToGcode(stream, ParametersOf("t1"));
  ASSERT_TRUE(gcode);
  EXPECT_EQ(gcode->findings.size(), machine::kDiagnosticsMax);
  EXPECT_EQ(gcode->findings_dropped.count(), 5U);
  const auto made = FromGcode(text, ParametersOf("t1"));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->findings.size(), machine::kDiagnosticsMax);
  EXPECT_EQ(made->findings_dropped.count(), 1U);
}

class Counting final : public machine::BytesKeeper {
 public:
  void Release() const override { ++releases; }
  mutable int releases = 0;
};

// Whatever is read of a long text need not stay in memory: about every so many bytes it is
// released, and no more often.
TEST(StreamTools, ReleaseWhatTheyHaveRead) {
  constexpr int kParts = 6;
  const auto releases = [](std::string_view line, const auto& tool) {
    std::string text;
    while (text.size() < kParts * machine::kReleaseEvery) text += line;
    const auto keeper = std::make_shared<Counting>();
    tool(machine::Bytes(keeper, text));
    return keeper->releases;
  };
  const machine::Parameters t1 = ParametersOf("t1");
  const ByteSink nowhere = [](std::string_view) {};
  constexpr std::string_view kStream =
      "PD1,1;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;;\n";
  EXPECT_NEAR(
      releases("(a comment that fills a line of a program in G-code, and no more)\n",
               [&](const machine::Bytes& text) { EXPECT_TRUE(FromGcode(text, t1, {}, nowhere)); }),
      kParts, 1);
  EXPECT_NEAR(
      releases(kStream, [&](const machine::Bytes& text) { EXPECT_TRUE(CheckWork(text, t1)); }),
      kParts, 1);
  // Read once, and then copied.
  EXPECT_NEAR(releases(kStream,
                       [&](const machine::Bytes& text) {
                         EXPECT_TRUE(MoveStream(text, t1, {0, 0, 0}, nowhere));
                       }),
              2 * kParts, 2);
  EXPECT_NEAR(
      releases(kStream,
               [&](const machine::Bytes& text) { EXPECT_TRUE(TileStream(text, t1, {}, nowhere)); }),
      2 * kParts, 3);
}

}  // namespace
}  // namespace rmlcell::rml1
