// A job whose power went, and what is told of a step that is taught (live.md 5.10, 7.09).
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class CutPower : public HostMachineTest {};

// LIVE-5.10: which job it was is known to whoever looks at the machine.
TEST_F(CutPower, ItsJobIsKnown) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  const v1::HostOrderAnswer begun = Do(JobOf(kSquare, "square.rml"));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  Pass(7s, 50ms);
  for (const bool on : {false, true}) {
    v1::HostOrder order;
    order.mutable_inputs()->set_control_token(token_);
    order.mutable_inputs()->add_inputs()->set_power(on);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "jobs/17");
}

// LIVE-7.09: a step that is put in has a text behind it and none before.
TEST_F(CutPower, AStepThatIsTaughtHasItsText) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = Do(open).session().name();
  const v1::HostEdit made =
      Taught(session, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(made.slot());
  program.set_content(made.object());
  program.set_object_revision(1);
  v1::HostEditAnswer answer;
  answer.set_number(made.number());
  host_->EditAnswered(answer, now_);
  host_->Change(memory, now_);
  const v1::TeachEntry step = Taught(session, "DLY DEL 0 POINT 5 ENT REC").taught();
  EXPECT_EQ(step.act(), v1::TeachEntry::ACT_INSERT);
  EXPECT_THAT(step.after(), testing::HasSubstr("DELAY"));
  EXPECT_EQ(step.before(), "");
  EXPECT_EQ(step.step().program(), 12);
}

}  // namespace
}  // namespace rmlcell::server
