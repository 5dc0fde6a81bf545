// Bounds of jobs that no client reaches in passing: a RUN's attempts, a choice of many, what a
// worker sends to who follows.
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>

#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "server/jobs/running_toolpath.h"
#include "server/jobs/told_jobs.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

class JobBounds : public testing::Test {
 protected:
  Result<v1::Job> Submit(const v1::Job& job) {
    v1::SubmitJobRequest request;
    *request.mutable_job() = job;
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return answer.get_future().get();
  }
  static v1::Job Brought(v1::JobKind kind, const std::string& machine, const std::string& file) {
    v1::Job job;
    job.set_kind(kind);
    job.set_machine("machines/" + machine);
    job.mutable_inline_program()->set_file_name(file);
    job.mutable_inline_program()->set_content("STOP\n");
    job.set_inline_slot(7);
    return job;
  }
  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// LIVE-5.01: a RUN is attempted once; who says so says nothing new.
TEST_F(JobBounds, OfTheAttemptsOfARun) {
  v1::Job job = Brought(v1::JOB_KIND_RUN, "mill-1", "a.rml");
  job.mutable_inline_program()->set_content("PA;PU100,0;");
  job.set_attempts_max(1);
  EXPECT_TRUE(Submit(job));
  job.set_attempts_max(2);
  EXPECT_EQ(CodeOf(Submit(job)), ErrorCode::kCellInvalidArgument);
}

// What is wrong with an input is told with its name.
TEST_F(JobBounds, OfTheNamesOfInputs) {
  v1::Job job = Brought(v1::JOB_KIND_SIMULATE, "optimo-1", "part.S");
  job.mutable_simulation()->add_variables("NOSUCH");
  const auto refused = Submit(job);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("NOSUCH"), std::string::npos) << refused.error().detail;
}

// A choice has all of them, however many pages they are.
TEST_F(JobBounds, OfAChoiceOfMany) {
  std::atomic<int> done = 0;
  for (int i = 0; i < 1'001; ++i) {
    bed.store().Submit({.machine = "optimo-1", .kind = "CHECK"},
                       [&done](const Result<storage::SubmittedJob>&) { ++done; });
  }
  ASSERT_TRUE(Eventually([&] { return done == 1'001; }));
  v1::JobChoice choice;
  choice.set_all(true);
  EXPECT_EQ(Must(book.Choose(choice, std::nullopt)).size(), 1'001U);
}

// An executable that is linked beside a program that the machine does not have is for this job.
TEST_F(JobBounds, OfExecutablesBesideAProgramThatWasBrought) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 12, .object = "object 12"}}, {}));
  ASSERT_TRUE(Submit(Brought(v1::JOB_KIND_SIMULATE, "optimo-1", "part.S")));
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  const auto made = Must(MakeAssignment(bed.store(), config, *leased));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  ASSERT_EQ(assignment.programs_size(), 2);
  for (const v1::AssignedProgram& program : assignment.programs())
    EXPECT_EQ(program.object_revision(), 0) << program.slot();
}

// A job of just 16 KiB is told from memory.
TEST(ToldJobBounds, OfTheBytesOfAJob) {
  ToldJobs told;
  v1::Job job;
  job.set_title(std::string(ToldJobs::kBytesMax - 100, 't'));
  while (job.ByteSizeLong() < ToldJobs::kBytesMax) job.mutable_title()->push_back('t');
  ASSERT_EQ(job.ByteSizeLong(), ToldJobs::kBytesMax);
  told.Keep(1, 5, job);
  EXPECT_NE(told.Find(1, 5), nullptr);
  told.Keep(1, 1, job);
  EXPECT_NE(told.Find(1, 1), nullptr);
  job.mutable_title()->push_back('t');
  told.Keep(2, 5, job);
  EXPECT_EQ(told.Find(2, 5), nullptr);
  told.Keep(3, 0, {});
  EXPECT_EQ(told.Find(3, 0), nullptr);
}

// limits.output_bytes counts what is sent to who follows the toolpath, too, with the same slack.
TEST(ToolpathBudget, IsUsedUpToItsLastByte) {
  constexpr std::size_t kSlack = 1 << 20;
  for (const std::size_t over : {0, 1}) {
    DispatcherBed bed;
    bed.config.limit_output_bytes = 1'000;
    const std::int64_t job = bed.server.SubmitCheck();
    FakeWorker worker(bed.dispatcher(), "w");
    ASSERT_TRUE(worker.Take());
    worker.Toolpath(std::string(400, 'a'), "open");
    worker.Toolpath(std::string(600 + kSlack - 400 - 200, 'b'), "open");
    worker.Toolpath(std::string(600 + over, 'c'), "open");
    worker.Finish();
    EXPECT_EQ(worker.Released(), true);
    EXPECT_EQ(bed.Job(job).state,
              over == 0 ? storage::JobState::kSucceeded : storage::JobState::kFailed)
        << over;
  }
}

}  // namespace
}  // namespace rmlcell::server
