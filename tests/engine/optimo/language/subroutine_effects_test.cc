#include "engine/optimo/language/subroutine_effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// A program and what its subroutines do.
struct Followed {
  explicit Followed(const std::string& text)
      : module(MustCompile(text).module),
        graph(module),
        dwells(module),
        faulty(module.instructions.size()),
        effects(module, graph, dwells, faulty) {}

  const FlowState* At(int label) const { return effects.Of(*ModuleIndex(module).FindLabel(label)); }
  // What is known at the start of a program, and then the subroutine.
  FlowState Behind(int label) const {
    FlowState state = FlowState::AtStart();
    state.Then(*At(label));
    return state;
  }

  Module module;
  FlowGraph graph;
  Dwells dwells;
  std::vector<bool> faulty;
  SubroutineEffects effects;
};

// OPT-7.20, OPT-3.36: what a subroutine does not touch is as before, on all of its paths.
TEST(SubroutineEffects, KeepWhatTheyDoNotTouch) {
  const Followed program(
      "GOSUB 10\nENDTASK\n10 IF VL[1] THEN 11\nWORK 1,3/OFF\n11 OL[8] = ON\nRETURN\n");
  const FlowState state = program.Behind(10);
  EXPECT_EQ(state.speed.known(), 70.0F);  // OPT-2.10
  EXPECT_TRUE(state.modes.IsDefaultPath());
  EXPECT_TRUE(state.gas_2.Is(Output::kOn));
  EXPECT_TRUE(state.gas_3.Is(Output::kOff));
  EXPECT_TRUE(state.KnowsProcesses());
  EXPECT_EQ(state.on.made, 0U);
}

// OPT-7.20, OPT-7.21: subroutines inside each other, and around in a ring.
TEST(SubroutineEffects, GoThroughOtherSubroutines) {
  const Followed program(
      "GOSUB 10\nENDTASK\n10 SPEED 5\nGOSUB 20\nRETURN\n20 IF VL[1] THEN 21\nGOSUB 10\n21 OL[9] = "
      "ON\nRETURN\n");
  const FlowState state = program.Behind(10);
  EXPECT_EQ(state.speed.known(), 5.0F);
  EXPECT_TRUE(state.gas_3.Is(Output::kOn));
  EXPECT_FALSE(program.Behind(20).speed.known());  // 70, or 5 by way of 10
}

// OPT-2.54: the time of a /TIME in a subroutine may run out or not; what it calls and never comes
// back changes nothing behind it.
TEST(SubroutineEffects, TheTimeOfAMoveMayRunOut) {
  const auto speed_behind = [](const std::string& called) {
    const Followed program("GOSUB 10\nENDTASK\n10 MOVE (1.,2.,3.,0.,0.)/TIME (2.,20)\nRETURN\n20 " +
                           called);
    return program.Behind(10).speed.known();
  };
  EXPECT_FALSE(speed_behind("SPEED 5\nRETURN\n"));  // 70, or 5
  EXPECT_EQ(speed_behind("SPEED 70\nRETURN\n"), 70.0F);
  EXPECT_EQ(speed_behind("SPEED 5\n30 GOTO 30\n"), 70.0F);
}

// OPT-7.20, OPT-2.54: behind the RETURN of what it calls a subroutine goes on.
TEST(SubroutineEffects, GoOnBehindWhatTheyCall) {
  const std::string rest = "SPEED 5\nRETURN\n20 OL[9]=ON\nRETURN\n";
  const Followed calls("GOSUB 10\nENDTASK\n10 GOSUB 20\n" + rest);
  EXPECT_EQ(calls.Behind(10).speed.known(), 5.0F);
  EXPECT_TRUE(calls.Behind(10).gas_3.Is(Output::kOn));
  const Followed timed("GOSUB 10\nENDTASK\n10 MOVE (1.,2.,3.,0.,0.)/TIME (2.,20)\n" + rest);
  EXPECT_EQ(timed.Behind(10).speed.known(), 5.0F);
  EXPECT_TRUE(timed.Behind(10).gas_3.MayBe(Output::kOn));
  EXPECT_TRUE(timed.Behind(10).gas_3.MayBe(Output::kOff));
}

// The findings of a program, each with the statement that it is about. What is told of a variable
// once is told at the first of several statements in the text: only that it is told. How far moves
// go is left out: it is known better or worse from one to the next.
std::vector<std::string> ToldOf(const std::string& text) {
  std::vector<std::string> told;
  for (const Diagnostic& d : Compile(text, "", {}).diagnostics) {
    if (d.code == ErrorCode::kNoMotion || d.code == ErrorCode::kShortFly) continue;
    const std::size_t begin = text.rfind('\n', static_cast<std::size_t>(d.where.byte_offset)) + 1;
    const std::string line = text.substr(begin, text.find('\n', begin) - begin);
    told.push_back(CodeText(d.code) + " " + (d.rule == "OPT-1.17" ? "" : line) + " " + d.rule);
  }
  std::ranges::sort(told);
  return told;
}

