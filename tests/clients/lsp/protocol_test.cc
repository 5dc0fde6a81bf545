#include "clients/lsp/protocol.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace rmlcell::lsp {
namespace {

TEST(Protocol, JsonIsRefusedWhenItIsNoneOrTooDeep) {
  EXPECT_FALSE(ReadJson(""));
  EXPECT_FALSE(ReadJson("{\"a\":"));
  EXPECT_FALSE(ReadJson("{} {}"));
  EXPECT_FALSE(ReadJson("\"\xFF\""));
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_TRUE(ReadJson(nested(kJsonDepthMax)));
  EXPECT_FALSE(ReadJson(nested(kJsonDepthMax + 1)));
  EXPECT_FALSE(ReadJson(std::string(50'000'000, '[')));
  EXPECT_TRUE(ReadJson("\"[[[[\\\"" + std::string(100, '[') + "\""));  // text is not nested
}

// Editors written in JavaScript send half a pair while one is typed, or cut in two. U+FFFD takes one
// unit of UTF-16 as well, so that later positions fit.
TEST(Protocol, HalfASurrogatePairIsReplaced) {
  const std::string replaced = "\xEF\xBF\xBD";
  const auto text = [](std::string_view json) {
    const auto read = ReadJson(json);
    return read && read->is_string() ? read->get<std::string>() : std::string("nothing");
  };
  EXPECT_EQ(text(R"("a\ud834z")"), "a" + replaced + "z");
  EXPECT_EQ(text(R"("\uDD1E\uD834")"), replaced + replaced);
  EXPECT_EQ(text(R"("\ud834\ud834\udd1e")"), replaced + "\xF0\x9D\x84\x9E");
  EXPECT_EQ(text(R"("\ud834\u0041")"), replaced + "A");
  EXPECT_EQ(text(R"("\\\ud834")"), "\\" + replaced);
  EXPECT_EQ(text(R"("\\ud834 \ud834")"), "\\ud834 " + replaced);
  EXPECT_EQ(text(R"("\ud834\ud8")"), "nothing");
  EXPECT_EQ(text(R"("\ud834)"), "nothing");
}

TEST(Protocol, BytesThatAreNoUtf8AreReplacedWhenWritten) {
  EXPECT_EQ(WriteJson(Json("a\xFFz")), "\"a\xEF\xBF\xBDz\"");
}

TEST(Protocol, PositionsAreWholeNumbersFromZero) {
  EXPECT_EQ(ReadPosition({{"line", 3}, {"character", 4}}), (Position{3, 4}));
  EXPECT_EQ(ReadPosition({{"line", 3}, {"character", 4294967296.0}}), std::nullopt);
  EXPECT_EQ(ReadPosition({{"line", 3}, {"character", 18446744073709551615U}}),
            (Position{3, 4294967295U}));
  EXPECT_EQ(ReadPosition({{"line", -1}, {"character", 4}}), std::nullopt);
  EXPECT_EQ(ReadPosition({{"line", "3"}, {"character", 4}}), std::nullopt);
  EXPECT_EQ(ReadPosition(Json::array()), std::nullopt);
  EXPECT_EQ(ReadRange({{"start", {{"line", 0}, {"character", 0}}}}), std::nullopt);
}

TEST(Protocol, MembersAreReadAlongAPathWhateverIsThere) {
  const Json json = {{"a", {{"b", {{"c", "text"}, {"n", 5}, {"f", true}, {"l", {1, "x"}}}}}}};
  EXPECT_EQ(TextMember(json, {"a", "b", "c"}), "text");
  EXPECT_EQ(TextMember(json, {"a", "b", "n"}), std::nullopt);
  EXPECT_EQ(TextMember(json, {"a", "c", "b"}), std::nullopt);
  EXPECT_EQ(TextMember(json, {"a", "b", "c", "d"}), std::nullopt);
  EXPECT_EQ(NumberMember(json, {"a", "b", "n"}), 5);
  EXPECT_TRUE(FlagMember(json, {"a", "b", "f"}));
  EXPECT_FALSE(FlagMember(json, {"a", "b", "n"}));
}

}  // namespace
}  // namespace rmlcell::lsp
