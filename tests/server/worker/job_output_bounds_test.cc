// How what a job puts out goes to the server, and until when it stays in its budgets, to the byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <time.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "proto/bridge/framing.h"
#include "server/worker/job_lease.h"
#include "server/worker/job_output.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kKibibyte = 1'024;
constexpr std::size_t kFrameHead = 4;  // conventions: a frame is its length and its bytes

class JobOutputBounds : public JobRunnerTest {
 protected:
  void Join() { line_ = Joined(); }
  // What was sent until now.
  void Hear() {
    line_->Close();
    while (!line_->gone()) line_->Receive(std::chrono::seconds(60));
    heard_ = server.requests();
  }
  // Of those that came by themselves.
  std::vector<std::size_t> Chunks(const std::string& name) {
    std::vector<std::size_t> sizes;
    for (const v1::WorkRequest& message : heard_) {
      if (message.artifact().name() == name) sizes.push_back(message.artifact().chunk().size());
    }
    return sizes;
  }
  std::vector<const v1::WorkerToolpath*> Toolpaths() {
    std::vector<const v1::WorkerToolpath*> all;
    for (const v1::WorkRequest& message : heard_) {
      if (message.has_toolpath()) all.push_back(&message.toolpath());
    }
    return all;
  }
  static std::vector<std::string> NamesIn(const v1::WorkerFinish& finish) {
    std::vector<std::string> names;
    for (const v1::WorkerArtifact& artifact : finish.artifacts()) names.push_back(artifact.name());
    return names;
  }
  const v1::WorkerLease lease_ = Lease();
};

// Small products go with the end: of 32 KiB each, 128 KiB together.
TEST_F(JobOutputBounds, SmallProductsGoWithTheEnd) {
  Join();
  JobOutput output(*line_, lease_, 1'000'000);
  output.Send("large", "a/b", std::string(32 * kKibibyte + 1, 'l'));
  for (const char* name : {"one", "two", "three"})
    output.Send(name, "a/b", std::string(32 * kKibibyte, 's'));
  output.Send("more", "a/b", std::string(32 * kKibibyte - 10, 'm'));
  output.Send("no room", "c/d", std::string(11, 'n'));
  output.Send("last", "e/f", std::string(10, 'x'));
  output.Send("empty", "g/h", "");
  v1::WorkerFinish finish;
  output.MoveSmallTo(finish);
  Hear();
  EXPECT_THAT(NamesIn(finish), ElementsAre("one", "two", "three", "more", "last", "empty"));
  EXPECT_EQ(finish.artifacts(4).chunk(), std::string(10, 'x'));
  EXPECT_EQ(finish.artifacts(4).media_type(), "e/f");
  EXPECT_THAT(Chunks("large"), ElementsAre(32 * kKibibyte + 1));
  EXPECT_THAT(Chunks("no room"), ElementsAre(11));
}

// In messages of 128 KiB, and none that is empty.
TEST_F(JobOutputBounds, LargeProductsComeInParts) {
  Join();
  JobOutput output(*line_, lease_, 1'000'000);
  output.Send("even", "a/b", std::string(256 * kKibibyte, 'e'));
  output.Send("odd", "a/b", std::string(128 * kKibibyte + 1, 'o'));
  Hear();
  EXPECT_THAT(Chunks("even"), ElementsAre(128 * kKibibyte, 128 * kKibibyte));
  EXPECT_THAT(Chunks("odd"), ElementsAre(128 * kKibibyte, 1));
}

