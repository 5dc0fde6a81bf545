// What a mill leaves of its block, as it is milled and afterwards: job.proto, StreamJobHeights.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "engine/simulation/material/height_tiles.h"
#include "server/base/names.h"
#include "server/services/followed_job.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using Message = v1::StreamJobHeightsResponse;

v1::HeightTile Tile(int column, int row, char height) {
  v1::HeightTile tile;
  tile.set_column(column);
  tile.set_row(row);
  tile.set_columns(64);
  tile.set_rows(64);
  tile.set_heights(std::string(2 * 64 * 64, height));
  return tile;
}

v1::WorkerHeights Grid(int columns = 1024, int rows = 128) {
  v1::WorkerHeights heights;
  heights.mutable_grid()->set_columns(columns);
  heights.mutable_grid()->set_rows(rows);
  heights.mutable_grid()->set_cell_mm(0.2);
  return heights;
}

v1::WorkerHeights Tiles(const std::vector<v1::HeightTile>& tiles) {
  v1::WorkerHeights heights;
  heights.mutable_tiles()->Add(tiles.begin(), tiles.end());
  return heights;
}

// 200 x 100 cells, with one number each row.
std::string StoredGrid() {
  const simulation::Stock stock{.x_max = 200.0, .y_max = 100.0, .bottom = -65.535, .cell = 1.0};
  simulation::HeightField field = simulation::HeightField::Of(stock).value();
  for (int row = 0; row < 100; ++row) {
    const double y = row + 0.5;
    field.Cut({.radius_mm = 0.1}, {0.5, y, -0.01 * row}, {199.5, y, -0.01 * row});
  }
  std::string bytes;
  simulation::WriteHeightGrid(field, [&](std::string_view part) {
    bytes += part;
    return true;
  });
  return bytes;
}

class HeightsFollow : public testing::Test {
 protected:
  OpenedStream<Message> Follow(std::int64_t job) {
    v1::StreamJobHeightsRequest request;
    request.set_name(JobName(job));
    request.set_follow(true);
    return room.Heights(request);
  }
  static v1::Job Mills() {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.mutable_simulation()->mutable_milling();
    return job;
  }

  StreamBed room;
};

TEST_F(HeightsFollow, TellsWhatThereIsAndWhatChanges) {
  const std::int64_t job = room.Submit(Mills());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.RunMill(job);
  auto early = Follow(job);
  running->Add(Grid());
  running->Add(Tiles({Tile(0, 0, 'a'), Tile(64, 0, 'b')}));
  EXPECT_EQ(early.Next().grid().columns(), 1024);
  const Message first = early.Next();
  ASSERT_EQ(first.tiles().tiles_size(), 2);
  EXPECT_EQ(first.tiles().tiles(1).SerializeAsString(), Tile(64, 0, 'b').SerializeAsString());
  running->Add(Tiles({Tile(0, 0, 'c')}));
  const Message second = early.Next();
  ASSERT_EQ(second.tiles().tiles_size(), 1);
  EXPECT_EQ(second.tiles().tiles(0).heights()[0], 'c');
  // Who comes later gets of each tile the latest only.
  auto late = Follow(job);
  EXPECT_DOUBLE_EQ(late.Next().grid().cell_mm(), 0.2);
  const Message all = late.Next();
  ASSERT_EQ(all.tiles().tiles_size(), 2);
  EXPECT_EQ(all.tiles().tiles(0).heights()[0], 'b');
  EXPECT_EQ(all.tiles().tiles(1).heights()[0], 'c');
  room.Finish(lease);
  running->End(true);
  early.ExpectGoodEnd();
  late.ExpectGoodEnd();
}

