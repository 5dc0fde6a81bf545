#include "engine/optimo/offline/convert.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/optimo/language/program.h"
#include "tests/engine/optimo/language/random_program.h"

namespace rmlcell::optimo {
namespace {

std::string Metric(const std::string& text) { return Convert(text, Direction::kToMetric).text; }
std::string Inch(const std::string& text) { return Convert(text, Direction::kToInch).text; }
std::vector<int> FindingsOf(const std::string& text) {
  std::vector<int> numbers;
  for (const Diagnostic& d : Convert(text, Direction::kToMetric).diagnostics)
    numbers.push_back(Lookup(d.code).number);
  return numbers;
}

// OPT-8.26, OPT-8.40
TEST(Convert, OnlyMeasurementsChange) {
  for (const char* text :
       {"SPEED 30", "ACCEL 50", "OVERSH 50", "DELAY 2.", "WORKDEF 1,0 (6.5, 80., 1.5, 95)",
        "VR[0] = SQRT(2)", "VR[3] = ASIN(0.5)", "CALL 2 (1.5)", "FUNCTION 44 (7.)", "GOTO 20",
        "VI[2] = 5", "OL[11] = 1", "; MOVE (1,0,0,0,0)", "WAIT IA[0] > 10."}) {
    EXPECT_EQ(Metric(text), text);
  }
}

// OPT-8.27, OPT-8.28
TEST(Convert, NumbersHaveUpToSixDecimals) {
  EXPECT_EQ(Metric("VR[0] = 45"), "VR[0] = 1143.0");
  EXPECT_EQ(Metric("VR[0] = 0"), "VR[0] = 0.0");
  EXPECT_EQ(Metric("VR[0] = -0.0"), "VR[0] = 0.0");
  EXPECT_EQ(Metric("VR[3] = -164.533"), "VR[3] = -2.871643");
  EXPECT_EQ(Metric("VR[0] = .5"), "VR[0] = 12.7");
  EXPECT_EQ(Metric("VR[0] = 40.739"), "VR[0] = 1034.7706");
}

// OPT-B.40, OPT-8.28: of a number in parentheses the digits change, and nothing around them.
TEST(Convert, NumbersInParenthesesKeepThem) {
  EXPECT_EQ(Metric("VR[0] = -(2.)"), "VR[0] = -(50.8)");
  EXPECT_EQ(Metric("VR[0] = - ( -( .5 ) ) ; 7 (8)"), "VR[0] = - ( -( 12.7 ) ) ; 7 (8)");
  EXPECT_EQ(Metric("VR[0] = -(\n; 5. inches (five)\n5 E 0\n)"),
            "VR[0] = -(\n; 5. inches (five)\n127.0\n)");
  EXPECT_EQ(Metric("MOVE (-(1),2,(3),0,-(90))"), "MOVE (-(25.4),50.8,(76.2),0.0,-(1.570796))");
}

// OPT-8.36, OPT-8.52: a sign may stand apart from its digits, before a comment or on another line.
TEST(Convert, SignsApartFromTheirDigits) {
  EXPECT_EQ(Metric("MOVE (- ; neg\n 5., 2., 3., 0., 0.)"),
            "MOVE (- ; neg\n 127.0, 50.8, 76.2, 0.0, 0.0)");
  EXPECT_EQ(Metric("VR[0]=(\n-\n7 ; 8\n)"), "VR[0]=(\n-\n177.8 ; 8\n)");
  EXPECT_EQ(Metric("VR[0]=\n-\n5\nVR[1] = 1"), "VR[0]=\n-\n127.0\nVR[1] = 25.4");
}

// OPT-7.62: what the control could not hold is told, and stays.
TEST(Convert, NumbersBeyondReal) {
  EXPECT_EQ(Metric("VR[0] = 500000000000000000.0"), "VR[0] = 500000000000000000.0");
  EXPECT_EQ(FindingsOf("VR[0] = 500000000000000000.0"), std::vector<int>{7004});
  EXPECT_EQ(Metric("VR[0] = 300000000000000000.0").substr(0, 12), "VR[0] = 7620");
}

// OPT-8.53: a line behind one that forgot a parenthesis is no part of it.
TEST(Convert, LinesBehindAForgottenParenthesis) {
  EXPECT_EQ(Metric("VR[0] = (1 + 2\nVR[5] = 3\nVR[1] = 1"),
            "VR[0] = (1 + 2\nVR[5] = 76.2\nVR[1] = 25.4");
}

// OPT-8.29
TEST(Convert, RepeatedConversionMayMoveANumber) {
  EXPECT_EQ(Inch("VR[0] = 420.5"), "VR[0] = 16.555118");
  EXPECT_EQ(Metric("VR[0] = 16.555118"), "VR[0] = 420.499997");
}

// OPT-8.30, OPT-8.31, OPT-8.32
TEST(Convert, VariablesHaveTheirUnits) {
  for (const int n : {0, 1, 2, 5, 7, 10, 12, 15, 17, 20, 22, 80, 88, 92, 94}) {
    const std::string target = "VR[" + std::to_string(n) + "] = ";
    EXPECT_EQ(Metric(target + "1"), target + "25.4");
  }
  for (const int n : {3, 4, 8, 9, 13, 14, 18, 19, 23, 24, 89, 91, 95, 97}) {
    const std::string target = "VR[" + std::to_string(n) + "] = ";
    EXPECT_EQ(Metric(target + "180"), target + "3.141593");
  }
  for (const char* target :
       {"VR[25] = ", "VR[26] = ", "VR[79] = ", "VR[98] = ", "VI[0] = ", "OA[0] = ", "PAR[0] = "}) {
    EXPECT_EQ(Metric(target + std::string("1")), target + std::string("1"));
  }
}

// OPT-8.33, OPT-8.34, OPT-8.36
TEST(Convert, NamesHaveTheUnitOfTheirVariable) {
  EXPECT_EQ(Metric("DECLARE YNEAR = VR[15]\nYNEAR = 230\n"),
            "DECLARE YNEAR = VR[15]\nYNEAR = 5842.0\n");
  EXPECT_EQ(Metric("DECLARE N = 3\nLET VR[N] = 1.5\n"), "DECLARE N = 3\nLET VR[N] = 0.02618\n");
  EXPECT_EQ(Metric("DECLARE EPSILON = 0.001\n"), "DECLARE EPSILON = 0.001\n");
  EXPECT_EQ(Metric("DECLARE N = 0\nVR[N] = 1\n"), "DECLARE N = 0\nVR[N] = 25.4\n");
  for (const std::string none : {"DECLARE N = 99\nVR[N] = 1\n", "DECLARE N = 100\nVR[N] = 1\n",
                                 "DECLARE N = -1\nVR[N] = 1\n", "DECLARE N = 3.\nVR[N] = 1\n"})
    EXPECT_EQ(Metric(none), none);
}

// OPT-8.35, OPT-E.7710
TEST(Convert, ConstantsWhereAUnitBelongsAreReported) {
  const std::string text = "DECLARE XHOME = 10.5\nMOVE (XHOME,0.,0.,0.,0.)\n";
  EXPECT_EQ(Metric(text), "DECLARE XHOME = 10.5\nMOVE (XHOME,0.0,0.0,0.0,0.0)\n");
  EXPECT_EQ(FindingsOf(text), (std::vector<int>{7710}));
  EXPECT_TRUE(FindingsOf("DECLARE FEED = 10.5\nSPEED FEED\n").empty());
}

// OPT-8.34, OPT-8.35, OPT-8.37: PI is a constant, by that name and by others: half a turn in
// radians, a turn, in degrees it is three of them.
TEST(Convert, PiWhereAnAngleBelongsIsReported) {
  const std::vector<int> once = {7710};
  for (const std::string text :
       {"MOVE (0.0,0.0,0.0,PI,0.0)", "MOVE (0.0,0.0,0.0,-PI,0.0)", "VR[3] = PI", "VR[3] = PI/2",
        "VR[3] = 2*PI", "VR[0] = SIN(PI)", "VR[0] = SIN(PI/2)", "VR[3] = VR[4] + PI",
        "DECLARE P = PI\nMOVE (0.0,0.0,0.0,P,0.0)", "DECLARE P = PI\nVR[3] = P/2"}) {
    EXPECT_EQ(FindingsOf(text), once) << text;
    EXPECT_EQ(Metric(text), text);
    EXPECT_EQ(Inch(text), text);
  }
  EXPECT_EQ(FindingsOf("VR[3] = VR[4] + PI/2"), (std::vector<int>{7709}));
  // A factor is none, and where no measurement belongs there is nothing to say.
  for (const std::string text : {"VR[0] = VR[1] * PI", "VR[3] = VR[4] / PI", "VR[26] = PI",
                                 "DECLARE P = PI", "SPEED PI", "VR[3] = ASIN(PI/4)"}) {
    EXPECT_EQ(FindingsOf(text), (std::vector<int>{})) << text;
  }
}

// OPT-8.37, OPT-8.38, OPT-8.50
TEST(Convert, ParametersHaveTheirUnits) {
  EXPECT_EQ(Metric("MOVE (1,1,1,180,180)/VIA(1,1,1,180,180)"),
            "MOVE (25.4,25.4,25.4,3.141593,3.141593)/VIA(25.4,25.4,25.4,3.141593,3.141593)");
  EXPECT_EQ(Metric("SYSDEF (1,1,1,180,180,180)"),
            "SYSDEF (25.4,25.4,25.4,3.141593,3.141593,3.141593)");
  EXPECT_EQ(Metric("path hole (.5)"), "path hole (12.7)");
  EXPECT_EQ(Metric("TCP (8.68, 0, 0.72/0, 1.77, 0)"),
            "TCP (220.472, 0.0, 18.288/0.0, 44.958, 0.0)");
  EXPECT_EQ(Metric("VR[26] = SIN(90) "), "VR[26] = SIN(1.570796) ");
  EXPECT_EQ(Metric("VR[26] = COS(90)"), "VR[26] = COS(1.570796)");
  EXPECT_EQ(Metric("VR[26] = TAN(90)"), "VR[26] = TAN(1.570796)");
  // Other functions have no unit, and what is inside is none of their outside.
  for (const std::string function :
       {"ASIN", "ACOS", "ATAN", "SQRT", "EXP", "LN", "LOG", "ABS", "INT"}) {
    const std::string text = "VR[0] = VR[1] + " + function + "(1)";
    EXPECT_EQ(Metric(text), text);
  }
}

// OPT-8.39, OPT-8.01
TEST(Convert, DirectivesHaveALength) {
  EXPECT_EQ(Metric("15 ;$DIA=0.020\n;$rad = 0.01 \n;$left\n;$dia=x\n"),
            "15 ;$DIA=0.508\n;$rad = 0.254 \n;$left\n;$dia=x\n");
  // OPT-8.26, OPT-8.02, OPT-8.05: comments stay, and so does what RMLCOMP would not read.
  for (const std::string text : {"SPEED 5 ;$dia=1\n", ";$dia=1 mm\n"})
    EXPECT_EQ(Metric(text), text);
}

// OPT-8.41
TEST(Convert, TheRotaryTableStaysInDegrees) {
  EXPECT_EQ(Metric("FUNCTION 99 (90.)"), "FUNCTION 99 (90.)");
  EXPECT_EQ(Metric("FUNCTION 99 (SIN(90.))"), "FUNCTION 99 (SIN(90.))");
  EXPECT_EQ(Metric("FUNCTION 44 (SIN(90.))"), "FUNCTION 44 (SIN(1.570796))");
  EXPECT_EQ(Metric("FUNCTION 44 (7., SIN(90.), SIN(180.))"),
            "FUNCTION 44 (7., SIN(1.570796), SIN(3.141593))");
}

// OPT-8.42, OPT-8.43, OPT-8.48
TEST(Convert, ANumberTakesTheUnitOfTheOtherOperand) {
  EXPECT_EQ(Metric("VR[26] = VR[0] + 1"), "VR[26] = VR[0] + 25.4");
  EXPECT_EQ(Metric("VR[0] = VR[3] - 180"), "VR[0] = VR[3] - 3.141593");
  EXPECT_EQ(Metric("MOVE (VR[40] + 1, 0, 0, 0, 0)"), "MOVE (VR[40] + 25.4, 0.0, 0.0, 0.0, 0.0)");
  EXPECT_EQ(Metric("VR[0] = 2 + 3"), "VR[0] = 50.8 + 76.2");
  EXPECT_EQ(Metric("DECLARE XP = VR[0]\nDECLARE YP = VR[1]\nMOVE (XP + 1, YP * 2, 3, 0, 0)\n"),
            "DECLARE XP = VR[0]\nDECLARE YP = VR[1]\nMOVE (XP + 25.4, YP * 2, 76.2, 0.0, 0.0)\n");
}

// OPT-8.44, OPT-8.47
TEST(Convert, RelationsConvertLabelsDoNot) {
  EXPECT_EQ(Metric("IF VR[5] > 100 THEN 50 ELSE 60"), "IF VR[5] > 2540.0 THEN 50 ELSE 60");
  for (const std::string relation : {"<", "<=", "=", ">=", ">", "<>", "><"}) {
    EXPECT_EQ(Metric("WAIT VR[5] " + relation + " 1"), "WAIT VR[5] " + relation + " 25.4");
  }
  EXPECT_EQ(Inch("MOVE (0.0, 0.0, 0.0, 0.0, 0.0)/END (VR[3] > 6.182)"),
            "MOVE (0.0, 0.0, 0.0, 0.0, 0.0)/END (VR[3] > 354.202509)");
  EXPECT_EQ(Metric("IF VL[1] = 1 THEN 5"), "IF VL[1] = 1 THEN 5");
  EXPECT_EQ(Metric("WAIT 1"), "WAIT 1");
}

// OPT-8.45
TEST(Convert, ProductsAreNotConverted) {
  for (const char* text :
       {"VR[0] = VR[1] * 2", "VR[0] = VR[1] / 2", "VR[0] = VR[1] ^ 2", "VR[0] = VR[1] MOD 2"}) {
    EXPECT_EQ(Metric(text), text);
    EXPECT_TRUE(FindingsOf(text).empty());
  }
}

// OPT-8.46, OPT-E.7709
TEST(Convert, SeveralOperatorsAreLeftAloneAndReported) {
  EXPECT_EQ(Metric("VR[0] = VR[1] + 2 + 3"), "VR[0] = VR[1] + 2 + 3");
  EXPECT_EQ(FindingsOf("VR[0] = VR[1] + 2 + 3"), (std::vector<int>{7709}));
  EXPECT_EQ(FindingsOf("VR[0] = (VR[1] + 2) * 3"), (std::vector<int>{7709}));
  EXPECT_TRUE(FindingsOf("VR[0] = VR[1] + VR[2] + VR[3]").empty());
  EXPECT_EQ(Metric("VR[1] = -230"), "VR[1] = -5842.0");
  EXPECT_EQ(Metric("VR[0] = VR[1] + SIN(90)"), "VR[0] = VR[1] + SIN(1.570796)");
  EXPECT_EQ(Metric("IF VR[5] > 100 AND IL[3] THEN 50"), "IF VR[5] > 2540.0 AND IL[3] THEN 50");
  EXPECT_EQ(Metric("IF 1 AND VR[5] > 100 THEN 50"), "IF 1 AND VR[5] > 2540.0 THEN 50");
}

// OPT-8.49
TEST(Convert, ExponentsBecomePlainDecimals) {
  EXPECT_EQ(Metric("VR[0] = 1.5E2"), "VR[0] = 3810.0");
  EXPECT_EQ(Metric("VR[0] = 1.5 E -2"), "VR[0] = 0.381");
  EXPECT_EQ(Metric("VR[26] = 1.5E2"), "VR[26] = 1.5E2");
}

// OPT-8.51, OPT-B.78, OPT-B.77
TEST(Convert, TheHeaderIsTheFirstLine) {
  const FileNames names{"a.si", "a.s", "Tue Apr 20 13:37:22 1993"};
  EXPECT_EQ(Convert("; old\n", Direction::kToMetric, names).text,
            "; Metric File a.s Created From Inch File a.si - Tue Apr 20 13:37:22 1993\n; old\n");
  EXPECT_EQ(Convert("; old\r\n", Direction::kToInch, FileNames{"a.s", "a.si", "now"}).text,
            "; Inch File a.si Created From Metric File a.s - now\r\n; old\r\n");
}

// OPT-8.52
TEST(Convert, LinesStay) {
  EXPECT_EQ(Metric("MOVE (1,0,0,0,0)/ ; c\n\nVIA(2,0,0,0,0)\n"),
            "MOVE (25.4,0.0,0.0,0.0,0.0)/ ; c\n\nVIA(50.8,0.0,0.0,0.0,0.0)\n");
}

// OPT-8.53, OPT-E.7711
TEST(Convert, LinesThatAreNoRmlAreCopied) {
  const std::string text = "MOVE (1,2\nMOVE (1,0,0,0,0)\nVR[0] = 1 2\n";
  EXPECT_EQ(Metric(text), "MOVE (1,2\nMOVE (25.4,0.0,0.0,0.0,0.0)\nVR[0] = 1 2\n");
  EXPECT_EQ(FindingsOf(text), (std::vector<int>{7711, 7711}));
  // Also those that can be read, each of several.
  for (const std::string bad : {"MOVE (1,0,0,0,0)/FLY/FLY\n", "12345 VR[0] = 1\n"}) {
    EXPECT_EQ(Metric(bad + "VR[0] = 1\n" + bad + "VR[0] = 2\n" + bad),
              bad + "VR[0] = 25.4\n" + bad + "VR[0] = 50.8\n" + bad);
  }
}

// OPT-8.53: however many there are; those that are not told singly are counted.
TEST(Convert, EveryLineThatIsNoRmlIsCopied) {
  std::string text = "VR[0] = 1.\n";
  for (int n = 0; n < 1200; ++n) text += "12345 VR[0] = 1.\n";
  text += "VR[0] = 1.\n";
  const Conversion made = Convert(text, Direction::kToMetric);
  std::string expected = text;
  expected.replace(0, 10, "VR[0] = 25.4");
  expected.replace(expected.size() - 11, 10, "VR[0] = 25.4");
  EXPECT_EQ(made.text, expected);
  EXPECT_EQ(made.diagnostics.size(), 1000U);
  ASSERT_EQ(made.diagnostics_dropped.kinds().size(), 1U);
  const GatheredFindings& more = made.diagnostics_dropped.kinds().at(ErrorCode::kConvertNotRml);
  EXPECT_EQ(more.count, 200U);
  EXPECT_EQ(more.code, ErrorCode::kConvertNotRml);
  EXPECT_EQ(more.severity, Severity::kWarning);
  EXPECT_EQ(more.first.where.line, 1002);
  EXPECT_EQ(more.last.where.line, 1201);
  EXPECT_EQ(more.last.code, ErrorCode::kConvertNotRml);
}

// OPT-8.53: those whose name has no room in a program, too.
TEST(Convert, LinesWithANameTooManyAreCopied) {
  std::string text = "DECLARE A0 = VR[0]\n";
  for (int n = 1; n < 65'535; ++n) text += "DECLARE A" + std::to_string(n) + " = 5\n";
  const std::string nameless = "DECLARE Z1 = 5\nDECLARE Z2 = 5\nZ2 = 5.\nZ3 = 5.\n";
  EXPECT_EQ(Metric(text + nameless + "A0 = 5.\n"), text + nameless + "A0 = 127.0\n");
}

// OPT-8.53: whatever its sequence number is, what a DECLARE says is known.
TEST(Convert, ADeclareWithAWrongSequenceNumberIsKnown) {
  EXPECT_EQ(Metric("10 VR[0] = 1.\n10 DECLARE LEN = VR[0]\nLEN = 2.0\n"),
            "10 VR[0] = 25.4\n10 DECLARE LEN = VR[0]\nLEN = 50.8\n");
}

// OPT-8.53: a line with a sequence number that stands before already is no RML.
TEST(Convert, ALineWithASequenceNumberTwiceIsCopied) {
  const std::string text = "10 VR[0] = 2.\n";
  EXPECT_EQ(Metric("10 VR[0] = 1.\n" + text), "10 VR[0] = 25.4\n" + text);
  EXPECT_EQ(FindingsOf("10 VR[0] = 1.\n" + text), (std::vector<int>{7711}));
}

// OPT-8.53: what is missing at the end of a line is missing there, and not on the next one.
TEST(Convert, TheLineBehindAnUnfinishedOneIsNotIt) {
  for (const std::string unfinished : {"DECLARE X =", "DEFINE PAR[1] ="}) {
    const std::string text = "DECLARE LEN = VR[0]\n" + unfinished + "\n";
    const Conversion made = Convert(text + "LEN = 2.0\n", Direction::kToMetric);
    EXPECT_EQ(made.text, text + "LEN = 50.8\n");
    ASSERT_EQ(made.diagnostics.size(), 1U);
    EXPECT_EQ(made.diagnostics[0].code, ErrorCode::kConvertNotRml);
    EXPECT_EQ(made.diagnostics[0].where.line, 2);
    EXPECT_EQ(made.diagnostics[0].where.column, static_cast<int>(unfinished.size()) + 1);
  }
}

// OPT-8.65, OPT-E.7708: VR [ 26 ] = VR [ 0 ] + ... : 9 tokens and two for each further term.
TEST(Convert, StatementsOfMoreThanTwoHundredTokensAreCopied) {
  const auto sum = [](int terms) {
    std::string text = "VR[26] = VR[0]";
    for (int t = 0; t < terms; ++t) text += "+1";
    return text;
  };
  const std::string call = "MOVE (1,0,0,0,0)\n";
  EXPECT_EQ(FindingsOf(sum(95) + "\n"), (std::vector<int>{7709}));         // 9 + 190 = 199
  EXPECT_EQ(FindingsOf(sum(96) + "\n" + call), (std::vector<int>{7708}));  // 201
  EXPECT_EQ(Metric(sum(96) + "\n" + call), sum(96) + "\nMOVE (25.4,0.0,0.0,0.0,0.0)\n");
  std::string even = "VI[2] = 1";  // 6 tokens
  for (int t = 0; t < 97; ++t) even += "+1";
  EXPECT_TRUE(FindingsOf(even + "\n").empty());                    // 200
  EXPECT_EQ(FindingsOf(even + "+1\n"), (std::vector<int>{7708}));  // 202
}

// What 1Ah and behind it is stays.
TEST(Convert, TextBehindItsEndStays) {
  EXPECT_EQ(Metric("VR[0] = 1\n\x1A VR[0] = 1"), "VR[0] = 25.4\n\x1A VR[0] = 1");
}

struct Literals {
  std::vector<std::string> texts;  // of the numbers, in order
  std::string rest;                // the text with a mark in place of each
};

Literals LiteralsOf(const std::string& text) {
  Findings none(0);
  const ParsedProgram program = Parse(text, none);
  std::vector<NodePlace> places;
  for (std::size_t n = 0; n < program.module.nodes.size(); ++n) {
    const Node op = program.module.nodes[n].op;
    if (op == Node::kInteger || op == Node::kReal) places.push_back(program.node_places[n]);
  }
  std::ranges::sort(places, {}, &NodePlace::offset);
  Literals literals;
  std::size_t at = 0;
  for (const NodePlace& place : places) {
    literals.texts.push_back(text.substr(place.offset, place.length));
    literals.rest += text.substr(at, place.offset - at) + '#';
    at = place.offset + place.length;
  }
  literals.rest += text.substr(at);
  return literals;
}

// "- .5 E -3" too: signs first, blanks anywhere.
double ValueOf(const std::string& text) {
  const std::size_t digits = text.find_first_of(".0123456789");
  std::string plain = text.substr(digits);
  std::erase_if(plain, [](char c) { return c == ' ' || c == '\t'; });
  const auto minus = std::count(text.begin(), text.begin() + static_cast<int>(digits), '-');
  return (minus % 2 == 0 ? 1.0 : -1.0) * std::stod(plain);
}

// Half of the last decimal that is written, and what double precision leaves of long numbers.
constexpr double kHalfDecimal = 0.5e-6;
double Rounding(double value) { return 1e-15 * std::fabs(value) + 1e-15; }

// What became of one number on the way there and back.
void CheckNumber(const std::string& before, const std::string& there, const std::string& back,
                 bool to_inch) {
  if (there == before) {
    // Without a unit; or a zero, or too small a number to be seen, that has one.
    if (std::fabs(ValueOf(before)) > 0.0) {
      EXPECT_EQ(back, before);
    }
    return;
  }
  const double a = ValueOf(before), b = ValueOf(there), c = ValueOf(back);
  const double length = to_inch ? 1.0 / 25.4 : 25.4;
  const double angle = to_inch ? 180.0 / std::acos(-1.0) : std::acos(-1.0) / 180.0;
  const bool is_length = std::fabs(b - a * length) <= kHalfDecimal + Rounding(b);
  const bool is_angle = std::fabs(b - a * angle) <= kHalfDecimal + Rounding(b);
  ASSERT_TRUE(is_length || is_angle) << before << " became " << there;
  // The half decimal that was lost on the way there, in the unit of the way back, and another half:
  // within 1e-6 where the unit there is the finer one (inch to mm, radian to degree).
  const double factor = is_length && is_angle ? std::min(length, angle)
                        : is_length           ? length
                                              : angle;
  const double bound = kHalfDecimal / factor + kHalfDecimal + Rounding(a) + Rounding(b) / factor;
  EXPECT_NEAR(c, a, bound) << before << " became " << there << " and " << back;
  if (factor > 1.0) {
    EXPECT_NEAR(c, a, 1e-6 + Rounding(a) + Rounding(b) / factor);
  }
}

// OPT-8.26, OPT-8.27, OPT-8.28, OPT-8.29
TEST(Convert, ThereAndBackIsTheSameAndNothingElseIsTouched) {
  int changed = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    for (const bool to_inch : {false, true}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + (to_inch ? " to inch" : " to metric"));
      const std::string text = RandomProgram(seed).Make(40);
      const std::string there = to_inch ? Inch(text) : Metric(text);
      const std::string back = to_inch ? Metric(there) : Inch(there);
      const Literals a = LiteralsOf(text), b = LiteralsOf(there), c = LiteralsOf(back);
      ASSERT_EQ(b.rest, a.rest);
      ASSERT_EQ(c.rest, a.rest);
      ASSERT_EQ(b.texts.size(), a.texts.size());
      ASSERT_EQ(c.texts.size(), a.texts.size());
      for (std::size_t n = 0; n < a.texts.size(); ++n) {
        CheckNumber(a.texts[n], b.texts[n], c.texts[n], to_inch);
        if (HasFatalFailure()) return;
        changed += b.texts[n] != a.texts[n] ? 1 : 0;
      }
    }
  }
  EXPECT_GT(changed, 5000);  // more than ten a program
}

}  // namespace
}  // namespace rmlcell::optimo
