// The log of a machine, a line each.
#include "clients/cli/machine_log.h"

#include <gtest/gtest.h>

namespace rmlcell::cli {
namespace {

v1::CellEvent Applied(const std::string& caller) {
  v1::CellEvent event;
  event.set_caller(caller);
  event.mutable_machine()->set_virtual_time_ns(1'500'000'000);
  event.mutable_machine()->mutable_input_applied();
  return event;
}

v1::AppliedInput& InputOf(v1::CellEvent& event) {
  return *event.mutable_machine()->mutable_input_applied()->mutable_input();
}

TEST(MachineLog, SaysWhoDidWhat) {
  v1::CellEvent event = Applied("anna");
  InputOf(event).set_override_percent(55.0);
  EXPECT_EQ(MachineLogLine(event), "anna: override 55 %  [1.500 s]");
  InputOf(event).set_stop(v1::HOLD_REASON_STOP);
  EXPECT_EQ(MachineLogLine(event), "anna: STOP  [1.500 s]");
  v1::ControlChanged& control = *InputOf(event).mutable_control();
  control.set_kind(v1::ControlChanged::KIND_TAKEN_OVER);
  control.set_from("queue/jobs/1");
  control.set_to("anna");
  control.set_reason("it chatters");
  EXPECT_EQ(MachineLogLine(event),
            "anna: takes control over from queue/jobs/1: it chatters  [1.500 s]");
  InputOf(event).mutable_start()->set_job("jobs/17");
  InputOf(event).mutable_start()->mutable_step()->set_program(1);
  InputOf(event).mutable_start()->mutable_step()->set_step(9);
  EXPECT_EQ(MachineLogLine(event), "anna: starts at step 1/9 of jobs/17  [1.500 s]");
}

// What somebody else wrote does not steer a terminal.
TEST(MachineLog, ShowsWhatOthersWroteAsText) {
  v1::CellEvent event = Applied("an\x1bna");
  InputOf(event).mutable_resume();
  EXPECT_EQ(MachineLogLine(event).find('\x1b'), std::string::npos);
}

TEST(MachineLog, ARunWithItsEnd) {
  v1::CellEvent event;
  event.mutable_machine()->mutable_run_begun()->set_run(3);
  event.mutable_machine()->mutable_run_begun()->set_job("jobs/17");
  EXPECT_EQ(MachineLogLine(event), "run 3 of jobs/17 begins");
  v1::RunOver& over = *event.mutable_machine()->mutable_run_over();
  over.set_run(3);
  over.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(MachineLogLine(event), "run 3 is over: completed");
  v1::Halted& halted = *event.mutable_machine()->mutable_run()->mutable_halted();
  halted.set_message("breakpoint");
  halted.mutable_place()->set_program(45);
  halted.mutable_place()->set_step(7);
  EXPECT_EQ(MachineLogLine(event), "halted at 45/7: breakpoint");
  halted.set_message("STOP");
  halted.set_reason(v1::HOLD_REASON_STOP);
  EXPECT_EQ(MachineLogLine(event), "halted at 45/7: STOP");
  halted.set_reason(v1::HOLD_REASON_CONTROL);
  EXPECT_EQ(MachineLogLine(event), "halted at 45/7: STOP (CONTROL)");
}

TEST(MachineLog, AHostThatWasLost) {
  v1::CellEvent event;
  event.mutable_machine()->mutable_host_lost()->set_host("workshop/4711");
  EXPECT_EQ(MachineLogLine(event), "its host workshop/4711 is gone");
  v1::Recovered& found = *event.mutable_machine()->mutable_recovered();
  found.set_mark_virtual_time_ns(17'000'000'000);
  EXPECT_EQ(MachineLogLine(event), "found again at 17.000 s");
  found.set_seen_until_ns(17'250'000'000);
  found.mutable_place()->set_program(1);
  found.mutable_place()->set_step(9);
  EXPECT_EQ(MachineLogLine(event),
            "found again at 17.000 s at 1/9; what was shown up to 17.250 s is void");
}

// Records are listed elsewhere; what a job tells its machine tells, too.
TEST(MachineLog, WhatDoesNotBelongThere) {
  v1::CellEvent event;
  event.mutable_machine()->mutable_changed();
  EXPECT_EQ(MachineLogLine(event), "");
  event.mutable_job()->mutable_halted()->set_message("STOP");
  EXPECT_EQ(MachineLogLine(event), "");
}

}  // namespace
}  // namespace rmlcell::cli
