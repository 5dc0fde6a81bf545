// What a machine that lives has selected, and which programs its run is in (live.md 2, 5).
#include "engine/machine/tools.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SelectedProgram : public MachineTest {};

// LIVE-5.04: the program that a job brings is nobody's choice: START takes what was selected
// before.
TEST_F(SelectedProgram, WhatAJobBringsIsNotSelected) {
  Load({"DELAY 1\n", "DELAY 1\n", "DELAY 1\n"});
  Start(3);
  GoOn(At(5.0));
  Over();
  EXPECT_EQ(machine->selected_program(), 3);
  Good(StartRun{.program = 1, .source = StartSource::kQueue, .brought = Translated("DELAY 2\n")});
  GoOn(At(5.5));
  EXPECT_EQ(machine->selected_program(), 3);
  EXPECT_EQ(machine->status().open->program, 1);
  // Neither by who finds the machine behind a crash.
  const std::string state = machine->Save();
  RunObserver nobody;
  const auto found = Machine::Make(family_, parameters(), machine->memory(), state, nobody);
  ASSERT_TRUE(found);
  EXPECT_EQ((*found)->selected_program(), 3);
  GoOn(At(20.0));
  Over();
  EXPECT_EQ(machine->selected_program(), 3);
  EXPECT_EQ(machine->status().shown.program, 3);
  const ShownStep shown = machine->status().shown;
  Good(StartRun{.program = 2, .source = StartSource::kQueue});  // as it is stored
  EXPECT_EQ(machine->status().shown, shown);                    // no step of it was begun yet
  GoOn(At(40.0));
  Over();
  EXPECT_EQ(machine->selected_program(), 3);
  Start(2);
  EXPECT_EQ(machine->selected_program(), 2);
}

// LIVE-5.03, OPT-4.63: in use are what was started and what called each other from there, and
// nothing that a job brought.
TEST_F(SelectedProgram, ProgramsThatARunIsInAreInUse) {
  Load({"CALL 2\nDELAY 1\n", "DELAY 1\nCALL 3\nDELAY 1\n", "DELAY 5\n", "DELAY 1\n"});
  EXPECT_THAT(machine->loaded_programs(), IsEmpty());
  Start(1);
  GoOn(At(0.5));
  EXPECT_THAT(machine->loaded_programs(), ElementsAre(1, 2));
  GoOn(At(3.0));
  EXPECT_THAT(machine->loaded_programs(), ElementsAre(1, 2, 3));
  GoOn(At(30.0));
  EXPECT_THAT(machine->loaded_programs(), IsEmpty());
  Over();
  Good(StartRun{
      .program = 4, .source = StartSource::kQueue, .brought = Translated("CALL 3\nDELAY 1\n")});
  GoOn(At(31.0));
  EXPECT_THAT(machine->loaded_programs(), ElementsAre(3));
}

// LIVE-5.02: what is called by a number is there before anything moves, and FUNCTIONs of what is
// called, too; what is computed nobody knows before.
TEST_F(SelectedProgram, CalledProgramsAreLookedFor) {
  const auto check = [&](const std::vector<std::string>& programs) {
    std::map<int, StoredProgram> memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory[static_cast<int>(i) + 1] = Translated(programs[i]);
    const Status all = family_.CheckNeeds(memory, {}, parameters(), 1);
    return all ? std::string("all") : CodeText(all.error().code) + " " + all.error().detail;
  };
  EXPECT_EQ(check({"CALL 2\n", "GO 3\n", "CALL 1\n"}), "all");
  EXPECT_THAT(check({"CALL 2\n", "CALL 77\n"}), HasSubstr("OPT-E7102"));
  EXPECT_THAT(check({"DELAY 1\nGO 79\n"}), HasSubstr("OPT-E7102"));
  EXPECT_THAT(check({"CALL 2\n", "FUNCTION 50\n"}), HasSubstr("OPT-E7103"));
  EXPECT_EQ(check({"VI[1] = 77\nCALL VI[1]\n"}), "all");
}

