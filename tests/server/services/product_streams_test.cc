// Toolpath and trace of a job, as proto/rmlcell/v1/job.proto and docs/toolpath.md have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/simulation/toolpath/toolpath.h"
#include "proto/bridge/framing.h"
#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using simulation::ToolpathBlock;
using simulation::ToolpathPoint;

// One run along X with a bend aside of so many um in its middle.
std::string BlockWithBend(std::int32_t aside_um) {
  ToolpathBlock block;
  block.points = {{0, 0, 0}, {1'000'000, aside_um, 0}, {2'000'000, 0, 0}};
  block.reached_us = {0, 500, 1000};
  block.runs.push_back({.program = 1,
                        .step = 1,
                        .use = machine::MotionUse::kCut,
                        .beam_on = true,
                        .speed_class = 2,
                        .start_us = 0,
                        .end_us = 1000,
                        .first_point = 0,
                        .point_count = 3});
  return EncodeToolpathBlock(block);
}

std::string Frames(const std::vector<std::string>& blocks) {
  std::string bytes;
  for (const std::string& block : blocks) bridge::AddFrame(block, bytes);
  return bytes;
}

v1::Job WithTolerance(double tolerance_mm) {
  v1::Job job;
  job.mutable_simulation()->set_toolpath_tolerance_mm(tolerance_mm);
  return job;
}

class ProductStreamsTest : public testing::Test {
 protected:
  std::vector<std::string> Blocks(std::int64_t job, int level) {
    auto stream = room.Toolpath(JobName(job), level);
    std::vector<std::string> blocks;
    header.reset();
    for (const v1::StreamJobToolpathResponse& message : stream.Rest()) {
      EXPECT_EQ(message.has_header(), blocks.empty() && !header);
      if (message.has_header()) {
        header = message.header();
      } else {
        blocks.push_back(message.block());
      }
    }
    EXPECT_TRUE(header);
    stream.ExpectGoodEnd();
    return blocks;
  }
  // Whether a bend of so many um is left at this level of a job that asked for this tolerance.
  bool BendIsLeft(double tolerance_mm, int level, std::int32_t aside_um) {
    const std::int64_t job =
        room.Ended("toolpath", Frames({BlockWithBend(aside_um)}), WithTolerance(tolerance_mm));
    std::vector<ToolpathPoint> points;
    for (const std::string& bytes : Blocks(job, level)) {
      const auto block = simulation::DecodeToolpathBlock(bytes);
      EXPECT_TRUE(block);
      if (block) points.insert(points.end(), block->points.begin(), block->points.end());
    }
    EXPECT_GE(points.size(), 2U);
    EXPECT_EQ(points.front(), (ToolpathPoint{0, 0, 0}));
    EXPECT_EQ(points.back(), (ToolpathPoint{2'000'000, 0, 0}));
    return points.size() > 2;
  }

  StreamBed room;
  std::optional<v1::ToolpathHeader> header;  // of the last Blocks()
};

