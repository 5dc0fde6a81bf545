// Random expressions: the engine against an evaluator of the tests' own; a failure names the seed.
#include <gtest/gtest.h>

#include <map>

#include "engine/optimo/language/evaluate.h"
#include "tests/engine/optimo/language/compile_text.h"
#include "tests/engine/optimo/language/random_expression.h"
#include "tests/engine/optimo/language/reference_evaluator.h"

namespace rmlcell::optimo {
namespace {

constexpr std::uint32_t kExpressionSeeds = 4000;

class ReferenceAccess : public VariableAccess {
 public:
  explicit ReferenceAccess(const ReferenceVariables& values) : values_(values) {}
  float Read(Variable variable) override {
    switch (variable.group) {
      case VariableGroup::kVr:
        return values_.vr.at(variable.index);
      case VariableGroup::kVi:
        return values_.vi.at(variable.index);
      default:
        return values_.vl.at(variable.index);
    }
  }

 private:
  const ReferenceVariables& values_;
};

ReferenceVariables RandomVariables(RandomExpression& random) {
  ReferenceVariables values;
  for (float& v : values.vr) v = random.Value();
  for (float& v : values.vi) v = static_cast<float>(random.Below(9)) - 4.0F;
  for (float& v : values.vl) v = static_cast<float>(random.Below(2));
  return values;
}

// How often each outcome came: a value under 0, an error under its number.
using Outcomes = std::map<int, int>;

void Agree(std::uint32_t seed, bool logical, Outcomes& outcomes) {
  RandomExpression random(seed);
  const ReferenceVariables values = RandomVariables(random);
  const std::string text = logical ? random.Logical(3) : random.Numeric(3);
  SCOPED_TRACE("seed " + std::to_string(seed) + ": " + text);
  const ReferenceValue expected = EvaluateText(text, values);
  ASSERT_TRUE(expected.understood);
  const Compilation compiled = MustCompile((logical ? "VL[0] = " : "VR[0] = ") + text + "\n");
  ASSERT_TRUE(compiled.ok);
  ReferenceAccess variables(values);
  const Result<Value> found =
      Evaluate(compiled.module.Value(compiled.module.instructions[0], 1), variables);
  ASSERT_EQ(found ? 0 : Lookup(found.error().code).number, expected.error);
  if (found) {
    ASSERT_EQ(found->number, expected.number);
    if (logical) {
      ASSERT_EQ(found->type, ValueType::kLogical);
    }
  }
  ++outcomes[expected.error];
}

// OPT-7.72, OPT-7.74, OPT-7.80, OPT-7.83, OPT-B.37
TEST(ExpressionProperties, NumbersAgreeWithASecondEvaluator) {
  Outcomes outcomes;
  for (std::uint32_t seed = 1; seed <= kExpressionSeeds && !HasFatalFailure(); ++seed)
    Agree(seed, false, outcomes);
  EXPECT_GT(outcomes[0],
            static_cast<int>(kExpressionSeeds) / 2);  // values, not errors, most of the time
  for (const int error : {7201, 7202, 7204}) EXPECT_GT(outcomes[error], 10) << error;
}

// OPT-7.85, OPT-7.87, OPT-7.90, OPT-B.44
TEST(ExpressionProperties, ConditionsAgreeWithASecondEvaluator) {
  Outcomes outcomes;
  for (std::uint32_t seed = 1; seed <= kExpressionSeeds && !HasFatalFailure(); ++seed)
    Agree(seed, true, outcomes);
  EXPECT_GT(outcomes[0], static_cast<int>(kExpressionSeeds) / 2);
  EXPECT_GT(outcomes[7201], 10);
}

// The second evaluator itself, on values worked out by hand: OPT-7.73, OPT-7.74, OPT-7.80,
// OPT-7.86, OPT-7.87
TEST(ExpressionProperties, TheSecondEvaluatorFollowsTheManual) {
  ReferenceVariables values;
  values.vr[1] = 2.0F;
  const auto number = [&](std::string_view text) { return EvaluateText(text, values).number; };
  const auto error = [&](std::string_view text) { return EvaluateText(text, values).error; };
  EXPECT_EQ(number("-2^2"), 4.0F);
  EXPECT_EQ(number("2^3^2"), 64.0F);
  EXPECT_EQ(number("10 MOD 4*3"), 6.0F);
  EXPECT_EQ(number("-7 MOD 3"), -1.0F);
  EXPECT_EQ(number("1 OR 1 AND 0"), 1.0F);
  EXPECT_EQ(number("NOT VR[1] = 2."), 0.0F);
  EXPECT_EQ(number(".256 E -3"), 0.000256F);
  EXPECT_EQ(error("0 OR (1/0 > 0)"), 7201);
  EXPECT_EQ(error("1E18*100."), 7202);
  EXPECT_EQ(error("(-8)^(1/3)"), 7204);
  EXPECT_FALSE(EvaluateText("2 +", values).understood);
}

}  // namespace
}  // namespace rmlcell::optimo
