#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "engine/motion/geometry/frames.h"
#include "engine/optimo/offline/compensate.h"

namespace rmlcell::optimo {
namespace {

std::vector<std::string> SaidOf(const Compensation& compensation) {
  std::vector<std::string> said;
  for (const Diagnostic& d : compensation.diagnostics)
    said.push_back(std::to_string(Lookup(d.code).number) + ": " + d.detail);
  return said;
}

std::string PointText(const motion::MachinePoint& p) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "%.12f,%.12f,%.12f", p.x(), p.y(), p.z());
  return text.data();
}

// The last MOVE of a text, to the end of its line.
std::string LastMove(const std::string& text) {
  const std::size_t at = text.rfind("MOVE");
  return text.substr(at, text.find('\n', at) - at);
}

// OPT-7.30, OPT-8.23: the tip stays where it is when the system moves: a contour that begins before
// SYSDEF is the one whose first point is written in the new system. All six numbers differ.
TEST(CompensateSides, ThePierceStaysWhereItIsAcrossSysdef) {
  const motion::RigidMotion system = motion::RigidMotionOf({5, 7, 11}, 0.6, -0.4, 0.3);
  const motion::MachinePoint pierce(10, 20, 30);
  const motion::MachinePoint in_system =
      system.linear().transpose() * (pierce - motion::MachinePoint(system.translation()));
  const std::string sysdef = "SYSDEF (5,7,11,0.6,-0.4,0.3)\n",
                    rest = "WORK 0,0/ON\nMOVE (40,-15,8,0.2,0.7)\nWORK 0,0/OFF\n",
                    head = ";$rad=1\n;$left\nPATH LIN\n";
  const Compensation before = Compensate(head + "MOVE (10,20,30,0.2,0.7)\n" + sysdef + rest);
  const Compensation behind =
      Compensate(head + sysdef + "MOVE (" + PointText(in_system) + ",0.2,0.7)\n" + rest);
  ASSERT_TRUE(before.ok && behind.ok);
  EXPECT_EQ(LastMove(before.text), LastMove(behind.text));
  EXPECT_EQ(LastMove(before.text).find("MOVE (40,"), std::string::npos);  // it is compensated
}

// The same without a rotation, by hand: (10,20,30) is (5,13,19) from (5,7,11), and left of +Y is
// -X.
TEST(CompensateSides, ThePierceMovesAgainstTheOrigin) {
  const Compensation made = Compensate(
      ";$rad=1\n;$left\nPATH LIN\nMOVE (10,20,30,0,0)\nSYSDEF (5,7,11,0,0,0)\nWORK 0,0/ON\n"
      "MOVE (5,23,19,0,0)\nWORK 0,0/OFF\n");
  ASSERT_TRUE(made.ok);
  EXPECT_EQ(LastMove(made.text), "MOVE (4.00000,23.00000,19.00000,0.00000,0.00000)");
}

// OPT-8.19: where the angles of the start are not known the head is taken to stand straight down.
// The half circle runs about (0,0) from (1.6,-1.2); at its end the head lies along the radius, and
// only the start has no room for an offset of 2. Of one angle alone nothing follows.
TEST(CompensateSides, ANotKnownHeadStandsStraightDown) {
  for (const std::string head : {"VR[1],0", "VR[1],1.570796327", "1.570796327,VR[1]"}) {
    const std::string arc =
        "PATH CIR\nMOVE (1.6,-1.2,0," + head +
        ")\nWORK 0,0/ON\n"
        "MOVE (-1.6,1.2,0,-2.214297436,1.570796327)/VIA (1.2,1.6,0,0,0)\nWORK 0,0/OFF\n";
    const Compensation consumed = Compensate(";$rad=2\n;$left\n" + arc);
    EXPECT_EQ(SaidOf(consumed),
              (std::vector<std::string>{
                  "7806: the arc of radius 2.000000 is not larger than the offset"}))
        << head;
    EXPECT_TRUE(Compensate(";$rad=1.9\n;$left\n" + arc).ok) << head;
  }
}

// OPT-8.05, OPT-8.09: a directive is no step of the program.
TEST(CompensateSides, FindingsOfDirectivesHaveNoStep) {
  for (const std::string text : {"SPEED 5\n;$middle\n", "SPEED 5\n;$dia=x\n",
                                 ";$rad=1\n;$left\nSPEED 5\nWORK 0,0/ON\n;$right\n",
                                 ";$rad=1\n;$left\nSPEED 5\nWORK 0,0/ON\n;$rad=2\n"}) {
    const Compensation made = Compensate(text);
    ASSERT_EQ(made.diagnostics.size(), 1U) << text;
    EXPECT_EQ(made.diagnostics[0].step, 0) << text;
    EXPECT_GT(made.diagnostics[0].where.line, 1) << text;
  }
}

