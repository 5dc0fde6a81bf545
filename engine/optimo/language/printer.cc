#include "engine/optimo/language/printer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <vector>

#include "engine/optimo/language/priority.h"

namespace rmlcell::optimo {
namespace {

int LevelOf(const ExprNode& node) {
  switch (node.op) {
    case Node::kOr:
    case Node::kXor:
      return kOrLevel;
    case Node::kAnd:
      return kAndLevel;
    case Node::kNot:
      return kNotLevel;
    case Node::kLess:
    case Node::kLessEqual:
    case Node::kEqual:
    case Node::kGreaterEqual:
    case Node::kGreater:
    case Node::kNotEqual:
      return kRelationLevel;
    case Node::kAdd:
    case Node::kSubtract:
      return kSumLevel;
    case Node::kMultiply:
    case Node::kDivide:
    case Node::kMod:
      return kTermLevel;
    case Node::kPower:
      return kPowerLevel;
    case Node::kNegate:
      return kSignedLevel;
    default:
      return kLeafLevel;
  }
}

// Two signs would cancel: "-(-X)".
bool OperandNeedsParentheses(const ExprNode& parent, const ExprNode& operand) {
  if (parent.op == Node::kNot) return LevelOf(operand) < kNotLevel;
  if (parent.op == Node::kNegate) return LevelOf(operand) <= kSignedLevel;
  return false;  // a function has its own
}
// Operators of one priority go from the left, relations do not chain.
bool LeftNeedsParentheses(const ExprNode& parent, const ExprNode& left) {
  const int level = LevelOf(parent);
  return LevelOf(left) < (level == kRelationLevel ? level + 1 : level);
}
bool RightNeedsParentheses(const ExprNode& parent, const ExprNode& right) {
  return LevelOf(right) <= LevelOf(parent);
}

std::string_view OperatorText(Node node) {
  switch (node) {
    case Node::kPower:
      return " ^ ";
    case Node::kMultiply:
      return " * ";
    case Node::kDivide:
      return " / ";
    case Node::kMod:
      return " MOD ";
    case Node::kAdd:
      return " + ";
    case Node::kSubtract:
      return " - ";
    case Node::kLess:
      return " < ";
    case Node::kLessEqual:
      return " <= ";
    case Node::kEqual:
      return " = ";
    case Node::kGreaterEqual:
      return " >= ";
    case Node::kGreater:
      return " > ";
    case Node::kNotEqual:
      return " <> ";
    case Node::kAnd:
      return " AND ";
    case Node::kXor:
      return " XOR ";
    default:
      return " OR ";
  }
}

void PrintInteger(int value, std::string& out) {
  std::array<char, 16> room;
  out.append(room.data(), std::to_chars(room.data(), room.data() + room.size(), value).ptr);
}

void PrintName(const Module& module, std::uint16_t name, std::string& out) {
  char room[kNameLength];
  out += UnpackName(module.names[name].key, room);
}

void PrintLeaf(const Module& module, const ExprNode& node, std::string& out) {
  if (node.name != kNoName) return PrintName(module, node.name, out);
  switch (node.op) {
    case Node::kInteger:
      return PrintInteger(static_cast<int>(node.number), out);
    case Node::kReal:
      return PrintReal(node.number, out);
    case Node::kLogical:
      out += node.number != 0.0F ? "ON" : "OFF";
      return;
    case Node::kPi:
      out += "PI";
      return;
    default:
      break;
  }
  out += GroupName(node.group);
  out += '[';
  if (node.index_name != kNoName) {
    PrintName(module, node.index_name, out);
  } else {
    PrintInteger(node.index, out);
  }
  out += ']';
}

void Prepend(std::string_view prefix, std::string& text) {
  std::string joined(prefix);
  joined += text;
  text = std::move(joined);
}

void Enclose(std::string& text) {
  Prepend("(", text);
  text += ')';
}

struct Piece {
  std::string text;
  const ExprNode* root = nullptr;
};

std::string ExpressionText(const Module& module, Expression expression) {
  std::vector<Piece> stack;
  for (const ExprNode& node : expression) {
    const int arity = Arity(node.op);
    if (arity == 0) {
      stack.push_back({{}, &node});
      PrintLeaf(module, node, stack.back().text);
      continue;
    }
    if (arity == 1) {
      Piece& operand = stack.back();
      if (OperandNeedsParentheses(node, *operand.root)) Enclose(operand.text);
      if (node.op == Node::kNegate) {
        Prepend("-", operand.text);
      } else if (node.op == Node::kNot) {
        Prepend("NOT ", operand.text);
      } else {
        Enclose(operand.text);
        Prepend(FunctionName(node.op), operand.text);
      }
      operand.root = &node;
      continue;
    }
    Piece right = std::move(stack.back());
    stack.pop_back();
    Piece& left = stack.back();
    if (LeftNeedsParentheses(node, *left.root)) Enclose(left.text);
    if (RightNeedsParentheses(node, *right.root)) Enclose(right.text);
    left.text += OperatorText(node.op);
    left.text += right.text;
    left.root = &node;
  }
  return std::move(stack.back().text);
}

bool DividesOutside(std::string_view text) {
  int depth = 0;
  for (const char c : text) {
    if (c == '(') ++depth;
    if (c == ')') --depth;
    if (c == '/' && depth == 0) return true;
  }
  return false;
}

// The list of a MOVE, SYSDEF ...: "(1.0, 2.0)".
template <class At>
void PrintList(const Module& module, int count, std::string& out, At at) {
  out += '(';
  for (int v = 0; v < count; ++v) {
    if (v > 0) out += ", ";
    PrintExpression(module, at(v), out);
  }
  out += ')';
}

void PrintTcp(const Module& module, const Instruction& i, std::string& out) {
  out += '(';
  for (int v = 0; v < 6; ++v) {
    if (v > 0) out += v == 3 ? " / " : ", ";
    const Expression value = module.Value(i, v);
    if (value.size() == 1) {
      PrintLeaf(module, value[0], out);
      continue;
    }
    std::string text = ExpressionText(module, value);
    if (DividesOutside(text)) Enclose(text);
    out += text;
  }
  out += ')';
}

void PrintTargets(const Module& module, const Instruction& i, std::string& out) {
  bool first = true;
  for (const std::uint16_t label : module.Targets(i)) {
    if (!first) out += ", ";
    first = false;
    PrintInteger(label, out);
  }
}

void PrintGroups(std::uint8_t groups, std::string& out) {
  constexpr std::array<std::string_view, 4> kNames = {"IL", "OL", "IA", "OA"};
  bool first = true;
  for (std::size_t g = 0; g < kNames.size(); ++g) {
    if ((groups >> g & 1) == 0) continue;
    if (!first) out += ", ";
    first = false;
    out += kNames[g];
  }
}

void PrintTimeAndLabel(const Module& module, Expression time, std::uint16_t label,
                       std::string& out) {
  out += '(';
  PrintExpression(module, time, out);
  out += ", ";
  PrintInteger(label, out);
  out += ')';
}

void PrintAttributes(const Module& module, const Instruction& i, std::string& out) {
  if (i.attributes == 0) return;
  for (const AttributeInfo& info : kAttributes) {
    if (!i.Has(info.bit)) continue;
    out += " /";
    out += Describe(info.word).text;
    switch (info.bit) {
      case kVia:
        out += ' ';
        PrintList(module, 5, out, [&](int v) { return module.Via(i, v); });
        break;
      case kStart:
      case kEnd:
        out += " (";
        PrintExpression(module, info.bit == kStart ? module.Start(i) : module.End(i), out);
        out += ')';
        break;
      case kTime:
        out += ' ';
        PrintTimeAndLabel(module, module.Time(i), module.TimeLabel(i), out);
        break;
      default:
        break;
    }
  }
}

// Writes what stands between the word of an instruction and its attributes, part by part.
class OperandPrinter {
 public:
  OperandPrinter(const Module& module, const Instruction& i, std::string& out)
      : module_(module), i_(i), out_(out), targets_(module.Targets(i)) {}

