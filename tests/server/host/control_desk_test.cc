// Who has control of a machine: live.md, section 4.
#include "server/host/control_desk.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>
#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;
using google::protobuf::util::TimeUtil;
using testing::HasSubstr;

class ControlDeskTest : public testing::Test {
 protected:
  HostTime At(std::chrono::milliseconds time) const {
    return {.steady = time, .wall = WallTime(std::chrono::hours(24) + time)};
  }
  static v1::AcquireControlRequest Asked(std::string client = "a client") {
    v1::AcquireControlRequest request;
    request.set_machine("machines/mill-1");
    request.set_client(std::move(client));
    return request;
  }
  static v1::AcquireControlRequest TakingOver(std::string reason) {
    v1::AcquireControlRequest request = Asked("another");
    request.set_take_over(true);
    request.set_reason(std::move(reason));
    return request;
  }
  std::string Acquire(const std::string& caller = "anna") {
    const auto acquired = desk.Acquire(Asked(), caller, At(0ms));
    EXPECT_TRUE(acquired);
    return acquired ? acquired->control_token() : "";
  }
  static ErrorCode CodeOf(const Status& status) {
    return status ? ErrorCode::kCellInternal : status.error().code;
  }

  int made = 0;
  ControlDesk desk{[this] { return "token " + std::to_string(++made); }};
};

