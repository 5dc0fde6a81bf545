// `rmlcell machine start-at`: what it would do is shown before it is done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct FakeDecision final : v1::JobService::Service {
  explicit FakeDecision(CallNotes& notes) : calls(notes) {}
  grpc::Status DecideInterrupted(grpc::ServerContext*, const v1::DecideInterruptedRequest* request,
                                 v1::DecideInterruptedResponse* response) override {
    calls.Add("DecideInterrupted", *request);
    response->set_job("jobs/18");
    return refusal;
  }
  CallNotes& calls;
  grpc::Status refusal{};
};

class StartAtTest : public MachineWords {
 protected:
  StartAtTest() {
    server_.reset();
    server_ =
        std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&machine_, &decision_});
    machine_.statuses[0].set_machine("machines/m");
    machine_.statuses[0].set_state(v1::MACHINE_STATE_IDLE);
    machine_.preview.set_preview_token("p");
  }
  ~StartAtTest() override { server_.reset(); }  // before decision_
  void CutOff(const std::string& job) {
    machine_.statuses[0].set_state(v1::MACHINE_STATE_INSPECT);
    machine_.statuses[0].set_cut_off_job(job);
  }
  void Ask(v1::Confirmation confirmation) {
    v1::StartDifference& made = *machine_.preview.add_differences();
    made.set_action(v1::START_ACTION_ASK);
    made.set_confirmation(confirmation);
  }
  static std::string Preview(const std::string& what) {
    return "GetMachine name: \"machines/m\"\nPreviewStart machine: \"machines/m\" " + what + "\n";
  }
  static std::string Start(const std::string& what = {}) {
    return WithControlFor(
        "StartAtStep machine: \"machines/m\" control_token: \"t\" preview_token: \"p\"" + what);
  }
  static constexpr const char* kStep = "step { program: 45 step: 10 } approach: APPROACH_SAFE";

  FakeDecision decision_{calls_};
};

TEST_F(StartAtTest, IsPreviewedAndStarted) {
  const Told told = Say("start-at m 45/10");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "machines/m  IDLE; it does not live: rmlcell machine enable\n");
  EXPECT_EQ(Calls(), Preview(kStep) + Start());
  EXPECT_EQ(Say("start-at m 45/10 --preview").output, "");
  EXPECT_EQ(Calls(), Preview(kStep));
  Say("start-at m 45/10 --halt");
  EXPECT_EQ(Calls(), Preview(kStep) + Start(" halt_at_entry: true"));
  Say("start-at m 45/10 --no-halt");
  EXPECT_EQ(Calls(), Preview(kStep) + Start(" halt_at_entry: false"));
}

TEST_F(StartAtTest, AsksForWhatIsWanted) {
  Say("start-at m 3 --preview --slot 99 --occurrence 2 --direct --off-until-work-on");
  EXPECT_EQ(Calls(), Preview("step { step: 3 } occurrence: 2 approach: APPROACH_DIRECT "
                             "program: 99 off_until_work_on: true"));
  Say("start-at m 3 --preview --stock 100x80x10 --tool flat:3 --untouched");
  const std::string block = Calls();
  EXPECT_THAT(block, HasSubstr("size_x_mm: 100 size_y_mm: 80 size_z_mm: 10"));
  EXPECT_THAT(block, testing::EndsWith(" part_so_far: PART_SO_FAR_UNTOUCHED\n"));
  Say("start-at m 3 --preview --stock 100x80x10 --tool flat:3");
  EXPECT_THAT(Calls(), Not(HasSubstr("part_so_far")));
}

TEST_F(StartAtTest, WrongUseAsksForNoStart) {
  const auto expect = [&](const std::string& line, const std::string& error,
                          const std::string& calls) {
    const Told told = Say("start-at m " + line);
    EXPECT_EQ(told.exit_code, kUsage) << line;
    EXPECT_THAT(told.errors, HasSubstr(error)) << line;
    EXPECT_EQ(Calls(), calls) << line;
  };
  expect("x", "rmlcell: 'x' is no step: PROGRAM/STEP, such as 45/10, or a step\n", "");
  expect("45/10 --seen toll", "rmlcell: --seen 'toll': nothing is called so; see --help\n", "");
  expect("", "rmlcell: name a step: PROGRAM/STEP, such as 45/10; no run was cut off here\n",
         "GetMachine name: \"machines/m\"\n");
  expect("45/10 --slot 100", "--slot", "");
  expect("45/10 --slot 0", "--slot", "");
  expect("45/10 --halt --no-halt", "--halt", "");
  expect("45/10 --stock 1x1x1", "--tool", "");
  expect("45/10 --stock 1x1 --tool flat:3", "CELL-E", "GetMachine name: \"machines/m\"\n");
}

