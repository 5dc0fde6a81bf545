#include "engine/optimo/language/parser.h"

#include <algorithm>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/hex.h"
#include "engine/optimo/language/nearest_word.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kNamesMax = kNoName;                   // names have 16-bit numbers
constexpr std::size_t kQuotedMax = 40;                       // of a token in a message
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // what some editors put before UTF-8

}  // namespace

Parser::Parser(std::string_view text, ParsedProgram& program, Findings& findings, Places places)
    : text_(text),
      program_(program),
      module_(program.module),
      findings_(findings),
      places_(places),
      lexer_(text, program.comments) {}

// Room for what a text of this size most likely holds, so that large programs are not copied while
// they grow. Untouched room costs no memory; the bound keeps it small for a text that is mostly
// comment.
void Parser::Reserve() {
  constexpr std::size_t kElementsMax = std::size_t{1} << 23;
  const auto line_ends = static_cast<std::size_t>(std::ranges::count(text_, '\n'));
  const std::size_t instructions = std::min(line_ends + 1, kElementsMax);
  const std::size_t values = std::min(text_.size() / 7, kElementsMax);
  module_.instructions.reserve(instructions);
  program_.statements.reserve(instructions);
  module_.expression_ends.reserve(values);
  module_.nodes.reserve(values);
  if (places_ == Places::kNodes) program_.node_places.reserve(values);
}

void Parser::Run() {
  Reserve();
  while (lexer_.NextStatement()) ParseStatement();
  module_.end_labels = pending_labels_;
  program_.end_label_places = pending_label_places_;
  module_.step_count = steps_;
  program_.tokens_read = lexer_.tokens_read();
}

// line := [ label ] [ statement ]                                               OPT-1.27
void Parser::ParseStatement() {
  at_ = 0;
  nesting_ = 0;
  slash_separates_ = false;
  first_ = Peek();
  instruction_ = Instruction{};
  instruction_.step = steps_ + 1;  // that a sequence number leads to, here or on a later line
  labelled_ = first_.kind == TokenKind::kNumber;
  if (labelled_) {
    const Token label = Take();
    // What is said of the number belongs to the instruction that it leads to (OPT-1.27).
    instruction_.step = Peek().word == Word::kDeclare ? 0 : steps_ + 1;
    const bool added = AddLabel(label);
    if (Is(TokenKind::kEnd)) return;
    if (!added)
      program_.mislabelled.push_back(static_cast<std::uint32_t>(module_.instructions.size()));
    first_ = Peek();
  }
  instruction_ = Instruction{};
  instruction_.first_expression = static_cast<std::uint32_t>(module_.expression_ends.size());
  instruction_.first_target = static_cast<std::uint32_t>(module_.targets.size());
  attribute_parts_.clear();
  const std::uint64_t errors = findings_.error_count();
  nameless_ = false;
  const bool rest_of_if = std::exchange(broken_if_, false) &&
                          (first_.word == Word::kThen || first_.word == Word::kElse);
  const bool steps = first_.word != Word::kDeclare && !rest_of_if;
  if (steps) ++steps_;
  instruction_.step = steps ? steps_ : 0;

  const WordGroup group = first_.kind != TokenKind::kWord || first_.word == Word::kNone
                              ? WordGroup::kNone
                              : Describe(first_.word).group;
  bool good = false;
  if (rest_of_if) {
    broken_if_ = true;  // reported where the IF stopped
  } else if (first_.kind == TokenKind::kWord &&
             (group == WordGroup::kNone || group == WordGroup::kVariable ||
              (IsRefused(first_) && Peek(1).kind == TokenKind::kEqual))) {
    good = ParseAssignment(false);
  } else if (group == WordGroup::kInstruction) {
    good = ParseInstruction(first_.word);
  } else if (group == WordGroup::kIgnored) {
    ParseIgnored(first_.word);
    good = true;
  } else if (group == WordGroup::kUnavailable) {
    FailAt(first_, ErrorCode::kWordUnavailable, Quoted(first_) + " is not available on the Optimo",
           Describe(first_.word).rule);
  } else {
    Fail("an instruction");
  }
  if (good && instruction_.op != Op::kIgnored) {
    good = ParseAttributes();
    if (good && !Is(TokenKind::kEnd)) good = Fail("the end of the statement");
  }
  if (!good) DropStatement();
  if (good && instruction_.op == Op::kDeclare) {
    declared_[instruction_.name] = true;
    declared_names_.push_back(instruction_.name);
  }
  if (good && (findings_.error_count() != errors || nameless_))
    program_.faulty.push_back(static_cast<std::uint32_t>(module_.instructions.size()));
  FinishStatement(good);
}

