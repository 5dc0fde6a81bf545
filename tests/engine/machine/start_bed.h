#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/reach_step.h"
#include "engine/machine/start_preview.h"
#include "tests/engine/machine/machine_bed.h"

// Runs to a step, runs that begin at one, and the whole run beside them.
namespace rmlcell::machine {

// Every step of a run, and when the machine moves.
class WholeRun final : public RunObserver {
 public:
  struct Step {
    StepTarget target{};
    SimTime at{0};
  };
  struct Motion {
    SimTime start{0};
    SimTime end{0};
    ProgramStep of{};
    bool passes = false;  // its end, at speed
  };

  void OnStep(SimTime at, const Place& place, std::string_view /*name*/) override {
    const ProgramStep step{place.program, place.step};
    const auto same = [&](const Step& one) { return one.target.at == step; };
    const auto before = static_cast<std::uint64_t>(std::ranges::count_if(steps, same));
    steps.push_back({{.at = step, .occurrence = before + 1}, at});
  }
  void OnMotion(const MotionDone& done) override {
    const double left = done.motion->path.length() - done.travelled;
    motions.push_back({done.start,
                       done.end,
                       {done.place.program, done.place.step},
                       left < 1e-9 && done.motion->speed.end().speed > 1e-9});
  }

  // No motion of a step before it is under way when it begins, and none is passed.
  bool StandsBefore(const Step& step) const {
    const auto index = &step - steps.data();
    return std::ranges::none_of(motions, [&](const Motion& motion) {
      const bool covers = motion.start <= step.at && step.at < motion.end;
      const bool passes = motion.end == step.at && motion.passes;
      return (covers || passes) && OwnerOf(motion) < index;
    });
  }

  std::vector<Step> steps;
  std::vector<Motion> motions;

 private:
  // The last pass of its step that had begun when the motion did.
  std::ptrdiff_t OwnerOf(const Motion& motion) const {
    std::ptrdiff_t owner = -1;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (steps[i].target.at == motion.of && steps[i].at <= motion.start)
        owner = static_cast<std::ptrdiff_t>(i);
    }
    return owner;
  }
};

// What a machine does outside, without the time: motions by where they end, signals, waits.
class Outside final : public RunObserver {
 public:
  void OnMove(const MoveDone& done) override {
    (done.approach ? approach : moves).push_back(Text(done));
  }
  void OnMotion(const MotionDone& done) override {
    if (!done.approach) return;
    uses.insert(done.use);
    cuts = cuts || done.beam_on || done.in_work;
    feeds.push_back(done.programmed_mm_s);
  }
  void OnSignal(const SignalChange& change) override {
    if (change.signal == Signal::kBeam || change.signal == Signal::kSpindle)
      moves.push_back("signal " + std::to_string(change.value != 0.0));
  }
  void OnStep(SimTime, const Place& place, std::string_view) override {
    steps.push_back(place.step);
  }

  std::vector<std::string> approach;
  std::vector<std::string> moves;  // and beam and spindle
  std::vector<int> steps;
  std::vector<double> feeds;
  std::set<MotionUse> uses;
  bool cuts = false;

 private:
  static std::string Number(double value) {
    const std::string text = std::to_string(value);
    return text.substr(0, text.find('.') + 3);
  }
  static std::string Text(const MoveDone& done) {
    return std::string(done.path) + " " + Number(done.axes.column.x()) + " " +
           Number(done.axes.column.y()) + " " + Number(done.axes.column.z()) + " " +
           Number(done.axes.a_rad) + " " + Number(done.axes.b_rad);
  }
};

class StartTest : public MachineTest {
 protected:
  explicit StartTest(std::string_view family = "optimo") : MachineTest(family) {}