// A job is told to run before its worker tells of a block: it is looked for again, whatever else is
// told of the job.
TEST_F(HeightsFollow, ABlockThatComesLaterIsFound) {
  const std::int64_t job = room.Submit(Mills());
  const storage::Lease lease = room.bed.Lease();
  auto stream = Follow(job);
  ASSERT_TRUE(Eventually([&] { return room.heights_looked_for > 0; }));  // and not found
  const auto running = room.RunMill(job);
  running->Add(Grid());
  EXPECT_EQ(stream.Next().grid().columns(), 1024);
  room.Finish(lease);
  running->End(true);
  stream.ExpectGoodEnd();
}

// Whoever waits looks now and then, and not all the time: besides what is told of the job, which is
// that it was submitted, at most once in each such time, however slow the computer is.
TEST_F(HeightsFollow, WhoWaitsLooksNowAndThen) {
  const auto begin = std::chrono::steady_clock::now();
  auto stream = Follow(room.Submit(Mills()));
  ASSERT_TRUE(Eventually([&] { return room.heights_looked_for > 0; }));
  for (int other = 0; other < 100; ++other) room.Submit(Mills());
  const int looked = room.heights_looked_for;
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(looked, 3 + took / FollowedJob<RunningHeights>::kBegunLookedForAfter);
}

// A block that is milled faster than it is looked at: a message has a few, and none is missing.
TEST_F(HeightsFollow, ManyTilesComeInTurn) {
  const std::int64_t job = room.Submit(Mills());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.RunMill(job);
  running->Add(Grid());
  for (int tile = 0; tile < 32; ++tile) {
    running->Add(Tiles({Tile(tile % 16 * 64, tile / 16 * 64, static_cast<char>('A' + tile))}));
  }
  room.Finish(lease);
  running->End(true);
  // It is over for the store, and the stream says what it was all the same.
  auto stream = Follow(job);
  stream.ExpectRefused(grpc::StatusCode::NOT_FOUND, "height.grid");
  std::string seen;
  std::uint64_t at = 0;
  for (RunningHeights::Part part = running->Look(at); !part.tiles.empty();
       part = running->Look(at)) {
    EXPECT_LE(part.tiles.size(), 16U);
    EXPECT_FALSE(part.ended && part.tiles.size() == 16U && seen.empty());
    for (const v1::HeightTile& tile : part.tiles) seen += tile.heights()[0];
    at = part.seen;
  }
  EXPECT_EQ(seen, "ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_`");
  EXPECT_TRUE(running->Look(at).ended);
}

// The memory of the server is bounded, whatever a worker sends.
TEST_F(HeightsFollow, WhatIsNoPartOfTheGridIsLeftOut) {
  RunningHeights running;
  running.Add(Tiles({Tile(0, 0, 'a')}));  // before the grid
  running.Add(Grid(1025, 64));
  EXPECT_FALSE(running.Look(0).grid);
  running.Add(Grid(128, 100));
  running.Add(Grid(64, 64));  // the first one counts
  EXPECT_EQ(running.Look(0).grid->columns(), 128);
  v1::HeightTile narrow = Tile(64, 0, 'b');
  narrow.set_columns(63);  // and has the bytes of 64
  v1::HeightTile negative = Tile(-64, 0, 'b');
  v1::HeightTile between = Tile(32, 0, 'b');
  v1::HeightTile empty = Tile(0, 0, 'b');
  empty.set_rows(0);
  empty.clear_heights();
  running.Add(Tiles({narrow, negative, between, empty, Tile(128, 0, 'b'), Tile(0, 64, 'b')}));
  EXPECT_TRUE(running.Look(0).tiles.empty());
  v1::HeightTile last = Tile(64, 64, 'd');
  last.set_rows(36);
  last.set_heights(std::string(2 * 64 * 36, 'd'));
  running.Add(Tiles({last}));
  EXPECT_EQ(running.Look(0).tiles.size(), 1U);
}

TEST_F(HeightsFollow, AnAttemptThatIsLostEndsTheStream) {
  const std::int64_t job = room.Submit(Mills());
  auto stream = Follow(job);  // it waits yet
  room.bed.Lease();
  const auto running = room.RunMill(job);
  running->Add(Grid());
  EXPECT_TRUE(stream.Next().has_grid());
  running->End(false);
  stream.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "was lost: follow the job again");
}

