// What is known where two ways come together does not depend on which of them comes first.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::both_ways {
namespace {

// How often this is said behind two ways.
auto SaidBehind(const std::string& one, const std::string& other, const std::string& rest,
                int number, std::string_view rule) {
  const std::string text =
      "IF IL[20] THEN 5\n" + one + "GOTO 10\n5 ACCEL 50\n" + other + "10 ACCEL 60\n" + rest;
  const Compilation compiled = Compile(text, "", {.advice = true});
  EXPECT_TRUE(compiled.ok) << text;
  return std::ranges::count_if(compiled.diagnostics, [&](const Diagnostic& d) {
    return Lookup(d.code).number == number && d.rule == rule;
  });
}

struct Row {
  std::string one, other, rest;
  int number;
  std::string_view rule;
  int said;
};

void ExpectEitherWay(const Row& row) {
  EXPECT_EQ(SaidBehind(row.one, row.other, row.rest, row.number, row.rule), row.said)
      << row.one << row.other << row.rest;
  EXPECT_EQ(SaidBehind(row.other, row.one, row.rest, row.number, row.rule), row.said)
      << row.other << row.one << row.rest;
}

const std::string kCut = "OL[11]=ON\nWORK 0,0/ON\nDELAY 1\nMOVE (9.,0.,0.,0.,0.)\n";

// OPT-3.09, OPT-3.33, OPT-5.40, OPT-5.47, OPT-1.17: what may be missing, or on, on one of them.
TEST(BothWays, WhatMayBeIsTold) {
  const std::string def = "WORKDEF 1,4 (8.,75.,1.,50.)\n", work = "WORK 1,4/ON\n";
  for (const Row& row : {
           Row{def, "", work, 7401, "OPT-3.09", 1},
           Row{def, def, work, 7401, "OPT-3.09", 0},
           Row{"WORK 0,0/ON\n", "", "CALL 2\n", 7407, "OPT-3.33", 1},
           Row{"WORK 0,0/ON\nWORK 0,0/OFF\n", "", "CALL 2\n", 7407, "OPT-3.33", 0},
           Row{"OL[8]=ON\n", "", "OL[9]=ON\n", 7409, "OPT-5.40", 1},
           Row{"OL[9]=ON\n", "", "OL[8]=ON\n", 7409, "OPT-5.40", 1},
           Row{"OL[8]=ON\nOL[8]=OFF\n", "", "OL[9]=ON\n", 7409, "OPT-5.40", 0},
           Row{"VL[8]=ON\n", "VR[8]=1.\n", "OL[9]=ON\n", 7409, "OPT-5.40", 0},
           Row{"VR[5]=1.\n", "", "VR[6]=VR[5]\n", 7033, "OPT-1.17", 1},
           Row{"VR[5]=1.\n", "VR[5]=2.\n", "VR[6]=VR[5]\n", 7033, "OPT-1.17", 0},
           Row{"OL[11]=OFF\n", "", "WORK 0,0/ON\n", 7033, "OPT-5.47", 1},
           Row{"OL[11]=OFF\n", "OL[11]=ON\n", "WORK 0,0/ON\n", 7033, "OPT-5.47", 0},
       })
    ExpectEitherWay(row);
}

// OPT-5.45, OPT-5.46, OPT-5.48, OPT-2.52, OPT-B.22: what is told of one value alone.
TEST(BothWays, WhatIsNotTheSameIsNotKnown) {
  const std::string lines = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
  const std::string hole =
      "COORD ABSOL\nPATH HOLE (5.)\nMOVE (20.,2.,3.,0.,0.)/VIA (23.,2.,3.,0.,0.)\n";
  const std::string tiny = "MOVE (.005,0.,0.,0.,0.)/FLY\nMOVE (.01,0.,0.,0.,0.)/FLY\n",
                    start = lines + "MOVE (0.,0.,0.,0.,0.)/FLY\n",
                    more = "MOVE (.015,0.,0.,0.,0.)/FLY\nMOVE (20.,0.,0.,0.,0.)\n";
  for (const Row& row : {
           Row{"PATH PTP\n", "PATH LIN\n", "COORD ABSOL\n" + kCut, 7033, "OPT-5.45", 0},
           Row{"PATH PTP\n", "PATH PTP\n", "COORD ABSOL\n" + kCut, 7033, "OPT-5.45", 1},
           Row{"SPEED 30\n", "SPEED 10\n", "COORD ABSOL\nPATH LIN\n" + kCut, 7033, "OPT-5.46", 0},
           Row{"SPEED 30\n", "SPEED 30\n", "COORD ABSOL\nPATH LIN\n" + kCut, 7033, "OPT-5.46", 1},
           Row{"SYSDEF (1.,0.,0.,1.,0.,0.)\n", "", hole, 7033, "OPT-5.48", 0},
           Row{"SYSDEF (1.,0.,0.,0.,0.,0.)\n", "", hole, 7033, "OPT-5.48", 1},
           Row{lines + "MOVE (9.,0.,0.,0.,0.)\n", lines + "MOVE (0.,0.,0.,0.,0.)\n",
               "SPEED 0\nMOVE (9.,0.,0.,0.,0.)\n", 7307, "OPT-B.22", 0},
           Row{lines + "MOVE (9.,0.,0.,0.,0.)\n", lines + "MOVE (9.,0.,0.,0.,0.)\n",
               "SPEED 0\nMOVE (8.,0.,0.,0.,0.)\n", 7307, "OPT-B.22", 1},
           Row{start + tiny, start + tiny, more, 7314, "OPT-2.52", 1},
           Row{start + tiny, start + "MOVE (.01,0.,0.,0.,0.)\n", more, 7314, "OPT-2.52", 0},
       })
    ExpectEitherWay(row);
}

// OPT-7.37, OPT-4.71, OPT-5.46: each value is looked at itself, and each instruction.
TEST(BothWays, WhatStandsBesideDoesNotCount) {
  const auto said = [](const std::string& text, int number) {
    return std::ranges::count(FindingsOf(text, true), number);
  };
  EXPECT_EQ(said("SYSDEF (0,0,0,0,0,0)\n", 7311), 1);
  EXPECT_EQ(said("SYSDEF (VR[86],0,0,0,0,0)\n", 7311), 0);
  EXPECT_EQ(said("SYSDEF (0,0,0,0,0,VR[91])\n", 7311), 0);
  EXPECT_EQ(said("TCP (0,0,3/0,0,3)\n", 7312), 1);
  EXPECT_EQ(FindingsOf("SYSDEF (XX,0,0,0,0,0)\n", true), std::vector<int>{7011});
  EXPECT_EQ(said("TCP (0,0,VR[82]/0,0,0)\n", 7312), 0);
  EXPECT_EQ(said("TCP (1,0,3/1,0,3)\n", 7312), 1);
  EXPECT_EQ(said("TCP (0,1,3/0,1,3)\n", 7312), 1);
  for (const char* points : {"1,0,3/0,0,3", "0,0,3/1,0,3", "0,1,3/0,0,3", "0,0,3/0,1,3"})
    EXPECT_EQ(said("TCP (" + std::string(points) + ")\n", 7312), 0) << points;
  const std::string lines =
      "COORD ABSOL\nPATH LIN\nOL[11]=ON\nWORKDEF 2,5 (15)\nSPEED 30\n"
      "MOVE (9.,0.,0.,0.,0.)\n";
  EXPECT_EQ(said(lines + "WORK 0,0/ON\nWORK 2,5/ON\nWORK 2,5/OFF\nWORK 0,0/OFF\n", 7033), 1);
  EXPECT_EQ(said(lines + "WORK 2,5/ON\nWORK 2,5/OFF\n", 7033), 0);
  EXPECT_EQ(said(lines + "WORK 0,0/OFF\nWORK 0,0/ON\nWORK 0,0/OFF\n", 7033), 0);
}

// OPT-5.47: where the beam is switched on, and not once more where it cuts.
TEST(BothWays, ASensorThatIsOffIsToldOnce) {
  const auto said = [](const std::string& text) {
    const Compilation compiled = Compile(text, "", {.advice = true});
    return std::ranges::count(compiled.diagnostics, "OPT-5.47", &Diagnostic::rule);
  };
  const std::string move = "MOVE (9.,0.,0.,0.,0.)\n";
  EXPECT_EQ(said("WORK 0,0/ON\nDELAY 1\n" + move + move), 1);
  EXPECT_EQ(said("OL[11]=ON\nWORK 0,0/ON\nDELAY 1\nOL[11]=OFF\n" + move + move), 1);
}

// OPT-3.09: where something is wrong each sequence number may be jumped to from there.
TEST(BothWays, BesideAFaultANumberIsComeToFromAnywhere) {
  const auto said = [](const std::string& text) {
    return std::ranges::count(FindingsOf(text, true), 7401);
  };
  EXPECT_EQ(said("WORK 1,3/ON\nGOTO #\n"), 1);
  EXPECT_EQ(said("10 WORK 1,3/ON\nGOTO #\n"), 0);
  EXPECT_EQ(said("ACCEL 5\n10 WORK 1,3/ON\nGOTO #\n"), 0);
  EXPECT_EQ(said("10 WORK 1,3/ON\nGOTO 10\n"), 1);
}

// OPT-7.109: a GOSUB stands for the moves that it leads to, also the first instruction.
TEST(BothWays, AGosubIsItsMoves) {
  const auto said = [](const std::string& first) {
    const Compilation compiled =
        Compile(first +
                    "COORD ROBOT\nPATH PTP\nMOVE (1.,0.,0.,0.,0.)\nCOORD ABSOL\n"
                    "MOVE (2.,0.,0.,0.,0.)\nENDTASK\n900 SYSDEF (1.,0.,0.,0.,0.,0.)\n"
                    "COORD ABSOL\nMOVE (3.,0.,0.,0.,0.)\nRETURN\n",
                "", {.advice = true});
    return std::ranges::count(compiled.diagnostics, "OPT-7.109", &Diagnostic::rule);
  };
  EXPECT_EQ(said("GOSUB 900\n"), 1);
  EXPECT_EQ(said("ACCEL 5\nGOSUB 900\n"), 1);
  EXPECT_EQ(said("ACCEL 5\n"), 0);
  EXPECT_EQ(said("MOVE (0.,0.,0.,0.,0.)/TIME (5.,900)\n"), 0);  // seldom comes there
  // The last retract of a subroutine is no move of the program behind it.
  const std::string_view apart =
      "GOTO 10\n900 COORD ABSOL\nMOVE (1.,0.,0.,0.,0.)\nCOORD ROBOT\nPATH PTP\n"
      "MOVE (2.,0.,0.,0.,0.)\nRETURN\n10 SYSDEF (1.,0.,0.,0.,0.,0.)\nCOORD ABSOL\n"
      "MOVE (3.,0.,0.,0.,0.)\nGOSUB 900\nENDTASK\n";
  const Compilation compiled = Compile(apart, "", {.advice = true});
  EXPECT_EQ(std::ranges::count(compiled.diagnostics, "OPT-7.109", &Diagnostic::rule), 0);
}

// OPT-3.47, OPT-7.23: either number of an IF is come to.
TEST(BothWays, BothNumbersOfAnIfAreReached) {
  const auto said = [](const std::string& text) {
    const Compilation compiled = Compile(text, "", {.advice = true});
    return std::ranges::count(compiled.diagnostics, "OPT-3.47", &Diagnostic::rule);
  };
  EXPECT_EQ(said("IF IL[20] THEN 10 ELSE 20\n10 ACCEL 5\nENDTASK\n20 ACCEL 6\n"), 0);
  EXPECT_EQ(said("IF IL[20] THEN 20 ELSE 10\n10 ACCEL 5\nENDTASK\n20 ACCEL 6\n"), 0);
  EXPECT_EQ(said("IF IL[20] THEN 10 ELSE 10\nACCEL 4\n10 ACCEL 5\n"), 1);
}

// OPT-2.51: the next move behind a CALL is one of another program.
TEST(BothWays, AShortMoveIsForgottenBehindACall) {
  const auto said = [](const std::string& between) {
    return std::ranges::count(FindingsOf("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0.,0.,0.,0.,0.)\n"
                                         "MOVE (0.9,0.,0.,0.,0.)/FLY\n" +
                                             between + "MOVE (20.,0.,0.,0.,0.)\n",
                                         true),
                              7314);
  };
  EXPECT_EQ(said(""), 1);
  EXPECT_EQ(said("ACCEL 5\n"), 1);
  EXPECT_EQ(said("CALL 2\n"), 0);
}

}  // namespace
}  // namespace rmlcell::optimo::both_ways
