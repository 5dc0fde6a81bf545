#include <gtest/gtest.h>

#include <sstream>

#include "tests/engine/optimo/control/run_text.h"

// Expressions as a run computes them. Their operands stand in variables, so that nothing can be
// known before: X, Y and Z are VR[1], VR[2] and VR[3].
namespace rmlcell::optimo::testing::expression_run {
namespace {

struct Row {
  std::string operands;  // "2 3 4" for X, Y, Z; those left out are 0
  std::string expression;
  std::string wanted;  // as VR[0] shows it
};

std::string ProgramOf(const Row& row) {
  std::string text = "DECLARE X = VR[1]\nDECLARE Y = VR[2]\nDECLARE Z = VR[3]\n";
  std::istringstream operands(row.operands);
  std::string value;
  for (const char* name : {"X = ", "Y = ", "Z = "}) {
    if (operands >> value) text += name + value + "\n";
  }
  return text + "VR[0] = " + row.expression + "\n";
}

void ExpectResults(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    const Ran ran = RunText(ProgramOf(row), {.variables = {"VR[0]"}});
    EXPECT_EQ(CodeOf(ran), 0) << row.expression;
    EXPECT_EQ(ran.variables.at("VR[0]"), row.wanted) << row.expression << " of " << row.operands;
  }
}

// OPT-7.72, OPT-7.73, OPT-7.74, OPT-7.75: the minus sign first, then functions, '^', '*' '/' MOD,
// '+'
// '-'; of equals the leftmost first.
TEST(ExpressionRun, Priorities) {
  ExpectResults({{"2 3 4", "X + Y * Z", "14.0"},
                 {"2 3 4", "(X + Y) * Z", "20.0"},
                 {"5", "+X", "5.0"},
                 {"2 3", "Y * X ^ 2", "12.0"},
                 {"2 4", "2 * SQRT(Y) ^ 3", "16.0"},
                 {"2", "-X ^ 2", "4.0"},
                 {"2", "0 - X ^ 2", "-4.0"},
                 {"2", "X ^ -1", "0.5"},
                 {"2 3", "X ^ Y ^ X", "64.0"},
                 {"2 3", "X ^ (Y ^ X)", "512.0"},
                 {"8 4 2", "X / Y / Z", "1.0"},
                 {"8 4 2", "X / (Y / Z)", "4.0"},
                 {"7 3 2", "X - Y - Z", "2.0"},
                 {"7 3 2", "X - (Y - Z)", "6.0"},
                 {"10 4 3", "X MOD Y * Z", "6.0"},
                 {"10 4 3", "X MOD (Y * Z)", "10.0"},
                 {"7 3 2", "X - Y + Z", "6.0"}});
}

// OPT-7.76, OPT-7.77, OPT-7.80: numbers of VI are reals on the way, and cut towards zero where a VI
// takes them; the rest of MOD has the sign of its first operand.
TEST(ExpressionRun, IntegersAndRests) {
  ExpectValues({{"VI[2]=7\nVI[3]=2\nVR[0]=VI[2]/VI[3]\n", "VR[0]", "3.5"},
                {"VI[2]=7\nVI[3]=2\nVI[4]=VI[2]/VI[3]\n", "VI[4]", "3"},
                {"VI[2]=-7\nVI[3]=2\nVI[4]=VI[2]/VI[3]\n", "VI[4]", "-3"},
                {"VR[0]=2.9\nVI[4]=VR[0]\n", "VI[4]", "2"},
                {"VR[0]=-2.9\nVI[4]=VR[0]\n", "VI[4]", "-2"},
                {"VI[2]=7\nVI[3]=2\nVI[4]=VI[2]/VI[3]*2\n", "VI[4]", "7"}});
  ExpectResults({{"7 3", "X MOD Y", "1.0"},
                 {"-7 3", "X MOD Y", "-1.0"},
                 {"7 -3", "X MOD Y", "1.0"},
                 {"7.5 2", "X MOD Y", "1.5"},
                 {"6 3", "X MOD Y", "0.0"}});
}

// OPT-7.81, OPT-7.82, OPT-B.38: powers and functions, computed in double precision and rounded
// once: the sine of 1.570795 is 1 - 9e-13. 1.5707964 and 0.7853982 are a half and a quarter of pi
// in seven digits, 7.896296E13 is e to 32.
TEST(ExpressionRun, PowersAndFunctions) {
  ExpectResults({{"-2 3", "X ^ Y", "-8.0"},
                 {"0 0", "X ^ Y", "1.0"},
                 {"6.25", "SQRT(X)", "2.5"},
                 {"0", "SQRT(X)", "0.0"},
                 {"1.570795", "SIN(X)", "1.0"},
                 {"3.14159", "COS(X)", "-1.0"},
                 {"1", "TAN(X)", "1.5574077"},
                 {"1", "ASIN(X)", "1.5707964"},
                 {"-1", "ASIN(X)", "-1.5707964"},
                 {"1", "ACOS(X)", "0.0"},
                 {"0", "ACOS(X)", "1.5707964"},
                 {"1", "ATAN(X)", "0.7853982"},
                 {"1", "LN(X)", "0.0"},
                 {"1000", "LOG(X)", "3.0"},
                 {"0", "EXP(X)", "1.0"},
                 {"32", "EXP(X)", "7.896296E13"},
                 {"-3", "ABS(X)", "3.0"},
                 {"-2.7", "INT(X)", "-2.0"},
                 {"2.7", "INT(X)", "2.0"}});
}

// OPT-7.79, OPT-7.81, OPT-7.83: what a function cannot take ends the run with its code; the bounds
// themselves may be used.
TEST(ExpressionRun, Domains) {
  const struct {
    Row row;
    int code;
  } cases[] = {{{"1 0", "X / Y", ""}, 7201},       {{"5 0", "X MOD Y", ""}, 7201},
               {{"0 -1", "X ^ Y", ""}, 7201},      {{"-8", "X ^ (1/3)", ""}, 7204},
               {{"-0.0001", "SQRT(X)", ""}, 7204}, {{"0", "SQRT(X)", ""}, 0},
               {{"1.00001", "ASIN(X)", ""}, 7204}, {{"-1.00001", "ASIN(X)", ""}, 7204},
               {{"1.00001", "ACOS(X)", ""}, 7204}, {{"-1.00001", "ACOS(X)", ""}, 7204},
               {{"-1", "ACOS(X)", ""}, 0},         {{"0", "LN(X)", ""}, 7204},
               {{"-1", "LN(X)", ""}, 7204},        {{"0.0001", "LN(X)", ""}, 0},
               {{"0", "LOG(X)", ""}, 7204},        {{"0.0001", "LOG(X)", ""}, 0},
               {{"32.0001", "EXP(X)", ""}, 7204},  {{"32", "EXP(X)", ""}, 0},
               {{"-32.0001", "EXP(X)", ""}, 7204}, {{"-32", "EXP(X)", ""}, 0}};
  for (const auto& [row, code] : cases) {
    EXPECT_EQ(CodeOf(RunText(ProgramOf(row))), code) << row.expression << " of " << row.operands;
  }
}

// OPT-2.35, OPT-7.62, OPT-B.37: numbers of other instructions than LET are the same: rounded to 24
// bits by each operation, too small ones 0, too large ones an error. 1000 + 0.00003 is 1000 in 24
// bits, whose steps are 0.00006 there.
TEST(ExpressionRun, NumbersOfInstructions) {
  const struct {
    Row row;
    double x_mm;
  } cases[] = {{{"1000 2.5 4", "X + Y * Z", ""}, 1010.0},
               {{"1000 2.5 4", "X - Y - Z", ""}, 993.5},
               {{"1000 0.00003", "X + Y + Y", ""}, 1000.0},
               {{"1000 1E-12", "X + Y * Y * 1E+18", ""}, 1000.0},
               {{"3000 2.5", "X / Y - 100", ""}, 1100.0},
               {{"-900", "-X", ""}, 900.0},
               {{"1000 1", "X+(Y+(Y+(Y+(Y+(Y+(Y+(Y+(Y+Y))))))))", ""}, 1009.0}};
  for (const auto& [row, x_mm] : cases) {
    const Ran ran = RunText(ProgramOf(row) + "COORD ABSOL\nPATH LIN\nMOVE (" + row.expression +
                            ", 900., -400., 0., 0.)\n");
    ASSERT_EQ(ran.moves.size(), 1U) << row.expression;
    EXPECT_EQ(ran.moves.front().program_point.x(), x_mm) << row.expression;
  }
  EXPECT_EQ(CodeOf(RunText("VR[1] = 5E+18\nSPEED VR[1] + VR[1]\n")), 7202);  // beyond 2^63
}

}  // namespace
}  // namespace rmlcell::optimo::testing::expression_run
