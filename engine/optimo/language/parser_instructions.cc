#include <algorithm>
#include <string>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/optimo/language/nearest_word.h"
#include "engine/optimo/language/parser.h"

namespace rmlcell::optimo {
namespace {

Detail CountText(const Detail& what, int count, std::string_view needed) {
  const auto number = ParseInteger(needed);
  return what + " has " + Told("values", count) + (count == 1 ? " value" : " values") + ", needs " +
         (number ? Told("needed", *number) : Told("needed", needed));
}

}  // namespace

bool Parser::ParseInstruction(Word word) {
  Take();
  instruction_.op = OpOf(word);
  switch (instruction_.op) {
    case Op::kPath:
      return ParsePath();
    case Op::kTcp:
      return ParseTcp();
    case Op::kWorkdef:
      return ParseWorkdef();
    case Op::kWork:
      return ParseProcess();
    case Op::kCall:
      return ParseCall();
    case Op::kFunction:
      return ParseFunction();
    case Op::kGoto:
      return ParseGoto();
    case Op::kTimer:
      return ParseTimer();
    case Op::kLet:
      return ParseAssignment(true);
    case Op::kDeclare:
      return ParseDeclare();
    case Op::kDefine:
      return ParseDefine();
    default:
      return ParseOperands();
  }
}

// By the rows of operands.h; the instructions above say more about what is wrong.
bool Parser::ParseOperands() {
  std::size_t number = 0;
  for (const Operand& operand : Describe(instruction_.op).operands) {
    if (operand.optional && !Begins(operand)) {
      if (operand.kind == Operand::Kind::kGroups) instruction_.choice = kAllGroups;
      return true;
    }
    if (!ParseOperand(operand, number)) return false;
  }
  return true;
}

// A fixed text of the rows is one token: a word, or a sign with blanks around it for people.
bool Parser::IsText(std::string_view text) {
  const std::string_view token = Trimmed(text);
  switch (token.front()) {
    case ',':
      return Is(TokenKind::kComma);
    case '(':
      return Is(TokenKind::kOpen);
    case ')':
      return Is(TokenKind::kClose);
    case '=':
      return Is(TokenKind::kEqual);
    case '/':
      return Is(TokenKind::kSlash);
    default:
      return Peek().word != Word::kNone && Describe(Peek().word).text == token;
  }
}

bool Parser::Begins(const Operand& operand) {
  switch (operand.kind) {
    case Operand::Kind::kGroups:
      return !Is(TokenKind::kEnd) && !Is(TokenKind::kSlash);
    case Operand::Kind::kText:
      return IsText(operand.text);
    default:
      return Is(TokenKind::kOpen);
  }
}

bool Parser::ParseOperand(const Operand& operand, std::size_t& number) {
  switch (operand.kind) {
    case Operand::Kind::kText:
      if (!IsText(operand.text)) return Fail(operand.missing);
      Take();
      return true;
    case Operand::Kind::kList:
      return ParseCountedList(operand);
    case Operand::Kind::kNumber:
      return ParseNumber(operand, instruction_.numbers[number++]);
    case Operand::Kind::kChoice:
      return ParseChoice(operand);
    case Operand::Kind::kGroups:
      return ParseGroups();
    case Operand::Kind::kLabel:
      return ParseJumpLabel();
    case Operand::Kind::kLabels:
      do {
        if (!ParseJumpLabel()) return false;
      } while (TryTake(TokenKind::kComma));
      return true;
    case Operand::Kind::kProgram:
      return ParseProgramNumber();
    case Operand::Kind::kVariable:
      ++instruction_.value_count;
      return ParseTarget(operand.missing);
    case Operand::Kind::kBits:
      ++instruction_.value_count;
      return ParseBits(operand);
    default:
      ++instruction_.value_count;
      return ParseExpression();
  }
}

// "MOVE (", "SYSDEF (": all of the values, or a word about how many there are.
bool Parser::ParseCountedList(const Operand& operand) {
  int count = 0;
  if (Is(TokenKind::kOpen) && !ParseList(count, operand.high)) return false;
  if (count < operand.low || count > operand.high) {
    return FailAt(
        first_, ErrorCode::kArgumentCount,
        CountText(Told("instruction", Describe(instruction_.op).name), count, operand.missing),
        operand.rule);
  }
  instruction_.value_count = static_cast<std::uint8_t>(count);
  return true;
}

bool Parser::ParseNumber(const Operand& operand, std::uint16_t& number) {
  const Token token = Peek();
  if (!ParseWhole(operand.missing, number)) return false;
  if (number >= operand.low && number <= operand.high) return true;
  return FailAt(token, ErrorCode::kLiteralRange, std::string(operand.range), operand.rule);
}

bool Parser::ParseChoice(const Operand& operand) {
  for (std::size_t n = 0; n < operand.words.size(); ++n) {
    if (!TakeWord(operand.words[n])) continue;
    instruction_.choice = static_cast<std::uint8_t>(n);
    return true;
  }
  return Fail(operand.missing);
}

// "PATH" ( "PTP" | "LIN" | "CIR" | "HOLE" "(" expr ")" )                        OPT-2.12
bool Parser::ParsePath() {
  if (!ParseChoice(operands::kPath[0])) return false;
  if (instruction_.choice != static_cast<std::uint8_t>(PathType::kHole)) return true;
  instruction_.value_count = 1;
  return ParseParenthesised();
}

// "TCP" "(" three values ( "/" | "," ) three values ")"                         OPT-4.64
bool Parser::ParseTcp() {
  int count = 0;
  if (Is(TokenKind::kOpen) && !ParseList(count, 6, 3)) return false;
  if (count == 6) {
    instruction_.value_count = 6;
    return true;
  }
  return FailAt(
      first_, ErrorCode::kArgumentCount,
      count < 0
          ? Detail(
                "TCP has '/' only between the third and the fourth value; a division needs parentheses")
          : CountText(Told("instruction", "TCP"), count, "6"),
      count < 0 ? "OPT-B.85" : "OPT-4.72");
}

// integer "," integer                                                           OPT-3.01, OPT-3.13
bool Parser::ParseProcess() {
  const Token kind = Peek();
  if (!ParseWhole(operands::kProcess[0].missing, instruction_.numbers[0])) return false;
  if (!Expect(TokenKind::kComma, operands::kProcess[1].missing)) return false;
  const Token process = Peek();
  if (!ParseWhole(operands::kProcess[2].missing, instruction_.numbers[1])) return false;
  if (instruction_.numbers[0] > 2) {
    return FailAt(kind, ErrorCode::kProcessNumber, "the kind of a process is 0, 1 or 2",
                  "OPT-3.02");
  }
  if (instruction_.numbers[1] > 9) {
    return FailAt(process, ErrorCode::kProcessNumber, "process numbers go from 0 to 9", "OPT-3.02");
  }
  return true;
}

bool Parser::ParseWorkdef() {
  if (!ParseProcess()) return false;
  int count = 0;
  const bool comma = TryTake(TokenKind::kComma);
  if (comma && !Is(TokenKind::kOpen)) return Fail("'(' and the parameters");
  if (Is(TokenKind::kOpen)) {
    if (!ParseList(count, 5)) return false;
    if (count == 0)
      return FailAt(first_, ErrorCode::kArgumentCount,
                    CountText(Told("instruction", "WORKDEF"), 0, "some between its parentheses"),
                    "OPT-3.01");
  }
  const int kind = instruction_.numbers[0];
  const bool fits = kind == 0 ? count == 0 : kind == 1 ? count == 4 || count == 5 : count == 1;
  if (!fits) {
    const char* needed = kind == 0   ? "none"
                         : kind == 1 ? "4 or 5: speed, power, delay, peak [, schedule]"
                                     : "1: the laser schedule";
    return FailAt(
        first_, ErrorCode::kArgumentCount,
        CountText(Told("instruction", "WORKDEF") + " " + Told("kind", kind), count, needed),
        kind == 0   ? "OPT-3.03"
        : kind == 1 ? "OPT-3.04"
                    : "OPT-3.06");
  }
  instruction_.value_count = static_cast<std::uint8_t>(count);
  return true;
}

// prog := integer | target                                                      OPT-7.01, OPT-7.07
bool Parser::ParseProgramNumber() {
  instruction_.value_count = 1;
  if (!Is(TokenKind::kNumber)) return ParseTarget(operands::kProgram[0].missing);
  if (!Peek().whole) return Fail("a whole program number");
  if (!ParseLiteral(false, Token{})) return false;
  module_.EndExpression();
  return true;
}

// args := "(" expr { "," expr } ")"                                             OPT-9.20
bool Parser::ParseArguments() {
  if (!Is(TokenKind::kOpen)) return true;
  int count = 0;
  if (!ParseList(count, kParameterCount)) return false;
  if (count == 0) {
    --at_;
    return Fail("a parameter");
  }
  if (count > kParameterCount) {
    return FailAt(first_, ErrorCode::kTooManyParameters,
                  Told("values", count) + " parameters; at most eight are passed", "OPT-9.20");
  }
  instruction_.value_count = static_cast<std::uint8_t>(1 + count);
  return true;
}

bool Parser::ParseCall() { return ParseProgramNumber() && ParseArguments(); }

bool Parser::ParseFunction() {
  const Token number = Peek();
  if (number.kind == TokenKind::kWord && number.word != Word::kNone &&
      Describe(number.word).group == WordGroup::kVariable) {
    return FailAt(number, ErrorCode::kFunctionNumber,
                  "FUNCTION takes a number or a declared constant", "OPT-9.01");
  }
  return ParseProgramNumber() && ParseArguments();
}

// "GOTO" ( label | target "(" label { "," label } ")" )                         OPT-7.15, OPT-7.17
bool Parser::ParseGoto() {
  if (!Is(TokenKind::kWord)) return ParseJumpLabel();
  instruction_.op = Op::kGotoTable;
  return ParseOperands();
}

// "(" expr "," label ")"
bool Parser::ParseTimeAndLabel() {
  const auto& rows = operands::kTimer;
  return Expect(TokenKind::kOpen, rows[0].missing) && ParseExpression() &&
         Expect(TokenKind::kComma, rows[2].missing) && ParseJumpLabel() &&
         Expect(TokenKind::kClose, rows[4].missing);
}

// "TIMER" ( "(" expr "," label ")" [ "/" "AUTO" ] | "/" "DIS" )                 OPT-B.59
bool Parser::ParseTimer() {
  if (Is(TokenKind::kSlash)) {
    Take();
    if (!TakeWord(Word::kDis)) return Fail("DIS, or the time before '/'");
    instruction_.attributes = kDis;
    return true;
  }
  instruction_.value_count = 1;
  return ParseTimeAndLabel();
}

// "DECLARE" name "=" ( [ sign ] number | logical | "PI" | variable | par )      OPT-7.41
bool Parser::ParseDeclare() {
  if (!Is(TokenKind::kWord)) return Fail(operands::kDeclare[0].missing);
  const Token name = Take();
  if (const Word reserved = FindWord(name.key); reserved != Word::kNone) {
    refused_.set(static_cast<std::size_t>(reserved));
    return FailAt(name, ErrorCode::kNameReserved,
                  Quoted(name, "name") + " is reserved" +
                      (name.word == Word::kNone ? ": eight characters count" : ""),
                  "OPT-7.48");
  }
  instruction_.name = InternName(name);
  instruction_.value_count = 1;
  if (!Expect(TokenKind::kEqual, operands::kEquals.missing)) return false;
  if (Is(TokenKind::kEnd)) return Fail("a number, a constant or a variable");
  const Token value = Peek();
  const bool group = value.kind == TokenKind::kWord && value.word != Word::kNone &&
                     (Describe(value.word).group == WordGroup::kVariable ||
                      Describe(value.word).group == WordGroup::kConstant);
  const bool sign = value.kind == TokenKind::kMinus || value.kind == TokenKind::kPlus;
  const bool number =
      value.kind == TokenKind::kNumber || (sign && Peek(1).kind == TokenKind::kNumber);
  if (value.kind == TokenKind::kBadNumber || value.kind == TokenKind::kBadCharacter)
    return Fail("a value");
  if (!group && !number) {
    return FailAt(value, ErrorCode::kDeclareValue,
                  "DECLARE takes a number, a constant or a variable", "OPT-7.42");
  }
  if (!ParseSigned()) return false;
  module_.EndExpression();
  const Token next = Peek();
  const bool attribute = next.kind == TokenKind::kSlash && EndsExpression(Peek(1));
  if (LevelOf(next) != 0 && !attribute) {
    return FailAt(next, ErrorCode::kDeclareValue, "DECLARE takes no expression", "OPT-7.42");
  }
  if (declared_[instruction_.name] && !nameless_) {
    char room[kNameLength];
    return FailAt(name, ErrorCode::kNameDuplicate,
                  Told("name", UnpackName(name.key, room)) + " is declared already", "OPT-7.49");
  }
  return true;
}

// "DEFINE" "PAR" [ "[" integer "]" ] "=" ( "FLOAT" | "INT" | "LOGIC" )          OPT-9.22
bool Parser::ParseDefine() {
  const Token what = Peek();
  if (!TakeWord(Word::kPar)) {
    if (what.kind != TokenKind::kWord) return Fail(operands::kDefine[0].missing);
    return FailAt(what, ErrorCode::kDefineInvalid, "DEFINE gives the type of a PAR", "OPT-9.23");
  }
  const bool indexed = TryTake(TokenKind::kOpenIndex);
  if (indexed) {
    const Token index = Peek();
    if (!ParseWhole(operands::kDefine[1].missing, instruction_.numbers[0])) return false;
    if (!Expect(TokenKind::kCloseIndex, "']'")) return false;
    if (instruction_.numbers[0] >= kParameterCount) {
      return FailAt(index, ErrorCode::kIndexRange, "PAR has the indices 0..7", "OPT-9.21");
    }
  }
  if (!Expect(TokenKind::kEqual, operands::kEquals.missing)) return false;
  const Token type = Peek();
  const Operand& types = operands::kDefine.back();
  const bool known = type.kind == TokenKind::kWord &&
                     std::ranges::find(types.words, type.word) != types.words.end();
  if (type.kind == TokenKind::kWord && !known) {
    return FailAt(type, ErrorCode::kDefineInvalid, "a type is FLOAT, INT or LOGIC", "OPT-9.23");
  }
  if (!ParseChoice(types)) return false;
  if (indexed) return true;
  findings_.Add(ErrorCode::kDefineWithoutIndex, PlaceOf(what), "DEFINE PAR means PAR[0]",
                "OPT-9.24", {{what.offset, static_cast<int>(what.length), "PAR[0]"}});
  return true;
}

// "ASSIGN" target "=" ( integer | target ) "/" integer                          OPT-7.102
bool Parser::ParseBits(const Operand& operand) {
  const Token& value = Peek();
  const Token& follower = Peek(1);
  const bool number = value.kind == TokenKind::kNumber ||
                      (value.kind == TokenKind::kMinus && follower.kind == TokenKind::kNumber);
  if (!number) return ParseTarget(operand.missing);
  if (!ParseSigned()) return false;
  if (module_.nodes.back().op != Node::kInteger) {
    at_ -= 1;
    return Fail("a whole number up to 32767");
  }
  module_.EndExpression();
  return true;
}

// group { "," group }                                                           OPT-7.98, OPT-B.61
bool Parser::ParseGroups() {
  do {
    if (TakeWord(Word::kIl)) {
      instruction_.choice |= kGroupIl;
    } else if (TakeWord(Word::kOl)) {
      instruction_.choice |= kGroupOl;
    } else if (TakeWord(Word::kIa)) {
      instruction_.choice |= kGroupIa;
    } else if (TakeWord(Word::kOa)) {
      instruction_.choice |= kGroupOa;
    } else {
      return Fail(operands::kGroups[0].missing);
    }
  } while (TryTake(TokenKind::kComma));
  return true;
}

// { "/" attribute }, in any order, each once                                    OPT-2.43
bool Parser::ParseAttributes() {
  const InstructionInfo& row = Describe(instruction_.op);
  while (TryTake(TokenKind::kSlash)) {
    const Token word = Peek();
    const AttributeInfo* found = nullptr;
    for (const AttributeInfo& info : kAttributes) {
      if (word.kind == TokenKind::kWord && word.word == info.word) found = &info;
    }
    if (found == nullptr) return Fail("an attribute behind '/'");
    const bool late_dis = found->bit == kDis && instruction_.value_count > 0;
    if ((row.attributes & found->bit) == 0 || late_dis) {
      return FailAt(word, ErrorCode::kAttributeNotAllowed,
                    Told("instruction", row.name) + " has no attribute " +
                        Told("attribute", Describe(word.word).text),
                    "OPT-2.43");
    }
    const std::uint16_t exclusive = instruction_.op == Op::kGo      ? row.attributes
                                    : instruction_.op == Op::kTimer ? row.attributes
                                    : (found->bit & (kOn | kOff)) != 0
                                        ? static_cast<std::uint16_t>(kOn | kOff)
                                        : static_cast<std::uint16_t>(found->bit);
    if ((instruction_.attributes & exclusive) != 0) {
      const bool same = instruction_.Has(found->bit);
      return FailAt(
          word, ErrorCode::kAttributeDuplicate,
          Quoted(word, "attribute") + (same ? " stands twice" : " contradicts another attribute"),
          "OPT-2.43");
    }
    Take();
    if (!ParseAttribute(word, found->bit)) return false;
    instruction_.attributes |= found->bit;
  }
  const bool switches = instruction_.op == Op::kWork || instruction_.op == Op::kUpdate;
  if (switches && !instruction_.Has(kOn) && !instruction_.Has(kOff)) return Fail("/ON or /OFF");
  return true;
}

bool Parser::ParseAttribute(const Token& word, Attribute attribute) {
  const auto first = static_cast<std::uint32_t>(module_.expression_ends.size());
  switch (attribute) {
    case kVia: {
      int count = 0;
      if (Is(TokenKind::kOpen) && !ParseList(count, 5)) return false;
      if (count != 5)
        return FailAt(word, ErrorCode::kArgumentCount,
                      CountText(Told("attribute", "/VIA"), count, "5"), "OPT-2.31");
      break;
    }
    case kStart:
    case kEnd:
      if (!ParseParenthesised()) return false;
      break;
    case kTime:
      if (!ParseTimeAndLabel()) return false;
      break;
    default:
      return true;
  }
  attribute_parts_.push_back(
      {attribute, first, static_cast<std::uint32_t>(module_.expression_ends.size()) - first});
  return true;
}

}  // namespace rmlcell::optimo
