#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// What stands between two copies of a part, and how many copies there may be. T1: 100 units in a
// mm, X to 200 mm and Y to 150 mm.
namespace rmlcell::rml1 {
namespace {

std::string Tiled(const std::string& part, const TileOptions& options,
                  std::string_view profile = "t1") {
  const auto made = TileStream(part, ParametersOf(profile), options);
  return made ? made->stream : "refused: " + made.error().detail;
}

// The work is 200 by 100 units, 2 by 1 mm.
const std::string kBox = "!PZ0,200;\nPU100,100;PD300,100,300,200;PU0,0;";
constexpr TileOptions kTwo{.columns = 2, .gap_mm = 1.0};

// A part that changes every setting: the copy begins with those of the beginning, in this order,
// behind the lift. Its work is 200 wide, so with 1 mm between the copies they are 300 apart.
TEST(TileBounds, SettingsOfTheBeginningComeAgain) {
  EXPECT_EQ(Tiled("VS4;!VZ2;!DW5;!RC6600;!PZ0,200;!MC1;\nPU100,100;PD300,100;"
                  "VS9;!VZ3;!DW7;!RC9000;!PZ-10,300;PD300,200;PU100,100;",
                  kTwo),
            "VS4;!VZ2;!DW5;!RC6600;!PZ0,200;!MC1;\nPU100,100;PD300,100;"
            "VS9;!VZ3;!DW7;!RC9000;!PZ-10,300;PD300,200;\n"
            "PU;\nVS4;\n!VZ2;\n!DW5;\n!RC6600;\n!PZ0,200;\n"
            "PU400,100;PD600,100;VS9;!VZ3;!DW7;!RC9000;!PZ-10,300;PD600,200;\n"
            "PU;\n;PU100,100;");
}

// Each by itself: what has not changed is not said again.
TEST(TileBounds, OnlyWhatHasChangedComesAgain) {
  const auto between = [](const std::string& change, std::string_view profile = "t1") {
    const std::string head = "VS4;!VZ2;!PZ-5,200;!MC1;!RC3;\n";
    const std::string made =
        Tiled(head + "PU100,100;PD300,100;" + change + "PD300,200;PU0,0;", kTwo, profile);
    const std::string first = change + "PD300,200;\nPU;\n";
    const std::size_t begin = made.find(first) + first.size();
    return made.substr(begin, made.find("PU400,100;") - begin);
  };
  EXPECT_EQ(between(""), "");
  EXPECT_EQ(between("VS5;"), "VS4;\n");
  EXPECT_EQ(between("!VZ5;"), "!VZ2;\n");
  EXPECT_EQ(between("!DW5;"), "!DW0;\n");
  EXPECT_EQ(between("!MC0;"), "!MC1;\n");
  EXPECT_EQ(between("!PZ-6,200;"), "!PZ-5,200;\n");
  EXPECT_EQ(between("!PZ-5,201;"), "!PZ-5,200;\n");
  // RML1-9.31: 16 stages from 4500 to 15000 rpm, 700 apart. The third is 6600 rpm.
  EXPECT_EQ(between("!RC5;"), "!RC6600;\n");
  EXPECT_EQ(between("!RC5;", "t1s"), "!RC3;\n");
  EXPECT_EQ(between("!RC15;", "t1s"), "!RC3;\n");
}

// A tool that is up at the surface still touches the work: to the copy the way leads at the top.
TEST(TileBounds, TheToolUpAtTheSurfaceIsLifted) {
  EXPECT_EQ(Tiled("!PZ-10,0;PU100,100;PD300,100;PU;PU0,0;", kTwo),
            "!PZ-10,0;PU100,100;PD300,100;PU;\n!ZM0;\nPU400,100;PD600,100;PU;\n!ZM0;\n;PU0,0;");
}

// The lift behind the last cut belongs to the copy, and what comes behind a way across does not.
TEST(TileBounds, WhereACopyEnds) {
  EXPECT_EQ(Tiled("!PZ-10,200;PU100,100;PD300,100;PU;PU0,0;!ZM0;", kTwo),
            "!PZ-10,200;PU100,100;PD300,100;PU;\nPU400,100;PD600,100;PU;\n;PU0,0;!ZM0;");
  EXPECT_EQ(Tiled("!PZ-10,200;PU100,100;PD300,100;PU0,0;!ZM0;", kTwo),
            "!PZ-10,200;PU100,100;PD300,100;\nPU;\nPU400,100;PD600,100;\nPU;\n;PU0,0;!ZM0;");
  // Nothing need stand between two commands, and a turn is no lift.
  EXPECT_EQ(Tiled("!PZ-10,200;PU100,100;PD300,100PU0,0;", kTwo),
            "!PZ-10,200;PU100,100;PD300,100;\nPU;\nPU400,100;PD600,100;\nPU;\nPU0,0;");
  EXPECT_EQ(Tiled("!PZ-10,200;PU100,100;PD300,100;PU;!ZE A90;PU0,0;", kTwo, "t1a"),
            "!PZ-10,200;PU100,100;PD300,100;PU;\nPU400,100;PD600,100;PU;\n;!ZE A90;PU0,0;");
}

// Behind the lift the spindle stops once, behind the last copy, and so does the whole machine.
TEST(TileBounds, WhatMovesNothingIsNoLift) {
  for (const std::string last : {"!MC0;", "!NR;"}) {
    EXPECT_EQ(
        Tiled("!PZ-10,200;!MC1;PU100,100;PD300,100;PU;" + last + "PU0,0;", kTwo),
        "!PZ-10,200;!MC1;PU100,100;PD300,100;PU;\nPU400,100;PD600,100;PU;\n;" + last + "PU0,0;");
  }
}

// RML1-3A.21: with the names of mode 1 alone the lift makes coordinates absolute.
TEST(TileBounds, NamesOfModeOne) {
  machine::Parameters old = ParametersOf("t1");
  ASSERT_TRUE(old.Set("COMMAND", std::string_view("MODE1")));
  const auto made = TileStream("@-10,200;M100,100;I200,0;M0,0;", old, kTwo);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->stream, "@-10,200;M100,100;I200,0;\nM;\nM400,100;I200,0;\nM;\n^PR;\n;M0,0;");
}

TEST(TileBounds, PartsThatCannotComeAgain) {
  EXPECT_EQ(Tiled("!MC0;!ZM-2000;PD;PD100,0;PU;", kTwo),
            "refused: the tool is down where the first copy begins: lift it there");
  EXPECT_EQ(Tiled("!PZ-10,200;PU100,100;PD300,100;PD300,.;PU;", {.rows = 2}),
            "refused: a lone period as a number: write 0");
  machine::Parameters between = ParametersOf("t1");
  ASSERT_TRUE(between.Set("Z0", -20.005));
  const auto made = TileStream("!PZ-50,100;PU100,100;!ZO-2500;PD300,100;PU;", between, kTwo);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().detail, "Z0 of the beginning is no whole unit");
}

