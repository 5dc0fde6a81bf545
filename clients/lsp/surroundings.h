#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clients/lsp/document.h"
#include "clients/lsp/program_folder.h"
#include "engine/machine/editing.h"

namespace rmlcell::lsp {

// Another document that is open, whose text goes over that on the disk; null: not open.
using FindOpen = std::function<const Document*(std::string_view uri)>;

// What lies around a document: its folder, with what is open over what is on the disk.
class DocumentSurroundings final : public machine::Surroundings {
 public:
  // All of them must outlive it.
  DocumentSurroundings(const Document& document, const ProgramFolder& folder,
                       SourceExtensions extensions, FindOpen open)
      : document_(document), folder_(folder), extensions_(extensions), open_(std::move(open)) {}

  const std::string& uri() const override { return document_.uri(); }
  std::vector<machine::NumberedFile> Programs() const override;
  std::optional<machine::NumberedSource> Read(const machine::NumberedFile& file) const override;
  std::string ScheduleNote(int number) const override;
  std::string ProcessNote(int kind, int process) const override;

 private:
  const Document& document_;
  const ProgramFolder& folder_;
  SourceExtensions extensions_;
  FindOpen open_;
};

}  // namespace rmlcell::lsp
