// Block and tool of proto/rmlcell/v1/milling.proto, and as they are written on the command line
// (docs/material.md).
#include "proto/bridge/milling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "rmlcell/v1/milling.pb.h"

namespace rmlcell::bridge {
namespace {

using simulation::MillTool;
using testing::StartsWith;

constexpr double kPi = 3.14159265358979323846;

v1::Milling Sound() {
  v1::Milling milling;
  v1::Stock& stock = *milling.mutable_stock();
  stock.set_size_x_mm(100.0);
  stock.set_size_y_mm(80.0);
  stock.set_size_z_mm(10.0);
  stock.set_left_mm(-5.0);
  stock.set_front_mm(-6.0);
  stock.set_top_mm(2.0);
  v1::MillTool& tool = *milling.mutable_tool();
  tool.set_shape(v1::MillTool::SHAPE_VEE);
  tool.set_diameter_mm(6.0);
  tool.set_angle_rad(kPi / 3.0);
  tool.set_tip_diameter_mm(0.2);
  tool.set_flute_mm(12.0);
  tool.set_shank_diameter_mm(8.0);
  tool.set_holder_diameter_mm(20.0);
  tool.set_holder_from_mm(25.0);
  tool.set_flutes(2);
  return milling;
}

// Diameters are halved, sizes are counted from the least corner, the top and downwards.
TEST(MillingOfAJob, EachFieldHasItsPlace) {
  v1::Milling given = Sound();
  const auto made = FromProto(given);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->stock, (simulation::Stock{.x_min = -5.0,
                                            .x_max = 95.0,
                                            .y_min = -6.0,
                                            .y_max = 74.0,
                                            .bottom = -8.0,
                                            .top = 2.0,
                                            .cell = 0.05}));  // a quarter of the tip
  const MillTool& tool = made->tool;
  EXPECT_EQ(tool.shape, MillTool::Shape::kVee);
  EXPECT_EQ(tool.radius_mm, 3.0);
  EXPECT_NEAR(tool.half_angle_rad, kPi / 6.0, 1e-15);
  EXPECT_EQ(tool.tip_radius_mm, 0.1);
  EXPECT_EQ(tool.flute_mm, 12.0);
  EXPECT_EQ(tool.shank_radius_mm, 4.0);
  EXPECT_EQ(tool.holder_radius_mm, 10.0);
  EXPECT_EQ(tool.holder_from_mm, 25.0);
  EXPECT_EQ(tool.flutes, 2);
  EXPECT_FALSE(made->chips);  // no material is told
  EXPECT_EQ(made->rpm, 0.0);
  given.set_cell_mm(0.25);
  EXPECT_EQ(FromProto(given)->stock.cell, 0.25);
}

TEST(MillingOfAJob, AToolHasTheShapeThatItIsSaidToHave) {
  for (const auto& [said, made] : {std::pair(v1::MillTool::SHAPE_FLAT, MillTool::Shape::kFlat),
                                   std::pair(v1::MillTool::SHAPE_BALL, MillTool::Shape::kBall)}) {
    v1::Milling given = Sound();
    given.mutable_tool()->set_shape(said);
    given.mutable_tool()->clear_angle_rad();
    given.mutable_tool()->clear_tip_diameter_mm();
    const auto milling = FromProto(given);
    ASSERT_TRUE(milling) << milling.error().detail;
    EXPECT_EQ(milling->tool.shape, made);
  }
}

// chip_loads.toml: wax at 6 mm.
TEST(MillingOfAJob, AMaterialHasItsChipsAtTheDiameterOfTheTool) {
  v1::Milling given = Sound();
  given.set_material("wax");
  given.set_rpm(7000.0);
  const auto made = FromProto(given);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->chips, (simulation::ChipRange{0.03, 0.35, 400.0, 0.175}));
  EXPECT_EQ(made->rpm, 7000.0);
}

