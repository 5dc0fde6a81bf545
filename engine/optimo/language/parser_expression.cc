#include <string>

#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/parser.h"
#include "engine/optimo/language/priority.h"

namespace rmlcell::optimo {
namespace {

Node BinaryNode(const Token& token) {
  switch (token.kind) {
    case TokenKind::kPower:
      return Node::kPower;
    case TokenKind::kTimes:
      return Node::kMultiply;
    case TokenKind::kSlash:
      return Node::kDivide;
    case TokenKind::kPlus:
      return Node::kAdd;
    case TokenKind::kMinus:
      return Node::kSubtract;
    case TokenKind::kLess:
      return Node::kLess;
    case TokenKind::kLessEqual:
      return Node::kLessEqual;
    case TokenKind::kEqual:
      return Node::kEqual;
    case TokenKind::kGreaterEqual:
      return Node::kGreaterEqual;
    case TokenKind::kGreater:
      return Node::kGreater;
    case TokenKind::kNotEqual:
      return Node::kNotEqual;
    default:
      break;
  }
  switch (token.word) {
    case Word::kMod:
      return Node::kMod;
    case Word::kAnd:
      return Node::kAnd;
    case Word::kXor:
      return Node::kXor;
    default:
      return Node::kOr;
  }
}

Node FunctionNode(Word word) {
  switch (word) {
    case Word::kSin:
      return Node::kSin;
    case Word::kCos:
      return Node::kCos;
    case Word::kTan:
      return Node::kTan;
    case Word::kAsin:
      return Node::kAsin;
    case Word::kAcos:
      return Node::kAcos;
    case Word::kAtan:
      return Node::kAtan;
    case Word::kSqrt:
      return Node::kSqrt;
    case Word::kExp:
      return Node::kExp;
    case Word::kLn:
      return Node::kLn;
    case Word::kLog:
      return Node::kLog;
    case Word::kAbs:
      return Node::kAbs;
    default:
      return Node::kInt;
  }
}

VariableGroup GroupOf(Word word) {
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
    default:
      return VariableGroup::kPar;
  }
}

constexpr std::string_view kValueExpected = "a number, a variable, a name or '('";

}  // namespace

// Appends a node; what else it has is set by the caller.
ExprNode& Parser::Emit(Node op, std::uint32_t offset, std::uint32_t length) {
  if (places_ == Places::kNodes) program_.node_places.push_back({offset, length});
  return module_.nodes.emplace_back(ExprNode{.op = op});
}

// [ "-" ] number with nothing behind that could join it: nearly every value of a program that a CAD
// system wrote. Spares it the walk through the levels.
bool Parser::IsNumberAlone() {
  const std::size_t sign = Is(TokenKind::kMinus) ? 1 : 0;
  if (Peek(sign).kind != TokenKind::kNumber) return false;
  const TokenKind next = Peek(sign + 1).kind;
  return next == TokenKind::kComma || next == TokenKind::kClose || next == TokenKind::kEnd;
}

bool Parser::ParseExpression() {
  if (IsNumberAlone()) {
    const Token sign = Peek();
    if (!ParseLiteral(TryTake(TokenKind::kMinus), sign)) return false;
  } else if (!ParseBinary(kOrLevel)) {
    return false;
  }
  module_.EndExpression();
  return true;
}

bool Parser::ParseParenthesised() {
  return Expect(TokenKind::kOpen, "'('") && ParseExpression() && Expect(TokenKind::kClose, "')'");
}

