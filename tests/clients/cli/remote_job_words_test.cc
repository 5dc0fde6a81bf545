// What a person who submits and watches a job sees, and all that is sent along with one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "tests/clients/cli/fake_jobs.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;

// The share where it is known, how long it takes where that is planned, the instruction and the
// tip; a job that ended well leaves a full bar.
TEST_F(RemoteJobs, ATerminalShowsHowFarAJobIs) {
  v1::WatchJobResponse planned;
  v1::JobProgress& at = *planned.mutable_progress();
  at.set_virtual_time_ns(234'000'000'000);
  at.set_planned_time_ns(868'000'000'000);
  at.set_progress(0.5);
  at.set_instruction("MOVE");
  at.mutable_position()->mutable_tip()->set_x(1.0);
  at.mutable_position()->mutable_tip()->set_y(-2.5);
  at.mutable_position()->mutable_tip()->set_z(3.25);
  v1::WatchJobResponse unplanned = planned;
  unplanned.mutable_progress()->clear_planned_time_ns();
  unplanned.mutable_progress()->clear_progress();
  const auto drawn = [&](const v1::WatchJobResponse& end) {
    jobs.connections = {{{planned, unplanned, end}, {}}};
    jobs.watches.clear();
    testing::internal::CaptureStdout();
    const std::string text = OnErrors([&] { WatchJob(server.remote(), "17", 0, false); });
    testing::internal::GetCapturedStdout();
    return text;
  };
  const auto cells = [](const char* cell, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += cell;
    return text;
  };
  const std::string good = drawn(End(1, v1::Outcome::KIND_COMPLETED));
  EXPECT_THAT(good, HasSubstr(cells("█", 14) + cells("░", 14) +
                              " 50 %  234.0 of 868.0 s  MOVE  X 1.00 Y -2.50 Z 3.25"));
  EXPECT_THAT(good, HasSubstr("█" + cells("░", 27) + "  234.0 s  MOVE  X 1.00 Y -2.50 Z 3.25"));
  EXPECT_THAT(good, testing::EndsWith(cells("█", 28) + " 100 %  jobs/17\n"));
  const std::string bad = drawn(End(1, v1::Outcome::KIND_FAILED, v1::VERDICT_BAD));
  EXPECT_THAT(bad, Not(HasSubstr("100 %")));
  // As messages, for scripts.
  jobs.connections = {{{planned, End(1, v1::Outcome::KIND_COMPLETED)}, {}}};
  EXPECT_THAT(Watch(false, 0, true).output, HasSubstr("\"234000000000\""));
}

// That the server is away is told when it goes, not at each try; and again when it came back in
// between.
TEST_F(RemoteJobs, ThatTheServerIsAwayIsToldOnce) {
  const grpc::Status away{grpc::StatusCode::UNAVAILABLE, "away"};
  jobs.connections = {{{EventOf(7, "before")}, away},
                      {{}, away},
                      {{EventOf(8, "between")}, away},
                      {{End(9, v1::Outcome::KIND_COMPLETED)}, {}}};
  const Told told = Watch();
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(jobs.watches.size(), 4U);
  const std::string line = "rmlcell: the server is away; watching again when it is back\n";
  EXPECT_EQ(told.errors, line + line);
}

// Where a run begins, and what stands for it; nothing of a simulation where nothing was asked.
TEST_F(RemoteJobs, ARunIsSubmittedWithItsBeginning) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 7};
  wanted.kind = "run";
  wanted.unzeroed = true;
  wanted.ticket = "17";
  wanted.step = "45/10";
  wanted.occurrence = 2;
  wanted.off_until_work_on = true;
  wanted.seen = {"clamps", "origin-valid"};
  wanted.labels = {"order-1", "urgent"};
  const v1::Job job = Submitted(wanted).job();
  EXPECT_EQ(job.kind(), v1::JOB_KIND_RUN);
  EXPECT_TRUE(job.run().unzeroed());
  EXPECT_EQ(job.run().ticket(), "jobs/17");
  EXPECT_EQ(job.run().step().program(), 45);
  EXPECT_EQ(job.run().step().step(), 10);
  EXPECT_EQ(job.run().occurrence(), 2);
  EXPECT_TRUE(job.run().off_until_work_on());
  ASSERT_EQ(job.run().confirmations_size(), 2);
  EXPECT_EQ(job.run().confirmations(0), v1::CONFIRMATION_CLAMPS);
  EXPECT_EQ(job.run().confirmations(1), v1::CONFIRMATION_ORIGIN_VALID);
  EXPECT_THAT(job.labels(), ElementsAre("order-1", "urgent"));
  EXPECT_FALSE(job.has_simulation());
  wanted.override_percent = 50.0;
  EXPECT_TRUE(Submitted(wanted).job().has_simulation());
  // One that begins at its beginning says nothing of all that.
  const v1::Job plain = Submitted({.machine = "m", .file = {}, .slot = 7}).job();
  EXPECT_FALSE(plain.has_run());
  EXPECT_EQ(plain.labels_size(), 0);
  wanted.seen = {"clamp"};
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9003"),
                                     HasSubstr("'clamp' is nothing to look at: clamps, tool")));
  wanted.step = "45/";
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9003"), HasSubstr("'45/' is no step")));
}

