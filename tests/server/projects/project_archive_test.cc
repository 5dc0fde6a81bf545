#include "server/projects/project_archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "tests/fuzz/seeds.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

v1::ProjectProgram& AddProgram(v1::Project& project, int slot, const std::string& name,
                               const std::string& bytes) {
  v1::ProjectProgram& program = *project.add_programs();
  program.set_slot(slot);
  program.mutable_source()->set_file_name(name);
  program.mutable_source()->set_content(bytes);
  return program;
}

// As any tool for archives packs it.
std::string Packed(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string bytes(1 << 20, '\0');
  std::size_t used = 0;
  archive* made = archive_write_new();
  archive_write_set_format_zip(made);
  archive_write_open_memory(made, bytes.data(), bytes.size(), &used);
  for (const auto& [name, content] : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry, name.ends_with('/') ? AE_IFDIR : AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(made, entry);
    archive_write_data(made, content.data(), content.size());
    archive_entry_free(entry);
  }
  archive_write_free(made);
  bytes.resize(used);
  return bytes;
}

std::map<std::string, std::string> Unpacked(const std::string& bytes) {
  std::map<std::string, std::string> files;
  archive* read = archive_read_new();
  archive_read_support_format_zip(read);
  archive_read_open_memory(read, bytes.data(), bytes.size());
  archive_entry* entry = nullptr;
  while (archive_read_next_header(read, &entry) == ARCHIVE_OK) {
    std::string content(1 << 16, '\0');
    const auto size = archive_read_data(read, content.data(), content.size());
    content.resize(static_cast<std::size_t>(size));
    files[archive_entry_pathname(entry)] = content;
  }
  archive_read_free(read);
  return files;
}

v1::Project Some() {
  v1::Project project;
  project.set_title("Door");
  project.set_notes("clamp left");
  AddProgram(project, 12, "door.S", "STOP\n").set_title("door");
  v1::ProjectProgram& mill = AddProgram(project, 44, "door.S", std::string("\0\xff;", 3));
  mill.mutable_milling()->set_cell_mm(0.5);
  mill.mutable_milling()->mutable_target()->mutable_file()->set_file_name("door.stl");
  mill.mutable_milling()->mutable_target()->mutable_file()->set_content("solid");
  v1::ProjectLaserSchedule& schedule = *project.add_laser_schedules();
  schedule.set_number(11);
  schedule.set_mode(v1::LASER_MODE_PULSE);
  schedule.set_power_percent(40.0);
  v1::ProjectProcess& process = *project.add_processes();
  process.set_kind(2);
  process.add_values(11.0);
  return project;
}

// OPT-8.68: a project is what is kept, and what comes back is what was put there.
TEST(ProjectArchive, GivesBackWhatWasPutIn) {
  const v1::Project project = Some();
  const auto archive = WriteProjectArchive(project);
  ASSERT_TRUE(archive);
  const auto back = ReadProjectArchive(*archive);
  ASSERT_TRUE(back) << back.error().detail;
  EXPECT_EQ(back->DebugString(), project.DebugString());
}

// What a person finds who opens it.
TEST(ProjectArchive, HasAFileForEachTextOfTheProject) {
  auto files = Unpacked(*WriteProjectArchive(Some()));
  const std::string json = std::exchange(files["project.json"], {});
  EXPECT_THAT(json, HasSubstr("\"fileName\": \"programs/12/door.S\""));
  EXPECT_THAT(json, HasSubstr("\"mode\": \"LASER_MODE_PULSE\""));
  EXPECT_THAT(json, Not(HasSubstr("content")));
  EXPECT_THAT(files, ElementsAre(Pair("programs/12/door.S", "STOP\n"),
                                 Pair("programs/44/door.S", std::string("\0\xff;", 3)),
                                 Pair("project.json", ""), Pair("targets/44/door.stl", "solid")));
}

TEST(ProjectArchive, LeavesOutWhatIsOfTheCell) {
  v1::Project project = Some();
  project.set_name("projects/door");
  project.set_etag("7");
  project.mutable_create_time()->set_seconds(1);
  project.mutable_update_time()->set_seconds(2);
  EXPECT_EQ(*WriteProjectArchive(project), *WriteProjectArchive(Some()));
}

