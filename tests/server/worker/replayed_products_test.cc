// The products of a run that a machine recorded (live.md 3.41, 6).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include "engine/machine/machine_note.h"
#include "engine/optimo/language/compiler.h"
#include "engine/simulation/run/input_description.h"
#include "proto/bridge/framing.h"
#include "rmlcell/v1/job.pb.h"
#include "tests/server/worker/replayed_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class ReplayedProducts : public ReplayedBed {
 protected:
  // A mill that is to run this stream from its beginning.
  static recording::Recording Run(const std::string& stream,
                                  std::chrono::seconds until = std::chrono::hours(1)) {
    return RecordingOf(
        {.memory = MillWith(stream), .input = machine::StartRun{.program = 5}, .until = until});
  }
};

constexpr const char* kThereAndBack = "PA;PA;VS10;PU200,0;PU0,0;";

TEST_F(ReplayedProducts, AreThoseOfTheRun) {
  const Status made = Make(Run(kThereAndBack));
  ASSERT_TRUE(made) << made.error().detail;
  const v1::RunReport report = Report();
  EXPECT_EQ(report.family(), "rml1");
  EXPECT_EQ(report.profile(), "srm-20");
  EXPECT_EQ(report.outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_GT(report.total().times().cycle_s(), 0.0);
  EXPECT_TRUE(report.inputs().contains("program"));
  EXPECT_THAT(Product("picture.svg"), HasSubstr("<svg"));
  const std::string toolpath = Product("toolpath");
  std::string_view rest = toolpath;
  EXPECT_TRUE(bridge::TakeFrame(rest));
  while (bridge::TakeFrame(rest)) continue;
  EXPECT_TRUE(rest.empty());
}

// The program that was brought is the one that ran, whatever the slot had.
TEST_F(ReplayedProducts, HaveTheProgramThatWasBrought) {
  ASSERT_TRUE(Make(Run(kThereAndBack)));
  const v1::RunReport stored = Report();
  recording::Recording brought = Run(kThereAndBack);
  brought.head.mutable_brought()->set_file_name("other.rml");
  brought.head.mutable_brought()->set_content("PA;PA;VS10;PU2000,0;PU0,0;");
  ASSERT_TRUE(Make(brought));
  EXPECT_GT(Report().total().times().cycle_s(), stored.total().times().cycle_s());
  EXPECT_NE(Report().inputs().at("program"), stored.inputs().at("program"));
}

// Cut off by the end of its host: its outcome is that of the job, and no part is good.
TEST_F(ReplayedProducts, OfARunThatWasCutOff) {
  for (const char* code : {"CELL-E9432", "CELL-E9411"}) {
    recording::Recording recording = Run(kThereAndBack, std::chrono::seconds(3));
    v1::Outcome& outcome = *recording.entries[2].mutable_run_over()->mutable_outcome();
    outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
    outcome.set_code(code);
    outcome.set_message("as the host said");
    const Status made = Make(recording);
    ASSERT_TRUE(made) << made.error().detail;
    const v1::RunReport report = Report();
    EXPECT_EQ(report.outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
    EXPECT_EQ(report.outcome().code(), code);
    EXPECT_EQ(report.outcome().message(), "as the host said");
    EXPECT_EQ(report.outcome().verdict(), v1::VERDICT_BAD);
    std::vector<std::string> reasons;
    for (const v1::VerdictReason& reason : report.outcome().reasons())
      reasons.push_back(reason.code());
    EXPECT_THAT(reasons, testing::Contains(code));
    EXPECT_THAT(Product("picture.svg"), HasSubstr("<svg"));
  }
}

TEST_F(ReplayedProducts, NothingIsMadeOfWhatIsNoWholeRun) {
  EXPECT_THAT(Refused(Run(kThereAndBack, std::chrono::seconds(1))),
              HasSubstr("CELL-E9015 the recording ends before the run does"));
  recording::Recording other = Run(kThereAndBack);
  other.entries[0].mutable_mark()->set_state_sha256("another");
  EXPECT_THAT(Refused(other), HasSubstr("CELL-E9436 entry 1, mark.state_sha256: recorded "));
  other = Run(kThereAndBack);
  other.head.set_family("lathe");
  EXPECT_EQ(Refused(other), "CELL-E9008 'lathe'; there are optimo rml1");
  EXPECT_EQ(MakeProducts(folder_ + "/none", folder_).error().code, ErrorCode::kCellFileUnreadable);
  ASSERT_TRUE(Make(Run(kThereAndBack)));
  EXPECT_EQ(MakeProducts(folder_ + "/recording", folder_ + "/no/folder").error().code,
            ErrorCode::kCellFileUnwritable);
}

// Its report is of what was run, and not of the steps before.
TEST_F(ReplayedProducts, OfAStartAtAStepAreOfWhatWasRun) {
  const machine::MachineMemory memory = MillWith("PA;PA;VS10;PU2000,0;PU2000,2000;PU0,0;");
  const v1::RunReport whole =
      ReportOf({.memory = memory, .input = machine::StartRun{.program = 5}});
  const v1::RunReport rest = ReportOf(
      {.memory = memory,
       .input = machine::StartAtStep{.program = 5,
                                     .target = {.at = {.program = 5, .step = 5}},
                                     .acknowledged = {"clamps", "tool", "origin", "Z0", "table"}}});
  EXPECT_EQ(whole.total().steps(), 6);
  EXPECT_NEAR(whole.total().path_length_mm(), 40.0 + 20.0 + std::sqrt(800.0), 1e-6);
  EXPECT_EQ(rest.total().steps(), 2);
  EXPECT_NEAR(rest.total().path_length_mm(), 20.0 + std::sqrt(800.0), 1e-6);
  EXPECT_LT(rest.total().times().cycle_s(), 3.0);  // 48.3 mm at 30 mm/s, and not what was before
  EXPECT_NEAR(rest.total().times().cycle_s(), rest.total().times().motion_s(), 1e-6);
  EXPECT_EQ(rest.outcome().kind(), v1::Outcome::KIND_COMPLETED);
}

// Where its steps stand in the text, as of a run of a worker; and in which mode it ran.
TEST_F(ReplayedProducts, OfAnOptimoHaveItsStepsAndItsMode) {
  const std::string text = "; a part\nDELAY 1\n\nDELAY 1\n";
  machine::MachineMemory memory;
  memory.programs[5] = {.name = "part",
                        .object = machine::Bytes::Of(optimo::Compile(text, {}, {}).object)};
  std::set<std::string> inputs;
  for (const machine::Mode mode : {machine::Mode::kRemote, machine::Mode::kCycle}) {
    const v1::RunReport report =
        ReportOf({.family = "optimo",
                  .profile = "",
                  .memory = memory,
                  .before = {machine::ChangeMode{mode}},
                  .input = machine::StartRun{.program = 5,
                                             .source = mode == machine::Mode::kCycle
                                                           ? machine::StartSource::kPanel
                                                           : machine::StartSource::kConsole,
                                             .unzeroed = true}});
    EXPECT_EQ(report.outcome().kind(), v1::Outcome::KIND_COMPLETED) << report.outcome().message();
    inputs.insert(report.inputs_hash());
    v1::GetStepMapResponse map;
    ASSERT_TRUE(map.ParseFromString(Product("steps")));
    ASSERT_EQ(map.programs_size(), 1);
    EXPECT_EQ(map.programs(0).object_sha256().size(), 64U);
  }
  EXPECT_EQ(inputs.size(), 2U);
}

// By their inputs two runs are told apart: all that this one began with counts, as for a run of a
// worker that has no budget.
TEST_F(ReplayedProducts, NameAllThatTheRunBeganWith) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::MachineMemory memory;
  memory.programs[5] = {.name = "part",
                        .object = machine::Bytes::Of(optimo::Compile("DELAY 1\n", {}, {}).object)};
  memory.deleted = {7};
  memory.schedules = {{.number = 3, .name = "soft", .mode = "CW", .power_percent = 40.0}};
  const recording::Recording recording = RecordingOf(
      {.family = "optimo",
       .profile = "",
       .memory = memory,
       .before = {machine::ChangeMode{machine::Mode::kRemote}, machine::ChangeOverride{85.0}},
       .input = machine::StartRun{
           .program = 5, .source = machine::StartSource::kConsole, .unzeroed = true}});
  const auto note = machine::ReadMachineNote(recording.entries.front().mark().state());
  ASSERT_TRUE(note);
  machine::RunSetup setup(*machine::MakeParameters(family, "", {}));
  setup.programs = memory.programs;
  setup.deleted_programs = memory.deleted;
  setup.schedules = memory.schedules;
  setup.main_program = 5;
  setup.machine_state = note->family;
  setup.mode = machine::Mode::kRemote;
  setup.override_percent = 85.0;
  setup.budget = {.steps = 0, .virtual_time = SimTime(0)};
  const Status made = Make(recording);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(Report().inputs_hash(), simulation::FingerprintOf(family, setup));
}

// Nor is another run that was begun later.
TEST_F(ReplayedProducts, AreOfTheFirstRunAlone) {
  recording::Recording recording = Run(kThereAndBack);
  ASSERT_TRUE(Make(recording));
  const std::string hash = Report().inputs_hash();
  recording.entries[3].mutable_applied()->mutable_input()->mutable_start()->set_program(6);
  const Status made = Make(recording);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(Report().inputs_hash(), hash);
}

}  // namespace
}  // namespace rmlcell::server
