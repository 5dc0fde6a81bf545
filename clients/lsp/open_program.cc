#include "clients/lsp/open_program.h"

#include <utility>

namespace rmlcell::lsp {

std::optional<Neighbour> ReadNeighbour(const OpenProgram& program, const NumberedFile& file) {
  if (const Document* open = program.open ? program.open(file.uri) : nullptr; open != nullptr)
    return Neighbour{open->uri(), open->text()};
  Result<std::string> text = program.folder.Read(file.uri);
  if (!text) return std::nullopt;
  return Neighbour{file.uri, *std::move(text)};
}

std::optional<Neighbour> FindNeighbour(const OpenProgram& program, int number) {
  for (const NumberedFile& file : program.folder.Programs(program.document.uri())) {
    if (file.number != number) continue;
    if (auto neighbour = ReadNeighbour(program, file)) return neighbour;
  }
  return std::nullopt;
}

std::optional<int> CalledProgram(const ProgramIndex& index, const Use& use) {
  if (use.kind == UseKind::kProgram) return use.number;
  if (use.kind != UseKind::kName) return std::nullopt;
  const StatementPlace& statement = index.statements()[use.statement];
  const bool calls = statement.word == optimo::Word::kCall || statement.word == optimo::Word::kGo ||
                     statement.word == optimo::Word::kFunction;
  // The first name behind the instruction is the program; others are what is passed.
  if (!calls || &use - index.uses().data() !=
                    static_cast<std::ptrdiff_t>(statement.first_use) +
                        (index.uses()[statement.first_use].kind == UseKind::kLabel ? 2 : 1)) {
    return std::nullopt;
  }
  const Declaration* declaration = index.FindDeclaration(use.key);
  if (declaration == nullptr || !declaration->whole || *declaration->whole > 99)
    return std::nullopt;
  return static_cast<int>(*declaration->whole);
}

}  // namespace rmlcell::lsp
