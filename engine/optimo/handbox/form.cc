#include "engine/optimo/handbox/form.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/check.h"
#include "engine/core/number_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kTypedMax = 9;  // what a display of 20 characters has room for

std::string WholeText(int value, int digits) {
  std::string text = std::to_string(value);
  const auto width = static_cast<std::size_t>(digits);
  if (text.size() < width) text.insert(0, width - text.size(), '0');
  return text;
}

}  // namespace

Field Field::Real(std::string before, double value, double low, double high, Decimals decimals) {
  Field field;
  field.before_ = std::move(before);
  field.digits_ = decimals == Decimals::kOne         ? FixedText(value, 1)
                  : decimals == Decimals::kUpToThree ? TrimmedText(value, 3)
                                                     : ShortestText(value);
  field.given_ = value;
  field.low_ = low;
  field.high_ = high;
  return field;
}

Field Field::Whole(std::string before, int digits, int value, int low, int high) {
  Field field;
  field.before_ = std::move(before);
  field.digits_ = WholeText(value, digits);
  field.width_ = digits;
  field.low_ = low;
  field.high_ = high;
  return field;
}

Field Field::Shown(std::string text) {
  Field field;
  field.before_ = std::move(text);
  field.fixed_ = true;
  return field;
}

Field Field::Choice(std::string before, std::vector<std::string> words, std::size_t chosen) {
  Field field;
  field.before_ = std::move(before);
  field.words_ = std::move(words);
  field.chosen_ = chosen;
  return field;
}

// Words are in a ring: a pair of them is chosen from with either key.
void Field::Choose(bool next) {
  chosen_ = (chosen_ + (next ? 1 : words_.size() - 1)) % words_.size();
}

void Field::Clear() {
  if (is_choice() || fixed_) return;
  digits_ = width_ > 0 ? WholeText(0, width_) : "";
  typed_ = true;
}

void Field::Type(char c) {
  const bool digit = c >= '0' && c <= '9';
  if (is_choice()) return;
  if (width_ > 0) {
    if (digit) digits_ = digits_.substr(1) + c;
    return;
  }
  const bool fits = digit || (c == '-' && digits_.empty()) ||
                    (c == '.' && digits_.find('.') == std::string::npos);
  if (typed_ && fits && digits_.size() < kTypedMax) digits_ += c;
}

double Field::value() const {
  if (width_ == 0 && !typed_) return given_;
  if (digits_.find_first_of("0123456789") == std::string::npos) return std::nan("");
  // "12." and ".5" are typed, too.
  std::string text = digits_;
  if (text.ends_with('.')) text += '0';
  if (const std::size_t point = text.find('.'); point != std::string::npos) {
    if (point == 0 || text[point - 1] == '-') text.insert(point, "0");
  }
  return ParseDouble(text).value_or(std::nan(""));
}

bool Field::InRange() const {
  if (is_choice()) return true;
  const double number = value();
  return number >= low_ && number <= high_;
}

Form Form::OfLines(FormKind kind, std::vector<Field> fields) {
  std::vector<Line> lines;
  for (Field& field : fields) lines.push_back({std::move(field)});
  return {kind, std::move(lines)};
}

Form Form::OfNumbers(FormKind kind, std::span<const std::string_view> names,
                     const std::vector<double>& values) {
  constexpr double kMost = 999'999.0;
  std::vector<Field> fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    fields.push_back(Field::Real(std::string(names[i]) + " = ", i < values.size() ? values[i] : 0.0,
                                 -kMost, kMost, Decimals::kUpToThree));
  }
  return OfLines(kind, std::move(fields));
}

void Form::Move(bool next) {
  if (field().is_choice()) return field().Choose(next);
  if (next && field_ + 1 < lines_[line_].size()) {
    ++field_;
  } else if (next && line_ + 1 < lines_.size()) {
    ++line_;
    field_ = 0;
  } else if (!next && field_ > 0) {
    --field_;
  } else if (!next && line_ > 0) {
    --line_;
    field_ = lines_[line_].size() - 1;
  }
}

bool Form::Check() {
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    for (std::size_t f = 0; f < lines_[l].size(); ++f) {
      if (lines_[l][f].InRange()) continue;
      line_ = l;
      field_ = f;
      return false;
    }
  }
  return true;
}

std::size_t Form::count() const {
  std::size_t count = 0;
  for (const Line& line : lines_) count += line.size();
  return count;
}

const Field& Form::at(std::size_t number) const {
  for (const Line& line : lines_) {
    if (number < line.size()) return line[number];
    number -= line.size();
  }
  RMLCELL_CHECK(false);
  return lines_.front().front();
}

std::string Form::text() const {
  std::string text;
  for (const Field& one : lines_[line_]) text += one.text();
  return text;
}

}  // namespace rmlcell::optimo
