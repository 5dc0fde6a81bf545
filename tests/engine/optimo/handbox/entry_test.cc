// Data entry: fields, choices, and an instruction that is ready to record.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class Entry : public HandboxTest {
 protected:
  // Program 12 with seven steps, at step 7.
  void AtStep7() {
    Have({{12, "SPEED 1\nSPEED 2\nSPEED 3\nSPEED 4\nSPEED 5\nSPEED 6\nENDTASK\n"}});
    Keys("JOB 1 2 NEXT 7 ENT");
  }
  std::string Step7() const { return Program(12).at(6); }
};

// OPT-5.01 OPT-4.43 OPT-B.74: the first form of each key.
TEST_F(Entry, KeysOpenForms) {
  AtStep7();
  for (const auto& [key, text] :
       std::vector<std::pair<std::string, std::string>>{{"MOV", "SPEED 70.0"},
                                                        {"TCP", "X0 = 0.0"},
                                                        {"DYN", "COORD ROBOT"},
                                                        {"PATH", "PATH PTP"},
                                                        {"WORK", "TOOL = 0 PROGR = 00"},
                                                        {"DLY", "DELAY 0.0"},
                                                        {"OUT", "OUT 00 = 0"},
                                                        {"DEB", "BREAK = OFF"},
                                                        {"START", "ISTR GO"},
                                                        {"F2", "OVERSH 100"},
                                                        {"F3", "FUNCTION = 00"},
                                                        {"SHIFT F3", "SYSDEF = NO"},
                                                        {"F6", "SIM PRG 12 STEP 0000"},
                                                        {"F8", "GOSUB 0000"},
                                                        {"JOB", "P=12 S=0000 T=0 M=0"}}) {
    Keys(key);
    EXPECT_EQ(Shows(), text);
    EXPECT_EQ(Said(), 0);
    Keys("ERR");
    EXPECT_EQ(Shows(), "P=12S=0007I=ENDTASK") << key;
  }
  EXPECT_THAT(edits, IsEmpty());
}

// OPT-4.12: forms are of MANUAL.
TEST_F(Entry, FormsAreOfManual) {
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle}) {
    Have({}, mode);
    for (const char* key :
         {"MOV", "TCP", "DYN", "PATH", "WORK", "DLY", "OUT", "DEB", "CAL",  "F2",
          "F3",  "F6",  "F8",  "ZERO", "HOME", "REC", "DEL", "ENT", "NEXT", "5"}) {
      Keys(key);
      EXPECT_EQ(Said(), 7601) << key;
    }
  }
}

// OPT-5.02 OPT-5.03 OPT-4.33: the name flashes, and is recorded by REC.
TEST_F(Entry, AnInstructionIsReadyToRecord) {
  AtStep7();
  Keys("PATH NEXT ENT");
  EXPECT_EQ(Shows(), "*PATH");
  EXPECT_THAT(edits, IsEmpty());
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0008I=ENDTASK");
  EXPECT_EQ(Step7(), "PATH LIN");
}

// OPT-5.02: with no program selected there is nothing to record; the mode is set.
TEST_F(Entry, WithoutProgramOnlyTheModeIsSet) {
  Have({});
  Keys("PATH NEXT ENT");
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  Keys("PATH");
  EXPECT_EQ(Shows(), "PATH LIN");
  Keys("ERR REC");
  EXPECT_EQ(Said(), 7602);
}

