#include "engine/optimo/control/plain_code.h"

#include <algorithm>
#include <optional>

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kConstantsMax = 0x10000;  // of a module: their numbers have 16 bits
constexpr std::size_t kLabelsMax = 0xFFFF;      // of a table, likewise

// Where the whole group lies; nothing: its variables are no numbers, or not plain.
std::optional<Bank> BankOf(VariableGroup group) {
  switch (group) {
    case VariableGroup::kVr:
      return Bank::kVr;
    case VariableGroup::kVi:
      return Bank::kVi;
    case VariableGroup::kOa:
      return Bank::kOa;
    case VariableGroup::kPar:
      return Bank::kPar;
    default:
      return std::nullopt;
  }
}

PlainOp OperationOf(Node node) {
  switch (node) {
    case Node::kAdd:
      return PlainOp::kAdd;
    case Node::kSubtract:
      return PlainOp::kSubtract;
    case Node::kMultiply:
      return PlainOp::kMultiply;
    case Node::kDivide:
      return PlainOp::kDivide;
    case Node::kLess:
      return PlainOp::kLess;
    case Node::kLessEqual:
      return PlainOp::kLessEqual;
    case Node::kEqual:
      return PlainOp::kEqual;
    case Node::kGreaterEqual:
      return PlainOp::kGreaterEqual;
    case Node::kGreater:
      return PlainOp::kGreater;
    case Node::kNotEqual:
      return PlainOp::kNotEqual;
    default:
      return PlainOp::kOperate;
  }
}

}  // namespace

// Writes the operations of one module. What turns out not to be plain is taken back.
class PlainWriter {
 public:
  PlainWriter(PlainCode& code, const Executable& executable, std::size_t module,
              const ModuleIndex& index)
      : code_(code),
        executable_(executable),
        module_(executable.modules[module].module),
        index_(index),
        of_function_(module > 0) {}

  void WriteAll() {
    const auto count = static_cast<std::uint32_t>(module_.instructions.size());
    std::vector<std::uint32_t>& starts = code_.starts_;
    starts.reserve(count + 1U);
    for (const Instruction& i : module_.instructions) {
      const auto n = static_cast<std::uint32_t>(starts.size());  // each has a start
      if (i.op == Op::kDeclare) {
        starts.push_back(kNoIndex);
      } else if (i.reads_machine || !WriteStep(i, n)) {
        Leave();
      }
    }
    Leave();
    for (std::uint32_t n = count; n-- > 0;) {
      if (starts[n] == kNoIndex) starts[n] = starts[n + 1];
    }
  }

 private:
  // One operation will do for all that follow each other.
  void Leave() {
    if (code_.operations_.empty() || code_.operations_.back().op != PlainOp::kLeave) Write({});
    code_.starts_.push_back(static_cast<std::uint32_t>(code_.operations_.size()) - 1U);
  }

  bool WriteStep(const Instruction& i, std::uint32_t instruction) {
    begin_ = code_.operations_.size();
    next_ = instruction + 1;
    temporaries_ = 0;
    PlainOperation begin{.op = PlainOp::kBegin, .result = kAlwaysSet, .target = i.step};
    begin.instruction = i.op;
    begin.left.index = kAlwaysSet;
    Write(begin);
    if (WriteOperations(i)) {
      code_.starts_.push_back(static_cast<std::uint32_t>(begin_));
      return true;
    }
    code_.operations_.resize(begin_);
    return false;
  }

  // False: it is not plain.
  bool WriteOperations(const Instruction& i) {
    switch (i.op) {
      case Op::kLet:
        return WriteLet(i);
      case Op::kGoto:
        return WriteJump(PlainOp::kGoTo, module_.Targets(i)[0]);
      case Op::kGosub:
        return WriteJump(PlainOp::kGosub, module_.Targets(i)[0]);
      case Op::kIf:
        return WriteIf(i);
      case Op::kGotoTable:
        return WriteTable(i);
      case Op::kReturn:
        return WriteEnd({.op = PlainOp::kReturn});
      case Op::kFunction:
        return WriteCall(i);
      case Op::kTask:
      case Op::kDefine:
        return WriteEnd({.op = PlainOp::kGoOn});
      default:
        return false;
    }
  }

