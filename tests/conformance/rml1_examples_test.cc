// Every example of rml1.md sections 1 to 7, from the table that was made of it.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/conformance/rml1_bench.h"
#include "tests/conformance/rml1_example.h"

namespace rmlcell::rml1::conformance {
namespace {

const std::string kExamplesTable = RMLCELL_SOURCE_DIR "/tests/conformance/rml1_examples.csv";

class Rml1Examples : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(examples_.size(), 505U); }

  void ExpectFacts(const Example& example, const Observed& seen, const std::string& how) {
    for (const std::string& violation : Violations(example, seen)) {
      ADD_FAILURE() << example.name() << " " << how << ": " << example.tags << " " << example.input
                    << "\n  " << violation;
    }
  }

  const std::vector<Example> examples_ = LoadExamples(kExamplesTable);
};

// RML1-7.01: the facts hold for the stream in one piece and for single bytes.
TEST_F(Rml1Examples, HoldWholeAndByteByByte) {
  for (const Example& example : examples_) {
    const Observed whole = RunOnBench(example, 0);
    ExpectFacts(example, whole, "whole");
    EXPECT_TRUE(RunOnBench(example, 1) == whole) << example.name();
  }
}

// RML1-7.01: split at every position.
TEST_F(Rml1Examples, HoldSplitAtEveryPosition) {
  for (const Example& example : examples_) {
    const Observed whole = RunOnBench(example, 0);
    for (std::size_t position = 0; position <= example.input.size(); ++position) {
      ASSERT_TRUE(RunOnBenchSplitAt(example, position) == whole)
          << example.name() << " split at " << position;
    }
  }
}

// RML1-7.05, RML1-9.42: the same streams as stored programs, in virtual time.
TEST_F(Rml1Examples, HoldAsPrograms) {
  for (const Example& example : examples_) ExpectFacts(example, RunAsProgram(example), "program");
}

// The committed table is what the specification says, word for word.
TEST_F(Rml1Examples, AreThoseOfTheSpecification) {
  const std::string spec = std::string(RMLCELL_SHARED_DIR) + "/spec/rml1.md";
  if (!std::filesystem::exists(spec)) GTEST_SKIP() << "no specification at " << spec;
  const std::vector<Example> wanted = ExtractExamples(spec);
  ASSERT_EQ(wanted.size(), examples_.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(examples_[i].name(), wanted[i].name());
    EXPECT_EQ(examples_[i].tags, wanted[i].tags) << wanted[i].name();
    EXPECT_EQ(examples_[i].input, wanted[i].input) << wanted[i].name();
    EXPECT_EQ(examples_[i].facts, wanted[i].facts) << wanted[i].name();
  }
}

// The checker itself: a fact that does not hold is told, whatever kind it is.
TEST(Rml1Facts, AreNotTakenForGranted) {
  const Example example{.id = "x", .number = 1, .tags = "", .input = "PU100,0;XX;", .facts = ""};
  const Observed seen = RunOnBench(example, 0);
  for (const char* wrong : {"err 0",
                            "log empty",
                            "log 2",
                            "err 1; moves (0,0,500)",
                            "err 1; no moves",
                            "err 1; rel",
                            "err 1; moves (0,0,500) (100,0,501)",
                            "err 1; down",
                            "err 1; VS 3",
                            "err 1; com 11",
                            "err 1; trace empty",
                            "err 1; feeds 2",
                            "err 1; feeds 2 60 60",
                            "err 1; feeds 2 59",
                            "err 1; paused",
                            "err 1; pending",
                            "err 1; at (0,0,500)",
                            "err 1; logical (0,0,500)",
                            "err 1; Z0 0",
                            "err 1; MC off",
                            "err 1; spindle off",
                            "err 1; rpm 1",
                            "err 1; ESC.M 1",
                            "err 1; comlog 11",
                            "err 1; nonsense",
                            ""}) {
    Example claim = example;
    claim.facts = wrong;
    EXPECT_FALSE(Violations(claim, seen).empty()) << wrong;
  }
}

}  // namespace
}  // namespace rmlcell::rml1::conformance