// LIVE-4.01: a token that proves it, 5 s where nothing is said; another client is told who has it.
TEST_F(ControlDeskTest, OneHasItAndOthersAreToldWho) {
  const auto acquired = desk.Acquire(Asked("console"), "anna", At(0ms));
  ASSERT_TRUE(acquired);
  EXPECT_EQ(acquired->lease().number(), 1);
  EXPECT_EQ(acquired->lease().holder(), "anna");
  EXPECT_EQ(acquired->lease().on_loss(), v1::ControlLease::ON_LOSS_HOLD);
  EXPECT_EQ(TimeUtil::TimestampToMilliseconds(acquired->lease().expire_time()) -
                TimeUtil::TimestampToMilliseconds(acquired->lease().since()),
            5'000);
  EXPECT_TRUE(desk.Check(acquired->control_token(), At(4'999ms)));
  EXPECT_EQ(CodeOf(desk.Check("", At(1ms))), ErrorCode::kCellControlNeeded);
  EXPECT_EQ(CodeOf(desk.Check("guessed", At(1ms))), ErrorCode::kCellControlNeeded);
  const auto refused = desk.Acquire(Asked(), "bert", At(1ms));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellLeaseHeld);
  EXPECT_THAT(refused.error().detail, HasSubstr("anna (console) has it since"));
}

// LIVE-4.01: 1 to 60 s.
TEST_F(ControlDeskTest, TheTimeHasBounds) {
  for (const auto& [ms, good] :
       {std::pair{999, false}, {1'000, true}, {60'000, true}, {60'001, false}}) {
    ControlDesk fresh{[] { return "t"; }};
    v1::AcquireControlRequest request = Asked();
    *request.mutable_ttl() = TimeUtil::MillisecondsToDuration(ms);
    EXPECT_EQ(bool(fresh.Acquire(request, "anna", At(0ms))), good) << ms;
  }
  v1::AcquireControlRequest request = Asked(std::string(101, 'x'));
  EXPECT_FALSE(desk.Acquire(request, "anna", At(0ms)));
  request.set_client(std::string(100, 'x'));
  EXPECT_TRUE(desk.Acquire(request, "anna", At(0ms)));
}

// LIVE-4.01: what is far beyond these is no time either, though its nanoseconds, as many as a
// number has room for, would be between 1 and 2 s.
TEST_F(ControlDeskTest, ATimeThatIsFarBeyondIsRefused) {
  for (const std::int64_t seconds : {18'446'744'075, -18'446'744'072}) {
    v1::AcquireControlRequest request = Asked();
    request.mutable_ttl()->set_seconds(seconds);
    const auto refused = desk.Acquire(request, "anna", At(0ms));
    ASSERT_FALSE(refused) << seconds;
    EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(refused.error().detail, "ttl: allowed are 1 s to 60 s");
  }
}

// LIVE-4.03: all can read who has it now, who had it before, and by which lease; why, where it was
// taken over.
TEST_F(ControlDeskTest, EachChangeOfHandsIsToldOnce) {
  const auto told = [this](v1::ControlChanged::Kind kind, const std::string& from,
                           const std::string& to, std::int64_t lease) {
    const auto change = desk.TakeChange();
    ASSERT_TRUE(change);
    EXPECT_EQ(change->kind(), kind);
    EXPECT_EQ(change->from(), from);
    EXPECT_EQ(change->to(), to);
    EXPECT_EQ(change->lease(), lease);
    EXPECT_EQ(change->reason(), "");
    EXPECT_FALSE(desk.TakeChange());
  };
  v1::AcquireControlRequest given = Asked();
  given.set_reason("nobody had it");
  const auto first = desk.Acquire(given, "anna", At(0ms));
  ASSERT_TRUE(first);
  told(v1::ControlChanged::KIND_ACQUIRED, "", "anna", 1);
  ASSERT_TRUE(desk.Release(first->control_token(), At(1ms)));
  told(v1::ControlChanged::KIND_RELEASED, "anna", "", 0);
  Acquire("bert");
  told(v1::ControlChanged::KIND_ACQUIRED, "", "bert", 2);
  ASSERT_TRUE(desk.Expire(At(5'000ms)));
  told(v1::ControlChanged::KIND_EXPIRED, "bert", "", 0);
  desk.GiveToQueue("jobs/17", v1::ControlLease::ON_LOSS_HOLD, At(5'000ms));
  told(v1::ControlChanged::KIND_ACQUIRED, "", "queue/jobs/17", 3);
  desk.RunIsOver();
  told(v1::ControlChanged::KIND_RELEASED, "queue/jobs/17", "", 0);
}

// LIVE-4.02: renewed from now on; over by the steady clock, and never revived.
TEST_F(ControlDeskTest, OneThatIsOverIsNotRevived) {
  const std::string token = Acquire();
  EXPECT_TRUE(desk.Renew(token, At(4'000ms)));
  EXPECT_FALSE(desk.Expire(At(8'999ms)));
  EXPECT_EQ(CodeOf(desk.Check(token, At(9'000ms))), ErrorCode::kCellControlNeeded);
  EXPECT_FALSE(desk.Renew(token, At(9'000ms)));
  const auto on_loss = desk.Expire(At(9'000ms));
  ASSERT_TRUE(on_loss);
  EXPECT_EQ(*on_loss, v1::ControlLease::ON_LOSS_HOLD);
  EXPECT_FALSE(desk.lease());
  EXPECT_FALSE(desk.Expire(At(10'000ms)));
  EXPECT_FALSE(desk.Renew(token, At(9'001ms)));
  const std::string next = Acquire("bert");
  EXPECT_FALSE(desk.Check(token, At(1ms)));
  EXPECT_TRUE(desk.Release(next, At(1ms)));
  EXPECT_FALSE(desk.Release(next, At(2ms)));
}

// LIVE-4.03: with a reason that all can read; the old holder is told who has it.
TEST_F(ControlDeskTest, IsTakenOverWithAReason) {
  const std::string token = Acquire();
  static_cast<void>(desk.TakeChange());
  for (const std::string& reason : {std::string(), std::string(201, 'r')})
    EXPECT_FALSE(desk.Acquire(TakingOver(reason), "bert", At(1ms)));
  EXPECT_TRUE(desk.Check(token, At(1ms)));
  const auto taken = desk.Acquire(TakingOver("shift change"), "bert", At(1ms));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->lease().number(), 2);
  const Status old = desk.Check(token, At(2ms));
  ASSERT_FALSE(old);
  EXPECT_THAT(old.error().detail, HasSubstr("bert has control"));
  const auto change = desk.TakeChange();
  ASSERT_TRUE(change);
  EXPECT_EQ(change->kind(), v1::ControlChanged::KIND_TAKEN_OVER);
  EXPECT_EQ(change->from(), "anna");
  EXPECT_EQ(change->to(), "bert");
  EXPECT_EQ(change->reason(), "shift change");
  EXPECT_FALSE(desk.TakeChange());
}

// A reason has 1 to 200 characters.
TEST_F(ControlDeskTest, AReasonHasBounds) {
  for (const std::size_t length : {std::size_t{1}, std::size_t{200}}) {
    Acquire();
    EXPECT_TRUE(desk.Acquire(TakingOver(std::string(length, 'r')), "bert", At(1ms))) << length;
    EXPECT_TRUE(desk.Expire(At(5'001ms)));
  }
}

// LIVE-4.02: of a lease that is over nobody has control, and of none nobody either.
TEST_F(ControlDeskTest, NobodyIsNamedWhoHasItNoMore) {
  EXPECT_EQ(desk.Check("", At(0ms)).error().detail, "no control token");
  const std::string token = Acquire();
  EXPECT_EQ(desk.Check("", At(4'999ms)).error().detail, "no control token: anna has control");
  EXPECT_EQ(desk.Check(token, At(5'000ms)).error().detail, "the control token is over");
}

// LIVE-4.05: the queue has control for as long as its run is open, however long that is.
TEST_F(ControlDeskTest, TheLeaseOfTheQueueDoesNotRunOut) {
  desk.GiveToQueue("jobs/17", v1::ControlLease::ON_LOSS_HOLD, At(0ms));
  EXPECT_FALSE(desk.runs_out());
  EXPECT_FALSE(desk.Expire(At(3'600'000ms)));
  EXPECT_EQ(desk.Check("guessed", At(3'600'000ms)).error().detail,
            "the control token is over: queue/jobs/17 has control");
  desk.RunIsOver();
  EXPECT_FALSE(desk.lease());
}

// LIVE-4.02: what is wanted of a run stands in the lease of a person, as long as he has it; that of
// the queue is for its run as it is.
TEST_F(ControlDeskTest, WhatARunWantsStandsInTheLeaseOfAPerson) {
  desk.RunBegins(v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_FALSE(desk.lease());
  desk.GiveToQueue("jobs/17", v1::ControlLease::ON_LOSS_HOLD, At(0ms));
  EXPECT_TRUE(desk.IsOfQueue());
  desk.RunBegins(v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_EQ(desk.lease()->on_loss(), v1::ControlLease::ON_LOSS_HOLD);
  desk.RunIsOver();
  EXPECT_FALSE(desk.IsOfQueue());
  const std::string token = Acquire();
  desk.RunBegins(v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_EQ(desk.lease()->on_loss(), v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_EQ(*desk.Release(token, At(1ms)), v1::ControlLease::ON_LOSS_GO_ON);
  desk.RunIsOver();
  EXPECT_FALSE(desk.lease());
}

// LIVE-4.03: whoever takes it over during a run has it as he took it, behind that run as well.
TEST_F(ControlDeskTest, BehindARunItIsAsItWasTaken) {
  v1::AcquireControlRequest first = Asked();
  first.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_TRUE(desk.Acquire(first, "anna", At(0ms)));
  desk.RunBegins(v1::ControlLease::ON_LOSS_HOLD);
  v1::AcquireControlRequest second = TakingOver("shift change");
  second.set_on_loss(v1::ControlLease::ON_LOSS_HOLD);
  ASSERT_TRUE(desk.Acquire(second, "bert", At(1ms)));
  desk.RunIsOver();
  EXPECT_EQ(desk.lease()->holder(), "bert");
  EXPECT_EQ(desk.lease()->on_loss(), v1::ControlLease::ON_LOSS_HOLD);
}

}  // namespace
}  // namespace rmlcell::server
