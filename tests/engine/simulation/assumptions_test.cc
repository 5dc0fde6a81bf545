// What a check says that it went by, where nobody told it.
#include "engine/simulation/run/assumptions.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell::simulation {
namespace {

std::string AssumedText(const Assumptions& assumptions) { return assumptions.Text(); }

// The first one with its value, the others by their number, each once.
TEST(Assumptions, TheFirstIsToldAndTheOthersAreCounted) {
  const machine::InputScript nothing;
  Assumptions assumptions(nothing);
  EXPECT_EQ(AssumedText(assumptions), "");
  assumptions.Add({.group = "VR", .index = 86, .value = 2.5});
  EXPECT_EQ(AssumedText(assumptions), ", if VR[86] is 2.5");
  assumptions.Add({.group = "VR", .index = 86, .value = 2.5});
  EXPECT_EQ(AssumedText(assumptions), ", if VR[86] is 2.5");
  assumptions.Add({.group = "VI", .index = 86});
  EXPECT_EQ(AssumedText(assumptions), ", if VR[86] is 2.5 (and 1 more is as it was)");
  assumptions.Add({.group = "VR", .index = 87});
  EXPECT_EQ(AssumedText(assumptions), ", if VR[86] is 2.5 (and 2 more are as they were)");
}

TEST(Assumptions, ATruthIsOnOrOff) {
  const auto told = [](double value) {
    const machine::InputScript nothing;
    Assumptions assumptions(nothing);
    assumptions.Add({.group = "OL", .index = 3, .value = value, .on_off = true});
    return AssumedText(assumptions);
  };
  EXPECT_EQ(told(1.0), ", if OL[3] is ON");
  EXPECT_EQ(told(0.0), ", if OL[3] is OFF");
}

// A script of inputs tells the input that it sets: none of another number, and none of another kind
// with the same number.
TEST(Assumptions, WhatAScriptSetsIsTold) {
  using machine::InputKind;
  const machine::InputScript script = {{.kind = InputKind::kLogical, .index = 5, .value = 1.0}};
  Assumptions assumptions(script);
  assumptions.Add({.group = "IL", .index = 5, .on_off = true, .input = InputKind::kLogical});
  EXPECT_EQ(AssumedText(assumptions), "");
  assumptions.Add({.group = "IL", .index = 6, .on_off = true, .input = InputKind::kLogical});
  EXPECT_EQ(AssumedText(assumptions), ", if IL[6] is OFF");
  assumptions.Add({.group = "IA", .index = 5, .input = InputKind::kAnalogue});
  EXPECT_EQ(AssumedText(assumptions), ", if IL[6] is OFF (and 1 more is as it was)");
  assumptions.Add({.group = "VL", .index = 5, .on_off = true});
  EXPECT_EQ(AssumedText(assumptions), ", if IL[6] is OFF (and 2 more are as they were)");
}

}  // namespace
}  // namespace rmlcell::simulation
