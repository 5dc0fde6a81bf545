// What the status of a live machine says beside state and place: who may start it, what is
// selected, what its tool does, what alarms and what lamps there are (live.md 2.01, 3.16).
#include <algorithm>
#include <string>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class ToldStatus : public HostMachineTest {
 protected:
  v1::MachineStatus Status() { return host_->StatusAt(now_); }
  void SetMode(v1::OperatingMode mode) {
    v1::HostOrder order;
    order.mutable_mode()->set_mode(mode);
    order.mutable_mode()->set_control_token(token_);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  void Store(int slot, const std::string& content) {
    v1::HostMemory memory;
    v1::AssignedProgram& program = *memory.add_programs();
    program.set_slot(slot);
    program.set_content(content);
    host_->Change(memory, now_);
  }
  // A program of an Optimo that runs, of which so much time has gone.
  void RunOnOptimo(const std::string& text, std::chrono::milliseconds time) {
    const v1::HostOrderAnswer begun = Do(JobOf(text));
    ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
    Pass(time, 50ms);
  }
  static std::vector<std::string> CodesOf(const v1::MachineStatus& status) {
    std::vector<std::string> codes;
    for (const v1::StartBlocker& one : status.start_blockers()) codes.push_back(one.code());
    return codes;
  }
};

// LIVE-2.11: in REMOTE the console and the queue, in MANUAL nobody, else whoever stands there.
TEST_F(ToldStatus, SaysWhoMayStart) {
  MakeAndTake();
  EXPECT_THAT(Status().start_sources(),
              ElementsAre(v1::START_SOURCE_CONSOLE, v1::START_SOURCE_QUEUE));
  SetMode(v1::OPERATING_MODE_MANUAL);
  EXPECT_THAT(Status().start_sources(), IsEmpty());
  SetMode(v1::OPERATING_MODE_CYCLE);
  EXPECT_THAT(Status().start_sources(), ElementsAre(v1::START_SOURCE_PANEL));
}

// LIVE-9.03, LIVE-2.11: what START takes, which programs are on their way, and those of gates.
TEST_F(ToldStatus, SaysWhichProgramsAreMeant) {
  MakeAndTake();
  EXPECT_EQ(Status().selected_program(), 0);
  EXPECT_THAT(Status().gate_programs(), IsEmpty());  // a mill has no gates
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(1s);
  EXPECT_EQ(Status().selected_program(), 5);
  EXPECT_THAT(Status().run().loaded_programs(), ElementsAre(5));
  MakeAndTakeOptimo();
  EXPECT_THAT(Status().gate_programs(), ElementsAre(0, 0));
  v1::HostOrder gates;
  gates.mutable_gates()->set_control_token(token_);
  for (const int program : {7, 45}) gates.mutable_gates()->add_gate_programs(program);
  ASSERT_FALSE(Do(gates).has_refusal());
  EXPECT_THAT(Status().gate_programs(), ElementsAre(7, 45));
  v1::HostOrder one;
  one.mutable_gates()->set_control_token(token_);
  one.mutable_gates()->add_gate_programs(7);
  EXPECT_EQ(Do(one).refusal().code(), CodeText(ErrorCode::kCellInvalidArgument));
}

// LIVE-3.16: where the tip is as the program counts: 0.5 mm in the work, and 1 mm above it where
// the square ends.
TEST_F(ToldStatus, SaysWhereTheTipIsInTheWork) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(30s, 50ms);
  ASSERT_TRUE(Status().has_work_tip());
  EXPECT_NEAR(Status().work_tip().z(), -0.5, 1e-9);
  Pass(150s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_NEAR(Status().work_tip().x(), 0.0, 1e-9);
  EXPECT_NEAR(Status().work_tip().y(), 0.0, 1e-9);
  EXPECT_NEAR(Status().work_tip().z(), 1.0, 1e-9);
}

