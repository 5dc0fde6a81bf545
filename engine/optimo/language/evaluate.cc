#include "engine/optimo/language/evaluate.h"

#include <cmath>
#include <cstddef>

namespace rmlcell::optimo {
namespace {

Outcome Fail(ErrorCode code) { return {0.0F, false, code}; }

Outcome OfFloat(float result) {
  if (BecomesReal(result)) return {result};
  return Fail(std::isnan(result) ? ErrorCode::kDomain : ErrorCode::kRealOverflow);
}

// Functions are computed in double precision and rounded once (OPT-B.38). Outside its domain a
// function is not a number.
Outcome Round(double value) { return OfFloat(static_cast<float>(value)); }

// OPT-7.81: any base with an integer exponent; 0^0 is 1.
Outcome Power(double base, double exponent) {
  if (base == 0.0 && exponent < 0.0) return Fail(ErrorCode::kDivisionByZero);
  return Round(std::pow(base, exponent));
}

// OPT-7.80: the sign of a. fmod is exact: a - b * trunc(a / b) without rounding between.
Outcome Modulo(double a, double b) {
  if (b == 0.0) return Fail(ErrorCode::kDivisionByZero);
  return Round(std::fmod(a, b));
}

Outcome Function(Node op, double x) {
  switch (op) {
    case Node::kSin:
      return Round(std::sin(x));
    case Node::kCos:
      return Round(std::cos(x));
    case Node::kTan:
      return Round(std::tan(x));
    case Node::kAsin:
      return Round(std::asin(x));
    case Node::kAcos:
      return Round(std::acos(x));
    case Node::kAtan:
      return Round(std::atan(x));
    case Node::kSqrt:
      return Round(std::sqrt(x));
    case Node::kExp:
      return x < -32.0 || x > 32.0 ? Fail(ErrorCode::kDomain) : Round(std::exp(x));
    case Node::kLn:
      return x == 0.0 ? Fail(ErrorCode::kDomain) : Round(std::log(x));
    case Node::kLog:
      return x == 0.0 ? Fail(ErrorCode::kDomain) : Round(std::log10(x));
    case Node::kAbs:
      return {static_cast<float>(std::fabs(x))};
    default:
      return {static_cast<float>(std::trunc(x))};
  }
}

Outcome Unary(Node op, float operand) {
  switch (op) {
    case Node::kNegate:
      return {operand == 0.0F ? 0.0F : -operand};
    case Node::kNot:
      return {operand == 0.0F ? 1.0F : 0.0F};
    default:
      return Function(op, static_cast<double>(operand));
  }
}

Outcome Binary(Node op, double a, double b) {
  const auto truth = [](bool value) { return Outcome{value ? 1.0F : 0.0F}; };
  switch (op) {
    case Node::kPower:
      return Power(a, b);
    case Node::kMod:
      return Modulo(a, b);
    case Node::kLess:
      return truth(a < b);
    case Node::kLessEqual:
      return truth(a <= b);
    case Node::kEqual:
      return truth(a == b);
    case Node::kGreaterEqual:
      return truth(a >= b);
    case Node::kGreater:
      return truth(a > b);
    case Node::kNotEqual:
      return truth(a != b);
    case Node::kAnd:
      return truth(a != 0.0 && b != 0.0);
    case Node::kOr:
      return truth(a != 0.0 || b != 0.0);
    default:
      return truth((a != 0.0) != (b != 0.0));
  }
}

std::string DetailOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kDivisionByZero:
      return "division by zero";
    case ErrorCode::kRealOverflow:
      return "a result beyond 2^63";
    default:
      return "an argument outside its domain";
  }
}

}  // namespace

Outcome Operate(Node op, float left, float right) {
  switch (op) {
    case Node::kMultiply:
      return OfFloat(left * right);
    case Node::kDivide:
      return right == 0.0F ? Fail(ErrorCode::kDivisionByZero) : OfFloat(left / right);
    case Node::kAdd:
      return OfFloat(left + right);
    case Node::kSubtract:
      return OfFloat(left - right);
    default:
      return Arity(op) == 1 ? Unary(op, left)
                            : Binary(op, static_cast<double>(left), static_cast<double>(right));
  }
}

Result<Value> Evaluate(Expression expression, VariableAccess& variables) {
  float stack[kOperandStackMax];
  std::size_t top = 0;
  for (const ExprNode& node : expression) {
    const int arity = Arity(node.op);
    if (arity == 0) {
      RMLCELL_CHECK(top < kOperandStackMax);
      stack[top++] = node.op == Node::kVariable ? variables.Read(node.variable()) : node.number;
      continue;
    }
    RMLCELL_CHECK(top >= static_cast<std::size_t>(arity));
    top -= static_cast<std::size_t>(arity);
    const Outcome outcome = Operate(node.op, stack[top], arity == 2 ? stack[top + 1] : 0.0F);
    if (!outcome.good) return Error{outcome.code, DetailOf(outcome.code), {}};
    stack[top++] = outcome.number;
  }
  RMLCELL_CHECK(top == 1);
  return Value{expression.back().type, stack[0]};
}

bool IsConstant(Expression expression) {
  for (const ExprNode& node : expression) {
    if (node.op == Node::kVariable || node.op == Node::kName) return false;
  }
  return true;
}

Result<int> TruncateToInteger(float number) {
  const float whole = std::trunc(number);
  if (!(whole >= static_cast<float>(kIntegerMin) && whole <= static_cast<float>(kIntegerMax))) {
    return Error{ErrorCode::kIntegerOverflow, "a value outside -32768..32767", {}};
  }
  return static_cast<int>(whole);
}

Result<float> ConvertTo(ValueType type, Value value) {
  switch (type) {
    case ValueType::kLogical:
      return value.truth() ? 1.0F : 0.0F;
    case ValueType::kReal:
      return value.number;
    case ValueType::kInteger:
      break;
  }
  const Result<int> whole = TruncateToInteger(value.number);
  if (!whole) return whole.error();
  return static_cast<float>(*whole);
}

}  // namespace rmlcell::optimo
