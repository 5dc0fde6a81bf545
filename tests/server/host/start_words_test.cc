// A start at a step as it is asked for and as its preview tells it (live.md 6.01 to 6.06).
#include <string>
#include <utility>
#include <vector>

#include "server/host/start_desk.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class StartWords : public HostMachineTest {
 protected:
  v1::HostOrder Question(int step) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(5);
    order.mutable_preview_start()->mutable_step()->set_step(step);
    return order;
  }
  machine::StartAtStep Asked(const v1::PreviewStartRequest& request) {
    v1::HostOrder order = Question(8);
    order.mutable_preview_start()->MergeFrom(request);
    const auto task = host_->PreparePreview(order, now_);
    EXPECT_TRUE(task) << task.error().detail;
    return task ? task->start : machine::StartAtStep();
  }
  // That of the third corner of the square, for a test to change.
  machine::StartPreview Previewed() {
    auto task = host_->PreparePreview(Question(8), now_);
    EXPECT_TRUE(task) << task.error().detail;
    auto made = task->run(task->start, {});
    EXPECT_TRUE(made) << made.error().detail;
    return *std::move(made);
  }
  static v1::PreviewStartResponse ToldOf(const machine::StartPreview& preview) {
    return ToProto(preview, families::FindFamily("rml1")->info());
  }
  static std::vector<std::string> FindingsOf(const v1::ApproachMotion& motion) {
    std::vector<std::string> said;
    for (const v1::Diagnostic& finding : motion.findings()) {
      EXPECT_EQ(finding.code(), CodeText(ErrorCode::kCellApproach));
      said.push_back(finding.message());
    }
    return said;
  }
};

// LIVE-6.01, LIVE-6.06: which pass, which way, and whether the beam stays off.
TEST_F(StartWords, OfWhatIsAskedFor) {
  MakeAndTake();
  machine::StartAtStep start = Asked({});
  EXPECT_EQ(start.program, 5);
  EXPECT_EQ(start.target.at.program, 5);
  EXPECT_EQ(start.target.at.step, 8);
  EXPECT_EQ(start.target.occurrence, 1U);
  EXPECT_EQ(start.way, machine::ApproachWay::kSafe);
  EXPECT_FALSE(start.off_until_work_on);
  v1::PreviewStartRequest request;
  request.set_approach(v1::APPROACH_DIRECT);
  EXPECT_EQ(Asked(request).way, machine::ApproachWay::kDirect);
  request.set_approach(v1::APPROACH_SAFE);
  EXPECT_EQ(Asked(request).way, machine::ApproachWay::kSafe);
  request.set_part_so_far(v1::PART_SO_FAR_CUT_TO_STEP);
  request.set_off_until_work_on(true);
  request.set_occurrence(3);
  EXPECT_TRUE(Asked(request).off_until_work_on);
  EXPECT_EQ(Asked(request).target.occurrence, 3U);
  v1::HostOrder odd = Question(8);
  odd.mutable_preview_start()->set_part_so_far(static_cast<v1::PartSoFar>(99));
  EXPECT_EQ(host_->PreparePreview(odd, now_).error().code, ErrorCode::kCellInvalidArgument);
  odd = Question(0);
  EXPECT_EQ(host_->PreparePreview(odd, now_).error().code, ErrorCode::kCellInvalidArgument);
}

// LIVE-6.03: each value there and now, and what is done about it; what a person sees to has the
// confirmation that says so.
TEST_F(StartWords, OfWhatIsDifferent) {
  MakeAndTake();
  machine::StartPreview preview = Previewed();
  using Action = machine::StartAction;
  preview.differences = {{"VS", "1", "2", Action::kSet},       {"pose", "a", "b", Action::kMove},
                         {"OL[3]", "1", "0", Action::kSwitch}, {"clamps", "x", "", Action::kAsk},
                         {"tool", "x", "", Action::kAsk},      {"origin", "x", "", Action::kAsk},
                         {"Z0", "x", "", Action::kAsk},        {"table", "x", "", Action::kAsk},
                         {"mirror", "x", "", Action::kAsk},    {"Z0", "1", "2", Action::kNone}};
  const v1::PreviewStartResponse told = ToldOf(preview);
  ASSERT_EQ(told.differences_size(), 10);
  EXPECT_EQ(told.differences(0).item(), "VS");
  EXPECT_EQ(told.differences(0).there(), "1");
  EXPECT_EQ(told.differences(0).now(), "2");
  std::vector<v1::StartAction> actions;
  std::vector<v1::Confirmation> confirmations;
  for (const v1::StartDifference& one : told.differences()) {
    actions.push_back(one.action());
    confirmations.push_back(one.confirmation());
  }
  EXPECT_THAT(actions,
              ElementsAre(v1::START_ACTION_SET, v1::START_ACTION_MOVE, v1::START_ACTION_SWITCH,
                          v1::START_ACTION_ASK, v1::START_ACTION_ASK, v1::START_ACTION_ASK,
                          v1::START_ACTION_ASK, v1::START_ACTION_ASK, v1::START_ACTION_ASK,
                          v1::START_ACTION_NONE));
  EXPECT_THAT(confirmations,
              ElementsAre(v1::CONFIRMATION_UNSPECIFIED, v1::CONFIRMATION_UNSPECIFIED,
                          v1::CONFIRMATION_UNSPECIFIED, v1::CONFIRMATION_CLAMPS,
                          v1::CONFIRMATION_TOOL, v1::CONFIRMATION_ORIGIN_VALID,
                          v1::CONFIRMATION_ORIGIN_VALID, v1::CONFIRMATION_TABLE_CLEAR,
                          v1::CONFIRMATION_UNSPECIFIED, v1::CONFIRMATION_UNSPECIFIED));
}

