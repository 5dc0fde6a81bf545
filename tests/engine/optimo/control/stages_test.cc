// The tables of stages in the headers of the control's parts, row by row: move_watch.h, works.h,
// waits.h, alarms.h, halts.h, program_counter.h (TIMER) and ride.h. The state is looked at every
// millisecond while a program runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "engine/optimo/control/control.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::stages {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;

using Show = std::function<std::string(const ControlState&)>;

std::string WatchOf(const ControlState& state) {
  constexpr const char* kNames[] = {"idle", "armed", "comes", "watches", "ran out", "stands"};
  const WatchState& watch = state.watch;
  // What a stage has, and what it cannot have.
  const bool idle = watch.stage == WatchStage::kIdle;
  const bool timed = watch.stage == WatchStage::kArmed || watch.stage == WatchStage::kRanOut ||
                     watch.stage == WatchStage::kStands;
  EXPECT_FALSE(idle && (watch.end || watch.time));
  EXPECT_FALSE(timed && !watch.time);
  return kNames[static_cast<int>(watch.stage)];
}

std::string WaitOf(const ControlState& state) {
  constexpr const char* kNames[] = {"none",      "standstill", "time",
                                    "condition", "take over",  "no motion"};
  return kNames[static_cast<int>(state.waits.pending.kind)];
}

std::string TasksOf(const ControlState& state) {
  constexpr const char* kNames[] = {"start", "dwell", "end"};
  std::string text;
  for (const WorkTask& task : state.works.tasks) {
    EXPECT_EQ(task.stage == WorkStage::kStart, task.start.has_value());
    EXPECT_FALSE(task.stage == WorkStage::kDwell && task.end);
    EXPECT_FALSE(task.stage == WorkStage::kEnd && !task.end);
    text += text.empty() ? "" : "+";
    text += kNames[static_cast<int>(task.stage)];
  }
  return text.empty() ? "-" : text;
}

std::string AlarmOf(const ControlState& state) {
  return state.alarms.deferred ? "deferred" : "none";
}

std::string GoesOnOf(const ControlState& state) {
  constexpr const char* kNames[] = {"no", "ahead", "comes", "beside"};
  return kNames[static_cast<int>(state.ride.program)];
}

// Of each program, the innermost last.
std::string TimersOf(const ControlState& state) {
  constexpr const char* kNames[] = {"none", "counts", "runs", "stands"};
  std::string text;
  for (const ProgramContext& program : state.counter.programs) {
    const bool calls = &program != &state.counter.programs.back();
    EXPECT_EQ(program.timer_stage() == TimerStage::kStands, calls && program.timer.has_value());
    text += text.empty() ? "" : "+";
    text += kNames[static_cast<int>(program.timer_stage())];
  }
  return text;
}

std::string HaltsOf(const ControlState& state) {
  constexpr const char* kPhases[] = {"running", "halted", "finished"};
  constexpr const char* kSteps[] = {"", " SINGLE", " BREAK"};
  const HaltState& halts = state.halts;
  const bool halted = state.situation.phase == machine::RunPhase::kHalted;
  EXPECT_FALSE(halts.place_ahead && !halted);
  EXPECT_FALSE(halts.stop && halted);
  std::string text = kPhases[static_cast<int>(state.situation.phase)];
  if (halts.hold) text += " hold";
  if (halts.stop) text += " stop";
  text += kSteps[static_cast<int>(halts.after_step)];
  if (halts.place_ahead) text += " on the path";
  if (halts.breakpoint) text += " (" + std::to_string(halts.breakpoint->step) + ")";
  return text;
}

struct Seen {
  std::vector<std::string> stages;  // one after the other
  std::vector<std::string> timed;   // the same, with the tenth of a second that it was seen from
  int gosubs = 0;                   // VI[3]
};

