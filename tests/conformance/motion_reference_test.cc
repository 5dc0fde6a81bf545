#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
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

// Every case of motion.md section 12 agrees with its reference. OPT-2.13, OPT-2.14, OPT-2.42,
// OPT-B.24, OPT-B.31
TEST(MotionReference, EveryCaseAgrees) {
  const std::optional<std::string> text = FileText(kCommitted);
  ASSERT_TRUE(text);
  const Result<std::vector<ReferenceCase>> cases = ReadReferenceCases(*text);
  ASSERT_TRUE(cases) << cases.error().detail;
  ASSERT_EQ(cases->size(), 81u);
  for (const ReferenceCase& reference : *cases) {
    SCOPED_TRACE(reference.name + " " + reference.text);
    const ReferenceVerdict verdict = Judge(reference);
    for (const std::string& difference : verdict.differences) ADD_FAILURE() << difference;
    EXPECT_EQ(verdict.kind, ReferenceVerdict::Kind::kAgrees);
  }
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
  EXPECT_EQ(Judge({"", "", "", R"({"f":"reach"})", R"({"v1":1})"}).kind,
            ReferenceVerdict::Kind::kUnreadable);
  EXPECT_EQ(verdict("{}").kind, ReferenceVerdict::Kind::kUnreadable);
}

// What cannot be computed is told, never passed over.
TEST(MotionReference, TellsWhatMakesNoSense) {
  const auto detail = [](const std::string& input) {
    const ReferenceVerdict verdict = Judge({"", "", "", input, R"({"T":1})"});
    EXPECT_EQ(verdict.kind, ReferenceVerdict::Kind::kUnreadable) << input;
    return verdict.differences.empty() ? "" : verdict.differences.front();
  };
  EXPECT_EQ(detail(R"({"f":"spiral"})"), "there is no kind of case 'spiral'");
  EXPECT_EQ(detail(R"({"f":"rest_to_rest","dist":10,"v":0,"a":2000,"j":40000})"),
            "v is 0: it has to be above 0");
  EXPECT_EQ(detail(R"({"f":"rest_to_rest","dist":10,"v":50,"a":-1,"j":40000})"),
            "a is -1: it has to be above 0");
  EXPECT_EQ(detail(R"({"f":"plan","start":[0,0,0],"start_ab":[0,0],"moves":[
                {"type":"SPLINE","target":[1,0,0],"ab":[0,0],"speed":10}]})"),
            "there is no move of type 'SPLINE'");
  EXPECT_EQ(detail(R"({"f":"span","dist":1,"v0":50,"v1":0,"v":50,"a":2000,"j":40000})"),
            "dist is too short to get from v0 to v1");
  EXPECT_EQ(detail(R"({"f":"span","dist":100,"v0":60,"v1":0,"v":50,"a":2000,"j":40000})"),
            "an end is faster than v");
  EXPECT_EQ(detail(R"({"f":"end_condition","dist":300,"speed":10,"t_true":-9})"),
            "t_true is -9: it is 0 or above");
  EXPECT_EQ(detail(R"({"f":"stop_resume","dist":300,"speed":10,"t":99,"wait":1})"),
            "t is after the end of the motion");
  // 100 mm at 50 mm/s take 2.0707 s, the last 0.0707 of them to brake.
  EXPECT_EQ(detail(R"({"f":"override_change","dist":100,"speed":10,"t":2.02,)"
                   R"("override0":100,"override1":10})"),
            "t is where the motion brakes for its end: nothing changes any more");
  EXPECT_EQ(detail(R"({"f":"clip","points":[[1,1,1]],"box":[[5,0,0],[0,5,5]]})"),
            "the box ends before it begins");
  EXPECT_EQ(detail(R"({"f":"sweep","tool":{"kind":"drill","R":1},"seg":[[0,0,0],[1,0,0]],)"
                   R"("cell":[0,0]})"),
            "there is no tool of kind 'drill'");
}

}  // namespace
}  // namespace rmlcell::motion
