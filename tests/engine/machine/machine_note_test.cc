#include "engine/machine/machine_note.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace rmlcell::machine {
namespace {

Result<MachineNote> ReadLines(const std::string& lines) {
  return ReadMachineNote("rmlcell machine 1\n" + lines + "\nfamily\n");
}

TEST(MachineNoteTest, ReadsWhatItWritesAndNothingElse) {
  const MachineNote note{
      .time = SimTime(12'345),
      .on = false,
      .emergency = true,
      .cover_open = true,
      .mode = Mode::kSingle,
      .override_percent = 72.5,
      .simulation = ProgramStep{3, 4},
      .breakpoints = {{.at = {5, 6}, .condition = "VI[1] > 2", .from_pass = 9}, {.at = {5, 7}}},
      .alarms = {{.id = 4,
                  .code = ErrorCode::kEmergencyStop,
                  .detail = "by a person",
                  .at = SimTime(77),
                  .place = {.program = 1, .step = 2, .line = 3, .byte_offset = 4}},
                 {.id = 5, .code = ErrorCode::kCellPowerOff}},
      .last_alarm = 5,
      .last_run = 8,
      .shown = {.program = 12, .step = 7, .instruction = "MOVE"},
      .message = ErrorCode::kLabelNotFound,
      .handbox = "1 2 0 3 1 12.7 70 100",
      .family = std::string("\0family\nx", 9)};
  const std::string text = WriteMachineNote(note);
  const Result<MachineNote> read = ReadMachineNote(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, note);
  const std::size_t lines = text.size() - note.family.size();
  for (std::size_t cut = 0; cut < lines; ++cut)
    EXPECT_FALSE(ReadMachineNote(text.substr(0, cut))) << cut;
  for (const auto& [from, to] :
       {std::pair{"machine 1", "machine 2"}, std::pair{"time 12345", "time -1"},
        std::pair{"time 12345", "time x"}, std::pair{"on 0", "on 2"},
        std::pair{"cover_open 1", "cover_open 2"}, std::pair{"mode SINGLE", "mode FAST"},
        std::pair{"override 72.5", "override 0"}, std::pair{"override 72.5", "override 1e9"},
        std::pair{"simulation 3 4", "simulation 3"},
        std::pair{"simulation 3 4", "simulation 3 4 5"}, std::pair{"simulation 3 4", "x 1"},
        std::pair{"breakpoint 5 6", "breakpoint 500 6"}, std::pair{"EmergencyStop", "Nothing"},
        std::pair{"last_run 8", "last_run -8"}, std::pair{"shown 12 7", "shown 100 7"},
        std::pair{"shown 12 7", "shown 12 -7"}, std::pair{"OPT-E60", "OPT-E61"},
        std::pair{"message OPT-E60", "message 60"}}) {
    std::string changed = text;
    changed.replace(changed.find(from), std::string_view(from).size(), to);
    EXPECT_FALSE(ReadMachineNote(changed)) << to;
  }
}

// Every number at both ends of what it may be, and one beyond each: '#' stands for it.
TEST(MachineNoteTest, NumbersHaveRanges) {
  const std::string most = "9223372036854775807", beyond = "9223372036854775808";
  const std::string step = "2147483647", no_step = "2147483648";
  const std::string passes = "1000000000000", too_many = "1000000000001";
  struct Number {
    std::string line;
    std::string low;
    std::string high;
    std::string below;
    std::string above;
  };
  const std::vector<Number> numbers = {
      {"time #", "0", most, "-1", beyond},
      {"on #", "0", "1", "-1", "2"},
      {"emergency #", "0", "1", "-1", "2"},
      {"cover_open #", "0", "1", "-1", "2"},
      {"override #", "0.001", "1000", "0", "1000.001"},
      {"simulation # 4", "0", "99", "-1", "100"},
      {"simulation 4 #", "0", step, "-1", no_step},
      {"breakpoint # 2 1 ", "0", "99", "-1", "100"},
      {"breakpoint 2 # 1 ", "0", step, "-1", no_step},
      {"breakpoint 2 3 # ", "1", passes, "0", too_many},
      {"alarm # EmergencyStop 0 0 0 0 0 ", "1", most, "0", beyond},
      {"alarm 1 EmergencyStop # 0 0 0 0 ", "0", most, "-1", beyond},
      {"alarm 1 EmergencyStop 0 # 0 0 0 ", "0", "99", "-1", "100"},
      {"alarm 1 EmergencyStop 0 0 # 0 0 ", "0", step, "-1", no_step},
      {"alarm 1 EmergencyStop 0 0 0 # 0 ", "0", step, "-1", no_step},
      {"alarm 1 EmergencyStop 0 0 0 0 # ", "-1", most, "-2", beyond},
      {"last_alarm #", "0", most, "-1", beyond},
      {"last_run #", "0", most, "-1", beyond},
      {"shown # 2 MOVE", "0", "99", "-1", "100"},
      {"shown 2 # MOVE", "0", step, "-1", no_step},
      {"gates # 2", "0", "99", "-1", "100"},
      {"gates 2 #", "0", "99", "-1", "100"}};
  for (const Number& number : numbers) {
    const auto reads = [&](const std::string& value) {
      std::string line = number.line;
      return bool(ReadLines(line.replace(line.find('#'), 1, value)));
    };
    EXPECT_TRUE(reads(number.low)) << number.line;
    EXPECT_TRUE(reads(number.high)) << number.line;
    EXPECT_FALSE(reads(number.below)) << number.line;
    EXPECT_FALSE(reads(number.above)) << number.line;
  }
}

// As many alarms, and as many breakpoints, as are read; with one more it is no note.
TEST(MachineNoteTest, HasRoomForTenThousandOfEach) {
  for (const std::string line : {"\nalarm 1 EmergencyStop 0 0 0 0 0 ", "\nbreakpoint 2 3 1 "}) {
    std::string lines = "on 1";
    for (int n = 0; n < 10'000; ++n) lines += line;
    const Result<MachineNote> read = ReadLines(lines);
    ASSERT_TRUE(read) << line;
    EXPECT_EQ(read->alarms.size() + read->breakpoints.size(), 10'000U);
    EXPECT_FALSE(ReadLines(lines + line)) << line;
  }
}

// What people wrote stays in its line: what is no character becomes a space, and nothing else.
TEST(MachineNoteTest, TextStaysInItsLine) {
  MachineNote note;
  note.alarms = {{.id = 1, .code = ErrorCode::kEmergencyStop, .detail = "a\nb\x1f\x7f \u00e4!"}};
  note.breakpoints = {{.at = {1, 2}, .condition = "VI[1]\t>\r2"}};
  note.handbox = "1\n2";
  const Result<MachineNote> read = ReadMachineNote(WriteMachineNote(note));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->alarms.at(0).detail, "a b \x7f \u00e4!");
  EXPECT_EQ(read->breakpoints.at(0).condition, "VI[1] > 2");
  EXPECT_EQ(read->handbox, "1 2");
}

// Nothing is a note without its head, and nothing with two heads.
TEST(MachineNoteTest, HasOneHead) {
  EXPECT_FALSE(ReadMachineNote("family\n"));
  EXPECT_FALSE(ReadMachineNote("on 1\nfamily\n"));
  EXPECT_FALSE(ReadLines("rmlcell machine 1"));
  const Result<MachineNote> least = ReadMachineNote("rmlcell machine 1\nfamily\n");
  ASSERT_TRUE(least);
  EXPECT_EQ(*least, MachineNote{});
}

// Whoever keeps it is told that it is none.
TEST(MachineNoteTest, WhatIsNoneIsSaidToBeNone) {
  for (const char* text : {"", "family\n", "rmlcell machine 1\nfast 1\nfamily\n"}) {
    const Result<MachineNote> none = ReadMachineNote(text);
    ASSERT_FALSE(none) << text;
    EXPECT_EQ(none.error().code, ErrorCode::kCellBadText);
    EXPECT_EQ(none.error().detail, "this is no state of a machine of this version");
  }
}

}  // namespace
}  // namespace rmlcell::machine
