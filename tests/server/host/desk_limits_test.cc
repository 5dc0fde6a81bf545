// The ends of what a host waits for, keeps and takes.
#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/host/answered_requests.h"
#include "server/host/arm_desk.h"
#include "server/host/control_desk.h"
#include "server/host/key_desk.h"
#include "server/host/parked_orders.h"
#include "server/host/start_desk.h"
#include "server/host/unstored_entries.h"
#include "tests/server/host/parked_order.h"

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;
using google::protobuf::util::TimeUtil;
using testing::ElementsAre;
using testing::IsEmpty;

HostTime DeskTime(std::chrono::nanoseconds time) {
  const auto wall = std::chrono::duration_cast<std::chrono::microseconds>(time);
  return {.steady = time, .wall = WallTime(std::chrono::hours(24) + wall)};
}

v1::ArmMachineRequest ToArm(const std::string& job = {}) {
  v1::ArmMachineRequest request;
  request.set_job(job);
  for (const auto one : {v1::CONFIRMATION_TOOL, v1::CONFIRMATION_ORIGIN_VALID,
                         v1::CONFIRMATION_CLAMPS, v1::CONFIRMATION_COVER})
    request.add_confirmations(one);
  return request;
}

// DEV-1.41: 120 s where nothing is said; 1 to 600 s.
TEST(DeskLimits, OfAnArming) {
  for (const auto& [ms, good] :
       {std::pair{999, false}, {1'000, true}, {600'000, true}, {600'001, false}, {-1'000, false}}) {
    ArmDesk desk{[] { return "t"; }};
    v1::ArmMachineRequest request = ToArm();
    *request.mutable_armed_for() = TimeUtil::MillisecondsToDuration(ms);
    const auto armed = desk.Arm(request, "anna", 1, 2, DeskTime(0s));
    EXPECT_EQ(bool(armed), good) << ms;
    if (!armed) {
      EXPECT_EQ(armed.error().code, ErrorCode::kCellInvalidArgument);
      EXPECT_EQ(armed.error().detail, "armed_for: 1 s to 600 s");
    }
  }
  ArmDesk desk{[] { return "t"; }};
  ASSERT_TRUE(desk.Arm(ToArm(), "anna", 1, 2, DeskTime(0s)));
  desk.Expire(1, 2, DeskTime(120s - 1ns));
  EXPECT_TRUE(desk.is_armed());
  desk.Expire(1, 2, DeskTime(120s));
  EXPECT_FALSE(desk.is_armed());
}

