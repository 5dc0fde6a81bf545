#include "engine/optimo/offline/contour_advice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/checker.h"
#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

// The findings of one number, by line and detail.
struct Told {
  int line;
  std::string detail;
};
std::vector<Told> FindingsWith(const std::string& text, ErrorCode code) {
  std::vector<Told> told;
  for (const Diagnostic& d : TranslateOptimo({"a.S", text}, {}).diagnostics) {
    if (d.code == code) told.push_back({d.where.line, d.detail});
  }
  return told;
}

// A corner at (100,0,0) that turns by `degrees` to the left, on line 6, cut at SPEED 10.
std::string CornerOf(double degrees, const std::string& before = "", bool beam = true) {
  const double x = 100.0 + 100.0 * std::cos(degrees * M_PI / 180.0);
  const double y = 100.0 * std::sin(degrees * M_PI / 180.0);
  return "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\n" +
         std::string(beam ? "WORK 0,0/ON\n" : "OL[11]=ON\n") + "MOVE (100,0,0,0,0)/FLY\n" + before +
         "MOVE (" + FixedText(x, 6) + "," + FixedText(y, 6) + ",0,0,0)\nWORK 0,0/OFF\n";
}

// OPT-2.62, OPT-E.7317: motion.md C01: 90 degrees at 50 mm/s: 1.3588 mm from the corner.
TEST(ContourAdvice, SharpCornersAreToldWithTheirDistance) {
  const auto told = FindingsWith(CornerOf(90), ErrorCode::kFlySharp);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].line, 6);
  EXPECT_EQ(told[0].detail,
            "the contour turns by 90.0 degrees; the path stays 1.359 mm away from the corner");
  EXPECT_TRUE(FindingsWith(CornerOf(59.9), ErrorCode::kFlySharp).empty());
  EXPECT_EQ(FindingsWith(CornerOf(60.1), ErrorCode::kFlySharp).size(), 1U);
}

// OPT-2.42, OPT-2.62: OVERSH 50 halves the speed; case C13: 0.480 mm.
TEST(ContourAdvice, OvershotCornersAreMeasuredAtTheirSpeed) {
  const std::string text = CornerOf(90);
  const auto told = FindingsWith("OVERSH 50\n" + text, ErrorCode::kFlySharp);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].detail.find("stays 0.480 mm"), std::string::npos) << told[0].detail;
}

// OPT-2.34, 2.10: a program that says nothing runs at SPEED 70, ACCEL 100 and OVERSH 100.
TEST(ContourAdvice, WhatHoldsAtTheStart) {
  const auto told = [](const std::string& before) {
    std::string text = CornerOf(90);
    text.erase(text.find("SPEED 10\n"), 9);
    const auto found = FindingsWith(before + text, ErrorCode::kFlySharp);
    return found.size() == 1 ? found[0].detail : std::to_string(found.size()) + " findings";
  };
  EXPECT_EQ(told(""), told("SPEED 70\n"));
  EXPECT_EQ(told(""), told("ACCEL 100\n"));
  EXPECT_EQ(told(""), told("OVERSH 100\n"));
  EXPECT_NE(told(""), told("SPEED 35\n"));
}

// OPT-2.62: OVERSH 0, beam off, or a corner that is no passage: nothing to say.
TEST(ContourAdvice, HarmlessCornersAreNotTold) {
  EXPECT_TRUE(FindingsWith("OVERSH 0\n" + CornerOf(90), ErrorCode::kFlySharp).empty());
  EXPECT_TRUE(FindingsWith(CornerOf(90, "", false), ErrorCode::kFlySharp).empty());
  EXPECT_TRUE(FindingsWith(CornerOf(90, "DELAY 1\n"), ErrorCode::kFlySharp).empty());
  // What is not known cannot be told: a speed from a variable, a corner that a jump comes to.
  EXPECT_TRUE(FindingsWith(CornerOf(90, "SPEED VR[64]\n"), ErrorCode::kFlySharp).empty());
  EXPECT_TRUE(FindingsWith(CornerOf(90, "10\n") + "GOTO 10\n", ErrorCode::kFlySharp).empty());
  EXPECT_EQ(FindingsWith(CornerOf(90, "OL[16]=ON\n"), ErrorCode::kFlySharp).size(), 1U);
  // A schedule is no beam (OPT-3.23).
  EXPECT_TRUE(
      FindingsWith("WORKDEF 2,0 (5)\nWORK 2,0/ON\n" + CornerOf(90, "", false), ErrorCode::kFlySharp)
          .empty());
}

