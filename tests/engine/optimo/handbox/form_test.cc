#include "engine/optimo/handbox/form.h"

#include <gtest/gtest.h>

#include <array>

namespace rmlcell::optimo {
namespace {

// OPT-5.07 OPT-B.76: it shows less than it holds, and holds it as long as nothing is typed.
TEST(HandboxForm, ARealFieldKeepsItsValue) {
  Field field = Field::Real("SPEED ", 70.25, 0.0, 100.0);
  EXPECT_EQ(field.text(), "SPEED 70.2");
  EXPECT_EQ(field.value(), 70.25);
  EXPECT_EQ(Field::Real("RAD = ", 12.75, 0.0, 100.0, Decimals::kUpToThree).text(), "RAD = 12.75");
  EXPECT_EQ(Field::Real("OVERSH ", 50.0, 0.0, 100.0, Decimals::kIfAny).text(), "OVERSH 50");
}

// OPT-5.07 OPT-4.41: a sign only in front, one point, and no more than there is room for.
TEST(HandboxForm, ARealFieldTakesANumber) {
  Field field = Field::Real("", 0.0, -1e6, 1e6);
  field.Clear();
  EXPECT_FALSE(field.InRange());
  for (const char c : {'-', '-', '.', '5', '.', '2', '-'}) field.Type(c);
  EXPECT_EQ(field.text(), "-.52");
  EXPECT_EQ(field.value(), -0.52);
  field.Clear();
  for (int i = 0; i < 20; ++i) field.Type('1');
  EXPECT_EQ(field.text(), "111111111");
  field.Clear();
  for (const char c : {'1', '2', '.'}) field.Type(c);
  EXPECT_EQ(field.value(), 12.0);
  field.Clear();
  field.Type('-');
  EXPECT_FALSE(field.InRange());
  field.Clear();
  field.Type('.');
  EXPECT_FALSE(field.InRange());
}

// OPT-5.10
TEST(HandboxForm, BothEndsOfARangeAreIn) {
  for (const auto& [text, in] : {std::pair{"0", true}, std::pair{"100", true},
                                 std::pair{"100.1", false}, std::pair{"-1", false}}) {
    Field field = Field::Real("", 5.0, 0.0, 100.0);
    field.Clear();
    for (const char* c = text; *c != 0; ++c) field.Type(*c);
    EXPECT_EQ(field.InRange(), in) << text;
  }
  EXPECT_FALSE(Field::Whole("", 2, 0, 1, 99).InRange());
  EXPECT_TRUE(Field::Whole("", 2, 99, 1, 99).InRange());
}

// OPT-5.01: fields of a line, then the next line; what is out of range is shown.
TEST(HandboxForm, GoesThroughFields) {
  Form form(FormKind::kSimul, {{Field::Whole("A", 1, 1, 0, 9), Field::Whole("B", 1, 2, 0, 9)},
                               {Field::Whole("C", 1, 3, 1, 9)}});
  EXPECT_EQ(form.count(), 3U);
  form.Move(true);
  form.Type('7');
  EXPECT_EQ(form.text(), "A1B7");
  form.Move(true);
  form.Clear();
  EXPECT_EQ(form.text(), "C0");
  form.Move(false);
  form.Move(false);
  form.Move(false);
  form.Type('8');
  EXPECT_EQ(form.text(), "A8B7");
  EXPECT_FALSE(form.Check());
  EXPECT_EQ(form.text(), "C0");
  form.Type('4');
  EXPECT_TRUE(form.Check());
  EXPECT_EQ(form.at(0).whole(), 8);
  EXPECT_EQ(form.at(2).whole(), 4);
}

// OPT-5.01: words are chosen from in a ring, and nothing is typed into them.
TEST(HandboxForm, WordsAreChosen) {
  Form form = Form::OfLines(FormKind::kBreak, {Field::Choice("BREAK = ", {"OFF", "ON"}, 0)});
  form.Type('1');
  form.Clear();
  EXPECT_EQ(form.text(), "BREAK = OFF");
  form.Move(false);
  EXPECT_EQ(form.text(), "BREAK = ON");
  form.Move(false);
  EXPECT_EQ(form.text(), "BREAK = OFF");
}

// OPT-5.01: NEXT stays at the last field of a line that is the last one, PREV at the first.
TEST(HandboxForm, ItStaysAtItsEnds) {
  Form form(FormKind::kProcess, {{Field::Whole("A", 1, 1, 0, 9), Field::Whole("B", 1, 2, 0, 9)}});
  form.Move(true);
  form.Move(true);
  form.Type('7');
  EXPECT_EQ(form.text(), "A1B7");
  form.Move(false);
  form.Move(false);
  form.Type('8');
  EXPECT_EQ(form.text(), "A8B7");
}

}  // namespace
}  // namespace rmlcell::optimo
