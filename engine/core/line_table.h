#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace rmlcell {

// Where the lines of a text begin, as editors count them, from 0. Lines end at LF, CR LF or a CR
// alone; the languages know no CR alone, so the two may count lines differently there: what is told
// between them is bytes.
class LineTable {
 public:
  explicit LineTable(std::string_view text) { Rebuild(text); }

  void Rebuild(std::string_view text);
  // Bytes `begin` to `end` of the old text were replaced by `inserted` bytes; `text` is the new
  // one.
  void Replace(std::string_view text, std::size_t begin, std::size_t end, std::size_t inserted);

  std::size_t count() const { return begins_.size(); }
  std::size_t Begin(std::size_t line) const { return begins_[line]; }
  // Behind the last byte that is no line end. Precondition: line < count().
  std::size_t End(std::string_view text, std::size_t line) const;
  std::size_t LineOf(std::size_t offset) const;

  bool operator==(const LineTable&) const = default;

 private:
  std::vector<std::uint32_t> begins_;
};

}  // namespace rmlcell
