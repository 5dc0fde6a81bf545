// What a person sees of a job that is watched, and what a submission asks for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>

#include "clients/cli/remote.h"
#include "clients/cli/remote_machines.h"
#include "tests/clients/cli/fake_jobs.h"
#include "tests/clients/cli/fake_machine.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

using WatchedJobs = RemoteJobs;

TEST_F(WatchedJobs, ProgressSaysTimeInstructionAndPlace) {
  v1::WatchJobResponse at;
  v1::JobProgress& progress = *at.mutable_progress();
  progress.set_progress(0.5);
  progress.set_virtual_time_ns(234'040'000'000);
  progress.set_planned_time_ns(868'060'000'000);
  progress.set_instruction("MOVE");
  progress.mutable_position()->mutable_tip()->set_x(1.254);
  progress.mutable_position()->mutable_tip()->set_y(-2.506);
  progress.mutable_position()->mutable_tip()->set_z(3.758);
  jobs.connections = {{{at, End(2, v1::Outcome::KIND_COMPLETED)}, {}}};
  std::string shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    EXPECT_EQ(WatchJob(server.remote(), "17", 0, false), 0);
    testing::internal::GetCapturedStdout();
  });
  EXPECT_THAT(shown, HasSubstr("  234.0 of 868.1 s  MOVE  X 1.25 Y -2.51 Z 3.76"));
  EXPECT_THAT(shown, HasSubstr(" 50 %  "));
  // How far it came, at its end.
  EXPECT_THAT(shown, HasSubstr(" 100 %  jobs/17\n"));
  progress.clear_planned_time_ns();
  jobs.watches.clear();
  jobs.connections = {{{at, End(2, v1::Outcome::KIND_FAILED, v1::VERDICT_BAD)}, {}}};
  shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    EXPECT_EQ(WatchJob(server.remote(), "17", 0, false), 1);
    testing::internal::GetCapturedStdout();
  });
  EXPECT_THAT(shown, HasSubstr("  234.0 s  MOVE  X 1.25"));
  EXPECT_THAT(shown, Not(HasSubstr("100 %")));
}

// From its first event on, and by its own rule.
TEST_F(WatchedJobs, ASubmissionThatIsWatchedMayBeStrict) {
  jobs.job.set_name("jobs/17");
  const auto submit = [&](bool strict) {
    jobs.watches.clear();
    jobs.connections = {{{End(1, v1::Outcome::KIND_COMPLETED, v1::VERDICT_DOUBTFUL)}, {}}};
    SubmitRequest wanted;
    wanted.machine = "m";
    wanted.slot = 7;
    wanted.watch = true;
    wanted.strict = strict;
    return Hear([&] { return SubmitJob(server.remote(), wanted); }).exit_code;
  };
  EXPECT_EQ(submit(true), 1);
  ASSERT_EQ(jobs.watches.size(), 1U);
  EXPECT_EQ(jobs.watches[0].name(), "jobs/17");
  EXPECT_EQ(jobs.watches[0].after_sequence(), 0);
  EXPECT_EQ(submit(false), 0);
}

TEST_F(WatchedJobs, NumbersAloneNameAJob) {
  jobs.job.set_name("jobs/17");
  EXPECT_EQ(Hear([&] { return ResumeJob(server.remote(), "17"); }).exit_code, 0);
  EXPECT_EQ(jobs.asked, "resume jobs/17");
  EXPECT_EQ(Hear([&] { return HoldJob(server.remote(), "17"); }).exit_code, 0);
  EXPECT_EQ(jobs.asked, "hold jobs/17");
  EXPECT_EQ(Hear([&] { return CancelJob(server.remote(), "17"); }).exit_code, 0);
  EXPECT_EQ(jobs.asked, "jobs/17");
}

// Each product is asked for by its own name, and by no other.
TEST_F(WatchedJobs, ProductsOfABlockHaveTheirNames) {
  const auto asked = [&](const std::string& product) {
    SubmitRequest wanted;
    wanted.machine = "m";
    wanted.slot = 7;
    wanted.milling.block.stock = "100x80x10";
    wanted.milling.block.tool = "flat:3";
    wanted.milling.products = {product};
    const v1::Milling milling = Submitted(wanted).job().simulation().milling();
    return std::string(milling.relief() ? "relief " : "") +
           (milling.height_map() ? "height-map " : "") +
           (milling.height_grid() ? "height-grid " : "") + (milling.stl() ? "stl " : "");
  };
  for (const std::string product : {"relief", "height-map", "height-grid", "stl"})
    EXPECT_EQ(asked(product), product + " ");
}

// What happens is told on a line of its own: the bar is taken away before, and drawn again behind.
TEST_F(WatchedJobs, TheBarGivesWayToEachEvent) {
  v1::WatchJobResponse at;
  at.mutable_progress()->set_progress(0.5);
  jobs.connections = {
      {{at, EventOf(1, "one"), at, End(2, v1::Outcome::KIND_FAILED, v1::VERDICT_BAD)}, {}}};
  const std::string shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    EXPECT_EQ(WatchJob(server.remote(), "17", 0, false), 1);
    testing::internal::GetCapturedStdout();
  });
  // Each time that it is drawn, too, what stood there goes.
  std::size_t cleared = 0;
  for (std::size_t from = 0; (from = shown.find("\r\x1b[K", from)) != std::string::npos; from += 4)
    ++cleared;
  EXPECT_EQ(cleared, 4U) << shown;
}

using WordsOfTheMachine = MachineWords;

// How long a machine goes on nobody knows: a block that wanders, and no share.
TEST_F(WordsOfTheMachine, ShowsWhereItIs) {
  v1::WatchMachineResponse& one = machine_.watched.emplace_back();
  one.mutable_status()->set_state(v1::MACHINE_STATE_RUNNING);
  v1::AxisValue& axis = *one.mutable_status()->add_axes();
  axis.set_axis("X");
  axis.set_value(12.5);
  const std::string shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    const MachineAct act{.machine = "m"};
    WatchMachine(server_->remote(), act);
    testing::internal::GetCapturedStdout();
  });
  EXPECT_THAT(shown, HasSubstr("░  X 12.500"));
  EXPECT_THAT(shown, Not(HasSubstr("%")));
}

}  // namespace
}  // namespace rmlcell::cli
