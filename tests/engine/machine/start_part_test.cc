// The part on the table, as a preview sees it: what cuts it until now, and where the approach goes
// through it. LIVE-6.07. And how long a run to a step is gone on with.
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

// Tells what it is asked, and has a depth for each way.
class SeenPart final : public PartOnTable {
 public:
  struct Way {
    motion::MachinePoint from;
    motion::MachinePoint to;
  };
  void BeginAt(const motion::MachinePoint& /*work_origin*/,
               const motion::MachinePoint& at) override {
    begun.push_back(at);
  }
  void EndAt(const motion::MachinePoint& at) override { ended.push_back(at); }
  double DepthOf(const motion::MachinePoint& from, const motion::MachinePoint& to) const override {
    ways.push_back({from, to});
    return depth;
  }
  void OnStep(SimTime /*at*/, const Place& /*place*/, std::string_view /*name*/) override {
    ++steps;
  }

  std::vector<motion::MachinePoint> begun;
  std::vector<motion::MachinePoint> ended;
  mutable std::vector<Way> ways;
  double depth = 0.0;
  std::uint64_t steps = 0;
};

constexpr const char* kFarMove =
    "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\nDELAY 10\n"
    "MOVE (621.02, 2301.2, -350., 0.2, 0.3)\nVI[1]=1\n";

class StartPart : public StartTest {
 protected:
  Result<StartPreview> Asked(const RunSetup& setup, const StepTarget& target,
                             const PartSoFar& so_far, const ReachLimits& limits = {}) {
    return PreviewStart(family_, setup,
                        {.target = target,
                         .off_until_work_on = true,
                         .machine_state = StandingState(),
                         .part = &part,
                         .part_so_far = so_far},
                        limits);
  }

  SeenPart part;
};

// Each motion of the approach goes from where the one before it ended, the first from where the
// machine stands; the run to the step cuts it, or nothing does.
TEST_F(StartPart, TheApproachIsLookedAtWayByWay) {
  const RunSetup setup = Setup({kFarMove});
  for (const bool untouched : {false, true}) {
    part = SeenPart();
    const Result<StartPreview> preview = Asked(setup, {.at = {1, 7}}, {.untouched = untouched});
    ASSERT_TRUE(preview);
    EXPECT_TRUE(preview->part_checked);
    ASSERT_GE(preview->approach.size(), 2U);
    ASSERT_EQ(part.ways.size(), preview->approach.size());
    motion::MachinePoint at =
        (*family_.NewStanding(parameters(), StandingState()))->state().axes.column;
    ASSERT_EQ(part.begun.size(), 1U);
    EXPECT_EQ(part.begun[0], at);
    for (std::size_t k = 0; k < part.ways.size(); ++k) {
      EXPECT_EQ(part.ways[k].from, at) << k;
      at = preview->approach[k].to.column;
      EXPECT_EQ(part.ways[k].to, at) << k;
    }
    EXPECT_NE(part.ways.front().from, part.ways.front().to);
    EXPECT_EQ(part.steps > 0, !untouched);
    EXPECT_TRUE(part.ended.empty());
  }
}

// How deep is told; half a millimetre is in the way as well.
TEST_F(StartPart, LittleIsInTheWayToo) {
  part.depth = 0.5;
  const Result<StartPreview> preview = Asked(Setup({kFarMove}), {.at = {1, 7}}, {});
  ASSERT_TRUE(preview);
  ASSERT_EQ(preview->refusals.size(), preview->approach.size());
  for (std::size_t k = 0; k < preview->refusals.size(); ++k) {
    EXPECT_EQ(preview->refusals[k].code, ErrorCode::kCellApproach);
    EXPECT_THAT(preview->refusals[k].detail,
                HasSubstr("motion " + std::to_string(k + 1) +
                          " of the approach goes 0.500 mm into the part"));
  }
}

// What was cut off in the middle of a motion has cut as far as it came.
TEST_F(StartPart, ACutOffRunHasCutToWhereItStood) {
  const RunSetup setup = Setup({kFarMove});
  WholeRun whole;
  auto run = family_.NewRun(setup, whole);
  ASSERT_TRUE(run);
  (*run)->Advance(At(1.5));
  const motion::MachinePoint there = (*run)->state().axes.column;
  ASSERT_NE(there, part.begun.empty() ? motion::MachinePoint() : part.begun[0]);
  ASSERT_TRUE(Asked(setup, {.at = {1, 7}}, {.cut_until = At(1.5)}));
  ASSERT_EQ(part.ended.size(), 1U);
  EXPECT_EQ(part.ended[0], there);
  EXPECT_EQ(part.steps, whole.steps.size());
}

// LIVE-6.01: no more steps than that are gone for it, though it was cut off later.
TEST_F(StartPart, AnEndlessRunIsNotCutToItsEnd) {
  const RunSetup setup = Setup({"DELAY 1\n100 DELAY 1\nGOTO 100\n"});
  ASSERT_TRUE(Asked(setup, {.at = {1, 2}}, {.cut_until = At(2000.0)}, {.steps_max = 500}));
  EXPECT_GE(part.steps, 400U);
  EXPECT_LE(part.steps, 501U);
}

