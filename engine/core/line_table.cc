#include "engine/core/line_table.h"

#include <algorithm>
#include <span>

namespace rmlcell {
namespace {

// Begins of the lines that start behind `from` and not behind `to`.
void AppendBegins(std::string_view text, std::size_t from, std::size_t to,
                  std::vector<std::uint32_t>& begins) {
  for (std::size_t at = from; at < to; ++at) {
    if (text[at] != '\n' && text[at] != '\r') continue;
    if (text[at] == '\r' && at + 1 < text.size() && text[at + 1] == '\n') continue;
    begins.push_back(static_cast<std::uint32_t>(at + 1));
  }
}

}  // namespace

void LineTable::Rebuild(std::string_view text) {
  begins_.assign(1, 0);
  AppendBegins(text, 0, text.size(), begins_);
}

// Lines are read anew from the one of the byte before the change, whose CR may have met an LF, to
// the end of the one behind it, whose end did not change.
void LineTable::Replace(std::string_view text, std::size_t begin, std::size_t end,
                        std::size_t inserted) {
  const std::size_t first = LineOf(std::max<std::size_t>(begin, 1) - 1);
  const std::size_t last = LineOf(end);
  const bool at_end = last + 1 == begins_.size();
  const std::size_t stop = at_end ? text.size() : begins_[last + 1] - (end - begin) + inserted;
  std::vector<std::uint32_t> fresh;
  AppendBegins(text, begins_[first], stop, fresh);
  // The begin at `stop` itself is among the fresh ones: its line end lies before it.
  const std::size_t kept = last + (at_end ? 1U : 2U);
  for (std::uint32_t& line : std::span(begins_).subspan(kept)) {
    line = static_cast<std::uint32_t>(line - (end - begin) + inserted);
  }
  const auto from = begins_.begin() + static_cast<std::ptrdiff_t>(first) + 1;
  const auto to = begins_.begin() + static_cast<std::ptrdiff_t>(kept);
  const auto common =
      std::min<std::ptrdiff_t>(to - from, static_cast<std::ptrdiff_t>(fresh.size()));
  std::copy_n(fresh.begin(), common, from);
  if (common < to - from) {
    begins_.erase(from + common, to);
  } else {
    begins_.insert(from + common, fresh.begin() + common, fresh.end());
  }
}

std::size_t LineTable::End(std::string_view text, std::size_t line) const {
  if (line + 1 == begins_.size()) return text.size();
  const std::size_t next = begins_[line + 1];
  const std::string_view with_end = text.substr(begins_[line], next - begins_[line]);
  return next - (with_end.ends_with("\r\n") ? 2U : 1U);
}

std::size_t LineTable::LineOf(std::size_t offset) const {
  const auto behind = std::ranges::upper_bound(begins_, offset);
  return static_cast<std::size_t>(behind - begins_.begin()) - 1;
}

}  // namespace rmlcell
