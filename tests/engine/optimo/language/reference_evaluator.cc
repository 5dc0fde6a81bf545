#include "tests/engine/optimo/language/reference_evaluator.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string>

namespace rmlcell::optimo {
namespace {

constexpr int kDivisionByZero = 7201, kOverflow = 7202, kDomain = 7204;

// To 24 bits, in the range of REAL. OPT-B.37, OPT-7.62
ReferenceValue Rounded(long double value) {
  const auto number = static_cast<float>(value);
  if (std::isnan(number)) return {0.0F, kDomain};
  if (std::fabs(number) > std::ldexp(1.0F, 63)) return {0.0F, kOverflow};
  return {std::fabs(number) < std::ldexp(1.0F, -64) ? 0.0F : number};
}

// a - b * trunc(a / b), exactly: b is taken away as long as it goes, in steps of powers of two.
// OPT-7.80
ReferenceValue Modulo(float a, float b) {
  if (b == 0.0F) return {0.0F, kDivisionByZero};
  double rest = std::fabs(a);
  const double divisor = std::fabs(b);
  for (int shift = 160; shift >= 0; --shift) {
    const double step = std::ldexp(divisor, shift);
    if (rest >= step) rest -= step;
  }
  return Rounded(a < 0.0F ? -rest : rest);
}

// OPT-7.81
ReferenceValue Power(float base, float exponent) {
  const bool whole = std::floor(exponent) == exponent;
  if (base == 0.0F && exponent < 0.0F) return {0.0F, kDivisionByZero};
  if (base < 0.0F && !whole) return {0.0F, kDomain};
  if (!whole || std::fabs(exponent) > 200.0F) {
    return Rounded(std::pow(static_cast<long double>(base), static_cast<long double>(exponent)));
  }
  long double product = 1.0L;
  for (int n = 0; n < static_cast<int>(std::fabs(exponent)); ++n) product *= base;
  return Rounded(exponent < 0.0F ? 1.0L / product : product);
}

// OPT-7.82, OPT-7.83
ReferenceValue Function(const std::string& name, float argument) {
  const long double x = argument;
  const bool outside_one = argument < -1.0F || argument > 1.0F;
  if (name == "SIN") return Rounded(std::sin(x));
  if (name == "COS") return Rounded(std::cos(x));
  if (name == "TAN") return Rounded(std::tan(x));
  if (name == "ATAN") return Rounded(std::atan(x));
  if (name == "ABS") return Rounded(argument < 0.0F ? -x : x);
  if (name == "INT") return Rounded(argument < 0.0F ? std::ceil(x) : std::floor(x));
  if (name == "ASIN") return outside_one ? ReferenceValue{0.0F, kDomain} : Rounded(std::asin(x));
  if (name == "ACOS") return outside_one ? ReferenceValue{0.0F, kDomain} : Rounded(std::acos(x));
  if (name == "SQRT")
    return argument < 0.0F ? ReferenceValue{0.0F, kDomain} : Rounded(std::sqrt(x));
  if (name == "LN") return argument <= 0.0F ? ReferenceValue{0.0F, kDomain} : Rounded(std::log(x));
  if (name == "LOG")
    return argument <= 0.0F ? ReferenceValue{0.0F, kDomain} : Rounded(std::log10(x));
  if (name == "EXP")
    return std::fabs(argument) > 32.0F ? ReferenceValue{0.0F, kDomain} : Rounded(std::exp(x));
  return {.understood = false};
}

class Reader {
 public:
  Reader(std::string_view text, const ReferenceVariables& variables)
      : text_(text), variables_(variables) {}

  ReferenceValue Whole() {
    ReferenceValue value = Expr();
    Blanks();
    value.understood = value.understood && at_ == text_.size();
    return value;
  }

