#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// Places as editors count them: line and character from 0, characters in the units that client and
// server agreed on. The engine counts bytes.
namespace rmlcell::lsp {

// What a character of a position counts; editors that say nothing count UTF-16.
enum class Encoding { kUtf16, kUtf8, kUtf32 };

struct Position {
  std::uint32_t line = 0;
  std::uint32_t character = 0;

  auto operator<=>(const Position&) const = default;
};
struct Range {
  Position start{};
  Position end{};  // behind the last character

  bool operator==(const Range&) const = default;
};

// Where the lines of a text begin. Lines end at LF, CR LF or a CR alone, as in editors; the engine
// knows no CR alone, so the two may count lines differently there: only bytes are exchanged.
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

// Characters of `text` in the units of `encoding`. A byte that is no UTF-8 counts as one.
std::uint32_t CharactersIn(std::string_view text, Encoding encoding);
// Bytes of the first `characters` of a line; all of it when it has fewer. A place inside a
// character is the one before it.
std::size_t BytesOfCharacters(std::string_view line, std::uint32_t characters, Encoding encoding);

}  // namespace rmlcell::lsp
