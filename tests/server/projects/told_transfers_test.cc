// What is told of a transfer, and a machine that is changed while one goes on.
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/projects/packed_together.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Somebody else is at work just before programs are stored.
class StoreWithOthers final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<storage::ProgramWrite>& programs,
      const std::vector<storage::ScheduleRecord>& schedules, std::string_view caller) override {
    if (others) others();
    return store_.PutPrograms(machine, programs, schedules, caller);
  }
  std::function<void()> others{};
};

class ToldTransfers : public testing::Test {
 protected:
  static constexpr const char* kSource = "SPEED 5\nSTOP\n";

  void Create(const v1::Project& project) {
    v1::CreateProjectRequest request;
    request.set_project_id("door");
    *request.mutable_project() = project;
    ASSERT_TRUE(projects.Create(request, "anna"));
  }
  static v1::ProjectProgram& Add(v1::Project& project, int slot) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(slot);
    program.set_title("door");
    program.mutable_source()->set_file_name("door.S");
    program.mutable_source()->set_content(kSource);
    return program;
  }
  static void AddSchedule(v1::Project& project, int number) {
    v1::ProjectLaserSchedule& schedule = *project.add_laser_schedules();
    schedule.set_number(number);
    schedule.set_title("thin");
    schedule.set_mode(v1::LASER_MODE_CW);
    schedule.set_power_percent(40.0);
  }
  void PutSchedule(int number, const std::string& title, const std::string& mode) {
    Must(bed.store().PutSchedule({.machine = "optimo-1",
                                  .number = number,
                                  .name = title,
                                  .mode = mode,
                                  .power_percent = 40.0},
                                 storage::kAnyRevision));
  }
  void Put(int slot, const std::string& title, const std::string& source, const std::string& name) {
    Must(bed.store().PutPrograms("optimo-1",
                                 {{.slot = slot,
                                   .name = title,
                                   .object = ObjectOf(kSource),
                                   .source = source,
                                   .source_name = name,
                                   .expected = storage::kAnyRevision}},
                                 {}));
  }
  ProgramResult<v1::TransferProjectResponse> Bring(bool validate_only,
                                                   const std::string& etag = {}) {
    v1::TransferProjectRequest request;
    request.set_name("projects/door");
    request.set_machine("machines/optimo-1");
    request.set_validate_only(validate_only);
    request.set_etag(etag);
    return transfer.ToMachine(request, "anna");
  }
  std::optional<ErrorCode> Refusal(bool validate_only, const std::string& etag) {
    const auto brought = Bring(validate_only, etag);
    return brought ? std::nullopt : std::optional(brought.error.error.code);
  }

  ServerBed bed;
  StoreWithOthers store{bed.store()};
  Config config;
  ProjectBook projects{store};
  ProgramBook programs{store, config};
  ProjectTransfer transfer{store, projects, programs};
};

// WEB-3.07: whatever of an item is another one makes it another item.
TEST_F(ToldTransfers, AnItemIsTheSameWhereAllOfItIs) {
  v1::Project project;
  for (const int slot : {11, 12, 13, 14}) Add(project, slot);
  for (const int number : {1, 2, 3}) AddSchedule(project, number);
  Create(project);
  Put(11, "door", kSource, "door.S");
  Put(12, "lid", kSource, "door.S");
  Put(13, "door", "SPEED 5   ; slow\nSTOP\n", "door.S");
  Put(14, "door", kSource, "lid.S");
  PutSchedule(1, "thin", "CW");
  PutSchedule(2, "thick", "CW");
  PutSchedule(3, "thin", "PULSE");
  const auto preview = Bring(true);
  ASSERT_TRUE(preview);
  ASSERT_EQ(preview.value->items_size(), 7);
  for (const int same : {0, 4})
    EXPECT_EQ(preview.value->items(same).change(), v1::TRANSFER_CHANGE_SAME) << same;
  for (const int other : {1, 2, 3, 5, 6})
    EXPECT_EQ(preview.value->items(other).change(), v1::TRANSFER_CHANGE_REPLACE) << other;
  EXPECT_TRUE(preview.value->findings().ok());
  const v1::Program& after = preview.value->items(0).program_after();
  EXPECT_EQ(after.name(), "machines/optimo-1/programs/11");
  EXPECT_EQ(after.title(), "door");
  EXPECT_EQ(after.file_name(), "door.S");
  EXPECT_EQ(after.source_bytes(), 13);
  EXPECT_EQ(after.object_bytes(), static_cast<std::int64_t>(ObjectOf(kSource).size()));
  EXPECT_EQ(preview.value->items(4).laser_schedule_before().etag(), "1");
  EXPECT_EQ(preview.value->items(4).laser_schedule_after().etag(), "");  // it is not stored yet
}

// WEB-3.07: so is a slot, or a schedule, that was empty when it was looked at.
TEST_F(ToldTransfers, WhatIsFilledSinceThePreviewIsAChange) {
  v1::Project project;
  Add(project, 11);
  AddSchedule(project, 1);
  Create(project);
  const auto before = Bring(true);
  ASSERT_TRUE(before);
  PutSchedule(1, "thin", "CW");
  EXPECT_EQ(Refusal(true, before.value->etag()), ErrorCode::kCellEtagMismatch);
  const auto with_schedule = Bring(true);
  ASSERT_TRUE(with_schedule);
  Put(11, "door", kSource, "door.S");
  EXPECT_EQ(Refusal(false, with_schedule.value->etag()), ErrorCode::kCellEtagMismatch);
}

