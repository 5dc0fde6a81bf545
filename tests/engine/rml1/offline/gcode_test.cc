#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "engine/rml1/offline/gcode_arc.h"
#include "engine/rml1/offline/gcode_words.h"
#include "engine/rml1/offline/stream_walk.h"
#include "engine/rml1/offline/stream_writer.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::string ToText(std::string_view stream, std::string_view profile = "t1") {
  const Result<GcodeText> made = ToGcode(stream, ParametersOf(profile));
  return made ? made->text : made.error().detail;
}

StreamOfGcode From(std::string_view text, std::string_view profile = "t1",
                   const FromGcodeOptions& options = {}) {
  return FromGcode(text, ParametersOf(profile), options).value();
}

constexpr std::string_view kHead = "DF;\n!MC0;\n";

std::string Body(std::string_view text, std::string_view profile = "t1") {
  const StreamOfGcode made = From(text, profile);
  EXPECT_TRUE(made.ok) << (made.findings.empty() ? "" : made.findings.front().detail);
  EXPECT_EQ(made.stream.substr(0, kHead.size()), kHead);
  return made.stream.substr(std::min(kHead.size(), made.stream.size()));
}

ErrorCode CodeOf(std::string_view text) {
  const StreamOfGcode made = From(text);
  EXPECT_FALSE(made.ok) << text;
  EXPECT_TRUE(made.stream.empty());
  for (const Diagnostic& finding : made.findings) {
    if (finding.severity == Severity::kTool) return finding.code;
  }
  return ErrorCode::kCellUsage;
}

// Where the tool goes, in whole units of the work; points that round to one are one.
class Points final : public PhraseListener {
 public:
  explicit Points(const Profile& profile) : profile_(profile) {}
  bool OnPhrase(const Phrase& phrase) override {
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion) continue;
      const auto unit = [&](double value) {
        return NearestUnit(value / profile_.units_per_mm, profile_);
      };
      const Units at{unit(action.to.x - profile_.origin_x), unit(action.to.y - profile_.origin_y),
                     unit(action.to.z - profile_.z0)};
      if (points.empty() || !(points.back() == at)) points.push_back(at);
    }
    return true;
  }
  std::vector<Units> points{{.z = 0}};

 private:
  const Profile& profile_;
};

std::vector<Units> PathOf(std::string_view stream, std::string_view profile_id) {
  const Profile profile = MakeProfile(ParametersOf(profile_id)).value();
  Points points(profile);
  points.points = {{.z = NearestUnit(-profile.z0 / profile.units_per_mm, profile)}};
  StreamWalk(profile, points).Run(stream);
  return points.points;
}

// T1: travel 60 mm/s = 3600 mm/min, V 2 mm/s = 120 mm/min, tool up 5 mm above Z0.
TEST(ToGcode, SaysWhatTheToolDoes) {
  EXPECT_EQ(ToText("!RC15;VS4;PU100,250;!DW100;PD150,250;!NR;H;"),
            "(made of an RML-1 stream; X0 Y0 is its work origin, Z0 its Z0)\n"
            "G21 G90 G17 G94\n"
            "S15000 M3\n"
            "G1 Z5 F120\n"
            "G0 X1 Y2.5\n"
            "G4 P0.1\n"
            "G1 Z0\n"
            "G4 P0.1\n"
            "G1 X1.5 F240\n"
            "M0\n"
            "G0 Z20\n"
            "G0 X0 Y0\n"
            "M5\n"
            "M30\n");
}

// RML1-3C.32: Z0 moves, the zero of the G-code stays: work Z 0 is 10 mm higher now.
TEST(ToGcode, TheZeroStaysAndTheFirstWordOfXBringsY) {
  EXPECT_NE(ToText("!MC0;!ZO-1000;Z100,0,0;").find("G1 X1 Y0 Z10 F120\n"), std::string::npos);
}

TEST(ToGcode, ClippingIsDoneAndNoted) {
  const Result<GcodeText> made = ToGcode("!MC0;!VZ2;Z0,0,-9000;", ParametersOf("t1"));
  ASSERT_TRUE(made);
  EXPECT_NE(made->text.find("G1 Z-40 F120\n"), std::string::npos);  // the bottom
  ASSERT_EQ(made->findings.size(), 1U);
  EXPECT_EQ(made->findings[0].code, ErrorCode::kRml1Clipped);
}

