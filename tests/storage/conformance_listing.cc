// Which jobs are listed, in which order and in which pages (store.h JobQuery).
#include <gmock/gmock.h>

#include <map>
#include <span>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// store.h JobQuery: newest first, pages cover everything once, also while jobs come in.
TEST_P(StoreConformance, JobsAreListedInPages) {
  std::vector<std::int64_t> submitted;
  for (int i = 0; i < 7; ++i) submitted.insert(submitted.begin(), Submit().id);
  std::vector<std::int64_t> listed;
  JobQuery query{.limit = 3};
  for (;;) {
    const std::vector<JobRecord> page = Must(store().ListJobs(query));
    if (page.empty()) break;
    for (const JobRecord& job : page) listed.push_back(job.id);
    query.behind = PlaceOf(page.back());
    Submit();
  }
  EXPECT_EQ(listed, submitted);
  EXPECT_THAT(Must(store().ListJobs({.limit = 0})), IsEmpty());
  EXPECT_THAT(Must(store().ListJobs({.limit = -5})), IsEmpty());
}

// What no index helps to find, alone and together, counted too.
TEST_P(StoreConformance, JobsAreFoundByWhatIsInThem) {
  const std::vector<std::string> families = {"optimo", "rml1"};
  const std::vector<std::string> titles = {"Bracket left", "lid", "BRACKET 50% right"};
  const std::vector<std::string> verdicts = {"GOOD", "BAD", ""};
  std::vector<JobRecord> all;
  for (std::size_t i = 0; i < 24; ++i) {
    Must(store().SubmitAndWait(
        {.machine = "m1", .family = families[i % 2], .kind = "CHECK", .title = titles[i / 2 % 3]}));
    clock().Advance(std::chrono::seconds(10));
  }
  for (std::size_t i = 0; i < 18; ++i) {
    const LeasedJob leased = Acquire("w", "CHECK");
    JobEnd end;
    end.outcome.state = i % 4 == 3 ? JobState::kFailed : JobState::kSucceeded;
    end.outcome.verdict = verdicts[i % 3];
    Must(store().Finish(leased.lease, end));
  }
  all = Must(store().ListJobs({.limit = 1000}));
  ASSERT_EQ(all.size(), 24U);
  EXPECT_EQ(all.back().family, "optimo");
  EXPECT_EQ(all.back().outcome->verdict, "GOOD");
  const WallTime middle = all[11].created_at;
  const auto fits = [](const JobQuery& query, const JobRecord& job) {
    return (query.family.empty() || job.family == query.family) &&
           (query.verdict.empty() || (job.outcome && job.outcome->verdict == query.verdict)) &&
           (query.text.empty() || (query.text == "bracket") == (job.title != "lid")) &&
           (!query.created_from || job.created_at >= *query.created_from) &&
           (!query.created_before || job.created_at < *query.created_before);
  };
  for (const char* family : {"", "rml1"}) {
    for (const char* verdict : {"", "BAD"}) {
      for (const char* text : {"", "bracket", "LID"}) {
        for (const int times : {0, 1, 2}) {
          JobQuery query{.family = family, .verdict = verdict, .text = text, .limit = 1000};
          if (times == 1) query.created_from = middle;
          if (times == 2) query.created_before = middle;
          std::vector<std::int64_t> found;
          std::map<JobState, std::int64_t> counts;
          for (const JobRecord& job : all) {
            if (!fits(query, job)) continue;
            found.push_back(job.id);
            ++counts[job.state];
          }
          EXPECT_EQ(IdsOf(Must(store().ListJobs(query))), found) << family << verdict << text;
          std::map<JobState, std::int64_t> counted;
          for (const JobStateCount& count : Must(store().CountByState(query)))
            counted[count.state] = count.jobs;
          EXPECT_EQ(counted, counts);
        }
      }
    }
  }
  // A sign of a pattern is itself.
  EXPECT_EQ(Must(store().ListJobs({.text = "50%", .limit = 1000})).size(), 8U);
  EXPECT_THAT(Must(store().ListJobs({.text = "5_%", .limit = 1000})), IsEmpty());
}