// DEV-1.41: each of what a person must have seen to; then for one job, with one token.
TEST(DeskLimits, OfWhatAnArmingIsFor) {
  ArmDesk desk{[] { return "t"; }};
  for (int left_out = 0; left_out < 4; ++left_out) {
    v1::ArmMachineRequest request = ToArm();
    request.mutable_confirmations()->erase(request.confirmations().begin() + left_out);
    const auto armed = desk.Arm(request, "anna", 1, 2, DeskTime(0s));
    ASSERT_FALSE(armed) << left_out;
    EXPECT_EQ(armed.error().code, ErrorCode::kCellNotArmed);
  }
  EXPECT_EQ(desk.MayStart("jobs/1", {}).error().detail, "nobody has armed it, or that is over");
  v1::ArmMachineRequest request = ToArm("jobs/1");
  request.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  const auto armed = desk.Arm(request, "anna", 1, 2, DeskTime(0s));
  ASSERT_TRUE(armed);
  EXPECT_EQ(armed->arm_token(), "t");
  EXPECT_EQ(TimeUtil::TimestampToSeconds(armed->expire_time()), 24 * 3600 + 120);
  EXPECT_EQ(desk.on_loss(), v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_TRUE(desk.MayStart("jobs/1", {}));
  EXPECT_TRUE(desk.MayStart("jobs/1", "t"));
  EXPECT_EQ(desk.MayStart("jobs/1", "u").error().detail,
            "this is not the token that it was armed with");
  EXPECT_EQ(desk.MayStart("jobs/2", "t").error().detail,
            "it is armed for jobs/1 and not for jobs/2");
  v1::MachineStatus status;
  desk.AddTo(status);
  EXPECT_EQ(TimeUtil::TimestampToSeconds(status.armed_until()), 24 * 3600 + 120);
  EXPECT_EQ(status.armed_by(), "anna");
  EXPECT_EQ(status.armed_for(), "jobs/1");
  desk.Expire(2, 2, DeskTime(0s));  // another has control
  EXPECT_FALSE(desk.is_armed());
  EXPECT_EQ(desk.on_loss(), v1::ControlLease::ON_LOSS_UNSPECIFIED);
  ASSERT_TRUE(desk.Arm(ToArm(), "anna", 1, 2, DeskTime(0s)));
  EXPECT_TRUE(desk.MayStart("jobs/2", {}));  // whichever is next
  desk.Expire(1, 3, DeskTime(0s));           // the memory is another one
  EXPECT_FALSE(desk.is_armed());
}

// LIVE-4.03: 1 to 200 characters, however many bytes they have.
TEST(DeskLimits, OfTheReasonOfATakeOver) {
  const auto taken = [](std::size_t characters) {
    ControlDesk desk{[] { return "t"; }};
    v1::AcquireControlRequest request;
    EXPECT_TRUE(desk.Acquire(request, "anna", DeskTime(0s)));
    request.set_take_over(true);
    for (std::size_t i = 0; i < characters; ++i) *request.mutable_reason() += "\xC3\xA4";
    return bool(desk.Acquire(request, "bert", DeskTime(0s)));
  };
  EXPECT_FALSE(taken(0));
  EXPECT_TRUE(taken(1));
  EXPECT_TRUE(taken(200));
  EXPECT_FALSE(taken(201));
}

// LIVE-7.04: 64 answers are kept; then it is known that the key has acted, and no more.
TEST(DeskLimits, OfTheAnswersToKeys) {
  KeyDesk desk;
  for (std::int64_t number = 1; number <= 64; ++number) desk.Take(number, {});
  EXPECT_EQ(desk.Look(1, false), KeyDesk::Turn::kAnswered);
  desk.Take(65, {});
  EXPECT_EQ(desk.Look(1, false), KeyDesk::Turn::kTooLate);
  EXPECT_EQ(desk.Look(2, false), KeyDesk::Turn::kAnswered);
  EXPECT_EQ(desk.Look(65, false), KeyDesk::Turn::kAnswered);
  EXPECT_EQ(desk.Look(66, false), KeyDesk::Turn::kActs);
  desk.Release("X+", 70);
  EXPECT_TRUE(desk.IsReleased("X+", 69));
  EXPECT_FALSE(desk.IsReleased("X+", 70));
}

// LIVE-7.05: a beat that comes twice counts once.
TEST(DeskLimits, OfBeatsThatComeAgain) {
  DeadMan dead_man;
  dead_man.Press("X+", DeskTime(0s));
  EXPECT_TRUE(dead_man.Hear(1, {"X+"}, 0s, DeskTime(0s)));
  EXPECT_FALSE(dead_man.Hear(1, {"X+"}, 0s, DeskTime(0s)));
  EXPECT_TRUE(dead_man.Hear(2, {"X+"}, 0s, DeskTime(0s)));
}

// LIVE-7.05: what was known counts with a beat that comes 2 s later, and not behind that.
TEST(DeskLimits, OfWhatIsKnownOfALine) {
  const auto slow_after = [](std::chrono::nanoseconds time) {
    LineSpeed speed;
    for (int beat = 0; beat < 3; ++beat) speed.Hear(60ms, {}, DeskTime(1h));
    speed.Hear(60ms, {}, DeskTime(1h + time));
    return speed.WhySlow(DeskTime(1h + time)).has_value();
  };
  EXPECT_TRUE(slow_after(2s));
  EXPECT_FALSE(slow_after(2s + 1ns));
  LineSpeed speed;
  for (int beat = 0; beat < 3; ++beat) speed.Hear(41ms, {}, DeskTime(1h));
  EXPECT_EQ(*speed.WhySlow(DeskTime(1h)),
            "the line, or another clock: a heartbeat takes 41 ms to come, at most 40 ms; one that "
            "tells round_trip needs no clock");
  for (int beat = 0; beat < 3; ++beat) speed.Hear(41ms, 81ms, DeskTime(1h));
  EXPECT_EQ(*speed.WhySlow(DeskTime(1h)), "the line: 81 ms there and back, at most 80 ms");
}

StartDesk::Basis StandingBasis() {
  return {.state = "s", .named = {{"override", "100"}}, .programs = 1, .schedules = 2, .halts = 3};
}

// LIVE-6.08: for 120 s, of the newest one, as long as nothing is another.
TEST(DeskLimits, OfAPreview) {
  int tokens = 0;
  StartDesk desk{[&] { return "t" + std::to_string(++tokens); }};
  v1::StartAtStepRequest request;
  const auto why = [&](const StartDesk::Basis& basis, std::chrono::nanoseconds at) {
    const auto taken = desk.Take(request, basis, DeskTime(at));
    if (taken) return std::string("taken");
    EXPECT_EQ(taken.error().code, ErrorCode::kCellPreviewStale);
    return std::string(taken.error().detail);
  };
  EXPECT_EQ(why(StandingBasis(), 0s), "it is not the newest one");  // none was made
  EXPECT_EQ(desk.Keep({}, StandingBasis(), DeskTime(1s)), "t1");
  EXPECT_EQ(desk.Keep({}, StandingBasis(), DeskTime(1s)), "t2");
  request.set_preview_token("t1");
  EXPECT_EQ(why(StandingBasis(), 1s), "it is not the newest one");
  request.set_preview_token("t2");
  EXPECT_EQ(why(StandingBasis(), 121s - 1ns), "taken");
  EXPECT_EQ(why(StandingBasis(), 121s), "it is older than 120 s");
  StartDesk::Basis basis = StandingBasis();
  basis.programs = 2;
  EXPECT_EQ(why(basis, 1s), "programs were changed");
  basis = StandingBasis();
  basis.schedules = 3;
  EXPECT_EQ(why(basis, 1s), "laser schedules were changed");
  basis = StandingBasis();
  basis.halts = 4;
  EXPECT_EQ(desk.Take(request, basis, DeskTime(1s)).error().code, ErrorCode::kCellMachineState);
  basis = StandingBasis();
  basis.state = "other";
  EXPECT_EQ(why(basis, 1s), "the machine was changed");
  basis.named = {{"override", "90"}};
  EXPECT_EQ(why(basis, 1s), "the machine was changed: override 90 (was 100)");
  basis.named.clear();
  for (const char* name : {"a", "b", "c", "d"}) basis.named.push_back({name, "1"});
  const std::string four =
      "the machine was changed: a 1 (was none), b 1 (was none), "
      "c 1 (was none), d 1 (was none), ";
  EXPECT_EQ(why(basis, 1s), four + "override none (was 100)");
  basis.named.push_back({"e", "1"});  // five are named
  EXPECT_EQ(why(basis, 1s), four + "e 1 (was none), and more");
}

TEST(DeskLimits, OfWhatAStartAtAStepTakesAlong) {
  StartDesk desk{[] { return "t"; }};
  machine::StartAtStep start;
  start.halt_at_entry = true;
  desk.Keep(start, {}, DeskTime(0s));
  v1::StartAtStepRequest request;
  request.set_preview_token("t");
  EXPECT_TRUE(desk.Take(request, {}, DeskTime(0s))->halt_at_entry);  // as it was previewed
  request.set_halt_at_entry(false);
  request.add_confirmations(v1::CONFIRMATION_ORIGIN_VALID);
  request.add_confirmations(v1::CONFIRMATION_TABLE_CLEAR);
  const auto taken = desk.Take(request, {}, DeskTime(0s));
  ASSERT_TRUE(taken);
  EXPECT_FALSE(taken->halt_at_entry);
  EXPECT_THAT(taken->acknowledged, testing::UnorderedElementsAre("origin", "Z0", "table"));
}

// LIVE-3.21
TEST(DeskLimits, OfOrdersThatAreParked) {
  ParkedOrders parked;
  const auto first = parked.Add(ParkedStart(1), 10s);
  const auto second = parked.Add(ParkedStart(2), 20s);
  EXPECT_FALSE(parked.HasKey());
  EXPECT_THAT(parked.TakeLate(10s - 1ns), IsEmpty());
  std::vector<v1::HostOrder> late = parked.TakeLate(10s);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].number(), 1);
  EXPECT_TRUE(first->over);
  EXPECT_FALSE(second->over);
  EXPECT_THAT(parked.TakeLate(19s), IsEmpty());  // once
  EXPECT_EQ(parked.TakeMotions("").size(), 1U);
  EXPECT_THAT(parked.TakeMotions(""), IsEmpty());
  EXPECT_THAT(parked.TakeLate(30s), IsEmpty());  // it was stopped before
  v1::HostOrder key;
  key.mutable_key();
  parked.Add(key, 40s);
  EXPECT_TRUE(parked.HasKey());
  EXPECT_FALSE(parked.HasJob("jobs/1"));
  const auto one = parked.Add(ParkedRun(5, "jobs/1"), 40s);
  const auto other = parked.Add(ParkedRun(5, "jobs/2"), 40s);
  EXPECT_TRUE(parked.HasJob("jobs/1"));
  ASSERT_EQ(parked.TakeMotions("jobs/1").size(), 1U);
  EXPECT_TRUE(one->over);
  EXPECT_FALSE(other->over);
  EXPECT_FALSE(parked.HasJob("jobs/1"));
  EXPECT_TRUE(parked.HasJob("jobs/2"));
}