TEST(MillingOfAJob, RefusesWhatCannotBeByItsField) {
  const auto said = [](const std::function<void(v1::Milling&)>& change) -> std::string {
    v1::Milling milling = Sound();
    change(milling);
    const auto made = FromProto(milling);
    if (made) return std::string("sound");
    EXPECT_EQ(made.error().code, ErrorCode::kCellInvalidArgument);
    return made.error().detail;
  };
  const double infinite = std::numeric_limits<double>::infinity();
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(said([](v1::Milling&) {}), "sound");
  EXPECT_THAT(said([](v1::Milling& m) { m.clear_stock(); }), StartsWith("stock is missing"));
  EXPECT_THAT(said([](v1::Milling& m) { m.clear_tool(); }), StartsWith("tool is missing"));
  for (const double size_mm : {0.0, -1.0, none}) {
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_stock()->set_size_x_mm(size_mm); }),
                StartsWith("stock: size_x_mm"));
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_stock()->set_size_y_mm(size_mm); }),
                StartsWith("stock: size_x_mm"));
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_stock()->set_size_z_mm(size_mm); }),
                StartsWith("stock: size_x_mm"));
  }
  for (const double place_mm : {infinite, none}) {
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_stock()->set_left_mm(place_mm); }),
                StartsWith("stock: "));
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_stock()->set_top_mm(place_mm); }),
                StartsWith("stock: "));
  }
  for (const double cell_mm : {-0.1, none})
    EXPECT_THAT(said([&](v1::Milling& m) { m.set_cell_mm(cell_mm); }), StartsWith("cell_mm is "));
  for (const int shape : {0, 99}) {
    EXPECT_THAT(said([&](v1::Milling& m) {
                  m.mutable_tool()->set_shape(static_cast<v1::MillTool::Shape>(shape));
                }),
                StartsWith("tool.shape is missing"));
  }
  EXPECT_THAT(said([](v1::Milling& m) { m.mutable_tool()->set_shape(v1::MillTool::SHAPE_BALL); }),
              StartsWith("tool: angle_rad and tip_diameter_mm are for SHAPE_VEE"));
  EXPECT_THAT(said([](v1::Milling& m) { m.mutable_tool()->set_angle_rad(kPi); }),
              StartsWith("tool: half the angle"));
  EXPECT_THAT(said([](v1::Milling& m) { m.mutable_tool()->set_holder_from_mm(11.0); }),
              StartsWith("tool: the holder begins below"));
  EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_tool()->set_diameter_mm(infinite); }),
              StartsWith("tool: the radius"));
  for (const double tolerance_mm : {-0.1, 1000.1, none}) {
    EXPECT_THAT(said([&](v1::Milling& m) { m.set_stl_tolerance_mm(tolerance_mm); }),
                StartsWith("stl_tolerance_mm is "));
  }
  for (const int flutes : {-1, 101}) {
    EXPECT_THAT(said([&](v1::Milling& m) { m.mutable_tool()->set_flutes(flutes); }),
                StartsWith("tool.flutes is "));
  }
  EXPECT_EQ(said([&](v1::Milling& m) { m.mutable_tool()->set_flutes(100); }), "sound");
  EXPECT_THAT(said([](v1::Milling& m) { m.set_material("cheese"); }),
              testing::AllOf(StartsWith("material: "), testing::HasSubstr("wax")));
  EXPECT_THAT(said([](v1::Milling& m) {
                m.set_material("wax");
                m.mutable_tool()->clear_flutes();
              }),
              testing::AllOf(StartsWith("tool.flutes is missing"), testing::HasSubstr("flutes=2")));
  for (const double rpm : {-1.0, 0.9, 1'000'001.0, none})
    EXPECT_THAT(said([&](v1::Milling& m) { m.set_rpm(rpm); }), StartsWith("rpm is "));
  for (const double rpm : {1.0, 1'000'000.0})
    EXPECT_EQ(said([&](v1::Milling& m) { m.set_rpm(rpm); }), "sound");
  // 1000 by 800 cells of 0.1 mm; of 0.01 mm they are 80 million, more than 67,108,864.
  EXPECT_THAT(said([](v1::Milling& m) { m.set_cell_mm(0.01); }),
              testing::AllOf(StartsWith("stock: "), testing::HasSubstr("make the cells larger")));
}

// Milling.stl_tolerance_mm: absent is 0.01, and 0 is 0.
TEST(MillingOfAJob, AnStlHasATolerance) {
  v1::Milling milling = Sound();
  EXPECT_EQ(StlToleranceOf(milling), 0.01);
  milling.set_stl_tolerance_mm(0.0);
  EXPECT_EQ(StlToleranceOf(milling), 0.0);
  EXPECT_TRUE(FromProto(milling));
  milling.set_stl_tolerance_mm(1000.0);
  EXPECT_EQ(StlToleranceOf(milling), 1000.0);
  EXPECT_TRUE(FromProto(milling));
}

// The example of docs/material.md and the tool of this file, word for word.
TEST(MillingOfAJob, FromTheCommandLine) {
  v1::Milling milling;
  ASSERT_TRUE(SetBlockAndTool("100x80x10@-5,-6,2",
                              "vee:6:60:0.2:flutes=2:flute=12:shank=8:holder=20@25", milling));
  EXPECT_NEAR(milling.tool().angle_rad(), kPi / 3.0, 1e-12);
  milling.mutable_tool()->set_angle_rad(Sound().tool().angle_rad());
  EXPECT_EQ(milling.SerializeAsString(), Sound().SerializeAsString());
  for (const auto& [word, shape] : {std::pair("flat:3", v1::MillTool::SHAPE_FLAT),
                                    std::pair("ball:3", v1::MillTool::SHAPE_BALL)}) {
    ASSERT_TRUE(SetBlockAndTool("10x10x1", word, milling));
    EXPECT_EQ(milling.tool().shape(), shape);
    EXPECT_EQ(milling.tool().diameter_mm(), 3.0);
    EXPECT_EQ(milling.tool().angle_rad(), 0.0);
    EXPECT_TRUE(FromProto(milling));
  }
  EXPECT_FALSE(SetBlockAndTool("10x10", "flat:3", milling));
  EXPECT_FALSE(SetBlockAndTool("10x10x1", "drill:3", milling));
}