// OPT-5.04: another key, or a jog key, drops it.
TEST_F(Entry, AnotherKeyDropsIt) {
  AtStep7();
  Keys("MOV ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Keys("X+");
  EXPECT_EQ(Shows(), "*MOVE");
  Keys("DLY");
  EXPECT_EQ(Shows(), "DELAY 0.0");
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=12S=0007I=ENDTASK");
}

// OPT-5.05 OPT-5.06: once it flashes, ERR has no effect; MOV and ERR get rid of it.
TEST_F(Entry, ErrBeforeAndBehindEnt) {
  AtStep7();
  Keys("MOV ERR");
  EXPECT_EQ(Shows(), "P=12S=0007I=ENDTASK");
  Keys("MOV ENT ERR");
  EXPECT_EQ(Shows(), "*SPEED");
  Keys("X+ MOV");
  EXPECT_EQ(Shows(), "SPEED 70.0");
  Keys("ERR");
  EXPECT_EQ(Shows(), "P=12S=0007I=ENDTASK");
}

// OPT-5.07 OPT-4.25 OPT-4.41 OPT-B.76: DEL first.
TEST_F(Entry, ADecimalFieldIsClearedFirst) {
  AtStep7();
  Keys("MOV 3 0");
  EXPECT_EQ(Shows(), "SPEED 70.0");
  Keys("DEL");
  EXPECT_EQ(Shows(), "SPEED");
  Keys("3 0");
  EXPECT_EQ(Shows(), "SPEED 30");
  Keys("POINT 5 POINT ENT REC");
  EXPECT_EQ(Step7(), "SPEED 30.5");
  Keys("MOV");
  EXPECT_EQ(Shows(), "SPEED 30.5");
  Keys("TCP DEL MINUS 1 2 MINUS POINT 5");
  EXPECT_EQ(Shows(), "X0 = -12.5");
}

// OPT-5.08: no DEL where there is no point.
TEST_F(Entry, DigitsPushOthersOut) {
  AtStep7();
  Keys("DEB NEXT ENT 1 2");
  EXPECT_EQ(Shows(), "STEP = 012 PRG = 12");
  Keys("3 4");
  EXPECT_EQ(Shows(), "STEP = 234 PRG = 12");
  Keys("POINT MINUS");
  EXPECT_EQ(Shows(), "STEP = 234 PRG = 12");
  Keys("DEL 5");
  EXPECT_EQ(Shows(), "STEP = 005 PRG = 12");
}

// OPT-5.09
TEST_F(Entry, ErrInAFieldGivesItUp) {
  AtStep7();
  Keys("MOV DEL 3 ERR");
  EXPECT_EQ(Shows(), "P=12S=0007I=ENDTASK");
  Keys("MOV");
  EXPECT_EQ(Shows(), "SPEED 70.0");
}

// OPT-5.10 OPT-E.7604
TEST_F(Entry, AValueOutOfRangeIsRefused) {
  AtStep7();
  Keys("MOV DEL 1 4 0 ENT");
  EXPECT_EQ(Said(), 7604);
  EXPECT_EQ(Shows(), "SPEED 140");
  Keys("DEL ENT");  // nothing
  EXPECT_EQ(Said(), 7604);
  Keys("DEL 1 0 0 ENT");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Shows(), "*SPEED");
}

// OPT-5.23 OPT-5.24: through the fields, and back; it stays at the ends.
TEST_F(Entry, MovHasSixFields) {
  AtStep7();
  Keys("MOV");
  for (const char* text : {"FLY = 0", "START = 0", "TIME = 0", "END = 0", "NEXT = 0", "NEXT = 0"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows(), text);
  }
  for (const char* text :
       {"END = 0", "TIME = 0", "START = 0", "FLY = 0", "SPEED 70.0", "SPEED 70.0"}) {
    Keys("PREV");
    EXPECT_EQ(Shows(), text);
  }
  Keys("NEXT 2 ENT");
  EXPECT_EQ(Said(), 7604);
  EXPECT_EQ(Shows(), "FLY = 2");
  Keys("1 ENT");
  EXPECT_EQ(Shows(), "*SPEED");
}

// OPT-5.12 OPT-5.13
TEST_F(Entry, DynAndPathChoose) {
  AtStep7();
  Keys("DYN NEXT");
  EXPECT_EQ(Shows(), "COORD ABSOL");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*COORD");
  Keys("REC");
  EXPECT_EQ(Step7(), "COORD ABSOL");
  Keys("DYN");
  EXPECT_EQ(Shows(), "COORD ABSOL");
  Keys("PATH");
  for (const char* text : {"PATH LIN", "PATH CIR", "PATH HOL", "PATH PTP"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows(), text);
  }
  Keys("PREV PREV ENT REC");
  EXPECT_EQ(Program(12).at(7), "PATH CIR");
}

