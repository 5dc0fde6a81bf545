#include "engine/optimo/language/lexer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/language/program.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::string Kinds(std::string_view text) {
  std::vector<Comment> comments;
  Lexer lexer(text, comments);
  std::string out;
  while (lexer.NextStatement()) {
    for (std::size_t i = 0; lexer.At(i).kind != TokenKind::kEnd; ++i) {
      out += std::string(lexer.TextOf(lexer.At(i))) + "|";
    }
    out += "\n";
  }
  return out;
}

// OPT-1.30
TEST(Lexer, StatementsReachOverLines) {
  EXPECT_EQ(Kinds("MOVE (1.,\n; c\n\n2.)\n/FLY\nSPEED 5"), "MOVE|(|1.|,|2.|)|/|FLY|\nSPEED|5|\n");
  EXPECT_EQ(Kinds("VR[1] = 2. +\n3.\nSTOP"), "VR|[|1|]|=|2.|+|3.|\nSTOP|\n");
  EXPECT_EQ(Kinds("15\n(1)\n"), "15|\n(|1|)|\n");
  // Where a line begins with what cannot begin a statement.
  EXPECT_EQ(Kinds("UPDATE IL\n, OL\n/ON\nSTOP"), "UPDATE|IL|,|OL|/|ON|\nSTOP|\n");
  EXPECT_EQ(Kinds("SPEED 5\n)\nSTOP"), "SPEED|5|)|\nSTOP|\n");
}

// OPT-1.30: behind an operator that is a word, and inside a parenthesis behind any word.
TEST(Lexer, StatementsReachOverLinesBehindWords) {
  EXPECT_EQ(Kinds("VL[1] = ON AND\nOFF\nSTOP"), "VL|[|1|]|=|ON|AND|OFF|\nSTOP|\n");
  EXPECT_EQ(Kinds("VR[1] = (X\n+ 1)\nSTOP"), "VR|[|1|]|=|(|X|+|1|)|\nSTOP|\n");
  EXPECT_EQ(Kinds("VR[1] = 2. +\nSIN(1.)\nSTOP"), "VR|[|1|]|=|2.|+|SIN|(|1.|)|\nSTOP|\n");
  EXPECT_EQ(Kinds("MOVE\n(1.)\nSTOP"), "MOVE|(|1.|)|\nSTOP|\n");
  // What would be an assignment elsewhere is a comparison there.
  EXPECT_EQ(Kinds("VL[1] = (1 +\nX = 5)\nSTOP"), "VL|[|1|]|=|(|1|+|X|=|5|)|\nSTOP|\n");
  EXPECT_EQ(Kinds("PATH LIN\nX = 1\n"), "PATH|LIN|\nX|=|1|\n");
  EXPECT_EQ(Kinds("MOVE (1.,\nCONT 3\n"), "MOVE|(|1.|,|\nCONT|3|\n");
}

// An instruction word ends whatever was left open.
TEST(Lexer, InstructionWordsBeginAStatement) {
  EXPECT_EQ(Kinds("MOVE (1.,\n20 SPEED 5\n"), "MOVE|(|1.|,|\n20|SPEED|5|\n");
  EXPECT_EQ(Kinds("MOVE (1.,\nFUNCTION 44\n"), "MOVE|(|1.|,|\nFUNCTION|44|\n");
  EXPECT_EQ(Kinds("VR[1] = 2. +\nFUNCTIONX\n"), "VR|[|1|]|=|2.|+|FUNCTIONX|\n");  // a name
  // A parenthesis that closes nothing opens none.
  EXPECT_EQ(Kinds(")(1\n+2"), ")|(|1|+|2|\n");
}

// OPT-7.45, OPT-1.02
TEST(Lexer, NamesHaveAllLettersAndDigits) {
  const std::string all = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  EXPECT_EQ(Kinds("VR[0]=" + all + "+1"), "VR|[|0|]|=|" + all + "|+|1|\n");
  EXPECT_EQ(MustCompile("Declare az09ZA = vr[1]\nZERO\nzero\npAtH PTP\nVR[0] = AZ09za\n").object,
            MustCompile("DECLARE AZ09ZA = VR[1]\nZERO\nZERO\nPATH PTP\nVR[0] = AZ09ZA\n").object);
}

