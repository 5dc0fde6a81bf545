#include "engine/optimo/offline/convert.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/language/units_of_variables.h"
#include "engine/optimo/offline/cutter_directive.h"
#include "engine/optimo/offline/literal_text.h"
#include "engine/optimo/offline/text_edits.h"

namespace rmlcell::optimo {
namespace {

constexpr int kConvertDecimals = 6;  // OPT-8.28
constexpr std::size_t kFindingsMax = 1000;

bool IsRelation(Node op) { return op >= Node::kLess && op <= Node::kNotEqual; }
bool IsLogicalOperator(Node op) { return op == Node::kNot || op >= Node::kAnd; }
bool IsFunction(Node op) { return op >= Node::kSin && op <= Node::kInt; }
bool IsLiteral(Node op) { return op == Node::kInteger || op == Node::kReal; }

class Converter {
 public:
  Converter(const ParsedProgram& program, Direction direction, Findings& findings)
      : p_(program), module_(program.module), direction_(direction), findings_(findings) {
    names_.resize(module_.names.size());
  }

  std::vector<Fix> Run() {
    const std::vector<bool> faulty = FaultyStatements();
    auto label = p_.mislabelled.begin();
    for (std::size_t s = 0; s < module_.instructions.size(); ++s) {
      const Instruction& i = module_.instructions[s];
      const bool mislabelled = label != p_.mislabelled.end() && *label == s;
      if (mislabelled) ++label;
      if (faulty[s]) continue;
      if (mislabelled) {
        if (i.op == Op::kDeclare) Declare(i);  // the name is known all the same
        continue;
      }
      if (p_.statements[s].tokens > kConvertTokensMax) {
        findings_.Add(ErrorCode::kConvertLine, p_.At(i),
                      "more than 200 symbols; the line is copied", "OPT-8.65");
        continue;
      }
      instruction_ = &i;
      reported_ = false;
      const auto own = static_cast<std::ptrdiff_t>(edits_.size());
      ConvertInstruction(i);
      // Arguments of functions come first. Only here, so that all of it stays linear.
      std::ranges::sort(edits_.begin() + own, edits_.end(), {}, &Fix::byte_offset);
    }
    const auto statements = static_cast<std::ptrdiff_t>(edits_.size());
    ConvertDirectives();
    std::inplace_merge(edits_.begin(), edits_.begin() + statements, edits_.end(),
                       [](const Fix& a, const Fix& b) { return a.byte_offset < b.byte_offset; });
    return std::move(edits_);
  }

 private:
  // Whose line is copied, however many of them were reported. OPT-8.53
  std::vector<bool> FaultyStatements() const {
    std::vector<bool> faulty(module_.instructions.size());
    for (const std::uint32_t s : p_.faulty) faulty[s] = true;
    for (std::size_t s = 0; s < faulty.size(); ++s) {
      if (module_.instructions[s].op == Op::kInvalid) faulty[s] = true;
    }
    return faulty;
  }

  // What a name stands for, as far as the text was read.
  struct Known {
    Unit unit = Unit::kNone;
    bool constant = false;
    int integer = -1;  // of an INTEGER constant that can be an index
  };
  struct Part {  // an operand on the way through an expression
    std::uint32_t node = 0;
    Unit unit = Unit::kNone;
    bool literal = false;
    bool constant = false;
  };

  void ConvertInstruction(const Instruction& i);
  void ConvertValues(const Instruction& i, int linear, int rotary) {
    for (int v = 0; v < linear + rotary; ++v) {
      ConvertExpression(i.first_expression + static_cast<std::uint32_t>(v),
                        v < linear ? Unit::kLinear : Unit::kRotary);
    }
  }
  void ConvertExpression(std::uint32_t expression, Unit place);
  void Settle(std::vector<Part>& parts, std::size_t operators, bool convertible, Unit place);
  void ConvertDirectives();
  void ConvertNumber(const Part& part, Unit unit);
  Unit UnitOfNode(const ExprNode& node) const;
  bool IsConstant(const ExprNode& node) const {
    return node.op == Node::kPi || (node.op == Node::kName && names_[node.name].constant);
  }
  void Declare(const Instruction& i);
  // Divides where that is exact in one rounding: 25.4 mm are 1 inch.
  double Converted(double value, Unit unit) const {
    if (direction_ == Direction::kToInch)
      return unit == Unit::kLinear ? value / kMmPerInch : value * 360.0 / kTurn;
    return value * (unit == Unit::kLinear ? kMmPerInch : kTurn / 360.0);
  }

