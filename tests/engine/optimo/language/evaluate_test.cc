#include "engine/optimo/language/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

class StoredVariables : public VariableAccess {
 public:
  float Read(Variable variable) override { return values_[{variable.group, variable.index}]; }
  void Set(VariableGroup group, int index, float value) {
    values_[{group, static_cast<std::uint8_t>(index)}] = value;
  }

 private:
  std::map<std::pair<VariableGroup, std::uint8_t>, float> values_;
};

// The value of `text` as the right-hand side of an assignment to `target`.
Result<Value> ValueOf(const std::string& text, const std::string& target = "VR[0]") {
  static StoredVariables variables;
  const Compilation compiled = MustCompile(target + " = " + text + "\n");
  if (!compiled.ok) return Error{ErrorCode::kSyntax, "did not compile", {}};
  return Evaluate(compiled.module.Value(compiled.module.instructions[0], 1), variables);
}
float Number(const std::string& text) {
  const Result<Value> value = ValueOf(text);
  EXPECT_TRUE(value) << text;
  return value ? value->number : -12345.0F;
}
bool Truth(const std::string& text) {
  const Result<Value> value = ValueOf(text, "VL[0]");
  EXPECT_TRUE(value) << text;
  return value && value->truth();
}
int ErrorOf(const std::string& text) {
  const Result<Value> value = ValueOf(text);
  return value ? 0 : Lookup(value.error().code).number;
}

// OPT-7.72, OPT-7.73, OPT-7.75
TEST(Evaluate, PrioritiesAreThoseOfTheManual) {
  EXPECT_EQ(Number("2+3*4"), 14.0F);
  EXPECT_EQ(Number("+5"), 5.0F);
  EXPECT_EQ(Number("-2^2"), 4.0F);
  EXPECT_EQ(Number("0-2^2"), -4.0F);
  EXPECT_EQ(Number("2^-1"), 0.5F);
  EXPECT_EQ(Number("2^(3^2)"), 512.0F);
}

// OPT-7.74
TEST(Evaluate, EqualPrioritiesGoFromTheLeft) {
  EXPECT_EQ(Number("2^3^2"), 64.0F);
  EXPECT_EQ(Number("8/4/2"), 1.0F);
  EXPECT_EQ(Number("7-3-2"), 2.0F);
  EXPECT_EQ(Number("10 MOD 4*3"), 6.0F);
}

// OPT-7.76, OPT-7.80
TEST(Evaluate, NumericOperatorsWorkInReal) {
  EXPECT_EQ(Number("7/2"), 3.5F);
  EXPECT_EQ(Number("7 MOD 3"), 1.0F);
  EXPECT_EQ(Number("-7 MOD 3"), -1.0F);
  EXPECT_EQ(Number("7.5 MOD 2"), 1.5F);
}

// OPT-7.77, OPT-7.78
TEST(Evaluate, AssignmentToIntegerTruncates) {
  EXPECT_EQ(*ConvertTo(ValueType::kInteger, *ValueOf("7/2")), 3.0F);
  EXPECT_EQ(*ConvertTo(ValueType::kInteger, *ValueOf("-7/2")), -3.0F);
  EXPECT_EQ(*ConvertTo(ValueType::kInteger, *ValueOf("2.9")), 2.0F);
  const Result<float> over = ConvertTo(ValueType::kInteger, *ValueOf("32767+1"));
  ASSERT_FALSE(over);
  EXPECT_EQ(over.error().code, ErrorCode::kIntegerOverflow);
  EXPECT_TRUE(ConvertTo(ValueType::kInteger, {ValueType::kReal, -32768.9F}));
  EXPECT_FALSE(ConvertTo(ValueType::kInteger, {ValueType::kReal, -32769.0F}));
}

// OPT-9.27
TEST(Evaluate, ParametersAreConverted) {
  EXPECT_EQ(*ConvertTo(ValueType::kInteger, {ValueType::kReal, 2.7F}), 2.0F);
  EXPECT_EQ(*ConvertTo(ValueType::kLogical, {ValueType::kReal, -0.5F}), 1.0F);
  EXPECT_EQ(*ConvertTo(ValueType::kReal, {ValueType::kLogical, 1.0F}), 1.0F);
}

