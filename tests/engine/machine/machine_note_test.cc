#include "engine/machine/machine_note.h"

#include <gtest/gtest.h>

#include <utility>

namespace rmlcell::machine {
namespace {

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

}  // namespace
}  // namespace rmlcell::machine
