// Where advice ends: at the longest program, at the three coordinates of a
// target, at a hole without an axis; and where a text begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/flow_graph.h"
#include "engine/optimo/language/formatter.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::advice_ends {
namespace {

// How often this is said of a program.
auto CountOf(std::string_view text, int number, std::string_view rule) {
  const Compilation compiled = Compile(text, "", {.object_limit = 0, .advice = true});
  return std::ranges::count_if(compiled.diagnostics, [&](const Diagnostic& d) {
    return Lookup(d.code).number == number && d.rule == rule;
  });
}

// OPT-3.34: the longest program whose flow is followed, and one step more.
TEST(AdviceEnds, AProgramOfTheMostInstructionsIsFollowed) {
  std::string text = "WORK 0,0/ON\n";
  for (std::size_t n = 1; n < kFlowInstructionsMax; ++n) text += "ACCEL 5\n";
  EXPECT_EQ(CountOf(text, 7408, "OPT-3.34"), 1);
  EXPECT_EQ(CountOf(text + "ACCEL 5\n", 7408, "OPT-3.34"), 0);
}

// OPT-2.51: where the tip goes to is known whatever the head does, and not
// without one of X, Y, Z.
TEST(AdviceEnds, ATargetIsOfThreeCoordinates) {
  const std::string begin = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n",
                    end = "MOVE (20.,0.,0.,0.,0.)\n";
  for (const char* target : {"0.9,0.,0.,0.,0.", "0.,0.9,0.,VR[1],0.", "0.,0.,0.9,VR[1],VR[2]"})
    EXPECT_EQ(CountOf(begin + "MOVE (" + target + ")/FLY\n" + end, 7314, "OPT-2.51"), 1) << target;
  for (const char* target : {"VR[1],0.,0.9,0.,0.", "0.9,VR[1],0.,0.,0.", "0.9,0.,VR[1],0.,0."})
    EXPECT_EQ(CountOf(begin + "MOVE (" + target + ")/FLY\n" + end, 7314, "OPT-2.51"), 0) << target;
}

// OPT-5.48: an axis of any length has an angle, none has none.
TEST(AdviceEnds, AHoleWithoutAnAxisHasNoAngle) {
  const auto count = [](const std::string& via, const std::string& angles = "0.,0.") {
    return CountOf(
        "COORD ABSOL\nPATH HOLE (5.)\nMOVE (20.,2.,3.,0.,0.)/VIA (" + via + "," + angles + ")\n",
        7033, "OPT-5.48");
  };
  EXPECT_EQ(count("20.,2.,3."), 0);
  EXPECT_EQ(count("21.,2.,3."), 1);  // 1 mm of it, 90 degrees off
  EXPECT_EQ(count("22.,2.,3."), 1);
  EXPECT_EQ(count("20.,2.,4."), 0);
  // OPT-2.29: its head angles do not count.
  EXPECT_EQ(count("22.,2.,3.", "VR[1],VR[2]"), 1);
  EXPECT_EQ(count("22.,2.,VR[1]"), 0);
}

// What another program had in its last place, one behind the end of this one,
// is no part of it.
TEST(AdviceEnds, BehindTheLastInstructionStandsNothing) {
  struct Row {
    std::string text;    // of the program
    std::string behind;  // of the other one
    int number;
    std::string_view rule;
    int with, without;  // it is said so often
  };
  const std::string absol = "COORD ABSOL\nPATH LIN\nSPEED 30\nMOVE (0.,0.,0.,0.,0.)\n";
  const std::string robot = "COORD ROBOT\nPATH PTP\nMOVE (9.,0.,0.,0.,0.)\n";
  const std::string sub = "900 SYSDEF (1.,0.,0.,0.,0.,0.)\n" + absol;
  const Row rows[] = {
      {absol + "MOVE (9.,0.,0.,0.,0.)\n", "WORK 0,0/ON", 7033, "OPT-5.46", 1, 0},
      {absol, "RETURN", 7504, "OPT-7.22", 1, 0},
      {absol + "MOVE (9.,0.,0.,0.,0.)/FLY\n", "MOVE (8.,0.,0.,0.,0.)", 7032, "OPT-2.47", 0, 1},
      {sub + robot, "GOSUB 900", 7033, "OPT-7.109", 1, 0}};
  for (const Row& row : rows) {
    std::string first;
    for (int lines = 0; lines < 100; ++lines, first += "ACCEL 5\n") {
      const std::string text = first + row.text;
      EXPECT_EQ(CountOf(text + row.behind, row.number, row.rule), row.with) << text;
      EXPECT_EQ(CountOf(text, row.number, row.rule), row.without) << text;
    }
  }
}

// OPT-1.03: line ends are those of the text, whatever stands before it in
// memory.
TEST(AdviceEnds, ATextThatBeginsWithALineEndHasItsOwn) {
  const std::string_view text = "\r\n     STOP\n";
  EXPECT_EQ(Format(text.substr(1)).text, "\n     STOP\n");
  EXPECT_FALSE(Format(text.substr(1)).changed);
  EXPECT_EQ(Format(text).text, "\r\n     STOP\r\n");
}

// OPT-B.22: where the tip stands is not known behind what puts it, or the coordinates, elsewhere.
TEST(AdviceEnds, APlaceIsKnownAsLongAsNothingMovesIt) {
  const auto count = [](const std::string& between, const std::string& attributes = "") {
    return CountOf("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n" + between +
                       "SPEED 0\nMOVE (9.,0.,0.,0.,0.)" + attributes + "\n",
                   7307, "OPT-B.22");
  };
  for (const char* between : {"", "COORD ABSOL\n", "PATH PTP\n", "VR[1]=1.\n", "WAIT IL[20]\n"})
    EXPECT_EQ(count(between), 1) << between;
  for (const char* between : {"COORD ROBOT\nCOORD ABSOL\n", "ZERO\n", "FUNCTION 44\n", "CALL 2\n"})
    EXPECT_EQ(count(between), 0) << between;
  // OPT-2.54: a MOVE with a time of its own needs no SPEED.
  EXPECT_EQ(count("", "/TIME (5.,900)"), 0);
}

// OPT-B.22, OPT-5.46: of a MOVE that fails it is not said as well that it is slow.
TEST(AdviceEnds, AMoveThatFailsIsNotTooSlow) {
  const std::string cut =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nOL[11]=ON\nWORK 0,0/ON\nDELAY 1\n";
  const std::string move = "MOVE (9.,0.,0.,0.,0.)\nWORK 0,0/OFF\n";
  EXPECT_EQ(CountOf(cut + "SPEED 0\n" + move, 7307, "OPT-B.22"), 1);
  EXPECT_EQ(CountOf(cut + "SPEED 0\n" + move, 7033, "OPT-5.46"), 0);
  EXPECT_EQ(CountOf(cut + "SPEED 1\n" + move, 7033, "OPT-5.46"), 1);
}

// OPT-3.20, OPT-3.38: when a WORK with a condition switches the beam is not known.
TEST(AdviceEnds, ABeamThatWaitsIsNotFresh) {
  const auto count = [](const std::string& attributes) {
    return CountOf(
        "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nOL[11]=ON\nWORK 0,0/ON" +
            attributes + "\nMOVE (9.,0.,0.,0.,0.)\nWORK 0,0/OFF\n",
        7033, "OPT-3.20");
  };
  EXPECT_EQ(count(""), 1);
  EXPECT_EQ(count("/START (IL[20])"), 0);
  EXPECT_EQ(count("/END (IL[20])"), 0);
}

// OPT-3.47: each run of instructions that are never reached is told once, and an ENDTASK is none.
TEST(AdviceEnds, EachRunThatIsNotReachedIsTold) {
  const auto count = [](std::string_view text) { return CountOf(text, 7033, "OPT-3.47"); };
  EXPECT_EQ(count("GOTO 20\nSPEED 5\n20 GOTO 30\nSPEED 6\nSPEED 7\n30 ENDTASK\n"), 2);
  EXPECT_EQ(count("GOTO 20\nENDTASK\n20 SPEED 5\n"), 0);
  EXPECT_EQ(count("GOTO 20\nENDTASK\nSPEED 6\n20 SPEED 5\n"), 1);
}

// OPT-7.20: it is told of the subroutine, not of each GOSUB that leads to it.
TEST(AdviceEnds, ASubroutineWithoutReturnIsToldOnce) {
  const std::string subs = "ENDTASK\n100 SPEED 5\nENDTASK\n200 SPEED 6\nRETURN\n";
  EXPECT_EQ(CountOf("GOSUB 100\nGOSUB 100\n" + subs, 7033, "OPT-7.20"), 1);
  EXPECT_EQ(CountOf("GOSUB 100\nGOSUB 200\nGOSUB 100\n" + subs, 7033, "OPT-7.20"), 1);
  EXPECT_EQ(CountOf("GOSUB 200\nGOSUB 200\n" + subs, 7033, "OPT-7.20"), 0);
}

// OPT-7.109: the last retract of one subroutine and the first approach of the next one are not
// between ABSOL moves; in one subroutine both are.
TEST(AdviceEnds, ASubroutineEndsWithItsReturn) {
  const std::string begin = "SYSDEF (10.,0.,0.,0.,0.,0.)\nPATH PTP\nGOSUB 100\n";
  const std::string retract =
      "ENDTASK\n100 COORD ABSOL\nMOVE (1.,0.,0.,0.,0.)\nCOORD ROBOT\nMOVE (2.,0.,0.,0.,0.)\n";
  const std::string approach =
      "COORD ROBOT\nMOVE (3.,0.,0.,0.,0.)\nCOORD ABSOL\nMOVE (4.,0.,0.,0.,0.)\nRETURN\n";
  EXPECT_EQ(CountOf(begin + "GOSUB 200\n" + retract + "RETURN\n200 " + approach, 7033, "OPT-7.109"),
            0);
  EXPECT_EQ(CountOf(begin + retract + approach, 7033, "OPT-7.109"), 2);
}

// OPT-3.24: of what stands between them only a WORK 2 switches the beam off.
TEST(AdviceEnds, OnlyAWorkSwitchesTheBeamOff) {
  const auto count = [](const std::string& between) {
    return CountOf("WORK 0,0/ON\n" + between + "WORK 0,0/OFF\n", 7411, "OPT-3.24");
  };
  EXPECT_EQ(count("WORK 2,5/OFF\n"), 1);
  for (const char* between : {"WORK 2,5/ON\n", "WORKDEF 2,5 (15)\n", "ASSIGN VL[1] = 1 /2\n",
                              "DEFINE PAR[2] = INT\n", "BREAK 2\n"})
    EXPECT_EQ(count(between), 0) << between;
}

// OPT-9.16, OPT-3.33, OPT-3.34: which processes a FUNCTION switched nobody knows, so that nothing
// is told of them, with a beam or without one.
TEST(AdviceEnds, WhatAFunctionSwitchedIsNotTold) {
  const std::string call = "WORK 0,0/ON\nCALL 2\n", end = "WORKDEF 2,5 (15)\nWORK 2,5/ON\n";
  EXPECT_EQ(CountOf(call, 7407, "OPT-3.33"), 1);
  EXPECT_EQ(CountOf("FUNCTION 44\n" + call, 7407, "OPT-3.33"), 0);
  EXPECT_EQ(CountOf(end, 7408, "OPT-3.34"), 1);
  EXPECT_EQ(CountOf("FUNCTION 44\n" + end, 7408, "OPT-3.34"), 0);
}

// OPT-3.20, OPT-3.23: the kind of a process says whether it has a beam, its number does not.
TEST(AdviceEnds, TheKindOfAProcessHasTheBeam) {
  const auto count = [](const std::string& process, const std::string& values) {
    return CountOf("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nOL[11]=ON\nWORKDEF " +
                       process + values + "\nWORK " + process +
                       "/ON\nMOVE (9.,0.,0.,0.,0.)\nWORK " + process + "/OFF\n",
                   7033, "OPT-3.20");
  };
  EXPECT_EQ(count("0,0", ""), 1);
  EXPECT_EQ(count("0,3", ""), 1);
  EXPECT_EQ(count("2,0", " (15)"), 0);
}

// OPT-5.48: the axis of a hole is compared with a tool of which both angles are known, at a known
// centre.
TEST(AdviceEnds, AHoleIsComparedWithAToolThatIsKnown) {
  const auto count = [](const std::string& target) {
    return CountOf("COORD ABSOL\nPATH HOLE (5.)\nMOVE (" + target + ")/VIA (29.,2.,9.,0.,0.)\n",
                   7033, "OPT-5.48");
  };
  EXPECT_EQ(count("20.,2.,3.,0.,0."), 1);  // atan(9/6) = 56 degrees
  for (const char* target : {"20.,2.,3.,VR[1],0.", "20.,2.,3.,0.,VR[1]", "20.,2.,3.,VR[1],VR[2]",
                             "VR[1],2.,3.,0.,0.", "20.,2.,VR[1],0.,0."})
    EXPECT_EQ(count(target), 0) << target;
}

// OPT-2.52, OPT-7.20: a GOSUB that moves away and back begins a new row of moves.
TEST(AdviceEnds, ASubroutineThatMovesEndsTheRow) {
  const auto count = [](const std::string& body) {
    return CountOf(
        "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nMOVE (.005,0.,0.,0.,0.)/FLY\n"
        "MOVE (0.,0.,0.,0.,0.)/FLY\nGOSUB 100\nMOVE (.005,0.,0.,0.,0.)/FLY\n"
        "MOVE (90.,0.,0.,0.,0.)\nENDTASK\n100 " +
            body + "RETURN\n",
        7314, "OPT-2.52");
  };
  EXPECT_EQ(count("OL[16]=ON\n"), 1);
  EXPECT_EQ(count("MOVE (9.,0.,0.,0.,0.)\nMOVE (0.,0.,0.,0.,0.)\n"), 0);
}

// OPT-B.59, OPT-5.40: a TIMER may come in a GOSUB until that cancels it; what it switches is not
// known behind it.
TEST(AdviceEnds, ATimerMayComeUntilASubroutineCancelsIt) {
  const std::string rest =
      "GOSUB 20\nOL[9]=ON\nENDTASK\n10 OL[8]=OFF\nRETURN\n20 OL[8]=ON\nTIMER /DIS\nRETURN\n";
  EXPECT_EQ(CountOf(rest, 7409, "OPT-5.40"), 1);
  EXPECT_EQ(CountOf("TIMER (5.,10)\n" + rest, 7409, "OPT-5.40"), 0);
}

// OPT-9.12: a FUNCTION of that number is no TASK 1, before it or behind it.
TEST(AdviceEnds, FunctionOneIsNoTask) {
  EXPECT_EQ(CountOf("TASK 1\nTASK 1\n", 7033, "OPT-9.12"), 1);
  for (const char* text :
       {"FUNCTION 1\nTASK 1\n", "TASK 1\nFUNCTION 1\n", "FUNCTION 1\nFUNCTION 1\n"})
    EXPECT_EQ(CountOf(text, 7033, "OPT-9.12"), 0) << text;
}

// OPT-3.34, OPT-3.46: a jump to behind the last instruction ends the program as well.
TEST(AdviceEnds, AJumpToTheEndEndsTheProgram) {
  EXPECT_EQ(CountOf("WORK 0,0/ON\nGOTO 10\n10\n", 7408, "OPT-3.34"), 1);
  EXPECT_EQ(CountOf("WORK 0,0/ON\nWORK 0,0/OFF\nGOTO 10\n10\n", 7408, "OPT-3.34"), 0);
}

// OPT-3.34, OPT-3.38: a WORK with /END switches itself off, and what was on before it as well.
TEST(AdviceEnds, AWorkThatEndsByItselfIsNotLeftOn) {
  const auto count = [](std::string_view text) { return CountOf(text, 7408, "OPT-3.34"); };
  EXPECT_EQ(count("WORK 0,0/ON\n"), 1);
  EXPECT_EQ(count("WORK 0,0/ON/END (IL[20])\n"), 0);
  EXPECT_EQ(count("WORK 0,0/ON\nWORK 0,0/ON/END (IL[20])\n"), 0);
  EXPECT_EQ(count("WORK 0,0/ON/END (IL[20])\nWORK 0,0/ON\n"), 1);
}

// OPT-7.07, OPT-9.16: what another program did to outputs, variables and coordinates is not known;
// processes are off behind a CALL.
TEST(AdviceEnds, WhatAnotherProgramDidIsNotTold) {
  struct Row {
    std::string before, behind;
    int number;
    std::string_view rule;
  };
  const Row rows[] = {
      {"OL[8]=ON\n", "OL[9]=ON\n", 7409, "OPT-5.40"},
      {"OL[9]=ON\n", "OL[8]=ON\n", 7409, "OPT-5.40"},
      {"", "WORK 0,0/ON\nWORK 0,0/OFF\n", 7033, "OPT-5.47"},
      {"", "VR[6]=VR[5]\n", 7033, "OPT-1.17"},
      {"COORD ABSOL\nPATH HOLE (5.)\n", "MOVE (20.,2.,3.,0.,0.)/VIA (22.,2.,3.,0.,0.)\n", 7033,
       "OPT-5.48"},
      {"COORD ABSOL\nPATH LIN\nSPEED 30\nMOVE (0.,0.,0.,0.,0.)\nOL[11]=ON\nWORK 0,0/ON\nDELAY 1\n",
       "MOVE (9.,0.,0.,0.,0.)\n", 7033, "OPT-5.46"},
  };
  for (const Row& row : rows) {
    const auto count = [&](const std::string& between) {
      return CountOf(row.before + between + row.behind, row.number, row.rule);
    };
    EXPECT_EQ(count(""), 1) << row.behind;
    EXPECT_EQ(count("CALL 2\n"), 0) << row.behind;
    EXPECT_EQ(count("FUNCTION 44\n"), 0) << row.behind;
  }
  // OPT-3.09: nor is it known which WORKDEFs a FUNCTION has.
  EXPECT_EQ(CountOf("WORK 1,3/ON\nWORK 1,3/OFF\n", 7401, "OPT-3.09"), 1);
  EXPECT_EQ(CountOf("FUNCTION 44\nWORK 1,3/ON\nWORK 1,3/OFF\n", 7401, "OPT-3.09"), 0);
}

// OPT-B.59: a TIMER may come in the subroutine that arms it, itself or by way of another one; in
// one before the TIMER it may not.
TEST(AdviceEnds, ATimerMayComeInTheSubroutineThatArmsIt) {
  const std::string start = "GOSUB 20\nOL[9]=ON\n", timed = "ENDTASK\n10 OL[8]=OFF\nRETURN\n",
                    armed = "TIMER (5.,10)\nOL[8]=ON\nTIMER /DIS\nRETURN\n";
  const auto count = [](const std::string& text) { return CountOf(text, 7409, "OPT-5.40"); };
  EXPECT_EQ(count(start + timed + "20 OL[8]=ON\nRETURN\n"), 1);
  EXPECT_EQ(count(start + timed + "20 " + armed), 0);
  EXPECT_EQ(count(start + timed + "20 GOSUB 30\nRETURN\n30 " + armed), 0);
  EXPECT_EQ(count(start + "TIMER (5.,10)\nTIMER /DIS\n" + timed + "20 OL[8]=ON\nRETURN\n"), 1);
}

// OPT-7.20, OPT-3.33: of what stands behind a GOSUB that never comes back nothing is known.
TEST(AdviceEnds, BehindAGosubThatNeverReturnsNothingIsKnown) {
  const std::string text = "WORK 0,0/ON\nGOSUB 100\nCALL 2\nENDTASK\n100 ";
  EXPECT_EQ(CountOf(text + "RETURN\n", 7407, "OPT-3.33"), 1);
  EXPECT_EQ(CountOf(text + "ENDTASK\n", 7407, "OPT-3.33"), 0);
}

// OPT-2.54, OPT-B.59: the GOSUB of a /TIME comes behind its MOVE; when that of a TIMER comes is not
// known.
TEST(AdviceEnds, TheGosubOfATimeComesBehindItsMove) {
  const std::string cut =
      "COORD ABSOL\nPATH LIN\nSPEED 30\nMOVE (0.,0.,0.,0.,0.)\nOL[11]=ON\nWORK 0,0/ON\n";
  const std::string move = "MOVE (9.,0.,0.,0.,0.)",
                    rest = "\nWORK 0,0/OFF\nENDTASK\n900 MOVE (8.,0.,0.,0.,0.)\nRETURN\n";
  const std::string timed = move + "/TIME (5.,900)" + rest;
  EXPECT_EQ(CountOf(cut + "DELAY 1\n" + timed, 7033, "OPT-5.46"), 2);
  EXPECT_EQ(CountOf(cut + "DELAY 1\nTIMER (5.,900)\n" + move + rest, 7033, "OPT-5.46"), 1);
  // OPT-3.20: the first move behind the WORK is the one with the time.
  EXPECT_EQ(CountOf(cut + timed, 7033, "OPT-3.20"), 1);
  // OPT-3.38: /TIME of a WORK has no effect, and leads nowhere.
  const std::string led = "ENDTASK\n900 ACCEL 5\nRETURN\n";
  EXPECT_EQ(CountOf(move + "/TIME (5.,900)\n" + led, 7033, "OPT-3.47"), 0);
  EXPECT_EQ(CountOf("WORK 0,0/ON/TIME (5.,900)\nWORK 0,0/OFF\n" + led, 7033, "OPT-3.47"), 1);
}

// OPT-2.48: what reads the machine stops it, and so does a MOVE that waits; of a FUNCTION and a TCP
// it is not known.
TEST(AdviceEnds, WhatReadsTheMachineStopsIt) {
  const auto count = [](const std::string& behind) {
    return CountOf(
        "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n"
        "MOVE (9.,0.,0.,0.,0.)/FLY\n" +
            behind,
        7032, "OPT-2.48");
  };
  const std::string move = "MOVE (20.,0.,0.,0.,0.)";
  EXPECT_EQ(count("VL[1]=VL[2]\n" + move), 0);
  EXPECT_EQ(count("VL[1]=IL[20]\n" + move), 1);
  EXPECT_EQ(count(move + "/START (VL[1])\n"), 1);
  EXPECT_EQ(count("DELAY 1\n" + move), 1);
  // OPT-1.33: what a statement with an error would do is not known either.
  EXPECT_EQ(count("DELAY #\n" + move), 0);
  // OPT-7.20: behind a GOSUB comes its subroutine, and not what stands behind it.
  EXPECT_EQ(count("GOSUB 900\n" + move + "\nENDTASK\n900 DELAY 1\nRETURN\n"), 1);
  EXPECT_EQ(count("GOSUB 900\nDELAY 1\nENDTASK\n900 " + move + "\nRETURN\n"), 0);
  EXPECT_EQ(count("FUNCTION 44\nDELAY 1\n" + move), 0);
  EXPECT_EQ(count("TCP (0,0,6/0,0,1)\nDELAY 1\n" + move + "\nGOSUB 900\nENDTASK\n900 RETURN\n"), 0);
}

// OPT-1.17: what nothing sets is told once, each variable for itself; a DECLARE reads nothing.
TEST(AdviceEnds, AVariableThatNothingSetsIsToldOnce) {
  const auto count = [](std::string_view text) { return CountOf(text, 7033, "OPT-1.17"); };
  EXPECT_EQ(count("VR[0] = VR[7]\nVR[1] = VR[7] + VR[7]\n"), 1);
  EXPECT_EQ(count("VR[0] = VR[7] + VR[8]\n"), 2);
  EXPECT_EQ(count("DECLARE X1 = VR[7]\nX1 = 5.\n"), 0);
}

// OPT-7.109: only a SYSDEF with values shifts anything, and only a GOSUB that comes to ABSOL moves
// stands for some.
TEST(AdviceEnds, RobotMovesCountBesideAnOffset) {
  const std::string absol = "COORD ABSOL\nMOVE (1.,0.,0.,0.,0.)\n",
                    robot = "COORD ROBOT\nMOVE (2.,0.,0.,0.,0.)\n";
  const std::string offset = "SYSDEF (10.,0.,0.,0.,0.,0.)\n";
  const auto count = [](const std::string& text) {
    return CountOf("PATH PTP\n" + text, 7033, "OPT-7.109");
  };
  EXPECT_EQ(count(offset + absol + robot + absol), 1);
  EXPECT_EQ(count("SYSDEF\n" + absol + robot + absol), 0);
  EXPECT_EQ(count(absol + robot + absol), 0);
  const std::string calls = offset + absol + robot + "GOSUB 900\nENDTASK\n900 ";
  EXPECT_EQ(count(calls + "VI[2]=1\nRETURN\n"), 0);
  EXPECT_EQ(
      count(offset + absol + robot + "COORD ABSOL\nGOSUB 900\nENDTASK\n900 VI[2]=1\nRETURN\n"), 0);
  EXPECT_EQ(count(calls + absol + "RETURN\n"), 1);
}

// OPT-B.22: a MOVE that moves nothing needs no SPEED, and where one that ends early, that drills,
// or whose target is computed has brought the tip is not known.
TEST(AdviceEnds, AMoveWithoutSpeedFailsWhereItHasAWay) {
  const auto count = [](const std::string& between, const std::string& x) {
    return CountOf("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n" + between +
                       "SPEED 0\nMOVE (" + x + ",0.,0.,0.,0.)\nENDTASK\n900 RETURN\n",
                   7307, "OPT-B.22");
  };
  EXPECT_EQ(count("", "9."), 1);
  EXPECT_EQ(count("", "0."), 0);
  EXPECT_EQ(count("", "VR[1]"), 0);
  const std::string move = "MOVE (5.,0.,0.,0.,0.)";
  EXPECT_EQ(count(move + "\n", "9."), 1);
  for (const std::string& between :
       {move + "/END (IL[20])\n", move + "/TIME (5.,900)\n",
        "PATH HOLE (5.)\n" + move + "/VIA (5.,0.,9.,0.,0.)\nPATH LIN\n",
        std::string("MOVE (VR[1],0.,0.,0.,0.)\n")})
    EXPECT_EQ(count(between, "9."), 0) << between;
}

// OPT-2.51, OPT-5.48: how far a move goes is told of straight ones, and a hole is a PATH HOLE.
TEST(AdviceEnds, AnArcIsNotMeasured) {
  const auto count = [](const std::string& path, const std::string& via) {
    return CountOf("COORD ABSOL\nPATH " + path +
                       "\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\nMOVE (0.9,0.,0.,0.,0.)" + via +
                       "/FLY\nMOVE (20.,0.,0.,0.,0.)\n",
                   7314, "OPT-2.51");
  };
  EXPECT_EQ(count("LIN", ""), 1);
  EXPECT_EQ(count("PTP", ""), 1);
  EXPECT_EQ(count("CIR", "/VIA (5.,5.,0.,0.,0.)"), 0);
  const std::string beside = "MOVE (20.,2.,3.,0.,0.)/VIA (22.,2.,3.,0.,0.)\n";
  EXPECT_EQ(CountOf("COORD ABSOL\nPATH HOLE (5.)\n" + beside, 7033, "OPT-5.48"), 1);
  EXPECT_EQ(CountOf("COORD ABSOL\nPATH CIR\n" + beside, 7033, "OPT-5.48"), 0);
}

// OPT-5.48, OPT-7.28: each angle of a SYSDEF turns the tool axis away from what the program says, a
// shift does not.
TEST(AdviceEnds, EachAngleOfASysdefTurns) {
  const auto count = [](const std::string& values) {
    return CountOf("SYSDEF (" + values +
                       ")\nCOORD ABSOL\nPATH HOLE (5.)\n"
                       "MOVE (20.,2.,3.,0.,0.)/VIA (22.,2.,3.,0.,0.)\n",
                   7033, "OPT-5.48");
  };
  for (const char* shift : {"1.,0.,0.,0.,0.,0.", "0.,1.,0.,0.,0.,0.", "0.,0.,1.,0.,0.,0."})
    EXPECT_EQ(count(shift), 1) << shift;
  for (const char* turn :
       {"0.,0.,0.,1.,0.,0.", "0.,0.,0.,0.,1.,0.", "0.,0.,0.,0.,0.,1.", "0.,0.,0.,0.,0.,VR[1]"})
    EXPECT_EQ(count(turn), 0) << turn;
}

// OPT-8.78: degrees are told of FUNCTION 99 and a variable with a unit alone.
TEST(AdviceEnds, TheRotaryTableTakesNumbersWithoutUnit) {
  const auto count = [](std::string_view text) { return CountOf(text, 7033, "OPT-8.78"); };
  EXPECT_EQ(count("FUNCTION 99 (VR[3])\n"), 1);
  for (const char* text :
       {"FUNCTION 99 (90.)\n", "FUNCTION 99 (VR[30])\n", "FUNCTION 99\n", "FUNCTION 98 (VR[3])\n"})
    EXPECT_EQ(count(text), 0) << text;
}

// OPT-7.66, OPT-7.60, OPT-5.40, OPT-3.09: beside a fault advice is given on what has none, and what
// has one is told it alone.
TEST(AdviceEnds, BesideAFaultTheOthersAreAdvised) {
  EXPECT_EQ(FindingsOf("VI[98] = 1\n", true), std::vector<int>{7016});
  EXPECT_EQ(FindingsOf("DECLARE N = 8\nOL[9] = ON\nOL[N] = ON\nSPEED #\n", true),
            (std::vector<int>{7409, 7001}));
  EXPECT_EQ(FindingsOf("WORK 1,3/ON/START (VL[XX])\nDECLARE XX = #\n", true),
            std::vector<int>{7001});
}

}  // namespace
}  // namespace rmlcell::optimo::advice_ends
