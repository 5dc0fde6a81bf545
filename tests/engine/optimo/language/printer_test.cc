#include "engine/optimo/language/printer.h"

#include <gtest/gtest.h>

#include "engine/optimo/language/formatter.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::string Canonical(const std::string& statement) {
  std::string text = Decompile(MustCompile(statement + "\n").module);
  text.pop_back();
  return text;
}
std::string RealText(float value) {
  std::string text;
  PrintReal(value, text);
  return text;
}

// OPT-B.39
TEST(Printer, RealsAreShortest) {
  EXPECT_EQ(RealText(1262.139005F), "1262.139");
  EXPECT_EQ(RealText(80.0F), "80.0");
  EXPECT_EQ(RealText(0.0F), "0.0");
  EXPECT_EQ(RealText(-7.52F), "-7.52");
  EXPECT_EQ(RealText(1e-4F), "0.0001");
  EXPECT_EQ(RealText(9e-5F), "9.0E-5");
  EXPECT_EQ(RealText(1e7F), "10000000.0");
  EXPECT_EQ(RealText(1.5e8F), "1.5E8");
  EXPECT_EQ(RealText(1.5e7F), "1.5E7");
  EXPECT_EQ(RealText(-5e9F), "-5.0E9");
}

// OPT-B.40
TEST(Printer, StatementsHaveTheCanonicalForm) {
  EXPECT_EQ(Canonical("declare caxis=ol [11]"), "     DECLARE CAXIS = OL[11]");
  EXPECT_EQ(Canonical("define par[0]=int"), "     DEFINE PAR[0] = INT");
  EXPECT_EQ(Canonical("vr[00]=-7.52"), "     LET VR[0] = -7.52");
  EXPECT_EQ(Canonical("10 move(1.,2.,3.,0.,0.)/fly"), "10   MOVE (1.0, 2.0, 3.0, 0.0, 0.0) /FLY");
  EXPECT_EQ(
      Canonical("900 MOVE (1.,2.,3.,0.,0.)/TIME(2.5,0900)/START(IL[16])/FLY/VIA(2.,2.,3.,0.,0.)"),
      "900  MOVE (1.0, 2.0, 3.0, 0.0, 0.0) /VIA (2.0, 2.0, 3.0, 0.0, 0.0) /FLY /START (IL[16]) "
      "/TIME (2.5, 900)");
  EXPECT_EQ(Canonical("path hole(12.7)"), "     PATH HOLE (12.7)");
  EXPECT_EQ(Canonical("TCP (0.,0.,3.,0.,0.,-6.)"), "     TCP (0.0, 0.0, 3.0 / 0.0, 0.0, -6.0)");
  EXPECT_EQ(Canonical("WORKDEF 1,00,(6.5,80.,1.5,95)"), "     WORKDEF 1,0 (6.5, 80.0, 1.5, 95)");
  EXPECT_EQ(Canonical("work 0,00/on"), "     WORK 0,0 /ON");
  EXPECT_EQ(Canonical("GO 46/C"), "     GO 46 /C");
  EXPECT_EQ(Canonical("CALL 06 (VR[40],5)"), "     CALL 6 (VR[40], 5)");
  EXPECT_EQ(Canonical("WAIT (NOT IL[95])"), "     WAIT NOT IL[95]");
  EXPECT_EQ(Canonical("ASSIGN OL[22]=0/8"), "     ASSIGN OL[22] = 0 /8");
  EXPECT_EQ(Canonical("UPDATE OL,IL/OFF"), "     UPDATE IL, OL /OFF");
  EXPECT_EQ(Canonical("IMAGE"), "     IMAGE");
  EXPECT_EQ(Canonical("BREAK 07 ,45"), "     BREAK 7, 45");
  EXPECT_EQ(Canonical("VL[0]=TRUE"), "     LET VL[0] = ON");
  EXPECT_EQ(Canonical("cont  a   b"), "     CONT A B");
  EXPECT_EQ(Canonical("cont AaZz\t{`}~"), "     CONT AAZZ {`}~");
}

