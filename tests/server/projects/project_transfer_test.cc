#include "server/projects/project_transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::Must;
using testing::ElementsAre;
using testing::HasSubstr;

template <class T>
ErrorCode Refusal(const ProgramResult<T>& result) {
  return result ? ErrorCode::kCellInternal : result.error.error.code;
}
template <class T>
T Made(ProgramResult<T> result) {
  if (!result) ADD_FAILURE() << result.error.error.detail;
  return result ? *std::move(result.value) : T();
}

class ProjectTransferTest : public testing::Test {
 protected:
  void Put(int slot, const std::string& file, const std::string& text,
           const std::string& machine = "optimo-1") {
    Made(programs.Store({.name = "machines/" + machine + "/programs/" + std::to_string(slot),
                         .file_name = file,
                         .title = "p" + std::to_string(slot),
                         .bytes = text}));
  }
  // The machine itself takes no inches: they come with a project.
  void BringInch(int slot, const std::string& file, const std::string& text) {
    v1::CreateProjectRequest request;
    request.set_project_id("inch-" + std::to_string(slot));
    v1::ProjectProgram& program = *request.mutable_project()->add_programs();
    program.set_slot(slot);
    program.set_title("p" + std::to_string(slot));
    program.mutable_source()->set_file_name(file);
    program.mutable_source()->set_content(text);
    Made(projects.Create(request, "anna"));
    Made(Bring("inch-" + std::to_string(slot)));
  }
  void PutSchedule(int number, const std::string& mode, double power) {
    Must(bed.store().PutSchedule({.machine = "optimo-1",
                                  .number = number,
                                  .name = "s" + std::to_string(number),
                                  .mode = mode,
                                  .power_percent = power},
                                 storage::kAnyRevision));
  }
  ProgramResult<v1::Project> Take(const std::string& id, std::vector<int> slots = {},
                                  v1::Units units = v1::UNITS_UNSPECIFIED,
                                  const std::string& machine = "optimo-1") {
    v1::TransferProjectFromMachineRequest request;
    request.set_machine("machines/" + machine);
    request.set_project_id(id);
    *request.mutable_slots() = {slots.begin(), slots.end()};
    request.set_units(units);
    return transfer.FromMachine(request, "Thu Mar 04 08:52:34 1993", "anna");
  }
  ProgramResult<v1::TransferProjectResponse> Bring(const std::string& id,
                                                   bool validate_only = false,
                                                   const std::string& etag = {}) {
    v1::TransferProjectRequest request;
    request.set_name("projects/" + id);
    request.set_machine("machines/optimo-1");
    request.set_validate_only(validate_only);
    request.set_etag(etag);
    return transfer.ToMachine(request, "anna");
  }
  std::vector<std::string> Changes(const v1::TransferProjectResponse& response) {
    std::vector<std::string> changes;
    for (const v1::TransferItem& item : response.items()) {
      changes.push_back(item.name().substr(std::string("machines/optimo-1/").size()) + " " +
                        v1::TransferChange_Name(item.change()).substr(16));
    }
    return changes;
  }

  ServerBed bed;
  Config config;
  ProjectBook projects{bed.store()};
  ProgramBook programs{bed.store(), config};
  ProjectTransfer transfer{bed.store(), projects, programs};
};

// OPT-B.73: all of a project or nothing of it.
TEST_F(ProjectTransferTest, WhatHasNoRoomIsNotBrought) {
  v1::CreateProjectRequest request;
  request.set_project_id("large");
  for (const int slot : {20, 21}) {
    v1::ProjectProgram& program = *request.mutable_project()->add_programs();
    program.set_slot(slot);
    program.mutable_source()->set_file_name("a.S");
    std::string text;
    for (int i = 0; i < 200; ++i) text += "DELAY 1\n";
    program.mutable_source()->set_content(text);
  }
  Made(projects.Create(request, "anna"));
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  machine.parameters = {{"CMOS_SIZE", "1000"}};
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  EXPECT_EQ(Refusal(Bring("large", true)), ErrorCode::kCmosFull);
  EXPECT_EQ(Refusal(Bring("large")), ErrorCode::kCmosFull);
  EXPECT_TRUE(Must(bed.store().ListPrograms("optimo-1", 0, 99)).empty());
}

