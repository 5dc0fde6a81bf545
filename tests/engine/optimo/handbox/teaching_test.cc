// Points recorded by jog and REC.
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class Teaching : public HandboxTest {
 protected:
  // A program with ENDTASK alone, at that.
  void Begin() {
    Have({});
    Keys("JOB 1 2 ENT REC");
    edits.clear();
  }
  // As it would be recorded.
  std::string Here(bool tip) const {
    const machine::RunState run = machine->status().run;
    const motion::MachinePoint point = tip ? run.tip.tip : run.axes.column;
    std::ostringstream text;
    text << '(' << point.x() << ' ' << point.y() << ' ' << point.z() << ' ' << run.axes.a_rad << ' '
         << run.axes.b_rad << ')';
    return text.str();
  }
  // The values of "MOVE (1.0, 2.0 ..." in the same form; of the /VIA behind it.
  static std::string PointIn(const std::string& step, const std::string& word = "MOVE ") {
    std::string list = step.substr(step.find(word) + word.size() + 1);
    list = list.substr(0, list.find(')'));
    std::ostringstream text;
    std::istringstream values(list);
    char comma = '(';
    for (double value = 0.0; values >> value; values >> comma)
      text << (text.str().empty() ? "(" : " ") << value;
    return text.str() + ")";
  }
};

// OPT-5.15 OPT-5.17 OPT-6.41 OPT-5.16: one MOVE for each point, of the column in COORD ROBOT.
TEST_F(Teaching, AJogAndRecIsAMove) {
  Begin();
  Hold("X+", 1.0);
  EXPECT_EQ(Shows(), "*MOVE");
  const std::string first = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0002I=ENDTASK");
  Hold("Y+", 0.5);
  Hold("B+", 0.2);
  const std::string second = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0003I=ENDTASK");
  const std::vector<std::string> steps = Program(12);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(PointIn(steps[0]), first);
  EXPECT_EQ(PointIn(steps[1]), second);
  EXPECT_NE(first, second);
}

// OPT-5.16 OPT-5.03: of the tip in COORD ABSOL, which need not be recorded.
TEST_F(Teaching, AbsolIsTheTip) {
  Begin();
  Keys("DYN NEXT ENT");
  Hold("Z-", 0.5);
  Hold("B+", 0.3);
  const std::string tip = Here(true);
  EXPECT_NE(tip, Here(false));
  Keys("REC");
  EXPECT_THAT(Program(12), testing::SizeIs(2));
  EXPECT_EQ(PointIn(Program(12)[0]), tip);
}

// OPT-5.11 OPT-5.20: modes of the handbox change nothing that is recorded.
TEST_F(Teaching, ModesDoNotChangeWhatIsRecorded) {
  Begin();
  Hold("X+", 0.5);
  Keys("REC");
  const std::string object = ObjectAt(12);
  Keys("DYN NEXT ENT ERR PATH NEXT NEXT ENT MOV NEXT 1 ENT MOV ERR");
  EXPECT_EQ(ObjectAt(12), object);
}

// OPT-5.18 OPT-6.41: the via point first, then the end point.
TEST_F(Teaching, ACircleHasTwoPoints) {
  Have({{12, "SPEED 1\nSPEED 2\nSPEED 3\nSPEED 4\n"}});
  Keys("JOB 1 2 ENT REC");
  EXPECT_EQ(Shows(), "P=12S=0005I=ENDPRG");
  Keys("PATH NEXT NEXT ENT");
  Hold("X+", 0.5);
  EXPECT_EQ(Shows(), "*MOVE");
  const std::string via = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0005I=ENDPRG");
  EXPECT_THAT(edits, IsEmpty());
  Hold("Y+", 0.5);
  const std::string end = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0006I=ENDPRG");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(PointIn(Program(12)[4]), end);
  EXPECT_EQ(PointIn(Program(12)[4], "/VIA "), via);
}

// OPT-5.20: in the wrong PATH each point is a MOVE.
TEST_F(Teaching, TheWrongPathMakesPlainMoves) {
  Have({{12, "PATH CIR\n"}});
  Keys("JOB 1 2 ENT REC PATH NEXT ENT");
  Hold("X+", 0.5);
  Keys("REC");
  Hold("Y+", 0.5);
  Keys("REC");
  ASSERT_THAT(Program(12), testing::SizeIs(3));
  EXPECT_EQ(Program(12)[1].find("/VIA"), std::string::npos);
  EXPECT_EQ(Program(12)[2].find("/VIA"), std::string::npos);
}