// What is seen of a run until it is finished.
Seen SeenOf(Control& control, const Show& show) {
  Seen seen;
  for (int ms = 0; ms < 20'000; ++ms) {
    if (control.Advance(std::chrono::milliseconds(ms)) == machine::RunPhase::kFinished) break;
    const std::string stage = show(control.state());
    if (!seen.stages.empty() && seen.stages.back() == stage) continue;
    seen.stages.push_back(stage);
    seen.timed.push_back(std::to_string(ms / 1000) + "." + std::to_string(ms % 1000 / 100) + " " +
                         stage);
  }
  return seen;
}

// What was seen of a program that goes on for a second once its steps are over. Errors go to 800,
// times that ran out to 900. IL[20] is on from 0.5 s on, IL[21] from 1.5 s on.
Seen Through(const std::string& steps, const Show& show,
             const std::map<int, std::string>& programs = {}) {
  const machine::RunSetup setup = SetupOf(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nERR 800\nWORKDEF 1,0 (10.,60.,1.,95.)\n"
      "WORKDEF 1,1 (10.,60.,5.,95.)\nWORKDEF 2,0 (15)\n" +
          steps + "DELAY 1\nENDTASK\n900 VI[3]=VI[3]+1\nRETURN\n800 DELAY 1\n",
      {.programs = programs,
       .inputs = {{At(0.5), InputKind::kLogical, 20, 1.0},
                  {At(1.5), InputKind::kLogical, 21, 1.0}}});
  machine::RunObserver nobody;
  Control control(Resolve(setup.parameters), setup, nobody);
  Seen seen = SeenOf(control, show);
  EXPECT_EQ(control.state().outcome.kind, machine::OutcomeKind::kCompleted);
  seen.gosubs = static_cast<int>(control.state().data.area.vi[3]);
  return seen;
}

// Along X at 50 mm/s. New machines stand with the tip at (21.02, 2201.2, -350).
std::string MoveBy(double mm, const std::string& attributes) {
  return "MOVE (" + std::to_string(21.02 + mm) + ",2201.2,-350.,0.,0.)" + attributes + "\n";
}

void ExpectWatch(const std::string& steps, const std::vector<std::string>& stages, int gosubs = 0) {
  const Seen seen = Through(steps, WatchOf);
  EXPECT_EQ(seen.stages, stages) << steps;
  EXPECT_EQ(seen.gosubs, gosubs) << steps;
}

// OPT-2.54 to 2.58: of the /TIME that runs and the /END that is tested, from the beginning of a
// MOVE.
TEST(StagesOfAMove, FromTheBeginning) {
  ExpectWatch(MoveBy(50, "/END (IL[22])"), {"watches", "idle"});
  ExpectWatch(MoveBy(50, "/TIME (9.,900)"), {"watches", "idle"});
  ExpectWatch(MoveBy(500, "/END (IL[20])"), {"watches", "idle"});
  ExpectWatch(MoveBy(500, "/TIME (1.,900)"), {"watches", "ran out", "idle"}, 1);
  // Behind a passage: the program has run ahead of the motion before.
  ExpectWatch(MoveBy(50, "/FLY") + MoveBy(100, "/TIME (9.,900)"), {"comes", "watches", "idle"});
  // Its time runs from its own beginning.
  ExpectWatch(MoveBy(50, "/FLY") + MoveBy(300, "/TIME (2.,900)"),
              {"comes", "watches", "ran out", "idle"}, 1);
}

// OPT-2.54, OPT-2.55: while it waits for its /START.
TEST(StagesOfAMove, Armed) {
  ExpectWatch(MoveBy(50, "/START (IL[20])/TIME (9.,900)"), {"armed", "watches", "idle"});
  ExpectWatch(MoveBy(50, "/START (IL[22])/TIME (1.,900)"), {"armed", "idle"}, 1);
  ExpectWatch(MoveBy(50, "/START (IL[20])/TIME (9.,900)/END (IL[20])"), {"armed", "idle"});
  ExpectWatch("SPEED 0\n" + MoveBy(50, "/START (IL[20])/TIME (1.,900)"),
              {"armed", "stands", "idle"}, 1);
}