  void Print(std::span<const Operand> operands) {
    for (std::size_t n = 0; n < operands.size(); ++n) {
      if (operands[n].optional && !IsThere(operands.subspan(n))) return;
      PrintOne(operands[n], n == 0);
    }
  }

 private:
  // Whether an instruction has what begins here and may be left out: its first part but for text.
  bool IsThere(std::span<const Operand> rest) const {
    const auto part = std::ranges::find_if(
        rest, [](const Operand& operand) { return operand.kind != Operand::Kind::kText; });
    switch (part->kind) {
      case Operand::Kind::kLabel:
        return label_ < targets_.size();
      case Operand::Kind::kNumber:
        return i_.numbers[number_] != 0;
      case Operand::Kind::kGroups:
        return i_.choice != kAllGroups;
      default:
        return value_ < i_.value_count;
    }
  }

  void PrintOne(const Operand& operand, bool first) {
    switch (operand.kind) {
      case Operand::Kind::kText:
        out_ += operand.text;
        return;
      case Operand::Kind::kList:
        if (!first) out_ += ' ';
        PrintList(module_, i_.value_count - value_, out_,
                  [&](int v) { return module_.Value(i_, value_ + v); });
        value_ = i_.value_count;
        return;
      case Operand::Kind::kTool:
        return PrintTcp(module_, i_, out_);
      case Operand::Kind::kNumber:
        return PrintInteger(i_.numbers[number_++], out_);
      case Operand::Kind::kChoice:
        out_ += Describe(operand.words[i_.choice]).text;
        return;
      case Operand::Kind::kGroups:
        return PrintGroups(i_.choice, out_);
      case Operand::Kind::kName:
        return PrintName(module_, i_.name, out_);
      case Operand::Kind::kLabel:
        return PrintInteger(targets_[label_++], out_);
      case Operand::Kind::kLabels:
        return PrintTargets(module_, i_, out_);
      case Operand::Kind::kValue:
      case Operand::Kind::kVariable:
      case Operand::Kind::kProgram:
      case Operand::Kind::kConstant:
      case Operand::Kind::kLiteral:
      case Operand::Kind::kBits:
        return PrintExpression(module_, module_.Value(i_, value_++), out_);
    }
  }

