// A run that is played again: who watches it hears what its machine told (live.md 3, replay).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "proto/recording/replay.h"
#include "proto/recording/told.h"

namespace rmlcell::recording {
namespace {

SimTime SecondsOf(int count) { return std::chrono::seconds(count); }

// All that a run tells, a line each.
class AllHeard final : public machine::RunObserver {
 public:
  void OnRunBegun(const machine::RunNote& run) override { Add(run.begun, {}, "begun"); }
  void OnStep(SimTime at, const machine::Place& place, std::string_view name) override {
    Add(at, place, "step " + std::string(name));
  }
  void OnMotion(const machine::MotionDone& done) override { Add(done.end, done.place, "motion"); }
  void OnMove(const machine::MoveDone& move) override { Add(move.at, move.place, "move"); }
  void OnSignal(const machine::SignalChange& change) override {
    Add(change.at, change.place, "signal");
  }
  void OnWait(const machine::Wait& wait) override { Add(wait.end, wait.place, "wait"); }
  void OnHalt(const machine::Halt& halt) override {
    Add(halt.at, halt.place, "halt");
    *EventAt(halt.at).mutable_halted() = HaltedOf(halt);
    halted.push_back({halt.at, HaltedOf(halt)});
  }
  void OnResume(SimTime at, const machine::Place& place) override {
    Add(at, place, "resume");
    *EventAt(at).mutable_resumed() = ResumedOf(place);
    resumed.push_back({at, ResumedOf(place)});
  }
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override {
    Add(at, place, "program " + std::string(what) + " " + std::to_string(program));
  }
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override {
    Add(at, place, "message " + std::string(text));
    *EventAt(at).mutable_message() = MessageOf(place, text);
    messages.push_back({at, MessageOf(place, text)});
  }
  void OnEntered(SimTime at) override { Add(at, {}, "entered"); }
  void OnViolation(const machine::TravelViolation& violation) override {
    Add(violation.at, violation.place, "violation");
  }
  void OnLost(const machine::LostWay& way) override { Add(way.at, way.place, "lost"); }
  void OnDiagnostic(SimTime at, const Diagnostic& finding) override {
    Add(at, {}, "finding " + CodeText(finding.code));
    *EventAt(at).mutable_diagnostic() = bridge::ToProto(finding);
  }
  void OnCounted(SimTime at, const Diagnostic& finding) override {
    Add(at, {}, "counted " + CodeText(finding.code));
  }
  void OnAssumed(const machine::Assumed& assumed) override {
    Add({}, {}, "assumed " + std::string(assumed.group));
  }

  bool Heard(std::string_view what) const {
    return std::ranges::any_of(
        told, [&](const std::string& line) { return line.find(what) != std::string::npos; });
  }

  std::vector<std::string> told;
  std::vector<std::pair<SimTime, v1::RunEvent>> events;  // time of the run
  std::vector<std::pair<SimTime, v1::Halted>> halted;    // likewise
  std::vector<std::pair<SimTime, v1::Resumed>> resumed;  // likewise
  std::vector<std::pair<SimTime, v1::RunMessage>> messages;

