#include "engine/optimo/control/plain_steps.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace rmlcell::optimo {
namespace {

// As ConvertTo does it; false: its error.
bool BecomesOfType(ValueType type, float& number) {
  if (type == ValueType::kReal) return true;
  if (type == ValueType::kLogical) {
    number = number != 0.0F ? 1.0F : 0.0F;
    return true;
  }
  constexpr auto kBelow = static_cast<float>(kIntegerMin - 1);
  constexpr auto kAbove = static_cast<float>(kIntegerMax + 1);
  if (!(number > kBelow && number < kAbove)) return false;
  number = static_cast<float>(static_cast<int>(number));
  return true;
}

// The activation in execution, and the numbers that its steps work with.
class PlainActivation {
 public:
  PlainActivation(ProgramCounter& counter, DataState& data, const OptimoParameters& parameters,
                  const Telling& telling)
      : counter_(counter), data_(data), parameters_(parameters), telling_(telling) {
    BankAt(Bank::kVr) = data.area.vr.data();
    BankAt(Bank::kVi) = data.area.vi.data();
    BankAt(Bank::kOa) = data.area.oa.data();
    BankAt(Bank::kTemporary) = temporaries_;
    Enter();
  }
  PlainActivation(const PlainActivation&) = delete;
  PlainActivation& operator=(const PlainActivation&) = delete;

  const PlainOperation* Next() const { return code_->At(frame_->next); }
  machine::Place PlaceOf(const PlainOperation& begin) const {
    const bool known = begin.target <= lines_.size();
    return {.program = slot_,
            .step = static_cast<int>(begin.target),
            .line = known ? lines_[begin.target - 1] : 0};
  }
  bool Knows(const PlainOperation& begin) const {
    return data_.written[begin.result] && data_.written[begin.left.index];
  }

  // From the first operation of a step on: that which ends it. Null: it is not as usual.
  const PlainOperation* Compute(const PlainOperation* at);

  // Carries out the step that ends with this operation: where it goes on. Null: it cannot, and
  // nothing was done.
  const PlainOperation* End(const PlainOperation& end);

 private:
  const float*& BankAt(Bank bank) { return banks_[static_cast<std::size_t>(bank)]; }
  float At(NumberPlace place) const {
    return banks_[static_cast<std::size_t>(place.bank)][place.index];
  }
  bool Put(const PlainOperation& operation, float number) {
    const bool good = BecomesReal(number);
    temporaries_[operation.result] = number;
    return good;
  }
  bool PutTruth(const PlainOperation& operation, bool truth) {
    temporaries_[operation.result] = truth ? 1.0F : 0.0F;
    return true;
  }
  bool PutOutcome(const PlainOperation& operation) {
    const Outcome outcome = Operate(operation.node, At(operation.left), At(operation.right));
    temporaries_[operation.result] = outcome.number;
    return outcome.good;
  }
  bool PutArgument(const PlainOperation& operation) {
    arguments_[operation.result] = At(operation.left);
    return BecomesOfType(operation.type, arguments_[operation.result]);
  }
  // How many operations it passes over: those of a table up to the one that is selected.
  std::size_t Selected(const PlainOperation& operation) const {
    const float selected = std::trunc(At(operation.left));
    const bool one = selected >= 1.0F && selected <= static_cast<float>(operation.result);
    return one ? static_cast<std::size_t>(selected) - 1 : operation.result;
  }

  const PlainOperation* GoOn(const PlainOperation& end) {
    frame_->next = end.target;
    return &end + 1;
  }
  const PlainOperation* GoTo(std::uint32_t instruction) {
    frame_->next = instruction;
    return Next();
  }
  // `end` is followed by one with the other target.
  const PlainOperation* GoIf(bool truth, const PlainOperation& end) {
    return GoTo((truth ? &end : &end + 1)->target);
  }
  const PlainOperation* SetVr(const PlainOperation& end, float number) {
    data_.area.vr[end.result] = number;
    return Set(end, VariableGroup::kVr);
  }
  // Of the result of an operation.
  const PlainOperation* PutVr(const PlainOperation& end, float number) {
    return BecomesReal(number) ? SetVr(end, number) : nullptr;
  }
  const PlainOperation* Set(const PlainOperation& end, VariableGroup group);
  const PlainOperation* Gosub(const PlainOperation& end);
  const PlainOperation* Return();
  const PlainOperation* Call(const PlainOperation& end);
  const PlainOperation* Enter();

