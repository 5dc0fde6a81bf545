#include "engine/optimo/offline/fix_program.h"

#include <gtest/gtest.h>

#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

machine::Translation CheckAll(const machine::SourceFile& file) { return TranslateOptimo(file, {}); }
machine::Translation CheckErrors(const machine::SourceFile& file) {
  return TranslateOptimo(file, {.advice = false});
}

RepairedText FixText(std::string_view text, const std::string& name = "part.S") {
  return FixProgram({.name = name, .bytes = text}, CheckAll);
}

// OPT-7.91, OPT-2.61: two findings, two repairs; blanks, comments and CR LF stay.
TEST(FixProgram, RepairsAndKeepsLayoutAndComments) {
  const RepairedText fixing =
      FixText("\tSPEDE   20\t; slow\r\n; alone\r\nMOVE (1.,2.,3.,0.,0.) / INF ; x\r\n");
  EXPECT_EQ(fixing.text, "\tSPEED   20\t; slow\r\n; alone\r\nMOVE (1.,2.,3.,0.,0.) ; x\r\n");
  ASSERT_EQ(fixing.fixed.size(), 2U);
  EXPECT_EQ(fixing.fixed[0].code, ErrorCode::kNameUndeclared);
  EXPECT_EQ(fixing.fixed[0].where.line, 1);
  EXPECT_EQ(fixing.fixed[1].code, ErrorCode::kWordIgnored);
  EXPECT_EQ(fixing.fixed[1].where.line, 3);
  EXPECT_TRUE(fixing.left.ok);
}

// OPT-7.91, OPT-2.47: /FLY before the end is seen only when the word before it can be read.
TEST(FixProgram, RepairsWhatAnEarlierRepairBringsToLight) {
  const RepairedText fixing = FixText("COORD ABSOL\nMOEV (1000.,900.,-500.,0.,0.)/FLY\n");
  EXPECT_EQ(fixing.text, "COORD ABSOL\nMOVE (1000.,900.,-500.,0.,0.)\n");
  EXPECT_EQ(fixing.fixed.size(), 2U);
}

// RepairedText again changes nothing, and there is nothing left that could be.
TEST(FixProgram, ComesToRest) {
  for (const std::string text : {"SPEDE 20\nMOVE (1.,2.,3.,0.,0.)/FLY/INF\n", "SPEED 101\n", "\n",
                                 "SYSDEF (0,0,0,0,0,0)\nDEFINE PAR = INT\nXYZZY\n"}) {
    const RepairedText once = FixText(text);
    const RepairedText twice = FixText(once.text);
    EXPECT_EQ(twice.text, once.text) << text;
    EXPECT_TRUE(twice.fixed.empty()) << text;
  }
}

// OPT-2.12: what has no obvious repair stays as it is, and is told.
TEST(FixProgram, LeavesWhatItCannotRepair) {
  const RepairedText fixing = FixText("SPEED 101 ; too fast\n");
  EXPECT_EQ(fixing.text, "SPEED 101 ; too fast\n");
  EXPECT_TRUE(fixing.fixed.empty());
  EXPECT_FALSE(fixing.left.ok);
}

// OPT-2.61: a warning is not repaired when only errors are looked for.
TEST(FixProgram, RepairsOnlyWhatTheCheckTells) {
  const std::string text = "SPEDE 20\nMOVE (1.,2.,3.,0.,0.)/FLY\n";
  EXPECT_EQ(FixProgram({.name = "part.S", .bytes = text}, CheckErrors).text,
            "SPEED 20\nMOVE (1.,2.,3.,0.,0.)/FLY\n");
}

