// A run that was cut off goes on at a step, as the run of another job (live.md 5.10, 6).
#include <utility>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class ContinueJobTest : public HostMachineTest {
 protected:
  static v1::WorkerAssignment Assignment(const std::string& job,
                                         const std::string& text = kSquare) {
    v1::WorkerAssignment assignment;
    assignment.mutable_job()->set_name(job);
    assignment.set_main_program(5);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(5);
    program.set_file_name("square.rml");
    program.set_is_source(true);
    program.set_content(text);
    return assignment;
  }
  // The job runs for a while; its host dies and another one takes the machine over.
  void CutOff(std::chrono::milliseconds after, const std::string& text = kSquare) {
    Make();
    host_->Begin({}, now_);
    v1::HostOrder order;
    *order.mutable_run_job() = Assignment("jobs/17", text);
    ASSERT_FALSE(Do(order).has_refusal());
    Pass(after, 50ms);
    Again();
  }
  void Again() {
    v1::MachineMark mark;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.has_mark()) mark = entry.mark();
    }
    ASSERT_FALSE(mark.clean());
    inspect_job_ = mark.job();
    cut_off_base_ = mark.has_base() ? std::optional(mark.base()) : std::nullopt;
    std::optional<v1::MachineMark> open;
    if (mark.has_run_time_ns()) open = mark;
    Make(mark.state(), true, open);
    host_->Begin({}, now_);
    ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
  // Whoever reads the log sees that somebody looked, and then that the machine began.
  static void ExpectInspectedAndBegun(const std::vector<v1::JournalEntry>& entries) {
    ASSERT_GE(entries.size(), 2U);
    EXPECT_THAT(entries[0].event().message().text(), HasSubstr("inspected by "));
    EXPECT_TRUE(entries[1].applied().has_input());
    for (std::size_t i = 1; i < entries.size(); ++i)
      EXPECT_EQ(entries[i].sequence(), entries[i - 1].sequence() + 1);
  }
  v1::HostOrderAnswer Preview(int step, const std::string& text = kSquare,
                              v1::PreviewStartRequest asked = {}) {
    v1::HostOrder order;
    order.set_number(++number_);
    *order.mutable_preview_start() = std::move(asked);
    if (step > 0) order.mutable_preview_start()->mutable_step()->set_step(step);
    order.mutable_preview_start();
    *order.mutable_brought() = Assignment("", text).programs(0);
    auto task = host_->PreparePreview(order, now_);
    if (!task) {
      v1::HostOrderAnswer refused;
      refused.mutable_refusal()->set_message(task.error().detail);
      return refused;
    }
    auto made = task->run(task->start, {});
    return host_->Previewed(order, *std::move(task), std::move(made), now_);
  }
  v1::HostOrder Continue(const std::string& token, const std::string& continues = "jobs/17",
                         const std::string& text = kSquare) {
    v1::HostOrder order;
    order.set_reason("the tool is whole");
    v1::ContinueJob& job = *order.mutable_continue_job();
    *job.mutable_assignment() = Assignment("jobs/18", text);
    job.mutable_assignment()->mutable_job()->set_continues(continues);
    job.mutable_start()->set_control_token(token_);
    job.mutable_start()->set_request_id("continue " + token);
    job.mutable_start()->set_preview_token(token);
    job.mutable_start()->add_confirmations(v1::CONFIRMATION_TOOL);
    job.mutable_start()->add_confirmations(v1::CONFIRMATION_CLAMPS);
    job.mutable_start()->add_confirmations(v1::CONFIRMATION_ORIGIN_VALID);
    return order;
  }
  void Until(v1::MachineState state) {
    for (int i = 0; i < 6000 && State() != state; ++i) Pass(100ms, 50ms);
    ASSERT_EQ(State(), state);
  }
};

