#include "engine/optimo/editing/completion.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <set>
#include <string>
#include <utility>

#include "engine/core/letters.h"
#include "engine/optimo/editing/variable_facts.h"
#include "engine/optimo/editing/word_facts.h"
#include "engine/optimo/language/instruction_set.h"

namespace rmlcell::optimo::editing {
namespace {

using Kind = machine::Suggestion::Kind;

constexpr std::size_t kNamesMax = 1000;  // of a list; typing on narrows it
constexpr std::size_t kLabelsMax = 1000;

bool IsWordPart(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
}

bool StartsIgnoringCase(std::string_view text, std::string_view beginning) {
  return EqualIgnoringCase(text.substr(0, beginning.size()), beginning);
}

class Completer {
 public:
  Completer(const ProgramIndex& index, std::size_t offset, const machine::Surroundings& around)
      : index_(index), around_(around), text_(index.text()), offset_(offset), begin_(offset) {
    while (begin_ > 0 && IsWordPart(text_[begin_ - 1])) --begin_;
    typed_ = text_.substr(begin_, offset - begin_);
    made_.typed = {begin_, offset};
  }

  machine::Suggestions Make() {
    if (const Comment* comment = index_.CommentAt(offset_)) {
      InComment(*comment);
    } else {
      InStatement();
    }
    return std::move(made_);
  }

 private:
  void Add(std::string_view label, Kind kind, std::string_view detail, std::string_view text = {}) {
    if (!StartsIgnoringCase(label, typed_)) return;
    made_.list.push_back({.kind = kind,
                          .label = std::string(label),
                          .detail = std::string(detail),
                          .text = std::string(text)});
  }
  void AddWord(Word word, Kind kind = Kind::kWord) {
    const WordFact& fact = FactOf(word);
    Add(Describe(word).text, kind, fact.form, fact.text);
  }
  void AddWords(std::initializer_list<Word> words) {
    for (const Word word : words) AddWord(word);
  }
  void AddGroup(WordGroup group, Kind kind = Kind::kWord) {
    for (const WordInfo& row : ReservedWords()) {
      if (row.group == group) AddWord(row.word, kind);
    }
  }

  // The tokens of the statement up to what is being typed.
  void ReadTokens() {
    const StatementPlace* statement = nullptr;
    if (begin_ > 0) statement = index_.StatementAt(begin_ - 1);
    if (statement == nullptr) return;
    std::size_t from = statement->begin;
    // Behind the end of a statement a new line begins a new one, unless it goes on.
    if (statement->end < begin_ &&
        text_.substr(statement->end, begin_ - statement->end).find('\n') !=
            std::string_view::npos &&
        !GoesOn(*statement)) {
      from = text_.rfind('\n', begin_ - 1) + 1;
    }
    std::vector<Comment> comments;
    Lexer lexer(text_.substr(from, begin_ - from), comments);
    if (!lexer.NextStatement()) return;
    for (std::size_t at = 0; lexer.At(at).kind != TokenKind::kEnd && at < kTokensMax; ++at)
      tokens_.push_back(lexer.At(at));
    if (!tokens_.empty() && tokens_.front().kind == TokenKind::kNumber)
      tokens_.erase(tokens_.begin());
  }
  // The last token asks for more, or a parenthesis is open (OPT-1.30).
  bool GoesOn(const StatementPlace& statement) const {
    int depth = 0;
    for (const char c : index_.TextOf(statement)) {
      if (c == '(') ++depth;
      if (c == ')') --depth;
    }
    const char last = statement.end > 0 ? text_[statement.end - 1] : ' ';
    return depth > 0 || std::string_view("/,(=+-*^<>").find(last) != std::string_view::npos;
  }

