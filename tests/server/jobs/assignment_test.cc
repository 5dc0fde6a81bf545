#include "server/jobs/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "engine/machine/machine_note.h"
#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// How many programs may have executables that are kept.
std::ptrdiff_t Revisions(const v1::WorkerAssignment& assignment) {
  return std::ranges::count_if(assignment.programs(), [](const v1::AssignedProgram& program) {
    return program.object_revision() > 0;
  });
}

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
  // A memory of more than the megabyte that an Optimo has.
  void WidenMemory() {
    storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
    machine.parameters["CMOS_SIZE"] = "1e9";
    Must(bed.store().PutMachine(machine, storage::kAnyRevision));
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
  EXPECT_EQ(assignment.programs(0).object_revision(), 1);
  // A check follows a program into those that it calls, too.
  v1::SubmitJobRequest check = Stored(32);
  check.mutable_job()->set_kind(v1::JOB_KIND_CHECK);
  const auto checked = Must(MakeAssignment(bed.store(), config, Lease(check)));
  EXPECT_EQ(Contents(checked.first.assignment()), (Programs{{32, "object 32"}, {44, "object 44"}}));
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
  EXPECT_EQ(Revisions(made.first.assignment()), 0);  // nor of any that links it as a FUNCTION
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
  EXPECT_EQ(Revisions(made.first.assignment()), 0);
}

// What a job brings is not what its machine has stored there, and has nothing of that.
TEST_F(AssignmentTest, AProgramThatIsBroughtHasNothingOfWhatIsStoredInItsSlot) {
  Put(9, "stored 9");
  Must(bed.store().PutExecutable("optimo-1", 9, 1, "executable 9"));
  v1::SubmitJobRequest request;
  v1::Job& job = *request.mutable_job();
  job.set_kind(v1::JOB_KIND_SIMULATE);
  job.set_machine("machines/optimo-1");
  job.set_inline_slot(9);
  job.mutable_inline_program()->set_file_name("part.O");
  job.mutable_inline_program()->set_form(v1::PROGRAM_FORM_OBJECT);
  job.mutable_inline_program()->set_content("brought 9");
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  EXPECT_EQ(Contents(assignment), (Programs{{9, "brought 9"}}));
  EXPECT_EQ(assignment.programs(0).title(), "");
  EXPECT_EQ(assignment.programs(0).executable(), "");
  EXPECT_EQ(Revisions(assignment), 0);
}

// Two slots with the same bytes are two programs.
TEST_F(AssignmentTest, TheSameObjectInAnotherSlotIsAProgramOfItsOwn) {
  for (const int slot : {31, 32, 44}) Put(slot, "object");
  Must(bed.store().PutExecutable("optimo-1", 32, 1, "executable 32"));
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(32))));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  EXPECT_EQ(Contents(assignment), (Programs{{31, "object"}, {32, "object"}, {44, "object"}}));
  for (const v1::AssignedProgram& program : assignment.programs()) {
    EXPECT_EQ(program.title(), "p" + std::to_string(program.slot()));
    EXPECT_EQ(program.executable(), program.slot() == 32 ? "executable 32" : "");
  }
}