// Nothing of it stays but its step; what uses a name that it was to declare is spared a second
// error.
void Parser::DropStatement() {
  broken_if_ = broken_if_ || instruction_.op == Op::kIf;
  DropExpressions(instruction_.first_expression);
  module_.targets.resize(instruction_.first_target);
  const bool named = instruction_.op == Op::kDeclare && instruction_.name != kNoName &&
                     !declared_[instruction_.name];
  if (named) program_.broken_names[instruction_.name] = true;
  if (instruction_.op == Op::kDefine && instruction_.numbers[0] < kParameterCount)
    program_.broken_parameters.set(instruction_.numbers[0]);
  const std::uint32_t step = instruction_.step;
  instruction_ = Instruction{};
  instruction_.step = step;
  instruction_.first_expression = static_cast<std::uint32_t>(module_.expression_ends.size());
  instruction_.first_target = static_cast<std::uint32_t>(module_.targets.size());
}

void Parser::FinishStatement(bool good) {
  if (good && !std::ranges::is_sorted(attribute_parts_, {}, &AttributePart::attribute))
    OrderAttributeParts();
  instruction_.first_label = static_cast<std::uint32_t>(module_.labels.size());
  instruction_.label_count = static_cast<std::uint16_t>(pending_labels_.size());
  if (!pending_labels_.empty()) {
    module_.labels.insert(module_.labels.end(), pending_labels_.begin(), pending_labels_.end());
    program_.label_places.insert(program_.label_places.end(), pending_label_places_.begin(),
                                 pending_label_places_.end());
    pending_labels_.clear();
    pending_label_places_.clear();
  }
  module_.instructions.push_back(instruction_);
  const Token& end = at_ > 0 ? lexer_.At(at_ - 1) : first_;
  const std::uint32_t behind = end.kind == TokenKind::kEnd ? end.offset : end.offset + end.length;
  program_.statements.push_back({first_.offset, std::max(behind, first_.offset + first_.length),
                                 static_cast<std::uint32_t>(at_) - (labelled_ ? 1U : 0U)});
}

// Attributes stand in any order in the text and in one order in the module. OPT-2.43
void Parser::OrderAttributeParts() {
  std::ranges::stable_sort(attribute_parts_, {}, &AttributePart::attribute);
  const std::uint32_t base = instruction_.first_expression + instruction_.value_count;
  const std::uint32_t begin = module_.FirstNode(base);
  std::vector<ExprNode> nodes;
  std::vector<NodePlace> places;
  std::vector<std::uint32_t> ends;
  for (const AttributePart& part : attribute_parts_) {
    for (std::uint32_t e = part.first; e < part.first + part.count; ++e) {
      for (std::uint32_t n = module_.FirstNode(e); n < module_.expression_ends[e]; ++n) {
        nodes.push_back(module_.nodes[n]);
        if (places_ == Places::kNodes) places.push_back(program_.node_places[n]);
      }
      ends.push_back(begin + static_cast<std::uint32_t>(nodes.size()));
    }
  }
  std::ranges::copy(nodes, module_.nodes.begin() + begin);
  std::ranges::copy(ends, module_.expression_ends.begin() + base);
  if (places_ == Places::kNodes) std::ranges::copy(places, program_.node_places.begin() + begin);
}

void Parser::DropExpressions(std::uint32_t expressions) {
  const std::uint32_t nodes = module_.FirstNode(expressions);
  module_.expression_ends.resize(expressions);
  module_.nodes.resize(nodes);
  if (places_ == Places::kNodes) program_.node_places.resize(nodes);
}

