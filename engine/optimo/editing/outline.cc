#include "engine/optimo/editing/outline.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace rmlcell::optimo::editing {
namespace {

using machine::FoldedLines;
using machine::OutlinePart;

constexpr std::size_t kNameMax = 60;  // bytes of a statement in the outline

std::string OneLine(std::string_view text) {
  std::string line;
  for (const char c : text.substr(0, kNameMax))
    line += c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
  return text.size() > kNameMax ? line + " ..." : line;
}

class OutlineMaker {
 public:
  explicit OutlineMaker(const ProgramIndex& index) : index_(index) {}

  std::vector<OutlinePart> Make() {
    for (const Declaration& declaration : index_.declarations()) {
      const Use& name = index_.uses()[declaration.use];
      const StatementPlace& statement = index_.statements()[name.statement];
      parts_.push_back(
          {.kind =
               declaration.variable ? OutlinePart::Kind::kVariable : OutlinePart::Kind::kConstant,
           .name = std::string(index_.TextOf(name)),
           .detail = OneLine(index_.text().substr(declaration.value_begin,
                                                  declaration.value_end - declaration.value_begin)),
           .whole = {statement.begin, statement.end},
           .name_at = {name.begin, name.end}});
    }
    Parts();
    return std::move(parts_);
  }

 private:
  // One part for each sequence number, up to the next one.
  void Parts() {
    std::set<int> gosubs;
    for (const Use& use : index_.uses()) {
      if (use.kind == UseKind::kJump && index_.statements()[use.statement].word == Word::kGosub)
        gosubs.insert(use.number);
    }
    const bool steps = index_.step_count() <= kOutlineStepsMax;
    std::vector<OutlinePart> within;
    const Use* label = nullptr;
    std::size_t begin = 0;
    std::size_t end = 0;
    const auto close = [&] {
      if (label != nullptr) {
        const bool subroutine = gosubs.contains(label->number);
        const std::uint32_t step = index_.StepOfLabel(*label);
        parts_.push_back(
            {.kind =
                 subroutine ? OutlinePart::Kind::kSubroutine : OutlinePart::Kind::kSequenceNumber,
             .name = std::to_string(label->number),
             .detail = step > index_.step_count() ? "end" : "step " + std::to_string(step),
             .whole = {begin, std::max<std::size_t>(end, label->end)},
             .name_at = {label->begin, label->end},
             .parts = std::move(within)});
      } else {
        std::ranges::move(within, std::back_inserter(parts_));
      }
      within.clear();
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
      within.push_back(
          {.kind = OutlinePart::Kind::kStep,
           .name = std::to_string(statement.step) + " " + OneLine(index_.TextOf(statement)),
           .whole = {statement.body, statement.end},
           .name_at = {statement.body, statement.end}});
    }
    close();
  }

  const ProgramIndex& index_;
  std::vector<OutlinePart> parts_;
};

class FoldMaker {
 public:
  FoldMaker(const ProgramIndex& index, const LineTable& lines) : index_(index), lines_(lines) {}

  std::vector<FoldedLines> Make() {
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
      Add(statement.body, statement.end, FoldedLines::Kind::kStatements);
      const Use* label = statement.first_use < index_.uses().size()
                             ? &index_.uses()[statement.first_use]
                             : nullptr;
      if (label != nullptr && label->kind == UseKind::kLabel && label->statement == s &&
          gosubs.contains(label->number)) {
        subroutine = statement.begin;
      }
      if (statement.word == Word::kReturn && subroutine != kNowhere) {
        Add(subroutine, statement.end, FoldedLines::Kind::kRegion);
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
        Add(on[number], statement.end, FoldedLines::Kind::kRegion);
        on.erase(number);
      }
    }
    return std::move(folds_);
  }

 private:
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

  std::size_t LineOf(std::size_t offset) const { return lines_.LineOf(offset); }

  void Add(std::size_t begin, std::size_t end, FoldedLines::Kind kind) {
    const std::size_t first = LineOf(begin);
    const std::size_t last = LineOf(end);
    if (last > first) folds_.push_back({.kind = kind, .first = first, .last = last});
  }

  // Whether nothing but blanks stands before it on its line.
  bool Alone(std::size_t offset) const {
    const std::size_t begin = lines_.Begin(LineOf(offset));
    return index_.text().substr(begin, offset - begin).find_first_not_of(" \t") ==
           std::string_view::npos;
  }

  void Comments() {
    const Comment* first = nullptr;
    const Comment* last = nullptr;
    for (const Comment& comment : index_.comments()) {
      if (!Alone(comment.begin)) continue;
      if (last != nullptr && LineOf(comment.begin) != LineOf(last->begin) + 1) {
        Add(first->begin, last->begin, FoldedLines::Kind::kComment);
        first = nullptr;
      }
      if (first == nullptr) first = &comment;
      last = &comment;
    }
    if (first != nullptr) Add(first->begin, last->begin, FoldedLines::Kind::kComment);
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
      if (first != nullptr) Add(first->begin, last->end, FoldedLines::Kind::kStatements);
      first = nullptr;
    }
    if (first != nullptr) Add(first->begin, last->end, FoldedLines::Kind::kStatements);
  }

  const ProgramIndex& index_;
  const LineTable& lines_;
  std::vector<FoldedLines> folds_;
};

}  // namespace

std::vector<OutlinePart> Outline(const ProgramIndex& index) { return OutlineMaker(index).Make(); }

std::vector<FoldedLines> Folds(const ProgramIndex& index, const LineTable& lines) {
  return FoldMaker(index, lines).Make();
}

}  // namespace rmlcell::optimo::editing
