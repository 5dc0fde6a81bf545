// `rmlcell machine ...`: what each verb asks a machine for, and what it says then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>

#include "engine/core/catalogue.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class MachineActsTest : public MachineWords {
 protected:
  MachineActsTest() {
    machine_.statuses[0].set_machine("machines/m");
    machine_.statuses[0].set_state(v1::MACHINE_STATE_OFF);
  }
  // It does it, and shows how the machine stands then.
  void ExpectDone(const std::string& line, const std::string& calls) {
    const Told told = Say(line);
    EXPECT_EQ(told.exit_code, kGood) << line << told.errors;
    EXPECT_EQ(told.output, "machines/m  OFF; it does not live: rmlcell machine enable\n") << line;
    EXPECT_EQ(told.errors, "") << line;
    EXPECT_EQ(Calls(), calls) << line;
  }
  // It is wrong use: nothing is asked for.
  void ExpectWrong(const std::string& line, const std::string& error) {
    const Told told = Say(line);
    EXPECT_EQ(told.exit_code, kUsage) << line;
    EXPECT_THAT(told.errors, HasSubstr(error)) << line;
    EXPECT_EQ(Calls(), "") << line;
  }
  v1::Variable& AddVariable(const std::string& name) {
    v1::Variable& made = *machine_.variables.add_variables();
    made.set_name(name);
    return made;
  }
};

TEST_F(MachineActsTest, WhatNeedsNoControl) {
  ExpectDone("enable m", "EnableMachine machine: \"machines/m\"\n");
  ExpectDone("disable machines/m", "DisableMachine machine: \"machines/m\"\n");
  ExpectDone("hold m", "HoldMachine machine: \"machines/m\"\n");
  ExpectDone("stop m", "StopMachine machine: \"machines/m\"\n");
  ExpectDone("emergency-stop m", "EmergencyStopMachine machine: \"machines/m\"\n");
  ExpectDone("abort m", "AbortRun machine: \"machines/m\"\n");
  ExpectDone("status m", "GetMachine name: \"machines/m\"\n");
  ExpectDone("take m --reason why --computer pc",
             "TakeMachine machine: \"machines/m\" reason: \"why\" computer: \"pc\"\n");
  std::array<char, 256> name{};
  ASSERT_EQ(::gethostname(name.data(), name.size() - 1), 0);
  ExpectDone("take m --reason why",
             "TakeMachine machine: \"machines/m\" reason: \"why\" computer: \"" +
                 std::string(name.data()) + "\"\n");
}

TEST_F(MachineActsTest, WhatOneClientDoesAtATime) {
  const std::string head = " machine: \"machines/m\" control_token: \"t\"";
  for (const auto& [line, call] : std::initializer_list<std::pair<std::string, std::string>>{
           {"resume m", "ResumeMachine" + head},
           {"resume m --accept-displaced", "ResumeMachine" + head + " accept_displaced: true"},
           {"resume m --restore-process", "ResumeMachine" + head + " restore_process: true"},
           {"mode m cycle", "SetMode" + head + " mode: OPERATING_MODE_CYCLE"},
           {"mode m manual", "SetMode" + head + " mode: OPERATING_MODE_MANUAL"},
           {"mode m repeat", "SetMode" + head + " mode: OPERATING_MODE_REPEAT"},
           {"mode m single", "SetMode" + head + " mode: OPERATING_MODE_SINGLE"},
           {"mode m remote", "SetMode" + head + " mode: OPERATING_MODE_REMOTE"},
           {"override m 55", "SetOverride" + head + " override_percent: 55"},
           {"factor m 2.5", "SetFactor" + head + " factor: 2.5"},
           {"acknowledge m 7", "AcknowledgeAlarm" + head + " alarm_id: 7"},
           {"confirm m", "ConfirmMachine" + head + " confirmations: CONFIRMATION_INSPECTED"},
           {"gates m 0 99", "SetGates" + head + " gate_programs: 0 gate_programs: 99"},
           {"zero m", "ZeroMachine" + head}})
    ExpectDone(line, WithControlFor(call));
  ExpectDone("confirm m --take-over why",
             WithControlFor("ConfirmMachine" + head + " confirmations: CONFIRMATION_INSPECTED",
                            " take_over: true reason: \"why\""));
}

