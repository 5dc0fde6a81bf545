// What is not known any more where a GOSUB may come at any time: what it changes, and nothing else.
#include <gtest/gtest.h>

#include <cstdint>

#include "engine/optimo/language/flow_state.h"

namespace rmlcell::optimo::timed_effects {
namespace {

// Of two states that differ in one thing alone.
template <class Field>
void ExpectForgotten(Field FlowState::*field, const Field& mine, const Field& others) {
  FlowState state = FlowState::AtStart();
  state.*field = mine;
  FlowState other = state, wanted = state;
  other.*field = others;
  wanted.*field = FlowState::Unknown().*field;
  FlowState same = state;
  same.ForgetDifferences(state);
  EXPECT_TRUE(same == state);
  state.ForgetDifferences(other);
  EXPECT_TRUE(state == wanted);
}

// OPT-B.59
TEST(TimedEffects, WhatDiffersIsForgotten) {
  using Gas = Choice<Output>;
  using Tiny = Choice<TinyMoves>;
  using Target = Single<motion::ProgramPoint>;
  Modes straight = Modes::AtStart();
  straight.SetPath(PathType::kLin);
  ExpectForgotten(&FlowState::modes, Modes::AtStart(), straight);
  ExpectForgotten(&FlowState::beam, Choice<BeamThere>::Of(BeamThere::kOff),
                  Choice<BeamThere>::Of(BeamThere::kOn));
  ExpectForgotten(&FlowState::gas_2, Gas::Of(Output::kOff), Gas::Of(Output::kOn));
  ExpectForgotten(&FlowState::gas_3, Gas::Of(Output::kOn), Gas::Of(Output::kOff));
  ExpectForgotten(&FlowState::sensor, Choice<Sensor>::Of(Sensor::kOn),
                  Choice<Sensor>::Of(Sensor::kOff));
  ExpectForgotten(&FlowState::turned, Choice<Turned>::Of(Turned::kNo),
                  Choice<Turned>::Of(Turned::kUnknown));
  ExpectForgotten(&FlowState::tiny_moves, Tiny::Of(TinyMoves::kTwo), Tiny::Of(TinyMoves::kNone));
  ExpectForgotten(&FlowState::speed, Single<float>(70.0F), Single<float>(5.0F));
  ExpectForgotten(&FlowState::short_fly, Single<std::uint32_t>(3U), Single<std::uint32_t>());
  const auto place = motion::ProgramPoint::FromOrigin(motion::ProgramVector(1.0, 2.0, 3.0));
  ExpectForgotten(&FlowState::target, Target(place), Target());
}

// OPT-3.09, OPT-3.34: what may be ON and what may be OFF say one thing together, and so do the
// WORKDEFs.
TEST(TimedEffects, ProcessesAreForgottenTogether) {
  using Processes = Facts<ProcessSet> FlowState::*;
  const auto expect = [](Processes differs, Processes one, Processes two) {
    FlowState state = FlowState::AtStart();
    FlowState other = state, wanted = state;
    (other.*differs).made ^= 1U;
    wanted.*one = FlowState::Unknown().*one;
    wanted.*two = FlowState::Unknown().*two;
    state.ForgetDifferences(other);
    EXPECT_TRUE(state == wanted);
  };
  expect(&FlowState::on, &FlowState::on, &FlowState::off);
  expect(&FlowState::off, &FlowState::on, &FlowState::off);
  expect(&FlowState::defined, &FlowState::defined, &FlowState::undefined);
  expect(&FlowState::undefined, &FlowState::defined, &FlowState::undefined);
}

// OPT-B.59, OPT-1.17: what arms a TIMER may have come; what sets a variable need not have.
TEST(TimedEffects, TimersAndVariablesAreThoseOfBoth) {
  FlowState state = FlowState::AtStart(), other = state;
  other.timer = Choice<Armed>::Of(Armed::kYes);
  other.unset.made.reset(5);
  state.unset.made.reset(6);
  state.ForgetDifferences(other);
  EXPECT_TRUE(state.timer.MayBe(Armed::kYes));
  EXPECT_TRUE(state.timer.MayBe(Armed::kNo));
  EXPECT_FALSE(state.unset.made.test(5));
  EXPECT_FALSE(state.unset.made.test(6));
  EXPECT_TRUE(state.unset.made.test(7));
}

}  // namespace
}  // namespace rmlcell::optimo::timed_effects
