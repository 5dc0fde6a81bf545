#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/fix_program.h"
#include "engine/optimo/offline/translate.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::string ToMetric(const std::string& text) { return Convert(text, Direction::kToMetric).text; }
std::string ToInch(const std::string& text) { return Convert(text, Direction::kToInch).text; }

// OPT-8.43, OPT-8.46: what a function gives has no unit: the place counts for the number beside it.
TEST(ConvertSides, ANumberBesideAFunctionTakesTheUnitOfThePlace) {
  EXPECT_EQ(ToMetric("VR[0] = INT(VR[30]) + 2"), "VR[0] = INT(VR[30]) + 50.8");
  EXPECT_EQ(ToMetric("VR[3] = 180 - ABS(VR[30])"), "VR[3] = 3.141593 - ABS(VR[30])");
  EXPECT_EQ(ToMetric("MOVE (SQRT(VR[30]) + 1,0,0,0,0)"),
            "MOVE (SQRT(VR[30]) + 25.4,0.0,0.0,0.0,0.0)");
}

// OPT-8.46: what a function gives is no number of the text: there is nothing to convert beside it,
// and nothing to report.
TEST(ConvertSides, WhatAFunctionGivesIsNoNumber) {
  for (const std::string text :
       {"VR[0] = VR[1] + INT(VR[30]) + VR[2]", "VR[0] = INT(VR[30]) + VR[1]", "VR[0] = INT(VR[30])",
        "VR[3] = VR[4] - ABS(VR[30])"}) {
    EXPECT_EQ(ToMetric(text), text);
    EXPECT_TRUE(Convert(text, Direction::kToMetric).diagnostics.empty()) << text;
  }
}

// OPT-8.45: a product stays one beside a logical operator, on either side of it.
TEST(ConvertSides, ProductsInConditionsAreNotConverted) {
  for (const std::string text : {"IF IL[3] AND VR[5] * 2 THEN 50", "IF VR[5] * 2 AND IL[3] THEN 50",
                                 "IF 1 OR VR[5] / 3 THEN 50"}) {
    EXPECT_EQ(ToMetric(text), text);
    EXPECT_TRUE(Convert(text, Direction::kToMetric).diagnostics.empty()) << text;
  }
}

// OPT-7.59, OPT-8.30, OPT-8.32: an index that no variable has gives no unit, also where its last
// byte would.
TEST(ConvertSides, IndicesThatNoVariableHasHaveNoUnit) {
  for (const std::string index : {"256", "259", "336", "-256", "-253"}) {
    const std::string text = "DECLARE N = " + index + "\nVR[N] = 1\n";
    EXPECT_EQ(ToMetric(text), text);
  }
}

// OPT-8.34, OPT-8.35: a name of a variable is no constant, nor is one that nobody declared.
TEST(ConvertSides, OnlyDeclaredNumbersAreConstants) {
  for (const std::string text : {"DECLARE XP = VR[0]\nMOVE (XP,0,0,0,0)\n",
                                 "DECLARE XP = VR[30]\nMOVE (XP,0,0,0,0)\n", "VR[0] = XPOS\n"}) {
    EXPECT_TRUE(Convert(text, Direction::kToMetric).diagnostics.empty()) << text;
  }
}

// OPT-8.27: computed in double precision, to the last of fifteen digits: divided, not multiplied by
// a rounded part of an inch.
TEST(ConvertSides, InchesAreDivided) {
  EXPECT_EQ(ToInch("VR[0] = 4511693040.4"), "VR[0] = 177625710.251969");
}

// OPT-8.02, OPT-8.39: a directive stands alone on its line, from its first letter.
TEST(ConvertSides, WhatStandsBeforeADirectiveMakesItAComment) {
  EXPECT_EQ(ToMetric("X;$dia=1\n"), "X;$dia=1\n");
  EXPECT_EQ(ToMetric("SPEED 5\nX;$dia=1\n"), "SPEED 5\nX;$dia=1\n");
  EXPECT_EQ(ToMetric("5;$dia=1\n"), "5;$dia=25.4\n");
  EXPECT_EQ(ToMetric(" ;$dia=1\n"), " ;$dia=25.4\n");
}

// OPT-8.57, OPT-8.59: a second slash makes it a path and no switch.
TEST(ConvertSides, APathOfTwoSlashesIsNoSwitch) {
  const auto request = ReadConvertArguments(std::vector<std::string>{"//x", "/m"});
  ASSERT_TRUE(request);
  ASSERT_TRUE(*request);
  EXPECT_EQ((*request)->input, "//x");
  EXPECT_EQ((*request)->output, "//x.s");
}

