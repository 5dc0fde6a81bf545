#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/optimo/language/words.h"

// What stands between the word of an instruction and its attributes, as data: the printer writes
// it, the object holds it, its reader demands it, and the parser reads most of it by these rows.
namespace rmlcell::optimo {

// One part of the operands. Instruction has a place for each kind: values, numbers, choice, name,
// targets.
struct Operand {
  enum class Kind : std::uint8_t {
    kText,      // fixed, as it is printed: " = "
    kValue,     // value: an expression
    kVariable,  // value: a variable, or the name of one
    kProgram,   // value: a whole number, a variable, or a name
    kConstant,  // value: a whole number, or a name
    kLiteral,   // value: what DECLARE takes
    kBits,      // value: a whole number or a variable
    kList,      // values in parentheses: from `low` to `high` of them
    kTool,      // the list of six of TCP, '/' in its middle
    kNumber,    // the next of the numbers, from `low` to `high`
    kChoice,    // one of `words`
    kGroups,    // choice: bits of groups; kAllGroups when it is left out
    kName,      // the declared name
    kLabel,     // target
    kLabels,    // targets, one or more
  };
  Kind kind = Kind::kText;
  std::string_view text{};  // kText
  std::string_view
      missing{};  // what a statement lacks without it: "a task number"; kList: how many
  std::uint16_t low = 0;
  std::uint16_t high = 0xFFFF;
  bool optional = false;  // this and all that follow may be left out together
  std::span<const Word> words{};
  std::string_view range{};  // kNumber: what to say of another number; empty: the parser's own
  std::string_view rule{};
};

namespace operands {

using Kind = Operand::Kind;

// In the order of CoordType, PathType, ValueType.
inline constexpr std::array kCoordWords = {Word::kAbsol, Word::kRobot};
inline constexpr std::array kPathWords = {Word::kPtp, Word::kLin, Word::kCir, Word::kHole};
inline constexpr std::array kTypeWords = {Word::kFloat, Word::kInt, Word::kLogic};

// clang-format off
inline constexpr std::array kPose = {
    Operand{.kind = Kind::kList, .missing = "5", .low = 5, .high = 5, .rule = "OPT-2.01"}};
inline constexpr std::array kFrame = {
    Operand{.kind = Kind::kList, .missing = "6 or none", .low = 6, .high = 6, .optional = true, .rule = "OPT-7.38"}};
inline constexpr std::array kTool = {Operand{.kind = Kind::kTool, .low = 6, .high = 6}};
inline constexpr std::array kCoord = {
    Operand{.kind = Kind::kChoice, .missing = "ABSOL or ROBOT", .words = kCoordWords}};
inline constexpr std::array kPath = {
    Operand{.kind = Kind::kChoice, .missing = "PTP, LIN, CIR or HOLE", .words = kPathWords},
    Operand{.kind = Kind::kList, .low = 1, .high = 1, .optional = true}};
inline constexpr std::array kValue = {Operand{.kind = Kind::kValue}};
inline constexpr std::array kProcess = {
    Operand{.kind = Kind::kNumber, .missing = "the kind 0, 1 or 2", .high = 2},
    Operand{.text = ",", .missing = "',' and the process number"},
    Operand{.kind = Kind::kNumber, .missing = "a process number", .high = 9}};
inline constexpr std::array kWorkdef = {
    kProcess[0], kProcess[1], kProcess[2],
    Operand{.kind = Kind::kList, .low = 1, .high = 5, .optional = true}};
inline constexpr std::array kProgram = {
    Operand{.kind = Kind::kProgram, .missing = "a program number"}};
inline constexpr Operand kArguments{.kind = Kind::kList, .low = 1, .high = 8, .optional = true};
inline constexpr std::array kCall = {kProgram[0], kArguments};
inline constexpr std::array kFunction = {
    Operand{.kind = Kind::kConstant, .missing = "a program number"}, kArguments};
inline constexpr std::array kLabel = {Operand{.kind = Kind::kLabel}};
inline constexpr std::array kLabelTable = {
    Operand{.kind = Kind::kVariable, .missing = "a sequence number or a variable"},
    Operand{.text = " (", .missing = "'(' and sequence numbers"},
    Operand{.kind = Kind::kLabels},
    Operand{.text = ")", .missing = "',' or ')'"}};
inline constexpr std::array kIf = {
    Operand{.kind = Kind::kValue},
    Operand{.text = " THEN ", .missing = "THEN"},
    Operand{.kind = Kind::kLabel},
    Operand{.text = " ELSE ", .missing = "ELSE", .optional = true},
    Operand{.kind = Kind::kLabel}};
inline constexpr std::array kTask = {Operand{.kind = Kind::kNumber, .missing = "a task number"}};
inline constexpr std::array kTimer = {
    Operand{.text = "(", .missing = "'(' and a time", .optional = true},
    Operand{.kind = Kind::kValue},
    Operand{.text = ", ", .missing = "',' and a sequence number"},
    Operand{.kind = Kind::kLabel},
    Operand{.text = ")", .missing = "')'"}};
inline constexpr Operand kEquals{.text = " = ", .missing = "'='"};
inline constexpr std::array kLet = {
    Operand{.kind = Kind::kVariable, .missing = "a variable or name"}, kEquals,
    Operand{.kind = Kind::kValue}};
inline constexpr std::array kDeclare = {
    Operand{.kind = Kind::kName, .missing = "a name"}, kEquals, Operand{.kind = Kind::kLiteral}};
inline constexpr std::array kDefine = {
    Operand{.text = "PAR[", .missing = "PAR"},
    Operand{.kind = Kind::kNumber, .missing = "an index", .high = 7},
    Operand{.text = "] = ", .missing = "'='"},
    Operand{.kind = Kind::kChoice, .missing = "FLOAT, INT or LOGIC", .words = kTypeWords}};
inline constexpr std::array kAssign = {
    Operand{.kind = Kind::kVariable, .missing = "a variable or name"}, kEquals,
    Operand{.kind = Kind::kBits, .missing = "a number or a variable"},
    Operand{.text = " /", .missing = "'/' and the number of outputs"},
    Operand{.kind = Kind::kNumber, .missing = "the number of outputs"}};
inline constexpr std::array kGroups = {
    Operand{.kind = Kind::kGroups, .missing = "IL, OL, IA or OA"}};
inline constexpr std::array kGroupsOrAll = {
    Operand{.kind = Kind::kGroups, .missing = "IL, OL, IA or OA", .optional = true}};
inline constexpr std::array kStep = {
    Operand{.kind = Kind::kNumber, .missing = "a step number", .low = 1, .high = 9999,
            .range = "steps go from 1 to 9999", .rule = "OPT-6.15"},
    Operand{.text = ", ", .missing = "','", .optional = true},
    Operand{.kind = Kind::kNumber, .missing = "a program number", .high = 99,
            .range = "program numbers go from 1 to 99", .rule = "OPT-6.15"}};
// clang-format on

}  // namespace operands

// How many places of an instruction its operands take.
struct OperandCounts {
  bool choice = false;
  bool name = false;
  std::uint8_t numbers = 0;
  std::uint8_t values = 0;          // the most there can be
  bool values_vary = false;         // and fewer, too
  std::uint8_t targets = 0;         // the most, but for kLabels
  bool targets_vary = false;        // more or fewer
  bool targets_with_value = false;  // they are there when the value is
};

constexpr OperandCounts CountOf(std::span<const Operand> operands) {
  using enum Operand::Kind;
  OperandCounts counts;
  bool may_end = false;  // before the part that is looked at
  bool value_may_end = false;
  for (const Operand& operand : operands) {
    may_end = may_end || operand.optional;
    switch (operand.kind) {
      case kText:
        break;
      case kValue:
      case kVariable:
      case kProgram:
      case kConstant:
      case kLiteral:
      case kBits:
        counts.values = static_cast<std::uint8_t>(counts.values + 1);
        counts.values_vary = counts.values_vary || may_end;
        value_may_end = value_may_end || may_end;
        break;
      case kList:
      case kTool:
        counts.values = static_cast<std::uint8_t>(counts.values + operand.high);
        counts.values_vary = counts.values_vary || may_end || operand.low != operand.high;
        break;
      case kNumber:
        counts.numbers = static_cast<std::uint8_t>(counts.numbers + 1);
        break;
      case kChoice:
      case kGroups:
        counts.choice = true;
        break;
      case kName:
        counts.name = true;
        break;
      case kLabel:
      case kLabels:
        counts.targets = static_cast<std::uint8_t>(counts.targets + 1);
        counts.targets_with_value = value_may_end;
        counts.targets_vary = (may_end && !value_may_end) || operand.kind == kLabels;
        break;
    }
  }
  return counts;
}

}  // namespace rmlcell::optimo
