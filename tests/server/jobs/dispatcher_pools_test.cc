// Which workers are given which jobs.
#include <gtest/gtest.h>

#include <set>

#include "server/jobs/dispatcher.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

// What only waits holds no worker that computes.
TEST(DispatcherPools, AWorkerIsGivenJobsOfItsPool) {
  DispatcherBed bed;
  const auto of_pool = [](std::string_view pool) {
    v1::WorkerHello hello = Hello(std::string(pool));
    hello.set_pool(std::string(pool));
    return hello;
  };
  FakeWorker paced(bed.dispatcher(), of_pool(kPacedPool));
  FakeWorker computing(bed.dispatcher(), of_pool(kComputingWorkers));
  const auto submit = [&](const std::string& pool) {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/optimo-1");
    job.mutable_inline_program()->set_file_name("part.S");
    return Must(bed.server.store().SubmitAndWait(
                    {.machine = "optimo-1",
                     .kind = "SIMULATE",
                     .pool = pool,
                     .specification = job.SerializeAsString(),
                     .attachments = {{.name = std::string(kMainAttachment), .bytes = "STOP\n"}}}))
        .job.id;
  };
  const std::int64_t slow = submit(std::string(kPacedPool));
  const std::int64_t second = submit(std::string(kPacedPool));
  const std::int64_t quick = submit("");
  ASSERT_TRUE(paced.Take());
  EXPECT_EQ(paced.job(), slow);
  ASSERT_TRUE(computing.Take());
  EXPECT_EQ(computing.job(), quick);
  computing.Finish();
  EXPECT_EQ(computing.Released(), true);
  bed.LookAgain();
  EXPECT_FALSE(computing.HasJob());
  EXPECT_EQ(bed.Job(second).state, storage::JobState::kQueued);
  FakeWorker any(bed.dispatcher(), "any");
  ASSERT_TRUE(any.Take());
  EXPECT_EQ(any.job(), second);
}

// What was tried again, and the look that was put off with it, are one job; as long as it could not
// be given back there is none beside it.
TEST(DispatcherFailures, AWorkerIsGivenOneJobWhenAFailingStoreWorksAgain) {
  for (const int losses : {1, 2}) {
    DispatcherBed bed;
    bed.hooks.machines_that_fail = 1;
    bed.hooks.losses_that_fail = losses;
    std::set<std::int64_t> jobs = {bed.server.SubmitCheck(), bed.server.SubmitCheck()};
    FakeWorker worker(bed.dispatcher(), "w");
    while (!jobs.empty()) {
      ASSERT_TRUE(worker.Take()) << losses;
      bed.LookAgain();
      EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kAssignment)) << losses;
      EXPECT_EQ(jobs.erase(worker.job()), 1U) << losses;
      worker.Finish();
      EXPECT_EQ(worker.Released(), true) << losses;
      EXPECT_EQ(bed.Job(worker.job()).state, JobState::kSucceeded) << losses;
    }
  }
}

// What a worker says behind its last word, or without a job, is not heard, and nobody is hurt.
TEST(DispatcherStrays, AreNotHeard) {
  DispatcherBed bed;
  FakeWorker idle(bed.dispatcher(), "idle");
  idle.Heartbeat();
  bed.Settle();
  const std::int64_t job = bed.server.SubmitCheck();
  ASSERT_TRUE(idle.Take());
  EXPECT_EQ(idle.job(), job);
  idle.Leave();
  idle.Finish();
  FakeWorker next(bed.dispatcher(), "next");
  ASSERT_TRUE(next.Take());
  EXPECT_EQ(next.job(), job);
  next.Finish();
  EXPECT_EQ(next.Released(), true);
}

}  // namespace
}  // namespace rmlcell::server
