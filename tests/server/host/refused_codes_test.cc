// The code of what a live machine refuses, by which clients tell one reason from another (live.md 4
// to 7).
#include <string>
#include <utility>
#include <vector>

#include "proto/recording/recording.h"
#include "server/host/host_line.h"
#include "server/host/machine_recorder.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class RefusedCodes : public HostMachineTest {
 protected:
  std::string CodeOf(const v1::HostOrder& order) { return Do(order).refusal().code(); }
  static std::string Code(ErrorCode code) { return CodeText(code); }
  std::string CodeOfPreview(const v1::PreviewStartRequest& request) {
    v1::HostOrder order;
    order.set_number(++number_);
    *order.mutable_preview_start() = request;
    const auto task = host_->PreparePreview(order, now_);
    return task ? std::string() : CodeText(task.error().code);
  }
  v1::HostOrder ContinueOf(const std::string& job, const std::string& token) {
    v1::HostOrder order;
    v1::ContinueJob& continued = *order.mutable_continue_job();
    *continued.mutable_assignment() = JobOf(kSquare, "square.rml").run_job();
    continued.mutable_assignment()->mutable_job()->set_name("jobs/18");
    continued.mutable_assignment()->mutable_job()->set_continues(job);
    continued.mutable_start()->set_control_token(token_);
    continued.mutable_start()->set_preview_token(token);
    return order;
  }
  // A job runs for a while; its host dies, and another one has the machine.
  void CutOffAJob() {
    Make();
    host_->Begin({}, now_);
    ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
    Pass(45s, 50ms);
    v1::MachineMark mark;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.has_mark()) mark = entry.mark();
    }
    inspect_job_ = mark.job();
    cut_off_base_ = mark.base();
    Make(mark.state(), true, mark);
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
  std::string PreviewToken() {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start();
    *order.mutable_brought() = JobOf(kSquare, "square.rml").run_job().programs(0);
    auto task = host_->PreparePreview(order, now_);
    EXPECT_TRUE(task) << task.error().detail;
    auto made = task->run(task->start, {});
    return host_->Previewed(order, *std::move(task), std::move(made), now_)
        .preview()
        .preview_token();
  }
};

// LIVE-4.01: what is asked for is wrong; that somebody has it is another matter.
TEST_F(RefusedCodes, OfControl) {
  Make();
  v1::HostOrder order;
  order.mutable_acquire_control()->mutable_ttl()->set_seconds(61);
  EXPECT_EQ(CodeOf(order), Code(ErrorCode::kCellInvalidArgument));
  Control();
  order.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  EXPECT_EQ(CodeOf(order), Code(ErrorCode::kCellLeaseHeld));
}

// LIVE-5.02, LIVE-5.10
TEST_F(RefusedCodes, OfJobs) {
  MakeAndTake();
  EXPECT_EQ(CodeOf(ContinueOf("jobs/16", "none")), Code(ErrorCode::kCellMachineState));
  v1::HostOrder confirm;
  confirm.mutable_confirm()->set_control_token(token_);
  confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  EXPECT_EQ(CodeOf(confirm), Code(ErrorCode::kCellMachineState));
  v1::HostOrder power;
  power.mutable_inputs()->set_control_token(token_);
  power.mutable_inputs()->add_inputs()->set_power(false);
  ASSERT_FALSE(Do(power).has_refusal());
  ASSERT_EQ(State(), v1::MACHINE_STATE_OFF);
  EXPECT_EQ(CodeOf(JobOf(kSquare, "square.rml")), Code(ErrorCode::kCellNotLive));
}