// OPT-5.27 OPT-5.28 OPT-4.46 OPT-4.47
TEST_F(Entry, OvershDelayGosub) {
  AtStep7();
  Keys("F2 DEL 5 0 ENT");
  EXPECT_EQ(Shows(), "*OVERSH");
  Keys("REC DLY DEL POINT 5 ENT");
  EXPECT_EQ(Shows(), "*DELAY");
  Keys("REC");
  EXPECT_EQ(Program(12).at(6), "OVERSH 50");
  EXPECT_EQ(Program(12).at(7), "DELAY 0.5");
  Keys("F8 1 0 0");
  EXPECT_EQ(Shows(), "GOSUB 0100");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*GOSUB");
  Keys("REC");
  EXPECT_EQ(Program(12).at(8), "GOSUB 100");
}

// OPT-4.47
TEST_F(Entry, GosubOfAProgramMadeOffLine) {
  Have({{1, "SPEED 5\nENDTASK\n100 DELAY 1\nRETURN\n"}});
  Keys("JOB 1 NEXT 2 ENT F8 1 0 0 ENT REC");
  EXPECT_THAT(Program(1), ElementsAre("SPEED 5", "GOSUB 100", "ENDTASK", "100  DELAY 1", "RETURN"));
}

// OPT-4.73 OPT-4.64: six values; the tip moves, and it is recorded.
TEST_F(Entry, TcpHasSixValues) {
  AtStep7();
  const double tip = machine->status().run.tip.tip.z();
  Keys("TCP");
  for (const char* text :
       {"Y0 = 0.0", "Z0 = 0.0", "X1 = 0.0", "Y1 = 0.0", "Z1 = -5.0", "Z1 = -5.0"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows(), text);
  }
  Keys("TCP NEXT NEXT DEL 3 ENT");
  EXPECT_EQ(Shows(), "*TCP");
  EXPECT_NEAR(machine->status().run.tip.tip.z(), tip + 3.0, 1e-9);  // OPT-4.65, OPT-4.69
  Keys("REC");
  EXPECT_EQ(Step7(), "TCP (0.0, 0.0, 3.0 / 0.0, 0.0, -5.0)");
}

// OPT-5.37 OPT-B.75: the output is set at once, and LET flashes.
TEST_F(Entry, OutSetsAnOutput) {
  AtStep7();
  Keys("OUT 1 1 NEXT 1");
  EXPECT_EQ(Shows(), "OUT 11 = 1");
  EXPECT_EQ(Value("OL[11]"), "0");
  Keys("ENT");
  EXPECT_EQ(Value("OL[11]"), "1");
  EXPECT_EQ(Shows(), "*P=12S=0007I=LET");
  Keys("REC");
  EXPECT_EQ(Step7(), "LET OL[11] = 1");
  Keys("OUT ENT");
  EXPECT_EQ(Said(), 7604);
}

// OPT-5.41 OPT-5.37: what the control refuses is not ready to record.
TEST_F(Entry, AnOutputThatIsNotFitted) {
  AtStep7();
  Keys("OUT 9 NEXT 1 ENT");
  EXPECT_EQ(Said(), 931);
  EXPECT_EQ(Value("OL[9]"), "0");
  EXPECT_EQ(Shows(), "ERROR 931");
}

// OPT-5.43 OPT-5.44 OPT-B.75: recorded, and not carried out.
TEST_F(Entry, StartInManualMakesLinks) {
  AtStep7();
  Keys("START");
  EXPECT_EQ(Shows(), "ISTR GO");
  Keys("NEXT");
  EXPECT_EQ(Shows(), "ISTR CALL");
  Keys("ENT");
  EXPECT_EQ(Shows(), "PROG 00");
  Keys("4 6 ENT");
  EXPECT_EQ(Shows(), "*P=12 S=0007 CALL");
  Keys("REC");
  EXPECT_EQ(Step7(), "CALL 46");
  EXPECT_EQ(state(), MachineState::kIdle);
  Keys("START ENT 4 7 ENT");
  EXPECT_EQ(Shows(), "*P=12 S=0008 GO");
  Keys("REC");
  EXPECT_EQ(Program(12).at(7), "GO 47");
  EXPECT_EQ(machine->status().last_run, 0);
}

