// Modes, override, SHIFT and the keys without function.
#include <algorithm>
#include <array>
#include <cstdint>

#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

class ModeKeys : public HandboxTest {};

// OPT-4.22 OPT-4.23: five modes in a row, one lamp, no way round the ends.
TEST_F(ModeKeys, GoAlongTheSwitch) {
  Have({});
  for (const std::string_view mode : {"REPEAT", "CYCLE", "SINGLE", "REMOTE", "REMOTE"}) {
    Keys("MODE_RIGHT");
    EXPECT_THAT(Lamps(), ElementsAre(mode, "ROB"));
  }
  for (const std::string_view mode : {"SINGLE", "CYCLE", "REPEAT", "MANUAL", "MANUAL"}) {
    Keys("MODE_LEFT");
    EXPECT_THAT(Lamps(), ElementsAre(mode, "ROB"));
  }
  EXPECT_EQ(Said(), 0);
}

// OPT-4.34 OPT-4.40
TEST_F(ModeKeys, OverrideHasTenSteps) {
  Have({});
  const auto percent = [this] { return machine->status().override_percent; };
  EXPECT_EQ(percent(), 100.0);
  Keys("OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS");
  EXPECT_EQ(percent(), 40.0);
  Keys("OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS OVERRIDE_MINUS");
  EXPECT_EQ(percent(), 10.0);
  for (const double next : {25.0, 40.0, 55.0, 70.0, 85.0, 100.0, 115.0, 130.0, 145.0, 145.0}) {
    Keys("OVERRIDE_PLUS");
    EXPECT_EQ(percent(), next);
  }
}

// OPT-4.40: one that somebody else has set goes to the next step, up or down.
TEST_F(ModeKeys, OverrideGoesToTheNextStep) {
  Have({});
  Good(machine::ChangeOverride{.percent = 60.0});
  Keys("OVERRIDE_PLUS");
  EXPECT_EQ(machine->status().override_percent, 70.0);
  Good(machine::ChangeOverride{.percent = 60.0});
  Keys("OVERRIDE_MINUS");
  EXPECT_EQ(machine->status().override_percent, 55.0);
}

// OPT-4.11 LIVE-2.11: in REMOTE they are dead, but for these.
TEST_F(ModeKeys, InRemoteFewKeysAct) {
  Have({{1, "DELAY 1\n"}}, Mode::kRemote);
  Keys("OVERRIDE_MINUS");
  EXPECT_EQ(machine->status().override_percent, 85.0);
  for (const char* key :
       {"START", "STOP", "HOLD", "SHIFT", "STEP", "HOME", "ZERO", "NOTE", "JOG_ABS", "X+",
        "DEL",   "MOD",  "REC",  "PREV",  "NEXT", "ENT",  "JOB",  "TCP",  "DYN",     "PATH",
        "WORK",  "DLY",  "MOV",  "OUT",   "DEB",  "CAL",  "PAR",  "DISP", "F1",      "F2",
        "F3",    "F4",   "F5",   "F6",    "F7",   "F8",   "0",    "9",    "POINT",   "MINUS"}) {
    Keys(key);
    EXPECT_EQ(Said(), 7601) << key;
    EXPECT_EQ(state(), MachineState::kIdle) << key;
    EXPECT_THAT(Lamps(), ElementsAre("REMOTE", "ROB")) << key;
  }
  EXPECT_EQ(Shows(), "ERROR 7601");
  Keys("ERR");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Shows(), "P=00S=0000I=********");
  Keys("EMERGENCY_STOP");
  EXPECT_EQ(state(), MachineState::kAlarm);
  Keys("MODE_LEFT");
  EXPECT_THAT(Lamps(), ElementsAre("SINGLE", "ROB"));
}

// OPT-4.09: twice is off again; a key without shifted meaning leaves it.
TEST_F(ModeKeys, ShiftHasALamp) {
  Have({{2, "DELAY 1\n"}, {45, "DELAY 1\n"}});
  Keys("SHIFT");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB", "SHIFT"));
  Keys("SHIFT");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
  Keys("SHIFT MOV ERR");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB", "SHIFT"));
  Keys("NEXT");
  EXPECT_EQ(Shows(), "P=02S=0000I=********");
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
}

// OPT-4.10
TEST_F(ModeKeys, TheNoteKeyMakesKeysBeep) {
  Have({});
  Keys("JOB ERR");
  EXPECT_EQ(beeps, 0);
  Keys("NOTE JOB ERR");
  EXPECT_EQ(beeps, 2);
  Do("JOB", KeyAction::kPress);
  Do("JOB", KeyAction::kRelease);
  EXPECT_EQ(beeps, 3);
  Keys("NOTE JOB");
  EXPECT_EQ(beeps, 4);
}