// OPT-7.20, OPT-3.36: whether the statements stand in a subroutine or in its place, the same is
// told.
TEST(SubroutineEffects, AreThoseOfTheStatementsInTheirPlace) {
  const std::vector<std::string> statements = {"COORD ABSOL",
                                               "COORD ROBOT",
                                               "PATH LIN",
                                               "PATH PTP",
                                               "PATH CIR",
                                               "SPEED 5",
                                               "SPEED 12",
                                               "SPEED 30",
                                               "SPEED 90",
                                               "SPEED 0",
                                               "SPEED VR[26]",
                                               "DELAY 1",
                                               "DELAY 0",
                                               "WAIT IL[20]",
                                               "OL[8]=ON",
                                               "OL[8]=OFF",
                                               "OL[9]=ON",
                                               "OL[9]=OFF",
                                               "OL[11]=ON",
                                               "OL[11]=OFF",
                                               "ASSIGN OL[8]=2 /2",
                                               "WORK 0,0/ON",
                                               "WORK 0,0/OFF",
                                               "WORK 1,1/ON",
                                               "WORK 1,1/OFF",
                                               "WORK 2,5/ON",
                                               "WORK 2,5/OFF",
                                               "WORKDEF 1,1 (8.,75.,1.,50.)",
                                               "WORKDEF 2,5 (15)",
                                               "CALL 2",
                                               "FUNCTION 44",
                                               "MOVE (10.,2.,3.,0.,0.)",
                                               "MOVE (10.5,2.,3.,0.,0.)/FLY",
                                               "MOVE (90.,2.,3.,0.,0.)/FLY",
                                               "MOVE (20.,2.,3.,0.,0.)/VIA (29.,2.,9.,0.,0.)",
                                               "PATH HOLE (5.)",
                                               "SYSDEF",
                                               "SYSDEF (1.,0.,0.,0.,0.,1.)",
                                               "TCP (0,0,6/0,0,1)",
                                               "ZERO",
                                               "VR[1]=5.",
                                               "VR[2]=VR[1]",
                                               "VI[2]=VI[3]",
                                               "TIMER /DIS"};
  std::mt19937 random(7);
  const auto lines = [&](std::uint32_t most) {
    std::string text;
    for (std::uint32_t n = 1 + static_cast<std::uint32_t>(random()) % most; n > 0; --n)
      text += statements[random() % statements.size()] + "\n";
    return text;
  };
  std::size_t told = 0;
  for (int round = 0; round < 1500; ++round) {
    const std::string before = "COORD ABSOL\nPATH LIN\n" + lines(4), body = lines(3),
                      behind = lines(4);
    const std::vector<std::string> in_place =
        ToldOf(before + "OL[16]=ON\n" + body + "OL[16]=ON\n" + behind + "ENDTASK\n");
    const std::vector<std::string> called =
        ToldOf(before + "GOSUB 100\n" + behind + "ENDTASK\n100 OL[16]=ON\n" + body + "RETURN\n");
    ASSERT_EQ(called, in_place) << before << "-- body\n" << body << "-- behind\n" << behind;
    told += in_place.size();
  }
  EXPECT_GT(told, 2000U);  // more than one a round
}

// OPT-7.20
TEST(SubroutineEffects, KnowWhoNeverReturns) {
  const Followed program("GOSUB 10\nGOSUB 20\nENDTASK\n10 GOTO 10\n20 GOSUB 10\nRETURN\n");
  EXPECT_EQ(program.At(10), nullptr);
  EXPECT_EQ(program.At(20), nullptr);
}

// What stands outside of all subroutines is not looked at for them, however much that is.
TEST(SubroutineEffects, OnlySubroutinesAreLookedAt) {
  const auto work = [](int outside) {
    std::string text;
    for (int n = 0; n < outside; ++n) text += "SPEED 5\n";
    const Followed program(text + "GOSUB 10\n" + text + "GOSUB 10\nENDTASK\n10 RETURN\n");
    EXPECT_NE(program.At(10), nullptr);
    return program.effects.work();
  };
  EXPECT_EQ(work(0), 1U);
  EXPECT_EQ(work(500), 1U);
}

// OPT-7.21: chains of GOSUBs are followed in one go, whichever way they lead, and also where each
// subroutine runs on into the next.
TEST(SubroutineEffects, WorkIsLinear) {
  const auto work = [](int count, bool upwards, bool runs_on) {
    std::string text = "GOSUB " + std::to_string(upwards ? 0 : count - 1) + "\nENDTASK\n";
    for (int s = 0; s < count; ++s) {
      const int called = upwards ? s + 1 : s - 1;
      text += std::to_string(s) +
              (called < 0 || called >= count ? " SPEED 5" : " GOSUB " + std::to_string(called)) +
              (runs_on ? "\n" : "\nRETURN\n");
    }
    return Followed(text + "RETURN\n").effects.work();
  };
  for (const bool upwards : {false, true}) {
    for (const bool runs_on : {false, true}) {
      if (!upwards && runs_on) continue;  // rings
      EXPECT_LE(work(4000, upwards, runs_on), 4 * work(1000, upwards, runs_on) + 100);
      EXPECT_LE(work(4000, upwards, runs_on), 6U * 4000U);
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