// OPT-8.20, OPT-2.23, OPT-7.33, OPT-B.60: where a contour begins is not known behind a MOVE in
// ROBOT, behind ZERO, and behind a hole of which a number is none.
TEST(CompensateSides, WhereNobodyKnowsTheStart) {
  const std::string known = "MOVE (9,8,7,0,0)\n",
                    cut = "PATH LIN\nWORK 0,0/ON\nMOVE (50,0,0,0,0)\n";
  const std::vector<std::string> said = {
      "7805: the point where this move starts is not known as numbers"};
  for (const std::string& before :
       {std::string("COORD ROBOT\nMOVE (9,8,7,0,0)\nCOORD ABSOL\n"), known + "ZERO\n",
        std::string("PATH HOLE (5)\nMOVE (0,0,0,0,0)/VIA (0,0,5,0,0)\n"),
        std::string("PATH HOLE (5)\nMOVE (10,0,0,0,0)/VIA (10,0,5,0,0)\n"),
        known + "PATH HOLE (VR[1])\nMOVE (0,0,0,0,0)/VIA (0,0,5,0,0)\n",
        known + "PATH HOLE (5)\nMOVE (VR[1],0,0,0,0)/VIA (0,0,5,0,0)\n",
        known + "PATH HOLE (5)\nMOVE (0,0,0,0,0)/VIA (0,VR[1],5,0,0)\n"}) {
    EXPECT_EQ(SaidOf(Compensate(";$rad=1\n;$left\n" + before + cut)), said) << before;
  }
}

// OPT-2.23: a hole about (1,2) along Z ends where its circle is nearest to (4,6,9): at (4,6,3).
// Left of +Y from there is -X.
TEST(CompensateSides, AContourBeginsWhereTheHoleEnds) {
  const Compensation made = Compensate(
      ";$rad=1\n;$left\nMOVE (4,6,9,0,0)\nPATH HOLE (5)\nMOVE (1,2,3,0,0)/VIA (1,2,12,0,0)\n"
      "PATH LIN\nWORK 0,0/ON\nMOVE (4,36,3,0,0)\n");
  ASSERT_TRUE(made.ok);
  EXPECT_EQ(LastMove(made.text), "MOVE (3.00000,36.00000,3.00000,0.00000,0.00000)");
}

// OPT-8.20, OPT-2.19: behind a move from nowhere the next one starts at its target: on its line a
// via point outside it makes no arc.
TEST(CompensateSides, TheMoveBehindOneFromNowhereHasItsStart) {
  const Compensation made = Compensate(
      ";$rad=1\n;$left\nPATH CIR\nWORK 0,0/ON\nMOVE (10,20,30,0,0)\n"
      "MOVE (12,24,36,0,0)/VIA (9,18,27,0,0)\n");
  ASSERT_EQ(made.diagnostics.size(), 2U);
  EXPECT_EQ(made.diagnostics[0].code, ErrorCode::kCompVariable);
  EXPECT_EQ(made.diagnostics[1].code, ErrorCode::kArcUndefined);
}

// OPT-8.06: TCP does not switch the beam on.
TEST(CompensateSides, OnlyWorkSwitchesTheBeam) {
  const std::string text =
      ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nTCP (0,0,9/0,0,0)\nMOVE (9,0,0,0,0)\n"
      "MOVE (9,9,0,0,0)\n";
  EXPECT_EQ(Compensate(text).text, text);
}

// OPT-8.23: a rotation that is no number counts as 0, and is told.
TEST(CompensateSides, RotationsThatAreNoNumbersCountAsNothing) {
  const auto cut = [](const std::string& rotations) {
    return Compensate(";$rad=1\n;$left\nPATH LIN\nSYSDEF (0,0,0," + rotations +
                      ")\nMOVE (0,0,0,0,0.7)\nWORK 0,0/ON\nMOVE (9,5,0,0,0.7)\n");
  };
  for (const auto& [variable, number] : {std::pair{"VR[1],0.4,0.5", "0,0.4,0.5"},
                                         {"0.4,VR[1],0.5", "0.4,0,0.5"},
                                         {"0.4,0.5,VR[1]", "0.4,0.5,0"}}) {
    const Compensation made = cut(variable);
    EXPECT_EQ(LastMove(made.text), LastMove(cut(number).text)) << variable;
    EXPECT_EQ(
        SaidOf(made),
        (std::vector<std::string>{"7811: a rotation of SYSDEF is no number; it is taken as 0"}));
  }
}