// OPT-8.68: to the PC and back, programs and schedules are identical.
TEST_F(ProjectTransferTest, ToThePcAndBackNothingIsChanged) {
  const std::string text = "SPEED 5   ; slow\nSTOP\n";
  const std::string inch = "; of the shop\nMOVE (1.0, 2.0, -1.0, 0.0, 0.0)\nSTOP\n";
  Put(12, "door.S", text);
  BringInch(44, "door.SI", inch);
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 7, .object = ObjectOf("STOP\n")}}, {}));
  PutSchedule(11, "PULSE", 40.0);
  const auto all = [](const auto&) { return true; };
  const auto before = Must(bed.store().GetMachineMemory("optimo-1", all));
  const v1::Project project = Made(Take("door"));
  EXPECT_EQ(project.programs_size(), 3);
  ASSERT_TRUE(bed.store().DeleteProgram("optimo-1", 44, storage::kAnyRevision));
  ASSERT_TRUE(bed.store().DeleteSchedule("optimo-1", 11));
  Made(Bring("door"));
  const auto after = Must(bed.store().GetMachineMemory("optimo-1", all));
  ASSERT_EQ(after.programs.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(after.programs[i].slot, before.programs[i].slot);
    EXPECT_EQ(after.programs[i].object, before.programs[i].object);
    EXPECT_EQ(after.programs[i].name, before.programs[i].name);
  }
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 12)).source, text);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 44)).source, inch);
  ASSERT_EQ(after.schedules.size(), 1U);
  EXPECT_EQ(after.schedules[0].mode, "PULSE");
  EXPECT_EQ(after.schedules[0].power_percent, 40.0);
}

// OPT-8.70: metric as it is decompiled, and in inches for a project that wants inches.
TEST_F(ProjectTransferTest, AProjectMayWantInches) {
  const std::string inch = "MOVE (2.0, 2.0, -1.0, 0.0, 0.0)\nSTOP\n";
  const std::string object = ObjectOf("MOVE (25.4, 50.8, -25.4, 0.0, 0.0)\nSTOP\n");
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 7, .object = object}}, {}));
  BringInch(8, "8.SI", inch);
  Made(Take("metric", {7}));
  EXPECT_THAT(Must(projects.Get("projects/metric")).programs(0).source().content(),
              HasSubstr("MOVE (25.4, 50.8, -25.4, 0.0, 0.0)"));
  Made(Take("inch", {7, 8}, v1::UNITS_INCH));
  const v1::Project both = Must(projects.Get("projects/inch"));
  EXPECT_EQ(both.programs(0).source().file_name(), "7.SI");
  EXPECT_THAT(both.programs(0).source().content(), HasSubstr("MOVE (1.0, 2.0, -1.0, 0.0, 0.0)"));
  EXPECT_EQ(both.programs(1).source().content(), inch);  // it has them
  Made(Take("mm", {8}, v1::UNITS_METRIC));
  EXPECT_THAT(Must(projects.Get("projects/mm")).programs(0).source().content(),
              HasSubstr("MOVE (50.8, 50.8, -25.4, 0.0, 0.0)"));
}

// So does one whose name tells no units; what is named as an object is no text to convert.
TEST_F(ProjectTransferTest, ATextWithoutAnExtensionMayComeInInches) {
  Put(9, "part", "MOVE (25.4, 50.8, -25.4, 0.0, 0.0)\nSTOP\n");
  const v1::ProgramText text = Made(Take("inch", {9}, v1::UNITS_INCH)).programs(0).source();
  EXPECT_EQ(text.file_name(), "part.si");
  EXPECT_THAT(text.content(), HasSubstr("MOVE (1.0, 2.0, -1.0, 0.0, 0.0)"));
  Must(bed.store().PutPrograms(
      "optimo-1",
      {{.slot = 10, .object = ObjectOf("STOP\n"), .source = "STOP\n", .source_name = "part.O"}},
      {}));
  EXPECT_EQ(Refusal(Take("object", {10}, v1::UNITS_INCH)), ErrorCode::kCellInvalidArgument);
}

TEST_F(ProjectTransferTest, TakesTheStreamsOfAMill) {
  Put(3, "cup.rml", "PA;PU0,0;", "mill-1");
  Made(Take("cup", {}, v1::UNITS_INCH, "mill-1"));  // a stream has its own units
  const v1::Project project = Must(projects.Get("projects/cup"));
  ASSERT_EQ(project.programs_size(), 1);
  EXPECT_EQ(project.programs(0).slot(), 3);
  EXPECT_EQ(project.programs(0).title(), "p3");
  EXPECT_EQ(project.programs(0).source().file_name(), "cup.rml");
  EXPECT_EQ(project.programs(0).source().content(), "PA;PU0,0;");
}