 private:
  v1::RunEvent& EventAt(SimTime at) { return events.emplace_back(at, v1::RunEvent()).second; }
  void Add(SimTime at, const machine::Place& place, const std::string& what) {
    told.push_back(std::to_string(at.count()) + " " + std::to_string(place.program) + "/" +
                   std::to_string(place.step) + " " + what);
  }
};

// A laser, and what acts on it.
class RecordedLaser : public testing::Test {
 protected:
  explicit RecordedLaser(const std::string& text) {
    what_.head.set_family("optimo");
    machine::Translation made =
        family_.Translate({.name = "a.S", .bytes = text}, parameters_, {.advice = false});
    EXPECT_TRUE(made.ok);
    machine::MachineMemory memory;
    memory.programs[4] = {.name = "a.S", .object = machine::Bytes::Of(std::move(made.object))};
    SetMemory(memory, what_.head);
    auto machine = machine::Machine::Make(family_, parameters_, std::move(memory), "", heard_);
    EXPECT_TRUE(machine);
    machine_ = *std::move(machine);
    const std::string state = machine_->Save();
    v1::MachineMark& mark = *Entry().mutable_mark();
    mark.set_state(state);
    mark.set_state_sha256(*BytesOfHex(bridge::Sha256Hex(state)));
  }
  v1::JournalEntry& Entry(SimTime at = SimTime(0)) {
    v1::JournalEntry& entry = what_.entries.emplace_back();
    entry.set_fence(3);
    entry.set_sequence(static_cast<std::int64_t>(what_.entries.size()));
    entry.set_virtual_time_ns(at.count());
    return entry;
  }
  void GoOn(SimTime until) {
    while (machine_->time() < until && machine_->Advance(until) == machine::Progress::kMoreWork) {
    }
  }
  void Act(SimTime at, const machine::MachineInput& input) {
    GoOn(at);
    const Status done = machine_->Apply(input);
    EXPECT_TRUE(done) << done.error().detail;
    *Entry(at).mutable_applied()->mutable_input() = bridge::AppliedOf(input);
  }