// OPT-4.12 OPT-4.13 OPT-4.27 OPT-4.45 OPT-E.7601
TEST_F(ModeKeys, KeysWithoutFunctionDoNothing) {
  Have({{1, "DELAY 1\n"}});
  Keys("JOB 1 ENT NEXT");
  for (const char* key : {"STEP", "MOD", "PAR", "DISP", "F1", "F4", "F5", "F7"}) {
    Keys(key);
    EXPECT_EQ(Said(), 7601) << key;
    EXPECT_EQ(Shows(), "ERROR 7601");
    Keys("ERR");
    EXPECT_EQ(Shows(), "P=01S=0001I=DELAY") << key;
  }
  EXPECT_EQ(Program(1), std::vector<std::string>{"DELAY 1"});
}

// LIVE-7.03: what is no key is refused, and nothing else is an error.
TEST_F(ModeKeys, UnknownKeysAreRefused) {
  Have({});
  for (const char* key : {"", "F9", "x+", "D+", "10", "REC "}) {
    const auto answer = machine->PressKey(key);
    ASSERT_FALSE(answer) << key;
    EXPECT_EQ(answer.error().code, ErrorCode::kCellInvalidArgument);
  }
}

// LIVE-7.10: it is a protocol error to press what has no power; the emergency stop is a switch.
TEST_F(ModeKeys, WithoutPowerNothingIsPressed) {
  Have({});
  Good(machine::SwitchPower{false});
  EXPECT_EQ(machine->PressKey("JOB").error().code, ErrorCode::kCellNotLive);
  EXPECT_EQ(Shows(), "");
  Do("EMERGENCY_STOP", KeyAction::kPress);
  Good(machine::SwitchPower{true});
  EXPECT_EQ(Shows(), "ERROR 7610");
}

class MillWithoutHandbox : public machine::MachineTest {
 protected:
  MillWithoutHandbox() : MachineTest("rml1") {}
};

// LIVE-7.01
TEST_F(MillWithoutHandbox, HasNoKeys) {
  Load({"PU0,0;"});
  EXPECT_EQ(machine->PressKey("START").error().code, ErrorCode::kCellNotLive);
}

// OPT-4.21 OPT-5.11 LIVE-7.01: modes are kept, open forms are not; a new power-up is as it comes.
TEST_F(ModeKeys, ModesAreKept) {
  Have({{1, "DELAY 1\n"}});
  const std::string untouched = machine->Save();
  EXPECT_EQ(untouched.find("handbox"), std::string::npos);
  Keys("JOB 1 ENT JOG_TCP NOTE DYN PREV ENT ERR PATH NEXT ENT MOV DEL 3 5 NEXT 1 ENT MOV");
  EXPECT_EQ(Shows(), "SPEED 35.0");
  const std::string kept = machine->Save();
  Load({}, kept);
  EXPECT_EQ(machine->Save(), kept);
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "TCP"));
  EXPECT_EQ(Shows(), "P=01S=0000I=********");
  Keys("DYN");
  EXPECT_EQ(Shows(), "COORD ABSOL");
  Keys("PATH");
  EXPECT_EQ(Shows(), "PATH LIN");
  Keys("MOV");
  EXPECT_EQ(Shows(), "SPEED 35.0");
  Keys("NEXT");
  EXPECT_EQ(Shows(), "FLY = 1");
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
  Keys("PATH");
  EXPECT_EQ(Shows(), "PATH PTP");
}

// LIVE-7.01: what is no state of a handbox is refused.
TEST_F(ModeKeys, DamagedModesAreRefused) {
  Have({});
  Keys("JOG_ABS");
  const std::string kept = machine->Save();
  const std::size_t at = kept.find("handbox ") + 8;
  for (const std::string line :
       {"1", "0 3 0 0 0 0 70 100", "0 1 1 0 0 -1 70 100", "0 1 1 0 0 0 70 101",
        "0 1 1 0 0.5 0 70 100", "0 1 1 0 0 0 70 100 1", "a"}) {
    std::string other = kept;
    other.replace(at, other.find('\n', at) - at, line);
    machine::RunObserver nobody;
    const auto made = machine::Machine::Make(family_, parameters(), {}, other, nobody);
    ASSERT_FALSE(made) << line;
    EXPECT_EQ(made.error().code, ErrorCode::kCellBadText);
  }
}