TEST_F(MachineActsTest, WrongUseAsksForNothing) {
  ExpectWrong("mode m fast", "fast not in");
  ExpectWrong("gates m 0 100", "SLOTS");
  ExpectWrong("gates m 7", "SLOTS");
  ExpectWrong("start m 0", "SLOT");
  ExpectWrong("start m 100", "SLOT");
  ExpectWrong("start m 7 --job 17", "--job");
  ExpectWrong("start m --seen tool", "--seen");
  ExpectWrong("start m --job 17 --seen toll", "--seen 'toll': nothing is called so; see --help\n");
  ExpectWrong("take m", "--reason");
  ExpectWrong("status", "MACHINE");
  for (const char* text : {"VR[5]", "=5", "VR[5]=x", "VR[5]="}) {
    const std::string none = "rmlcell: '" + std::string(text) +
                             "' is none: NAME=VALUE, such as VR[5]=2.5 or IL[20]=on\n";
    ExpectWrong("write m " + std::string(text), none);
    ExpectWrong("input m " + std::string(text), none);
  }
  ExpectWrong("input m gate=3x", "'gate=3x' is none");
}

// A lease that somebody else has, and a call that is refused behind it: that is given back.
TEST_F(MachineActsTest, ARefusalIsTold) {
  machine_.refused["SetMode"] = {grpc::StatusCode::FAILED_PRECONDITION, "it runs"};
  Told told = Say("mode m cycle");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: it runs\n");
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(Calls(), testing::EndsWith("\nReleaseControl token t\n"));
  machine_.refused["AcquireControl"] = {grpc::StatusCode::FAILED_PRECONDITION, "anna has it"};
  machine_.control.clear_control_token();
  for (const char* line : {"mode m cycle", "start m", "start m --job 17 --seen tool", "zero m"}) {
    told = Say(line);
    EXPECT_EQ(told.exit_code, kConnection);
    EXPECT_EQ(told.errors, "rmlcell: anna has it\n");
    const std::string calls = Calls();
    EXPECT_THAT(calls, StartsWith("AcquireControl "));
    EXPECT_EQ(std::ranges::count(calls, '\n'), 1) << calls;
  }
  for (const char* call : {"GetMachine", "EnableMachine", "StopMachine", "ReadVariables",
                           "TakeMachine", "WatchMachine"})
    machine_.refused[call] = {grpc::StatusCode::INVALID_ARGUMENT, "no"};
  for (const char* line : {"status m", "enable m", "stop m", "read m X", "take m --reason why",
                           "watch m", "acknowledge m", "options m"}) {
    told = Say(line);
    EXPECT_EQ(told.exit_code, kUsage) << line;
    EXPECT_EQ(told.errors, "rmlcell: no\n") << line;
    EXPECT_EQ(told.output, "") << line;
  }
}

// What it holds itself while it shows the machine does not keep jobs from it behind that.
TEST_F(MachineActsTest, TheControlOfTheVerbIsNotShown) {
  v1::MachineStatus& status = machine_.statuses[0];
  status.set_state(v1::MACHINE_STATE_IDLE);
  status.set_host("h");
  status.set_zeroed(true);
  status.mutable_control()->set_holder("me");
  v1::StartBlocker& held = *status.add_start_blockers();
  held.set_code("CELL-E1");
  held.set_symbol(ConstantName(ErrorCode::kCellLeaseHeld));
  v1::StartBlocker& other = *status.add_start_blockers();
  other.set_code("CELL-E2");
  other.set_symbol("OTHER");
  EXPECT_THAT(Say("status m").output, AllOf(HasSubstr("control   me\n"), HasSubstr("CELL-E1")));
  const std::string shown = Say("mode m cycle").output;
  EXPECT_THAT(shown, Not(AnyOf(HasSubstr("control"), HasSubstr("CELL-E1"))));
  EXPECT_THAT(shown, HasSubstr("CELL-E2"));
}

