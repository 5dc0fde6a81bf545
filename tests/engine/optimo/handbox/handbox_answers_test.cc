// What single keys ask of the machine, seen at the handbox itself; fields at the ends of what they
// take; what is shown of programs that changed or are none.
#include <map>
#include <string>
#include <variant>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/handbox/override_steps.h"
#include "engine/optimo/handbox/steps.h"
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class HandboxAnswers : public HandboxTest {
 protected:
  // Of a handbox that belongs to no machine, in this mode, with this program selected.
  machine::HandboxAnswer PressOne(const std::string& key, KeyAction action = KeyAction::kTap) {
    const machine::MachineView view{.status = status, .programs = programs};
    Result<machine::HandboxAnswer> answer = alone.Press(key, action, view);
    EXPECT_TRUE(answer);
    return *std::move(answer);
  }
  std::string ShownAlone() const {
    const machine::MachineView view{.status = status, .programs = programs};
    return alone.panel(view).display;
  }
  static machine::StoredProgram Stored(const std::string& object) {
    return {.name = "some", .object = machine::Bytes::Of(object)};
  }
  std::string Object(const std::string& text) const {
    return std::string(*Translated(text).object);
  }

  OptimoHandbox alone{machine::Parameters(OptimoFamily().parameters()), HandboxModes()};
  machine::MachineStatus status{.mode = Mode::kManual};
  std::map<int, machine::StoredProgram> programs;
};

// OPT-4.22: at the ends of the switch nothing is asked for.
TEST_F(HandboxAnswers, TheModeSwitchEndsAtBothSides) {
  for (const auto& [mode, key, next] : {std::tuple{Mode::kRemote, "MODE_RIGHT", Mode::kRemote},
                                        std::tuple{Mode::kManual, "MODE_LEFT", Mode::kManual},
                                        std::tuple{Mode::kSingle, "MODE_RIGHT", Mode::kRemote},
                                        std::tuple{Mode::kRepeat, "MODE_LEFT", Mode::kManual}}) {
    status.mode = mode;
    const machine::HandboxAnswer answer = PressOne(key);
    EXPECT_FALSE(answer.message.has_value()) << key;
    ASSERT_EQ(answer.requests.size(), mode == next ? 0U : 1U) << key;
    if (mode != next) {
      EXPECT_EQ(std::get<machine::ChangeMode>(answer.requests[0]).mode, next);
    }
  }
}

// OPT-4.14: the emergency stop is down from the press to the release.
TEST_F(HandboxAnswers, TheEmergencyStopComesUpAgain) {
  const machine::HandboxAnswer down = PressOne("EMERGENCY_STOP", KeyAction::kPress);
  ASSERT_EQ(down.requests.size(), 1U);
  EXPECT_TRUE(std::get<machine::EmergencyStop>(down.requests[0]).pressed);
  const machine::HandboxAnswer up = PressOne("EMERGENCY_STOP", KeyAction::kRelease);
  ASSERT_EQ(up.requests.size(), 1U);
  EXPECT_FALSE(std::get<machine::EmergencyStop>(up.requests[0]).pressed);
}

// OPT-4.34, OPT-4.35, OPT-4.40: both ends stop, for the override and for jogs.
TEST_F(HandboxAnswers, StepsOfTheOverrideEndAtBothSides) {
  EXPECT_EQ(NextOverride(145.0, true), 145.0);
  EXPECT_EQ(NextOverride(130.0, true), 145.0);
  EXPECT_EQ(NextOverride(10.0, false), 10.0);
  EXPECT_EQ(NextOverride(25.0, false), 10.0);
  EXPECT_EQ(NextOverride(50.0, true), 55.0);
  EXPECT_EQ(NextOverride(50.0, false), 40.0);
  EXPECT_EQ(JogShareOf(145.0), 0.4);
  EXPECT_EQ(JogShareOf(200.0), 0.4);
  EXPECT_EQ(JogShareOf(1.0), 0.0005);
}

// OPT-4.12: what the cell refuses for its mode or state is a key that is not enabled; all else is
// told as it is.
TEST_F(HandboxAnswers, WhatTheCellRefuses) {
  const auto said = [this](ErrorCode code) { return alone.Done(Error{code, "refused", {}}); };
  EXPECT_EQ(said(ErrorCode::kCellMode), ErrorCode::kKeyNotEnabled);
  EXPECT_EQ(said(ErrorCode::kCellMachineState), ErrorCode::kKeyNotEnabled);
  EXPECT_EQ(said(ErrorCode::kCellNotLive), ErrorCode::kCellNotLive);
  EXPECT_EQ(said(ErrorCode::kNotZeroed), ErrorCode::kNotZeroed);
  EXPECT_EQ(alone.Done({}), std::nullopt);
}