// OPT-2.62: a program with an error has no path yet, so nothing is said of one.
TEST(ContourAdvice, NoneBesideAnError) {
  EXPECT_TRUE(FindingsWith(CornerOf(90) + "SPEED ;\n", ErrorCode::kFlySharp).empty());
}

// OPT-2.62: a comment allows it, as any other advice.
TEST(ContourAdvice, CommentsSilenceIt) {
  const std::string text = CornerOf(90);
  const std::size_t corner = text.find("/FLY") + 4;
  EXPECT_TRUE(FindingsWith(text.substr(0, corner) + " ; rmlcell: allow 7317" + text.substr(corner),
                           ErrorCode::kFlySharp)
                  .empty());
}

// OPT-E.7318: a leg of 1 mm allows a cut of 0.5 mm at both of its corners of 90 degrees. There
// K = 0.9719 and J = 4.2 (motion.md 4.2, 4.3), a_n = 1600 and j_n = 32000: (j_n d^2/J)^(1/3) = 12.4
// mm/s is what the tightest place of the bend allows, and the middle of it, of which the speed is
// told, is passed no slower; K is the curvature there: sqrt(a_n d/K) = 28.7 is the most.
TEST(ContourAdvice, ShortNeighboursCostSpeed) {
  const auto told = FindingsWith(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nMOVE (100,0,0,0,0)/FLY\n"
      "MOVE (100,1,0,0,0)/FLY\nMOVE (200,1,0,0,0)\n",
      ErrorCode::kFlyCapped);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].line, 5);
  EXPECT_EQ(told[1].line, 6);
  const std::string before = "a short neighbour makes the blend tighter: ",
                    after = " mm/s in its middle instead of 50.0";
  ASSERT_TRUE(told[0].detail.starts_with(before));
  ASSERT_TRUE(told[0].detail.ends_with(after)) << told[0].detail;
  const double speed = *ParseDouble(
      std::string_view(told[0].detail)
          .substr(before.size(), told[0].detail.size() - before.size() - after.size()));
  EXPECT_GE(speed, 12.35);
  EXPECT_LE(speed, 28.7);
  // With room for the whole bend (4.05 mm of cut, case C01) it costs nothing.
  EXPECT_TRUE(
      FindingsWith("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nMOVE (100,0,0,0,0)/FLY\n"
                   "MOVE (100,8.2,0,0,0)/FLY\nMOVE (200,8.2,0,0,0)\n",
                   ErrorCode::kFlyCapped)
          .empty());
}

// OPT-E.7319: B = 0.5 degrees is 0.008727 rad, 31 degrees are 0.541052 rad, 29 are 0.506145.
TEST(ContourAdvice, AHeadThatSwingsWhileStraightDown) {
  const auto count = [](const std::string& from, const std::string& to) {
    return FindingsWith(
               "COORD ABSOL\nPATH LIN\nMOVE (0,0,0," + from + ")\nMOVE (100,0,0," + to + ")\n",
               ErrorCode::kHeadSingular)
        .size();
  };
  EXPECT_EQ(count("0,0.008727", "0.541052,0.008727"), 1U);
  EXPECT_EQ(count("0,0.008727", "0.506145,0.008727"), 0U);
  EXPECT_EQ(count("0,0.0192", "0.541052,0.0192"), 0U);   // 1.1 degrees
  EXPECT_EQ(count("0,0.785398", "3.14,-0.785398"), 1U);  // passes through B = 0
  EXPECT_EQ(FindingsWith("COORD ABSOL\nPATH PTP\nMOVE (0,0,0,0,0)\nMOVE (100,0,0,1,0)\n",
                         ErrorCode::kHeadSingular)
                .size(),
            0U);  // no contour
}

