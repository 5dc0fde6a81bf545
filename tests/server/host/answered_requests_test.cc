// Requests that are repeated, also behind a crash of the host (live.md 3.27).
#include "server/host/answered_requests.h"

#include <unistd.h>

#include <filesystem>

#include "proto/bridge/encoding.h"
#include "proto/bridge/sha256.h"
#include "server/host/journal.h"
#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class AnsweredTest : public HostMachineTest {
 protected:
  void SetUp() override {
    Make();
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
  // All that is on the disk by now.
  void Keep() {
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) disk_.push_back(entry);
  }
  // Another host, with what the first `count` entries of the disk say.
  void Crash(std::size_t count, std::chrono::minutes later = std::chrono::minutes(0)) {
    now_.steady += later;
    now_.wall += later;
    v1::HostWelcome welcome;
    HostMachine::Setup setup =
        SetupOf(RecoveredFrom(welcome, {disk_.begin(), disk_.begin() + static_cast<long>(count)}));
    setup.name = "machines/mill-1";
    setup.host = "workshop/2";
    setup.fence = 8;
    setup.family = families::FindFamily("rml1");
    setup.profile = "srm-20";
    setup.memory.programs[5] = {.name = "square", .object = machine::Bytes::Of(kSquare)};
    auto made = HostMachine::Make(std::move(setup), now_,
                                  [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
  }
  v1::HostOrder Factor(const std::string& id) {
    v1::HostOrder order;
    order.mutable_factor()->set_factor(2.0);
    order.mutable_factor()->set_control_token(token_);
    order.mutable_factor()->set_request_id(id);
    return order;
  }
  std::vector<v1::JournalEntry> disk_;
};

// LIVE-3.27: what the state has is not done again; the token of then proves nothing any more, and
// the repeat needs none.
TEST_F(AnsweredTest, ARepeatBehindACrashGetsTheFirstAnswer) {
  const v1::HostOrder start = Start("the one");
  EXPECT_TRUE(Do(start).status().has_run());
  Pass(2s);
  Keep();
  Crash(disk_.size());
  const v1::HostOrderAnswer again = Do(start);
  EXPECT_FALSE(again.has_refusal()) << again.refusal().message();
  EXPECT_EQ(again.status().state(), v1::MACHINE_STATE_INSPECT);
  EXPECT_FALSE(host_->StatusAt(now_).has_run());
  // Another one is looked at.
  EXPECT_EQ(Do(Start("another")).refusal().code(), "CELL-E9420");
}

// LIVE-3.27: a refusal is an answer, too.
TEST_F(AnsweredTest, ARefusalIsRepeatedToo) {
  const v1::HostOrder none = Start("none", 6);
  const std::string code = Do(none).refusal().code();
  EXPECT_FALSE(code.empty());
  Keep();
  Crash(disk_.size());
  Control();
  v1::HostOrder again = none;
  EXPECT_EQ(Do(again).refusal().code(), code);
}

// LIVE-3.27: what lies behind the newest mark did not happen to the machine that is found: its
// repeat acts.
TEST_F(AnsweredTest, WhatTheStateDoesNotHaveActs) {
  Keep();
  const std::size_t before = disk_.size();
  const v1::HostOrder start = Start("the one");
  Do(start);
  Keep();
  ASSERT_TRUE(disk_.back().has_mark());
  for (std::size_t cut = before; cut < disk_.size(); ++cut) {
    Crash(cut);
    Control();
    v1::HostOrder again = start;
    again.mutable_start()->set_control_token(token_);
    EXPECT_TRUE(Do(again).status().has_run()) << cut;
  }
}

// LIVE-3.27: an id that was used for something else is refused, also behind a crash, whatever token
// proves it; and so is one that is no id.
TEST_F(AnsweredTest, AnIdIsForOneRequest) {
  EXPECT_TRUE(Do(Start("the one")).status().has_run());
  EXPECT_EQ(Do(Start("the one", 6)).refusal().code(), "CELL-E9019");
  EXPECT_EQ(Do(Factor("the one")).refusal().code(), "CELL-E9019") << "of another method";
  EXPECT_EQ(host_->StatusAt(now_).factor(), 1.0);
  v1::HostOrder renewed = Start("the one");
  renewed.mutable_start()->set_control_token("another token");
  EXPECT_FALSE(Do(renewed).has_refusal());
  EXPECT_EQ(Do(Start(std::string(65, 'a'))).refusal().code(), "CELL-E9003");
  Pass(2s);
  Keep();
  Crash(disk_.size());
  EXPECT_EQ(Do(Start("the one", 6)).refusal().code(), "CELL-E9019");
  EXPECT_FALSE(Do(Start("the one")).has_refusal());
}

// LIVE-3.27: for ten minutes, and of one caller and one kind.
TEST_F(AnsweredTest, AnAnswerIsKeptForTenMinutes) {
  Do(Factor("faster"));
  Keep();
  Crash(disk_.size(), std::chrono::minutes(9));
  EXPECT_TRUE(Do(Factor("faster")).has_status());
  Crash(disk_.size(), std::chrono::minutes(2));
  EXPECT_EQ(Do(Factor("faster")).refusal().code(), "CELL-E9420");
}

v1::JournalEntry Entry(std::int64_t sequence, std::int64_t second) {
  v1::JournalEntry entry;
  entry.set_fence(7);
  entry.set_sequence(sequence);
  entry.mutable_time()->set_seconds(1'700'000'000 + second);
  return entry;
}

// LIVE-3.27, LIVE-3.24: answers that may still be asked for outlive the trimming of the journal.
TEST(AnsweredJournal, AnswersOutliveWhatIsStored) {
  const std::string path = testing::TempDir() + "/answered-" + std::to_string(::getpid());
  std::filesystem::remove(path);
  auto opened = Journal::Open(path);
  ASSERT_TRUE(opened);
  std::unique_ptr<Journal> journal = std::move(opened->journal);
  std::int64_t sequence = 0;
  const auto answered = [&](std::int64_t second, const std::string& id) {
    v1::JournalEntry entry = Entry(++sequence, second);
    entry.mutable_answered()->set_request_id(id);
    ASSERT_TRUE(journal->Write({entry}));
  };
  answered(0, "old");
  answered(700, "new");
  for (int i = 0; i < 45; ++i) {
    v1::JournalEntry mark = Entry(++sequence, 1000);
    mark.mutable_mark()->set_state(std::string(100'000, 's'));
    ASSERT_TRUE(journal->Write({mark}));
  }
  answered(1001, "behind");
  journal->Stored(7, sequence - 1);
  EXPECT_LT(journal->bytes(), 1'000);
  answered(1002, "last");
  journal.reset();
  const auto again = Journal::Open(path);
  ASSERT_TRUE(again);
  std::vector<std::string> ids;
  for (const v1::JournalEntry& entry : again->entries) ids.push_back(entry.answered().request_id());
  EXPECT_THAT(ids, testing::ElementsAre("new", "behind", "last"));
  EXPECT_EQ(again->torn_bytes, 0);
  // What was kept is dropped in its turn.
  EXPECT_EQ(again->entries.front().sequence(), 2);
  std::filesystem::remove(path);
}

// LIVE-3.27: what halts, and what only asks, needs no memory beyond its host; what proves something
// must not be in it.
TEST(AnsweredEntries, HaveNothingThatNobodyNeedsOrMaySee) {
  v1::HostOrder factor;
  factor.mutable_factor()->set_request_id("one");
  v1::HostOrder disarm;
  disarm.mutable_disarm()->set_request_id("one");
  v1::HostOrder undo;
  undo.mutable_undo_teaching()->set_request_id("one");
  v1::HostOrderAnswer status;
  status.mutable_status()->set_machine("machines/mill-1");
  EXPECT_TRUE(AnsweredRequests::EntryOf(factor, status));
  EXPECT_FALSE(AnsweredRequests::EntryOf(disarm, status));
  EXPECT_FALSE(AnsweredRequests::EntryOf(undo, status));
  std::vector<v1::HostOrderAnswer> secrets(5);
  secrets[0].mutable_control();
  secrets[1].mutable_control_kept();
  secrets[2].mutable_armed();
  secrets[3].mutable_session();
  secrets[4].mutable_key();
  for (const v1::HostOrderAnswer& secret : secrets)
    EXPECT_FALSE(AnsweredRequests::EntryOf(factor, secret)) << secret.result_case();
}

// A status is that of whoever is asked again, and takes no room.
TEST(AnsweredEntries, HaveNoStatus) {
  v1::HostOrder factor;
  factor.set_caller("anna");
  factor.mutable_factor()->set_request_id("one");
  v1::HostOrderAnswer answer;
  answer.mutable_status()->set_machine(std::string(5'000, 'm'));
  const auto entry = AnsweredRequests::EntryOf(factor, answer);
  ASSERT_TRUE(entry);
  EXPECT_TRUE(entry->by_status());
  EXPECT_FALSE(entry->answer().has_status());
  EXPECT_EQ(entry->request_id(), "one");
  EXPECT_EQ(entry->caller(), "anna");
}

// LIVE-3.27: what is another order under the same id is known behind a crash, too.
TEST(AnsweredEntries, KnowWhatWasAsked) {
  const HostTime now{.steady = 1h, .wall = WallTime(24h)};
  v1::HostOrder order;
  order.set_caller("anna");
  order.mutable_factor()->set_request_id("one");
  order.mutable_factor()->set_factor(2.0);
  const auto kept = AnsweredRequests::EntryOf(order, v1::HostOrderAnswer());
  ASSERT_TRUE(kept);
  v1::JournalEntry entry;
  *entry.mutable_time() = Stamp(now.wall);
  *entry.mutable_answered() = *kept;
  AnsweredRequests answered;
  answered.Recover({entry}, {}, now);
  const std::string key = AnsweredRequests::KeyOf(order);
  ASSERT_NE(answered.Find(key), nullptr);
  EXPECT_FALSE(answered.IsAnother(key, AnsweredRequests::DigestOf(order)));
  order.mutable_factor()->set_factor(3.0);
  EXPECT_TRUE(answered.IsAnother(key, AnsweredRequests::DigestOf(order)));
}

// LIVE-3.27: what an earlier version kept is compared all the same: the first 32 digits of the
// SHA-256 of what was asked, whatever token it came with.
TEST(AnsweredEntries, KeepWhatWasAskedInTheSameWay) {
  v1::HostOrder order;
  order.set_for_job("jobs/17");
  order.set_reason("it chatters");
  order.mutable_factor()->set_request_id("one");
  order.mutable_factor()->set_factor(2.0);
  const std::string about = std::to_string(order.request_case()) + "\njobs/17\nit chatters\n";
  const std::string asked = bridge::StableBytes(order.factor());
  order.mutable_factor()->set_control_token("a token");
  EXPECT_EQ(AnsweredRequests::DigestOf(order), bridge::Sha256Hex(about + asked).substr(0, 32));
}

// LIVE-3.27: ten minutes from when it was given, however many hosts there were meanwhile.
TEST(AnsweredEntries, AreAsOldAsTheirAnswers) {
  const HostTime given{.steady = 1h, .wall = WallTime(24h)};
  const auto behind = [&given](std::chrono::microseconds time) {
    return HostTime{.steady = given.steady + time, .wall = given.wall + time};
  };
  v1::HostOrder order;
  order.set_caller("anna");
  order.mutable_factor()->set_request_id("one");
  v1::JournalEntry entry;
  *entry.mutable_time() = Stamp(given.wall);
  entry.mutable_answered()->set_request_id("one");
  entry.mutable_answered()->set_caller("anna");
  AnsweredRequests answered;
  answered.Recover({entry}, {}, behind(9min));
  const std::string key = AnsweredRequests::KeyOf(order);
  answered.Keep("another", "d", {}, behind(10min));
  EXPECT_NE(answered.Find(key), nullptr);
  answered.Keep("a third", "d", {}, behind(10min + 1us));
  EXPECT_EQ(answered.Find(key), nullptr);
  EXPECT_NE(answered.Find("another"), nullptr);
}

}  // namespace
}  // namespace rmlcell::server
