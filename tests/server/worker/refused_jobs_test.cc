// Jobs that end before anything runs, and recordings of which nothing is made (worker.proto,
// live.md 3.41).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "tests/server/worker/replayed_bed.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class RefusedJobs : public JobRunnerTest {
 protected:
  void ExpectRefused(const v1::WorkerAssignment& assignment, const std::string& code,
                     const std::string& why) {
    Work(assignment);
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED) << why;
    EXPECT_EQ(Outcome().code(), code) << why;
    EXPECT_THAT(Outcome().message(), HasSubstr(why));
    EXPECT_THAT(Names(), IsEmpty()) << why;
  }
};

TEST_F(RefusedJobs, AnInputBeforeTheBeginEndsTheJob) {
  for (const v1::JobKind kind : {v1::JOB_KIND_CHECK, v1::JOB_KIND_SIMULATE}) {
    v1::WorkerAssignment assignment = Assignment(kind, "STOP\n");
    assignment.mutable_job()->mutable_simulation()->add_inputs()->set_virtual_time_ns(-1);
    ExpectRefused(assignment, CodeText(ErrorCode::kCellInvalidArgument),
                  "virtual_time_ns must be 0 or later");
  }
}

TEST_F(RefusedJobs, MoreThanAThousandVariablesEndTheJob) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "STOP\n");
  for (int i = 0; i < 1'001; ++i)
    assignment.mutable_job()->mutable_simulation()->add_variables("VI[" + std::to_string(i) + "]");
  ExpectRefused(assignment, CodeText(ErrorCode::kCellInvalidArgument),
                "variables: more than 1,000");
}

TEST_F(RefusedJobs, ACheckOfASlotWithoutAProgramFails) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_CHECK, "STOP\n");
  assignment.set_main_program(46);
  ExpectRefused(assignment, CodeText(families::FindFamily("optimo")->info().empty_slot),
                "program 46");
}

TEST_F(RefusedJobs, AMachineWhoseStateCannotBeReadRunsNothing) {
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "PA;PU100,0;", "rml1");
  assignment.set_machine_state("no state");
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED);
  EXPECT_THAT(Outcome().code(), testing::Not(IsEmpty()));
  EXPECT_THAT(Names(), IsEmpty());
}

// Nobody waits for the rest of a program behind a line that is gone.
TEST_F(RefusedJobs, AProgramThatDoesNotComeIsNotWaitedFor) {
  server.lease_ms = 30;
  v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, "");
  assignment.mutable_programs(0)->set_size(10);
  bool sent = false;
  server.heard = [&](const v1::WorkRequest& message) {
    if (message.has_heartbeat() && !std::exchange(sent, true)) server.HangUp();
  };
  EXPECT_TRUE(Work(assignment));
  EXPECT_FALSE(Finished());
}

// SimulationOptions.toolpath_tolerance_mm: an arc has the fewer points the coarser it may be.
TEST_F(RefusedJobs, AToolpathIsAsFineAsTheJobWantsIt) {
  const auto toolpath = [this](double tolerance_mm) {
    v1::WorkerAssignment assignment =
        Assignment(v1::JOB_KIND_SIMULATE,
                   "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)\nPATH CIR\n"
                   "MOVE (1200.,900.,-500.,0.,0.)/VIA (1100.,1000.,-500.,0.,0.)\n");
    assignment.mutable_job()->mutable_simulation()->set_toolpath_tolerance_mm(tolerance_mm);
    Work(assignment);
    EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED) << Outcome().message();
    return Artifacts()["toolpath"].size();
  };
  const std::size_t usual = toolpath(0.0);
  EXPECT_LT(toolpath(5.0), usual);
  EXPECT_GT(toolpath(0.001), usual);
}