  bool Write(const PlainOperation& operation) {
    code_.operations_.push_back(operation);
    return true;
  }

  // It goes on behind the instruction.
  bool WriteEnd(PlainOperation end) {
    end.target = next_;
    return Write(end);
  }

  // An end that looks at the result of the last operation does what that does, too, when it is one
  // of those from `first` to `last`: the ends for these are those from `joined` on.
  PlainOperation Joined(const PlainOperation& end, PlainOp first, PlainOp last, PlainOp joined) {
    PlainOperation both = code_.operations_.back();
    if (end.left.bank != Bank::kTemporary || both.op < first || both.op > last) return end;
    code_.operations_.pop_back();
    both.op = static_cast<PlainOp>(static_cast<int>(joined) + static_cast<int>(both.op) -
                                   static_cast<int>(first));
    both.result = end.result;
    both.target = end.target;
    return both;
  }

  bool WriteLet(const Instruction& i) {
    const ExprNode& target = module_.Value(i, 0).back();
    const std::optional<NumberPlace> value = WriteValue(module_.Value(i, 1));
    if (!value) return false;
    PlainOperation end{.result = target.index, .left = *value};
    switch (target.group) {
      case VariableGroup::kVr:
        end.op = PlainOp::kSetVr;
        return WriteEnd(Joined(end, PlainOp::kAdd, PlainOp::kDivide, PlainOp::kVrAdd));
      case VariableGroup::kVi:
        end.op = PlainOp::kSetVi;
        return WriteEnd(end);
      case VariableGroup::kVl:
        end.op = PlainOp::kSetVl;
        return WriteEnd(end);
      case VariableGroup::kPar:
        end.op = PlainOp::kSetPar;
        end.type = module_.parameter_types[target.index];
        return WriteEnd(end);
      default:
        return false;  // outputs are shown outside
    }
  }

  bool WriteJump(PlainOp op, int label) {
    const std::optional<std::uint32_t> target = index_.FindLabel(label);
    if (!target) return false;
    PlainOperation jump{.op = op, .target = *target};
    if (op == PlainOp::kGosub) jump.next = next_;
    return Write(jump);
  }

  bool WriteIf(const Instruction& i) {
    const auto targets = module_.Targets(i);
    const std::optional<NumberPlace> condition = WriteValue(module_.Value(i, 0));
    const std::optional<std::uint32_t> target = index_.FindLabel(targets[0]);
    if (!condition || !target) return false;
    const PlainOperation end{.op = PlainOp::kIf, .left = *condition, .target = *target};
    Write(Joined(end, PlainOp::kLess, PlainOp::kNotEqual, PlainOp::kIfLess));
    return targets.size() > 1 ? WriteJump(PlainOp::kGoTo, targets[1])
                              : WriteEnd({.op = PlainOp::kGoOn});
  }

  bool WriteTable(const Instruction& i) {
    const auto targets = module_.Targets(i);
    const std::optional<NumberPlace> selected = WriteValue(module_.Value(i, 0));
    if (!selected || targets.size() > kLabelsMax) return false;
    Write({.op = PlainOp::kSelect,
           .result = static_cast<std::uint16_t>(targets.size()),
           .left = *selected});
    for (const std::uint16_t label : targets) {
      if (!WriteJump(PlainOp::kGoTo, label)) return false;
    }
    return WriteEnd({.op = PlainOp::kGoOn});
  }

