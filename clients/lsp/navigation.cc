#include "clients/lsp/navigation.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace rmlcell::lsp {
namespace {

constexpr int kHighlightRead = 2, kHighlightWrite = 3;  // of LSP

const Use* UseAt(const OpenProgram& program, std::size_t offset) {
  return program.index.CommentAt(offset) != nullptr ? nullptr : program.index.At(offset);
}

bool IsLabel(UseKind kind) { return kind == UseKind::kLabel || kind == UseKind::kJump; }

bool Declares(const Use& use) { return use.kind == UseKind::kLabel || use.declares; }

Json At(const Document& document, std::size_t begin, std::size_t end) {
  return Location(document.uri(), PositionFinder(document).Span(begin, end));
}

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

Json Definition(const OpenProgram& program, std::size_t offset) {
  Json found = Json::array();
  const ProgramIndex& index = program.index;
  const Use* use = UseAt(program, offset);
  if (use == nullptr) return found;
  if (IsLabel(use->kind)) {
    if (const Use* label = index.FindLabel(use->number))
      found.push_back(At(program.document, label->begin, label->end));
    return found;
  }
  if (use->kind == UseKind::kName) {
    if (const Declaration* declaration = index.FindDeclaration(use->key)) {
      const Use& name = index.uses()[declaration->use];
      found.push_back(At(program.document, name.begin, name.end));
    }
  }
  if (const auto number = CalledProgram(index, *use)) {
    if (const auto neighbour = FindNeighbour(program, *number))
      found.push_back(Location(neighbour->uri, Range{}));
  }
  const StatementPlace& statement = index.statements()[use->statement];
  const ProcessUse* process = ProcessOf(index, statement);
  if (use->kind == UseKind::kWord && use->word == optimo::Word::kWork && process != nullptr) {
    if (const StatementPlace* place = DefinitionOfProcess(index, *process))
      found.push_back(At(program.document, place->body, place->end));
  }
  return found;
}

Json References(const OpenProgram& program, std::size_t offset, bool with_declaration) {
  Json found = Json::array();
  const Use* use = UseAt(program, offset);
  if (use == nullptr) return found;
  PositionFinder positions(program.document);
  for (const Use* same : SameUses(program.index, *use)) {
    if (Declares(*same) && !with_declaration) continue;
    found.push_back(Location(program.document.uri(), positions.Span(same->begin, same->end)));
  }
  if (use->kind != UseKind::kProgram) return found;
  int last = 0;
  for (const NumberedFile& file : program.folder.Programs(program.document.uri())) {
    if (file.number == last || file.uri == program.document.uri()) continue;
    last = file.number;
    const auto neighbour = ReadNeighbour(program, file);
    if (!neighbour || neighbour->uri == program.document.uri()) continue;
    const Document other(neighbour->uri, {}, 0, neighbour->text, program.document.encoding());
    const ProgramIndex index(other.text());
    PositionFinder places(other);
    for (const Use* same : SameUses(index, *use))
      found.push_back(Location(other.uri(), places.Span(same->begin, same->end)));
  }
  return found;
}

Json Highlights(const OpenProgram& program, std::size_t offset) {
  Json found = Json::array();
  const Use* use = UseAt(program, offset);
  if (use == nullptr) return found;
  PositionFinder positions(program.document);
  for (const Use* same : SameUses(program.index, *use)) {
    found.push_back({{"range", ToJson(positions.Span(same->begin, same->end))},
                     {"kind", Declares(*same) ? kHighlightWrite : kHighlightRead}});
  }
  return found;
}

}  // namespace rmlcell::lsp