// OPT-8.58: what contradicts what is said by name.
TEST(ConvertSides, ContradictionsNameTheirFiles) {
  const auto said = [](const std::vector<std::string>& arguments) -> std::string {
    const auto request = ReadConvertArguments(arguments);
    return request ? "nothing" : std::string(request.error().detail);
  };
  EXPECT_EQ(said({"in.s", "out.s"}), "in.s and out.s");
  EXPECT_EQ(said({"in.si", "out.si"}), "in.si and out.si");
  EXPECT_EQ(said({"in.s", "out.cmp"}), "out.cmp would not be metric");
  EXPECT_EQ(said({"in.cmp", "/m"}), "in.cmp is metric");
  EXPECT_EQ(said({"in.s", "/m"}), "in.s and its switch");
  EXPECT_EQ(said({"in.old"}), "in.old is neither .S nor .SI");
  EXPECT_EQ(said({"in.s", "/x"}), "/x");
  EXPECT_EQ(said({"in.s", "/i", "/m"}), "/i and /m");
}

// OPT-7.50: of more findings than a list holds, those that are not seen may be other errors: no
// name is put right then. So in an inch source, too.
TEST(ConvertSides, NamesStayWhereNotAllFindingsAreSeen) {
  std::string text = "DECLARE PASSLR = VR[1]\n";
  for (int n = 0; n < 2500; ++n) text += "PASSRL = 5.\n";
  text += "SPEED 101\n";
  const ProgramCheck check = [](const machine::SourceFile& file) {
    return TranslateOptimo(file, {});
  };
  for (const std::string name : {"part.SI", "part.S"}) {
    const RepairedText fixing = FixProgram({.name = name, .bytes = text}, check);
    EXPECT_EQ(fixing.text, text) << name;
    EXPECT_TRUE(fixing.fixed.empty()) << name;
  }
}

// OPT-B.71, OPT-1.08: what is refused says why, and of which file; the smallest limit is one.
TEST(ConvertSides, RefusalsNameTheirFile) {
  const machine::Translation empty = TranslateOptimo({"a.S", ""}, {});
  ASSERT_EQ(empty.diagnostics.size(), 1U);
  EXPECT_EQ(empty.diagnostics[0].detail, "the file is empty");
  EXPECT_EQ(empty.diagnostics[0].file, "a.S");
  const std::string object = MustCompile("SPEED 5\n").object;
  const machine::Translation limited = TranslateOptimo({"44.O", object}, {}, 1);
  ASSERT_EQ(limited.diagnostics.size(), 1U);
  EXPECT_EQ(limited.diagnostics[0].code, ErrorCode::kObjectTooLong);
  EXPECT_EQ(limited.diagnostics[0].detail,
            "the object has " + std::to_string(object.size()) + " bytes");
}

// OPT-8.46: the argument of a function is an expression of its own: its operators do not count
// outside; and a line is reported once, each.
TEST(ConvertSides, OperatorsAreCountedByExpressionAndReportedByLine) {
  EXPECT_EQ(ToMetric("VR[0] = INT(VR[30] + 1) + 2"), "VR[0] = INT(VR[30] + 1) + 50.8");
  EXPECT_EQ(ToMetric("VR[0] = INT(VR[30] * 3) + 2"), "VR[0] = INT(VR[30] * 3) + 50.8");
  const std::string line = "MOVE (VR[0]+1+2,VR[1]+1+2,0,0,0)\n";
  EXPECT_EQ(Convert(line, Direction::kToMetric).diagnostics.size(), 1U);
  EXPECT_EQ(Convert(line + line, Direction::kToMetric).diagnostics.size(), 2U);
}

// OPT-8.46, OPT-8.47: a number alone is a truth value on either side.
TEST(ConvertSides, TruthValuesStayOnEitherSide) {
  EXPECT_EQ(ToMetric("IF VR[5] > 100 AND 1 THEN 50"), "IF VR[5] > 2540.0 AND 1 THEN 50");
  EXPECT_EQ(ToMetric("IF 1 AND VR[5] > 100 THEN 50"), "IF 1 AND VR[5] > 2540.0 THEN 50");
}

