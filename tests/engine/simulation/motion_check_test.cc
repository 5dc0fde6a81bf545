#include "engine/simulation/run/motion_check.h"

#include <gtest/gtest.h>

#include <chrono>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "tests/engine/simulation/fake_family.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

// A memory of Optimo programs, as CHECK gets them.
machine::RunSetup Memory(const std::map<int, std::string>& programs) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(family.parameters())};
  for (const auto& [slot, text] : programs) {
    machine::Translation made =
        family.Translate({.name = "test.S", .bytes = text}, setup.parameters, {.source = true});
    EXPECT_TRUE(made.ok) << text;
    machine::StoredProgram& stored = setup.programs[slot];
    stored.object = machine::Bytes::Of(std::move(made.object));
    stored.source = std::make_shared<const machine::SourceNotes>(std::move(made.source));
  }
  return setup;
}

MotionCheck Checked(const std::map<int, std::string>& programs, const std::set<int>& slots,
                    const machine::InputScript& inputs = {}) {
  machine::RunSetup setup = Memory(programs);
  setup.inputs = inputs;
  const auto check = CheckMotion(*families::FindFamily("optimo"), setup, slots);
  EXPECT_TRUE(check);
  return *check;
}

const std::string kPart =
    "SYSDEF\nCOORD ABSOL\nPATH LIN\nMOVE (4000.,0.,0.,0.,0.)\nMOVE (4100.,0.,0.,0.,0.)\n";

// CHECK of one program in slot 45, as people read it.
std::string VerdictOfCheck(const std::string& text, const machine::InputScript& inputs = {}) {
  CheckedProgram check{.family = families::FindFamily("optimo"),
                       .slot = 45,
                       .translation = {.ok = true},
                       .motion = Checked({{45, text}}, {45}, inputs)};
  return TextOf(JudgeCheck(check));
}

