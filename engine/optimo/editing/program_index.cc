#include "engine/optimo/editing/program_index.h"

#include <algorithm>

namespace rmlcell::optimo::editing {

namespace {

std::optional<VariableGroup> GroupOf(Word word) {
  switch (word) {
    case Word::kVr:
      return VariableGroup::kVr;
    case Word::kVi:
      return VariableGroup::kVi;
    case Word::kVl:
      return VariableGroup::kVl;
    case Word::kIl:
      return VariableGroup::kIl;
    case Word::kOl:
      return VariableGroup::kOl;
    case Word::kIa:
      return VariableGroup::kIa;
    case Word::kOa:
      return VariableGroup::kOa;
    case Word::kPar:
      return VariableGroup::kPar;
    default:
      return std::nullopt;
  }
}

}  // namespace

// Walks the statements token by token.
class ProgramIndex::Builder {
 public:
  explicit Builder(ProgramIndex& to) : to_(to), lexer_(to.text_, to.comments_) {}

  void Run() {
    while (lexer_.NextStatement()) ReadStatement();
  }

 private:
  void ReadStatement();
  void ReadTokens(std::size_t at);
  // Reads what begins at token `at`; returns the token behind it.
  std::size_t ReadToken(std::size_t at);
  std::size_t ReadVariable(std::size_t at, VariableGroup group);
  bool IsJump(std::size_t at);
  bool IsProgram(std::size_t at);
  void ReadDeclaration(std::size_t at);
  void ReadProcess(std::size_t at);

  Use& Add(UseKind kind, const Token& first, const Token& last) {
    Use& use = to_.uses_.emplace_back();
    use.kind = kind;
    use.begin = first.offset;
    use.end = last.offset + last.length;
    use.statement = static_cast<std::uint32_t>(to_.statements_.size() - 1);
    return use;
  }
  bool Is(std::size_t at, TokenKind kind) { return lexer_.At(at).kind == kind; }
  bool IsWhole(std::size_t at, std::uint32_t most) {
    const Token& token = lexer_.At(at);
    return token.kind == TokenKind::kNumber && token.whole && token.digits <= most;
  }

