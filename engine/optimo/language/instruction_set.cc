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

}  // namespace

Op OpOf(Word word) { return kOpOfWord[static_cast<std::size_t>(word)]; }

}  // namespace rmlcell::optimo
