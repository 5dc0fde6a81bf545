// The bounds of projects and of their lists, each on both sides; values from
// proto/rmlcell/v1/project.proto.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ProjectLimits : public testing::Test {
 protected:
  // What the server says to a project with this change, asked only.
  std::optional<ErrorCode> Asked(const std::function<void(v1::Project&)>& change) {
    v1::CreateProjectRequest request;
    request.set_project_id("asked");
    change(*request.mutable_project());
    request.set_validate_only(true);
    const auto created = book.Create(request, "anna");
    return created ? std::nullopt : std::optional(created.error.error.code);
  }
  void Fill(int count) {
    for (int i = 0; i < count; ++i) {
      const std::string number = std::to_string(10'000 + i);
      Must(bed.store().PutProject({.id = "p" + number, .title = "t" + number}, 0));
    }
  }
  v1::ListProjectsResponse Page(int size, const std::string& token = "") {
    v1::ListProjectsRequest request;
    request.set_page_size(size);
    request.set_page_token(token);
    return Must(book.List(request));
  }

  ServerBed bed;
  ProjectBook book{bed.store()};
  Config config;
  ProgramBook programs{bed.store(), config};
  ProjectTransfer transfers{bed.store(), book, programs};
};

// ListProjectsRequest.page_size: 0 is 100, at most 1000, below 0 is refused.
TEST_F(ProjectLimits, PagesHaveAHundredProjectsOrSoManyAsWantedUpToAThousand) {
  Fill(1002);
  EXPECT_EQ(Page(0).projects_size(), 100);
  EXPECT_EQ(Page(0).next_page_token(), "p10099");
  EXPECT_EQ(Page(1).projects_size(), 1);
  EXPECT_EQ(Page(1).projects(0).name(), "projects/p10000");
  EXPECT_EQ(Page(1, "p10000").projects(0).name(), "projects/p10001");
  EXPECT_EQ(Page(999).projects_size(), 999);
  for (const int size : {1000, 1001, std::numeric_limits<int>::max()}) {
    const v1::ListProjectsResponse page = Page(size);
    EXPECT_EQ(page.projects_size(), 1000) << size;
    const v1::ListProjectsResponse rest = Page(size, page.next_page_token());
    ASSERT_EQ(rest.projects_size(), 2) << size;
    EXPECT_EQ(rest.projects(0).name(), "projects/p11000");
    EXPECT_EQ(rest.projects(0).title(), "t11000");
    EXPECT_EQ(rest.next_page_token(), "");
  }
  v1::ListProjectsRequest request;
  request.set_page_size(-1);
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellInvalidArgument);
}

