#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

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

// Characters of `text` in the units of `encoding`. A byte that is no UTF-8 counts as one.
std::uint32_t CharactersIn(std::string_view text, Encoding encoding);
// Bytes of the first `characters` of a line; all of it when it has fewer. A place inside a
// character is the one before it.
std::size_t BytesOfCharacters(std::string_view line, std::uint32_t characters, Encoding encoding);

}  // namespace rmlcell::lsp