// list := "(" expr { "," expr } ")". With slash_after = n, a "/" may stand behind the n-th value
// (TCP). Keeps the first keep_max values; count is that of all.
bool Parser::ParseList(int& count, int keep_max, int slash_after) {
  count = 0;
  if (!Expect(TokenKind::kOpen, "'('")) return false;
  if (TryTake(TokenKind::kClose)) return true;
  const bool outer = slash_separates_;
  slash_separates_ = slash_after > 0;
  do {
    if (!ParseExpression()) return false;
    if (++count > keep_max)
      DropExpressions(static_cast<std::uint32_t>(module_.expression_ends.size()) - 1);
    if (slash_separates_ && TryTake(TokenKind::kSlash)) {
      if (count == slash_after) continue;
      count = -1;   // the wrong number of values, OPT-B.85
      return true;  // the caller reports it
    }
    if (!TryTake(TokenKind::kComma)) break;
  } while (true);
  slash_separates_ = outer;
  return Expect(TokenKind::kClose, "',' or ')'");
}

int Parser::LevelOf(const Token& token) const {
  switch (token.kind) {
    case TokenKind::kPower:
      return kPowerLevel;
    case TokenKind::kTimes:
    case TokenKind::kSlash:
      return kTermLevel;
    case TokenKind::kPlus:
    case TokenKind::kMinus:
      return kSumLevel;
    case TokenKind::kLess:
    case TokenKind::kLessEqual:
    case TokenKind::kEqual:
    case TokenKind::kGreaterEqual:
    case TokenKind::kGreater:
    case TokenKind::kNotEqual:
      return kRelationLevel;
    case TokenKind::kWord:
      break;
    default:
      return kNoLevel;
  }
  switch (token.word) {
    case Word::kMod:
      return kTermLevel;
    case Word::kAnd:
      return kAndLevel;
    case Word::kOr:
    case Word::kXor:
      return kOrLevel;
    default:
      return kNoLevel;
  }
}

// A "/" before an attribute word ends the expression; otherwise it divides. OPT-B.85
bool Parser::EndsExpression(const Token& slash_follower) const {
  if (slash_separates_) return true;
  if (slash_follower.kind != TokenKind::kWord || slash_follower.word == Word::kNone) return false;
  const WordGroup group = Describe(slash_follower.word).group;
  return group == WordGroup::kAttribute || slash_follower.word == Word::kOn ||
         slash_follower.word == Word::kOff || slash_follower.word == Word::kClock ||
         slash_follower.word == Word::kIntr;
}

// expr, xorterm, notterm, relation, sum, term and power of the grammar: operators of at least
// `level`, from the left; relations do not chain (OPT-B.43).
bool Parser::ParseBinary(int level) {
  if (TakeWord(Word::kNot)) {
    const Token word = lexer_.At(at_ - 1);
    if (level > kNotLevel)
      return FailAt(word, ErrorCode::kSyntax, "NOT needs parentheses here", "OPT-7.87");
    int count = 1;
    while (TakeWord(Word::kNot)) ++count;
    if (!ParseBinary(kRelationLevel)) return false;
    for (; count > 0; --count) Emit(Node::kNot, word.offset, word.length);
  } else if (!ParseSigned()) {
    return false;
  }
  bool compared = false;
  while (true) {
    const Token& next = Peek();
    const int found = LevelOf(next);
    if (found == kNoLevel || found < level) return true;
    if (next.kind == TokenKind::kSlash && EndsExpression(Peek(1))) return true;
    const Token op = Take();
    if (found == kRelationLevel) {
      if (compared)
        return FailAt(op, ErrorCode::kSyntax, "a comparison cannot follow another; use parentheses",
                      "OPT-B.43");
      compared = true;
    }
    if (!ParseBinary(found + 1)) return false;
    Emit(BinaryNode(op), op.offset, op.length);
  }
}

// signed := { "+" | "-" } primary. A sign before a literal is part of it (OPT-7.73, OPT-B.40).
bool Parser::ParseSigned() {
  bool negative = false;
  Token sign;
  while (Is(TokenKind::kMinus) || Is(TokenKind::kPlus)) {
    const Token token = Take();
    if (token.kind == TokenKind::kPlus) continue;
    if (sign.kind == TokenKind::kEnd) sign = token;
    negative = !negative;
  }
  return ParsePrimary(negative, sign);
}

