#include "engine/optimo/language/typing.h"

#include <utility>

#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/lexer.h"
#include "engine/optimo/language/nearest_word.h"

namespace rmlcell::optimo {
namespace {

std::string NameText(const Module& module, std::uint16_t name) {
  char room[kNameLength];
  return std::string(UnpackName(module.names[name].key, room));
}

bool IsArithmetic(Node op) { return op >= Node::kPower && op <= Node::kSubtract; }
bool IsLogicalOperator(Node op) { return op >= Node::kAnd; }

}  // namespace

Place Typing::PlaceOfStatement() const {
  if (places_ == nullptr) return {.step = static_cast<int>(instruction_->step)};
  return places_->At(*instruction_);
}

// The places of one statement are asked for as long as it has findings.
NodePlace Typing::NodePlaceOf(std::size_t node) {
  if (placed_ != instruction_) node_places_ = places_->NodePlacesOf(*instruction_);
  placed_ = instruction_;
  return node_places_[node - module_.FirstNode(instruction_->first_expression)];
}

Place Typing::PlaceOfNode(std::size_t node) {
  // Of what is only counted the line is enough: nothing is read again for it.
  if (places_ == nullptr || findings_.full()) return PlaceOfStatement();
  const NodePlace place = NodePlaceOf(node);
  return {place.offset, static_cast<int>(place.length), static_cast<int>(instruction_->step)};
}

Place Typing::PlaceOfName(std::size_t node) {
  Place at = PlaceOfStatement();
  if (places_ == nullptr) return at;
  const NodePlace place = NamePlaceOf(node);
  at.offset = place.offset;
  at.length = static_cast<int>(place.length);
  return at;
}

// Where its name stands: of a variable with an index by name only that.
NodePlace Typing::NamePlaceOf(std::size_t node) {
  NodePlace place = NodePlaceOf(node);
  if (module_.nodes[node].index_name == kNoName) return place;
  // Inside a parenthesis a variable may stand on several lines. OPT-1.30
  std::string inside = "(";
  inside += places_->text.substr(place.offset, place.length);
  std::vector<Comment> comments;
  Lexer lexer(inside, comments);
  lexer.NextStatement();
  const Token& name = lexer.At(3);  // behind '(', the group and '['
  return {place.offset + name.offset - 1, name.length};
}

void Typing::Report(ErrorCode code, std::size_t node, Detail detail, std::string_view rule) {
  findings_.Add(code, PlaceOfNode(node), std::move(detail), rule);
}

bool Typing::IsDeclaredBelow(std::uint16_t name) {
  if (declared_anywhere_.empty()) {
    declared_anywhere_.resize(module_.names.size());
    for (const Instruction& i : module_.instructions) {
      if (i.op == Op::kDeclare) declared_anywhere_[i.name] = true;
    }
  }
  return declared_anywhere_[name];
}

// Those that would not be another error there.
std::vector<std::uint16_t> Typing::NamesFor(Use use) const {
  std::vector<std::uint16_t> names;
  for (const std::uint16_t name : declared_names_) {
    const Node op = module_.names[name].value.op;
    const bool fits = use == Use::kValue || (use == Use::kTarget && op == Node::kVariable) ||
                      (use == Use::kIndex && op == Node::kInteger);
    if (fits) names.push_back(name);
  }
  return names;
}

void Typing::ReportUndeclared(std::uint16_t name, std::size_t node, Use use) {
  if (places_ != nullptr && broken_names_[name]) return;
  if (findings_.full()) return Report(ErrorCode::kNameUndeclared, node, {}, {});
  if (IsDeclaredBelow(name)) {
    findings_.Add(ErrorCode::kNameUndeclared, PlaceOfName(node),
                  Told("name", NameText(module_, name)) + " is not declared before it is used",
                  "OPT-7.50");
    return;
  }
  std::vector<std::string_view> candidates;
  const NameCandidates names(module_, NamesFor(use));
  names.AppendTo(candidates);
  const std::string text = NameText(module_, name);
  const NearWords near = NearestWords(text, candidates);
  std::vector<Fix> fixes;
  const Place at = PlaceOfName(node);
  if (places_ != nullptr && IsSurelyName(text, near))
    fixes.push_back({at.offset, at.length, near.words.front()});
  findings_.Add(ErrorCode::kNameUndeclared, at,
                Told("name", text) + " is not declared" + QuestionFor(near), "OPT-7.50",
                std::move(fixes));
}

void Typing::UseVariable(const ExprNode& node) {
  if (node.group == VariableGroup::kPar) parameter_used_[node.index] = true;
  if (node.group == VariableGroup::kIl || node.group == VariableGroup::kIa ||
      (node.group == VariableGroup::kOa && node.index == 0)) {
    reads_machine_ = true;
  }
}

// An index by name: an INTEGER constant inside the range. OPT-7.60
bool Typing::ResolveIndex(std::size_t at) {
  ExprNode& node = module_.nodes[at];
  if (node.index_name == kNoName) return true;
  const DeclaredName& name = module_.names[node.index_name];
  if (!name.declared) {
    ReportUndeclared(node.index_name, at, Use::kIndex);
    return false;
  }
  const int max = node.group == VariableGroup::kPar ? kParameterCount - 1 : kVariableIndexMax;
  const float value = name.value.number;
  if (name.value.op != Node::kInteger || value < 0.0F || value > static_cast<float>(max)) {
    Report(ErrorCode::kIndexRange, at,
           Told("name", NameText(module_, node.index_name)) + " is no INTEGER constant from 0 to " +
               Told("most", max),
           "OPT-7.60");
    return false;
  }
  node.index = static_cast<std::uint8_t>(value);
  return true;
}

bool Typing::ResolveNode(std::size_t at, Use use) {
  ExprNode& node = module_.nodes[at];
  if (node.op == Node::kVariable && node.name == kNoName) {
    if (!ResolveIndex(at)) return false;
    UseVariable(node);
    return true;
  }
  if (node.op != Node::kName) return true;
  const DeclaredName& name = module_.names[node.name];
  if (!name.declared) {
    ReportUndeclared(node.name, at, use);
    return false;
  }
  const std::uint16_t keep = node.name;
  node = name.value;
  node.name = keep;
  if (node.op == Node::kVariable) UseVariable(node);
  return true;
}

// 0 and 1 are logical where a logical value is wanted. OPT-B.45
bool Typing::MakeLogical(Operand& operand) {
  if (operand.type == ValueType::kLogical) return true;
  ExprNode& node = module_.nodes[operand.node];
  if (node.op != Node::kInteger || (node.number != 0.0F && node.number != 1.0F)) return false;
  node.type = operand.type = ValueType::kLogical;
  return true;
}

bool Typing::NeedNumeric(const Operand& operand) {
  if (operand.unknown) return false;
  if (operand.type != ValueType::kLogical) return true;
  Report(ErrorCode::kTypeMismatch, operand.node, "a logical value where a number is needed",
         "OPT-7.89");
  return false;
}

bool Typing::NeedLogical(Operand& operand) {
  if (operand.unknown) return false;
  if (MakeLogical(operand)) return true;
  Report(ErrorCode::kTypeMismatch, operand.node, "a number where a logical value is needed",
         "OPT-7.89");
  return false;
}

bool Typing::TypeBinary(std::size_t at, Operand& a, Operand& b) {
  ExprNode& node = module_.nodes[at];
  if (IsLogicalOperator(node.op)) {
    node.type = ValueType::kLogical;
    const bool first = NeedLogical(a);
    return NeedLogical(b) && first;
  }
  node.type = IsArithmetic(node.op) ? ValueType::kReal : ValueType::kLogical;
  const bool equality = node.op == Node::kEqual || node.op == Node::kNotEqual;
  const bool logical = a.type == ValueType::kLogical || b.type == ValueType::kLogical;
  if (equality && logical) {  // OPT-7.85
    if (a.unknown || b.unknown) return false;
    if (MakeLogical(a) && MakeLogical(b)) return true;
    Report(ErrorCode::kTypeMismatch, at, "a logical value is compared with a number", "OPT-7.85");
    return false;
  }
  const bool first = NeedNumeric(a);
  return NeedNumeric(b) && first;
}

ValueType Typing::TypeOfLeaf(const ExprNode& node) const {
  switch (node.op) {
    case Node::kInteger:
      return ValueType::kInteger;
    case Node::kLogical:
      return ValueType::kLogical;
    case Node::kVariable:
      return node.group == VariableGroup::kPar ? module_.parameter_types[node.index]
                                               : TypeOf(node.group);
    default:
      return ValueType::kReal;
  }
}

Typing::Operand Typing::TypeLeaf(std::size_t at) {
  const bool known = ResolveNode(at);
  ExprNode& node = module_.nodes[at];
  node.type = TypeOfLeaf(node);
  const bool of_broken = places_ != nullptr && node.op == Node::kVariable &&
                         node.group == VariableGroup::kPar &&
                         places_->broken_parameters[node.index];
  return {at, node.type, !known || of_broken};
}

bool Typing::HasType(Operand& root, Wanted wanted) {
  if (root.unknown || wanted == Wanted::kAny) return !root.unknown;
  return wanted == Wanted::kNumeric ? NeedNumeric(root) : NeedLogical(root);
}

bool Typing::Type(std::uint32_t expression, Wanted wanted) {
  const ExprRange range = module_.Range(expression);
  if (range.count == 1) {
    Operand leaf = TypeLeaf(range.first);
    return HasType(leaf, wanted);
  }
  stack_.clear();
  for (std::size_t at = range.first; at < range.first + range.count; ++at) {
    const Node op = module_.nodes[at].op;
    const int arity = Arity(op);
    if (arity == 0) {
      stack_.push_back(TypeLeaf(at));
      if (stack_.size() > kOperandStackMax) {
        Report(ErrorCode::kSyntax, at, "the expression has too many pending operands; split it",
               {});
        return false;
      }
      continue;
    }
    Operand result{at, ValueType::kReal, false};
    if (arity == 1) {
      module_.nodes[at].type = op == Node::kNot ? ValueType::kLogical : ValueType::kReal;
      result.unknown = op == Node::kNot ? !NeedLogical(stack_.back()) : !NeedNumeric(stack_.back());
      stack_.pop_back();
    } else {
      Operand second = stack_.back();
      stack_.pop_back();
      result.unknown = !TypeBinary(at, stack_.back(), second);
      stack_.pop_back();
    }
    result.type = module_.nodes[at].type;
    stack_.push_back(result);
  }
  return HasType(stack_.back(), wanted);
}

bool Typing::ResolveTarget(std::uint32_t expression) {
  const std::size_t at = module_.FirstNode(expression);
  if (!ResolveNode(at, Use::kTarget)) return false;
  ExprNode& node = module_.nodes[at];
  if (node.op != Node::kVariable) {
    Report(ErrorCode::kConstantAssigned, at,
           Told("name", NameText(module_, node.name)) + " is a constant", "OPT-7.43");
    return false;
  }
  node.type = TypeOfLeaf(node);
  if (IsReadOnly(node.variable())) {
    Report(ErrorCode::kReadOnly, at, ToldVariable(node.variable()) + " can only be read",
           "OPT-7.66");
    return false;
  }
  return true;
}

void Typing::Declare(const Instruction& instruction) {
  DeclaredName& name = module_.names[instruction.name];
  const std::size_t at = module_.FirstNode(instruction.first_expression);
  if (!ResolveNode(at)) {
    if (places_ == nullptr) return Report(ErrorCode::kNameUndeclared, at, {}, {});
    broken_names_[instruction.name] = true;
    return;
  }
  ExprNode& node = module_.nodes[at];
  node.type = TypeOfLeaf(node);
  name.declared = true;
  declared_names_.push_back(instruction.name);
  name.value = node;
  name.value.index_name = kNoName;
}

void Typing::Define(const Instruction& instruction) {
  const std::size_t index = instruction.numbers[0];
  const auto par = [index] { return "PAR[" + Told("index", index) + "]"; };
  if (std::exchange(parameter_defined_[index], true)) {
    findings_.Add(ErrorCode::kDefineInvalid, PlaceOfStatement(), par() + " is defined already",
                  "OPT-B.88");
  } else if (parameter_used_[index]) {
    findings_.Add(ErrorCode::kDefineAfterUse, PlaceOfStatement(), par() + " was used before",
                  "OPT-9.25");
  }
  module_.parameter_types[index] = static_cast<ValueType>(instruction.choice);
}

}  // namespace rmlcell::optimo
