#include "clients/lsp/rename.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "clients/lsp/navigation.h"
#include "engine/core/number_text.h"

namespace rmlcell::lsp {
namespace {

constexpr std::size_t kNameBytesMax = 64;  // only eight count
constexpr int kLabelMax = 9999;            // OPT-1.23
constexpr std::size_t kLabelDigitsMax = 4;

RequestError Refuse(std::string why) { return {ErrorNumber::kRequestFailed, std::move(why)}; }

bool IsLetter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// What can be renamed here, or why it cannot.
std::variant<const Use*, RequestError> Renamable(const OpenProgram& program, std::size_t offset) {
  const ProgramIndex& index = program.index;
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

std::optional<RequestError> CheckName(const ProgramIndex& index, const Use& use,
                                      const std::string& name) {
  const bool word = !name.empty() && name.size() <= kNameBytesMax && IsLetter(name.front()) &&
                    std::ranges::all_of(name, [](char c) { return IsLetter(c) || IsDigit(c); });
  if (!word) return Refuse("a name begins with a letter and has letters and digits (OPT-7.45)");
  const optimo::NameKey key = optimo::PackName(name);
  if (const optimo::Word reserved = optimo::FindWord(key); reserved != optimo::Word::kNone)
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

std::optional<RequestError> CheckLabel(const ProgramIndex& index, const Use& use,
                                       const std::string& name) {
  const auto number = ParseInteger(name);
  const bool good = number && name.size() <= kLabelDigitsMax &&
                    std::ranges::all_of(name, IsDigit) && *number <= kLabelMax;
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

std::variant<Json, RequestError> PrepareRename(const OpenProgram& program, std::size_t offset) {
  const auto found = Renamable(program, offset);
  if (const auto* refused = std::get_if<RequestError>(&found)) return *refused;
  const Use& use = *std::get<const Use*>(found);
  return Json{{"range", ToJson(PositionFinder(program.document).Span(use.begin, use.end))},
              {"placeholder", program.index.TextOf(use)}};
}

std::variant<Json, RequestError> Rename(const OpenProgram& program, std::size_t offset,
                                        const std::string& new_name) {
  const auto found = Renamable(program, offset);
  if (const auto* refused = std::get_if<RequestError>(&found)) return *refused;
  const Use& use = *std::get<const Use*>(found);
  const auto wrong = use.kind == UseKind::kName ? CheckName(program.index, use, new_name)
                                                : CheckLabel(program.index, use, new_name);
  if (wrong) return *wrong;
  Json edits = Json::array();
  PositionFinder positions(program.document);
  for (const Use* same : SameUses(program.index, use))
    edits.push_back(TextEdit(positions.Span(same->begin, same->end), new_name));
  return Json{{"changes", {{program.document.uri(), std::move(edits)}}}};
}

}  // namespace rmlcell::lsp
