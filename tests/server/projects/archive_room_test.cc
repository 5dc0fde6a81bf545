// The room that a project has when it is read from an archive, used to its last byte.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/projects/project_archive.h"
#include "tests/server/projects/packed_together.h"

namespace rmlcell::server {
namespace {

// Each of these programs is the file "a".
std::string NamingTheSameFile(int programs) {
  std::string json = R"({"programs":[)";
  for (int slot = 1; slot <= programs; ++slot) {
    json += (slot > 1 ? "," : "") + std::string(R"({"slot":)") + std::to_string(slot) +
            R"(,"source":{"fileName":"a"}})";
  }
  return json + "]}";
}

// All its files together, project.json among them, have 64 MiB.
TEST(ArchiveRoom, IsThatOfAllItsFiles) {
  const std::string json = NamingTheSameFile(1);
  const std::size_t left = kProjectBytesMax - json.size();
  const auto full =
      ReadProjectArchive(PackedTogether({{"project.json", json}, {"a", std::string(left, 'x')}}));
  ASSERT_TRUE(full) << full.error().detail;
  EXPECT_EQ(full->programs(0).source().content().size(), left);
  const auto more = ReadProjectArchive(
      PackedTogether({{"project.json", json}, {"a", std::string(left + 1, 'x')}}));
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kCellTooLarge);
}

// A file that is named twice counts twice.
TEST(ArchiveRoom, IsThatOfAllThatIsNamed) {
  constexpr std::size_t kHalf = kProjectBytesMax / 2;
  const std::string json = NamingTheSameFile(2);
  const auto full =
      ReadProjectArchive(PackedTogether({{"project.json", json}, {"a", std::string(kHalf, 'x')}}));
  ASSERT_TRUE(full) << full.error().detail;
  EXPECT_EQ(full->programs(1).source().content().size(), kHalf);
  const auto more = ReadProjectArchive(
      PackedTogether({{"project.json", json}, {"a", std::string(kHalf + 1, 'x')}}));
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kCellTooLarge);
}

// Of the same project the same bytes: the files of an archive are of 2000-01-01, and readable.
TEST(ArchiveRoom, FilesAreOfOneTime) {
  v1::Project project;
  v1::ProjectProgram& program = *project.add_programs();
  program.set_slot(7);
  program.mutable_source()->set_file_name("7.S");
  program.mutable_source()->set_content("STOP\n");
  const auto written = WriteProjectArchive(project);
  ASSERT_TRUE(written);
  const std::unique_ptr<archive, int (*)(archive*)> read(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(read.get());
  archive_read_open_memory(read.get(), written->data(), written->size());
  int files = 0;
  archive_entry* entry = nullptr;
  while (archive_read_next_header(read.get(), &entry) == ARCHIVE_OK) {
    ++files;
    EXPECT_EQ(archive_entry_mtime(entry), 946'684'800);
    EXPECT_EQ(archive_entry_perm(entry), 0644U);
  }
  EXPECT_EQ(files, 2);
}

}  // namespace
}  // namespace rmlcell::server