  const Module& module_;
  const Instruction& i_;
  std::string& out_;
  std::span<const std::uint16_t> targets_;
  int value_ = 0;  // the next ones
  std::size_t number_ = 0;
  std::size_t label_ = 0;
};

}  // namespace

std::string_view FunctionName(Node node) {
  constexpr std::array<std::string_view, 12> kNames = {"SIN",  "COS", "TAN", "ASIN", "ACOS", "ATAN",
                                                       "SQRT", "EXP", "LN",  "LOG",  "ABS",  "INT"};
  return kNames[static_cast<std::size_t>(node) - static_cast<std::size_t>(Node::kSin)];
}

void PrintReal(float value, std::string& out) {
  constexpr float kFixedMin = 1e-4F, kFixedMax = 1e7F;
  const float magnitude = std::fabs(value);
  std::array<char, 64> room;
  char* const end = room.data() + room.size();
  if (magnitude == 0.0F) {
    out += "0.0";
  } else if (magnitude >= kFixedMin && magnitude <= kFixedMax) {
    const std::string_view text(
        room.data(),
        static_cast<std::size_t>(
            std::to_chars(room.data(), end, value, std::chars_format::fixed).ptr - room.data()));
    out += text;
    if (text.find('.') == std::string_view::npos) out += ".0";
  } else {
    const std::string_view text(
        room.data(), static_cast<std::size_t>(
                         std::to_chars(room.data(), end, value, std::chars_format::scientific).ptr -
                         room.data()));
    const std::size_t e = text.find('e');
    out += text.substr(0, e);
    if (text.substr(0, e).find('.') == std::string_view::npos) out += ".0";
    out += 'E';
    if (text[e + 1] == '-') out += '-';
    std::size_t digits = e + 2;
    while (text[digits] == '0') ++digits;
    out += text.substr(digits);
  }
}

void PrintExpression(const Module& module, Expression expression, std::string& out) {
  if (expression.size() == 1) return PrintLeaf(module, expression[0], out);
  out += ExpressionText(module, expression);
}

int PrintedNesting(Expression expression, bool in_tcp) {
  struct Depth {
    int depth;
    const ExprNode* root;
    bool divides;  // outside of parentheses
  };
  std::vector<Depth> stack;
  for (const ExprNode& node : expression) {
    const int arity = Arity(node.op);
    if (arity == 0) {
      stack.push_back({0, &node, false});
    } else if (arity == 1) {
      Depth& operand = stack.back();
      const bool sign = node.op == Node::kNegate || node.op == Node::kNot;
      const bool more = !sign || OperandNeedsParentheses(node, *operand.root);
      operand = {operand.depth + (more ? 1 : 0), &node, operand.divides && !more};
    } else {
      const Depth right = stack.back();
      stack.pop_back();
      const Depth left = stack.back();
      const bool left_more = LeftNeedsParentheses(node, *left.root);
      const bool right_more = RightNeedsParentheses(node, *right.root);
      stack.back() = {
          std::max(left.depth + (left_more ? 1 : 0), right.depth + (right_more ? 1 : 0)), &node,
          node.op == Node::kDivide || (left.divides && !left_more) ||
              (right.divides && !right_more)};
    }
  }
  return stack.back().depth + (in_tcp && stack.back().divides ? 1 : 0);
}

void PrintLabelColumns(int label, std::string& out) {
  const std::size_t begin = out.size();
  if (label != kNoLabel) PrintInteger(label, out);
  out.append(kLabelColumns - std::min(kLabelColumns, out.size() - begin), ' ');
}

void PrintStatement(const Module& module, const Instruction& instruction, std::string& out) {
  if (instruction.op == Op::kIgnored) {
    out += module.texts[instruction.name];
    return;
  }
  out += Describe(instruction.op).name;
  const std::size_t bare = out.size();
  out += ' ';
  const std::size_t begin = out.size();
  OperandPrinter(module, instruction, out).Print(Describe(instruction.op).operands);
  if (out.size() == begin) out.resize(bare);
  PrintAttributes(module, instruction, out);
}

}  // namespace rmlcell::optimo