// OPT-5.29 OPT-5.30 OPT-5.33 OPT-5.34 OPT-5.35
TEST_F(Entry, WorkHasDefOnAndOff) {
  AtStep7();
  Keys("WORK ENT");
  EXPECT_EQ(Shows(), "WORK = DEF");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*WORKDEF");
  Keys("REC WORK ENT NEXT");
  EXPECT_EQ(Shows(), "WORK = ON");
  Keys("ENT");
  EXPECT_EQ(Shows(), "START = 0");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*WORKON");
  Keys("REC WORK ENT NEXT NEXT");
  EXPECT_EQ(Shows(), "WORK = OFF");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*WORKOFF");
  Keys("REC WORK 2 NEXT 5 ENT ENT");
  EXPECT_EQ(Shows(), "PROG 00");
  Keys("ENT");
  EXPECT_EQ(Said(), 7604);
  Keys("1 5 ENT REC WORK ENT NEXT ENT 1 ENT");
  EXPECT_EQ(Shows(), "INPUT = 00");
  Keys("1 6 ENT REC");
  const std::vector<std::string> steps = Program(12);
  EXPECT_THAT(std::vector(steps.begin() + 6, steps.end()),
              ElementsAre("WORKDEF 0,0", "WORK 0,0 /ON", "WORK 0,0 /OFF", "WORKDEF 2,5 (15)",
                          "WORK 0,0 /ON /START (IL[16])", "ENDTASK"));
}

// OPT-5.31 OPT-5.32: recorded in another order than asked for; PROG 0 is none.
TEST_F(Entry, WorkdefOfALaser) {
  AtStep7();
  Keys("WORK 1 ENT ENT DEL 7 5 NEXT DEL 8 NEXT DEL 1 NEXT DEL 5 0 NEXT");
  EXPECT_EQ(Shows(), "PROG 00");
  Keys("ENT REC");
  EXPECT_EQ(Step7(), "WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0)");
  Keys("WORK 1 ENT ENT");
  for (const char* text : {"POWER 0.0", "SPEED 0.0", "DELAY 0.0", "PEAK 0.0", "PROG 00"}) {
    EXPECT_EQ(Shows(), text);
    Keys("NEXT");
  }
  Keys("1 2 ENT");  // SPEED is above 0, OPT-3.08
  EXPECT_EQ(Said(), 7604);
  Keys("PREV PREV PREV DEL 8 ENT REC");
  EXPECT_EQ(Program(12).at(7), "WORKDEF 1,0 (8.0, 0.0, 0.0, 0.0, 12)");
}

// OPT-9.38
TEST_F(Entry, SysdefIsSetAndCancelled) {
  AtStep7();
  const auto sysdef = [this] { return machine->modal_values().back().value; };
  Keys("SHIFT F3 NEXT");
  EXPECT_EQ(Shows(), "SYSDEF = YES");
  Keys("ENT");
  for (const char* text :
       {"X = 0.0", "Y = 0.0", "Z = 0.0", "RZ = 0.0", "RY = 0.0", "RX = 0.0", "RX = 0.0"}) {
    EXPECT_EQ(Shows(), text);
    Keys("NEXT");
  }
  Keys("SHIFT F3 NEXT ENT DEL 1 0 ENT");
  EXPECT_EQ(Shows(), "*SYSDEF");
  EXPECT_EQ(sysdef(), "(10.0, 0.0, 0.0, 0.0, 0.0, 0.0)");
  Keys("REC SHIFT F3 ENT");
  EXPECT_EQ(sysdef(), "OFF");
  Keys("REC");
  EXPECT_EQ(Program(12).at(6), "SYSDEF (10.0, 0.0, 0.0, 0.0, 0.0, 0.0)");
  EXPECT_EQ(Program(12).at(7), "SYSDEF");
}