// LIVE-6.05, LIVE-6.07: where each motion of the way ends, how fast it is, and what is wrong with
// it.
TEST_F(StartWords, OfTheWayThere) {
  MakeAndTake();
  machine::StartPreview preview = Previewed();
  const motion::AxisPose to{.column = {1.0, 2.0, 3.0}, .a_rad = 0.5, .b_rad = 0.25};
  preview.approach = {
      {.path = "PU", .to = to, .feed_mm_s = 30.0},
      {.path = "PD",
       .to = to,
       .beyond = {{.axis = 0, .excess = 1.0, .at_target = true}, {.axis = 3, .excess = 0.1}},
       .into_part_mm = 0.25}};
  const v1::PreviewStartResponse told = ToldOf(preview);
  ASSERT_EQ(told.approach_size(), 2);
  EXPECT_EQ(told.approach(0).path(), "PU");
  EXPECT_EQ(told.approach(0).feed_mm_s(), 30.0);
  ASSERT_EQ(told.approach(0).to_size(), 4);  // a mill has no B
  EXPECT_EQ(told.approach(0).to(1).axis(), "Y");
  EXPECT_EQ(told.approach(0).to(1).value(), 2.0);
  EXPECT_EQ(told.approach(0).to(3).value(), 0.5);
  EXPECT_THAT(FindingsOf(told.approach(0)), IsEmpty());
  EXPECT_EQ(told.approach(1).path(), "PD");
  EXPECT_THAT(FindingsOf(told.approach(1)),
              ElementsAre("X of its target leaves the travel", "A leaves the travel on the way",
                          "0.250 mm into the part"));
}

// LIVE-6.04: why it may not begin, and where it may instead.
TEST_F(StartWords, OfWhatSpeaksAgainstIt) {
  MakeAndTake();
  machine::StartPreview preview = Previewed();
  v1::PreviewStartResponse told = ToldOf(preview);
  EXPECT_EQ(told.run_time_ns(), preview.run_time.count());
  EXPECT_THAT(told.refusals(), IsEmpty());
  EXPECT_EQ(told.there().stack_size(), static_cast<int>(preview.reach.run->stack().size()));
  ASSERT_FALSE(preview.there.empty());
  EXPECT_EQ(told.there().values(0).name(), preview.there[0].name);
  EXPECT_EQ(told.there().values(0).value(), preview.there[0].value);
  preview.clean_before = machine::StepTarget{.at = {.program = 5, .step = 7}};
  preview.clean_after = machine::StepTarget{.at = {.program = 6, .step = 9}};
  preview.missing_cut_mm = 2.5;
  preview.part_checked = true;
  preview.run_time = SimTime(1'234);
  preview.refusals = {Error{ErrorCode::kCellStepUnreachable, "beside", {}}};
  told = ToldOf(preview);
  EXPECT_EQ(told.clean_before().program(), 5);
  EXPECT_EQ(told.clean_before().step(), 7);
  EXPECT_EQ(told.clean_after().program(), 6);
  EXPECT_EQ(told.clean_after().step(), 9);
  EXPECT_EQ(told.missing_cut_mm(), 2.5);
  EXPECT_TRUE(told.part_checked());
  EXPECT_EQ(told.run_time_ns(), 1'234);
  ASSERT_EQ(told.refusals_size(), 1);
  EXPECT_EQ(told.refusals(0).code(), CodeText(ErrorCode::kCellStepUnreachable));
  EXPECT_EQ(told.refusals(0).message(), "beside");
  preview.clean_before.reset();
  preview.clean_after.reset();
  told = ToldOf(preview);
  EXPECT_FALSE(told.has_clean_before());
  EXPECT_FALSE(told.has_clean_after());
}

// LIVE-6.07: what removes no material has no block to be looked at.
TEST_F(StartWords, OfAPartThatNobodyCuts) {
  MakeOptimo();
  v1::HostOrder order;
  order.set_number(++number_);
  order.mutable_preview_start()->set_program(5);
  order.mutable_preview_start()->mutable_step()->set_step(1);
  *order.mutable_brought() = JobOf("DELAY 1\n").run_job().programs(0);
  order.mutable_preview_start()->mutable_milling();
  const auto task = host_->PreparePreview(order, now_);
  ASSERT_FALSE(task);
  EXPECT_EQ(task.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(task.error().detail, "milling: this machine removes no material");
}

}  // namespace
}  // namespace rmlcell::server
