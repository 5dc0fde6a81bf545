#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>

namespace rmlcell::optimo {

// Writes right-typed expressions by the grammar of optimo.md B.9: every operator at its own level,
// so that priorities and not parentheses decide, odd blanks, every form of a number. Reads VR, VI
// and VL with the indices 0 to 9. The same seed gives the same text on every platform.
class RandomExpression {
 public:
  explicit RandomExpression(std::uint32_t seed) : random_(seed) {}

  // sum = term { ( "+" | "-" ) term } ;
  std::string Numeric(int depth) {
    std::string text = Term(depth);
    for (std::uint32_t n = Below(3); n > 1; --n) text += Pick({"+", "-"}) + Term(depth);
    return text;
  }

  // expr = xorterm { ( "OR" | "XOR" ) xorterm } ;  and below it AND
  std::string Logical(int depth) {
    std::string text = NotTerm(depth);
    for (std::uint32_t n = Below(3); n > 0; --n)
      text += Pick({" AND ", " or ", " XOR ", " And\t", " OR "}) + NotTerm(depth);
    return text;
  }

  float Value() {
    constexpr std::array kValues = {0.0F, 1.0F,     -1.0F,  2.0F,    0.5F,     -3.25F,
                                    7.0F, 100.125F, 32.5F,  -0.001F, 1.0E6F,   12.75F,
                                    3.0F, 1.0E-9F,  -40.0F, 4.0E12F, -2.5E-3F, 0.1F};
    return kValues[Below(kValues.size())];
  }
  std::uint32_t Below(std::size_t bound) {
    return static_cast<std::uint32_t>(random_()) % static_cast<std::uint32_t>(bound);
  }

 private:
  // term = power { ( "*" | "/" | "MOD" ) power } ;
  std::string Term(int depth) {
    std::string text = Power(depth);
    for (std::uint32_t n = Below(3); n > 1; --n)
      text += Pick({"*", "/", " MOD ", " * ", " mod "}) + Power(depth);
    return text;
  }
  // power = signed { "^" signed } ;  seldom, and with small exponents, or most would overflow
  std::string Power(int depth) {
    std::string text = Signed(depth);
    if (Below(8) == 0)
      text += Pick({"^", " ^ "}) + Pick({"2", "-1", "0", "3.", ".5", "2^2", "VI[1]"});
    return text;
  }
  std::string Signed(int depth) {
    return Pick({"", "", "", "", "-", "+", "- ", "--"}) + Primary(depth);
  }

  std::string Primary(int depth) {
    if (depth <= 0) return Leaf();
    switch (Below(4)) {
      case 0:
        return "(" + Numeric(depth - 1) + ")";
      case 1:
        return Pick({"SIN", "cos", "TAN ", "ASIN", "Acos", "ATAN", "SQRT", "EXP", "ln", "LOG",
                     "ABS", "INT"}) +
               "(" + Numeric(depth - 1) + " )";
      default:
        return Leaf();
    }
  }
  std::string Leaf() {
    switch (Below(6)) {
      case 0:
        return "VR[" + Digit() + "]";
      case 1:
        return "vi [ " + Digit() + " ]";
      case 2:
        return Digit();
      case 3:
        return Digit() + "." + Digit() + Digit();
      case 4:
        return Pick(
            {"PI", "40000", ".25", "3 E 2", "5.E -3", "0.5e+1", "16777217.", "0.333333333"});
      default:
        return Pick({"1", "2", "0.5", "10", "0"});
    }
  }

  // notterm = { "NOT" } relation ;
  std::string NotTerm(int depth) {
    return Pick({"", "", "", "NOT ", "not NOT "}) + Relation(depth);
  }
  std::string Relation(int depth) {
    switch (Below(depth > 0 ? 6 : 2)) {
      case 0:
        return "VL[" + Digit() + "]";
      case 1:
        return Pick({"ON", "OFF", "true", "NO", "1", "0"});
      case 2:
        return "(" + Logical(depth - 1) + ")";
      case 3:  // two logical values
        return "(" + Logical(depth - 1) + ")" + Pick({"=", "<>", " >< "}) + "VL[" + Digit() + "]";
      default:
        return Numeric(depth - 1) + Pick({"<", " <= ", "=", ">=", ">", " <> ", "><"}) +
               Numeric(depth - 1);
    }
  }

  std::string Digit() { return std::to_string(Below(10)); }
  std::string Pick(std::initializer_list<const char*> choices) {
    return *(choices.begin() + Below(choices.size()));
  }

  std::mt19937 random_;
};

}  // namespace rmlcell::optimo
