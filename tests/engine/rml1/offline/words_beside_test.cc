// Words that stand beside others, numbers one unit beside a bound, and what is
// told first.
#include <gtest/gtest.h>

#include <string>

#include "engine/rml1/offline/gcode_reader.h"
#include "engine/rml1/offline/stream_copy.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

StreamOfGcode StreamFrom(const std::string& text, const machine::Parameters& parameters) {
  return FromGcode(text, parameters, {}).value();
}

// docs/gcode.md: a word that changes nothing here, or only what comes later,
// stops no motion of its line.
TEST(WordsBeside, AMotionIsObeyedBesideEachOfThem) {
  for (const char* word : {"G17", "G18", "G19", "G21", "G90",   "G91.1", "G94",    "G40", "G49",
                           "G54", "G61", "G64", "G80", "M3",    "M5",    "M6",     "M7",  "M9",
                           "M0",  "M2",  "T1",  "F60", "S6000", "N5",    "G43 H1", "(a)"}) {
    const StreamOfGcode made = StreamFrom(std::string(word) + "G0 X7 (b)Y5\n", ParametersOf("t1"));
    EXPECT_TRUE(made.ok) << word;
    EXPECT_NE(made.stream.find("PU700,500;"), std::string::npos) << word << '\n' << made.stream;
  }
}

// A line ends with CR LF also where the text does, and what was written twice
// is told alone.
TEST(WordsBeside, TheLastLineAndALetterAlone) {
  GcodeReader reader("G0\r\n");
  EXPECT_TRUE(reader.Next());
  EXPECT_EQ(reader.offset(), 4U);
  EXPECT_FALSE(reader.Next());
  const StreamOfGcode twice = StreamFrom("G0 X1 X2\n", ParametersOf("t1"));
  ASSERT_EQ(twice.findings.size(), 1U);
  EXPECT_EQ(twice.findings[0].detail, "X twice in one line");
}

// rewrite.h: what cannot be followed is told where it stands, whatever comes
// behind it.
TEST(WordsBeside, WhatIsRefusedFirstIsTold) {
  const std::string stream = "PD1;" + std::string(300, '$');
  const auto moved = MoveStream(stream, ParametersOf("t1"), {1, 2, 0});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::kRml1NotRewritten);
  const auto scaled = ScaleStream(stream, ParametersOf("t1"), 40, 100);
  ASSERT_FALSE(scaled);
  EXPECT_EQ(scaled.error().code, ErrorCode::kRml1NotRewritten);
}

// stream_copy.h: places come in ascending order; what stands before one that
// was copied is refused, and is not copied either.
TEST(WordsBeside, PlacesComeInAscendingOrder) {
  const std::string stream(300, ';');
  const machine::Bytes bytes = machine::Bytes::Borrowed(stream);
  std::size_t copied = 0;
  const ByteSink sink = [&](std::string_view part) { copied += part.size(); };
  StreamCopy copy(bytes, 100, sink);
  copy.Insert(99, std::string(200'000, 'x'));
  const Status finished = copy.Finish(300);
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, ErrorCode::kRml1NotRewritten);
  EXPECT_EQ(finished.error().where, (SourceSpan{1, 100, 1, 99}));
  EXPECT_EQ(copied, 0U);
  StreamCopy level(bytes, 100, sink);
  level.Insert(100, "x");
  EXPECT_TRUE(level.Finish(300));
  EXPECT_EQ(copied, 201U);
}

// rewrite.h: heights may come to Z0, and not by a unit to its wrong side.
TEST(WordsBeside, HeightsMayComeToZ0) {
  const auto moved = [](std::string_view stream, double z_mm) {
    const auto made = MoveStream(stream, ParametersOf("t1"), {0, 0, z_mm});
    return made ? made->stream : "refused: " + made.error().detail;
  };
  EXPECT_EQ(moved("!PZ-1,5;", 0.01), "!PZ0,6;");
  EXPECT_EQ(moved("!PZ-1,5;", 0.02),
            "refused: the tool-down height would come "
            "above Z0: move Z0 on the panel");
  EXPECT_EQ(moved("!PZ-1,5;", -0.05), "!PZ-6,0;");
  EXPECT_EQ(moved("!PZ-1,5;", -0.06),
            "refused: the tool-up height would come below Z0: move Z0 on the panel");
}

// RML1-1.12: on a link of 7 bits a digit may have its top bit set, right behind
// a sign, too: it is no number that could be written anew byte for byte.
TEST(WordsBeside, ADigitWithItsTopBit) {
  machine::Parameters seven = ParametersOf("t1");
  ASSERT_TRUE(seven.Set("DATA_BITS", std::string_view("7")));
  for (const char* stream : {"PU-\xB1"
                             "5,2;",
                             "PU\xB1"
                             "5,2;",
                             "PU-5\xB1,2;"}) {
    const auto made = MoveStream(stream, seven, {1, 0, 0});
    ASSERT_FALSE(made) << stream;
    EXPECT_EQ(made.error().detail, "a number with other bytes in it");
  }
}

// RML1-9.31: 16 stages from the lowest speed to the highest one, also where
// these are 1 rpm apart.
TEST(WordsBeside, StagesOfANarrowSpindle) {
  machine::Parameters narrow = ParametersOf("t1s");
  ASSERT_TRUE(narrow.Set("SPINDLE_MAX", 4501.0));
  EXPECT_NE(StreamFrom("S4501 M3\n", narrow).stream.find("!RC15;"), std::string::npos);
  EXPECT_NE(StreamFrom("S4500 M3\n", narrow).stream.find("!RC0;"), std::string::npos);
}

// stream_writer.h: the two-axis command only where the other one is not fast
// enough: at the highest speed of Z it is, however fast the least speed of X
// and Y.
TEST(WordsBeside, AsFastAsZGoes) {
  machine::Parameters slow_z = ParametersOf("t1");
  ASSERT_TRUE(slow_z.Set("Z_SPEED_MAX", 10.0));
  ASSERT_TRUE(slow_z.Set("XY_SPEED_MIN", 30.0));
  ASSERT_TRUE(slow_z.Set("XY_SPEED", 30.0));
  const auto made = [&](const std::string& feed) {
    return StreamFrom("G1 Z-1 F60\nG1 X5 F" + feed + "\n", slow_z).stream;
  };
  EXPECT_NE(made("600").find("!VZ10;\nZ500,0,-100;\n"), std::string::npos) << made("600");
  EXPECT_NE(made("601").find("VS30;\n!PZ-100,0;\nPD500,0;\n"), std::string::npos) << made("601");
}

}  // namespace
}  // namespace rmlcell::rml1
