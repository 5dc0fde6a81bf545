// What the worker of a job makes while the job runs, as its followers look at it.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/jobs/running_heights.h"
#include "server/jobs/running_toolpath.h"

namespace rmlcell::server {
namespace {

v1::WorkerHeights GridOf(int columns, int rows) {
  v1::WorkerHeights heights;
  heights.mutable_grid()->set_columns(columns);
  heights.mutable_grid()->set_rows(rows);
  return heights;
}

// Of two bytes a cell.
v1::WorkerHeights TileAt(int column, int row, int columns, int rows, char with = 'a') {
  v1::WorkerHeights heights;
  v1::HeightTile& tile = *heights.add_tiles();
  tile.set_column(column);
  tile.set_row(row);
  tile.set_columns(columns);
  tile.set_rows(rows);
  tile.set_heights(std::string(static_cast<std::size_t>(2 * columns * rows), with));
  return heights;
}

TEST(RunningHeights, AGridIsOneForAScreen) {
  const auto taken = [](int columns, int rows) {
    RunningHeights running;
    running.Add(GridOf(columns, rows));
    return running.Look(0).grid.has_value();
  };
  EXPECT_TRUE(taken(1, 1));
  EXPECT_TRUE(taken(1024, 1024));
  EXPECT_FALSE(taken(0, 1));
  EXPECT_FALSE(taken(1, 0));
  EXPECT_FALSE(taken(1025, 1));
  EXPECT_FALSE(taken(1, 1025));
}

// Tiles begin every 64 cells and end there, or with the grid.
TEST(RunningHeights, ATileIsAPartOfItsGrid) {
  const auto taken = [](const v1::WorkerHeights& tile) {
    RunningHeights running;
    running.Add(GridOf(200, 100));
    running.Add(tile);
    return !running.Look(0).tiles.empty();
  };
  EXPECT_TRUE(taken(TileAt(0, 0, 64, 64)));
  EXPECT_TRUE(taken(TileAt(0, 0, 1, 1)));
  EXPECT_TRUE(taken(TileAt(192, 64, 8, 36)));
  EXPECT_FALSE(taken(TileAt(192, 64, 9, 36)));
  EXPECT_FALSE(taken(TileAt(192, 64, 8, 37)));
  EXPECT_FALSE(taken(TileAt(0, 0, 65, 1)));
  EXPECT_FALSE(taken(TileAt(0, 0, 0, 1)));
  EXPECT_FALSE(taken(TileAt(-64, 0, 64, 64)));
  EXPECT_FALSE(taken(TileAt(0, -64, 64, 64)));
  EXPECT_FALSE(taken(TileAt(1, 0, 1, 1)));
  v1::WorkerHeights short_one = TileAt(0, 0, 64, 64);
  short_one.mutable_tiles(0)->mutable_heights()->pop_back();
  EXPECT_FALSE(taken(short_one));
}

TEST(RunningHeights, ATileIsToldAsItWasLast) {
  RunningHeights running;
  running.Add(GridOf(128, 64));
  running.Add(TileAt(0, 0, 64, 64, 'a'));
  running.Add(TileAt(64, 0, 64, 64, 'b'));
  RunningHeights::Part part = running.Look(0);
  ASSERT_EQ(part.tiles.size(), 2U);
  EXPECT_EQ(part.tiles[0].heights()[0], 'a');
  EXPECT_EQ(part.tiles[1].heights()[0], 'b');
  EXPECT_FALSE(part.ended);
  EXPECT_TRUE(running.Look(part.seen).tiles.empty());
  EXPECT_EQ(running.Look(part.seen).seen, part.seen);
  running.Add(TileAt(0, 0, 64, 64, 'c'));
  EXPECT_EQ(running.Look(part.seen).tiles.size(), 1U);
  part = running.Look(0);
  ASSERT_EQ(part.tiles.size(), 2U);
  EXPECT_EQ(part.tiles[0].heights()[0], 'b');
  EXPECT_EQ(part.tiles[1].heights()[0], 'c');
}

// A look gives sixteen of them: it is over when the last one was seen, and not before.
TEST(RunningHeights, SixteenTilesAreSeenAtOnce) {
  RunningHeights running;
  running.Add(GridOf(1024, 128));
  for (int tile = 0; tile < 16; ++tile) running.Add(TileAt(tile * 64, 0, 64, 64));
  running.End(true);
  EXPECT_EQ(running.Look(0).tiles.size(), 16U);
  EXPECT_TRUE(running.Look(0).ended);
  running.Add(TileAt(0, 64, 64, 64));
  const RunningHeights::Part part = running.Look(0);
  EXPECT_EQ(part.tiles.size(), 16U);
  EXPECT_FALSE(part.ended);
  EXPECT_FALSE(part.stored);
  const RunningHeights::Part rest = running.Look(part.seen);
  EXPECT_EQ(rest.tiles.size(), 1U);
  EXPECT_TRUE(rest.ended);
  EXPECT_TRUE(rest.stored);
}

TEST(RunningToolpath, IsToldFromWhereItIsAskedFor) {
  RunningToolpath running;
  running.Add("abc", "open");
  RunningToolpath::Part part = running.Look(1, 0);
  EXPECT_EQ(part.frames, "bc");
  EXPECT_EQ(part.open_block, "");  // behind all that is whole
  EXPECT_FALSE(part.ended);
  part = running.Look(3, 0);
  EXPECT_EQ(part.frames, "");
  EXPECT_EQ(part.open_block, "open");
  EXPECT_EQ(running.Look(3, part.open_seen).open_block, "");  // it was seen
  running.Add("", "more");
  EXPECT_EQ(running.Look(3, part.open_seen).open_block, "more");
  running.End(false);
  EXPECT_TRUE(running.Look(3, 0).ended);
  EXPECT_FALSE(running.Look(3, 0).stored);
}

TEST(RunningToolpath, APartHasAQuarterOfAMebibyte) {
  RunningToolpath running;
  running.Add(std::string((256 << 10) + 1, 'a'), "open");
  EXPECT_EQ(running.Look(0, 0).frames.size(), std::size_t{256} << 10);
  EXPECT_EQ(running.Look(256 << 10, 0).frames.size(), 1U);
}

// Whoever waits is woken by each change, as long as he follows.
TEST(Followed, WakesItsFollowers) {
  const auto running = std::make_shared<RunningToolpath>();
  int one = 0;
  int other = 0;
  auto follower = running->Follow([&one] { ++one; });
  const auto stays = running->Follow([&other] { ++other; });
  running->Add("a", "");
  EXPECT_EQ(one, 1);
  follower.reset();
  running->Add("b", "");
  running->End(true);
  EXPECT_EQ(one, 1);
  EXPECT_EQ(other, 3);
}

// So is whoever looks at the block.
TEST(Followed, HeightsWakeTheirFollowers) {
  const auto running = std::make_shared<RunningHeights>();
  int woken = 0;
  auto follower = running->Follow([&woken] { ++woken; });
  running->Add(GridOf(64, 64));
  EXPECT_EQ(woken, 1);
  running->Add(TileAt(0, 0, 64, 64));
  EXPECT_EQ(woken, 2);
  running->End(true);
  EXPECT_EQ(woken, 3);
  follower.reset();
  running->Add(TileAt(0, 0, 64, 64));
  EXPECT_EQ(woken, 3);
}

// Without a grid nobody knows where a tile stands.
TEST(RunningHeights, ATileBeforeItsGridIsDropped) {
  RunningHeights running;
  running.Add(TileAt(0, 0, 1, 1, 'a'));
  EXPECT_TRUE(running.Look(0).tiles.empty());
  running.Add(GridOf(1, 1));
  EXPECT_TRUE(running.Look(0).tiles.empty());
  running.Add(TileAt(0, 0, 1, 1, 'b'));
  const RunningHeights::Part part = running.Look(0);
  ASSERT_EQ(part.tiles.size(), 1U);
  EXPECT_EQ(part.tiles[0].heights(), "bb");
}

// What lies in a file, since it is more than a mebibyte, and cannot be read is followed no more.
TEST(RunningToolpath, APartThatCannotBeReadEndsIt) {
  RunningToolpath running;
  running.Add(std::string((1 << 20) + 1, 'a'), "open");
  EXPECT_FALSE(running.Look(0, 5).ended);
  const RunningToolpath::Part part = running.Look(-1, 5);
  EXPECT_TRUE(part.ended);
  EXPECT_FALSE(part.stored);
  EXPECT_EQ(part.frames, "");
  EXPECT_EQ(part.open_seen, 5U);
}

}  // namespace
}  // namespace rmlcell::server
