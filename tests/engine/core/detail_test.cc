#include "engine/core/detail.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>

#include "engine/core/near_words.h"
#include "engine/core/result.h"
#include "tests/engine/core/arguments_text.h"

namespace rmlcell {
namespace {

Detail Two() { return Told("values", 2); }

TEST(Detail, NumbersAndWordsStandInTheTextAndBesideIt) {
  const Detail count = Told("label", std::uint16_t{60});
  EXPECT_EQ(count, "60");
  ASSERT_EQ(count.arguments().size(), 1U);
  EXPECT_EQ(count.arguments()[0], (Argument{"label", 60.0, ""}));
  const Detail word = Told("name", "ZONE1");
  EXPECT_EQ(word, "ZONE1");
  EXPECT_EQ(word.arguments()[0], (Argument{"name", std::string("ZONE1"), ""}));
  const Detail speed = Told("speed", 12.5, "mm/s", "12.5 mm/s");
  EXPECT_EQ(speed, "12.5 mm/s");
  EXPECT_EQ(speed.arguments()[0], (Argument{"speed", 12.5, "mm/s"}));
  EXPECT_EQ(Told("step", std::int64_t{-7}), "-7");
  EXPECT_EQ(Told("bytes", std::uint64_t{1} << 40), "1099511627776");
}

TEST(Detail, TextAloneKnowsNothing) {
  EXPECT_EQ(ArgumentsText("radius is 0"), "");
  EXPECT_EQ(ArgumentsText(std::string("radius is 0")), "");
  EXPECT_TRUE(Detail().empty());
}

TEST(Detail, JoinsWithEveryKindOfTextOnEitherSide) {
  const std::string string = " of ";
  const std::string_view view = string;
  const char* const letters = " of ";
  const auto is = [](const Detail& joined, const char* text) {
    EXPECT_EQ(joined, text);
    EXPECT_EQ(ArgumentsText(joined), "values=2") << text;
  };
  is(Two() + string, "2 of ");
  is(Two() + std::string(" of "), "2 of ");
  is(Two() + view, "2 of ");
  is(Two() + letters, "2 of ");
  is(Two() + '.', "2.");
  is(string + Two(), " of 2");
  is(std::string(" of ") + Two(), " of 2");
  is(view + Two(), " of 2");
  is(letters + Two(), " of 2");
  is('(' + Two(), "(2");
  const Detail kept = Two();
  is(kept + " values", "2 values");
  is("of " + kept, "of 2");
  is(kept, "2");
}

TEST(Detail, ArgumentsComeInTheOrderOfTheText) {
  const Detail joined = "MOVE has " + Told("values", 2) + (true ? " values" : " value") +
                        ", needs " + Told("needed", 5) + ": " + Told("first", "X") + '.';
  EXPECT_EQ(joined, "MOVE has 2 values, needs 5: X.");
  EXPECT_EQ(ArgumentsText(joined), "values=2 needed=5 first='X'");
  EXPECT_EQ(ArgumentsText(Told("first", 1) + Told("second", 2)), "first=1 second=2");
}

TEST(Detail, GrowsByEveryKindOfText) {
  Detail detail = "the run takes";
  detail += ' ';
  detail += std::string("longer ");
  detail += std::string_view("than ");
  detail += Told("limit", 5.0, "s", "5.0 s");
  detail += ": ";
  detail += Told("step", 3);
  EXPECT_EQ(detail, "the run takes longer than 5.0 s: 3");
  EXPECT_EQ(ArgumentsText(detail), "limit=5 s step=3");
  detail += Detail(detail);
  EXPECT_EQ(detail.arguments().size(), 4U);
  Detail twice = Told("step", 3);
  twice += twice;
  EXPECT_EQ(twice, "33");
  EXPECT_EQ(ArgumentsText(twice), "step=3 step=3");
}

TEST(Detail, WhatIsMovedOrHandedOnKeepsItsArguments) {
  Detail made = "radius is " + Told("radius", 0.0, "mm", "0");
  const Error error = InvalidArgument(std::move(made));
  EXPECT_EQ(ArgumentsText(error.detail), "radius=0 mm");
  const Error wrapped = InvalidArgument("process " + Told("process", 3) + ": " + error.detail);
  EXPECT_EQ(wrapped.detail, "process 3: radius is 0");
  EXPECT_EQ(ArgumentsText(wrapped.detail), "process=3 radius=0 mm");
}

TEST(Detail, IsEqualByItsText) {
  EXPECT_EQ("label " + Told("label", 60), Detail("label 60"));
  EXPECT_EQ("label " + Told("label", 60), "label 60");
  EXPECT_NE(Told("label", 60), Told("label", 61));
  EXPECT_EQ((Error{ErrorCode::kCellNotFound, Told("program", 3), {}}),
            (Error{ErrorCode::kCellNotFound, "3", {}}));
}

TEST(Detail, KnowsEveryWordThatMayHaveBeenMeant) {
  const std::string words[] = {"GO", "GOTO", "GOSUB"};
  const Detail question = DidYouMean(words);
  EXPECT_EQ(question, "; did you mean GO, GOTO or GOSUB?");
  EXPECT_EQ(ArgumentsText(question), "near='GO' near='GOTO' near='GOSUB'");
}

}  // namespace
}  // namespace rmlcell