// A name that is none of a file must not write beside the folder when somebody unpacks it.
TEST(ProjectArchive, KeepsBytesWithoutAFileNameInTheJson) {
  for (const std::string name : {"", "..", "../../etc/passwd", "a\\b", "C:x", "a\nb"}) {
    v1::Project project;
    AddProgram(project, 1, name, "STOP\n");
    const auto archive = WriteProjectArchive(project);
    ASSERT_TRUE(archive) << name;
    EXPECT_EQ(Unpacked(*archive).size(), 1U) << name;
    EXPECT_EQ(ReadProjectArchive(*archive)->DebugString(), project.DebugString()) << name;
  }
}

// A folder as the command reads it, packed by hand, with its own name or without.
TEST(ProjectArchive, ReadsAFolderThatAPersonPacked) {
  const std::string json = R"({"title":"t","programs":[{"slot":7,"source":{"fileName":"7.S"}}]})";
  for (const std::string folder : {"", "door/", "a/door/"}) {
    const auto project = ReadProjectArchive(Packed({{folder + "README", "x"},
                                                    {folder + "7.S", "STOP\n"},
                                                    {folder + "sub/project.json", "{}"},
                                                    {folder + "project.json", json}}));
    ASSERT_TRUE(project) << folder << project.error().detail;
    EXPECT_EQ(project->title(), "t");
    EXPECT_EQ(project->programs(0).source().content(), "STOP\n");
    EXPECT_EQ(project->programs(0).source().file_name(), "7.S");
  }
}

// Where a field stands in the header of each file, and in its entry of the directory.
std::vector<std::size_t> FieldsAt(const std::string& bytes, std::size_t in_header,
                                  std::size_t in_entry) {
  std::vector<std::size_t> found;
  for (const auto& [begin, behind] :
       {std::pair<std::string, std::size_t>("PK\3\4", in_header), {"PK\1\2", in_entry}}) {
    for (std::size_t at = bytes.find(begin); at != std::string::npos;
         at = bytes.find(begin, at + 1))
      found.push_back(at + behind);
  }
  return found;
}
std::vector<std::size_t> FlagsOfNames(const std::string& bytes) { return FieldsAt(bytes, 7, 9); }

// Any tool for archives unpacks it: what is deflated needs version 2.0 of ZIP, and nothing is so
// large that it needs a newer one.
TEST(ProjectArchive, NeedsNoNewTool) {
  const std::string bytes = *WriteProjectArchive(Some());
  const std::vector<std::size_t> versions = FieldsAt(bytes, 4, 6);
  EXPECT_THAT(versions, testing::SizeIs(8));
  for (const std::size_t at : versions) EXPECT_LE(int{bytes[at]}, 20) << at;
}

// Names with letters of other alphabets, marked as UTF-8 as every newer tool for archives does it.
TEST(ProjectArchive, ReadsNamesOfAllAlphabets) {
  std::string bytes =
      Packed({{"project.json", R"({"programs":[{"slot":7,"source":{"fileName":"Tür.S"}}]})"},
              {"Tür.S", "STOP\n"},
              {"T\xFCr.txt", "of an older tool, whatever its mark says"}});
  for (const std::size_t at : FlagsOfNames(bytes)) bytes[at] = '\x08';
  const auto project = ReadProjectArchive(bytes);
  ASSERT_TRUE(project) << project.error().detail;
  EXPECT_EQ(project->programs(0).source().content(), "STOP\n");
  EXPECT_EQ(project->programs(0).source().file_name(), "Tür.S");
  const std::string written = *WriteProjectArchive(*project);
  EXPECT_THAT(FlagsOfNames(written), testing::SizeIs(4));
  EXPECT_EQ(std::ranges::count_if(FlagsOfNames(written),
                                  [&](std::size_t at) { return written[at] == '\x08'; }),
            2);
}

TEST(ProjectArchive, SaysWhatIsWrong) {
  const auto said = [](const std::string& bytes) {
    const auto project = ReadProjectArchive(bytes);
    return project ? Detail() : project.error().detail;
  };
  EXPECT_THAT(said(""), HasSubstr("cannot be read"));
  EXPECT_THAT(said("no archive at all"), HasSubstr("cannot be read"));
  EXPECT_THAT(said(Packed({{"a", "b"}})), HasSubstr("no project.json"));
  EXPECT_THAT(said(Packed({{"project.json", "{"}})), HasSubstr("project.json of the archive: "));
  EXPECT_THAT(said(Packed({{"project.json", R"({"colour":1})"}})), HasSubstr("colour"));
  EXPECT_THAT(said(Packed({{"project.json",
                            R"({"programs":[{"slot":1,"source":{"fileName":"gone.S"}}]})"}})),
              HasSubstr("no file gone.S"));
  // A folder is none.
  EXPECT_THAT(
      said(Packed({{"project.json", R"({"programs":[{"slot":1,"source":{"fileName":"7.S/"}}]})"},
                   {"7.S/", ""}})),
      HasSubstr("no file 7.S/"));
}