  const ParsedProgram& p_;
  const Module& module_;
  Direction direction_;
  Findings& findings_;
  std::vector<Known> names_;
  std::vector<Fix> edits_;
  const Instruction* instruction_ = nullptr;
  bool reported_ = false;  // 7709 or 7710 of this statement
};

void Converter::ConvertInstruction(const Instruction& i) {
  std::uint32_t values = i.value_count;  // those that the switch leaves without a unit
  switch (i.op) {
    case Op::kDeclare:
      return Declare(i);
    case Op::kMove:
      ConvertValues(i, 3, 2);
      break;
    case Op::kSysdef:
      if (i.value_count == 6) ConvertValues(i, 3, 3);
      break;
    case Op::kTcp:
      ConvertValues(i, 6, 0);
      break;
    case Op::kPath:
      if (i.value_count == 1) ConvertValues(i, 1, 0);
      break;
    case Op::kLet:
      ConvertExpression(i.first_expression + 1, UnitOfNode(module_.Value(i, 0)[0]));
      break;
    case Op::kAssign:
      break;
    case Op::kFunction: {
      const Expression number = module_.Value(i, 0);
      const float slot = number[0].op == Node::kName
                             ? static_cast<float>(names_[number[0].name].integer)
                             : number[0].number;
      if (slot == 99.0F) values = 0;  // always in degrees, OPT-8.41
      for (std::uint32_t v = 1; v < values; ++v)
        ConvertExpression(i.first_expression + v, Unit::kNone);
      break;
    }
    default:
      for (std::uint32_t v = 0; v < values; ++v)
        ConvertExpression(i.first_expression + v, Unit::kNone);
      break;
  }
  std::uint32_t at = i.first_expression + i.value_count;
  const std::uint32_t end = i.first_expression + module_.ExpressionCount(i);
  if (i.Has(kVia)) {
    for (int v = 0; v < 5; ++v) ConvertExpression(at++, v < 3 ? Unit::kLinear : Unit::kRotary);
  }
  while (at < end) ConvertExpression(at++, Unit::kNone);
}

// The number in a DECLARE is never converted; the name of a VR has the unit of the VR. OPT-8.33,
// OPT-8.34
void Converter::Declare(const Instruction& i) {
  const ExprNode& value = module_.Value(i, 0)[0];
  Known& known = names_[i.name];
  known = {};
  if (value.op == Node::kVariable) {
    known.unit = UnitOfNode(value);
  } else {
    known.constant = IsLiteral(value.op) || value.op == Node::kPi;
    if (value.op == Node::kInteger) known.integer = static_cast<int>(value.number);
  }
}

Unit Converter::UnitOfNode(const ExprNode& node) const {
  if (node.op == Node::kName) return names_[node.name].unit;
  if (node.op != Node::kVariable) return Unit::kNone;
  Variable variable = node.variable();
  if (node.index_name != kNoName) {
    const int index = names_[node.index_name].integer;
    if (index < 0 || index > kVariableIndexMax) return Unit::kNone;
    variable.index = static_cast<std::uint8_t>(index);
  }
  return UnitOf(variable);
}

// Function arguments are expressions of their own, parentheses are not (OPT-8.46). The nodes are in
// postfix order: an argument is settled when its function comes, the rest at the end.
void Converter::ConvertExpression(std::uint32_t expression, Unit place) {
  struct Open {  // a value on the stack: the parts and operators of which it is made
    std::vector<Part> parts;
    std::size_t operators = 0;
    bool convertible = true;  // only + - and relations so far
  };
  const ExprRange range = module_.Range(expression);
  if (range.count == 1) {  // nearly all
    const ExprNode& node = module_.nodes[range.first];
    const bool constant = IsConstant(node);
    std::vector<Part> parts;
    if (place != Unit::kNone && (IsLiteral(node.op) || constant)) {
      parts.push_back({range.first, Unit::kNone, IsLiteral(node.op), constant});
      Settle(parts, 0, true, place);
    }
    return;
  }
  std::vector<Open> stack;
  for (std::uint32_t at = range.first; at < range.first + range.count; ++at) {
    const ExprNode& node = module_.nodes[at];
    const int arity = Arity(node.op);
    if (arity == 0) {
      stack.push_back({{{at, UnitOfNode(node), IsLiteral(node.op), IsConstant(node)}}, 0, true});
    } else if (arity == 1) {
      if (!IsFunction(node.op)) continue;  // a sign is no operator, NOT is not counted
      Open argument = std::move(stack.back());
      const bool rotary = node.op == Node::kSin || node.op == Node::kCos || node.op == Node::kTan;
      Settle(argument.parts, argument.operators, argument.convertible,
             rotary ? Unit::kRotary : Unit::kNone);
      stack.back() = {{{at, Unit::kNone, false, false}}, 0, true};
    } else {
      Open right = std::move(stack.back());
      stack.pop_back();
      Open& left = stack.back();
      if (IsLogicalOperator(
              node.op)) {  // a side without operator is a truth value: nothing to convert
        if (left.operators == 0) left.parts.clear();
        if (right.operators == 0) right.parts.clear();
      }
      if (left.parts.size() < right.parts.size())
        std::swap(left.parts, right.parts);  // keeps it linear
      left.parts.insert(left.parts.end(), right.parts.begin(), right.parts.end());
      left.operators += right.operators;
      left.convertible = left.convertible && right.convertible;
      if (IsLogicalOperator(node.op)) continue;  // not counted
      ++left.operators;
      if (node.op != Node::kAdd && node.op != Node::kSubtract && !IsRelation(node.op))
        left.convertible = false;
    }
  }
  Settle(stack.back().parts, stack.back().operators, stack.back().convertible, place);
}

// One expression with all of its operands. OPT-8.42 to 8.48
void Converter::Settle(std::vector<Part>& parts, std::size_t operators, bool convertible,
                       Unit place) {
  Unit unit = place;
  bool numbers = false, measured = false;
  for (const Part& part : parts) {
    if (part.unit != Unit::kNone) {
      unit = part.unit;
      measured = true;
    }
    numbers = numbers || part.literal || part.constant;
  }
  if (unit == Unit::kNone || !numbers) return;
  if (operators > 1) {
    if (!std::exchange(reported_, true)) {
      findings_.Add(ErrorCode::kConvertExpression, p_.At(*instruction_),
                    "numbers left alone in an expression with several operators", "OPT-8.46");
    }
    return;
  }
  // A product is as large as its measured side (OPT-8.45). Without one a constant in it is the
  // measurement: PI / 2 where an angle belongs.
  if (!convertible && measured) return;
  for (const Part& part : parts) {
    if (part.literal && convertible) ConvertNumber(part, unit);
    if (part.constant) {
      const NodePlace& at = p_.node_places[part.node];
      findings_.Add(ErrorCode::kConvertConstant,
                    {at.offset, static_cast<int>(at.length), static_cast<int>(instruction_->step)},
                    module_.nodes[part.node].op == Node::kPi
                        ? "PI stands where a measurement belongs; it is not converted"
                        : "a declared constant stands where a measurement belongs; its number is "
                          "not converted",
                    "OPT-8.35");
    }
  }
}

void Converter::ConvertNumber(const Part& part, Unit unit) {
  const NumberPlace place = PlaceOfNumber(p_, part.node);
  const std::optional<double> value = LiteralValue(p_.text.substr(place.offset, place.length));
  if (!value) return;
  const double converted = Converted(*value, unit);
  if (!(std::abs(converted) <= kRealMax)) {
    findings_.Add(ErrorCode::kLiteralRange, p_.At(*instruction_),
                  "a number would become larger than the control can hold; it is left alone",
                  "OPT-7.62");
    return;
  }
  edits_.push_back(
      {place.offset, static_cast<int>(place.length), TrimmedText(converted, kConvertDecimals)});
}

// ";$DIA=0.020": the amount is a length. OPT-8.39
void Converter::ConvertDirectives() {
  for (const Comment& comment : p_.comments) {
    const std::optional<CutterDirective> directive = ReadCutterDirective(p_, comment);
    if (!directive || !directive->amount) continue;
    edits_.push_back({directive->amount_begin,
                      static_cast<int>(directive->amount_end - directive->amount_begin),
                      TrimmedText(Converted(*directive->amount, Unit::kLinear), kConvertDecimals)});
  }
}

// Errors of the parser that nobody was told singly: as what they are to CONVERT.
void AddCopiedLines(const UntoldFindings& errors, UntoldFindings& untold) {
  for (const auto& [code, kind] : errors.kinds()) {
    if (!IsError(kind.severity)) continue;
    GatheredFindings lines = kind;
    lines.code = ErrorCode::kConvertNotRml;
    lines.severity = Lookup(lines.code).severity;
    for (Diagnostic* place : {&lines.first, &lines.last}) {
      place->code = lines.code;
      place->severity = lines.severity;
    }
    untold.Add(lines);
  }
}

}  // namespace

Conversion Convert(std::string_view text, Direction direction,
                   const std::optional<FileNames>& names) {
  const std::string_view file = names ? std::string_view(names->input) : std::string_view();
  Findings syntax(kFindingsMax), findings(kFindingsMax);
  const ParsedProgram program = Parse(text, syntax);
  for (const Diagnostic& error : syntax.Take(text, file)) {
    if (!IsError(error.severity)) continue;
    findings.Add(ErrorCode::kConvertNotRml,
                 {error.where.byte_offset, error.where.length, error.step},
                 "the line is copied: " + error.detail, "OPT-8.53");
  }
  const std::vector<Fix> edits = Converter(program, direction, findings).Run();
  Conversion result;
  if (names) {
    const bool metric = direction == Direction::kToMetric;
    result.text = (metric ? "; Metric File " : "; Inch File ") + names->output +
                  (metric ? " Created From Inch File " : " Created From Metric File ") +
                  names->input + " - " + names->date;
    result.text += LineEndOf(text);
  }
  result.text += ApplyEdits(text, edits);
  result.diagnostics = findings.Take(text, file);
  result.diagnostics_dropped = findings.dropped();
  AddCopiedLines(syntax.dropped(), result.diagnostics_dropped);
  return result;
}

}  // namespace rmlcell::optimo
