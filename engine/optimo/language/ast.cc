#include "engine/optimo/language/ast.h"

#include <algorithm>
#include <bit>

#include "engine/optimo/language/evaluate.h"

namespace rmlcell::optimo {

std::string_view TypeName(ValueType type) {
  switch (type) {
    case ValueType::kReal:
      return "REAL";
    case ValueType::kInteger:
      return "INTEGER";
    case ValueType::kLogical:
      return "LOGICAL";
  }
  return "";
}

std::string_view GroupName(VariableGroup group) {
  constexpr std::array<std::string_view, 8> kNames = {"VR", "VI", "VL", "IL",
                                                      "OL", "IA", "OA", "PAR"};
  return kNames[static_cast<std::size_t>(group)];
}

Detail ToldVariable(Variable variable) {
  return Told("variable",
              std::string(GroupName(variable.group)) + "[" + std::to_string(variable.index) + "]");
}

ValueType TypeOf(VariableGroup group) {
  switch (group) {
    case VariableGroup::kVi:
      return ValueType::kInteger;
    case VariableGroup::kVl:
    case VariableGroup::kIl:
    case VariableGroup::kOl:
      return ValueType::kLogical;
    default:
      return ValueType::kReal;
  }
}

bool IsReadOnly(Variable variable) {
  switch (variable.group) {
    case VariableGroup::kIl:
    case VariableGroup::kIa:
      return true;
    case VariableGroup::kOa:
      return variable.index == 0;
    case VariableGroup::kVi:
      return variable.index >= 98;
    default:
      return false;
  }
}

bool IsLiteral(const ExprNode& node) {
  return node.name == kNoName && (node.op == Node::kInteger || node.op == Node::kReal);
}

ExprNode NegatedLiteral(const ExprNode& literal) {
  ExprNode negated = literal;
  negated.number = literal.number == 0.0F ? 0.0F : -literal.number;
  if (negated.number > static_cast<float>(kIntegerMax)) negated.op = Node::kReal;  // -(-32768)
  return negated;
}

Expression Module::Via(const Instruction& i, int position) const {
  return expression(i.first_expression + i.value_count + static_cast<std::uint32_t>(position));
}
Expression Module::Start(const Instruction& i) const {
  return expression(i.first_expression + i.value_count + (i.Has(kVia) ? 5U : 0U));
}
Expression Module::End(const Instruction& i) const {
  return expression(i.first_expression + i.value_count + (i.Has(kVia) ? 5U : 0U) +
                    (i.Has(kStart) ? 1U : 0U));
}
Expression Module::Time(const Instruction& i) const {
  return expression(i.first_expression + ExpressionCount(i) - 1);
}
std::uint16_t Module::TimeLabel(const Instruction& i) const {
  return targets[i.first_target + i.target_count - 1];
}

std::span<const std::uint16_t> Module::Targets(const Instruction& i) const {
  const std::size_t count = i.target_count - (i.Has(kTime) ? 1U : 0U);
  return {targets.data() + i.first_target, count};
}

std::uint32_t Module::ExpressionCount(const Instruction& i) const {
  return i.value_count + (i.Has(kVia) ? 5U : 0U) +
         static_cast<std::uint32_t>(
             std::popcount(static_cast<unsigned>(i.attributes & (kStart | kEnd | kTime))));
}

ModuleIndex::ModuleIndex(const Module& module) : module_(&module) {
  const auto count = static_cast<std::uint32_t>(module.instructions.size());
  const auto set_label = [this](std::uint16_t label, std::uint32_t index) {
    if (by_label_.size() <= label) by_label_.resize(label + 1U, kNoIndex);
    by_label_[label] = index;
  };
  by_step_.reserve(module.step_count);
  bool task_found = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Instruction& instruction = module.instructions[i];
    if (instruction.step > 0) by_step_.push_back(i);
    if (instruction.label_count > 0) {
      const std::uint32_t target = SkipDeclares(i);
      for (const std::uint16_t label : module.Labels(instruction)) set_label(label, target);
    }
    if (instruction.op == Op::kTask && instruction.numbers[0] == 1 && !task_found) {
      task_found = true;
      entry_ = i;
    }
  }
  for (const std::uint16_t label : module.end_labels) set_label(label, count);
  if (!task_found) entry_ = SkipDeclares(0);
}

std::optional<std::uint32_t> ModuleIndex::FindLabel(int label) const {
  if (label < 0 || static_cast<std::size_t>(label) >= by_label_.size()) return std::nullopt;
  const std::uint32_t index = by_label_[static_cast<std::size_t>(label)];
  if (index == kNoIndex) return std::nullopt;
  return index;
}

std::optional<std::uint32_t> ModuleIndex::FindStep(std::uint32_t step) const {
  if (step == 0 || step > by_step_.size()) return std::nullopt;
  return by_step_[step - 1];
}

std::uint32_t ModuleIndex::SkipDeclares(std::uint32_t index) const {
  const auto count = static_cast<std::uint32_t>(module_->instructions.size());
  while (index < count && module_->instructions[index].op == Op::kDeclare) ++index;
  return index;
}

}  // namespace rmlcell::optimo