// OPT-B.22: one that never moves.
TEST(StagesOfAMove, Standing) {
  ExpectWatch("SPEED 0\n" + MoveBy(50, "/TIME (1.,900)"), {"stands", "idle"}, 1);
  ExpectWatch("SPEED 0\n" + MoveBy(50, "/TIME (9.,900)/END (IL[20])"), {"stands", "idle"});
}

// What ends it whatever stage it is in: a MOVE that takes over, an error.
TEST(StagesOfAMove, Cleared) {
  ExpectWatch(MoveBy(500, "/TIME (9.,900)/NEXT") + "DELAY 1\n" + MoveBy(0, ""),
              {"watches", "idle"});
  ExpectWatch(MoveBy(500, "/TIME (9.,900)/NEXT") + "DELAY 1\nVR[0]=1/0\n", {"watches", "idle"});
  ExpectWatch(
      "SPEED 0\n" + MoveBy(50, "/TIME (9.,900)/NEXT") + "DELAY 1\nSPEED 10\n" + MoveBy(50, ""),
      {"stands", "idle"});
  ExpectWatch("SPEED 0\n" + MoveBy(50, "/TIME (9.,900)/NEXT") + "DELAY 1\nVR[0]=1/0\n",
              {"stands", "idle"});
}

std::vector<std::string> Tasks(const std::string& steps,
                               const std::map<int, std::string>& programs = {}) {
  return Through(steps, TasksOf, programs).timed;
}

// OPT-3.38: the three stages, each by itself and one out of the other. Conditions are tested when
// an input changes, or at ticks of 48 ms from the WORK on: 32 of them are 1.536 s.
TEST(StagesOfAWork, OneAfterTheOther) {
  EXPECT_THAT(Tasks("WORK 0,0/ON/START (IL[20])/NEXT\nDELAY 2\nWORK 0,0/OFF\n"),
              ElementsAre("0.0 start", "0.5 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/END (IL[21])\nDELAY 2\n"), ElementsAre("0.0 end", "1.5 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/START (IL[20])/END (IL[21])/NEXT\nDELAY 2\n"),
              ElementsAre("0.0 start", "0.5 end", "1.5 -"));
  EXPECT_THAT(Tasks("WORK 1,0/ON/NEXT\nDELAY 2\nWORK 1,0/OFF\n"),
              ElementsAre("0.0 dwell", "1.0 -"));
  EXPECT_THAT(Tasks("WORK 1,0/ON/END (IL[21])/NEXT\nDELAY 2\n"),
              ElementsAre("0.0 dwell+end", "1.0 end", "1.5 -"));
  EXPECT_THAT(Tasks("WORK 1,1/ON/START (IL[20])/END (IL[21])/NEXT\nDELAY 2\n"),
              ElementsAre("0.0 start", "0.5 dwell+end", "1.5 dwell"));
}

// What takes its place or the beam before: the dwell of 5 s is over at once.
TEST(StagesOfAWork, Dropped) {
  const std::string dwells = "WORK 1,1/ON/NEXT\nDELAY 0.4\n";
  const std::string off = "DELAY 1\nWORK 1,1/OFF\n";
  EXPECT_THAT(Tasks(dwells + "WORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n" + off),
              ElementsAre("0.0 dwell", "0.4 -"));
  EXPECT_THAT(Tasks(dwells + "WORK 2,0/OFF\n" + off), ElementsAre("0.0 dwell", "0.4 -"));
  EXPECT_THAT(Tasks(dwells + "WORK 2,0/ON\nDELAY 1\nWORK 2,0/OFF\n" + off),
              ElementsAre("0.0 dwell", "1.4 -"));  // a schedule leaves it alone
  EXPECT_THAT(Tasks(dwells + "WORK 1,1/OFF\nDELAY 1\n"), ElementsAre("0.0 dwell", "0.4 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/START (IL[22])/NEXT\nDELAY 0.4\nWORK 0,0/OFF\nDELAY 1\n"),
              ElementsAre("0.0 start", "0.4 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/END (IL[22])\nDELAY 0.4\nWORK 0,0/OFF\nDELAY 1\n"),
              ElementsAre("0.0 end", "0.4 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/END (IL[22])\nDELAY 0.4\nVR[0]=1/0\n"),
              ElementsAre("0.0 end", "0.4 -"));  // the error is caught, and its handler goes on
}