TEST_F(RefusedCodes, OfRuns) {
  MakeAndTake();
  v1::HostOrder of_a_job;
  of_a_job.mutable_start()->set_job("jobs/17");
  of_a_job.mutable_start()->set_control_token(token_);
  EXPECT_EQ(CodeOf(of_a_job), Code(ErrorCode::kCellUnimplemented));
  v1::HostOrder nothing;
  nothing.mutable_start()->set_control_token(token_);
  EXPECT_EQ(CodeOf(nothing), Code(ErrorCode::kCellInvalidArgument));
  ASSERT_FALSE(Do(Start()).has_refusal());
  v1::HostOrder abort;
  abort.mutable_abort()->set_run(99);
  EXPECT_EQ(CodeOf(abort), Code(ErrorCode::kCellMachineState));
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  abort.mutable_abort()->set_run(1);
  EXPECT_FALSE(Do(abort).has_refusal());
}

// LIVE-7.04
TEST_F(RefusedCodes, OfKeys) {
  MakeAndTake();
  v1::HostOrder key;
  key.mutable_panel_key()->set_key("COVER");
  key.mutable_panel_key()->set_action(v1::KEY_ACTION_TAP);
  key.mutable_panel_key()->set_control_token(token_);
  EXPECT_EQ(CodeOf(key), Code(ErrorCode::kCellInvalidArgument));  // it has no number
  key.mutable_panel_key()->set_sequence(10);
  EXPECT_EQ(CodeOf(key), Code(ErrorCode::kCellKeySequence));
  MakeAndTakeOptimo();
  key.mutable_panel_key()->set_control_token(token_);
  key.mutable_panel_key()->set_sequence(1);
  EXPECT_EQ(CodeOf(key), Code(ErrorCode::kCellNotLive));
}

// LIVE-6.01
TEST_F(RefusedCodes, OfStartsThatAreLookedAt) {
  MakeAndTake();
  v1::PreviewStartRequest request;
  request.set_program(5);
  request.mutable_step()->set_step(9);
  EXPECT_EQ(CodeOfPreview(request), "");
  request.mutable_milling()->mutable_tool()->set_diameter_mm(-1.0);
  EXPECT_EQ(CodeOfPreview(request), Code(ErrorCode::kCellInvalidArgument));
}

// LIVE-7.08: whatever a later server says of a program that it did not store, it was not stored.
TEST_F(RefusedCodes, OfWhatIsNotStored) {
  MakeAndTakeOptimo();
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = Do(open).session().name();
  Taught(session, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  v1::HostEditAnswer refused;
  refused.set_number(1);
  refused.mutable_refusal()->set_code("CELL-E0000");
  host_->EditAnswered(refused, now_);
  EXPECT_EQ(host_->Handbox()->message_code(), Code(ErrorCode::kCellStoreFailed));
}

// Where nobody listens: that is no refusal of a server.
TEST(RefusedLines, ByNobody) {
  const auto joined = HostLine::Join(
      "unix:" + testing::TempDir() + "/nobody-listens", {}, [](const v1::HostResponse&) {}, [] {});
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, ErrorCode::kCellUnavailable);
}

// LIVE-3.40: what was too large to be recorded is not there, as any other that is not.
TEST(RefusedRecordings, OfWhatIsTooLarge) {
  MachineRecorder recorder;
  EXPECT_EQ(recorder.Part({}).error().code, ErrorCode::kCellNotFound);
  machine::MachineMemory memory;
  memory.programs[5].object =
      machine::Bytes::Of(std::string(MachineRecorder::kBytesMax + std::size_t{1}, 'x'));
  recorder.Begin({}, memory, {});
  EXPECT_EQ(recorder.Part({}).error().code, ErrorCode::kCellNotFound);
}

