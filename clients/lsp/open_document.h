#pragma once

#include <memory>
#include <optional>

#include "clients/lsp/server.h"

// What the server keeps of a document and of a message. Private to the folder.
namespace rmlcell::lsp {

struct Server::Message {
  Json json;
  std::string problem;  // not empty: there is no JSON, and this is why
  ErrorNumber problem_number = ErrorNumber::kParseError;
  std::size_t bytes = 0;
  bool cancelled = false;
};

struct Server::OpenDocument {
  explicit OpenDocument(Document made) : document(std::move(made)) {}

  void Changed() {
    program.reset();
    findings.reset();
    unpublished = true;
  }

  Document document;
  std::unique_ptr<machine::EditedProgram> program;  // of the present text, once somebody asked
  std::optional<Findings> findings;                 // of the present text
  bool unpublished = true;
};

}  // namespace rmlcell::lsp