  RunSetup Setup(const std::vector<std::string>& programs) const {
    RunSetup setup(parameters());
    for (std::size_t i = 0; i < programs.size(); ++i)
      setup.programs[static_cast<int>(i) + 1] = Translated(programs[i]);
    setup.main_program = 1;
    setup.machine_state = StandingState();
    setup.budget = {.steps = 0, .virtual_time = SimTime(0)};
    return setup;
  }
  std::string StandingState() const { return (*family_.NewStanding(parameters(), ""))->Save(); }
  // `may_fail`: the program needs what this machine does not have.
  WholeRun Whole(const RunSetup& setup, bool may_fail = false) const {
    WholeRun whole;
    auto run = family_.NewRun(setup, whole);
    EXPECT_TRUE(run);
    GoUntil(**run, [] { return false; }, {});
    EXPECT_TRUE(may_fail || !(*run)->outcome().code) << CodeText(*(*run)->outcome().code);
    return whole;
  }
  StepReach Reach(const RunSetup& setup, const StepTarget& target) const {
    Result<StepReach> reach = ReachStep(family_, setup, target, {});
    EXPECT_TRUE(reach);
    EXPECT_FALSE(reach->unreachable) << target.at.step << ": " << reach->unreachable->detail;
    return *std::move(reach);
  }
  StartPreview PreviewOf(const RunSetup& setup, const StepTarget& target,
                         bool off_until_work_on = true,
                         ApproachWay way = ApproachWay::kSafe) const {
    Result<StartPreview> preview = PreviewStart(family_, setup,
                                                {.target = target,
                                                 .way = way,
                                                 .off_until_work_on = off_until_work_on,
                                                 .machine_state = StandingState()},
                                                {});
    EXPECT_TRUE(preview);
    return *std::move(preview);
  }
  static std::string FirstRefusal(const StartPreview& preview) {
    if (preview.may_begin()) return "none";
    return CodeText(preview.refusals[0].code) + " " + preview.refusals[0].detail;
  }
  // One that begins there, halted at its entry.
  std::unique_ptr<machine::Run> Entered(const RunSetup& setup, const StepReach& reach,
                                        RunObserver& observer) const {
    RunSetup own = setup;
    own.inputs.clear();
    auto run = family_.NewRun(std::move(own), observer);
    EXPECT_TRUE(run);
    (*run)->Restore(*reach.run->Save());
    (*run)->enterable()->Enter({.machine_state = StandingState(), .halt_at_entry = true});
    while ((*run)->Advance((*run)->state().time + At(60.0)) == RunPhase::kRunning) {
    }
    EXPECT_EQ((*run)->state().phase, RunPhase::kHalted);
    EXPECT_FALSE((*run)->state().approaching);
    return *std::move(run);
  }
  void Observe(const std::vector<std::string>& programs) {
    MachineMemory memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory.programs[static_cast<int>(i) + 1] = Translated(programs[i]);
    outside = Outside();
    machine = *Machine::Make(family_, parameters(), std::move(memory), "", outside);
  }
  // Keys at random times; then it is left alone, and started where it stands.
  void PressAtRandom(unsigned seed) {
    std::mt19937 dice(seed);
    std::uniform_real_distribution<double> pause(0.005, 0.4);
    std::uniform_int_distribution<int> key(0, 4);
    const auto press = [&](const MachineInput& input) {
      const Status done = machine->Apply(input);
      static_cast<void>(done);  // not every key is one now
    };
    while (machine->time() < At(12.0)) {
      GoOn(machine->time() + At(pause(dice)));
      const int what = key(dice);
      if (what == 0) press(StopRun{});
      if (what == 1) press(HoldRun{});
      if (what == 2) press(ChangeOverride{50.0 + 90.0 * pause(dice)});
      if (what > 2) press(ResumeRun{});
    }
    press(ChangeOverride{100.0});
    for (int i = 0; i < 100 && state() != MachineState::kIdle; ++i) {
      press(ResumeRun{});
      GoOn(machine->time() + At(20.0));
    }
  }
  void IsNotDisturbedByKeys(const std::vector<std::string>& programs, const StartAtStep& input) {
    Observe(programs);
    Good(input);
    GoOn(At(500.0));
    const Outside alone = outside;
    EXPECT_EQ(alone.approach.size(), 2U);
    for (unsigned seed = 1; seed <= 60; ++seed) {
      Observe(programs);
      Good(input);
      PressAtRandom(seed);
      EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted) << seed;
      EXPECT_EQ(outside.approach, alone.approach) << seed;
      EXPECT_EQ(outside.steps, alone.steps) << seed;
      EXPECT_FALSE(outside.cuts) << seed;
    }
  }
  static StartAtStep At1(int step) {
    return {.program = 1,
            .target = {.at = {1, step}},
            .acknowledged = {"clamps", "table", "tool", "Z0", "origin"}};
  }

  Outside outside;
};

// Items as "name=value", of all but what a person or nobody sees to.
inline std::vector<std::string> ToDo(const std::vector<StartDifference>& differences) {
  std::vector<std::string> rows;
  for (const StartDifference& one : differences) {
    if (one.action == StartAction::kAsk || one.action == StartAction::kNone) continue;
    rows.push_back(one.item + ": " + one.there + " <- " + one.now);
  }
  return rows;
}

inline const StartDifference* Row(const std::vector<StartDifference>& rows, std::string_view item) {
  const auto found = std::ranges::find(rows, item, &StartDifference::item);
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace rmlcell::machine
