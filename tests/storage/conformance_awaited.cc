// store.h AwaitJobs: who has time is given a job by the transaction that makes one.
#include <gmock/gmock.h>

#include <future>
#include <mutex>
#include <set>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

JobRequest RequestOf(const std::string& worker, const std::string& kind = "SIMULATE") {
  return {.worker = worker,
          .server = "s",
          .kinds = {kind},
          .duration = kLease,
          .events = {{.kind = "state", .payload = "running"}}};
}

// What a request was given, and how often it was answered.
struct Given {
  std::mutex mutex;
  int answers = 0;
  std::vector<LeasedJob> jobs;
};

// Asks, and waits until the request stands, if it was not answered: the store writes in order.
class Asking {
 public:
  explicit Asking(Store& store) : store_(store) {}

  std::shared_ptr<Given> Await(JobRequest request, std::int64_t* number = nullptr) const {
    auto given = std::make_shared<Given>();
    const std::int64_t known_by =
        store_.AwaitJobs(std::move(request), [given](Result<std::vector<LeasedJob>> leased) {
          const std::lock_guard lock(given->mutex);
          ++given->answers;
          if (leased) given->jobs = *std::move(leased);
        });
    if (number != nullptr) *number = known_by;
    Pass();
    return given;
  }
  // Until all that was asked for before is done.
  void Pass() const { Must(store_.ActOn({}, QueueAct::kHold, {})); }

 private:
  Store& store_;
};

std::vector<std::int64_t> JobsOf(Given& given) {
  const std::lock_guard lock(given.mutex);
  std::vector<std::int64_t> ids;
  for (const LeasedJob& job : given.jobs) ids.push_back(job.lease.job);
  return ids;
}

int AnswersOf(Given& given) {
  const std::lock_guard lock(given.mutex);
  return given.answers;
}

TEST_P(StoreConformance, AwaitedOneThatIsThereIsGivenAtOnce) {
  const Asking asking(store());
  const JobRecord job = Submit();
  const auto given = asking.Await(RequestOf("w"));
  ASSERT_EQ(given->jobs.size(), 1U);
  EXPECT_EQ(given->jobs[0].lease.job, job.id);
  EXPECT_EQ(given->jobs[0].lease.worker, "w");
  EXPECT_EQ(given->jobs[0].job.specification, job.specification);
}

// Nobody sees it wait: whoever made it finds it running.
TEST_P(StoreConformance, AwaitedOneThatComesIsGivenAsItIsMade) {
  const Asking asking(store());
  const auto given = asking.Await(RequestOf("w"));
  EXPECT_EQ(AnswersOf(*given), 0);
  const JobRecord made =
      Must(store().SubmitAndWait({.machine = "optimo-1",
                                  .kind = "SIMULATE",
                                  .specification = "what to do",
                                  .events = {{.kind = "state", .payload = "queued"}}}))
          .job;
  EXPECT_THAT(JobsOf(*given), ElementsAre(made.id));
  EXPECT_EQ(given->jobs[0].job.specification, "what to do");
  EXPECT_EQ(Must(store().GetJob(made.id)).state, JobState::kRunning);
  const auto events = EventsOf(made.id);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].payload, "queued");
  EXPECT_EQ(events[1].payload, "running");
  EXPECT_EQ(Must(store().CountJobs()).running, 1);
  EXPECT_EQ(Must(store().CountJobs()).queued, 0);
  Finish(given->jobs[0].lease);
  EXPECT_EQ(AnswersOf(*given), 1);
  EXPECT_EQ(Must(store().GetJob(Submit().id)).state, JobState::kQueued);  // it was for one
}