// OPT-2.04, OPT-7.91: an inch source is refused, but its form can be repaired; its numbers are not
// taken for millimetres.
TEST(FixProgram, RepairsTheFormOfInchSources) {
  const RepairedText fixing = FixText("SPEDE 20\nMOVE (1.,2.,-3.,90.,0.)\n", "part.SI");
  EXPECT_EQ(fixing.text, "SPEED 20\nMOVE (1.,2.,-3.,90.,0.)\n");
  ASSERT_EQ(fixing.left.diagnostics.size(), 1U);
  EXPECT_EQ(fixing.left.diagnostics[0].code, ErrorCode::kSourceIsInch);
}

// OPT-7.50, OPT-7.41: a name is put right where nothing else is wrong: it may be unknown because
// its DECLARE is.
TEST(FixProgram, NamesFollowFromOtherErrors) {
  const auto fixed = [](const std::string& text) { return FixText(text).text; };
  EXPECT_EQ(fixed("DECLARE PASSLR = VR[1]\nPASSRL = 5.\n"),
            "DECLARE PASSLR = VR[1]\nPASSLR = 5.\n");
  // The DECLARE is put right, and then its name is known.
  EXPECT_EQ(fixed("DECLARE PASSLR = VR[1]\nDECALRE PASSRL = VR[2]\nPASSLR = 1.\nPASSRL = 5.\n"),
            "DECLARE PASSLR = VR[1]\nDECLARE PASSRL = VR[2]\nPASSLR = 1.\nPASSRL = 5.\n");
  for (const std::string& text :
       {// A DECLARE that nobody can put right.
        std::string("DECLARE PASSLR = VR[1]\nDECLARE PASSRL = VR[2]]\nPASSRL = 5.\n"),
        std::string("DECLARE PASSLR = VR[1]\nDECLARE PASSRL = VR[NOPE]\nPASSRL = 5.\n"),
        // Another error, whatever it is.
        std::string("DECLARE PASSLR = VR[1]\nPASSRL = 5.\nSPEED 101\n"),
        // It is declared, only too late.
        std::string("DECLARE PONT = VR[1]\nPNOT = 5.\nDECLARE PNOT = VR[2]\nPNOT = 6.\n"),
        // What no assignment, no index and no place for a number takes.
        std::string("DECLARE OUTLET = 5\nOUTLTE = 3\n"),
        std::string("DECLARE OUTLET = 5.5\nOL[OUTLTE] = ON\n"),
        std::string("DECLARE OUTLET = OL[16]\nVR[30] = OUTLTE + 1\n")}) {
    EXPECT_EQ(fixed(text), text);
  }
}

// OPT-9.24: an index is put behind PAR where the statement can be read.
TEST(FixProgram, PutsAnIndexOnlyInStatementsThatCanBeRead) {
  EXPECT_EQ(FixText("DEFINE PAR = INT\n").text, "DEFINE PAR[0] = INT\n");
  EXPECT_EQ(FixText("DEFINE PAR(0] = INT\n").text, "DEFINE PAR(0] = INT\n");
  EXPECT_EQ(FixText("DEFINE PAR(0] = INT\n").left.diagnostics.size(), 1U);
}

// Many repairs in one go, and each finding whole or not at all.
TEST(FixProgram, RepairsMoreThanOneListOfFindings) {
  std::string text, wanted;
  for (int i = 0; i < 2500; ++i) {
    text += "SPEDE 20\n";
    wanted += "SPEED 20\n";
  }
  const RepairedText fixing = FixText(text);
  EXPECT_EQ(fixing.text, wanted);
  EXPECT_EQ(fixing.fixed.size(), 2500U);
}

// Where each repair brings another finding there is an end all the same.
TEST(FixProgram, EndsWhereRepairsDoNot) {
  const auto always = [](const machine::SourceFile&) {
    machine::Translation checked;
    checked.diagnostics.push_back({.code = ErrorCode::kPracticeAdvice,
                                   .severity = Severity::kAdvice,
                                   .detail = {},
                                   .rule = {},
                                   .file = {},
                                   .where = {1, 1, 0, 0},
                                   .fixes = {{0, 0, ";"}}});
    return checked;
  };
  const RepairedText fixing = FixProgram({.name = "part.S", .bytes = "SPEED 5\n"}, always);
  EXPECT_EQ(fixing.text, std::string(64, ';') + "SPEED 5\n");
  EXPECT_EQ(fixing.fixed.size(), 64U);
}

