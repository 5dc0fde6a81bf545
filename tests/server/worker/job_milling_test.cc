// A job with block and tool (milling.proto): what it leaves, what the verdict says of it, and that
// it stays within the budgets of the job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <new>
#include <set>
#include <utility>

#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/height_tiles.h"
#include "server/worker/material_files.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

// A groove of 20 mm along X at Y 15.1, 1 mm deep, with clearance on the way. 100 units a mm.
constexpr const char* kGroove = "VS10;!VZ10;!PZ-100,200;!MC1;PU2010,1510;PD4010,1510;PU0,0;!MC0;";
class JobMilling : public JobRunnerTest {
 protected:
  // With all that can be left of the block, or nothing.
  static v1::WorkerAssignment MillFor(const std::string& source, bool all) {
    v1::WorkerAssignment assignment = Mill(source);
    v1::Milling& milling = MillingOf(assignment);
    milling.set_relief(all);
    milling.set_height_map(all);
    milling.set_height_grid(all);
    milling.set_stl(all);
    return assignment;
  }
  std::vector<std::string> Reasons() {
    std::vector<std::string> codes;
    const v1::Outcome outcome = Outcome();
    for (const v1::VerdictReason& reason : outcome.reasons()) codes.push_back(reason.code());
    return codes;
  }
};

TEST_F(JobMilling, LeavesWhatIsAskedFor) {
  Work(MillFor(kGroove, true));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), ElementsAre("height.grid", "height.png", "left.stl", "picture.svg",
                                   "relief.png", "report", "toolpath"));
  auto artifacts = Artifacts();
  EXPECT_THAT(artifacts["relief.png"], StartsWith("\x89PNG\r\n\x1a\n"));
  const auto heights = simulation::ReadHeightMap(artifacts["height.png"]);
  ASSERT_TRUE(heights) << heights.error().detail;
  EXPECT_EQ(heights->columns, 300U);  // 60 mm in cells of 0.2 mm
  EXPECT_EQ(heights->rows, 150U);
  EXPECT_NEAR(heights->heights[75 * 300 + 150], -1.0, 1e-4);  // at X 30.1, Y 15.1
  EXPECT_NEAR(heights->heights[75 * 300 + 250], 0.0, 1e-4);   // at X 50.1: beyond the groove
  EXPECT_EQ(artifacts["height.grid"].size(), 64U + 2 * 300 * 150);
  EXPECT_THAT(artifacts["height.grid"], StartsWith("RMLCELLH"));
  // 80 bytes, the number of triangles, 50 bytes each.
  const std::string& stl = artifacts["left.stl"];
  ASSERT_GT(stl.size(), 84U);
  EXPECT_EQ((stl.size() - 84) % 50, 0U);
  for (const v1::WorkerArtifact& artifact : ArtifactMessages()) {
    if (artifact.name().ends_with(".png")) {
      EXPECT_EQ(artifact.media_type(), "image/png");
    }
    if (artifact.name() == "left.stl") {
      EXPECT_EQ(artifact.media_type(), "model/stl");
    }
  }
}

// Who looks on sees the tiles of the block as they change, and at the end what is left of it, as
// the product has it.
TEST_F(JobMilling, TheHeightsAreSentAsTheBlockIsMilled) {
  int grids = 0;
  int messages = 0;
  std::map<std::pair<int, int>, v1::HeightTile> seen;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!message.has_heights()) return;
    ++messages;
    if (message.heights().has_grid()) {
      ++grids;
      EXPECT_EQ(message.heights().grid().columns(), 300);
      EXPECT_EQ(message.heights().grid().rows(), 150);
      EXPECT_EQ(message.heights().grid().level(), 0);
    }
    for (const v1::HeightTile& tile : message.heights().tiles())
      seen[{tile.row(), tile.column()}] = tile;
  };
  // The groove, behind ways that take 8 s of the machine: more than a run catches up at once, so
  // that the first look at the block is over before it is touched.
  std::string ways = "VS10;!VZ10;!PZ-100,200;!MC1;";
  for (int i = 0; i < 6; ++i) ways += "PU4010,0;PU0,0;";
  v1::WorkerAssignment assignment = MillFor(ways + "PU2010,1510;PD4010,1510;PU0,0;!MC0;", true);
  assignment.mutable_job()->mutable_simulation()->set_pace(10.0);
  WorkBehind(assignment, {Order(v1::WorkerControl::KIND_FOLLOW_HEIGHTS)});
  EXPECT_EQ(grids, 1);
  EXPECT_GT(messages, 1);
  const std::string stored = Artifacts()["height.grid"];
  const auto head = simulation::ReadHeightGridHead(stored);
  ASSERT_TRUE(head);
  simulation::HeightGridTiles grid(*head, 0, std::nullopt);
  int told = 0;
  for (const simulation::HeightTile& tile :
       grid.Add(std::string_view(stored).substr(simulation::kHeightGridHeadBytes))) {
    const auto found = seen.find({static_cast<int>(tile.row), static_cast<int>(tile.column)});
    const bool touched = tile.heights.find_first_not_of('\xFF') != std::string::npos;
    ASSERT_EQ(found != seen.end(), touched) << tile.column << ' ' << tile.row;
    if (!touched) continue;
    EXPECT_EQ(found->second.heights(), tile.heights);
    ++told;
  }
  EXPECT_GT(told, 1);
}