// OPT-7.55, OPT-B.41
TEST(Lexer, ExponentsMayHaveBlanks) {
  EXPECT_EQ(Kinds("X = .256 E -3"), "X|=|.256 E -3|\n");
  EXPECT_EQ(Kinds("X = 5 EX"), "X|=|5|EX|\n");
  EXPECT_EQ(Kinds("X = 5 E + 3"), "X|=|5 E + 3|\n");
}

// OPT-7.56, OPT-B.37: literals are rounded once, to the nearest of 24 bits.
TEST(Lexer, LiteralsAreRoundedOnce) {
  const auto literal = [](const std::string& text) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  EXPECT_EQ(literal("1262.139005"), 1262.139005F);
  EXPECT_EQ(literal("16777217."), 16777216.0F);               // half way: to even
  EXPECT_EQ(literal("16777217.0000000000001"), 16777218.0F);  // a little more than half way
  EXPECT_EQ(literal("16777219."), 16777220.0F);
  EXPECT_EQ(literal("0.1"), 0.1F);
  EXPECT_EQ(literal("123456789012345678."), 123456789012345678.0F);
  EXPECT_EQ(literal("0." + std::string(60, '0') + "5"), 0.0F);
  EXPECT_EQ(literal("1E-50"), 0.0F);
  EXPECT_EQ(literal("0E23"), 0.0F);
  EXPECT_EQ(literal("1E-23"), 0.0F);
  EXPECT_EQ(literal("1E18"), 1E18F);
  EXPECT_EQ(literal("9.9999999999999999999"), 10.0F);  // twenty digits
  // Half way in double precision, and a little beside it in truth, on either side.
  EXPECT_EQ(literal("49.03273963928223"), 49.03273963928223F);
  EXPECT_EQ(literal("74.60992050170898"), 74.60992050170898F);
  EXPECT_EQ(literal("80.81708145141602"), 80.81708145141602F);
  EXPECT_EQ(literal("80.39683151245117"), 80.39683151245117F);
}

// OPT-7.56: 2^53 is 9007199254740992; of more digits a double does not hold all, and what is a
// little beside the half way between two floats must not come to lie on the other side of it.
TEST(Lexer, LiteralsOfMoreThanADoubleHoldsAreRoundedOnce) {
  const auto literal = [](const std::string& text) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  EXPECT_EQ(literal("925.9909973144531"), 925.990966796875F);  // next: 925.99102783203125
  EXPECT_EQ(literal("96.67728042602539"), 96.677276611328125F);
  EXPECT_EQ(literal("107.40089797973633"), 107.40090179443359375F);  // before: 107.400894165...
  EXPECT_EQ(literal("12116371188312769E-18"), 0.012116371188312769F);
  // Half way between two floats the last of however many digits decides.
  for (const std::size_t zeros : {389U, 390U, 391U, 392U, 1000U})
    EXPECT_EQ(literal("16777217." + std::string(zeros, '0') + "1"), 16777218.0F) << zeros;
  EXPECT_EQ(literal("16777217." + std::string(1000, '0')), 16777216.0F);
}

// OPT-7.59, OPT-7.62: 2^64 + 1 has twenty digits, and is not 1.
TEST(Lexer, TwentyDigitsAreNotFewer) {
  const Compilation compiled = MustCompile("VR[0] = 1.8446744073709551617\n");
  EXPECT_EQ(compiled.module.Value(compiled.module.instructions[0], 1)[0].number,
            1.8446744073709551617F);
  EXPECT_EQ(FindingsOf("VR[0] = 18446744073709551617\n"), std::vector<int>{7004});
  EXPECT_EQ(FindingsOf("VR[18446744073709551617] = 1.\n"), std::vector<int>{7017});
}