// LIVE-5.10, LIVE-6.09: a new job goes on where the old one was; it halts at its entry, and ends.
TEST_F(ContinueJobTest, ANewJobGoesOnWhereTheOldOneWas) {
  CutOff(45s);
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "jobs/17");
  const int cut_off_at = host_->StatusAt(now_).cut_off_at().step();
  EXPECT_GT(cut_off_at, 7);
  const v1::HostOrderAnswer preview = Preview(0);
  ASSERT_TRUE(preview.has_preview()) << preview.refusal().message();
  const std::string token = preview.preview().preview_token();
  ASSERT_NE(token, "");
  EXPECT_GT(preview.preview().run_time_ns(), 4'000'000'000);  // the way to that command
  const v1::HostOrderAnswer begun = Do(Continue(token));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(begun.status().run().job(), "jobs/18");
  EXPECT_EQ(begun.status().run().source(), v1::START_SOURCE_QUEUE);
  EXPECT_EQ(begun.status().run().phase(), v1::RUN_PHASE_APPROACH);
  Until(v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_ENTRY);
  EXPECT_EQ(host_->StatusAt(now_).run().place().step(), cut_off_at);  // the next to begin
  Do(Resume());
  Until(v1::MACHINE_STATE_IDLE);
  bool over = false;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
    if (!entry.has_run_over() || entry.run_over().job() != "jobs/18") continue;
    over = true;
    EXPECT_EQ(entry.run_over().outcome().kind(), v1::Outcome::KIND_COMPLETED);
  }
  EXPECT_TRUE(over);
  // Its recording begins where no run is open any more.
  v1::HostOrder order;
  order.mutable_recording()->set_job("jobs/18");
  const auto recorded = recording::ReadFile(Do(order).recording().chunk());
  ASSERT_TRUE(recorded) << recorded.error().detail;
  const v1::MachineMark& first = recorded->entries.front().mark();
  EXPECT_TRUE(first.clean());
  EXPECT_EQ(first.job(), "");
  EXPECT_FALSE(first.has_base());
}

// LIVE-6.07: where the part is known the way is looked at against what the run had cut of it.
TEST_F(ContinueJobTest, TheWayIsLookedAtAgainstThePart) {
  const std::string sides =
      "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;PD3000,1000;PD3000,3000;PD1000,3000;PU0,0;";
  CutOff(35s, sides);  // on the second side, its ninth command
  v1::PreviewStartRequest asked;
  v1::Stock& block = *asked.mutable_milling()->mutable_stock();
  block.set_size_x_mm(60);
  block.set_size_y_mm(60);
  block.set_size_z_mm(5);
  v1::MillTool& tool = *asked.mutable_milling()->mutable_tool();
  tool.set_shape(v1::MillTool::SHAPE_FLAT);
  tool.set_diameter_mm(3);
  const v1::PreviewStartResponse there = Preview(0, sides, asked).preview();
  EXPECT_TRUE(there.part_checked());
  EXPECT_NE(there.preview_token(), "");
  // Where that side ends it has not been yet.
  const v1::PreviewStartResponse ahead = Preview(10, sides, asked).preview();
  EXPECT_TRUE(ahead.part_checked());
  EXPECT_EQ(ahead.preview_token(), "");
  ASSERT_EQ(ahead.refusals().size(), 1);
  EXPECT_EQ(ahead.refusals(0).code(), "CELL-E9427");
  EXPECT_THAT(ahead.refusals(0).message(),
              testing::HasSubstr("motion 3 of the approach goes 0.500 mm into the part"));
  ASSERT_EQ(ahead.approach().size(), 3);  // up from where it stands, across, down
  EXPECT_TRUE(ahead.approach(0).findings().empty());
  EXPECT_TRUE(ahead.approach(1).findings().empty());
  EXPECT_EQ(ahead.approach(2).findings(0).code(), "CELL-E9427");
  // A person who knows that it was cut before, or that this block is a new one, says so.
  asked.set_part_so_far(v1::PART_SO_FAR_CUT_TO_STEP);
  EXPECT_NE(Preview(10, sides, asked).preview().preview_token(), "");
  asked.set_part_so_far(v1::PART_SO_FAR_UNTOUCHED);
  EXPECT_EQ(Preview(0, sides, asked).preview().preview_token(), "");
  asked.mutable_milling()->mutable_tool()->set_diameter_mm(-3);
  EXPECT_THAT(Preview(0, sides, asked).refusal().message(), testing::HasSubstr("milling.tool"));
  // Nobody knows it.
  EXPECT_FALSE(Preview(10, sides).preview().part_checked());
  EXPECT_NE(Preview(10, sides).preview().preview_token(), "");
}

