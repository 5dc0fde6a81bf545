// What the device says about a stream: code, rule, words, place and step of each finding.
#include "engine/rml1/finding.h"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

struct Case {
  std::string_view stream;
  std::string_view finding;  // "code rule offset+length step: detail"
  std::string_view profile = "t1";
};

std::string FirstFinding(const Case& c) {
  machine::Parameters parameters = ParametersOf(c.profile);
  EXPECT_TRUE(parameters.Set("SEQUENCES", c.stream.starts_with("\x1b.k") ? "K" : "ALL").ok());
  const machine::Translation translation =
      Rml1Family().Translate({.name = "a", .bytes = c.stream}, parameters, {.advice = true});
  if (translation.diagnostics.empty()) return "none";
  const Diagnostic& d = translation.diagnostics[0];
  std::ostringstream out;
  out << CodeText(d.code) << " " << d.rule << " " << d.where.byte_offset << "+" << d.where.length
      << " " << d.step << ": " << d.detail;
  EXPECT_EQ(d.where.column, d.where.byte_offset + 1);
  EXPECT_EQ(d.severity, Lookup(d.code).severity);
  return out.str();
}

// RML1-6.01, RML1-6.02, RML1-6.03, RML1-6.07: one entry for each discarded byte, name, or command.
TEST(Finding, OfCommandErrors) {
  const Case cases[] = {
      {"PU;$", "RML1-E1 RML1-2.05 3+1 0: '$' begins no command"},
      {"PU;\x7f", "RML1-E1 RML1-2.05 3+1 0: 0x7F begins no command"},
      {"PU;\xa5", "RML1-E1 RML1-2.05 3+1 0: 0xA5 begins no command"},
      {"PU;X  Y;", "RML1-E1 RML1-2.09 3+4 0: the name that ends with 'Y' is no command"},
      {"PU;! QQ;", "RML1-E1 RML1-2.09 3+4 0: the name that ends with 'Q' is no command"},
      {"PU;!3", "RML1-E1 RML1-2.09 3+2 0: the name that ends with '3' is no command"},
      {"PU;-", "RML1-E2 RML1-2.02 3+1 0: '-' where a command is expected"},
      {"PU;DF5;", "RML1-E2 RML1-2.02 5+1 0: '5' where a command is expected"},
      {"PU;IN5;", "RML1-E2 RML1-2.02 5+1 0: '5' where a command is expected"},
      {"^PU;H5;", "RML1-E2 RML1-2.02 5+1 0: '5' where a command is expected"},
      {"PU;^ QR;",
       "RML1-E2 RML1-3A.31 5+2 0: the name after ^ that ends with 'R' is no command "
       "of two letters"},
      {"PU;!ZE X1 X2;", "RML1-E2 RML1-3D.15 10+1 2: axis 'X' twice in one group"},
      {"PU;!ZE X;", "RML1-E3 RML1-3D.16 8+1 2: an axis letter without a number"},
      {"PU;!ZE X-;", "RML1-E3 RML1-3D.16 9+1 2: an axis letter without a number"},
      {"PU;!ZE 1;", "RML1-E3 RML1-3D.17 7+1 2: '1' where an axis letter is expected"},
      {"PU;!ZE X1:Y1A2;", "RML1-E3 RML1-3D.13 3+3 2: Y and A cannot move in one group", "t1a"},
      {"PU;PD1;", "RML1-E2 RML1-9.15 3+2 2: PD lacks a number of its last set"},
      {"PU;Z1,2;", "RML1-E2 RML1-9.15 3+1 2: Z lacks a number of its last set"},
      {"PU;PD1,9e;PD0,9000000;",
       "RML1-E1 RML1-2.09 8+1 0: the name that ends with ';' is no "
       "command"},
      {"PU;PD0,9000000;", "RML1-E3 RML1-2.34 3+2 2: a coordinate of PD becomes 9e+06"},
      {"PD8000000,0;PR;R8000000,0;",
       "RML1-E8002 RML1-5A.01 0+2 1: the tool could not follow PD to "
       "its end"},
      {"!ZE X9000000;", "RML1-E3 RML1-2.34 0+3 1: a coordinate of !ZE becomes 9e+06"},
      {"PU;@1;", "RML1-E3 RML1-3C.13 3+1 2: a tool height of 1, allowed are -4000 to 0"},
      {"PU;!PZ0,-2;", "RML1-E3 RML1-3C.13 3+3 2: a tool height of -2, allowed are 0 to 8388607"},
      {"PU;!PZ0,9000000;",
       "RML1-E3 RML1-3C.13 3+3 2: a tool height of 9000000, allowed are 0 to 8388607"},
      {"PU;W-1;", "RML1-E3 RML1-2.33 3+1 2: W -1"},
      {"PU;V40000;", "RML1-E3 RML1-2.33 3+1 2: V 40000"},
      {"PU;!RC-3;", "RML1-E3 RML1-2.33 3+3 2: !RC -3"},
      {"PU;!ZM1;", "RML1-E3 RML1-3C.29 3+3 2: !ZM leads to machine Z 1"},
      {"PU;!ZO-6001;", "RML1-E3 RML1-3C.29 3+3 2: !ZO leads to machine Z -6001"},
  };
  for (const Case& c : cases) EXPECT_EQ(FirstFinding(c), c.finding) << c.stream;
}