// OPT-5.14 OPT-5.19: the radius, the step PATH, then centre and normal.
TEST_F(Teaching, AHole) {
  Begin();
  Keys("PATH NEXT NEXT NEXT ENT");
  EXPECT_EQ(Shows(), "RAD = 0.0");
  Keys("DEL 1 2 POINT 7");
  EXPECT_EQ(Shows(), "RAD = 12.7");
  Keys("ENT");
  EXPECT_EQ(Shows(), "*PATH");
  Keys("REC");
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
  Hold("X+", 0.5);
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
  const std::string centre = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0002I=ENDTASK");
  Hold("Z+", 0.2);
  EXPECT_EQ(Shows(), "*MOVE");
  const std::string normal = Here(false);
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0003I=ENDTASK");
  EXPECT_EQ(Program(12)[0], "PATH HOLE (12.7)");
  EXPECT_EQ(PointIn(Program(12)[1]), centre);
  EXPECT_EQ(PointIn(Program(12)[1], "/VIA "), normal);
  Keys("PATH ENT");
  EXPECT_EQ(Shows(), "RAD = 12.7");  // the last one
}

// OPT-5.49 OPT-5.21: taught again, only the mode counts.
TEST_F(Teaching, AHoleIsTaughtAgain) {
  Have({{12, "PATH HOLE (12.7)\nENDTASK\n"}});
  Keys("JOB 1 2 NEXT 2 ENT PATH PREV ENT DEL 5 ENT");
  EXPECT_EQ(Shows(), "*PATH");
  Hold("X+", 0.5);
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
  Keys("REC");
  EXPECT_THAT(edits, IsEmpty());
  Hold("Z+", 0.2);
  EXPECT_EQ(Shows(), "*MOVE");
  Keys("REC");
  EXPECT_EQ(Program(12)[0], "PATH HOLE (12.7)");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_NE(Program(12)[1].find("/VIA"), std::string::npos);
}

