#include <array>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/object_form.h"

namespace rmlcell::optimo {
namespace {

// Table k holds the checksum of a byte with k zero bytes behind it: four bytes are taken at once.
constexpr std::size_t kSlices = 4;
using CrcTables = std::array<std::array<std::uint32_t, 256>, kSlices>;
constexpr CrcTables MakeCrcTables() {
  CrcTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit)
      value = (value & 1U) != 0 ? 0xEDB88320U ^ value >> 1 : value >> 1;
    tables[0][i] = value;
  }
  for (std::size_t k = 1; k < kSlices; ++k) {
    for (std::size_t i = 0; i < 256; ++i) {
      const std::uint32_t before = tables[k - 1][i];
      tables[k][i] = tables[0][before & 0xFF] ^ before >> 8;
    }
  }
  return tables;
}
constexpr CrcTables kCrc = MakeCrcTables();
// Object bytes of one instruction, roughly: room is made once. A MOVE has 27.
constexpr std::size_t kRecordBytes = 28;

void WriteLeaf(const ExprNode& node, ByteWriter& out) {
  const auto group = static_cast<unsigned>(node.group);
  if (node.name != kNoName) {
    out.Byte(kTagName);
    out.Whole(node.name);
    return;
  }
  switch (node.op) {
    case Node::kInteger:
      out.Byte(kTagInteger);
      out.Fixed16(static_cast<unsigned>(static_cast<int>(node.number)) & 0xFFFF);
      return;
    case Node::kReal:
      out.Byte(kTagReal);
      out.Real(node.number);
      return;
    case Node::kLogical:
      return out.Byte(node.number != 0.0F ? kTagOn : kTagOff);
    case Node::kPi:
      return out.Byte(kTagPi);
    default:
      break;
  }
  if (node.index_name != kNoName) {
    out.Byte(kTagNamedIndex + group);
    out.Whole(node.index_name);
  } else {
    out.Byte(kTagVariable + group);
    out.Byte(node.index);
  }
}

void WriteExpression(Expression expression, ByteWriter& out) {
  for (std::size_t i = expression.size(); i-- > 0;) {
    const ExprNode& node = expression[i];
    if (Arity(node.op) == 0) {
      WriteLeaf(node, out);
    } else {
      out.Byte(kTagOperator + static_cast<unsigned>(node.op));
    }
  }
}

void WriteLabels(std::span<const std::uint16_t> labels, ByteWriter& out) {
  out.Whole(labels.size());
  for (const std::uint16_t label : labels) out.Fixed16(label);
}

void WriteRecord(const Module& module, const Instruction& i, ByteWriter& out) {
  out.Byte(Describe(i.op).object_code | (i.label_count > 0 ? kLabelsFlag : 0U) |
           (i.attributes != 0 ? kAttributesFlag : 0U));
  if (i.label_count > 0) WriteLabels(module.Labels(i), out);
  if (i.attributes != 0) out.Whole(i.attributes);
  if (i.op == Op::kIgnored) return out.Text(module.texts[i.name]);
  const OperandCounts& counts = CountOf(i.op);
  if (counts.choice) out.Byte(i.choice);
  for (std::size_t n = 0; n < counts.numbers; ++n) out.Whole(i.numbers[n]);
  if (counts.name) out.Whole(i.name);
  if (counts.values_vary) out.Byte(i.value_count);
  const std::uint32_t expressions = module.ExpressionCount(i);
  for (std::uint32_t e = 0; e < expressions; ++e)
    WriteExpression(module.expression(i.first_expression + e), out);
  if (counts.targets_vary) out.Whole(i.target_count);
  for (std::uint32_t t = 0; t < i.target_count; ++t)
    out.Fixed16(module.targets[i.first_target + t]);
}

}  // namespace

std::uint32_t Checksum(std::string_view bytes) {
  std::uint32_t sum = 0xFFFF'FFFFU;
  std::size_t at = 0;
  const auto byte = [&](std::size_t n) {
    return std::uint32_t{static_cast<unsigned char>(bytes[at + n])};
  };
  for (; at + kSlices <= bytes.size(); at += kSlices) {
    sum ^= byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
    sum = kCrc[3][sum & 0xFF] ^ kCrc[2][sum >> 8 & 0xFF] ^ kCrc[1][sum >> 16 & 0xFF] ^
          kCrc[0][sum >> 24];
  }
  for (; at < bytes.size(); ++at) sum = kCrc[0][(sum ^ byte(0)) & 0xFF] ^ sum >> 8;
  return ~sum;
}

std::string EncodeObject(const Module& module) {
  ByteWriter out(kRecordBytes * module.instructions.size());
  out.Raw(kObjectMagic);
  out.Byte(kObjectVersion);
  out.Whole(module.instructions.size());
  out.Whole(module.names.size());
  for (const DeclaredName& name : module.names) {
    char room[kNameLength];
    out.Text(UnpackName(name.key, room));
  }
  WriteLabels(module.end_labels, out);
  for (const Instruction& instruction : module.instructions) WriteRecord(module, instruction, out);
  out.Fixed32(Checksum(out.bytes()));
  return out.Take();
}

}  // namespace rmlcell::optimo
