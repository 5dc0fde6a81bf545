#include <algorithm>
#include <bitset>
#include <cmath>
#include <string>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/evaluate.h"
#include "engine/optimo/language/object_form.h"
#include "engine/optimo/language/parser.h"
#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

constexpr int kLabelMax = 9999;
constexpr std::uint64_t kTargetsMax = kStatementTokensMax / 2;  // a comma between two

bool IsVariable(Expression value) {
  return value.size() == 1 && (value[0].op == Node::kVariable || value[0].op == Node::kName);
}

bool IsWholeNumber(Expression value) {
  return value.size() == 1 && value[0].op == Node::kInteger && value[0].number >= 0.0F;
}

// Accepts exactly what EncodeObject can write, or could once: so what was accepted, decompiled and
// compiled again is the same object.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : in_(bytes) {}

  bool Read(Module& module) {
    module_ = &module;
    const std::uint64_t records = in_.Whole(kSourceBytesMax);
    ReadNames();
    ReadLabels(module.end_labels);
    for (std::uint64_t r = 0; r < records && !in_.bad(); ++r) ReadRecord();
    return !in_.bad() && in_.AtEnd() && next_name_ == module.names.size();
  }

 private:
  void ReadNames();
  void ReadLabels(std::vector<std::uint16_t>& labels);
  void ReadRecord();
  void ReadIgnored(Instruction& i);
  void ReadExpression();
  void ReadLeaf(unsigned tag, ExprNode& node);
  void RequireForm(const Instruction& i);
  void RequireOperand(const Instruction& i, const Operand& operand, int& value,
                      std::size_t& number);
  void RequireOwn(const Instruction& i);
  void Require(bool condition) {
    if (!condition) in_.Refuse();
  }

  ByteReader in_;
  Module* module_ = nullptr;
  std::bitset<kLabelMax + 1> labels_;
  std::size_t next_name_ = 0;
  std::vector<ExprNode> reversed_;
};