  const machine::MachineFamily& family_ = *families::FindFamily("optimo");
  const machine::Parameters parameters_ = *machine::MakeParameters(family_, "", {});
  AllHeard heard_;
  std::unique_ptr<machine::Machine> machine_;
  Recording what_;
};

// It begins a run at 5 s, is held at 6 s and goes on at 9 s.
class RecordedRun : public RecordedLaser {
 protected:
  RecordedRun()
      : RecordedLaser(
            "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n"
            "OL[11] = ON\nDELAY 1\n") {
    Act(SecondsOf(5), machine::StartRun{.program = 4});
    Act(SecondsOf(6), machine::HoldRun{});
    Act(SecondsOf(9), machine::ResumeRun{});
    GoOn(SecondsOf(60));
  }
};

// LIVE-3.40
TEST_F(RecordedRun, WhoWatchesHearsWhatTheMachineTold) {
  ASSERT_EQ(heard_.halted.size(), 1U);
  ASSERT_EQ(heard_.resumed.size(), 1U);
  AllHeard again;
  std::vector<std::pair<SimTime, SimTime>> over;  // when it began, how long it worked
  std::vector<std::int64_t> begun;
  const auto played = Replay(
      what_,
      {.to = SecondsOf(60),
       .observer = &again,
       .begun = [&](const auto&...) { begun.push_back(1); },
       .over = [&](const machine::RunOver& run) { over.emplace_back(run.run.begun, run.worked); }});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_EQ(again.told, heard_.told);
  EXPECT_EQ(begun.size(), 1U);
  const auto ended = machine_->TakeRunsOver();
  ASSERT_EQ(ended.size(), 1U);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over[0], std::pair(SecondsOf(5), ended[0].worked));
  EXPECT_EQ(played->inputs, 3);
  EXPECT_EQ(played->until, SecondsOf(60));
}

// LIVE-3.40: a run that begins at a step, one that finds something, and one that leaves the travel.
class RecordedTrouble : public RecordedLaser {
 protected:
  RecordedTrouble()
      : RecordedLaser(
            "COORD ABSOL\nPATH LIN\nSPEED 10\nVR[1] = VR[2] + 1\n"
            "MOVE (521.02, 2201.2, -350., 0., 0.)/FLY\n"
            "MOVE (521.03, 2201.2, -350., 0., 0.)\nSETERR 7\n"
            "MOVE (90521.02, 2201.2, -350., 0., 0.)\n") {}
};

TEST_F(RecordedTrouble, IsHeardAgain) {
  Act(SecondsOf(5), machine::StartRun{.program = 4});
  GoOn(SecondsOf(60));
  AllHeard again;
  ASSERT_TRUE(Replay(what_, {.to = SecondsOf(60), .observer = &again}));
  EXPECT_EQ(again.told, heard_.told);
  for (const char* what :
       {"begun", "step", "motion", "move", "program", "message", "assumed", "violation", "finding"})
    EXPECT_TRUE(heard_.Heard(what)) << what;
}

// LIVE-3.40: what a run found is in its entries with what it said, and is compared as well.
TEST_F(RecordedTrouble, WhatItFoundIsCompared) {
  Act(SecondsOf(5), machine::StartRun{.program = 4});
  GoOn(SecondsOf(60));
  for (const auto& [at, event] : heard_.events) *Entry(SecondsOf(5) + at).mutable_event() = event;
  std::int64_t told = std::ssize(heard_.events);
  for (const machine::RunOver& over : machine_->TakeRunsOver()) {
    *Entry(SecondsOf(5) + over.lasted).mutable_run_over() = OverOf(over);
    ++told;
  }
  const auto same = Replay(what_, {.to = SecondsOf(60)});
  ASSERT_TRUE(same);
  EXPECT_FALSE(same->difference) << same->difference->field << same->difference->played;
  EXPECT_EQ(same->events, told);
  const auto found = std::ranges::find_if(
      what_.entries, [](const v1::JournalEntry& entry) { return entry.event().has_diagnostic(); });
  ASSERT_NE(found, what_.entries.end());
  found->mutable_event()->mutable_diagnostic()->set_message("another");
  const auto other = Replay(what_, {.to = SecondsOf(60)});
  ASSERT_TRUE(other && other->difference);
  EXPECT_EQ(other->difference->field, "event");
  EXPECT_EQ(other->difference->sequence, found->sequence());
}

// It begins a run at 5 s, and loses its power at 6 s.
class RecordedPower : public RecordedLaser {
 protected:
  RecordedPower()
      : RecordedLaser("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n") {
    Act(SecondsOf(5), machine::StartRun{.program = 4});
    Act(SecondsOf(6), machine::SwitchPower{.on = false});
  }
};

// LIVE-2.10, LIVE-3.40: power that goes ends a run where it is, and that its machine did, not its
// host: an end that no entry tells is a difference.
TEST_F(RecordedPower, TheEndByItIsCompared) {
  const auto over = machine_->TakeRunsOver();
  ASSERT_EQ(over.size(), 1U);
  int ended = 0;
  const auto untold = Replay(what_, {.over = [&](const machine::RunOver&) { ++ended; }});
  ASSERT_TRUE(untold && untold->difference);
  EXPECT_EQ(untold->difference->field, "run_over");
  EXPECT_EQ(untold->difference->recorded, "no end of a run");
  EXPECT_EQ(untold->difference->sequence, 3);
  EXPECT_EQ(ended, 1);
  *Entry(SecondsOf(6)).mutable_run_over() = OverOf(over[0]);
  const auto told = Replay(what_, {});
  ASSERT_TRUE(told);
  EXPECT_FALSE(told->difference) << told->difference->field << told->difference->played;
  EXPECT_EQ(told->events, 1);
  EXPECT_EQ(told->until, SecondsOf(6));  // nothing is missing: it goes on no further
}

// LIVE-3.40: what the machine told is in its entries at its time, that of the machine.
TEST_F(RecordedRun, WhatWasToldIsCompared) {
  const auto& [halted_at, halted] = heard_.halted.at(0);
  const auto& [resumed_at, resumed] = heard_.resumed.at(0);
  const std::vector<v1::JournalEntry> inputs(what_.entries.begin(), what_.entries.end());
  const auto played = [&](std::int64_t late_ns) {
    what_.entries.assign(inputs.begin(), inputs.end());
    const v1::JournalEntry resume = inputs.back();
    what_.entries.pop_back();
    *Entry(SecondsOf(5) + halted_at).mutable_event()->mutable_halted() = halted;
    what_.entries.push_back(resume);
    what_.entries.back().set_sequence(5);
    *Entry(SecondsOf(5) + resumed_at + SimTime(late_ns)).mutable_event()->mutable_resumed() =
        resumed;
    const auto result = Replay(what_, {.to = SecondsOf(10)});
    EXPECT_TRUE(result);
    return result ? *result : Replayed();
  };
  const Replayed same = played(0);
  EXPECT_FALSE(same.difference) << same.difference->field << same.difference->played;
  EXPECT_EQ(same.events, 2);
  const Replayed late = played(1);
  ASSERT_TRUE(late.difference);
  EXPECT_EQ(late.difference->field, "event.virtual_time_ns");
  EXPECT_EQ(late.difference->sequence, 6);
  EXPECT_EQ(late.difference->recorded, std::to_string((SecondsOf(5) + resumed_at).count() + 1));
  EXPECT_EQ(late.difference->played, std::to_string((SecondsOf(5) + resumed_at).count()));
}

// Nothing lies behind the last entry: the machine goes on by the least time there is, to be told
// what ends there.
TEST_F(RecordedRun, AnEndAtTheLastInstantIsLookedForOneInstantBehindIt) {
  Entry(SecondsOf(9)).mutable_run_over()->set_run(1);
  const auto played = Replay(what_, {});
  ASSERT_TRUE(played);
  ASSERT_TRUE(played->difference);
  EXPECT_EQ(played->difference->field, "run_over");
  EXPECT_EQ(played->difference->played, "no end of a run");
  EXPECT_EQ(played->until, SecondsOf(9) + SimTime(1));
}

// The same with all that was told of it: its begin, two events and its end.
class ToldRun : public RecordedRun {
 protected:
  ToldRun() {
    std::vector<machine::RunOver> over = machine_->TakeRunsOver();
    EXPECT_EQ(over.size(), 1U);
    const std::vector<v1::JournalEntry> inputs(what_.entries.begin(), what_.entries.end());
    what_.entries.assign(inputs.begin(), inputs.begin() + 2);
    Entry(SecondsOf(5)).mutable_run_begun()->set_run(1);
    Again(inputs[2]);
    *Entry(SecondsOf(5) + heard_.halted.at(0).first).mutable_event()->mutable_halted() =
        heard_.halted.at(0).second;
    Again(inputs[3]);
    *Entry(SecondsOf(5) + heard_.resumed.at(0).first).mutable_event()->mutable_resumed() =
        heard_.resumed.at(0).second;
    over_ = OverOf(over.at(0));
    *Entry(SecondsOf(5) + over.at(0).lasted).mutable_run_over() = over_;
  }
  void Again(const v1::JournalEntry& input) {
    what_.entries.push_back(input);
    what_.entries.back().set_sequence(static_cast<std::int64_t>(what_.entries.size()));
  }
  Replayed Played(const ReplayOptions& options = {.to = SecondsOf(60)}) const {
    const auto played = Replay(what_, options);
    EXPECT_TRUE(played) << played.error().detail;
    return played ? *played : Replayed();
  }
  void ExpectDifference(std::int64_t sequence, const std::string& field,
                        const std::string& recorded, const std::string& played) const {
    const Replayed result = Played();
    ASSERT_TRUE(result.difference) << field;
    EXPECT_EQ(result.difference->sequence, sequence);
    EXPECT_EQ(result.difference->field, field);
    EXPECT_EQ(result.difference->recorded, recorded);
    EXPECT_EQ(result.difference->played, played);
  }
  static std::string Json(const google::protobuf::Message& message) {
    return bridge::StableJson(message).value();
  }
  v1::JournalEntry& Of(std::size_t sequence) { return what_.entries.at(sequence - 1); }