// OPT-5.04: what a key drops that has something else to do: a form, a question, what flashes.
TEST_F(Entry, WhatDropsWhatWasEntered) {
  const std::string at_step = "P=12S=0007I=ENDTASK";
  for (const auto& [keys, shows] : std::vector<std::pair<std::string, std::string>>{
           {"MOV HOME", at_step},
           {"MOV ZERO 0", at_step},
           {"MOV SHIFT DEL 0", at_step},
           {"MOV MODE_RIGHT", at_step},
           {"MOV MODE_LEFT", "SPEED 70.0"},  // it is MANUAL already
           {"ZERO JOB", "P=12 S=0000 T=0 M=0"},
           {"MOV ENT JOB ERR", at_step},
           {"JOB SHIFT NEXT", at_step},
           {"MOV EMERGENCY_STOP", "ERROR 7610"}}) {
    AtStep7();
    Keys(keys);
    EXPECT_EQ(Shows(), shows) << keys;
  }
  Have({{12, "DELAY 1\n"}}, Mode::kCycle);
  Keys("JOB 1 2 ENT JOB START");
  GoOn(At(0.5));
  EXPECT_EQ(Shows(), "P=12S=0001I=DELAY");
}

// OPT-4.44: they are looked at, and no key changes them.
TEST_F(Entry, CalShowsParameters) {
  Have({});
  Keys("CAL");
  EXPECT_EQ(Shows(), "VMAX 500");
  Keys("DEL 5 NEXT PREV");
  EXPECT_EQ(Shows(), "VMAX 500");
  Keys("NEXT");
  EXPECT_EQ(Shows(), "AMAX 2000");
  Keys("ENT");
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
}

// LIVE-7.01: a run that stands has its own TCP and SYSDEF.
TEST_F(Entry, TheToolOfARunIsItsOwn) {
  Have({{1, "DELAY 1\nDELAY 1\n"}}, Mode::kSingle);
  Keys("JOB 1 ENT START");
  GoOn(At(2.0));
  Keys("MODE_LEFT MODE_LEFT MODE_LEFT TCP ENT");
  EXPECT_EQ(Said(), 7601);
  Keys("SHIFT F3 ENT");
  EXPECT_EQ(Said(), 7601);
}

// OPT-5.04: a jog key drops a form and a question, too.
TEST_F(Entry, AJogKeyDropsWhatIsOpen) {
  for (const char* keys : {"MOV X+", "ZERO X+", "MOV ENT X+"}) {
    AtStep7();
    Keys(keys);
    EXPECT_EQ(Shows(), "*MOVE") << keys;
  }
}

// OPT-5.31: schedule 1 is recorded like any other.
TEST_F(Entry, WorkdefWithTheFirstSchedule) {
  AtStep7();
  Keys("WORK 1 ENT ENT NEXT DEL 8 NEXT NEXT NEXT 1 ENT REC");
  EXPECT_EQ(Step7(), "WORKDEF 1,0 (8.0, 0.0, 0.0, 0.0, 1)");
}

// OPT-4.27 OPT-4.45: keys without function leave a form, a question and what flashes as it is.
TEST_F(Entry, KeysWithoutFunctionLeaveWhatIsOpen) {
  for (const auto& [open, shows] : {std::pair{"MOV", "SPEED 70.0"}, std::pair{"ZERO", "ZERO AXIS?"},
                                    std::pair{"MOV ENT", "*SPEED"}}) {
    AtStep7();
    Keys(open);
    for (const char* key : {"MOD", "STEP", "PAR", "DISP", "F1", "F4", "F5", "F7"}) {
      Keys(key);
      EXPECT_EQ(Said(), 7601) << open << " " << key;
      EXPECT_EQ(Shows(), shows) << key;
    }
  }
  // OPT-4.12: nor does a key of MANUAL anything in a form that is open in another mode.
  Have({{12, "DELAY 1\n"}}, Mode::kCycle);
  Keys("JOB 1 2 ENT JOB MOV");
  EXPECT_EQ(Said(), 7601);
  EXPECT_EQ(Shows(), "P=12 S=0000 T=0 M=0");
  EXPECT_THAT(edits, IsEmpty());
}

}  // namespace
}  // namespace rmlcell::optimo