bool Parser::AddLabel(const Token& token) {
  if (token.length > 4) {
    Report(token, ErrorCode::kLabelRange, "sequence numbers go from 0 to 9999", "OPT-1.23");
    return false;
  }
  std::uint32_t& line = label_line_[token.digits];
  if (line != 0) {
    Report(token, ErrorCode::kLabelDuplicate,
           "sequence number " + Told("label", token.digits) + " stands on line " +
               Told("line", line) + " already",
           "OPT-1.25");
    return false;
  }
  line = lexer_.line();
  pending_labels_.push_back(static_cast<std::uint16_t>(token.digits));
  pending_label_places_.push_back({token.offset, token.length});
  return true;
}

// [ "LET" ] target "=" expr                                                     OPT-7.91
bool Parser::ParseAssignment(bool after_let) {
  instruction_.op = Op::kLet;
  const Token target = Peek();
  const Token next = Peek(1);
  if (next.kind == TokenKind::kBadCharacter && next.joined) {  // X_1, OPT-7.45
    Take();
    return Fail("'='");
  }
  if (!after_let && target.word == Word::kNone && next.kind != TokenKind::kEqual) {
    const auto known = names_.find(target.key);
    if (known == names_.end() || !declared_[known->second]) return FailUnknown(target);
  }
  return ParseOperands();
}

std::string IgnoredText(Word word, std::string_view rest) {
  std::string text(Describe(word).text);
  bool blank = true;
  for (const char c : rest) {
    const bool is_blank = c == ' ' || c == '\t';
    if (!is_blank) {
      if (blank) text += ' ';
      text += c >= 'a' && c <= 'z' ? static_cast<char>(c - ('a' - 'A')) : c;
    }
    blank = is_blank;
  }
  return text;
}

// The words that are accepted without effect; what follows on the line is kept and not examined.
void Parser::ParseIgnored(Word word) {
  instruction_.op = Op::kIgnored;
  Take();
  std::string text = IgnoredText(word, lexer_.RestOfLine(first_));
  if (module_.texts.size() >= kNamesMax) {
    ReportStatement(ErrorCode::kObjectTooLong,
                    "more instructions without effect than an object can hold");
    instruction_.name = 0;
    return;
  }
  instruction_.name = static_cast<std::uint16_t>(module_.texts.size());
  module_.texts.push_back(std::move(text));
}

// Would the statement be right with `text` in place of this word, its first?
bool Parser::IsRightWith(const Token& word, std::string_view text) const {
  constexpr std::size_t kBytesMax = 2000;  // what is longer is left to the programmer
  std::string repaired(text);
  repaired += text_.substr(word.offset + word.length, kBytesMax);
  std::vector<Comment> comments;
  Lexer lexer(repaired, comments);
  if (!lexer.NextStatement()) return false;
  std::size_t count = 1;
  while (lexer.At(count).kind != TokenKind::kEnd) ++count;
  const Token last = lexer.At(count - 1);
  const std::size_t end = last.offset + last.length;
  if (end >= kBytesMax) return false;
  Findings none(0);
  const ParsedProgram program =
      Parse(std::string_view(repaired).substr(0, end), none, Places::kStatements);
  return none.error_count() == 0 && program.statements.size() == 1;
}

// GOTO10: where the digits behind the word of an instruction begin, if a blank there makes it
// right.
std::optional<std::uint32_t> Parser::MissingBlank(const Token& name) const {
  const std::string_view text = lexer_.TextOf(name);
  const std::size_t letters = text.find_last_not_of("0123456789") + 1;
  if (letters == text.size() || letters > kNameLength) return std::nullopt;
  if (OpOf(FindWord(PackName(text.substr(0, letters)))) == Op::kInvalid) return std::nullopt;
  std::string apart(text);
  apart.insert(letters, " ");
  if (!IsRightWith(name, apart)) return std::nullopt;
  return static_cast<std::uint32_t>(letters);
}

