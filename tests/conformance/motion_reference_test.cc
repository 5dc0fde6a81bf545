#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>

#include "tests/conformance/motion_cases.h"

namespace rmlcell::motion {
namespace {

std::optional<std::string> FileText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

const std::string kCommitted = RMLCELL_SOURCE_DIR "/tests/conformance/motion_reference.csv";

// The committed table is the one of the specification, byte for byte.
TEST(MotionReference, CommittedCopyEqualsTheSpecification) {
  const std::optional<std::string> shared =
      FileText(RMLCELL_SHARED_DIR "/spec/motion-reference.csv");
  if (!shared) GTEST_SKIP() << "no specification at " RMLCELL_SHARED_DIR;
  EXPECT_EQ(FileText(kCommitted), shared);
}

// Every case of motion.md section 12 agrees with its reference, but for clipping (engine/rml1) and
// material (engine/simulation). OPT-2.13, OPT-2.14, OPT-2.42, OPT-B.24, OPT-B.31
TEST(MotionReference, EveryCaseAgrees) {
  const std::optional<std::string> text = FileText(kCommitted);
  ASSERT_TRUE(text);
  const Result<std::vector<ReferenceCase>> cases = ReadReferenceCases(*text);
  ASSERT_TRUE(cases) << cases.error().detail;
  ASSERT_EQ(cases->size(), 81u);
  std::set<std::string> not_covered;
  for (const ReferenceCase& reference : *cases) {
    SCOPED_TRACE(reference.name + " " + reference.text);
    const ReferenceVerdict verdict = Judge(reference);
    if (verdict.kind == ReferenceVerdict::Kind::kNotCovered) {
      not_covered.insert(reference.group);
      continue;
    }
    for (const std::string& difference : verdict.differences) ADD_FAILURE() << difference;
    EXPECT_EQ(verdict.kind, ReferenceVerdict::Kind::kAgrees);
  }
  EXPECT_EQ(not_covered, (std::set<std::string>{"clip", "material"}));
}

TEST(MotionReference, ReadsQuotedFields) {
  const auto cases =
      ReadReferenceCases("case,group,text,input,output\nA,b,\"c, \"\"d\"\"\ne\",{},{}\r\n");
  ASSERT_TRUE(cases);
  ASSERT_EQ(cases->size(), 1u);
  EXPECT_EQ((*cases)[0].text, "c, \"d\"\ne");
  EXPECT_EQ((*cases)[0].output, "{}");
}

TEST(MotionReference, TellsADifferenceFromAgreement) {
  const std::string input = R"({"f":"reach","v0":0.0,"dist":10.0,"a":2000.0,"j":40000.0})";
  const auto verdict = [&](const std::string& output) {
    return Judge({"", "", "", input, output});
  };
  // Section 5.2 by hand: a-limited, b = 100, c = -40000: (-100 + sqrt(170000)) / 2 = 156.1552813.
  EXPECT_EQ(verdict(R"({"v1":156.1552813})").kind, ReferenceVerdict::Kind::kAgrees);
  EXPECT_EQ(verdict(R"({"v1":156.156})").kind, ReferenceVerdict::Kind::kDiffers);
  EXPECT_EQ(verdict(R"({"other":1})").kind, ReferenceVerdict::Kind::kDiffers);
  EXPECT_EQ(verdict(R"([1])").kind, ReferenceVerdict::Kind::kUnreadable);
  EXPECT_EQ(Judge({"", "", "", R"({"f":"reach"})", "{}"}).kind,
            ReferenceVerdict::Kind::kUnreadable);
}

}  // namespace
}  // namespace rmlcell::motion