// What G-code has no word for stands there as a comment, and is told.
TEST(ToGcode, WhatItCannotSayIsAComment) {
  const Result<GcodeText> made =
      ToGcode("!MC0;!PZ-50,200;VS99;PU0,0;PD500,0;PD(9;PD", ParametersOf("t1"));
  ASSERT_TRUE(made);
  std::vector<ErrorCode> codes;
  for (const Diagnostic& finding : made->findings) codes.push_back(finding.code);
  EXPECT_EQ(codes, (std::vector{ErrorCode::kRml1SpeedClamped, ErrorCode::kRml1FeedNotGiven,
                                ErrorCode::kRml1UnknownCommand, ErrorCode::kRml1WrongParameters,
                                ErrorCode::kRml1IncompleteCommand}));
  // The plunge at the speed of Z, which nobody set, as fast as the way to Z 2 before it.
  EXPECT_NE(
      made->text.find("(RML1-E8013 in the stream: a cut without a feed rate: F is the default "
                      "of this machine)\nG1 Z-0.5\n"),
      std::string::npos)
      << made->text;
  EXPECT_NE(made->text.find("(RML1-E8003 in the stream: VS 99 is beyond the machine)\n"),
            std::string::npos);
  // A bracket inside would end the comment.
  EXPECT_NE(made->text.find("(RML1-E1 in the stream: '[' begins no command)\n"), std::string::npos);
  EXPECT_NE(ToText("PU;~").find("(RML1-E1 in the stream: '~' begins no command)\n"),
            std::string::npos);
  EXPECT_NE(
      ToText("!MC1;!VZ2;VS4;PD1,1;PU;")
          .find(
              "(RML1-E8012 in the stream: the spindle goes on turning at the end, where M30 stops "
              "it)\nM30\n"),
      std::string::npos);
  EXPECT_TRUE(
      ToGcode("!MC0;VS4;!VZ2;!PZ-50,200;PU0,0;PD500,0;PU;", ParametersOf("t1"))->findings.empty());
}

TEST(ToGcode, RefusesTheRotaryAxisAndWhatIsNoStream) {
  const auto turned = ToGcode("PU;\n!ZE A90;", ParametersOf("t1a"));
  ASSERT_FALSE(turned);
  EXPECT_EQ(turned.error().code, ErrorCode::kRml1RotaryMotion);
  EXPECT_EQ(turned.error().where->line, 2);
  const auto prose = ToGcode(std::string(300, '$'), ParametersOf("t1"));
  ASSERT_FALSE(prose);
  EXPECT_EQ(prose.error().code, ErrorCode::kRml1NoProgram);
}

// 600 mm/min are 10 mm/s. X and Y alone above the work: PU at that height.
TEST(FromGcode, LinesRapidsAndSpindle) {
  EXPECT_EQ(Body("%\nO12\nN10 G21 G90 (metric)\nM3 S6600 ; on\ng0z2\nG0X1.Y-.5\nG1 Z-0.1F600\n"
                 "X2.004\nM5\nM30\n%\n"),
            "!RC6600;\n!MC1;\n!VZ60;\nZ0,0,200;\n!PZ0,200;\nPU100,-50;\n!VZ10;\nZ100,-50,-10;\n"
            "Z200,-50,-10;\n!MC0;\n");
}

// The MDX-40A: 50 mm/s in X and Y, 30 mm/s with Z. 2400 mm/min are 40 mm/s.
TEST(FromGcode, CutsThatZIsTooSlowForAreTwoAxisMotions) {
  EXPECT_EQ(Body("G1 Z-1 F600\nG1 X5 F2400\nY5 Z0\n", "mdx-40a"),
            "!VZ10;\nZ0,0,-100;\nVS40;\n!PZ-100,0;\nPD500,0;\n!VZ30;\nZ500,500,0;\n");
  // From Z0 to the bottom, 105 mm below the top and 85 below Z0 (RML1-3A.07).
  EXPECT_EQ(Body("G1 Z0 F600\nX5 F2400\n", "mdx-40a"),
            "!VZ10;\nZ0,0,0;\nVS40;\n!PZ0,0;\nPD500,0;\n");
  EXPECT_EQ(Body("G1 Z-85 F600\nX5 F2400\n", "mdx-40a"),
            "!VZ10;\nZ0,0,-8500;\nVS40;\n!PZ-8500,0;\nPD500,0;\n");
  EXPECT_EQ(Body("G1 Z0.01 F600\nX5 F2400\n", "mdx-40a"), "!VZ10;\nZ0,0,1;\n!VZ30;\nZ500,0,1;\n");
  // Where X and Y are no faster, three axes do as well: T1 has 60 mm/s in all of them.
  EXPECT_EQ(Body("G1 Z0 F600\nX1 F6000\n"), "!VZ10;\nZ0,0,0;\n!VZ60;\nZ100,0,0;\n");
}