// LIVE-6.05, LIVE-5.02: a job of the queue that begins at a step of the program that it brought:
// the approach is its first phase, it halts at its entry where the machine has that, and it ends.
TEST_F(ContinueJobTest, AJobBeginsAtAStep) {
  for (const bool halts : {false, true}) {
    options_.set_halt_at_entry(halts);
    Make();
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    const std::string text = std::string(kSquare) + "PU100,100;";  // other than what is stored
    v1::PreviewStartRequest asked;
    asked.set_program(5);
    const v1::PreviewStartResponse preview = Preview(8, text, asked).preview();
    ASSERT_NE(preview.preview_token(), "");
    v1::HostOrder order = Continue(preview.preview_token(), "", text);
    // Of another program than the one that was looked at.
    v1::HostOrder other = order;
    other.mutable_continue_job()->mutable_assignment()->mutable_programs(0)->set_content(kSquare);
    other.mutable_continue_job()->mutable_start()->set_request_id("other");
    EXPECT_EQ(Do(other).refusal().code(), "CELL-E9428");
    v1::HostOrder unseen = order;
    unseen.mutable_continue_job()->mutable_start()->clear_confirmations();
    unseen.mutable_continue_job()->mutable_start()->set_request_id("unseen");
    EXPECT_EQ(Do(unseen).refusal().code(), "CELL-E9421");
    order.mutable_continue_job()->mutable_start()->clear_control_token();  // the queue has none
    const v1::HostOrderAnswer begun = Do(order);
    ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
    EXPECT_EQ(begun.status().run().job(), "jobs/18");
    EXPECT_EQ(begun.status().run().phase(), v1::RUN_PHASE_APPROACH);
    EXPECT_TRUE(begun.status().cut_off_job().empty());
    if (halts) {
      Until(v1::MACHINE_STATE_HELD);
      EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_ENTRY);
      Do(Resume());
    }
    Until(v1::MACHINE_STATE_IDLE);
    // A mode in which the queue starts nothing.
    v1::HostOrder mode;
    Control(v1::ControlLease::ON_LOSS_GO_ON);  // that of before has run out
    mode.mutable_mode()->set_control_token(token_);
    mode.mutable_mode()->set_mode(v1::OPERATING_MODE_CYCLE);
    ASSERT_FALSE(Do(mode).has_refusal());
    const std::string token = Preview(8, text, asked).preview().preview_token();
    EXPECT_EQ(Do(Continue(token, "", text)).refusal().code(), "CELL-E9423");
  }
}

// LIVE-6.01: of a mill, held and let go on in the step in which it was cut off.
TEST_F(ContinueJobTest, AKeyBehindTheStepIsNotForIt) {
  Make();
  host_->Begin({}, now_);
  v1::HostOrder order;
  *order.mutable_run_job() = Assignment("jobs/17");
  ASSERT_FALSE(Do(order).has_refusal());
  Pass(40s, 50ms);
  const std::int64_t at = host_->StatusAt(now_).run().run_time_ns();
  Do(Stop());
  Pass(2s);
  v1::HostOrder resume = Resume();
  resume.set_for_job("jobs/17");
  Do(resume);
  Pass(1s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  Again();
  const v1::PreviewStartResponse preview = Preview(0).preview();
  EXPECT_NE(preview.preview_token(), "");
  EXPECT_GT(preview.run_time_ns(), 0);
  EXPECT_LE(preview.run_time_ns(), at);
}

// LIVE-5.10, LIVE-6.01: more came to it than is kept: where it was is known all the same. A stream
// comes to each of its commands once.
TEST_F(ContinueJobTest, WhereItWasIsKnownWhateverCame) {
  Make();
  host_->Begin({}, now_);
  v1::HostOrder order;
  *order.mutable_run_job() = Assignment("jobs/17");
  ASSERT_FALSE(Do(order).has_refusal());
  Pass(40s, 50ms);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("slower");
  take.mutable_acquire_control()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  token_ = Do(take).control().control_token();
  for (int i = 0; i < 1'001; ++i) {
    v1::HostOrder slower;
    slower.mutable_override()->set_control_token(token_);
    slower.mutable_override()->set_override_percent(i % 2 == 0 ? 99.0 : 100.0);
    ASSERT_FALSE(Do(slower).has_refusal());
  }
  Pass(1s);
  const int step = host_->StatusAt(now_).run().place().step();
  ASSERT_GT(step, 5);
  Again();
  EXPECT_TRUE(cut_off_base_->incomplete());
  EXPECT_EQ(host_->StatusAt(now_).cut_off_at().step(), step);
  const v1::PreviewStartResponse preview = Preview(0).preview();
  ASSERT_NE(preview.preview_token(), "");
  const v1::HostOrderAnswer begun = Do(Continue(preview.preview_token()));
  EXPECT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(begun.status().run().job(), "jobs/18");
}

// LIVE-5.10, LIVE-2.05: what is refused moves nothing, and the machine waits on.
TEST_F(ContinueJobTest, WhatIsRefusedLeavesTheDecisionOpen) {
  CutOff(45s);
  const std::string token = Preview(0).preview().preview_token();
  EXPECT_EQ(Do(Continue("another")).refusal().code(), "CELL-E9428");
  EXPECT_THAT(Do(Continue(token, "jobs/16")).refusal().message(), HasSubstr("jobs/16"));
  EXPECT_EQ(Do(Continue(token + " ", "jobs/17", "PU0,0;")).refusal().code(), "CELL-E9428");
  v1::HostOrder empty = Continue(token);
  empty.mutable_continue_job()->mutable_start()->set_request_id("empty");
  empty.mutable_continue_job()->mutable_assignment()->clear_programs();
  EXPECT_EQ(Do(empty).refusal().code(), "CELL-E9003");
  v1::HostOrder unseen = Continue(token);
  unseen.mutable_continue_job()->mutable_start()->set_request_id("unseen");
  unseen.mutable_continue_job()->mutable_start()->clear_confirmations();
  EXPECT_THAT(Do(unseen).refusal().message(), HasSubstr("tool"));
  v1::HostOrder stranger = Continue(token);
  stranger.mutable_continue_job()->mutable_start()->set_request_id("stranger");
  stranger.mutable_continue_job()->mutable_start()->set_control_token("none");
  EXPECT_EQ(Do(stranger).refusal().code(), "CELL-E9420");
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "jobs/17");
  // The direct way is for runs of nobody's job.
  v1::HostOrder direct;
  *direct.mutable_start_at_step() = Continue(token).continue_job().start();
  direct.mutable_start_at_step()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  direct.mutable_start_at_step()->set_request_id("direct");
  EXPECT_EQ(Do(direct).refusal().code(), "CELL-E9409");
  v1::HostOrder at_last = Continue(token);
  at_last.mutable_continue_job()->mutable_start()->set_request_id("at last");
  EXPECT_FALSE(Do(at_last).has_refusal());
}