// Nothing follows the assignment of what is not in it any more, however large it was.
TEST_F(AssignmentTest, WhatIsReplacedDoesNotFollow) {
  Put(44, "stored 44");
  Put(45, std::string(70'000, 'l'));
  v1::SubmitJobRequest request = Stored(44);
  v1::SlotProgram& further = *request.mutable_job()->mutable_simulation()->add_programs();
  further.set_slot(45);
  further.mutable_program()->set_file_name("45.S");
  further.mutable_program()->set_content("STOP\n");
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
  EXPECT_EQ(Contents(made.first.assignment()), (Programs{{44, "stored 44"}, {45, "STOP\n"}}));
  EXPECT_TRUE(made.programs.empty());
}

TEST_F(AssignmentTest, ABudgetIsWhatTheJobWantsButNoMoreThanTheServerAllows) {
  config.limit_steps = 1000;
  config.limit_processor_s = 5.0;
  Put(1, "object");
  v1::SubmitJobRequest request = Stored(1);
  request.mutable_job()->mutable_budget()->set_steps(2000);                  // more than allowed
  request.mutable_job()->mutable_budget()->set_processor_ns(2'500'000'000);  // less
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
  const v1::Budget& budget = made.first.assignment().budget();
  EXPECT_EQ(budget.steps(), 1000);
  EXPECT_EQ(budget.processor_ns(), 2'500'000'000);
  EXPECT_EQ(budget.memory_bytes(), config.limit_memory_bytes);  // not given: all of it
  EXPECT_EQ(budget.output_bytes(), config.limit_output_bytes);
  EXPECT_EQ(budget.virtual_time_ns(), FromSeconds(config.limit_virtual_time_s).count());
}

// OPT-3.44: schedules are records of the machine; those that nobody stored it has by default.
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
  EXPECT_EQ(assignment.schedules(0).title(), "thin");
  EXPECT_EQ(assignment.schedules(0).mode(), "PULSE");
  EXPECT_EQ(assignment.schedules(0).power_percent(), 40.0);
}

// Job.budget: 0 is the limit of the server; each on both sides of it.
TEST_F(AssignmentTest, EachLimitOfABudgetIsItsOwn) {
  config.limit_steps = 10;
  config.limit_virtual_time_s = 20e-9;
  config.limit_memory_bytes = 30;
  config.limit_processor_s = 40e-9;
  config.limit_output_bytes = 50;
  Put(1, "object");
  const auto given = [&](int difference) {
    v1::SubmitJobRequest request = Stored(1);
    v1::Budget& wanted = *request.mutable_job()->mutable_budget();
    wanted.set_steps(10 + difference);
    wanted.set_virtual_time_ns(20 + difference);
    wanted.set_memory_bytes(30 + difference);
    wanted.set_processor_ns(40 + difference);
    wanted.set_output_bytes(50 + difference);
    return Must(MakeAssignment(bed.store(), config, Lease(request))).first.assignment().budget();
  };
  for (const int difference : {-1, 0, 1}) {
    const v1::Budget budget = given(difference);
    const int less = std::min(difference, 0);
    EXPECT_EQ(budget.steps(), 10 + less);
    EXPECT_EQ(budget.virtual_time_ns(), 20 + less);
    EXPECT_EQ(budget.memory_bytes(), 30 + less);
    EXPECT_EQ(budget.processor_ns(), 40 + less);
    EXPECT_EQ(budget.output_bytes(), 50 + less);
  }
}

TEST_F(AssignmentTest, BringsTheMachineAsItIs) {
  storage::MachineRecord machine = Must(bed.store().GetMachine("mill-1"));
  machine.parameters = {{"X_MAX", "250"}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  const storage::MachineLease host = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "h", .duration = std::chrono::seconds(60)}));
  const std::string stands = machine::WriteMachineNote({.family = "state of the machine"});
  ASSERT_TRUE(bed.store().AppendMachine(
      host, {.mark = storage::MachineMark{.sequence = 1, .state = stands}}));
  Put(2, "PU;", "mill-1");
  const storage::LeasedJob leased = Lease(Stored(2, "mill-1"));
  const auto made = Must(MakeAssignment(bed.store(), config, leased));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  EXPECT_EQ(assignment.profile(), machine.profile);
  ASSERT_EQ(assignment.parameters_size(), 1);
  EXPECT_EQ(assignment.parameters().at("X_MAX"), "250");
  EXPECT_EQ(assignment.machine_state(), "state of the machine");
  EXPECT_EQ(assignment.main_program(), 2);
  EXPECT_EQ(assignment.job().name(), "jobs/" + std::to_string(leased.job.id));
  ASSERT_EQ(assignment.programs_size(), 1);
  EXPECT_FALSE(assignment.programs(0).is_source());  // what is stored is an object
  EXPECT_EQ(Revisions(made.first.assignment()), 0);  // nothing is made of it that could be kept
}

// A mark that this version cannot read must not begin a run on a new machine.
TEST_F(AssignmentTest, RefusesAMarkThatIsNone) {
  const storage::MachineLease host = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "h", .duration = std::chrono::seconds(60)}));
  ASSERT_TRUE(
      bed.store().AppendMachine(host, {.mark = storage::MachineMark{.sequence = 1, .state = "x"}}));
  Put(2, "PU;", "mill-1");
  const storage::LeasedJob leased = Lease(Stored(2, "mill-1"));
  EXPECT_EQ(CodeOf(MakeAssignment(bed.store(), config, leased)), ErrorCode::kCellStoreCorrupt);
}

