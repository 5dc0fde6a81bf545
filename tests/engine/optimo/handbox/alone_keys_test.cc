// Single keys at a handbox that belongs to no machine, and the modal values that its forms begin
// with.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/handbox/form.h"
#include "engine/optimo/handbox/modal_text.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/handbox/steps.h"
#include "engine/optimo/language/compiler.h"
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

const std::map<int, machine::StoredProgram> kNoPrograms;

// OPT-4.15, OPT-4.74: HOME of a machine that is not zeroed is refused, and nothing is run.
TEST(AloneKeys, HomeNeedsTheZero) {
  for (const bool zeroed : {true, false}) {
    OptimoHandbox alone(machine::Parameters(OptimoFamily().parameters()), HandboxModes());
    machine::MachineStatus status{.mode = machine::Mode::kManual};
    status.run.zeroed = zeroed;
    const machine::MachineView view{.status = status, .programs = kNoPrograms};
    const Result<machine::HandboxAnswer> answer =
        alone.Press("HOME", machine::KeyAction::kPress, view);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->run.has_value(), zeroed);
    EXPECT_EQ(answer->message.has_value(), !zeroed);
    if (!zeroed) {
      EXPECT_EQ(*answer->message, ErrorCode::kNotZeroed);
    }
  }
}

// A modal value that is no list has no numbers.
TEST(AloneKeys, OnlyListsHaveNumbers) {
  const machine::MachineView view{
      .status = {},
      .programs = kNoPrograms,
      .modal_values = {{"TCP", "(1.5, -2.0, 3.0)"}, {"SYSDEF", "OFF"}, {"PATH", "7.0"}}};
  EXPECT_EQ(ModalNumbers(view, "TCP"), (std::vector<double>{1.5, -2.0, 3.0}));
  EXPECT_TRUE(ModalNumbers(view, "SYSDEF").empty());
  EXPECT_TRUE(ModalNumbers(view, "PATH").empty());
  EXPECT_TRUE(ModalNumbers(view, "SPEED").empty());
}

class TaughtTwice : public HandboxTest {};

// OPT-5.18: each circle has two points of its own: behind one that is recorded the next one begins
// with its via point.
TEST_F(TaughtTwice, TheNextCircleBeginsWithItsOwnPoint) {
  Have({{12, "SPEED 1\n"}});
  Keys("JOB 1 2 ENT REC PATH NEXT NEXT ENT");
  for (std::size_t circles = 1; circles <= 2; ++circles) {
    Hold("X+", 0.5);
    Keys("REC");
    EXPECT_EQ(edits.size(), circles - 1);
    Hold("Y+", 0.5);
    Keys("REC");
    EXPECT_EQ(edits.size(), circles);
  }
}

// OPT-4.27: SHIFT PREV while a point is ready to record is refused, and deletes nothing.
TEST_F(TaughtTwice, ShiftPrevBehindAJogIsRefused) {
  Have({{11, "SPEED 1\n"}, {12, "SPEED 1\n"}});
  Keys("JOB 1 2 ENT");
  Hold("X+", 0.5);
  ASSERT_EQ(Shows(), "*MOVE");
  Keys("SHIFT PREV");
  EXPECT_EQ(Shows(), "*MOVE");
  EXPECT_NE(Said(), 0);
}

// OPT-4.28: REC while a form is filled in records nothing.
TEST_F(TaughtTwice, RecInAFormIsRefused) {
  Have({{12, "SPEED 1\n"}});
  Keys("JOB 1 3 ENT MOV REC");
  EXPECT_NE(Said(), 0);
  EXPECT_THAT(edits, IsEmpty());
  EXPECT_EQ(Program(13), std::vector<std::string>{"none"});
}

// OPT-5.01: back over a line one comes to its last field.
TEST(AloneKeys, BackToTheLastFieldOfALine) {
  Form form(FormKind::kSimul, {{Field::Whole("A", 1, 1, 0, 9), Field::Whole("B", 1, 2, 0, 9)},
                               {Field::Whole("C", 1, 3, 1, 9)}});
  form.Move(true);
  form.Move(true);
  form.Move(false);
  form.Type('8');
  EXPECT_EQ(form.text(), "A1B8");
}