// OPT-E.7301: code, program, step, line and the time at which a run would do it.
TEST(MotionCheck, FindsEveryViolationWithItsPlace) {
  const MotionCheck check = Checked({{45, kPart}}, {45});
  ASSERT_EQ(check.findings.size(), 2U);
  EXPECT_TRUE(check.has_errors());
  EXPECT_EQ(check.findings[0].code, ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(check.findings[0].program, 45);
  EXPECT_EQ(check.findings[0].step, 4);
  EXPECT_EQ(check.findings[0].where.line, 4);
  EXPECT_EQ(check.findings[0].at, SimTime(0));
  EXPECT_EQ(check.findings[1].step, 5);
  EXPECT_GT(*check.findings[1].at, SimTime(0));
  EXPECT_TRUE(check.cut_short.empty());
  EXPECT_TRUE(check.reasons.empty());  // findings speak for themselves
}

// OPT-B.09: the SYSDEF of the caller brings the part into the travel; only alone would it leave it.
TEST(MotionCheck, AProgramIsLookedAtWithTheOffsetOfItsCaller) {
  const std::string caller = "SYSDEF (-1000.,0.,-300.,0.,0.,0.)\nCALL 44\n";
  const std::string part = kPart.substr(kPart.find('\n') + 1);  // has no SYSDEF of its own
  const std::map<int, std::string> programs = {{44, part}, {45, caller}};
  EXPECT_TRUE(Checked(programs, {44, 45}).findings.empty());
  EXPECT_EQ(Checked(programs, {44}).findings.size(), 2U);
  EXPECT_FALSE(Checked(programs, {44}).has_errors());  // nobody knows who calls it
  // The same the other way round: the fault is the caller's offset, the place that of the step.
  const MotionCheck far = Checked({{44, "COORD ABSOL\nMOVE (100.,0.,0.,0.,0.)\n"},
                                   {45, "SYSDEF (5000.,0.,0.,0.,0.,0.)\nCALL 44\n"}},
                                  {44, 45});
  ASSERT_EQ(far.findings.size(), 1U);
  EXPECT_EQ(far.findings[0].program, 44);
}

// A program of a single step is a part of its caller as well: it is not looked at by itself, where
// what it calls would have no offset.
TEST(MotionCheck, AProgramOfOneStepIsLookedAtWithItsCaller) {
  const std::string part = kPart.substr(kPart.find('\n') + 1);
  const std::map<int, std::string> programs = {
      {44, "CALL 46\n"}, {45, "SYSDEF (-1000.,0.,-300.,0.,0.,0.)\nCALL 44\n"}, {46, part}};
  EXPECT_TRUE(Checked(programs, {44, 45, 46}).findings.empty());
  EXPECT_EQ(Checked(programs, {44}).findings.size(), 2U);
}

// OPT-4.55: a tool that is 500 mm shorter brings the column below the end of Z: -1000 + 300 - 500 =
// -1200 is inside -1300, -1150 + 300 - 500 = -1350 is 50 outside.
TEST(MotionCheck, TheToolCounts) {
  const std::string tool = "SYSDEF\nTCP (0.,0.,500.,0.,0.,0.)\nCOORD ABSOL\n";
  EXPECT_TRUE(Checked({{1, tool + "MOVE (500.,500.,-1000.,0.,0.)\n"}}, {1}).findings.empty());
  const MotionCheck low = Checked({{1, tool + "MOVE (500.,500.,-1150.,0.,0.)\n"}}, {1});
  ASSERT_EQ(low.findings.size(), 1U);
  EXPECT_EQ(low.findings[0].detail, "Z of the target leaves its travel by 50.000 mm");
}

// OPT-2.16: advice of the motion comes along, and is no error.
TEST(MotionCheck, TellsAxesThatHoldBack) {
  const MotionCheck check = Checked(
      {{1, "COORD ABSOL\nPATH LIN\nMOVE (500.,500.,-400.,0.,1.)\nMOVE (500.,505.,-400.,0.,0.)\n"}},
      {1});
  ASSERT_FALSE(check.findings.empty());
  EXPECT_EQ(check.findings[0].code, ErrorCode::kSpeedHeldByAxis);
  EXPECT_FALSE(check.has_errors());
}

// OPT-B.22, OPT-B.25: a MOVE that would never end, and a turn back that /FLY cannot pass.
TEST(MotionCheck, TellsWhatARunWouldMeet) {
  const MotionCheck still = Checked({{1, "SPEED 0\nMOVE (100.,100.,0.,0.,0.)\n"}}, {1});
  ASSERT_EQ(still.findings.size(), 1u);
  EXPECT_EQ(still.findings[0].code, ErrorCode::kNoMotion);
  EXPECT_EQ(still.findings[0].where.line, 2);
  EXPECT_FALSE(still.has_errors());
  const MotionCheck back = Checked({{1,
                                     "COORD ABSOL\nPATH LIN\nMOVE (500.,500.,-400.,0.,0.)\n"
                                     "MOVE (600.,500.,-400.,0.,0.)/FLY\n"
                                     "MOVE (500.,500.,-400.,0.,0.)\n"}},
                                   {1});
  ASSERT_EQ(back.findings.size(), 1u);
  EXPECT_EQ(back.findings[0].code, ErrorCode::kFlyReversal);
  EXPECT_EQ(back.findings[0].where.line, 4);
}

// A comment lets advice of the motion pass at its line, or in the whole text; an error never.
TEST(MotionCheck, CommentsAllowAdvice) {
  const std::string there = "COORD ABSOL\nPATH LIN\nMOVE (500.,500.,-400.,0.,1.)\n";
  const std::string slow = "MOVE (500.,505.,-400.,0.,0.)";
  const auto count = [&](const std::string& text) {
    return Checked({{1, text}}, {1}).findings.size();
  };
  EXPECT_EQ(count(there + slow + "\n"), 1u);
  EXPECT_EQ(count(there + slow + " ; rmlcell: allow 7321\n"), 0u);
  EXPECT_EQ(count(there + "; rmlcell: allow 7321\n" + slow + "\n"), 0u);
  EXPECT_EQ(count("; rmlcell: allow 7321 in file\n" + there + slow + "\n"), 0u);
  EXPECT_EQ(count(there + "SPEED 50 ; rmlcell: allow 7321\n" + slow + "\n"), 1u);
  EXPECT_EQ(count("MOVE (9000.,0.,0.,0.,0.) ; rmlcell: allow 7301\n"), 1u);
}

// What inputs decide is looked at as far as they let it happen, and said so.
TEST(MotionCheck, StopsWhereAnInputIsMissing) {
  const std::string program = "COORD ABSOL\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n";
  const MotionCheck without = Checked({{1, program}}, {1});
  EXPECT_TRUE(without.findings.empty());
  ASSERT_TRUE(without.cut_short.contains(1));
  EXPECT_NE(without.cut_short.at(1).text.find("only up to step 2, line 2"), std::string::npos);
  const MotionCheck with = Checked(
      {{1, program}}, {1}, {{std::chrono::seconds(5), machine::InputKind::kLogical, 16, 1.0}});
  ASSERT_EQ(with.findings.size(), 1U);
  EXPECT_EQ(ToSeconds(*with.findings[0].at), 5.0);
}

// OPT-7.28: SYSDEF outlives the program that set it. Where X, Y and Z go hangs on it, in COORD
// ABSOL alone; A and B never. 4000 - 3600 = 400; 13 - 12.6 = 0.4.
TEST(MotionCheck, DoubtsATravelErrorThatHangsOnAnOffsetBefore) {
  const std::string x = "MOVE (4000.,0.,0.,0.,0.)\n";
  EXPECT_EQ(
      VerdictOfCheck("COORD ABSOL\n" + x),
      "DOUBTFUL; OPT-E7301 X of the target leaves its travel by 400.000 mm, if no SYSDEF is in "
      "force before @2");
  const std::string bad = "BAD; OPT-E7301 X of the target leaves its travel by 400.000 mm @";
  EXPECT_EQ(VerdictOfCheck("SYSDEF\nCOORD ABSOL\n" + x), bad + "3");
  EXPECT_EQ(VerdictOfCheck("SYSDEF (1.,0.,0.,0.,0.,0.)\nCOORD ABSOL\nMOVE (3999.,0.,0.,0.,0.)\n"),
            bad + "3");
  EXPECT_EQ(VerdictOfCheck("COORD ROBOT\n" + x), bad + "2");
  EXPECT_EQ(VerdictOfCheck("COORD ABSOL\nMOVE (500.,500.,-400.,13.,0.)\n"),
            "BAD; OPT-E7301 A of the target leaves its travel by 0.400 rad @2");
  // One that is sure speaks for those that are not.
  EXPECT_EQ(VerdictOfCheck("COORD ABSOL\n" + x + "SYSDEF\n" + x), bad + "4");
}

// That one move is sure takes no doubt from the next one: each is asked for itself.
TEST(MotionCheck, EachTravelErrorHasItsOwnDoubt) {
  const MotionCheck check = Checked({{45,
                                      "COORD ROBOT\nMOVE (4000.,0.,0.,0.,0.)\nCOORD ABSOL\n"
                                      "MOVE (4100.,0.,0.,0.,0.)\n"}},
                                    {45});
  ASSERT_EQ(check.findings.size(), 2U);
  EXPECT_EQ(check.findings[0].step, 2);
  EXPECT_TRUE(IsError(check.findings[0].severity));
  EXPECT_EQ(check.findings[1].step, 4);
  EXPECT_FALSE(IsError(check.findings[1].severity));
  EXPECT_NE(check.findings[1].detail.find(", if no SYSDEF is in force before"), std::string::npos);
}

// OPT-7.104: a SYSDEF of variables that an operator, or another program, set before.
TEST(MotionCheck, DoubtsATravelErrorThatHangsOnAVariable) {
  const std::string move = "COORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\n";
  EXPECT_EQ(
      VerdictOfCheck("SYSDEF (VR[86],VR[87],0.,0.,0.,0.)\n" + move),
      "DOUBTFUL; OPT-E7301 X of the target leaves its travel by 400.000 mm, if VR[86] is 0 (and "
      "1 more is as it was) @3");
  EXPECT_EQ(VerdictOfCheck("VR[86] = 1.\nVR[87] = 0.\nSYSDEF (VR[86],VR[87],0.,0.,0.,0.)\n" + move),
            "BAD; OPT-E7301 X of the target leaves its travel by 401.000 mm @5");
}

// What the script of inputs says is told, and nothing that the check had to assume.
TEST(MotionCheck, DoubtsATravelErrorThatHangsOnAnInput) {
  const std::string text =
      "COORD ROBOT\nIF IL[5] THEN 10\nMOVE (4000.,0.,0.,0.,0.)\n10 COORD ROBOT\n";
  EXPECT_EQ(
      VerdictOfCheck(text),
      "DOUBTFUL; OPT-E7301 X of the target leaves its travel by 400.000 mm, if IL[5] is OFF @3");
  EXPECT_EQ(VerdictOfCheck(text, {{SimTime(0), machine::InputKind::kLogical, 5, 1.0}}), "GOOD");
  EXPECT_EQ(VerdictOfCheck(text, {{SimTime(0), machine::InputKind::kLogical, 5, 0.0}}),
            "BAD; OPT-E7301 X of the target leaves its travel by 400.000 mm @3");
  // What is looked at later has no part in it.
  EXPECT_EQ(VerdictOfCheck("COORD ROBOT\nMOVE (4000.,0.,0.,0.,0.)\nVR[1] = VR[2]\n"),
            "BAD; OPT-E7301 X of the target leaves its travel by 400.000 mm @2");
}

// OPT-3.37, OPT-7.68, OPT-7.69: work flags IL[87] to IL[94], the motion flag IL[95], VI[98] and
// VI[99] and OA[0] are the control's own, whatever was before; all others are as somebody left
// them. Each condition is false on a machine that was just switched on.
TEST(MotionCheck, WhatTheControlSetsItselfIsSure) {
  const auto verdict = [](const std::string& condition) {
    return VerdictOfCheck("COORD ROBOT\nIF " + condition +
                          " THEN 10\nMOVE (4000.,0.,0.,0.,0.)\n10 COORD ROBOT\n");
  };
  const std::string beyond = "OPT-E7301 X of the target leaves its travel by 400.000 mm";
  for (const char* own : {"IL[87]", "IL[94]", "IL[95]", "(VI[98]>7)", "(VI[99]>0)", "(OA[0]>0)"})
    EXPECT_EQ(verdict(own), "BAD; " + beyond + " @3") << own;
  for (const auto& [other, as_it_is] : {std::pair("IL[86]", "IL[86] is OFF"),
                                        {"IL[96]", "IL[96] is OFF"},
                                        {"(VI[97]>0)", "VI[97] is 0"},
                                        {"(OA[1]>0)", "OA[1] is 0"},
                                        {"(IA[7]>0)", "IA[7] is 0"},
                                        {"VL[3]", "VL[3] is OFF"},
                                        {"OL[3]", "OL[3] is OFF"},
                                        {"(VR[3]>0)", "VR[3] is 0"}})
    EXPECT_EQ(verdict(other), "DOUBTFUL; " + beyond + ", if " + as_it_is + " @3") << other;
}

// The rules of a run judge a check, too: the programs of laser_verdict_test.cc.
TEST(MotionCheck, IsJudgedByTheRulesOfARun) {
  const std::string from = "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\n";
  const std::string to = "MOVE (50.,1000.,-400.,0.,0.)\n";
  const std::string beyond = "MOVE (60.,1000.,-400.,0.,0.)\n";
  const std::string without_beam = "WORK 0,0 /ON\n" + to + "WORK 2,5 /OFF\n" + beyond;
  const std::string off = "WORK 0,0 /OFF\n";
  EXPECT_EQ(VerdictOfCheck(from + "WORK 0,0 /ON\n" + to + off), "GOOD");
  EXPECT_EQ(VerdictOfCheck(from + without_beam + off),
            "BAD; OPT-E7414 10.000 mm of a process that is ON with the beam off @8");
  EXPECT_EQ(
      VerdictOfCheck("IF IL[5] THEN 10\n" + from + without_beam + off + "10 COORD ROBOT\n"),
      "DOUBTFUL; OPT-E7414 10.000 mm of a process that is ON with the beam off, if IL[5] is OFF "
      "@9");
  // A beam that stands 2 s behind the way, nothing of it piercing.
  EXPECT_EQ(VerdictOfCheck(from + "WORK 0,0 /ON\n" + to + "DELAY 2.\n" + off).substr(0, 16),
            "BAD; CELL-E9621 ");
}

// A reason belongs to the program that does it, however it was run, and to those that call it.
TEST(MotionCheck, DealsReasonsToThePrograms) {
  const std::string cut =
      "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\nWORK 0,0 /ON\n"
      "MOVE (50.,1000.,-400.,0.,0.)\n";
  const MotionCheck check =
      Checked({{44, cut}, {45, "CALL 44\n"}, {46, "CALL 44\n"}}, {44, 45, 46});
  std::vector<int> programs;
  for (const machine::Reason& reason : check.reasons) {
    EXPECT_EQ(reason.code, ErrorCode::kWorkActiveAtEnd);
    EXPECT_EQ(reason.said.ends_with(", in program 44"), reason.first.program != 44);
    programs.push_back(reason.first.program);
  }
  EXPECT_EQ(programs, (std::vector{44, 45, 46}));
}

// A halt is answered with START: the program goes on behind it.
TEST(MotionCheck, GoesOnBehindAHalt) {
  EXPECT_EQ(VerdictOfCheck("COORD ROBOT\nSTOP\nSTOP\nMOVE (9.,0.,0.,0.,0.)\n"),
            "DOUBTFUL; CELL-E9308 halts that wait for a key to go on: 2 @2");
  EXPECT_EQ(VerdictOfCheck("COORD ROBOT\nSTOP\nMOVE (9.,0.,0.,0.,0.)\n",
                           {{std::chrono::seconds(5), machine::InputKind::kStart, 0, 1.0}}),
            "GOOD");
  const MotionCheck check = Checked({{1, "COORD ABSOL\nSTOP\nMOVE (9000.,0.,0.,0.,0.)\n"}}, {1});
  EXPECT_EQ(check.findings.size(), 1U);
}

// A START that changes nothing is not given for ever: the program waits for something else.
TEST(MotionCheck, AHaltThatStartDoesNotEnd) {
  Script script;
  script.Step(1, 4, 5).Nothing(1.0).Halt("STOP").Halt("STOP").Nothing(1.0);
  const auto check = CheckMotion(FakeFamily(script, true), FakeFamily::Setup(), {1});
  ASSERT_TRUE(check);
  ASSERT_TRUE(check->cut_short.contains(1));
  const CutShort& why = check->cut_short.at(1);
  EXPECT_EQ(why.text.find("only up to step 4, line 5: CELL-E9308 "), 0U) << why.text;
  EXPECT_EQ(why.cause, ErrorCode::kCellWaitsForever);
  EXPECT_EQ(
      std::ranges::count(check->reasons, ErrorCode::kCellWaitsForever, &machine::Reason::code),
      0);  // what cut it short says it
}

// Whatever a program does, its check ends, and ends the same every time.
TEST(MotionCheck, IsBounded) {
  const std::string endless =
      "COORD ROBOT\n10 MOVE (9000.,0.,0.,0.,0.)\nMOVE (0.,0.,0.,0.,0.)\nGOTO 10\n";
  const MotionCheck check = Checked({{1, endless}}, {1});
  EXPECT_EQ(check.findings.size(), 1U);
  ASSERT_TRUE(check.cut_short.contains(1));
  EXPECT_EQ(Checked({{1, endless}}, {1}).cut_short, check.cut_short);
}

// Two programs that run each other in a ring are looked at, though none is the first.
TEST(MotionCheck, ARingIsLookedAtOnce) {
  const MotionCheck check =
      Checked({{44, "COORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\nGO 45\n"}, {45, "GO 44\n"}}, {44, 45});
  ASSERT_EQ(check.findings.size(), 1U);
  EXPECT_EQ(check.findings[0].program, 44);
}

// A check fails where every run of these programs fails: with code and place of the failure.
TEST(MotionCheck, FailsWhereEveryRunFails) {
  const auto fault = [](const std::map<int, std::string>& programs) -> std::string {
    const MotionCheck check = Checked(programs, {45});
    EXPECT_FALSE(check.cut_short.empty());
    if (!check.has_errors()) return "";
    const Diagnostic& last = check.findings.back();
    return CodeText(last.code) + " " + std::to_string(last.program) + "/" +
           std::to_string(last.step) + " line " + std::to_string(last.where.line);
  };
  EXPECT_EQ(fault({{45, "COORD ABSOL\nVR[1] = 5.\nVR[2] = VR[1] / (VR[1] - 5.)\n"}}),
            "OPT-E7201 45/3 line 3");
  EXPECT_EQ(fault({{45, "COORD ROBOT\nPATH LIN\nMOVE (1000.,900.,-400.,0.,0.)\n"}}),
            "OPT-E7302 45/3 line 3");
  EXPECT_EQ(fault({{45, "CALL 44\n"}, {44, "VI[1] = 0\nVR[2] = 1. / VI[1]\n"}}),
            "OPT-E7201 44/2 line 2");
  // OPT-2.08, OPT-7.12: a program starts with the COORD of the machine.
  EXPECT_EQ(fault({{45, "PATH LIN\nMOVE (1000.,900.,-400.,0.,0.)\n"}}), "OPT-E7302 45/2 line 2");
  EXPECT_EQ(fault({{45,
                    "PATH HOLE (25.1)\nMOVE (1200.,1120.,-350.,0.,0.) / VIA "
                    "(1200.,1120.,-150.,0.,0.)\n"}}),
            "OPT-E7302 45/2 line 2");
  // What nothing of the run has set may be another time otherwise: variables, inputs, the
  // parameters of a FUNCTION; and a program may be there another time.
  for (const char* unsure : {"VR[2] = 1. / VR[1]\n", "VR[2] = 1. / VI[1]\n", "VR[2] = 1. / IA[5]\n",
                             "IF VL[1] THEN 10\nVR[2] = 1. / 0.\n10 VR[3] = 1.\n",
                             "IF IL[1] THEN 10\nVR[2] = 1. / 0.\n10 VR[3] = 1.\n",
                             "IF IL[96] THEN 10\nVR[2] = 1. / 0.\n10 VR[3] = 1.\n",
                             "IF OL[20] THEN 10\nVR[2] = 1. / 0.\n10 VR[3] = 1.\n",
                             "DEFINE PAR[0] = FLOAT\nVR[2] = 1. / PAR[0]\n",
                             "IF IL[1] THEN 10\nPATH LIN\nMOVE (1000.,900.,-400.,0.,0.)\n10 "
                             "VR[3] = 1.\n",
                             "CALL 44\n"}) {
    EXPECT_EQ(fault({{45, unsure}}), "") << unsure;
  }
}

// OPT-E.7102, OPT-E.7103: what is missing in the whole memory of a machine is not there; of files
// that were given to a check nobody knows.
TEST(MotionCheck, AMissingProgramIsAnErrorOfAWholeMemory) {
  const auto verdict = [](const std::string& text, MemoryGiven given) {
    auto motion = CheckMotion(*families::FindFamily("optimo"), Memory({{45, text}}), {45}, given);
    CheckedProgram check{.family = families::FindFamily("optimo"),
                         .slot = 45,
                         .translation = {.ok = true},
                         .motion = *std::move(motion)};
    const std::string told = TextOf(JudgeCheck(check));
    return told.substr(0, told.find(' ', told.find("-E")));
  };
  const std::string call = "COORD ABSOL\nSPEED 10\nCALL 77\n";
  EXPECT_EQ(verdict(call, MemoryGiven::kWhole), "BAD; OPT-E7102");
  EXPECT_EQ(verdict(call, MemoryGiven::kInPart), "DOUBTFUL; CELL-E9606");
  EXPECT_EQ(verdict("FUNCTION 44\n", MemoryGiven::kWhole), "BAD; OPT-E7103");
  EXPECT_EQ(verdict("FUNCTION 44\n", MemoryGiven::kInPart), "DOUBTFUL; CELL-E9606");
  // Whether it is called at all hangs on an input.
  EXPECT_EQ(verdict("IF IL[5] THEN 10\nCALL 77\n10 SPEED 5\n", MemoryGiven::kWhole),
            "DOUBTFUL; CELL-E9608");
  EXPECT_EQ(verdict("VL[5] = ON\nIF VL[5] THEN 10\nCALL 77\n10 SPEED 5\n", MemoryGiven::kWhole),
            "GOOD");
}

// A failure comes when it comes: behind the two seconds that the program waits before it.
TEST(MotionCheck, AFailureHasItsTime) {
  const MotionCheck check =
      Checked({{45, "COORD ABSOL\nDELAY 2.\nVR[1] = 5.\nVR[2] = VR[1] / (VR[1] - 5.)\n"}}, {45});
  ASSERT_EQ(check.findings.size(), 1U);
  EXPECT_EQ(check.findings[0].step, 4);
  EXPECT_EQ(*check.findings[0].at, std::chrono::seconds(2));
}

// Of two errors of one program the first is told, and none as that of a program that it calls.
TEST(MotionCheck, TheFirstErrorOfAProgramIsItsVerdict) {
  EXPECT_EQ(VerdictOfCheck("SYSDEF\nCOORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\nVR[1] = 5.\n"
                           "VR[2] = VR[1] / (VR[1] - 5.)\n"),
            "BAD; OPT-E7301 X of the target leaves its travel by 400.000 mm @3");
}

// Why a check did not come to the end has an advice that fits.
TEST(MotionCheck, SaysWhatCutItShort) {
  const auto told = [](const std::string& text, const machine::InputScript& inputs = {}) {
    const std::string all = VerdictOfCheck(text, inputs);
    return all.substr(0, all.find(" motion checked"));
  };
  EXPECT_EQ(told("CALL 44\n"), "DOUBTFUL; CELL-E9606");
  EXPECT_EQ(told("WAIT (IL[16])\n"), "DOUBTFUL; CELL-E9607");
  EXPECT_EQ(told("10 SPEED 20\nGOTO 10\n"), "DOUBTFUL; CELL-E9604");
  EXPECT_EQ(VerdictOfCheck("VR[2] = 1. / VR[1]\n"),
            "DOUBTFUL; CELL-E9608 motion checked only up to step 1, line 1: OPT-E7201 division by "
            "zero, if VR[1] is 0");
  // It waits for what it was told will not come, or for what it has set itself: so does every run.
  EXPECT_EQ(
      told("WAIT (IL[16])\n", {{SimTime(0), machine::InputKind::kLogical, 16, 0.0}}).substr(0, 14),
      "BAD; OPT-E7902");
  EXPECT_EQ(told("VL[1] = OFF\nWAIT (VL[1])\n").substr(0, 14), "BAD; OPT-E7902");
}

// RML1-5A.01: a mill cuts off what lies outside; its translation says so already.
TEST(MotionCheck, AMillHasNone) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup setup{machine::Parameters(mill.parameters())};
  setup.programs[1].object = machine::Bytes::Of("PD;PA99999,0;");
  const auto check = CheckMotion(mill, setup, {1});
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->findings.empty());
  EXPECT_TRUE(check->reasons.empty());
  EXPECT_TRUE(check->cut_short.empty());
}