// fix_program.h: a round that would leave more errors than there were is not made; one that leaves
// as many is.
TEST(FixProgram, ARoundThatMakesMoreErrorsIsNotMade) {
  for (const std::size_t behind : {1U, 2U}) {
    const auto check = [behind](const machine::SourceFile& file) {
      const bool repaired = file.bytes.starts_with(';');
      Diagnostic error{.code = ErrorCode::kSyntax,
                       .severity = Severity::kCompile,
                       .detail = {},
                       .rule = {},
                       .file = {},
                       .where = {1, 1, 0, 0},
                       .fixes = {}};
      if (!repaired) error.fixes.push_back({0, 0, ";"});
      machine::Translation checked;
      checked.diagnostics.assign(repaired ? behind : 1U, error);
      return checked;
    };
    const RepairedText fixing = FixProgram({.name = "part.S", .bytes = "SPEED 5\n"}, check);
    EXPECT_EQ(fixing.text, behind == 1U ? ";SPEED 5\n" : "SPEED 5\n");
    EXPECT_EQ(fixing.fixed.size(), behind == 1U ? 1U : 0U);
    EXPECT_EQ(fixing.left.diagnostics.size(), 1U);
  }
}

// OPT-B.69: an object is no text, under whatever name.
TEST(FixProgram, ObjectsAndBinariesAreNoText) {
  const std::string object = Compile("SPEED 20\n", "", {}).object;
  EXPECT_FALSE(CheckIsText("12.O", object));
  EXPECT_FALSE(CheckIsText("12.S", object));
  EXPECT_FALSE(CheckIsText("12.S", std::string_view("SPEED 20\n\0", 10)));
  const Status of_object = CheckIsText("12.O", "SPEED 20\n");
  EXPECT_EQ(of_object.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(of_object.error().detail, "12.O is an object, not a source");
  EXPECT_EQ(CheckIsText("12.S", std::string_view("SPEED 20\n\0", 10)).error().code,
            ErrorCode::kCellBadText);
  EXPECT_TRUE(CheckIsText("12.S", "SPEED 20 ; \xE9t\xE9 \x1B\n\x1A"));
}

// OPT-7.50: a name is put right when nothing else is left to be repaired; both are told.
TEST(FixProgram, NamesComeLast) {
  const RepairedText fixing =
      FixText("DECLARE PASSLR = VR[1]\nPASSRL = 5.\nMOVE (1.,2.,3.,0.,0.) / INF ; x\n");
  EXPECT_EQ(fixing.text, "DECLARE PASSLR = VR[1]\nPASSLR = 5.\nMOVE (1.,2.,3.,0.,0.) ; x\n");
  ASSERT_EQ(fixing.fixed.size(), 2U);
  EXPECT_EQ(fixing.fixed[0].code, ErrorCode::kWordIgnored);
  EXPECT_EQ(fixing.fixed[1].code, ErrorCode::kNameUndeclared);
  EXPECT_EQ(fixing.fixed[1].where.line, 2);
}

// fix_program.h: where there is nothing to repair nothing is looked at again.
TEST(FixProgram, WhatNeedsNoRepairIsLookedAtOnce) {
  int looks = 0;
  const ProgramCheck check = [&looks](const machine::SourceFile& file) {
    ++looks;
    return TranslateOptimo(file, {});
  };
  EXPECT_EQ(FixProgram({.name = "part.S", .bytes = "SPEED 101\n"}, check).text, "SPEED 101\n");
  EXPECT_EQ(looks, 1);
}

}  // namespace
}  // namespace rmlcell::optimo