void Reader::ReadNames() {
  const std::uint64_t count = in_.Whole(kNoName);
  std::vector<NameKey> keys;
  for (std::uint64_t n = 0; n < count && !in_.bad(); ++n) {
    const std::string_view text = in_.Text(kNameLength);
    bool good = !text.empty() && text[0] >= 'A' && text[0] <= 'Z';
    for (const char c : text) good = good && ((c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'));
    const NameKey key = PackName(text);
    Require(good && FindWord(key) == Word::kNone);
    keys.push_back(key);
    module_->names.push_back({.key = key, .declared = false, .value = {}});
  }
  std::ranges::sort(keys);
  Require(std::ranges::adjacent_find(keys) == keys.end());
}

void Reader::ReadLabels(std::vector<std::uint16_t>& labels) {
  const std::uint64_t count = in_.Whole(kLabelMax + 1);
  for (std::uint64_t n = 0; n < count && !in_.bad(); ++n) {
    const unsigned label = in_.Fixed16();
    if (label > kLabelMax || labels_.test(label)) return in_.Refuse();
    labels_.set(label);
    labels.push_back(static_cast<std::uint16_t>(label));
  }
}

void Reader::ReadRecord() {
  const unsigned code = in_.Byte();
  const unsigned op = code & kCodeMask;
  if (op == 0 || op >= static_cast<unsigned>(kOpCount)) return in_.Refuse();
  Instruction i;
  i.op = static_cast<Op>(op);
  i.first_expression = static_cast<std::uint32_t>(module_->expression_ends.size());
  i.first_target = static_cast<std::uint32_t>(module_->targets.size());
  i.first_label = static_cast<std::uint32_t>(module_->labels.size());
  if ((code & kLabelsFlag) != 0) {
    ReadLabels(module_->labels);
    i.label_count = static_cast<std::uint16_t>(module_->labels.size() - i.first_label);
    Require(i.label_count > 0);
  }
  if ((code & kAttributesFlag) != 0) {
    i.attributes = static_cast<std::uint16_t>(in_.Whole(0xFFFF));
    Require(i.attributes != 0 && (i.attributes & ~Describe(i.op).attributes) == 0);
  }
  if (i.op == Op::kIgnored) return ReadIgnored(i);
  const OperandCounts& counts = CountOf(i.op);
  if (counts.choice) i.choice = static_cast<std::uint8_t>(in_.Byte());
  for (std::size_t n = 0; n < counts.numbers; ++n)
    i.numbers[n] = static_cast<std::uint16_t>(in_.Whole(0xFFFF));
  if (counts.name) {
    i.name = static_cast<std::uint16_t>(in_.Whole(kNoName - 1U));
    Require(i.name == next_name_++ && i.name < module_->names.size());
  }
  i.value_count = counts.values;
  if (counts.values_vary) {
    i.value_count = static_cast<std::uint8_t>(in_.Byte());
    Require(i.value_count <= counts.values);
  }
  const std::uint32_t expressions = module_->ExpressionCount(i);
  for (std::uint32_t e = 0; e < expressions && !in_.bad(); ++e) ReadExpression();
  std::uint64_t targets = i.Has(kTime) ? 1 : 0;
  if (counts.targets_vary) {
    targets = in_.Whole(kTargetsMax);
  } else {
    targets += counts.targets_with_value ? i.value_count : counts.targets;
  }
  for (std::uint64_t t = 0; t < targets && !in_.bad(); ++t) {
    const unsigned label = in_.Fixed16();
    Require(label <= kLabelMax);
    module_->targets.push_back(static_cast<std::uint16_t>(label));
  }
  i.target_count = static_cast<std::uint16_t>(targets);
  if (!in_.bad()) RequireForm(i);
  module_->instructions.push_back(i);
}

void Reader::ReadIgnored(Instruction& i) {
  const std::string_view text = in_.Text(kSourceBytesMax);
  const std::size_t blank = std::min(text.find(' '), text.size());
  const std::string_view word_text = text.substr(0, blank);
  const Word word = word_text.size() <= kNameLength ? FindWord(PackName(word_text)) : Word::kNone;
  Require(word != Word::kNone && Describe(word).group == WordGroup::kIgnored &&
          module_->texts.size() < kNoName);
  if (in_.bad()) return;
  const std::string_view rest = text.substr(std::min(blank + 1, text.size()));
  Require(IgnoredText(word, rest) == text &&
          text.find_first_of("\n\r;\x1A") == std::string_view::npos);
  i.name = static_cast<std::uint16_t>(module_->texts.size());
  module_->texts.emplace_back(text);
  module_->instructions.push_back(i);
}

void Reader::ReadLeaf(unsigned tag, ExprNode& node) {
  switch (tag) {
    case kTagInteger:
      node.number = static_cast<float>(static_cast<std::int16_t>(in_.Fixed16()));
      return;
    case kTagReal: {
      node.op = Node::kReal;
      node.number = in_.Real();
      const double magnitude = std::fabs(static_cast<double>(node.number));
      const bool zero = std::bit_cast<std::uint32_t>(node.number) == 0;
      return Require(zero || (magnitude >= kRealMin && magnitude <= kRealMax));
    }
    case kTagOff:
    case kTagOn:
      node.op = Node::kLogical;
      node.number = tag == kTagOn ? 1.0F : 0.0F;
      return;
    case kTagPi:
      node.op = Node::kPi;
      node.number = kPiLanguage;
      return;
    case kTagName:
      node.op = Node::kName;
      node.name = static_cast<std::uint16_t>(in_.Whole(kNoName - 1U));
      return Require(node.name < module_->names.size());
    default:
      break;
  }
  const unsigned group = tag & 7U;
  node.op = Node::kVariable;
  node.group = static_cast<VariableGroup>(group);
  if (tag >= kTagNamedIndex) {
    node.index_name = static_cast<std::uint16_t>(in_.Whole(kNoName - 1U));
    return Require(node.index_name < module_->names.size());
  }
  const unsigned index = in_.Byte();
  Require(index <= static_cast<unsigned>(node.group == VariableGroup::kPar ? kParameterCount - 1
                                                                           : kVariableIndexMax));
  node.index = static_cast<std::uint8_t>(index);
}

void Reader::ReadExpression() {
  reversed_.clear();
  for (std::uint64_t needed = 1; needed > 0 && !in_.bad();) {
    const unsigned tag = in_.Byte();
    ExprNode node;
    if (tag >= kTagOperator) {
      const unsigned op = tag - kTagOperator;
      if (op < static_cast<unsigned>(Node::kNegate) || op >= static_cast<unsigned>(kNodeCount))
        return in_.Refuse();
      node.op = static_cast<Node>(op);
      needed += static_cast<std::uint64_t>(Arity(node.op));
    } else {
      if ((tag > kTagName && tag < kTagVariable) || tag == 0) return in_.Refuse();
      ReadLeaf(tag, node);
    }
    --needed;
    // Objects were written with the sign of "-(5)" beside its literal.
    while (IsLiteral(node) && !reversed_.empty() && reversed_.back().op == Node::kNegate) {
      reversed_.pop_back();
      node = NegatedLiteral(node);
    }
    reversed_.push_back(node);
  }
  if (in_.bad()) return;
  module_->nodes.insert(module_->nodes.end(), reversed_.rbegin(), reversed_.rend());
  module_->EndExpression();
}

// What the grammar demands and the checker takes for granted, by the operands; then what no row of
// them says.
void Reader::RequireForm(const Instruction& i) {
  for (std::uint32_t e = 0; e < module_->ExpressionCount(i); ++e) {
    Require(PrintedNesting(module_->expression(i.first_expression + e), i.op == Op::kTcp) <=
            kNestingMax);
  }
  int value = 0;
  std::size_t number = 0;
  for (const Operand& operand : Describe(i.op).operands) {
    RequireOperand(i, operand, value, number);
    if (in_.bad()) return;
  }
  RequireOwn(i);
}

void Reader::RequireOperand(const Instruction& i, const Operand& operand, int& value,
                            std::size_t& number) {
  const auto next_value = [&] { return module_->Value(i, value++); };
  const bool there = value < i.value_count;
  switch (operand.kind) {
    case Operand::Kind::kValue:
      if (there) ++value;  // the time of TIMER may be missing
      return;
    case Operand::Kind::kVariable:
      return Require(there && IsVariable(next_value()));
    case Operand::Kind::kProgram: {
      if (!there) return in_.Refuse();
      const Expression given = next_value();
      return Require(IsVariable(given) || IsWholeNumber(given));
    }
    case Operand::Kind::kConstant: {
      if (!there) return in_.Refuse();
      const Expression given = next_value();
      return Require(given.size() == 1 && (given[0].op == Node::kName || IsWholeNumber(given)));
    }
    case Operand::Kind::kLiteral: {
      const Expression given = next_value();
      return Require(given.size() == 1 && given[0].op != Node::kName);
    }
    case Operand::Kind::kBits: {
      const Expression given = next_value();
      return Require(IsVariable(given) || (given.size() == 1 && given[0].op == Node::kInteger));
    }
    case Operand::Kind::kList: {
      const int left = i.value_count - value;
      return Require((left == 0 && operand.optional) || left >= operand.low);
    }
    case Operand::Kind::kNumber: {
      const unsigned given = i.numbers[number++];
      return Require(given >= operand.low && given <= operand.high);
    }
    case Operand::Kind::kChoice:
      return Require(i.choice < operand.words.size());
    case Operand::Kind::kGroups:
      return Require(i.choice >= 1 && i.choice <= kAllGroups);
    case Operand::Kind::kLabels:
      return Require(i.target_count >= 1);
    case Operand::Kind::kText:
    case Operand::Kind::kTool:
    case Operand::Kind::kName:
    case Operand::Kind::kLabel:
      return;
  }
}

void Reader::RequireOwn(const Instruction& i) {
  const bool on = i.Has(kOn), off = i.Has(kOff);
  switch (i.op) {
    case Op::kPath:
      return Require((i.choice == static_cast<std::uint8_t>(PathType::kHole)) ==
                     (i.value_count == 1));
    case Op::kWorkdef: {
      const unsigned kind = i.numbers[0], count = i.value_count;
      return Require(kind == 0 ? count == 0 : kind == 1 ? count == 4 || count == 5 : count == 1);
    }
    case Op::kWork:
    case Op::kUpdate:
      return Require(on != off);
    case Op::kGo:
      return Require((i.attributes & (i.attributes - 1)) == 0);
    case Op::kIf:
      return Require(i.target_count == 1 || i.target_count == 2);
    case Op::kTimer:
      return Require(i.value_count == 1 ? !i.Has(kDis) : i.attributes == kDis);
    default:
      return;
  }
}

Error Corrupt(Detail detail) { return {ErrorCode::kObjectCorrupt, std::move(detail), {}}; }

}  // namespace

Result<Module> DecodeObject(std::string_view bytes) {
  constexpr std::size_t kHead = kObjectMagic.size() + 1, kTail = 4;
  if (bytes.size() < kHead + kTail || bytes.substr(0, kObjectMagic.size()) != kObjectMagic) {
    return Corrupt("this is no object");
  }
  const auto version = static_cast<unsigned char>(bytes[kObjectMagic.size()]);
  if (version != kObjectVersion)
    return Corrupt("object version " + Told("version", version) + " is not known");
  const std::string_view body = bytes.substr(0, bytes.size() - kTail);
  if (ByteReader(bytes.substr(body.size())).Fixed32() != Checksum(body))
    return Corrupt("the checksum is wrong");
  Module module;
  if (!Reader(body.substr(kHead)).Read(module)) return Corrupt("a record is damaged");
  Findings findings(1);
  CheckModule(module, findings);
  if (findings.error_count() == 0) return module;
  for (const Diagnostic& found : findings.Take({}, {})) {
    if (IsError(found.severity))
      return Corrupt(Told("code", CodeText(found.code)) + " at step " + Told("step", found.step));
  }
  return Corrupt("the program has errors");
}

}  // namespace rmlcell::optimo
