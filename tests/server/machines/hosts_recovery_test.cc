// What the next host of a machine is told by the server, and what the log says of the one before.
#include "server/base/names.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

// LIVE-3.18: status was shown that is ahead of what is stored: it counts for nothing, and how far
// it went is told.
TEST_F(HostsTest, StatusDecidesNothing) {
  const auto link = Joined();
  hosts.Receive(*link, Entries(Fence(*link), 1, false));
  EXPECT_TRUE(Eventually([&] { return !Told().empty(); }));
  Tell(*link, v1::MACHINE_STATE_RUNNING, 99);
  EXPECT_EQ(hosts.StatusOf("mill-1")->virtual_time_ns(), 99);
  hosts.Leave(*link);
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  const auto next = Joined(Hello("other/2"));
  EXPECT_EQ(next->Newest(v1::HostResponse::kWelcome)->welcome().mark().virtual_time_ns(), 77);
  ASSERT_TRUE(Told().back().has_recovered());
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 77);
  EXPECT_EQ(Told().back().recovered().seen_until_ns(), 99);
}

// LIVE-3.30: the newest mark of journal and store is where it stands; nothing before it is void.
TEST_F(HostsTest, TheMarkOfTheJournalMayBeNewer) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, false));
  EXPECT_TRUE(Eventually([&] { return !Told().empty(); }));
  Tell(*link, v1::MACHINE_STATE_RUNNING, 99);
  hosts.Leave(*link);
  v1::HostHello hello = Hello("other/2");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  v1::MachineMark& mark = *hello.mutable_journal_mark();
  mark.set_fence(fence);
  mark.set_sequence(5);
  mark.set_virtual_time_ns(91);
  mark.mutable_place()->set_step(4);
  Joined(hello);
  ASSERT_TRUE(Told().back().has_recovered());
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 91);
  EXPECT_EQ(Told().back().recovered().place().step(), 4);
  EXPECT_EQ(Told().back().recovered().seen_until_ns(), 99);
}

// LIVE-3.30, LIVE-5.20: a mark behind a begin that the store does not have is none; behind one that
// it has it counts.
TEST_F(HostsTest, TheMarkBehindABeginCountsWhereTheStoreHasIt) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, false));  // up to number 2, at 77 ns
  EXPECT_TRUE(Eventually([&] { return !Told().empty(); }));
  hosts.Leave(*link);
  v1::HostHello hello = Hello("other/2");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  v1::MachineMark& mark = *hello.mutable_journal_mark();
  mark.set_fence(fence);
  mark.set_sequence(6);
  mark.set_virtual_time_ns(91);
  v1::HostBegin& begin = *hello.mutable_begin();
  begin.set_job("jobs/17");
  begin.set_fence(fence);
  begin.set_sequence(5);
  begin.mutable_mark()->set_fence(fence);
  begin.mutable_mark()->set_sequence(4);
  begin.mutable_mark()->set_virtual_time_ns(80);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  const auto next = Joined(hello);
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 80);
  hosts.Leave(*next);
  hello.set_host("third/3");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  hello.mutable_begin()->set_sequence(2);  // which the store has
  Joined(hello);
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 91);
}

// LIVE-3.30, LIVE-5.20: of one that was moved by hand, too, whose marks are clean, it is told how
// far what was shown is void; where the host gave it back in order nothing is.
TEST_F(HostsTest, WhatWasShownOfOneMovedByHandIsVoid) {
  const auto link = Joined();
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  EXPECT_TRUE(Eventually([&] { return !Told().empty(); }));
  Tell(*link, v1::MACHINE_STATE_JOGGING, 99);
  hosts.Leave(*link);
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  const auto next = Joined(Hello("other/2"));
  ASSERT_TRUE(Told().back().has_recovered());
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 77);
  EXPECT_EQ(Told().back().recovered().seen_until_ns(), 99);
  const std::size_t told = Told().size();
  v1::HostRequest back;
  back.mutable_hand_back()->set_fence(Fence(*next));
  hosts.Receive(*next, back);
  hosts.Leave(*next);
  EXPECT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
  Joined(Hello("third/3"));
  EXPECT_EQ(Told().size(), told);
}

// LIVE-5.20: a host that comes back to another server, where all that it had to tell is stored,
// says nothing more: a job of the one before it is given back all the same.
TEST_F(HostsTest, AHostThatComesBackFreesTheJobOfTheOneBefore) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, true));
  EXPECT_TRUE(Eventually([&] { return link->Newest(v1::HostResponse::kEntriesStored); }));
  hosts.Leave(*link);
  const std::int64_t job = RunGivenTo("before/1");
  v1::HostHello hello = Hello("elsewhere/1", fence);
  hello.mutable_begin()->set_job(JobName(job));
  const auto again = Joined(hello);
  Beat(*again);
  EXPECT_TRUE(Eventually(
      [&] { return Must(bed.store().GetJob(job)).state == storage::JobState::kQueued; }));
  EXPECT_TRUE(Must(bed.store().GetJob(job)).held);
}

// LIVE-3.05: a host that is told to end, and is not heard of until its machine has been given back,
// gets no other lease: it ends.
TEST_F(HostsTest, ALeaseThatIsOverStaysOver) {
  const std::int64_t fence = Fence(*Joined());
  const v1::HostHello late = Hello("elsewhere/1", fence);
  hosts.Forget("mill-1");
  EXPECT_EQ(Refused(late), ErrorCode::kCellMachineTaken);
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  EXPECT_TRUE(Must(bed.store().MachineLeases()).empty());
  const auto next = Joined(Hello("elsewhere/2"));
  EXPECT_GT(Fence(*next), fence);
  EXPECT_EQ(Refused(late), ErrorCode::kCellMachineTaken);
  EXPECT_FALSE(next->closed());
}

}  // namespace
}  // namespace rmlcell::server
