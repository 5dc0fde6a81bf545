// What goes with a job to whoever works on it: the least that it may use, its machine, and its
// program alone.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <string>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class GivenPrograms : public testing::Test {
 protected:
  std::int64_t Submit(const std::string& machine, const std::function<void(v1::Job&)>& change) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/" + machine);
    change(job);
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return Must(ParseJobName(Must(answer.get_future().get()).name()));
  }
  static void Bring(v1::Job& job, const std::string& file_name, v1::ProgramForm form) {
    job.set_inline_slot(7);
    job.mutable_inline_program()->set_file_name(file_name);
    job.mutable_inline_program()->set_form(form);
    job.mutable_inline_program()->set_content("STOP\n");
  }
  v1::WorkerAssignment Assigned() {
    const auto leased = Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
    return Must(MakeAssignment(bed.store(), config, leased.value())).first.assignment();
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// Job.budget: 0 is the limit of the server, and one is one.
TEST_F(GivenPrograms, ABudgetOfOneIsOne) {
  Submit("optimo-1", [](v1::Job& job) {
    Bring(job, "part.S", v1::PROGRAM_FORM_UNSPECIFIED);
    job.mutable_budget()->set_steps(1);
    job.mutable_budget()->set_virtual_time_ns(1);
    job.mutable_budget()->set_memory_bytes(1);
    job.mutable_budget()->set_processor_ns(1);
    job.mutable_budget()->set_output_bytes(1);
  });
  const v1::Budget budget = Assigned().budget();
  EXPECT_EQ(budget.steps(), 1);
  EXPECT_EQ(budget.virtual_time_ns(), 1);
  EXPECT_EQ(budget.memory_bytes(), 1);
  EXPECT_EQ(budget.processor_ns(), 1);
  EXPECT_EQ(budget.output_bytes(), 1);
}

TEST_F(GivenPrograms, AMachineHasItsProfile) {
  Must(bed.store().PutMachine({.id = "mill-2", .family = "rml1", .profile = "srm-20"}, 0));
  Submit("mill-2", [](v1::Job& job) {
    Bring(job, "part.rml", v1::PROGRAM_FORM_UNSPECIFIED);
    job.mutable_inline_program()->set_content("PU;");
  });
  EXPECT_EQ(Assigned().profile(), "srm-20");
}

// worker.proto, AssignedProgram: each that comes alone says what its bytes are, and how many.
TEST_F(GivenPrograms, TheProgramOfAJobSaysWhatItIs) {
  const auto program_of = [this](const std::function<void(v1::Job&)>& change) {
    return Must(ProgramOfJob(bed.store(), Submit("optimo-1", change)));
  };
  const v1::AssignedProgram source =
      program_of([](v1::Job& job) { Bring(job, "part.S", v1::PROGRAM_FORM_UNSPECIFIED); });
  EXPECT_EQ(source.slot(), 7);
  EXPECT_EQ(source.file_name(), "part.S");
  EXPECT_TRUE(source.is_source());
  EXPECT_EQ(source.content(), "STOP\n");
  EXPECT_EQ(source.size(), 5);
  const v1::AssignedProgram object =
      program_of([](v1::Job& job) { Bring(job, "part.O", v1::PROGRAM_FORM_OBJECT); });
  EXPECT_EQ(object.file_name(), "part.O");
  EXPECT_FALSE(object.is_source());
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "an object"}}, {}));
  const v1::AssignedProgram stored =
      program_of([](v1::Job& job) { job.set_program("machines/optimo-1/programs/45"); });
  EXPECT_EQ(stored.slot(), 45);
  EXPECT_EQ(stored.file_name(), "");
  EXPECT_FALSE(stored.is_source());
  EXPECT_EQ(stored.content(), "an object");
  EXPECT_EQ(stored.size(), 9);
}

}  // namespace
}  // namespace rmlcell::server
