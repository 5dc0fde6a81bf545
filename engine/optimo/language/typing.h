#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/program.h"

// Names and types of expressions (OPT-7.41 to 7.60, 7.72 to 7.94, B.45, B.46). Private to the
// folder.
namespace rmlcell::optimo {

// What the place of an expression takes.
enum class Wanted : std::uint8_t {
  kNumeric,
  kLogical,
  kAny,  // a condition or a parameter: logical or numeric
};

class Typing {
 public:
  // `places` may be null: then findings have no place.
  Typing(Module& module, const ParsedProgram* places, Findings& findings)
      : module_(module), places_(places), findings_(findings) {
    if (places != nullptr) broken_names_ = places->broken_names;
  }

  // Resolves the names of the expression and sets its types. False when something is wrong or
  // unknown; it is reported then.
  bool Type(std::uint32_t expression, Wanted wanted);

  // The first node of an expression that must be a variable: assignment targets. Reports 7015,
  // 7011.
  bool ResolveTarget(std::uint32_t expression);

  // Precondition: the first DECLARE of its name. Whoever makes a module sees to that: the parser
  // reports another one (7010), in an object each name has its own record.
  void Declare(const Instruction& instruction);
  void Define(const Instruction& instruction);

  void BeginStep(const Instruction& instruction) {
    instruction_ = &instruction;
    reads_machine_ = false;
  }
  bool reads_machine() const { return reads_machine_; }

  Place PlaceOfNode(std::size_t node);
  Place PlaceOfStatement() const;

 private:
  struct Operand {
    std::size_t node = 0;
    ValueType type = ValueType::kReal;
    bool unknown = false;  // has an error already
  };
  NodePlace NodePlaceOf(std::size_t node);
  NodePlace NamePlaceOf(std::size_t node);
  Place PlaceOfName(std::size_t node);
  Operand TypeLeaf(std::size_t node);
  // What an undeclared name could have been.
  enum class Use : std::uint8_t { kValue, kTarget, kIndex };
  bool ResolveNode(std::size_t node, Use use = Use::kValue);
  bool ResolveIndex(std::size_t node);
  void UseVariable(const ExprNode& node);
  ValueType TypeOfLeaf(const ExprNode& node) const;
  bool HasType(Operand& root, Wanted wanted);
  bool MakeLogical(Operand& operand);
  bool NeedNumeric(const Operand& operand);
  bool NeedLogical(Operand& operand);
  bool TypeBinary(std::size_t node, Operand& a, Operand& b);
  void ReportUndeclared(std::uint16_t name, std::size_t node, Use use);
  bool IsDeclaredBelow(std::uint16_t name);
  std::vector<std::uint16_t> NamesFor(Use use) const;
  void Report(ErrorCode code, std::size_t node, Detail detail, std::string_view rule);

  Module& module_;
  const ParsedProgram* places_;
  Findings& findings_;
  std::vector<std::uint16_t> declared_names_;  // in order
  std::vector<bool> broken_names_;       // their DECLARE has an error: uses are no further ones
  std::vector<bool> declared_anywhere_;  // once it is asked for
  const Instruction* instruction_ = nullptr;
  bool reads_machine_ = false;
  std::array<bool, kParameterCount> parameter_used_{};
  std::array<bool, kParameterCount> parameter_defined_{};
  std::vector<Operand> stack_;
  const Instruction* placed_ = nullptr;  // whose places are in node_places_
  std::vector<NodePlace> node_places_;
};

}  // namespace rmlcell::optimo
