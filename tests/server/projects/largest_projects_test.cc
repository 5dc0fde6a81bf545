// The largest project that goes into an archive, and what is told of an object that is replaced.
#include <gtest/gtest.h>

#include <string>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// 64 MiB, all that it is made of among them.
TEST(LargestProjects, HaveSixtyFourMebibytes) {
  v1::Project project;
  v1::ProjectProgram& program = *project.add_programs();
  program.set_slot(7);
  program.mutable_source()->set_file_name("7.S");
  std::string& content = *program.mutable_source()->mutable_content();
  content.assign(kProjectBytesMax - 100, ';');
  // Lengths are numbers of a size of their own.
  while (project.ByteSizeLong() < kProjectBytesMax)
    content.append(kProjectBytesMax - project.ByteSizeLong(), ';');
  ASSERT_EQ(project.ByteSizeLong(), kProjectBytesMax);
  EXPECT_TRUE(WriteProjectArchive(project));
  content += ';';
  const auto larger = WriteProjectArchive(project);
  ASSERT_FALSE(larger);
  EXPECT_EQ(larger.error().code, ErrorCode::kCellTooLarge);
}

// WEB-3.07: of an object that was stored alone it is told that it has no text and no executable.
TEST(LargestProjects, WhatIsReplacedIsToldAsItIs) {
  ServerBed bed;
  Config config;
  ProjectBook projects{bed.store()};
  ProgramBook programs{bed.store(), config};
  ProjectTransfer transfer{bed.store(), projects, programs};
  Must(bed.store().PutPrograms(
      "optimo-1",
      {{.slot = 12, .name = "old", .object = ObjectOf("SPEED 5\n")},
       {.slot = 13, .object = ObjectOf("SPEED 5\n"), .source = "SPEED 5", .source_name = "b.S"}},
      {}));
  Must(bed.store().PutExecutable("optimo-1", 13, 1, "executable", "anna"));
  v1::CreateProjectRequest request;
  request.set_project_id("door");
  for (const int slot : {12, 13}) {
    v1::ProjectProgram& program = *request.mutable_project()->add_programs();
    program.set_slot(slot);
    program.set_title("new");
    program.mutable_source()->set_file_name("a.S");
    program.mutable_source()->set_content("STOP\n");
  }
  ASSERT_TRUE(projects.Create(request, "anna"));
  v1::TransferProjectRequest asked;
  asked.set_name("projects/door");
  asked.set_machine("machines/optimo-1");
  asked.set_validate_only(true);
  const auto preview = transfer.ToMachine(asked, "anna");
  ASSERT_TRUE(preview);
  ASSERT_EQ(preview.value->items_size(), 2);
  const v1::Program& object = preview.value->items(0).program_before();
  EXPECT_EQ(object.title(), "old");
  EXPECT_FALSE(object.has_source_bytes());
  EXPECT_FALSE(object.has_executable_bytes());
  EXPECT_EQ(object.object_bytes(), static_cast<std::int64_t>(ObjectOf("SPEED 5\n").size()));
  EXPECT_EQ(object.etag(), "1");
  const v1::Program& text = preview.value->items(1).program_before();
  EXPECT_EQ(text.file_name(), "b.S");
  EXPECT_EQ(text.source_bytes(), 7);
  EXPECT_EQ(text.executable_bytes(), 10);
  const v1::Program& after = preview.value->items(0).program_after();
  EXPECT_EQ(after.title(), "new");
  EXPECT_EQ(after.file_name(), "a.S");
  EXPECT_EQ(after.object_bytes(), static_cast<std::int64_t>(ObjectOf("STOP\n").size()));
}

}  // namespace
}  // namespace rmlcell::server