// Those of the line that is gone count up from 1; of other lines, which stay, down from -1.
TEST(DeskLimits, OfOrdersWhoseLineIsGone) {
  ParkedOrders parked;
  const auto gone = parked.Add(ParkedStart(1), 10s);
  const auto own = parked.Add(ParkedStart(0), 10s);
  const auto stays = parked.Add(ParkedStart(-1), 10s);
  parked.ForgetLine();
  EXPECT_TRUE(gone->over);
  EXPECT_FALSE(own->over);
  EXPECT_FALSE(stays->over);
  parked.ForgetAll();
  EXPECT_TRUE(own->over);
  EXPECT_TRUE(stays->over);
}

// LIVE-3.27: 1,024 answers, each for ten minutes.
TEST(DeskLimits, OfAnsweredRequests) {
  AnsweredRequests answered;
  answered.Keep("", "d", {}, DeskTime(0s));
  EXPECT_EQ(answered.Find(""), nullptr);
  for (int i = 0; i < 1'024; ++i) answered.Keep(std::to_string(i), "d", {}, DeskTime(0s));
  EXPECT_NE(answered.Find("0"), nullptr);
  answered.Keep("more", "d", {}, DeskTime(0s));
  EXPECT_EQ(answered.Find("0"), nullptr);
  EXPECT_NE(answered.Find("1"), nullptr);
  answered.Keep("then", "d", {}, DeskTime(10min));
  EXPECT_NE(answered.Find("more"), nullptr);
  answered.Keep("last", "d", {}, DeskTime(10min + 1ns));
  EXPECT_EQ(answered.Find("more"), nullptr);
  EXPECT_NE(answered.Find("then"), nullptr);
  EXPECT_FALSE(answered.IsAnother("then", "d"));
  EXPECT_TRUE(answered.IsAnother("then", "e"));
  answered.Keep("old", "", {}, DeskTime(10min));  // of a host that kept none
  EXPECT_FALSE(answered.IsAnother("old", "e"));
  v1::JournalEntry entry;
  *entry.mutable_time() = TimeUtil::SecondsToTimestamp(24 * 3600);
  EXPECT_TRUE(IsAskedFor(entry, DeskTime(10min).wall));
  EXPECT_FALSE(IsAskedFor(entry, DeskTime(10min + 1us).wall));
}

// The journal has answers of up to 4 KiB.
TEST(DeskLimits, OfAnAnswerInTheJournal) {
  v1::HostOrder order;
  order.mutable_factor()->set_request_id("id");
  const auto entry_with = [&](std::size_t bytes) {
    v1::HostOrderAnswer answer;
    answer.mutable_refusal()->set_message(std::string(bytes, 'x'));
    return AnsweredRequests::EntryOf(order, answer);
  };
  const auto entry = entry_with(3'000);
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->kind(), static_cast<int>(v1::HostOrder::kFactor));
  const std::size_t most = 3'000 + 4'096 - entry->ByteSizeLong();
  EXPECT_EQ(entry_with(most)->ByteSizeLong(), 4'096U);
  EXPECT_FALSE(entry_with(most + 1));
  order.mutable_factor()->clear_request_id();
  EXPECT_FALSE(entry_with(1));  // nobody asks for it again
}

// LIVE-3.25: behind 200 other entries a mark stays, for a part to end with.
TEST(DeskLimits, OfMarksThatStay) {
  const auto is_old = [](std::size_t others) {
    std::vector<EntryKind> kinds(others, EntryKind::kOther);
    kinds.push_back(EntryKind::kMark);
    kinds.push_back(EntryKind::kMark);
    const std::vector<bool> old = OldMarks(kinds);
    EXPECT_FALSE(old.back());
    return bool(old[others]);
  };
  EXPECT_TRUE(is_old(0));
  EXPECT_TRUE(is_old(199));
  EXPECT_FALSE(is_old(200));
  // From one that stays on they are counted anew.
  std::vector<EntryKind> kinds(200, EntryKind::kOther);
  kinds.push_back(EntryKind::kMark);
  kinds.resize(kinds.size() + 199, EntryKind::kOther);
  for (int mark = 0; mark < 2; ++mark) kinds.push_back(EntryKind::kMark);
  const std::vector<bool> old = OldMarks(kinds);
  EXPECT_FALSE(old[200]);
  EXPECT_TRUE(old[400]);
}

// A part ends with the first mark by which it has a mebibyte.
TEST(DeskLimits, OfPartsOfEntries) {
  const auto parts = [](std::size_t first_bytes) {
    v1::JournalEntry entry;
    entry.mutable_mark()->set_state(std::string(first_bytes - 100, 's'));
    while (entry.ByteSizeLong() < first_bytes)
      entry.mutable_mark()->mutable_state()->push_back('s');
    EXPECT_EQ(entry.ByteSizeLong(), first_bytes);
    return EntriesInParts({entry, entry}, 3).size();
  };
  EXPECT_EQ(parts(1 << 20), 2U);
  EXPECT_EQ(parts((1 << 20) - 1), 1U);
}

}  // namespace
}  // namespace rmlcell::server