// OPT-2.48, OPT-2.49, OPT-2.62: what may stand at a corner, and what makes it one that is not
// passed, or of which nothing is known.
TEST(ContourAdvice, WhatStandsBetweenTheMovesOfACorner) {
  const std::string behind = "GOTO 9\n5 RETURN\n9\n";
  const auto told = [&](const std::string& between) {
    return FindingsWith(CornerOf(90, between) + behind, ErrorCode::kFlySharp).size();
  };
  for (const std::string passes :
       {"SPEED 10\n", "ACCEL 100\n", "OVERSH 100\n", "PATH LIN\n", "VR[1]=2.\n", "OL[16]=ON\n",
        "ASSIGN OL[16]=1 /1\n", "DECLARE X = 5.\n", "DEFINE PAR[0] = INT\n", "7\n",
        "WORKDEF 2,0 (5)\nWORK 2,0/ON\n", "WORK 0,0/ON\n", "TASK 1\n"}) {
    EXPECT_EQ(told(passes), 1U) << passes;
  }
  for (const std::string stops : {"DELAY 1\n",
                                  "WAIT IL[20]\n",
                                  "PAUSE\n",
                                  "STOP\n",
                                  "ZERO\n",
                                  "VR[1]=IA[0]\n",
                                  "VL[1]=IL[20]\n",
                                  "ERR 5\n",
                                  "NOERR\n",
                                  "SETERR 5\n",
                                  "UPDATE OL /ON\n",
                                  "IMAGE OL\n",
                                  "REAL\n",
                                  "TIMER (1.,5)\n",
                                  "COORD ABSOL\n",
                                  "COORD ROBOT\n",
                                  "CALL 2\n",
                                  "FUNCTION 3\n",
                                  "GOSUB 5\n",
                                  "GOTO 7\n7\n",
                                  "ENDTASK\n",
                                  "TCP (0,0,0/0,0,-5)\n",
                                  "SYSDEF\n",
                                  "WORK 0,0/OFF\n",
                                  "WORKDEF 2,0 (5)\nWORK 2,0/OFF\n",
                                  "WORK 0,0/ON/START (IL[20])\n",
                                  "WORK 0,0/ON/END (IL[20])\n",
                                  "WORK 0,0/ON/TIME (1.,5)\n",
                                  "WORKDEF 1,0 (8.,75.,1.,50.)\nWORK 1,0/ON\n",
                                  "PATH HOLE (5.)\n",
                                  "SPEED VR[64]\n",
                                  "ACCEL VR[64]\n",
                                  "OVERSH VR[64]\n"}) {
    EXPECT_EQ(told(stops), 0U) << stops;
  }
}

// OPT-2.43, OPT-2.48, OPT-2.54: attributes of the two moves; a target that is no number.
TEST(ContourAdvice, AttributesOfTheMovesOfACorner) {
  const auto told = [](const std::string& first, const std::string& second) {
    return FindingsWith(
               "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
               "MOVE (100,0,0,0,0)" +
                   first + "\nMOVE (100,100,0,0," + second + "\nWORK 0,0/OFF\n5\n",
               ErrorCode::kFlySharp)
        .size();
  };
  EXPECT_EQ(told("/FLY", "0)"), 1U);
  EXPECT_EQ(told("/FLY", "0)/FLY"), 1U);
  EXPECT_EQ(told("", "0)"), 0U);
  EXPECT_EQ(told("/FLY", "0)/START (IL[20])"), 0U);
  EXPECT_EQ(told("/FLY/START (IL[20])", "0)"), 1U);
  EXPECT_EQ(told("/FLY/END (IL[20])", "0)"), 0U);
  EXPECT_EQ(told("/FLY/TIME (1.,5)", "0)"), 0U);
  EXPECT_EQ(told("/FLY/END (IL[20])/NEXT", "0)"), 0U);
  EXPECT_EQ(told("/FLY", "VR[1])"), 0U);
}

