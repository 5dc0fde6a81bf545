// How a machine stands, as `rmlcell machine status` tells it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class MachineStatusTest : public MachineWords {
 protected:
  MachineStatusTest() {
    status().set_machine("machines/m");
    status().set_state(v1::MACHINE_STATE_IDLE);
  }
  v1::MachineStatus& status() { return machine_.statuses[0]; }
  void Live() {
    status().set_host("h");
    status().set_mode(v1::OPERATING_MODE_REMOTE);
    status().set_zeroed(true);
    status().set_override_percent(100.0);
  }
  std::string Shown() {
    const Told told = Say("status m");
    EXPECT_EQ(told.exit_code, kGood) << told.errors;
    return told.output;
  }
};

TEST_F(MachineStatusTest, WhatDoesNotLive) {
  EXPECT_EQ(Shown(), "machines/m  IDLE; it does not live: rmlcell machine enable\n");
  for (const v1::MachineState comes : {v1::MACHINE_STATE_STARTING, v1::MACHINE_STATE_RECOVERING}) {
    status().set_state(comes);
    EXPECT_THAT(Shown(), Not(HasSubstr("it does not live")));
  }
  status().set_state(v1::MACHINE_STATE_STARTING);
  EXPECT_EQ(Shown(), "machines/m  STARTING\n");
  status().set_state(v1::MACHINE_STATE_OFF);
  status().mutable_off_reason()->set_message("no host\tknows it");
  EXPECT_EQ(Shown(), "machines/m  OFF: no host\\x09knows it\n");
}

TEST_F(MachineStatusTest, OneThatStands) {
  Live();
  EXPECT_EQ(Shown(),
            "machines/m  IDLE in REMOTE\n"
            "position  \n"
            "override  100 %\n");
  v1::LastRun& last = *status().mutable_last_run();
  last.set_run(4);
  last.set_program(7);
  last.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  v1::StartBlocker& blocker = *status().add_start_blockers();
  blocker.set_code("CELL-E1");
  blocker.set_message("the door is open");
  blocker.set_advice("close it");
  status().set_factor(1.0);  // that of every other clock
  EXPECT_EQ(Shown(),
            "machines/m  IDLE in REMOTE\n"
            "position  \n"
            "last run  4, program 7: completed\n"
            "override  100 %\n"
            "jobs wait CELL-E1: the door is open; close it\n");
  last.set_job("jobs/17");
  EXPECT_THAT(Shown(), HasSubstr("\nlast run  4 of jobs/17: completed\n"));
}

TEST_F(MachineStatusTest, AllThatThereMayBe) {
  Live();
  status().set_state(v1::MACHINE_STATE_HELD);
  status().set_zeroed(false);
  status().set_door_open(true);
  status().set_hold_reason(v1::HOLD_REASON_DOOR);
  status().set_cut_off_job("jobs/9");
  status().mutable_cut_off_at()->set_program(45);
  status().mutable_cut_off_at()->set_step(1);
  const auto axis = [this](const char* name, double value, v1::Unit unit) {
    v1::AxisValue& made = *status().add_axes();
    made.set_axis(name);
    made.set_value(value);
    made.set_unit(unit);
  };
  axis("X", 1.5, v1::UNIT_MILLIMETRE);
  axis("A", 0.5, v1::UNIT_RADIAN);
  v1::MachineRun& run = *status().mutable_run();
  run.set_run(5);
  run.set_job("jobs/17");
  run.set_program(44);
  run.mutable_place()->set_program(1);
  run.mutable_place()->set_byte_offset(0);
  run.mutable_place()->set_step(1);
  run.set_instruction("MOVE");
  run.set_run_time_ns(61'500'000'000);
  status().mutable_last_run()->set_run(4);
  status().set_factor(2.5);
  status().mutable_control()->set_holder("anna");
  status().mutable_control()->set_client("page");
  for (const int id : {3, 1000}) {
    v1::Alarm& alarm = *status().add_alarms();
    alarm.set_id(id);
    alarm.mutable_diagnostic()->set_code("OPT-E12");
    alarm.mutable_diagnostic()->set_message("emergency stop");
  }
  status().add_start_blockers()->set_code("CELL-E1");
  EXPECT_EQ(Shown(),
            "machines/m  HELD in REMOTE, jobs/9 was cut off at 45/1, held by DOOR, "
            "axes without reference, door open\n"
            "position  X 1.500  A 0.5000 rad\n"
            "run       5 of jobs/17, program 1, byte 0, step 1 MOVE, 1 min 1.500 s\n"
            "override  100 %\n"
            "time      2.5 times as fast\n"
            "control   anna (page)\n"
            "alarm 3   OPT-E12: emergency stop\n"
            "alarm 1000 OPT-E12: emergency stop\n");
  status().mutable_control()->clear_client();
  EXPECT_THAT(Shown(), HasSubstr("\ncontrol   anna\n"));
}

// The program that was started, where the place does not name one; none: somebody's hand.
TEST_F(MachineStatusTest, WhereARunIs) {
  Live();
  status().mutable_run()->set_run(5);
  EXPECT_THAT(Shown(), HasSubstr("\nrun       5, by hand, 0.000 s\n"));
  status().mutable_run()->set_program(1);
  EXPECT_THAT(Shown(), HasSubstr("\nrun       5, program 1, 0.000 s\n"));
  status().mutable_run()->mutable_place()->set_step(2);
  EXPECT_THAT(Shown(), HasSubstr("\nrun       5, program 1, step 2, 0.000 s\n"));
}

TEST_F(MachineStatusTest, AsAMessage) {
  const Told told = Say("status m", true);
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_THAT(told.output, StartsWith("{"));
  EXPECT_THAT(told.output, HasSubstr("MACHINE_STATE_IDLE"));
}

}  // namespace
}  // namespace rmlcell::cli