// LIVE-5.02 (b), OPT-3.44: the schedules that it names, also in what it calls and in FUNCTIONs.
TEST_F(SelectedProgram, NamedSchedulesAreLookedFor) {
  Parameters few = parameters();
  ASSERT_TRUE(few.Set("SCHEDULES", 11.0));
  const auto check = [&](const std::vector<std::string>& programs) {
    std::map<int, StoredProgram> memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory[static_cast<int>(i) + 1] = Translated(programs[i]);
    const Status all = family_.CheckNeeds(memory, {{.number = 20}}, few, 1);
    return all ? std::string("all") : CodeText(all.error().code) + " " + all.error().detail;
  };
  EXPECT_EQ(check({"WORKDEF 2,0 (11)\n"}), "all");
  EXPECT_EQ(check({"WORKDEF 2,0 (20)\n"}), "all");
  EXPECT_EQ(check({"WORKDEF 2,0 (12)\n"}), "OPT-E7404 laser schedule 12, of program 1, step 1");
  EXPECT_EQ(check({"DELAY 1\nWORKDEF 1,3 (8.,75.,0.,50.,12)\n"}),
            "OPT-E7404 laser schedule 12, of program 1, step 2");
  EXPECT_EQ(check({"WORKDEF 1,3 (8.,75.,0.,50.)\nVI[1] = 12\nWORKDEF 2,0 (VI[1])\n"}), "all");
  EXPECT_EQ(check({"CALL 2\n", "WORKDEF 2,0 (63)\n"}),
            "OPT-E7404 laser schedule 63, of program 2, step 1");
  EXPECT_EQ(check({"FUNCTION 2\n", "WORKDEF 2,0 (63)\n"}),
            "OPT-E7404 laser schedule 63, of program 2, step 1");
  EXPECT_EQ(check({"DELAY 1\n", "WORKDEF 2,0 (63)\n"}), "all");  // nobody calls it
  ASSERT_TRUE(few.Set("LASER", "EFA51"));
  EXPECT_EQ(check({"WORKDEF 2,0 (12)\n"}), "all");  // WORK 2 is refused there, OPT-3.43
}

// LIVE-5.02 (b), OPT-B.73: room for the executables that the run makes, as it counts them.
TEST_F(SelectedProgram, RoomForExecutablesIsLookedFor) {
  std::map<int, StoredProgram> memory = {{1, Translated("CALL 2\nDELAY 1\n")},
                                         {2, Translated("DELAY 2\n")}};
  const auto check = [&](double bytes) {
    Parameters small = parameters();
    EXPECT_TRUE(small.Set("CMOS_SIZE", bytes));
    const Status all = family_.CheckNeeds(memory, {}, small, 1);
    return all ? std::string("all") : CodeText(all.error().code) + " " + all.error().detail;
  };
  // What else is stored takes room, too.
  memory[3].object = Bytes::Of(std::string(2000, 'x'));
  double least = 2000.0;
  while (check(least) != "all") ++least;
  // Both objects, and the executables that are made of them.
  const ObjectLookup objects = [&](int slot) -> std::optional<std::string_view> {
    return std::string_view(*memory.at(slot).object);
  };
  std::size_t bytes = 2000;
  for (const int slot : {1, 2}) {
    bytes += memory.at(slot).object->size() +
             family_.tools()->Link(slot, objects, parameters())->executable.size();
  }
  EXPECT_EQ(least, static_cast<double>(bytes));
  EXPECT_THAT(check(least - 1.0), HasSubstr("OPT-E7109 no room for executable 102"));
  EXPECT_THAT(check(2000.0), HasSubstr("OPT-E7109 no room for executable 101"));
  // One that was made before takes its place already, and the run makes it no more.
  memory[2].executable = Bytes::Of(std::string("damaged"));
  EXPECT_THAT(check(1e6), HasSubstr("OPT-E7034"));
}

// LIVE-9.06: an alarm that never was cannot be acknowledged; one that is no more can, again.
TEST_F(SelectedProgram, AnAlarmThatNeverWasIsNotAcknowledged) {
  Load({"DELAY 1\n"});
  Good(EmergencyStop{});
  Good(EmergencyStop{.pressed = false});
  const std::int64_t alarm = machine->status().alarms.at(0).id;
  EXPECT_THAT(Refused(Acknowledge{.alarm = alarm + 1}), HasSubstr("CELL-E9003"));
  EXPECT_THAT(Refused(Acknowledge{.alarm = 0}), HasSubstr("CELL-E9003"));
  Good(Acknowledge{.alarm = alarm});
  EXPECT_THAT(machine->status().alarms, IsEmpty());
  Good(Acknowledge{.alarm = alarm});
}

