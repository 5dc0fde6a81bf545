#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/optimo/language/ast.h"
#include "engine/optimo/language/lexer.h"

// Where what stands in an Optimo program: sequence numbers and the jumps to them, names, variables,
// programs that are called, laser processes. Made from the tokens alone, so that it holds for a
// program that is being written and does not parse yet.
namespace rmlcell::optimo::editing {

inline constexpr std::uint32_t kSequenceNumberMax = 9999;  // OPT-1.23

enum class UseKind : std::uint8_t {
  kWord,      // a reserved word
  kName,      // a declared name, or one that should be
  kLabel,     // a sequence number before its statement
  kJump,      // a sequence number that is jumped to
  kProgram,   // a program number: GO, CALL, FUNCTION, BREAK, SIMUL
  kVariable,  // VR[5], from the group to the bracket
};

struct Use {
  UseKind kind = UseKind::kWord;
  bool declares = false;                     // kName behind DECLARE
  Word word = Word::kNone;                   // kWord
  VariableGroup group = VariableGroup::kVr;  // kVariable
  std::uint16_t number = 0;                  // of label, jump, program, variable
  std::uint32_t begin = 0;                   // byte offsets
  std::uint32_t end = 0;
  std::uint32_t statement = 0;
  NameKey key = 0;  // kName: what counts of it
};

struct StatementPlace {
  Word word = Word::kNone;  // the first; kNone: an assignment, or a lone label
  bool lone_label = false;
  std::uint32_t step = 0;   // as the control counts; 0: none
  std::uint32_t begin = 0;  // of its sequence number, if it has one
  std::uint32_t body = 0;   // behind the sequence number
  std::uint32_t end = 0;
  std::uint32_t first_use = 0;  // in ProgramIndex::uses
};

// DECLARE NAME = value.
struct Declaration {
  NameKey key = 0;
  std::uint32_t use = 0;  // of the name
  std::uint32_t value_begin = 0;
  std::uint32_t value_end = 0;
  std::optional<Variable> variable{};    // nothing: a constant
  std::optional<std::uint32_t> whole{};  // the value of an integer constant, no sign
};

// WORKDEF n,p (...) and WORK n,p /ON or /OFF.
struct ProcessUse {
  bool defines = false;
  bool on = false;
  bool off = false;
  std::uint8_t kind = 0;
  std::uint8_t process = 0;
  std::uint32_t statement = 0;
};

// The text must outlive the index and not change.
class ProgramIndex {
 public:
  explicit ProgramIndex(std::string_view text);

  std::string_view text() const { return text_; }
  const std::vector<Use>& uses() const { return uses_; }
  const std::vector<StatementPlace>& statements() const { return statements_; }
  const std::vector<Declaration>& declarations() const { return declarations_; }
  const std::vector<ProcessUse>& processes() const { return processes_; }
  const std::vector<Comment>& comments() const { return comments_; }
  std::uint32_t step_count() const { return steps_; }

  // What stands at `offset`, or ends there; null: nothing of meaning.
  const Use* At(std::size_t offset) const;
  // The statement that `offset` is in or, between two, the one before; null before the first.
  const StatementPlace* StatementAt(std::size_t offset) const;
  // The comment that `offset` is in, its ';' excluded; null: none.
  const Comment* CommentAt(std::size_t offset) const;

  const Use* FindLabel(int number) const;
  // The first declaration of a name.
  const Declaration* FindDeclaration(NameKey key) const;
  // The step that a sequence number leads to; step_count() + 1 is the end of the program.
  std::uint32_t StepOfLabel(const Use& label) const;

  std::string_view TextOf(const Use& use) const {
    return text_.substr(use.begin, use.end - use.begin);
  }
  std::string_view TextOf(const StatementPlace& statement) const {
    return text_.substr(statement.body, statement.end - statement.body);
  }

 private:
  class Builder;

  std::string_view text_;
  std::vector<Use> uses_;
  std::vector<StatementPlace> statements_;
  std::vector<Declaration> declarations_;
  std::vector<ProcessUse> processes_;
  std::vector<Comment> comments_;
  std::uint32_t steps_ = 0;
};

// The numbers of a process: "WORK 1,00 /ON" at its statement; nothing when it is neither WORK nor
// WORKDEF, or has none.
const ProcessUse* ProcessOf(const ProgramIndex& index, const StatementPlace& statement);

}  // namespace rmlcell::optimo::editing