// OPT-5.50, OPT-5.26: END asks for its input and NEXT for nothing, whatever the other one is; taken
// back, END is gone, and NEXT stays.
TEST_F(HandboxAnswers, EndAndNextAreOfTheirOwn) {
  Have({});
  Keys("JOB 1 2 ENT REC MOV NEXT NEXT NEXT NEXT 1 ENT");
  EXPECT_EQ(Shows(), "INPUT = 00");
  Keys("1 7 ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Hold("X+", 0.3);
  Keys("REC MOV NEXT NEXT NEXT NEXT NEXT 1 ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Hold("X+", 0.3);
  Keys("REC MOV NEXT NEXT NEXT NEXT 1 NEXT 1 ENT 1 8 ENT MOV NEXT NEXT NEXT NEXT 0 ENT");
  EXPECT_EQ(Shows(), "*SPEED");
  Hold("X+", 0.3);
  Keys("REC");
  const std::vector<std::string> steps = Program(12);
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_TRUE(steps[0].ends_with(") /END (IL[17])")) << steps[0];
  EXPECT_TRUE(steps[1].ends_with(") /NEXT")) << steps[1];
  EXPECT_TRUE(steps[2].ends_with(") /NEXT")) << steps[2];
  EXPECT_EQ(steps[2].find("/END"), std::string::npos);
}

// OPT-1.23, OPT-5.50: 0 is a sequence number like any other.
TEST_F(HandboxAnswers, TheGosubOfATimeMayBeZero) {
  Have({});
  Keys("JOB 1 2 ENT REC MOV NEXT NEXT NEXT 1 ENT DEL 5 ENT");
  EXPECT_EQ(Shows(), "GOSUB 0000");
  Keys("ENT");
  EXPECT_EQ(Said(), 0);
  Hold("X+", 0.3);
  Keys("REC");
  EXPECT_TRUE(Program(12)[0].ends_with(" /TIME (5.0, 0)")) << Program(12)[0];
}

// OPT-6.15: program 1 is meant where it is given, though another one is selected; 0 is that one.
TEST_F(HandboxAnswers, SimulOfProgramOne) {
  status.shown.program = 12;
  for (const auto& [keys, program] :
       {std::pair{"01", 1}, std::pair{"00", 12}, std::pair{"02", 2}}) {
    PressOne("F6");
    for (const char digit : std::string(keys)) PressOne(std::string(1, digit));
    PressOne("NEXT");
    PressOne("7");
    const machine::HandboxAnswer answer = PressOne("ENT");
    ASSERT_EQ(answer.requests.size(), 1U) << keys;
    const auto& set = std::get<machine::SetSimulation>(answer.requests[0]);
    ASSERT_TRUE(set.until.has_value());
    EXPECT_EQ(set.until->program, program);
    EXPECT_EQ(set.until->step, 7);
  }
}

// OPT-B.76: a radius is shown with three decimals at most; OPT-4.41: what is typed with minus or
// point first is a number.
TEST_F(HandboxAnswers, DecimalsOfFields) {
  Have({});
  Keys("JOB 1 2 ENT REC PATH PREV ENT DEL 1 POINT 2 3 4 6 ENT REC");
  EXPECT_EQ(Program(12)[0], "PATH HOLE (1.2346)");
  Keys("PATH ENT");
  EXPECT_EQ(Shows(), "RAD = 1.235");
  Keys("ERR TCP DEL MINUS POINT 5 NEXT DEL POINT 2 5 NEXT DEL MINUS 3 POINT ENT REC");
  EXPECT_EQ(Program(12)[1], "TCP (-0.5, 0.25, -3.0 / 0.0, 0.0, -5.0)");
}

// OPT-4.73: the values in force are shown, the first as well as the last.
TEST_F(HandboxAnswers, TheToolInForceIsShown) {
  Have({});
  Keys("TCP DEL 1 2 POINT 5 ENT TCP");
  EXPECT_EQ(Shows(), "X0 = 12.5");
  Keys("NEXT NEXT NEXT NEXT NEXT");
  EXPECT_EQ(Shows(), "Z1 = -5.0");
}

// A program that was changed elsewhere: the step that was shown is shown anew, none stays none, and
// the end is the end.
TEST_F(HandboxAnswers, AChangedProgramIsShownAgain) {
  programs[12] = Stored(Object("SPEED 5\nDELAY 1\nVI[2]=1\n"));
  const auto again = [this](int step, const std::string& instruction) {
    status.shown = {.program = 12, .step = step, .instruction = instruction};
    const machine::MachineView view{.status = status, .programs = programs};
    const machine::ShownStep shown = alone.ShowAgain(view);
    EXPECT_EQ(shown.program, 12);
    return std::to_string(shown.step) + " " + shown.instruction;
  };
  EXPECT_EQ(again(0, ""), "0 ");
  EXPECT_EQ(again(1, "MOVE"), "1 SPEED");
  EXPECT_EQ(again(2, "MOVE"), "2 DELAY");
  EXPECT_EQ(again(2, "ENDPRG"), "4 ENDPRG");
  EXPECT_EQ(again(9, "MOVE"), "4 ENDPRG");
}

// OPT-B.71: a program that cannot be read has no steps; one that went while it was asked for is not
// deleted.
TEST_F(HandboxAnswers, ProgramsThatAreNone) {
  programs[12] = Stored("no object");
  status.shown.program = 12;
  for (const std::string key : {"NEXT", "PREV", "REC"})
    EXPECT_EQ(PressOne(key).message, ErrorCode::kObjectCorrupt) << key;
  programs[12] = Stored(Object("DELAY 1\n"));
  PressOne("SHIFT");
  EXPECT_FALSE(PressOne("DEL").message.has_value());
  EXPECT_EQ(ShownAlone().substr(0, 10), "DELETE Y/N");
  programs.clear();
  const machine::HandboxAnswer answer = PressOne("1");
  EXPECT_EQ(answer.message, ErrorCode::kProgramMissing);
  EXPECT_FALSE(answer.edit.has_value());
}

// LIVE-7.09: what cannot be read, or does not compile any more, is not taken back.
TEST_F(HandboxAnswers, EditsThatCannotBeTakenBack) {
  const auto code = [](const machine::ProgramEdit& edit, const std::string& object) {
    const Result<std::string> undone = UndoProgramEdit(edit, object);
    return undone ? std::string("taken back") : CodeText(undone.error().code);
  };
  using Kind = machine::ProgramEdit::Kind;
  const std::string corrupt = CodeText(ErrorCode::kObjectCorrupt);
  EXPECT_EQ(code({.kind = Kind::kInsert, .program = 12, .object = "none"}, "none"), corrupt);
  EXPECT_EQ(code({.kind = Kind::kDelete, .program = 12, .object = "none"}, "none"), corrupt);
  const std::string other = CodeText(ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(code({.kind = Kind::kRemove, .program = 12, .text_before = "SPEED 999\n"}, ""), other);
  EXPECT_EQ(code({.kind = Kind::kRemove, .program = 12, .text_before = "SPEED 99\n"}, ""),
            "taken back");
}

// Steps have places among all instructions; what is no step has the place behind all. OPT-1.08: no
// step has room in an object that is full.
TEST_F(HandboxAnswers, PlacesAndRoomOfSteps) {
  programs[12] = Stored(Object("DECLARE A = VR[1]\nSPEED 5\nDELAY 1\n"));
  const Result<std::optional<Steps>> steps = Steps::Of(programs, 12);
  ASSERT_TRUE(steps && *steps);
  EXPECT_EQ((*steps)->PlaceOf(1), 1);
  EXPECT_EQ((*steps)->PlaceOf(2), 2);
  for (const int none : {0, -1, 3}) EXPECT_EQ((*steps)->PlaceOf(none), 3) << none;
  const auto insert = [&](const std::string& statement, std::size_t limit) {
    const Result<machine::ProgramEdit> edit = InsertStep(**steps, 12, 2, statement, limit);
    return edit ? edit->text_after : CodeText(edit.error().code);
  };
  EXPECT_EQ(insert("DELAY 2", 0), "DELAY 2");
  const std::size_t size = InsertStep(**steps, 12, 2, "DELAY 2", 0)->object.size();
  EXPECT_EQ(insert("DELAY 2", size), "DELAY 2");
  EXPECT_EQ(insert("DELAY 2", size - 1), CodeText(ErrorCode::kObjectTooLong));
  EXPECT_EQ(insert("DELAY 2", 1), CodeText(ErrorCode::kObjectTooLong));
  EXPECT_EQ(insert("SPEED 101", 0), CodeText(ErrorCode::kLiteralRange));
}

}  // namespace
}  // namespace rmlcell::optimo
