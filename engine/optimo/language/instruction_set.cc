#include "engine/optimo/language/instruction_set.h"

namespace rmlcell::optimo {
namespace {

constexpr auto kWordCount = static_cast<std::size_t>(Word::kLogic) + 1;

constexpr std::array<Op, kWordCount> MakeOpOfWord() {
  std::array<Op, kWordCount> ops{};
  for (const InstructionInfo& row : kInstructionSet) {
    Op& op = ops[static_cast<std::size_t>(row.word)];
    if (row.word != Word::kNone && op == Op::kInvalid) op = row.op;
  }
  return ops;
}
constexpr std::array<Op, kWordCount> kOpOfWord = MakeOpOfWord();

constexpr std::array<OperandCounts, kOpCount> MakeCounts() {
  std::array<OperandCounts, kOpCount> counts{};
  for (const InstructionInfo& row : kInstructionSet) {
    counts[static_cast<std::size_t>(row.op)] = CountOf(row.operands);
  }
  return counts;
}
constexpr std::array<OperandCounts, kOpCount> kCounts = MakeCounts();

}  // namespace

const OperandCounts& CountOf(Op op) { return kCounts[static_cast<std::size_t>(op)]; }

Op OpOf(Word word) { return kOpOfWord[static_cast<std::size_t>(word)]; }

}  // namespace rmlcell::optimo
