// Who hears of RUNs that wait, and what is told of jobs beside what they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <string>
#include <vector>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class ToldOfRuns : public testing::Test {
 protected:
  using Change = std::function<void(v1::Job&)>;

  Result<v1::Job> Submit(
      v1::JobKind kind, const Change& change = [](v1::Job&) {}, const std::string& request_id = {},
      bool more_come = false) {
    v1::SubmitJobRequest request;
    request.set_request_id(request_id);
    v1::Job& job = *request.mutable_job();
    job.set_kind(kind);
    job.set_machine("machines/optimo-1");
    job.mutable_inline_program()->set_file_name("part.S");
    job.mutable_inline_program()->set_content("STOP\n");
    change(job);
    std::promise<Result<v1::Job>> answer;
    book.Submit(
        request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); },
        more_come);
    return answer.get_future().get();
  }
  storage::JobRecord Record(const v1::Job& job) {
    return Must(bed.store().GetJob(Must(ParseJobName(job.name()))));
  }
  std::string WhyNoReport(const v1::Job& job) {
    const auto read = book.ReadArtifact(Must(ParseJobName(job.name())), "report");
    return read ? std::string() : std::string(read.error().detail);
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// LIVE-5.02: each time when one may have become ready, and for no other job.
TEST_F(ToldOfRuns, ThoseThatMayBeginAreTold) {
  std::vector<std::string> machines;
  book.OnRunWaits([&machines](const std::string& machine) { machines.push_back(machine); });
  const v1::Job simulation = Must(Submit(v1::JOB_KIND_SIMULATE));
  EXPECT_THAT(machines, IsEmpty());
  const v1::Job run = Must(Submit(
      v1::JOB_KIND_RUN, [](v1::Job&) {}, "r"));
  EXPECT_THAT(machines, ElementsAre("optimo-1"));
  for (const v1::Job& job : {simulation, run}) Must(book.HoldBack(job.name(), "anna"));
  EXPECT_EQ(machines.size(), 1U);
  Must(book.LetGo(simulation.name(), "anna"));
  EXPECT_EQ(machines.size(), 1U);
  Must(book.LetGo(run.name(), "anna"));
  EXPECT_THAT(machines, ElementsAre("optimo-1", "optimo-1"));
  // Handed in once more after its end it is the same job, and waits for nothing.
  Must(bed.store().Finish(bed.Lease("RUN"), {}));
  EXPECT_EQ(Must(Submit(
                     v1::JOB_KIND_RUN, [](v1::Job&) {}, "r"))
                .name(),
            run.name());
  EXPECT_EQ(machines.size(), 2U);
}

// LIVE-5.02: of one that waits it is told what keeps it, unless many come at once.
TEST_F(ToldOfRuns, WhyOneWaitsIsTold) {
  int later = 0;
  book.OnToldToWait([](v1::Job& job) { job.add_start_blockers()->set_code("CELL-E9423"); },
                    [&later](const std::function<void()>& work) {
                      ++later;
                      work();
                    });
  const v1::Job run = Must(Submit(v1::JOB_KIND_RUN));
  EXPECT_EQ(run.start_blockers_size(), 1);
  EXPECT_EQ(later, 1);
  EXPECT_EQ(Must(book.Get(run.name())).start_blockers_size(), 1);
  EXPECT_EQ(Must(Submit(
                     v1::JOB_KIND_RUN, [](v1::Job&) {}, {}, true))
                .start_blockers_size(),
            0);
  const v1::Job simulation = Must(Submit(v1::JOB_KIND_SIMULATE));
  EXPECT_EQ(simulation.start_blockers_size(), 0);
  EXPECT_EQ(later, 1);
  EXPECT_EQ(Must(book.Get(simulation.name())).start_blockers_size(), 0);
  bed.Lease("RUN");
  EXPECT_EQ(Must(book.Get(run.name())).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(Must(book.Get(run.name())).start_blockers_size(), 0);
}

// What is to prove it is over before it begins; named twice it is awaited once.
TEST_F(ToldOfRuns, ATicketIsAwaited) {
  const v1::Job first = Must(Submit(v1::JOB_KIND_SIMULATE));
  const v1::Job second = Must(Submit(v1::JOB_KIND_SIMULATE));
  const auto awaited = [&](const v1::Job& ticket) {
    return Record(Must(Submit(v1::JOB_KIND_RUN,
                              [&](v1::Job& job) {
                                job.add_after_jobs(first.name());
                                job.mutable_run()->set_ticket(ticket.name());
                              })))
        .after;
  };
  EXPECT_THAT(awaited(first), ElementsAre(1));
  EXPECT_THAT(awaited(second), UnorderedElementsAre(1, 2));
}

// However slow it is, a simulation with a pace keeps no computing worker.
TEST_F(ToldOfRuns, AnyPaceIsOne) {
  const auto pool = [this](double pace) {
    const auto job = Submit(v1::JOB_KIND_SIMULATE,
                            [pace](v1::Job& asked) { asked.mutable_simulation()->set_pace(pace); });
    return Record(Must(job)).pool;
  };
  EXPECT_EQ(pool(0.0), "");
  EXPECT_EQ(pool(0.5), kPacedPool);
  EXPECT_EQ(pool(1.0), kPacedPool);
}

// LIVE-3.40: products of a RUN may come behind its end, where it was begun.
TEST_F(ToldOfRuns, AProductThatMayStillComeIsToldSo) {
  const v1::Job simulation = Must(Submit(v1::JOB_KIND_SIMULATE));
  const v1::Job run = Must(Submit(v1::JOB_KIND_RUN));
  const v1::Job never = Must(Submit(v1::JOB_KIND_RUN));
  EXPECT_EQ(WhyNoReport(run),
            run.name() + " has not ended: what it leaves, perhaps report, is there at its end");
  Must(bed.store().Finish(bed.Lease("SIMULATE"), {}));
  Must(bed.store().Finish(bed.Lease("RUN"), {}));
  Must(bed.store().RequestCancel(Must(ParseJobName(never.name())), {}));
  EXPECT_EQ(WhyNoReport(simulation), simulation.name() + " has no report");
  EXPECT_EQ(WhyNoReport(never), never.name() + " has no report");
  EXPECT_EQ(WhyNoReport(run),
            run.name() +
                " has no report yet: what its machine recorded is played again for it, where it "
                "was not cut off");
}

// LIVE-6.03: each refusal of a start at a step says what is missing.
TEST_F(ToldOfRuns, AStartAtAStepSaysWhatIsWrong) {
  const auto why = [this](const std::function<void(v1::RunOptions&)>& change) {
    const auto made = Submit(v1::JOB_KIND_RUN, [&](v1::Job& job) { change(*job.mutable_run()); });
    return made ? std::string() : std::string(made.error().detail);
  };
  const auto at = [&why](const std::function<void(v1::RunOptions&)>& change) {
    return why([&](v1::RunOptions& run) {
      run.mutable_step()->set_step(1);
      change(run);
    });
  };
  EXPECT_EQ(at([](v1::RunOptions&) {}), "");
  EXPECT_EQ(why([](v1::RunOptions& run) { run.set_occurrence(1); }),
            "job.run.step: say where it begins");
  EXPECT_EQ(why([](v1::RunOptions& run) { run.set_off_until_work_on(true); }),
            "job.run.step: say where it begins");
  EXPECT_EQ(at([](v1::RunOptions& run) { run.set_occurrence(-1); }),
            "job.run.occurrence counts from 1");
  EXPECT_EQ(at([](v1::RunOptions& run) { run.mutable_step()->set_step(0); }),
            "job.run.step.step: steps count from 1");
  EXPECT_EQ(
      at([](v1::RunOptions& run) { run.add_confirmations(static_cast<v1::Confirmation>(99)); }),
      "job.run.confirmations: one is none that there is");
}

}  // namespace
}  // namespace rmlcell::server
