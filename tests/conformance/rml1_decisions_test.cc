// The repairs and decisions of rml1.md sections 8 and 9, with examples of our own in the same form
// as those of sections 1 to 7. Rows whose behaviour shows elsewhere have unit tests in
// tests/engine/rml1.
#include <gtest/gtest.h>

#include "tests/conformance/rml1_bench.h"
#include "tests/conformance/rml1_example.h"

namespace rmlcell::rml1::conformance {
namespace {

const std::string kDecisionsTable = RMLCELL_SOURCE_DIR "/tests/conformance/rml1_decisions.csv";

// RML1-9.05: in one piece, byte by byte, and split at every position.
TEST(Rml1Decisions, HoldOnTheBench) {
  const std::vector<Example> examples = LoadExamples(kDecisionsTable);
  ASSERT_GT(examples.size(), 100U);
  for (const Example& example : examples) {
    const Observed whole = RunOnBench(example, 0);
    for (const std::string& violation : Violations(example, whole)) {
      ADD_FAILURE() << example.name() << " " << example.tags << " " << example.input << "\n  "
                    << violation;
    }
    EXPECT_TRUE(RunOnBench(example, 1) == whole) << example.name();
    for (std::size_t position = 0; position <= example.input.size(); ++position) {
      ASSERT_TRUE(RunOnBenchSplitAt(example, position) == whole) << example.name();
    }
  }
}

TEST(Rml1Decisions, HoldAsPrograms) {
  for (const Example& example : LoadExamples(kDecisionsTable)) {
    for (const std::string& violation : Violations(example, RunAsProgram(example))) {
      ADD_FAILURE() << example.name() << " " << example.tags << " " << example.input << "\n  "
                    << violation;
    }
  }
}

}  // namespace
}  // namespace rmlcell::rml1::conformance
