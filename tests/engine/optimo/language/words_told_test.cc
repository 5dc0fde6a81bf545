#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/flow_field.h"
#include "engine/optimo/language/printer.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/optimo/language/compile_text.h"

// What findings say of words, where they stand, and that nothing behind the end of a text is read.
namespace rmlcell::optimo {
namespace {

std::vector<Diagnostic> FoundIn(std::string_view text, ErrorCode code, bool advice = false) {
  std::vector<Diagnostic> found;
  for (const Diagnostic& d : Compile(text, "", {.advice = advice}).diagnostics) {
    if (d.code == code) found.push_back(d);
  }
  return found;
}

struct TextRow {
  std::string program;
  ErrorCode code;
  std::string detail;
  std::string arguments;
};

TEST(WordsTold, FindingsNameTheirWords) {
  const std::vector<TextRow> rows = {
      {"DECLARE LONGNAMEOF = 1\n", ErrorCode::kNameTruncated, "'LONGNAMEOF' counts as LONGNAME",
       "name='LONGNAMEOF' counts_as='LONGNAME'"},
      {"SPEED\nDELAY 1\n", ErrorCode::kSyntax, "expected a number, a variable, a name or '('",
       "expected='a number, a variable, a name or '(''"},
      {"SPEED", ErrorCode::kSyntax, "expected a number, a variable, a name or '('",
       "expected='a number, a variable, a name or '(''"},
      {"VR[1] = 1 +", ErrorCode::kUnexpectedEnd,
       "expected a number, a variable, a name or '(' before the end of the text",
       "expected='a number, a variable, a name or '(''"},
      {"CALL 3 ()\n", ErrorCode::kSyntax, "expected a parameter, found ')'",
       "expected='a parameter' found=')'"},
      {"DECLARE TEN = 10\nDECLARE TEN = 5\n", ErrorCode::kNameDuplicate, "TEN is declared already",
       "name='TEN'"},
      {"WORK 0,0/ON/FLY\n", ErrorCode::kAttributeNotAllowed, "WORK has no attribute FLY",
       "instruction='WORK' attribute='FLY'"},
      {"WORKDEF 1,0 ()\n", ErrorCode::kArgumentCount,
       "WORKDEF has 0 values, needs some between its parentheses",
       "instruction='WORKDEF' values=0 needed='some between its parentheses'"},
      {"VR[1] = X\nDECLARE X = 1\n", ErrorCode::kNameUndeclared,
       "X is not declared before it is used", "name='X'"},
      {"DECLARE X = 1.5\nVR[X] = 1\n", ErrorCode::kIndexRange,
       "X is no INTEGER constant from 0 to 99", "name='X' most=99"},
      {"DECLARE X = 1\nX = 2\n", ErrorCode::kConstantAssigned, "X is a constant", "name='X'"},
  };
  for (const TextRow& row : rows) {
    const std::vector<Diagnostic> found = FoundIn(row.program, row.code);
    ASSERT_EQ(found.size(), 1U) << row.program;
    EXPECT_EQ(found[0].detail, row.detail);
    EXPECT_EQ(ArgumentsText(found[0].detail), row.arguments) << row.program;
  }
}

// OPT-1.32: a byte order mark is told as one, and can be taken out.
TEST(WordsTold, AByteOrderMark) {
  const auto found = FoundIn(
      "\xEF\xBB\xBF"
      "DELAY 1\n",
      ErrorCode::kBadCharacter);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].detail, "a byte order mark stands before the text");
  EXPECT_EQ(found[0].rule, "OPT-1.32");
}

// Where a value is of the wrong type its operator is shown: NOT, a function, a sign.
TEST(WordsTold, PlacesOfOperators) {
  const auto place = [](const std::string& text) {
    for (const Diagnostic& d : Compile(text, "", {.advice = false}).diagnostics)
      return text.substr(static_cast<std::size_t>(d.where.byte_offset),
                         static_cast<std::size_t>(d.where.length));
    return std::string("nothing");
  };
  EXPECT_EQ(place("VR[1] = 1 + (NOT VL[1])\n"), "NOT");
  EXPECT_EQ(place("VR[1] = 1 + (NOT NOT VL[1])\n"), "NOT");
  EXPECT_EQ(place("VL[1] = SIN(VR[1]) AND VL[2]\n"), "SIN");
  EXPECT_EQ(place("VL[1] = VL[2] AND SQRT(VR[1])\n"), "SQRT");
  EXPECT_EQ(place("VL[1] = (-VR[1]) AND VL[2]\n"), "-");
}

