// Rules that jobs, programs and projects ask alike: slots, families of files, update masks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "engine/families/families.h"
#include "rmlcell/v1/project.pb.h"
#include "server/records/file_family.h"
#include "server/records/program_place.h"
#include "server/records/update_mask.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const machine::MachineFamily& Optimo() { return *families::FindFamily("optimo"); }
const machine::MachineFamily& Mill() { return *families::FindFamily("rml1"); }

// OPT-1.10: slots 1 to 99. The code is the machine's own where it has one.
TEST(ProgramPlace, SlotsAreOneToNinetyNine) {
  for (const int slot : {1, 2, 98, 99}) {
    EXPECT_TRUE(CheckSlot(Optimo(), slot, "slot"));
    EXPECT_TRUE(CheckSlot(Mill(), slot, "slot"));
  }
  for (const std::int64_t slot :
       {std::int64_t{0}, std::int64_t{-1}, std::int64_t{100}, INT64_MAX}) {
    const Status laser = CheckSlot(Optimo(), slot, "job.inline_slot");
    ASSERT_FALSE(laser) << slot;
    EXPECT_EQ(laser.error().code, ErrorCode::kProgramNumber);
    EXPECT_EQ(laser.error().detail,
              "job.inline_slot is " + std::to_string(slot) + "; slots are 1 to 99");
    const Status mill = CheckSlot(Mill(), slot, "slot");
    ASSERT_FALSE(mill) << slot;
    EXPECT_EQ(mill.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_THAT(mill.error().detail, HasSubstr("no executables"));
  }
}

// OPT-3.44: laser schedules 1 to 63; a mill has none.
TEST(ProgramPlace, SchedulesAreThoseOfTheFamily) {
  for (const int number : {1, 63}) EXPECT_TRUE(CheckSchedule(Optimo(), number));
  for (const std::int64_t number : {std::int64_t{0}, std::int64_t{64}, INT64_MAX}) {
    const Status refused = CheckSchedule(Optimo(), number);
    ASSERT_FALSE(refused) << number;
    EXPECT_EQ(refused.error().code, ErrorCode::kScheduleRange);
    EXPECT_EQ(refused.error().detail, "laser schedule is " + std::to_string(number));
  }
  EXPECT_EQ(CodeOf(CheckSchedule(Mill(), 1)), ErrorCode::kCellPrecondition);
}

// Who puts a program at 100 hears what the numbers behind it are.
TEST(ProgramPlace, ANumberThatIsNoneSaysWhatThereIs) {
  for (const int number : {0, 100, 200}) {
    const Status laser = CheckNumber(Optimo(), {.number = number});
    ASSERT_FALSE(laser) << number;
    EXPECT_EQ(laser.error().code, ErrorCode::kProgramNumber);
    EXPECT_EQ(laser.error().detail,
              "program number is " + std::to_string(number) +
                  "; programs have 1 to 99, and their executables 101 to 199");
    const Status mill = CheckNumber(Mill(), {.number = number});
    ASSERT_FALSE(mill) << number;
    EXPECT_THAT(mill.error().detail, HasSubstr("slots are 1 to 99, and there are no executables"));
  }
}

// OPT-1.11: the executable of slot n has the number n + 100; a mill has none.
TEST(ProgramPlace, NumbersAreThoseOfTheFamily) {
  const auto checked = [](const machine::MachineFamily& family, int number) {
    return CodeOf(CheckNumber(
        family, Must(ParseProgramName("machines/m/programs/" + std::to_string(number)))));
  };
  for (const int number : {1, 99}) {
    EXPECT_EQ(checked(Optimo(), number), std::nullopt);
    EXPECT_EQ(checked(Mill(), number), std::nullopt);
  }
  for (const int number : {101, 199}) {
    EXPECT_EQ(checked(Optimo(), number), std::nullopt);
    EXPECT_EQ(checked(Mill(), number), ErrorCode::kCellInvalidArgument);
  }
  for (const int number : {0, 100, 200}) {
    EXPECT_EQ(checked(Optimo(), number), ErrorCode::kProgramNumber);
    EXPECT_EQ(checked(Mill(), number), ErrorCode::kCellInvalidArgument);
  }
}

TEST(ProgramPlace, IsFoundByItsName) {
  ServerBed bed;
  const ProgramPlace object = Must(FindProgramPlace(bed.store(), "machines/optimo-1/programs/45"));
  EXPECT_EQ(object.machine.id, "optimo-1");
  EXPECT_EQ(object.family, &Optimo());
  EXPECT_EQ(object.slot, 45);
  EXPECT_FALSE(object.executable);
  const ProgramPlace executable =
      Must(FindProgramPlace(bed.store(), "machines/optimo-1/programs/145"));
  EXPECT_EQ(executable.slot, 45);
  EXPECT_TRUE(executable.executable);
  const auto code = [&](std::string_view name) {
    return CodeOf(FindProgramPlace(bed.store(), name));
  };
  EXPECT_EQ(code("machines/optimo-1"), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code("machines/none/programs/1"), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(code("machines/optimo-1/programs/100"), ErrorCode::kProgramNumber);
  EXPECT_EQ(code("machines/mill-1/programs/101"), ErrorCode::kCellInvalidArgument);
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  EXPECT_EQ(code("machines/odd/programs/1"), ErrorCode::kCellUnknownFamily);
  // OPT-1.10: a laser says it with its own code, a mill with that of the cell.
  EXPECT_EQ(EmptySlot(Optimo(), "machines/m/programs/4").code, ErrorCode::kProgramMissing);
  EXPECT_EQ(EmptySlot(Mill(), "machines/m/programs/4").code, ErrorCode::kCellNotFound);
  EXPECT_THAT(EmptySlot(Mill(), "machines/m/programs/4").detail,
              HasSubstr("machines/m/programs/4"));
}

// A name tells the family where it can: nothing of the one is stored for the other.
TEST(FileFamily, IsToldByTheEndOfTheName) {
  for (const std::string name : {"a.S", "a.s", "a.SI", "a.CMP", "a.O"}) {
    EXPECT_TRUE(CheckFileFamily(name, Optimo())) << name;
    EXPECT_EQ(CodeOf(CheckFileFamily(name, Mill())), ErrorCode::kCellInvalidArgument) << name;
  }
  for (const std::string name : {"a.rml", "a.RML", "a.prn"}) {
    EXPECT_TRUE(CheckFileFamily(name, Mill())) << name;
    EXPECT_EQ(CodeOf(CheckFileFamily(name, Optimo())), ErrorCode::kCellInvalidArgument) << name;
  }
  for (const std::string name : {"", "a", "a.txt"}) {
    EXPECT_TRUE(CheckFileFamily(name, Optimo())) << name;
    EXPECT_TRUE(CheckFileFamily(name, Mill())) << name;
  }
  const Status refused = CheckFileFamily("part.rml", Optimo());
  EXPECT_EQ(
      refused.error().detail,
      "part.rml is a program for Roland mill or engraver, RML-1, not for Amada OPTIMO 5-axis laser");
}

// AIP-134: the fields that the mask names; all of them for "*"; without a mask those that are
// given.
TEST(UpdateMask, SaysWhichFieldsChange) {
  constexpr std::array<std::string_view, 3> kFields = {"title", "notes", "programs"};
  const auto fields = [&](const std::vector<std::string>& paths, const v1::Project& wanted) {
    google::protobuf::FieldMask mask;
    for (const std::string& path : paths) mask.add_paths(path);
    return FieldsToUpdate(mask, wanted, kFields);
  };
  v1::Project project;
  EXPECT_THAT(Must(fields({}, project)), IsEmpty());
  EXPECT_THAT(Must(fields({"title"}, project)), ElementsAre("title"));
  EXPECT_THAT(Must(fields({"title", "programs", "title"}, project)),
              ElementsAre("programs", "title"));
  EXPECT_THAT(Must(fields({"*"}, project)), ElementsAre("notes", "programs", "title"));
  project.set_title("t");
  EXPECT_THAT(Must(fields({}, project)), ElementsAre("title"));
  EXPECT_THAT(Must(fields({"notes"}, project)), ElementsAre("notes"));
  project.add_programs();
  EXPECT_THAT(Must(fields({}, project)), ElementsAre("programs", "title"));
  for (const std::string path : {"name", "Title", "title ", "", "programs.slot"}) {
    EXPECT_EQ(CodeOf(fields({"title", path}, project)), ErrorCode::kCellInvalidArgument) << path;
  }
  EXPECT_EQ(fields({"nam\x01"}, project).error().detail,
            "update_mask: 'nam?' is none of title, notes, programs, *");
}

}  // namespace
}  // namespace rmlcell::server
