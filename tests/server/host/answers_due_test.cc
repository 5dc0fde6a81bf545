// Answers that wait for the disk.
#include "server/host/answers_due.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

v1::HostOrderAnswer AnswerTo(std::int64_t number) {
  v1::HostOrderAnswer answer;
  answer.set_number(number);
  answer.mutable_status();
  return answer;
}

std::vector<std::int64_t> NumbersOf(const std::vector<v1::HostOrderAnswer>& answers) {
  std::vector<std::int64_t> numbers;
  for (const v1::HostOrderAnswer& answer : answers) numbers.push_back(answer.number());
  return numbers;
}

// LIVE-3.21: they go out with the write that began behind them, once.
TEST(AnswersDue, GoOutWithTheirWrite) {
  AnswersDue due;
  due.Add(AnswerTo(1), false);
  due.Add(AnswerTo(2), false);
  const auto first = due.Begin(0ns);
  due.Add(AnswerTo(3), false);
  const auto second = due.Begin(1ns);
  EXPECT_THAT(NumbersOf(first->answers), ElementsAre(1, 2));
  EXPECT_THAT(NumbersOf(second->answers), ElementsAre(3));
  EXPECT_THAT(due.Begin(2ns)->answers, IsEmpty());
  due.End(first);
  EXPECT_THAT(NumbersOf(due.TakeLate(2s, 1s)), ElementsAre(3));
}

// LIVE-3.21: whoever waits for longer than that is told that it acts and is not on the disk, and is
// not answered again.
TEST(AnswersDue, LateOnesAreToldSo) {
  AnswersDue due;
  due.Add(AnswerTo(1), false);
  const auto first = due.Begin(5s);
  due.Add(AnswerTo(2), false);
  const auto second = due.Begin(6s);
  EXPECT_THAT(due.TakeLate(6s, 1s), IsEmpty());
  const auto late = due.TakeLate(6s + 1ns, 1s);
  ASSERT_THAT(NumbersOf(late), ElementsAre(1));
  EXPECT_EQ(late[0].refusal().code(), "CELL-E9429");
  EXPECT_THAT(first->answers, IsEmpty());
  EXPECT_THAT(NumbersOf(second->answers), ElementsAre(2));
}

// LIVE-5.07: the queue would begin a job again that was refused: it hears when it is on the disk.
TEST(AnswersDue, ThatOfAJobIsNeverARefusal) {
  AnswersDue due;
  due.Add(AnswerTo(1), true);
  due.Add(AnswerTo(2), false);
  const auto batch = due.Begin(0ns);
  EXPECT_THAT(NumbersOf(due.TakeLate(60s, 1s)), ElementsAre(2));
  EXPECT_THAT(NumbersOf(batch->of_jobs), ElementsAre(1));
  EXPECT_TRUE(batch->of_jobs[0].has_status());
}

// LIVE-3.06: over another line nobody has asked for them; those of further servers stay.
TEST(AnswersDue, AreOfTheirLine) {
  AnswersDue due;
  due.Add(AnswerTo(1), false);
  due.Add(AnswerTo(-1), false);
  const auto batch = due.Begin(0ns);
  due.Add(AnswerTo(2), false);
  due.Add(AnswerTo(-2), false);
  due.ForgetLine();
  EXPECT_THAT(NumbersOf(batch->answers), ElementsAre(-1));
  EXPECT_THAT(NumbersOf(due.Begin(0ns)->answers), ElementsAre(-2));
}

}  // namespace
}  // namespace rmlcell::server