// OPT-5.24 OPT-5.25: while it is 1, every MOVE gets it.
TEST_F(Teaching, Fly) {
  Begin();
  Keys("MOV NEXT 1 ENT");
  for (int i = 0; i < 3; ++i) {
    Hold("X+", 0.3);
    Keys("REC");
  }
  Keys("MOV NEXT 0 ENT");
  Hold("X+", 0.3);
  Keys("REC");
  const std::vector<std::string> steps = Program(12);
  ASSERT_EQ(steps.size(), 5U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(steps[i].ends_with(" /FLY")) << steps[i];
  EXPECT_TRUE(steps[3].ends_with(")")) << steps[3];
}

// OPT-5.26 OPT-5.50: into the next MOVE only.
TEST_F(Teaching, AttributesOfTheNextMove) {
  Begin();
  Keys("MOV NEXT NEXT 1 ENT");
  EXPECT_EQ(Shows(), "INPUT = 00");
  Keys("1 6 ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Hold("X+", 0.3);
  Keys("REC MOV NEXT NEXT NEXT 1 NEXT 1 NEXT 1 ENT");
  EXPECT_EQ(Shows(), "TIME 0.0");
  Keys("DEL 2 POINT 5 ENT");
  EXPECT_EQ(Shows(), "GOSUB 0000");
  Keys("1 0 0 ENT");
  EXPECT_EQ(Shows(), "INPUT = 00");
  Keys("1 7 ENT");
  Hold("X+", 0.3);
  Keys("REC");
  Hold("X+", 0.3);
  Keys("REC");
  const std::vector<std::string> steps = Program(12);
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_TRUE(steps[0].ends_with(") /START (IL[16])")) << steps[0];
  EXPECT_TRUE(steps[1].ends_with(") /END (IL[17]) /TIME (2.5, 100) /NEXT")) << steps[1];
  EXPECT_TRUE(steps[2].ends_with(")") && steps[2].find('/') == std::string::npos) << steps[2];
}

// OPT-5.26: what was entered before stays until then.
TEST_F(Teaching, AttributesAreGathered) {
  Begin();
  Keys("MOV NEXT NEXT 1 ENT 1 6 ENT MOV NEXT NEXT");
  EXPECT_EQ(Shows(), "START = 1");
  Keys("0 ENT");
  Hold("X+", 0.3);
  Keys("REC");
  EXPECT_EQ(Program(12)[0].find('/'), std::string::npos);
}

// OPT-5.26: all of them, shown again as they were entered, and taken back one by one.
TEST_F(Teaching, AttributesAreShownAgain) {
  Begin();
  Keys("MOV NEXT NEXT 1 NEXT 1 NEXT 1 NEXT 1 ENT 1 6 ENT DEL 2 POINT 5 ENT 1 0 0 ENT 1 7 ENT MOV");
  for (const char* text : {"FLY = 0", "START = 1", "TIME = 1", "END = 1", "NEXT = 1"}) {
    Keys("NEXT");
    EXPECT_EQ(Shows(), text);
  }
  for (const char* text : {"INPUT = 16", "TIME 2.5", "GOSUB 0100", "INPUT = 17", "*SPEED"}) {
    Keys("ENT");
    EXPECT_EQ(Shows(), text);
  }
  Keys("MOV NEXT NEXT 0 ENT ENT ENT ENT MOV NEXT NEXT NEXT 0 ENT ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Hold("X+", 0.3);
  Keys("REC");
  EXPECT_TRUE(Program(12)[0].ends_with(") /END (IL[17]) /NEXT")) << Program(12)[0];
  Keys("MOV NEXT NEXT NEXT NEXT 1 ENT 1 7 ENT MOV NEXT NEXT NEXT NEXT 0 ENT");
  Hold("X+", 0.3);
  Keys("REC");
  EXPECT_TRUE(Program(12)[1].ends_with(")")) << Program(12)[1];
  EXPECT_EQ(Program(12)[1].find('/'), std::string::npos);
}

// OPT-5.18: the first of two points is forgotten with what it was meant for: the program, COORD,
// PATH.
TEST_F(Teaching, AFirstPointIsForgotten) {
  for (const char* between : {"JOB 1 2 NEXT 1 ENT", "DYN NEXT ENT", "PATH ENT"}) {
    Begin();
    Keys("PATH NEXT NEXT ENT");
    Hold("X+", 0.3);
    Keys("REC " + std::string(between));
    Hold("Y+", 0.3);
    Keys("REC");
    EXPECT_THAT(edits, IsEmpty()) << between;
    Hold("X+", 0.3);
    Keys("REC");
    ASSERT_EQ(edits.size(), 1U) << between;
    EXPECT_NE(Program(12)[0].find("/VIA"), std::string::npos);
  }
}

// OPT-5.26: attributes are for the next MOVE of the program that is taught.
TEST_F(Teaching, AttributesAreForgottenWithTheProgram) {
  Begin();
  Keys("MOV NEXT NEXT 1 ENT 1 6 ENT JOB 1 2 ENT MOV NEXT NEXT");
  EXPECT_EQ(Shows(), "START = 0");
  Keys("ERR MOV NEXT NEXT 1 ENT 1 6 ENT");
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Keys("MOV NEXT NEXT");
  EXPECT_EQ(Shows(), "START = 0");
}

// OPT-4.74 OPT-E.7310: nothing is recorded without reference.
TEST_F(Teaching, RecNeedsZeroedAxes) {
  Begin();
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  Keys("JOB 1 2 ENT REC");
  Hold("X+", 0.3);
  EXPECT_EQ(Shows(), "*MOVE");
  Keys("REC");
  EXPECT_EQ(Said(), 7310);
  EXPECT_EQ(Program(12), std::vector<std::string>{"ENDTASK"});
}

// OPT-5.22 OPT-E.7608 OPT-5.16: a warning; SYSDEF is not in the numbers.
TEST_F(Teaching, SysdefIsWarnedOf) {
  Begin();
  Keys("SHIFT F3 NEXT ENT DEL 1 0 ENT");
  Hold("X+", 0.3);
  const std::string here = Here(false);
  Keys("REC");
  EXPECT_EQ(Said(), 7608);
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_TRUE(edits[0].note.sysdef_active);
  EXPECT_EQ(PointIn(Program(12)[0]), here);
}

// OPT-5.15: only while it stands, and with a program that is stored.
TEST_F(Teaching, WhatMovesIsNotRecorded) {
  Begin();
  Do("X+", KeyAction::kPress);
  GoOn(machine->time() + At(0.2));
  Keys("REC");
  EXPECT_EQ(Said(), 7601);
  EXPECT_THAT(edits, IsEmpty());
  Do("X+", KeyAction::kRelease);
  GoOn(machine->time() + At(2.0));
  Keys("REC");
  EXPECT_EQ(edits.size(), 1U);
  Keys("JOB 9 9 ENT");
  Hold("X+", 0.2);
  Keys("REC");
  EXPECT_EQ(Said(), 7102);
  EXPECT_EQ(edits.size(), 1U);
}

// OPT-5.15: nothing flashes without a program.
TEST_F(Teaching, JogWithoutProgram) {
  Have({});
  Hold("X+", 0.2);
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
}

// LIVE-7.09: what the journal has besides.
TEST_F(Teaching, EditsTellHowItWas) {
  Begin();
  Keys("DYN NEXT ENT REC PATH NEXT NEXT NEXT ENT DEL 5 ENT MOV NEXT 1 ENT PATH NEXT ENT");
  Hold("X+", 0.4);
  Keys("REC");
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[0].text_after, "COORD ABSOL");
  EXPECT_EQ(edits[0].step, 1);
  const machine::ProgramEdit& edit = edits[1];
  EXPECT_EQ(edit.kind, machine::ProgramEdit::Kind::kInsert);
  EXPECT_EQ(edit.step, 2);
  EXPECT_TRUE(edit.text_after.starts_with("MOVE (")) << edit.text_after;
  EXPECT_EQ(edit.text_before, "");
  EXPECT_EQ(edit.note.coord, "ABSOL");
  EXPECT_EQ(edit.note.tcp, "(0.0, 0.0, 0.0, 0.0, 0.0, -5.0)");
  EXPECT_FALSE(edit.note.sysdef_active);
  EXPECT_EQ(edit.note.modes, "PATH PTP FLY 1");
  EXPECT_EQ(edit.note.axes, machine->status().run.axes);
  EXPECT_EQ(edit.note.tip, machine->status().run.tip);
}

// LIVE-7.09: the mode of a hole is told with its radius.
TEST_F(Teaching, EditsTellTheRadiusOfAHole) {
  Begin();
  Keys("PATH PREV ENT DEL 1 2 POINT 5 ENT REC");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0].text_after, "PATH HOLE (12.5)");
  EXPECT_EQ(edits[0].note.coord, "ROBOT");
  EXPECT_EQ(edits[0].note.modes, "PATH HOLE (12.5) FLY 0");
}

