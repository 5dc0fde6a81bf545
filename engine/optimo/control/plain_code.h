#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/optimo/language/linker.h"

// The plain instructions of a module, made ready to be carried out: those that need nothing but
// variables and the place in the program. Loops consist of them. Each becomes a few operations on
// numbers whose places are known, and the last one does what the instruction does; labels and
// functions are places, too, so that nothing is looked up on the way. What the other instructions
// do stands with the parts of the control.
namespace rmlcell::optimo {

// Where a number lies.
enum class Bank : std::uint8_t { kVr, kVi, kOa, kPar, kConstant, kTemporary };
inline constexpr std::size_t kBanks = static_cast<std::size_t>(Bank::kTemporary) + 1;
inline constexpr std::size_t kTemporariesMax = 64;  // an instruction that needs more is not plain

struct NumberPlace {
  Bank bank = Bank::kConstant;
  std::uint16_t index = 0;

  bool operator==(const NumberPlace&) const = default;
};

// The variables of all groups, one behind the other.
inline constexpr std::size_t kVariablesOfGroup = kVariableIndexMax + 1;
inline constexpr std::size_t NumberOf(Variable variable) {
  return static_cast<std::size_t>(variable.group) * kVariablesOfGroup + variable.index;
}
// VI[98]: the control itself sets it.
inline constexpr std::size_t kAlwaysSet = NumberOf({VariableGroup::kVi, 98});

enum class PlainOp : std::uint8_t {
  kLeave,  // what is here is not plain, or the module ends
  // Begins a step, that of number `target`: an `instruction` that reads the variables of numbers
  // result and left.index, kAlwaysSet where it reads fewer. Those that are always set by the run
  // itself, as PAR of a FUNCTION, are left out; of more than two, kKnow has the others.
  kBegin,
  // Temporary `result` becomes:
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kLess,
  kLessEqual,
  kEqual,
  kGreaterEqual,
  kGreater,
  kNotEqual,
  kOperate,  // what `node` makes of left and right
  kVl,       // VL[left.index]
  kOl,       // OL[left.index]
  // Further operations of a step:
  kKnow,      // it reads the variable of number `target`, too
  kArgument,  // left, as `type`, is argument `result` of the call
  kSelect,    // table of `result` labels: left selects one of the next operations, or the last
  // What ends a step and does what it does. It goes on with instruction `target`.
  kSetVr,  // VR[result] = left
  kVrAdd,  // VR[result] = left + right; the others in the order of those above
  kVrSubtract,
  kVrMultiply,
  kVrDivide,
  kSetVi,
  kSetVl,
  kSetPar,  // as `type`
  kGoOn,    // with the next operation, which is that of the target
  kGoTo,
  kIf,      // where left is true, else with the target of the next operation
  kIfLess,  // where left < right; the others in the order of those above
  kIfLessEqual,
  kIfEqual,
  kIfGreaterEqual,
  kIfGreater,
  kIfNotEqual,
  kGosub,     // and then with `next`
  kFunction,  // module `target` of the executable with `result` arguments, and then with `next`
  kReturn,    // of a GOSUB or FUNCTION
};

struct PlainOperation {
  PlainOp op = PlainOp::kLeave;
  union {
    Op instruction = Op::kInvalid;  // kBegin
    Node node;                      // kOperate
    ValueType type;                 // kArgument, kSetPar
  };
  std::uint16_t result = 0;
  NumberPlace left{};
  union {
    NumberPlace right{};
    std::uint32_t next;  // kGosub, kFunction: instruction
  };
  std::uint32_t target = 0;
};

class PlainCode {
 public:
  // Of a module of the executable, with its index.
  PlainCode(const Executable& executable, std::size_t module, const ModuleIndex& index);

  // What comes next from this instruction on, DECLARE passed over: kBegin or kLeave.
  const PlainOperation* At(std::uint32_t instruction) const {
    return operations_.data() + starts_[instruction];
  }
  const std::vector<float>& constants() const { return constants_; }

 private:
  friend class PlainWriter;

  // The operations of a step end where those of the next one begin, or with kLeave.
  std::vector<PlainOperation> operations_;
  std::vector<std::uint32_t> starts_;  // by instruction, and one for the end
  std::vector<float> constants_;
};

}  // namespace rmlcell::optimo
