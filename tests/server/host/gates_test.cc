// Gates over the line of a host (live.md 2.11): what a gate begins is a run like any other.
#include <utility>

#include "engine/machine/program_file.h"
#include "proto/recording/replay.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class GatesOverTheLine : public HostMachineTest {
 protected:
  void MakeOptimo(bool cut_off = false) {
    const machine::MachineFamily& family = *families::FindFamily("optimo");
    const auto parameters =
        machine::MakeParameters(family, std::string(family.info().default_profile), {});
    ASSERT_TRUE(parameters);
    machine::Translation made = family.Translate({.name = "a.S", .bytes = "DELAY 2\nVI[3]=7\n"},
                                                 *parameters, {.advice = false});
    ASSERT_TRUE(made.ok);
    machine::MachineMemory memory;
    memory.programs[45] = {.name = "a",
                           .object = machine::Bytes::Of(machine::ObjectOf(std::move(made), ""))};
    auto host = HostMachine::Make({.name = "machines/optimo-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = &family,
                                   .memory = std::move(memory),
                                   .cut_off = cut_off},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(host) << host.error().detail;
    host_ = *std::move(host);
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    v1::HostOrder order;
    order.mutable_gates()->set_control_token(token_);
    order.mutable_gates()->add_gate_programs(0);
    order.mutable_gates()->add_gate_programs(45);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  v1::HostOrder Gate(int gate) {
    v1::HostOrder order;
    order.mutable_inputs()->set_control_token(token_);
    order.mutable_inputs()->add_inputs()->set_gate(gate);
    return order;
  }
};

// LIVE-2.11, LIVE-3.40: told as a run of its own, from its begin, marked at once, and played again.
TEST_F(GatesOverTheLine, AGateBeginsARun) {
  MakeOptimo();
  Pass(30s, 100ms);
  static_cast<void>(host_->TakeEntries(now_, true));
  EXPECT_EQ(Do(Gate(1)).refusal().code(), "CELL-E9423");
  v1::HostOrder both = Gate(2);
  both.mutable_inputs()->add_inputs()->set_gate(1);
  EXPECT_EQ(Do(both).refusal().code(), "CELL-E9003");  // or one of them had acted
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const v1::HostOrderAnswer begun = Do(Gate(2));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(begun.status().run().source(), v1::START_SOURCE_GATE_2);
  bool marked = false;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_))
    marked = marked || (entry.has_mark() && !entry.mark().clean());
  EXPECT_TRUE(marked);
  Pass(5s, 100ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  static_cast<void>(host_->TakeEntries(now_, true));
  v1::HostOrder order;
  order.mutable_recording();
  const auto recording = recording::ReadFile(Do(order).recording().chunk());
  ASSERT_TRUE(recording) << recording.error().detail;
  const auto played = recording::Replay(*recording, {});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference) << played->difference->field;
  EXPECT_EQ(played->inputs, 1);
}

// LIVE-2.05, LIVE-2.10: a machine that waits for an inspection is started by no gate.
TEST_F(GatesOverTheLine, NoGateStartsAMachineThatWaitsForAnInspection) {
  MakeOptimo(true);
  ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_EQ(Do(Gate(2)).refusal().code(), "CELL-E9409");
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
}

}  // namespace
}  // namespace rmlcell::server