// A time that is none is a wrong use of the command.
TEST_F(RemoteJobs, ATimeThatIsNoneIsWrongUse) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 7};
  wanted.not_before = "tomorrow";
  EXPECT_THAT(Refusal(wanted), AllOf(HasSubstr("CELL-E9026"), HasSubstr("--not-before tomorrow")));
}

TEST_F(RemoteJobs, TheBlockGoesAlongAsItWasGiven) {
  SubmitRequest wanted{.machine = "m", .file = {}, .slot = 1};
  wanted.milling.block.stock = "100x80x10";
  wanted.milling.block.tool = "flat:2:flutes=2";
  wanted.milling.block.cell_mm = 0.25;
  wanted.milling.block.material = "wax";
  wanted.milling.block.rpm = 8000.0;
  wanted.milling.stl_tolerance_mm = 0.5;
  wanted.milling.products = {"height-grid"};
  const v1::SubmitJobRequest request = Submitted(wanted);
  const v1::Milling& milling = request.job().simulation().milling();
  EXPECT_EQ(milling.cell_mm(), 0.25);
  EXPECT_EQ(milling.material(), "wax");
  EXPECT_EQ(milling.rpm(), 8000.0);
  EXPECT_EQ(milling.stl_tolerance_mm(), 0.5);
  EXPECT_TRUE(milling.height_grid());
  EXPECT_FALSE(milling.relief() || milling.height_map() || milling.stl());
  // No server takes a target of more than 64 MiB, however it is set up.
  wanted.milling.block.target = folder.Put("large.stl", "solid");
  std::filesystem::resize_file(wanted.milling.block.target, (std::uintmax_t{64} << 20) + 1);
  EXPECT_THAT(Refusal(wanted),
              AllOf(HasSubstr("CELL-E9007"), HasSubstr("larger than 67108864 bytes")));
}

TEST_F(RemoteJobs, AJobThatIsShownSaysForWhatItWaitsAndWhyItIsNotGood) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_state(v1::Job::STATE_QUEUED);
  jobs.job.set_waits_for("anna\tat the page");
  const auto show = [&] { return Hear([&] { return ShowJob(server.remote(), "17"); }).output; };
  EXPECT_THAT(show(), Not(HasSubstr("waits")));  // nothing but its turn
  jobs.job.set_wait_reason(v1::WAIT_REASON_CONTROL);
  EXPECT_THAT(show(), HasSubstr("\nwaits     anna\\x09at the page\n"));
  jobs.job.set_wait_reason(v1::WAIT_REASON_MACHINE_NOT_READY);
  EXPECT_THAT(show(), HasSubstr("\nwaits     its machine cannot start: rmlcell machine status\n"));
  v1::Outcome& outcome = *jobs.job.mutable_outcome();
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  outcome.set_verdict(v1::VERDICT_BAD);
  v1::VerdictReason& reason = *outcome.add_reasons();
  reason.set_message("too deep");
  reason.set_code("RML1-E8002");
  EXPECT_THAT(show(), HasSubstr("\nverdict   BAD\n          too deep (RML1-E8002)\n"));
}

}  // namespace
}  // namespace rmlcell::cli