// LIVE-6.07: where nobody waits until it is cut, that is said, and not that it may begin.
TEST_F(StartPart, WhatIsNotCutInTimeIsTold) {
  const RunSetup setup = Setup({kFarMove});
  const ReachLimits until_cut{.go_on = [this] { return part.begun.empty(); }};
  const auto told = [&](const PartSoFar& so_far) {
    part = SeenPart();
    const Result<StartPreview> preview = Asked(setup, {.at = {1, 7}}, so_far, until_cut);
    EXPECT_EQ(part.begun.size(), 1U);
    if (preview) return std::string("it was looked at");
    EXPECT_EQ(preview.error().code, ErrorCode::kCellStepUnreachable);
    return std::string(preview.error().detail);
  };
  EXPECT_EQ(told({.cut_until = At(1.5)}), "where it was cut off takes longer than is looked for");
  EXPECT_EQ(told({}), "what cuts the part takes too long to be seen");
  EXPECT_EQ(told({.untouched = true}), "it was looked at");
}

// LIVE-6.04: the nearest clean step has its pass, the second one, too.
TEST_F(StartPart, ACleanStepOfTheSecondPassIsNamed) {
  const RunSetup setup = Setup(
      {"COORD ABSOL\nPATH LIN\nSPEED 20\nWORKDEF 1,0 (8.,75.,.2,50.)\nVI[2]=0\n100 VI[2]=VI[2]+1\n"
       "WORK 1,0/ON\nMOVE (521.02+VI[2], 2201.2, -350., 0., 0.)\nWORK 1,0/OFF\n"
       "IF VI[2] < 3 THEN 100\n"});
  const StartPreview preview = PreviewOf(setup, {.at = {1, 8}, .occurrence = 2}, false);
  ASSERT_EQ(preview.clean_before, (StepTarget{.at = {1, 7}, .occurrence = 2}));
  EXPECT_THAT(FirstRefusal(preview),
              HasSubstr("; clean before: 1/7, 2. time; clean behind: 1/10, 2. time"));
  EXPECT_THAT(FirstRefusal(PreviewOf(setup, {.at = {1, 8}}, false)),
              HasSubstr("; clean before: 1/7; clean behind: 1/10"));
}

// LIVE-6.01: who was cut off behind a halt that somebody ended: it is ended for him, at once.
TEST_F(StartPart, TheOccurrenceBehindAHalt) {
  const RunSetup setup = Setup({"DELAY 2\nPAUSE\n100 DELAY 1\nVI[2]=VI[2]+1\nGOTO 100\n"});
  EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 3}, At(5.5), {}), 4U);
}

// LIVE-6.04: where a WORK is ON whose beam is not, nothing is missing of what the next one cuts.
TEST_F(StartPart, WithoutABeamNoCutIsMissing) {
  RunSetup setup = Setup(
      {"COORD ABSOL\nPATH LIN\nSPEED 20\nWORKDEF 1,0 (8.,75.,.2,50.)\nWORKDEF 2,0 (11)\nWORK 2,0/ON\n"
       "MOVE (521.02, 2201.2, -350., 0., 0.)\nWORK 1,0/ON\nMOVE (561.02, 2201.2, -350., 0., 0.)\n"
       "WORK 1,0/OFF\nWORK 2,0/OFF\n"});
  setup.schedules = {{.number = 11}};
  const auto missing = [&](int step) { return PreviewOf(setup, {.at = {1, step}}).missing_cut_mm; };
  EXPECT_EQ(missing(7), 0.0);
  EXPECT_NEAR(missing(9), 40.0, 1e-3);
}

// LIVE-6.04: what is missing goes on until the beam is off: an output that is switched off
// meanwhile ends nothing.
TEST_F(StartPart, TheMissingCutEndsWithItsBeam) {
  const RunSetup setup = Setup(
      {"COORD ABSOL\nPATH LIN\nSPEED 20\nWORKDEF 1,0 (8.,75.,.2,50.)\nOL[11]=ON\n"
       "MOVE (521.02, 2201.2, -350., 0., 0.)\nWORK 1,0/ON\nMOVE (561.02, 2201.2, -350., 0., 0.)\n"
       "OL[11]=OFF\nMOVE (601.02, 2201.2, -350., 0., 0.)\nWORK 1,0/OFF\nVI[1]=1\n"});
  EXPECT_NEAR(PreviewOf(setup, {.at = {1, 8}}).missing_cut_mm, 80.0, 1e-3);
}

// The run that came to a step goes on by itself: nobody looks at its steps any more.
TEST_F(StartPart, TheRunThatCameThereGoesOn) {
  const RunSetup setup = Setup({kFarMove});
  const StepReach reach = Reach(setup, {.at = {1, 5}});
  reach.run->enterable()->ForgetTarget();
  reach.run->Apply({.at = reach.run->state().time, .kind = InputKind::kStart, .value = 1.0});
  while (reach.run->Advance(reach.run->state().time + At(60.0)) == RunPhase::kRunning) {
  }
  EXPECT_EQ(reach.run->state().phase, RunPhase::kFinished);
  EXPECT_EQ(reach.run->ReadVariable("VI[1]")->text, "1");
}

}  // namespace
}  // namespace rmlcell::machine