  ProgramCounter& counter_;
  DataState& data_;
  const OptimoParameters& parameters_;
  const Telling& telling_;
  Frame* frame_ = nullptr;
  const PlainCode* code_ = nullptr;
  int slot_ = 0;
  std::span<const int> lines_{};
  std::array<const float*, kBanks> banks_{};
  std::array<float, kParameterCount> arguments_{};  // of the call that is made
  float temporaries_[kTemporariesMax];              // written before they are read
};

// Operations that loops consist of stand here as in Operate, so that none of them is a call.
inline const PlainOperation* PlainActivation::Compute(const PlainOperation* at) {
  for (;; ++at) {
    bool good = true;
    switch (at->op) {
      case PlainOp::kAdd:
        good = Put(*at, At(at->left) + At(at->right));
        break;
      case PlainOp::kSubtract:
        good = Put(*at, At(at->left) - At(at->right));
        break;
      case PlainOp::kMultiply:
        good = Put(*at, At(at->left) * At(at->right));
        break;
      case PlainOp::kDivide:
        good = At(at->right) != 0.0F && Put(*at, At(at->left) / At(at->right));
        break;
      case PlainOp::kLess:
        good = PutTruth(*at, At(at->left) < At(at->right));
        break;
      case PlainOp::kLessEqual:
        good = PutTruth(*at, At(at->left) <= At(at->right));
        break;
      case PlainOp::kEqual:
        good = PutTruth(*at, At(at->left) == At(at->right));
        break;
      case PlainOp::kGreaterEqual:
        good = PutTruth(*at, At(at->left) >= At(at->right));
        break;
      case PlainOp::kGreater:
        good = PutTruth(*at, At(at->left) > At(at->right));
        break;
      case PlainOp::kNotEqual:
        good = PutTruth(*at, At(at->left) != At(at->right));
        break;
      case PlainOp::kOperate:
        good = PutOutcome(*at);
        break;
      case PlainOp::kVl:
        good = PutTruth(*at, data_.area.vl[at->left.index]);
        break;
      case PlainOp::kOl:
        good = PutTruth(*at, data_.area.ol[at->left.index]);
        break;
      case PlainOp::kKnow:
        good = data_.written[at->target];
        break;
      case PlainOp::kArgument:
        good = PutArgument(*at);
        break;
      case PlainOp::kSelect:
        at += Selected(*at);
        break;
      default:
        return at;
    }
    if (!good) return nullptr;
  }
}

inline const PlainOperation* PlainActivation::End(const PlainOperation& end) {
  switch (end.op) {
    case PlainOp::kSetVr:
      return SetVr(end, At(end.left));
    case PlainOp::kVrAdd:
      return PutVr(end, At(end.left) + At(end.right));
    case PlainOp::kVrSubtract:
      return PutVr(end, At(end.left) - At(end.right));
    case PlainOp::kVrMultiply:
      return PutVr(end, At(end.left) * At(end.right));
    case PlainOp::kVrDivide:
      return At(end.right) != 0.0F ? PutVr(end, At(end.left) / At(end.right)) : nullptr;
    case PlainOp::kSetVi: {
      float number = At(end.left);
      if (!BecomesOfType(ValueType::kInteger, number)) return nullptr;
      data_.area.vi[end.result] = number;
      return Set(end, VariableGroup::kVi);
    }
    case PlainOp::kSetVl:
      data_.area.vl[end.result] = At(end.left) != 0.0F;
      return Set(end, VariableGroup::kVl);
    case PlainOp::kSetPar: {
      float number = At(end.left);
      if (!BecomesOfType(end.type, number)) return nullptr;
      frame_->parameters[end.result % kParameterCount] = number;
      return Set(end, VariableGroup::kPar);
    }
    case PlainOp::kGoTo:
      return GoTo(end.target);
    case PlainOp::kIf:
      return GoIf(At(end.left) != 0.0F, end);
    case PlainOp::kIfLess:
      return GoIf(At(end.left) < At(end.right), end);
    case PlainOp::kIfLessEqual:
      return GoIf(At(end.left) <= At(end.right), end);
    case PlainOp::kIfEqual:
      return GoIf(At(end.left) == At(end.right), end);
    case PlainOp::kIfGreaterEqual:
      return GoIf(At(end.left) >= At(end.right), end);
    case PlainOp::kIfGreater:
      return GoIf(At(end.left) > At(end.right), end);
    case PlainOp::kIfNotEqual:
      return GoIf(At(end.left) != At(end.right), end);
    case PlainOp::kGosub:
      return Gosub(end);
    case PlainOp::kReturn:
      return Return();
    case PlainOp::kFunction:
      return Call(end);
    default:
      return GoOn(end);
  }
}

// The variable has got its value.
inline const PlainOperation* PlainActivation::Set(const PlainOperation& end, VariableGroup group) {
  data_.written[NumberOf({group, static_cast<std::uint8_t>(end.result)})] = true;
  return GoOn(end);
}

const PlainOperation* PlainActivation::Gosub(const PlainOperation& end) {
  if (frame_->returns.size() >= static_cast<std::size_t>(parameters_.gosub_depth)) return nullptr;
  frame_->returns.push_back(end.next);
  return GoTo(end.target);
}

const PlainOperation* PlainActivation::Return() {
  if (counter_.in_gosub()) {
    frame_->next = frame_->returns.back();
    frame_->returns.pop_back();
    return Next();
  }
  if (!counter_.in_function()) return nullptr;
  counter_.LeaveFunction();
  return Enter();
}

const PlainOperation* PlainActivation::Call(const PlainOperation& end) {
  if (counter_.level() > ProgramCounter::kFunctionLevels) return nullptr;
  std::fill(arguments_.begin() + end.result, arguments_.end(), 0.0F);
  frame_->next = end.next;
  counter_.EnterFunction(counter_.program().program->executable.modules[end.target], arguments_);
  return Enter();
}

// The innermost activation is another one now.
const PlainOperation* PlainActivation::Enter() {
  ProgramContext& context = counter_.program();
  frame_ = &context.frames.back();
  const auto module = static_cast<std::size_t>(frame_->module);
  code_ = &context.program->plain[module];
  slot_ = context.program->executable.modules[module].slot;
  lines_ = telling_.LinesOf(slot_);
  BankAt(Bank::kPar) = frame_->parameters.data();
  BankAt(Bank::kConstant) = code_->constants().data();
  return Next();
}

}  // namespace

bool PlainSteps::come() const {
  const Frame& frame = counter_.frame();
  const PlainCode& code = counter_.program().program->plain[static_cast<std::size_t>(frame.module)];
  return code.At(frame.next)->op == PlainOp::kBegin;
}

// The place may be that of a step that is refused: Fetch comes to it at once.
PlainSteps::Done PlainSteps::CarryOut(std::uint64_t most) {
  PlainActivation activation(counter_, data_, parameters_, telling_);
  const PlainOperation* at = activation.Next();
  Done done;
  while (done.steps < most && at->op == PlainOp::kBegin && activation.Knows(*at)) {
    const PlainOperation& begin = *at;
    situation_.place = activation.PlaceOf(begin);
    const PlainOperation* end = activation.Compute(at + 1);
    if (end == nullptr) break;
    at = activation.End(*end);
    if (at == nullptr) break;
    done.last = begin.instruction;
    ++done.steps;
    telling_.observer().OnStep(situation_.now, situation_.place, Describe(done.last).name);
  }
  return done;
}

}  // namespace rmlcell::optimo
