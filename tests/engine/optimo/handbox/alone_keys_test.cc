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

}  // namespace
}  // namespace rmlcell::optimo