class RefusedRecordings : public ReplayedBed {
 protected:
  static recording::Recording ThereAndBack() {
    return RecordingOf({.memory = MillWith("PA;PA;VS10;PU200,0;PU0,0;"),
                        .input = machine::StartRun{.program = 5}});
  }
  // After one second, in the middle of the run.
  static recording::Recording With(const v1::AppliedInput& input) {
    recording::Recording recording = ThereAndBack();
    v1::JournalEntry entry;
    entry.set_sequence(3);
    entry.set_virtual_time_ns(1'000'000'000);
    *entry.mutable_applied()->mutable_input() = input;
    recording.entries.insert(recording.entries.begin() + 2, entry);
    recording.entries[3].set_sequence(4);
    recording.entries[4].set_sequence(5);
    return recording;
  }
};

TEST_F(RefusedRecordings, WhatIsNoRecordingIsRefused) {
  std::ofstream(folder_ + "/recording", std::ios::binary) << "a letter";
  const Status made = MakeProducts(folder_ + "/recording", folder_);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(made.error().detail, "byte 0 of the recording: it does not begin as one");
}

TEST_F(RefusedRecordings, OneWhoseMachineCannotBeReadIsRefused) {
  recording::Recording recording = ThereAndBack();
  recording.entries.front().mutable_mark()->set_state("no state");
  EXPECT_EQ(Refused(recording),
            CodeText(ErrorCode::kCellBadText) + " this is no state of a machine of this version");
}

TEST_F(RefusedRecordings, OneWhoseProgramCannotBeTranslatedIsRefused) {
  recording::Recording recording =
      RecordingOf({.family = "optimo", .profile = "", .input = machine::StartRun{.program = 5}});
  v1::AssignedProgram& brought = *recording.head.mutable_brought();
  brought.set_file_name("part.S");
  brought.set_is_source(true);
  brought.set_content("SPEED 101\n");
  EXPECT_THAT(Refused(recording), StartsWith("OPT-E7004"));
}

TEST_F(RefusedRecordings, OneWithAnInputThatSaysNothingIsRefused) {
  v1::AppliedInput input;
  input.mutable_from_outside();
  EXPECT_EQ(Refused(With(input)),
            CodeText(ErrorCode::kCellBadText) + " entry 3: inputs: one of them says nothing");
}

TEST_F(RefusedRecordings, AProductThatCannotBeWrittenIsNamed) {
  for (const char* name : {"toolpath", "report", "picture.svg"}) {
    const std::string file = folder_ + "/" + name;
    std::filesystem::remove_all(file);
    std::filesystem::create_directories(file);
    EXPECT_EQ(Refused(ThereAndBack()), CodeText(ErrorCode::kCellFileUnwritable) + " " + file);
    std::filesystem::remove_all(file);
  }
}

// Nor is one written for which there is no room.
TEST_F(RefusedRecordings, AProductWithoutRoomIsNamed) {
  for (const char* name : {"toolpath", "report", "picture.svg"}) {
    const std::string file = folder_ + "/" + name;
    std::filesystem::remove_all(file);
    std::filesystem::create_symlink("/dev/full", file);
    EXPECT_EQ(Refused(ThereAndBack()), CodeText(ErrorCode::kCellFileUnwritable) + " " + file);
    std::filesystem::remove_all(file);
  }
}

// LIVE-5.08: a mill has no number for it; its run has failed all the same.
TEST_F(RefusedRecordings, ARunThatAnEmergencyStopEndedHasFailed) {
  const Status made = Make(With(bridge::AppliedOf(machine::EmergencyStop{})));
  ASSERT_TRUE(made) << made.error().detail;
  const v1::Outcome outcome = Report().outcome();
  const std::string code = CodeText(ErrorCode::kCellEmergencyStop);
  EXPECT_EQ(outcome.kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(outcome.code(), code);
  EXPECT_EQ(outcome.verdict(), v1::VERDICT_BAD);
  std::vector<std::string> reasons;
  for (const v1::VerdictReason& reason : outcome.reasons()) reasons.push_back(reason.code());
  EXPECT_THAT(reasons, Contains(code));
}

}  // namespace
}  // namespace rmlcell::server