// job.proto, ToolpathHeader.
TEST_F(ProductStreamsTest, AHeaderComesBeforeTheBlocks) {
  const std::string frames = Frames({BlockWithBend(500'000)});
  const std::int64_t job = room.Ended("toolpath", frames, WithTolerance(0.1));
  EXPECT_EQ(Blocks(job, 0).size(), 1U);
  EXPECT_EQ(header->level(), 0);
  EXPECT_EQ(header->level_max(), 5);
  EXPECT_DOUBLE_EQ(header->tolerance_mm(), 0.1);
  EXPECT_EQ(header->bytes(), static_cast<std::int64_t>(frames.size()));
  EXPECT_EQ(Blocks(job, 2).size(), 1U);
  EXPECT_EQ(header->level(), 2);
  EXPECT_DOUBLE_EQ(header->tolerance_mm(), 6.4);
}

TEST_F(ProductStreamsTest, AtLevelZeroTheBlocksAreTheStoredOnes) {
  // Whatever they hold: nobody looks into them.
  const std::vector<std::string> blocks{BlockWithBend(1), "any bytes", std::string("\0", 1)};
  EXPECT_EQ(Blocks(room.Ended("toolpath", Frames(blocks)), 0), blocks);
  EXPECT_TRUE(Blocks(room.Ended("toolpath", ""), 0).empty());
}

TEST_F(ProductStreamsTest, LevelsOutOfRangeAreRefused) {
  const std::int64_t job = room.Ended("toolpath", Frames({BlockWithBend(1)}));
  for (const int level : {-1, 6}) {
    auto stream = room.Toolpath(JobName(job), level);
    stream.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT,
                         "level is " + std::to_string(level) + ", allowed are 0 to 5");
  }
  EXPECT_EQ(Blocks(job, 5).size(), 1U);
}

// Level n keeps within 8^n times the tolerance of the path; the stored polyline took one of them.
TEST_F(ProductStreamsTest, EachLevelHasEightTimesTheToleranceOfTheOneBefore) {
  EXPECT_FALSE(BendIsLeft(0.0, 1, 69));  // 0.08 mm less 0.01 mm, where none is asked for
  EXPECT_TRUE(BendIsLeft(0.0, 1, 81));
  EXPECT_FALSE(BendIsLeft(0.0, 2, 629));  // 0.64 mm
  EXPECT_TRUE(BendIsLeft(0.0, 2, 641));
  EXPECT_FALSE(BendIsLeft(0.1, 1, 690));  // 0.8 mm less 0.1 mm
  EXPECT_TRUE(BendIsLeft(0.1, 1, 801));
}

// Where it is asked for the header tells of each level what its own stream would hold.
TEST_F(ProductStreamsTest, TheHeaderTellsHowLargeEachLevelIs) {
  const std::int64_t job = room.Ended(
      "toolpath", Frames({BlockWithBend(20), BlockWithBend(5'000), BlockWithBend(500'000)}));
  auto stream = room.Toolpath(JobName(job), 2, true);
  const v1::ToolpathHeader told = stream.Rest().at(0).header();
  ASSERT_EQ(told.levels_size(), 6);
  double tolerance_mm = 0.01;
  for (int level = 0; level < 6; ++level, tolerance_mm *= 8.0) {
    EXPECT_EQ(told.levels(level).level(), level);
    EXPECT_NEAR(told.levels(level).tolerance_mm(), tolerance_mm, 1e-9);
    Blocks(job, level);
    EXPECT_EQ(told.levels(level).bytes(), header->bytes()) << level;
    EXPECT_TRUE(header->levels().empty());
  }
  EXPECT_GT(told.levels(0).bytes(), told.levels(5).bytes());
}

// Also where all of it is asked for, which comes as it is stored.
TEST_F(ProductStreamsTest, TheFinestLevelComesWithTheSizesOfAll) {
  const std::vector<std::string> blocks{BlockWithBend(20), BlockWithBend(500'000)};
  const std::string frames = Frames(blocks);
  auto stream = room.Toolpath(JobName(room.Ended("toolpath", frames)), 0, true);
  const v1::ToolpathHeader told = stream.Next().header();
  EXPECT_EQ(told.level(), 0);
  EXPECT_EQ(told.bytes(), static_cast<std::int64_t>(frames.size()));
  ASSERT_EQ(told.levels_size(), 6);
  EXPECT_EQ(told.levels(0).bytes(), told.bytes());
  EXPECT_LT(told.levels(5).bytes(), told.bytes());
  for (const std::string& block : blocks) EXPECT_EQ(stream.Next().block(), block);
  stream.ExpectGoodEnd();
}

// The toolpath that is stored has a tolerance of 0.001 to 10 mm, whatever is asked for.
TEST_F(ProductStreamsTest, LevelsCountFromTheToleranceThatTheStoredOneHas) {
  EXPECT_TRUE(BendIsLeft(100.0, 1, 81'000));
  EXPECT_FALSE(BendIsLeft(100.0, 1, 69'000));
  EXPECT_FALSE(BendIsLeft(0.0001, 1, 6));
}

TEST_F(ProductStreamsTest, ACoarserToolpathEndsWhereTheStoredOneCannotBeRead) {
  const std::string good = BlockWithBend(500'000);
  const std::string frames = Frames({good, "no block", good});
  EXPECT_EQ(Blocks(room.Ended("toolpath", frames), 1).size(), 1U);
  // Cut off in the second frame, at any level.
  const std::string cut = Frames({good}) + Frames({good}).substr(0, 9);
  const std::int64_t job = room.Ended("toolpath", cut);
  EXPECT_EQ(Blocks(job, 0), std::vector{good});
  EXPECT_EQ(Blocks(job, 1).size(), 1U);
}

TEST_F(ProductStreamsTest, AJobWithoutTheProductSaysWhy) {
  const std::int64_t bare = room.Ended("report", "r");
  for (const int level : {0, 1}) {
    auto stream = room.Toolpath(JobName(bare), level);
    stream.ExpectRefused(grpc::StatusCode::NOT_FOUND, "has no toolpath");
  }
  auto trace = room.Trace(JobName(bare));
  trace.ExpectRefused(grpc::StatusCode::NOT_FOUND, "has no trace");
  const std::int64_t queued = room.Submit();
  auto early = room.Toolpath(JobName(queued), 0);
  early.ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "has not ended");
  auto unknown = room.Toolpath("jobs/99", 0);
  unknown.ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9004");
  auto misnamed = room.Trace("jobs/x");
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

TEST_F(ProductStreamsTest, ATraceComesInOrderByManyRecordsAMessage) {
  constexpr int kRecords = 1203;
  std::string frames;
  for (int i = 1; i <= kRecords; ++i) {
    v1::TraceRecord record;
    record.set_number(i);
    bridge::AddFrame(record.SerializeAsString(), frames);
  }
  auto stream = room.Trace(JobName(room.Ended("trace", frames)));
  const std::vector<v1::StreamJobTraceResponse> messages = stream.Rest();
  stream.ExpectGoodEnd();
  ASSERT_EQ(messages.size(), 3U);  // a trace may be larger than a message
  EXPECT_EQ(messages[0].records_size(), 500);
  EXPECT_EQ(messages[1].records_size(), 500);
  int last = 0;
  for (const v1::StreamJobTraceResponse& message : messages) {
    for (const v1::TraceRecord& record : message.records()) EXPECT_EQ(record.number(), ++last);
  }
  EXPECT_EQ(last, kRecords);
}

// StreamJobArtifactResponse.chunk: all bytes in order, in parts that a message has room for (4
// MiB).
TEST_F(ProductStreamsTest, AnArtifactComesInPartsAsItIsKept) {
  constexpr std::size_t kMessageBytesMax = 4 << 20;
  std::string bytes;
  for (int i = 0; bytes.size() < 2 * kMessageBytesMax; ++i) bytes += std::to_string(i);
  for (const std::string& kept : {bytes, bytes.substr(0, 1 << 20), std::string("\0x", 2)}) {
    auto stream = room.Artifact(JobName(room.Ended("left.stl", kept)), "left.stl");
    std::string together;
    for (const v1::StreamJobArtifactResponse& message : stream.Rest()) {
      EXPECT_FALSE(message.chunk().empty());
      EXPECT_LT(message.chunk().size(), kMessageBytesMax);
      together += message.chunk();
    }
    stream.ExpectGoodEnd();
    EXPECT_EQ(together, kept);
  }
  auto empty = room.Artifact(JobName(room.Ended("toolpath", "")), "toolpath");
  EXPECT_TRUE(empty.Rest().empty());
  empty.ExpectGoodEnd();
}

TEST_F(ProductStreamsTest, AnArtifactThatIsNotThereSaysWhy) {
  const std::int64_t job = room.Ended("report", "r");
  auto other = room.Artifact(JobName(job), "relief.png");
  other.ExpectRefused(grpc::StatusCode::NOT_FOUND, "has no relief.png");
  auto nameless = room.Artifact(JobName(job), "");
  nameless.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "artifact is missing");
  auto early = room.Artifact(JobName(room.Submit()), "report");
  early.ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "has not ended");
  auto misnamed = room.Artifact("jobs/x", "report");
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

TEST_F(ProductStreamsTest, AServerThatStopsEndsThem) {
  const std::int64_t job = room.Ended("toolpath", Frames({BlockWithBend(1)}));
  room.open.StopAll();
  auto stream = room.Toolpath(JobName(job), 0);
  stream.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the server stops");
}

}  // namespace
}  // namespace rmlcell::server