TEST_F(ProjectLimits, OfTexts) {
  EXPECT_EQ(Asked([](v1::Project& p) { p.set_title(std::string(200, 't')); }), std::nullopt);
  EXPECT_EQ(Asked([](v1::Project& p) { p.set_title(std::string(201, 't')); }),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Asked([](v1::Project& p) { p.set_notes(std::string(65'536, 'n')); }), std::nullopt);
  EXPECT_EQ(Asked([](v1::Project& p) { p.set_notes(std::string(65'537, 'n')); }),
            ErrorCode::kCellInvalidArgument);
}

// OPT-1.10: slots 1 to 99.
TEST_F(ProjectLimits, OfPrograms) {
  const auto asked = [&](int slot, std::size_t title) {
    return Asked([&](v1::Project& project) {
      v1::ProjectProgram& program = *project.add_programs();
      program.set_slot(slot);
      program.set_title(std::string(title, 't'));
      program.mutable_source()->set_content("STOP\n");
    });
  };
  for (const int slot : {1, 99}) EXPECT_EQ(asked(slot, 200), std::nullopt) << slot;
  for (const int slot : {-1, 0, 100}) EXPECT_EQ(asked(slot, 0), ErrorCode::kProgramNumber) << slot;
  EXPECT_EQ(asked(1, 201), ErrorCode::kCellInvalidArgument);
}

// ProjectProgram.units: metric against a name that says inch (OPT-8.72) is refused; inch counts for
// any name, and without units the name counts.
TEST_F(ProjectLimits, UnitsThatContradictTheNameOfTheFile) {
  const auto asked = [&](v1::Units units, const std::string& name) {
    v1::CreateProjectRequest request;
    request.set_project_id("asked");
    request.set_validate_only(true);
    for (const int slot : {45, 46}) {
      v1::ProjectProgram& program = *request.mutable_project()->add_programs();
      program.set_slot(slot);
      program.mutable_source()->set_content("STOP\n");
      if (slot == 45) continue;
      program.mutable_source()->set_file_name(name);
      program.set_units(units);
    }
    const auto created = book.Create(request, "anna");
    return created ? "" : created.error.error.detail;
  };
  for (const std::string name : {"46.SI", "46.si", "hole.Si"}) {
    EXPECT_EQ(asked(v1::UNITS_METRIC, name), "program 46: units are UNITS_METRIC, but the name " +
                                                 name + " says inch: leave the units out, or " +
                                                 "rename the file");
    EXPECT_EQ(asked(v1::UNITS_INCH, name), "");
    EXPECT_EQ(asked(v1::UNITS_UNSPECIFIED, name), "");
  }
  for (const std::string name : {"", "46.S", "SI.S", "46.CMP", "46.O"}) {
    for (const v1::Units units : {v1::UNITS_UNSPECIFIED, v1::UNITS_METRIC, v1::UNITS_INCH})
      EXPECT_EQ(asked(units, name), "") << name;
  }
  const auto change = [](v1::Project& project) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(45);
    program.mutable_source()->set_file_name("45.SI");
    program.mutable_source()->set_content("STOP\n");
    program.set_units(v1::UNITS_METRIC);
  };
  EXPECT_EQ(Asked(change), ErrorCode::kCellInvalidArgument);
  v1::CreateProjectRequest kept;
  kept.set_project_id("kept");
  ASSERT_TRUE(book.Create(kept, "anna"));
  v1::UpdateProjectRequest update;
  change(*update.mutable_project());
  update.mutable_project()->set_name("projects/kept");
  const auto updated = book.Update(update, "anna");
  ASSERT_FALSE(updated);
  EXPECT_EQ(updated.error.error.code, ErrorCode::kCellInvalidArgument);
}

// OPT-3.44: schedules 1 to 63, power 0 to 100 %.
TEST_F(ProjectLimits, OfLaserSchedules) {
  const auto asked = [&](int number, v1::LaserMode mode, double power_percent, std::size_t title) {
    return Asked([&](v1::Project& project) {
      v1::ProjectLaserSchedule& schedule = *project.add_laser_schedules();
      schedule.set_number(number);
      schedule.set_mode(mode);
      schedule.set_power_percent(power_percent);
      schedule.set_title(std::string(title, 't'));
    });
  };
  for (const int number : {1, 63})
    EXPECT_EQ(asked(number, v1::LASER_MODE_UNSPECIFIED, 50.0, 200), std::nullopt) << number;
  for (const int number : {0, 64})
    EXPECT_EQ(asked(number, v1::LASER_MODE_UNSPECIFIED, 50.0, 0), ErrorCode::kScheduleRange);
  for (const v1::LaserMode mode :
       {v1::LASER_MODE_UNSPECIFIED, v1::LASER_MODE_CW, v1::LASER_MODE_PULSE})
    EXPECT_EQ(asked(1, mode, 50.0, 0), std::nullopt);
  for (const int mode : {-1, 3})
    EXPECT_EQ(asked(1, static_cast<v1::LaserMode>(mode), 50.0, 0), ErrorCode::kCellInvalidArgument);
  for (const double power : {0.0, 100.0})
    EXPECT_EQ(asked(1, v1::LASER_MODE_CW, power, 0), std::nullopt) << power;
  for (const double power : {-0.001, 100.001})
    EXPECT_EQ(asked(1, v1::LASER_MODE_CW, power, 0), ErrorCode::kCellInvalidArgument) << power;
  EXPECT_EQ(asked(1, v1::LASER_MODE_CW, 50.0, 201), ErrorCode::kCellInvalidArgument);
}

// A process is known by its kind and its number together.
TEST_F(ProjectLimits, OfProcesses) {
  const auto asked = [&](std::initializer_list<std::pair<int, int>> processes) {
    return Asked([&](v1::Project& project) {
      for (const auto& [kind, number] : processes) {
        v1::ProjectProcess& process = *project.add_processes();
        process.set_kind(kind);
        process.set_process(number);
        if (kind == 2) process.add_values(1.0);
      }
    });
  };
  EXPECT_EQ(asked({{0, 1}, {0, 2}, {2, 1}}), std::nullopt);
  EXPECT_EQ(asked({{0, 1}, {0, 1}}), ErrorCode::kProjectDuplicate);
}

// Asked only: what would be kept, under its name; times and etag are the server's.
TEST_F(ProjectLimits, WhatIsKeptOfAProject) {
  v1::CreateProjectRequest request;
  request.set_project_id("lid");
  request.mutable_project()->set_name("projects/another");
  request.mutable_project()->set_etag("77");
  request.mutable_project()->set_title("Lid");
  request.set_validate_only(true);
  EXPECT_EQ(book.Create(request, "anna").value->name(), "projects/lid");
  request.set_validate_only(false);
  const auto created = book.Create(request, "anna");
  ASSERT_TRUE(created);
  EXPECT_EQ(created.value->name(), "projects/lid");
  EXPECT_EQ(created.value->etag(), "1");
  EXPECT_EQ(created.value->title(), "Lid");
  EXPECT_EQ(created.value->create_time().seconds(), created.value->update_time().seconds());
  bed.clock().Advance(std::chrono::seconds(7));
  v1::UpdateProjectRequest update;
  update.mutable_project()->set_name("projects/lid");
  update.mutable_project()->set_notes("turn it over");
  const auto updated = book.Update(update, "anna");
  ASSERT_TRUE(updated);
  EXPECT_EQ(updated.value->etag(), "2");
  EXPECT_EQ(updated.value->title(), "Lid");  // not given: as it was
  EXPECT_EQ(updated.value->notes(), "turn it over");
  EXPECT_EQ(updated.value->update_time().seconds() - updated.value->create_time().seconds(), 7);
  const storage::ProjectRecord record = Must(bed.store().GetProject("lid"));
  v1::Project body;
  ASSERT_TRUE(body.ParseFromString(record.body));
  EXPECT_EQ(body.title(), "");  // kept once
  EXPECT_EQ(body.etag(), "");
  EXPECT_EQ(body.name(), "");
  EXPECT_FALSE(body.has_create_time());
  EXPECT_FALSE(body.has_update_time());
}

// Every call that names a project says so when the name is none, and does nothing.
TEST_F(ProjectLimits, NamesThatAreNone) {
  for (const std::string name :
       {"", "lid", "projects/", "projects/Lid", "machines/lid", "projects/lid/programs/1"}) {
    EXPECT_EQ(CodeOf(book.Get(name)), ErrorCode::kCellInvalidArgument) << name;
    v1::UpdateProjectRequest update;
    update.mutable_project()->set_name(name);
    const auto updated = book.Update(update, "anna");
    ASSERT_FALSE(updated) << name;
    EXPECT_EQ(updated.error.error.code, ErrorCode::kCellInvalidArgument) << name;
    v1::DeleteProjectRequest remove;
    remove.set_name(name);
    const Status removed = book.Delete(remove, "anna");
    ASSERT_FALSE(removed) << name;
    EXPECT_EQ(removed.error().code, ErrorCode::kCellInvalidArgument) << name;
    v1::TransferProjectRequest transfer;
    transfer.set_name(name);
    transfer.set_machine("machines/optimo-1");
    const auto transferred = transfers.ToMachine(transfer, "anna");
    ASSERT_FALSE(transferred) << name;
    EXPECT_EQ(transferred.error.error.code, ErrorCode::kCellInvalidArgument) << name;
  }
}

// What is no etag of ours names no revision: nothing is changed, nothing deleted.
TEST_F(ProjectLimits, EtagsThatAreNone) {
  Must(bed.store().PutProject({.id = "lid", .title = "Lid"}, 0));
  for (const std::string etag : {"x", "0", "-1", "01", "1 ", "2"}) {
    v1::UpdateProjectRequest update;
    update.mutable_project()->set_name("projects/lid");
    update.mutable_project()->set_title("new");
    update.mutable_project()->set_etag(etag);
    const auto updated = book.Update(update, "anna");
    ASSERT_FALSE(updated) << etag;
    EXPECT_EQ(updated.error.error.code, ErrorCode::kCellEtagMismatch) << etag;
    v1::DeleteProjectRequest remove;
    remove.set_name("projects/lid");
    remove.set_etag(etag);
    const Status removed = book.Delete(remove, "anna");
    ASSERT_FALSE(removed) << etag;
    EXPECT_EQ(removed.error().code, ErrorCode::kCellEtagMismatch) << etag;
  }
  EXPECT_EQ(Must(book.Get("projects/lid")).title(), "Lid");
  v1::DeleteProjectRequest remove;
  remove.set_name("projects/lid");
  remove.set_etag("1");
  EXPECT_TRUE(book.Delete(remove, "anna"));
}

// One damaged body is told of by whatever reads it, and no half of a page is given.
TEST_F(ProjectLimits, ADamagedBodyIsToldOf) {
  Must(bed.store().PutProject({.id = "good", .title = "t"}, 0));
  Must(bed.store().PutProject({.id = "wrong", .title = "t", .body = "\xFF\xFF"}, 0));
  EXPECT_EQ(CodeOf(book.List({})), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(Page(1).projects_size(), 1);
  v1::UpdateProjectRequest update;
  update.mutable_project()->set_name("projects/wrong");
  update.mutable_project()->set_title("new");
  const auto updated = book.Update(update, "anna");
  ASSERT_FALSE(updated);
  EXPECT_EQ(updated.error.error.code, ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(Must(bed.store().GetProject("wrong")).title, "t");
}

// ProjectProgram.milling: as that of a job, but said when it is stored.
TEST_F(ProjectLimits, OfMillings) {
  const auto asked = [&](double diameter_mm) {
    return Asked([&](v1::Project& project) {
      v1::ProjectProgram& program = *project.add_programs();
      program.set_slot(7);
      program.mutable_source()->set_content("PA;");
      v1::Milling& milling = *program.mutable_milling();
      milling.mutable_stock()->set_size_x_mm(60.0);
      milling.mutable_stock()->set_size_y_mm(30.0);
      milling.mutable_stock()->set_size_z_mm(5.0);
      milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
      milling.mutable_tool()->set_diameter_mm(diameter_mm);
    });
  };
  EXPECT_EQ(asked(3.0), std::nullopt);
  EXPECT_EQ(asked(0.0), ErrorCode::kCellInvalidArgument);
}

// Likewise its target. Lists leave out what is large.
TEST_F(ProjectLimits, OfTargets) {
  v1::CreateProjectRequest request;
  request.set_project_id("coaster");
  v1::ProjectProgram& program = *request.mutable_project()->add_programs();
  program.set_slot(7);
  program.mutable_source()->set_content("PA;");
  v1::Milling& milling = *program.mutable_milling();
  milling.mutable_stock()->set_size_x_mm(60.0);
  milling.mutable_stock()->set_size_y_mm(30.0);
  milling.mutable_stock()->set_size_z_mm(5.0);
  milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
  milling.mutable_tool()->set_diameter_mm(3.0);
  v1::MillTarget& target = *milling.mutable_target();
  const auto missing = book.Create(request, "anna");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error.error.code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(missing.error.error.detail,
            "program 7: milling.target is missing: file, inline_program or slot");
  target.mutable_file()->set_content("PA;");
  EXPECT_EQ(book.Create(request, "anna").error.error.code, ErrorCode::kCellBadText);
  target.mutable_file()->set_content("solid\nendsolid\n");
  ASSERT_TRUE(book.Create(request, "anna"));
  const auto kept = Must(book.Get("projects/coaster"));
  EXPECT_EQ(kept.programs(0).milling().target().file().content(), "solid\nendsolid\n");
  const v1::MillTarget listed = Page(1).projects(0).programs(0).milling().target();
  EXPECT_TRUE(listed.has_file());
  EXPECT_EQ(listed.file().content(), "");
}

}  // namespace
}  // namespace rmlcell::server