// OPT-2.04: the form of an inch source is put right, its names too, and no more: that /FLY is
// nothing before the end is advice.
TEST(ConvertSides, OfInchSourcesErrorsAreRepaired) {
  const ProgramCheck check = [](const machine::SourceFile& file) {
    return TranslateOptimo(file, {});
  };
  const std::string move = "MOVE (1.,2.,3.,0.,0.)/FLY\n";
  EXPECT_EQ(FixProgram({.name = "a.SI", .bytes = "SPEDE 20\n" + move}, check).text,
            "SPEED 20\n" + move);
  EXPECT_EQ(
      FixProgram({.name = "a.SI", .bytes = "DECLARE PASSLR = VR[1]\nPASSRL = 5.\n"}, check).text,
      "DECLARE PASSLR = VR[1]\nPASSLR = 5.\n");
}

// program_file.h: what does not fit into the list is counted, of inch sources as well; the source
// is told when it was asked for.
TEST(ConvertSides, TranslationsTellWhatDidNotFit) {
  std::string text;
  for (int n = 0; n < 1500; ++n) text += "SPEED 101\n";
  for (const std::string name : {"a.SI", "a.S"}) {
    const machine::Translation looked =
        TranslateOptimo({name, text}, {.advice = false, .unconverted = true});
    EXPECT_EQ(looked.diagnostics.size(), machine::kDiagnosticsMax) << name;
    EXPECT_FALSE(looked.diagnostics_dropped.empty()) << name;
  }
  const auto lines =
      TranslateOptimo({"a.S", "SPEED 5\n\nSPEED 6\n"}, {.source = true}).source.step_lines;
  ASSERT_GE(lines.size(), 2U);
  EXPECT_EQ(lines[0], 1);
  EXPECT_EQ(lines[1], 3);
  EXPECT_TRUE(TranslateOptimo({"a.S", "SPEED 5\n"}, {}).source.step_lines.empty());
}

// OPT-8.53, OPT-7.46, OPT-9.24: a line that is only warned of is RML: it is converted like others,
// and none is told as copied.
TEST(ConvertSides, WarningsOfReadingAreNoErrors) {
  for (const auto& [text, wanted] : std::vector<std::pair<std::string, std::string>>{
           {"DECLARE LONGERNAME = VR[0]\nLONGERNAME = 1\n",
            "DECLARE LONGERNAME = VR[0]\nLONGERNAME = 25.4\n"},
           {"DEFINE PAR = INT\nVR[0] = 1\n", "DEFINE PAR = INT\nVR[0] = 25.4\n"}}) {
    const Conversion converted = Convert(text, Direction::kToMetric);
    EXPECT_EQ(converted.text, wanted);
    EXPECT_TRUE(converted.diagnostics.empty()) << text;
  }
}

// OPT-8.26, OPT-8.37, OPT-8.38: each statement has its own values, and is converted once: what
// stands behind it is no further value of it.
TEST(ConvertSides, StatementsEndWhereTheyEnd) {
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"MOVE (1,1,1,180,180)", "MOVE (25.4,25.4,25.4,3.141593,3.141593)"},
      {"MOVE (1,1,1,180,180)/VIA (1,1,1,180,180)",
       "MOVE (25.4,25.4,25.4,3.141593,3.141593)/VIA (25.4,25.4,25.4,3.141593,3.141593)"},
      {"SYSDEF (1,1,1,180,180,180)", "SYSDEF (25.4,25.4,25.4,3.141593,3.141593,3.141593)"},
      {"SYSDEF", "SYSDEF"},
      {"TCP (1,1,1/1,1,1)", "TCP (25.4,25.4,25.4/25.4,25.4,25.4)"},
      {"PATH HOLE (1)", "PATH HOLE (25.4)"},
      {"PATH LIN", "PATH LIN"},
      {"VR[0] = 1", "VR[0] = 25.4"},
      {"SPEED 5", "SPEED 5"},
      {"WORK 0,0/ON", "WORK 0,0/ON"},
      {"WAIT VR[5] > 1", "WAIT VR[5] > 25.4"},
      {"FUNCTION 99 (90.)", "FUNCTION 99 (90.)"},
      {"FUNCTION 44 (7.)", "FUNCTION 44 (7.)"},
      {"DECLARE N = 1", "DECLARE N = 1"},
      {"ASSIGN OL[16] = 1 /1", "ASSIGN OL[16] = 1 /1"},
  };
  for (const auto& [text, metric] : rows) {
    EXPECT_EQ(ToMetric(text + "\nDELAY 90.\n"), metric + "\nDELAY 90.\n");
    EXPECT_EQ(ToMetric(text + "\nDELAY SIN(90.)\n"), metric + "\nDELAY SIN(1.570796)\n");
  }
}

