#include "engine/core/text_fixes.h"

#include <gtest/gtest.h>

namespace rmlcell {
namespace {

using Fixes = std::vector<Fix>;

std::string Fixed(const std::vector<Fixes>& findings) {
  std::vector<Diagnostic> diagnostics;
  for (const Fixes& fixes : findings) {
    diagnostics.push_back(
        {.code = ErrorCode::kSyntax, .severity = Severity::kCompile, .fixes = fixes});
  }
  return ApplyFixes("0123456789", diagnostics);
}

TEST(TextFixes, AreAppliedFromTheFrontWhateverTheirOrder) {
  EXPECT_EQ(Fixed({{}}), "0123456789");
  EXPECT_EQ(Fixed({{{7, 1, "c"}, {2, 3, "ab"}}, {{0, 1, ""}}}), "1ab56c89");
  EXPECT_EQ(Fixed({{{10, 0, "end"}}, {{0, 0, "begin"}}}), "begin0123456789end");
}

// Where two fixes of one finding overlap the one that begins first counts.
TEST(TextFixes, OfOneFindingMayOverlap) {
  EXPECT_EQ(Fixed({{{3, 2, "c"}, {2, 3, "ab"}}}), "01ab56789");
  EXPECT_EQ(Fixed({{{2, 1, "a"}, {3, 1, "b"}}}), "01ab456789");
}

// What does not fit into the text, or touches the repair of an earlier finding, is left alone; a
// finding is repaired whole or not at all.
TEST(TextFixes, OfFindingsThatMeetTheEarlierIsRepaired) {
  const std::string same = "0123456789";
  EXPECT_EQ(Fixed({{{-1, 1, "x"}}}), same);
  EXPECT_EQ(Fixed({{{5, -1, "x"}}}), same);
  EXPECT_EQ(Fixed({{{9, 2, "x"}}}), same);
  EXPECT_EQ(Fixed({{{9, 1, "x"}}}), "012345678x");
  EXPECT_EQ(Fixed({{{0, 1, "x"}, {9, 2, "y"}}}), same);
  const Fixes middle = {{4, 2, "x"}};  // "45"
  for (const Fix& meets : {Fix{4, 2, "y"}, Fix{3, 2, "y"}, Fix{5, 2, "y"}, Fix{3, 4, "y"},
                           Fix{4, 0, "y"}, Fix{5, 0, "y"}, Fix{4, 1, "y"}, Fix{5, 1, "y"}}) {
    EXPECT_EQ(Fixed({middle, {meets}}), "0123x6789") << meets.byte_offset << " " << meets.length;
    EXPECT_EQ(Fixed({middle, {meets, {0, 1, "z"}}}), "0123x6789");
  }
  EXPECT_EQ(Fixed({middle, {{6, 1, "y"}}}), "0123xy789");
  EXPECT_EQ(Fixed({middle, {{3, 1, "y"}}}), "012yx6789");
  EXPECT_EQ(Fixed({middle, {{6, 0, "y"}}}), "0123xy6789");
  EXPECT_EQ(Fixed({{{4, 0, "x"}}, {{4, 0, "y"}}}), "0123x456789");
  EXPECT_EQ(Fixed({{{4, 0, "x"}}, {{3, 2, "y"}}}), "0123x456789");
  EXPECT_EQ(Fixed({{{4, 0, "x"}}, {{3, 1, "y"}}}), "012yx456789");
}

}  // namespace
}  // namespace rmlcell