// However much of the block is new at its end: who looks on has seen all of it when that is told.
TEST_F(JobMilling, AllOfTheBlockIsSeenAtItsEnd) {
  std::set<std::pair<int, int>> seen;
  server.heard = [&](const v1::WorkRequest& message) {
    for (const v1::HeightTile& tile : message.heights().tiles())
      seen.emplace(tile.row(), tile.column());
  };
  v1::WorkerAssignment assignment = Mill(
      "VS50;!VZ50;!PZ-100,200;!MC1;PU1010,510;PD5010,510;PD5010,2510;PD1010,2510;PD1010,510;"
      "PU0,0;!MC0;",
      0.06);
  MillingOf(assignment).set_height_grid(true);
  WorkBehind(assignment, {Order(v1::WorkerControl::KIND_FOLLOW_HEIGHTS)});
  const std::string stored = Artifacts()["height.grid"];
  const auto head = simulation::ReadHeightGridHead(stored);
  ASSERT_TRUE(head);
  simulation::HeightGridTiles grid(*head, 0, std::nullopt);
  std::set<std::pair<int, int>> touched;
  for (const simulation::HeightTile& tile :
       grid.Add(std::string_view(stored).substr(simulation::kHeightGridHeadBytes))) {
    if (tile.heights.find_first_not_of('\xFF') != std::string::npos)
      touched.emplace(static_cast<int>(tile.row), static_cast<int>(tile.column));
  }
  EXPECT_GT(touched.size(), 32U);
  EXPECT_EQ(seen, touched);
}

// 20 mm x 3 mm x 1 mm and two half discs of 1.5 mm, 67.07 mm3 together.
TEST_F(JobMilling, TheReportTellsWhatWasTakenOff) {
  Work(MillFor(kGroove, false));
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
  EXPECT_NEAR(Report().milling().removed_mm3(), 67.07, 0.7);
  EXPECT_NEAR(Report().milling().deepest_cut_mm(), 1.0, 1e-6);
  EXPECT_EQ(Report().milling().tool_diameter_mm(), 3.0);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_GOOD);
  v1::WorkerAssignment plain = MillFor(kGroove, true);
  plain.mutable_job()->mutable_simulation()->clear_milling();
  Work(plain);
  EXPECT_FALSE(Report().has_milling());
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
}

// docs/verdict.md: travel through the block, and what is cut below it. The tool travels at Z 2.
TEST_F(JobMilling, TheVerdictMindsTheBlock) {
  v1::WorkerAssignment high = MillFor(kGroove, true);
  MillingOf(high).mutable_stock()->set_top_mm(3.0);
  Work(high);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_BAD);
  EXPECT_THAT(Reasons(), testing::Contains("CELL-E9601"));
  EXPECT_GT(Report().milling().gouges(), 0);
  v1::WorkerAssignment thin = MillFor(kGroove, true);
  MillingOf(thin).mutable_stock()->set_size_z_mm(0.8);
  Work(thin);
  EXPECT_NEAR(Report().milling().below_mm(), 0.2, 1e-6);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_DOUBTFUL);  // more than 0.01 mm, not 1 mm
  EXPECT_THAT(Reasons(), ElementsAre("CELL-E9602"));
}

// 300 by 150 cells of 4 bytes are 180 kB; 6000 by 3000 are 72 MB, more than this job may hold.
TEST_F(JobMilling, ABlockCountsAsMemoryOfTheJob) {
  v1::WorkerAssignment assignment = MillFor(kGroove, false);
  assignment.mutable_budget()->set_memory_bytes(32 << 20);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  MillingOf(assignment).set_cell_mm(0.01);
  EXPECT_TRUE(Work(assignment));  // the worker goes on
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
  EXPECT_EQ(Outcome().code(), "CELL-E9302");
}