// At Z 0 the tool is up; a hair below it is not.
TEST(FromGcode, RapidsAtZ0) {
  EXPECT_EQ(Body("G0 Z0\nG0 X1\n"), "!VZ60;\nZ0,0,0;\n!PZ0,0;\nPU100,0;\n");
  EXPECT_EQ(Body("G0 Z-.01\nG0 X1\n"), "!VZ60;\nZ0,0,-1;\nZ100,0,-1;\n");
}

// Half a unit is rounded away from zero although half of 0.025 mm times 40 may be a bit less;
// anything below it is not.
TEST(StreamWriter, RoundsToTheNearestUnit) {
  const Profile modela = MakeProfile(ParametersOf("mdx-20")).value();
  EXPECT_EQ(NearestUnit(0.0125, modela), 1);
  EXPECT_EQ(NearestUnit(-0.0125, modela), -1);
  EXPECT_EQ(NearestUnit(0.0125 - 1e-8, modela), 0);
  EXPECT_EQ(NearestUnit(-0.0125 + 1e-8, modela), 0);
}

TEST(FromGcode, InchesAndOldMachines) {
  // 0.1 inch = 2.54 mm = 101.6 units of 0.025 mm; 0.5 inch a minute = 0.2117 mm/s, rounded down.
  EXPECT_EQ(Body("G20 G1 X0.1 Z.25 F0.5\n", "mdx-20"), "!VZ0.2;\nZ102,0,254;\n");
}

TEST(FromGcode, NamesFollowTheCommandSet) {
  const auto made = FromGcode("G0 Z1\nG0 X1\nG1 Z-1 F60\n", [] {
    machine::Parameters parameters = ParametersOf("t1");
    EXPECT_TRUE(parameters.Set("COMMAND", std::string_view("MODE1")));
    return parameters;
  }());
  EXPECT_EQ(made->stream,
            "^DF;\n!MC0;\n!VZ60;\nZ0,0,100;\n!PZ0,100;\nM100,0;\n!VZ1;\nZ100,0,-100;\n");
}

