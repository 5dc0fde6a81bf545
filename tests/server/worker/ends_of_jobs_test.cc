// What a job tells at its end, and what of it is done when it is to end early.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::IsEmpty;

class EndsOfJobs : public JobRunnerTest {};

// A worker that is to end does what is done as soon as it would be handed back.
TEST_F(EndsOfJobs, ACheckIsNotHandedBack) {
  v1::WorkResponse stop;
  stop.mutable_stop();
  EXPECT_FALSE(WorkBehind(Assignment(v1::JOB_KIND_CHECK, "STOP\n"), {stop}));
  EXPECT_FALSE(HandedBack());
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), testing::ElementsAre("report"));
}

// What is cancelled before it began leaves nothing.
TEST_F(EndsOfJobs, WhatWasCancelledBeforeLeavesNothing) {
  for (const v1::JobKind kind : {v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE}) {
    WorkBehind(Assignment(kind, "DELAY 1\n"), {Order(v1::WorkerControl::KIND_CANCEL)});
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_CANCELLED);
    EXPECT_THAT(Names(), IsEmpty()) << kind;
  }
}

// An error stands where its finding does, to the column.
TEST_F(EndsOfJobs, AnErrorHasTheColumnOfItsFinding) {
  Work(Assignment(v1::JOB_KIND_CHECK, "STOP\nSPEED 101\n"));
  ASSERT_EQ(Report().diagnostics_size(), 1);
  EXPECT_GT(Outcome().place().column(), 0);
  EXPECT_EQ(Outcome().place().column(), Report().diagnostics(0).place().column());
}

TEST_F(EndsOfJobs, ACheckSaysOfWhichMachineItIs) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_CHECK, "PA;PU100,0;", "rml1");
  assignment.set_profile("t1");
  Work(assignment);
  EXPECT_EQ(Report().profile(), "t1");
}