// OPT-7.79, OPT-7.81, OPT-E.7201
TEST(Evaluate, DivisionByZeroIsAnError) {
  EXPECT_EQ(ErrorOf("1/0"), 7201);
  EXPECT_EQ(ErrorOf("5 MOD 0"), 7201);
  EXPECT_EQ(ErrorOf("0^-1"), 7201);
  EXPECT_EQ(Number("0^0"), 1.0F);
  EXPECT_EQ(ValueOf("1/0").error().detail, "division by zero");
}

// OPT-7.81, OPT-7.83, OPT-E.7204
TEST(Evaluate, FunctionsHaveDomains) {
  EXPECT_EQ(Number("(-2)^3"), -8.0F);
  EXPECT_EQ(ErrorOf("(-8)^(1/3)"), 7204);
  for (const char* text :
       {"SQRT(-1)", "ASIN(2)", "ACOS(-2)", "LN(0)", "LOG(0)", "EXP(33)", "EXP(-33)"}) {
    EXPECT_EQ(ErrorOf(text), 7204) << text;
  }
  EXPECT_EQ(Number("SQRT(0)"), 0.0F);
  EXPECT_EQ(ErrorOf("EXP(32)"), 0);
  // Just outside, and at the ends.
  for (const char* text : {"ASIN(1.000001)", "ASIN(-1.000001)", "ACOS(1.000001)", "ACOS(-1.000001)",
                           "SQRT(-1E-10)", "LN(-1)", "LN(-1E-10)", "LOG(-1)", "LOG(-1E-10)",
                           "EXP(32.00001)", "EXP(-32.00001)", "(-2)^0.5", "(-2)^(-0.5)"}) {
    EXPECT_EQ(ErrorOf(text), 7204) << text;
  }
  EXPECT_EQ(ErrorOf("EXP(-32)"), 0);
  EXPECT_EQ(Number("ACOS(1)"), 0.0F);
  EXPECT_FLOAT_EQ(Number("ACOS(-1)"), 3.14159265F);
  EXPECT_FLOAT_EQ(Number("ASIN(1)"), 1.57079633F);
  EXPECT_FLOAT_EQ(Number("ASIN(-1)"), -1.57079633F);
  EXPECT_EQ(Number("LN(1)"), 0.0F);
  EXPECT_EQ(Number("LOG(10)"), 1.0F);
  EXPECT_EQ(Number("LOG(1E-10)"), -10.0F);
  EXPECT_EQ(ErrorOf("LN(1E-18)"), 0);
}

// OPT-7.82, OPT-7.57, OPT-B.38
TEST(Evaluate, FunctionsTakeRadians) {
  EXPECT_EQ(Number("PI/2"), 1.570795F);
  EXPECT_EQ(Number("SIN(PI/2)"), 1.0F);
  EXPECT_EQ(Number("LOG(1000)"), 3.0F);
  EXPECT_EQ(Number("INT(-2.7)"), -2.0F);
  EXPECT_EQ(Number("ABS(-3)"), 3.0F);
  EXPECT_EQ(Number("ATAN(1)"), 0.785398163F);
  EXPECT_EQ(Number("EXP(1)"), 2.71828183F);
}

// OPT-W.73, OPT-7.57: PI is 3.14159, whatever name it has; it is REAL, and a constant.
TEST(Evaluate, PiHasSixDigits) {
  EXPECT_EQ(Number("PI"), 3.14159F);
  EXPECT_EQ(Number("-PI"), -3.14159F);
  // Not the pi of the mathematicians: it differs from 3.14159 in 24 bits by 2.53518 millionths.
  EXPECT_NEAR(Number("SIN(PI)*1000000."), 2.53518F, 1e-5F);
  EXPECT_EQ(*ConvertTo(ValueType::kInteger, *ValueOf("PI")), 3.0F);
  const Compilation compiled = MustCompile("DECLARE P = PI\nVR[0] = P\n");
  const ExprNode& node = compiled.module.Value(compiled.module.instructions[1], 1)[0];
  EXPECT_EQ(node.number, 3.14159F);
  EXPECT_EQ(node.type, ValueType::kReal);
  EXPECT_EQ(Decompile(compiled.module), "     DECLARE P = PI\n     LET VR[0] = P\n");
  EXPECT_EQ(FindingsOf("DECLARE P = PI\nP = 3.\n"), std::vector<int>{7015});
  EXPECT_EQ(FindingsOf("DECLARE PI = 3.\n"), std::vector<int>{7009});
  EXPECT_EQ(FindingsOf("VL[0] = PI\n"), std::vector<int>{7018});
  EXPECT_EQ(FindingsOf("DECLARE P = PI\nVR[P] = 1.\n"), std::vector<int>{7017});
}

