#include "engine/core/keep_finding.h"

#include <gtest/gtest.h>

namespace rmlcell {
namespace {

Diagnostic Of(ErrorCode code, int step) {
  return {.code = code, .severity = Lookup(code).severity, .detail = "told", .step = step};
}

// Five findings come into a list of two, an error as the fourth and as the fifth of them.
TEST(KeepFinding, TheFirstErrorTakesThePlaceOfTheLastOne) {
  std::vector<Diagnostic> told;
  UntoldFindings untold;
  for (const int step : {1, 2, 3}) KeepFinding(Of(ErrorCode::kWordIgnored, step), 2, told, untold);
  EXPECT_EQ(untold.count(), 1U);
  EXPECT_EQ(told.back().step, 2);
  KeepFinding(Of(ErrorCode::kSyntax, 4), 2, told, untold);
  KeepFinding(Of(ErrorCode::kSyntax, 5), 2, told, untold);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].step, 1);
  EXPECT_EQ(told[1].step, 4);
  EXPECT_EQ(told[1].detail, "told");
  ASSERT_EQ(untold.kinds().size(), 2U);
  const GatheredFindings& words = untold.kinds().at(ErrorCode::kWordIgnored);
  EXPECT_EQ(words.count, 2U);
  EXPECT_EQ(words.first.step, 2);
  EXPECT_EQ(words.last.step, 3);
  EXPECT_EQ(untold.kinds().at(ErrorCode::kSyntax).count, 1U);
  EXPECT_EQ(untold.kinds().at(ErrorCode::kSyntax).first.step, 5);
}

// An error among those that are counted came before: what was told of it went elsewhere.
TEST(KeepFinding, AnErrorThatIsCountedWasTheFirst) {
  std::vector<Diagnostic> told = {Of(ErrorCode::kWordIgnored, 1)};
  UntoldFindings untold;
  untold.Add(Of(ErrorCode::kSyntax, 2));
  KeepFinding(Of(ErrorCode::kSyntax, 3), 1, told, untold);
  EXPECT_EQ(told.front().step, 1);
  EXPECT_EQ(untold.count(), 2U);
}

// Where an error is told already, no other takes its place; where none is told at all, neither.
TEST(KeepFinding, WithoutRoomForOneMore) {
  std::vector<Diagnostic> told;
  UntoldFindings untold;
  KeepFinding(Of(ErrorCode::kSyntax, 1), 0, told, untold);
  EXPECT_TRUE(told.empty());
  untold = {};
  KeepFinding(Of(ErrorCode::kSyntax, 2), 1, told, untold);
  KeepFinding(Of(ErrorCode::kObjectTooLong, 3), 1, told, untold);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told.front().step, 2);
  EXPECT_EQ(untold.count(), 1U);
}

}  // namespace
}  // namespace rmlcell