// OPT-8.26, OPT-8.43: all arguments of a CALL are looked at, in the order of the text.
TEST(ConvertSides, EachArgumentIsLookedAt) {
  EXPECT_EQ(ToMetric("CALL 2 (1.5, SIN(90.), VR[0] + 1, SIN(180.))"),
            "CALL 2 (1.5, SIN(1.570796), VR[0] + 25.4, SIN(3.141593))");
  EXPECT_EQ(ToMetric("VR[0] = 1 + SIN(90)"), "VR[0] = 25.4 + SIN(1.570796)");
}

// OPT-8.41, OPT-9.01: the rotary table is program 99, by a name as well.
TEST(ConvertSides, TheRotaryTableByName) {
  const std::string table = "DECLARE RTAB = 99\n", other = "DECLARE RTAB = 44\n";
  EXPECT_EQ(ToMetric(table + "FUNCTION RTAB (SIN(90.))\n"), table + "FUNCTION RTAB (SIN(90.))\n");
  EXPECT_EQ(ToMetric(other + "FUNCTION RTAB (SIN(90.))\n"),
            other + "FUNCTION RTAB (SIN(1.570796))\n");
}

// OPT-8.46: operators on the right count as those on the left.
TEST(ConvertSides, OperatorsOnTheRightCount) {
  for (const std::string text : {"VR[0] = 3 - (VR[1] + 2)", "VR[0] = 3 * (VR[1] + 2)"}) {
    const Conversion converted = Convert(text, Direction::kToMetric);
    EXPECT_EQ(converted.text, text);
    ASSERT_EQ(converted.diagnostics.size(), 1U) << text;
    EXPECT_EQ(converted.diagnostics[0].code, ErrorCode::kConvertExpression) << text;
  }
}

// OPT-8.39: directives stand between the statements, each in its place.
TEST(ConvertSides, DirectivesBetweenStatements) {
  EXPECT_EQ(ToMetric(";$dia=1\nVR[0] = 1\n;$rad=2\nVR[1] = 2\n;$dia=3\n"),
            ";$dia=25.4\nVR[0] = 25.4\n;$rad=50.8\nVR[1] = 50.8\n;$dia=76.2\n");
}

// OPT-8.53, OPT-8.65: what is no RML is told as that alone, however long it is.
TEST(ConvertSides, ALongLineThatIsNoneIsToldOnce) {
  std::string text = "VI[2] = 1";  // tokens: VI [ 2 ] = 1, then two each
  for (int n = 0; n < 98; ++n) text += "+1";
  text += " 2\n";
  const Conversion converted = Convert(text, Direction::kToMetric);
  EXPECT_EQ(converted.text, text);
  ASSERT_EQ(converted.diagnostics.size(), 1U);
  EXPECT_EQ(converted.diagnostics[0].code, ErrorCode::kConvertNotRml);
}

// OPT-8.53: of more lines than there is room for the rest are counted, as the warnings that they
// are; what the parser only warns of is none of them.
TEST(ConvertSides, WhatHasNoRoomIsCountedAsWhatItIs) {
  std::string wrong, warned;
  for (int n = 0; n < 1100; ++n) {
    wrong += "12345 VR[0] = 1.\n";
    warned += "DEFINE PAR = INT\n";
  }
  const UntoldFindings dropped = Convert(wrong, Direction::kToMetric).diagnostics_dropped;
  ASSERT_TRUE(dropped.kinds().contains(ErrorCode::kConvertNotRml));
  const GatheredFindings& more = dropped.kinds().at(ErrorCode::kConvertNotRml);
  EXPECT_EQ(more.count, 100U);
  for (const Diagnostic& place : {more.first, more.last}) {
    EXPECT_EQ(place.code, ErrorCode::kConvertNotRml);
    EXPECT_EQ(place.severity, Severity::kWarning);
  }
  const Conversion same = Convert(warned, Direction::kToMetric);
  EXPECT_EQ(same.text, warned);
  EXPECT_TRUE(same.diagnostics.empty());
  EXPECT_TRUE(same.diagnostics_dropped.empty());
}

}  // namespace
}  // namespace rmlcell::optimo
