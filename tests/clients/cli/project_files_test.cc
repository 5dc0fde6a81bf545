// What a project is made of: a JSON file, a folder, or both.
#include "clients/cli/project_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ReadProjectTest : public testing::Test {
 protected:
  // Each program as "slot name content".
  static std::vector<std::string> Programs(const v1::Project& project) {
    std::vector<std::string> all;
    for (const v1::ProjectProgram& program : project.programs()) {
      all.push_back(std::to_string(program.slot()) + " " + program.source().file_name() + " " +
                    program.source().content());
    }
    return all;
  }
  static v1::Project Read(const std::string& path) {
    const auto project = ReadProject(path);
    if (!project) {
      ADD_FAILURE() << CodeText(project.error().code) << ": " << project.error().detail;
      return {};
    }
    return *project;
  }
  static void ExpectRefused(const std::string& path, ErrorCode code, const std::string& detail) {
    const auto project = ReadProject(path);
    ASSERT_FALSE(project) << path;
    EXPECT_EQ(project.error().code, code) << project.error().detail;
    EXPECT_THAT(project.error().detail, HasSubstr(detail));
  }

  CliFolder folder;
};

constexpr const char* kTwoPrograms = R"({
  "title": "Bracket", "notes": "clamp left",
  "laserSchedules": [{"number": 3, "mode": "LASER_MODE_PULSE", "powerPercent": 40}],
  "programs": [{"slot": 12, "title": "outside", "source": {"fileName": "parts/outside.S"}},
               {"slot": 44, "source": {"fileName": "inside.SI"}, "units": "UNITS_INCH"}]})";

TEST_F(ReadProjectTest, FilesOfTheJsonLieBesideIt) {
  folder.Put("p/parts/outside.S", "COORD ABSOL\n");
  folder.Put("p/inside.SI", "STOP\n");
  folder.Put("p/1.S", "not named");
  const v1::Project project = Read(folder.Put("p/any.json", kTwoPrograms));
  EXPECT_EQ(project.title(), "Bracket");
  EXPECT_EQ(project.notes(), "clamp left");
  ASSERT_EQ(project.laser_schedules_size(), 1);
  EXPECT_EQ(project.laser_schedules(0).number(), 3);
  // The name alone: folders of this computer say nothing to a server.
  EXPECT_THAT(Programs(project), ElementsAre("12 outside.S COORD ABSOL\n", "44 inside.SI STOP\n"));
  EXPECT_EQ(project.programs(0).title(), "outside");
  EXPECT_EQ(project.programs(1).units(), v1::UNITS_INCH);
}

TEST_F(ReadProjectTest, ContentThatIsGivenIsKept) {
  folder.Put("12.S", "of the file");
  const v1::Project project = Read(folder.Put("a.json", R"({"programs": [
      {"slot": 12, "source": {"fileName": "12.S", "content": "Z2l2ZW4="}},
      {"slot": 13, "source": {"fileName": "far/none.S", "content": "Z2l2ZW4="}},
      {"slot": 14}]})"));
  EXPECT_THAT(Programs(project), ElementsAre("12 12.S given", "13 far/none.S given", "14  "));
}

TEST_F(ReadProjectTest, AFileWithoutProgramsHasNone) {
  folder.Put("12.S", "beside it");
  const v1::Project project = Read(folder.Put("a.json", R"({"title": "T"})"));
  EXPECT_EQ(project.title(), "T");
  EXPECT_EQ(project.programs_size(), 0);
}

TEST_F(ReadProjectTest, AFolderWithAProjectFileIsWhatThatSays) {
  folder.Put("parts/outside.S", "one");
  folder.Put("inside.SI", "two");
  folder.Put("1.S", "not named");
  folder.Put("project.json", kTwoPrograms);
  const v1::Project project = Read(folder.path());
  EXPECT_EQ(project.title(), "Bracket");
  EXPECT_THAT(Programs(project), ElementsAre("12 outside.S one", "44 inside.SI two"));
}