// LIVE-2.10, OPT-B.56: with the door open and the beam to come RESUME from afar is refused and the
// run stays held; the key at the machine is the control's own.
TEST_F(SelectedProgram, ResumeFromAfarLosesNoPart) {
  const auto hold = [&] {
    Load({"COORD ABSOL\nPATH LIN\nWORK 0,0/ON\nWAIT IL[20]\nWORK 0,0/OFF\n"});
    Start();
    GoOn(machine->time() + At(3.0));
    Good(MoveDoor{.open = true});
    GoOn(machine->time() + At(3.0));
    ASSERT_EQ(state(), MachineState::kHeld);
  };
  // Where no beam is due it goes on.
  Load({"DELAY 5\nDELAY 5\n"});
  Start();
  GoOn(At(1.0));
  Good(MoveDoor{.open = true});
  GoOn(At(2.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{.source = StartSource::kConsole});
  EXPECT_EQ(state(), MachineState::kRunning);
  hold();
  EXPECT_THAT(Refused(ResumeRun{.source = StartSource::kConsole}), HasSubstr("OPT-E7410"));
  EXPECT_EQ(state(), MachineState::kHeld);
  Good(MoveDoor{.open = false});
  Good(ResumeRun{.source = StartSource::kConsole});
  EXPECT_EQ(state(), MachineState::kRunning);
}

// OPT-4.61, OPT-4.42: what is selected while a run is suspended is shown until the run goes on, and
// stays selected when it is ended.
TEST_F(SelectedProgram, WhatIsSelectedInAHold) {
  Load({"DELAY 5\nDELAY 5\n", "DELAY 5\n"});
  Good(ChangeMode{Mode::kSingle});
  const auto hold_and_select = [&] {
    Good(StartRun{.program = 1, .source = StartSource::kPanel});
    GoOn(machine->time() + At(9.0));
    ASSERT_EQ(state(), MachineState::kHeld);
    for (const char* key : {"JOB", "0", "2", "ENT"}) ASSERT_TRUE(machine->PressKey(key)) << key;
    EXPECT_EQ(machine->selected_program(), 2);
    EXPECT_EQ(machine->panel().display, "P=02S=0000I=********");
  };
  hold_and_select();
  ASSERT_TRUE(machine->PressKey("START"));
  GoOn(machine->time() + At(1.0));
  EXPECT_EQ(machine->status().shown.program, 1);
  EXPECT_EQ(machine->status().shown.step, 2);
  Good(AbortRun{});
  Over();
  EXPECT_EQ(machine->selected_program(), 1);
  hold_and_select();
  Good(AbortRun{});
  Over();
  EXPECT_EQ(machine->selected_program(), 2);
}

// OPT-B.63, OPT-7.70: runs are counted from the selection of their program on, be it the same one
// again. What is selected beside a run that is held counts from its end, unless START goes on with
// the run.
TEST_F(SelectedProgram, RunsAreCountedFromTheSelectionOn) {
  Load({"DELAY 1\n", "DELAY 10\n"});
  Good(ChangeMode{Mode::kCycle});
  const auto tap = [&](const std::vector<std::string_view>& keys) {
    for (const std::string_view key : keys) ASSERT_TRUE(machine->PressKey(key)) << key;
  };
  const auto go_on_for = [&](double seconds) { GoOn(machine->time() + At(seconds)); };
  tap({"JOB", "0", "1", "ENT"});
  for (const char* runs : {"1", "2"}) {
    tap({"START"});
    go_on_for(5.0);
    EXPECT_EQ(Value("VI[98]"), runs);
  }
  tap({"JOB", "0", "1", "ENT"});
  EXPECT_EQ(Value("VI[98]"), "0");
  tap({"JOB", "0", "2", "ENT", "START"});
  go_on_for(1.0);
  tap({"STOP"});
  go_on_for(1.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  tap({"JOB", "0", "1", "ENT"});
  EXPECT_EQ(Value("VI[98]"), "1");
  tap({"START"});
  go_on_for(30.0);
  ASSERT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Value("VI[98]"), "1");
  tap({"START"});
  go_on_for(1.0);
  tap({"STOP"});
  go_on_for(1.0);
  tap({"JOB", "0", "1", "ENT"});
  EXPECT_EQ(Value("VI[98]"), "2");
  Good(AbortRun{});
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Value("VI[98]"), "0");
}

// LIVE-5.04, OPT-1.11: what a job brings is not in the memory: the executable that is made of it is
// not that of the slot, whose own program runs next.
TEST_F(SelectedProgram, TheExecutableOfWhatAJobBringsIsNotKept) {
  Load({"DELAY 1\n"});
  Good(StartRun{.program = 1, .source = StartSource::kQueue, .brought = Translated("VI[5]=7\n")});
  GoOn(At(5.0));
  Over();
  EXPECT_EQ(Value("VI[5]"), "7");
  EXPECT_THAT(machine->TakeMadeExecutables(), IsEmpty());
  Start(1);
  GoOn(At(10.0));
  EXPECT_EQ(Over().lasted, At(1.0));
}

// LIVE-2.11: a job of the queue goes on in REMOTE alone; what the console started goes on in CYCLE.
TEST_F(SelectedProgram, AJobIsHeldWhenItsMachineLeavesRemote) {
  for (const StartSource source : {StartSource::kQueue, StartSource::kConsole}) {
    Load({"DELAY 5\n"});
    Good(StartRun{.program = 1, .source = source});
    GoOn(At(1.0));
    Good(ChangeMode{Mode::kCycle});
    GoOn(At(2.0));
    const bool job = source == StartSource::kQueue;
    EXPECT_EQ(state(), job ? MachineState::kHeld : MachineState::kRunning);
  }
}

// OPT-1.13: a FUNCTION that was deleted since it was linked is told of, and what was linked runs.
TEST_F(SelectedProgram, ADeletedFunctionIsStale) {
  Load({"FUNCTION 2\nDELAY 1\n", "VI[1]=VI[1]+1\nRETURN\n"});
  Start(1);
  GoOn(At(5.0));
  Over();
  Good(DeleteProgram{2});
  heard.told.clear();
  Start(1);
  GoOn(At(10.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(Value("VI[1]"), "2");
  EXPECT_THAT(heard.told, testing::Contains(testing::EndsWith("finding OPT-E7110")));
}

}  // namespace
}  // namespace rmlcell::machine
