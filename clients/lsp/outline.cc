#include "clients/lsp/outline.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

namespace rmlcell::lsp {
namespace {

using optimo::Word;

// Of LSP.
enum SymbolKind : int {
  kModule = 2,
  kFunction = 12,
  kVariable = 13,
  kConstant = 14,
  kKey = 20,
  kEvent = 24
};

constexpr std::size_t kNameMax = 60;  // bytes of a statement in the outline

std::string OneLine(std::string_view text) {
  std::string line;
  for (const char c : text.substr(0, kNameMax))
    line += c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
  return text.size() > kNameMax ? line + " ..." : line;
}

class Outline {
 public:
  Outline(const Document& document, const ProgramIndex& index)
      : index_(index), positions_(document) {}

  Json Make() {
    for (const Declaration& declaration : index_.declarations()) {
      const Use& name = index_.uses()[declaration.use];
      const StatementPlace& statement = index_.statements()[name.statement];
      symbols_.push_back(
          Symbol(std::string(index_.TextOf(name)), declaration.variable ? kVariable : kConstant,
                 statement.begin, statement.end, name.begin, name.end,
                 OneLine(index_.text().substr(declaration.value_begin,
                                              declaration.value_end - declaration.value_begin))));
    }
    Parts();
    return std::move(symbols_);
  }

 private:
  Json Symbol(std::string name, SymbolKind kind, std::size_t begin, std::size_t end,
              std::size_t name_begin, std::size_t name_end, std::string detail) {
    Json symbol = {{"name", std::move(name)},
                   {"kind", static_cast<int>(kind)},
                   {"range", ToJson(positions_.Span(begin, end))},
                   {"selectionRange", ToJson(positions_.Span(name_begin, name_end))}};
    if (!detail.empty()) symbol["detail"] = std::move(detail);
    return symbol;
  }

  // One part for each sequence number, up to the next one.
  void Parts() {
    std::set<int> gosubs;
    for (const Use& use : index_.uses()) {
      if (use.kind == UseKind::kJump && index_.statements()[use.statement].word == Word::kGosub)
        gosubs.insert(use.number);
    }
    const bool steps = index_.step_count() <= kOutlineStepsMax;
    Json children = Json::array();
    const Use* label = nullptr;
    std::size_t begin = 0;
    std::size_t end = 0;
    const auto close = [&] {
      if (label != nullptr) {
        const bool subroutine = gosubs.contains(label->number);
        const std::uint32_t step = index_.StepOfLabel(*label);
        Json part = Symbol(std::to_string(label->number), subroutine ? kFunction : kKey, begin,
                           std::max<std::size_t>(end, label->end), label->begin, label->end,
                           step > index_.step_count() ? "end" : "step " + std::to_string(step));
        if (!children.empty()) part["children"] = std::move(children);
        symbols_.push_back(std::move(part));
      } else {
        for (Json& child : children) symbols_.push_back(std::move(child));
      }
      children = Json::array();
    };
    for (const StatementPlace& statement : index_.statements()) {
      const bool labelled = statement.first_use < index_.uses().size() &&
                            index_.uses()[statement.first_use].kind == UseKind::kLabel &&
                            index_.uses()[statement.first_use].begin == statement.begin;
      if (labelled) {
        close();
        label = &index_.uses()[statement.first_use];
        begin = statement.begin;
      }
      end = statement.end;
      if (!steps || statement.step == 0) continue;
      children.push_back(
          Symbol(std::to_string(statement.step) + " " + OneLine(index_.TextOf(statement)), kEvent,
                 statement.body, statement.end, statement.body, statement.end, {}));
    }
    close();
  }

  const ProgramIndex& index_;
  PositionFinder positions_;
  Json symbols_ = Json::array();
};

void Flatten(const Json& symbol, const std::string& uri, const std::string& container, Json& to) {
  Json flat = {{"name", symbol["name"]},
               {"kind", symbol["kind"]},
               {"location", {{"uri", uri}, {"range", symbol["range"]}}}};
  if (!container.empty()) flat["containerName"] = container;
  to.push_back(std::move(flat));
  if (const auto children = symbol.find("children"); children != symbol.end()) {
    for (const Json& child : *children) Flatten(child, uri, symbol["name"], to);
  }
}

class Folder {
 public:
  Folder(const Document& document, const ProgramIndex& index)
      : document_(document), index_(index) {}