// A wait belongs to the motion behind it, and makes a PU a Z, because PU has none (RML1-3A.57).
TEST(FromGcode, Waits) {
  EXPECT_EQ(Body("G0 Z1\nG4 P0.25\nG4 P.25\nG0 X1\nG4 P1\n"),
            "!VZ60;\nZ0,0,100;\n!DW500;\nZ100,0,100;\n!DW0;\n");
  EXPECT_EQ(From("G0 Z1\nG4 P1\n").findings.at(0).code, ErrorCode::kRml1GcodeIgnored);
  EXPECT_EQ(CodeOf("G4 P32.768\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_EQ(CodeOf("G4 X1\n"), ErrorCode::kRml1GcodeWord);
}

// A half circle of radius 10 from (0,0) to (20,0) about (10,0): G2 goes over Y > 0.
TEST(FromGcode, ArcsStayWithinTheTolerance) {
  const std::string head = "G1 Z0 F600\n";
  for (const double tolerance : {0.5, 0.05}) {
    const StreamOfGcode made = From(head + "G2 X20 Y0 I10 J0\n", "t1", {.tolerance_mm = tolerance});
    ASSERT_TRUE(made.ok);
    std::vector<Units> path = PathOf(made.stream, "t1");
    path.erase(path.begin());  // the start, at the top
    EXPECT_EQ(path.front(), (Units{0, 0, 0}));
    EXPECT_EQ(path.back(), (Units{2000, 0, 0}));
    // The middle of every chord is the furthest from the circle; units are 0.01 mm.
    for (std::size_t k = 1; k < path.size(); ++k) {
      const double x = static_cast<double>(path[k - 1].x + path[k].x) / 200.0 - 10.0;
      const double y = static_cast<double>(path[k - 1].y + path[k].y) / 200.0;
      EXPECT_GE(std::hypot(x, y), 10.0 - tolerance - 0.008);
      EXPECT_LE(std::hypot(x, y), 10.008);
      EXPECT_GE(path[k].y, 0);
    }
    // pi / (2 acos(1 - t / 10)): 4.97 and 15.7 chords.
    EXPECT_EQ(path.size(), tolerance == 0.5 ? 6U : 17U);
  }
}

TEST(GcodeArc, CentresRadiiAndTurns) {
  // A quarter from (10,0) to (0,10) about the zero, both ways.
  const Arc counter = ArcOf({.from = {10, 0}, .to = {0, 10}, .i = -10}).value();
  EXPECT_NEAR(counter.sweep_rad, M_PI / 2, 1e-12);
  const Arc clockwise =
      ArcOf({.from = {10, 0}, .to = {0, 10}, .clockwise = true, .i = -10}).value();
  EXPECT_NEAR(clockwise.sweep_rad, -3 * M_PI / 2, 1e-12);
  // The same quarter by its radius; below 0 the longer arc, whose centre is (10,10).
  const Arc by_radius = ArcOf({.from = {10, 0}, .to = {0, 10}, .r = 10}).value();
  EXPECT_NEAR(by_radius.centre.x(), 0.0, 1e-9);
  EXPECT_NEAR(by_radius.sweep_rad, M_PI / 2, 1e-9);
  const Arc longer = ArcOf({.from = {10, 0}, .to = {0, 10}, .r = -10}).value();
  EXPECT_NEAR(longer.centre.x(), 10.0, 1e-9);
  EXPECT_NEAR(longer.centre.y(), 10.0, 1e-9);
  EXPECT_NEAR(longer.sweep_rad, 3 * M_PI / 2, 1e-9);
  // A full turn ends where it began.
  const Arc full = ArcOf({.clockwise = true, .i = 5}).value();
  EXPECT_NEAR(full.sweep_rad, -2 * M_PI, 1e-12);
  EXPECT_NEAR(full.At(1.0).x(), 0.0, 1e-9);
  for (const ArcWords& bad : {ArcWords{.to = {1, 0}}, ArcWords{.to = {1, 0}, .i = 1, .r = 1},
                              ArcWords{.r = 1}, ArcWords{.to = {10, 0}, .r = 4},
                              ArcWords{.to = {10, 0}, .i = 4}, ArcWords{.to = {1, 0}, .i = 0}}) {
    ASSERT_FALSE(ArcOf(bad));
    EXPECT_EQ(ArcOf(bad).error().code, ErrorCode::kRml1GcodeArc);
  }
}

TEST(FromGcode, WhatMovesTheToolIsNeverDropped) {
  for (const char* word : {"G41 X1",    "G81 Z-1 R1 F60",
                           "G28",       "G91 X1",
                           "H1",        "G92 X0",
                           "G53 G0 X0", "G18.1",
                           "G93",       "G55",
                           "G10 L2",    "M4",
                           "M98 P1",    "A90",
                           "G0 A1",     "G1.5",
                           "U1",        "E1",
                           "P1",        "M6.5"}) {
    const StreamOfGcode made = From(std::string("G0 X0\n") + word + "\n");
    EXPECT_FALSE(made.ok) << word;
    ASSERT_FALSE(made.findings.empty()) << word;
    EXPECT_EQ(made.findings.front().code, ErrorCode::kRml1GcodeWord) << word;
    EXPECT_EQ(made.findings.front().where.line, 2) << word;
  }
  EXPECT_EQ(CodeOf("G0 X1\nG1 X2\n"), ErrorCode::kRml1GcodeFeed);
  EXPECT_EQ(CodeOf("F0\n"), ErrorCode::kRml1GcodeFeed);
  EXPECT_EQ(CodeOf("T1\nG1 X1 F60\nM6 T2\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(CodeOf("G28 G91 Z1\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(CodeOf("G91 G28 Z0\nG0 X1\n"), ErrorCode::kRml1GcodeWord);  // G90 is missing
  EXPECT_EQ(CodeOf("G0 X1 I1\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(CodeOf("G0 X90000000\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_EQ(CodeOf("G2 X1 F60\n"), ErrorCode::kRml1GcodeArc);
}

TEST(FromGcode, LinesThatCannotBeRead) {
  for (const char* line :
       {"%%", "% G0", "G0 X", "G0 X1.2.3", "G0 X--1", "(no end", "/G0 X1", "#1=2", "G0 X[1]",
        "G0 G1 X1", "G0 X1 X2", "X1", "\xff", "G4", "S-1", "G0 X1e"}) {
    EXPECT_EQ(CodeOf(std::string(line) + "\n"), ErrorCode::kRml1GcodeForm) << line;
  }
  const StreamOfGcode made = From("G0 X1\r\nG0 Y\rG0 Z#\n");
  ASSERT_EQ(made.findings.size(), 2U);  // all errors at once, lines of every kind
  EXPECT_EQ(made.findings[0].where.line, 2);
  EXPECT_EQ(made.findings[0].where.column, 4);
  EXPECT_EQ(made.findings[1].where.line, 3);
}

TEST(FromGcode, WhatSaysNothingIsNotedOnce) {
  const StreamOfGcode made =
      From("G54 G40 G80\nT1 M6\nG54 M8\nG64 P0.01\nG0 X1\nM30\nG0 X2\nG0 X3\n");
  EXPECT_TRUE(made.ok);
  EXPECT_EQ(made.findings.size(), 8U);  // G54 G40 G80 T M6 M8 G64, and what stands behind the end
  for (const Diagnostic& finding : made.findings)
    EXPECT_EQ(finding.code, ErrorCode::kRml1GcodeIgnored);
  EXPECT_EQ(made.stream.find("200,0"), std::string::npos);
}

TEST(FromGcode, SpeedsAreRoundedAndSaidOnce) {
  const StreamOfGcode made = From("G1 Z0 F100\nX1 F101\nX2 F99999\nS700\nS800\n");
  EXPECT_TRUE(made.ok);
  ASSERT_EQ(made.findings.size(), 2U);
  EXPECT_EQ(made.findings[0].detail, "1.667 mm/s becomes 1 mm/s, a speed of the machine");
  EXPECT_EQ(made.findings[0].where.line, 1);
  EXPECT_EQ(made.findings[0].where.column, 7);  // of the F
  EXPECT_EQ(made.findings[1].detail, "S700 becomes 4500 rpm");
  // Only stages, evenly spaced from 4500 to 15000: 8000 is the fifth (RML1-9.31).
  EXPECT_NE(From("S8100\n", "t1s").stream.find("!RC5;"), std::string::npos);
  machine::Parameters one_speed = ParametersOf("t1s");
  ASSERT_TRUE(one_speed.Set("SPINDLE_MIN", 15000.0));
  EXPECT_NE(FromGcode("S15000\n", one_speed)->stream.find("!RC0;"), std::string::npos);
  EXPECT_EQ(From("S8100\n", "t1f").stream.find("!RC"), std::string::npos);
}

// RS-274: blanks mean nothing, in words and in numbers; letters may be small; leading zeros.
TEST(FromGcode, BlanksCaseAndLeadingZeros) {
  const std::string plain = Body("G1 X10.5 Y-2 F600\nG0 Z1\n");
  for (const char* same :
       {"G 1 X 1 0 . 5 Y - 2 F6 00\nG 0 Z 1\n", "g01x10.5y-2f600\ng00z1\n",
        "G1X010.50Y-02.F0600\nG0Z1.\n", "\tN 1 0 G1\tX1\t0.5 Y-2F600 \nN20G0Z+1\n",
        "(a) G1 (b) X10.5 (c) Y-2 F600 ; d (e\n;(\nG0 Z1 (f;g)\n",
        "\xEF\xBB\xBF%\nG1 X10.5 Y-2 F600\r\n\r\nG0 Z1\n % (end)\nG0 Z9\n"}) {
    EXPECT_EQ(Body(same), plain) << same;
  }
  const StreamOfGcode made = From("G1 F60 X 1 0 0 . 0 .\n");  // the place has the blanks, too
  ASSERT_EQ(made.findings.size(), 1U);
  EXPECT_EQ(made.findings[0].where.column, 8);
  EXPECT_EQ(made.findings[0].where.length, 13);
}

// A quarter of radius 2 in each plane; the middle of it is 2 * sqrt(1/2) = 1.414 mm from its centre
// in both axes. G18 turns from Z to X, G19 from Y to Z: so Fusion leads into a contour.
TEST(FromGcode, ArcsInAllPlanes) {
  const auto middle = [](const std::string& arc) {
    // 0.2 mm: pi / 4 / acos(1 - 0.2 / 2) = 1.74, so two chords.
    const StreamOfGcode made = From("G1 Z0 F600\n" + arc, "t1", {.tolerance_mm = 0.2});
    EXPECT_TRUE(made.ok) << made.findings.front().detail;
    const std::vector<Units> path = PathOf(made.stream, "t1");
    EXPECT_EQ(path.size(), 4U);
    return path[2];
  };
  // From (0,0,0) with the centre at X 2 (or Y 2), down to Z -2 below the centre.
  EXPECT_EQ(middle("G18 G2 X2 Z-2 I2 K0\n"), (Units{59, 0, -141}));
  EXPECT_EQ(middle("G19 G3 Y2 Z-2 J2 K0\n"), (Units{0, 59, -141}));
  EXPECT_EQ(middle("G18 G3 X2 Z2 I2 K0\n"), (Units{59, 0, 141}));
  EXPECT_EQ(middle("G18 G2 X2 Z-2 R2 Y1\n"), (Units{59, 50, -141}));
  EXPECT_EQ(CodeOf("G18 G2 X2 Z-2 I2 J0 F60\n"), ErrorCode::kRml1GcodeArc);
  EXPECT_EQ(CodeOf("G2 X2 Y2 I2 K0 F60\n"), ErrorCode::kRml1GcodeArc);
}

// Told once of a kind, with the first line and how many more there are.
TEST(FromGcode, CutsWhileTheSpindleStandsAreTold) {
  const StreamOfGcode never = From("G0 Z1\nG1 Z-1 F600\nG1 X5\nG1 Z1\nG1 X9\n");
  EXPECT_TRUE(never.ok);
  ASSERT_EQ(never.findings.size(), 1U);
  EXPECT_EQ(never.findings[0].code, ErrorCode::kRml1GcodeSpindleStands);
  EXPECT_EQ(never.findings[0].severity, Severity::kWarning);
  EXPECT_EQ(never.findings[0].where.line, 2);  // and lines 3 and 4, but not 5, above the work
  EXPECT_EQ(never.findings[0].detail,
            "a cut below Z 0 before M3 turns the spindle on, here and in 2 more lines");
  const StreamOfGcode stopped = From("M3\nG1 Z-1 F600\nM5\nG1 X5\nM3\nG1 X9\nG0 Z1\nM5\nG0 X0\n");
  ASSERT_EQ(stopped.findings.size(), 1U);
  EXPECT_EQ(stopped.findings[0].where.line, 4);
  EXPECT_EQ(stopped.findings[0].detail, "a cut below Z 0 behind M5, which stops the spindle");
  const std::size_t on = stopped.stream.find("!MC1;");  // once more behind M5, which stops it
  EXPECT_NE(stopped.stream.find("!MC1;", on + 1), std::string::npos);
  // An M5 at the beginning stops nothing; an arc is one line, however many chords it has.
  const StreamOfGcode arc = From("M5\nG1 Z-1 F600\nG2 X2 Y2 I1 J1\n");
  ASSERT_EQ(arc.findings.size(), 1U);
  EXPECT_EQ(arc.findings[0].detail,
            "a cut below Z 0 before M3 turns the spindle on, here and in 1 more line");
  EXPECT_TRUE(From("M3 G1 Z-1 F600\nG0 Z1\nM5\n").findings.empty());
  EXPECT_TRUE(From("G0 Z1\nG1 X5 F600\nG1 Z0\n").findings.empty());
}

// T1: the highest speed with Z is 60 mm/s.
TEST(FromGcode, RapidsThroughTheWorkAreToldWithTheirLines) {
  const StreamOfGcode made =
      From("M3 G0 Z1\nG0 X5\nG1 Z-1 F600\nG0 X9\nG0 Y9\nG0 Z1\nG0 Z-0.5\nG0 X0 Y0 Z2\n");
  EXPECT_TRUE(made.ok);
  ASSERT_EQ(made.findings.size(), 2U);
  EXPECT_EQ(made.findings[0].code, ErrorCode::kRml1GcodeRapidInWork);
  EXPECT_EQ(made.findings[0].severity, Severity::kWarning);
  EXPECT_EQ(made.findings[0].where.line, 4);  // lines 4 and 5, and out of the work in line 8
  EXPECT_EQ(
      made.findings[0].detail,
      "G0 leads across below Z 0, here and in 2 more lines: the stream goes there at 60 mm/s");
  EXPECT_EQ(made.findings[1].where.line, 7);
  EXPECT_EQ(made.findings[1].detail, "G0 leads down below Z 0: the stream goes there at 60 mm/s");
  // Up out of the work, across at Z 0, and down to Z 0 are what rapids are for.
  EXPECT_TRUE(From("M3 G1 Z-1 F600\nG0 Z0\nG0 X5\nG0 Z3\nG0 X0 Z0\n").findings.empty());
}

// Up to the top, which is 20 mm above Z0 of T1, and then to the origin.
TEST(FromGcode, HomeIsTheTopAndTheOrigin) {
  const std::string head = "G1 X5 Y6 Z-1 F600\n";
  const std::string start = "!VZ10;\nZ500,600,-100;\n!VZ60;\nZ500,600,2000;\n";
  EXPECT_EQ(Body(head + "G28 G91 Z0.\nG90\n"), start);
  EXPECT_EQ(Body(head + "G91\nG28 Z0\nG28 X0 Y0\nG90\nM30\n"), start + "!PZ0,2000;\nPU0,0;\n");
  EXPECT_EQ(Body(head + "G91 G28 Y0\n"), start + "!PZ0,2000;\nPU500,0;\n");
  EXPECT_EQ(Body(head + "G91 G28\n"), start + "!PZ0,2000;\nPU0,0;\n");
}

TEST(FromGcode, OneToolMayBeCalledMoreThanOnce) {
  EXPECT_TRUE(From("G0 Z5\nM6 T1\nG1 X1 F60\nT1 M6\nG1 X2\n").ok);
  EXPECT_TRUE(From("G0 Z5\nT1\nM6\nG43 Z5 H1\nG1 X1 F60\n").ok);
  EXPECT_EQ(CodeOf("G1 X1 F60\nM6 T1\n"), ErrorCode::kRml1GcodeWord);
  EXPECT_EQ(CodeOf("G1 X1 F60\nM6\n"), ErrorCode::kRml1GcodeWord);
}

// Where work leaves the travel, X 0 to 200 mm and Z down to -40 mm of T1, the line is known.
TEST(FromGcode, TheFirstLineBeyondTheTravelIsKnown) {
  EXPECT_FALSE(From("G0 X300\nG1 X200 F60\nG1 Z-40\n").beyond_travel);
  EXPECT_EQ(From("G1 Z-1 F60\nX5\nX200.01\nX300\n").beyond_travel->line, 3);
  EXPECT_EQ(From("G1 Z-1 F60\nY-1\n").beyond_travel->line, 2);
  EXPECT_EQ(From("G1 Z-1 F60\nZ-40.01\n").beyond_travel->line, 2);
}

TEST(FromGcode, BoundsOfWhatIsMade) {
  const StreamOfGcode made = From("G1 X1 F60\nG1 X2\nG1 X3\nG1 X4\n", "t1", {.bytes_max = 40});
  EXPECT_FALSE(made.ok);
  EXPECT_EQ(made.findings.front().code, ErrorCode::kRml1ProductTooLarge);
  EXPECT_EQ(CodeOf("G1 X0 F60\nG2 I80000 J1\n"), ErrorCode::kRml1GcodeRange);
  EXPECT_FALSE(From("G1 X0 F60\nG2 I80000\n", "t1", {.tolerance_mm = 1e-7}).ok);
  EXPECT_FALSE(FromGcode("G0 X1", ParametersOf("t1"), {.tolerance_mm = 0.0}));
  EXPECT_FALSE(FromGcode("", ParametersOf("t1")));
}

// docs/gcode.md has the table of words.
TEST(FromGcode, ThePageHasTheWordsOfTheTable) {
  const std::string page = ReadFile(std::string(RMLCELL_SOURCE_DIR) + "/docs/gcode.md");
  std::string wanted;
  for (const GcodeRow& row : kGcodeRows) {
    std::string word = row.letter + std::to_string(row.tenths / 10);
    if (row.tenths % 10 != 0) word += "." + std::to_string(row.tenths % 10);
    wanted = "\n| `" + word + "` | " + std::string(row.text) + " | ";
    EXPECT_NE(page.find(wanted), std::string::npos) << wanted;
  }
  // And no other: rows of words stand before the table of letters.
  const std::string words = page.substr(0, page.find("| letter |"));
  std::size_t rows = 0;
  for (std::size_t at = words.find("\n| `"); at != std::string::npos;
       at = words.find("\n| `", at + 1))
    ++rows;
  EXPECT_EQ(rows, kGcodeRows.size());
}

void ExpectSamePath(const std::string& stream, std::string_view profile) {
  const Result<GcodeText> gcode = ToGcode(stream, ParametersOf(profile));
  ASSERT_TRUE(gcode) << gcode.error().detail;
  const StreamOfGcode again = From(gcode->text, profile);
  ASSERT_TRUE(again.ok) << (again.findings.empty() ? "" : again.findings.front().detail);
  const std::vector<Units> wanted = PathOf(stream, profile);
  const std::vector<Units> got = PathOf(again.stream, profile);
  ASSERT_EQ(wanted.size(), got.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    ASSERT_EQ(wanted[i], got[i]) << i << " of " << wanted.size();
}

// Motions of every kind, in and out of the travel, in both modes, with heights and origins.
std::string RandomStream(std::mt19937& random) {
  const auto number = [&](int low, int high) {
    return std::to_string(low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1)));
  };
  std::string stream;
  const int commands = 1 + static_cast<int>(random() % 40);
  for (int i = 0; i < commands; ++i) {
    const std::string x = number(-3000, 23000), y = number(-3000, 17000), z = number(-4500, 2500);
    switch (random() % 16) {
      case 0:
        stream += "PU" + x + "," + y + ";";
        break;
      case 1:
        stream += "PD" + x + "," + y + ";";
        break;
      case 2:
        stream += "Z" + x + "," + y + "," + z + "\n";
        break;
      case 3:
        stream += "PR" + number(-900, 900) + "," + number(-900, 900) + ";";
        break;
      case 4:
        stream += "PA" + x + "," + y + ";";
        break;
      case 5:
        stream += "!PZ" + number(-900, 0) + "," + number(0, 900) + ";";
        break;
      case 6:
        stream += "!ZM" + number(-6000, 0) + ";";
        break;
      case 7:
        stream += "!ZO" + number(-4000, -1000) + ";";
        break;
      case 8:
        stream += "VS" + number(0, 70) + ";";
        break;
      case 9:
        stream += "!VZ" + number(0, 70) + ";";
        break;
      case 10:
        stream += "!MC" + number(0, 1) + ";";
        break;
      case 11:
        stream += "!DW" + number(0, 200) + ";";
        break;
      case 12:
        stream += "H;";
        break;
      case 13:
        stream += "IN;";
        break;
      case 14:
        stream += "!RC" + number(0, 20) + ";";
        break;
      default:
        stream += "D" + x + "," + y + "," + x + "," + y + ";";
        break;
    }
  }
  return stream;
}

TEST(GcodeRoundTrip, TheToolGoesTheSameWayOverRandomStreams) {
  std::mt19937 random(20261123);  // NOLINT: the same streams in every run
  for (int i = 0; i < 400; ++i) {
    const std::string stream = RandomStream(random);
    SCOPED_TRACE(stream);
    ExpectSamePath(stream, i % 3 == 0 ? "mdx-40a" : i % 3 == 1 ? "t1" : "mdx-20");
    if (HasFatalFailure()) return;
  }
}

TEST(GcodeRoundTrip, TheToolGoesTheSameWayOverTheCorpus) {
  const std::string corpus = std::string(RMLCELL_SHARED_DIR) + "/corpus/rml1";
  if (!std::filesystem::exists(corpus)) GTEST_SKIP() << "no corpus at " << corpus;
  int programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    const std::string extension = entry.path().extension();
    if (extension != ".rml" && extension != ".prn") continue;
    SCOPED_TRACE(entry.path());
    ExpectSamePath(ReadFile(entry.path()), "srm-20");
    if (HasFatalFailure()) return;
    ++programs;
  }
  EXPECT_EQ(programs, 25);
}

// The MDX-40A: 50 mm/s in X and Y, 30 with Z. Behind a two-axis cut the tool stands at its end,
// from where it comes back; speed and heights that hold already are not said again, and what comes
// back to the place where the tool stands is no motion. RML1-3A.07: below the travel there is no
// tool-down height, so the three-axis command leads there.
TEST(FromGcode, TwoAxisMotionsBehindEachOther) {
  EXPECT_EQ(Body("G1 Z-1 F600\nG1 X5 F2400\nG1 X0\n", "mdx-40a"),
            "!VZ10;\nZ0,0,-100;\nVS40;\n!PZ-100,0;\nPD500,0;\nPD0,0;\n");
  EXPECT_EQ(Body("G0 Z1\nG0 X1\nG0 X0\n"), "!VZ60;\nZ0,0,100;\n!PZ0,100;\nPU100,0;\nPU0,0;\n");
  EXPECT_EQ(Body("G1 Z-85.01 F600\nX5 F2400\n", "mdx-40a"),
            "!VZ10;\nZ0,0,-8501;\n!VZ30;\nZ500,0,-8501;\n");
  EXPECT_EQ(Body("G1 Z0 F600\nG1 X0\nG1 X1\n"), "!VZ10;\nZ0,0,0;\nZ100,0,0;\n");
}

// RML1-3A.57: a wait stands before the two-axis cut, too, and before no other one.
TEST(FromGcode, WaitsBeforeTwoAxisCuts) {
  EXPECT_EQ(Body("G1 Z-1 F600\nG4 P0.5\nG1 X5 F2400\nG1 X6\n", "mdx-40a"),
            "!VZ10;\nZ0,0,-100;\nVS40;\n!PZ-100,0;\n!DW500;\nPD500,0;\n!DW0;\nPD600,0;\n");
}

// What kind of finding a speed is that the machine has not, or that is set by hand; a speed that is
// set already is not said again. RML1-9.31: 5 of 15 stages from 4500 to 15000 rpm are 8000.
TEST(FromGcode, SpeedsOfTheSpindleAndTheirFindings) {
  const StreamOfGcode rounded = From("G1 Z0 F100\nS700\n");
  ASSERT_EQ(rounded.findings.size(), 2U);
  for (const Diagnostic& finding : rounded.findings)
    EXPECT_EQ(finding.code, ErrorCode::kRml1SpeedRounded) << finding.detail;
  const StreamOfGcode by_hand = From("S8100\n", "t1f");
  ASSERT_EQ(by_hand.findings.size(), 1U);
  EXPECT_EQ(by_hand.findings[0].code, ErrorCode::kRml1GcodeIgnored);
  EXPECT_EQ(by_hand.findings[0].detail, "S, the spindle speed of this machine is set by hand");
  const StreamOfGcode staged = From("S8100\n", "t1s");
  ASSERT_EQ(staged.findings.size(), 1U);
  EXPECT_EQ(staged.findings[0].detail, "S8100 becomes 8000 rpm");
  EXPECT_EQ(Body("S6600\nS6600 M3\nS6600\n"), "!RC6600;\n!MC1;\n!MC0;\n");
}

}  // namespace
}  // namespace rmlcell::rml1