// OPT-3.38: that of a CALLed program ends with it, that of its caller waits behind it: IL[20] is on
// since 0.5 s.
TEST(StagesOfAWork, OfTheirPrograms) {
  EXPECT_THAT(Tasks("CALL 45\n", {{45, "WORK 0,0/ON/START (IL[22])/NEXT\nDELAY 0.4\n"}}),
              ElementsAre("0.0 start", "0.4 -"));
  EXPECT_THAT(Tasks("WORK 0,0/ON/START (IL[20])/NEXT\nCALL 45\nDELAY 1\nWORK 0,0/OFF\n",
                    {{45, "DELAY 0.2\nWORK 0,1/ON/START (IL[22])/NEXT\nDELAY 0.8\n"}}),
              ElementsAre("0.0 start", "0.2 start+start", "1.0 start", "1.0 -"));
}

std::vector<std::string> Waits(const std::string& steps) { return Through(steps, WaitOf).stages; }

// What begins each kind of wait and what ends it. The last wait is the DELAY behind the steps.
TEST(StagesOfAWait, BegunAndEnded) {
  EXPECT_THAT(Waits(""), ElementsAre("time"));
  EXPECT_THAT(Waits("WAIT (IL[20])\n"), ElementsAre("condition", "time"));
  EXPECT_THAT(Waits("WORK 0,0/ON/START (IL[20])\nWORK 0,0/OFF\n"),
              ElementsAre("condition", "time"));
  EXPECT_THAT(Waits("WORK 1,0/ON/START (IL[20])\nWAIT (IL[21])\nWORK 1,0/OFF\n"),
              ElementsAre("condition", "time"));  // the pierce lasts until 1.5 s: WAIT is met
  EXPECT_THAT(Waits(MoveBy(50, "/START (IL[20])")), ElementsAre("condition", "none", "time"));
  EXPECT_THAT(Waits(MoveBy(50, "/START (IL[22])/TIME (1.,900)")), ElementsAre("condition", "time"));
  EXPECT_THAT(Waits("SPEED 0\n" + MoveBy(50, "/TIME (1.,900)")), ElementsAre("no motion", "time"));
  EXPECT_THAT(Waits("SPEED 0\n" + MoveBy(50, "/TIME (9.,900)/END (IL[20])")),
              ElementsAre("no motion", "time"));
  // STOP and its like, COORD here, let a motion of /NEXT come to its end.
  EXPECT_THAT(Waits(MoveBy(50, "/NEXT") + "COORD ABSOL\n"), ElementsAre("standstill", "time"));
  // A MOVE brings it to rest from the next tick on: 11 of them are 0.528 s.
  EXPECT_THAT(Waits(MoveBy(500, "/NEXT") + "DELAY 0.5\n" + MoveBy(0, "")),
              ElementsAre("time", "take over", "standstill", "none", "time"));
}

// An error ends whatever it is: here of an /END in the background at 0.048 s.
TEST(StagesOfAWait, EndedByAnError) {
  const std::string fails = "VI[5]=1\nWORK 0,0/ON/END (1/VI[5] > 2)\nVI[5]=0\n";
  EXPECT_THAT(Through(fails + "WAIT (IL[22])\n", WaitOf).timed,
              ElementsAre("0.0 condition", "0.0 time"));
  EXPECT_EQ(Through(fails + "SPEED 0\n" + MoveBy(50, "/TIME (9.,900)"), WaitOf).timed,
            (std::vector<std::string>{"0.0 no motion", "0.0 time"}));
}

// A /FLY chain of 80 moves, round a square of 1 mm: more than the planner decides at once, so that
// the motion begins while the program is in the midst of them.
const std::string kRounds =
    "10 MOVE (22.02,2201.2,-350.,0.,0.)/FLY\nMOVE (22.02,2200.2,-350.,0.,0.)/FLY\n"
    "MOVE (21.02,2200.2,-350.,0.,0.)/FLY\nMOVE (21.02,2201.2,-350.,0.,0.)/FLY\n"
    "VI[2]=VI[2]+1\nIF VI[2] < 20 THEN 10\n";

