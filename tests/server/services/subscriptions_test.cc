// What the subscriptions of a watch want, as proto/rmlcell/v1/cell.proto has it.
#include "server/services/subscriptions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/base/names.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::microseconds;
using storage::EventRecord;

v1::Subscription Jobs(const std::string& filter) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_jobs()->set_filter(filter);
  return wanted;
}

class SubscriptionTest : public testing::Test {
 protected:
  std::int64_t Submit(const std::string& machine, const std::string& kind,
                      const std::string& caller) {
    return Must(bed.store().SubmitAndWait({.machine = machine, .kind = kind, .caller = caller}))
        .job.id;
  }
  static ErrorCode Refused(const v1::Subscription& wanted) {
    const auto made = CellSubscription::Make(wanted);
    return made ? ErrorCode{} : made.error().code;
  }

  ServerBed bed;
  JobFactsBook facts{bed.store()};
};

TEST_F(SubscriptionTest, AFilterLooksAtWhatAJobKeeps) {
  const std::int64_t laser = Submit("optimo-1", "CHECK", "anna");
  const std::int64_t mill = Submit("mill-1", "SIMULATE", "berta");
  const auto wants = [&](const std::string& filter) {
    const CellSubscription made = Must(CellSubscription::Make(Jobs(filter)));
    std::string found;
    if (made.WantsEvent({.job = laser, .kind = "state"}, facts)) found += "laser ";
    if (made.WantsEvent({.job = mill, .kind = "state"}, facts)) found += "mill ";
    if (made.WantsLatest(JobName(laser), facts)) found += "laser now ";
    if (made.WantsLatest(JobName(mill), facts)) found += "mill now ";
    return found;
  };
  EXPECT_EQ(wants(""), "laser mill laser now mill now ");
  EXPECT_EQ(wants("machine = machines/mill-1"), "mill mill now ");
  EXPECT_EQ(wants("kind = CHECK"), "laser laser now ");
  EXPECT_EQ(wants("caller = berta"), "mill mill now ");
  EXPECT_EQ(wants("caller = berta AND kind = CHECK"), "");
  const std::int64_t labelled =
      Must(bed.store().SubmitAndWait({.machine = "mill-1", .labels = {"a", "order-1"}})).job.id;
  const CellSubscription by_label = Must(CellSubscription::Make(Jobs("label = order-1")));
  EXPECT_TRUE(by_label.WantsEvent({.job = labelled, .kind = "state"}, facts));
  EXPECT_FALSE(by_label.WantsEvent({.job = mill, .kind = "state"}, facts));
  for (const char* changing : {"state = FAILED", "finished = true"})
    EXPECT_EQ(Refused(Jobs(changing)), ErrorCode::kCellBadFilter) << changing;
}

TEST_F(SubscriptionTest, SignalsCanBeLeftOut) {
  const std::int64_t job = Submit("optimo-1", "CHECK", "anna");
  v1::Subscription wanted = Jobs("");
  wanted.mutable_jobs()->set_without_signals(true);
  const CellSubscription made = Must(CellSubscription::Make(wanted));
  EXPECT_FALSE(made.WantsEvent({.job = job, .kind = "signal"}, facts));
  EXPECT_TRUE(made.WantsEvent({.job = job, .kind = "halted"}, facts));
  const CellSubscription all = Must(CellSubscription::Make(Jobs("")));
  EXPECT_TRUE(all.WantsEvent({.job = job, .kind = "signal"}, facts));
}

TEST_F(SubscriptionTest, MachinesBringTheirProgramsAndSchedules) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_machines()->add_names("machines/mill-1");
  const CellSubscription made = Must(CellSubscription::Make(wanted));
  const auto wants = [&](const std::string& resource) {
    return made.WantsEvent({.resource = resource, .kind = "updated"}, facts);
  };
  EXPECT_TRUE(wants("machines/mill-1"));
  EXPECT_TRUE(wants("machines/mill-1/programs/3"));
  EXPECT_TRUE(wants("machines/mill-1/laserSchedules/3"));
  EXPECT_FALSE(wants("machines/mill-10"));
  EXPECT_FALSE(wants("machines/optimo-1/programs/3"));
  EXPECT_FALSE(wants("projects/mill-1"));
  EXPECT_FALSE(wants("jobs/1"));
  EXPECT_TRUE(made.WantsLatest("machines/mill-1", facts));
  EXPECT_FALSE(made.WantsLatest("machines/optimo-1", facts));
  wanted.mutable_machines()->set_events_only(true);
  EXPECT_FALSE(Must(CellSubscription::Make(wanted)).WantsLatest("machines/mill-1", facts));
}

