#include "clients/cli/milling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/material/parallel_for.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;

machine::MachineShape Mill() {
  machine::MachineShape shape;
  shape.has_work_origin = true;
  return shape;
}

simulation::ProgramMemory ThisMill() {
  return {.family = families::FindFamily("rml1"), .profile = "t1"};
}

MillingOptions Block(const std::string& stock, const std::string& tool, double cell_mm = 0.1) {
  MillingOptions options;
  options.block.stock = stock;
  options.block.tool = tool;
  options.block.cell_mm = cell_mm;
  return options;
}

void ExpectInvalid(const MillingOptions& options, const machine::MachineShape& shape,
                   const std::string& detail) {
  const auto milling = MillingOf(options, shape, ThisMill());
  ASSERT_FALSE(milling) << detail;
  EXPECT_EQ(milling.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(milling.error().detail, HasSubstr(detail));
}

TEST(MillingOf, BlockAndToolAreAsWrittenWithTheCellsAskedFor) {
  const auto milling = MillingOf(Block("100x80x10@-5,-6,2", "ball:3", 0.25), Mill(), ThisMill());
  ASSERT_TRUE(milling);
  EXPECT_EQ(milling->stock, (simulation::Stock{.x_min = -5,
                                               .x_max = 95,
                                               .y_min = -6,
                                               .y_max = 74,
                                               .bottom = -8,
                                               .top = 2,
                                               .cell = 0.25}));
  EXPECT_EQ(milling->tool.shape, simulation::MillTool::Shape::kBall);
  EXPECT_EQ(milling->tool.radius_mm, 1.5);
}

TEST(MillingOf, ALaserTakesNothingOffABlock) {
  ExpectInvalid(Block("100x80x10", "flat:3"), {}, "--stock is for mills");
}

TEST(MillingOf, ABlockOrAToolThatCannotBeIsRefused) {
  ExpectInvalid(Block("100x80", "flat:3"), Mill(), "'100x80' is no block");
  ExpectInvalid(Block("0x80x10", "flat:3"), Mill(), "ends before it begins");
  ExpectInvalid(Block("100x80x10", ""), Mill(), "'' is no tool");
  ExpectInvalid(Block("100x80x10", "flat:0"), Mill(), "above 0 mm");
  ExpectInvalid(Block("100x80x10", "flat:3", 0.0), Mill(), "have no size");
  ExpectInvalid(Block("100x80x10", "flat:3", -1.0), Mill(), "have no size");
  ExpectInvalid(Block("100x80x10", "flat:3", 1e-6), Mill(), "make the cells larger");
}

TEST(WriteMaterial, AFileThatCannotBeWrittenIsAnError) {
  const CliFolder folder;
  const auto material = simulation::HeightField::Of(
      {.x_min = 0, .x_max = 2, .y_min = 0, .y_max = 2, .bottom = -1, .top = 0, .cell = 1});
  ASSERT_TRUE(material);
  simulation::SerialFor alone;
  for (const std::string& path : {folder.File("none/a.stl"), std::string("/dev/full")}) {
    const Status written = WriteMaterial(*material, {}, {.stl = path}, alone);
    ASSERT_FALSE(written) << path;
    EXPECT_EQ(written.error().code, ErrorCode::kCellFileUnwritable);
    EXPECT_THAT(written.error().detail, HasSubstr(path));
  }
  EXPECT_TRUE(WriteMaterial(*material, {}, {.stl = folder.File("a.stl")}, alone));
  // A binary STL: 80 bytes of heading, the number of triangles, 50 bytes for each.
  const std::string bytes = folder.Read("a.stl");
  ASSERT_GT(bytes.size(), 84U);
  const auto byte = [&](std::size_t i) {
    return std::size_t{static_cast<unsigned char>(bytes[i])};
  };
  const std::size_t triangles = byte(80) | byte(81) << 8 | byte(82) << 16 | byte(83) << 24;
  EXPECT_EQ(bytes.size(), 84 + 50 * triangles);
  EXPECT_EQ(triangles, 12U);  // untouched, it is a box
}

template <typename Options>
bool Takes(void (*add)(CLI::App&, Options&), const std::string& line) {
  CLI::App app;
  std::string file;
  app.add_option("FILE", file);
  Options options;
  add(app, options);
  std::istringstream text(line);
  std::vector<std::string> words;
  for (std::string word; text >> word;) words.insert(words.begin(), word);
  try {
    app.parse(words);
  } catch (const CLI::ParseError&) {
    return false;
  }
  return true;
}

TEST(MillingOptions, NumbersReachTheEndsOfTheirRanges) {
  const std::string block = "--stock 1x1x1 --tool flat:3 ";
  for (const char* good : {"--rpm 1", "--rpm 1000000", "--target t --target-tolerance 0",
                           "--target t --target-tolerance 1000", "--stl s --stl-tolerance 0",
                           "--stl s --stl-tolerance 1000"})
    EXPECT_TRUE(Takes(AddMillingOptions, block + good)) << good;
  for (const char* wrong : {"--rpm 0.5", "--rpm 1000001", "--target t --target-tolerance -0.5",
                            "--target t --target-tolerance 1000.5", "--stl s --stl-tolerance -0.5",
                            "--stl s --stl-tolerance 1000.5"})
    EXPECT_FALSE(Takes(AddMillingOptions, block + wrong)) << wrong;
  for (const char* good : {"--target-slot 1", "--target-slot 99",
                           "--stl-tolerance 0.5 --products relief,stl FILE", "--rpm 1"})
    EXPECT_TRUE(Takes(AddJobMillingOptions, block + good)) << good;
  for (const char* wrong : {"--target-slot 0", "--target-slot 100", "--products picture"})
    EXPECT_FALSE(Takes(AddJobMillingOptions, block + wrong)) << wrong;
}

// An option that means nothing by itself is refused rather than passed over.
TEST(MillingOptions, EachNeedsWhatItIsOf) {
  for (const char* wrong :
       {"--stock 1x1x1", "--tool flat:3", "--cell 0.5", "--material wax", "--rpm 5", "--target t",
        "--stl s", "--relief r", "--height-map h", "--stock 1x1x1 --tool flat:3 --stl-tolerance 1",
        "--stock 1x1x1 --tool flat:3 --target-tolerance 1",
        "--stock 1x1x1 --tool flat:3 --target-png p"})
    EXPECT_FALSE(Takes(AddMillingOptions, wrong)) << wrong;
  for (const char* wrong : {"--target-slot 1", "--target-tolerance 1", "--products stl",
                            "--stock 1x1x1 --tool flat:3 --stl-tolerance 1",
                            "--stock 1x1x1 --tool flat:3 --target t --target-slot 1"})
    EXPECT_FALSE(Takes(AddJobMillingOptions, wrong)) << wrong;
}

}  // namespace
}  // namespace rmlcell::cli