TEST_F(MachineActsTest, AlarmsAreAcknowledgedOneByOne) {
  const auto line = [](int alarm) {
    return WithControlFor(
        "AcknowledgeAlarm machine: \"machines/m\" control_token: \"t\" alarm_id: " +
        std::to_string(alarm));
  };
  const std::string asked = "GetMachine name: \"machines/m\"\n";
  ExpectDone("acknowledge m", asked);  // there is none
  machine_.statuses[0].add_alarms()->set_id(3);
  machine_.statuses[0].add_alarms()->set_id(5);
  EXPECT_EQ(Say("acknowledge m").exit_code, kGood);
  EXPECT_EQ(Calls(), asked + line(3) + line(5));
  machine_.refused["AcknowledgeAlarm"] = {grpc::StatusCode::FAILED_PRECONDITION, "still there"};
  EXPECT_EQ(Say("acknowledge m").exit_code, kConnection);
  EXPECT_EQ(Calls(), asked + line(3));
}

TEST_F(MachineActsTest, InputsOfEachKind) {
  const std::pair<const char*, const char*> kKinds[] = {
      {"IL[20]=on", "input { name: \"IL[20]\" value { logical: true } }"},
      {"IL[20]=OFF", "input { name: \"IL[20]\" value { logical: false } }"},
      {"VR[5]=-2.5", "input { name: \"VR[5]\" value { real: -2.5 } }"},
      {"door=open", "door_open: true"},
      {"door=closed", "door_open: false"},
      {"gate=1", "gate: 1"},
      {"gate=2", "gate: 2"},
      {"power=on", "power: true"},
      {"power=off", "power: false"},
      {"emergency-stop=released", "emergency_stop_released: true"}};
  std::string line = "input m";
  std::string call = "SetInputs machine: \"machines/m\" control_token: \"t\"";
  for (const auto& [word, input] : kKinds) {
    line += std::string(" ") + word;
    call += std::string(" inputs { ") + input + " }";
  }
  ExpectDone(line, WithControlFor(call));
}

TEST_F(MachineActsTest, VariablesAreReadAndWritten) {
  AddVariable("VR[5]").mutable_value()->set_real(2.5);
  AddVariable("VI[1]").mutable_value()->set_integer(-7);
  AddVariable("IL[1]").mutable_value()->set_logical(true);
  AddVariable("IL[2]").mutable_value()->set_logical(false);
  AddVariable("NAME").mutable_value()->set_word("a\tb");
  AddVariable("NONE");
  const std::string values =
      "VR[5] = 2.5\nVI[1] = -7\nIL[1] = on\nIL[2] = off\nNAME = a\\x09b\nNONE = -\n";
  Told told = Say("read m VR[5] VI[0..1]");
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(told.output, values);
  EXPECT_EQ(Calls(),
            "ReadVariables machine: \"machines/m\" variables: \"VR[5]\" variables: \"VI[0..1]\"\n");
  told = Say("write m VR[5]=2.5 OL[3]=off");
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(told.output, values);
  EXPECT_EQ(Calls(), WithControlFor("WriteVariables machine: \"machines/m\" control_token: \"t\" "
                                    "variables { name: \"VR[5]\" value { real: 2.5 } } "
                                    "variables { name: \"OL[3]\" value { logical: false } }"));
  v1::Variable& wrong = AddVariable("X");
  wrong.mutable_error()->set_code("OPT-E1");
  wrong.mutable_error()->set_message("it is read only");
  AddVariable("Y").mutable_value()->set_real(1.0);
  for (const char* line : {"read m X", "write m X=1"}) {
    told = Say(line);
    EXPECT_EQ(told.exit_code, kProgramErrors);
    EXPECT_EQ(told.output, values + "Y = 1\n");
    EXPECT_EQ(told.errors, "rmlcell: X: OPT-E1: it is read only\n");
  }
  told = Say("read m X", true);
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(std::ranges::count(told.output, '\n'), 8);
  EXPECT_THAT(told.output, HasSubstr("it is read only"));
  EXPECT_EQ(told.errors, "");
}