// Without names a part of the cell is wanted whole, and nothing of another part.
TEST_F(SubscriptionTest, OfAllMachinesOrProjectsNothingElseIsWanted) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_machines();
  const CellSubscription machines = Must(CellSubscription::Make(wanted));
  wanted.mutable_projects();
  const CellSubscription projects = Must(CellSubscription::Make(wanted));
  const EventRecord of_job{.job = Submit("mill-1", "CHECK", "anna"), .kind = "state"};
  const EventRecord of_deleted{.resource = "jobs/7", .kind = "deleted"};
  const EventRecord of_machine{.resource = "machines/mill-1", .kind = "updated"};
  const EventRecord of_project{.resource = "projects/lid", .kind = "updated"};
  EXPECT_TRUE(machines.WantsEvent(of_machine, facts));
  for (const EventRecord& other : {of_job, of_deleted, of_project})
    EXPECT_FALSE(machines.WantsEvent(other, facts)) << other.resource;
  EXPECT_TRUE(projects.WantsEvent(of_project, facts));
  for (const EventRecord& other : {of_job, of_deleted, of_machine})
    EXPECT_FALSE(projects.WantsEvent(other, facts)) << other.resource;
  EXPECT_TRUE(machines.WantsLatest("machines/mill-1", facts));
  for (const char* other : {"jobs/7", "handboxes/mill-1"})
    EXPECT_FALSE(machines.WantsLatest(other, facts)) << other;
}

// A job that was deleted is known by its name alone.
TEST_F(SubscriptionTest, OfADeletedJobEverySubscriptionThatMayHaveShownItHears) {
  const EventRecord deleted{.resource = "jobs/7", .kind = "deleted"};
  EXPECT_TRUE(Must(CellSubscription::Make(Jobs("kind = CHECK"))).WantsEvent(deleted, facts));
  v1::Subscription named;
  named.set_id("a");
  named.mutable_jobs()->add_names("jobs/8");
  EXPECT_FALSE(Must(CellSubscription::Make(named)).WantsEvent(deleted, facts));
  named.mutable_jobs()->add_names("jobs/7");
  EXPECT_TRUE(Must(CellSubscription::Make(named)).WantsEvent(deleted, facts));
}

TEST_F(SubscriptionTest, OfProjects) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_projects();
  EXPECT_TRUE(Must(CellSubscription::Make(wanted))
                  .WantsEvent({.resource = "projects/lid", .kind = "updated"}, facts));
  // Of what stands for now they have nothing.
  const std::int64_t job = Submit("optimo-1", "CHECK", "anna");
  for (const std::string& other : {JobName(job), std::string("machines/optimo-1")})
    EXPECT_FALSE(Must(CellSubscription::Make(wanted)).WantsLatest(other, facts));
  wanted.mutable_projects()->add_names("projects/box");
  EXPECT_FALSE(Must(CellSubscription::Make(wanted))
                   .WantsEvent({.resource = "projects/lid", .kind = "updated"}, facts));
  wanted.mutable_projects()->add_names("lid");
  EXPECT_EQ(Refused(wanted), ErrorCode::kCellInvalidArgument);
}