// OPT-5.16: points are recorded to 0.0001 mm and 0.000001 rad.
TEST_F(Teaching, PointsAreRounded) {
  Have({{12, "ENDTASK\n"}});
  const machine::MachineMemory memory = machine->memory();
  Result<std::unique_ptr<machine::Machine>> made =
      machine::Machine::Make(family_,
                             *MakeParameters(family_, "standard",
                                             {{"HOME_X", "10.00007"},
                                              {"HOME_Y", "20.00017"},
                                              {"HOME_Z", "-30.00027"},
                                              {"HOME_A", "0.1000007"},
                                              {"HOME_B", "0.2000017"}}),
                             memory, {}, heard);
  ASSERT_TRUE(made);
  machine = *std::move(made);
  Good(machine::ChangeMode{Mode::kManual});
  Keys("JOB 1 2 NEXT 1 ENT X+");  // a TAP leaves no motion
  GoOn(machine->time() + At(2.0));
  Keys("REC");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Program(12).at(0), "MOVE (10.0001, 20.0002, -30.0003, 0.100001, 0.200002)");
}

// OPT-5.19: the centre of a hole is forgotten with its radius.
TEST_F(Teaching, ACentreIsForgottenWithTheRadius) {
  Begin();
  Keys("PATH PREV ENT DEL 5 ENT");
  Hold("X+", 0.3);
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
  Keys("REC PATH ENT ENT");
  Hold("Y+", 0.3);
  EXPECT_EQ(Shows(), "*ENTER CENTER NORMAL");
  Keys("REC");
  EXPECT_THAT(edits, IsEmpty());
  Hold("Z+", 0.2);
  Keys("REC");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_NE(Program(12)[0].find("/VIA"), std::string::npos);
}

}  // namespace
}  // namespace rmlcell::optimo
