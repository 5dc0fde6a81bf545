#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "engine/core/catalogue.h"
#include "engine/core/near_words.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {
namespace {

// Codes and names of errors that may be meant.
std::vector<std::string> NearCodes(const std::string& word) {
  std::vector<std::string> known;
  for (const CatalogueEntry& entry : Catalogue()) {
    known.push_back(CodeText(entry.code));
    known.push_back(ConstantName(entry.code));
  }
  return NearestTo(word, std::vector<std::string_view>(known.begin(), known.end())).words;
}

}  // namespace

int Explain(const std::vector<std::string>& codes, bool json) {
  int exit_code = kGood;
  std::vector<const CatalogueEntry*> entries;
  if (codes.empty()) {
    for (const CatalogueEntry& entry : Catalogue()) entries.push_back(&entry);
  }
  for (const std::string& code : codes) {
    const auto found = FindByText(code);
    if (found.empty()) {
      Complain("no error '" + Visible(code) + "'" + DidYouMean(NearCodes(code)) +
               "; rmlcell explain without a code lists them all");
      exit_code = kUsage;
    }
    entries.insert(entries.end(), found.begin(), found.end());
  }
  for (const CatalogueEntry* entry : entries) {
    if (json) {
      Print(Json(bridge::Explain(*entry)));
      continue;
    }
    if (codes.empty()) {
      Print(CodeText(entry->code) + "  " + ConstantName(entry->code) + ": " +
            std::string(entry->when));
      continue;
    }
    Print(Paint(CodeText(entry->code), Colour::kBold, ColourOnOutput()) + "  " +
          ConstantName(entry->code) + "  (" + std::string(SeverityName(entry->severity)) + ")");
    Print("  what happened:  " + std::string(entry->when));
    Print("  the machine:    " + std::string(SeverityEffect(entry->severity)));
    Print("  what to do:     " + std::string(entry->advice));
  }
  return exit_code;
}

}  // namespace rmlcell::cli