// Trace, toolpath, events and whatever else: all of it counts, and all of it may be used.
TEST_F(JobOutputBounds, TheBudgetIsUsedToTheLastByte) {
  Join();
  JobOutput output(*line_, lease_, 1'000);
  EXPECT_TRUE(output.Fits(1'000));
  EXPECT_FALSE(output.Fits(1'001));
  output.CountEvents(300);
  EXPECT_TRUE(output.Fits(700));
  EXPECT_FALSE(output.Fits(701));
  EXPECT_TRUE(output.AddTrace(std::string(200 - kFrameHead, 't')));
  EXPECT_TRUE(output.Fits(500));
  EXPECT_FALSE(output.Fits(501));
  EXPECT_TRUE(output.AddToolpath(std::string(499 - kFrameHead, 'p')));
  EXPECT_TRUE(output.Fits(1));
  EXPECT_FALSE(output.Fits(2));
  output.CountEvents(1);
  EXPECT_TRUE(output.Fits());
  EXPECT_FALSE(output.AddTrace("t"));
  EXPECT_FALSE(output.Fits());
}

// Eight parts at once; then orders are looked at, and the rest comes next time.
TEST_F(JobOutputBounds, EightPartsOfAToolpathAreSentAtOnce) {
  Join();
  JobOutput output(*line_, lease_, std::int64_t{1} << 30);
  std::string expected;
  const std::string first(1'024 * kKibibyte - kFrameHead, 'f');
  bridge::AddFrame(first, expected);
  output.AddToolpath(first);
  EXPECT_TRUE(output.SendNewToolpath("open"));   // just eight
  EXPECT_TRUE(output.SendNewToolpath("open"));   // nothing is new
  EXPECT_TRUE(output.SendNewToolpath("other"));  // the open block alone
  const std::string second(1'024 * kKibibyte, 's');
  bridge::AddFrame(second, expected);
  output.AddToolpath(second);
  EXPECT_FALSE(output.SendNewToolpath("last"));
  EXPECT_TRUE(output.SendNewToolpath("last"));
  Hear();
  const auto sent = Toolpaths();
  ASSERT_EQ(sent.size(), 8U + 1U + 8U + 1U);
  std::string frames;
  for (const v1::WorkerToolpath* one : sent) frames += one->frames();
  EXPECT_TRUE(frames == expected);
  EXPECT_EQ(sent[6]->open_block(), "");
  EXPECT_EQ(sent[7]->open_block(), "open");
  EXPECT_EQ(sent[8]->open_block(), "other");
  EXPECT_THAT(sent[8]->frames(), IsEmpty());
  EXPECT_EQ(sent[16]->open_block(), "");
  EXPECT_EQ(sent[17]->frames().size(), kFrameHead);
  EXPECT_EQ(sent[17]->open_block(), "last");
}

// The budget of processor time may be used up; it counts from when the job came.
TEST_F(JobOutputBounds, ProcessorTimeMayBeUsedUp) {
  Join();
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  assignment.mutable_budget()->set_processor_ns(2'500'000'000);
  double time_s = 10.0;
  const JobLease lease(*line_, assignment, stopping, [&time_s] { return time_s; });
  EXPECT_FALSE(lease.over_time());
  time_s = 12.5;
  EXPECT_FALSE(lease.over_time());
  time_s = 12.515625;
  EXPECT_TRUE(lease.over_time());
}

// job_lease.h: what is of another lease, be it of another attempt or of another job, changes
// nothing.
TEST_F(JobOutputBounds, WhatIsOfAnotherLeaseChangesNothing) {
  using Control = v1::WorkerControl;
  Join();
  const v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  JobLease lease(*line_, assignment, stopping, [] { return 0.0; });
  for (const auto kind :
       {Control::KIND_STOP, Control::KIND_FOLLOW_TOOLPATH, Control::KIND_FOLLOW_HEIGHTS}) {
    lease.Take(Order(kind, 4));
    v1::WorkResponse of_another_job = Order(kind);
    of_another_job.mutable_control()->mutable_lease()->set_job(8);
    lease.Take(of_another_job);
  }
  lease.Take(Release(4));
  EXPECT_FALSE(lease.has_orders());
  EXPECT_FALSE(lease.toolpath_followed());
  EXPECT_FALSE(lease.heights_followed());
  EXPECT_FALSE(lease.lost());
  lease.Take(Order(Control::KIND_FOLLOW_TOOLPATH));
  EXPECT_TRUE(lease.toolpath_followed());
  EXPECT_FALSE(lease.heights_followed());
  lease.Take(Order(Control::KIND_FOLLOW_HEIGHTS));
  EXPECT_TRUE(lease.heights_followed());
  EXPECT_FALSE(lease.has_orders());  // they wait for nobody
  lease.Take(Order(Control::KIND_STOP));
  ASSERT_TRUE(lease.has_orders());
  EXPECT_EQ(lease.TakeOrders().front().kind(), Control::KIND_STOP);
  EXPECT_FALSE(lease.has_orders());
  lease.Take(Release());
  EXPECT_TRUE(lease.lost());
}

// A program of many parts comes through, however slowly it is taken off.
TEST_F(JobOutputBounds, AProgramOfManyPartsComesThrough) {
  Join();
  constexpr int kParts = 40;
  std::thread sender([this] {
    for (int part = 0; part < kParts; ++part) {
      v1::WorkResponse message;
      message.mutable_blob()->set_slot(part);
      message.mutable_blob()->set_chunk(std::string(100 * kKibibyte, 'b'));
      server.Send(message);
    }
  });
  for (int part = 0; part < kParts; ++part) {
    const auto message = line_->Receive(std::chrono::seconds(60));
    ASSERT_TRUE(message) << part;
    EXPECT_EQ(message->blob().slot(), part);
    EXPECT_EQ(message->blob().chunk().size(), 100 * kKibibyte);
  }
  sender.join();
}

// Of any length: gRPC by itself takes 4 MiB.
TEST_F(JobOutputBounds, ALongMessageComesThrough) {
  Join();
  v1::WorkResponse message;
  message.mutable_blob()->set_chunk(std::string(5 * kKibibyte * kKibibyte, 'b'));
  server.Send(message);
  const auto heard = line_->Receive(std::chrono::seconds(60));
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->blob().chunk().size(), 5 * kKibibyte * kKibibyte);
}

// JobLease::Listen: what comes up to an order, however much is to come yet.
TEST_F(JobOutputBounds, OrdersAreTakenInOneByOne) {
  Join();
  const v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  JobLease lease(*line_, assignment, stopping, [] { return 0.0; });
  const auto kinds = {v1::WorkerControl::KIND_HOLD, v1::WorkerControl::KIND_RESUME};
  for (const auto kind : kinds) server.Send(Order(kind));
  for (const auto kind : kinds) {
    lease.Listen(std::chrono::minutes(1));
    const std::vector<v1::WorkerControl> taken = lease.TakeOrders();
    ASSERT_EQ(taken.size(), 1U);
    EXPECT_EQ(taken.front().kind(), kind);
  }
}

// Processor time is that of the thread that asks, in seconds.
TEST(ProcessorTimeOfAJob, IsThatOfItsThread) {
  const auto by_hand = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec * 1'000'000'000 + time.tv_nsec) / 1e9;
  };
  for (int time = 0; time < 3; ++time) {
    const double before = by_hand();
    const double told = ThreadProcessorTime_s();
    EXPECT_GE(told, before - 1e-9);
    EXPECT_LE(told, by_hand() + 1e-9);
  }
}

// A run without pace tells where it is as soon as it is somewhere, with the share of it that is
// done.
TEST_F(JobOutputBounds, ARunWithoutPaceTellsWhereItIs) {
  std::string source = "PA;PA;VS8;!MC1;";
  for (int i = 0; i < 20'000; ++i) source += "Z" + std::to_string(i % 2 * 1000) + ",0,-50;";
  int positions = 0;
  int shares = 0;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!IsPosition(message)) return;
    ++positions;
    EXPECT_GT(message.heartbeat().progress().virtual_time_ns(), 0);
    shares += message.heartbeat().progress().has_progress() ? 1 : 0;
  };
  const auto begun = std::chrono::steady_clock::now();
  Work(Assignment(v1::JOB_KIND_SIMULATE, source, "rml1"));
  const auto took = std::chrono::steady_clock::now() - begun;
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(shares, positions);
  EXPECT_LE(positions, took / std::chrono::milliseconds(50) + 2) << "20 a second at most";
}

// One that is told to go as the machine would tells where it is at once, and what part of it is
// done when it is known how long it takes. It lasts for minutes: the cancel comes before its end,
// however late that is.
TEST_F(JobOutputBounds, ARunWithThePaceOfItsMachineTellsWhatIsKnown) {
  std::vector<v1::JobProgress> positions;
  server.heard = [&](const v1::WorkRequest& message) {
    if (!IsPosition(message)) return;
    positions.push_back(message.heartbeat().progress());
    if (positions.size() < 3 || positions.back().planned_time_ns() == 0) return;
    server.Send(Order(v1::WorkerControl::KIND_CANCEL));
  };
  std::string source = "PA;PA;VS8;!MC1;";
  for (int i = 0; i < 1'000; ++i) source += "PU1000,0;PU0,0;";
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, source, "rml1");
  assignment.mutable_job()->mutable_simulation()->set_pace(1.0);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
  ASSERT_FALSE(positions.empty());
  EXPECT_EQ(positions.front().virtual_time_ns(), 0);
  for (const v1::JobProgress& one : positions)
    EXPECT_EQ(one.has_progress(), one.planned_time_ns() > 0);
}

}  // namespace
}  // namespace rmlcell::server
