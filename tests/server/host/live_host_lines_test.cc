// What a host says to its servers of itself, and when (live.md 3.04 to 3.07, 3.16).
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/host/journal.h"
#include "tests/server/host/live_host_bed.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

class LiveHostLines : public LiveHost {
 protected:
  void TellRenewed() {
    v1::HostResponse renewed;
    renewed.mutable_renewed();
    server_->Tell(renewed);
  }
  // The most of them between one status and the next, once nothing else happens any more.
  std::size_t RenewalsBetweenStatuses() {
    std::size_t most = 0;
    std::size_t count = 0;
    int statuses = 0;
    for (const v1::HostRequest& told : server_->Told()) {
      if (told.has_status()) {
        ++statuses;
        count = 0;
      }
      if (told.has_renew() && statuses > 1) most = std::max(most, ++count);
    }
    return most;
  }
};

// LIVE-3.04, LIVE-3.16: each third of its lease, though its status is told once a second.
TEST_F(LiveHostLines, ARenewalWaitsForNoStatus) {
  v1::HostWelcome welcome = WelcomeTo("rml1");
  welcome.mutable_lease()->set_seconds(0);
  welcome.mutable_lease()->set_nanos(150'000'000);
  Live(welcome);
  // Were it told with a status alone, there would be one.
  for (std::size_t status = 3; status <= 60 && RenewalsBetweenStatuses() < 4; ++status)
    server_->Told(v1::HostRequest::kStatus, status);
  EXPECT_GE(RenewalsBetweenStatuses(), 4U);
}

// What a server says to a renewal changes nothing of the machine.
TEST_F(LiveHostLines, ARenewalMayBeAnswered) {
  Live();
  TellRenewed();
  StoreAll();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  TellRenewed();
  StoreAll();
  EXPECT_EQ(AskWhereItIs().run_state().fence(), 7);
  EXPECT_EQ(Ask(StopOrder()).halt().status().fence(), 7);
}

// LIVE-3.16: what an order led to is told before it is answered: who has the answer and looks sees
// it. Slower acts at once, faster is written first.
TEST_F(LiveHostLines, WhatAnOrderLedToIsToldBeforeItsAnswer) {
  Live();
  TakeControl();
  for (const double percent : {90.0, 80.0, 100.0, 60.0, 70.0}) {
    ASSERT_FALSE(Ask(OverrideOf(percent)).has_refusal());
    const std::vector<v1::HostRequest> told = server_->Told();
    const auto answer =
        std::ranges::find_if(told.rbegin(), told.rend(), &v1::HostRequest::has_answer);
    const auto status = std::find_if(answer, told.rend(),
                                     [](const v1::HostRequest& one) { return one.has_status(); });
    ASSERT_NE(status, told.rend());
    EXPECT_EQ(status->status().override_percent(), percent);
  }
}

// LIVE-3.07: only when each of its servers is of another version; one that is away is none of them.
TEST_F(LiveHostLines, ItEndsWhenAllItsServersAreOfAnotherVersion) {
  v1::HostWelcome welcome = WelcomeTo("rml1");
  welcome.add_servers("unix:" + folder_ + "/nobody");
  Live(welcome);
  server_->Refuse({grpc::StatusCode::FAILED_PRECONDITION, "of another version"});
  server_->EndLine();
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(Count(v1::HostRequest::kHello), 3U);  // the first, and one refusal for each server
}

// LIVE-3.07: one after the other: a server that has taken it since begins the count anew.
TEST_F(LiveHostLines, ItGoesOnWhenItWasWelcomeBetween) {
  FakeHostServer other("unix:" + folder_ + "/b");
  other.Refuse({grpc::StatusCode::UNAVAILABLE, "away"});
  v1::HostWelcome welcome = WelcomeTo("rml1");
  welcome.add_servers(other.address());
  Live(welcome);
  for (std::size_t hellos = 3; hellos <= 5; hellos += 2) {
    server_->RefuseOnce({grpc::StatusCode::FAILED_PRECONDITION, "of another version"});
    server_->EndLine();
    server_->Told(v1::HostRequest::kHello, hellos);  // it was refused, and came again
    EXPECT_EQ(AskWhereItIs().run_state().fence(), 7);
  }
  stopping_ = true;
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(server_->Told(v1::HostRequest::kHandBack, 1)[0].hand_back().fence(), 7);
}