  Json Make() {
    Comments();
    Declarations();
    std::set<int> gosubs;
    for (const Use& use : index_.uses()) {
      if (use.kind == UseKind::kJump && index_.statements()[use.statement].word == Word::kGosub)
        gosubs.insert(use.number);
    }
    std::map<std::pair<int, int>, std::size_t> on;  // process: where it went on
    std::size_t process = 0;
    std::size_t subroutine = kNowhere;
    const auto& statements = index_.statements();
    for (std::size_t s = 0; s < statements.size(); ++s) {
      const StatementPlace& statement = statements[s];
      Add(statement.body, statement.end, nullptr);
      const Use* label = statement.first_use < index_.uses().size()
                             ? &index_.uses()[statement.first_use]
                             : nullptr;
      if (label != nullptr && label->kind == UseKind::kLabel && label->statement == s &&
          gosubs.contains(label->number)) {
        subroutine = statement.begin;
      }
      if (statement.word == Word::kReturn && subroutine != kNowhere) {
        Add(subroutine, statement.end, "region");
        subroutine = kNowhere;
      }
      while (process < index_.processes().size() && index_.processes()[process].statement < s)
        ++process;
      if (process == index_.processes().size() || index_.processes()[process].statement != s)
        continue;
      const ProcessUse& use = index_.processes()[process];
      const std::pair<int, int> number(use.kind, use.process);
      if (!use.defines && use.on) on[number] = statement.begin;
      if (!use.defines && use.off && on.contains(number)) {
        Add(on[number], statement.end, "region");
        on.erase(number);
      }
    }
    return std::move(ranges_);
  }

 private:
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

  std::size_t LineOf(std::size_t offset) const { return document_.lines().LineOf(offset); }

  void Add(std::size_t begin, std::size_t end, const char* kind) {
    const std::size_t first = LineOf(begin);
    const std::size_t last = LineOf(end);
    if (last <= first) return;
    Json range = {{"startLine", first}, {"endLine", last}};
    if (kind != nullptr) range["kind"] = kind;
    ranges_.push_back(std::move(range));
  }

  // Whether nothing but blanks stands before it on its line.
  bool Alone(std::size_t offset) const {
    const std::size_t begin = document_.lines().Begin(LineOf(offset));
    return index_.text().substr(begin, offset - begin).find_first_not_of(" \t") ==
           std::string_view::npos;
  }

  void Comments() {
    const optimo::Comment* first = nullptr;
    const optimo::Comment* last = nullptr;
    for (const optimo::Comment& comment : index_.comments()) {
      if (!Alone(comment.begin)) continue;
      if (last != nullptr && LineOf(comment.begin) != LineOf(last->begin) + 1) {
        Add(first->begin, last->begin, "comment");
        first = nullptr;
      }
      if (first == nullptr) first = &comment;
      last = &comment;
    }
    if (first != nullptr) Add(first->begin, last->begin, "comment");
  }

  void Declarations() {
    const StatementPlace* first = nullptr;
    const StatementPlace* last = nullptr;
    for (const StatementPlace& statement : index_.statements()) {
      if (statement.word == Word::kDeclare) {
        if (first == nullptr) first = &statement;
        last = &statement;
        continue;
      }
      if (first != nullptr) Add(first->begin, last->end, nullptr);
      first = nullptr;
    }
    if (first != nullptr) Add(first->begin, last->end, nullptr);
  }

  const Document& document_;
  const ProgramIndex& index_;
  Json ranges_ = Json::array();
};

}  // namespace

Json Symbols(const Document& document, const ProgramIndex& index, bool nested) {
  Json symbols = Outline(document, index).Make();
  if (nested) return symbols;
  Json flat = Json::array();
  for (const Json& symbol : symbols) Flatten(symbol, document.uri(), {}, flat);
  return flat;
}

Json FoldingRanges(const Document& document, const ProgramIndex& index) {
  return Folder(document, index).Make();
}

}  // namespace rmlcell::lsp
