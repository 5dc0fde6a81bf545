#include "engine/optimo/editing/neighbours.h"

namespace rmlcell::optimo::editing {

std::optional<machine::NumberedSource> FindNeighbour(const machine::Surroundings& around,
                                                     int number) {
  for (const machine::NumberedFile& file : around.Programs()) {
    if (file.number != number) continue;
    if (auto neighbour = around.Read(file)) return neighbour;
  }
  return std::nullopt;
}

std::optional<int> CalledProgram(const ProgramIndex& index, const Use& use) {
  if (use.kind == UseKind::kProgram) return use.number;
  if (use.kind != UseKind::kName) return std::nullopt;
  const StatementPlace& statement = index.statements()[use.statement];
  const bool calls = statement.word == Word::kCall || statement.word == Word::kGo ||
                     statement.word == Word::kFunction;
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

}  // namespace rmlcell::optimo::editing
