#include "engine/optimo/editing/rename.h"

#include <algorithm>
#include <optional>
#include <string>

#include "engine/core/number_text.h"
#include "engine/optimo/editing/navigation.h"

namespace rmlcell::optimo::editing {
namespace {

using machine::Refusal;

constexpr std::size_t kNameBytesMax = 64;  // only eight count
constexpr std::size_t kLabelDigitsMax = 4;

Refusal Refuse(std::string why) { return {std::move(why)}; }

bool IsLetter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// What can be renamed here, or why it cannot.
std::variant<const Use*, Refusal> RenamableUse(const ProgramIndex& index, std::size_t offset) {
  const Use* use = index.CommentAt(offset) != nullptr ? nullptr : index.At(offset);
  if (use == nullptr) return Refuse("there is no name or sequence number here");
  switch (use->kind) {
    case UseKind::kName:
      if (index.FindDeclaration(use->key) == nullptr)
        return Refuse("'" + std::string(index.TextOf(*use)) + "' is not declared in this program");
      return use;
    case UseKind::kLabel:
    case UseKind::kJump:
      if (index.FindLabel(use->number) == nullptr)
        return Refuse("the program has no sequence number " + std::to_string(use->number));
      return use;
    case UseKind::kWord:
      return Refuse("a reserved word has no other name");
    case UseKind::kVariable:
      return Refuse("a variable of the control has no other name; DECLARE gives it one");
    case UseKind::kProgram:
      return Refuse("a program is renamed by renaming its file");
  }
  return Refuse("there is no name or sequence number here");
}

std::optional<Refusal> CheckName(const ProgramIndex& index, const Use& use,
                                 const std::string& name) {
  const bool word = !name.empty() && name.size() <= kNameBytesMax && IsLetter(name.front()) &&
                    std::ranges::all_of(name, [](char c) { return IsLetter(c) || IsDigit(c); });
  if (!word) return Refuse("a name begins with a letter and has letters and digits (OPT-7.45)");
  const NameKey key = PackName(name);
  if (const Word reserved = FindWord(key); reserved != Word::kNone)
    return Refuse("'" + name + "' is reserved: " + std::string(Describe(reserved).text) +
                  " (OPT-7.48)");
  if (key == use.key) return std::nullopt;
  const auto taken = std::ranges::find_if(index.uses(), [&](const Use& other) {
    return other.kind == UseKind::kName && other.key == key;
  });
  if (taken != index.uses().end())
    return Refuse("'" + name + "' is the same name as '" + std::string(index.TextOf(*taken)) +
                  "' of this program: eight characters count (OPT-7.46)");
  return std::nullopt;
}

std::optional<Refusal> CheckLabel(const ProgramIndex& index, const Use& use,
                                  const std::string& name) {
  const auto number = ParseInteger(name);
  const bool good = number && name.size() <= kLabelDigitsMax &&
                    std::ranges::all_of(name, IsDigit) && *number <= kSequenceNumberMax;
  if (!good) return Refuse("a sequence number goes from 0 to 9999 (OPT-1.23)");
  if (*number == use.number) return std::nullopt;
  if (index.FindLabel(static_cast<int>(*number)) != nullptr)
    return Refuse("sequence number " + name + " is taken (OPT-1.25)");
  const bool jumped_to = std::ranges::any_of(index.uses(), [&](const Use& other) {
    return other.kind == UseKind::kJump && other.number == *number;
  });
  if (jumped_to)
    return Refuse("there are jumps to " + name + " already, which now lead nowhere (OPT-7.16)");
  return std::nullopt;
}

}  // namespace

std::variant<machine::TextSpan, Refusal> Renamable(const ProgramIndex& index, std::size_t offset) {
  const auto found = RenamableUse(index, offset);
  if (const auto* refused = std::get_if<Refusal>(&found)) return *refused;
  const Use& use = *std::get<const Use*>(found);
  return machine::TextSpan{use.begin, use.end};
}

std::variant<std::vector<machine::TextSpan>, Refusal> Rename(const ProgramIndex& index,
                                                             std::size_t offset,
                                                             const std::string& name) {
  const auto found = RenamableUse(index, offset);
  if (const auto* refused = std::get_if<Refusal>(&found)) return *refused;
  const Use& use = *std::get<const Use*>(found);
  const auto wrong =
      use.kind == UseKind::kName ? CheckName(index, use, name) : CheckLabel(index, use, name);
  if (wrong) return *wrong;
  std::vector<machine::TextSpan> places;
  for (const Use* same : SameUses(index, use)) places.push_back({same->begin, same->end});
  return places;
}

}  // namespace rmlcell::optimo::editing
