// A start at a step over the line of a host (live.md 6): preview, token, start.
#include <utility>

#include "proto/recording/replay.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class StartAtTest : public HostMachineTest {
 protected:
  // As the process of a host does it, but on this thread.
  v1::HostOrderAnswer Preview(int step, int program = 5) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(program);
    order.mutable_preview_start()->mutable_step()->set_step(step);
    auto task = host_->PreparePreview(order, now_);
    if (!task) {
      v1::HostOrderAnswer refused;
      refused.mutable_refusal()->set_code(CodeText(task.error().code));
      return refused;
    }
    Result<machine::StartPreview> made = task->run(task->start, {});
    return host_->Previewed(order, *std::move(task), std::move(made), now_);
  }
  v1::HostOrder StartAt(const std::string& token, bool halt = false) {
    v1::HostOrder order;
    v1::StartAtStepRequest& start = *order.mutable_start_at_step();
    start.set_control_token(token_);
    start.set_preview_token(token);
    start.set_request_id("start " + token);
    start.add_confirmations(v1::CONFIRMATION_CLAMPS);
    start.add_confirmations(v1::CONFIRMATION_TOOL);
    start.add_confirmations(v1::CONFIRMATION_ORIGIN_VALID);
    if (halt) start.set_halt_at_entry(true);
    return order;
  }
  void Until(v1::MachineState state) {
    for (int i = 0; i < 4000 && State() != state; ++i) Pass(100ms, 50ms);
    ASSERT_EQ(State(), state);
  }
};

// LIVE-6.02, LIVE-6.03, LIVE-6.05: what is there, what is different, how it goes there.
TEST_F(StartAtTest, APreviewSaysWhatItWouldDo) {
  MakeAndTake();
  const v1::HostOrderAnswer answer = Preview(8);  // the third corner of the square
  ASSERT_TRUE(answer.has_preview()) << answer.refusal().message();
  const v1::PreviewStartResponse& preview = answer.preview();
  EXPECT_NE(preview.preview_token(), "");
  EXPECT_THAT(preview.refusals(), IsEmpty());
  EXPECT_GT(preview.run_time_ns(), 0);
  EXPECT_EQ(preview.there().fence(), 7);
  EXPECT_FALSE(preview.there().values().empty());
  const auto row = [&](const std::string& item) {
    for (const v1::StartDifference& one : preview.differences()) {
      if (one.item() == item) return one;
    }
    return v1::StartDifference();
  };
  EXPECT_EQ(row("VS").there(), "1");
  EXPECT_EQ(row("VS").action(), v1::START_ACTION_SET);
  EXPECT_EQ(row("pose").action(), v1::START_ACTION_MOVE);
  EXPECT_EQ(row("tool").action(), v1::START_ACTION_ASK);
  EXPECT_EQ(row("tool").confirmation(), v1::CONFIRMATION_TOOL);
  ASSERT_FALSE(preview.approach().empty());
  EXPECT_EQ(preview.approach(0).path(), "PU");
  // Nothing of it is done.
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-6.04: nothing is previewed that could not begin.
TEST_F(StartAtTest, ARunThatIsOpenHasNoPreview) {
  MakeAndTake();
  Do(Start());
  Pass(1s);
  EXPECT_EQ(Preview(8).refusal().code(), "CELL-E9421");
  Do(Stop());
  Until(v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Preview(8).refusal().code(), "CELL-E9421");
}

// LIVE-6.09, LIVE-3.40: the approach is a phase of the run; it halts before the step, goes on,
// ends, and comes out the same when it is played again.
TEST_F(StartAtTest, ItBeginsWhereItWasAsked) {
  MakeAndTake();
  const std::string token = Preview(8).preview().preview_token();
  const v1::HostOrderAnswer begun = Do(StartAt(token, true));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(begun.status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(begun.status().run().phase(), v1::RUN_PHASE_APPROACH);
  Until(v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_ENTRY);
  EXPECT_EQ(host_->StatusAt(now_).run().phase(), v1::RUN_PHASE_PROGRAM);
  EXPECT_EQ(host_->StatusAt(now_).run().place().step(), 8);  // where a crash would leave it
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true))  // nor of what is to come
    EXPECT_LE(entry.virtual_time_ns(), host_->StatusAt(now_).virtual_time_ns());
  Do(Resume());
  Until(v1::MACHINE_STATE_IDLE);
  static_cast<void>(host_->TakeEntries(now_, true));
  v1::HostOrder order;
  order.mutable_recording();
  const auto recording = recording::ReadFile(Do(order).recording().chunk());
  ASSERT_TRUE(recording) << recording.error().detail;
  const auto played = recording::Replay(*recording, {});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference)
      << played->difference->field << ": " << played->difference->recorded << " is "
      << played->difference->played;
  EXPECT_EQ(played->inputs, 2);  // the start, RESUME
}