  ProgramIndex& to_;
  Lexer lexer_;
  std::size_t body_ = 0;  // the first token behind the sequence number
  Word first_ = Word::kNone;
  int depth_ = 0;               // open parentheses
  int timed_depth_ = 0;         // of /TIME ( or TIMER (; 0: not inside
  bool list_of_jumps_ = false;  // GOTO VI[2] (
};

void ProgramIndex::Builder::ReadStatement() {
  const Token first = lexer_.At(0);
  StatementPlace& statement = to_.statements_.emplace_back();
  statement.begin = first.offset;
  statement.first_use = static_cast<std::uint32_t>(to_.uses_.size());
  body_ = 0;
  if (first.kind == TokenKind::kNumber) {
    body_ = 1;
    if (first.whole && first.digits <= kSequenceNumberMax) {
      Add(UseKind::kLabel, first, first).number = static_cast<std::uint16_t>(first.digits);
    }
  }
  const Token word = lexer_.At(body_);
  statement.body = word.kind == TokenKind::kEnd ? first.offset + first.length : word.offset;
  statement.end = statement.body;
  if (word.kind == TokenKind::kEnd) {
    statement.lone_label = true;
    return;
  }
  statement.end = word.offset + word.length;
  first_ = word.kind == TokenKind::kWord ? word.word : Word::kNone;
  statement.word = first_;
  if (first_ != Word::kDeclare) statement.step = ++to_.steps_;
  depth_ = 0;
  timed_depth_ = 0;
  list_of_jumps_ = false;
  if (first_ != Word::kNone && Describe(first_).group == WordGroup::kIgnored) {
    Add(UseKind::kWord, word, word).word = first_;
    const std::string_view rest = lexer_.RestOfLine(word);
    if (!rest.empty()) {
      const auto end = static_cast<std::size_t>(rest.data() + rest.size() - to_.text_.data());
      to_.statements_.back().end = static_cast<std::uint32_t>(end);
    }
    return;
  }
  ReadTokens(body_);
  if (first_ == Word::kDeclare) ReadDeclaration(body_);
  if (first_ == Word::kWork || first_ == Word::kWorkdef) ReadProcess(body_);
}

void ProgramIndex::Builder::ReadTokens(std::size_t at) {
  while (!Is(at, TokenKind::kEnd)) {
    const std::size_t next = ReadToken(at);
    const Token& last = lexer_.At(next - 1);
    to_.statements_.back().end = last.offset + last.length;
    if (last.kind == TokenKind::kTooLong) return;
    at = next;
  }
}

std::size_t ProgramIndex::Builder::ReadToken(std::size_t at) {
  const Token token = lexer_.At(at);
  switch (token.kind) {
    case TokenKind::kOpen:
      ++depth_;
      if (timed_depth_ == 0 && at > 0 && lexer_.At(at - 1).kind == TokenKind::kWord) {
        const Word before = lexer_.At(at - 1).word;
        const bool attribute = before == Word::kTime && at > 1 && Is(at - 2, TokenKind::kSlash);
        if (attribute || (before == Word::kTimer && at - 1 == body_)) timed_depth_ = depth_;
      }
      if (first_ == Word::kGoto && depth_ == 1) list_of_jumps_ = true;
      break;
    case TokenKind::kClose:
      if (depth_ == timed_depth_) timed_depth_ = 0;
      if (depth_ > 0) --depth_;
      break;
    case TokenKind::kNumber:
      if (IsJump(at)) {
        Add(UseKind::kJump, token, token).number = static_cast<std::uint16_t>(token.digits);
      } else if (IsProgram(at)) {
        Add(UseKind::kProgram, token, token).number = static_cast<std::uint16_t>(token.digits);
      }
      break;
    case TokenKind::kWord: {
      if (token.word == Word::kNone) {
        Use& use = Add(UseKind::kName, token, token);
        use.key = token.key;
        use.declares = first_ == Word::kDeclare && at == body_ + 1;
        break;
      }
      if (const auto group = GroupOf(token.word); group && Is(at + 1, TokenKind::kOpenIndex))
        return ReadVariable(at, *group);
      Add(UseKind::kWord, token, token).word = token.word;
      break;
    }
    default:
      break;
  }
  return at + 1;
}

// VR [ 5 ]; with a name as index the group is a word and the name a name.
std::size_t ProgramIndex::Builder::ReadVariable(std::size_t at, VariableGroup group) {
  const Token word = lexer_.At(at);
  if (IsWhole(at + 2, kVariableIndexMax) && Is(at + 3, TokenKind::kCloseIndex)) {
    const auto index = static_cast<std::uint16_t>(lexer_.At(at + 2).digits);
    Use& use = Add(UseKind::kVariable, word, lexer_.At(at + 3));
    use.group = group;
    use.number = index;
    return at + 4;
  }
  Add(UseKind::kWord, word, word).word = word.word;
  return at + 1;
}

// GOTO 20, GOSUB 100, ERR 900, THEN 50, ELSE 60, GOTO VI[2] (20, 30), /TIME (2.5, 900),
// TIMER (5.0, 900).
bool ProgramIndex::Builder::IsJump(std::size_t at) {
  if (!IsWhole(at, kSequenceNumberMax) || at == 0) return false;
  const Token& before = lexer_.At(at - 1);
  if (before.kind == TokenKind::kWord) {
    const bool begins = at - 1 == body_;
    return before.word == Word::kThen || before.word == Word::kElse ||
           (begins && (before.word == Word::kGoto || before.word == Word::kGosub ||
                       before.word == Word::kErr));
  }
  const bool item = before.kind == TokenKind::kComma || before.kind == TokenKind::kOpen;
  if (list_of_jumps_ && depth_ == 1) return item;
  return timed_depth_ > 0 && depth_ == timed_depth_ && before.kind == TokenKind::kComma;
}

// GO 46, CALL 2, FUNCTION 44; the second number of BREAK 7, 45 and SIMUL.
bool ProgramIndex::Builder::IsProgram(std::size_t at) {
  if (!IsWhole(at, kSequenceNumberMax)) return false;
  if (at == body_ + 1) {
    return first_ == Word::kGo || first_ == Word::kCall || first_ == Word::kFunction;
  }
  return at == body_ + 3 && (first_ == Word::kBreak || first_ == Word::kSimul) &&
         Is(at - 1, TokenKind::kComma);
}

// DECLARE NAME = value
void ProgramIndex::Builder::ReadDeclaration(std::size_t at) {
  if (!Is(at + 1, TokenKind::kWord) || lexer_.At(at + 1).word != Word::kNone ||
      !Is(at + 2, TokenKind::kEqual) || Is(at + 3, TokenKind::kEnd)) {
    return;
  }
  Declaration& made = to_.declarations_.emplace_back();
  made.key = lexer_.At(at + 1).key;
  const StatementPlace& statement = to_.statements_.back();
  for (std::uint32_t u = statement.first_use; u < to_.uses_.size(); ++u) {
    const Use& use = to_.uses_[u];
    if (use.declares) made.use = u;
    if (use.kind == UseKind::kVariable)
      made.variable = Variable{use.group, static_cast<std::uint8_t>(use.number)};
  }
  made.value_begin = lexer_.At(at + 3).offset;
  made.value_end = statement.end;
  if (IsWhole(at + 3, kDigitsMax) && Is(at + 4, TokenKind::kEnd))
    made.whole = lexer_.At(at + 3).digits;
}

// WORK n , p
void ProgramIndex::Builder::ReadProcess(std::size_t at) {
  constexpr std::uint32_t kKindMax = 2, kProcessMax = 9;  // OPT-3.01
  if (!IsWhole(at + 1, kKindMax) || !Is(at + 2, TokenKind::kComma) || !IsWhole(at + 3, kProcessMax))
    return;
  ProcessUse& made = to_.processes_.emplace_back();
  made.kind = static_cast<std::uint8_t>(lexer_.At(at + 1).digits);
  made.process = static_cast<std::uint8_t>(lexer_.At(at + 3).digits);
  made.statement = static_cast<std::uint32_t>(to_.statements_.size() - 1);
  made.defines = first_ == Word::kWorkdef;
  for (std::uint32_t u = to_.statements_.back().first_use; u < to_.uses_.size(); ++u) {
    made.on = made.on || to_.uses_[u].word == Word::kOn;
    made.off = made.off || to_.uses_[u].word == Word::kOff;
  }
}

ProgramIndex::ProgramIndex(std::string_view text) : text_(text.substr(0, text.find('\x1A'))) {
  if (text_.size() > kSourceBytesMax) text_ = {};
  Builder(*this).Run();
}

const Use* ProgramIndex::At(std::size_t offset) const {
  const auto behind = std::ranges::upper_bound(uses_, offset, {}, &Use::begin);
  if (behind == uses_.begin()) return nullptr;
  const Use& use = *std::prev(behind);
  if (offset <= use.end && (offset < use.end || behind == uses_.end() || behind->begin > offset))
    return &use;
  return nullptr;
}

const StatementPlace* ProgramIndex::StatementAt(std::size_t offset) const {
  const auto behind = std::ranges::upper_bound(statements_, offset, {}, &StatementPlace::begin);
  return behind == statements_.begin() ? nullptr : &*std::prev(behind);
}

const Comment* ProgramIndex::CommentAt(std::size_t offset) const {
  const auto behind = std::ranges::lower_bound(comments_, offset, {}, &Comment::begin);
  if (behind == comments_.begin()) return nullptr;
  const Comment& comment = *std::prev(behind);
  return offset <= comment.end ? &comment : nullptr;
}

const Use* ProgramIndex::FindLabel(int number) const {
  const auto found = std::ranges::find_if(
      uses_, [&](const Use& use) { return use.kind == UseKind::kLabel && use.number == number; });
  return found == uses_.end() ? nullptr : &*found;
}

const Declaration* ProgramIndex::FindDeclaration(NameKey key) const {
  const auto found = std::ranges::find(declarations_, key, &Declaration::key);
  return found == declarations_.end() ? nullptr : &*found;
}

std::uint32_t ProgramIndex::StepOfLabel(const Use& label) const {
  for (std::size_t s = label.statement; s < statements_.size(); ++s) {
    if (statements_[s].step > 0) return statements_[s].step;
  }
  return steps_ + 1;
}

const ProcessUse* ProcessOf(const ProgramIndex& index, const StatementPlace& statement) {
  const auto number = static_cast<std::uint32_t>(&statement - index.statements().data());
  const auto found =
      std::ranges::lower_bound(index.processes(), number, {}, &ProcessUse::statement);
  return found != index.processes().end() && found->statement == number ? &*found : nullptr;
}

}  // namespace rmlcell::optimo::editing
