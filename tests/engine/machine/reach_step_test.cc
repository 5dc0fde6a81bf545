// What is there before a step (live.md 6): the same as in the whole run, of every step.
#include "engine/machine/reach_step.h"

#include <fstream>
#include <iterator>
#include <map>

#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

// Before each step, of a run that halts behind each: an own way to the same.
struct Traced {
  std::map<std::string, std::string> values;
  std::vector<ModalValue> modal;
  motion::AxisPose axes;
};

std::vector<std::string> NamesOf(const MachineFamily& family) {
  if (family.info().id == "rml1") {
    return {"X",  "Y",   "Z",       "LX", "LY", "LZ", "VS",   "VZ",   "DW",
            "MC", "RPM", "SPINDLE", "Z0", "Z1", "Z2", "MODE", "TOOL", "ERR"};
  }
  std::vector<std::string> names;
  for (int i = 0; i <= 99; ++i) {
    for (const char* group : {"VR", "VI", "VL", "IL", "OL", "OA"})
      names.push_back(std::string(group) + "[" + std::to_string(i) + "]");
  }
  return names;
}

std::string Published(const std::string& name) {
  std::ifstream file(std::string(RMLCELL_SHARED_DIR) + "/corpus/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Traced Look(const Run& run, const std::vector<std::string>& names) {
  Traced traced{.values = {}, .modal = run.modal_values(), .axes = run.state().axes};
  for (const std::string& name : names) traced.values[name] = run.ReadVariable(name)->text;
  return traced;
}

class ReachTest : public StartTest {
 protected:
  explicit ReachTest(std::string_view family = "optimo") : StartTest(family) {}

  void EveryStep(const std::vector<std::string>& programs, bool may_fail = false) {
    const RunSetup setup = Setup(programs);
    const std::vector<std::string> names = NamesOf(family_);
    RunSetup single = setup;
    single.mode = Mode::kSingle;
    WholeRun heard_single;
    auto run = family_.NewRun(std::move(single), heard_single);
    ASSERT_TRUE(run);
    std::vector<Traced> traced = {Look(**run, names)};
    while ((*run)->Advance((*run)->state().time + At(60.0)) != RunPhase::kFinished) {
      if ((*run)->state().phase != RunPhase::kHalted) continue;
      traced.push_back(Look(**run, names));
      (*run)->Apply({.at = (*run)->state().time, .kind = InputKind::kStart, .value = 1.0});
    }
    const WholeRun whole = Whole(setup, may_fail);
    ASSERT_GE(traced.size(), whole.steps.size());
    ASSERT_EQ(heard_single.steps.size(), whole.steps.size());
    for (std::size_t i = 0; i < whole.steps.size(); ++i) {
      const StepReach reach = Reach(setup, whole.steps[i].target);
      const Traced there = Look(*reach.run, names);
      const std::string step = std::to_string(whole.steps[i].target.at.step);
      EXPECT_EQ(there.values, traced[i].values) << step;
      // A corner that is passed and one that is not round differently.
      const motion::AxisPose& axes = traced[i].axes;
      EXPECT_LT((there.axes.column - axes.column).norm(), 1e-9) << step;
      EXPECT_NEAR(there.axes.a_rad, axes.a_rad, 1e-12) << step;
      EXPECT_NEAR(there.axes.b_rad, axes.b_rad, 1e-12) << step;
      // A program that is called has its own, up to the step behind it.
      if (i == 0 || whole.steps[i - 1].target.at.program == whole.steps[i].target.at.program) {
        EXPECT_EQ(there.modal, traced[i].modal) << step;
      }
      EXPECT_EQ(reach.facts.place.step, whole.steps[i].target.at.step);
    }
  }

  // The nearest clean steps of each step, by brute force: `work` tells whether a process or the
  // tool is in the way there.
  template <class IsInTheWay>
  void CleanSteps(const std::vector<std::string>& programs, IsInTheWay work) {
    const RunSetup setup = Setup(programs);
    const WholeRun whole = Whole(setup);
    std::vector<bool> clean;
    for (const WholeRun::Step& step : whole.steps) {
      const StepReach reach = Reach(setup, step.target);
      clean.push_back(whole.StandsBefore(step) && !work(*reach.run));
    }
    EXPECT_GT(std::ranges::count(clean, true), 1);
    EXPECT_GT(std::ranges::count(clean, false), 1);
    for (std::size_t i = 0; i < whole.steps.size(); ++i) {
      const StartPreview preview = PreviewOf(setup, whole.steps[i].target);
      std::optional<StepTarget> before;
      std::optional<StepTarget> after;
      for (std::size_t k = 0; k < i; ++k) {
        if (clean[k]) before = whole.steps[k].target;
      }
      for (std::size_t k = whole.steps.size(); k-- > i + 1;) {
        if (clean[k]) after = whole.steps[k].target;
      }
      const int step = whole.steps[i].target.at.step;
      EXPECT_EQ(preview.clean_before, before) << step;
      EXPECT_EQ(preview.clean_after, after) << step;
    }
  }
};

class MillReach : public ReachTest {
 protected:
  MillReach() : ReachTest("rml1") {}
};

constexpr const char* kPasses =
    "COORD ABSOL\nPATH LIN\nSPEED 20\nVI[2]=0\n"
    "100 VI[2]=VI[2]+1\nMOVE (521.02+VI[2], 2201.2, -350., 0., 0.)/FLY\nVR[8]=VI[2]*1.5\n"
    "MOVE (561.02, 2241.2+VI[2], -350., 0.2, 0.1)\nOL[11]=NOT OL[11]\nGOSUB 200\n"
    "IF VI[2] < 3 THEN 100\nCALL 2\nSPEED 30\nFUNCTION 3\nENDTASK\n"
    "200 VR[9]=VR[9]+VR[8]\nDELAY .5\nRETURN\n";
constexpr const char* kCalled =
    "SYSDEF (10.,20.,-5.,0.,0.,0.)\nCOORD ABSOL\nPATH LIN\nMOVE (500., 2200., -350., 0., 0.)\n"
    "TCP (0.,0.,1.,0.,0.,-5.)\nOA[3]=2.5\nSYSDEF\n";
constexpr const char* kFunction = "VI[7]=VI[2]*10\nACCEL 50\nOVERSH 20\n";
constexpr const char* kCut =
    "COORD ABSOL\nPATH LIN\nSPEED 20\nWORKDEF 1,0 (8.,75.,.2,50.)\n"
    "MOVE (521.02, 2201.2, -350., 0., 0.)\nOL[8]=ON\nWORK 1,0/ON\n"
    "MOVE (561.02, 2201.2, -350., 0., 0.)/FLY\nVR[1]=1.\n"
    "MOVE (561.02, 2241.2, -350., 0., 0.)/FLY\nMOVE (521.02, 2241.2, -350., 0., 0.)\n"
    "WORK 1,0/OFF\nOL[8]=OFF\nMOVE (621.02, 2241.2, -350., 0., 0.)/FLY\nVR[2]=2.\n"
    "MOVE (621.02, 2301.2, -350., 0., 0.)\nWORK 1,0/ON\nMOVE (661.02, 2301.2, -350., 0., 0.)\n"
    "WORK 1,0/OFF\nVR[3]=3.\n";

constexpr const char* kCommands =
    "VS10;!VZ10;!PZ-100,200;!MC1;PU2010,1510;VS11;PU2500,1800;VS10;PD4010,1510;PD4010,3510,3800,3600;W50;"
    "PD2010,3510;PU1000,1000;Z1200,1200,100,1300,1300,-50;Z1400,1400,-50;!VZ5;PU;PR;PD100,0;PA;"
    "H;!RC9;PU0,0;!MC0;";

// LIVE-6.01: *there* is what the whole run has there, of every step and every pass.
TEST_F(ReachTest, EveryStepOfALoop) { EveryStep({kPasses, kCalled, kFunction}); }
TEST_F(ReachTest, EveryStepOfACut) { EveryStep({kCut}); }
TEST_F(MillReach, EveryCommand) { EveryStep({kCommands}); }

// LIVE-6.01: the same of what people published.
TEST_F(ReachTest, TheCorpus) {
  if (Published("optimo/sample1.S").empty()) GTEST_SKIP() << "the shared corpus is not here";
  for (const char* name : {"sample1.S", "sample2-cylind.S", "sample3.S", "ch02-fly.S",
                           "ch02-hole.S", "ch02-cir.S", "ch03-work1.S", "ch03-work2.S"}) {
    SCOPED_TRACE(name);
    EveryStep({Published("optimo/" + std::string(name))}, true);
  }
}
TEST_F(MillReach, TheCorpus) {
  if (Published("rml1/22-move.rml").empty()) GTEST_SKIP() << "the shared corpus is not here";
  for (const char* name :
       {"01-fts_mini_cut.rml", "08-FabMicroISP-brd_cut_microport.rml", "15-output_bis2.rml",
        "17-3hncholesl.rml", "07-ROUGH_LEFT_EXTRA1.prn", "23-sample-2.rml"}) {
    SCOPED_TRACE(name);
    EveryStep({Published("rml1/" + std::string(name))});
  }
}

// LIVE-6.01: the time of the run there is that of the whole run, where the machine stands there.
TEST_F(ReachTest, AtTheTimeOfTheWholeRun) {
  const RunSetup setup = Setup({kCut});
  const WholeRun whole = Whole(setup);
  int standing = 0;
  for (const WholeRun::Step& step : whole.steps) {
    if (!whole.StandsBefore(step)) continue;
    EXPECT_EQ(Reach(setup, step.target).run->state().time, step.at) << step.target.at.step;
    ++standing;
  }
  EXPECT_EQ(standing, 15);
}

// LIVE-6.04: the nearest clean steps.
TEST_F(ReachTest, CleanStepsByBruteForce) {
  const auto work = [](machine::Run& run) {
    for (const StateItem& item : run.enterable()->items()) {
      if (item.name == "WORK") return item.value != "OFF";
    }
    return true;
  };
  CleanSteps({kCut}, work);
  CleanSteps({kPasses, kCalled, kFunction}, work);
}
TEST_F(MillReach, CleanStepsByBruteForce) {
  CleanSteps({kCommands}, [](const machine::Run& run) {
    const double z = std::stod(run.ReadVariable("Z")->text);
    return run.ReadVariable("TOOL")->text == "down" || z < 0.0;
  });
}

// LIVE-6.01, CELL-E9426: not reached, with the last step that was.
TEST_F(ReachTest, WhatIsNotReached) {
  const auto why = [&](const RunSetup& setup, const StepTarget& target,
                       const ReachLimits& limits = {}) {
    Result<StepReach> reach = ReachStep(family_, setup, target, limits);
    EXPECT_TRUE(reach);
    EXPECT_TRUE(reach->unreachable);
    EXPECT_EQ(reach->unreachable->code, ErrorCode::kCellStepUnreachable);
    return std::string(reach->unreachable->detail);
  };
  const RunSetup loop = Setup({kPasses, kCalled, kFunction});
  EXPECT_EQ(why(loop, {.at = {1, 5}, .occurrence = 4}),
            "step 1/5 is not reached for the 4. time: the program ends; the last step reached is "
            "1/15");
  EXPECT_EQ(
      why(loop, {.at = {1, 5}, .occurrence = 1'000'000}),
      "step 1/5 is not reached for the 1000000. time: the program ends; the last step reached "
      "is 1/15");
  EXPECT_EQ(why(loop, {.at = {1, 99}}),
            "step 1/99 is not reached: the program ends; the last step reached is 1/15");
  EXPECT_EQ(why(loop, {.at = {1, 0}}), "step 0 is none: they count from 1");
  EXPECT_EQ(why(loop, {.at = {1, -1}}), "step -1 is none: they count from 1");
  EXPECT_THAT(why(loop, {.at = {1, 0}, .byte_offset = 0}), HasSubstr("has no bytes"));
  EXPECT_THAT(why(loop, {.at = {1, 5}, .byte_offset = 7}), HasSubstr("has no bytes"));
  const RunSetup waits = Setup({"VI[2]=1\nWAIT IL[5]\nVI[2]=2\n"});
  EXPECT_THAT(why(waits, {.at = {1, 3}}),
              HasSubstr("waits for what does not come; the last step reached is 1/2"));
  const RunSetup fails = Setup({"VI[2]=0\nVR[1]=1/VI[2]\nVI[2]=2\n"});
  EXPECT_THAT(why(fails, {.at = {1, 3}}), HasSubstr("the run ends with OPT-E"));
  const RunSetup endless = Setup({"100 VI[2]=1\nGOTO 100\nVI[3]=1\n"});
  EXPECT_THAT(why(endless, {.at = {1, 3}}, {.steps_max = 5000}),
              HasSubstr("the run ends with OPT-E"));
  int asked = 0;
  EXPECT_THAT(why(endless, {.at = {1, 3}}, {.go_on = [&] { return ++asked < 10; }}),
              HasSubstr("it takes longer than is looked for"));
  EXPECT_EQ(asked, 10);
}

// Of each step by itself, of the slots 1 to 99 and the first 65,536 steps; others come once.
TEST(StepCounts, CountEachStepByItself) {
  StepCounts counts;
  for (const ProgramStep at : {ProgramStep{1, 2}, ProgramStep{1, 1}, ProgramStep{1, 0},
                               ProgramStep{0, 2}, ProgramStep{99, 65'535}, ProgramStep{1, 3}}) {
    for (std::uint64_t time = 1; time <= 3; ++time) EXPECT_EQ(counts.Count(at), time) << at.step;
  }
  EXPECT_EQ(counts.Count({1, 2}), 4U);
  for (const ProgramStep at :
       {ProgramStep{1, 65'536}, ProgramStep{100, 1}, ProgramStep{-1, 1}, ProgramStep{1, -1}}) {
    for (int time = 0; time < 3; ++time) EXPECT_EQ(counts.Count(at), 1U) << at.step;
  }
}

// LIVE-6.01: recorded inputs, and START at halts that no recorded key ends.
TEST_F(ReachTest, WithRecordedInputs) {
  RunSetup setup = Setup({"WAIT IL[5]\nPAUSE\nVI[2]=7\nDELAY 1\nVL[3]=IL[6]\nVI[4]=1\n"});
  setup.inputs = {{At(3.0), InputKind::kLogical, 5, 1.0},
                  {At(10.0), InputKind::kStart, 0, 1.0},
                  {At(10.5), InputKind::kLogical, 6, 1.0}};
  StepReach reach = Reach(setup, {.at = {1, 6}});
  EXPECT_EQ(reach.run->state().time, At(11.0));
  EXPECT_EQ(reach.run->ReadVariable("VL[3]")->text, "1");
  setup.inputs.resize(1);
  reach = Reach(setup, {.at = {1, 6}});
  EXPECT_EQ(reach.run->state().time, At(4.0));
  EXPECT_EQ(reach.run->ReadVariable("VL[3]")->text, "0");
}

// LIVE-6.01: the pass that an interrupted run was in.
TEST_F(ReachTest, TheOccurrenceOfARunThatWasCutOff) {
  const RunSetup setup = Setup({"100 DELAY 1\nVI[2]=VI[2]+1\nIF VI[2] < 5 THEN 100\n"});
  EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 1}, At(0.5), {}), 1U);
  EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 1}, At(2.5), {}), 3U);
  EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 2}, At(2.5), {}), 2U);
  EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 4}, At(2.5), {}), 0U);
}

// LIVE-6.01: whoever asks may give up.
TEST_F(ReachTest, TheOccurrenceIsGivenUp) {
  const RunSetup setup = Setup({"100 DELAY 1\nVI[2]=VI[2]+1\nIF VI[2] < 5 THEN 100\n"});
  const Result<std::uint64_t> none =
      OccurrenceAt(family_, setup, {1, 1}, At(2.5), {.go_on = [] { return false; }});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellStepUnreachable);
  EXPECT_EQ(none.error().detail, "where it was cut off takes longer than is looked for");
}

}  // namespace
}  // namespace rmlcell::machine
