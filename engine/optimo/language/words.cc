#include "engine/optimo/language/words.h"

#include <array>

#include "engine/core/check.h"

namespace rmlcell::optimo {
namespace {

constexpr std::array kWords = {
#define RMLCELL_WORD(symbol, text, group, rule) \
  WordInfo{Word::k##symbol, text, WordGroup::group, rule},
#include "engine/optimo/language/words.def"
#undef RMLCELL_WORD
};

constexpr NameKey Pack(std::string_view text) {
  NameKey key = 0;
  for (int i = 0; i < kNameLength; ++i) {
    const auto at = static_cast<std::size_t>(i);
    auto byte = at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
    if (byte >= 'a' && byte <= 'z') byte -= 'a' - 'A';
    key = key << 8 | byte;
  }
  return key;
}

// Open addressing; a quarter full, so that a miss ends at the first or second look.
constexpr std::size_t kSlots = 512;
constexpr std::size_t SlotOf(NameKey key) {
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 55);
}
struct Slot {
  NameKey key = 0;
  Word word = Word::kNone;
};
constexpr std::array<Slot, kSlots> MakeSlots() {
  std::array<Slot, kSlots> slots{};
  for (const WordInfo& row : kWords) {
    const NameKey key = Pack(row.text);
    std::size_t at = SlotOf(key);
    while (slots[at].word != Word::kNone) at = (at + 1) % kSlots;
    slots[at] = {key, row.word};
  }
  return slots;
}
constexpr std::array<Slot, kSlots> kWordSlots = MakeSlots();

}  // namespace

std::span<const WordInfo> ReservedWords() { return kWords; }

const WordInfo& Describe(Word word) {
  RMLCELL_CHECK(word != Word::kNone);
  return kWords[static_cast<std::size_t>(word) - 1];
}

NameKey PackName(std::string_view text) { return Pack(text); }

std::string_view UnpackName(NameKey key, char (&room)[kNameLength]) {
  std::size_t length = 0;
  for (int shift = 56; shift >= 0; shift -= 8) {
    const auto byte = static_cast<char>(key >> shift & 0xFF);
    if (byte == 0) break;
    room[length++] = byte;
  }
  return {room, length};
}

Word FindWord(NameKey key) {
  for (std::size_t at = SlotOf(key);; at = (at + 1) % kSlots) {
    const Slot& slot = kWordSlots[at];
    if (slot.word == Word::kNone || slot.key == key) return slot.word;
  }
}

}  // namespace rmlcell::optimo