// motion/planner.h: a MOVE on the spot adds nothing, but one without /FLY makes the corner a stop.
TEST(ContourAdvice, MovesOnTheSpotAreNoCorner) {
  const auto told = [](const std::string& between) {
    return FindingsWith(CornerOf(90, between), ErrorCode::kFlySharp);
  };
  const std::string stay = "MOVE (100,0,0,0,0)";
  for (const std::string& passes : {stay + "/FLY\n", stay + "/FLY\n" + stay + "/FLY\n"}) {
    ASSERT_EQ(told(passes).size(), 1U) << passes;
    EXPECT_EQ(told(passes)[0].line, 6) << passes;
  }
  EXPECT_EQ(told(stay + "\n").size(), 0U);
  EXPECT_EQ(told(stay + "/FLY\n" + stay + "\n").size(), 0U);
  EXPECT_EQ(told(stay + "\n" + stay + "/FLY\n").size(), 0U);
}

// OPT-E.7319: on both sides of straight down, either way, and what is said of which move.
TEST(ContourAdvice, TheSwingOfTheHeadIsTold) {
  const auto told = [](const std::string& from, const std::string& to) {
    return FindingsWith(
        "COORD ABSOL\nPATH LIN\nMOVE (0,0,0," + from + ")\nMOVE (100,0,0," + to + ")\n",
        ErrorCode::kHeadSingular);
  };
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"0,-0.008727", "0.541052,-0.008727"},
           {"0.541052,0.008727", "0,0.008727"},
           {"0,-0.5", "-0.541052,0.5"},
           {"0,0.5", "0.541052,-0.5"},
           {"0,0.5", "0.541052,0.017"},  // 0.974 degrees
           {"0,0.017", "0.541052,0.5"},
           {"0,-0.5", "0.541052,-0.017"}}) {
    const auto found = told(from, to);
    ASSERT_EQ(found.size(), 1U) << from << " " << to;
    EXPECT_EQ(found[0].line, 4);
    EXPECT_EQ(found[0].detail, "A turns by 31.0 degrees while the head passes straight down");
  }
  EXPECT_TRUE(told("0,-0.5", "0.541052,-0.0178").empty());  // 1.02 degrees
  EXPECT_TRUE(told("0,0.5", "0.541052,0.5").empty());
  EXPECT_TRUE(told("0,-0.5", "0.506145,0.5").empty());
  // Where the tip stands still the head may turn as it likes.
  EXPECT_TRUE(FindingsWith("COORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nMOVE (0,0,0,1,0)\n",
                           ErrorCode::kHeadSingular)
                  .empty());
}

// contour_advice.h: where a jump comes to, nothing that was said before counts: the place, PATH,
// COORD, SPEED, ACCEL, OVERSH and the beam. Each must be said again before a corner can be told.
TEST(ContourAdvice, NothingIsKnownWhereAJumpComesTo) {
  const std::vector<std::string> setting = {"COORD ABSOL\n", "PATH LIN\n",   "SPEED 10\n",
                                            "ACCEL 100\n",   "OVERSH 100\n", "WORK 0,0/ON\n"};
  const std::string jump = "WORK 0,0/OFF\nGOTO 10\n";
  const auto told = [&](std::size_t left_out, const std::string& moves) {
    std::string before, behind = "10\n";
    for (std::size_t k = 0; k < setting.size(); ++k) {
      before += setting[k];
      if (k != left_out) behind += setting[k];
    }
    return FindingsWith(before + "MOVE (0,0,0,0,0)\nMOVE (100,0,0,0,0)\n" + behind + moves + jump,
                        ErrorCode::kFlySharp)
        .size();
  };
  // The first corner is at the end of a move that starts somewhere.
  const std::string one = "MOVE (100,100,0,0,0)/FLY\nMOVE (0,100,0,0,0)\n";
  const std::string two = "MOVE (100,100,0,0,0)/FLY\nMOVE (0,100,0,0,0)/FLY\nMOVE (0,200,0,0,0)\n";
  EXPECT_EQ(told(setting.size(), one), 0U);
  EXPECT_EQ(told(setting.size(), two), 1U);
  for (std::size_t k = 0; k < setting.size(); ++k) EXPECT_EQ(told(k, two), 0U) << setting[k];
}