  v1::RunOver over_;
};

// LIVE-3.40: what the host adds, its reason and the job, the machine did not do.
TEST_F(ToldRun, IsTheSameAgain) {
  Of(5).mutable_event()->mutable_halted()->set_reason(v1::HOLD_REASON_STOP);
  Of(8).mutable_run_over()->set_job("jobs/3");
  Entry(SecondsOf(55)).mutable_applied()->mutable_input()->mutable_control();  // acts on nothing
  const Replayed same = Played();
  EXPECT_FALSE(same.difference) << same.difference->field << same.difference->played;
  EXPECT_EQ(same.inputs, 3);
  EXPECT_EQ(same.events, 4);
  EXPECT_EQ(same.marks, 1);
}

// A recording that ends with what was told last: nothing is missing there.
TEST_F(ToldRun, IsTheSameUpToEachThatWasTold) {
  for (const std::size_t count : {8U, 7U, 5U}) {
    what_.entries.resize(count);
    const Replayed same = Played({});
    EXPECT_FALSE(same.difference) << count << same.difference->field << same.difference->played;
  }
}

TEST_F(ToldRun, EachDifferenceIsToldWithBothSides) {
  Of(8).mutable_run_over()->set_program(9);
  v1::RunOver other = over_;
  other.set_program(9);
  ExpectDifference(8, "run_over", Json(other), Json(over_));
  v1::RunEvent halted = Of(5).event();
  halted.mutable_halted()->clear_reason();
  Of(5).mutable_event()->mutable_halted()->set_message("another");
  v1::RunEvent another = halted;
  another.mutable_halted()->set_message("another");
  ExpectDifference(5, "event", Json(another), Json(halted));
  Of(3).mutable_run_begun()->set_run(2);
  ExpectDifference(3, "run_begun.run", "2", "1");
}

// What no entry tells, though it came.
TEST_F(ToldRun, WhatIsMissingInTheRecordingIsADifference) {
  const v1::RunEvent resumed = Of(7).event();
  what_.entries.pop_back();
  ExpectDifference(7, "run_over", "no end of a run", Json(over_));
  what_.entries.pop_back();
  *Entry(SecondsOf(50)).mutable_run_over() = over_;
  ExpectDifference(7, "event", "no event", Json(resumed));
}

TEST_F(ToldRun, WhatTheMachineRefusesIsADifference) {
  what_.entries.resize(3);
  v1::AppliedInput again = bridge::AppliedOf(machine::StartRun{.program = 4});
  *Entry(SecondsOf(6)).mutable_applied()->mutable_input() = again;
  const Replayed refused = Played();
  ASSERT_TRUE(refused.difference);
  EXPECT_EQ(refused.difference->sequence, 4);
  EXPECT_EQ(refused.difference->field, "applied");
  EXPECT_EQ(refused.difference->recorded, Json(again));
  EXPECT_NE(refused.difference->played.find("CELL-E9421"), std::string::npos);
  EXPECT_EQ(refused.inputs, 1);
}

// LIVE-3.40: the machine stands in the middle of a run that its host cut off, or that is over
// there.
TEST_F(ToldRun, WhatItsHostCutOffEndsWhereItIs) {
  what_.entries.resize(3);
  v1::Outcome& cut = *Entry(SecondsOf(6)).mutable_run_over()->mutable_outcome();
  cut.set_kind(v1::Outcome::KIND_INTERRUPTED);
  cut.set_code("CELL-E9402");
  bool open = false;
  Played({.to = SecondsOf(6),
          .stands = [&](const machine::Machine& one) { open = one.status().open.has_value(); }});
  EXPECT_TRUE(open);
  int ended = 0;
  const Replayed played =
      Played({.to = SecondsOf(6),
              .cut_off = [&](const machine::RunOver& over, const v1::Outcome& outcome) {
                ++ended;
                EXPECT_EQ(over.run.number, 1);
                EXPECT_EQ(outcome.code(), "CELL-E9402");
              }});
  EXPECT_EQ(ended, 1);
  EXPECT_FALSE(played.difference);
}

// Somebody looked at the machine: it did nothing, and its run goes on.
TEST_F(ToldRun, WhatItsHostSaysIsNotPlayed) {
  what_.entries.resize(3);
  Entry(SecondsOf(6)).mutable_event()->mutable_message()->set_text("somebody looked");
  int ended = 0;
  bool open = false;
  const Replayed played = Played(
      {.to = SecondsOf(6),
       .cut_off = [&](const machine::RunOver&, const v1::Outcome&) { ++ended; },
       .stands = [&](const machine::Machine& one) { open = one.status().open.has_value(); }});
  EXPECT_FALSE(played.difference);
  EXPECT_EQ(played.events, 1);  // the begin of the run
  EXPECT_EQ(ended, 0);
  EXPECT_TRUE(open);
}

// LIVE-3.40: it ends with the entry where they part; how the machine stands there is not told.
TEST_F(ToldRun, ADifferenceEndsItAtItsEntry) {
  int told = 0;
  const ReplayOptions until_a_minute = {.to = SecondsOf(60),
                                        .stands = [&](const machine::Machine&) { ++told; }};
  Of(8).set_virtual_time_ns(SecondsOf(59).count());
  Of(8).mutable_run_over()->set_program(9);
  EXPECT_EQ(Played().until, SecondsOf(59));
  Played(until_a_minute);
  EXPECT_EQ(told, 0);
  Of(8).mutable_run_over()->set_program(4);
  Played(until_a_minute);
  EXPECT_EQ(told, 1);
  ReplayOptions nobody_waits = until_a_minute;
  nobody_waits.goes_on = [](SimTime) { return false; };
  Played(nobody_waits);
  EXPECT_EQ(told, 1);
  Of(5).set_virtual_time_ns(SecondsOf(8).count());
  Of(5).mutable_event()->mutable_halted()->set_message("another");
  EXPECT_EQ(Played().until, SecondsOf(8));
}

TEST_F(ToldRun, WhatCannotBePlayedIsAnError) {
  const auto code = [](const Recording& what) -> std::optional<ErrorCode> {
    const auto played = Replay(what, {});
    return played ? std::nullopt : std::optional(played.error().code);
  };
  Recording other = what_;
  other.head.set_family("lathe");
  EXPECT_EQ(code(other), ErrorCode::kCellUnknownFamily);
  other = what_;
  other.head.set_profile("lathe");
  EXPECT_EQ(code(other), ErrorCode::kCellInvalidArgument);
  other = what_;
  other.entries[0].mutable_mark()->set_state("no state");
  EXPECT_TRUE(code(other));
  other = what_;
  other.head.mutable_brought()->set_file_name("a.S");
  other.head.mutable_brought()->set_is_source(true);
  other.head.mutable_brought()->set_content("SPEDE 20\n");
  EXPECT_TRUE(code(other));
  Of(4).mutable_applied()->mutable_input()->set_mode(v1::OPERATING_MODE_UNSPECIFIED);
  const auto bad = Replay(what_, {});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::kCellBadText);
  EXPECT_TRUE(std::string(bad.error().detail).starts_with("entry 4: ")) << bad.error().detail;
}

