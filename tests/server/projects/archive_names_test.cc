// Which names of a project become files of its archive, and which project.json
// it is read from.
#include <archive.h>
#include <archive_entry.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <locale.h>

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/projects/project_archive.h"
#include "tests/server/projects/packed_together.h"

namespace rmlcell::server {
namespace {

using testing::Contains;
using testing::Not;

// As a tool reads it in which names are in UTF-8.
std::vector<std::string> FilesIn(const std::string& bytes) {
  const std::unique_ptr<std::remove_pointer_t<locale_t>, void (*)(locale_t)> utf8(
      ::newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr), ::freelocale);
  const locale_t before = ::uselocale(utf8.get());
  const std::unique_ptr<archive, int (*)(archive*)> read(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(read.get());
  archive_read_open_memory(read.get(), bytes.data(), bytes.size());
  std::vector<std::string> names;
  archive_entry* entry = nullptr;
  while (archive_read_next_header(read.get(), &entry) == ARCHIVE_OK)
    names.emplace_back(archive_entry_pathname(entry));
  ::uselocale(before);
  return names;
}

// What no folder can have stays in project.json, and comes back from there.
TEST(ArchiveNames, AreThoseOfFiles) {
  const auto is_file = [](const std::string& name) {
    v1::Project project;
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(7);
    program.mutable_source()->set_file_name(name);
    program.mutable_source()->set_content("STOP\n");
    const auto written = WriteProjectArchive(project);
    EXPECT_TRUE(written);
    const auto read = ReadProjectArchive(*written);
    EXPECT_TRUE(read && read->programs(0).source().content() == "STOP\n" &&
                read->programs(0).source().file_name() == name)
        << name;
    const std::vector<std::string> files = FilesIn(*written);
    EXPECT_THAT(files, Contains("project.json"));
    return std::ranges::find(files, "programs/7/" + name) != files.end();
  };
  EXPECT_TRUE(is_file("part one.S"));
  EXPECT_TRUE(is_file("!.S"));
  EXPECT_FALSE(is_file("part\x1F.S"));
  EXPECT_TRUE(is_file(std::string(255, 'n')));
  EXPECT_FALSE(is_file(std::string(256, 'n')));
  EXPECT_TRUE(is_file("Fr\xC3\xA4se.S"));
  EXPECT_FALSE(is_file(".."));
  EXPECT_FALSE(is_file("a:b"));
}

// Whoever unpacks them can read them; when that was packed does not show, so that the same project
// is the same bytes.
TEST(ArchiveNames, AreOfFilesThatAllCanRead) {
  v1::Project project;
  project.add_programs()->set_slot(7);
  project.mutable_programs(0)->mutable_source()->set_file_name("part.S");
  project.mutable_programs(0)->mutable_source()->set_content("STOP\n");
  const auto written = WriteProjectArchive(project);
  ASSERT_TRUE(written);
  const std::unique_ptr<archive, int (*)(archive*)> read(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(read.get());
  archive_read_open_memory(read.get(), written->data(), written->size());
  archive_entry* entry = nullptr;
  int files = 0;
  for (; archive_read_next_header(read.get(), &entry) == ARCHIVE_OK; ++files) {
    EXPECT_EQ(archive_entry_perm(entry), 0644U) << archive_entry_pathname(entry);
    EXPECT_EQ(archive_entry_mtime(entry), 946'684'800) << "2000-01-01";
  }
  EXPECT_EQ(files, 2);
}

// The one that lies least deep; of two the first by name.
TEST(ArchiveNames, TheFirstProjectIsRead) {
  const std::string a = R"({"title": "a"})";
  const std::string b = R"({"title": "b"})";
  const auto title = [](const std::vector<std::pair<std::string, std::string>>& files) {
    const auto read = ReadProjectArchive(PackedTogether(files));
    return read ? read->title() : read.error().detail;
  };
  EXPECT_EQ(title({{"x/project.json", a}, {"y/project.json", b}}), "a");
  EXPECT_EQ(title({{"y/project.json", b}, {"x/project.json", a}}), "a");
  EXPECT_EQ(title({{"x/deep/project.json", a}, {"y/project.json", b}}), "b");
  EXPECT_EQ(title({{"x/project.json", a}, {"project.json", b}}), "b");
}

// 1,000 files, and 64 MiB as they come.
TEST(ArchiveNames, AreOfSoManyFiles) {
  const auto why_not = [](int more) {
    std::vector<std::pair<std::string, std::string>> files{{"project.json", "{}"}};
    for (int file = 0; file < more; ++file) files.emplace_back("f" + std::to_string(file), "x");
    const auto read = ReadProjectArchive(PackedTogether(files));
    return read ? "" : read.error().detail;
  };
  EXPECT_EQ(why_not(999), "");
  EXPECT_EQ(why_not(1'000), "the archive has more than 1,000 files");
  const auto code = [](std::size_t bytes) {
    return ReadProjectArchive(std::string(bytes, 'x')).error().code;
  };
  EXPECT_EQ(code(kProjectBytesMax), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code(kProjectBytesMax + 1), ErrorCode::kCellTooLarge);
}

}  // namespace
}  // namespace rmlcell::server
