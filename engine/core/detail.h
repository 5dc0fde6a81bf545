#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rmlcell {

// A number or a word that a text was made of.
struct Argument {
  std::string name;                         // "speed", "limit", "values", "needed"
  std::variant<double, std::string> value;  // a number in `unit`, or a word
  std::string unit{};                       // "mm", "mm/s", "%"; empty for counts and words

  bool operator==(const Argument&) const = default;
};

// What was observed, as an English text that still knows the numbers and words in it: whoever says
// it in another language, or draws it, need not read them out of the text. Texts are joined with +,
// and keep what each of them knows. Two details are equal when their texts are.
class Detail : public std::string {
 public:
  using std::string::string;
  // Not in line: an error is on the way of every result, and hardly ever there.
  Detail();
  Detail(std::string text);  // NOLINT: implicit by design
  Detail(std::string text, Argument argument);
  Detail(const Detail&);
  Detail(Detail&&) noexcept;
  Detail& operator=(const Detail&);
  Detail& operator=(Detail&&) noexcept;
  ~Detail();

  const std::vector<Argument>& arguments() const { return arguments_; }

  Detail& operator+=(const Detail& more);
  Detail& operator+=(std::string_view more);
  Detail& operator+=(const char* more) { return *this += std::string_view(more); }
  Detail& operator+=(const std::string& more) { return *this += std::string_view(more); }
  Detail& operator+=(char more) { return *this += std::string_view(&more, 1); }

 private:
  std::vector<Argument> arguments_;
};

// By value where std::string has forms for both kinds of reference, so that these are the better
// ones.
Detail operator+(Detail left, const Detail& right);
Detail operator+(Detail left, std::string right);
Detail operator+(Detail left, std::string_view right);
Detail operator+(Detail left, const char* right);
Detail operator+(Detail left, char right);
Detail operator+(std::string left, const Detail& right);
Detail operator+(std::string_view left, const Detail& right);
Detail operator+(const char* left, const Detail& right);
Detail operator+(char left, const Detail& right);

// A count or another whole number, as digits: "no sequence number " + Told("label", 60).
Detail ToldWhole(std::string_view name, double value, std::string digits);
template <std::integral Number>
requires(!std::same_as<Number, char> && !std::same_as<Number, bool>) Detail
    Told(std::string_view name, Number value) {
  return ToldWhole(name, static_cast<double>(value), std::to_string(value));
}
// A word, or a name.
Detail Told(std::string_view name, std::string_view word);
// A number in a unit, that reads `text` where it stands: Told("speed", 12.5, "mm/s", "12.5 mm/s").
Detail Told(std::string_view name, double value, std::string_view unit, std::string text);

}  // namespace rmlcell