// The nearest instruction words or declared names are proposed, and put in place when it is sure
// what was meant. OPT-7.91
bool Parser::FailUnknown(const Token& name) {
  if (findings_.full()) return FailAt(name, ErrorCode::kNameUndeclared, {});
  Detail detail = Quoted(name, "name") + " is no instruction and no declared name";
  std::vector<Fix> fixes;
  if (const auto blank = MissingBlank(name)) {
    detail += "; a blank is missing before its digits";
    fixes.push_back({name.offset + *blank, 0, " "});
  } else {
    std::vector<std::string_view> candidates;
    for (const WordInfo& row : ReservedWords()) {
      if (row.group == WordGroup::kInstruction || row.group == WordGroup::kIgnored)
        candidates.push_back(row.text);
    }
    const NameCandidates names(module_, declared_names_);
    names.AppendTo(candidates);
    const NearWords near = NearestWords(lexer_.TextOf(name), candidates);
    detail += QuestionFor(near);
    if (std::ranges::find(near.words, Describe(Word::kDeclare).text) != near.words.end())
      MarkBroken();
    // Not for a word without effect, nor for a name, behind which no '=' stands.
    const bool sure = (near.IsSingle(Slip::kOneLetter) || near.IsSingle(Slip::kSwap)) &&
                      OpOf(FindWord(PackName(near.words.front()))) != Op::kInvalid;
    if (sure && IsRightWith(name, near.words.front()))
      fixes.push_back({name.offset, static_cast<int>(name.length), near.words.front()});
  }
  findings_.Add(ErrorCode::kNameUndeclared, PlaceOf(name), std::move(detail), "OPT-7.91",
                std::move(fixes));
  return false;
}

// The name behind a mistyped DECLARE.
void Parser::MarkBroken() {
  const Token name = Peek(1);
  if (name.kind != TokenKind::kWord || name.word != Word::kNone) return;
  if (Peek(2).kind == TokenKind::kEqual) program_.broken_names[InternName(name)] = true;
}

std::uint16_t Parser::InternName(const Token& token) {
  const auto [entry, added] =
      names_.try_emplace(token.key, static_cast<std::uint16_t>(module_.names.size()));
  if (added) {
    if (module_.names.size() >= kNamesMax) {
      names_.erase(entry);
      if (!std::exchange(too_many_names_, true)) {
        Report(token, ErrorCode::kObjectTooLong, "more names than an object can hold");
      }
      nameless_ = true;
      return 0;
    }
    module_.names.push_back({.key = token.key, .declared = false, .value = {}});
    declared_.push_back(false);
    program_.broken_names.push_back(IsRefused(token));
    long_form_reported_.push_back(false);
  }
  const std::uint16_t name = entry->second;
  // Of a name that nobody declared there is more to say than that it is long.
  const bool known = declared_[name] || instruction_.op == Op::kDeclare;
  if (token.length > kNameLength && known && !long_form_reported_[name]) {
    long_form_reported_[name] = true;
    char room[kNameLength];
    findings_.Add(
        ErrorCode::kNameTruncated, PlaceOf(token),
        Quoted(token, "name") + " counts as " + Told("counts_as", UnpackName(token.key, room)),
        "OPT-7.46");
  }
  return name;
}

bool Parser::Fail(std::string_view expected) {
  const Token token = Peek();
  if (BeginsStatement(token))
    return FailAt(token, ErrorCode::kSyntax, "expected " + Told("expected", expected));
  switch (token.kind) {
    case TokenKind::kEnd:
      if (lexer_.unfinished()) {
        return FailAt(token, ErrorCode::kUnexpectedEnd,
                      "expected " + Told("expected", expected) + " before the end of the text");
      }
      return FailAt(token, ErrorCode::kSyntax, "expected " + Told("expected", expected));
    case TokenKind::kBadCharacter:
      if (token.offset == 0 && lexer_.TextOf(token).starts_with(kByteOrderMark)) {
        findings_.Add(ErrorCode::kBadCharacter, PlaceOf(token),
                      "a byte order mark stands before the text", "OPT-1.32",
                      {{0, static_cast<int>(kByteOrderMark.size()), ""}});
        return false;
      }
      return FailAt(token, ErrorCode::kBadCharacter, Quoted(token) + " cannot stand here",
                    "OPT-1.32");
    case TokenKind::kBadNumber:
      return FailAt(token, ErrorCode::kBadNumber, Quoted(token) + " is no number", "OPT-B.42");
    case TokenKind::kTooLong:
      return FailAt(token, ErrorCode::kSyntax, "the statement is too long");
    case TokenKind::kWord:
      if (token.word != Word::kNone && Describe(token.word).group == WordGroup::kUnavailable) {
        return FailAt(token, ErrorCode::kWordUnavailable,
                      Quoted(token) + " is not available on the Optimo", Describe(token.word).rule);
      }
      break;
    default:
      break;
  }
  return FailAt(token, ErrorCode::kSyntax,
                "expected " + Told("expected", expected) + ", found " + Quoted(token, "found"));
}

