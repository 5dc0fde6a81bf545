// FUNCTION from the handbox, and HOME: what runs in MANUAL.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class FunctionKeys : public HandboxTest {
 protected:
  // Program 12 of four steps, at the last one; FUNCTION 44 with one parameter.
  void AtStep4(const std::string& function) {
    Have({{12, "SPEED 1\nSPEED 2\nSPEED 3\nENDTASK\n"}, {44, function}});
    Keys("JOB 1 2 NEXT 4 ENT");
  }
  motion::AxisPose axes() const { return machine->status().run.axes; }
};

// OPT-9.32 OPT-9.33 OPT-9.34 OPT-9.35: NO goes back, and REC records without executing.
TEST_F(FunctionKeys, IsRecordedWithoutExecution) {
  AtStep4("VR[1] = PAR[0]\nRETURN\n");
  Keys("F3");
  EXPECT_EQ(Shows(), "FUNCTION = 00");
  Keys("4 4 ENT");
  EXPECT_EQ(Shows(), "NUMBER PARAMETERS=0");
  Keys("1 ENT");
  EXPECT_EQ(Shows(), "PAR0 = 0.0");
  Keys("DEL 7 ENT");
  EXPECT_EQ(Shows(), "EXECUTION?");
  Keys("0");
  EXPECT_EQ(Shows(), "*FUNCTION = 44");
  Keys("REC");
  EXPECT_EQ(Program(12).at(3), "FUNCTION 44 (7.0)");
  EXPECT_EQ(Shows(), "P=12S=0005I=ENDTASK");
  EXPECT_EQ(Value("VR[1]"), "0.0");
}

// OPT-9.33: PREV and NEXT go through the parameters; there are eight at most.
TEST_F(FunctionKeys, ParametersAreGoneThrough) {
  AtStep4("RETURN\n");
  Keys("F3 4 4 ENT 9 ENT");
  EXPECT_EQ(Said(), 7604);
  Keys("8 ENT");
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(Shows(), "PAR" + std::to_string(i) + " = 0.0");
    Keys("NEXT");
  }
  Keys("PREV DEL MINUS 1 POINT 5 ENT 0 REC");
  EXPECT_EQ(Program(12).at(3), "FUNCTION 44 (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.5, 0.0)");
  Keys("F3 0 ENT");
  EXPECT_EQ(Said(), 7604);
}

