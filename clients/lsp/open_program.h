#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "clients/lsp/document.h"
#include "clients/lsp/program_folder.h"
#include "clients/lsp/program_index.h"

namespace rmlcell::lsp {

// The Optimo program that a request is about: its text, its index, and the way to its neighbours.
struct OpenProgram {
  const Document& document;
  const ProgramIndex& index;
  const ProgramFolder& folder;
  // Another document that is open, whose text goes over that on the disk; null: not open.
  std::function<const Document*(std::string_view uri)> open{};
};

// A program beside the one that is edited, as it stands in the editor or else on the disk.
struct Neighbour {
  std::string uri;
  std::string text;
};
// Nothing when the file cannot be read.
std::optional<Neighbour> ReadNeighbour(const OpenProgram& program, const NumberedFile& file);
// The source of a program number in the folder of the document; nothing when there is none that can
// be read.
std::optional<Neighbour> FindNeighbour(const OpenProgram& program, int number);

// The number that a GO, CALL or FUNCTION at this use names: 44, or the constant of a name; nothing
// for a variable and for what is called from nowhere.
std::optional<int> CalledProgram(const ProgramIndex& index, const Use& use);

}  // namespace rmlcell::lsp