// OPT-8.01
TEST(CompensateSides, InchSourcesAreToldWhatToDo) {
  const Compensation refused = Compensate("SPEED 5\n", {}, true);
  ASSERT_EQ(refused.diagnostics.size(), 1U);
  EXPECT_EQ(refused.diagnostics[0].detail, "convert the source to metric first");
  EXPECT_EQ(refused.diagnostics[0].rule, "OPT-8.01");
}

// OPT-8.11, OPT-8.20, OPT-8.23: a MOVE has five numbers, ten with a via point, and SYSDEF has six:
// what stands behind it is neither asked for nor written anew.
TEST(CompensateSides, WhatFollowsAStatementIsNoPartOfIt) {
  const std::string start = ";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n";
  for (const std::string move :
       {"MOVE (10,0,0,0,0)\n", "PATH CIR\nMOVE (10,0,0,0,0)/VIA (5,-5,0,0,0)\n"}) {
    for (const std::string behind : {"DELAY VR[1]\n", "DELAY 2\n", "VR[1]=VR[2]\n", "SPEED 5\n"}) {
      const Compensation made = Compensate(start + move + behind);
      EXPECT_EQ(SaidOf(made), std::vector<std::string>{}) << move << behind;
      EXPECT_TRUE(made.text.ends_with(")\n" + behind)) << move << made.text;
    }
  }
  EXPECT_TRUE(Compensate("SYSDEF (1,2,3,0,0,0)\nDELAY VR[1]\n").diagnostics.empty());
}

// OPT-2.19, OPT-8.20: a MOVE with a via point ends at its target, also where nothing is cut.
TEST(CompensateSides, AContourBeginsWhereAnArcEnds) {
  const Compensation made = Compensate(
      ";$rad=1\n;$left\nMOVE (0,0,0,0,0)\nPATH CIR\nMOVE (10,0,0,0,0)/VIA (5,5,0,0,0)\n"
      "PATH LIN\nWORK 0,0/ON\nMOVE (10,20,0,0,0)\n");
  ASSERT_TRUE(made.ok);
  EXPECT_EQ(LastMove(made.text), "MOVE (9.00000,20.00000,0.00000,0.00000,0.00000)");
}

// OPT-2.19: a via point on the line through start and target makes no arc: between them it leads
// along the line, and outside them, on either side, nowhere.
TEST(CompensateSides, AViaPointOnTheLineOfItsMove) {
  const auto cut = [](const std::string& target, const std::string& via) {
    return Compensate(";$rad=1\n;$left\nPATH CIR\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (" + target +
                      ",0,0,0,0)/VIA (" + via + ",0,0,0,0)\n");
  };
  for (const auto& [target, via] : {std::pair{"5", "9"}, {"5", "-3"}, {"-5", "3"}}) {
    const Compensation none = cut(target, via);
    ASSERT_EQ(none.diagnostics.size(), 1U) << target << " " << via;
    EXPECT_EQ(none.diagnostics[0].code, ErrorCode::kArcUndefined) << target << " " << via;
  }
  const Compensation along = cut("9", "5");
  ASSERT_TRUE(along.ok);
  EXPECT_EQ(LastMove(along.text),
            "MOVE (9.00000,1.00000,0.00000,0.00000,0.00000)/VIA "
            "(5.00000,1.00000,0.00000,0.00000,0.00000)");
}

// OPT-8.06, OPT-8.09: a move without a side ends the contour, also where the side must not change:
// the way there and the way back are two of them, and no path that turns back.
TEST(CompensateSides, AMoveThatIsNotCompensatedEndsTheContour) {
  const std::string changes = "7803: the side changes while the beam is on";
  EXPECT_EQ(SaidOf(Compensate(";$rad=1\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
                              "MOVE (10,0,0,0,0)\n;$none\nMOVE (20,0,0,0,0)\n;$left\n"
                              "MOVE (10,0,0,0,0)\n")),
            (std::vector<std::string>{changes, changes}));
}

// compensate.h: what the list of findings has no room for is counted.
TEST(CompensateSides, FindingsWithoutRoomAreCounted) {
  std::string text;
  for (int n = 0; n < 1100; ++n) text += ";$middle\n";
  const Compensation made = Compensate(text);
  EXPECT_FALSE(made.ok);
  EXPECT_EQ(made.diagnostics.size() + made.diagnostics_dropped.count(), 1100U);
  EXPECT_TRUE(made.diagnostics_dropped.kinds().contains(ErrorCode::kCompDirective));
}

}  // namespace
}  // namespace rmlcell::optimo