 private:
  // expr = xorterm { ( "OR" | "XOR" ) xorterm } ;
  ReferenceValue Expr() {
    ReferenceValue left = XorTerm();
    while (true) {
      if (Word("OR")) {
        left = Both(left, XorTerm(), [](float a, float b) { return Truth(a != 0 || b != 0); });
      } else if (Word("XOR")) {
        left = Both(left, XorTerm(), [](float a, float b) { return Truth((a != 0) != (b != 0)); });
      } else {
        return left;
      }
    }
  }
  // xorterm = notterm { "AND" notterm } ;
  ReferenceValue XorTerm() {
    ReferenceValue left = NotTerm();
    while (Word("AND"))
      left = Both(left, NotTerm(), [](float a, float b) { return Truth(a != 0 && b != 0); });
    return left;
  }
  // notterm = { "NOT" } relation ;
  ReferenceValue NotTerm() {
    if (!Word("NOT")) return Relation();
    ReferenceValue value = NotTerm();
    if (value.error == 0) value.number = value.number == 0.0F ? 1.0F : 0.0F;
    return value;
  }
  // relation = sum [ relop sum ] ;
  ReferenceValue Relation() {
    const ReferenceValue left = Sum();
    if (Sign("<>") || Sign("><"))
      return Both(left, Sum(), [](float a, float b) { return Truth(a < b || a > b); });
    if (Sign("<=")) return Both(left, Sum(), [](float a, float b) { return Truth(!(a > b)); });
    if (Sign(">=")) return Both(left, Sum(), [](float a, float b) { return Truth(!(a < b)); });
    if (Sign("<")) return Both(left, Sum(), [](float a, float b) { return Truth(a < b); });
    if (Sign(">")) return Both(left, Sum(), [](float a, float b) { return Truth(a > b); });
    if (Sign("="))
      return Both(left, Sum(), [](float a, float b) { return Truth(!(a < b) && !(a > b)); });
    return left;
  }
  // sum = term { ( "+" | "-" ) term } ;  in IEEE single precision
  ReferenceValue Sum() {
    ReferenceValue left = Term();
    while (true) {
      if (Sign("+")) {
        left = Both(left, Term(), [](float a, float b) { return Rounded(a + b); });
      } else if (Sign("-")) {
        left = Both(left, Term(), [](float a, float b) { return Rounded(a - b); });
      } else {
        return left;
      }
    }
  }
  // term = power { ( "*" | "/" | "MOD" ) power } ;
  ReferenceValue Term() {
    ReferenceValue left = PowerTerm();
    while (true) {
      if (Sign("*")) {
        left = Both(left, PowerTerm(), [](float a, float b) { return Rounded(a * b); });
      } else if (Sign("/")) {
        left = Both(left, PowerTerm(), [](float a, float b) {
          return b == 0.0F ? ReferenceValue{0.0F, kDivisionByZero} : Rounded(a / b);
        });
      } else if (Word("MOD")) {
        left = Both(left, PowerTerm(), Modulo);
      } else {
        return left;
      }
    }
  }
  // power = signed { "^" signed } ;
  ReferenceValue PowerTerm() {
    ReferenceValue left = Signed();
    while (Sign("^")) left = Both(left, Signed(), Power);
    return left;
  }
  // signed = { "+" | "-" } primary ;
  ReferenceValue Signed() {
    if (Sign("+")) return Signed();
    if (!Sign("-")) return Primary();
    ReferenceValue value = Signed();
    value.number = -value.number;
    return value;
  }
  ReferenceValue Primary() {
    Blanks();
    if (Sign("(")) return Closed(Expr());
    if (at_ < text_.size() && (IsDigit(text_[at_]) || text_[at_] == '.')) return Number();
    for (const char* on : {"ON", "TRUE", "YES"}) {
      if (Word(on)) return {1.0F};
    }
    for (const char* off : {"OFF", "FALSE", "NO"}) {
      if (Word(off)) return {0.0F};
    }
    if (Word("PI")) return {3.14159F};
    const std::string name = TakeLetters();
    if (Sign("[")) return Variable(name);
    if (!Sign("(")) return {.understood = false};
    const ReferenceValue argument = Closed(Expr());
    if (argument.error != 0 || !argument.understood) return argument;
    return Function(name, argument.number);
  }
  ReferenceValue Closed(ReferenceValue value) {
    value.understood = Sign(")") && value.understood;
    return value;
  }
  ReferenceValue Variable(const std::string& group) {
    Blanks();
    std::size_t index = 0;
    while (at_ < text_.size() && IsDigit(text_[at_]))
      index = index * 10 + static_cast<std::size_t>(text_[at_++] - '0');
    if (!Sign("]") || index >= variables_.vr.size()) return {.understood = false};
    if (group == "VR") return {variables_.vr[index]};
    if (group == "VI") return {variables_.vi[index]};
    if (group == "VL") return {variables_.vl[index]};
    return {.understood = false};
  }
  // Digits with at most one point, then an exponent that may have blanks. OPT-7.54, OPT-7.55
  ReferenceValue Number() {
    std::string plain;
    const auto digits = [&] {
      while (at_ < text_.size() && (IsDigit(text_[at_]) || text_[at_] == '.'))
        plain += text_[at_++];
    };
    digits();
    if (Sign("E") || Sign("e")) {
      plain += 'e';
      if (Sign("-")) plain += '-';
      Sign("+");
      Blanks();
      digits();
    }
    return Rounded(std::strtof(plain.c_str(), nullptr));
  }

  static ReferenceValue Truth(bool value) { return {value ? 1.0F : 0.0F}; }
  static bool IsDigit(char c) { return c >= '0' && c <= '9'; }

  // Both operands are worked out, whatever the first one is. OPT-7.90
  template <typename Operation>
  static ReferenceValue Both(const ReferenceValue& a, const ReferenceValue& b,
                             Operation operation) {
    if (a.error != 0 || !a.understood) return a;
    if (b.error != 0 || !b.understood) return b;
    return operation(a.number, b.number);
  }

  void Blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool Sign(std::string_view sign) {
    Blanks();
    if (text_.substr(at_, sign.size()) != sign) return false;
    at_ += sign.size();
    return true;
  }
  std::string TakeLetters() {
    std::string word;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0)
      word += static_cast<char>(std::toupper(static_cast<unsigned char>(text_[at_++])));
    Blanks();
    return word;
  }
  bool Word(std::string_view word) {
    Blanks();
    const std::size_t before = at_;
    if (TakeLetters() == word) return true;
    at_ = before;
    return false;
  }

  std::string_view text_;
  const ReferenceVariables& variables_;
  std::size_t at_ = 0;
};

}  // namespace

ReferenceValue EvaluateText(std::string_view text, const ReferenceVariables& variables) {
  return Reader(text, variables).Whole();
}

}  // namespace rmlcell::optimo