// OPT-2.49, OPT-2.56: whether the program runs ahead of a motion or goes on beside one.
TEST(StagesOfNext, AheadAndBeside) {
  const auto seen = [](const std::string& steps) { return Through(steps, GoesOnOf).stages; };
  EXPECT_THAT(seen(MoveBy(50, "") + MoveBy(50, "/NEXT")), ElementsAre("no"));  // it stands there
  EXPECT_THAT(seen(kRounds + MoveBy(50, "")), ElementsAre("ahead", "no"));
  EXPECT_THAT(seen(kRounds + "COORD ABSOL\n"), ElementsAre("ahead", "no"));
  EXPECT_THAT(seen(MoveBy(50, "/NEXT") + "DELAY 2\n"), ElementsAre("beside", "no"));
  EXPECT_THAT(seen(MoveBy(50, "/FLY") + MoveBy(100, "/NEXT") + "DELAY 4\n"),
              ElementsAre("comes", "beside", "no"));
  EXPECT_THAT(seen(kRounds + MoveBy(50, "/NEXT") + "DELAY 4\n"),
              ElementsAre("ahead", "comes", "beside", "no"));
  EXPECT_THAT(seen(MoveBy(500, "/NEXT") + "DELAY 0.5\n" + MoveBy(0, "/FLY") + MoveBy(50, "")),
              ElementsAre("beside", "no"));  // taken over
}

// OPT-3.55, OPT-3.58: an error while the machine stands is handled at once, one ahead of motion
// when that is over.
TEST(StagesOfAnAlarm, DeferredWhileTheMachineMoves) {
  EXPECT_THAT(Through("VR[0]=1/0\n", AlarmOf).stages, ElementsAre("none"));
  EXPECT_THAT(Through(MoveBy(50, "/FLY") + "VR[0]=1/0\n", AlarmOf).timed,
              ElementsAre("0.0 deferred", "1.1 none"));  // 50 mm at 50 mm/s, and the stop
  const Seen waits = Through(MoveBy(50, "/FLY") + "VR[0]=1/0\n", WaitOf);
  EXPECT_THAT(waits.timed, ElementsAre("0.0 standstill", "1.1 time"));
}

std::vector<std::string> Timers(const std::string& steps,
                                const std::map<int, std::string>& programs = {}) {
  return Through(steps, TimersOf, programs).timed;
}

// OPT-B.59: set, due, made, set anew and switched off. Its GOSUB is made between two instructions.
TEST(StagesOfATimer, OneAfterTheOther) {
  const std::string handlers =
      "GOTO 10\n910 DELAY 1\nRETURN\n920 DELAY 1\nTIMER (9.,900)\nDELAY 1\nRETURN\n10 ";
  EXPECT_THAT(Timers(""), ElementsAre("0.0 none"));
  EXPECT_THAT(Timers("TIMER (.5,900)\nDELAY 2\n"), ElementsAre("0.0 counts", "2.0 none"));
  EXPECT_THAT(Timers("TIMER (9.,900)\nDELAY 1\nTIMER /DIS\n"),
              ElementsAre("0.0 counts", "1.0 none"));
  EXPECT_THAT(Timers(handlers + "TIMER (.5,910)/AUTO\nDELAY 1\nDELAY 1\n"),
              ElementsAre("0.0 counts", "1.0 runs", "2.0 counts", "3.0 runs", "4.0 counts",
                          "5.0 runs"));  // behind the DELAY of the end, too
  EXPECT_THAT(Timers(handlers + "TIMER (.5,910)\nDELAY 1\nDELAY 1\n"),
              ElementsAre("0.0 counts", "1.0 none"));  // while its GOSUB runs, too
  EXPECT_THAT(Timers(handlers + "TIMER (.5,920)/AUTO\nDELAY 1\n"),
              ElementsAre("0.0 counts", "1.0 runs", "2.0 counts"));
  EXPECT_THAT(Timers(handlers + "TIMER (.5,910)/AUTO\nDELAY 1\nTIMER /DIS\n"),
              ElementsAre("0.0 counts", "1.0 runs", "2.0 none"));
}

