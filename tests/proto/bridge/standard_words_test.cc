// A machine in the words of standards (live.md 2.14, 2.15).
#include "proto/bridge/standard_words.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace rmlcell::bridge {
namespace {

struct Row {
  v1::MachineState state;
  const char* execution;
  const char* item_state;
  const char* device_state;
};

constexpr Row kRows[] = {
    {v1::MACHINE_STATE_OFF, "STOPPED", "NotAvailable", "OFFLINE"},
    {v1::MACHINE_STATE_STARTING, "UNAVAILABLE", "NotAvailable", "OFFLINE"},
    {v1::MACHINE_STATE_RECOVERING, "UNAVAILABLE", "NotAvailable", "OFFLINE"},
    {v1::MACHINE_STATE_NOT_ZEROED, "READY", "NotExecuting", "IDLE"},
    {v1::MACHINE_STATE_IDLE, "READY", "NotExecuting", "IDLE"},
    {v1::MACHINE_STATE_JOGGING, "ACTIVE", "Executing", "IDLE"},
    {v1::MACHINE_STATE_RUNNING, "ACTIVE", "Executing", "SENDING"},
    {v1::MACHINE_STATE_STOPPING, "FEED_HOLD", "Executing", "HOLDING"},
    {v1::MACHINE_STATE_HELD, "FEED_HOLD", "NotExecuting", "HELD"},
    {v1::MACHINE_STATE_ALARM, "STOPPED", "OutOfService", "ALARM"},
    {v1::MACHINE_STATE_INSPECT, "STOPPED", "OutOfService", "INSPECT"},
    {v1::MACHINE_STATE_LOST, "UNAVAILABLE", "NotAvailable", "OFFLINE"},
};

// LIVE-2.14, LIVE-2.15: of every state there is.
TEST(StandardWords, OfEachState) {
  std::set<int> states;
  for (const Row& row : kRows) {
    v1::MachineStatus status;
    status.set_state(row.state);
    const v1::StandardWords words = StandardWordsOf(status);
    EXPECT_EQ(words.execution(), row.execution) << row.state;
    EXPECT_EQ(words.item_state(), row.item_state) << row.state;
    EXPECT_EQ(words.device_state(), row.device_state) << row.state;
    states.insert(row.state);
  }
  for (int state = 1; v1::MachineState_IsValid(state); ++state) EXPECT_TRUE(states.contains(state));
}

// LIVE-2.14: what a held run is depends on who held it, a running one on whether it waits.
TEST(StandardWords, OfRuns) {
  v1::MachineStatus status;
  status.set_state(v1::MACHINE_STATE_HELD);
  const auto held = [&](v1::HoldReason reason) {
    status.set_hold_reason(reason);
    return StandardWordsOf(status).execution();
  };
  for (const auto reason : {v1::HOLD_REASON_HOLD, v1::HOLD_REASON_STOP, v1::HOLD_REASON_DOOR})
    EXPECT_EQ(held(reason), "FEED_HOLD");
  for (const auto reason : {v1::HOLD_REASON_PROGRAM, v1::HOLD_REASON_BREAKPOINT,
                            v1::HOLD_REASON_SINGLE, v1::HOLD_REASON_ENTRY})
    EXPECT_EQ(held(reason), "PROGRAM_STOPPED");
  for (const auto reason : {v1::HOLD_REASON_CONTROL, v1::HOLD_REASON_MACHINE_LEASE,
                            v1::HOLD_REASON_SERVER_LOST, v1::HOLD_REASON_LATE})
    EXPECT_EQ(held(reason), "INTERRUPTED");
  status.set_state(v1::MACHINE_STATE_RUNNING);
  status.mutable_run()->set_instruction("WAIT");
  EXPECT_EQ(StandardWordsOf(status).execution(), "WAIT");
  status.mutable_run()->set_phase(v1::RUN_PHASE_DRAINING);
  EXPECT_EQ(StandardWordsOf(status).device_state(), "DRAINING");
  status.set_state(v1::MACHINE_STATE_STOPPING);
  status.set_hold_reason(v1::HOLD_REASON_ABORT);
  EXPECT_EQ(StandardWordsOf(status).device_state(), "ENDING");
  status.set_state(v1::MACHINE_STATE_IDLE);
  status.mutable_armed_until()->set_seconds(5);
  EXPECT_EQ(StandardWordsOf(status).device_state(), "ARMED");
}

// LIVE-2.14: nothing moves, and nothing is held.
TEST(StandardWords, WhoIsAtRest) {
  const std::set<int> at_rest = {v1::MACHINE_STATE_OFF, v1::MACHINE_STATE_NOT_ZEROED,
                                 v1::MACHINE_STATE_IDLE, v1::MACHINE_STATE_ALARM,
                                 v1::MACHINE_STATE_INSPECT};
  for (const Row& row : kRows)
    EXPECT_EQ(IsAtRest(row.state), at_rest.contains(row.state)) << row.state;
}

// LIVE-2.14: the operating modes.
TEST(StandardWords, OfModes) {
  v1::MachineStatus status;
  const auto words = [&](v1::OperatingMode mode) {
    status.set_mode(mode);
    const v1::StandardWords made = StandardWordsOf(status);
    return made.controller_mode() + " " + made.operation_mode();
  };
  EXPECT_EQ(words(v1::OPERATING_MODE_MANUAL), "MANUAL Setup");
  EXPECT_EQ(words(v1::OPERATING_MODE_SINGLE), "SEMI_AUTOMATIC Setup");
  EXPECT_EQ(words(v1::OPERATING_MODE_CYCLE), "AUTOMATIC Processing");
  EXPECT_EQ(words(v1::OPERATING_MODE_REPEAT), "AUTOMATIC Processing");
  EXPECT_EQ(words(v1::OPERATING_MODE_REMOTE), "AUTOMATIC Processing");
}

}  // namespace
}  // namespace rmlcell::bridge