// A family whose translation tells all is not run: nobody says that it halts.
TEST(MotionCheck, WhatIsNotCheckedByRunningIsNotRun) {
  Script script;
  script.Step(1, 1).Halt("STOP").Nothing(1.0);
  for (const bool checked_by_running : {true, false}) {
    const auto check =
        CheckMotion(FakeFamily(script, checked_by_running), FakeFamily::Setup(), {1});
    ASSERT_TRUE(check);
    EXPECT_EQ(check->reasons.size(), checked_by_running ? 1U : 0U);
  }
}

// What a day of a long run ends in the midst of is no halt.
TEST(MotionCheck, ALongRunIsNoHalt) {
  Script script;
  script.Step(1, 1).Nothing(72'000.0).Nothing(72'000.0);
  const auto check = CheckMotion(FakeFamily(script, true), FakeFamily::Setup(), {1});
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->reasons.empty());
  EXPECT_TRUE(check->cut_short.empty());
}

// A run tells more than its motion: the family says which codes are about that, and this one none.
TEST(MotionCheck, TellsWhatIsAboutTheMotionAlone) {
  Script script;
  script.Step(1, 4).Find(ErrorCode::kHoleRadiusZero, "radius is 0").Nothing(1.0);
  const auto check = CheckMotion(FakeFamily(script, true), FakeFamily::Setup(), {1});
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->findings.empty());
}

}  // namespace
}  // namespace rmlcell::simulation