bool Parser::ParsePrimary(bool negative, const Token& sign) {
  const Token& next = Peek();
  if (next.kind == TokenKind::kNumber) return ParseLiteral(negative, sign);
  if (next.kind == TokenKind::kOpen) {
    if (nesting_ >= kNestingMax)
      return FailAt(next, ErrorCode::kSyntax, "parentheses are nested too deep");
    ++nesting_;
    Take();
    const bool outer = slash_separates_;
    slash_separates_ = false;
    if (!ParseBinary(kOrLevel) || !Expect(TokenKind::kClose, "')'")) return false;
    slash_separates_ = outer;
    --nesting_;
  } else if (next.kind == TokenKind::kWord) {
    const Token word = next;
    const WordGroup group = word.word == Word::kNone || IsNameOfRefused(word, Peek(1))
                                ? WordGroup::kNone
                                : Describe(word.word).group;
    if (group == WordGroup::kVariable) {
      if (!ParseVariable()) return false;
    } else if (group == WordGroup::kNone) {
      Take();
      Emit(Node::kName, word.offset, word.length).name = InternName(word);
    } else if (group == WordGroup::kConstant) {
      Take();
      const bool pi = word.word == Word::kPi;
      const bool on = word.word == Word::kOn || word.word == Word::kTrue || word.word == Word::kYes;
      Emit(pi ? Node::kPi : Node::kLogical, word.offset, word.length).number =
          pi ? kPiLanguage : (on ? 1.0F : 0.0F);
    } else if (group == WordGroup::kFunction) {
      if (nesting_ >= kNestingMax)
        return FailAt(word, ErrorCode::kSyntax, "functions are nested too deep");
      ++nesting_;
      Take();
      const bool outer = slash_separates_;
      slash_separates_ = false;
      if (!Expect(TokenKind::kOpen, "'(' and the argument") || !ParseBinary(kOrLevel) ||
          !Expect(TokenKind::kClose, "')'")) {
        return false;
      }
      slash_separates_ = outer;
      --nesting_;
      Emit(FunctionNode(word.word), word.offset, word.length);
    } else if (group == WordGroup::kUnavailable) {
      return FailAt(word, ErrorCode::kWordUnavailable,
                    Quoted(word) + " is not available on the Optimo", Describe(word.word).rule);
    } else {
      return Fail(kValueExpected);
    }
  } else {
    return Fail(kValueExpected);
  }
  if (negative) Negate(sign);
  return true;
}

// The value that ends before the next token. A number in parentheses is a literal as one without
// them is: the canonical text has none, and must mean the same (OPT-1.06, OPT-B.40).
void Parser::Negate(const Token& sign) {
  ExprNode& value = module_.nodes.back();
  if (!IsLiteral(value)) {
    Emit(Node::kNegate, sign.offset, sign.length);
    return;
  }
  value = NegatedLiteral(value);
  const Token& last = lexer_.At(at_ - 1);
  if (places_ == Places::kNodes)
    program_.node_places.back() = {sign.offset, last.offset + last.length - sign.offset};
}

bool Parser::ParseLiteral(bool negative, const Token& sign) {
  const Token token = Take();
  if (token.too_large) {
    Report(token, ErrorCode::kLiteralRange, "REAL numbers reach to 9.2E18", "OPT-7.62");
  }
  const Token& next = Peek();
  if (next.kind == TokenKind::kWord && next.joined) {
    // "5THEN" is two words; "0x5" and "5E" are no numbers. OPT-B.42
    const bool infix =
        next.word != Word::kNone && (Describe(next.word).group == WordGroup::kOperator ||
                                     Describe(next.word).group == WordGroup::kFlow);
    if (!infix) return FailAt(token, ErrorCode::kBadNumber, "letters in a number", "OPT-B.42");
  }
  const std::uint32_t offset = negative ? sign.offset : token.offset;
  const int limit = negative ? -kIntegerMin : kIntegerMax;
  const bool integer = token.whole && token.digits <= static_cast<std::uint32_t>(limit);
  Emit(integer ? Node::kInteger : Node::kReal, offset, token.offset + token.length - offset)
      .number = negative && token.number != 0.0F ? -token.number : token.number;
  return true;
}