  void InStatement() {
    ReadTokens();
    if (tokens_.empty()) return AtStart();
    const Token& last = tokens_.back();
    const Word first =
        tokens_.front().kind == TokenKind::kWord ? tokens_.front().word : Word::kNone;
    const bool alone = tokens_.size() == 1;
    if (last.kind == TokenKind::kSlash && IsAttributePlace(first)) return AddAttributes(first);
    if (IsJumpPlace(first)) return AddLabels();
    switch (first) {
      case Word::kCoord:
        return alone ? AddWords({Word::kAbsol, Word::kRobot}) : void();
      case Word::kPath:
        if (alone) return AddWords({Word::kPtp, Word::kLin, Word::kCir, Word::kHole});
        break;
      case Word::kDefine:
        if (alone) return AddWords({Word::kPar});
        if (last.kind == TokenKind::kEqual) AddWords({Word::kFloat, Word::kInt, Word::kLogic});
        return;
      case Word::kUpdate:
      case Word::kImage:
      case Word::kReal:
        if (alone || last.kind == TokenKind::kComma)
          AddWords({Word::kIl, Word::kOl, Word::kIa, Word::kOa});
        return;
      case Word::kGo:
      case Word::kCall:
      case Word::kFunction:
        if (alone) {
          AddPrograms();
          AddNames();
          if (first != Word::kFunction) AddGroup(WordGroup::kVariable, Kind::kVariable);
          return;
        }
        break;
      case Word::kDeclare:
        if (alone || last.kind != TokenKind::kEqual) return;
        AddGroup(WordGroup::kVariable, Kind::kVariable);
        AddGroup(WordGroup::kConstant, Kind::kConstant);
        return;
      case Word::kSysdef:
      case Word::kTask:
      case Word::kBreak:
      case Word::kSimul:
      case Word::kWork:
        if (alone) return;
        break;
      default:
        break;
    }
    if (last.kind == TokenKind::kOpenIndex) return AddIndexes();
    if (last.kind == TokenKind::kNumber || last.kind == TokenKind::kClose ||
        last.kind == TokenKind::kCloseIndex ||
        (last.kind == TokenKind::kWord && last.word == Word::kNone && tokens_.size() > 1)) {
      if (first == Word::kIf) AddWords({Word::kThen, Word::kElse});
      AddGroup(WordGroup::kOperator);
      return;
    }
    if (last.kind == TokenKind::kWord && alone && last.word == Word::kNone) return;  // NAME, then =
    InExpression();
  }

  void AtStart() {
    for (const WordInfo& row : ReservedWords()) {
      if (row.group == WordGroup::kInstruction) AddWord(row.word);
    }
    AddNames();
    AddGroup(WordGroup::kVariable, Kind::kVariable);
  }

  void InExpression() {
    AddNames();
    AddGroup(WordGroup::kVariable, Kind::kVariable);
    AddGroup(WordGroup::kFunction, Kind::kFunction);
    AddGroup(WordGroup::kConstant, Kind::kConstant);
    AddWord(Word::kNot);
  }

  // A slash inside parentheses divides, and so does one in an instruction without attributes.
  bool IsAttributePlace(Word first) const {
    const Op op = first == Word::kNone ? Op::kInvalid : OpOf(first);
    if (Describe(op).attributes == 0) return false;
    int depth = 0;
    for (const Token& token : tokens_) {
      if (token.kind == TokenKind::kOpen) ++depth;
      if (token.kind == TokenKind::kClose) --depth;
    }
    return depth == 0;
  }

  void AddAttributes(Word first) {
    const std::uint16_t allowed = Describe(OpOf(first)).attributes;
    for (const AttributeInfo& attribute : kAttributes) {
      const bool given = std::ranges::any_of(tokens_, [&](const Token& token) {
        return token.kind == TokenKind::kWord && token.word == attribute.word;
      });
      if ((allowed & attribute.bit) != 0 && attribute.bit != kInf && !given)
        AddWord(attribute.word);
    }
  }

  bool IsJumpPlace(Word first) const {
    const Token& last = tokens_.back();
    if (last.kind == TokenKind::kWord) {
      if (last.word == Word::kThen || last.word == Word::kElse) return true;
      return tokens_.size() == 1 &&
             (first == Word::kGoto || first == Word::kGosub || first == Word::kErr);
    }
    // The lists of GOTO VI[2] (, and the second value of /TIME ( and TIMER (.
    std::size_t open = tokens_.size();
    int depth = 0;
    for (std::size_t at = tokens_.size(); at-- > 0;) {
      if (tokens_[at].kind == TokenKind::kClose) ++depth;
      if (tokens_[at].kind == TokenKind::kOpen && depth-- == 0) {
        open = at;
        break;
      }
    }
    if (open == tokens_.size() || open == 0) return false;
    if (first == Word::kGoto)
      return last.kind == TokenKind::kOpen || last.kind == TokenKind::kComma;
    const Token& before = tokens_[open - 1];
    const bool timed = before.kind == TokenKind::kWord &&
                       (before.word == Word::kTime || before.word == Word::kTimer);
    return timed && last.kind == TokenKind::kComma;
  }