// OPT-2.10: SPEED, ACCEL and OVERSH set one thing each, in whichever order they stand.
TEST(ContourAdvice, TheOrderOfSettingsDoesNotMatter) {
  const auto told = [](const std::string& settings) {
    const std::string text = settings +
                             "COORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
                             "MOVE (100,0,0,0,0)/FLY\nMOVE (100,1,0,0,0)/FLY\nMOVE (200,1,0,0,0)\n";
    std::string all;
    for (const ErrorCode code : {ErrorCode::kFlySharp, ErrorCode::kFlyCapped})
      for (const Told& each : FindingsWith(text, code)) all += each.detail + "\n";
    return all;
  };
  const std::string speed = "SPEED 10\n", accel = "ACCEL 40\n", oversh = "OVERSH 70\n";
  const std::string expected = told(oversh + accel + speed);
  EXPECT_NE(expected, "");
  EXPECT_EQ(told(speed + accel + oversh), expected);
  EXPECT_EQ(told(speed + oversh + accel), expected);
  EXPECT_EQ(told(accel + oversh + speed), expected);
  EXPECT_EQ(told(oversh + speed + accel), expected);
}

// contour_advice.h: COORD moves nothing: the place is known as long as no MOVE was in ROBOT.
TEST(ContourAdvice, CoordMovesNothing) {
  const auto told = [](const std::string& between) {
    return FindingsWith(
               "COORD ABSOL\nPATH LIN\nSPEED 10\nWORK 0,0/ON\nMOVE (0,0,0,0,0)\n" + between +
                   "COORD ABSOL\nMOVE (100,0,0,0,0)/FLY\nMOVE (100,100,0,0,0)\nWORK 0,0/OFF\n",
               ErrorCode::kFlySharp)
        .size();
  };
  EXPECT_EQ(told(""), 1U);
  EXPECT_EQ(told("COORD ROBOT\n"), 1U);
  EXPECT_EQ(told("COORD ROBOT\nPATH PTP\nMOVE (0,0,0,0,0)\nPATH LIN\n"), 0U);
}

