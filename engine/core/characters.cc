#include "engine/core/characters.h"

namespace rmlcell {
namespace {

struct Character {
  std::size_t bytes = 1;
  std::uint32_t utf16 = 1;
};

bool Continues(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

Character CharacterAt(std::string_view text, std::size_t at) {
  const auto lead = static_cast<unsigned char>(text[at]);
  if (lead < 0xC2 || lead > 0xF4) return {};
  const std::size_t bytes = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!Continues(text, at + i)) return {};
  }
  return {bytes, bytes == 4 ? 2U : 1U};
}

std::uint32_t UnitsOf(Character character, Encoding encoding) {
  switch (encoding) {
    case Encoding::kUtf8:
      return static_cast<std::uint32_t>(character.bytes);
    case Encoding::kUtf16:
      return character.utf16;
    case Encoding::kUtf32:
      break;
  }
  return 1;
}

}  // namespace

std::uint32_t CharactersIn(std::string_view text, Encoding encoding) {
  std::uint32_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    const Character character = CharacterAt(text, at);
    at += character.bytes;
    count += UnitsOf(character, encoding);
  }
  return count;
}

std::size_t BytesOfCharacters(std::string_view line, std::uint32_t characters, Encoding encoding) {
  std::size_t at = 0;
  std::uint32_t count = 0;
  while (at < line.size()) {
    const Character character = CharacterAt(line, at);
    count += UnitsOf(character, encoding);
    if (count > characters) break;
    at += character.bytes;
  }
  return at;
}

}  // namespace rmlcell
