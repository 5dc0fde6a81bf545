// What a submission names, at its ends, and who is told that a job was cancelled.
#include <gtest/gtest.h>

#include <functional>
#include <future>
#include <optional>
#include <utility>

#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "server/jobs/worker_processes.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

class AskedOnce : public testing::Test {
 protected:
  // Why the server takes no such job; "" where it does.
  std::string WhyNotTaken(const std::string& machine, v1::JobKind kind,
                          const std::function<void(v1::Job&)>& change) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(kind);
    job.set_machine("machines/" + machine);
    job.mutable_inline_program()->set_file_name(machine == "mill-1" ? "a.rml" : "a.S");
    job.mutable_inline_program()->set_content(machine == "mill-1" ? "PA;PU100,0;" : "STOP\n");
    change(job);
    request.set_validate_only(true);
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    const Result<v1::Job> made = answer.get_future().get();
    return made ? std::string() : std::string(made.error().detail);
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// LIVE-6.03: 16 confirmations; negative slots are none.
TEST_F(AskedOnce, ConfirmationsOfAStart) {
  const auto with = [this](int confirmations) {
    return WhyNotTaken("mill-1", v1::JOB_KIND_RUN, [&](v1::Job& job) {
      job.mutable_run()->mutable_step()->set_step(1);
      for (int i = 0; i < confirmations; ++i)
        job.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
    });
  };
  EXPECT_EQ(with(16), "");
  EXPECT_EQ(with(17), "job.run.confirmations has more than 16");
}

// Names of files have up to 255 bytes, of whichever text.
TEST_F(AskedOnce, NamesOfFurtherFiles) {
  const auto further = [this](std::size_t bytes) {
    return WhyNotTaken("optimo-1", v1::JOB_KIND_SIMULATE, [&](v1::Job& job) {
      v1::SlotProgram& program = *job.mutable_simulation()->add_programs();
      program.set_slot(45);
      program.mutable_program()->set_file_name(std::string(bytes - 2, 'x') + ".S");
      program.mutable_program()->set_content("STOP\n");
    });
  };
  EXPECT_EQ(further(255), "");
  EXPECT_EQ(further(256), "job.simulation.programs: a file name is longer than 255 bytes");
  const auto target = [this](std::size_t bytes) {
    return WhyNotTaken("mill-1", v1::JOB_KIND_SIMULATE, [&](v1::Job& job) {
      v1::Milling& milling = *job.mutable_simulation()->mutable_milling();
      milling.mutable_stock()->set_size_x_mm(60.0);
      milling.mutable_stock()->set_size_y_mm(30.0);
      milling.mutable_stock()->set_size_z_mm(5.0);
      milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
      milling.mutable_tool()->set_diameter_mm(3.0);
      milling.mutable_target()->mutable_file()->set_file_name(std::string(bytes - 4, 'x') + ".stl");
      milling.mutable_target()->mutable_file()->set_content("solid\nendsolid\n");
    });
  };
  EXPECT_EQ(target(255), "");
  EXPECT_EQ(target(256), "the file name of the target is longer than 255 bytes");
}

// Tokens that no page had: each of its numbers has its ends.
TEST_F(AskedOnce, TokensOfPages) {
  const auto taken = [this](const std::string& token) {
    v1::ListJobsRequest request;
    request.set_page_token(token);
    const std::optional<ErrorCode> refused = CodeOf(book.List(request));
    EXPECT_EQ(refused.value_or(ErrorCode::kCellBadPageToken), ErrorCode::kCellBadPageToken);
    return !refused;
  };
  for (const char* good : {"1,0,0,1000,0", "1,0,1,-1000,0", "1000000000000000,1,0,0,2.5"})
    EXPECT_TRUE(taken(good)) << good;
  for (const char* bad : {"1,0,0,1001,0", "1,0,0,-1001,0", "0,0,0,0,0", "1.5,0,0,0,0", "1,0,2,0,0",
                          "1,0,-1,0,0", "1,-1,0,0,0", "1,99,0,0,0", "1,0,0,0", "1,0,0,0,0,0"})
    EXPECT_FALSE(taken(bad)) << bad;
}

// A snapshot of 200 jobs: beside 199 that have not ended there is room for one that has.
TEST_F(AskedOnce, TheLastJobOfASnapshot) {
  const auto fill = [this](int count) {
    std::atomic<int> done = 0;
    for (int i = 0; i < count; ++i) {
      bed.store().Submit({.machine = "optimo-1", .kind = "CHECK"},
                         [&done](const Result<storage::SubmittedJob>&) { ++done; });
    }
    ASSERT_TRUE(Eventually([&] { return done == count; }));
  };
  fill(1);
  Must(bed.store().Finish(bed.Lease(), {.outcome = {.state = storage::JobState::kSucceeded}}));
  fill(199);
  const std::vector<v1::Job> newest = Must(book.Newest({}));
  ASSERT_EQ(newest.size(), 200U);
  EXPECT_EQ(newest.back().name(), "jobs/1");
}

// What a machine has stored are objects, those beside the program of the job as well.
TEST_F(AskedOnce, StoredProgramsAreObjects) {
  for (const int slot : {32, 44})
    Must(bed.store().PutPrograms("optimo-1",
                                 {{.slot = slot, .object = "object " + std::to_string(slot)}}, {}));
  v1::SubmitJobRequest request;
  request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
  request.mutable_job()->set_machine("machines/optimo-1");
  request.mutable_job()->set_program("machines/optimo-1/programs/32");
  std::promise<bool> submitted;
  book.Submit(request, "anna",
              [&](const Result<v1::Job>& made) { submitted.set_value(static_cast<bool>(made)); });
  ASSERT_TRUE(submitted.get_future().get());
  const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  const auto made = Must(MakeAssignment(bed.store(), config, *leased));
  ASSERT_EQ(made.first.assignment().programs_size(), 2);
  for (const v1::AssignedProgram& program : made.first.assignment().programs())
    EXPECT_FALSE(program.is_source()) << program.slot();
}

// One worker of each pool needs the program as well as two of the same.
TEST(WorkersOfPools, AreNotStartedWithoutTheirProgram) {
  for (const auto& [count, further] : {std::pair{1, 1}, {1, 0}, {0, 1}}) {
    const auto started = WorkerProcesses::Start(
        {.program = "/no/such/worker", .count = count, .further_count = further});
    EXPECT_EQ(CodeOf(started), ErrorCode::kCellConfiguration) << count << further;
  }
  EXPECT_TRUE(WorkerProcesses::Start({.program = "/no/such/worker", .count = 0}));
}

// Who cancels a job, and by which request, goes to its worker with the order.
TEST(CancelledBy, IsToldToTheWorker) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  ASSERT_TRUE(bed.dispatcher().Cancel(job, "anna", "request 7"));
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(order.caller(), "anna");
  EXPECT_EQ(order.request_id(), "request 7");
}

}  // namespace
}  // namespace rmlcell::server
