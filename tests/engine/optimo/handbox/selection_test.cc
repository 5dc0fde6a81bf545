// Programs and steps: selecting, creating, deleting.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class Selection : public HandboxTest {};

// OPT-4.42 OPT-4.57 OPT-4.03 OPT-B.74: digits come in at the right, NEXT goes to the next field.
TEST_F(Selection, JobSelectsProgramAndStep) {
  Have({{45, "SPEED 5\nDELAY 1\nMOVE (1.,2.,3.,0.,0.)\n"}});
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  Keys("JOB");
  EXPECT_EQ(Shows(), "P=00 S=0000 T=0 M=0");
  Keys("4 5");
  EXPECT_EQ(Shows(), "P=45 S=0000 T=0 M=0");
  Keys("ENT");
  EXPECT_EQ(Shows(), "P=45S=0000I=********");
  Keys("JOB NEXT 3");
  EXPECT_EQ(Shows(), "P=45 S=0003 T=0 M=0");
  Keys("PREV DEL 4 5 ENT");
  EXPECT_EQ(Shows(), "P=45S=0003I=MOVE");
}

// OPT-4.57 OPT-4.29: DEL clears a field, ERR gives it up.
TEST_F(Selection, JobIsGivenUp) {
  Have({{45, "SPEED 5\n"}});
  Keys("JOB 4 5 ENT JOB 1 2 DEL");
  EXPECT_EQ(Shows(), "P=00 S=0000 T=0 M=0");
  Keys("7 ERR");
  EXPECT_EQ(Shows(), "P=45S=0000I=********");
}

// OPT-4.58 OPT-E.7604
TEST_F(Selection, ProgramZeroIsRefused) {
  Have({});
  Keys("JOB 0 ENT");
  EXPECT_EQ(Said(), 7604);
  EXPECT_EQ(Shows(), "P=00 S=0000 T=0 M=0");
  EXPECT_EQ(machine->panel().message, ErrorCode::kFieldRange);
  Keys("9 ENT");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Shows(), "P=09S=0000I=********");
}

// OPT-4.42: in every mode but REMOTE, and not while a run goes on.
TEST_F(Selection, JobWorksWhileItStands) {
  Have({{1, "DELAY 5\nDELAY 5\n"}, {2, "DELAY 5\n"}});
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle}) {
    Good(machine::ChangeMode{mode});
    Keys("JOB 0 1 ENT");
    EXPECT_EQ(Shows(), "P=01S=0000I=********");
  }
  Keys("START");
  GoOn(At(1.0));
  Keys("JOB");
  EXPECT_EQ(Said(), 7601);
  GoOn(At(9.0));
  Keys("JOB 0 2 ENT");
  EXPECT_EQ(Shows(), "P=02S=0000I=********");
  // The run that is suspended goes on, OPT-4.61.
  Keys("START");
  GoOn(At(10.0));
  EXPECT_EQ(Shows(), "P=01S=0002I=DELAY");
}

// OPT-4.32: existing programs by number; at the ends they stay.
TEST_F(Selection, ShiftNextAndPrevSelectPrograms) {
  for (const Mode mode : {Mode::kManual, Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    Have({{2, "DELAY 1\n"}, {45, "DELAY 1\n"}, {90, "DELAY 1\n"}}, mode);
    for (const char* program : {"02", "45", "90", "90"}) {
      Keys("SHIFT NEXT");
      EXPECT_EQ(Shows(), "P=" + std::string(program) + "S=0000I=********");
    }
    for (const char* program : {"45", "02", "02"}) {
      Keys("SHIFT PREV");
      EXPECT_EQ(Shows(), "P=" + std::string(program) + "S=0000I=********");
    }
    Have({{2, "DELAY 1\n"}, {90, "DELAY 1\n"}}, mode);
    Keys("SHIFT PREV");
    EXPECT_EQ(Shows(), "P=90S=0000I=********");
  }
}

// OPT-4.60 OPT-4.28 OPT-6.36: a new program has an ENDTASK; of an old one the end is shown.
TEST_F(Selection, RecBehindJob) {
  Have({{45, "SPEED 1\nSPEED 2\nSPEED 3\nSPEED 4\n"}, {46, "SPEED 1\nENDTASK\n"}});
  Keys("JOB 7 7 ENT REC");
  EXPECT_EQ(Shows(), "P=77S=0001I=ENDTASK");
  EXPECT_EQ(Program(77), std::vector<std::string>{"ENDTASK"});
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0].kind, machine::ProgramEdit::Kind::kCreate);
  EXPECT_EQ(edits[0].program, 77);
  Keys("JOB 4 5 ENT REC");
  EXPECT_EQ(Shows(), "P=45S=0005I=ENDPRG");
  Keys("JOB 4 6 NEXT 1 ENT REC");
  EXPECT_EQ(Shows(), "P=46S=0002I=ENDTASK");
  EXPECT_EQ(edits.size(), 1U);
}

// OPT-4.30 OPT-4.31 OPT-6.37
TEST_F(Selection, NextAndPrevGoThroughSteps) {
  Have({{1, "SPEED 5\nDELAY 1\nVI[3] = 7\n"}});
  Keys("NEXT");
  EXPECT_EQ(Said(), 7602);
  Keys("JOB 1 ENT");
  for (const char* step :
       {"0001I=SPEED", "0002I=DELAY", "0003I=LET", "0004I=ENDPRG", "0004I=ENDPRG"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows(), "P=01S=" + std::string(step));
  }
  for (const char* step : {"0003I=LET", "0002I=DELAY", "0001I=SPEED", "0001I=SPEED"}) {
    Keys("PREV");
    EXPECT_EQ(Shows(), "P=01S=" + std::string(step));
  }
  Keys("JOB 0 1 ENT PREV");
  EXPECT_EQ(Shows(), "P=01S=0000I=********");
  Keys("JOB 0 9 ENT NEXT");
  EXPECT_EQ(Said(), 7102);
}