// The last stage and the first come again, too.
TEST(TileBounds, StagesOfTheSpindle) {
  const auto made = [](const std::string& stage) {
    return Tiled("!RC" + stage + ";!PZ0,200;\nPU100,100;PD300,100;!RC7;PD300,200;PU0,0;", kTwo,
                 "t1s");
  };
  EXPECT_NE(made("0").find("PU;\n!RC0;\nPU400,100;"), std::string::npos);
  EXPECT_NE(made("15").find("PU;\n!RC15;\nPU400,100;"), std::string::npos);
}

// One copy is the stream itself.
TEST(TileBounds, OneCopyIsTheStream) { EXPECT_EQ(Tiled(kBox, {}), kBox); }

// A gap is never less than asked for, in whole units; 0.1 + 0.2 is 0.3 all the same. Widths of
// parts of a unit are whole ones, too.
TEST(TileBounds, PitchesAreWholeUnits) {
  const auto pitch = [](const std::string& part, double gap) {
    return TileStream(part, ParametersOf("t1"), {.columns = 2, .gap_mm = gap})->pitch_x_mm;
  };
  EXPECT_EQ(pitch(kBox, 0.0), 2.0);
  EXPECT_EQ(pitch(kBox, 0.3), 2.3);
  EXPECT_EQ(pitch(kBox, 0.1 + 0.2), 2.3);
  EXPECT_EQ(pitch(kBox, 0.300005), 2.31);
  EXPECT_EQ(pitch("!PZ0,200;\nPU100,100;PD300.5,100,300.5,200;PU0,0;", 0.0), 2.01);
}

// What a field is short of by less than rounding it has; by more it has not. 2 mm for one copy, 3
// mm more for each.
TEST(TileBounds, AFieldThatIsALittleSmall) {
  const auto columns = [](double width_mm) {
    const auto made =
        TileStream(kBox, ParametersOf("t1"), {.within_mm = {{width_mm, 1.0}}, .gap_mm = 1.0});
    return made ? made->columns : 0;
  };
  EXPECT_EQ(columns(2.0), 1);
  EXPECT_EQ(columns(1.99999999), 1);
  EXPECT_EQ(columns(1.999995), 0);
  EXPECT_EQ(columns(5.0), 2);
  EXPECT_EQ(columns(4.9999), 1);
}