// OPT-7.82, OPT-7.83, OPT-E.7204: each function by a value that no other has, and both ends of what
// it takes.
TEST(Evaluate, EachFunctionHasItsValuesAndEnds) {
  struct Row {
    const char* text;
    float value;
  };
  for (const Row& row :
       {Row{"SIN(1)", 0.841470985F}, Row{"COS(1)", 0.540302306F}, Row{"TAN(1)", 1.55740772F},
        Row{"ASIN(1)", 1.57079633F}, Row{"ASIN(-1)", -1.57079633F}, Row{"ACOS(-1)", 3.14159265F},
        Row{"ACOS(1)", 0.0F}, Row{"ATAN(-2)", -1.10714872F}, Row{"SQRT(2)", 1.41421356F},
        Row{"EXP(-32)", 1.26641655e-14F}, Row{"EXP(32)", 7.8962960e13F}, Row{"LN(10)", 2.30258509F},
        Row{"LOG(2)", 0.301029996F}, Row{"ABS(2.5)", 2.5F}, Row{"ABS(-2.5)", 2.5F},
        Row{"INT(2.7)", 2.0F}, Row{"INT(-2.7)", -2.0F}}) {
    EXPECT_EQ(Number(row.text), row.value) << row.text;
  }
  for (const char* text :
       {"ASIN(1.0001)", "ASIN(-1.0001)", "ACOS(1.0001)", "ACOS(-1.0001)", "SQRT(-.0001)",
        "EXP(32.0001)", "EXP(-32.0001)", "LN(-1)", "LOG(-1)", "(-8)^.5"}) {
    EXPECT_EQ(ErrorOf(text), 7204) << text;
  }
}

// OPT-7.80, OPT-7.81, OPT-7.85, OPT-7.86
TEST(Evaluate, EachOperatorHasItsValue) {
  EXPECT_EQ(Number("7 - 2"), 5.0F);
  EXPECT_EQ(Number("7 * -2"), -14.0F);
  EXPECT_EQ(Number("7 MOD -3"), 1.0F);
  EXPECT_EQ(Number("-7 MOD -3"), -1.0F);
  EXPECT_EQ(Number("(-2)^-1"), -0.5F);
  EXPECT_EQ(Number("0^2"), 0.0F);
  EXPECT_EQ(Number("-(0)"), 0.0F);
  EXPECT_EQ(Number("-(3-2)"), -1.0F);
  EXPECT_FALSE(std::signbit(Number("-(2-2)")));
  EXPECT_EQ(ErrorOf("0^-.5"), 7201);
  struct Row {
    const char* op;
    bool less, equal, greater;
  };
  for (const Row& row :
       {Row{"<", true, false, false}, Row{"<=", true, true, false}, Row{"=", false, true, false},
        Row{">=", false, true, true}, Row{">", false, false, true}, Row{"<>", true, false, true},
        Row{"><", true, false, true}}) {
    const std::string op = row.op;
    EXPECT_EQ(Truth("1 " + op + " 2"), row.less) << op;
    EXPECT_EQ(Truth("2 " + op + " 2"), row.equal) << op;
    EXPECT_EQ(Truth("3 " + op + " 2"), row.greater) << op;
  }
  struct Logical {
    const char* op;
    bool both, first, second, none;
  };
  for (const Logical& row :
       {Logical{" AND ", true, false, false, false}, Logical{" OR ", true, true, true, false},
        Logical{" XOR ", false, true, true, false}}) {
    const std::string op = row.op;
    EXPECT_EQ(Truth("ON" + op + "ON"), row.both) << op;
    EXPECT_EQ(Truth("ON" + op + "OFF"), row.first) << op;
    EXPECT_EQ(Truth("OFF" + op + "ON"), row.second) << op;
    EXPECT_EQ(Truth("OFF" + op + "OFF"), row.none) << op;
  }
}

