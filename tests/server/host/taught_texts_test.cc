// What the log has of steps that are taught and taken out again (live.md 7.08, 7.09).
#include <string>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class TaughtTexts : public HostMachineTest {
 protected:
  void OpenHandbox() {
    MakeOptimo();
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    v1::HostOrder open;
    open.mutable_create_session()->set_control_token(token_);
    session_ = Do(open).session().name();
  }
  // As the store answers it.
  void Store(const v1::HostEdit& edit) {
    v1::HostMemory memory;
    v1::AssignedProgram& program = *memory.add_programs();
    program.set_slot(edit.slot());
    program.set_content(edit.object());
    program.set_object_revision(edit.object_revision() + 1);
    v1::HostEditAnswer answer;
    answer.set_number(edit.number());
    host_->EditAnswered(answer, now_);
    host_->Change(memory, now_);
  }
  std::string session_;
};

// Each entry has the text of its step before and behind, its place, and what the store has of it.
TEST_F(TaughtTexts, OfAStepThatIsTakenOut) {
  OpenHandbox();
  Store(Taught(session_, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC"));
  const v1::HostEdit put_in = Taught(session_, "DLY DEL 0 POINT 5 ENT REC");
  EXPECT_EQ(put_in.number(), 2);
  EXPECT_EQ(put_in.object_revision(), 1);
  EXPECT_EQ(put_in.taught().before(), "");
  const std::string text = put_in.taught().after();
  EXPECT_THAT(text, testing::HasSubstr("DELAY"));
  Store(put_in);
  const v1::HostEdit taken_out = Taught(session_, "JOB 1 2 NEXT 1 ENT DEL 1");
  EXPECT_EQ(taken_out.number(), 3);
  EXPECT_EQ(taken_out.slot(), 12);
  EXPECT_EQ(taken_out.object_revision(), 2);
  const v1::TeachEntry& taught = taken_out.taught();
  EXPECT_EQ(taught.act(), v1::TeachEntry::ACT_DELETE);
  EXPECT_EQ(taught.before(), text);
  EXPECT_EQ(taught.after(), "");
  EXPECT_EQ(taught.step().program(), 12);
  EXPECT_EQ(taught.step().step(), put_in.taught().step().step());
  EXPECT_EQ(taught.caller(), "anna");
  EXPECT_EQ(taught.time().seconds(), Stamp(now_.wall).seconds());
  EXPECT_EQ(taught.axes_size(), 5);
}

// LIVE-7.09: whoever has control may take back what was taught; the host has no say in it.
TEST_F(TaughtTexts, WhoHasControlMayUndoThem) {
  OpenHandbox();
  v1::HostOrder undo;
  undo.mutable_undo_teaching()->set_control_token(token_);
  const v1::HostOrderAnswer undone = Do(undo);
  EXPECT_TRUE(undone.has_undone()) << undone.refusal().message();
  undo.mutable_undo_teaching()->set_control_token("another");
  EXPECT_EQ(Do(undo).refusal().code(), CodeText(ErrorCode::kCellControlNeeded));
}

// host.proto, HostEdit.object_revision: 0 where there was no program, though one of that number was
// there before.
TEST_F(TaughtTexts, OfAProgramThatIsGoneHaveNoRevision) {
  OpenHandbox();
  Store(Taught(session_, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC"));
  v1::HostMemory nothing;
  nothing.set_whole(true);
  host_->Change(nothing, now_);
  const v1::HostEdit again = Taught(session_, "JOB 1 2 ENT REC");
  EXPECT_EQ(again.taught().act(), v1::TeachEntry::ACT_CREATE);
  EXPECT_EQ(again.object_revision(), 0);
}

// LIVE-7.09: where a step stands among all instructions, by which it is taken back. Here each of
// them is a step.
TEST_F(TaughtTexts, OfAStepHaveItsPlace) {
  OpenHandbox();
  Store(Taught(session_, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC"));
  Store(Taught(session_, "DLY DEL 0 POINT 5 ENT REC"));
  const v1::TeachEntry second =
      Taught(session_, "JOB 1 2 NEXT 2 ENT DLY DEL 0 POINT 7 ENT REC").taught();
  ASSERT_GT(second.step().step(), 1);
  EXPECT_EQ(second.place(), second.step().step() - 1);
}

}  // namespace
}  // namespace rmlcell::server