constexpr const char* kPng = "\x89PNG\r\n\x1a\n...";
constexpr const char* kStl = "solid\nendsolid\n";

// A target may be three things; each has what it needs, and says what it is.
TEST(TargetOfAJob, RefusesWhatCannotBeByItsField) {
  const auto said = [](const std::function<void(v1::MillTarget&)>& change) {
    v1::MillTarget target;
    change(target);
    const Status sound = CheckTarget(target);
    return sound ? std::string("sound") : CodeText(sound.error().code) + " " + sound.error().detail;
  };
  const auto file = [&](const std::string& name, const std::string& type,
                        const std::string& content) {
    return said([&](v1::MillTarget& target) {
      target.mutable_file()->set_file_name(name);
      target.mutable_file()->set_media_type(type);
      target.mutable_file()->set_content(content);
    });
  };
  EXPECT_THAT(said([](v1::MillTarget&) {}), StartsWith("CELL-E9003 target is missing"));
  for (const char* type : {"", "image/png"}) EXPECT_EQ(file("a.png", type, kPng), "sound");
  for (const char* type : {"", "model/stl"}) EXPECT_EQ(file("a.stl", type, kStl), "sound");
  EXPECT_EQ(file("", "", kStl), "sound");
  EXPECT_EQ(file("a.stl", "", kPng), "sound");  // as with the command: the bytes tell
  EXPECT_THAT(file("a.stl", "", ""), StartsWith("CELL-E9003 target.file.content is empty"));
  EXPECT_THAT(file("a", "text/plain", kStl), StartsWith("CELL-E9003 target.file.media_type"));
  EXPECT_THAT(file("a.png", "", kStl), StartsWith("CELL-E9024 target.file: no height map"));
  EXPECT_THAT(file("a", "image/png", kStl), StartsWith("CELL-E9024 target.file: no height map"));
  EXPECT_THAT(file("a.stl", "", "PA;"), StartsWith("CELL-E9024 target.file: no STL"));
  EXPECT_THAT(file("a", "model/stl", kPng), StartsWith("CELL-E9024 target.file: no STL"));
  EXPECT_EQ(said([](v1::MillTarget& t) { t.mutable_inline_program()->set_content("PA;"); }),
            "sound");
  EXPECT_EQ(said([](v1::MillTarget& t) { t.mutable_inline_program(); }),
            "CELL-E9017 target.inline_program");
  for (const int slot : {1, 99})
    EXPECT_EQ(said([&](v1::MillTarget& t) { t.set_slot(slot); }), "sound");
  for (const int slot : {-1, 0, 100, 145}) {
    EXPECT_THAT(said([&](v1::MillTarget& t) { t.set_slot(slot); }),
                StartsWith("CELL-E9003 target.slot is "));
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const double tolerance_mm : {-0.1, 1000.1, none}) {
    EXPECT_THAT(said([&](v1::MillTarget& t) {
                  t.set_slot(1);
                  t.set_tolerance_mm(tolerance_mm);
                }),
                StartsWith("CELL-E9003 target.tolerance_mm is "));
  }
}

// MillTarget.tolerance_mm: absent is 0.1, and 0 is 0.
TEST(TargetOfAJob, HasATolerance) {
  v1::MillTarget target;
  EXPECT_EQ(TargetToleranceOf(target), 0.1);
  target.set_tolerance_mm(0.0);
  EXPECT_EQ(TargetToleranceOf(target), 0.0);
}

// docs/material.md, "Beside what should be left": a PNG, .stl, any other.
TEST(TargetOfAJob, AFileOfTheCommandLineIsWhatItIsThere) {
  v1::MillTarget target;
  SetTargetFile("a.rml", kPng, target);
  EXPECT_EQ(target.file().content(), kPng);
  EXPECT_EQ(TargetMediaType(target), "image/png");
  SetTargetFile("A.STL", kStl, target);
  EXPECT_EQ(target.file().file_name(), "A.STL");
  EXPECT_EQ(TargetMediaType(target), "model/stl");
  SetTargetFile("a.rml", "PA;", target);
  ASSERT_TRUE(target.has_inline_program());
  EXPECT_EQ(target.inline_program().file_name(), "a.rml");
  EXPECT_EQ(target.inline_program().content(), "PA;");
}

}  // namespace
}  // namespace rmlcell::bridge
