// What a run tells seldom is heard again where it is played (live.md 3, replay): that its way in is
// over, lines beyond the travel, and findings that are only counted.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "proto/recording/replay.h"

namespace rmlcell::recording {
namespace {

// These alone, a line each.
class SeldomHeard final : public machine::RunObserver {
 public:
  void OnEntered(SimTime at) override { lines.push_back(TextAt("entered", at)); }
  void OnLost(const machine::LostWay& way) override {
    lines.push_back(TextAt("lost", way.at) + " " + std::to_string(way.from.x()) + " to " +
                    std::to_string(way.to.x()));
    ++lost;
  }
  void OnCounted(SimTime at, const Diagnostic& finding) override {
    lines.push_back(TextAt("counted " + CodeText(finding.code), at));
    ++counted;
  }

  std::vector<std::string> lines;
  int lost = 0;
  int counted = 0;

 private:
  static std::string TextAt(const std::string& what, SimTime at) {
    return what + " at " + std::to_string(at.count());
  }
};

class HeardAgain : public testing::Test {
 protected:
  // A machine of this family that has the program in slot 1, recorded from its beginning on.
  void Make(const std::string& family_name, const std::string& profile, const std::string& text) {
    const machine::MachineFamily& family = *families::FindFamily(family_name);
    const auto parameters = machine::MakeParameters(family, profile, {});
    ASSERT_TRUE(parameters) << parameters.error().detail;
    machine::Translation made =
        family.Translate({.name = "a", .bytes = text}, *parameters, {.advice = false});
    ASSERT_TRUE(made.ok);
    machine::MachineMemory memory;
    memory.programs[1] = {.name = "a",
                          .object = machine::Bytes::Of(made.as_it_came ? text : made.object)};
    recorded_.head.set_family(family_name);
    recorded_.head.set_profile(profile);
    SetMemory(memory, recorded_.head);
    parameters_.emplace(*parameters);
    auto machine = machine::Machine::Make(family, *parameters_, std::move(memory), "", heard_);
    ASSERT_TRUE(machine) << machine.error().detail;
    machine_ = *std::move(machine);
    const std::string state = machine_->Save();
    v1::MachineMark& mark = *Next().mutable_mark();
    mark.set_state(state);
    mark.set_state_sha256(*BytesOfHex(bridge::Sha256Hex(state)));
  }
  void Begin(const machine::MachineInput& input) {
    const Status done = machine_->Apply(input);
    ASSERT_TRUE(done) << done.error().detail;
    *Next().mutable_applied()->mutable_input() = bridge::AppliedOf(input);
    while (machine_->time() < kEnd && machine_->Advance(kEnd) == machine::Progress::kMoreWork) {
    }
  }
  // The last that acts on it, at its end.
  void SwitchOff() {
    const machine::SwitchPower off{.on = false};
    const Status done = machine_->Apply(off);
    ASSERT_TRUE(done) << done.error().detail;
    v1::JournalEntry& entry = Next();
    entry.set_virtual_time_ns(kEnd.count());
    *entry.mutable_applied()->mutable_input() = bridge::AppliedOf(off);
  }
  std::vector<std::string> Again() const {
    SeldomHeard again;
    const auto played = Replay(recorded_, {.to = kEnd, .observer = &again});
    EXPECT_TRUE(played) << played.error().detail;
    return again.lines;
  }

  // How often it is asked whether the replay goes on.
  int Asked(SimTime to) const {
    int asked = 0;
    EXPECT_TRUE(Replay(recorded_, {.to = to, .goes_on = [&](SimTime) { return ++asked > 0; }}));
    return asked;
  }

  // What is played when so many of these questions are answered with yes.
  Replayed PlayedFor(int answers) const {
    int asked = 0;
    const auto played =
        Replay(recorded_, {.to = kEnd, .goes_on = [&](SimTime) { return ++asked <= answers; }});
    EXPECT_TRUE(played) << played.error().detail;
    return played ? *played : Replayed();
  }

  static constexpr SimTime kEnd = std::chrono::hours(10);
  SeldomHeard heard_;
  std::unique_ptr<machine::Machine> machine_;

 private:
  v1::JournalEntry& Next() {
    v1::JournalEntry& entry = recorded_.entries.emplace_back();
    entry.set_fence(3);
    entry.set_sequence(static_cast<std::int64_t>(recorded_.entries.size()));
    return entry;
  }

  std::optional<machine::Parameters> parameters_;
  Recording recorded_;
};

// LIVE-3.40
TEST_F(HeardAgain, LinesBeyondTheTravelAndFindingsThatAreCounted) {
  std::string stream = ";;^IN;!MC1;V15;";
  for (int i = 0; i < 1002; ++i) stream += "PU100,100;PD-300,100;";
  Make("rml1", "srm-20", stream + "PU;");
  Begin(machine::StartRun{.program = 1});
  EXPECT_GE(heard_.lost, 1002);
  EXPECT_GE(heard_.counted, 2);
  EXPECT_EQ(Again(), heard_.lines);
}

// LIVE-3.40
TEST_F(HeardAgain, ThatTheWayToItsStepIsOver) {
  Make("optimo", "",
       "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\n"
       "DELAY 1\nMOVE (561.02, 2201.2, -380., 0., 0.)\n");
  Begin(machine::StartAtStep{.program = 1,
                             .target = {.at = {1, 6}},
                             .acknowledged = {"clamps", "table", "tool", "Z0", "origin"}});
  ASSERT_EQ(heard_.lines.size(), 1U);
  EXPECT_TRUE(heard_.lines[0].starts_with("entered at ")) << heard_.lines[0];
  EXPECT_EQ(Again(), heard_.lines);
}

// LIVE-3.40: up to the last entry there is as much to play as in all; nobody is asked once more.
TEST_F(HeardAgain, NobodyIsAskedWhereNothingIsLeftToPlay) {
  Make("optimo", "", "DELAY 1\n");
  Begin(machine::StartRun{.program = 1});
  EXPECT_EQ(Asked(SimTime(0)), Asked(SimTime::max()));
  EXPECT_GT(Asked(SimTime(1)), Asked(SimTime(0)));
}

// LIVE-3.40: a stream of more commands than are read at a time: it is asked between two parts, too,
// and the rest of them is not read for somebody who left. The first three times it is asked before
// an entry, and before the end.
TEST_F(HeardAgain, WhoLeavesDoesNotWaitForTheRestOfAStream) {
  std::string stream = ";;^IN;!MC0;";
  for (int i = 0; i < 100'000; ++i) stream += "V15;";
  Make("rml1", "srm-20", stream);
  Begin(machine::StartRun{.program = 1});
  ASSERT_GT(Asked(kEnd), 4);
  EXPECT_EQ(PlayedFor(Asked(kEnd)).until, kEnd);
  EXPECT_LT(PlayedFor(3).until, kEnd);
}

// LIVE-3.40: nor does anything act that comes behind the place where he left.
TEST_F(HeardAgain, WhatComesBehindTheLastQuestionDoesNotAct) {
  std::string stream = ";;^IN;!MC0;";
  for (int i = 0; i < 100'000; ++i) stream += "V15;";
  Make("rml1", "srm-20", stream);
  Begin(machine::StartRun{.program = 1});
  SwitchOff();
  ASSERT_GT(Asked(kEnd), 4);
  EXPECT_EQ(PlayedFor(Asked(kEnd)).inputs, 2);
  EXPECT_EQ(PlayedFor(3).inputs, 1);
}

}  // namespace
}  // namespace rmlcell::recording
