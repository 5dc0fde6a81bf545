// What a block is compared with and what its material takes: the options of
// `rmlcell simulate` as the engine gets them (docs/material.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/cli/milling.h"
#include "engine/families/families.h"
#include "engine/simulation/material/parallel_for.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class BlockTargets : public testing::Test {
 protected:
  BlockTargets() {
    options_.block.stock = "10x10x5";
    options_.block.tool = "flat:2.5:flutes=2";
    options_.block.cell_mm = 1.0;
    shape_.has_work_origin = true;
  }
  Result<simulation::Milling> Made() const { return MillingOf(options_, shape_, mill_); }
  // Of what is refused.
  Error Refusal() const {
    const auto made = Made();
    EXPECT_FALSE(made);
    return made ? Error{} : made.error();
  }

  CliFolder folder_;
  MillingOptions options_;
  machine::MachineShape shape_;
  simulation::ProgramMemory mill_{.family = families::FindFamily("rml1"), .profile = "t1"};
};

// Wax, tools of 3 mm: 0.015 to 0.2 mm an edge and turn, half of that straight
// down.
TEST_F(BlockTargets, ChipsAreThoseOfTheDiameter) {
  options_.block.tool = "flat:3:flutes=2";
  options_.block.material = "wax";
  options_.block.rpm = 4500.0;
  const auto made = Made();
  ASSERT_TRUE(made);
  EXPECT_EQ(
      made->chips,
      (simulation::ChipRange{
          .least_mm = 0.015, .most_mm = 0.2, .speed_most_m_min = 400.0, .plunge_most_mm = 0.1}));
  EXPECT_EQ(made->rpm, 4500.0);
  options_.block.material.clear();
  EXPECT_FALSE(Made()->chips);
  options_.block.material = "butter";
  EXPECT_EQ(Refusal().code, ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(Refusal().detail, HasSubstr("wax"));
  options_.block.material = "wax";
  options_.block.tool = "flat:3";
  EXPECT_THAT(Refusal().detail, HasSubstr("needs the edges of the tool"));
}

// The program runs in its own slot on the same mill, which stands as if nothing
// had run there.
TEST_F(BlockTargets, AnotherProgramIsTheTarget) {
  options_.block.target = folder_.Put("7.rml", "!PZ-100,200;PU550,550;PD550,550;PU0,0;");
  mill_.programs = {{.slot = 7,
                     .file_name = "7.rml",
                     .bytes = machine::Bytes::Of("!PZ-300,200;PU150,150;PD150,150;PU0,0;"),
                     .is_source = true}};
  mill_.machine_state = "what a run has kept, and nobody can read";
  const auto made = Made();
  ASSERT_TRUE(made) << made.error().detail;
  ASSERT_TRUE(made->target);
  EXPECT_EQ(made->target->tolerance_mm, 0.1);
  const std::vector<float>& heights = *made->target->heights;
  ASSERT_EQ(heights.size(), 100U);
  // A plunge to -1 at (5.5, 5.5): its cell, and the four whose centres are 1 mm
  // away.
  for (std::size_t k = 0; k < 100; ++k) {
    const bool cut = k == 55 || k == 54 || k == 56 || k == 45 || k == 65;
    EXPECT_EQ(heights[k], cut ? -1.0f : 0.0f) << k;
  }
  options_.block.target_tolerance_mm = 0.25;
  EXPECT_EQ(Made()->target->tolerance_mm, 0.25);
}

// A picture of heights, whatever it is called; a body by its name.
TEST_F(BlockTargets, HeightsAndBodiesAreReadAsTheyAre) {
  const auto field = simulation::HeightField::Of(
      {.x_min = 0, .x_max = 10, .y_min = 0, .y_max = 10, .bottom = -5, .top = 0, .cell = 1});
  ASSERT_TRUE(field);
  simulation::SerialFor alone;
  const std::string map = folder_.File("map.rml");
  const std::string body = folder_.File("body.stl");
  MillingOptions files;
  files.stl = body;
  files.height_map = map;
  ASSERT_TRUE(WriteMaterial(*field, {}, files, alone));
  for (const std::string& file : {map, body}) {
    options_.block.target = file;
    const auto made = Made();
    ASSERT_TRUE(made) << file << ": " << made.error().detail;
    ASSERT_EQ(made->target->heights->size(), 100U) << file;
    for (const float height : *made->target->heights) EXPECT_NEAR(height, 0.0F, 1e-3F) << file;
  }
}

// Each names the file that it is about, but one that cannot be read names
// itself.
TEST_F(BlockTargets, ATargetThatIsNoneIsRefused) {
  const auto refused = [&](const std::string& file) {
    options_.block.target = file;
    return Refusal();
  };
  const std::string none = folder_.File("none.rml");
  EXPECT_EQ(refused(none).code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(refused(none).detail, none);
  const std::string empty = folder_.Put("empty.rml", "");
  EXPECT_EQ(refused(empty).code, ErrorCode::kCellEmptyProgram);
  EXPECT_EQ(refused(empty).detail, "--target " + empty + ": " + empty);
  const std::string wrong = folder_.Put("wrong.rml", "\xff\xfe\xff\xfe\xff\xfe\xff\xfe");
  EXPECT_EQ(refused(wrong).code, ErrorCode::kCellBadText);
  EXPECT_EQ(refused(wrong).detail,
            "--target " + wrong + ": the program has errors: rmlcell check lists them");
  const std::string body = folder_.Put("body.STL", "solid none\nendsolid none\n");
  EXPECT_THAT(refused(body).detail, StartsWith("--target " + body + ": "));
  options_.block.target_tolerance_mm = -0.5;
  const std::string good = folder_.Put("good.rml", "!PZ-100,200;PU550,550;PD550,550;PU0,0;");
  EXPECT_EQ(refused(good).code, ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(refused(good).detail, HasSubstr("tolerance of a target"));
}

}  // namespace
}  // namespace rmlcell::cli
