#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/handbox.h"
#include "engine/machine/machine.h"
#include "engine/optimo/language/compiler.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::optimo {

using machine::At;
using machine::KeyAction;
using machine::MachineState;
using machine::Mode;
using testing::ElementsAre;
using testing::IsEmpty;

// A machine, and somebody at its handbox. What keys change is stored at once.
class HandboxTest : public machine::MachineTest {
 protected:
  // Programs of these slots; the machine is zeroed and in this mode.
  void Have(const std::vector<std::pair<int, std::string>>& programs, Mode mode = Mode::kManual) {
    Load({});
    for (const auto& [slot, text] : programs)
      Good(machine::StoreProgram{.slot = slot, .program = Translated(text)});
    Good(machine::ChangeMode{mode});
  }

  // "JOB 4 5 ENT": each a TAP.
  void Keys(const std::string& names) {
    std::istringstream all(names);
    for (std::string name; all >> name;) Do(name, KeyAction::kTap);
  }
  void Do(const std::string& key, KeyAction action) {
    const Result<machine::KeyAnswer> answer = machine->PressKey(key, action);
    ASSERT_TRUE(answer) << key << ": " << answer.error().detail;
    message = answer->message;
    beeps += answer->beeps;
    if (!answer->edit) return;
    edits.push_back(*answer->edit);
    if (stores) Store(*answer->edit);
  }
  void Store(const machine::ProgramEdit& edit) {
    if (edit.object.empty()) return Good(machine::DeleteProgram{.slot = edit.program});
    Good(machine::StoreProgram{
        .slot = edit.program,
        .program = {.name = "taught", .object = machine::Bytes::Of(edit.object)}});
  }
  // While the key is down for so long.
  void Hold(const std::string& key, double seconds) {
    Do(key, KeyAction::kPress);
    GoOn(machine->time() + At(seconds));
    Do(key, KeyAction::kRelease);
    GoOn(machine->time() + At(2.0));
  }

  // The display without blanks at its end; one that flashes has a '*' before it.
  std::string Shows() const {
    const machine::Panel panel = machine->panel();
    EXPECT_EQ(panel.display.size(), 20U);  // OPT-4.01
    const std::size_t end = panel.display.find_last_not_of(' ') + 1;
    return (panel.flashing ? "*" : "") + panel.display.substr(0, end);
  }
  // The number of what the control said to the last key; 0: nothing.
  int Said() const { return message ? Lookup(*message).number : 0; }
  std::vector<std::string_view> Lamps() const { return machine->panel().lamps; }

  std::string ObjectAt(int slot) const {
    const auto found = machine->memory().programs.find(slot);
    return found == machine->memory().programs.end() ? "" : std::string(*found->second.object);
  }
  // The steps of a program as they are printed.
  std::vector<std::string> Program(int slot) const {
    std::vector<std::string> lines;
    if (ObjectAt(slot).empty()) return {"none"};
    std::istringstream source(ObjectToSource(ObjectAt(slot)).value());
    for (std::string line; std::getline(source, line);) {
      if (!line.empty()) lines.push_back(line.starts_with(' ') ? line.substr(5) : line);
    }
    return lines;
  }

  std::optional<ErrorCode> message;
  int beeps = 0;
  bool stores = true;
  std::vector<machine::ProgramEdit> edits;
};

}  // namespace rmlcell::optimo
