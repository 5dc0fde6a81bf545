// Numbers that a refusal tells: as a person reads them, and with their unit for a program.
#include <gtest/gtest.h>

#include <tuple>

#include "proto/bridge/inputs.h"
#include "proto/bridge/milling.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/milling.pb.h"

namespace rmlcell::bridge {
namespace {

// "the text | name=number unit | name=word"
std::string InFull(const Detail& detail) {
  std::string all = detail;
  for (const Argument& argument : detail.arguments()) {
    all += " | " + argument.name + "=";
    if (const double* const number = std::get_if<double>(&argument.value)) {
      all += std::to_string(*number).substr(0, std::to_string(*number).find('.') + 3);
      all += " " + argument.unit;
    } else {
      all += std::get<std::string>(argument.value);
    }
  }
  return all;
}

v1::Milling FlatBlock() {
  v1::Milling milling;
  EXPECT_TRUE(SetBlockAndTool("100x80x10@-5,-6,2", "flat:3", milling));
  return milling;
}

template <class Change>
std::string RefusedBlock(Change change) {
  v1::Milling milling = FlatBlock();
  change(milling);
  const auto made = FromProto(milling);
  return made ? "taken" : InFull(made.error().detail);
}

TEST(NamedNumbers, OfABlock) {
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.set_cell_mm(-0.25); }),
            "cell_mm is -0.25: above 0, or 0 for what fits the tool | value=-0.25 mm");
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.set_stl_tolerance_mm(1000.5); }),
            "stl_tolerance_mm is 1000.5, allowed are 0 to 1000 | name=stl_tolerance_mm | "
            "value=1000.50 mm");
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.set_rpm(0.5); }),
            "rpm is 0.5, allowed are 1 to 1,000,000, or 0 for what the program says | speed=0.50 "
            "rpm");
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.mutable_tool()->set_flutes(101); }),
            "tool.flutes is 101, allowed are 1 to 100, or 0 when it is not known | value=101.00 ");
  for (const int flutes : {0, 1, 100})
    EXPECT_EQ(RefusedBlock([&](v1::Milling& m) { m.mutable_tool()->set_flutes(flutes); }), "taken");
  // Only a tool with a tip has an angle, or a diameter there.
  const std::string vee = "tool: angle_rad and tip_diameter_mm are for SHAPE_VEE";
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.mutable_tool()->set_angle_rad(0.5); }), vee);
  EXPECT_EQ(RefusedBlock([](v1::Milling& m) { m.mutable_tool()->set_tip_diameter_mm(0.5); }), vee);
}

TEST(NamedNumbers, OfATarget) {
  v1::MillTarget target;
  target.set_slot(100);
  EXPECT_EQ(InFull(CheckTarget(target).error().detail),
            "target.slot is 100, allowed are 1 to 99 | program=100.00 ");
  target.set_slot(99);
  EXPECT_TRUE(CheckTarget(target));
  target.set_tolerance_mm(-0.5);
  EXPECT_EQ(InFull(CheckTarget(target).error().detail),
            "target.tolerance_mm is -0.5, allowed are 0 to 1000 | name=target.tolerance_mm | "
            "value=-0.50 mm");
}

TEST(NamedNumbers, OfInputs) {
  EXPECT_EQ(InFull(CheckOverride(145.5, 145.0).error().detail),
            "the value is 145.5; allowed are above 0 to 145 % | override=145.50 % | most=145.00 %");
  v1::SimulationOptions options;
  const auto said = [&](const std::string& line) {
    const Status read = ParseInputFile("\n" + line, "in.txt", 145.0, options);
    return read ? "taken" : InFull(read.error().detail);
  };
  EXPECT_EQ(said("1 IL[1] = 2.5"),
            "in.txt:2: the value is 2.5; allowed are 0 and 1 | file=in.txt | line=2.00  | "
            "value=2.50 ");
  EXPECT_EQ(said("1 OVERRIDE = 146"),
            "in.txt:2: the value is 146; allowed are above 0 to 145 % | file=in.txt | line=2.00  | "
            "override=146.00 % | most=145.00 %");
  EXPECT_EQ(
      said("1 GO"),
      "in.txt:2: 'GO' is none of IL[n], IA[n], DOOR, START, HOLD, STOP, EMERGENCY, OVERRIDE | "
      "file=in.txt | line=2.00  | word=GO");
}

// A line and a column, of the line that is wrong.
TEST(NamedNumbers, WhereAnInputIsWrong) {
  const std::tuple<std::string, int, int> rows[] = {{"\n\n\nSTART", 4, 1},
                                                    {"\n12.5 START = 1", 2, 6},
                                                    {"0 HOLD\n\n\n\n 1 IL[1] = 2", 5, 4},
                                                    {"  1 \t DOOR = 2 # no", 1, 7},
                                                    {"\t START", 1, 3},
                                                    {"1 IL[1] =", 1, 10},
                                                    {"\n\n1 IL[1] = maybe", 3, 11}};
  for (const auto& [text, line, column] : rows) {
    v1::SimulationOptions options;
    const Status read = ParseInputFile(text, "in.txt", 145.0, options);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().where->line, line) << text;
    EXPECT_EQ(read.error().where->column, column) << text;
  }
}

// A level has cells of twice the size of the one before, and as many as it takes for the block.
TEST(HeightGridMessage, EachFieldIsOfItsLevel) {
  simulation::HeightGridHead head{};
  head.size = {.columns = 100, .rows = 41};
  head.left = -5.0;
  head.front = 6.5;
  head.cell = 0.25;
  head.bottom = -8.0;
  head.top = 2.0;
  const auto of_level = [&](int level) { return ToProto(head, level).ShortDebugString(); };
  EXPECT_EQ(
      of_level(0),
      "columns: 100 rows: 41 left_mm: -5 front_mm: 6.5 cell_mm: 0.25 bottom_mm: -8 top_mm: 2");
  EXPECT_EQ(of_level(3),
            "level: 3 columns: 13 rows: 6 left_mm: -5 front_mm: 6.5 cell_mm: 2 bottom_mm: -8 "
            "top_mm: 2");
  const v1::HeightTile tile = ToProto(
      simulation::HeightTile{.column = 1, .row = 2, .columns = 3, .rows = 4, .heights = "h"});
  EXPECT_EQ(tile.ShortDebugString(), "column: 1 row: 2 columns: 3 rows: 4 heights: \"h\"");
}

}  // namespace
}  // namespace rmlcell::bridge