// OPT-B.37, OPT-7.62, OPT-E.7202: 2^63 = 9.223372E18 and 2^-64 = 5.421011E-20 are the ends.
TEST(Evaluate, RealEndsAtTwoToTheSixtyThird) {
  EXPECT_EQ(Number("2^63"), 9223372036854775808.0F);
  EXPECT_EQ(Number("-(2^63)"), -9223372036854775808.0F);
  EXPECT_EQ(ErrorOf("2^63*1.000001"), 7202);
  EXPECT_EQ(ErrorOf("-(2^63)*1.000001"), 7202);
  EXPECT_EQ(Number("2^-64"), 5.42101086e-20F);
  EXPECT_EQ(Number("2^-64*.999999"), 0.0F);
  EXPECT_EQ(Number("-(2^-64)*.999999"), 0.0F);
}

// OPT-7.77, OPT-7.78, OPT-E.7203
TEST(Evaluate, IntegersEndAtSixteenBits) {
  const auto integer = [](float value) {
    return ConvertTo(ValueType::kInteger, {ValueType::kReal, value});
  };
  EXPECT_EQ(*integer(32767.9F), 32767.0F);
  EXPECT_FALSE(integer(32768.0F));
  EXPECT_EQ(*integer(-32768.9F), -32768.0F);
  ASSERT_FALSE(integer(-32769.0F));
  EXPECT_EQ(integer(-32769.0F).error().code, ErrorCode::kIntegerOverflow);
  EXPECT_EQ(*ConvertTo(ValueType::kLogical, {ValueType::kReal, 0.0F}), 0.0F);
  EXPECT_EQ(*ConvertTo(ValueType::kReal, {ValueType::kReal, 2.7F}), 2.7F);
}

// OPT-B.37, OPT-7.62, OPT-E.7202
TEST(Evaluate, RealHasTwentyFourBits) {
  EXPECT_EQ(Number("16777216.+1."), 16777216.0F);
  EXPECT_EQ(Number("0.1+0.2"), 0.3F);
  EXPECT_EQ(ErrorOf("1E18*100."), 7202);
  EXPECT_EQ(Number("1E-15*1E-15"), 0.0F);
  EXPECT_EQ(Number("4.6E18+4.6E18"), 9.2E18F);
}

// OPT-7.87, OPT-7.86, OPT-7.85
TEST(Evaluate, LogicalOperators) {
  EXPECT_TRUE(Truth("1 OR 1 AND 0"));
  EXPECT_TRUE(Truth("1 XOR 1 OR 1"));
  EXPECT_FALSE(Truth("NOT VR[1] = 0."));
  EXPECT_TRUE(Truth("VR[1] = 0."));
  EXPECT_FALSE(Truth("VR[1] >< 0."));
  EXPECT_FALSE(Truth("1 AND 0"));
}

// OPT-7.90
TEST(Evaluate, LogicalOperatorsTakeNoShortCut) {
  const Result<Value> value = ValueOf("ON OR (1/0 > 0)", "VL[0]");
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::kDivisionByZero);
}

// OPT-B.52
TEST(Evaluate, ComparisonOfRealsIsExact) {
  StoredVariables variables;
  variables.Set(VariableGroup::kVr, 0, 0.1F);
  const Compilation compiled = MustCompile("5 IF VR[0] = 0.1 THEN 5\n");
  const Result<Value> value =
      Evaluate(compiled.module.Value(compiled.module.instructions[0], 0), variables);
  ASSERT_TRUE(value);
  EXPECT_TRUE(value->truth());
  EXPECT_EQ(value->type, ValueType::kLogical);
}

// OPT-7.95, OPT-7.57
TEST(Evaluate, NamesStandForTheirValues) {
  StoredVariables variables;
  const Compilation compiled =
      MustCompile("DECLARE X = VR[0]\nDECLARE XHOME = 10.5\nX = XHOME + 200.0\n");
  const Instruction& let = compiled.module.instructions[2];
  EXPECT_EQ(compiled.module.Value(let, 0)[0].variable(), (Variable{VariableGroup::kVr, 0}));
  EXPECT_EQ(Evaluate(compiled.module.Value(let, 1), variables)->number, 210.5F);
}

}  // namespace
}  // namespace rmlcell::optimo