// OPT-B.89, OPT-B.59: each program has its own, that of a caller stands still, and goes on as what
// it was; one of a FUNCTION ends with it.
TEST(StagesOfATimer, OfTheirPrograms) {
  EXPECT_THAT(Timers("TIMER (9.,900)\nDELAY 1\nCALL 45\nDELAY 1\n", {{45, "DELAY 1\n"}}),
              ElementsAre("0.0 counts", "1.0 stands+none", "2.0 counts"));
  EXPECT_THAT(Timers("TIMER (9.,900)\nDELAY 1\nCALL 45\nDELAY 1\n",
                     {{45, "DELAY 1\nTIMER (9.,900)\nDELAY 1\nENDTASK\n900 RETURN\n"}}),
              ElementsAre("0.0 counts", "1.0 stands+none", "2.0 stands+counts", "3.0 counts"));
  EXPECT_THAT(Timers("GOTO 10\n910 CALL 45\nDELAY 1\nRETURN\n"
                     "10 TIMER (.5,910)/AUTO\nDELAY 1\nTIMER /DIS\n",
                     {{45, "DELAY 1\n"}}),
              ElementsAre("0.0 counts", "1.0 stands+none", "2.0 runs", "3.0 none"));
  EXPECT_THAT(
      Timers("DELAY 1\nFUNCTION 44\n", {{44, "TIMER (9.,900)\nDELAY 1\nENDTASK\n900 RETURN\n"}}),
      ElementsAre("0.0 none", "1.0 counts", "2.0 none"));
  EXPECT_THAT(Timers("TIMER (9.,900)\nDELAY 1\nGO 46\n", {{46, "DELAY 1\n"}}),
              ElementsAre("0.0 counts", "1.0 none"));
}

// What was seen of a program while keys were pressed, and what is left at its end.
std::vector<std::string> Halts(const std::string& text, const RunOptions& options) {
  const machine::RunSetup setup = SetupOf(text, options);
  machine::RunObserver nobody;
  Control control(Resolve(setup.parameters), setup, nobody);
  std::vector<std::string> seen = SeenOf(control, HaltsOf).timed;
  seen.push_back(HaltsOf(control.state()));
  return seen;
}

machine::InputChange Key(double at_s, InputKind kind) { return {At(at_s), kind}; }

const std::string kTwo = "DELAY 1\nDELAY 1\n";

// OPT-4.17, OPT-4.18: between instructions and inside of one; a halt ends what was asked for.
TEST(StagesOfAHalt, OfKeys) {
  EXPECT_THAT(
      Halts(kTwo, {.inputs = {Key(0.5, InputKind::kHold), Key(3.0, InputKind::kStart)}}),
      ElementsAre("0.0 running", "0.5 running hold", "1.0 halted", "3.0 running", "finished"));
  EXPECT_THAT(
      Halts(kTwo, {.inputs = {Key(0.2, InputKind::kHold), Key(0.5, InputKind::kStop),
                              Key(3.0, InputKind::kStart)}}),
      ElementsAre("0.0 running", "0.2 running hold", "0.5 halted", "3.0 running", "finished"));
  // HOLD while it is halted: for the next START.
  EXPECT_THAT(Halts(kTwo, {.inputs = {Key(0.5, InputKind::kStop), Key(1.0, InputKind::kHold),
                                      Key(2.0, InputKind::kStart), Key(4.0, InputKind::kStart)}}),
              ElementsAre("0.0 running", "0.5 halted", "1.0 halted hold", "2.0 running hold",
                          "2.5 halted", "4.0 running", "finished"));
}

const std::string kAlongX = "COORD ABSOL\nPATH LIN\nSPEED 10\n";

