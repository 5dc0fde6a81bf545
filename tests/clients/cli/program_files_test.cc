// Which programs a local run gets from files, folders and slots: docs/files.md, "The memory of a
// local run".
#include "clients/cli/program_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST(ProgramFiles, ANumberAsNameIsTheSlot) {
  EXPECT_EQ(SlotFromName("progs/44.S"), 44);
  EXPECT_EQ(SlotFromName("007.S"), 7);
  EXPECT_EQ(SlotFromName("1"), 1);
  EXPECT_EQ(SlotFromName("99.rml"), 99);
  for (const char* name : {"0.S", "100.S", "-1.S", "part.S", "12a.S", "12.5.S", ".S", "",
                           "4294967297.S", "99999999999999999999.S", "12/part.S"}) {
    EXPECT_EQ(SlotFromName(name), std::nullopt) << name;
  }
}

TEST(ProgramFiles, SlotAndFileAreTwoSidesOfTheFirstEqualsSign) {
  using Named = SlotFile;
  EXPECT_EQ(*ParseSlotFile("44=FILE"), (Named{44, "FILE"}));
  EXPECT_EQ(*ParseSlotFile("44"), (Named{44, ""}));
  EXPECT_EQ(*ParseSlotFile("44="), (Named{44, ""}));
  EXPECT_EQ(*ParseSlotFile("1=a=b"), (Named{1, "a=b"}));
  EXPECT_EQ(*ParseSlotFile("99=x"), (Named{99, "x"}));
}

TEST(ProgramFiles, ASlotIsANumberOf1To99) {
  for (const char* text : {"", "=FILE", "x=FILE", "4 4=FILE"}) {
    const auto parsed = ParseSlotFile(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, ErrorCode::kCellUsage) << text;
    EXPECT_THAT(parsed.error().detail, HasSubstr("write 44=FILE"));
  }
  for (const char* text : {"0=FILE", "100", "-1=FILE", "4294967340=FILE"}) {
    const auto parsed = ParseSlotFile(text);
    ASSERT_TRUE(parsed) << text;
    EXPECT_EQ(parsed->Slot(**FamilyFor("optimo", {})).error().code, ErrorCode::kProgramNumber)
        << text;
    // A machine without program memory has no number of its own for it.
    EXPECT_EQ(parsed->Slot(**FamilyFor("rml1", {})).error().code, ErrorCode::kCellInvalidArgument)
        << text;
  }
  const SlotFile beyond{100, "FILE"};
  EXPECT_EQ(beyond.Slot(**FamilyFor("optimo", {})).error().detail, "program number is 100");
  EXPECT_EQ(*SlotFile({99, "FILE"}).Slot(**FamilyFor("optimo", {})), 99);
}

TEST(ProgramFiles, TheFamilyFollowsFromItsIdOrElseFromTheName) {
  EXPECT_EQ((*FamilyFor({}, "jobs/a.S"))->info().id, "optimo");
  EXPECT_EQ((*FamilyFor({}, "a.prn"))->info().id, "rml1");
  EXPECT_EQ((*FamilyFor("rml1", "a.S"))->info().id, "rml1");  // over what the name says
  EXPECT_EQ((*FamilyFor("optimo", {}))->info().id, "optimo");
  const auto unknown = FamilyFor("lathe", "a.S");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(unknown.error().detail, "'lathe'; there are optimo rml1");
  for (const char* name : {"notes.txt", "part", ""}) {
    const auto untold = FamilyFor({}, name);
    ASSERT_FALSE(untold) << name;
    EXPECT_EQ(untold.error().code, ErrorCode::kCellFamilyUnknownFromName) << name;
  }
}

class LoadFilesTest : public testing::Test {
 protected:
  struct Request {
    std::vector<std::string> files{};
    std::vector<std::string> slots{};
    int main_slot = 0;
    std::string family{};
    EmptyInFolders empty = EmptyInFolders::kRefused;
  };
  static Result<LoadedFiles> Load(const Request& request) {
    return LoadFiles(request.files, request.slots, request.main_slot, request.family,
                     request.empty);
  }
  // Slots with what lies in them.
  static std::map<int, std::string> Memory(const Result<LoadedFiles>& loaded) {
    std::map<int, std::string> memory;
    if (!loaded) {
      ADD_FAILURE() << CodeText(loaded.error().code) << ": " << loaded.error().detail;
      return memory;
    }
    for (const simulation::MemoryProgram& program : loaded->programs) {
      EXPECT_TRUE(memory.emplace(program.slot, *program.bytes).second) << program.slot;
      EXPECT_TRUE(program.is_source);
    }
    return memory;
  }
  static int MainOf(const Result<LoadedFiles>& loaded) { return loaded ? loaded->main_slot : -1; }
  static std::string FamilyOf(const Result<LoadedFiles>& loaded) {
    return loaded ? std::string(loaded->family->info().id) : "none";
  }
  static void ExpectRefused(const Request& request, ErrorCode code, const std::string& detail) {
    const Result<LoadedFiles> loaded = Load(request);
    ASSERT_FALSE(loaded) << detail;
    EXPECT_EQ(loaded.error().code, code) << loaded.error().detail;
    EXPECT_THAT(loaded.error().detail, HasSubstr(detail));
  }