// variable := group "[" (integer | name) "]"                                    OPT-7.59, OPT-7.60
bool Parser::ParseVariable() {
  const Token group = Take();
  ExprNode node;
  node.op = Node::kVariable;
  node.group = GroupOf(group.word);
  if (!Expect(TokenKind::kOpenIndex, "'[' and an index")) return false;
  const int max = node.group == VariableGroup::kPar ? kParameterCount - 1 : kVariableIndexMax;
  const Token index = Take();
  const bool name =
      index.kind == TokenKind::kWord && (index.word == Word::kNone || IsRefused(index));
  if (name && Is(TokenKind::kCloseIndex)) {
    node.index_name = InternName(index);
  } else if (index.kind == TokenKind::kNumber && index.whole && Is(TokenKind::kCloseIndex)) {
    if (index.digits > static_cast<std::uint32_t>(max)) {
      return FailAt(index, ErrorCode::kIndexRange,
                    "index " + Told("index", index.digits, {}, std::string(lexer_.TextOf(index))) +
                        " is outside 0.." + Told("most", max),
                    "OPT-7.59");
    }
    node.index = static_cast<std::uint8_t>(index.digits);
  } else if (index.kind == TokenKind::kEnd || index.kind == TokenKind::kCloseIndex ||
             index.kind == TokenKind::kBadCharacter || index.kind == TokenKind::kBadNumber) {
    --at_;
    return Fail("an index");
  } else if (index.kind == TokenKind::kNumber && index.whole) {
    return Fail("']'");
  } else {
    return FailAt(index, ErrorCode::kIndexRange,
                  "an index is a number or the name of an INTEGER constant", "OPT-7.60");
  }
  const Token close = Take();
  Emit(Node::kVariable, group.offset, close.offset + close.length - group.offset) = node;
  return true;
}

// A DECLARE of this reserved word was refused, and here it stands where only a name can.
bool Parser::IsNameOfRefused(const Token& word, const Token& next) const {
  return IsRefused(word) && next.kind != TokenKind::kOpenIndex && next.kind != TokenKind::kOpen;
}

bool Parser::ParseTarget(std::string_view expected) {
  const Token& next = Peek();
  if (next.kind != TokenKind::kWord) return Fail(expected);
  if (next.word == Word::kNone || IsNameOfRefused(next, Peek(1))) {
    const Token name = Take();
    Emit(Node::kName, name.offset, name.length).name = InternName(name);
  } else if (Describe(next.word).group == WordGroup::kVariable) {
    if (!ParseVariable()) return false;
  } else {
    return Fail(expected);
  }
  module_.EndExpression();
  return true;
}

// label := 1 to 4 digits                                                        OPT-1.23
bool Parser::ParseJumpLabel() {
  if (!Is(TokenKind::kNumber) || !Peek().whole) return Fail("a sequence number");
  const Token token = Take();
  if (token.length > 4) {
    return FailAt(token, ErrorCode::kLabelRange, "sequence numbers go from 0 to 9999", "OPT-1.23");
  }
  module_.targets.push_back(static_cast<std::uint16_t>(token.digits));
  static_assert(kStatementTokensMax / 2 < 0xFFFF, "counted with 16 bits");
  ++instruction_.target_count;
  return true;
}

// A whole number without sign, for counts and steps; larger ones saturate and fail the range check.
bool Parser::ParseWhole(std::string_view what, std::uint16_t& value) {
  if (!Is(TokenKind::kNumber) || !Peek().whole) return Fail(what);
  value = static_cast<std::uint16_t>(std::min<std::uint32_t>(Take().digits, 0xFFFF));
  return true;
}

}  // namespace rmlcell::optimo
