#include "engine/core/catalogue.h"

#include <algorithm>
#include <array>

#include "engine/core/check.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell {
namespace {

// A plain array: how many a std::array has clang++ finds out for no more than 256.
constexpr CatalogueEntry kRows[] = {
#define RMLCELL_ERROR(family, number, symbol, severity, when, advice, ...) \
  CatalogueEntry{ErrorCode::k##symbol,                                     \
                 ErrorFamily::k##family,                                   \
                 number,                                                   \
                 #symbol,                                                  \
                 Severity::k##severity,                                    \
                 when,                                                     \
                 advice __VA_OPT__(, Refusal::k##__VA_ARGS__)},
#include "engine/core/catalogue.def"
#undef RMLCELL_ERROR
};
constexpr std::span<const CatalogueEntry> kCatalogue(kRows);

constexpr bool IsIndexedByCode() {
  for (std::size_t i = 0; i < kCatalogue.size(); ++i) {
    if (static_cast<std::size_t>(kCatalogue[i].code) != i) return false;
  }
  return true;
}
static_assert(IsIndexedByCode(), "Lookup reads the row by its code");

template <class Use>
void ForEachRow(Use use) {
  std::ranges::for_each(kCatalogue, use);
  for (const ErrorTable& table : OwnErrorTables()) std::ranges::for_each(table.rows, use);
}

// Of the table that a family brings with it; null when there is none.
const ErrorTable* FindTable(ErrorFamily family) {
  for (const ErrorTable& table : OwnErrorTables()) {
    if (!table.rows.empty() && table.rows.front().family == family) return &table;
  }
  return nullptr;
}

}  // namespace

std::span<const CatalogueEntry> Catalogue() { return kCatalogue; }

[[gnu::weak]] std::span<const ErrorTable> OwnErrorTables() { return {}; }

const CatalogueEntry& Lookup(ErrorCode code) {
  const auto index = static_cast<std::size_t>(code);
  if (index < kCatalogue.size()) return kCatalogue[index];
  RMLCELL_CHECK(index >= kOwnErrorFirst);
  const std::size_t own = index - kOwnErrorFirst;
  const ErrorTable* table = FindTable(OwnErrorFamily(static_cast<int>(own / kOwnErrorsMax)));
  RMLCELL_CHECK(table != nullptr && own % kOwnErrorsMax < table->rows.size());
  return table->rows[own % kOwnErrorsMax];
}

std::optional<ErrorCode> FindError(ErrorFamily family, int number) {
  const CatalogueEntry* found = nullptr;
  ForEachRow([&](const CatalogueEntry& entry) {
    if (found == nullptr && entry.family == family && entry.number == number) found = &entry;
  });
  return found == nullptr ? std::nullopt : std::optional(found->code);
}

std::string_view FamilyPrefix(ErrorFamily family) {
  switch (family) {
    case ErrorFamily::kOptimo:
      return "OPT";
    case ErrorFamily::kRml1:
      return "RML1";
    case ErrorFamily::kCell:
      return "CELL";
    default:
      break;
  }
  const ErrorTable* table = FindTable(family);
  return table == nullptr ? std::string_view{} : table->prefix;
}

std::string_view SeverityName(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return "advice";
    case Severity::kWarning:
      return "warning";
    case Severity::kCompile:
      return "compile error";
    case Severity::kProgram:
      return "program error";
    case Severity::kFatal:
      return "fatal program error";
    case Severity::kAlarm:
      return "alarm";
    case Severity::kMessage:
      return "operator message";
    case Severity::kTool:
      return "tool error";
    case Severity::kBudget:
      return "budget";
    case Severity::kDevice:
      return "device error";
    case Severity::kRequest:
      return "request error";
  }
  return "";
}

std::string_view SeverityEffect(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return "Reported only.";
    case Severity::kWarning:
      return "Reported with its place; changes nothing.";
    case Severity::kCompile:
      return "The program is not stored.";
    case Severity::kProgram:
      return "The instruction has no effect, motion and beam stop; the program ends unless ERR catches it.";
    case Severity::kFatal:
      return "The instruction has no effect, motion and beam stop, the run ends.";
    case Severity::kAlarm:
      return "The run ends with the shutter closed; no start until the alarm is acknowledged.";
    case Severity::kMessage:
      return "Shown to the operator; the key or request has no effect.";
    case Severity::kTool:
      return "The tool stops and writes nothing.";
    case Severity::kBudget:
      return "The cell ends the run; beam off, shutter closed.";
    case Severity::kDevice:
      return "Noted in the error register and log; interpretation goes on.";
    case Severity::kRequest:
      return "The request is refused and nothing is changed.";
  }
  return "";
}

std::string CodeText(ErrorCode code) {
  const CatalogueEntry& entry = Lookup(code);
  return std::string(FamilyPrefix(entry.family)) + "-E" + std::to_string(entry.number);
}

std::string ConstantName(ErrorCode code) {
  std::string name;
  bool after_small = false;
  for (const char c : Lookup(code).symbol) {  // letters and digits
    const bool small = UpperCase(c) != c;
    const bool starts_word = !small && (LowerCase(c) != c || after_small);
    const bool inside_family = name == "RML";  // RML1 is one word
    if (starts_word && !name.empty() && !inside_family) name += '_';
    name += UpperCase(c);
    after_small = small;
  }
  return name;
}

std::vector<const CatalogueEntry*> FindByText(std::string_view text) {
  std::vector<const CatalogueEntry*> found;
  const std::size_t dash = text.find('-');
  std::string_view family;
  std::string_view digits = text;
  if (dash != std::string_view::npos) {
    if (dash == 0) return found;
    family = text.substr(0, dash);
    digits = text.substr(dash + 1);
  }
  if (!digits.empty() && (digits.front() == 'E' || digits.front() == 'e')) digits.remove_prefix(1);
  const auto number = ParseInteger(digits);
  const bool may_be_name = dash == std::string_view::npos && !number;  // no name has either
  ForEachRow([&](const CatalogueEntry& entry) {
    const bool same_family =
        family.empty() || EqualIgnoringCase(family, FamilyPrefix(entry.family));
    const bool same_number = number && *number == entry.number && same_family;
    const bool same_name = may_be_name && (EqualIgnoringCase(text, entry.symbol) ||
                                           EqualIgnoringCase(text, ConstantName(entry.code)));
    if (same_number || same_name) found.push_back(&entry);
  });
  return found;
}

}  // namespace rmlcell