  CliFolder folder;
};

TEST_F(LoadFilesTest, AFileAloneIsTheMainProgram) {
  const auto loaded = Load({.files = {folder.Put("part.S", "one")}});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "one")));
  EXPECT_EQ(MainOf(loaded), 1);
  EXPECT_EQ(FamilyOf(loaded), "optimo");
  EXPECT_EQ(loaded->programs.front().name, "part");
  EXPECT_EQ(loaded->programs.front().file_name, folder.File("part.S"));
}

TEST_F(LoadFilesTest, ANumberedFileGoesIntoItsSlotAndOthersIntoTheFirstFreeOnes) {
  const auto loaded = Load({.files = {folder.Put("b.S", "first"), folder.Put("c.S", "second"),
                                      folder.Put("1.S", "one"), folder.Put("3.S", "three")}});
  EXPECT_THAT(Memory(loaded),
              ElementsAre(Pair(1, "one"), Pair(2, "first"), Pair(3, "three"), Pair(4, "second")));
  EXPECT_EQ(MainOf(loaded), 2);  // the first file is started
}

TEST_F(LoadFilesTest, TheFirstFileTakesTheSlotOfMainUnlessItHasANumber) {
  const std::string part = folder.Put("part.S", "part");
  const std::string other = folder.Put("other.S", "other");
  auto loaded = Load({.files = {part, other}, .main_slot = 12});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "other"), Pair(12, "part")));
  EXPECT_EQ(MainOf(loaded), 12);
  loaded = Load({.files = {part, other}, .main_slot = 1});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "part"), Pair(2, "other")));
  EXPECT_EQ(MainOf(loaded), 1);
  loaded =
      Load({.files = {folder.Put("7.S", "seven"), folder.Put("8.S", "eight")}, .main_slot = 8});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(7, "seven"), Pair(8, "eight")));
  EXPECT_EQ(MainOf(loaded), 8);
  ExpectRefused({.files = {part}, .main_slot = 100}, ErrorCode::kProgramNumber, "100");
}

TEST_F(LoadFilesTest, AFolderBringsItsNumberedProgramsAndNothingElse) {
  folder.Put("p/12.S", "twelve");
  folder.Put("p/44.SI", "forty-four");
  folder.Put("p/part.S", "not numbered");
  folder.Put("p/100.S", "no slot");
  folder.Put("p/45.txt", "of no family");
  folder.Put("p/46.S/1.S", "in a folder below");
  const auto loaded = Load({.files = {folder.File("p")}, .main_slot = 12});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(12, "twelve"), Pair(44, "forty-four")));
  EXPECT_EQ(MainOf(loaded), 12);
  EXPECT_EQ(loaded->programs.front().name, "12");
}

TEST_F(LoadFilesTest, OfSeveralProgramsOneMustBeNamed) {
  folder.Put("p/12.S", "twelve");
  EXPECT_EQ(MainOf(Load({.files = {folder.File("p")}})), 12);  // the only one
  folder.Put("p/44.S", "forty-four");
  ExpectRefused({.files = {folder.File("p")}}, ErrorCode::kCellUsage, "--main 12");
  const std::string part = folder.Put("44.S", "other");
  // The first file, even behind a folder.
  const std::string main = folder.Put("50.S", "fifty");
  EXPECT_EQ(MainOf(Load({.files = {folder.File("p"), main}})), 50);
  ExpectRefused({.slots = {"1=" + main, "2=" + part}}, ErrorCode::kCellUsage, "several programs");
}

TEST_F(LoadFilesTest, AFolderOfTwoFamiliesGivesThoseOfTheFirstFile) {
  folder.Put("p/1.S", "laser");
  folder.Put("p/2.rml", "mill");
  folder.Put("p/3.prn", "mill, too");
  const std::string programs = folder.File("p");
  auto loaded = Load({.files = {folder.Put("50.rml", "main"), programs}});
  EXPECT_EQ(FamilyOf(loaded), "rml1");
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(2, "mill"), Pair(3, "mill, too"), Pair(50, "main")));
  // Of the first file, though it comes behind the folder.
  loaded = Load({.files = {programs, folder.Put("51.rml", "main")}});
  EXPECT_EQ(FamilyOf(loaded), "rml1");
  EXPECT_EQ(Memory(loaded).count(1), 0U);
  // Without a file, of the first program found.
  loaded = Load({.files = {programs}});
  EXPECT_EQ(FamilyOf(loaded), "optimo");
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "laser")));
  EXPECT_EQ(MainOf(loaded), 1);
  // What is asked for goes over both.
  loaded = Load({.files = {programs}, .main_slot = 2, .family = "rml1"});
  EXPECT_EQ(FamilyOf(loaded), "rml1");
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(2, "mill"), Pair(3, "mill, too")));
}