// OPT-4.18: STOP on a motion. Of 50 mm/s the ramp takes 0.0707 s.
TEST(StagesOfAHalt, OnThePath) {
  EXPECT_THAT(Halts(kAlongX + MoveBy(100, ""),
                    {.inputs = {Key(1.0, InputKind::kStop), Key(3.0, InputKind::kStart)}}),
              ElementsAre("0.0 running", "1.0 halted on the path", "3.0 running", "finished"));
}

// OPT-4.18: 2 ms before the end of what is planned the machine cannot come to rest on it: it
// brakes from there on, over what the program has appended meanwhile.
TEST(StagesOfAHalt, AStopThatNeedsMoreMotions) {
  const machine::RunSetup setup = SetupOf(kAlongX + kRounds);
  machine::RunObserver nobody;
  Control control(Resolve(setup.parameters), setup, nobody);
  const motion::PathRide& path = control.state().ride.path;
  SimTime now{0};
  control.Advance(now);
  while (!path.to_come().empty()) control.Advance(now += std::chrono::milliseconds(1));
  now = path.under_way()->end - std::chrono::milliseconds(2);
  control.Advance(now);
  ASSERT_EQ(GoesOnOf(control.state()), "ahead");
  control.Apply({now, InputKind::kStop});
  EXPECT_EQ(HaltsOf(control.state()), "running stop");
  control.Advance(now + std::chrono::milliseconds(1));
  EXPECT_EQ(HaltsOf(control.state()), "running stop");
  control.Advance(now + std::chrono::milliseconds(3));
  EXPECT_EQ(HaltsOf(control.state()), "running");
  control.Advance(now + At(0.3));
  EXPECT_EQ(HaltsOf(control.state()), "halted on the path");
}

// OPT-6.31, OPT-6.08: behind each step in SINGLE, behind that of the breakpoint, which stays; not
// behind the end of the program.
TEST(StagesOfAHalt, BehindAStep) {
  const RunOptions single{.inputs = {Key(2.0, InputKind::kStart)}, .mode = machine::Mode::kSingle};
  EXPECT_THAT(Halts(kTwo, single),
              ElementsAre("0.0 running SINGLE", "1.0 halted", "2.0 running SINGLE", "finished"));
  RunOptions stopped{.inputs = {Key(0.5, InputKind::kStop), Key(2.0, InputKind::kStart),
                                Key(3.0, InputKind::kStart)},
                     .mode = machine::Mode::kSingle};
  EXPECT_THAT(Halts(kTwo, stopped),
              ElementsAre("0.0 running SINGLE", "0.5 halted SINGLE", "2.0 running SINGLE",
                          "2.5 halted", "3.0 running SINGLE", "finished"));
  RunOptions both = single;
  both.breakpoint = machine::ProgramStep{.program = 1, .step = 1};
  EXPECT_THAT(Halts(kTwo, both), ElementsAre("0.0 running BREAK (1)", "1.0 halted (1)",
                                             "2.0 running SINGLE (1)", "finished (1)"));
  EXPECT_THAT(
      Halts("BREAK 2\n" + kTwo,
            {.inputs = {Key(2.0, InputKind::kStart)}, .breakpoint = machine::ProgramStep{1, 3}}),
      ElementsAre("0.0 running BREAK (2)", "1.0 halted (2)", "2.0 running (2)", "finished (2)"));
}

// The run is over from any phase, and what was asked for is left as it is.
TEST(StagesOfAHalt, Finished) {
  const auto ended = [](std::vector<machine::InputChange> keys, machine::Mode mode) {
    keys.push_back(Key(0.8, InputKind::kEmergencyStop));
    return Halts(kTwo, {.inputs = keys, .mode = mode});
  };
  EXPECT_THAT(ended({Key(0.5, InputKind::kHold)}, machine::Mode::kCycle),
              ElementsAre("0.0 running", "0.5 running hold", "finished hold"));
  EXPECT_THAT(ended({Key(0.5, InputKind::kStop)}, machine::Mode::kSingle),
              ElementsAre("0.0 running SINGLE", "0.5 halted SINGLE", "finished SINGLE"));
}

}  // namespace
}  // namespace rmlcell::optimo::testing::stages