TEST_F(ProjectTransferTest, TakesNothingThatIsNotThere) {
  EXPECT_EQ(Refusal(Take("a")), ErrorCode::kProjectSource);
  Put(12, "a.S", "STOP\n");
  EXPECT_EQ(Refusal(Take("a", {13})), ErrorCode::kProgramMissing);
  EXPECT_EQ(Refusal(Take("a", {100})), ErrorCode::kProgramNumber);
  EXPECT_EQ(Refusal(Take("a", {}, static_cast<v1::Units>(9))), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Refusal(Take("a", {}, v1::UNITS_METRIC, "none")), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(Refusal(Take("A", {})), ErrorCode::kCellInvalidArgument);
  Made(Take("a"));
  EXPECT_EQ(Refusal(Take("a")), ErrorCode::kCellAlreadyExists);
}

// WEB-3.07: each item before, and what was stored after, schedules included.
TEST_F(ProjectTransferTest, TellsWhatBecomesOfEachItem) {
  Put(12, "12.S", "STOP\n");
  Put(13, "13.S", "SPEED 5\nSTOP\n");
  PutSchedule(11, "CW", 40.0);
  PutSchedule(12, "CW", 40.0);
  Made(Take("door"));
  v1::Project project = Must(projects.Get("projects/door"));
  project.mutable_programs(1)->mutable_source()->set_content("SPEED 6\nSTOP\n");
  *project.add_programs() = project.programs(0);
  project.mutable_programs(2)->set_slot(20);
  project.mutable_laser_schedules(0)->set_power_percent(41.0);
  *project.add_laser_schedules() = project.laser_schedules(0);
  project.mutable_laser_schedules(2)->set_number(5);
  v1::UpdateProjectRequest update;
  *update.mutable_project() = project;
  Made(projects.Update(update, "anna"));

  const std::vector<std::string> changes = {"programs/12 SAME",          "programs/13 REPLACE",
                                            "programs/20 ADD",           "laserSchedules/5 ADD",
                                            "laserSchedules/11 REPLACE", "laserSchedules/12 SAME"};
  const auto preview = Made(Bring("door", true));
  EXPECT_EQ(Changes(preview), changes);
  EXPECT_EQ(preview.items(1).program_before().object_bytes(),
            static_cast<std::int64_t>(ObjectOf("SPEED 5\nSTOP\n").size()));
  EXPECT_EQ(preview.items(1).program_after().etag(), "");
  EXPECT_FALSE(preview.items(2).has_program_before());
  EXPECT_EQ(preview.items(4).laser_schedule_before().power_percent(), 40.0);
  EXPECT_EQ(preview.items(4).laser_schedule_after().power_percent(), 41.0);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 13)).revision, 1);  // nothing was stored

  const auto done = Made(Bring("door", false, preview.etag()));
  EXPECT_EQ(Changes(done), changes);
  EXPECT_EQ(done.items(1).program_after().etag(), "2");
  EXPECT_EQ(done.items(1).program_after().object_sha256(),
            preview.items(1).program_after().object_sha256());
  EXPECT_EQ(done.items(4).laser_schedule_after().etag(), "2");
  EXPECT_NE(Made(Bring("door", true)).etag(), preview.etag());
}

// WEB-3.07: a machine that was changed after the preview refuses the transfer.
TEST_F(ProjectTransferTest, IsRefusedWhereTheMachineWasChangedSinceThePreview) {
  Put(12, "12.S", "STOP\n");
  PutSchedule(11, "CW", 40.0);
  Made(Take("door"));
  for (const auto& change : std::vector<std::function<void()>>{
           [&] { Put(12, "12.S", "SPEED 5\nSTOP\n"); },
           [&] { ASSERT_TRUE(bed.store().DeleteProgram("optimo-1", 12, storage::kAnyRevision)); },
           [&] { PutSchedule(11, "CW", 41.0); },
           [&] { ASSERT_TRUE(bed.store().DeleteSchedule("optimo-1", 11)); }}) {
    const std::string seen = Made(Bring("door", true)).etag();
    Made(Bring("door", true, seen));
    change();
    EXPECT_EQ(Refusal(Bring("door", false, seen)), ErrorCode::kCellEtagMismatch);
    EXPECT_EQ(Refusal(Bring("door", true, seen)), ErrorCode::kCellEtagMismatch);
  }
  // Of other slots nothing was said.
  const std::string seen = Made(Bring("door", true)).etag();
  Put(50, "50.S", "STOP\n");
  Made(Bring("door", false, seen));
}

}  // namespace
}  // namespace rmlcell::server
