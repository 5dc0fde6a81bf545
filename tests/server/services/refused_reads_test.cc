// Streams whose store refuses what they read: each ends with the error of the store, the server
// goes on, and who comes again finds all as it was.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/simulation/material/height_tiles.h"
#include "proto/bridge/framing.h"
#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

class RefusedReads : public testing::Test {
 protected:
  // Of jobs, or of another part of the cell; events only.
  static v1::WatchCellRequest WatchOf(const std::string& part) {
    v1::WatchCellRequest request;
    v1::Subscription& subscription = *request.add_subscriptions();
    subscription.set_id(part);
    if (part == "machines") {
      subscription.mutable_machines()->set_events_only(true);
    } else if (part == "projects") {
      subscription.mutable_projects();
    } else {
      subscription.mutable_jobs()->set_events_only(true);
    }
    return request;
  }
  // The feed began behind both machines of the bed: what comes behind 1 is read from the store.
  static v1::WatchCellRequest JobsBehind(std::int64_t sequence) {
    v1::WatchCellRequest request = WatchOf("jobs");
    request.set_after_sequence(sequence);
    return request;
  }
  void ExpectEndsAtOnce(const v1::WatchCellRequest& request, const std::string& call) {
    SCOPED_TRACE(call);
    room.store.Refuse(call);
    room.WatchCell(request).ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
    room.store.Heal();
    EXPECT_NE(room.WatchCell(request).Next().log_id(), "");
  }
  template <class Message>
  static void ExpectEndsWithTheStore(OpenedStream<Message> stream) {
    stream.ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
  }
  static std::string StoredFrames(const std::vector<std::string>& blocks) {
    std::string bytes;
    for (const std::string& block : blocks) bridge::AddFrame(block, bytes);
    return bytes;
  }
  // 1200 x 600 cells, whose last row alone is cut: a part of a content, and some of another.
  v1::StreamJobHeightsRequest LargeBlock() {
    const simulation::Stock stock{.x_max = 1200.0, .y_max = 600.0, .bottom = -65.535, .cell = 1.0};
    simulation::HeightField field = simulation::HeightField::Of(stock).value();
    field.Cut({.radius_mm = 0.1}, {0.5, 599.5, -1.0}, {1199.5, 599.5, -1.0});
    std::string bytes;
    simulation::WriteHeightGrid(field, [&](std::string_view part) {
      bytes += part;
      return true;
    });
    v1::StreamJobHeightsRequest request;
    request.set_name(JobName(room.Ended("height.grid", bytes)));
    request.set_level(0);
    return request;
  }
  static v1::HeightArea OneCell(int column, int row) {
    v1::HeightArea area;
    area.set_column(column);
    area.set_row(row);
    area.set_columns(1);
    area.set_rows(1);
    return area;
  }

  StreamBed room;
};

TEST_F(RefusedReads, AWatchThatBeginsEndsWithThem) {
  for (const char* call : {"LastPosition", "ListJobs", "CountByState"})
    ExpectEndsAtOnce(WatchOf("jobs"), call);
  for (const char* call : {"ListMachines", "UnfinishedJobs"})
    ExpectEndsAtOnce(WatchOf("machines"), call);
  ExpectEndsAtOnce(WatchOf("projects"), "ListProjects");
}

TEST_F(RefusedReads, AWatchThatComesBackEndsWithThem) {
  for (const char* call : {"EventsGoneUntil", "HasPosition"}) ExpectEndsAtOnce(JobsBehind(1), call);
  // Of another log: it would begin anew.
  ExpectEndsAtOnce(JobsBehind(Must(room.bed.store().LastPosition()) + 1), "LastPosition");
}

TEST_F(RefusedReads, AWatchWhoseEventsAreRefusedEndsWithThem) {
  room.Submit();
  room.store.Refuse("AllEvents");
  auto watch = room.WatchCell(JobsBehind(1));
  EXPECT_TRUE(watch.Next().has_bookmark());
  watch.ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
}