// RML1-4.05, RML1-4.15, RML1-4.16, RML1-4.19: communication errors have a byte and no command.
TEST(Finding, OfCommunicationErrors) {
  const Case cases[] = {
      {"\x1b.k", "RML1-E11 RML1-4.05 2+1 0: "},
      {"PU;\x1b.Mx", "RML1-E12 RML1-4.16 6+1 0: "},
      {"PU;\x1b.M65536:", "RML1-E13 RML1-4.15 11+1 0: "},
      {"PU;\x1b.T1;2;3;4;5;6:", "RML1-E14 RML1-4.19 15+1 0: "},
  };
  for (const Case& c : cases) EXPECT_EQ(FirstFinding(c), c.finding) << c.stream;
}

// RML1-3A.46, RML1-9.48: advice, with the command that it is about.
TEST(Finding, OfAdvice) {
  const Case cases[] = {
      {"PU;F99;", "RML1-E8003 RML1-3A.46 3+1 2: F 99 is beyond the machine"},
      {"PU;!VZ0.2;", "RML1-E8003 RML1-3A.46 3+3 2: !VZ 0.2 is beyond the machine"},
      {"!MC;!SL1;", "RML1-E8005 RML1-9.48 4+3 2: !SL was skipped", "mdx-540"},
  };
  for (const Case& c : cases) EXPECT_EQ(FirstFinding(c), c.finding) << c.stream;
}

// Printing characters are shown as they are, blanks and all others by their number.
TEST(Finding, NamesEveryByte) {
  const auto named = [](unsigned char byte) {
    Finding finding{.kind = FindingKind::kForeignCharacter};
    finding.byte = byte;
    return DetailOf(finding);
  };
  for (const auto& [byte, name] : {std::pair<unsigned char, std::string>{0x00, "0x00"},
                                   {0x1F, "0x1F"},
                                   {0x20, "0x20"},
                                   {0x21, "'!'"},
                                   {0x7E, "'~'"},
                                   {0x7F, "0x7F"},
                                   {0xAB, "0xAB"},
                                   {0xFF, "0xFF"}}) {
    EXPECT_EQ(named(byte), name + " begins no command");
  }
}

// RML1-4.20: what no byte of a stored program can raise has its row as well.
TEST(Finding, RowsAreThoseOfTheTable) {
  EXPECT_EQ(RowOf(FindingKind::kLineError).code, ErrorCode::kRml1LineError);
  EXPECT_EQ(RowOf(FindingKind::kLineError).rule, "RML1-4.23");
  EXPECT_EQ(RowOf(FindingKind::kBufferOverflow).code, ErrorCode::kRml1BufferOverflow);
  EXPECT_EQ(RowOf(FindingKind::kLogCut).code, ErrorCode::kRml1LogCut);
  EXPECT_TRUE(IsError(FindingKind::kBufferOverflow));
  EXPECT_FALSE(IsError(FindingKind::kSpeedLimited));
}

// Places forwards and backwards, at both ends of the stream and beyond them.
TEST(LineCounter, GoesBothWays) {
  const std::string_view stream = "ab\ncd\n\nef";
  const auto place = [](const SourceSpan& at) {
    return std::to_string(at.line) + ":" + std::to_string(at.column);
  };
  const std::string expected[] = {"1:1", "1:2", "1:3", "2:1", "2:2",
                                  "2:3", "3:1", "4:1", "4:2", "4:3"};
  for (std::int64_t first = 0; first < 10; ++first) {
    for (std::int64_t second = 0; second < 10; ++second) {
      LineCounter lines;
      EXPECT_EQ(place(lines.At(stream, first, 1)), expected[first]) << first;
      EXPECT_EQ(place(lines.At(stream, second, 1)), expected[second]) << first << " " << second;
    }
  }
  LineCounter lines;
  EXPECT_EQ(place(lines.At(stream, 99, 1)), "4:3");
  EXPECT_EQ(place(lines.At(stream, -5, 1)), "1:1");
}

}  // namespace
}  // namespace rmlcell::rml1
