#include "engine/optimo/language/constant_advice.h"

#include <optional>
#include <string>
#include <utility>

#include "engine/core/check.h"
#include "engine/optimo/language/evaluate.h"

namespace rmlcell::optimo {
namespace {

constexpr double kNoLimit = 1e30;

// What an operand must be, and the control's error when it is not.
struct OperandRange {
  double min = 0.0;
  double max = kNoLimit;
  ErrorCode code = ErrorCode::kValueRange;
  std::string_view text{};
  std::string_view rule{};
  bool above_min = false;
};
constexpr OperandRange kPercentRange{.max = 100.0, .text = "0 to 100", .rule = "OPT-2.35"};
constexpr OperandRange kRampSpeed{
    .max = 100.0, .text = "above 0 to 100", .rule = "OPT-3.08", .above_min = true};
constexpr OperandRange kRampPercent{.max = 100.0, .text = "0 to 100", .rule = "OPT-3.08"};
constexpr OperandRange kRampDelay{.text = "0 or more seconds", .rule = "OPT-3.08"};
constexpr OperandRange kWaitRange{.text = "0 or more seconds", .rule = "OPT-3.45"};
constexpr OperandRange kScheduleRange{.min = 1.0,
                                      .max = 0x1.fffffep5,  // truncated, OPT-3.07
                                      .code = ErrorCode::kScheduleRange,
                                      .text = "1 to 63",
                                      .rule = "OPT-3.06"};
constexpr OperandRange kErrorRange{.min = 1.0,
                                   .max = 9999.9990234375,  // the last REAL below 10000
                                   .code = ErrorCode::kSeterrRange,
                                   .text = "1 to 9999",
                                   .rule = "OPT-3.61"};

const OperandRange* RangeOf(const Instruction& i, std::uint32_t position) {
  switch (i.op) {
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh:
      return &kPercentRange;
    case Op::kDelay:
      return &kWaitRange;
    case Op::kSeterr:
      return &kErrorRange;
    case Op::kWorkdef:
      if (i.numbers[0] == 2 || position == 4) return &kScheduleRange;
      return position == 0 ? &kRampSpeed : position == 2 ? &kRampDelay : &kRampPercent;
    default:
      return nullptr;
  }
}

class NoVariables final : public VariableAccess {
 public:
  float Read(Variable) override {
    RMLCELL_CHECK(false);
    return 0.0F;
  }
};

class ConstantAdviser {
 public:
  ConstantAdviser(const ParsedProgram& program, Findings& findings)
      : p_(program), module_(program.module), findings_(findings) {}

  void Run() {
    for (const Instruction& i : module_.instructions) {
      const std::uint32_t count = module_.ExpressionCount(i);
      for (std::uint32_t e = 0; e < count; ++e) {
        const Expression expression = module_.expression(i.first_expression + e);
        // A literal by itself is the checker's, except where its type is changed, or it is waited
        // for.
        if (expression.size() == 1 && i.op != Op::kLet && i.op != Op::kWait) continue;
        if (IsConstant(expression) && !Look(i, e, expression)) break;  // one is told
      }
    }
  }

 private:
  // False: it was told.
  bool Look(const Instruction& i, std::uint32_t e, Expression expression) {
    const Result<Value> value = Evaluate(expression, none_);
    if (!value)
      return Tell(i, value.error().code, value.error().detail, RuleOf(value.error().code));
    if (i.op == Op::kLet && e == 1) {
      const Result<float> stored = ConvertTo(module_.Value(i, 0)[0].type, *value);
      if (!stored) return Tell(i, stored.error().code, stored.error().detail, "OPT-7.78");
    }
    if (i.op == Op::kWait && !value->truth()) {
      findings_.AddAs(Severity::kWarning, ErrorCode::kPracticeAdvice, p_.At(i),
                      "this waits for ever: the condition is never true", "OPT-7.27");
      return false;
    }
    const OperandRange* range = e < i.value_count ? RangeOf(i, e) : nullptr;
    if (range == nullptr || expression.size() == 1) return true;  // literals: the checker's
    const auto number = static_cast<double>(value->number);
    const bool above = range->above_min ? number > range->min : number >= range->min;
    if (above && number <= range->max) return true;
    return Tell(i, range->code, "a value that is not " + Told("allowed", range->text), range->rule);
  }

  static std::string_view RuleOf(ErrorCode code) {
    if (code == ErrorCode::kDivisionByZero) return "OPT-7.79";
    return code == ErrorCode::kRealOverflow ? "OPT-7.62" : "OPT-7.83";
  }

  bool Tell(const Instruction& i, ErrorCode code, const Detail& what, std::string_view rule) {
    findings_.AddAs(Severity::kWarning, code, p_.At(i),
                    "this fails whenever it is executed: " + what, rule);
    return false;
  }

  const ParsedProgram& p_;
  const Module& module_;
  Findings& findings_;
  NoVariables none_;
};

}  // namespace

void AdviseOnConstants(const ParsedProgram& program, Findings& findings) {
  ConstantAdviser(program, findings).Run();
}

}  // namespace rmlcell::optimo
