// In which pass of a loop a start begins, behind a run that was cut off (live.md 6.01).
#include <string>
#include <utility>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class StartPasses : public HostMachineTest {
 protected:
  static constexpr const char* kLoop = "10 DELAY 1\nVI[1] = VI[1] + 1\nGOTO 10\n";

  void MakeLoop(v1::MachineMark mark, bool cut_off) {
    auto made = HostMachine::Make(
        {.name = "machines/optimo-1",
         .host = "workshop/1",
         .fence = 7,
         .family = families::FindFamily("optimo"),
         .state = mark.state(),
         .cut_off = cut_off,
         .open_run = mark.has_run_time_ns() ? std::optional(mark) : std::nullopt,
         .inspect_job = mark.job(),
         .cut_off_base = mark.has_base() ? std::optional(mark.base()) : std::nullopt},
        now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
  }
  v1::MachineMark NewestMark() {
    v1::MachineMark mark;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.has_mark()) mark = entry.mark();
    }
    return mark;
  }
  // Cut off in its fourth pass, at its first step.
  void CutOffInThePass() {
    MakeLoop({}, false);
    const v1::HostOrderAnswer begun = Do(JobOf(kLoop));
    ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
    Pass(3'500ms, 50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
    MakeLoop(NewestMark(), true);
    ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  }
  // Where a start would begin.
  machine::StepTarget TargetOf(std::int64_t occurrence) {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_occurrence(occurrence);
    *order.mutable_brought() = JobOf(kLoop).run_job().programs(0);
    auto task = host_->PreparePreview(order, now_);
    EXPECT_TRUE(task) << task.error().detail;
    const auto made = task->run(task->start, {});
    EXPECT_TRUE(made) << made.error().detail;
    return task->start.target;
  }
};

// It is the one in which it was, unless another one is named.
TEST_F(StartPasses, IsTheOneThatWasCutOff) {
  CutOffInThePass();
  EXPECT_EQ(TargetOf(0).at.program, 5);
  EXPECT_EQ(TargetOf(0).at.step, 1);
  EXPECT_EQ(TargetOf(0).occurrence, 4U);
  EXPECT_EQ(TargetOf(1).occurrence, 1U);
  EXPECT_EQ(TargetOf(2).occurrence, 2U);
}

}  // namespace
}  // namespace rmlcell::server