// WEB-3.07: and a project that wants slot 11 since, where it wanted schedule 11 before.
TEST_F(ToldTransfers, ASlotIsNoSchedule) {
  v1::Project project;
  Add(project, 12);
  AddSchedule(project, 11);
  Create(project);
  for (const int slot : {11, 12}) Put(slot, "door", kSource, "door.S");
  PutSchedule(11, "thin", "CW");
  const auto before = Bring(true);
  ASSERT_TRUE(before);
  project.clear_laser_schedules();
  Add(project, 11);
  v1::UpdateProjectRequest update;
  *update.mutable_project() = project;
  update.mutable_project()->set_name("projects/door");
  update.mutable_update_mask()->add_paths("*");
  ASSERT_TRUE(projects.Update(update, "anna"));
  EXPECT_EQ(Refusal(true, before.value->etag()), ErrorCode::kCellEtagMismatch);
}

// What is stored between the last look and the transfer is replaced only where nobody asked.
TEST_F(ToldTransfers, OthersAreNotOverwrittenUnseen) {
  v1::Project project;
  Add(project, 11);
  Create(project);
  Put(11, "old", kSource, "old.S");
  const auto preview = Bring(true);
  ASSERT_TRUE(preview);
  int tells = 0;
  programs.OnStored([&tells] { ++tells; });
  store.others = [this] { Put(11, "of another", kSource, "other.S"); };
  EXPECT_EQ(Refusal(false, preview.value->etag()), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 11)).name, "of another");
  EXPECT_EQ(tells, 0);
  EXPECT_EQ(Refusal(false, {}), std::nullopt);
  EXPECT_EQ(Must(bed.store().GetProgram("optimo-1", 11)).name, "door");
  EXPECT_EQ(tells, 1);
  EXPECT_EQ(Refusal(true, {}), std::nullopt);
  EXPECT_EQ(tells, 1);
}

// The machine gives the project its title, and each schedule with all that it has.
TEST_F(ToldTransfers, WhatComesFromAMachineHasItsTitles) {
  Put(11, "door", kSource, "door.S");
  PutSchedule(7, "thin", "PULSE");
  v1::TransferProjectFromMachineRequest request;
  request.set_machine("machines/optimo-1");
  request.set_project_id("taken");
  const auto taken = transfer.FromMachine(request, "Thu Mar 04 08:52:34 1993", "anna");
  ASSERT_TRUE(taken) << taken.error.error.detail;
  EXPECT_EQ(taken.value->title(), "Laser");
  ASSERT_EQ(taken.value->laser_schedules_size(), 1);
  EXPECT_EQ(taken.value->laser_schedules(0).number(), 7);
  EXPECT_EQ(taken.value->laser_schedules(0).title(), "thin");
  EXPECT_EQ(taken.value->laser_schedules(0).mode(), v1::LASER_MODE_PULSE);
  EXPECT_EQ(taken.value->laser_schedules(0).power_percent(), 40.0);
}

// OPT-3.01: processes are those of a laser; to a project of streams alone they say nothing.
TEST_F(ToldTransfers, StreamsHaveNoProcesses) {
  v1::CreateProjectRequest request;
  request.set_project_id("cup");
  request.set_validate_only(true);
  v1::Project& project = *request.mutable_project();
  v1::ProjectProcess& process = *project.add_processes();
  process.set_kind(2);  // without the schedule that it needs
  Add(project, 1).mutable_source()->set_file_name("cup.rml");
  Add(project, 2).mutable_source()->set_file_name("outline");
  EXPECT_TRUE(projects.Create(request, "anna"));
  project.mutable_programs(1)->mutable_source()->set_file_name("door.S");
  const auto laser = projects.Create(request, "anna");
  ASSERT_FALSE(laser);
  EXPECT_EQ(laser.error.error.code, ErrorCode::kArgumentCount);
  // One stream is enough to say so; a name that says nothing may be of a laser.
  project.mutable_programs()->DeleteSubrange(1, 1);
  EXPECT_TRUE(projects.Create(request, "anna"));
  project.mutable_programs(0)->mutable_source()->set_file_name("outline");
  EXPECT_FALSE(projects.Create(request, "anna"));
}

// What a cell says of a project that it keeps is not of the next one.
TEST_F(ToldTransfers, AnArchiveBringsNothingOfAnotherCell) {
  const auto read = ReadProjectArchive(PackedTogether(
      {{"project.json",
        R"({"name":"projects/door","etag":"7","title":"Door","createTime":"2001-01-01T00:00:00Z",)"
        R"("updateTime":"2001-01-01T00:00:00Z"})"}}));
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->title(), "Door");
  EXPECT_EQ(read->name(), "");
  EXPECT_EQ(read->etag(), "");
  EXPECT_FALSE(read->has_create_time());
  EXPECT_FALSE(read->has_update_time());
  // Of two files that are not there the first is named.
  const auto missing = ReadProjectArchive(
      PackedTogether({{"project.json", R"({"programs":[{"slot":1,"source":{"fileName":"first.S"}},)"
                                       R"({"slot":2,"source":{"fileName":"second.S"}}]})"}}));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().detail,
            "the archive has no file first.S, which its project.json names");
}

}  // namespace
}  // namespace rmlcell::server