// What was brought for a run is there for the first that begins, and no more.
TEST_F(ToldRun, WhatWasBroughtIsForOneRun) {
  v1::AssignedProgram& brought = *what_.head.mutable_brought();
  brought.set_file_name("b.S");
  brought.set_is_source(true);
  brought.set_content("SETERR 9\n");
  what_.entries.resize(2);
  *Entry(SecondsOf(40)).mutable_applied()->mutable_input() =
      bridge::AppliedOf(machine::StartRun{.program = 4});
  AllHeard again;
  std::vector<int> begun;
  Replay(what_, {.to = SecondsOf(60),
                 .observer = &again,
                 .begun =
                     [&](const machine::Run&) {
                       begun.push_back(again.Heard("message ERROR 9") ? 1 : 0);
                     }})
      .has_value();
  EXPECT_EQ(begun, (std::vector<int>{0, 1}));
  EXPECT_EQ(again.messages.size(), 1U);
  EXPECT_TRUE(again.Heard("motion"));
}

// LIVE-6.01: it is there for a start at a step, too.
TEST_F(RecordedRun, WhatWasBroughtIsForAStartAtAStep) {
  v1::AssignedProgram& brought = *what_.head.mutable_brought();
  brought.set_file_name("b.S");
  brought.set_is_source(true);
  brought.set_content(
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\n"
      "DELAY 1\nMOVE (561.02, 2201.2, -380., 0., 0.)\nSETERR 9\n");
  what_.entries.resize(1);
  *Entry(SecondsOf(5)).mutable_applied()->mutable_input() =
      bridge::AppliedOf(machine::StartAtStep{.program = 4, .target = {.at = {4, 6}}});
  AllHeard again;
  const auto played = Replay(what_, {.to = std::chrono::hours(10), .observer = &again});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_EQ(played->inputs, 1);
  EXPECT_TRUE(again.Heard("message ERROR 9"));
}

