// WatchMachine, as proto/rmlcell/v1/machine.proto has it.
#include <gtest/gtest.h>

#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

class MachineWatchTest : public testing::Test {
 protected:
  static v1::WatchMachineRequest Of(const std::string& name, double rate = 0.0) {
    v1::WatchMachineRequest request;
    request.set_name(name);
    request.set_max_rate_hz(rate);
    return request;
  }

  StreamBed room;
  Executor executor{1};
  MachineStatuses statuses{room.bed.store(), room.feed, executor};
};

TEST_F(MachineWatchTest, TellsTheStatusNowAndAfterEachChange) {
  ASSERT_TRUE(
      Eventually([&] { return room.feed.LatestAfter("machines/optimo-1", 0).has_value(); }));
  auto watch = room.WatchMachine(Of("machines/optimo-1"));
  const v1::WatchMachineResponse first = watch.Next();
  EXPECT_EQ(first.instance_id(), StreamBed::kInstance);
  EXPECT_EQ(first.status().machine(), "machines/optimo-1");
  EXPECT_EQ(first.status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(first.sequence(), Must(room.bed.store().LastPosition()));
  EXPECT_EQ(first.log_id(), room.bed.store().LogId());
  room.Submit();
  const v1::WatchMachineResponse waits = watch.Next();
  EXPECT_EQ(waits.status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(waits.status().jobs_active(), 1);
  const storage::Lease lease = room.bed.Lease();
  room.Finish(lease);
  // Latest wins: that it ran may have been left out.
  v1::WatchMachineResponse last = watch.Next();
  while (last.status().jobs_active() > 0) last = watch.Next();
  EXPECT_EQ(last.status().state(), v1::MACHINE_STATE_IDLE);
}

// LIVE-4.06: a hundred look on, each from its own place; those that stop reading cost the others
// nothing.
TEST_F(MachineWatchTest, AHundredLookOnAndSomeDoNotRead) {
  ASSERT_TRUE(
      Eventually([&] { return room.feed.LatestAfter("machines/optimo-1", 0).has_value(); }));
  std::vector<OpenedStream<v1::WatchMachineResponse>> watches;
  for (int i = 0; i < 100; ++i) watches.push_back(room.WatchMachine(Of("machines/optimo-1")));
  for (auto& watch : watches) {
    EXPECT_EQ(watch.Next().status().jobs_active(), 0);
  }
  room.Submit();
  for (std::size_t i = 0; i < watches.size(); i += 2) {
    EXPECT_EQ(watches[i].Next().status().jobs_active(), 1) << i;
  }
  room.Finish(room.bed.Lease());
  for (std::size_t i = 0; i < watches.size(); ++i) {
    v1::WatchMachineResponse last = watches[i].Next();
    while (last.has_status() && last.status().jobs_active() > 0) last = watches[i].Next();
    EXPECT_TRUE(last.has_status()) << i;
  }
}

TEST_F(MachineWatchTest, EndsWithTheMachine) {
  auto watch = room.WatchMachine(Of("machines/mill-1"));
  EXPECT_EQ(watch.Next().status().machine(), "machines/mill-1");
  EXPECT_TRUE(room.bed.store().DeleteMachine("mill-1", storage::kAnyRevision));
  watch.Rest();
  watch.ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
}

TEST_F(MachineWatchTest, WhatIsNoMachineIsRefused) {
  auto unknown = room.WatchMachine(Of("machines/none"));
  unknown.ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  auto misnamed = room.WatchMachine(Of("mill-1"));
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  for (const double rate : {-1.0, 0.5, 20.5}) {
    auto watch = room.WatchMachine(Of("machines/mill-1", rate));
    watch.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "max_rate_hz");
  }
}

}  // namespace
}  // namespace rmlcell::server
