// What proves that the program of a RUN was simulated (live.md 5.02).
#include "server/runs/run_ticket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;

class RunTicketTest : public testing::Test {
 protected:
  std::int64_t Submit(const std::function<void(v1::Job&)>& change = [](v1::Job&) {}) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("a.rml");
    job.mutable_inline_program()->set_content("PA;PU100,0;");
    job.set_inline_slot(7);
    change(job);
    std::int64_t id = 0;
    book.Submit(request, "anna", [&](const Result<v1::Job>& made) {
      if (made) id = *ParseJobName(made->name());
    });
    EXPECT_TRUE(Eventually([&] { return id != 0; }));
    return id;
  }
  // As a worker ends it.
  void End(JobState state, v1::Verdict verdict, const std::optional<v1::RunReport>& report) {
    const auto leased = bed.store().AcquireJobs({.worker = "w",
                                                 .server = "this server",
                                                 .kinds = {"SIMULATE", "CHECK"},
                                                 .duration = std::chrono::seconds(60)});
    ASSERT_TRUE(leased && !leased->empty());
    v1::Outcome outcome = ToProto(storage::JobOutcome{.state = state});
    outcome.set_verdict(verdict);
    storage::JobEnd end{.outcome = OutcomeOf(outcome)};
    end.outcome.state = state;
    if (report)
      end.artifacts.push_back({.name = "report",
                               .media_type = "application/x-protobuf",
                               .bytes = report->SerializeAsString()});
    ASSERT_TRUE(bed.store().Finish(leased->front().lease, end));
  }
  static v1::RunReport Report() {
    v1::RunReport report;
    report.set_family("rml1");
    report.set_engine_version("0.1.0");
    (*report.mutable_parameters())["JOG_SLOW"] = "2";
    (*report.mutable_inputs())["program"] = std::string(32, 'x');
    return report;
  }
  // "" where it is one.
  std::string WhyNone(std::int64_t job) {
    const auto ticket = TicketOf(bed.store(), JobName(job));
    if (ticket) return {};
    EXPECT_EQ(ticket.error().code, ErrorCode::kCellTicket);
    return ticket.error().detail;
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// LIVE-5.02: a simulation that came to a good end, and what it depended on.
TEST_F(RunTicketTest, ASimulationThatIsGoodIsOne) {
  const std::int64_t job = Submit();
  EXPECT_EQ(WhyNone(job), JobName(job) + " has not come to its end");
  End(JobState::kSucceeded, v1::VERDICT_GOOD, Report());
  const auto ticket = TicketOf(bed.store(), JobName(job));
  ASSERT_TRUE(ticket);
  EXPECT_EQ(ticket->job(), JobName(job));
  EXPECT_EQ(ticket->family(), "rml1");
  EXPECT_EQ(ticket->main_program(), 7);
  EXPECT_EQ(ticket->engine_version(), "0.1.0");
  EXPECT_EQ(ticket->parameters().at("JOG_SLOW"), "2");
  EXPECT_EQ(ticket->inputs().at("program"), std::string(32, 'x'));
}

// LIVE-5.02: nothing else is one.
TEST_F(RunTicketTest, NothingElseIsOne) {
  EXPECT_EQ(WhyNone(999), "jobs/999 is not kept");
  std::int64_t job = Submit();
  End(JobState::kSucceeded, v1::VERDICT_DOUBTFUL, Report());
  EXPECT_EQ(WhyNone(job), JobName(job) + " is DOUBTFUL, not GOOD");
  job = Submit();
  End(JobState::kSucceeded, v1::VERDICT_BAD, Report());
  EXPECT_EQ(WhyNone(job), JobName(job) + " is BAD, not GOOD");
  job = Submit();
  End(JobState::kFailed, v1::VERDICT_GOOD, Report());
  EXPECT_EQ(WhyNone(job), JobName(job) + " did not succeed");
  job = Submit();
  End(JobState::kSucceeded, v1::VERDICT_GOOD, std::nullopt);
  EXPECT_THAT(WhyNone(job), testing::HasSubstr("simulate it again"));
  job = Submit();
  v1::RunReport before = Report();  // of a version that did not say
  before.clear_inputs();
  End(JobState::kSucceeded, v1::VERDICT_GOOD, before);
  EXPECT_THAT(WhyNone(job), testing::HasSubstr("simulate it again"));
  job = Submit([](v1::Job& wanted) { wanted.set_kind(v1::JOB_KIND_CHECK); });
  End(JobState::kSucceeded, v1::VERDICT_GOOD, Report());
  EXPECT_EQ(WhyNone(job), JobName(job) + " is no simulation");
}

// LIVE-5.02: what ran dry up to a step has shown nothing of the cuts before it.
TEST_F(RunTicketTest, ADryRunIsNone) {
  const std::int64_t job = Submit([](v1::Job& wanted) {
    wanted.set_machine("machines/optimo-1");
    wanted.mutable_inline_program()->set_file_name("7.S");
    wanted.mutable_inline_program()->set_content("DELAY 1\n");
    wanted.mutable_simulation()->mutable_simul()->set_step(1);
  });
  End(JobState::kSucceeded, v1::VERDICT_GOOD, Report());
  EXPECT_EQ(WhyNone(job), JobName(job) + " ran dry up to a step");
}

// Of what cannot be read now it is not known that it proves nothing: the job may wait.
TEST_F(RunTicketTest, TroubleOfTheStoreIsHandedOn) {
  const std::int64_t job = Submit();
  End(JobState::kSucceeded, v1::VERDICT_GOOD, Report());
  FailingStore store(bed.store());
  ExpectFailuresHandedOn(store, "ticket", 2, [&] { return CodeOf(TicketOf(store, JobName(job))); });
}

}  // namespace
}  // namespace rmlcell::server