TEST_F(LoadFilesTest, TheMainProgramMayLieInTheFolderToo) {
  const std::string main = folder.Put("p/12.S", "twelve");
  folder.Put("p/44.S", "forty-four");
  const auto loaded = Load({.files = {main, folder.File("p")}});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(12, "twelve"), Pair(44, "forty-four")));
  EXPECT_EQ(MainOf(loaded), 12);
}

TEST_F(LoadFilesTest, SlotsBringProgramsOfAnyName) {
  const std::string odd = folder.Put("odd name.txt", "odd");
  auto loaded = Load({.files = {folder.Put("1.S", "one")}, .slots = {"44=" + odd}});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "one"), Pair(44, "odd")));
  EXPECT_EQ(MainOf(loaded), 1);
  loaded = Load({.slots = {"44=" + folder.File("1.S")}});  // alone: it is started
  EXPECT_EQ(MainOf(loaded), 44);
  loaded = Load({.slots = {"44=" + odd}, .family = "rml1"});
  EXPECT_EQ(FamilyOf(loaded), "rml1");
  ExpectRefused({.slots = {"44=" + odd}}, ErrorCode::kCellFamilyUnknownFromName, "odd name.txt");
  ExpectRefused({.slots = {"44"}}, ErrorCode::kCellUsage, "'44': write 44=FILE");
  ExpectRefused({.slots = {"100=" + odd}}, ErrorCode::kProgramNumber, "100");
  // A name without number goes round the slots that are taken.
  loaded = Load({.files = {folder.Put("part.S", "part")}, .slots = {"1=" + odd}});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "odd"), Pair(2, "part")));
  EXPECT_EQ(MainOf(loaded), 2);
}

TEST_F(LoadFilesTest, ASlotIsFilledOnce) {
  const std::string one = folder.Put("1.S", "one");
  const std::string part = folder.Put("part.S", "part");
  ExpectRefused({.files = {one}, .slots = {"1=" + part}}, ErrorCode::kCellUsage,
                "program 1 comes from two files: " + one + " and " + part);
  const std::string again = folder.Put("p/1.S", "another");
  ExpectRefused({.files = {one, folder.File("p")}}, ErrorCode::kCellUsage,
                "program 1 comes from two files: " + one + " and " + again);
  folder.Put("q/01.S", "x");
  folder.Put("q/1.S", "y");
  ExpectRefused({.files = {folder.File("q")}}, ErrorCode::kCellUsage, "program 1 comes from two");
  // The slot that --main gives to the first file, too.
  ExpectRefused({.files = {part}, .slots = {"12=" + one}, .main_slot = 12}, ErrorCode::kCellUsage,
                "program 12 comes from two files: " + part + " and " + one);
  ExpectRefused({.files = {part, folder.File("p")}, .main_slot = 1}, ErrorCode::kCellUsage,
                "program 1 comes from two files: " + part + " and " + again);
}

TEST_F(LoadFilesTest, EmptyFilesAreTakenOnlyInFolders) {
  const std::string empty = folder.Put("p/2.S", "");
  folder.Put("p/1.S", "one");
  const std::string programs = folder.File("p");
  ExpectRefused({.files = {programs}, .main_slot = 1}, ErrorCode::kCellEmptyProgram, empty);
  const auto loaded = Load({.files = {programs}, .main_slot = 1, .empty = EmptyInFolders::kTaken});
  EXPECT_THAT(Memory(loaded), ElementsAre(Pair(1, "one"), Pair(2, "")));
  // One that is named is needed.
  for (const EmptyInFolders rule : {EmptyInFolders::kRefused, EmptyInFolders::kTaken}) {
    ExpectRefused({.files = {empty}, .empty = rule}, ErrorCode::kCellEmptyProgram, empty);
    ExpectRefused({.slots = {"2=" + empty}, .empty = rule}, ErrorCode::kCellEmptyProgram, empty);
    ExpectRefused({.files = {empty, programs}, .empty = rule}, ErrorCode::kCellEmptyProgram, empty);
  }
}

TEST_F(LoadFilesTest, WhatCannotBeLoadedIsRefused) {
  ExpectRefused({}, ErrorCode::kCellUsage, "no program");
  std::filesystem::create_directory(folder.File("empty"));
  ExpectRefused({.files = {folder.File("empty")}}, ErrorCode::kCellUsage, "no program");
  ExpectRefused({.files = {folder.File("none.S")}}, ErrorCode::kCellFileUnreadable, "none.S");
  const std::string notes = folder.Put("notes.txt", "x");
  ExpectRefused({.files = {notes}}, ErrorCode::kCellFamilyUnknownFromName, "give --family");
  ExpectRefused({.files = {notes}, .family = "lathe"}, ErrorCode::kCellUnknownFamily, "lathe");
}

// A folder is none of the files that a family could be told from: that is wrong use.
TEST(ProgramFiles, AFolderHasNoFamily) {
  const CliFolder folder;
  const auto none = FamilyFor({}, folder.path());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellUsage);
  EXPECT_EQ(none.error().detail, "'" + folder.path() + "' is a directory: give its files");
}

}  // namespace
}  // namespace rmlcell::cli
