// What is said about a directive cannot be silenced, not even by that
// directive.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/optimo/editing/allowance.h"

namespace rmlcell::optimo::editing {
namespace directive_places {
namespace {

std::optional<Fix> AllowedAt(std::string_view text, std::size_t offset) {
  Diagnostic finding{.code = ErrorCode::kPracticeAdvice, .severity = Severity::kAdvice};
  finding.where.byte_offset = static_cast<std::int64_t>(offset);
  return Allowance(text, finding);
}

// The same row takes the number of a finding of its statement, and none of one
// of the comment.
TEST(DirectivePlaces, AFindingOfADirectiveIsNotAllowedByIt) {
  constexpr std::string_view kText = "SPEED 5\nVR[98] = 1. ; rmlcell: allow 7413\nSTOP\n";
  const std::size_t comment = kText.find(';'), end = kText.find("\nSTOP");
  EXPECT_EQ(AllowedAt(kText, comment), std::nullopt);
  EXPECT_EQ(AllowedAt(kText, comment - 1), (Fix{static_cast<std::int64_t>(end), 0, " 7033"}));
  EXPECT_EQ(AllowedAt(kText, 8), (Fix{static_cast<std::int64_t>(end), 0, " 7033"}));
  EXPECT_EQ(AllowedAt("; rmlcell: allow 7413", 0), std::nullopt);
}

}  // namespace
}  // namespace directive_places
}  // namespace rmlcell::optimo::editing