// OPT-7.55: with each exponent that a REAL can have.
TEST(Lexer, LiteralsHaveTheirPowerOfTen) {
  const auto literal = [](const std::string& text) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  for (int power = 0; power <= 18; ++power) {
    const std::string digits = std::to_string(power);
    for (const std::string& text :
         {"1E" + digits, "7.25E-" + digits, "125000E-" + digits, "3.5E" + digits})
      EXPECT_EQ(literal(text), std::stof(text)) << text;
  }
  for (int power = 19; power <= 24; ++power) {
    const std::string text = "1234567E-" + std::to_string(power);
    EXPECT_EQ(literal(text), std::stof(text)) << text;
  }
  EXPECT_EQ(literal("0E99"), 0.0F);
}

// OPT-7.55, OPT-7.62: of many digits as of few.
TEST(Lexer, LongLiteralsCountByTheirSize) {
  const auto literal = [](const std::string& text) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  const std::string zeros(60, '0'), many(450, '0');
  EXPECT_EQ(literal("1" + zeros + "E-60"), 1.0F);
  EXPECT_EQ(literal("1" + zeros + "E-99"), 0.0F);
  EXPECT_EQ(literal("." + zeros + "1E61"), 1.0F);
  EXPECT_EQ(literal("." + zeros + "1E5"), 0.0F);
  EXPECT_EQ(literal("0." + many + "1E5"), 0.0F);
  EXPECT_EQ(literal(many + "1.5"), 1.5F);
  EXPECT_EQ(literal("1.5" + many + "7"), 1.5F);
  EXPECT_EQ(literal(zeros + "." + zeros + "E99"), 0.0F);
  for (const std::string& text :
       {"1" + zeros, "1" + zeros + ".", "1" + many + "E-99", "." + zeros + "1E99"}) {
    EXPECT_EQ(FindingsOf("VR[0] = " + text + "\n"), std::vector<int>{7004}) << text;
  }
}

// OPT-7.62: 2^-64 is 5.42101086E-20; what is written smaller is 0.
TEST(Lexer, LiteralsBelowTheSmallestRealAreNothing) {
  const auto literal = [](const std::string& text) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  EXPECT_EQ(literal("5.42101086E-20"), 5.42101086e-20F);
  EXPECT_EQ(literal("5.421E-20"), 0.0F);
  EXPECT_EQ(literal("1E-30"), 0.0F);
}

// Work is linear in the text, whatever is wrong with it: no token is read more often than twice, by
// the statement that stopped before it and by its own.
TEST(Lexer, HostileTextIsReadTwiceAtMost) {
  const auto tokens_read = [](const std::string& line, int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += line;
    Findings findings(0);
    return Parse(text, findings, Places::kStatements).tokens_read;
  };
  struct Row {
    std::string line;
    std::uint64_t tokens;
  };
  const std::vector<Row> rows = {{"X = (1\n", 4},
                                 {"X = (\n", 3},
                                 {"MOVE (1.,\n", 4},
                                 {"VR[1] = 2. +\n", 7},
                                 {"VL[0] = VR[1] AND (2. /\n", 12},
                                 {"10 GOTO\n", 2},
                                 {"SPED 5 ; (\n", 2},
                                 {"# ,\n", 2},
                                 {")\n", 1}};
  for (const Row& row : rows) {
    EXPECT_LE(tokens_read(row.line, 20'000), 2 * 20'000 * row.tokens) << row.line;
  }
  EXPECT_EQ(tokens_read("SPEED 5\n", 1'000), 2'000U);  // and a right one once
}

// No text is too long for an answer.
TEST(Lexer, HostileTextHasItsFindings) {
  constexpr std::size_t kMany = 20'000'000;
  EXPECT_FALSE(Compile(std::string(kMany, '('), "", {}).ok);
  EXPECT_FALSE(Compile("X = " + std::string(kMany, '-') + "1", "", {}).ok);
  EXPECT_EQ(FindingsOf(std::string(kMany, 'A')), std::vector<int>{7011});
  EXPECT_EQ(FindingsOf(std::string(kMany, '\xC3')), std::vector<int>{7001});
  EXPECT_TRUE(Compile(std::string(kMany, '\n'), "", {}).ok);
}

}  // namespace
}  // namespace rmlcell::optimo
