#include "clients/cli/findings_text.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "engine/core/catalogue.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {

int Explain(const std::vector<std::string>& codes, bool json) {
  int exit_code = kGood;
  std::vector<const CatalogueEntry*> entries;
  if (codes.empty()) {
    for (const CatalogueEntry& entry : Catalogue()) entries.push_back(&entry);
  }
  for (const std::string& code : codes) {
    const auto found = FindByText(code);
    if (found.empty()) {
      Complain("no error '" + code + "'; rmlcell explain without a code lists them all");
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
