// The program memory that a worker is given with a job: what comes with the order, what follows in
// parts, and what the machine is.
#include "server/worker/assigned_programs.h"

#include <gtest/gtest.h>

#include <string>

namespace rmlcell::server {
namespace {

v1::AssignedProgram Program(int slot, const std::string& content, std::int64_t size) {
  v1::AssignedProgram program;
  program.set_slot(slot);
  program.set_file_name(std::to_string(slot) + ".S");
  program.set_content(content);
  program.set_size(size);
  program.set_is_source(true);
  return program;
}

v1::WorkerBlob Part(int slot, const std::string& chunk) {
  v1::WorkerBlob part;
  part.set_slot(slot);
  part.set_chunk(chunk);
  return part;
}

TEST(AssignedPrograms, AreCompleteWithTheLastByteOfEach) {
  v1::WorkerAssignment assignment;
  assignment.set_family("optimo");
  *assignment.add_programs() = Program(12, "SPEED 5\n", 8);
  *assignment.add_programs() = Program(44, "", 6);
  AssignedPrograms programs(assignment);
  EXPECT_FALSE(programs.complete());
  programs.Add(Part(44, "SPE"));
  EXPECT_FALSE(programs.complete());
  programs.Add(Part(45, "of nobody"));
  EXPECT_FALSE(programs.complete());
  programs.Add(Part(44, "ED\n"));
  EXPECT_TRUE(programs.complete());
  const simulation::ProgramMemory memory = programs.Memory();
  ASSERT_EQ(memory.programs.size(), 2U);
  EXPECT_EQ(*memory.programs[0].bytes, "SPEED 5\n");
  EXPECT_EQ(*memory.programs[1].bytes, "SPEED\n");
}

TEST(AssignedPrograms, WaitForTheirTargetWhereThereIsOne) {
  v1::WorkerAssignment assignment;
  assignment.set_family("rml1");
  *assignment.add_programs() = Program(1, "PU;", 3);
  *assignment.mutable_target() = Program(0, "PU", 3);
  AssignedPrograms programs(assignment);
  EXPECT_FALSE(programs.complete());
  programs.Add(Part(0, ";"));
  EXPECT_TRUE(programs.complete());
  EXPECT_EQ(programs.Memory().programs.size(), 1U);  // a target is no program of the machine
}

TEST(AssignedPrograms, HaveTheirNamesAndTheirExecutables) {
  v1::WorkerAssignment assignment;
  assignment.set_family("optimo");
  *assignment.add_programs() = Program(12, "a", 1);
  v1::AssignedProgram object = Program(13, "b", 1);
  object.set_title("bracket");
  object.set_is_source(false);
  object.set_executable("x");
  *assignment.add_programs() = object;
  const simulation::ProgramMemory memory = AssignedPrograms(assignment).Memory();
  ASSERT_EQ(memory.programs.size(), 2U);
  EXPECT_EQ(memory.programs[0].slot, 12);
  EXPECT_EQ(memory.programs[0].name, "12.S");  // no title: as its file
  EXPECT_EQ(memory.programs[0].file_name, "12.S");
  EXPECT_TRUE(memory.programs[0].is_source);
  EXPECT_TRUE(memory.programs[0].executable->empty());
  EXPECT_EQ(memory.programs[1].slot, 13);
  EXPECT_EQ(memory.programs[1].name, "bracket");
  EXPECT_EQ(memory.programs[1].file_name, "13.S");
  EXPECT_FALSE(memory.programs[1].is_source);

  EXPECT_EQ(*memory.programs[1].executable, "x");
}

TEST(AssignedPrograms, HaveTheMachineAsItStands) {
  v1::WorkerAssignment assignment;
  assignment.set_family("optimo");
  assignment.set_profile("pw-1993");
  assignment.set_machine_state("state");
  assignment.add_deleted_programs(7);
  assignment.mutable_job()->set_machine("machines/laser-1");
  simulation::ProgramMemory memory = AssignedPrograms(assignment).Memory();
  ASSERT_NE(memory.family, nullptr);
  EXPECT_EQ(memory.family->info().id, "optimo");
  EXPECT_EQ(memory.profile, "pw-1993");
  EXPECT_EQ(memory.parameters_of, "");  // nobody changed any
  EXPECT_EQ(memory.machine_state, "state");
  EXPECT_EQ(memory.deleted_programs.size(), 1U);
  EXPECT_TRUE(memory.schedules.empty());
  (*assignment.mutable_parameters())["OBJECT_LIMIT"] = "30000";
  v1::AssignedSchedule& schedule = *assignment.add_schedules();
  schedule.set_number(11);
  schedule.set_title("fine");
  schedule.set_mode("PULSE");
  schedule.set_power_percent(50.0);
  memory = AssignedPrograms(assignment).Memory();
  EXPECT_EQ(memory.parameters.at("OBJECT_LIMIT"), "30000");
  EXPECT_EQ(memory.parameters_of, "machines/laser-1");
  ASSERT_EQ(memory.schedules.size(), 1U);
  EXPECT_EQ(memory.schedules.front().number, 11);
  EXPECT_EQ(memory.schedules.front().name, "fine");
  EXPECT_EQ(memory.schedules.front().mode, "PULSE");
  EXPECT_EQ(memory.schedules.front().power_percent, 50.0);
}

}  // namespace
}  // namespace rmlcell::server