// Each state once, and of which job; as JSON each status.
TEST_F(MachineActsTest, AWatchTellsWhatChanges) {
  const auto add = [this](v1::MachineState state, const std::string& job) {
    v1::MachineStatus& status = *machine_.watched.emplace_back().mutable_status();
    status.set_state(state);
    if (!job.empty()) status.mutable_run()->set_job(job);
  };
  add(v1::MACHINE_STATE_IDLE, "");
  add(v1::MACHINE_STATE_IDLE, "");
  machine_.watched.emplace_back();  // no status
  add(v1::MACHINE_STATE_RUNNING, "jobs/1");
  add(v1::MACHINE_STATE_RUNNING, "jobs/2");
  add(v1::MACHINE_STATE_IDLE, "");
  Told told = Say("watch m");
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_EQ(told.output, "IDLE\nRUNNING jobs/1\nRUNNING jobs/2\nIDLE\n");
  EXPECT_EQ(Calls(), "WatchMachine name: \"machines/m\"\n");
  told = Say("watch m", true);
  EXPECT_EQ(std::ranges::count(told.output, '\n'), 5);
  EXPECT_THAT(told.output, StartsWith("{"));
}

class StartVerbTest : public MachineActsTest {
 protected:
  // It runs from its first moment on, so that nobody looks.
  StartVerbTest() { Run().set_run_time_ns(1); }
  v1::MachineRun& Run() { return *machine_.statuses[0].mutable_run(); }
  std::string Started(const std::string& what) {
    return "StartMachine machine: \"machines/m\" control_token: \"t\"" + what;
  }
};

TEST_F(StartVerbTest, AProgramTheSelectedOneOrAJob) {
  ExpectDone("start m", WithControlFor(Started(" selected: true")));
  ExpectDone("start m 1", WithControlFor(Started(" program: 1")));
  ExpectDone("start m 99", WithControlFor(Started(" program: 99")));
  Run().set_job("jobs/17");
  ExpectDone("start m --job 17", WithControlFor(Started(" job: \"jobs/17\"")));
  ExpectDone("start m --job jobs/17", WithControlFor(Started(" job: \"jobs/17\"")));
}

// DEV-1.41: armed by whoever has control, and started before it is given back.
TEST_F(StartVerbTest, SeenArmsTheMachineForItsJob) {
  machine_.armed.set_arm_token("armed");
  Run().set_job("jobs/17");
  ExpectDone("start m --job 17 --seen tool,clamps",
             WithControlFor("GetMachine name: \"machines/m\"\n"
                            "ArmMachine machine: \"machines/m\" control_token: \"t\" "
                            "job: \"jobs/17\" confirmations: CONFIRMATION_TOOL "
                            "confirmations: CONFIRMATION_CLAMPS on_loss: ON_LOSS_GO_ON\n" +
                            Started(" job: \"jobs/17\" arm_token: \"armed\"")));
  machine_.refused["ArmMachine"] = {grpc::StatusCode::FAILED_PRECONDITION, "not here"};
  const Told told = Say("start m --job 17 --seen tool");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: not here\n");
  EXPECT_THAT(Calls(), Not(HasSubstr("StartMachine")));
}

// The queue begins what a machine is armed for, and may be quicker than the command: a run that is
// over since then is that of the command, with its end; an older one is not.
TEST_F(StartVerbTest, WhatTheQueueHasRunMeanwhileHasRun) {
  machine_.armed.set_arm_token("armed");
  machine_.refused["StartMachine"] = {grpc::StatusCode::FAILED_PRECONDITION, "it waits no more"};
  v1::MachineStatus over;
  over.mutable_last_run()->set_run(2);
  over.mutable_last_run()->set_job("jobs/17");
  machine_.statuses = {v1::MachineStatus(), over};
  Told told = Say("start m --job 17 --seen tool");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.errors, "");
  over.mutable_last_run()->mutable_outcome()->set_kind(v1::Outcome::KIND_FAILED);
  machine_.statuses = {v1::MachineStatus(), over};
  EXPECT_EQ(Say("start m --job 17 --seen tool").exit_code, kProgramErrors);
  machine_.statuses = {over, over};
  told = Say("start m --job 17 --seen tool");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: it waits no more\n");
  over.mutable_last_run()->set_job("jobs/18");
  machine_.statuses = {v1::MachineStatus(), over};
  EXPECT_EQ(Say("start m --job 17 --seen tool").exit_code, kConnection);
}