// LIVE-7.01: each of the eight has its range, both ends of it included.
TEST_F(ModeKeys, KeptModesHaveTheirRanges) {
  Have({});
  Keys("JOG_ABS");
  const std::string kept = machine->Save();
  const std::size_t at = kept.find("handbox ") + 8;
  const std::string line = kept.substr(at, kept.find('\n', at) - at);
  EXPECT_EQ(line, "0 1 1 0 0 0 70 100");
  const auto taken = [&](const std::vector<std::string>& numbers) {
    std::string text;
    for (const std::string& number : numbers) text += (text.empty() ? "" : " ") + number;
    std::string other = kept;
    other.replace(at, line.size(), text);
    machine::RunObserver nobody;
    const auto made = machine::Machine::Make(family_, parameters(), {}, other, nobody);
    if (made) {
      EXPECT_EQ((*made)->Save(), other);
    }
    return bool(made);
  };
  const std::vector<std::string> least(8, "0");
  const std::vector<std::string> most = {"1", "2", "1", "3", "1", "99999.5", "100", "100"};
  EXPECT_TRUE(taken(least));
  EXPECT_TRUE(taken(most));
  const std::vector<std::string> beyond = {"2", "3", "2", "4", "2", "", "100.5", "100.5"};
  for (std::size_t n = 0; n < 8; ++n) {
    std::vector<std::string> numbers = least;
    numbers[n] = "-1";
    EXPECT_FALSE(taken(numbers)) << n;
    numbers = most;
    numbers[n] = beyond[n];
    if (!beyond[n].empty()) {
      EXPECT_FALSE(taken(numbers)) << n;
    }
    if (n < 5) {
      numbers[n] = "0.5";
      EXPECT_FALSE(taken(numbers)) << n;
    }
  }
}

// LIVE-7.01: nothing that was pressed before is left at a power-up.
TEST_F(ModeKeys, APowerUpForgetsKeys) {
  Have({{12, "DELAY 1\n"}});
  stores = false;
  Keys("JOB 1 2 NEXT 1 ENT MOV ENT REC SHIFT 5");
  EXPECT_EQ(Said(), 7601);
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  EXPECT_THAT(Lamps(), ElementsAre("MANUAL", "ROB"));
  EXPECT_NE(machine->panel().message, ErrorCode::kKeyNotEnabled);
  Keys("MOV");
  EXPECT_EQ(Said(), 0);
  EXPECT_EQ(Shows(), "SPEED 70.0");
}

const std::vector<std::string> kEveryKey = {"START",
                                            "STOP",
                                            "HOLD",
                                            "SHIFT",
                                            "STEP",
                                            "HOME",
                                            "ZERO",
                                            "EMERGENCY_STOP",
                                            "NOTE",
                                            "MODE_LEFT",
                                            "MODE_RIGHT",
                                            "OVERRIDE_PLUS",
                                            "OVERRIDE_MINUS",
                                            "JOG_ROB",
                                            "JOG_ABS",
                                            "JOG_TCP",
                                            "X+",
                                            "X-",
                                            "Y+",
                                            "Y-",
                                            "Z+",
                                            "Z-",
                                            "A+",
                                            "A-",
                                            "B+",
                                            "B-",
                                            "C+",
                                            "C-",
                                            "DEL",
                                            "MOD",
                                            "REC",
                                            "ERR",
                                            "PREV",
                                            "NEXT",
                                            "ENT",
                                            "JOB",
                                            "TCP",
                                            "DYN",
                                            "PATH",
                                            "WORK",
                                            "DLY",
                                            "MOV",
                                            "OUT",
                                            "DEB",
                                            "CAL",
                                            "PAR",
                                            "DISP",
                                            "F1",
                                            "F2",
                                            "F3",
                                            "F4",
                                            "F5",
                                            "F6",
                                            "F7",
                                            "F8",
                                            "0",
                                            "1",
                                            "2",
                                            "3",
                                            "4",
                                            "5",
                                            "6",
                                            "7",
                                            "8",
                                            "9",
                                            "POINT",
                                            "MINUS"};

