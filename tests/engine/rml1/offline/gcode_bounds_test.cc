#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/rml1/offline/gcode_arc.h"
#include "engine/rml1/offline/gcode_reader.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// Where what G-code says ends: the last value that is taken, and the first that is not.
// docs/gcode.md
namespace rmlcell::rml1 {
namespace {

StreamOfGcode Made(const std::string& text, const FromGcodeOptions& options = {}) {
  return FromGcode(text, ParametersOf("t1"), options).value();
}

// The first error of a text that is refused; kCellUsage: it is taken.
ErrorCode RefusedWith(const std::string& text) {
  for (const Diagnostic& finding : Made(text).findings) {
    if (finding.severity == Severity::kTool) return finding.code;
  }
  return ErrorCode::kCellUsage;
}

std::string GcodeOf(const std::string& stream) {
  return ToGcode(stream, ParametersOf("t1")).value().text;
}

std::string DetailOf(const std::string& text) {
  const StreamOfGcode made = Made(text);
  return made.findings.empty() ? "" : made.findings.front().detail;
}

// An end that is the start but for the noise of decimals is a full turn; one that is further away
// is the end of a short arc. About (0,0) with radius 10, 1e-5 rad are 1e-4 mm.
TEST(GcodeArcBounds, AFullTurnEndsWhereItBegan) {
  const Arc full = ArcOf({.from = {10, 0}, .to = {10, 1e-7}, .i = -10}).value();
  EXPECT_NEAR(full.sweep_rad, 2 * M_PI, 1e-9);
  const Arc shortest = ArcOf({.from = {10, 0}, .to = {10, 1e-4}, .i = -10}).value();
  EXPECT_NEAR(shortest.sweep_rad, 1e-5, 1e-9);
  const Arc nearly_full =
      ArcOf({.from = {10, 0}, .to = {10, 1e-4}, .clockwise = true, .i = -10}).value();
  EXPECT_NEAR(nearly_full.sweep_rad, 1e-5 - 2 * M_PI, 1e-9);
}

// I and J count from the start, in both senses.
TEST(GcodeArcBounds, ACentreBesideTheStart) {
  const Arc left = ArcOf({.from = {10, 5}, .to = {20, 5}, .i = 5, .j = 0}).value();
  EXPECT_EQ(left.centre.x(), 15.0);
  EXPECT_EQ(left.centre.y(), 5.0);
  const Arc below = ArcOf({.from = {10, 5}, .to = {13, 2}, .j = -3}).value();
  EXPECT_EQ(below.centre.x(), 10.0);
  EXPECT_EQ(below.centre.y(), 2.0);
}

// The same for what is no arc at all: a centre, or an end of an R, that is the start.
TEST(GcodeArcBounds, WhatIsNoiseOfDecimals) {
  EXPECT_EQ(ArcOf({.to = {1e-6, 0}, .j = -5}).value().sweep_rad, 2 * M_PI);
  EXPECT_LT(ArcOf({.to = {2e-6, 0}, .j = -5}).value().sweep_rad, 2 * M_PI);
  EXPECT_FALSE(ArcOf({.i = 1e-6}));
  EXPECT_TRUE(ArcOf({.i = 2e-6}));
  EXPECT_FALSE(ArcOf({.to = {1e-6, 0}, .r = 1}));
  EXPECT_TRUE(ArcOf({.to = {2e-6, 0}, .r = 1}));
}

// From (10,0) to (0,10) clockwise: the quarter about (10,10), or with R below 0 the three quarters
// about (0,0).
TEST(GcodeArcBounds, RadiusOfAClockwiseArc) {
  const Arc quarter = ArcOf({.from = {10, 0}, .to = {0, 10}, .clockwise = true, .r = 10}).value();
  EXPECT_NEAR(quarter.centre.x(), 10.0, 1e-9);
  EXPECT_NEAR(quarter.centre.y(), 10.0, 1e-9);
  EXPECT_NEAR(quarter.sweep_rad, -M_PI / 2, 1e-9);
  const Arc longer = ArcOf({.from = {10, 0}, .to = {0, 10}, .clockwise = true, .r = -10}).value();
  EXPECT_NEAR(longer.centre.x(), 0.0, 1e-9);
  EXPECT_NEAR(longer.centre.y(), 0.0, 1e-9);
  EXPECT_NEAR(longer.sweep_rad, -3 * M_PI / 2, 1e-9);
}

// Half of the way between the ends is 5 mm: an R that is 0.02 mm less is taken for that, one that
// is shorter still joins nothing.
TEST(GcodeArcBounds, ARadiusThatIsALittleShort) {
  const Arc half = ArcOf({.from = {0, 0}, .to = {10, 0}, .r = 4.981}).value();
  EXPECT_NEAR(half.centre.x(), 5.0, 1e-9);
  EXPECT_NEAR(half.centre.y(), 0.0, 1e-9);
  EXPECT_NEAR(half.radius_mm, 5.0, 1e-9);
  EXPECT_TRUE(ArcOf({.from = {0, 0}, .to = {10, 0}, .r = 4.98}));
  EXPECT_FALSE(ArcOf({.from = {0, 0}, .to = {10, 0}, .r = 4.979}));
}

// Ends that are not as far from the centre: 0.02 mm are always taken, and 0.1 % of the radius where
// that is more.
TEST(GcodeArcBounds, EndsThatAreNotAsFarFromTheCentre) {
  const auto made = [](double radius, double other) {
    return bool(ArcOf({.from = {radius, 0}, .to = {0, other}, .i = -radius}));
  };
  EXPECT_TRUE(made(1.0, 1.019));
  EXPECT_FALSE(made(1.0, 1.021));
  EXPECT_FALSE(made(1.0, 0.979));
  EXPECT_TRUE(made(0.02, 0.04));
  EXPECT_TRUE(made(100.0, 100.099));
  EXPECT_FALSE(made(100.0, 100.101));
  EXPECT_TRUE(made(1000.0, 1001.0));
}

// A chord of the angle a is radius (1 - cos(a / 2)) off: radius 1 and a tolerance of 1 - cos(45
// degrees) are chords of 90 degrees. None is longer than half a turn, whatever the tolerance.
TEST(GcodeArcBounds, ChordsOfATolerance) {
  const Arc turn = ArcOf({.from = {1, 0}, .to = {1, 0}, .i = -1}).value();
  EXPECT_EQ(turn.Chords(1.0 - std::sqrt(0.5)), 4.0);
  EXPECT_EQ(turn.Chords(0.999 * (1.0 - std::sqrt(0.5))), 5.0);
  EXPECT_EQ(turn.Chords(1.0 - std::cos(M_PI / 4.0000001)), 5.0);
  EXPECT_EQ(turn.Chords(1.0), 2.0);
  EXPECT_EQ(turn.Chords(50.0), 2.0);
  const Arc quarter = ArcOf({.from = {1, 0}, .to = {0, 1}, .i = -1}).value();
  EXPECT_EQ(quarter.Chords(50.0), 1.0);
}

// RML1-3A.55: a wait is at most 32767 ms, in all that stand before one motion.
TEST(GcodeBounds, Waits) {
  EXPECT_NE(Made("G4 P32.767\nG0 Z1\n").stream.find("!DW32767;"), std::string::npos);
  EXPECT_NE(Made("G4 P30\nG4 P2.767\nG0 Z1\n").stream.find("!DW32767;"), std::string::npos);
  EXPECT_EQ(RefusedWith("G4 P30\nG4 P2.768\nG0 Z1\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_TRUE(Made("G4 P0\nG0 Z1\n").ok);
  EXPECT_EQ(Made("G4 P0\nG0 Z1\n").stream.find("!DW"), std::string::npos);
  EXPECT_EQ(RefusedWith("G4 P-.001\n"), ErrorCode::kRml1GcodeForm);
  EXPECT_EQ(DetailOf("G4 P40\n"), "P40: a wait is at most 32.767 s");
}

// RML1-2.32: numbers from -8388608 to 8388607 units, of 0.01 mm here.
TEST(GcodeBounds, Coordinates) {
  EXPECT_EQ(RefusedWith("G0 X83886.07 Y-83886.08\n"), ErrorCode::kCellUsage);
  EXPECT_EQ(RefusedWith("G0 X83886.08\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_EQ(RefusedWith("G0 Y-83886.09\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_EQ(RefusedWith("G0 Z83886.08\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_EQ(DetailOf("G0 Y-83886.09\n"), "Y -83886.09 mm");
}

// Words that say nothing to a mill are noted, each once, and nothing else is said.
TEST(GcodeBounds, WordsThatAreNoted) {
  for (const auto& [text, detail] :
       {std::pair("O12\nG0 X1\nO13\n", "O12, the number of the program"),
        {"T1\nG0 X1\nT1\n", "T, the tool is put in by hand"},
        {"M6 T1\n", "M6, the tool is put in by hand"},
        {"G64 P.1\nG0 X1\nG64\n", "G64, path with tolerance"}}) {
    const StreamOfGcode made = Made(text);
    EXPECT_TRUE(made.ok) << text;
    bool noted = false;
    for (const Diagnostic& finding : made.findings) {
      EXPECT_EQ(finding.code, ErrorCode::kRml1GcodeIgnored) << text;
      noted = noted || finding.detail == detail;
    }
    EXPECT_TRUE(noted) << text;
  }
  EXPECT_EQ(RefusedWith("O1 G0 X1\n"), ErrorCode::kRml1GcodeWord);
}

// A line with a word that is refused does nothing else, so that nothing else is wrong with it; and
// of a program with an error nobody asks how it cuts.
TEST(GcodeBounds, RefusedLinesAreNotObeyed) {
  for (const char* line : {"G99 G1 X1", "P1 G1 X1", "H1 G1 X1", "U1 G1 X1", "G1 G0 X1", "G1 X1 X2"})
    EXPECT_EQ(Made(std::string(line) + "\n").findings.size(), 1U) << line;
  EXPECT_EQ(Made("G1 Z-1 F60\nG0 X5\nG0 Z-2\nG99\nG4 P1\n").findings.size(), 1U);
}

TEST(GcodeBounds, WhyThereIsNoArc) {
  EXPECT_EQ(DetailOf("G2 X1 F60\n"), "neither R nor a centre");
  EXPECT_EQ(DetailOf("G2 X1 I1 R1 F60\n"), "both R and a centre");
  EXPECT_EQ(DetailOf("G2 X0 R1 F60\n"), "R with an end that is the start: give I and J");
  EXPECT_EQ(DetailOf("G2 X1 I0 F60\n"), "the centre is the start");
  EXPECT_EQ(DetailOf("G2 X9 I3 F60\n"), "the start is 3 mm from the centre, the end 6 mm");
  EXPECT_EQ(DetailOf("G2 X9 R4 F60\n"), "R is 4 mm, the ends are 9 mm apart");
}

TEST(GcodeBounds, Pauses) {
  EXPECT_TRUE(Made("G0 Z1\nM0\nM1\n").stream.ends_with("Z0,0,100;\n!NR;\n!NR;\n"));
}

// G and M words are whole numbers or the tenths of the table.
TEST(GcodeBounds, NumbersOfWords) {
  for (const char* word : {"G-0.1", "G0.01", "G100000", "G1e3", "M-3", "M3.1"})
    EXPECT_NE(RefusedWith(std::string(word) + " X1\n"), ErrorCode::kCellUsage) << word;
  EXPECT_EQ(RefusedWith("G90.1\n"), RefusedWith("G90.10\n"));
  EXPECT_EQ(RefusedWith("G00 X1\nG01.0 X2 F60\n"), ErrorCode::kCellUsage);
}

// With the work origin 50 mm from the left and 20 mm from the front, X leads from -50 to 150 and Y
// from -20 to 130 mm.
TEST(GcodeBounds, TheTravelIsFromTheWorkOrigin) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  ASSERT_TRUE(moved.Set("ORIGIN_Y", std::string_view("20")));
  const auto beyond = [&](const std::string& place) {
    const auto made = FromGcode("G1 Z-1 F60\n" + place + "\n", moved).value();
    return made.beyond_travel ? made.beyond_travel->line : 0;
  };
  for (const char* within : {"X-50", "X150", "Y-20", "Y130", "Z-40"}) EXPECT_EQ(beyond(within), 0);
  for (const char* place : {"X-50.01", "X150.01", "Y-20.01", "Y130.01", "Z-40.01"})
    EXPECT_EQ(beyond(place), 2) << place;
  // Along the surface and above it nothing is cut.
  EXPECT_EQ(beyond("Z0\nX151\nZ1\nX152"), 0);
}

// A circle about (1000, 0) has n chords where the tolerance is 1 m (1 - cos(pi / n)) or a little
// less: at most 100,000.
TEST(GcodeBounds, ChordsOfAnArc) {
  const auto made = [](double chords) {
    return Made("G1 X0 F600\nG2 I1000\n",
                {.tolerance_mm = 1000.0 * (1.0 - std::cos(M_PI / chords))});
  };
  EXPECT_TRUE(made(99'999.5).ok);
  const StreamOfGcode refused = made(100'000.5);
  ASSERT_FALSE(refused.ok);
  EXPECT_EQ(refused.findings.front().code, ErrorCode::kRml1ProductTooLarge);
  EXPECT_EQ(refused.findings.front().detail, "an arc of 100001 chords");
}

// An arc leads to where its words say, even if that lies 0.019 mm beside the circle, and to no
// other point near it: here a quarter in one chord.
TEST(GcodeBounds, AnArcEndsWhereItsWordsSay) {
  const StreamOfGcode made = Made("G1 X10 Z0 F600\nG3 X0 Y10.019 I-10\n", {.tolerance_mm = 3.0});
  EXPECT_TRUE(made.stream.ends_with("\nZ1000,0,0;\nZ0,1002,0;\n")) << made.stream;
}

// What the stream says counts from the work origin, wherever that is on the table.
TEST(GcodeBounds, WordsAreFromTheWorkOrigin) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  ASSERT_TRUE(moved.Set("ORIGIN_Y", std::string_view("20")));
  const auto made = ToGcode("!MC0;PU100,250;PU-100,300;", moved);
  ASSERT_TRUE(made);
  EXPECT_NE(made->text.find("G0 X1 Y2.5\nG0 X-1 Y3\nM30\n"), std::string::npos) << made->text;
}

// T1: 4500 to 15000 rpm.
TEST(GcodeBounds, SpindleSpeeds) {
  EXPECT_EQ(DetailOf("S4500\nS15000\nS0\n"), "");
  EXPECT_EQ(DetailOf("S15001\n"), "S15001 becomes 15000 rpm");
  EXPECT_EQ(DetailOf("S4499\n"), "S4499 becomes 4500 rpm");
  EXPECT_EQ(DetailOf("S-1\n"), "S-1 is no speed");
  // S0 stands beside M5 and sets nothing.
  EXPECT_EQ(Made("S0 M5\n").stream.find("!RC"), std::string::npos);
}

// What lies in the work is below Z 0: a rapid up within it, or along Z 0, is none that dips.
TEST(GcodeBounds, RapidsWithinTheWork) {
  EXPECT_EQ(DetailOf("M3 S9000\nG1 Z-2 F600\nG0 Z-1\nG0 Z0\nG0 X5\n"), "");
  EXPECT_EQ(DetailOf("M3 S9000\nG1 Z-1 F600\nG0 Z-1.01\n"),
            "G0 leads down below Z 0: the stream goes there at 60 mm/s");
  EXPECT_EQ(DetailOf("G0 Z0\nG0 Z-.01\n"),
            "G0 leads down below Z 0: the stream goes there at 60 mm/s");
  EXPECT_EQ(DetailOf("M3 S9000\nG1 Z-.01 F600\nG0 Y1 Z5\n"),
            "G0 leads across below Z 0: the stream goes there at 60 mm/s");
  EXPECT_EQ(DetailOf("M3 S9000\nG1 Z-1 F600\nG0 X1\nG0 X2\n"),
            "G0 leads across below Z 0, here and in 1 more line: the stream goes there at 60 mm/s");
}

// A text of exactly as many bytes as may be made is made: DF and !MC0 are 10 bytes.
TEST(GcodeBounds, BytesOfTheStream) {
  const std::string text = "G1 X1 F60\nG1 X2\n";
  const std::size_t all = Made(text).stream.size();
  // The last motion is written where so much stood before it.
  const std::size_t before = all - std::string("Z200,0,2000;\n").size();
  EXPECT_TRUE(Made(text, {.bytes_max = before}).ok);
  EXPECT_FALSE(Made(text, {.bytes_max = before - 1}).ok);
}

// G28 takes zeros of X, Y and Z, and goes by way of nothing else.
TEST(GcodeBounds, WordsOfHome) {
  for (const char* word : {"I0", "J0", "K0", "R0", "X1", "Z-1"}) {
    EXPECT_EQ(RefusedWith(std::string("G91 G28 ") + word + "\n"), ErrorCode::kRml1GcodeWord)
        << word;
  }
  EXPECT_EQ(RefusedWith("G28 Z0\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(RefusedWith("G91 G28 X0 Y0 Z0\n"), ErrorCode::kCellUsage);
}

// Characters that begin no word are shown where they can be, else as a byte.
TEST(GcodeBounds, CharactersThatBeginNoWord) {
  EXPECT_EQ(DetailOf("!\n"), "'!' begins no word");
  EXPECT_EQ(DetailOf("~\n"), "'~' begins no word");
  EXPECT_EQ(DetailOf("\x7F\n"), "byte 0x7F begins no word");
  EXPECT_EQ(DetailOf("@\n"), "'@' begins no word");
  EXPECT_EQ(DetailOf("[\n"), "'[' begins no word");
  EXPECT_EQ(DetailOf("%\x1F\n"), "% stands alone on its line");
}

// At most 64 words in a line, and 40 characters in a number; a + in front is one of them, and only
// one is taken.
TEST(GcodeBounds, WordsAndDigits) {
  const auto words = [](int count) {
    std::string line;
    for (int k = 0; k < count; ++k) line += "M8 ";
    return RefusedWith("N1 " + line + "\n");
  };
  EXPECT_EQ(words(64), ErrorCode::kCellUsage);
  EXPECT_EQ(words(65), ErrorCode::kRml1GcodeForm);
  const auto digits = [](std::size_t count) {
    return RefusedWith("G0 X" + std::string(count - 1, '0') + "1\n");
  };
  EXPECT_EQ(digits(40), ErrorCode::kCellUsage);
  EXPECT_EQ(digits(41), ErrorCode::kRml1GcodeForm);
  EXPECT_EQ(RefusedWith("G0 X+1\n"), ErrorCode::kCellUsage);
  EXPECT_EQ(RefusedWith("G0 X++1\n"), ErrorCode::kRml1GcodeForm);
  EXPECT_EQ(RefusedWith("G0 X+-1\n"), ErrorCode::kRml1GcodeForm);
  // Not a zero that is left of it.
  EXPECT_EQ(RefusedWith("G0 X+" + std::string(40, '0') + "100\n"), ErrorCode::kRml1GcodeForm);
  EXPECT_EQ(DetailOf("G0 X\n"), "X has no number");
  EXPECT_EQ(DetailOf("G0 X.\n"), "X has no such number");
}

// Each % is on its own; the first one begins the program and the second ends it, or ends at once
// what began without.
TEST(GcodeBounds, PercentBeginsAndEnds) {
  EXPECT_NE(Made("%\nG0 Z5\n%\nG0 Z9\n").stream.find(",500;"), std::string::npos);
  EXPECT_EQ(Made("%\nG0 Z5\n%\nG0 Z9\n").stream.find(",900;"), std::string::npos);
  EXPECT_EQ(Made("G0 Z5\n%\nG0 Z9\n").stream.find(",900;"), std::string::npos);
  EXPECT_EQ(DetailOf("%\n%\nG0 Z9\n"), "what stands behind the end of the program");
}

// Lines are counted by each end of a line, CR LF being one; columns from 1; a long line has its
// places too, up to the millionth column and a thousand characters.
TEST(GcodeBounds, Places) {
  GcodeReader reader("\r\n\n\rG0 X1\r\nY22");
  for (int empty = 0; empty < 3; ++empty) EXPECT_TRUE(reader.Next()->value().words.empty());
  const GcodeBlock fourth = reader.Next()->value();
  ASSERT_EQ(fourth.words.size(), 2U);
  EXPECT_EQ(fourth.words[1].where.line, 4);
  EXPECT_EQ(fourth.words[1].where.column, 4);
  EXPECT_EQ(fourth.words[1].where.length, 2);
  EXPECT_EQ(fourth.words[1].where.byte_offset, 7);
  EXPECT_EQ(reader.offset(), 11U);
  const GcodeBlock last = reader.Next()->value();
  EXPECT_EQ(last.words[0].where.line, 5);
  EXPECT_EQ(last.words[0].where.length, 3);
  EXPECT_EQ(last.words[0].where.byte_offset, 11);
  EXPECT_FALSE(reader.Next());
  // Nothing behind the text counts, and behind the end of its last line nothing comes.
  GcodeReader half(std::string_view("G12\r\n").substr(0, 4));
  EXPECT_EQ(half.Next()->value().words[0].value, 12.0);
  EXPECT_EQ(half.offset(), 4U);
  EXPECT_FALSE(half.Next());
  GcodeReader cut(std::string_view("G12").substr(0, 2));
  EXPECT_EQ(cut.Next()->value().words[0].value, 1.0);
  const std::string far = std::string(1'000'005, ' ') + "X" + std::string(1'200, ' ') + "1";
  GcodeReader wide(far);
  const SourceSpan where = wide.Next()->value().words[0].where;
  EXPECT_EQ(where.column, 1'000'001);
  EXPECT_EQ(where.length, 1'000);
  EXPECT_EQ(where.byte_offset, 1'000'005);
}

// P belongs to G4 and G64, H to G43, and to no other G word of the line. A number is told with six
// decimals.
TEST(GcodeBounds, WordsThatBelongToOthers) {
  EXPECT_EQ(RefusedWith("G1 X1 P1 F60\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(RefusedWith("G1 X1 H1 F60\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(DetailOf("G1 X1 P1 F60\n"), "P1 without G4");
  EXPECT_EQ(DetailOf("G1 X1 H1 F60\n"), "H1 without G43");
  EXPECT_EQ(DetailOf("G1 X1 I0.1234567 F60\n"), "I0.123457 without G2 or G3");
}

// A spindle that turns gets another speed and goes on turning.
TEST(ToGcodeBounds, TheSpindleChangesItsSpeed) {
  EXPECT_NE(GcodeOf("!MC1;Z0,0,0;!RC15;Z1,0,0;!MC0;")
                .find("S4500 M3\nG1 Z0 F120\nS15000\nG1 X0.01 Y0\nM5\nM30\n"),
            std::string::npos)
      << GcodeOf("!MC1;Z0,0,0;!RC15;Z1,0,0;!MC0;");
}

// Whatever is cut at the speed of the machine, it is told once.
TEST(ToGcodeBounds, AFeedThatNobodyGaveIsToldOnce) {
  const Result<GcodeText> made =
      ToGcode("!MC0;!PZ-50,200;PU0,0;PD500,0;PD900,0;PU0,0;", ParametersOf("t1"));
  ASSERT_TRUE(made);
  ASSERT_EQ(made->findings.size(), 1U);
  EXPECT_EQ(made->findings[0].code, ErrorCode::kRml1FeedNotGiven);
}

// Places have five decimals at most: 100.0064 units are 1.000064 mm.
TEST(ToGcodeBounds, PlacesHaveFiveDecimals) {
  EXPECT_NE(GcodeOf("!MC0;Z100.0064,0,0;").find("\nG1 X1.00006 Y0 Z0 "), std::string::npos);
}

// A wait that no motion follows is told, however short it is; one before a motion is not.
TEST(GcodeBounds, AWaitBehindTheLastMotionIsTold) {
  const StreamOfGcode made = Made("G0 Z1\nG4 P.001\n");
  EXPECT_TRUE(made.ok);
  ASSERT_EQ(made.findings.size(), 1U);
  EXPECT_EQ(made.findings[0].code, ErrorCode::kRml1GcodeIgnored);
  EXPECT_EQ(made.findings[0].detail, "the wait behind the last motion");
  EXPECT_TRUE(Made("G4 P.001\nG0 Z1\n").findings.empty());
}

// docs/gcode.md, a spindle that stands: the first line is one like any other.
TEST(GcodeBounds, ACutOfAStandingSpindleInTheFirstLine) {
  const StreamOfGcode made = Made("G1 Z-1 F600\n");
  EXPECT_TRUE(made.ok);
  ASSERT_EQ(made.findings.size(), 1U);
  EXPECT_EQ(made.findings[0].code, ErrorCode::kRml1GcodeSpindleStands);
  EXPECT_EQ(made.findings[0].where.line, 1);
  EXPECT_EQ(made.findings[0].detail, "a cut below Z 0 before M3 turns the spindle on");
}

// docs/gcode.md: Z of an arc changes in equal steps, also from below Z 0 on. Half a turn of radius
// 10 with a tolerance of 0.5 mm are pi / (2 acos(0.95)) = 4.95, so five chords of 36 degrees.
TEST(GcodeBounds, AHelixGoesOnFromWhereItBegins) {
  const StreamOfGcode made = Made("G1 X0 Z-1 F600\nG2 X20 Z-3 I10\n", {.tolerance_mm = 0.5});
  EXPECT_TRUE(
      made.stream.ends_with("\nZ0,0,-100;\nZ191,588,-140;\nZ691,951,-180;\n"
                            "Z1309,951,-220;\nZ1809,588,-260;\nZ2000,0,-300;\n"))
      << made.stream;
}

// An origin may lie between two units, 50.005 mm from the left and 20.005 mm from the front: so
// does what counts from it. X 149.99 is half a unit within the travel of 200 mm, X 150 half a unit
// beyond it.
TEST(GcodeBounds, AnOriginBetweenTwoUnits) {
  machine::Parameters moved = ParametersOf("t1");
  ASSERT_TRUE(moved.Set("ORIGIN_X", 50.005));
  ASSERT_TRUE(moved.Set("ORIGIN_Y", 20.005));
  const auto beyond = [&](const std::string& place) {
    const auto made = FromGcode("G1 Z-1 F60\n" + place + "\n", moved).value();
    return made.beyond_travel ? made.beyond_travel->line : 0;
  };
  for (const char* within : {"X-50", "X149.99", "Y-20", "Y129.99"})
    EXPECT_EQ(beyond(within), 0) << within;
  for (const char* place : {"X-50.01", "X150", "Y-20.01", "Y130"})
    EXPECT_EQ(beyond(place), 2) << place;
}

}  // namespace
}  // namespace rmlcell::rml1