// OPT-7.104 to OPT-7.106: the first and the last variable of each range that is not the customer's.
TEST(WordsTold, RangesOfReservedVariables) {
  const auto told = [](const std::string& text, ErrorCode code) {
    return FoundIn(text + "\n", code, true).size();
  };
  const auto reserved = [&](const std::string& name, const std::string& value) {
    return told(name + "=" + value, ErrorCode::kReservedVariable);
  };
  for (const std::string index : {"43", "59", "98", "99"})
    EXPECT_EQ(reserved("VR[" + index + "]", "1."), 1U) << index;
  for (const std::string index : {"42", "60", "97"})
    EXPECT_EQ(reserved("VR[" + index + "]", "1."), 0U) << index;
  EXPECT_EQ(reserved("VI[70]", "1"), 1U);
  EXPECT_EQ(reserved("VI[69]", "1"), 0U);
  EXPECT_EQ(reserved("VL[80]", "ON"), 1U);
  EXPECT_EQ(reserved("VL[79]", "ON"), 0U);
  for (const std::string output : {"0", "7", "10", "12", "15", "17", "31"})
    EXPECT_EQ(told("OL[" + output + "]=ON", ErrorCode::kSystemOutput), 1U) << output;
  for (const std::string output : {"8", "9", "11", "16", "32", "99"})
    EXPECT_EQ(told("OL[" + output + "]=ON", ErrorCode::kSystemOutput), 0U) << output;
}

// OPT-7.102, OPT-7.106: an ASSIGN switches as many outputs as it says, sixteen at the most.
TEST(WordsTold, WidthsOfAssign) {
  const auto told = [](int first, int width) {
    const std::string text =
        "ASSIGN OL[" + std::to_string(first) + "]=0 /" + std::to_string(width) + "\n";
    return FoundIn(text, ErrorCode::kSystemOutput, true).size();
  };
  EXPECT_EQ(told(8, 2), 0U);
  EXPECT_EQ(told(8, 3), 1U);
  EXPECT_EQ(told(16, 1), 0U);
  EXPECT_EQ(told(16, 16), 1U);
  EXPECT_EQ(told(32, 16), 0U);
}