// contour_advice.h: programs of more than 40,000 instructions are left out. A corner has eight.
TEST(ContourAdvice, ProgramsThatNoControlHoldsAreLeftOut) {
  const auto told = [](int further) {
    std::string text = CornerOf(90);
    for (int n = 0; n < further; ++n) text += "SPEED 10\n";
    Findings findings;
    ParsedProgram program = Parse(text, findings, Places::kStatements);
    Check(program, findings);
    AdviseOnContours(program, ContourMachine::Standard(), findings);
    const std::vector<Diagnostic> all = findings.Take(text, "a.S");
    return std::ranges::count(all, ErrorCode::kFlySharp, &Diagnostic::code);
  };
  EXPECT_EQ(told(40'000 - 8), 1);
  EXPECT_EQ(told(40'000 - 8 + 1), 0);
}

// optimo.md B.1: the machine that is meant where none is named.
TEST(ContourAdvice, TheStandardMachineHasTheDefaults) {
  const ContourMachine machine = ContourMachine::Standard();
  EXPECT_EQ(machine.head_length_mm, 300.0);
  const motion::MachineLimits& limits = machine.limits;
  EXPECT_EQ(limits.tip_speed_mm_s, 500.0);
  EXPECT_EQ(limits.tip_acceleration_mm_s2, 2000.0);
  EXPECT_EQ(limits.tip_jerk_mm_s3, 40'000.0);
  EXPECT_EQ(limits.settling_s, 0.048);
  EXPECT_EQ(limits.axes.speed, (motion::AxisValues{500.0, 500.0, 500.0, kTurn, kTurn}));
  EXPECT_EQ(limits.axes.acceleration, (motion::AxisValues{2000.0, 2000.0, 2000.0, 20.0, 20.0}));
  EXPECT_EQ(limits.axes.jerk, (motion::AxisValues{40'000.0, 40'000.0, 40'000.0, 400.0, 400.0}));
  EXPECT_EQ(limits.axes.travel_min, (motion::AxisValues{-600.0, -600.0, -1300.0, -12.6, -2.4}));
  EXPECT_EQ(limits.axes.travel_max, (motion::AxisValues{3600.0, 3100.0, 1100.0, 12.6, 2.4}));
}

// OPT-2.09: a machine whose parameters start programs in COORD ABSOL, PATH LIN needs neither.
TEST(StartModes, WhatTheMachineStartsWithNeedsNoAdvice) {
  const auto said = [](const std::string& text, const StartModes& start) {
    ContourMachine machine = ContourMachine::Standard();
    machine.start = start;
    int advice = 0;
    for (const Diagnostic& d :
         TranslateOptimo({"a.S", text}, {}, kObjectLimitStandard, machine).diagnostics) {
      const bool of_coord = d.detail.starts_with("no COORD was set");
      const bool of_path = d.detail.find("no PATH was set") != std::string::npos;
      advice += of_coord || of_path ? 1 : 0;
    }
    return advice;
  };
  const std::string lin = "PATH LIN\nMOVE (10.,0.,0.,0.,0.)\n";
  const std::string contour = "COORD ABSOL\nWORK 0,0 /ON\nMOVE (10.,0.,0.,0.,0.)\nWORK 0,0 /OFF\n";
  const StartModes absol{.coord = CoordType::kAbsol, .path = PathType::kLin};
  EXPECT_EQ(said(lin, {}), 1);
  EXPECT_EQ(said(lin, absol), 0);
  EXPECT_EQ(said(contour, {}), 1);
  EXPECT_EQ(said(contour, absol), 0);
}

// OPT-2.19, OPT-2.21, OPT-2.62: an arc leaves the corner in its own direction: half a circle over
// (150,50) begins along Y, so that its corner turns by 90 degrees, where a line to the same point
// goes straight on. Of an arc through a point that is no number nothing is known.
TEST(ContourAdvice, ArcsTurnAsTheyBegin) {
  const auto told = [](const std::string& second) {
    return FindingsWith(
        "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
        "MOVE (100,0,0,0,0)/FLY\n" +
            second + "\nWORK 0,0/OFF\n",
        ErrorCode::kFlySharp);
  };
  const auto over = told("PATH CIR\nMOVE (200,0,0,0,0)/VIA (150,50,0,0,0)");
  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over[0].line, 6);
  EXPECT_TRUE(over[0].detail.starts_with("the contour turns by 90.0 degrees; ")) << over[0].detail;
  // In PATH LIN the via point leads nowhere, and without one CIR is a line.
  EXPECT_TRUE(told("MOVE (200,0,0,0,0)/VIA (150,50,0,0,0)").empty());
  EXPECT_TRUE(told("PATH CIR\nMOVE (200,0,0,0,0)").empty());
  for (const std::string via : {"VR[1],50,0", "150,VR[1],0", "150,50,VR[1]"}) {
    EXPECT_TRUE(told("PATH CIR\nMOVE (200,0,0,0,0)/VIA (" + via + ",0,0)").empty()) << via;
  }
  // Nor of one through its own begin, which is no arc.
  EXPECT_TRUE(told("PATH CIR\nMOVE (200,0,0,0,0)/VIA (100,0,0,0,0)").empty());
}

}  // namespace
}  // namespace rmlcell::optimo
