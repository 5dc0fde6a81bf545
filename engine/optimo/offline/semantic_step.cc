#include "engine/optimo/offline/semantic_step.h"

#include <array>
#include <bit>
#include <cmath>

#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

bool IsPlain(Expression value) { return value.size() == 1 && value[0].op != Node::kVariable; }

void Append(std::uint32_t value, std::string& to) {
  for (const char byte : std::bit_cast<std::array<char, sizeof(value)>>(value)) to += byte;
}

// Names stand for what they were declared as; 5, 5.0 and a constant of that value are the same, as
// are 1 and ON where a logical value stands. A negative zero is zero.
void AppendMeaning(Expression value, std::string& to) {
  for (const ExprNode& node : value) {
    if (node.op == Node::kVariable) {
      to += 'v';
      to += static_cast<char>(node.group);
      to += static_cast<char>(node.index);
    } else if (Arity(node.op) == 0) {
      to += node.type == ValueType::kLogical ? 'l' : 'n';
      Append(std::bit_cast<std::uint32_t>(node.number == 0.0F ? 0.0F : node.number), to);
    } else {
      to += 'o';
      to += static_cast<char>(node.op);
    }
  }
  to += ';';
}

// With names replaced by what they stand for: the same name may be declared differently.
std::string Text(const Module& module, Expression value) {
  std::vector<ExprNode> nodes(value.begin(), value.end());
  for (ExprNode& node : nodes) node.name = node.index_name = kNoName;
  std::string out;
  PrintExpression(module, nodes, out);
  return out;
}

// Plain values in one spelling, others as they are written.
std::string ValueText(const Module& module, Expression value) {
  if (!IsPlain(value) || value[0].op == Node::kLogical || value[0].type == ValueType::kLogical)
    return Text(module, value);
  std::string out;
  PrintReal(value[0].number == 0.0F ? 0.0F : value[0].number, out);
  return out;
}

bool IsFolded(Op op) {
  return op == Op::kSpeed || op == Op::kAccel || op == Op::kOversh || op == Op::kPath;
}

unsigned AspectsOfTarget(const Module& module, const Instruction& i) {
  const VariableGroup group = module.Value(i, 0)[0].group;
  return group == VariableGroup::kOl || group == VariableGroup::kOa ? kAspectOutputs : kAspectData;
}

unsigned AspectsOf(const Module& module, const Instruction& i) {
  switch (i.op) {
    case Op::kMove:
    case Op::kZero:
    case Op::kOversh:
      return kAspectPath | kAspectTime;
    case Op::kCoord:
    case Op::kPath:
    case Op::kSysdef:
    case Op::kTcp:
      return kAspectPath;
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kDelay:
    case Op::kWait:
      return kAspectTime;
    case Op::kWork:
    case Op::kWorkdef:
      return i.numbers[0] == 1 ? kAspectPower | kAspectTime : unsigned{kAspectPower};
    case Op::kLet:
    case Op::kAssign:
      return AspectsOfTarget(module, i);
    case Op::kUpdate:
    case Op::kImage:
    case Op::kReal:
      return kAspectOutputs;
    case Op::kDefine:
      return kAspectData;
    case Op::kStop:
    case Op::kPause:
      return kAspectFlow | kAspectTime;
    default:
      return kAspectFlow;
  }
}

std::string KindOf(const Module& module, const Instruction& i) {
  std::string kind(1, static_cast<char>(i.op));
  if (i.op == Op::kLet || i.op == Op::kAssign) AppendMeaning(module.Value(i, 0), kind);
  if (i.op == Op::kWork || i.op == Op::kWorkdef) {
    kind += static_cast<char>(i.numbers[0]);
    kind += static_cast<char>(i.numbers[1]);
    if (i.Has(kOn)) kind += '+';
  }
  return kind;
}

void TakeModal(const Module& module, const Instruction& i, ModalValues& modal) {
  if (i.op == Op::kPath) {
    modal.path.clear();
    PrintStatement(module, i, modal.path);
    return;
  }
  std::string& value = i.op == Op::kSpeed   ? modal.speed
                       : i.op == Op::kAccel ? modal.accel
                                            : modal.oversh;
  value = ValueText(module, module.Value(i, 0));
}

// ENDTASK at the end is assumed where it does not stand. OPT-3.46
std::size_t EndOfSteps(const Module& module) {
  std::size_t end = module.instructions.size();
  while (end > 0 && (module.instructions[end - 1].op == Op::kDeclare ||
                     module.instructions[end - 1].op == Op::kIgnored ||
                     module.instructions[end - 1].op == Op::kEndtask)) {
    --end;
  }
  return end;
}

void Note(StepDifference& to, unsigned aspects, const std::string& name, const std::string& before,
          const std::string& after) {
  if (before == after) return;
  to.aspects |= aspects;
  to.what.push_back(name + (name.empty() ? "" : " ") + before + " -> " + after);
}

unsigned AspectsOfAttribute(std::uint16_t bit, unsigned otherwise) {
  if (bit == kFly || bit == kEnd || bit == kTime || bit == kNext) return kAspectPath | kAspectTime;
  if (bit == kVia) return kAspectPath;
  if (bit == kStart) return kAspectTime;
  return otherwise;
}