// Whole labels, and the counts with them.
TEST_P(StoreConformance, JobsAreFoundByTheirLabels) {
  const auto put = [&](std::vector<std::string> labels) {
    return Must(store().SubmitAndWait({.kind = "SIMULATE", .labels = std::move(labels)})).job.id;
  };
  const auto first = put({"a", "order-1"});
  const auto second = put({"order-11"});
  const auto third = put({"order-1", "b", "c"});
  put({});
  Finish(Acquire("w", "SIMULATE").lease, JobState::kSucceeded);  // the first
  Reopen();
  EXPECT_THAT(IdsOf(Must(store().ListJobs({.label = "order-1"}))), ElementsAre(third, first));
  EXPECT_THAT(IdsOf(Must(store().ListJobs({.label = "order-11"}))), ElementsAre(second));
  EXPECT_THAT(IdsOf(Must(store().ListJobs({.label = "c"}))), ElementsAre(third));
  EXPECT_THAT(Must(store().ListJobs({.label = "order"})), IsEmpty());
  EXPECT_THAT(Must(store().GetJob(third)).labels, ElementsAre("order-1", "b", "c"));
  EXPECT_THAT(Must(store().GetJob(first)).labels, ElementsAre("a", "order-1"));
  std::int64_t counted = 0;
  for (const JobStateCount& count : Must(store().CountByState({.label = "order-1"})))
    counted += count.jobs;
  EXPECT_EQ(counted, 2);
}

// The order in which jobs run, and the pages of each order.
TEST_P(StoreConformance, JobsAreListedInTheOrderOfTheQueue) {
  std::vector<std::int64_t> ids;
  for (int i = 0; i < 12; ++i) ids.push_back(Submit().id);
  Finish(Acquire("w", "SIMULATE").lease, JobState::kSucceeded);  // 0
  Finish(Acquire("w", "SIMULATE").lease, JobState::kFailed);     // 1
  Acquire("w", "SIMULATE");                                      // 2
  Acquire("w", "SIMULATE");                                      // 3
  Must(store().HoldBack(ids[4], {}));
  Must(store().Move(ids[9], 0, 5, {}));
  Must(store().Move(ids[8], ids[6], std::nullopt, {}));
  Must(store().RequestCancel(ids[11], {}));  // behind one that waits comes one of a higher number
  const std::vector<std::int64_t> order = {ids[2], ids[3],  ids[9], ids[5],  ids[8], ids[6],
                                           ids[7], ids[10], ids[4], ids[11], ids[1], ids[0]};
  for (const JobOrder wanted : {JobOrder::kQueue, JobOrder::kOldestFirst, JobOrder::kNewestFirst}) {
    std::vector<std::int64_t> expected = order;
    if (wanted == JobOrder::kOldestFirst) expected = ids;
    if (wanted == JobOrder::kNewestFirst) expected.assign(ids.rbegin(), ids.rend());
    for (const int limit : {1, 2, 5, 100}) {
      std::vector<std::int64_t> listed;
      JobQuery query{.order = wanted, .limit = limit};
      for (;;) {
        const std::vector<JobRecord> page = Must(store().ListJobs(query));
        if (page.empty()) break;
        ASSERT_LE(page.size(), static_cast<std::size_t>(limit));
        for (const JobRecord& job : page) listed.push_back(job.id);
        query.behind = PlaceOf(page.back());
      }
      EXPECT_EQ(listed, expected) << static_cast<int>(wanted) << ' ' << limit;
    }
  }
  EXPECT_THAT(
      IdsOf(Must(store().ListJobs({.finished = false, .order = JobOrder::kQueue, .limit = 3}))),
      ElementsAre(ids[2], ids[3], ids[9]));
  EXPECT_THAT(
      IdsOf(Must(store().ListJobs({.state = JobState::kSucceeded, .order = JobOrder::kQueue}))),
      ElementsAre(ids[0]));
}

