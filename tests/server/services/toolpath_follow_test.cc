// The toolpath of a job that is not over: job.proto, StreamJobToolpathRequest.follow.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "proto/bridge/framing.h"
#include "server/base/names.h"
#include "server/services/followed_job.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

std::string Framed(const std::vector<std::string>& blocks) {
  std::string bytes;
  for (const std::string& block : blocks) bridge::AddFrame(block, bytes);
  return bytes;
}

class ToolpathFollowTest : public testing::Test {
 protected:
  OpenedStream<v1::StreamJobToolpathResponse> Follow(std::int64_t job) {
    v1::StreamJobToolpathRequest request;
    request.set_name(JobName(job));
    request.set_follow(true);
    return room.Toolpath(request);
  }
  static std::vector<storage::NewArtifact> Stored(const std::string& frames) {
    v1::RunReport report;
    report.mutable_toolpath()->set_records(77);
    report.mutable_toolpath()->set_complete(true);
    return {{.name = "toolpath", .media_type = "application/octet-stream", .bytes = frames},
            {.name = "report",
             .media_type = "application/octet-stream",
             .bytes = report.SerializeAsString()}};
  }

  static v1::Job Simulation() {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    return job;
  }

  StreamBed room;
};

TEST_F(ToolpathFollowTest, TellsWhatThereIsAndWhatComes) {
  const std::int64_t job = room.Submit(Simulation());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  running->Add(Framed({"one"}), "tw");
  auto stream = Follow(job);
  const v1::StreamJobToolpathResponse first = stream.Next();
  ASSERT_TRUE(first.has_header());
  EXPECT_DOUBLE_EQ(first.header().tolerance_mm(), 0.01);
  EXPECT_FALSE(first.header().complete());
  EXPECT_EQ(first.header().points(), 0);
  EXPECT_EQ(stream.Next().block(), "one");
  EXPECT_EQ(stream.Next().open_block(), "tw");
  running->Add({}, "two");
  EXPECT_EQ(stream.Next().open_block(), "two");
  // A frame in two parts is one block; what was open is in it.
  const std::string frame = Framed({"two and more"});
  running->Add(std::string_view(frame).substr(0, 7), {});
  running->Add(std::string_view(frame).substr(7), {});
  EXPECT_EQ(stream.Next().block(), "two and more");
  // The rest comes from the store, with a header that tells of all of it.
  const std::string frames = Framed({"one", "two and more", "three", "four"});
  running->Add(Framed({"three"}), "fo");
  EXPECT_EQ(stream.Next().block(), "three");
  EXPECT_EQ(stream.Next().open_block(), "fo");
  room.Finish(lease, Stored(frames));
  running->End(true);
  EXPECT_EQ(stream.Next().block(), "four");
  const v1::StreamJobToolpathResponse last = stream.Next();
  ASSERT_TRUE(last.has_header());
  EXPECT_TRUE(last.header().complete());
  EXPECT_EQ(last.header().points(), 77);
  EXPECT_EQ(last.header().bytes(), static_cast<std::int64_t>(frames.size()));
  stream.ExpectGoodEnd();
}