// lexer.h: a statement of too many words is told once, and the one behind its line is read.
TEST(WordsTold, BehindAStatementThatIsTooLong) {
  std::string text = "VR[1]=1";
  for (int n = 0; n < 50'001; ++n) text += "+1";
  const Compilation compiled = Compile(text + "\nDELAY\nSPEED 5\n", "", {.advice = false});
  ASSERT_EQ(compiled.diagnostics.size(), 2U);
  EXPECT_EQ(compiled.diagnostics[0].where.line, 1);
  EXPECT_EQ(compiled.diagnostics[1].where.line, 2);
}

// OPT-5.46: cutting takes 5 to 15 %, both included.
TEST(WordsTold, SpeedsOfCutting) {
  const auto told = [](const std::string& speed) {
    std::size_t count = 0;
    for (const Diagnostic& d : FoundIn(
             "COORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nOL[11]=ON\nWORK 0,0/ON\nDELAY 1.\nSPEED " +
                 speed + "\nMOVE (9,0,0,0,0)\nWORK 0,0/OFF\n",
             ErrorCode::kPracticeAdvice, true))
      count += d.rule == "OPT-5.46";
    return count;
  };
  EXPECT_EQ(told("5."), 0U);
  EXPECT_EQ(told("15."), 0U);
  EXPECT_EQ(told("4.99"), 1U);
  EXPECT_EQ(told("15.01"), 1U);
}

// OPT-2.51: shorter than 1 mm; the angles of the moves need no numbers for that.
TEST(WordsTold, ShortMovesWithFly) {
  const auto told = [](const std::string& x, const std::string& a) {
    return FoundIn("COORD ABSOL\nPATH LIN\nMOVE (0,0,0," + a + ",0)\nMOVE (" + x + ",0,0," + a +
                       ",0)/FLY\nMOVE (5,0,0,0,0)\n",
                   ErrorCode::kShortFly, true)
        .size();
  };
  for (const std::string a : {"0", "VR[1]"}) {
    EXPECT_EQ(told("0.99", a), 1U) << a;
    EXPECT_EQ(told("1.", a), 0U) << a;
  }
}

// OPT-4.55: as high is not below.
TEST(WordsTold, HeightsOfTcp) {
  EXPECT_EQ(FoundIn("TCP (0,0,1/0,0,1)\n", ErrorCode::kTcpReversed, true).size(), 0U);
  EXPECT_EQ(FoundIn("TCP (0,0,1/0,0,1.5)\n", ErrorCode::kTcpReversed, true).size(), 1U);
  EXPECT_EQ(FoundIn("TCP (0,0,1/0,0,0.5)\n", ErrorCode::kTcpReversed, true).size(), 0U);
}

// OPT-7.46, OPT-7.60: what is just long enough, and just in its range.
TEST(WordsTold, WhatIsJustInItsRange) {
  EXPECT_EQ(FoundIn("DECLARE EIGHTLET = 1\n", ErrorCode::kNameTruncated).size(), 0U);
  EXPECT_EQ(FoundIn("DECLARE NINELETTE = 1\n", ErrorCode::kNameTruncated).size(), 1U);
  EXPECT_EQ(FoundIn("DECLARE X = 99\nVR[X] = 1\n", ErrorCode::kIndexRange).size(), 0U);
  EXPECT_EQ(FoundIn("DECLARE X = 100\nVR[X] = 1\n", ErrorCode::kIndexRange).size(), 1U);
  EXPECT_EQ(FoundIn("DECLARE X = 7\nPAR[X] = 1\n", ErrorCode::kIndexRange).size(), 0U);
  EXPECT_EQ(FoundIn("DECLARE X = 8\nPAR[X] = 1\n", ErrorCode::kIndexRange).size(), 1U);
  EXPECT_TRUE(Compile("WORKDEF 2,9 (63)\nWORK 2,9/ON\nWORK 2,9/OFF\n", "", {.advice = false}).ok);
  EXPECT_FALSE(Compile("WORK 2,10/ON\n", "", {.advice = false}).ok);
  EXPECT_FALSE(Compile("WORK 3,9/ON\n", "", {.advice = false}).ok);
}

// lexer.h: a statement has 100,000 words at most.
TEST(WordsTold, TheMostWordsOfAStatement) {
  const auto codes = [](const std::string& value) {
    std::string text = "VR[1]=" + value;  // five words and those of the value
    for (int n = 0; n < 49'997; ++n) text += "+1";
    std::vector<ErrorCode> found;
    for (const Diagnostic& d : Compile(text + "\n", "", {.advice = false}).diagnostics)
      found.push_back(d.code);
    return found;
  };
  EXPECT_NE(codes("1"), codes("-1"));
  EXPECT_EQ(codes("-1"), codes("--1"));
}

// OPT-7.62: the largest number is one, and the next one is too large.
TEST(WordsTold, TheLargestNumber) {
  EXPECT_TRUE(Compile("VR[1]=9223372036854775808.\n", "", {.advice = false}).ok);
  EXPECT_FALSE(Compile("VR[1]=9223373136366403584.\n", "", {.advice = false}).ok);
}

// OPT-7.45: behind a DECLARE of a reserved word, which is told, the word stands for the name.
TEST(WordsTold, ANameThatIsReservedIsToldOnce) {
  for (const std::string use : {"VR[1] = SPEED\n", "VR[1] = 2*SPEED\n", "LET SPEED = 2\n"}) {
    EXPECT_EQ(FoundIn("DECLARE SPEED = 1\n" + use, ErrorCode::kNameReserved).size(), 1U) << use;
    EXPECT_EQ(FoundIn("DECLARE SPEED = 1\n" + use, ErrorCode::kSyntax).size(), 0U) << use;
  }
}

// printer.h: parentheses that the printed text needs, on either side of an operator.
TEST(WordsTold, NestingOfPrintedText) {
  const auto nesting = [](const std::string& value) {
    const Compilation compiled = MustCompile("VR[9]=" + value + "\n");
    return PrintedNesting(compiled.module.Value(compiled.module.instructions[0], 1), false);
  };
  EXPECT_EQ(nesting("VR[1]*VR[2]+VR[3]"), 0);
  EXPECT_EQ(nesting("VR[1]+VR[2]*VR[3]"), 0);
  EXPECT_EQ(nesting("(VR[1]+VR[2])*VR[3]"), 1);
  EXPECT_EQ(nesting("VR[1]*(VR[2]+VR[3])"), 1);
  EXPECT_EQ(nesting("VR[1]-(VR[2]-VR[3]*(VR[4]+VR[5]))"), 2);
}

// flow_field.h: of modes one behind the other each keeps what the second one does not set.
TEST(WordsTold, ModesOneBehindTheOther) {
  Modes both = Modes::AtStart();
  both.SetCoord(CoordType::kAbsol);
  both.SetPath(PathType::kLin);
  Modes path = Modes::Kept();
  path.SetPath(PathType::kHole);
  Modes coord = Modes::Kept();
  coord.SetCoord(CoordType::kRobot);
  Modes next = both;
  next.Then(path);
  EXPECT_EQ(next.coord(), CoordType::kAbsol);
  EXPECT_EQ(next.path(), PathType::kHole);
  next.Then(coord);
  EXPECT_EQ(next.coord(), CoordType::kRobot);
  EXPECT_EQ(next.path(), PathType::kHole);
}

// OPT-7.62: of a number of many digits the exponent counts once.
TEST(WordsTold, LongNumbersWithAnExponent) {
  const auto value = [](const std::string& number) {
    const Compilation compiled = MustCompile("VR[1]=" + number + "\n");
    return compiled.module.Value(compiled.module.instructions[0], 1)[0].number;
  };
  EXPECT_FLOAT_EQ(value("1.23456789012345678901E3"), 1234.5679F);
  EXPECT_FLOAT_EQ(value("1.23456789012345678901E-3"), 0.0012345679F);
  EXPECT_FLOAT_EQ(value("123456789012345678901.5E-18"), 123.45679F);
}

// All that a compilation says.
std::string SaidOf(std::string_view text) {
  const Compilation compiled = Compile(text, "", {.advice = true});
  std::string said = compiled.object;
  for (const Diagnostic& d : compiled.diagnostics) {
    said += "\n" + std::to_string(d.where.line) + ":" + std::to_string(d.where.column) + "+" +
            std::to_string(d.where.length) + "@" + std::to_string(d.where.byte_offset) + " " +
            d.detail;
    for (const Fix& fix : d.fixes)
      said += " [" + std::to_string(fix.byte_offset) + "+" + std::to_string(fix.length) + fix.text +
              "]";
  }
  return said;
}

// A text ends where it ends: what lies behind it in memory is no part of it, whatever it is and
// wherever the text ends.
TEST(WordsTold, NothingBehindTheTextIsRead) {
  const std::string programs[] = {
      "10 DECLARE N=12 ; rmlcell: allow 7317\r\n20\tVR[ 12 ]=-1.5E-3+N\r\n"
      "IF VL[3] AND IL[20] THEN GOTO 20\nMOVE(1,2.25,3,4,5)/VIA(1,2,3,4,5)/FLY ;end\r"
      "\nWORK 0,0 /ON/TIME(1.5,10)\n30 NAME = 7\nPATH HOLE (5.)\nCALL 12(1,VR[2])\n",
      // Lines behind an open parenthesis or an operator, before and after an error.
      "VR[1]=1+\n10 DELAY 5\nVR[2]=(1+#\nNAME = 5\nVR[3]=(2+##,\nVR [ N ] = 1\n"
      "VL[1]=VR[1]<VR[2]\nVL[2]=1<=2\nVL[3]=1<>2\nCONT 3 x\nVR[4]=007.5\nVR[5]=0\n",
      "VR[1]=1+\nFUNCTION 7\n"};
  for (const std::string& program : programs)
    for (std::size_t size = 1; size <= program.size(); ++size) {
      const std::string alone = program.substr(0, size);
      const std::string said = SaidOf(alone);
      for (const char behind : std::string_view("07aX.]=; \n\r(/+E")) {
        const std::string longer = alone + behind + "1=]";
        ASSERT_EQ(SaidOf(std::string_view(longer).substr(0, size)), said)
            << "'" << alone.substr(alone.size() - std::min<std::size_t>(alone.size(), 20))
            << "' before '" << behind << "'";
      }
    }
}

}  // namespace
}  // namespace rmlcell::optimo
