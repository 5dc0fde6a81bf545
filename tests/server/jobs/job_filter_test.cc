#include "server/jobs/job_filter.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using storage::JobQuery;
using storage::JobState;

JobQuery Applied(std::string_view filter) {
  JobQuery query;
  const Status applied = ApplyFilter(filter, query);
  EXPECT_TRUE(applied) << filter << ": " << applied.error().detail;
  return query;
}

TEST(JobFilter, AnEmptyOneAsksForAll) {
  for (const std::string_view filter : {"", " ", "\t\n"}) {
    const JobQuery query = Applied(filter);
    EXPECT_EQ(query.machine, "");
    EXPECT_EQ(query.kind, "");
    EXPECT_EQ(query.caller, "");
    EXPECT_FALSE(query.state);
    EXPECT_FALSE(query.finished);
  }
}

TEST(JobFilter, ComparesEachField) {
  const std::vector<std::pair<std::string, JobState>> states = {
      {"QUEUED", JobState::kQueued},       {"RUNNING", JobState::kRunning},
      {"SUCCEEDED", JobState::kSucceeded}, {"FAILED", JobState::kFailed},
      {"CANCELLED", JobState::kCancelled}, {"INTERRUPTED", JobState::kInterrupted}};
  for (const auto& [name, state] : states) {
    EXPECT_EQ(Applied("state = " + name).state, state);
    EXPECT_EQ(Applied("state=STATE_" + name).state, state);
  }
  EXPECT_EQ(Applied("state = failed").state, JobState::kFailed);
  EXPECT_EQ(Applied("machine = machines/optimo-1").machine, "optimo-1");
  EXPECT_EQ(Applied("machine = optimo-1").machine, "optimo-1");
  EXPECT_EQ(Applied("machine = \"machines/optimo-1\"").machine, "optimo-1");
  for (const std::string kind : {"CHECK", "SIMULATE", "RUN"}) {
    EXPECT_EQ(Applied("kind = " + kind).kind, kind);
    EXPECT_EQ(Applied("kind = JOB_KIND_" + kind).kind, kind);
  }
  EXPECT_EQ(Applied("caller = \"a person = AND more\"").caller, "a person = AND more");
  EXPECT_EQ(Applied("caller = \"=\"").caller, "=");
  EXPECT_EQ(Applied("finished = true").finished, true);
  EXPECT_EQ(Applied("finished=false").finished, false);
  EXPECT_EQ(Applied("family = rml1").family, "rml1");
  EXPECT_EQ(Applied("verdict = bad").verdict, "BAD");
  EXPECT_EQ(Applied("verdict = VERDICT_DOUBTFUL").verdict, "DOUBTFUL");
  EXPECT_EQ(Applied("text = \"left lid\"").text, "left lid");
  const storage::WallTime noon(std::chrono::seconds(1'764'072'000));
  EXPECT_EQ(Applied("since = 2025-11-25T12:00:00Z").created_from, noon);
  EXPECT_EQ(Applied("until = 2025-11-25T13:00:00.5+01:00").created_before,
            noon + std::chrono::milliseconds(500));
}

TEST(JobFilter, JoinsComparisonsByAnd) {
  const JobQuery query =
      Applied("state=FAILED AND machine=m and kind = CHECK And caller = c AND finished = true");
  EXPECT_EQ(query.state, JobState::kFailed);
  EXPECT_EQ(query.machine, "m");
  EXPECT_EQ(query.kind, "CHECK");
  EXPECT_EQ(query.caller, "c");
  EXPECT_EQ(query.finished, true);
  // A text in double quotes ends with them.
  const JobQuery close = Applied("caller=\"anna\"AND text=\"lid\"AND kind=RUN");
  EXPECT_EQ(close.caller, "anna");
  EXPECT_EQ(close.text, "lid");
  EXPECT_EQ(close.kind, "RUN");
}

// A filter that is not understood must not ask for something else.
TEST(JobFilter, RefusesWhatItDoesNotUnderstandAndLeavesTheQueryAsItWas) {
  for (const std::string filter : {"state",
                                   "state =",
                                   "= FAILED",
                                   "state FAILED",
                                   "state == FAILED",
                                   "state != FAILED",
                                   "state > FAILED",
                                   "state = LOST",
                                   "state = \"\"",
                                   "kind = MOVE",
                                   "kind = \"\"",
                                   "machine = machines/A",
                                   "machine = \"\"",
                                   "machine = projects/a",
                                   "finished = maybe",
                                   "finished = TRUE",
                                   "caller = \"\"",
                                   "caller = \"open",
                                   "user = a",
                                   "family = lathe",
                                   "verdict = WORSE",
                                   "verdict = \"\"",
                                   "text = \"\"",
                                   "since = yesterday",
                                   "until = 2025-11-25",
                                   "STATE = FAILED",
                                   "state = FAILED AND",
                                   "AND state = FAILED",
                                   "state = FAILED kind = CHECK",
                                   "state = FAILED OR kind = CHECK",
                                   "state = FAILED \"AND\" kind = CHECK",
                                   "state = FAILED AND state = QUEUED",
                                   "NOT state = FAILED",
                                   "(state = FAILED)",
                                   "state \"=\" FAILED",
                                   "\"state\" = FAILED",
                                   "state = FAILED,QUEUED"}) {
    JobQuery query{.machine = "before"};
    const Status applied = ApplyFilter(filter, query);
    ASSERT_FALSE(applied) << filter;
    EXPECT_EQ(applied.error().code, ErrorCode::kCellBadFilter) << filter;
    EXPECT_EQ(query.machine, "before") << filter;
    EXPECT_FALSE(query.state) << filter;
    EXPECT_EQ(query.kind, "") << filter;
  }
}

TEST(JobFilter, AnErrorSaysWhatWasExpected) {
  const auto detail = [](const std::string& filter) {
    JobQuery query;
    const Status applied = ApplyFilter(filter, query);
    return applied ? "none" : applied.error().detail;
  };
  EXPECT_EQ(detail("state"), "expected is FIELD = VALUE, found 'state'");
  EXPECT_EQ(detail("state = FAILED AND kind ="), "expected is FIELD = VALUE, found 'kind'");
  // A sign is neither a field nor a value.
  EXPECT_EQ(detail("caller == a"), "expected is FIELD = VALUE, found 'caller'");
  EXPECT_EQ(detail("caller = ="), "expected is FIELD = VALUE, found 'caller'");
  EXPECT_EQ(detail("= = a"), "expected is FIELD = VALUE, found '='");
  EXPECT_EQ(detail("state = FAILED AND"), "comparisons are joined by AND, found 'AND'");
  EXPECT_EQ(detail("state = FAILED OR kind = CHECK"), "comparisons are joined by AND, found 'OR'");
  EXPECT_EQ(detail("state = FAILED AND state = QUEUED"), "'state' stands twice");
  EXPECT_EQ(detail("state = LOST"),
            "no state 'LOST'; there are QUEUED, RUNNING, SUCCEEDED, FAILED, CANCELLED, "
            "INTERRUPTED");
  EXPECT_EQ(detail("kind = MOVE"), "no kind 'MOVE'; there are CHECK, SIMULATE, RUN");
  EXPECT_EQ(detail("caller = \"\""), "caller is empty");
  EXPECT_EQ(detail("finished = maybe"), "finished is true or false, not 'maybe'");
  EXPECT_EQ(detail("user = a"),
            "no field 'user'; there are state, machine, kind, caller, finished, family, verdict, "
            "label, text, since, until");
  EXPECT_EQ(detail("verdict = WORSE"), "no verdict 'WORSE'; there are GOOD, DOUBTFUL, BAD");
  EXPECT_EQ(detail("family = lathe"), "no family 'lathe'");
  EXPECT_EQ(detail("since = yesterday"),
            "since is a time such as 2026-11-25T10:00:00Z, not 'yesterday'");
  EXPECT_EQ(detail("caller = \"open"), "a quoted text has no end");
  EXPECT_EQ(detail("machine = machines/A"),
            "machine: name is 'machines/A', expected is machines/ID");
  EXPECT_EQ(detail("label = \"a b\""), "no label 'a b'");
  // Eleven comparisons are 43 words; more are refused before they are read.
  const std::string all =
      "state=FAILED AND machine=m AND kind=RUN AND caller=c AND finished=true AND family=rml1 AND "
      "verdict=BAD AND label=a AND text=a AND since=2026-01-01T00:00:00Z AND "
      "until=2026-02-01T00:00:00Z";
  EXPECT_EQ(detail(all), "none");
  EXPECT_EQ(detail(all + " AND"), "the filter has too many words");
}

TEST(JobFilter, Orders) {
  using storage::JobOrder;
  EXPECT_EQ(*ReadJobOrder(""), JobOrder::kNewestFirst);
  EXPECT_EQ(*ReadJobOrder("create_time desc"), JobOrder::kNewestFirst);
  EXPECT_EQ(*ReadJobOrder("create_time"), JobOrder::kOldestFirst);
  EXPECT_EQ(*ReadJobOrder("queue"), JobOrder::kQueue);
  EXPECT_EQ(ReadJobOrder("title").error().code, ErrorCode::kCellInvalidArgument);
}

TEST(JobFilter, PlacesOfPagesComeBackAsTheyWere) {
  const storage::JobPlace places[] = {
      {.id = 17, .place = 17.0},
      {.id = 1'000'000'000'000'000, .state = JobState::kInterrupted, .priority = -100},
      {.id = 5, .state = JobState::kRunning, .blocked = true, .priority = 100, .place = -0.1}};
  for (const storage::JobPlace& place : places)
    EXPECT_EQ(*ReadJobPlace(WriteJobPlace(place)), place) << WriteJobPlace(place);
}

TEST(JobFilter, AnErrorStaysShortAndReadable) {
  for (const std::string& filter :
       {"state = " + std::string(1 << 20, 'x'), std::string(1 << 20, 'x') + " = 1",
        "machine = " + std::string(1 << 20, 'x'), std::string("state = \xFF\x01\x1B[2J"),
        "state = FAILED " + std::string(1 << 20, 'y') + " kind = RUN"}) {
    JobQuery query;
    const Status applied = ApplyFilter(filter, query);
    ASSERT_FALSE(applied);
    EXPECT_LT(applied.error().detail.size(), 300U);
    for (const char c : applied.error().detail) EXPECT_TRUE(c >= 0x20 && c < 0x7F);
  }
  std::string many = "state = FAILED";
  for (int i = 0; i < 100'000; ++i) many += " AND state = FAILED";
  JobQuery query;
  EXPECT_FALSE(ApplyFilter(many, query));
}

}  // namespace
}  // namespace rmlcell::server