// LIVE-7.03 OPT-4.12: every key in every mode has its function, or does nothing with 7601.
TEST_F(ModeKeys, EveryKeyInEveryMode) {
  const std::vector<std::string> always = {"ERR",           "MODE_LEFT",      "MODE_RIGHT",
                                           "OVERRIDE_PLUS", "OVERRIDE_MINUS", "EMERGENCY_STOP"};
  const std::vector<std::string> also = {"START", "STOP",    "HOLD",    "SHIFT",  "NOTE",
                                         "JOB",   "JOG_ROB", "JOG_ABS", "JOG_TCP"};
  // In MANUAL, with a program at a step and nothing entered.
  const std::vector<std::string> dead = {
      "STOP", "HOLD", "STEP", "MOD", "ENT", "PAR", "DISP", "F1", "F4", "F5",    "F7",   "0",
      "1",    "2",    "3",    "4",   "5",   "6",   "7",    "8",  "9",  "POINT", "MINUS"};
  const auto is_in = [](const std::vector<std::string>& keys, const std::string& key) {
    return std::ranges::find(keys, key) != keys.end();
  };
  for (const Mode mode :
       {Mode::kManual, Mode::kRepeat, Mode::kCycle, Mode::kSingle, Mode::kRemote}) {
    for (const std::string& key : kEveryKey) {
      Have({{1, "DELAY 1\nDELAY 1\n"}});
      Keys("JOB 1 NEXT 1 ENT");
      Good(machine::ChangeMode{mode});
      Keys(key);
      const bool acts = is_in(always, key) || (mode == Mode::kManual   ? !is_in(dead, key)
                                               : mode == Mode::kRemote ? false
                                                                       : is_in(also, key));
      EXPECT_EQ(Said(), acts ? 0 : 7601) << key << " in mode " << static_cast<int>(mode);
    }
  }
}

// LIVE-7.01: whatever is pressed, the display has 20 characters, programs can be read, and the
// machine is kept.
TEST_F(ModeKeys, AnyKeysInAnyOrder) {
  Have({{1, "DELAY 1\nMOVE (100.,2201.2,-350.,0.,0.)\nENDTASK\n"},
        {4, "DELAY 1\n"},
        {12, "SPEED 5\n"}});
  std::uint32_t random = 4711;
  const auto one_of = [&random](std::size_t count) {
    random = random * 1664525U + 1013904223U;
    return static_cast<std::size_t>(random >> 8U) % count;
  };
  for (int i = 0; i < 20'000; ++i) {
    const std::string& key = kEveryKey[one_of(kEveryKey.size())];
    if (key == "EMERGENCY_STOP" && one_of(20) != 0) continue;
    Do(key, std::array{KeyAction::kTap, KeyAction::kTap, KeyAction::kPress,
                       KeyAction::kRelease}[one_of(4)]);
    if (one_of(3) == 0) {
      const SimTime until =
          machine->time() + SimTime(static_cast<std::int64_t>(one_of(2'000'000'000)));
      // One that takes no time and is repeated goes on for ever.
      if (machine->Advance(until) == machine::Progress::kMoreWork) Good(machine::AbortRun{});
      heard.told.clear();
    }
    Shows();
    while (!machine->status().alarms.empty()) {
      Good(machine::EmergencyStop{false});
      Good(machine::Acknowledge{machine->status().alarms.front().id});
    }
    machine->TakeRunsOver();
    if (i % 500 != 0) continue;
    for (const auto& [slot, program] : machine->memory().programs)
      EXPECT_TRUE(DecodeObject(*program.object));
    machine::RunObserver nobody;
    const auto kept = machine::Machine::Make(family_, parameters(), {}, machine->Save(), nobody);
    ASSERT_TRUE(kept);
    EXPECT_EQ((*kept)->Save(), machine->Save());
  }
}

// LIVE-7.03: nor is what looks like a jog key or a digit.
TEST_F(ModeKeys, NearlyKeysAreRefused) {
  Have({});
  for (const char* key : {"X", "X9", "X++", "+X", "a", "/", ":", "F"}) {
    const auto answer = machine->PressKey(key);
    ASSERT_FALSE(answer) << key;
    EXPECT_EQ(answer.error().code, ErrorCode::kCellInvalidArgument) << key;
  }
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-7.01: neither a form nor a question nor what flashes is left at a power-up.
TEST_F(ModeKeys, APowerUpForgetsWhatWasEntered) {
  for (const char* keys : {"MOV", "ZERO", "JOB"}) {
    Have({});
    Keys(keys);
    Good(machine::SwitchPower{false});
    Good(machine::SwitchPower{true});
    EXPECT_EQ(Shows(), "P=00S=0000I=********") << keys;
  }
  Have({{12, "DELAY 1\n"}});
  Keys("JOB 1 2 ENT MOV ENT");
  EXPECT_TRUE(machine->panel().flashing);
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  EXPECT_FALSE(machine->panel().flashing);
}

}  // namespace
}  // namespace rmlcell::optimo
