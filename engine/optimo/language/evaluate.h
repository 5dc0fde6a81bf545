#pragma once

#include <bit>
#include <cstdint>

#include "engine/core/result.h"
#include "engine/optimo/language/ast.h"

// Values of expressions, in IEEE single precision (OPT-B.37): every literal, operator and function
// result is rounded to 24 bits; below 2^-64 it becomes 0, beyond 2^63 it is an error.
namespace rmlcell::optimo {

// INTEGER and LOGICAL values are whole numbers in `number`: 16 bits fit into 24.
struct Value {
  ValueType type = ValueType::kReal;
  float number = 0.0F;

  bool truth() const { return number != 0.0F; }  // numeric is true when not zero, OPT-7.24
  bool operator==(const Value&) const = default;
};

inline constexpr float kPiLanguage = 3.14159F;                    // OPT-7.57
inline constexpr double kRealMax = 9223372036854775808.0;         // 2^63, OPT-7.62
inline constexpr double kRealMin = 1.0 / 18446744073709551616.0;  // 2^-64
inline constexpr int kIntegerMin = -32768;
inline constexpr int kIntegerMax = 32767;

// Of the result of an operation: one too small becomes 0. False: beyond 2^63, or no number at all.
inline bool BecomesReal(float& result) {
  constexpr auto kLeast = std::bit_cast<std::uint32_t>(static_cast<float>(kRealMin));
  constexpr auto kMost = std::bit_cast<std::uint32_t>(static_cast<float>(kRealMax));
  const std::uint32_t magnitude = std::bit_cast<std::uint32_t>(result) & 0x7FFF'FFFFU;
  if (magnitude - kLeast <= kMost - kLeast) return true;
  if (magnitude >= kLeast) return false;
  result = 0.0F;
  return true;
}

// What an operator gives: a number, or why there is none.
struct Outcome {
  float number = 0.0F;
  bool good = true;
  ErrorCode code{};  // where it is not good
};
// An operator or function; with one operand `right` is not looked at. Errors as those of Evaluate.
Outcome Operate(Node op, float left, float right);

// What an expression may read. A read of IL or IA may refresh the image first (OPT-7.97).
class VariableAccess {
 public:
  virtual ~VariableAccess() = default;
  virtual float Read(Variable variable) = 0;
};

// Pending operands that an expression may have; the checker refuses more, so that evaluation needs
// a fixed room. No program that people write comes near.
inline constexpr std::size_t kOperandStackMax = 128;

// Precondition: the expression comes from a checked module. Evaluation is complete, without short
// cut (OPT-7.90); the first error in evaluation order is returned. Errors: DivisionByZero 7201,
// RealOverflow 7202, Domain 7204.
Result<Value> Evaluate(Expression expression, VariableAccess& variables);

// A literal, a constant name or signs and operators on them: its value does not depend on
// variables.
bool IsConstant(Expression expression);

// Converts for storing: REAL truncates towards zero into INTEGER (OPT-7.77); numbers into LOGICAL
// by "not zero" (only parameters, OPT-9.27). Errors: IntegerOverflow 7203.
Result<float> ConvertTo(ValueType type, Value value);

// Truncation towards zero. Errors: IntegerOverflow 7203 outside -32768..32767.
Result<int> TruncateToInteger(float number);

}  // namespace rmlcell::optimo