bool Parser::FailAt(const Token& token, ErrorCode code, Detail detail, std::string_view rule) {
  if (!BeginsStatement(token)) {
    Report(token, code, std::move(detail), rule);
    return false;
  }
  // What is missing is missing before the line that it stands on.
  const Token& last = lexer_.At(at_ - 1);
  findings_.Add(code, {last.offset + last.length, 0, static_cast<int>(instruction_.step)},
                std::move(detail), rule);
  lexer_.ResumeAt(token);
  return false;
}

// The line may be a statement of its own behind one that forgot a parenthesis.
bool Parser::BeginsStatement(const Token& token) const {
  return token.first_on_line && token.offset > first_.offset &&
         lexer_.BeginsAssignment(token.offset);
}

void Parser::Report(const Token& token, ErrorCode code, Detail detail, std::string_view rule) {
  findings_.Add(code, PlaceOf(token), std::move(detail), rule);
}

void Parser::ReportStatement(ErrorCode code, Detail detail, std::string_view rule) {
  Report(first_, code, std::move(detail), rule);
}

Place Parser::PlaceOf(const Token& token) const {
  return {token.offset, static_cast<int>(token.length), static_cast<int>(instruction_.step)};
}

Detail Parser::Quoted(const Token& token, std::string_view name) const {
  std::string text;
  for (const char c : lexer_.TextOf(token).substr(0, kQuotedMax)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) {
      text += c;
    } else {
      text += "\\x" + HexByte(c);
    }
  }
  return "'" + Told(name, text) + (token.length > kQuotedMax ? "...'" : "'");
}

Place ParsedProgram::At(const Instruction& instruction) const {
  const Statement& statement =
      statements[static_cast<std::size_t>(&instruction - module.instructions.data())];
  return {statement.begin, static_cast<int>(statement.end - statement.begin),
          static_cast<int>(instruction.step)};
}

std::string_view ParsedProgram::TextOf(const Instruction& instruction) const {
  const Place place = At(instruction);
  return text.substr(static_cast<std::size_t>(place.offset),
                     static_cast<std::size_t>(place.length));
}

std::vector<NodePlace> ParsedProgram::NodePlacesOf(const Instruction& instruction) const {
  const std::uint32_t count = module.ExpressionCount(instruction);
  if (count == 0) return {};
  const std::uint32_t first = module.FirstNode(instruction.first_expression);
  const std::uint32_t last = module.expression_ends[instruction.first_expression + count - 1];
  if (!node_places.empty()) return {node_places.begin() + first, node_places.begin() + last};
  // A statement reads the same by itself: what it means depends on others, where its parts stand
  // does not.
  Findings none(0);
  std::vector<NodePlace> places = Parse(TextOf(instruction), none, Places::kNodes).node_places;
  RMLCELL_CHECK(places.size() == last - first);
  for (NodePlace& place : places)
    place.offset += static_cast<std::uint32_t>(At(instruction).offset);
  return places;
}

ParsedProgram Parse(std::string_view text, Findings& findings, Places places) {
  ParsedProgram program;
  text = text.substr(0, text.find('\x1A'));
  if (text.size() > kSourceBytesMax) {
    findings.Add(ErrorCode::kCellTooLarge, {}, "a program has at most 1 GiB");
    return program;
  }
  program.text = text;
  Parser(text, program, findings, places).Run();
  return program;
}

}  // namespace rmlcell::optimo
