// A machine that stands keeps each group of variables and inputs for itself. OPT-7.59, LIVE-9.07
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "engine/machine/standing.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo::testing::standing_groups {
namespace {

class Stands {
 public:
  MachineState State() const { return DecodeMachineState(standing->Save()).value(); }
  // All that holds something under this number: "VR 1.5 OL 1".
  std::string At5() const {
    const MachineState state = State();
    std::string text;
    const auto add = [&text](std::string_view name, double value) {
      if (value != 0.0)
        text += (text.empty() ? "" : " ") + std::string(name) + " " +
                std::to_string(value).substr(0, 3);
    };
    const DataArea& data = state.data;
    add("VR", data.vr[5]);
    add("VI", data.vi[5]);
    add("VL", data.vl[5]);
    add("IL", data.il[5]);
    add("OL", data.ol[5]);
    add("IA", data.ia[5]);
    add("OA", data.oa[5]);
    add("input IL", data.il_physical[5]);
    add("input IA", data.ia_physical[5]);
    add("output OL", state.outputs.logical[5]);
    add("output OA", state.outputs.analogue[5]);
    add("door", state.door_open);
    return text;
  }

  std::unique_ptr<machine::Standing> standing =
      *OptimoFamily().NewStanding(machine::Parameters(OptimoFamily().parameters()), "");
};

TEST(StandingGroups, AVariableIsOfItsGroupAlone) {
  const auto written = [](std::string_view name, double value) {
    Stands one;
    one.standing->WriteVariable(name, value);
    return one.At5();
  };
  EXPECT_EQ(written("VR[5]", 1.5), "VR 1.5");
  EXPECT_EQ(written("VI[5]", 3.0), "VI 3.0");
  EXPECT_EQ(written("VL[5]", 1.0), "VL 1.0");
  EXPECT_EQ(written("OL[5]", 1.0), "OL 1.0 output OL 1.0");
  EXPECT_EQ(written("OA[5]", 2.5), "OA 2.5 output OA 2.5");
  EXPECT_EQ(written("IL[5]", 1.0), "");
}

// What is no variable changes nothing, whatever was written before.
TEST(StandingGroups, WhatIsNoVariableChangesNothing) {
  Stands one;
  one.standing->WriteVariable("VI[5]", 3.0);
  for (const char* name : {"VX[5]", "VI[5", "VI[100]", ""}) one.standing->WriteVariable(name, 7.0);
  EXPECT_EQ(one.At5(), "VI 3.0");
}

TEST(StandingGroups, AnInputIsOfItsKindAlone) {
  using machine::InputKind;
  const auto applied = [](InputKind kind, double value) {
    Stands one;
    one.standing->Apply({.kind = kind, .index = 5, .value = value});
    return one.At5();
  };
  EXPECT_EQ(applied(InputKind::kLogical, 1.0), "input IL 1.0");
  EXPECT_EQ(applied(InputKind::kAnalogue, 2.5), "input IA 2.5");
  EXPECT_EQ(applied(InputKind::kDoor, 1.0), "door 1.0");
  EXPECT_EQ(applied(InputKind::kStart, 1.0), "");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::standing_groups