// Whatever lets a job begin.
TEST_P(StoreConformance, AwaitedOneThatMayBeginFromNowOnIsGiven) {
  const Asking asking(store());
  const auto given_by = [&](const std::string& how, const std::function<void()>& act) {
    const auto given = asking.Await(RequestOf("w"));
    EXPECT_EQ(AnswersOf(*given), 0) << how;
    act();
    EXPECT_EQ(AnswersOf(*given), 1) << how;
    return given->jobs.empty() ? Lease{} : given->jobs[0].lease;
  };
  const std::int64_t held =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .attempts_max = 9, .held = true})).job.id;
  Lease lease = given_by("let go", [&] { Must(store().LetGo(held, {})); });
  EXPECT_EQ(lease.job, held);
  lease = given_by("handed back", [&] { Must(store().HandBack(lease, PolicyOfTests())); });
  EXPECT_EQ(lease.job, held);
  lease = given_by("abandoned", [&] { Must(store().Abandon(lease, PolicyOfTests())); });
  EXPECT_EQ(lease.job, held);
  lease = given_by("run out", [&] {
    clock().Advance(kLease + 1ms);
    Must(store().Expire(PolicyOfTests()));
  });
  EXPECT_EQ(lease.job, held);
  const std::int64_t behind =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .after = {held}})).job.id;
  lease = given_by("behind another", [&] { Finish(lease); });
  EXPECT_EQ(lease.job, behind);
  Finish(lease);
  const std::int64_t late =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .not_before = clock().Now() + 1h})).job.id;
  lease = given_by("in its time", [&] {
    clock().Advance(1h);
    Must(store().Expire(PolicyOfTests()));
  });
  EXPECT_EQ(lease.job, late);
}

// A machine runs one RUN at a time: the next begins with the end of the first.
TEST_P(StoreConformance, AwaitedARunIsGivenWhenItsMachineIsFree) {
  const Asking asking(store());
  Submit("RUN", "optimo-1");
  const std::int64_t second = Submit("RUN", "optimo-1").id;
  const auto first = asking.Await(RequestOf("w", "RUN"));
  ASSERT_EQ(first->jobs.size(), 1U);
  const auto given = asking.Await(RequestOf("w", "RUN"));
  EXPECT_EQ(AnswersOf(*given), 0);
  Finish(first->jobs[0].lease);
  EXPECT_THAT(JobsOf(*given), ElementsAre(second));
}

TEST_P(StoreConformance, AwaitedOneThatDoesNotFitIsLeft) {
  const Asking asking(store());
  const auto checks = asking.Await(RequestOf("w", "CHECK"));
  JobRequest in_pool = RequestOf("p");
  in_pool.pools = {"paced"};
  const auto paced = asking.Await(std::move(in_pool));
  const std::int64_t job = Submit("SIMULATE").id;
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kQueued);
  const std::int64_t check = Submit("CHECK").id;
  EXPECT_THAT(JobsOf(*checks), ElementsAre(check));
  const std::int64_t slow =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .pool = "paced"})).job.id;
  EXPECT_THAT(JobsOf(*paced), ElementsAre(slow));
  EXPECT_EQ(Must(store().GetJob(job)).state, JobState::kQueued);
}

// Who asks for the runs of one machine, or for one job, does not ask for those of another.
TEST_P(StoreConformance, AwaitedEachIsGivenWhatItAsksFor) {
  const Asking asking(store());
  JobRequest of_first = RequestOf("a", "RUN");
  of_first.run_machines = {"m1"};
  JobRequest of_second = RequestOf("b", "RUN");
  of_second.run_machines = {"m2"};
  const auto first = asking.Await(of_first);
  const auto second = asking.Await(of_second);
  const std::int64_t run = Submit("RUN", "m2").id;
  EXPECT_THAT(JobsOf(*second), ElementsAre(run));
  EXPECT_EQ(AnswersOf(*first), 0);
  const std::int64_t runs = (Submit(), Acquire().job.id);
  const std::int64_t held = Must(store().SubmitAndWait({.kind = "SIMULATE", .held = true})).job.id;
  JobRequest for_one = RequestOf("c");
  for_one.job = runs;
  JobRequest for_another = RequestOf("d");
  for_another.job = held;
  const auto one = asking.Await(for_one);
  const auto another = asking.Await(for_another);
  EXPECT_EQ(AnswersOf(*another), 0);
  Must(store().LetGo(held, {}));
  EXPECT_THAT(JobsOf(*another), ElementsAre(held));
  EXPECT_EQ(AnswersOf(*one), 0);
}