// What is kept of a handbox are numbers alone.
TEST(AloneKeys, WhatIsKeptAreNumbers) {
  EXPECT_TRUE(OptimoHandbox::ReadModes("1 0 0 0 0 5 70 50"));
  for (const std::string text :
       {"x 0 0 0 0 5 70 50", "1 x 0 0 0 5 70 50", "1 0 0 0 x 5 70 50", "1 0 0 0 0 x 70 50",
        "1 0 0 0 0 5 x 50", "1 0 0 0 0 5 70 x", "1 0 0 0 0 5 70 5x"}) {
    const Result<HandboxModes> modes = OptimoHandbox::ReadModes(text);
    ASSERT_FALSE(modes) << text;
    EXPECT_EQ(modes.error().code, ErrorCode::kCellBadText);
  }
}

// A step before the first one is none.
TEST(AloneKeys, StepsBeginWithTheFirst) {
  std::map<int, machine::StoredProgram> programs;
  programs[12].object = machine::Bytes::Of(Compile("SPEED 1\nSPEED 2\n", "", {}).object);
  const std::optional<Steps> steps = Steps::Of(programs, 12).value();
  ASSERT_TRUE(steps);
  for (const int step : {-5, -1, 0}) {
    EXPECT_EQ(steps->Show(12, step).step, 0);
    EXPECT_EQ(steps->Show(12, step).instruction, "");
  }
  EXPECT_EQ(steps->Show(12, 1).step, 1);
  EXPECT_EQ(steps->Show(12, 1).instruction, "SPEED");
  EXPECT_EQ(steps->Show(12, 9).step, 3);
}

// OPT-5.10: what is out of range is gone to, also within a line, and typed into.
TEST(AloneKeys, TheFieldThatIsOutOfRangeIsGoneTo) {
  Form second(FormKind::kProcess, {{Field::Whole("A", 1, 1, 0, 9), Field::Whole("B", 1, 0, 1, 9)}});
  EXPECT_FALSE(second.Check());
  second.Type('7');
  EXPECT_EQ(second.text(), "A1B7");
  EXPECT_TRUE(second.Check());
  Form first(FormKind::kProcess, {{Field::Whole("A", 1, 0, 1, 9), Field::Whole("B", 1, 2, 0, 9)}});
  first.Move(true);
  EXPECT_FALSE(first.Check());
  first.Type('5');
  EXPECT_EQ(first.text(), "A5B2");
}

// OPT-4.20: the C keys do nothing: no point is ready to record behind them.
TEST_F(TaughtTwice, TheKeysOfCGiveNoPoint) {
  Have({{12, "SPEED 1\n"}});
  Keys("JOB 1 2 ENT C+ C-");
  EXPECT_EQ(Shows(), "P=12S=0000I=********");
  Keys("REC");
  EXPECT_EQ(Shows(), "P=12S=0002I=ENDPRG");
  EXPECT_THAT(edits, IsEmpty());
}

// LIVE-7.01: behind a power-up it is as it comes: what was the first point of a circle goes into no
// MOVE any more.
TEST(AloneKeys, APowerUpForgetsAFirstPoint) {
  OptimoHandbox alone(machine::Parameters(OptimoFamily().parameters()), HandboxModes());
  std::map<int, machine::StoredProgram> programs;
  programs[12].object = machine::Bytes::Of(Compile("SPEED 1\n", "", {}).object);
  machine::MachineStatus status{.mode = machine::Mode::kManual};
  status.run.zeroed = true;
  status.shown.program = 12;
  const machine::MachineView view{.status = status, .programs = programs};
  std::optional<machine::ProgramEdit> edit;
  const auto press = [&](const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
      const Result<machine::HandboxAnswer> answer =
          alone.Press(key, machine::KeyAction::kPress, view);
      ASSERT_TRUE(answer) << key;
      EXPECT_FALSE(answer->message.has_value()) << key;
      edit = answer->edit;
      EXPECT_EQ(alone.Done({}), std::nullopt) << key;
    }
  };
  press({"PATH", "NEXT", "NEXT", "ENT", "X+", "REC"});
  EXPECT_FALSE(edit.has_value());
  alone.CyclePower();
  press({"X+", "REC"});
  ASSERT_TRUE(edit.has_value());
  EXPECT_TRUE(edit->text_after.starts_with("MOVE (")) << edit->text_after;
  EXPECT_EQ(edit->text_after.find("/VIA"), std::string::npos) << edit->text_after;
}

}  // namespace
}  // namespace rmlcell::optimo
