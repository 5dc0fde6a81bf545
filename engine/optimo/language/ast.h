#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/detail.h"
#include "engine/optimo/language/instruction_set.h"

// A program as data: instructions in order, expressions in one pool, no text and no layout. The
// parser makes a Module (with where-was-it tables beside it, program.h), the checker resolves and
// types it, the object codec writes and reads it, the interpreter executes it.
namespace rmlcell::optimo {

enum class ValueType : std::uint8_t { kReal, kInteger, kLogical };
std::string_view TypeName(ValueType type);  // "REAL"

enum class VariableGroup : std::uint8_t { kVr, kVi, kVl, kIl, kOl, kIa, kOa, kPar };
inline constexpr std::size_t kVariableGroups = static_cast<std::size_t>(VariableGroup::kPar) + 1;
std::string_view GroupName(VariableGroup group);  // "VR"

inline constexpr int kVariableIndexMax = 99;  // OPT-7.59
inline constexpr int kAssignWidthMax = 16;    // OPT-7.102
inline constexpr int kParameterCount = 8;     // PAR[0] to PAR[7], OPT-9.20

struct Variable {
  VariableGroup group = VariableGroup::kVr;
  std::uint8_t index = 0;

  bool operator==(const Variable&) const = default;
};
Detail ToldVariable(Variable variable);  // "VR[5]"
// The type that the group has by itself; PAR: Module::parameter_types.
ValueType TypeOf(VariableGroup group);
// IL, IA, OA[0], VI[98], VI[99]. OPT-7.66
bool IsReadOnly(Variable variable);

// The parts of an expression. Codes of the object (OPT-B.70): order is part of the format.
enum class Node : std::uint8_t {
  kInteger,   // number; of type LOGICAL where 0 or 1 stand in a logical place, OPT-B.45
  kReal,      // number
  kLogical,   // number is 0 or 1
  kPi,        // 3.14159, OPT-7.57
  kVariable,  // group, index
  kName,  // before checking only: name; the checker turns it into one of the above and keeps `name`
  kNegate,
  kNot,
  kSin,
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan,
  kSqrt,
  kExp,
  kLn,
  kLog,
  kAbs,
  kInt,
  kPower,
  kMultiply,
  kDivide,
  kMod,
  kAdd,
  kSubtract,
  kLess,
  kLessEqual,
  kEqual,
  kGreaterEqual,
  kGreater,
  kNotEqual,
  kAnd,
  kOr,
  kXor,
};
inline constexpr int kNodeCount = static_cast<int>(Node::kXor) + 1;
inline int Arity(Node node) {  // 0 leaf, 1, 2
  if (node < Node::kNegate) return 0;
  return node < Node::kPower ? 1 : 2;
}

inline constexpr std::uint16_t kNoName = 0xFFFF;

struct ExprNode {
  Node op = Node::kInteger;
  ValueType type = ValueType::kReal;         // of the result; set by the checker
  VariableGroup group = VariableGroup::kVr;  // kVariable
  std::uint8_t index = 0;                    // kVariable
  std::uint16_t name = kNoName;              // the declared name that stood here
  std::uint16_t index_name = kNoName;        // the declared constant that stood as index
  float number = 0.0F;  // literals and constants, rounded to 24 bits (OPT-B.37)

  Variable variable() const { return {group, index}; }
  bool operator==(const ExprNode&) const = default;
};
// A number that stands there itself, not by a name.
bool IsLiteral(const ExprNode& node);
// The literal with the sign before it, which is a part of it (OPT-B.40).
ExprNode NegatedLiteral(const ExprNode& literal);

// A run of Module::nodes in postfix order; the last node is the root. Its type is the root's type.
// Expressions are called by number; they lie one behind the other, so that the end of each is all
// that is kept (docs/decisions/0006-tree-layout.md).
struct ExprRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};
using Expression = std::span<const ExprNode>;

enum class CoordType : std::uint8_t { kAbsol, kRobot };
enum class PathType : std::uint8_t { kPtp, kLin, kCir, kHole };

// Groups of UPDATE, IMAGE, REAL, as bits of Instruction::choice. IMAGE and REAL without group have
// all.
inline constexpr std::uint8_t kGroupIl = 1, kGroupOl = 2, kGroupIa = 4, kGroupOa = 8,
                              kAllGroups = 15;