constexpr std::array<const char*, 5> kAxes = {"X", "Y", "Z", "A", "B"};

void CompareMove(const Module& a, const Instruction& i, const Module& b, const Instruction& j,
                 StepDifference& to) {
  double moved2 = 0.0;
  bool plain = true;
  for (int v = 0; v < 5; ++v) {
    const Expression before = a.Value(i, v), after = b.Value(j, v);
    Note(to, kAspectPath, kAxes[static_cast<std::size_t>(v)], ValueText(a, before),
         ValueText(b, after));
    if (v > 2) continue;
    plain = plain && IsPlain(before) && IsPlain(after);
    if (!plain) continue;
    const double d = static_cast<double>(after[0].number) - static_cast<double>(before[0].number);
    moved2 += d * d;
  }
  if (plain) to.target_moved_mm = std::sqrt(moved2);
  for (int v = 0; v < 5 && i.Has(kVia) && j.Has(kVia); ++v) {
    Note(to, kAspectPath, std::string("via ") + kAxes[static_cast<std::size_t>(v)],
         ValueText(a, a.Via(i, v)), ValueText(b, b.Via(j, v)));
  }
}

}  // namespace

bool CanFold(const Module& a, const Module& b) {
  for (const Module* module : {&a, &b}) {
    for (const Instruction& i : module->instructions) {
      if (i.target_count > 0 || i.op == Op::kFunction) return false;
      if (!IsFolded(i.op)) continue;
      for (int v = 0; v < i.value_count; ++v) {
        if (!IsPlain(module->Value(i, v))) return false;
      }
    }
  }
  return true;
}

std::vector<SemanticStep> StepsOf(const Module& module, bool fold) {
  std::vector<SemanticStep> steps;
  ModalValues modal;
  const std::size_t end = EndOfSteps(module);
  for (std::uint32_t at = 0; at < end; ++at) {
    const Instruction& i = module.instructions[at];
    if (i.op == Op::kDeclare || i.op == Op::kIgnored) continue;
    if (fold && IsFolded(i.op)) {
      TakeModal(module, i, modal);
      continue;
    }
    SemanticStep step;
    step.instruction = at;
    step.kind = KindOf(module, i);
    step.aspects = AspectsOf(module, i);
    step.meaning += static_cast<char>(i.op);
    step.meaning += static_cast<char>(i.choice);
    for (const std::uint32_t number :
         {std::uint32_t{i.attributes}, std::uint32_t{i.numbers[0]}, std::uint32_t{i.numbers[1]},
          std::uint32_t{i.target_count}}) {
      Append(number, step.meaning);
    }
    const std::uint32_t expressions = module.ExpressionCount(i);
    for (std::uint32_t e = 0; e < expressions; ++e)
      AppendMeaning(module.expression(i.first_expression + e), step.meaning);
    if (fold && i.op == Op::kMove) {
      step.modal = modal;
      step.meaning += modal.path + '|' + modal.speed + '|' + modal.accel + '|' + modal.oversh;
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

StepDifference Compare(const Module& a, const SemanticStep& step_a, const Module& b,
                       const SemanticStep& step_b) {
  StepDifference to;
  if (step_a.meaning == step_b.meaning) return to;
  const Instruction& i = a.instructions[step_a.instruction];
  const Instruction& j = b.instructions[step_b.instruction];
  Note(to, kAspectPath, "", step_a.modal.path, step_b.modal.path);
  Note(to, kAspectTime, "SPEED", step_a.modal.speed, step_b.modal.speed);
  Note(to, kAspectTime, "ACCEL", step_a.modal.accel, step_b.modal.accel);
  Note(to, kAspectPath | kAspectTime, "OVERSH", step_a.modal.oversh, step_b.modal.oversh);
  for (const AttributeInfo& attribute : kAttributes) {
    const bool before = i.Has(attribute.bit), after = j.Has(attribute.bit);
    if (before == after) continue;
    to.aspects |= AspectsOfAttribute(attribute.bit, step_b.aspects);
    to.what.push_back("/" + std::string(Describe(attribute.word).text) +
                      (after ? " added" : " removed"));
  }
  for (const Attribute bit : {kStart, kEnd, kTime}) {
    if (!i.Has(bit) || !j.Has(bit)) continue;
    const auto value = [bit](const Module& module, const Instruction& of) {
      return ValueText(module, bit == kStart ? module.Start(of)
                               : bit == kEnd ? module.End(of)
                                             : module.Time(of));
    };
    Note(to, AspectsOfAttribute(bit, 0),
         bit == kStart ? "/START"
         : bit == kEnd ? "/END"
                       : "/TIME",
         value(a, i), value(b, j));
  }
  if (i.op == Op::kMove) {
    CompareMove(a, i, b, j, to);
  } else {
    std::string before, after;
    PrintStatement(a, i, before);
    PrintStatement(b, j, after);
    Note(to, step_b.aspects, "", before, after);
    // Written alike, with names that stand for something else.
    for (std::uint32_t e = 0; before == after && e < a.ExpressionCount(i); ++e) {
      Note(to, step_b.aspects, "", Text(a, a.expression(i.first_expression + e)),
           Text(b, b.expression(j.first_expression + e)));
    }
  }
  return to;
}

}  // namespace rmlcell::optimo