TEST_F(AssignmentTest, AnInlineProgramIsSourceUnlessItSaysThatItIsAnObject) {
  for (const bool object : {false, true}) {
    const auto form = object ? v1::PROGRAM_FORM_OBJECT : v1::PROGRAM_FORM_UNSPECIFIED;
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/optimo-1");
    job.set_inline_slot(9);
    job.mutable_inline_program()->set_file_name(object ? "part.O" : "part.S");
    job.mutable_inline_program()->set_form(form);
    job.mutable_inline_program()->set_content("STOP\n");
    v1::SlotProgram& further = *job.mutable_simulation()->add_programs();
    further.set_slot(45);
    further.mutable_program()->set_file_name(object ? "45.O" : "45.S");
    further.mutable_program()->set_form(form);
    further.mutable_program()->set_content("RESUME\n");
    const auto made = Must(MakeAssignment(bed.store(), config, Lease(request)));
    const v1::WorkerAssignment& assignment = made.first.assignment();
    EXPECT_EQ(assignment.main_program(), 9);
    EXPECT_EQ(Contents(assignment), (Programs{{9, "STOP\n"}, {45, "RESUME\n"}}));
    EXPECT_EQ(assignment.programs(0).is_source(), !object);
    EXPECT_EQ(assignment.programs(1).is_source(), !object);
    EXPECT_EQ(assignment.programs(0).file_name(), object ? "part.O" : "part.S");
    EXPECT_EQ(assignment.programs(1).file_name(), object ? "45.O" : "45.S");
  }
}

// OPT-1.11: the executable of the program that is started comes with it, and its title.
TEST_F(AssignmentTest, BringsTitlesAndTheExecutableOfTheMainProgram) {
  Put(32, "object 32");
  Put(44, "object 44");
  Must(bed.store().PutExecutable("optimo-1", 32, 1, "executable 32"));
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(32))));
  const v1::WorkerAssignment& assignment = made.first.assignment();
  ASSERT_EQ(assignment.programs_size(), 2);
  EXPECT_EQ(assignment.programs(0).title(), "p32");
  EXPECT_EQ(assignment.programs(0).executable(), "executable 32");
  EXPECT_EQ(assignment.programs(0).size(), 9);
  EXPECT_EQ(assignment.programs(1).title(), "p44");
  EXPECT_EQ(assignment.programs(1).executable(), "");
  EXPECT_EQ(Revisions(assignment), 2);
}

// Programs of up to 64 KiB go with the assignment, as long as all of them together have up to 1
// MiB.
TEST_F(AssignmentTest, FollowsTheAssignmentFromAByteMoreThanGoesWithIt) {
  WidenMemory();
  constexpr std::size_t kInline = 65'536;
  Put(1, std::string(kInline + 1, 'm'));
  for (int slot = 2; slot <= 17; ++slot) Put(slot, std::string(kInline, 'a'));
  Put(18, "b");
  const auto made = Must(MakeAssignment(bed.store(), config, Lease(Stored(1))));
  std::set<int> later;
  for (const auto& [slot, bytes] : made.programs) later.insert(slot);
  // 2 to 17 fill the megabyte; the main program is too large and 18 comes too late.
  EXPECT_EQ(later, (std::set<int>{1, 18}));
  for (const v1::AssignedProgram& program : made.first.assignment().programs()) {
    EXPECT_EQ(program.content().empty(), later.contains(program.slot())) << program.slot();
  }
}

TEST_F(AssignmentTest, WhatCannotBeReadIsAnError) {
  storage::LeasedJob leased = Lease([&] {
    Put(1, "object");
    return Stored(1);
  }());
  leased.job.machine = "none";
  EXPECT_EQ(CodeOf(MakeAssignment(bed.store(), config, leased)), ErrorCode::kCellUnknownMachine);
  leased.job.machine = "optimo-1";
  leased.job.specification = "\xFF\xFF";
  EXPECT_EQ(CodeOf(MakeAssignment(bed.store(), config, leased)), ErrorCode::kCellStoreCorrupt);
  Must(bed.store().SubmitAndWait({.machine = "optimo-1", .kind = "CHECK"}));  // without its program
  leased = *Must(bed.store().Acquire("w", {"CHECK"}, std::chrono::hours(1), {}));
  EXPECT_EQ(CodeOf(MakeAssignment(bed.store(), config, leased)), ErrorCode::kCellNotFound);
}

// One message is limited: many programs of moderate size follow it as well.
TEST_F(AssignmentTest, WhatDoesNotFitIntoOneMessageFollowsIt) {
  WidenMemory();
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