// Many blocks are there at once, more than is looked at together; who comes late gets all of them.
TEST_F(ToolpathFollowTest, EachFollowerGetsAllOfItInOrder) {
  const std::int64_t job = room.Submit(Simulation());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  std::vector<std::string> blocks;
  for (int i = 0; i < 300; ++i) blocks.push_back(std::to_string(i) + std::string(9'000, 'x'));
  const std::string frames = Framed(blocks);
  auto early = Follow(job);
  EXPECT_TRUE(early.Next().has_header());
  for (std::size_t at = 0; at < frames.size(); at += 100'000)
    running->Add(std::string_view(frames).substr(at, 100'000), {});
  auto late = Follow(job);
  EXPECT_TRUE(late.Next().has_header());
  for (auto* stream : {&early, &late}) {
    for (const std::string& block : blocks) ASSERT_EQ(stream->Next().block(), block);
  }
  room.Finish(lease, Stored(frames));
  running->End(true);
  for (auto* stream : {&early, &late}) {
    EXPECT_TRUE(stream->Next().has_header());
    stream->ExpectGoodEnd();
  }
}

TEST_F(ToolpathFollowTest, AJobThatWaitsIsFollowedWhenItBegins) {
  const std::int64_t job = room.Submit(Simulation());
  auto stream = Follow(job);
  ASSERT_TRUE(Eventually([&] { return room.toolpaths_looked_for > 0; }));  // and not found
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  running->Add(Framed({"one"}), {});
  EXPECT_TRUE(stream.Next().has_header());
  EXPECT_EQ(stream.Next().block(), "one");
  room.Finish(lease, Stored(Framed({"one"})));
  running->End(true);
  EXPECT_TRUE(stream.Next().header().complete());
  stream.ExpectGoodEnd();
}

// Whoever waits looks now and then, and not all the time: besides what is told of the job, which is
// that it was submitted, at most once in each such time, however slow the computer is.
TEST_F(ToolpathFollowTest, WhoWaitsLooksNowAndThen) {
  const auto begin = std::chrono::steady_clock::now();
  auto stream = Follow(room.Submit(Simulation()));
  ASSERT_TRUE(Eventually([&] { return room.toolpaths_looked_for > 0; }));
  for (int other = 0; other < 100; ++other) room.Submit(Simulation());
  const int looked = room.toolpaths_looked_for;
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_LE(looked, 3 + took / FollowedJob<RunningToolpath>::kBegunLookedForAfter);
}

// Of a job that another server has nothing is heard before its end.
TEST_F(ToolpathFollowTest, OneThatDoesNotRunHereIsToldWhenItIsOver) {
  const std::int64_t job = room.Submit(Simulation());
  auto stream = Follow(job);
  ASSERT_TRUE(Eventually([&] { return room.toolpaths_looked_for > 0; }));
  room.Finish(room.bed.Lease(), Stored(Framed({"one"})));
  EXPECT_TRUE(stream.Next().header().complete());
  EXPECT_EQ(stream.Next().block(), "one");
  stream.ExpectGoodEnd();
}

TEST_F(ToolpathFollowTest, OneThatIsOverIsToldAsItIsStored) {
  const std::int64_t job = room.Ended("toolpath", Framed({"one", "two"}));
  auto stream = Follow(job);
  EXPECT_TRUE(stream.Next().has_header());
  EXPECT_EQ(stream.Next().block(), "one");
  EXPECT_EQ(stream.Next().block(), "two");
  stream.ExpectGoodEnd();
}

// Its next attempt makes another one, which is not put behind this one.
TEST_F(ToolpathFollowTest, AnAttemptThatIsLostEndsTheStream) {
  const std::int64_t job = room.Submit(Simulation());
  room.bed.Lease();
  const auto running = room.Run(job);
  running->Add(Framed({"one"}), {});
  auto stream = Follow(job);
  EXPECT_TRUE(stream.Next().has_header());
  EXPECT_EQ(stream.Next().block(), "one");
  running->End(false);
  stream.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "was lost: follow the job again");
}

// Also when another attempt has brought the job to its end before the follower looks.
TEST_F(ToolpathFollowTest, WhatAnotherAttemptMadeIsNotPutBehindIt) {
  const std::int64_t job = room.Submit(Simulation());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  running->Add(Framed({"one"}), {});
  auto stream = Follow(job);
  EXPECT_TRUE(stream.Next().has_header());
  EXPECT_EQ(stream.Next().block(), "one");
  room.Finish(lease, Stored(Framed({"another", "and more"})));
  running->End(false);
  stream.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "was lost: follow the job again");
}

TEST_F(ToolpathFollowTest, AJobThatMakesNoneHasNothingToFollow) {
  v1::Job check = Simulation();
  check.set_kind(v1::JOB_KIND_CHECK);
  Follow(room.Submit(check)).ExpectRefused(grpc::StatusCode::NOT_FOUND, "makes no toolpath");
}

TEST_F(ToolpathFollowTest, RefusesLevelsAndJobsThatAreNot) {
  const std::int64_t job = room.Submit(Simulation());
  v1::StreamJobToolpathRequest request;
  request.set_name(JobName(job));
  request.set_follow(true);
  request.set_level(1);
  room.Toolpath(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "follow goes with");
  request.set_level(0);
  request.set_with_levels(true);
  room.Toolpath(request).ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "follow goes with");
  Follow(job + 1).ExpectRefused(grpc::StatusCode::NOT_FOUND, "job " + std::to_string(job + 1));
}

// What went out already is not told again, however many parts of the stored one it fills.
TEST_F(ToolpathFollowTest, WhatIsLeftOfALongOneComesFromTheStore) {
  const std::int64_t job = room.Submit(Simulation());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  std::vector<std::string> blocks;
  for (int i = 0; i < 300; ++i) blocks.push_back(std::to_string(i) + std::string(9'000, 'x'));
  running->Add(Framed(std::vector<std::string>(blocks.begin(), blocks.begin() + 200)), {});
  auto stream = Follow(job);
  EXPECT_EQ(stream.Next().header().bytes(), 0);  // nobody knows yet
  for (int i = 0; i < 200; ++i)
    ASSERT_EQ(stream.Next().block(), blocks[static_cast<std::size_t>(i)]);
  room.Finish(lease, Stored(Framed(blocks)));
  running->End(true);
  for (int i = 200; i < 300; ++i)
    ASSERT_EQ(stream.Next().block(), blocks[static_cast<std::size_t>(i)]);
  EXPECT_EQ(stream.Next().header().bytes(), static_cast<std::int64_t>(Framed(blocks).size()));
  stream.ExpectGoodEnd();
}

// Of a frame a part may have come before the end: the store has all of it.
TEST_F(ToolpathFollowTest, APartOfAFrameIsTakenFromTheStoreAsAWhole) {
  const std::int64_t job = room.Submit(Simulation());
  const storage::Lease lease = room.bed.Lease();
  const auto running = room.Run(job);
  running->Add(Framed({"one"}) + Framed({"two and more"}).substr(0, 7), "and more");
  auto stream = Follow(job);
  EXPECT_TRUE(stream.Next().has_header());
  EXPECT_EQ(stream.Next().block(), "one");
  EXPECT_EQ(stream.Next().open_block(), "and more");  // behind all that has come
  room.Finish(lease, Stored(Framed({"one", "two and more"})));
  running->End(true);
  EXPECT_EQ(stream.Next().block(), "two and more");
  EXPECT_TRUE(stream.Next().header().complete());
  stream.ExpectGoodEnd();
}

// ToolpathHeader.duration_ns: virtual time of the run, as its report has it; tip_box: where it was.
TEST_F(ToolpathFollowTest, TheHeaderSaysHowLongItTakes) {
  const std::int64_t job = room.Submit(Simulation());
  v1::RunReport report;
  report.mutable_total()->mutable_times()->set_cycle_s(2.5);
  report.mutable_tip_box()->mutable_low()->set_x(3.0);
  report.mutable_tip_box()->mutable_high()->set_x(4.0);
  room.Finish(room.bed.Lease(), {{.name = "toolpath", .bytes = Framed({"one"})},
                                 {.name = "report", .bytes = report.SerializeAsString()}});
  const v1::ToolpathHeader header = Follow(job).Next().header();
  EXPECT_EQ(header.duration_ns(), 2'500'000'000);
  EXPECT_EQ(header.tip_box().low().x(), 3.0);
  EXPECT_EQ(header.tip_box().high().x(), 4.0);
}

}  // namespace
}  // namespace rmlcell::server