// Also when it ended before its worker heard that somebody looks.
TEST_F(HeightsFollow, OneThatIsOverIsToldAsItIsStored) {
  const std::int64_t job = room.Submit(Mills());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.RunMill(job);
  auto stream = Follow(job);
  room.Finish(lease, {{.name = "height.grid", .bytes = StoredGrid()}});
  running->End(true);
  auto again = Follow(job);
  for (auto* followed : {&stream, &again}) {
    EXPECT_EQ(followed->Next().grid().rows(), 100);
    int tiles = 0;
    for (const Message& message : followed->Rest()) tiles += message.tiles().tiles_size();
    EXPECT_EQ(tiles, 8);  // four by two
  }
}

// Its worker may have had no time to tell anything of it: who follows gets what is stored.
TEST_F(HeightsFollow, ABlockOfWhichNothingWasToldComesFromTheStore) {
  const std::int64_t job = room.Submit(Mills());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.RunMill(job);
  auto stream = Follow(job);
  ASSERT_TRUE(Eventually([&] { return room.heights_looked_for > 0; }));  // and found
  room.Finish(lease, {{.name = "height.grid", .bytes = StoredGrid()}});
  running->End(true);
  EXPECT_EQ(stream.Next().grid().rows(), 100);
  int tiles = 0;
  for (const Message& message : stream.Rest()) tiles += message.tiles().tiles_size();
  EXPECT_EQ(tiles, 8);  // four by two
  stream.ExpectGoodEnd();
}

// 1200 x 600 cells are more bytes than one part of a content: 19 by 10 tiles, some a message.
TEST_F(HeightsFollow, ALargeBlockComesWhole) {
  const simulation::Stock stock{.x_max = 1200.0, .y_max = 600.0, .bottom = -65.535, .cell = 1.0};
  simulation::HeightField field = simulation::HeightField::Of(stock).value();
  field.Cut({.radius_mm = 0.1}, {0.5, 599.5, -1.0}, {1199.5, 599.5, -1.0});
  std::string bytes;
  simulation::WriteHeightGrid(field, [&](std::string_view part) {
    bytes += part;
    return true;
  });
  v1::StreamJobHeightsRequest request;
  request.set_name(JobName(room.Ended("height.grid", bytes, Mills())));
  request.set_level(0);
  auto stream = room.Heights(request);
  EXPECT_EQ(stream.Next().grid().columns(), 1200);
  std::vector<v1::HeightTile> tiles;
  for (const Message& message : stream.Rest()) {
    EXPECT_LE(message.tiles().tiles_size(), 16);
    for (const v1::HeightTile& tile : message.tiles().tiles()) tiles.push_back(tile);
  }
  ASSERT_EQ(tiles.size(), 190U);
  const v1::HeightTile& last = tiles.back();
  EXPECT_EQ(last.columns(), 48);
  EXPECT_EQ(last.rows(), 24);
  // The last row alone is cut, a millimetre deep.
  EXPECT_EQ(simulation::HeightAt(last.heights(), 22 * 48), 65'535);
  EXPECT_EQ(simulation::HeightAt(last.heights(), 23 * 48), 64'535);
}

TEST_F(HeightsFollow, LevelAndAreaOfWhatIsStored) {
  const std::int64_t job = room.Ended("height.grid", StoredGrid(), Mills());
  v1::StreamJobHeightsRequest request;
  request.set_name(JobName(job));
  request.set_level(1);
  request.mutable_area()->set_column(70);
  request.mutable_area()->set_row(3);
  request.mutable_area()->set_columns(1);
  request.mutable_area()->set_rows(1);
  auto stream = room.Heights(request);
  const v1::HeightGrid grid = stream.Next().grid();
  EXPECT_EQ(grid.level(), 1);
  EXPECT_EQ(grid.columns(), 100);
  EXPECT_EQ(grid.rows(), 50);
  EXPECT_DOUBLE_EQ(grid.cell_mm(), 2.0);
  const Message tiles = stream.Next();
  ASSERT_EQ(tiles.tiles().tiles_size(), 1);
  const v1::HeightTile& tile = tiles.tiles().tiles(0);
  EXPECT_EQ(tile.column(), 64);
  EXPECT_EQ(tile.columns(), 36);
  EXPECT_EQ(tile.rows(), 50);
  // Rows 20 and 21 are 200 and 210 numbers below the top.
  EXPECT_EQ(simulation::HeightAt(tile.heights(), 10 * 36), 65'535 - 205);
  stream.ExpectGoodEnd();
}

TEST_F(HeightsFollow, RefusesWhatIsNotThere) {
  v1::Job plain = Mills();
  plain.mutable_simulation()->clear_milling();
  Follow(room.Submit(plain))
      .ExpectRefused(grpc::StatusCode::NOT_FOUND, "makes no heights of a block");
  v1::StreamJobHeightsRequest request;
  request.set_name("jobs/99");
  room.Heights(request).ExpectRefused(grpc::StatusCode::NOT_FOUND, "99");
  request.set_level(17);
  room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "level");
  request.set_level(-1);
  room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "level");
  request.set_level(1);
  request.set_follow(true);
  room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "follow goes without");
  request.clear_level();
  request.set_follow(false);
  request.mutable_area()->set_columns(1);
  room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "area");
}