// 1,000 findings are listed; five of a kind are told at once, and all others together at the end.
TEST_F(EndsOfJobs, FindingsBeyondThoseListedAreGathered) {
  std::string source;
  for (int line = 0; line < 1'005; ++line) source += "SPEED 101\n";
  Work(Assignment(v1::JOB_KIND_CHECK, source));
  const v1::RunReport report = Report();
  EXPECT_EQ(report.diagnostics_size(), 1'000);
  EXPECT_EQ(report.diagnostics_dropped(), 5);
  ASSERT_EQ(report.gathered_size(), 1);
  EXPECT_EQ(report.gathered(0).code(), "OPT-E7004");
  EXPECT_EQ(report.gathered(0).count(), 5);
  EXPECT_EQ(report.gathered(0).first().program(), 45);
  EXPECT_EQ(report.gathered(0).first().line(), 1'001);
  EXPECT_EQ(report.gathered(0).last().program(), 45);
  EXPECT_EQ(report.gathered(0).last().line(), 1'005);
  ASSERT_EQ(Events().size(), 6U);
  EXPECT_EQ(Events().back().gathered().count(), 1'000);
}

// OPT-3.47: advice about the text goes with the run, in its log and in its report.
TEST_F(EndsOfJobs, AdviceAboutTheTextIsOfTheRunToo) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "GOTO 20\nDELAY 1\n20 DELAY 1\n"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  const auto is_it = [](const v1::Diagnostic& finding) { return finding.place().line() == 2; };
  const v1::RunReport report = Report();
  EXPECT_EQ(std::ranges::count_if(report.diagnostics(), is_it), 1);
  const std::vector<v1::JobEvent> events = Events();
  const auto told = std::ranges::find_if(
      events, [&](const v1::JobEvent& event) { return is_it(event.diagnostic()); });
  ASSERT_NE(told, events.end());
  EXPECT_EQ(told->virtual_time_ns(), 0);
}

// RunReport.inputs: what it hangs on, for who is to run the same; Outcome: how long it took.
TEST_F(EndsOfJobs, ARunSaysWhatItHangsOnAndHowLongItTook) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "DELAY 1.5\n"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  const v1::RunReport report = Report();
  ASSERT_TRUE(report.inputs().contains("programs/45"));
  EXPECT_EQ(report.inputs().at("programs/45").size(), 32U);
  EXPECT_GE(Outcome().cycle_time_ns(), 1'500'000'000);
  EXPECT_NEAR(1e-9 * static_cast<double>(Outcome().cycle_time_ns()),
              report.total().times().cycle_s(), 1e-9);
}

// worker.proto, WorkerFinish.executables: those that were made. A check makes none.
TEST_F(EndsOfJobs, ACheckTellsOfNoExecutable) {
  Work(Assignment(v1::JOB_KIND_CHECK, "DELAY 1\n"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(Finished()->executables_size(), 0);
}

// However soon it is over: who follows its way has seen all of it before its end is told.
TEST_F(EndsOfJobs, WhoFollowsAWaySeesItsEnd) {
  WorkBehind(
      Assignment(v1::JOB_KIND_SIMULATE, "PA;VS8;!MC1;PU1000,1000;Z1000,1000,-50;PU0,0;", "rml1"),
      {Order(v1::WorkerControl::KIND_FOLLOW_TOOLPATH)});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  std::string way;
  for (const v1::WorkRequest& message : heard_) {
    if (!message.has_toolpath()) continue;
    way += message.toolpath().frames();
    way += message.toolpath().open_block();
  }
  EXPECT_THAT(way, testing::Not(IsEmpty()));
}

// Also where some of it was sent a moment ago: behind where it was told to be last, some of its way
// comes.
TEST_F(EndsOfJobs, WhoFollowsAPacedWaySeesItsEnd) {
  v1::WorkerAssignment assignment = Assignment(
      v1::JOB_KIND_SIMULATE, "PA;VS10;!VZ10;!PZ-100,200;!MC1;PD3000,0;PU3000,0;", "rml1");
  assignment.mutable_job()->mutable_simulation()->set_pace(20.0);
  WorkBehind(assignment, {Order(v1::WorkerControl::KIND_FOLLOW_TOOLPATH)});
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  const auto last = std::find_if(heard_.rbegin(), heard_.rend(), IsPosition);
  ASSERT_NE(last, heard_.rend());
  EXPECT_TRUE(std::any_of(heard_.rbegin(), last,
                          [](const v1::WorkRequest& message) { return message.has_toolpath(); }));
}

// job_runner.h: everything that can go wrong with a job ends as its outcome. Here the clock of the
// processor throws behind the first look, with which the work begins.
TEST_F(EndsOfJobs, AnExceptionFailsTheJobAndNotItsWorker) {
  for (const v1::JobKind kind : {v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE}) {
    int looks = 0;
    processor_time = [&looks]() -> double {
      if (++looks > 1) throw std::runtime_error("the clock broke");
      return 0.0;
    };
    EXPECT_TRUE(Work(Assignment(kind, "DELAY 1\n")));
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED) << kind;
    EXPECT_EQ(Outcome().code(), "CELL-E9001") << kind;
    EXPECT_THAT(Outcome().message(), testing::HasSubstr("the clock broke")) << kind;
    EXPECT_THAT(Names(), IsEmpty()) << kind;
  }
}

// common.proto, Diagnostic.verdict: BAD where the verdict rests on findings of this code, be they
// listed, gathered or told while the job is under way.
TEST_F(EndsOfJobs, FindingsOfWhatCannotRunAreJudged) {
  std::string source;
  for (int line = 0; line < 1'005; ++line) source += "SPEED 101\n";
  Work(Assignment(v1::JOB_KIND_SIMULATE, source));
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_BAD);
  const v1::RunReport report = Report();
  ASSERT_EQ(report.diagnostics_size(), 1'000);
  EXPECT_EQ(report.diagnostics(0).verdict(), v1::VERDICT_BAD);
  EXPECT_EQ(report.diagnostics(999).verdict(), v1::VERDICT_BAD);
  ASSERT_EQ(report.gathered_size(), 1);
  EXPECT_EQ(report.gathered(0).verdict(), v1::VERDICT_BAD);
  const std::vector<v1::JobEvent> events = Events();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.front().diagnostic().verdict(), v1::VERDICT_BAD);
}

}  // namespace
}  // namespace rmlcell::server
