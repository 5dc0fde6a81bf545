#include "engine/rml1/offline/text_parts.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rmlcell::rml1 {
namespace {

// Nothing is lost between the parts, and none is longer than its last piece makes it.
TEST(TextParts, ComeWholeAndInParts) {
  std::vector<std::string> parts;
  TextParts text([&](std::string_view part) { parts.emplace_back(part); });
  std::string all;
  for (int i = 0; i < 60'000; ++i) {
    const std::string piece = std::to_string(i) + ";";
    text.Add(piece);
    all += piece;
  }
  EXPECT_EQ(text.size(), all.size());
  ASSERT_EQ(parts.size(), all.size() / TextParts::kPart);
  text.HandOver();
  std::string joined;
  for (const std::string& part : parts) {
    EXPECT_LT(part.size(), TextParts::kPart + 6);
    joined += part;
  }
  EXPECT_EQ(joined, all);
}

TEST(TextParts, APartIsFullWhenItIsAsLongAsThat) {
  std::size_t parts = 0;
  TextParts text([&](std::string_view) { ++parts; });
  text.Add(std::string(TextParts::kPart - 1, ' '));
  EXPECT_EQ(parts, 0U);
  text.Add(" ");
  EXPECT_EQ(parts, 1U);
}

}  // namespace
}  // namespace rmlcell::rml1
