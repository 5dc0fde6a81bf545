#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

// Characters as editors count them. The engine counts bytes.
namespace rmlcell {

// What a character of a position counts; editors that say nothing count UTF-16, as browsers do.
enum class Encoding { kUtf16, kUtf8, kUtf32 };

// Characters of `text` in the units of `encoding`. A byte that is no UTF-8 counts as one.
std::uint32_t CharactersIn(std::string_view text, Encoding encoding);
// Bytes of the first `characters` of a line; all of it when it has fewer. A place inside a
// character is the one before it.
std::size_t BytesOfCharacters(std::string_view line, std::uint32_t characters, Encoding encoding);

}  // namespace rmlcell
