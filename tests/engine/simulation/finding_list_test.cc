#include "engine/simulation/report/finding_list.h"

#include <gtest/gtest.h>

#include "engine/machine/family.h"

namespace rmlcell::simulation {
namespace {

Diagnostic Warning(int step, std::string detail = {}) {
  Diagnostic diagnostic{};
  diagnostic.code = ErrorCode::kSpeedLimited;
  diagnostic.severity = Severity::kWarning;
  diagnostic.detail = std::move(detail);
  diagnostic.program = 3;
  diagnostic.step = step;
  return diagnostic;
}

TEST(FindingList, SameFindingAtTheSameStepIsCounted) {
  FindingList list;
  list.Add(SimTime(10), Warning(5, "first"));
  list.Add(SimTime(20), Warning(6));
  list.Add(SimTime(30), Warning(5, "second"));
  ASSERT_EQ(list.findings().size(), 2u);
  EXPECT_EQ(list.findings()[0].count, 2u);
  EXPECT_EQ(list.findings()[0].first_at, SimTime(10));
  EXPECT_EQ(list.findings()[0].diagnostic.at, SimTime(10));
  EXPECT_EQ(list.findings()[0].diagnostic.detail, "first");
  EXPECT_EQ(list.findings()[1].count, 1u);
  Diagnostic other = Warning(5);
  other.code = ErrorCode::kFlyCancelled;
  list.Add(SimTime(40), other);
  EXPECT_EQ(list.findings().size(), 3u);
}

// Bounded: kDiagnosticsMax are kept, the others counted; known ones go on counting.
TEST(FindingList, FindingsPastTheLimitAreCounted) {
  FindingList list;
  const int limit = static_cast<int>(machine::kDiagnosticsMax);
  for (int step = 1; step <= limit + 2; ++step) list.Add(SimTime(step), Warning(step));
  EXPECT_EQ(list.findings().size(), machine::kDiagnosticsMax);
  EXPECT_EQ(list.dropped().count(), 2u);
  list.Add(SimTime(1), Warning(1));
  EXPECT_EQ(list.findings().front().count, 2u);
  EXPECT_EQ(list.dropped().count(), 2u);
  // Those that come without a text, too; by kind, to the last place.
  list.Count(SimTime(5), Warning(limit + 9));
  ASSERT_EQ(list.dropped().kinds().size(), 1u);
  const GatheredFindings& rest = list.dropped().kinds().at(ErrorCode::kSpeedLimited);
  EXPECT_EQ(rest.count, 3u);
  EXPECT_EQ(rest.first.step, limit + 1);
  EXPECT_EQ(rest.last.step, limit + 9);
}

// The alarm that ends a run is told behind a thousand warnings, in place of the last of them, which
// is counted as often as it came.
TEST(FindingList, TheFirstErrorIsTold) {
  FindingList list;
  const int limit = static_cast<int>(machine::kDiagnosticsMax);
  for (int step = 1; step <= limit; ++step) list.Add(SimTime(step), Warning(step));
  list.Add(SimTime(limit), Warning(limit));
  Diagnostic error = Warning(5, "why it ended");
  error.code = ErrorCode::kSyntax;
  error.severity = Severity::kCompile;
  list.Add(SimTime(3000), error);
  ASSERT_EQ(list.findings().size(), machine::kDiagnosticsMax);
  EXPECT_EQ(list.findings().back().diagnostic.detail, "why it ended");
  EXPECT_EQ(list.findings()[machine::kDiagnosticsMax - 2].diagnostic.step, limit - 1);
  const GatheredFindings& rest = list.dropped().kinds().at(ErrorCode::kSpeedLimited);
  EXPECT_EQ(rest.count, 2u);
  EXPECT_EQ(rest.first.step, limit);
  EXPECT_EQ(rest.last_at, SimTime(limit));
  // It is counted from now on, as is the next error; what is told goes on counting where it is.
  list.Add(SimTime(4000), Warning(limit));
  error.step = 6;
  list.Add(SimTime(5000), error);
  error.step = 5;
  list.Add(SimTime(6000), error);
  EXPECT_EQ(list.dropped().kinds().at(ErrorCode::kSpeedLimited).count, 3u);
  EXPECT_EQ(list.dropped().kinds().at(ErrorCode::kSyntax).count, 1u);
  EXPECT_EQ(list.findings().back().count, 2u);
}

}  // namespace
}  // namespace rmlcell::simulation
