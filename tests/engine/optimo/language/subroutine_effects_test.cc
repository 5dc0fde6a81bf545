#include "engine/optimo/language/subroutine_effects.h"

#include <gtest/gtest.h>

#include <string>

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

// OPT-7.20
TEST(SubroutineEffects, KnowWhoNeverReturns) {
  const Followed program("GOSUB 10\nGOSUB 20\nENDTASK\n10 GOTO 10\n20 GOSUB 10\nRETURN\n");
  EXPECT_EQ(program.At(10), nullptr);
  EXPECT_EQ(program.At(20), nullptr);
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