// What must be looked at is asked for once, and goes with the start when it is said.
TEST_F(StartAtTest, NothingStartsUnseen) {
  Ask(v1::CONFIRMATION_CLAMPS);
  Ask(v1::CONFIRMATION_TOOL);
  Ask(v1::CONFIRMATION_CLAMPS);
  machine_.preview.add_differences()->set_confirmation(v1::CONFIRMATION_COVER);  // not asked
  Told told = Say("start-at m 45/10");
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(told.errors, "rmlcell: look at clamps,tool and say so: --seen clamps,tool\n");
  EXPECT_EQ(Calls(), Preview(kStep));
  told = Say("start-at m 45/10 --seen tool");
  EXPECT_EQ(told.errors, "rmlcell: look at clamps and say so: --seen clamps\n");
  Calls();
  EXPECT_EQ(Say("start-at m 45/10 --seen tool,clamps").exit_code, kGood);
  EXPECT_EQ(Calls(), Preview(kStep) + Start(" confirmations: CONFIRMATION_CLAMPS"
                                            " confirmations: CONFIRMATION_TOOL"
                                            " confirmations: CONFIRMATION_CLAMPS"));
}

TEST_F(StartAtTest, WhatMayNotStartDoesNot) {
  machine_.preview.clear_preview_token();
  Told told = Say("start-at m 45/10");
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(Calls(), Preview(kStep));
  machine_.refused["PreviewStart"] = {grpc::StatusCode::FAILED_PRECONDITION, "it runs"};
  told = Say("start-at m 45/10");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: it runs\n");
}

TEST_F(StartAtTest, ThePreviewIsTold) {
  v1::StartDifference& one = *machine_.preview.add_differences();
  one.set_item("OL[3]");
  one.set_there("on");
  one.set_now("off");
  one.set_action(v1::START_ACTION_SWITCH);
  v1::ApproachMotion& motion = *machine_.preview.add_approach();
  motion.set_path("up");
  v1::AxisValue& axis = *motion.add_to();
  axis.set_axis("Z");
  axis.set_value(1.5);
  axis.set_unit(v1::UNIT_MILLIMETRE);
  motion.add_findings()->set_message("through the part");
  machine_.preview.set_missing_cut_mm(2.25);
  v1::Diagnostic& refusal = *machine_.preview.add_refusals();
  refusal.set_code("OPT-E1");
  refusal.set_message("within a contour");
  machine_.preview.mutable_clean_before()->set_program(45);
  machine_.preview.mutable_clean_before()->set_step(8);
  machine_.preview.mutable_clean_after()->set_program(45);
  machine_.preview.mutable_clean_after()->set_step(12);
  const std::string table =
      "ITEM   THERE  NOW  DONE ABOUT IT\n"
      "OL[3]  on     off  SWITCH\n";
  const std::string approach = "approach  up  Z 1.500 mm\n";
  const std::string clean = "left out  2.250 mm of cut\nclean before: 45/8\nclean behind: 45/12\n";
  Told told = Say("start-at m 45/10 --preview");
  EXPECT_EQ(told.output, table + approach + "          not checked against the part\n" + clean);
  EXPECT_EQ(told.errors, "rmlcell: up: through the part\nrmlcell: OPT-E1: within a contour\n");
  machine_.machine.set_family("rml1");
  machine_.preview.set_part_checked(true);
  EXPECT_EQ(Say("start-at m 45/10 --preview").output,
            table + "          places in units of the program\n" + approach +
                "          checked against the part\n" + clean);
  // Where it may start nobody looks for another step.
  machine_.preview.clear_refusals();
  EXPECT_THAT(Say("start-at m 45/10 --preview").output, Not(HasSubstr("clean")));
  EXPECT_THAT(Say("start-at m 45/10 --preview", true).output, StartsWith("{"));
}

// It was inspected, and somebody says so; its run is that of no job.
TEST_F(StartAtTest, BehindARunThatWasCutOff) {
  CutOff("");
  const std::string preview = Preview("step { } approach: APPROACH_SAFE");
  Told told = Say("start-at m");
  EXPECT_EQ(told.exit_code, kProgramErrors);
  EXPECT_EQ(told.errors, "rmlcell: look at inspected and say so: --seen inspected\n");
  EXPECT_EQ(Calls(), preview);
  EXPECT_EQ(Say("start-at m --seen inspected").exit_code, kGood);
  EXPECT_EQ(Calls(), preview + Start(" confirmations: CONFIRMATION_INSPECTED"));
}

// LIVE-5.10
TEST_F(StartAtTest, AJobThatWasCutOffGoesOnAsANewOne) {
  CutOff("jobs/17");
  const std::string decided =
      "DecideInterrupted name: \"jobs/17\" control_token: \"t\" decision: DECISION_RESUME_AT_STEP "
      "reason: \"resumed at a step\" preview_token: \"p\" "
      "confirmations: CONFIRMATION_INSPECTED";
  Told told = Say("start-at m 45/10 --seen inspected");
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_EQ(told.output, "jobs/18 goes on with jobs/17\n");
  EXPECT_EQ(Calls(), Preview(kStep) + WithControlFor(decided));
  Say("start-at m 45/10 --seen inspected --reason dull --no-halt");
  EXPECT_THAT(Calls(), AllOf(HasSubstr("reason: \"dull\""), HasSubstr(" halt_at_entry: false\n")));
  Say("start-at m 45/10 --seen inspected --halt");
  EXPECT_THAT(Calls(), HasSubstr(" halt_at_entry: true\n"));
  EXPECT_THAT(Say("start-at m 45/10 --seen inspected", true).output, HasSubstr("\"jobs/18\""));
  decision_.refusal = {grpc::StatusCode::ABORTED, "decided"};
  told = Say("start-at m 45/10 --seen inspected");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: decided\n");
}

}  // namespace
}  // namespace rmlcell::cli
