#include "clients/lsp/surroundings.h"

#include <utility>

#include "clients/lsp/project_facts.h"

namespace rmlcell::lsp {

std::vector<machine::NumberedFile> DocumentSurroundings::Programs() const {
  return folder_.Programs(document_.uri(), extensions_);
}

std::optional<machine::NumberedSource> DocumentSurroundings::Read(
    const machine::NumberedFile& file) const {
  if (const Document* open = open_ ? open_(file.uri) : nullptr; open != nullptr)
    return machine::NumberedSource{open->uri(), FileNameOfUri(open->uri()), open->text()};
  Result<std::string> text = folder_.Read(file.uri);
  if (!text) return std::nullopt;
  return machine::NumberedSource{file.uri, FileNameOfUri(file.uri), *std::move(text)};
}

std::string DocumentSurroundings::ScheduleNote(int number) const {
  return lsp::ScheduleNote(folder_, document_.uri(), number);
}

std::string DocumentSurroundings::ProcessNote(int kind, int process) const {
  return lsp::ProcessNote(folder_, document_.uri(), kind, process);
}

}  // namespace rmlcell::lsp