// Until its time has begun: what fails at once does so behind the answer.
TEST_F(StartVerbTest, IsLookedAtUntilItHasBegun) {
  Run().set_run_time_ns(0);
  const v1::MachineStatus begun = machine_.statuses[0];
  machine_.statuses = {begun, begun, begun};
  machine_.statuses[2].mutable_run()->set_run_time_ns(1);
  const std::string look = "\nGetMachine name: \"machines/m\"";
  ExpectDone("start m 7", WithControlFor(Started(" program: 7") + look + look));
  // No longer than that.
  machine_.statuses = {begun};
  std::string looks;
  for (int i = 0; i < 10; ++i) looks += look;
  ExpectDone("start m 7", WithControlFor(Started(" program: 7") + looks));
}

// Whose run was the last one says nothing of a program that nobody's job started.
TEST_F(StartVerbTest, AProgramThatIsOverAtOnceIsNotLookedFor) {
  machine_.statuses[0].clear_run();
  machine_.statuses[0].mutable_last_run()->set_job("jobs/16");
  ExpectDone("start m 7", WithControlFor(Started(" program: 7")));
}

TEST_F(StartVerbTest, ARunThatFailedAtOnceIsNoGoodStart) {
  Run().set_run(8);
  Run().set_run_time_ns(0);
  v1::MachineStatus failed;
  failed.set_machine("machines/m");
  failed.mutable_last_run()->set_run(8);
  failed.mutable_last_run()->mutable_outcome()->set_kind(v1::Outcome::KIND_FAILED);
  const v1::MachineStatus begun = machine_.statuses[0];
  const auto exit_of = [&](const v1::MachineStatus& then) {
    machine_.statuses = {begun, then};
    return Say("start m 7").exit_code;
  };
  EXPECT_EQ(exit_of(failed), kProgramErrors);
  v1::MachineStatus other = failed;
  other.mutable_last_run()->set_run(7);  // of before
  EXPECT_EQ(exit_of(other), kGood);
  other = failed;
  other.mutable_last_run()->mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(exit_of(other), kGood);
  other = failed;
  other.mutable_run()->set_run_time_ns(1);  // the next one runs
  EXPECT_EQ(exit_of(other), kGood);
}

// The queue may be quicker: then its run is looked for, or its end.
TEST_F(StartVerbTest, AJobIsLookedForUntilItsRunIsThere) {
  v1::MachineStatus other = machine_.statuses[0];
  other.mutable_run()->set_job("jobs/16");
  v1::MachineStatus over;
  over.set_machine("machines/m");
  over.mutable_last_run()->set_job("jobs/17");
  machine_.statuses = {other, other, over};
  const std::string look = "\nGetMachine name: \"machines/m\"";
  EXPECT_EQ(Say("start m --job 17").exit_code, kGood);
  EXPECT_EQ(Calls(), WithControlFor(Started(" job: \"jobs/17\"") + look + look));
  machine_.statuses = {other};
  EXPECT_EQ(Say("start m --job 17").exit_code, kGood);
  std::string looks;
  for (int i = 0; i < 50; ++i) looks += look;
  EXPECT_EQ(Calls(), WithControlFor(Started(" job: \"jobs/17\"") + looks));
}

// Control is kept until the axes have found their reference: given back before, they would stand.
TEST_F(MachineActsTest, ZeroingIsAwaited) {
  v1::MachineStatus moves = machine_.statuses[0];
  moves.set_state(v1::MACHINE_STATE_JOGGING);
  machine_.statuses.insert(machine_.statuses.begin(), {moves, moves});
  const std::string call = "ZeroMachine machine: \"machines/m\" control_token: \"t\"";
  const std::string look = "\nRenewControl token t\nGetMachine name: \"machines/m\"";
  ExpectDone("zero m", WithControlFor(call + look + look));
  machine_.statuses = {moves};
  machine_.refused["RenewControl"] = {grpc::StatusCode::PERMISSION_DENIED, "taken"};
  const Told told = Say("zero m");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: taken\n");
  EXPECT_EQ(Calls(), WithControlFor(call + "\nRenewControl token t"));
}

}  // namespace
}  // namespace rmlcell::cli