  bool WriteCall(const Instruction& i) {
    const int slot = i.numbers[0];
    const LinkedModule* callee = executable_.Find(slot);
    if (slot == kRotaryTableFunction || callee == nullptr) return false;
    for (int n = 1; n < i.value_count; ++n) {
      const std::optional<NumberPlace> value = WriteValue(module_.Value(i, n));
      if (!value) return false;
      PlainOperation argument{.op = PlainOp::kArgument, .left = *value};
      argument.result = static_cast<std::uint16_t>(n - 1);
      argument.type = callee->module.parameter_types[argument.result];
      Write(argument);
    }
    PlainOperation call{.op = PlainOp::kFunction,
                        .result = static_cast<std::uint16_t>(i.value_count - 1),
                        .target = static_cast<std::uint32_t>(callee - executable_.modules.data())};
    call.next = next_;
    return Write(call);
  }

  // Postfix to operations: a stack of places, of which only results need a temporary. Where the
  // value lies then; nothing: it is not plain.
  std::optional<NumberPlace> WriteValue(Expression expression) {
    stack_.clear();
    for (const ExprNode& node : expression) {
      const int arity = Arity(node.op);
      if (arity == 0) {
        if (!PushLeaf(node)) return std::nullopt;
        continue;
      }
      PlainOperation operation{.op = OperationOf(node.op)};
      if (operation.op == PlainOp::kOperate) operation.node = node.op;
      operation.right = stack_.back();
      if (arity == 2) stack_.pop_back();
      operation.left = stack_.back();
      stack_.pop_back();
      if (!PushResult(operation)) return std::nullopt;
    }
    return stack_.back();
  }

  bool PushLeaf(const ExprNode& node) {
    if (node.op != Node::kVariable) {
      if (code_.constants_.size() >= kConstantsMax) return false;
      stack_.push_back({.index = static_cast<std::uint16_t>(code_.constants_.size())});
      code_.constants_.push_back(node.number);
      return true;
    }
    NoteRead(node.variable());
    if (const std::optional<Bank> bank = BankOf(node.group)) {
      const int index = *bank == Bank::kPar ? node.index % kParameterCount : node.index;
      stack_.push_back({.bank = *bank, .index = static_cast<std::uint16_t>(index)});
      return true;
    }
    PlainOperation truth{.left = {.index = node.index}};
    truth.op = node.group == VariableGroup::kVl ? PlainOp::kVl : PlainOp::kOl;
    return (node.group == VariableGroup::kVl || node.group == VariableGroup::kOl) &&
           PushResult(truth);
  }

  bool PushResult(PlainOperation operation) {
    if (temporaries_ >= kTemporariesMax) return false;
    operation.result = temporaries_++;
    stack_.push_back({.bank = Bank::kTemporary, .index = operation.result});
    return Write(operation);
  }

  // VI[98], VI[99]: the control has set them. PAR of a function: its caller.
  void NoteRead(Variable variable) {
    if (variable.group == VariableGroup::kVi && IsReadOnly(variable)) return;
    if (variable.group == VariableGroup::kPar && of_function_) return;
    const auto number = static_cast<std::uint16_t>(NumberOf(variable));
    PlainOperation& begin = code_.operations_[begin_];
    for (std::uint16_t* read : {&begin.result, &begin.left.index}) {
      if (*read == kAlwaysSet) *read = number;
      if (*read == number) return;
    }
    Write({.op = PlainOp::kKnow, .target = number});
  }

  PlainCode& code_;
  const Executable& executable_;
  const Module& module_;
  const ModuleIndex& index_;
  const bool of_function_;
  std::size_t begin_ = 0;   // of the step that is written
  std::uint32_t next_ = 0;  // instruction
  std::uint16_t temporaries_ = 0;
  std::vector<NumberPlace> stack_{};
};

PlainCode::PlainCode(const Executable& executable, std::size_t module, const ModuleIndex& index) {
  PlainWriter(*this, executable, module, index).WriteAll();
}

}  // namespace rmlcell::optimo