// LIVE-3.16: a spindle that turns, and how fast.
TEST_F(ToldStatus, SaysHowFastASpindleTurns) {
  MakeAndTake();
  EXPECT_FALSE(Status().tool().on());
  EXPECT_EQ(Status().tool().speed_rpm(), 0.0);
  EXPECT_THAT(Status().lamps(), ElementsAre("POWER"));
  Store(6, "PA;VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD2000,100;PD2000,2000;");
  ASSERT_FALSE(Do(Start("", 6)).has_refusal());
  Pass(3s, 50ms);
  EXPECT_TRUE(Status().tool().on());
  v1::HostOrder read;
  read.mutable_read_variables()->add_variables("RPM");
  const v1::ReadVariablesResponse values = Do(read).variables();
  EXPECT_GT(Status().tool().speed_rpm(), 0.0);
  EXPECT_EQ(Status().tool().speed_rpm(),
            static_cast<double>(values.variables(0).value().integer()));
  EXPECT_EQ(values.virtual_time_ns(), Status().virtual_time_ns());
  EXPECT_THAT(Status().lamps(), ElementsAre("POWER", "SPINDLE"));
}

// LIVE-3.16: power and schedule of a beam, and the shutter.
TEST_F(ToldStatus, SaysWhatALaserDoes) {
  MakeOptimo();
  v1::HostMemory memory;
  v1::AssignedSchedule& schedule = *memory.add_schedules();
  schedule.set_number(7);
  schedule.set_mode("CW");
  schedule.set_power_percent(60.0);
  memory.set_schedules_changed(true);
  host_->Change(memory, now_);
  RunOnOptimo("WORKDEF 2,1 (7)\nWORK 2,1/ON\nWORKDEF 0,0\nWORK 0,0/ON\nDELAY 5\nWORK 0,0/OFF\n",
              3s);
  const v1::MachineStatus cutting = Status();
  EXPECT_TRUE(cutting.tool().on());
  EXPECT_EQ(cutting.tool().power_percent(), 60.0);
  EXPECT_EQ(cutting.tool().laser_schedule(), 7);
  ASSERT_EQ(cutting.outputs_size(), 1);
  EXPECT_EQ(cutting.outputs(0).name(), "shutter");
  EXPECT_EQ(cutting.tool().speed_rpm(), 0.0);
  EXPECT_THAT(cutting.lamps(), ElementsAre("REMOTE", "ROB"));
}