TEST_F(SubscriptionTest, TheRateIsOneToTwentyHertz) {
  const auto interval = [](double rate) {
    v1::Subscription wanted = Jobs("");
    wanted.set_max_rate_hz(rate);
    return Must(CellSubscription::Make(wanted)).interval();
  };
  EXPECT_EQ(interval(0.0), microseconds(0));
  EXPECT_EQ(interval(20.0), microseconds(0));
  EXPECT_EQ(interval(10.0), microseconds(100'000));
  EXPECT_EQ(interval(1.0), microseconds(1'000'000));
  for (const double rate : {0.99, 20.01, -1.0, std::nan("")}) {
    v1::Subscription wanted = Jobs("");
    wanted.set_max_rate_hz(rate);
    EXPECT_EQ(Refused(wanted), ErrorCode::kCellInvalidArgument) << rate;
  }
}

TEST_F(SubscriptionTest, WhatIsRefused) {
  v1::Subscription nameless = Jobs("");
  nameless.clear_id();
  EXPECT_EQ(Refused(nameless), ErrorCode::kCellInvalidArgument);
  nameless.set_id(std::string(65, 'a'));
  EXPECT_EQ(Refused(nameless), ErrorCode::kCellInvalidArgument);
  nameless.set_id(std::string(64, 'a'));
  EXPECT_EQ(Refused(nameless), ErrorCode{});
  v1::Subscription of_nothing;
  of_nothing.set_id("a");
  EXPECT_EQ(Refused(of_nothing), ErrorCode::kCellInvalidArgument);
  v1::Subscription both = Jobs("kind = CHECK");
  both.mutable_jobs()->add_names("jobs/1");
  EXPECT_EQ(Refused(both), ErrorCode::kCellInvalidArgument);
  v1::Subscription variables;
  variables.set_id("a");
  variables.mutable_variables();
  EXPECT_EQ(Refused(variables), ErrorCode::kCellUnimplemented);
  google::protobuf::RepeatedPtrField<v1::Subscription> twice;
  *twice.Add() = Jobs("");
  *twice.Add() = Jobs("");
  EXPECT_EQ(CodeOf(MakeSubscriptions(twice)), ErrorCode::kCellInvalidArgument);
}

// What a job is to become is no filter of a watch, and neither is what is no comparison.
TEST_F(SubscriptionTest, AFilterTakesWhatAJobKeepsAlone) {
  for (const char* filter : {"state = FAILED", "finished = true", "verdict = BAD", "text = lid",
                             "since = \"2026-11-25T10:00:00Z\"", "until = \"2026-11-25T10:00:00Z\"",
                             "colour = red", "kind"})
    EXPECT_EQ(Refused(Jobs(filter)), ErrorCode::kCellBadFilter) << filter;
}

TEST_F(SubscriptionTest, MachinesAreNamedInFull) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_machines()->add_names("machines/mill-1");
  EXPECT_EQ(Refused(wanted), ErrorCode{});
  wanted.mutable_machines()->add_names("mill-1");
  EXPECT_EQ(Refused(wanted), ErrorCode::kCellInvalidArgument);
}

TEST_F(SubscriptionTest, AWatchHasAHundred) {
  google::protobuf::RepeatedPtrField<v1::Subscription> wanted;
  for (int i = 0; i < 100; ++i) {
    *wanted.Add() = Jobs("");
    wanted.rbegin()->set_id("s" + std::to_string(i));
  }
  EXPECT_EQ(Must(MakeSubscriptions(wanted)).size(), 100U);
  *wanted.Add() = Jobs("");
  EXPECT_EQ(CodeOf(MakeSubscriptions(wanted)), ErrorCode::kCellInvalidArgument);
}

// Facts of jobs are asked once.
TEST_F(SubscriptionTest, FactsOfAJobThatIsGoneAreNone) {
  EXPECT_EQ(facts.Of(1), nullptr);
  const std::int64_t job = Submit("mill-1", "CHECK", "anna");
  EXPECT_EQ(facts.Of(job)->machine, "mill-1");
  EXPECT_EQ(facts.Of(job), facts.Of(job));
}

// A subscription of a family hears of its jobs alone.
TEST_F(SubscriptionTest, AFilterKnowsTheFamily) {
  const auto submit = [&](const std::string& family) {
    return Must(bed.store().SubmitAndWait({.machine = "m", .family = family, .kind = "CHECK"}))
        .job.id;
  };
  const std::int64_t laser = submit("optimo");
  const std::int64_t mill = submit("rml1");
  const CellSubscription made = Must(CellSubscription::Make(Jobs("family = optimo")));
  EXPECT_TRUE(made.WantsEvent({.job = laser, .kind = "state"}, facts));
  EXPECT_FALSE(made.WantsEvent({.job = mill, .kind = "state"}, facts));
}

}  // namespace
}  // namespace rmlcell::server