// The entry that is missed is told, also where others came behind it.
TEST_F(RecordedRun, TheEntryThatIsMissedIsTold) {
  Entry(SecondsOf(9)).mutable_run_over()->set_run(1);
  Entry(SecondsOf(10)).mutable_applied()->mutable_input()->set_override_percent(50.0);
  const auto played = Replay(what_, {});
  ASSERT_TRUE(played && played->difference);
  EXPECT_EQ(played->difference->sequence, 5);
  EXPECT_EQ(played->difference->played, "no end of a run");
}

// What a run says of its source, it says of the lines that were written; what may not be told is
// said there, too.
TEST(BroughtSource, KeepsTheLinesOfItsSteps) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  v1::AssignedProgram message;
  message.set_file_name("part.S");
  message.set_is_source(true);
  message.set_content("; a comment\nSPEED 20\n\nDELAY 1\n");
  const auto made = ProgramOf(message, family, *machine::MakeParameters(family, "", {}));
  ASSERT_TRUE(made) << made.error().detail;
  ASSERT_NE(made->source, nullptr);
  ASSERT_GE(made->source->step_lines.size(), 2U);
  EXPECT_EQ(made->source->step_lines[0], 2);
  EXPECT_EQ(made->source->step_lines[1], 4);
}

class RecordedMessages : public RecordedLaser {
 protected:
  static std::string Told(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += "SETERR 7\n";
    return text;
  }
  RecordedMessages() : RecordedLaser(Told(kToldOfRunMax + 2)) {}
};