// LIVE-2.04, LIVE-3.16: which alarm, since when by the time of the machine, and whether it may be
// acknowledged.
TEST_F(ToldStatus, SaysWhetherTheCauseOfAnAlarmIsGone) {
  MakeAndTake();
  Pass(1s);
  v1::HostOrder emergency;
  emergency.mutable_emergency_stop();
  Do(emergency);
  Pass(2s);
  ASSERT_EQ(Status().alarms_size(), 1);
  EXPECT_EQ(Status().alarms(0).id(), 1);
  EXPECT_EQ(Status().alarms(0).virtual_time_ns(), 1'000'000'000);
  EXPECT_EQ(Status().alarms(0).diagnostic().code(), CodeText(ErrorCode::kCellEmergencyStop));
  EXPECT_FALSE(Status().alarms(0).cause_gone());
  v1::HostOrder acknowledge;
  acknowledge.mutable_acknowledge_alarm()->set_control_token(token_);
  acknowledge.mutable_acknowledge_alarm()->set_alarm_id(1);
  EXPECT_EQ(Do(acknowledge).refusal().code(), CodeText(ErrorCode::kCellMachineState));
  v1::HostOrder release;
  release.mutable_inputs()->set_control_token(token_);
  release.mutable_inputs()->add_inputs()->set_emergency_stop_released(true);
  ASSERT_FALSE(Do(release).has_refusal());
  EXPECT_TRUE(Status().alarms(0).cause_gone());
  ASSERT_FALSE(Do(acknowledge).has_refusal());
  EXPECT_THAT(Status().alarms(), IsEmpty());
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-5.02 (a): axes without a reference keep jobs in the queue, but not while one runs that finds
// it; and a machine that is OFF keeps all of them.
TEST_F(ToldStatus, SaysThatTheAxesHaveNoReference) {
  MakeAndTakeOptimo();
  const std::string not_zeroed = CodeText(ErrorCode::kNotZeroed);
  EXPECT_THAT(CodesOf(Status()), testing::Not(testing::Contains(not_zeroed)));
  for (const bool on : {false, true}) {
    v1::HostOrder power;
    power.mutable_inputs()->set_control_token(token_);
    power.mutable_inputs()->add_inputs()->set_power(on);
    ASSERT_FALSE(Do(power).has_refusal());
    EXPECT_EQ(std::ranges::count(CodesOf(Status()), CodeText(ErrorCode::kCellNotLive)), on ? 0 : 1);
  }
  ASSERT_EQ(State(), v1::MACHINE_STATE_NOT_ZEROED);
  EXPECT_FALSE(Status().zeroed());
  EXPECT_THAT(CodesOf(Status()), testing::Contains(not_zeroed));
  v1::HostOrder zeroes = JobOf("ZERO\nDELAY 1\n");
  zeroes.mutable_run_job()->mutable_job()->mutable_run()->set_unzeroed(true);
  ASSERT_FALSE(Do(zeroes).has_refusal());
  ASSERT_FALSE(Status().zeroed());
  EXPECT_THAT(CodesOf(Status()), testing::Not(testing::Contains(not_zeroed)));
}

// LIVE-9.04: where a run is, in which program, what is in force there, and when.
TEST_F(ToldStatus, TheStateOfARunSaysWhereItIs) {
  MakeOptimo();
  RunOnOptimo("DELAY 1\nDELAY 50\n", 3s);
  v1::HostOrder order;
  order.mutable_run_state();
  const v1::RunState state = Do(order).run_state();
  ASSERT_EQ(state.stack_size(), 1);
  EXPECT_EQ(state.stack(0).program(), 5);
  EXPECT_EQ(state.stack(0).step(), 2);
  EXPECT_TRUE(std::ranges::any_of(state.values(), [](const v1::ModalValue& one) {
    return !one.name().empty() && !one.value().empty();
  }));
  EXPECT_FALSE(state.has_simulation_until());
  EXPECT_EQ(state.virtual_time_ns(), Status().virtual_time_ns());
  EXPECT_EQ(state.fence(), 7);
}

// LIVE-9.10: the answer to breakpoints has those that there are now, each with its step, its
// condition and the pass from which on it halts.
TEST_F(ToldStatus, BreakpointsAreToldAsTheyAreSet) {
  MakeAndTake();
  v1::HostOrder order;
  order.mutable_breakpoints()->set_control_token(token_);
  v1::Breakpoint& asked = *order.mutable_breakpoints()->add_breakpoints();
  asked.mutable_step()->set_program(5);
  asked.mutable_step()->set_step(7);  // the way to the first corner
  asked.set_passes(1);
  const v1::HostOrderAnswer answer = Do(order);
  ASSERT_TRUE(answer.has_run_state()) << answer.refusal().message();
  EXPECT_EQ(answer.run_state().fence(), 7);
  ASSERT_EQ(answer.run_state().breakpoints_size(), 1);
  EXPECT_EQ(answer.run_state().breakpoints(0).SerializeAsString(), asked.SerializeAsString());
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(20s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Status().hold_reason(), v1::HOLD_REASON_BREAKPOINT);
  EXPECT_EQ(Status().run().place().step(), 7);
}

// LIVE-2.03: IL and IA are those of an Optimo.
TEST_F(ToldStatus, AMillHasNoInputs) {
  MakeAndTake();
  v1::HostOrder order;
  order.mutable_inputs()->set_control_token(token_);
  order.mutable_inputs()->add_inputs()->set_door_open(true);
  v1::Variable& input = *order.mutable_inputs()->add_inputs()->mutable_input();
  input.set_name("IL[3]");
  input.mutable_value()->set_logical(true);
  const v1::HostOrderAnswer answer = Do(order);
  EXPECT_EQ(answer.refusal().code(), CodeText(ErrorCode::kCellNotLive));
  EXPECT_EQ(answer.refusal().message(), "the machine has no inputs");
  EXPECT_FALSE(Status().door_open());  // all of them or none
  order.mutable_inputs()->clear_inputs();
  EXPECT_EQ(Do(order).refusal().code(), CodeText(ErrorCode::kCellInvalidArgument));
}

}  // namespace
}  // namespace rmlcell::server
