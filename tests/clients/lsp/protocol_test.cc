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

// Editors written in JavaScript send half a pair while one is typed, or cut in two. U+FFFD takes
// one unit of UTF-16 as well, so that later positions fit.
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

// Nesting is how many are open at a time, not how many there were.
TEST(Protocol, NeighboursAreNotNested) {
  std::string flat = "[";
  for (int k = 0; k < kJsonDepthMax + 9; ++k) flat += "[],{},";
  EXPECT_TRUE(ReadJson(flat + "0]"));
}

// Pairs are whole, halves are at the ends of their ranges; digits of an escape in either case.
TEST(Protocol, EscapesAtTheEndsOfTheSurrogates) {
  const std::string replaced = "\xEF\xBF\xBD";
  const auto text = [](std::string_view json) {
    const auto read = ReadJson(json);
    return read && read->is_string() ? read->get<std::string>() : std::string("nothing");
  };
  EXPECT_EQ(text(R"("\uD7FF\uD800")"), "\xED\x9F\xBF" + replaced);
  EXPECT_EQ(text(R"("\uE000\uDFFF")"), "\xEE\x80\x80" + replaced);
  EXPECT_EQ(text(R"("\udbffx")"), replaced + "x");
  EXPECT_EQ(text(R"("\ud800\udc00\ud800")"), "\xF0\x90\x80\x80" + replaced);
  EXPECT_EQ(text(R"("\udbff\udfff\udc00")"), "\xF4\x8F\xBF\xBF" + replaced);
  EXPECT_EQ(text(R"("\ud800\ue000")"), replaced + "\xEE\x80\x80");
  EXPECT_EQ(text(R"("\ud800\udbff")"), replaced + replaced);
}

TEST(Protocol, NumbersListsAndRanges) {
  const Json json = {{"n", 5}, {"u", 5U}, {"f", 5.0}, {"t", "5"}, {"l", {"x", 1}}};
  EXPECT_EQ(NumberMember(json, {"u"}), 5);
  EXPECT_EQ(NumberMember(json, {"f"}), std::nullopt);
  EXPECT_EQ(NumberMember(json, {"t"}), std::nullopt);
  EXPECT_EQ(NumberMember(json, {"none"}), std::nullopt);
  EXPECT_TRUE(Lists(json, {"l"}, "x"));
  EXPECT_FALSE(Lists(json, {"l"}, "y"));
  EXPECT_FALSE(Lists(json, {"t"}, "5"));
  EXPECT_FALSE(Lists(json, {"none"}, "x"));
  EXPECT_EQ(ReadPosition({{"line", 0}, {"character", 0}}), (Position{0, 0}));
  EXPECT_EQ(ReadPosition({{"line", 0}, {"character", -1}}), std::nullopt);
  EXPECT_EQ(ReadPosition({{"line", 0}}), std::nullopt);
  const Json first = {{"line", 1}, {"character", 2}}, second = {{"line", 3}, {"character", 4}};
  EXPECT_EQ(ReadRange({{"start", first}, {"end", second}}), (Range{{1, 2}, {3, 4}}));
  EXPECT_EQ(ReadRange({{"start", first}, {"end", 5}}), std::nullopt);
  EXPECT_EQ(ReadRange({{"start", 5}, {"end", second}}), std::nullopt);
  EXPECT_EQ(ReadRange({{"end", second}}), std::nullopt);
  const Range range{{1, 2}, {3, 4}};
  const Json written = {{"start", first}, {"end", second}};
  EXPECT_EQ(ToJson(range), written);
  EXPECT_EQ(Location("u", range), (Json{{"uri", "u"}, {"range", written}}));
  EXPECT_EQ(TextEdit(range, "t"), (Json{{"range", written}, {"newText", "t"}}));
  EXPECT_EQ(Markdown("m"), (Json{{"kind", "markdown"}, {"value", "m"}}));
}

}  // namespace
}  // namespace rmlcell::lsp