// LIVE-6.08: a preview that is old, or of another machine state or memory, starts nothing.
TEST_F(StartAtTest, AStalePreviewStartsNothing) {
  MakeAndTake();
  const auto refused = [&](const std::string& token) { return Do(StartAt(token)).refusal(); };
  EXPECT_EQ(refused("").code(), "CELL-E9428");
  const std::string first = Preview(8).preview().preview_token();
  const std::string second = Preview(9).preview().preview_token();
  EXPECT_THAT(refused(first).message(), HasSubstr("newest"));
  v1::HostMemory memory;
  v1::AssignedProgram& stored = *memory.add_programs();
  stored.set_slot(6);
  stored.set_content("PU0,0;");
  host_->Change(memory, now_);
  EXPECT_THAT(refused(second).message(), HasSubstr("programs were changed"));
  const std::string third = Preview(8).preview().preview_token();
  Pass(1s);  // time alone changes nothing
  v1::HostOrder door;
  door.mutable_inputs()->add_inputs()->set_door_open(true);
  door.mutable_inputs()->set_control_token(token_);
  Do(door);
  EXPECT_THAT(refused(third).message(), HasSubstr("machine was changed: cover open (was closed)"));
  door.mutable_inputs()->mutable_inputs(0)->set_door_open(false);
  Do(door);
  const std::string fourth = Preview(8).preview().preview_token();
  Pass(120s, 1s);
  Control();
  EXPECT_THAT(refused(fourth).message(), HasSubstr("120 s"));
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-6.08: where it would halt, and how far it would run dry, is of what was looked at.
TEST_F(StartAtTest, APreviewIsOfWhatWasArmedToo) {
  MakeAndTake();
  const auto why = [&](const std::string& token) { return Do(StartAt(token)).refusal().message(); };
  const std::string first = Preview(8).preview().preview_token();
  ASSERT_NE(first, "");
  v1::HostOrder halt;
  halt.mutable_breakpoints()->set_control_token(token_);
  auto& at = *halt.mutable_breakpoints()->add_breakpoints()->mutable_step();
  at.set_program(5);
  at.set_step(7);
  ASSERT_FALSE(Do(halt).has_refusal());
  EXPECT_THAT(why(first), HasSubstr("machine was changed: BREAK 5/7 set (was none)"));
  halt.mutable_breakpoints()->clear_breakpoints();
  ASSERT_FALSE(Do(halt).has_refusal());
  const std::string second = Preview(8).preview().preview_token();
  ASSERT_NE(second, "");
  v1::HostOrder dry;
  dry.mutable_simulation()->set_control_token(token_);  // without a step it ends what was armed
  ASSERT_FALSE(Do(dry).has_refusal());
  EXPECT_THAT(why(second), HasSubstr("machine was changed: SIMUL 0/0 (was none)"));
}

// LIVE-6.03, LIVE-6.08: what a person must see to is asked for by name.
TEST_F(StartAtTest, WhatNobodyHasSeenToIsAskedFor) {
  MakeAndTake();
  v1::HostOrder order = StartAt(Preview(8).preview().preview_token());
  order.mutable_start_at_step()->clear_confirmations();
  const v1::HostOrderAnswer answer = Do(order);
  EXPECT_EQ(answer.refusal().code(), "CELL-E9421");
  EXPECT_THAT(answer.refusal().message(), HasSubstr("tool"));
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);  // nothing was cut off here
}

// LIVE-6.01, LIVE-6.04.
TEST_F(StartAtTest, StepsThatAreNone) {
  MakeAndTake();
  EXPECT_EQ(Preview(0).refusal().code(), "CELL-E9003");
  const v1::HostOrderAnswer far = Preview(500);
  ASSERT_TRUE(far.has_preview());
  EXPECT_EQ(far.preview().preview_token(), "");
  ASSERT_FALSE(far.preview().refusals().empty());
  EXPECT_EQ(far.preview().refusals(0).code(), "CELL-E9426");
}

// LIVE-6.08: that it stands elsewhere is said by the name that this has for people.
TEST_F(StartAtTest, APreviewIsOfWhereTheMachineStands) {
  MakeAndTake();
  const std::string token = Preview(8).preview().preview_token();
  ASSERT_NE(token, "");
  v1::HostOrder order;
  v1::PressPanelKeyRequest& key = *order.mutable_panel_key();
  key.set_key("X+");
  key.set_action(v1::KEY_ACTION_TAP);
  key.set_control_token(token_);
  key.set_sequence(1);
  ASSERT_FALSE(Do(order).has_refusal());
  Pass(500ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_THAT(Do(StartAt(token)).refusal().message(), HasSubstr("pose X "));
}

// LIVE-3.22: by its own time the run began before its start, by the way to that step; what is told
// of it is told of now.
TEST_F(StartAtTest, NothingIsToldOfThePast) {
  MakeAndTake();
  Pass(20s, 50ms);
  const v1::PreviewStartResponse preview = Preview(8).preview();
  ASSERT_GT(preview.run_time_ns(), 0);
  static_cast<void>(host_->TakeEntries(now_, true));
  ASSERT_FALSE(Do(StartAt(preview.preview_token())).has_refusal());
  int begun = 0;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
    EXPECT_GE(entry.virtual_time_ns(), 20'000'000'000);
    begun += entry.has_run_begun() ? 1 : 0;
  }
  EXPECT_EQ(begun, 1);
}

}  // namespace
}  // namespace rmlcell::server