// LIVE-3.40: a recording has what a replay needs: of a run under way no state, and neither what it
// makes again nor what was answered; where the machine stands behind it, all of that.
TEST(RecordedEntries, HaveWhatAReplayNeeds) {
  const auto mark = [](bool clean) {
    v1::JournalEntry entry;
    entry.mutable_mark()->set_state("where it stands");
    entry.mutable_mark()->set_clean(clean);
    entry.mutable_mark()->mutable_base()->set_program(5);
    entry.add_executables()->set_slot(5);
    return entry;
  };
  MachineRecorder recorder;
  recorder.Begin({}, {}, mark(true));
  v1::JournalEntry answered;
  answered.mutable_answered()->set_request_id("one");
  recorder.Add(answered);
  recorder.Add(mark(false));
  recorder.Add(mark(true));
  const auto part = recorder.Part({});
  ASSERT_TRUE(part);
  const auto recording = recording::ReadFile(part->chunk());
  ASSERT_TRUE(recording) << recording.error().detail;
  ASSERT_EQ(recording->entries.size(), 3U);
  const v1::JournalEntry& under_way = recording->entries[1];
  EXPECT_TRUE(under_way.has_mark());
  EXPECT_EQ(under_way.mark().state(), "");
  EXPECT_FALSE(under_way.mark().has_base());
  EXPECT_EQ(under_way.executables_size(), 0);
  const v1::JournalEntry& behind = recording->entries[2];
  EXPECT_EQ(behind.mark().state(), "where it stands");
  EXPECT_EQ(behind.mark().base().program(), 5);
  EXPECT_EQ(behind.executables_size(), 0);
}

// A job that was to go on and is refused is nobody's afterwards, and neither is what it brought.
TEST_F(RefusedCodes, AContinuationThatIsRefusedLeavesNothing) {
  CutOffAJob();
  ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  const std::string token = PreviewToken();
  host_->TakeEntries(now_, true);
  const v1::HostOrderAnswer refused = Do(ContinueOf("jobs/17", token));  // nobody has seen to it
  ASSERT_THAT(refused.refusal().message(), testing::HasSubstr("tool"));
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(12);
  program.set_content("PA;PA;");
  host_->Change(memory, now_);
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true))
    EXPECT_EQ(entry.job(), "") << entry.ShortDebugString();
  const v1::MachineRecording recorded = RecordingHead();
  EXPECT_FALSE(recorded.has_brought());
  EXPECT_EQ(recorded.job(), "");
}

// LIVE-5.02: nor is one of the queue, whose program is not that of the next run.
TEST_F(RefusedCodes, AJobThatIsRefusedLeavesNothing) {
  options_.set_ticket_needed(true);
  MakeAndTake();
  EXPECT_EQ(CodeOf(JobOf("PA;PA;VS5;PU100,0;", "other.rml")), Code(ErrorCode::kCellTicket));
  ASSERT_FALSE(Do(Start()).has_refusal());
  EXPECT_EQ(host_->StatusAt(now_).run().job(), "");
  static_cast<void>(host_->TakeEntries(now_, true));
  const v1::MachineRecording recorded = RecordingHead();
  EXPECT_FALSE(recorded.has_brought());
  EXPECT_EQ(recorded.job(), "");
}

// LIVE-6.08: nor is one that was to begin at a step.
TEST_F(RefusedCodes, AJobAtAStepThatIsRefusedLeavesNothing) {
  options_.set_ticket_needed(true);
  MakeAndTake();
  const std::string text = "PA;PA;VS10;PU2000,0;PU2000,2000;PU0,0;";
  v1::HostOrder question;
  question.set_number(++number_);
  question.mutable_preview_start()->set_program(5);
  question.mutable_preview_start()->mutable_step()->set_step(5);
  *question.mutable_brought() = JobOf(text, "other.rml").run_job().programs(0);
  auto task = host_->PreparePreview(question, now_);
  ASSERT_TRUE(task) << task.error().detail;
  auto made = task->run(task->start, {});
  const std::string token =
      host_->Previewed(question, *std::move(task), std::move(made), now_).preview().preview_token();
  ASSERT_NE(token, "");
  v1::HostOrder job = ContinueOf("", token);
  job.mutable_continue_job()->mutable_assignment()->mutable_programs(0)->set_content(text);
  EXPECT_EQ(CodeOf(job), Code(ErrorCode::kCellTicket));
  ASSERT_FALSE(Do(Start()).has_refusal());
  static_cast<void>(host_->TakeEntries(now_, true));
  const v1::MachineRecording recorded = RecordingHead();
  EXPECT_FALSE(recorded.has_brought());
  EXPECT_EQ(recorded.job(), "");
}

