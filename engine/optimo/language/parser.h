#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "engine/optimo/language/lexer.h"
#include "engine/optimo/language/program.h"

// The parser behind Parse() (program.h): one production of optimo.md B.9, one function. Private to
// the folder.
namespace rmlcell::optimo {

// "CONT 3": the word and what follows it on its line, in upper case with single blanks.
std::string IgnoredText(Word word, std::string_view rest);

class Parser {
 public:
  Parser(std::string_view text, ParsedProgram& program, Findings& findings, Places places);
  void Run();

 private:
  void Reserve();

  // Statements, parser.cc. They return false when the statement was given up; the error is
  // reported.
  void ParseStatement();
  bool ParseInstruction(Word word);
  bool ParseAssignment(bool after_let);
  void ParseIgnored(Word word);
  bool AddLabel(const Token& token);
  void DropStatement();
  void FinishStatement(bool good);
  void OrderAttributeParts();

  // Instructions, parser_instructions.cc
  bool ParseOperands();
  bool IsText(std::string_view text);
  bool Begins(const Operand& operand);
  bool ParseOperand(const Operand& operand, std::size_t& number);
  bool ParseCountedList(const Operand& operand);
  bool ParseNumber(const Operand& operand, std::uint16_t& number);
  bool ParseChoice(const Operand& operand);
  bool ParsePath();
  bool ParseTcp();
  bool ParseWorkdef();
  bool ParseCall();
  bool ParseFunction();
  bool ParseGoto();
  bool ParseTimer();
  bool ParseDeclare();
  bool ParseDefine();
  bool ParseBits(const Operand& operand);
  bool ParseGroups();
  bool ParseProcess();
  bool ParseProgramNumber();
  bool ParseArguments();
  bool ParseAttributes();
  bool ParseAttribute(const Token& word, Attribute attribute);
  bool ParseTimeAndLabel();

  // Values, parser_expression.cc
  bool ParseExpression();     // appends one expression
  bool ParseParenthesised();  // "(" expr ")"
  bool ParseList(int& count, int keep_max, int slash_after = 0);
  bool ParseBinary(int level);
  bool ParseSigned();
  bool ParsePrimary(bool negative, const Token& sign);
  void Negate(const Token& sign);
  bool ParseVariable();                         // group [ index ], appended as a node
  bool ParseTarget(std::string_view expected);  // variable | par | name, as one expression
  bool ParseLiteral(bool negative, const Token& sign);
  bool IsNumberAlone();
  bool ParseJumpLabel();
  bool ParseWhole(std::string_view what, std::uint16_t& value);
  int LevelOf(const Token& token) const;
  bool EndsExpression(const Token& slash_follower) const;
  ExprNode& Emit(Node op, std::uint32_t offset, std::uint32_t length);
  // Expressions stay up to the `expressions`th; nodes behind it go, too.
  void DropExpressions(std::uint32_t expressions);

  // Tokens
  // A copy: the next look may move the tokens.
  Token Peek(std::size_t ahead = 0) { return lexer_.At(at_ + ahead); }
  Token Take() { return lexer_.At(at_++); }
  bool Is(TokenKind kind) { return Peek().kind == kind; }
  bool TryTake(TokenKind kind) {
    const bool there = Is(kind);
    at_ += there ? 1 : 0;
    return there;
  }
  bool TakeWord(Word word) {
    const bool there = Peek().word == word;
    at_ += there ? 1 : 0;
    return there;
  }
  bool Expect(TokenKind kind, std::string_view expected) { return TryTake(kind) || Fail(expected); }
  bool ExpectWord(Word word, std::string_view expected) { return TakeWord(word) || Fail(expected); }

  // Reports at the next token. `expected` completes "expected ...".
  bool Fail(std::string_view expected);
  bool FailAt(const Token& token, ErrorCode code, Detail detail, std::string_view rule = {});
  void Report(const Token& token, ErrorCode code, Detail detail, std::string_view rule = {});
  void ReportStatement(ErrorCode code, Detail detail, std::string_view rule = {});
  bool FailUnknown(const Token& name);
  bool IsRightWith(const Token& word, std::string_view text) const;
  std::optional<std::uint32_t> MissingBlank(const Token& name) const;
  bool IsRefused(const Token& word) const {
    return refused_.any() && refused_.test(static_cast<std::size_t>(FindWord(word.key)));
  }
  bool IsNameOfRefused(const Token& word, const Token& next) const;
  Place PlaceOf(const Token& token) const;
  Detail Quoted(const Token& token, std::string_view name = "word") const;
  std::uint16_t InternName(const Token& token);
  void MarkBroken();
  bool BeginsStatement(const Token& token) const;

  std::string_view text_;
  ParsedProgram& program_;
  Module& module_;
  Findings& findings_;
  Places places_;
  Lexer lexer_;
  std::size_t at_ = 0;       // next token of the statement
  Token first_;              // of the statement, behind its label
  Instruction instruction_;  // under construction
  std::unordered_map<NameKey, std::uint16_t> names_;
  std::vector<bool> declared_;                 // by name, as far as the text was read
  std::vector<std::uint16_t> declared_names_;  // in order
  std::vector<bool> long_form_reported_;
  std::bitset<256> refused_;  // by Word: a DECLARE of it was an error, its uses are no further ones
  std::array<std::uint32_t, 10000> label_line_{};  // where it stands; 0: nowhere yet
  std::vector<NodePlace> pending_label_places_;    // of the instruction to come
  std::vector<std::uint16_t> pending_labels_;
  struct AttributePart {
    Attribute attribute;
    std::uint32_t first, count;  // expressions, as written
  };
  std::vector<AttributePart> attribute_parts_;
  std::uint32_t steps_ = 0;
  bool labelled_ = false;  // the statement has a sequence number on its line
  int nesting_ = 0;
  bool slash_separates_ = false;  // inside the list of TCP, OPT-B.85
  bool too_many_names_ = false;
  bool nameless_ = false;   // the statement has a name for which there is no room
  bool broken_if_ = false;  // the statement before is an IF that was given up
};

}  // namespace rmlcell::optimo
