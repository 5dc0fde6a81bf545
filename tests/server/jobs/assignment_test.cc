#include "server/jobs/assignment.h"

#include <gtest/gtest.h>

#include "server/config.h"
#include "server/jobs/job_book.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class AssignmentTest : public testing::Test {
 protected:
  // Submits as a client does, and leases it.
  storage::LeasedJob Lease(const v1::SubmitJobRequest& request) {
    std::atomic<bool> done = false;
    std::optional<Error> wrong;
    book.Submit(request, "c", [&](const Result<v1::Job>& job) {
      if (!job) wrong = job.error();
      done = true;
    });
    if (!Eventually([&] { return done.load(); }) || wrong)
      throw std::runtime_error("not submitted");
    return *Must(bed.store().Acquire("w", {"SIMULATE", "CHECK"}, std::chrono::hours(1), {}));
  }
  v1::SubmitJobRequest Stored(int slot, const std::string& machine = "optimo-1") {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine("machines/" + machine);
    request.mutable_job()->set_program("machines/" + machine + "/programs/" + std::to_string(slot));
    return request;
  }
  void Put(int slot, const std::string& object, const std::string& machine = "optimo-1") {
    Must(bed.store().PutPrograms(
        machine, {{.slot = slot, .name = "p" + std::to_string(slot), .object = object}}, {}));
  }
  static std::map<int, std::string> Contents(const v1::WorkerAssignment& assignment) {
    std::map<int, std::string> contents;
    for (const v1::AssignedProgram& program : assignment.programs())
      contents[program.slot()] = program.content();
    return contents;
  }
  using Programs = std::map<int, std::string>;

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

TEST_F(AssignmentTest, BringsTheWholeProgramMemoryOfAMachineWhoseProgramsCallEachOther) {
  Put(32, "object 32");
  Put(44, "object 44");
  Must(bed.store().PutExecutable("optimo-1", 44, 1, "executable 44"));
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(32))));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  EXPECT_EQ(assignment.main_program(), 32);
  EXPECT_EQ(Contents(assignment), (Programs{{32, "object 32"}, {44, "object 44"}}));
  EXPECT_EQ(assignment.programs(1).executable(), "executable 44");
  EXPECT_TRUE(assignment.default_schedules());
  EXPECT_EQ(made.object_revisions.at(32), 1);
}

// A mill runs one stream.
TEST_F(AssignmentTest, BringsOneStreamToAMill) {
  Put(1, "IN;", "mill-1");
  Put(2, "PU;", "mill-1");
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(2, "mill-1"))));
  EXPECT_EQ(Contents(made.first.assignment()), (Programs{{2, "PU;"}}));
  EXPECT_EQ(made.first.assignment().family(), "rml1");
}

// The job is for what was stored when it was submitted; an executable of the new object is not of
// it.
TEST_F(AssignmentTest, ASlotThatIsStoredAgainDoesNotChangeTheJob) {
  Put(32, "first");
  const storage::LeasedJob leased = Lease(Stored(32));
  Put(32, "second");
  Must(bed.store().PutExecutable("optimo-1", 32, 2, "executable of second"));
  const auto made = Must(MakeAssignment(bed.store(), config, leased));
  EXPECT_EQ(Contents(made.first.assignment()), (Programs{{32, "first"}}));
  EXPECT_EQ(made.first.assignment().programs(0).executable(), "");
  EXPECT_TRUE(made.object_revisions.empty());  // nor of any that links it as a FUNCTION
}

TEST_F(AssignmentTest, ProgramsOfTheJobGoOverThoseOfTheMachine) {
  Put(44, "stored 44");
  Put(45, "stored 45");
  v1::SubmitJobRequest request = Stored(44);
  v1::SlotProgram& further = *request.mutable_job()->mutable_simulation()->add_programs();
  further.set_slot(45);
  further.mutable_program()->set_file_name("45.S");
  further.mutable_program()->set_content("STOP\n");
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
  EXPECT_EQ(Contents(made.first.assignment()), (Programs{{44, "stored 44"}, {45, "STOP\n"}}));
  EXPECT_TRUE(made.first.assignment().programs(1).is_source());
  // Also 44 may link the job's 45 as a FUNCTION: its executable is for this job only.
  EXPECT_TRUE(made.object_revisions.empty());
}

TEST_F(AssignmentTest, ABudgetIsWhatTheJobWantsButNoMoreThanTheServerAllows) {
  config.limit_steps = 1000;
  config.limit_processor_s = 5.0;
  Put(1, "object");
  v1::SubmitJobRequest request = Stored(1);
  request.mutable_job()->mutable_budget()->set_steps(2000);       // more than allowed
  request.mutable_job()->mutable_budget()->set_processor_s(2.5);  // less
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
  const v1::Budget& budget = made.first.assignment().budget();
  EXPECT_EQ(budget.steps(), 1000);
  EXPECT_EQ(budget.processor_s(), 2.5);
  EXPECT_EQ(budget.memory_bytes(), config.limit_memory_bytes);  // not given: all of it
  EXPECT_EQ(budget.output_bytes(), config.limit_output_bytes);
  EXPECT_EQ(budget.virtual_time_s(), config.limit_virtual_time_s);
}

// OPT-3.44: schedules are records of the machine.
TEST_F(AssignmentTest, BringsTheLaserSchedulesOfTheMachine) {
  Put(1, "object");
  Must(bed.store().PutSchedule(
      {.machine = "optimo-1", .number = 12, .name = "thin", .mode = "PULSE", .power_percent = 40},
      0));
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(1))));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  EXPECT_FALSE(assignment.default_schedules());
  ASSERT_EQ(assignment.schedules_size(), 1);
  EXPECT_EQ(assignment.schedules(0).number(), 12);
  EXPECT_EQ(assignment.schedules(0).mode(), "PULSE");
  EXPECT_EQ(assignment.schedules(0).power_percent(), 40.0);
}

// One message is limited: many programs of moderate size follow it as well.
TEST_F(AssignmentTest, WhatDoesNotFitIntoOneMessageFollowsIt) {
  for (int slot = 1; slot <= 40; ++slot)
    Put(slot, std::string(60'000, static_cast<char>('a' + slot % 26)));
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(1))));
  EXPECT_LT(made.first.ByteSizeLong(), std::size_t{2} << 20);
  EXPECT_EQ(made.first.assignment().programs_size(), 40);
  std::size_t bytes = 0;
  for (const auto& [slot, program] : made.programs) bytes += program->size();
  for (const v1::AssignedProgram& program : made.first.assignment().programs()) {
    EXPECT_EQ(program.size(), 60'000);
    bytes += program.content().size();
  }
  EXPECT_EQ(bytes, 40U * 60'000U);
}

}  // namespace
}  // namespace rmlcell::server