// OPT-6.43 OPT-5.36 OPT-4.05: DECLAREs are not seen; WORK has names of its own.
TEST_F(Selection, StepsHaveNames) {
  Have({{1,
         "DECLARE A = VR[1]\nDECLARE B = VR[2]\nWORKDEF 0,0\nWORK 0,0/ON\nA = B\nWORK 0,0/OFF\n"
         "GOSUB 10\nENDTASK\n10 RETURN\n"}});
  Keys("JOB 1 ENT");
  for (const char* name :
       {"WORKDEF", "WORKON", "LET", "WORKOFF", "GOSUB", "ENDTASK", "RETURN", "ENDPRG"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows().substr(12), name);
  }
}

// OPT-5.36: the same while it runs.
TEST_F(Selection, AStepThatRunsHasItsName) {
  Have({{1, "WORKDEF 0,0\nWORK 0,0/ON\nPAUSE\nWORK 0,0/OFF\nPAUSE\n"}}, Mode::kSingle);
  Keys("JOB 1 ENT");
  for (const char* name : {"WORKDEF", "WORKON", "PAUSE", "WORKOFF"}) {
    Keys("START");
    GoOn(machine->time() + At(5.0));
    EXPECT_EQ(Shows().substr(12), name);
  }
}

// OPT-4.63 OPT-4.26 OPT-4.41: asked first; 0 is NO, 1 is YES.
TEST_F(Selection, ShiftDelDeletesTheProgram) {
  Have({{45, "DELAY 1\nDELAY 1\n"}});
  Keys("SHIFT DEL");
  EXPECT_EQ(Said(), 7602);
  Keys("JOB 4 5 ENT SHIFT DEL");
  EXPECT_EQ(Shows(), "DELETE Y/N");
  Keys("0");
  EXPECT_EQ(Shows(), "P=45S=0000I=********");
  EXPECT_TRUE(machine->memory().programs.contains(45));
  Keys("SHIFT DEL 1");
  EXPECT_FALSE(machine->memory().programs.contains(45));
  EXPECT_TRUE(machine->memory().deleted.contains(45));
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0].kind, machine::ProgramEdit::Kind::kRemove);
  EXPECT_EQ(Shows(), "P=45S=0000I=********");
  Keys("SHIFT DEL");
  EXPECT_EQ(Said(), 7102);
}

// OPT-4.63 OPT-B.65 OPT-E.7606: one that is suspended stays.
TEST_F(Selection, AProgramInUseIsNotDeleted) {
  Have({{45, "DELAY 1\nDELAY 1\n"}, {46, "DELAY 1\n"}}, Mode::kSingle);
  Keys("JOB 4 5 ENT START");
  GoOn(At(2.0));
  Keys("MODE_LEFT MODE_LEFT MODE_LEFT SHIFT DEL");
  EXPECT_EQ(Said(), 7606);
  EXPECT_TRUE(machine->memory().programs.contains(45));
  Keys("JOB 4 6 ENT SHIFT DEL 1");
  EXPECT_FALSE(machine->memory().programs.contains(46));
}

// OPT-B.63 OPT-7.70: it counts the runs since a program was selected, be it the same one again, and
// is 0 until the first.
TEST_F(Selection, WhatIsCountedBeginsAnewWithASelection) {
  Have({{45, "DELAY 1\n"}, {46, "DELAY 1\n"}}, Mode::kCycle);
  double now_s = 0.0;
  const auto run = [&] {
    Keys("START");
    GoOn(At(now_s += 10.0));
    return Value("VI[98]");
  };
  Keys("JOB 4 5 ENT");
  EXPECT_EQ(Value("VI[98]"), "0");
  EXPECT_EQ(run(), "1");
  EXPECT_EQ(run(), "2");
  Keys("JOB 4 6 ENT");
  EXPECT_EQ(Value("VI[98]"), "0");
  Keys("JOB 4 5 ENT");
  EXPECT_EQ(Value("VI[98]"), "0");
  EXPECT_EQ(run(), "1");
  EXPECT_EQ(run(), "2");
  Keys("JOB 4 5 ENT");
  EXPECT_EQ(Value("VI[98]"), "0");
  EXPECT_EQ(run(), "1");
}

// OPT-B.63: the open run counts on; what is selected beside it counts from its end, unless START
// goes on with the run.
TEST_F(Selection, BesideAnOpenRunItCountsFromItsEnd) {
  Have({{45, "DELAY 10\n"}, {46, "DELAY 1\n"}}, Mode::kCycle);
  Keys("JOB 4 5 ENT START");
  GoOn(At(1.0));
  Keys("STOP");
  GoOn(At(2.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  Keys("JOB 4 6 ENT");
  EXPECT_EQ(Value("VI[98]"), "1");
  Keys("START");  // goes on
  GoOn(At(30.0));
  EXPECT_EQ(Value("VI[98]"), "1");
  Keys("START");
  GoOn(At(31.0));
  Keys("STOP");
  GoOn(At(32.0));
  Keys("JOB 4 5 ENT");
  EXPECT_EQ(Value("VI[98]"), "2");
  Good(machine::AbortRun{});
  GoOn(At(40.0));
  EXPECT_EQ(Value("VI[98]"), "0");
}

}  // namespace
}  // namespace rmlcell::optimo