// Who finds nothing speaks for none that asks for another kind or in another pool.
TEST_P(StoreConformance, AwaitedOthersAreAskedBehindWhoFindsNothing) {
  const Asking asking(store());
  const auto checks = asking.Await(RequestOf("a", "CHECK"));
  const auto simulates = asking.Await(RequestOf("b", "SIMULATE"));
  JobRequest in_pool = RequestOf("c", "SIMULATE");
  in_pool.pools = {"paced"};
  const auto paced = asking.Await(std::move(in_pool));
  const std::int64_t slow =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .pool = "paced"})).job.id;
  EXPECT_THAT(JobsOf(*paced), ElementsAre(slow));
  EXPECT_EQ(AnswersOf(*simulates), 0);
  const std::int64_t job = Submit("SIMULATE").id;
  EXPECT_THAT(JobsOf(*simulates), ElementsAre(job));
  EXPECT_EQ(AnswersOf(*checks), 0);
}

// The one that has waited longest first, and one job each, also of those that come together.
TEST_P(StoreConformance, AwaitedWhoWaitsLongestIsFirst) {
  const Asking asking(store());
  std::vector<std::shared_ptr<Given>> given;
  for (int i = 0; i < 3; ++i) given.push_back(asking.Await(RequestOf("w" + std::to_string(i))));
  std::vector<std::int64_t> jobs;
  for (int i = 0; i < 4; ++i) jobs.push_back(Submit().id);
  for (std::size_t i = 0; i < given.size(); ++i)
    EXPECT_THAT(JobsOf(*given[i]), ElementsAre(jobs[i]));
  EXPECT_EQ(Must(store().GetJob(jobs[3])).state, JobState::kQueued);
  EXPECT_EQ(given[1]->jobs[0].lease.worker, "w1");
}

TEST_P(StoreConformance, AwaitedOneThatIsWithdrawnGetsNothing) {
  const Asking asking(store());
  std::int64_t number = 0;
  const auto given = asking.Await(RequestOf("w"), &number);
  const auto other = asking.Await(RequestOf("other"));
  store().Withdraw(number);
  store().Withdraw(number);
  asking.Pass();
  EXPECT_EQ(AnswersOf(*given), 1);
  EXPECT_THAT(JobsOf(*given), ElementsAre());
  const std::int64_t job = Submit().id;
  EXPECT_THAT(JobsOf(*other), ElementsAre(job));
  EXPECT_EQ(AnswersOf(*given), 1);
}

// Withdrawn as it is given a job: it has that, and is not answered twice.
TEST_P(StoreConformance, AwaitedOneThatWasAnsweredIsNotAnsweredAgain) {
  const Asking asking(store());
  std::int64_t number = 0;
  const auto given = asking.Await(RequestOf("w"), &number);
  const std::int64_t job = Submit().id;
  store().Withdraw(number);
  asking.Pass();
  EXPECT_EQ(AnswersOf(*given), 1);
  EXPECT_THAT(JobsOf(*given), ElementsAre(job));
}

TEST_P(StoreConformance, AwaitedAStoreThatGoesAnswersAll) {
  const Asking asking(store());
  const auto given = asking.Await(RequestOf("w"));
  Reopen();
  EXPECT_EQ(AnswersOf(*given), 1);
  EXPECT_THAT(JobsOf(*given), ElementsAre());
  EXPECT_EQ(Must(store().GetJob(Submit().id)).state, JobState::kQueued);
}

// A submission that is refused beside others undoes nothing of what they are given.
TEST_P(StoreConformance, AwaitedManyAtOnceAreGivenOnceEach) {
  const Asking asking(store());
  std::vector<std::shared_ptr<Given>> given;
  for (int i = 0; i < 20; ++i) given.push_back(asking.Await(RequestOf("w" + std::to_string(i))));
  std::vector<std::promise<Result<SubmittedJob>>> answers(30);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    NewJob job{.request_id = "r" + std::to_string(i / 2 * 2 == i ? i : i - 1),
               .request_hash = std::to_string(i),
               .kind = "SIMULATE"};
    store().Submit(std::move(job), [&answers, i](Result<SubmittedJob> made) {
      answers[i].set_value(std::move(made));
    });
  }
  std::set<std::int64_t> made;
  for (auto& answer : answers) {
    const auto one = answer.get_future().get();
    if (one) made.insert(one->job.id);
  }
  EXPECT_EQ(made.size(), 15U);  // of two with the same request id the second is refused
  asking.Pass();
  std::set<std::int64_t> leased;
  for (const auto& one : given) {
    for (const std::int64_t id : JobsOf(*one)) EXPECT_TRUE(leased.insert(id).second);
  }
  EXPECT_EQ(leased, made);
}

}  // namespace
}  // namespace rmlcell::storage