// One instruction. What its fields hold is said by its operands, in order (operands.h), and by its
// attributes: values are expressions of its own, before those of attributes; targets are sequence
// numbers jumped to. Besides:
//   COORD       choice CoordType       PATH      choice PathType       DEFINE    choice ValueType
//   FUNCTION    numbers[0] program, too
//   SYSDEF      values none or six     LET       values target, right-hand side
//   DEFINE      numbers[0] PAR index   ASSIGN    numbers[0] width
//   BREAK SIMUL numbers[1] program, 0: the own one
//   ignored     name: index of Module::texts, "CONT 3"
struct Instruction {
  Op op = Op::kInvalid;
  std::uint8_t choice = 0;
  std::uint8_t value_count = 0;
  bool reads_machine = false;  // reads IL, IA or OA[0] anywhere; set by the checker (OPT-2.48)
  std::uint16_t attributes = 0;
  std::array<std::uint16_t, 2> numbers = {0, 0};
  std::uint16_t name = kNoName;
  std::uint16_t label_count = 0;   // its sequence numbers, OPT-1.27
  std::uint16_t target_count = 0;  // that of /TIME is the last
  std::uint32_t first_label = 0;
  std::uint32_t first_target = 0;
  std::uint32_t first_expression = 0;
  std::uint32_t step = 0;  // as the control counts; 0 for DECLARE. OPT-6.01

  bool Has(Attribute attribute) const { return (attributes & attribute) != 0; }
};

// A declared name, in order of declaration.
struct DeclaredName {
  NameKey key = 0;
  bool declared = false;
  ExprNode value;  // literal, kPi or kVariable; name is kNoName

  bool is_variable() const { return value.op == Node::kVariable; }
};

inline constexpr std::uint32_t kNoIndex = 0xFFFF'FFFF;

struct Module {
  std::vector<Instruction> instructions;  // in program order; DECLARE among them, with step 0
  std::vector<ExprNode> nodes;
  // By number of the expression: the node behind its last one. Of an instruction: values, VIA (5),
  // START, END, TIME.
  std::vector<std::uint32_t> expression_ends;
  std::vector<std::uint16_t> labels;      // sequence numbers, in program order
  std::vector<std::uint16_t> targets;     // sequence numbers that are jumped to
  std::vector<std::uint16_t> end_labels;  // at the end of the text: they reach the implied ENDTASK
  std::vector<DeclaredName> names;
  std::vector<std::string> texts;
  std::array<ValueType, kParameterCount> parameter_types{};  // by DEFINE, else REAL (OPT-9.22)
  std::uint32_t step_count = 0;  // the implied ENDTASK is step_count + 1 (OPT-6.04)

  ExprRange Range(std::uint32_t index) const {
    const std::uint32_t first = FirstNode(index);
    return {first, expression_ends[index] - first};
  }
  // Of this expression, and of an instruction with this first_expression, if it has any.
  std::uint32_t FirstNode(std::uint32_t index) const {
    return index == 0 ? 0 : expression_ends[index - 1];
  }
  // The nodes behind the last expression become one.
  void EndExpression() { expression_ends.push_back(static_cast<std::uint32_t>(nodes.size())); }
  Expression expression(std::uint32_t index) const {
    const ExprRange range = Range(index);
    return {nodes.data() + range.first, range.count};
  }
  Expression Value(const Instruction& i, int position) const {
    return expression(i.first_expression + static_cast<std::uint32_t>(position));
  }
  // Precondition: the instruction has the attribute. Via: position 0 to 4.
  Expression Via(const Instruction& i, int position) const;
  Expression Start(const Instruction& i) const;
  Expression End(const Instruction& i) const;
  Expression Time(const Instruction& i) const;          // seconds
  std::uint16_t TimeLabel(const Instruction& i) const;  // sequence number of /TIME
  std::span<const std::uint16_t> Labels(const Instruction& i) const {
    return {labels.data() + i.first_label, i.label_count};
  }
  // Without that of /TIME.
  std::span<const std::uint16_t> Targets(const Instruction& i) const;
  std::uint32_t ExpressionCount(const Instruction& i) const;  // with those of attributes
};

// Answers what the interpreter asks about a module. Built once; the module must outlive it.
class ModuleIndex {
 public:
  explicit ModuleIndex(const Module& module);

  // The first instruction at or after the sequence number that is no DECLARE; the number of
  // instructions when it reaches the implied ENDTASK; nothing when the module does not have it
  // (error 60).
  std::optional<std::uint32_t> FindLabel(int label) const;

  // The instruction of this step; nothing when there is none. The implied ENDTASK is not an
  // instruction.
  std::optional<std::uint32_t> FindStep(std::uint32_t step) const;

  // Where execution starts: at TASK 1, else at the first instruction. OPT-9.12
  std::uint32_t entry() const { return entry_; }

  // Next instruction that is no DECLARE, from `index` on; the number of instructions at the end.
  std::uint32_t SkipDeclares(std::uint32_t index) const;

 private:
  const Module* module_;
  std::vector<std::uint32_t> by_label_;
  std::vector<std::uint32_t> by_step_;
  std::uint32_t entry_ = 0;
};

}  // namespace rmlcell::optimo
