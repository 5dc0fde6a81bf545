// The recording of a host, fetched part by part.
#include "server/machines/recordings.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

class RecordingsTest : public HostsTest {
 protected:
  void SetUp() override {
    link_ = Joined();
    Tell(*link_, v1::MACHINE_STATE_IDLE);
    FetchRecording(hosts, "mill-1", "jobs/7", [this](Result<std::string> fetched) {
      const std::lock_guard lock(mutex_);
      EXPECT_FALSE(fetched_);
      fetched_ = std::move(fetched);
    });
  }
  // The offset that the newest order asks for; it is answered.
  std::int64_t Answer(const std::string& chunk, std::int64_t total) {
    v1::HostRequest request;
    v1::HostRecordingPart& part = *request.mutable_answer()->mutable_recording();
    part.set_chunk(chunk);
    part.set_total(total);
    return Send(std::move(request));
  }
  std::int64_t Send(v1::HostRequest request) {
    std::optional<v1::HostResponse> asked;
    EXPECT_TRUE(Eventually([&] {
      asked = link_->Newest(v1::HostResponse::kOrder);
      return asked && asked->order().number() > answered_;
    }));
    const v1::HostOrder& order = asked->order();
    EXPECT_EQ(order.recording().job(), "jobs/7");
    answered_ = order.number();
    request.mutable_answer()->set_number(order.number());
    hosts.Receive(*link_, std::move(request));
    return order.recording().offset();
  }
  Result<std::string> Fetched() {
    EXPECT_TRUE(Eventually([&] {
      const std::lock_guard lock(mutex_);
      return fetched_.has_value();
    }));
    const std::lock_guard lock(mutex_);
    return *fetched_;
  }

  std::shared_ptr<FakeLink> link_;
  std::int64_t answered_ = 0;
  std::mutex mutex_;
  std::optional<Result<std::string>> fetched_;
};

// As much as there was at first: it has grown meanwhile, perhaps by half an entry.
TEST_F(RecordingsTest, EachPartFollowsTheOneBefore) {
  EXPECT_EQ(Answer("abc", 7), 0);
  EXPECT_EQ(Answer("def", 9), 3);
  EXPECT_EQ(Answer("ghi", 9), 6);
  EXPECT_EQ(Must(Fetched()), "abcdefg");
}

TEST_F(RecordingsTest, EndsWithTheLastByte) {
  EXPECT_EQ(Answer("abc", 6), 0);
  EXPECT_EQ(Answer("def", 6), 3);
  EXPECT_EQ(Must(Fetched()), "abcdef");
}

// A host that has no more than it said: what there is.
TEST_F(RecordingsTest, EndsWhereNothingComes) {
  EXPECT_EQ(Answer("abc", 6), 0);
  EXPECT_EQ(Answer("", 6), 3);
  EXPECT_EQ(Must(Fetched()), "abc");
}

TEST_F(RecordingsTest, WhatTheHostHasNotIsNotFound) {
  v1::HostRequest request;
  request.mutable_answer()->mutable_refusal()->set_code(CodeText(ErrorCode::kCellNotFound));
  request.mutable_answer()->mutable_refusal()->set_message("none of jobs/7");
  Send(std::move(request));
  EXPECT_EQ(CodeOf(Fetched()), ErrorCode::kCellNotFound);
  EXPECT_EQ(Fetched().error().detail, "none of jobs/7");
}

TEST_F(RecordingsTest, AnyOtherRefusalIsOneOfNow) {
  v1::HostRequest request;
  request.mutable_answer()->mutable_refusal()->set_code(CodeText(ErrorCode::kCellMachineState));
  Send(std::move(request));
  EXPECT_EQ(CodeOf(Fetched()), ErrorCode::kCellNotLive);
}

// A machine that no host has is asked for nothing.
TEST_F(RecordingsTest, WithoutAHostNothingIsFetched) {
  std::optional<Result<std::string>> fetched;
  FetchRecording(hosts, "optimo-1", "jobs/8", [&](Result<std::string> one) { fetched = one; });
  ASSERT_TRUE(fetched);
  EXPECT_EQ(CodeOf(*fetched), ErrorCode::kCellNotLive);
}

}  // namespace
}  // namespace rmlcell::server
