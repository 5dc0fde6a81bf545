// What a start at a step behind a run that was cut off asks, and what its way says (live.md 6).
#include <utility>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class StartBasesTest : public HostMachineTest {
 protected:
  // An Optimo whose run of program 5 was cut off at this step; its inputs are not known.
  void CutOffAtStep(int step) {
    v1::RunBase base;
    base.set_program(5);
    base.set_incomplete(true);
    base.mutable_place()->set_program(5);
    base.mutable_place()->set_step(step);
    CutOffWith(base);
  }
  void CutOffWith(const v1::RunBase& base) {
    auto made = HostMachine::Make({.name = "machines/optimo-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = families::FindFamily("optimo"),
                                   .cut_off = true,
                                   .inspect_job = "jobs/17",
                                   .cut_off_base = base},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
    ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  }
  // Why its start is not looked at; "" where it is.
  std::string WhyNoPreview(std::int64_t occurrence, int program = 0) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(program);
    order.mutable_preview_start()->set_occurrence(occurrence);
    *order.mutable_brought() = JobOf("DELAY 1.\nDELAY 2.\nSTOP\n").run_job().programs(0);
    const auto task = host_->PreparePreview(order, now_);
    if (task) looked_at_ = task->start.target;
    return task ? std::string()
                : CodeText(task.error().code) + " " + std::string(task.error().detail);
  }
  machine::StepTarget looked_at_;
};

// LIVE-5.10, LIVE-6.01: the pass is asked for where the program had come to a step, however early.
TEST_F(StartBasesTest, ThePassOfAStepIsAskedFor) {
  for (const int step : {1, 2}) {
    CutOffAtStep(step);
    EXPECT_THAT(WhyNoPreview(0), HasSubstr("CELL-E9426 name the occurrence")) << step;
    EXPECT_THAT(WhyNoPreview(1), Not(HasSubstr("name the occurrence"))) << step;
  }
  CutOffAtStep(0);
  EXPECT_THAT(WhyNoPreview(0), Not(HasSubstr("name the occurrence")));
  EXPECT_EQ(looked_at_.at.step, 1);  // steps count from there
}

// LIVE-6.01: it goes on with the program that was cut off, named or not, and with no other.
TEST_F(StartBasesTest, TheProgramThatWasCutOffMayBeNamed) {
  CutOffAtStep(2);
  EXPECT_THAT(WhyNoPreview(0, 5), HasSubstr("name the occurrence"));
  EXPECT_THAT(WhyNoPreview(0, 6), Not(HasSubstr("name the occurrence")));
}

// What it began with cannot be read: it cannot go on with that.
TEST_F(StartBasesTest, ABaseThatSaysNothingIsRefused) {
  v1::RunBase base;
  base.set_program(5);
  base.set_mode(static_cast<v1::OperatingMode>(99));
  base.mutable_place()->set_program(5);
  base.mutable_place()->set_step(2);
  CutOffWith(base);
  EXPECT_EQ(WhyNoPreview(1),
            CodeText(ErrorCode::kCellInvalidArgument) + " mode is none that there is");
}

TEST_F(StartBasesTest, AProgramThatIsBroughtMustBeOne) {
  MakeOptimo();
  v1::HostOrder order;
  order.set_number(++number_);
  order.mutable_preview_start()->set_program(5);
  order.mutable_preview_start()->mutable_step()->set_step(1);
  *order.mutable_brought() = JobOf("SPEED 101\n").run_job().programs(0);
  const auto task = host_->PreparePreview(order, now_);
  ASSERT_FALSE(task);
  EXPECT_EQ(CodeText(task.error().code), "OPT-E7004");
}

// What a job brings is run in its own slot; a start of another program is one of what is stored.
TEST_F(StartBasesTest, AProgramIsBroughtForItsSlotAlone) {
  MakeAndTake();
  v1::HostMemory memory;
  memory.add_programs()->set_slot(6);
  memory.mutable_programs(0)->set_content("PA;PA;VS10;PU200,0;");
  host_->Change(memory, now_);
  const auto brings = [this](int program) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(program);
    order.mutable_preview_start()->mutable_step()->set_step(1);
    *order.mutable_brought() = JobOf("PA;PA;VS5;PU100,0;", "other.rml").run_job().programs(0);
    const auto task = host_->PreparePreview(order, now_);
    EXPECT_TRUE(task) << task.error().detail;
    return task && task->start.brought.has_value();
  };
  EXPECT_TRUE(brings(5));
  EXPECT_FALSE(brings(6));
}

// LIVE-6.01: what could not be worked out is no start that may begin.
TEST_F(StartBasesTest, APreviewThatFailedSaysWhy) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder order;
  order.set_number(++number_);
  order.mutable_preview_start()->set_program(5);
  order.mutable_preview_start()->mutable_step()->set_step(8);
  auto task = host_->PreparePreview(order, now_);
  ASSERT_TRUE(task) << task.error().detail;
  const v1::HostOrderAnswer answer =
      host_->Previewed(order, *std::move(task),
                       Error{ErrorCode::kCellStepUnreachable, "it took too long", {}}, now_);
  EXPECT_EQ(answer.number(), number_);
  EXPECT_EQ(answer.refusal().code(), CodeText(ErrorCode::kCellStepUnreachable));
  EXPECT_FALSE(answer.has_preview());
}

// LIVE-6.07: each motion of the way says how deep it goes into the part: 0.5 mm, the depth of the
// mill of 3 mm on a side that was not cut yet.
TEST_F(StartBasesTest, AMotionSaysHowDeepItGoes) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder order;
  order.set_number(++number_);
  v1::PreviewStartRequest& asked = *order.mutable_preview_start();
  asked.set_program(5);
  asked.mutable_step()->set_step(9);
  asked.set_part_so_far(v1::PART_SO_FAR_UNTOUCHED);
  v1::Stock& block = *asked.mutable_milling()->mutable_stock();
  block.set_size_x_mm(60);
  block.set_size_y_mm(60);
  block.set_size_z_mm(5);
  asked.mutable_milling()->mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
  asked.mutable_milling()->mutable_tool()->set_diameter_mm(3);
  auto task = host_->PreparePreview(order, now_);
  ASSERT_TRUE(task) << task.error().detail;
  auto made = task->run(task->start, {});
  const v1::HostOrderAnswer answer =
      host_->Previewed(order, *std::move(task), std::move(made), now_);
  ASSERT_TRUE(answer.has_preview()) << answer.refusal().message();
  std::vector<std::string> said;
  for (const v1::ApproachMotion& motion : answer.preview().approach()) {
    for (const v1::Diagnostic& finding : motion.findings()) said.push_back(finding.message());
  }
  EXPECT_THAT(said, testing::ElementsAre("0.500 mm into the part"));
}

// LIVE-6.01: the program that is named is the one, whichever was started last.
TEST_F(StartBasesTest, TheFirstProgramMayBeNamed) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(120s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const auto looked_at = [this](int program) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(program);
    order.mutable_preview_start()->mutable_step()->set_step(8);
    const auto task = host_->PreparePreview(order, now_);
    return task ? task->start.program : -1;
  };
  EXPECT_EQ(looked_at(0), 5);
  EXPECT_EQ(looked_at(5), 5);
  EXPECT_NE(looked_at(1), 5);
}

}  // namespace
}  // namespace rmlcell::server