// Of the whole list in each order: those that fit, from any place on, up to the limit.
TEST_P(StoreConformance, StatesAreAskedForInEveryOrder) {
  std::vector<std::int64_t> ids;
  for (int i = 0; i < 8; ++i) ids.push_back(Submit().id);
  Finish(Acquire().lease, JobState::kSucceeded);  // 0
  Finish(Acquire().lease, JobState::kFailed);     // 1
  for (int i = 0; i < 2; ++i) Acquire();          // 2 and 3
  Must(store().HoldBack(ids[4], {}));
  Must(store().Move(ids[7], ids[5], std::nullopt, {}));
  Must(store().RequestCancel(ids[6], {}));
  const auto fitting = [](std::span<const JobRecord> jobs, const JobQuery& query) {
    std::vector<std::int64_t> found;
    for (const JobRecord& job : jobs) {
      const bool fits = (!query.state || job.state == *query.state) &&
                        (!query.finished || IsFinal(job.state) == *query.finished);
      if (fits && found.size() < static_cast<std::size_t>(query.limit)) found.push_back(job.id);
    }
    return found;
  };
  const std::optional<JobState> states[] = {std::nullopt, JobState::kQueued, JobState::kRunning,
                                            JobState::kSucceeded, JobState::kCancelled};
  const std::optional<bool> ends[] = {std::nullopt, true, false};
  for (const JobOrder order : {JobOrder::kQueue, JobOrder::kOldestFirst, JobOrder::kNewestFirst}) {
    const std::vector<JobRecord> all = Must(store().ListJobs({.order = order, .limit = 100}));
    ASSERT_EQ(all.size(), ids.size());
    for (std::size_t from = 0; from <= all.size(); ++from) {
      for (const auto& state : states) {
        for (const auto& finished : ends) {
          for (const int limit : {1, 3, 100}) {
            JobQuery query{.state = state, .finished = finished, .order = order, .limit = limit};
            if (from > 0) query.behind = PlaceOf(all[from - 1]);
            ASSERT_EQ(IdsOf(Must(store().ListJobs(query))),
                      fitting(std::span(all).subspan(from), query))
                << static_cast<int>(order) << ' ' << from << ' '
                << (state ? static_cast<int>(*state) : -1) << ' '
                << (finished ? static_cast<int>(*finished) : -1) << ' ' << limit;
          }
        }
      }
    }
  }
}

// Every filter, alone and together, against a plain filter over all jobs.
TEST_P(StoreConformance, FiltersAgreeWithAPlainSearch) {
  const std::vector<std::string> kinds = {"CHECK", "SIMULATE", "RUN"};
  const std::vector<std::string> machines = {"m1", "m2"};
  const std::vector<std::string> callers = {"anna", "bo"};
  for (int i = 0; i < 60; ++i) {
    const auto n = static_cast<std::size_t>(i);
    Must(store().SubmitAndWait(
        {.machine = machines[n / 3 % 2], .kind = kinds[n % 3], .caller = callers[n / 6 % 2]}));
  }
  const JobState ends[] = {JobState::kSucceeded, JobState::kFailed, JobState::kCancelled,
                           JobState::kInterrupted};
  for (int i = 0; i < 40; ++i) {
    const LeasedJob leased = Acquire("w", kinds[static_cast<std::size_t>(i % 3)]);
    // The others go on running; a RUN would keep its machine from the next one.
    if (i % 5 != 4 || i % 3 == 2) Finish(leased.lease, ends[i % 4]);
  }
  const std::vector<JobRecord> all = Must(store().ListJobs({.limit = 1000}));
  ASSERT_EQ(all.size(), 60U);

  const auto search = [&](const JobQuery& query) {
    std::vector<std::int64_t> found;
    for (const JobRecord& job : all) {
      const bool fits = (query.machine.empty() || job.machine == query.machine) &&
                        (!query.state || job.state == *query.state) &&
                        (query.kind.empty() || job.kind == query.kind) &&
                        (query.caller.empty() || job.caller == query.caller) &&
                        (!query.finished || IsFinal(job.state) == *query.finished) &&
                        (!query.behind || job.id < query.behind->id);
      if (fits && found.size() < static_cast<std::size_t>(query.limit)) found.push_back(job.id);
    }
    return found;
  };
  std::vector<std::optional<JobState>> states = {std::nullopt};
  for (int state = 0; state <= 5; ++state) states.emplace_back(static_cast<JobState>(state));
  int compared = 0;
  for (const char* machine : {"", "m1", "m3"}) {
    for (const auto& state : states) {
      for (const char* kind : {"", "CHECK", "RUN"}) {
        for (const char* caller : {"", "anna"}) {
          for (const std::optional<bool> finished :
               {std::optional<bool>(), std::optional(true), std::optional(false)}) {
            for (const auto& behind :
                 {std::optional<JobPlace>(), std::optional(PlaceOf(all[25]))}) {
              for (const int limit : {4, 1000}) {
                const JobQuery query{.machine = machine,
                                     .state = state,
                                     .kind = kind,
                                     .caller = caller,
                                     .finished = finished,
                                     .limit = limit,
                                     .behind = behind};
                ASSERT_EQ(IdsOf(Must(store().ListJobs(query))), search(query))
                    << machine << ' ' << (state ? static_cast<int>(*state) : -1) << ' ' << kind
                    << ' ' << caller << ' ' << (finished ? static_cast<int>(*finished) : -1) << ' '
                    << behind.has_value() << ' ' << limit;
                ++compared;
              }
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(compared, 3 * 7 * 3 * 2 * 3 * 2 * 2);
}

}  // namespace
}  // namespace rmlcell::storage