TEST_F(HeightsFollow, TheEndsOfLevelsAndAreas) {
  v1::StreamJobHeightsRequest whole;
  whole.set_name(JobName(room.Ended("height.grid", StoredGrid(), Mills())));
  for (const int level : {0, 16}) {
    whole.set_level(level);
    EXPECT_EQ(room.Heights(whole).Next().grid().level(), level);
  }
  whole.clear_level();
  whole.mutable_area()->set_columns(1);
  whole.mutable_area()->set_rows(1);
  EXPECT_TRUE(room.Heights(whole).Next().has_grid());
  for (const char* field : {"column", "row", "columns", "rows"}) {
    v1::StreamJobHeightsRequest request = whole;
    v1::HeightArea& area = *request.mutable_area();
    const auto* one_less = area.GetDescriptor()->FindFieldByName(field);
    area.GetReflection()->SetInt32(&area, one_less,
                                   area.GetReflection()->GetInt32(area, one_less) - 1);
    room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT,
                                        "area: it begins at 0 or later");
  }
}

// A block of one row and millions of columns: such a row is not held in memory.
TEST_F(HeightsFollow, TooManyColumnsAreRefused) {
  std::string bytes = StoredGrid();
  const std::size_t columns = simulation::HeightGridTiles::kColumnsMax + 1;
  for (std::size_t byte = 0; byte < 4; ++byte)
    bytes[12 + byte] = static_cast<char>(columns >> (8 * byte) & 0xFF);
  bytes[16] = 1;  // row
  v1::StreamJobHeightsRequest request;
  request.set_name(JobName(room.Ended("height.grid", bytes, Mills())));
  room.Heights(request).ExpectRefused(grpc::StatusCode::RESOURCE_EXHAUSTED, "1048577 columns");
  bytes[12] = static_cast<char>(bytes[12] - 1);
  request.set_name(JobName(room.Ended("height.grid", bytes, Mills())));
  EXPECT_TRUE(room.Heights(request).Next().has_grid());
}

TEST_F(HeightsFollow, ABadProductIsAnErrorAndNoPicture) {
  v1::StreamJobHeightsRequest request;
  request.set_name(JobName(room.Ended("height.grid", "no grid", Mills())));
  room.Heights(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "this is no height grid");
}

}  // namespace
}  // namespace rmlcell::server