// Where the operator says so, copies may stand beyond the travel: 1 + (900 - 2) / 3 = 300.
TEST(TileBounds, BeyondTheTravel) {
  const auto field = TileStream(kBox, ParametersOf("t1"),
                                {.within_mm = {{900.0, 1.0}}, .gap_mm = 1.0, .force = true});
  ASSERT_TRUE(field);
  EXPECT_EQ(field->columns, 300);
  EXPECT_EQ(field->rows, 1);
  EXPECT_FALSE(field->travel_is_less);
  EXPECT_TRUE(TileStream(kBox, ParametersOf("t1"), {.columns = 67, .force = true}));
  EXPECT_EQ(Tiled(kBox, {.columns = 67, .gap_mm = 1.0}),
            "refused: at most 66 columns and 75 rows fit, 3 mm and 2 mm from copy to copy");
  // The travel is less in Y alone: 1 + (149 - 1) / 2 = 75 rows from Y 1 on.
  const auto high =
      TileStream(kBox, ParametersOf("t1"), {.within_mm = {{2.0, 300.0}}, .gap_mm = 1.0});
  ASSERT_TRUE(high);
  EXPECT_EQ(high->columns, 1);
  EXPECT_EQ(high->rows, 75);
  EXPECT_TRUE(high->travel_is_less);
  // A field of just that many has them all.
  const auto as_many =
      TileStream(kBox, ParametersOf("t1"), {.within_mm = {{197.0, 149.0}}, .gap_mm = 1.0});
  ASSERT_TRUE(as_many);
  EXPECT_EQ(as_many->columns, 66);
  EXPECT_EQ(as_many->rows, 75);
  EXPECT_FALSE(as_many->travel_is_less);
}

// A hole has no width: without a gap any number of copies stands in its place, as many as there may
// be at all.
TEST(TileBounds, NumbersOfCopies) {
  const std::string hole = "!PZ-50,200;\nPU100,100;PD;PU;PU0,0;";
  const auto made = TileStream(hole, ParametersOf("t1"), {.columns = 1000, .gap_mm = 0.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->columns, 1000);
  const std::string at_the_edge = "!PZ-50,200;\nPU20000,100;PD;PU;PU0,0;";
  EXPECT_TRUE(TileStream(at_the_edge, ParametersOf("t1"), {.columns = 1000, .gap_mm = 0.0}));
  EXPECT_TRUE(Tiled(hole, {.columns = 1001}).starts_with("refused: 1001 copies; from 1 to 1000"));
  EXPECT_TRUE(Tiled(hole, {.rows = 0}).starts_with("refused: 0 copies; from 1 to 1000"));
  EXPECT_TRUE(Tiled(hole, {.gap_mm = INFINITY}).starts_with("refused: the gap is "));
  EXPECT_TRUE(Tiled(hole, {.within_mm = {{1.0, INFINITY}}}).starts_with("refused: the field is "));
  EXPECT_TRUE(Tiled(hole, {.within_mm = {{1.0, 0.0}}}).starts_with("refused: the field is 0 mm"));
}

// As many bytes as the first copies have may be made, and not one more: the end of the stream, from
// the semicolon behind the last cut on, and the lift before it are not of the copies.
TEST(TileBounds, BytesOfTheCopies) {
  const std::size_t behind = std::string(";\nPU;\n").size() + std::string(";PU0,0;").size();
  const std::size_t copies = Tiled(kBox, kTwo).size() - behind;
  TileOptions options = kTwo;
  options.bytes_max = copies;
  EXPECT_EQ(Tiled(kBox, options), Tiled(kBox, kTwo));
  options.bytes_max = copies - 1;
  EXPECT_TRUE(Tiled(kBox, options).starts_with("refused: more than "));
}

// A copy that is larger than the field does not fit; of a program that the travel cuts off nobody
// knows how large it is. 12.3457 units are 0.123 mm.
TEST(TileBounds, WhatDoesNotFitAtAll) {
  const auto large = TileStream(kBox, ParametersOf("t1"), {.within_mm = {{1.99, 5.0}}});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kRml1DoesNotFit);
  const auto beyond =
      TileStream("PU1000,100;PD20012.3456,100;PU;", ParametersOf("t1"), {.columns = 2});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, ErrorCode::kRml1WorkBeyondTravel);
  EXPECT_EQ(beyond.error().detail,
            "of the program alone 0.123 mm would not be cut: how large a copy is cannot be told");
}

// 120 by 80 mm on a travel of 200 by 150 mm: there is room for the first copy alone, which is told,
// and a field of any size has no more.
TEST(TileBounds, RoomForTheFirstCopyAlone) {
  const std::string large = "!PZ0,200;\nPU1000,1000;PD13000,1000,13000,9000;PU0,0;";
  const std::string most =
      "refused: at most 1 columns and 1 rows fit, 121 mm and 81 mm from copy to copy";
  EXPECT_EQ(Tiled(large, {.columns = 2, .gap_mm = 1.0}), most);
  EXPECT_EQ(Tiled(large, {.rows = 2, .gap_mm = 1.0}), most);
  const auto field =
      TileStream(large, ParametersOf("t1"), {.within_mm = {{400.0, 300.0}}, .gap_mm = 1.0});
  ASSERT_TRUE(field) << field.error().detail;
  EXPECT_EQ(field->columns, 1);
  EXPECT_EQ(field->rows, 1);
  EXPECT_TRUE(field->travel_is_less);
  EXPECT_EQ(field->stream, large);
}

}  // namespace
}  // namespace rmlcell::rml1