// LIVE-5.20: whoever finds the intent of a job finds behind it where the machine stands without
// that.
TEST_F(RefusedCodes, BehindAJobThatIsRefusedThereIsAMark) {
  const auto expect_mark_behind = [this](const v1::HostOrder& job) {
    static_cast<void>(host_->TakeEntries(now_, true));
    ASSERT_TRUE(host_->TakeEntries(now_).empty());
    ASSERT_TRUE(Do(job).has_refusal());
    const std::vector<v1::JournalEntry> entries = host_->TakeEntries(now_);
    ASSERT_EQ(entries.size(), 1U);
    EXPECT_TRUE(entries[0].has_mark());
  };
  Make({}, true);
  host_->Begin({}, now_);
  expect_mark_behind(JobOf(kSquare, "square.rml"));
  MakeAndTake();
  expect_mark_behind(ContinueOf("jobs/16", "none"));
}

// LIVE-4.01, LIVE-4.02: what became of a run would be guessed; and nobody keeps what he has not.
TEST_F(RefusedCodes, OfControlThatIsNone) {
  Make();
  v1::HostOrder take;
  take.mutable_acquire_control()->set_on_loss(static_cast<v1::ControlLease::OnLoss>(3));
  const v1::HostOrderAnswer refused = Do(take);
  EXPECT_EQ(refused.refusal().code(), Code(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(refused.refusal().message(), "on_loss is none that there is");
  EXPECT_FALSE(host_->StatusAt(now_).has_control());
  v1::HostOrder renew;
  renew.mutable_renew_control()->set_control_token("none");
  EXPECT_EQ(CodeOf(renew), Code(ErrorCode::kCellControlNeeded));
}

// LIVE-2.11, LIVE-7.08: what says nothing, or what there is not, is refused and changes nothing.
TEST_F(RefusedCodes, OfValuesThatAreNone) {
  MakeAndTakeOptimo();
  v1::HostOrder read;
  read.mutable_read_variables()->add_variables("VI[3..1]");
  EXPECT_EQ(CodeOf(read), Code(ErrorCode::kCellInvalidArgument));
  v1::HostOrder write;
  write.mutable_write_variables()->set_control_token(token_);
  write.mutable_write_variables()->add_variables()->set_name("VI[3]");
  EXPECT_EQ(CodeOf(write), Code(ErrorCode::kCellInvalidArgument));
  v1::HostOrder mode;
  mode.mutable_mode()->set_control_token(token_);
  EXPECT_EQ(CodeOf(mode), Code(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(host_->StatusAt(now_).mode(), v1::OPERATING_MODE_REMOTE);
  v1::HostOrder inputs;
  inputs.mutable_inputs()->set_control_token(token_);
  inputs.mutable_inputs()->add_inputs()->set_power(false);
  inputs.mutable_inputs()->add_inputs();
  EXPECT_EQ(CodeOf(inputs), Code(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// What is set from outside is said, and of what starts programs one at a time.
TEST_F(RefusedCodes, OfInputsFromOutside) {
  MakeAndTake();
  v1::HostOrder order;
  order.mutable_inputs()->set_control_token(token_);
  const v1::HostOrderAnswer none = Do(order);
  EXPECT_EQ(none.refusal().code(), Code(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(none.refusal().message(), "inputs: none is given");
  for (const int gate : {1, 2}) order.mutable_inputs()->add_inputs()->set_gate(gate);
  const v1::HostOrderAnswer both = Do(order);
  EXPECT_EQ(both.refusal().code(), Code(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(both.refusal().message(),
            "inputs: one gate at a time, for each of them starts a program");
}

}  // namespace
}  // namespace rmlcell::server