// OPT-B.40, OPT-7.73: parentheses only where the priority needs them.
TEST(Printer, ParenthesesOnlyWhereNeeded) {
  const auto expression = [](const std::string& text, const std::string& target = "VR[0]") {
    return Canonical(target + "=" + text).substr(5 + 4 + target.size() + 3);
  };
  EXPECT_EQ(expression("((VR[1]))+(2.*3.)"), "VR[1] + 2.0 * 3.0");
  EXPECT_EQ(expression("(VR[1]+2.)*3."), "(VR[1] + 2.0) * 3.0");
  EXPECT_EQ(expression("VR[1]-(VR[2]-VR[3])"), "VR[1] - (VR[2] - VR[3])");
  EXPECT_EQ(expression("(VR[1]-VR[2])-VR[3]"), "VR[1] - VR[2] - VR[3]");
  EXPECT_EQ(expression("2^(3^2)"), "2 ^ (3 ^ 2)");
  EXPECT_EQ(expression("-(VR[1]^2)"), "-(VR[1] ^ 2)");
  EXPECT_EQ(expression("-VR[1]^2"), "-VR[1] ^ 2");
  EXPECT_EQ(expression("-(-VR[1])"), "-(-VR[1])");
  EXPECT_EQ(expression("- 5"), "-5");
  EXPECT_EQ(expression("3--5"), "3 - -5");
  EXPECT_EQ(expression("SQRT((VR[1]+2.))"), "SQRT(VR[1] + 2.0)");
  EXPECT_EQ(expression("(VL[1] OR VL[2]) AND VL[3]", "VL[0]"), "(VL[1] OR VL[2]) AND VL[3]");
  EXPECT_EQ(expression("VL[1] OR (VL[2] AND VL[3])", "VL[0]"), "VL[1] OR VL[2] AND VL[3]");
  EXPECT_EQ(expression("NOT (VL[1] AND VL[2])", "VL[0]"), "NOT (VL[1] AND VL[2])");
  EXPECT_EQ(expression("NOT (NOT VL[1])", "VL[0]"), "NOT NOT VL[1]");
  EXPECT_EQ(expression("VL[1] AND (NOT VL[2])", "VL[0]"), "VL[1] AND NOT VL[2]");
  EXPECT_EQ(expression("(1 < 2) = (2 >< 3)", "VL[0]"), "(1 < 2) = (2 <> 3)");
}

// OPT-B.40: a sign before a literal is part of the literal, whatever parentheses stand between.
// OPT-1.06: and the canonical text compiles to the same object.
TEST(Printer, ASignIsPartOfItsLiteral) {
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"2. * -(4.)", "2.0 * -4.0"},
      {"-(5)", "-5"},
      {"-((5))", "-5"},
      {"-(-5)", "5"},
      {"-(+5)", "-5"},
      {"--(5)", "5"},
      {"3 - (5)", "3 - 5"},
      {"3 - -(5)", "3 - -5"},
      {"-(0)", "0"},
      {"-(0.)", "0.0"},
      {"-(32768)", "-32768.0"},  // 32768 is REAL by itself
      {"-(-32768)", "32768.0"},  // and no INTEGER
      {"-(-32767)", "32767"},
      {"-(2)^2", "-2 ^ 2"},
      {"-(2^2)", "-(2 ^ 2)"},
      {"-(2 + 3)", "-(2 + 3)"},
      {"SQRT(-(-4.))", "SQRT(4.0)"},
      {"-(PI)", "-PI"},
      {"-(VR[1])", "-VR[1]"},
      {"-(-(4.) + VR[1])", "-(-4.0 + VR[1])"},
  };
  for (const auto& [text, canonical] : rows) {
    const Compilation compiled = MustCompile("VR[0] = " + text + "\n");
    const std::string source = Decompile(compiled.module);
    EXPECT_EQ(source, "     LET VR[0] = " + canonical + "\n") << text;
    EXPECT_EQ(Format("VR[0] = " + text + "\n").text, source) << text;
    EXPECT_EQ(MustCompile(source).object, compiled.object) << text;
  }
}

// OPT-B.40, OPT-2.35: so it is refused like one without parentheses, at its place; the name of a
// constant is none.
TEST(Printer, ALiteralInParenthesesIsCheckedLikeOneWithout) {
  const Compilation compiled = Compile("SPEED  -( 5 ) ; no\n", "", {.advice = false});
  ASSERT_EQ(compiled.diagnostics.size(), 1U);
  EXPECT_EQ(compiled.diagnostics[0].code, ErrorCode::kLiteralRange);
  EXPECT_EQ(Canonical("DECLARE FIVE = 5\nVR[0] = -(FIVE)"),
            "     DECLARE FIVE = 5\n     LET VR[0] = -FIVE");
}

// OPT-B.85
TEST(Printer, DivisionsInTcpKeepTheirParentheses) {
  EXPECT_EQ(Canonical("TCP (0,0,(VR[1]/2)/0,0,-5)"), "     TCP (0, 0, (VR[1] / 2) / 0, 0, -5)");
  // Those outside of other parentheses only, and nothing but divisions.
  EXPECT_EQ(Canonical("TCP (0,0,ABS(VR[1]/2)/VR[2]+1,(ABS(VR[3])/2),(VR[4]/2)*3)"),
            "     TCP (0, 0, ABS(VR[1] / 2) / VR[2] + 1, (ABS(VR[3]) / 2), (VR[4] / 2 * 3))");
}

// OPT-7.51, OPT-7.46
TEST(Printer, NamesStayAndAreCut) {
  EXPECT_EQ(
      Decompile(
          MustCompile("DECLARE position1 = VR[1]\nDECLARE N = 3\nposition9 = VR[N]\n").module),
      "     DECLARE POSITION = VR[1]\n     DECLARE N = 3\n     LET POSITION = VR[N]\n");
}

// OPT-6.15: program 1 is written, and 0, which is the present one, is not.
TEST(Printer, TheProgramOfABreakpoint) {
  EXPECT_EQ(Canonical("BREAK 7, 1"), "     BREAK 7, 1");
  EXPECT_EQ(Canonical("SIMUL 7, 1"), "     SIMUL 7, 1");
  EXPECT_EQ(Canonical("BREAK 7, 0"), "     BREAK 7");
}

}  // namespace
}  // namespace rmlcell::optimo