// LIVE-5.10: the base outlives a second host that died before anybody decided, and a continued run
// that is cut off again has one.
TEST_F(ContinueJobTest, CutOffAgainAndAgain) {
  CutOff(45s);
  Again();
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "jobs/17");
  const int at = host_->StatusAt(now_).cut_off_at().step();
  v1::HostOrder order = Continue(Preview(0).preview().preview_token());
  order.mutable_continue_job()->mutable_start()->set_halt_at_entry(false);
  host_->TakeEntries(now_, true);
  ASSERT_FALSE(Do(order).has_refusal());
  ExpectInspectedAndBegun(host_->TakeEntries(now_, true));
  for (int i = 0; i < 2000; ++i) {
    if (host_->StatusAt(now_).run().place().step() > at) break;
    Pass(100ms, 50ms);
  }
  Again();
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "jobs/18");
  EXPECT_GT(host_->StatusAt(now_).cut_off_at().step(), at);
  const v1::HostOrderAnswer preview = Preview(0);
  ASSERT_TRUE(preview.has_preview()) << preview.refusal().message();
  EXPECT_NE(preview.preview().preview_token(), "");
}

// LIVE-6.08: a run of nobody's job goes on directly, when whoever starts it says that he has
// looked.
TEST_F(ContinueJobTest, ARunOfNobodysJobGoesOnDirectly) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  Do(Start("begin"));
  Pass(45s, 50ms);
  Again();
  EXPECT_EQ(host_->StatusAt(now_).cut_off_job(), "");
  v1::HostOrder order;
  *order.mutable_start_at_step() =
      Continue(Preview(0).preview().preview_token()).continue_job().start();
  EXPECT_EQ(Do(order).refusal().code(), "CELL-E9409");
  v1::HostOrder unseen = order;  // he has looked at the machine, and not at its tool
  unseen.mutable_start_at_step()->set_request_id("unseen");
  unseen.mutable_start_at_step()->clear_confirmations();
  unseen.mutable_start_at_step()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  EXPECT_EQ(Do(unseen).refusal().code(), "CELL-E9421");
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  order.mutable_start_at_step()->set_request_id("once more");
  order.mutable_start_at_step()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  host_->TakeEntries(now_, true);
  const v1::HostOrderAnswer begun = Do(order);
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  ExpectInspectedAndBegun(host_->TakeEntries(now_, true));
  Until(v1::MACHINE_STATE_HELD);
  Do(Resume());
  Until(v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(host_->StatusAt(now_).confirmations_due_size(), 0);
}

// LIVE-2.05, LIVE-5.10: a job that goes on with another one is begun from its top by nobody.
TEST_F(ContinueJobTest, NobodyBeginsItFromItsTop) {
  Make();
  host_->Begin({}, now_);
  v1::HostOrder order;
  *order.mutable_run_job() = Assignment("jobs/18");
  order.mutable_run_job()->mutable_job()->set_continues("jobs/17");
  EXPECT_EQ(Do(order).refusal().code(), "CELL-E9428");
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

}  // namespace
}  // namespace rmlcell::server