// cell.proto, Gap: events that were removed while the watch had not told them yet.
TEST_F(RefusedReads, AWatchThatIsTooSlowIsToldSoAndBeginsAnew) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  const std::int64_t last = Must(room.bed.store().LastPosition());
  room.store.Refuse("AllEvents", ErrorCode::kCellEventsGone);
  auto watch = room.WatchCell(JobsBehind(1));
  EXPECT_TRUE(watch.Next().has_bookmark());
  const v1::WatchCellResponse gap = watch.Next();
  ASSERT_TRUE(gap.has_gap()) << gap.ShortDebugString();
  EXPECT_EQ(gap.gap().reason(), v1::Gap::REASON_TOO_SLOW);
  EXPECT_EQ(gap.sequence(), last);
  const v1::WatchCellResponse anew = watch.Next();
  ASSERT_EQ(anew.snapshot().jobs_size(), 1);
  EXPECT_EQ(anew.snapshot().jobs(0).name(), JobName(job));
  room.store.Heal();
  room.Say(lease, {"a"});
  EXPECT_EQ(watch.Next().event().job().message().text(), "a");
}

TEST_F(RefusedReads, AWatchThatIsTooSlowEndsWhereItCannotBeginAnew) {
  room.store.Refuse("AllEvents", ErrorCode::kCellEventsGone);
  room.store.Refuse("LastPosition");
  auto watch = room.WatchCell(JobsBehind(1));
  EXPECT_TRUE(watch.Next().has_bookmark());
  watch.ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
}

TEST_F(RefusedReads, AWatchOfAMachineEndsWithThem) {
  v1::WatchMachineRequest request;
  request.set_name("machines/mill-1");
  for (const char* call : {"LastPosition", "GetMachine", "UnfinishedJobs"}) {
    SCOPED_TRACE(call);
    room.store.Refuse(call);
    ExpectEndsWithTheStore(room.WatchMachine(request));
    room.store.Heal();
    EXPECT_EQ(room.WatchMachine(request).Next().status().machine(), "machines/mill-1");
  }
}

TEST_F(RefusedReads, AProductThatCannotBeReadEndsItsStream) {
  const std::string name = JobName(room.Ended("toolpath", StoredFrames({"one"})));
  v1::StreamJobHeightsRequest heights = LargeBlock();
  room.store.Refuse("Next");
  ExpectEndsWithTheStore(room.Artifact(name, "toolpath"));
  ExpectEndsWithTheStore(room.Heights(heights));
  auto toolpath = room.Toolpath(name, 0);
  EXPECT_TRUE(toolpath.Next().has_header());
  toolpath.ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full");
  heights.set_name("x");
  room.Heights(heights).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// Two parts, and the end, at which it shows whether the bytes are those that were stored.
TEST_F(RefusedReads, ABlockIsReadToItsEnd) {
  v1::StreamJobHeightsRequest request = LargeBlock();
  for (const int good : {1, 2}) {
    room.store.Refuse("Next", ErrorCode::kCellStoreFailed, good);
    auto stream = room.Heights(request);
    EXPECT_TRUE(stream.Next().has_grid());
    int tiles = 0;
    for (const auto& message : stream.Rest()) tiles += message.tiles().tiles_size();
    EXPECT_EQ(tiles == 19 * 10, good == 2) << tiles;
    ExpectEndsWithTheStore(std::move(stream));
  }
}

// job.proto, StreamJobHeightsRequest.area: what it needs of the block is read, and no more.
TEST_F(RefusedReads, AnAreaIsReadAsFarAsItReaches) {
  v1::StreamJobHeightsRequest request = LargeBlock();
  *request.mutable_area() = OneCell(1199, 599);
  auto last = room.Heights(request);
  EXPECT_TRUE(last.Next().has_grid());
  const auto tiles = last.Next();
  ASSERT_EQ(tiles.tiles().tiles_size(), 1);
  EXPECT_EQ(tiles.tiles().tiles(0).column(), 1152);
  EXPECT_EQ(tiles.tiles().tiles(0).row(), 576);
  last.ExpectGoodEnd();
  *request.mutable_area() = OneCell(0, 0);
  room.store.Refuse("Next", ErrorCode::kCellStoreFailed, 1);
  auto first = room.Heights(request);
  EXPECT_TRUE(first.Next().has_grid());
  EXPECT_EQ(first.Next().tiles().tiles_size(), 1);
  first.ExpectGoodEnd();
}

}  // namespace
}  // namespace rmlcell::server
