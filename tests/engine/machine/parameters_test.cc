#include "engine/machine/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/engine/core/arguments_text.h"

namespace rmlcell::machine {
namespace {

using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

constexpr std::array kTable = {
    ParameterInfo{"VMAX", "mm/s", 500.0, 1.0, 1000.0, {}, "greatest speed", "T-1"},
    ParameterInfo{"OFFSET", "mm", 0.0, -10.0, 10.0, {}, "an offset", "T-2"},
    ParameterInfo{"DIRECTION", "", 0.0, 0.0, 0.0, "ARROW EFA51 NONE", "a word", "T-3"},
};

std::optional<ErrorCode> CodeOf(const Status& status) {
  return status ? std::nullopt : std::optional(status.error().code);
}

TEST(Parameters, HaveTheirDefaults) {
  const Parameters parameters(kTable);
  EXPECT_EQ(parameters.Number("VMAX"), 500.0);
  EXPECT_EQ(parameters.Word("DIRECTION"), "ARROW");  // the first word
  EXPECT_THAT(parameters.Changed(), IsEmpty());
  EXPECT_EQ(parameters.table().size(), 3U);
}

TEST(Parameters, AreSetAsNumbersOrAsTextWithoutRegardToCase) {
  Parameters parameters(kTable);
  EXPECT_TRUE(parameters.Set("vmax", 12.5));
  EXPECT_EQ(parameters.Number("VMAX"), 12.5);
  EXPECT_TRUE(parameters.Set("Vmax", std::string_view("7")));
  EXPECT_EQ(parameters.Number("VMAX"), 7.0);
  EXPECT_TRUE(parameters.Set("Direction", std::string_view("efa51")));
  EXPECT_EQ(parameters.Word("DIRECTION"), "EFA51");
}

TEST(Parameters, RangesIncludeTheirEnds) {
  Parameters parameters(kTable);
  EXPECT_TRUE(parameters.Set("VMAX", 1.0));
  EXPECT_TRUE(parameters.Set("VMAX", 1000.0));
  EXPECT_TRUE(parameters.Set("OFFSET", -10.0));
  for (const double value : {0.999, 1000.001, -1.0, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(CodeOf(parameters.Set("VMAX", value)), ErrorCode::kCellParameterRange) << value;
  }
  EXPECT_EQ(parameters.Number("VMAX"), 1000.0);  // unchanged on error
}

TEST(Parameters, RefusalsKnowNameValueAndRangeInTheirUnit) {
  Parameters parameters(kTable);
  const auto told = [](const Status& status) {
    return status ? std::string("good") : ArgumentsText(status.error().detail);
  };
  const Status high = parameters.Set("VMAX", 2000.5);
  EXPECT_EQ(high.error().detail, "VMAX is 2000.5, allowed are 1 to 1000");
  EXPECT_EQ(told(high), "name='VMAX' value=2000.5 mm/s least=1 mm/s most=1000 mm/s");
  EXPECT_EQ(told(parameters.Set("VMIN", 1.0)), "name='VMIN'");
  EXPECT_EQ(told(parameters.Set("VMAX", std::string_view("fast"))), "name='VMAX' word='fast'");
  EXPECT_EQ(told(parameters.Set("DIRECTION", std::string_view("LEFT"))),
            "name='DIRECTION' choices='ARROW EFA51 NONE'");
  const Detail offset = parameters.ToldNumber("limit", "OFFSET");
  EXPECT_EQ(offset, "0");
  EXPECT_EQ(ArgumentsText(offset), "limit=0 mm");
}

TEST(Parameters, WhatIsNotThereOrNotSuchIsRefused) {
  Parameters parameters(kTable);
  EXPECT_EQ(CodeOf(parameters.Set("VMIN", 1.0)), ErrorCode::kCellUnknownParameter);
  EXPECT_EQ(CodeOf(parameters.Set("", std::string_view("1"))), ErrorCode::kCellUnknownParameter);
  EXPECT_EQ(CodeOf(parameters.Set("DIRECTION", 1.0)), ErrorCode::kCellParameterRange);
  for (const std::string_view text : {"", "AR", "ARROW EFA51", "ARROW ", "1"}) {
    EXPECT_EQ(CodeOf(parameters.Set("DIRECTION", text)), ErrorCode::kCellParameterRange) << text;
  }
  for (const std::string_view text : {"", "fast", "7 ", "7mm", "1e999", "nan", "inf"}) {
    EXPECT_EQ(CodeOf(parameters.Set("VMAX", text)), ErrorCode::kCellParameterRange) << text;
  }
  EXPECT_THAT(parameters.Changed(), IsEmpty());
}

TEST(Parameters, AProfileIsAppliedWholeOrNotAtAll) {
  Parameters parameters(kTable);
  EXPECT_TRUE(parameters.Apply(
      {.id = "a", .title = "", .values = {{"VMAX", 700.0}, {"DIRECTION", "NONE"}}}));
  EXPECT_EQ(parameters.Number("VMAX"), 700.0);
  EXPECT_EQ(parameters.Word("DIRECTION"), "NONE");
  EXPECT_FALSE(
      parameters.Apply({.id = "b", .title = "", .values = {{"VMAX", 800.0}, {"OFFSET", 11.0}}}));
  EXPECT_EQ(parameters.Number("VMAX"), 700.0);
  // Single values go over the profile.
  EXPECT_TRUE(parameters.Set("VMAX", 600.0));
  EXPECT_EQ(parameters.Number("VMAX"), 600.0);
}

TEST(Parameters, ChangedIsWhatDiffersFromTheDefaultsAndReadsBack) {
  Parameters parameters(kTable);
  EXPECT_TRUE(parameters.Set("VMAX", 0.1 + 999.2));
  EXPECT_TRUE(parameters.Set("DIRECTION", std::string_view("none")));
  EXPECT_TRUE(parameters.Set("OFFSET", 0.0));  // its default
  EXPECT_THAT(parameters.Changed(),
              UnorderedElementsAre(Pair("VMAX", "999.3000000000001"), Pair("DIRECTION", "NONE")));
  Parameters read(kTable);
  for (const auto& [name, text] : parameters.Changed())
    EXPECT_TRUE(read.Set(name, std::string_view(text)));
  EXPECT_EQ(read.Number("VMAX"), parameters.Number("VMAX"));
  EXPECT_EQ(read.Changed(), parameters.Changed());
  EXPECT_TRUE(parameters.Set("VMAX", 500.0));
  EXPECT_TRUE(parameters.Set("DIRECTION", std::string_view("ARROW")));
  EXPECT_THAT(parameters.Changed(), IsEmpty());
}

// What is told: the name as the table writes it, the value seen and what is allowed.
TEST(Parameters, ErrorsSayWhatIsAllowed) {
  Parameters parameters(kTable);
  EXPECT_EQ(parameters.Set("VMIN", 1.0).error().detail, "VMIN");
  EXPECT_EQ(parameters.Set("vmin", std::string_view("x")).error().detail, "vmin");
  EXPECT_EQ(parameters.Set("vmax", 0.5).error().detail, "VMAX is 0.5, allowed are 1 to 1000");
  EXPECT_EQ(parameters.Set("offset", std::string_view("-10.5")).error().detail,
            "OFFSET is -10.5, allowed are -10 to 10");
  EXPECT_EQ(parameters.Set("vmax", std::string_view("fast")).error().detail,
            "VMAX takes a number, not 'fast'");
  EXPECT_EQ(parameters.Set("direction", 1.0).error().detail,
            "DIRECTION takes one of ARROW EFA51 NONE");
  EXPECT_EQ(parameters.Set("direction", std::string_view("SOUTH")).error().detail,
            "DIRECTION takes one of ARROW EFA51 NONE");
  const Status unknown = parameters.Apply({.id = "c", .title = "", .values = {{"NEW", 1.0}}});
  EXPECT_EQ(CodeOf(unknown), ErrorCode::kCellUnknownParameter);
  const Status word =
      parameters.Apply({.id = "d", .title = "", .values = {{"VMAX", 7.0}, {"DIRECTION", "X"}}});
  EXPECT_EQ(CodeOf(word), ErrorCode::kCellParameterRange);
  EXPECT_THAT(parameters.Changed(), IsEmpty());
}

// Each word of a choice, the last too; the death of asking for a word that is a number.
TEST(Parameters, EveryWordOfAChoice) {
  Parameters parameters(kTable);
  for (const std::string_view word : {"NONE", "EFA51", "ARROW"}) {
    EXPECT_TRUE(parameters.Set("DIRECTION", word));
    EXPECT_EQ(parameters.Word("direction"), word);
  }
  EXPECT_EQ(parameters.Number("offset"), 0.0);
  EXPECT_TRUE(parameters.Set("OFFSET", 10.0));
  EXPECT_EQ(parameters.Number("OFFSET"), 10.0);
  EXPECT_DEATH((void)parameters.Word("VMIN"), "check failed");
}

TEST(ParametersDeathTest, AskingForWhatIsNotThereIsOurMistake) {
  const Parameters parameters(kTable);
  EXPECT_DEATH((void)parameters.Number("VMIN"), "check failed");
  EXPECT_DEATH((void)parameters.Number("DIRECTION"), "check failed");
  EXPECT_DEATH((void)parameters.Word("VMAX"), "check failed");
}

}  // namespace
}  // namespace rmlcell::machine
