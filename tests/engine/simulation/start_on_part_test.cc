// The way to a step, against the block that lies on the table of a mill (live.md 6).
#include "engine/simulation/material/milled_part.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/run/recorder.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::simulation {
namespace {

using machine::At;
using testing::AllOf;
using testing::HasSubstr;

// SRM-20: 100 units a mm, Z 0 is as high as it goes. 1 mm deep round a square of 20 mm; the eighth
// command begins at its second corner, the tool in the work.
constexpr const char* kTwoSides =
    "VS10;!VZ8;!PZ-100,200;!RC9;!MC1;PU2010,1510;PD4010,1510;PD4010,3510;PU2010,3510;!MC0;";

class StartOnPart : public machine::StartTest {
 protected:
  StartOnPart() : StartTest("rml1") {}
  double WorkZero() const {
    return (*family_.NewStanding(parameters(), ""))->state().work_origin->z();
  }
  machine::StartPreview On(const char* block, const machine::PartSoFar& so_far,
                           const char* tool = "flat:3", int step = 8) const {
    Milling milling{.stock = ParseStock(block).value(), .tool = ParseTool(tool).value()};
    MilledPart part(milling);
    auto preview = machine::PreviewStart(family_, Setup({kTwoSides}),
                                         {.target = {.at = {1, step}},
                                          .machine_state = StandingState(),
                                          .part = &part,
                                          .part_so_far = so_far},
                                         {});
    EXPECT_TRUE(preview);
    EXPECT_TRUE(preview->part_checked);
    return *std::move(preview);
  }
};

// LIVE-6.07: what the program cut before the step is gone; a new block is in the way, by the depth
// of the cut.
TEST_F(StartOnPart, WhatIsCutBeforeIsNotInTheWay) {
  EXPECT_TRUE(On("60x60x5", {}).may_begin());
  const machine::StartPreview new_block = On("60x60x5", {.untouched = true});
  EXPECT_THAT(FirstRefusal(new_block),
              AllOf(HasSubstr("CELL-E9427"),
                    HasSubstr("motion 2 of the approach goes 1.000 mm into the part")));
  EXPECT_EQ(new_block.approach[0].into_part_mm, 0.0);
  // Of a block that lies elsewhere.
  EXPECT_TRUE(On("5x5x5@60,60,0", {.untouched = true}).may_begin());
}

// LIVE-6.07: a run that was cut off has cut what it came to, and no more.
TEST_F(StartOnPart, ARunThatWasCutOffLeftTheRest) {
  const SimTime there = On("60x60x5", {}).run_time;
  EXPECT_TRUE(On("60x60x5", {.cut_until = there}).may_begin());
  // It had not come to the second corner: 1 s and 10 mm short of it.
  const machine::StartPreview short_of = On("60x60x5", {.cut_until = there - At(1.0)});
  EXPECT_THAT(FirstRefusal(short_of), HasSubstr("motion 2 of the approach goes 1.000 mm"));
  EXPECT_TRUE(On("60x60x5", {.cut_until = there + At(100.0)}).may_begin());
  EXPECT_FALSE(On("60x60x5", {.cut_until = SimTime(0)}).may_begin());
}

// LIVE-6.07: the way across is as high as the mill goes, which is too low for this block; and a
// shank that is wider than its cutter goes where that was not.
TEST_F(StartOnPart, TheWayAcrossAndTheShankCount) {
  // Its first corner is reached 2 mm above the work; the way there is at the top.
  const double top = On("60x60x5", {}, "flat:3", 7).approach[0].to.column.z() - WorkZero();
  const std::string block =
      "60x60x" + std::to_string(top + 8.0) + "@0,0," + std::to_string(top + 3.0);
  const machine::StartPreview high = On(block.c_str(), {.untouched = true}, "flat:3", 7);
  EXPECT_EQ(high.approach[0].path, "PU");
  EXPECT_NEAR(high.approach[0].into_part_mm, 3.0, 1e-5);
  EXPECT_NEAR(high.approach[1].into_part_mm, top + 1.0, 1e-5);
  const machine::StartPreview shank = On("60x60x5", {}, "flat:3:flute=0.4:shank=6");
  EXPECT_NEAR(shank.approach[1].into_part_mm, 0.6, 1e-6);
  EXPECT_FALSE(shank.may_begin());
}

// LIVE-6.07: nobody who knows the part: nothing is said about it.
TEST_F(StartOnPart, WithoutAPartNothingIsLookedAt) {
  const machine::StartPreview preview = PreviewOf(Setup({kTwoSides}), {.at = {1, 8}});
  EXPECT_FALSE(preview.part_checked);
  EXPECT_TRUE(preview.may_begin());
}

// What is reported of a run of kTwoSides that begins at its eighth command; it is ended at `until`.
class EnteredReport : public machine::StartTest {
 protected:
  EnteredReport() : StartTest("rml1") {}
  RunReport ReportOf(SimTime until) {
    machine::MachineMemory memory;
    memory.programs[1] = Translated(kTwoSides);
    Recorder recorder(family_.Shape(parameters()), {}, {});
    machine = *machine::Machine::Make(family_, parameters(), std::move(memory), "", recorder);
    Good(At1(8));
    recorder.Begin(*machine->open_run());
    GoOn(machine->time() + until);
    if (machine->open_run() != nullptr) {
      Good(machine::AbortRun{});
      GoOn(machine->time() + At(20.0));
    }
    const machine::RunOver over = Over();
    recorder.Finish(*over.ended);
    RunReport report = recorder.Report(*over.ended);
    EXPECT_EQ(over.worked, report.cycle_time);  // as its job is told
    return report;
  }
};

// LIVE-6.09: from the second corner one side of 20 mm is cut, and one passed over, 3 mm higher,
// then the spindle runs down for 2 s. The way to that corner, and the spindle that starts on it,
// are in no figure.
TEST_F(EnteredReport, TheApproachIsNotCounted) {
  const RunReport report = ReportOf(At(500.0));
  EXPECT_EQ(report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_NEAR(report.total.cut_mm, 20.0, 1e-9);
  EXPECT_NEAR(report.total.travel_mm, 23.0, 1e-9);
  EXPECT_EQ(report.total.plunges, 0U);
  EXPECT_EQ(report.total.time.spin_up, At(2.0));
  EXPECT_EQ(report.total.steps, 3U);
  EXPECT_EQ(report.cycle_time, report.total.time.motion + At(2.0));
  EXPECT_GT(report.total.time.motion, At(2.0));  // 20 mm at 10 mm/s
  EXPECT_LT(report.total.time.motion, At(6.0));
  // The mill's own figures are of the same time.
  double up_and_down_s = 0.0;
  for (const machine::Figure& figure : report.figures) {
    if (figure.name == "tool_up_time" || figure.name == "tool_down_time")
      up_and_down_s += figure.value;
  }
  EXPECT_NEAR(up_and_down_s, ToSeconds(report.cycle_time), 1e-9);
}

// LIVE-6.09: one that never came to its step has done nothing.
TEST_F(EnteredReport, AnApproachAloneIsNothing) {
  const RunReport report = ReportOf(At(0.3));
  EXPECT_EQ(report.outcome.kind, machine::OutcomeKind::kCancelled);
  EXPECT_EQ(report.cycle_time, SimTime(0));
  EXPECT_EQ(report.total, WorkFigures());
}

// LIVE-6.07: where it takes too long to see what is left of the part, nothing is said about it.
TEST_F(StartOnPart, WhatCutsThePartIsGivenUp) {
  Milling milling{.stock = ParseStock("60x60x5").value(), .tool = ParseTool("flat:3").value()};
  std::vector<std::string> said;
  for (int most = 0; most < 10; ++most) {
    MilledPart part(milling);
    int asked = 0;
    const auto preview = machine::PreviewStart(
        family_, Setup({kTwoSides}),
        {.target = {.at = {1, 8}}, .machine_state = StandingState(), .part = &part},
        {.go_on = [&] { return asked++ < most; }});
    if (!preview) said.push_back(CodeText(preview.error().code) + " " + preview.error().detail);
  }
  EXPECT_THAT(said, testing::Contains("CELL-E9426 what cuts the part takes too long to be seen"));
}

}  // namespace
}  // namespace rmlcell::simulation