  void AddLabels() {
    std::set<int> seen;
    for (const Use& use : index_.uses()) {
      if (use.kind != UseKind::kLabel || !seen.insert(use.number).second) continue;
      if (seen.size() > kLabelsMax) {
        made_.cut = true;
        return;
      }
      std::string detail;
      const StatementPlace& statement = index_.statements()[use.statement];
      if (!statement.lone_label) detail = index_.TextOf(statement).substr(0, kDetailMax);
      Add(std::to_string(use.number), Kind::kSequenceNumber, detail);
    }
  }

  void AddNames() {
    std::size_t count = 0;
    for (const Declaration& declaration : index_.declarations()) {
      if (++count > kNamesMax) {
        made_.cut = true;
        return;
      }
      const Use& name = index_.uses()[declaration.use];
      const std::string value(index_.text().substr(
          declaration.value_begin,
          std::min(kDetailMax, std::size_t{declaration.value_end} - declaration.value_begin)));
      Add(index_.TextOf(name), declaration.variable ? Kind::kVariable : Kind::kConstant,
          "= " + value);
    }
  }

  void AddPrograms() {
    int last = 0;
    for (const machine::NumberedFile& file : around_.Programs()) {
      if (file.number == last) continue;
      last = file.number;
      Add(std::to_string(file.number), Kind::kProgram, file.name);
    }
  }

  void AddIndexes() {
    if (tokens_.size() < 2) return;
    const Word word = tokens_[tokens_.size() - 2].word;
    constexpr std::array kGroups = {Word::kVr, Word::kVi, Word::kVl, Word::kIl,
                                    Word::kOl, Word::kIa, Word::kOa, Word::kPar};
    const auto found = std::ranges::find(kGroups, word);
    if (found == kGroups.end()) return;
    const auto group = static_cast<VariableGroup>(found - kGroups.begin());
    const int most = group == VariableGroup::kPar ? kParameterCount - 1 : kVariableIndexMax;
    for (int index = 0; index <= most; ++index) {
      Add(std::to_string(index), Kind::kVariable,
          VariableNote({group, static_cast<std::uint8_t>(index)}));
    }
    AddNames();
  }

  // ";$" directives of the compensation (OPT-8.03, 8.04), "; rmlcell:" ones of the checker.
  void InComment(const Comment& comment) {
    const std::string_view before = text_.substr(comment.begin, begin_ - comment.begin);
    if (before == ";$") {
      Add("dia", Kind::kWord, ";$dia=0.4", "Diameter of the beam for cutter compensation.");
      Add("rad", Kind::kWord, ";$rad=0.2", "Radius of the beam for cutter compensation.");
      Add("left", Kind::kWord, ";$left", "The cut lies left of the programmed path.");
      Add("right", Kind::kWord, ";$right", "The cut lies right of the programmed path.");
      Add("none", Kind::kWord, ";$none", "No compensation from here on.");
    }
    const std::size_t mark = before.find("rmlcell:");
    if (mark != std::string_view::npos &&
        before.find_first_not_of(" \t", mark + 8) == std::string_view::npos) {
      Add("allow", Kind::kWord, "rmlcell: allow 7033",
          "Silences warnings and advice of these numbers on this line; on a line of its own for "
          "the "
          "next statement, with `in file` for the whole text.");
    }
  }

  static constexpr std::size_t kDetailMax = 60;    // bytes
  static constexpr std::size_t kTokensMax = 2000;  // of a statement that is being typed

  const ProgramIndex& index_;
  const machine::Surroundings& around_;
  std::string_view text_;
  std::size_t offset_;
  std::size_t begin_;  // of the word that is being typed
  std::string_view typed_;
  std::vector<Token> tokens_;
  machine::Suggestions made_;
};

}  // namespace

machine::Suggestions Complete(const ProgramIndex& index, std::size_t offset,
                              const machine::Surroundings& around) {
  // Behind the end that Ctrl-Z makes there is no program.
  if (offset > index.text().size()) return {.typed = {offset, offset}};
  return Completer(index, offset, around).Make();
}

}  // namespace rmlcell::optimo::editing