// Of each run so many are told, and so many are in its recording: not one less.
TEST_F(RecordedMessages, AThousandOfARunAreTold) {
  const auto add = [&](SimTime begun, std::size_t first) {
    for (std::size_t i = first; i < first + kToldOfRunMax; ++i)
      *Entry(begun + heard_.messages[i].first).mutable_event()->mutable_message() =
          heard_.messages[i].second;
    const auto over = machine_->TakeRunsOver();
    ASSERT_EQ(over.size(), 1U);
    *Entry(begun + over[0].lasted).mutable_run_over() = OverOf(over[0]);
  };
  Act(SecondsOf(5), machine::StartRun{.program = 4});
  GoOn(SecondsOf(600));
  add(SecondsOf(5), 0);
  Act(SecondsOf(600), machine::StartRun{.program = 4});
  GoOn(SecondsOf(1200));
  ASSERT_EQ(std::ssize(heard_.messages), 2 * (kToldOfRunMax + 2));
  add(SecondsOf(600), kToldOfRunMax + 2);
  const auto played = Replay(what_, {.to = SecondsOf(1200)});
  ASSERT_TRUE(played);
  EXPECT_FALSE(played->difference) << played->difference->field << played->difference->played;
  EXPECT_EQ(played->events, 2 * kToldOfRunMax + 2);  // the ends, too
}

}  // namespace
}  // namespace rmlcell::recording
