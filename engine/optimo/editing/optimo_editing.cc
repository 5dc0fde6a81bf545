#include "engine/optimo/editing/optimo_editing.h"

#include <algorithm>
#include <array>

#include "engine/optimo/editing/allowance.h"
#include "engine/optimo/editing/completion.h"
#include "engine/optimo/editing/hover.h"
#include "engine/optimo/editing/navigation.h"
#include "engine/optimo/editing/outline.h"
#include "engine/optimo/editing/rename.h"
#include "engine/optimo/editing/rule_facts.h"
#include "engine/optimo/editing/word_facts.h"

namespace rmlcell::optimo {
namespace {

constexpr std::array<std::string_view, 3> kSourceExtensions = {".S", ".SI", ".CMP"};

class EditedRml final : public machine::EditedProgram {
 public:
  explicit EditedRml(std::string_view text) : index_(text), lines_(text) {}

  std::optional<machine::HoverNote> Hover(std::size_t offset,
                                          const machine::Surroundings& around) const override {
    return editing::Hover(index_, lines_, offset, around);
  }
  machine::Places Definition(std::size_t offset,
                             const machine::Surroundings& around) const override {
    return editing::Definition(index_, offset, around);
  }
  machine::Places References(std::size_t offset, bool with_definition,
                             const machine::Surroundings& around) const override {
    return editing::References(index_, offset, with_definition, around);
  }
  std::vector<machine::Highlight> Highlights(std::size_t offset) const override {
    return editing::Highlights(index_, offset);
  }
  machine::Suggestions Complete(std::size_t offset,
                                const machine::Surroundings& around) const override {
    return editing::Complete(index_, offset, around);
  }
  std::variant<machine::TextSpan, machine::Refusal> Renamable(std::size_t offset) const override {
    return editing::Renamable(index_, offset);
  }
  std::variant<std::vector<machine::TextSpan>, machine::Refusal> Rename(
      std::size_t offset, const std::string& name) const override {
    return editing::Rename(index_, offset, name);
  }
  std::vector<machine::OutlinePart> Outline() const override { return editing::Outline(index_); }
  std::vector<machine::FoldedLines> Folds() const override {
    return editing::Folds(index_, lines_);
  }

 private:
  editing::ProgramIndex index_;
  LineTable lines_;
};

class Editing final : public machine::Editing {
 public:
  std::span<const std::string_view> source_extensions() const override { return kSourceExtensions; }
  std::unique_ptr<machine::EditedProgram> Look(std::string_view text) const override {
    return std::make_unique<EditedRml>(text);
  }
  bool IsNeverReached(const Diagnostic& finding) const override {
    return finding.code == ErrorCode::kPracticeAdvice && finding.rule == "OPT-3.47";
  }
  std::string_view TextOfRule(std::string_view rule) const override {
    return editing::TextOfRule(rule);
  }
  std::optional<Fix> Allow(std::string_view text, const Diagnostic& finding) const override {
    return editing::Allowance(text, finding);
  }
};

}  // namespace

const machine::Editing& OptimoEditing() {
  static const Editing editing;
  return editing;
}

std::vector<machine::LanguageWord> OptimoWords() {
  std::vector<machine::LanguageWord> words;
  for (const editing::WordFact& fact : editing::WordFacts()) {
    const WordInfo& info = Describe(fact.word);
    words.push_back({.name = info.text, .form = fact.form, .text = fact.text, .rule = info.rule});
  }
  std::ranges::sort(words, {}, &machine::LanguageWord::name);
  return words;
}

}  // namespace rmlcell::optimo