// OPT-9.36 OPT-9.37: YES runs it in MANUAL; then it can be recorded.
TEST_F(FunctionKeys, YesExecutesIt) {
  AtStep4("VR[1] = PAR[0]\nDELAY 1\nRETURN\n");
  Keys("F3 4 4 ENT 1 ENT DEL 7 ENT 1");
  EXPECT_EQ(Said(), 0);
  GoOn(At(0.5));
  EXPECT_EQ(Shows(), "P=44S=0002I=DELAY");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
  Keys("REC");
  EXPECT_EQ(Said(), 7601);
  Keys("ERR");
  GoOn(At(2.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(Value("VR[1]"), "7.0");
  EXPECT_EQ(Shows(), "*P=12 S=0004 FUNC=44");
  Keys("REC");
  EXPECT_EQ(Program(12).at(3), "FUNCTION 44 (7.0)");
}

// OPT-9.36: 40 % of the override that is selected, which changes it at once.
TEST_F(FunctionKeys, MovesAtAShareOfTheOverride) {
  AtStep4(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (100.,2201.2,-350.,0.,0.)\nMOVE (900.,2201.2,-350.,0.,0.)\nRETURN\n");
  Keys("F3 4 4 ENT ENT 1");
  while (machine->status().run.place.step < 5) GoOn(machine->time() + At(0.1));
  GoOn(machine->time() + At(2.0));
  EXPECT_NEAR(machine->status().run.tip_speed_mm_s, 20.0, 1e-6);  // 4 % of 500 mm/s
  Keys("OVERRIDE_MINUS OVERRIDE_MINUS");
  GoOn(machine->time() + At(2.0));
  EXPECT_NEAR(machine->status().run.tip_speed_mm_s, 14.0, 1e-6);
}

// OPT-9.36: STOP holds it, START goes on; SHIFT STOP ends it.
TEST_F(FunctionKeys, StopStartAndAbort) {
  AtStep4("DELAY 4\nVR[1] = 5.\nDELAY 4\nRETURN\n");
  Keys("F3 4 4 ENT ENT 1");
  GoOn(At(1.0));
  Keys("STOP");
  GoOn(At(9.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Value("VR[1]"), "0.0");
  Keys("MODE_RIGHT");
  EXPECT_EQ(Said(), 7601);
  Keys("START");
  EXPECT_EQ(Said(), 0);
  GoOn(At(14.0));
  EXPECT_EQ(Value("VR[1]"), "5.0");
  Keys("SHIFT STOP");
  GoOn(At(15.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-9.36: one that is not there, or axes without reference.
TEST_F(FunctionKeys, WhatCannotBeExecuted) {
  AtStep4("RETURN\n");
  Keys("F3 4 5 ENT ENT 1");
  GoOn(At(1.0));
  EXPECT_EQ(Over().outcome.code, ErrorCode::kFunctionMissing);
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Keys("F3 4 4 ENT ENT 1");
  EXPECT_EQ(Said(), 7310);
}

// OPT-4.06 OPT-9.37: what fails shows its number at once, and until ERR; it is not ready to record
// then, and REC is as with nothing flashing. NO records it all the same (OPT-9.35).
TEST_F(FunctionKeys, WhatFailsIsShownAndNotReadyToRecord) {
  AtStep4("COORD ROBOT\nPATH LIN\nMOVE (100.,2201.2,-350.,0.,0.)\nRETURN\n");
  const std::string before = ObjectAt(12);
  Keys("F3 4 5 ENT ENT 1");
  EXPECT_EQ(Shows(), "ERROR 7103");
  GoOn(At(1.0));
  EXPECT_EQ(Shows(), "ERROR 7103");
  EXPECT_EQ(machine->panel().message, ErrorCode::kFunctionMissing);
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=12S=0004I=ENDTASK");
  Keys("F3 4 4 ENT ENT 1");
  GoOn(At(2.0));
  EXPECT_EQ(Shows(), "ERROR 7302");
  Keys("REC");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Shows(), "ERROR 7302");
  EXPECT_EQ(ObjectAt(12), before);
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=12S=0004I=ENDTASK");
  Keys("F3 4 4 ENT ENT 0 REC");
  EXPECT_EQ(Program(12).at(3), "FUNCTION 44");
}

// OPT-4.06: its error is shown, whatever a key was told meanwhile.
TEST_F(FunctionKeys, AnErrorTakesThePlaceOfWhatAKeyWasTold) {
  AtStep4("DELAY 1\nCOORD ROBOT\nPATH LIN\nMOVE (100.,2201.2,-350.,0.,0.)\nRETURN\n");
  Keys("F3 4 4 ENT ENT 1");
  GoOn(At(0.5));
  Keys("REC");
  EXPECT_EQ(Shows(), "ERROR 7601");
  GoOn(At(2.0));
  EXPECT_EQ(Shows(), "ERROR 7302");
}

// OPT-9.36: it begins with the modes of the handbox.
TEST_F(FunctionKeys, ItBeginsWithTheModesOfTheHandbox) {
  AtStep4("DELAY 4\nRETURN\n");
  const auto modes = [this] {
    std::string text;
    Keys("F3 4 4 ENT ENT 1");
    GoOn(machine->time() + At(1.0));
    for (const machine::ModalValue& one : machine->modal_values()) {
      if (one.name == "COORD" || one.name == "PATH" || one.name == "SPEED" || one.name == "OVERSH")
        text += one.name + " " + one.value + "; ";
    }
    Keys("SHIFT STOP");
    GoOn(machine->time() + At(1.0));
    return text;
  };
  EXPECT_EQ(modes(), "COORD ROBOT; PATH PTP; SPEED 70.0; OVERSH 100.0; ");
  Keys("DYN NEXT ENT PATH NEXT ENT MOV DEL 3 5 ENT F2 DEL 5 0 ENT");
  EXPECT_EQ(modes(), "COORD ABSOL; PATH LIN; SPEED 35.0; OVERSH 50.0; ");
  Keys("PATH NEXT ENT");
  EXPECT_EQ(modes(), "COORD ABSOL; PATH CIR; SPEED 35.0; OVERSH 50.0; ");
  Keys("PATH NEXT ENT DEL 1 2 POINT 5 ENT");
  EXPECT_EQ(modes(), "COORD ABSOL; PATH HOLE (12.5); SPEED 35.0; OVERSH 50.0; ");
}

// OPT-9.19: without a rotary table 99 is an ordinary function, missing where it is not stored, and
// carried out where it is, in whatever slots there are programs. OPT-9.06: it is nobody's main
// program.
TEST_F(FunctionKeys, Function99IsAnOrdinaryOne) {
  AtStep4("RETURN\n");
  Keys("F3 9 9 ENT ENT 1");
  GoOn(At(1.0));
  const machine::RunOver over = Over();
  EXPECT_EQ(over.outcome.code, ErrorCode::kFunctionMissing);
  EXPECT_EQ(std::string(over.outcome.detail), "no object for FUNCTION 99");
  EXPECT_EQ(over.run.program, 0);
  Keys("ERR");
  for (int slot = kSlotMin; slot <= kSlotMax; ++slot)
    Good(machine::StoreProgram{.slot = slot, .program = Translated("VR[1] = 9.\nRETURN\n")});
  Keys("F3 9 9 ENT ENT 1");
  GoOn(At(2.0));
  EXPECT_EQ(Over().outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(Value("VR[1]"), "9.0");
  EXPECT_EQ(Shows(), "*P=12 S=0003 FUNC=99");  // at the end of what 12 is now
}

// LIVE-3.16: what runs by hand is no program of the memory, until a FUNCTION is in one.
TEST_F(FunctionKeys, WhatRunsByHandIsNoProgram) {
  AtStep4("DELAY 1\nRETURN\n");
  Hold("X+", 4.0);
  Keys("ERR");
  const auto place = [this] { return machine->status().run.place; };
  Do("HOME", KeyAction::kPress);
  GoOn(machine->time() + At(1.0));
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_EQ(machine->status().open->program, 0);
  EXPECT_EQ(place(), machine::Place());
  Do("HOME", KeyAction::kRelease);
  GoOn(machine->time() + At(2.0));
  Keys("F3 4 4 ENT ENT 1");
  GoOn(machine->time() + At(0.5));
  EXPECT_EQ(state(), MachineState::kRunning);  // LIVE-2.03: jog, HOME and ZERO are by hand
  EXPECT_EQ(place().program, 44);
  EXPECT_EQ(place().step, 1);
  EXPECT_EQ(machine->loaded_programs(), std::set<int>{44});  // it cannot be deleted meanwhile
}

// OPT-9.37: whatever a FUNCTION runs, what is selected and taught into is the program as before.
TEST_F(FunctionKeys, TheSelectedProgramStays) {
  AtStep4("DELAY 4\nDELAY 4\nRETURN\n");
  Keys("F3 4 4 ENT ENT 1");
  GoOn(At(1.0));
  EXPECT_EQ(machine->selected_program(), 12);
  Keys("STOP");
  GoOn(At(2.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->selected_program(), 12);
  const std::string before = ObjectAt(44);
  Keys("REC");
  EXPECT_EQ(ObjectAt(44), before);
  Keys("SHIFT STOP");
  GoOn(At(3.0));
  EXPECT_EQ(machine->selected_program(), 12);
}

// LIVE-7.02, LIVE-7.08: what is shown of a program follows what is stored of it by others.
TEST_F(FunctionKeys, TheDisplayFollowsWhatIsStored) {
  AtStep4("RETURN\n");
  ASSERT_EQ(Shows(), "P=12S=0004I=ENDTASK");
  Good(machine::StoreProgram{.slot = 12, .program = Translated("SPEED 1\nDELAY 2\n")});
  EXPECT_EQ(Shows(), "P=12S=0003I=ENDPRG");
  Keys("PREV");
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
  Good(machine::StoreProgram{.slot = 12, .program = Translated("SPEED 1\nSPEED 2\nDELAY 3\n")});
  EXPECT_EQ(Shows(), "P=12S=0002I=SPEED");
  Good(machine::DeleteProgram{.slot = 12});
  EXPECT_EQ(machine->status().shown.step, 0);
  EXPECT_EQ(machine->selected_program(), 12);
}

// OPT-4.15 OPT-4.35: while it is down, at the speed of jog.
TEST_F(FunctionKeys, HomeMovesWhileItIsDown) {
  Have({});
  const motion::AxisPose home = axes();  // a new machine stands there, OPT-B.02
  Hold("X+", 4.0);
  const motion::AxisPose away = axes();
  Do("HOME", KeyAction::kPress);
  EXPECT_EQ(Said(), 0);
  GoOn(machine->time() + At(1.0));
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_LE(machine->status().run.tip_speed_mm_s, 105.0 + 1e-6);
  Do("HOME", KeyAction::kRelease);
  GoOn(machine->time() + At(2.0));
  const motion::AxisPose between = axes();
  EXPECT_LT(between.column.x(), away.column.x() - 50.0);
  EXPECT_GT(between.column.x(), home.column.x() + 50.0);
  GoOn(machine->time() + At(5.0));
  EXPECT_EQ(axes(), between);
  Keys("HOME");  // a TAP leaves no motion
  GoOn(machine->time() + At(2.0));
  EXPECT_EQ(axes(), between);
  Do("HOME", KeyAction::kPress);
  GoOn(machine->time() + At(30.0));
  EXPECT_NEAR(axes().column.x(), home.column.x(), 1e-3);
  EXPECT_NEAR(axes().column.y(), home.column.y(), 1e-3);
  EXPECT_EQ(state(), MachineState::kIdle);
  Do("HOME", KeyAction::kRelease);
  EXPECT_EQ(Said(), 0);
}

// OPT-4.35 OPT-4.37: at the step of the override, also one that comes while it moves.
TEST_F(FunctionKeys, HomeFollowsTheOverride) {
  Have({});
  Hold("X+", 4.0);
  const auto speed = [this] { return machine->status().run.tip_speed_mm_s; };
  Keys("OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS");
  Do("HOME", KeyAction::kPress);
  for (const double share : {0.0005, 0.003, 0.01, 0.03, 0.09, 0.15}) {
    GoOn(machine->time() + At(0.5));
    EXPECT_NEAR(speed(), 500.0 * share, 1e-6);
    Keys("OVERRIDE_PLUS");
  }
  Do("HOME", KeyAction::kRelease);
  GoOn(machine->time() + At(2.0));
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-4.74 OPT-4.12 OPT-E.7310
TEST_F(FunctionKeys, HomeNeedsZeroedAxesAndManual) {
  Have({});
  Hold("X+", 1.0);
  const motion::AxisPose here = axes();
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle, Mode::kRemote}) {
    Good(machine::ChangeMode{mode});
    Hold("HOME", 1.0);
    EXPECT_EQ(axes(), here);
  }
  Good(machine::ChangeMode{Mode::kManual});
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Do("HOME", KeyAction::kPress);
  EXPECT_EQ(Said(), 7310);
  GoOn(machine->time() + At(1.0));
  EXPECT_EQ(axes(), here);
}

// LIVE-7.05 LIVE-7.06: nobody is heard any more; a mode key; the emergency stop.
TEST_F(FunctionKeys, WhatStopsHome) {
  Have({});
  Hold("X+", 8.0);
  const auto stops = [this](const auto& how) {
    Do("HOME", KeyAction::kPress);
    GoOn(machine->time() + At(0.5));
    how();
    GoOn(machine->time() + At(2.0));
    const motion::AxisPose stopped = axes();
    GoOn(machine->time() + At(2.0));
    EXPECT_EQ(axes(), stopped);
    EXPECT_FALSE(machine->open_run());
  };
  stops([this] { Good(machine::ReleaseJogs{}); });
  stops([this] { Keys("MODE_RIGHT"); });
  EXPECT_EQ(machine->status().mode, Mode::kManual);
  stops([this] { Good(machine::MoveDoor{.open = true}); });
  Good(machine::MoveDoor{.open = false});
  stops([this] { Keys("EMERGENCY_STOP"); });
}

}  // namespace
}  // namespace rmlcell::optimo