// The block itself fits, what is to be made of it does not: a relief of 1500 by 750 pixels is drawn
// row by row and kept as a file; the body of an exact ball nose has a triangle for each few cells.
TEST_F(JobMilling, SoDoTheFilesThatAreMadeOfIt) {
  v1::WorkerAssignment assignment = MillFor(kGroove, false);
  MillingOf(assignment).mutable_tool()->set_shape(v1::MillTool::SHAPE_BALL);
  MillingOf(assignment).set_cell_mm(0.04);
  Work(assignment);
  ASSERT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  // The least memory in which the run alone comes to its end, to 256 KiB.
  std::int64_t memory = 4 << 20;
  for (bool enough = false; !enough; memory += 256 << 10) {
    assignment.mutable_budget()->set_memory_bytes(memory);
    Work(assignment);
    enough = Outcome().kind() == v1::Outcome::KIND_COMPLETED;
  }
  MillingOf(assignment).set_stl(true);
  MillingOf(assignment).set_stl_tolerance_mm(0.0);
  EXPECT_TRUE(Work(assignment));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
  EXPECT_EQ(Outcome().code(), "CELL-E9302");
}

// Budget.output_bytes counts them, too: one byte less than all of them, and the report stays alone.
TEST_F(JobMilling, TheFilesCountAsOutput) {
  Work(MillFor(kGroove, false));
  std::size_t without = 0;
  for (const auto& [name, bytes] : Artifacts()) without += bytes.size();
  Work(MillFor(kGroove, true));
  std::size_t all = 0;
  for (const auto& [name, bytes] : Artifacts()) all += bytes.size();
  ASSERT_GT(all, without);
  v1::WorkerAssignment assignment = MillFor(kGroove, true);
  for (const std::size_t allowed : {all - 1, without}) {
    assignment.mutable_budget()->set_output_bytes(static_cast<std::int64_t>(allowed));
    Work(assignment);
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
    EXPECT_EQ(Outcome().code(), "CELL-E9306");
    EXPECT_THAT(Names(), ElementsAre("report"));
    EXPECT_EQ(Report().outcome().code(), "CELL-E9306");
  }
}

// A run that is cancelled has a report, and nobody waits for a body of its block.
TEST_F(JobMilling, ACancelledRunLeavesNoMaterial) {
  std::string endless = "VS10;!VZ10;!PZ-100,200;!MC1;";
  for (int i = 0; i < 20'000; ++i) endless += "PD4010,1510;PD2010,1510;";
  server.heard = [&](const v1::WorkRequest& message) {
    if (IsPosition(message)) server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  v1::WorkerAssignment assignment = MillFor(endless, true);
  assignment.mutable_job()->mutable_simulation()->set_pace(1.0);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
}

// Nothing may be thrown through libpng: what is out of memory is told when the file is closed.
TEST_F(JobMilling, AFileForWhichThereIsNoMemoryIsOutOfMemory) {
  const auto field = simulation::HeightField::Of(
      {.x_max = 10.0, .y_max = 10.0, .bottom = -1.0, .top = 0.0, .cell = 0.1});
  ASSERT_TRUE(field);
  for (const auto wants : {&v1::Milling::set_relief, &v1::Milling::set_height_map,
                           &v1::Milling::set_height_grid, &v1::Milling::set_stl}) {
    v1::Milling milling;
    (milling.*wants)(true);
    const auto none = [](std::size_t) -> bool { throw std::bad_alloc(); };
    EXPECT_THROW(MaterialFiles(*field, nullptr, milling, none), std::bad_alloc);
    EXPECT_FALSE(MaterialFiles(*field, nullptr, milling, [](std::size_t) { return false; }));
    EXPECT_EQ(MaterialFiles(*field, nullptr, milling, [](std::size_t) { return true; })->size(),
              1U);
  }
}

// What each of them adds is asked for with all that is there before it, to the byte.
TEST_F(JobMilling, EachFileCountsBesideThoseBefore) {
  const auto field = simulation::HeightField::Of(
      {.x_max = 10.0, .y_max = 10.0, .bottom = -1.0, .top = 0.0, .cell = 0.1});
  ASSERT_TRUE(field);
  v1::Milling milling;
  milling.set_height_map(true);
  milling.set_height_grid(true);
  milling.set_stl(true);
  std::size_t asked = 0;
  const auto files = MaterialFiles(*field, nullptr, milling, [&asked](std::size_t bytes) {
    asked = bytes;
    return true;
  });
  ASSERT_TRUE(files);
  std::size_t together = 0;
  for (const ProductFile& file : *files) together += file.bytes.size();
  EXPECT_EQ(files->size(), 3U);
  EXPECT_EQ(asked, together);
}

// A block that the server let through and this worker does not take: the job says why.
TEST_F(JobMilling, ABlockThatCannotBeEndsTheJob) {
  v1::WorkerAssignment assignment = MillFor(kGroove, true);
  MillingOf(assignment).mutable_tool()->set_diameter_mm(0.0);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(Outcome().code(), "CELL-E9003");
}

}  // namespace
}  // namespace rmlcell::server
