#include "engine/core/detail.h"

#include <algorithm>
#include <iterator>

namespace rmlcell {

Detail::Detail() = default;
Detail::Detail(std::string text) : std::string(std::move(text)) {}
Detail::Detail(std::string text, Argument argument) : std::string(std::move(text)) {
  arguments_.push_back(std::move(argument));
}
Detail::Detail(const Detail&) = default;
Detail::Detail(Detail&&) noexcept = default;
Detail& Detail::operator=(const Detail&) = default;
Detail& Detail::operator=(Detail&&) noexcept = default;
Detail::~Detail() = default;

Detail& Detail::operator+=(const Detail& more) {
  append(more);
  arguments_.reserve(arguments_.size() + more.arguments_.size());  // `more` may be this one
  std::copy_n(more.arguments_.begin(), more.arguments_.size(), std::back_inserter(arguments_));
  return *this;
}

Detail& Detail::operator+=(std::string_view more) {
  append(more);
  return *this;
}

Detail operator+(Detail left, const Detail& right) { return std::move(left += right); }
Detail operator+(Detail left, std::string right) { return std::move(left += right); }
Detail operator+(Detail left, std::string_view right) { return std::move(left += right); }
Detail operator+(Detail left, const char* right) { return std::move(left += right); }
Detail operator+(Detail left, char right) { return std::move(left += right); }
Detail operator+(std::string left, const Detail& right) { return Detail(std::move(left)) + right; }
Detail operator+(std::string_view left, const Detail& right) {
  return Detail(std::string(left)) + right;
}
Detail operator+(const char* left, const Detail& right) { return Detail(left) + right; }
Detail operator+(char left, const Detail& right) { return Detail(1, left) + right; }

Detail ToldWhole(std::string_view name, double value, std::string digits) {
  return {std::move(digits), {std::string(name), value}};
}

Detail Told(std::string_view name, std::string_view word) {
  return {std::string(word), {std::string(name), std::string(word)}};
}

Detail Told(std::string_view name, double value, std::string_view unit, std::string text) {
  return {std::move(text), {std::string(name), value, std::string(unit)}};
}

}  // namespace rmlcell