TEST_F(ReadProjectTest, AProjectFileWithoutProgramsLeavesThemToTheFolder) {
  folder.Put("44.SI", "inch");
  folder.Put("12.S", "metric");
  folder.Put("notes.txt", "no program");
  folder.Put("project.json", R"({"title": "Bracket"})");
  const v1::Project project = Read(folder.path());
  EXPECT_EQ(project.title(), "Bracket");
  EXPECT_THAT(Programs(project), ElementsAre("12 12.S metric", "44 44.SI inch"));
}

TEST_F(ReadProjectTest, AFolderWithoutProjectFileIsItsNumberedPrograms) {
  folder.Put("12.S", "twelve");
  folder.Put("2.S", "two");
  folder.Put("3.rml", "of another machine");
  folder.Put("other.json", R"({"title": "no"})");
  const v1::Project project = Read(folder.path());
  EXPECT_EQ(project.title(), "");
  EXPECT_THAT(Programs(project), ElementsAre("12 12.S twelve", "2 2.S two"));
}

TEST_F(ReadProjectTest, WhatIsNoProjectIsRefused) {
  ExpectRefused(folder.File("none.json"), ErrorCode::kCellFileUnreadable, "none.json");
  ExpectRefused(folder.path(), ErrorCode::kCellUsage, "no program");  // an empty folder
  for (const char* text :
       {"", "{", "[]", R"({"colour": "red"})", R"({"programs": [{"slot": "x"}]})"}) {
    const std::string path = folder.Put("bad.json", text);
    ExpectRefused(path, ErrorCode::kCellBadText, path + ": ");
  }
  const std::string path =
      folder.Put("a.json", R"({"programs": [{"slot": 1, "source": {"fileName": "gone.S"}}]})");
  ExpectRefused(path, ErrorCode::kCellFileUnreadable, "gone.S");
  const std::string empty = folder.Put("p/1.S", "");
  ExpectRefused(folder.File("p"), ErrorCode::kCellEmptyProgram, empty);
  // A project file that is there counts, even when it cannot be read.
  folder.Put("q/1.S", "x");
  folder.Put("q/project.json", "{");
  ExpectRefused(folder.File("q"), ErrorCode::kCellBadText, "project.json");
}

// A target of a program is a file beside the JSON file, too.
TEST_F(ReadProjectTest, TargetsLieBesideItLikewise) {
  folder.Put("p/a.rml", "PA;");
  folder.Put("p/parts/old.rml", "PD;");
  folder.Put("p/a.stl", "solid");
  const v1::Project project = Read(folder.Put("p/any.json", R"({"programs": [
    {"slot": 1, "source": {"fileName": "a.rml"},
     "milling": {"target": {"inlineProgram": {"fileName": "parts/old.rml"}}}},
    {"slot": 2, "source": {"fileName": "a.rml"}, "milling": {"target": {"file": {"fileName": "a.stl"}}}},
    {"slot": 3, "source": {"fileName": "a.rml"}, "milling": {"target": {"slot": 4}}}]})"));
  ASSERT_EQ(project.programs_size(), 3);
  EXPECT_EQ(project.programs(0).milling().target().inline_program().content(), "PD;");
  EXPECT_EQ(project.programs(0).milling().target().inline_program().file_name(), "old.rml");
  EXPECT_EQ(project.programs(1).milling().target().file().content(), "solid");
  EXPECT_EQ(project.programs(2).milling().target().slot(), 4);
  ExpectRefused(folder.Put("q/any.json", R"({"programs": [{"slot": 1, "milling":
    {"target": {"file": {"fileName": "none.stl"}}}}]})"),
                ErrorCode::kCellFileUnreadable, "none.stl");
}

// How a program is milled gets no target by being read.
TEST_F(ReadProjectTest, AProgramWithoutATargetStaysSo) {
  folder.Put("p/a.rml", "PA;");
  const v1::Project project = Read(folder.Put("p/any.json", R"({"programs": [
    {"slot": 1, "source": {"fileName": "a.rml"}},
    {"slot": 2, "source": {"fileName": "a.rml"}, "milling": {"stlToleranceMm": 0.5}}]})"));
  ASSERT_EQ(project.programs_size(), 2);
  EXPECT_FALSE(project.programs(0).has_milling());
  EXPECT_TRUE(project.programs(1).has_milling());
  EXPECT_FALSE(project.programs(1).milling().has_target());
}

}  // namespace
}  // namespace rmlcell::cli
