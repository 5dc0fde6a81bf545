#include "engine/optimo/editing/navigation.h"

#include <utility>

#include "engine/optimo/editing/neighbours.h"

namespace rmlcell::optimo::editing {
namespace {

const Use* UseAt(const ProgramIndex& index, std::size_t offset) {
  return index.CommentAt(offset) != nullptr ? nullptr : index.At(offset);
}

bool IsLabel(UseKind kind) { return kind == UseKind::kLabel || kind == UseKind::kJump; }

bool Declares(const Use& use) { return use.kind == UseKind::kLabel || use.declares; }

machine::TextSpan SpanOf(const Use& use) { return {use.begin, use.end}; }

// The nearest WORKDEF before a WORK, or the first behind it.
const StatementPlace* DefinitionOfProcess(const ProgramIndex& index, const ProcessUse& process) {
  const ProcessUse* found = nullptr;
  for (const ProcessUse& other : index.processes()) {
    const bool same =
        other.defines && other.kind == process.kind && other.process == process.process;
    if (same && (found == nullptr || other.statement < process.statement)) found = &other;
  }
  return found == nullptr ? nullptr : &index.statements()[found->statement];
}

}  // namespace

std::vector<const Use*> SameUses(const ProgramIndex& index, const Use& use) {
  std::vector<const Use*> same;
  for (const Use& other : index.uses()) {
    bool is_same = false;
    if (IsLabel(use.kind)) {
      is_same = IsLabel(other.kind) && other.number == use.number;
    } else if (use.kind == other.kind) {
      switch (use.kind) {
        case UseKind::kName:
          is_same = other.key == use.key;
          break;
        case UseKind::kVariable:
          is_same = other.group == use.group && other.number == use.number;
          break;
        case UseKind::kProgram:
          is_same = other.number == use.number;
          break;
        default:
          break;
      }
    }
    if (is_same) same.push_back(&other);
  }
  return same;
}

machine::Places Definition(const ProgramIndex& index, std::size_t offset,
                           const machine::Surroundings& around) {
  machine::Places found;
  const Use* use = UseAt(index, offset);
  if (use == nullptr) return found;
  if (IsLabel(use->kind)) {
    if (const Use* label = index.FindLabel(use->number)) found.here.push_back(SpanOf(*label));
    return found;
  }
  if (use->kind == UseKind::kName) {
    if (const Declaration* declaration = index.FindDeclaration(use->key))
      found.here.push_back(SpanOf(index.uses()[declaration->use]));
  }
  if (const auto number = CalledProgram(index, *use)) {
    if (auto neighbour = FindNeighbour(around, *number))
      found.elsewhere.push_back({*std::move(neighbour), {machine::TextSpan{}}});
  }
  const StatementPlace& statement = index.statements()[use->statement];
  const ProcessUse* process = ProcessOf(index, statement);
  if (use->kind == UseKind::kWord && use->word == Word::kWork && process != nullptr &&
      !process->defines) {
    if (const StatementPlace* place = DefinitionOfProcess(index, *process))
      found.here.push_back({place->body, place->end});
  }
  return found;
}

machine::Places References(const ProgramIndex& index, std::size_t offset, bool with_definition,
                           const machine::Surroundings& around) {
  machine::Places found;
  const Use* use = UseAt(index, offset);
  if (use == nullptr) return found;
  for (const Use* same : SameUses(index, *use)) {
    if (with_definition || !Declares(*same)) found.here.push_back(SpanOf(*same));
  }
  if (use->kind != UseKind::kProgram) return found;
  int last = 0;
  for (const machine::NumberedFile& file : around.Programs()) {
    if (file.number == last || file.uri == around.uri()) continue;
    last = file.number;
    auto neighbour = around.Read(file);
    if (!neighbour || neighbour->uri == around.uri()) continue;
    machine::PlacesInFile places{.file = *std::move(neighbour)};
    const ProgramIndex other(places.file.text);
    for (const Use* same : SameUses(other, *use)) places.spans.push_back(SpanOf(*same));
    if (!places.spans.empty()) found.elsewhere.push_back(std::move(places));
  }
  return found;
}

std::vector<machine::Highlight> Highlights(const ProgramIndex& index, std::size_t offset) {
  std::vector<machine::Highlight> found;
  const Use* use = UseAt(index, offset);
  if (use == nullptr) return found;
  for (const Use* same : SameUses(index, *use))
    found.push_back({.span = SpanOf(*same), .defines = Declares(*same)});
  return found;
}

}  // namespace rmlcell::optimo::editing
