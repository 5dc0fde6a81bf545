// The log of a machine, a line each.
#include "clients/cli/machine_log.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>

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

// Each kind of what acts on a machine, as its fields name it.
TEST(MachineLog, WhatActedOnIt) {
  const auto said = [](const std::string& fields) {
    v1::AppliedInput input;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(fields, &input)) << fields;
    return InputText(input);
  };
  EXPECT_EQ(said("key { key: 'X+' action: KEY_ACTION_PRESS }"), "key X+ PRESS");
  EXPECT_EQ(said("start { }"), "starts");
  EXPECT_EQ(said("start { program: 1 }"), "starts program 1");
  EXPECT_EQ(said("start { program: 7 job: 'jobs/17' step { program: 1 step: 9 } }"),
            "starts at step 1/9 program 7 of jobs/17");
  EXPECT_EQ(said("resume { }"), "RESUME");
  EXPECT_EQ(said("hold: HOLD_REASON_HOLD"), "HOLD");
  EXPECT_EQ(said("hold: HOLD_REASON_UNSPECIFIED"), "HOLD");
  EXPECT_EQ(said("stop: HOLD_REASON_SERVER_LOST"), "STOP (SERVER_LOST)");
  EXPECT_EQ(said("abort: HOLD_REASON_ABORT"), "ABORT");
  EXPECT_EQ(said("abort: HOLD_REASON_STOP"), "ABORT (STOP)");
  EXPECT_EQ(said("override_percent: 0.5"), "override 0.5 %");
  EXPECT_EQ(said("from_outside { input { name: 'IL[20]' value { logical: true } } }"),
            "IL[20] = on");
  EXPECT_EQ(said("from_outside { door_open: true }"), "opens the door");
  EXPECT_EQ(said("from_outside { door_open: false }"), "closes the door");
  EXPECT_EQ(said("from_outside { gate: 2 }"), "presses gate 2");
  EXPECT_EQ(said("from_outside { power: true }"), "power on");
  EXPECT_EQ(said("from_outside { power: false }"), "power off");
  EXPECT_EQ(said("from_outside { emergency_stop_released: true }"), "lets the emergency stop go");
  EXPECT_EQ(said("variable { name: 'VR[5]' value { real: 2.5 } }"), "VR[5] = 2.5");
  EXPECT_EQ(said("variable { name: 'VR[5]' text: '2.' }"), "VR[5] = 2.");
  EXPECT_EQ(said("mode: OPERATING_MODE_CYCLE"), "mode CYCLE");
  EXPECT_EQ(said("acknowledged_alarm: 3"), "acknowledges alarm 3");
  EXPECT_EQ(said("factor: 2.5"), "time 2.5 times as fast");
  EXPECT_EQ(said("breakpoints { }"), "breakpoints none");
  EXPECT_EQ(said("breakpoints { breakpoints { step { program: 1 step: 9 } }"
                 " breakpoints { step { program: 44 step: 1 } } }"),
            "breakpoints 1/9 44/1");
  EXPECT_EQ(said("simulation_until { }"), "no dry run");
  EXPECT_EQ(said("simulation_until { program: 45 step: 1 }"), "dry run up to 45/1");
  EXPECT_EQ(said("emergency_stop: true"), "EMERGENCY STOP");
  EXPECT_EQ(said("emergency_stop: false"), "lets the emergency stop go");
  EXPECT_EQ(said("power: true"), "power on");
  EXPECT_EQ(said("power: false"), "power off");
  EXPECT_EQ(said("control { kind: KIND_ACQUIRED }"), "takes control");
  EXPECT_EQ(said("control { kind: KIND_RELEASED }"), "gives control back");
  EXPECT_EQ(said("control { kind: KIND_EXPIRED from: 'anna' }"), "control of anna ran out");
  EXPECT_EQ(said("control { }"), "control changes hands");
  EXPECT_EQ(said("program_changed { program: 7 }"), "program 7 is another one");
  EXPECT_EQ(said("gates { programs: 7 programs: 0 }"), "gates start 7 0");
  EXPECT_EQ(said(""), "an input of a later version");
}

TEST(MachineLog, WhatHappenedToIt) {
  const auto said = [](const std::string& fields) {
    v1::CellEvent event;
    EXPECT_TRUE(
        google::protobuf::TextFormat::ParseFromString("machine { " + fields + " }", &event));
    return MachineLogLine(event);
  };
  EXPECT_EQ(said("run { halted { } } virtual_time_ns: 1"), "halted  [0.000 s]");
  EXPECT_EQ(said("run { halted { place { program: 1 step: 1 } } }"), "halted at 1/1");
  EXPECT_EQ(said("run { resumed { place { program: 45 step: 7 } } }"), "goes on at 45/7");
  EXPECT_EQ(said("run { resumed { } }"), "goes on");
  EXPECT_EQ(said("run { message { text: 'a\tb' } }"), "a\\x09b");
  EXPECT_EQ(
      said("run { diagnostic { code: 'RML1-E8002' message: 'x' severity: SEVERITY_WARNING } }"),
      "warning RML1-E8002: x");
  EXPECT_EQ(said("run { }"), "");
  EXPECT_EQ(said("run_begun { run: 3 }"), "run 3 begins");
  EXPECT_EQ(said("run_over { run: 3 job: 'jobs/17' outcome { kind: KIND_COMPLETED } }"),
            "run 3 of jobs/17 is over: completed");
  EXPECT_EQ(said("alarm { id: 3 diagnostic { code: 'OPT-E12' message: 'emergency stop' } }"),
            "alarm 3: OPT-E12: emergency stop");
  EXPECT_EQ(said("clock_slipped { lost_ns: 250000000 }"), "its time slipped by 0.250 s");
  // Told alike as long as nobody could see the difference.
  EXPECT_EQ(said("recovered { mark_virtual_time_ns: 17000000000 seen_until_ns: 17000400000 }"),
            "found again at 17.000 s");
  EXPECT_EQ(said("recovered { mark_virtual_time_ns: 17000000000 seen_until_ns: 16000000000 }"),
            "found again at 17.000 s");
}

// With which program somebody speaks, where the log has it.
TEST(MachineLog, SaysWithWhatItWasDone) {
  v1::CellEvent event = Applied("anna");
  InputOf(event).mutable_resume();
  event.mutable_machine()->mutable_input_applied()->set_client("page");
  EXPECT_EQ(MachineLogLine(event), "anna (page): RESUME  [1.500 s]");
  event.clear_caller();
  event.mutable_machine()->set_virtual_time_ns(0);
  EXPECT_EQ(MachineLogLine(event), "RESUME");
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