// LIVE-7.02: a handbox is shown when it has changed, and not with each status.
TEST_F(LiveHostLines, AHandboxIsShownWhenItHasChanged) {
  Live(WelcomeTo("optimo"));
  server_->Told(v1::HostRequest::kStatus, Count(v1::HostRequest::kStatus) + 2);
  const std::vector<v1::HostRequest> shown = server_->Told(v1::HostRequest::kPanel, 1);
  for (std::size_t i = 1; i < shown.size(); ++i)
    EXPECT_NE(shown[i].panel().SerializeAsString(), shown[i - 1].panel().SerializeAsString());
}

// LIVE-3.16: between what it tells it rests, be it heard or not.
TEST_F(LiveHostLines, ItRestsWhereNothingIsToDo) {
  for (const char* family : {"rml1", "optimo"}) {
    Live(WelcomeTo(family));
    EXPECT_TRUE(ComesToRest()) << family;
    server_->Refuse({grpc::StatusCode::UNAVAILABLE, "away"});
    server_->EndLine();
    server_->AwaitEnds(1);
    EXPECT_TRUE(ComesToRest()) << family;
    stopping_ = true;
    EXPECT_EQ(host_.get(), 0);
    stopping_ = false;
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/" + family);
    std::filesystem::remove(JournalPath());
  }
}

// LIVE-3.06: a server that it comes back to is told where it stands, and what it has not stored.
TEST_F(LiveHostLines, ALineThatIsTakenUpAgainBeginsWithWhatIsNotStored) {
  Live();
  TakeControl();
  const std::vector<v1::JournalEntry> before = Entries();
  ASSERT_FALSE(before.empty());
  server_->EndLine();
  server_->AwaitEnds(1);  // a status that comes behind this is of the new line
  server_->Told(v1::HostRequest::kHello, 2);
  const std::size_t statuses = Count(v1::HostRequest::kStatus);
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control(); }, statuses);
  std::vector<std::int64_t> again;
  for (const v1::JournalEntry& entry : Entries()) again.push_back(entry.sequence());
  EXPECT_EQ(std::ranges::count(again, before.front().sequence()), 2);
  EXPECT_EQ(std::ranges::count(again, before.back().sequence()), 2);
}

// LIVE-5.20: of a job that the host before was about to begin it tells with each line, until the
// server has stored something of it.
TEST_F(LiveHostLines, AJobThatWasAboutToBeginIsToldUntilItIsKnown) {
  v1::JournalEntry mark;
  mark.set_fence(3);
  mark.set_sequence(1);
  mark.mutable_mark()->set_clean(true);
  v1::JournalEntry intent;
  intent.set_fence(3);
  intent.set_sequence(2);
  intent.mutable_intent()->mutable_input()->mutable_start()->set_job("jobs/17");
  ASSERT_TRUE(Journal::Open(JournalPath())->journal->Write({mark, intent}));
  Live();
  EXPECT_EQ(server_->Told(v1::HostRequest::kHello, 1)[0].hello().begin().job(), "jobs/17");
  AskWhereItIs();  // which stores nothing
  server_->EndLine();
  EXPECT_EQ(server_->Told(v1::HostRequest::kHello, 2)[1].hello().begin().job(), "jobs/17");
  StoreAll();
  AskWhereItIs();  // it has heard that
  server_->EndLine();
  EXPECT_FALSE(server_->Told(v1::HostRequest::kHello, 3)[2].hello().has_begin());
}

// What is in the store is not told again.
TEST_F(LiveHostLines, WhatIsStoredIsToldOnce) {
  Live();
  TakeControl();
  StoreAll();
  const std::int64_t stored = Entries().back().sequence();
  AskWhereItIs();
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 2);
  Ask(ReleaseOfControl());
  std::vector<std::int64_t> told;
  for (const v1::JournalEntry& entry : Entries()) told.push_back(entry.sequence());
  EXPECT_EQ(std::ranges::count(told, stored), 1);
  EXPECT_GT(told.back(), stored);
}

}  // namespace
}  // namespace rmlcell::server