// That it is damaged is said where nothing more is known of it.
TEST(ProjectArchive, SaysWhyItCannotBeRead) {
  const auto read = ReadProjectArchive("no archive at all");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().detail, testing::StartsWith("the archive cannot be read: "));
  EXPECT_THAT(read.error().detail, Not(HasSubstr("it is damaged")));
}

// A byte that fell over is found by the sum of its file.
TEST(ProjectArchive, RefusesADamagedFile) {
  v1::Project project;
  std::string text;
  for (int line = 0; line < 500; ++line) text += "DELAY " + std::to_string(line * 7919) + "\n";
  AddProgram(project, 1, "1.S", text);
  const std::string whole = *WriteProjectArchive(project);
  int refused = 0;
  for (std::size_t at = whole.find("programs/1/1.S") + 60; at < whole.size() - 400; at += 40) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const auto read = ReadProjectArchive(damaged);
    EXPECT_TRUE(!read || read->programs(0).source().content() == text) << at;
    EXPECT_TRUE(read || read.error().code == ErrorCode::kCellInvalidArgument) << at;
    refused += read ? 0 : 1;
  }
  EXPECT_GT(refused, 0);
  EXPECT_FALSE(ReadProjectArchive(whole.substr(0, whole.size() / 2)));
}

// Some kilobytes that unpack to more than there is room for, and one file that is named many times.
TEST(ProjectArchive, IsBounded) {
  v1::Project project;
  std::string programs;
  for (int slot = 1; slot <= 99; ++slot) {
    programs += (slot > 1 ? "," : "") + std::string(R"({"slot":)") + std::to_string(slot) +
                R"(,"source":{"fileName":"a"}})";
  }
  const std::string json = R"({"programs":[)" + programs + "]}";
  const auto many = ReadProjectArchive(
      Packed({{"project.json", json}, {"a", std::string(kProjectBytesMax / 98, 'x')}}));
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().code, ErrorCode::kCellTooLarge);
  const auto bomb = ReadProjectArchive(
      Packed({{"project.json", json}, {"a", std::string(kProjectBytesMax, 'x')}}));
  ASSERT_FALSE(bomb);
  EXPECT_EQ(bomb.error().code, ErrorCode::kCellTooLarge);
  AddProgram(project, 1, "1.S", std::string(kProjectBytesMax, 'x'));
  EXPECT_EQ(WriteProjectArchive(project).error().code, ErrorCode::kCellTooLarge);
}

// What comes from outside is read or refused, whatever it is.
TEST(ProjectArchive, DamageIsReadOrRefused) {
  std::mt19937 random(8);  // NOLINT: the same every time
  const std::string whole = *WriteProjectArchive(Some());
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    const auto project = ReadProjectArchive(fuzz::Damaged(whole, 1 + round % 4, 0, random));
    if (project) {
      EXPECT_LE(project->ByteSizeLong(), 1000U);
    } else {
      EXPECT_NE(project.error().detail, "");
      ++refused;
    }
  }
  EXPECT_GT(refused, 2000);
}

// A target that is a program is a file beside the others as well.
TEST(ProjectArchive, HasTheProgramOfATarget) {
  v1::Project project;
  v1::ProjectProgram& program = AddProgram(project, 44, "door.rml", "PU;");
  v1::ProgramText& target = *program.mutable_milling()->mutable_target()->mutable_inline_program();
  target.set_file_name("old.rml");
  target.set_content("PD;");
  const auto archive = WriteProjectArchive(project);
  ASSERT_TRUE(archive);
  EXPECT_EQ(Unpacked(*archive)["targets/44/old.rml"], "PD;");
  const auto back = ReadProjectArchive(*archive);
  ASSERT_TRUE(back) << back.error().detail;
  EXPECT_EQ(back->DebugString(), project.DebugString());
}

}  // namespace
}  // namespace rmlcell::server
