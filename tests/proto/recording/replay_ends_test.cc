// Where a replay ends, and what it says of what lies there (live.md 3, replay).
#include <gtest/gtest.h>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/replay.h"

namespace rmlcell::recording {
namespace {

// A mill that stands, and is switched off at 5 s; nothing else happens to it.
class ReplayEnds : public testing::Test {
 protected:
  static constexpr std::int64_t kOff_ns = 5'000'000'000;

  ReplayEnds() {
    what_.head.set_family("rml1");
    what_.head.set_profile("srm-20");
    const machine::MachineFamily& family = *families::FindFamily("rml1");
    machine::RunObserver nobody;
    const auto made = machine::Machine::Make(family, *machine::MakeParameters(family, "srm-20", {}),
                                             {}, "", nobody);
    EXPECT_TRUE(made);
    const std::string state = (*made)->Save();
    v1::MachineMark& mark = *At(0).mutable_mark();
    mark.set_state(state);
    mark.set_state_sha256(*BytesOfHex(bridge::Sha256Hex(state)));
    At(kOff_ns).mutable_applied()->mutable_input()->set_power(false);
  }
  v1::JournalEntry& At(std::int64_t time_ns) {
    v1::JournalEntry& entry = what_.entries.emplace_back();
    entry.set_fence(7);
    entry.set_sequence(static_cast<std::int64_t>(what_.entries.size()));
    entry.set_virtual_time_ns(time_ns);
    return entry;
  }
  Replayed Played(const ReplayOptions& options = {}) const {
    const auto played = Replay(what_, options);
    EXPECT_TRUE(played) << played.error().detail;
    return played ? *played : Replayed();
  }
  static std::string SaidOf(const Replayed& played) {
    if (!played.difference) return "the same";
    return std::to_string(played.difference->sequence) + " " + played.difference->field + ": " +
           played.difference->played;
  }

  Recording what_;
};

// LIVE-3.40: what lies behind the end is not played; what lies at it is.
TEST_F(ReplayEnds, WhatActsAtTheEndActs) {
  const Replayed whole = Played();
  EXPECT_EQ(SaidOf(whole), "the same");
  EXPECT_EQ(whole.inputs, 1);
  EXPECT_EQ(whole.marks, 1);
  EXPECT_EQ(whole.until, SimTime(kOff_ns));
  for (const auto& [to_ns, inputs] :
       {std::pair{kOff_ns - 1, 0}, {kOff_ns, 1}, {kOff_ns + 1, 1}, {3 * kOff_ns, 1}}) {
    const Replayed part = Played({.to = SimTime(to_ns)});
    EXPECT_EQ(part.inputs, inputs) << to_ns;
    EXPECT_EQ(part.until, SimTime(to_ns)) << to_ns;
  }
}

// LIVE-3.40: how it stands with the last entry is told; what came behind it is not known.
TEST_F(ReplayEnds, HowItStandsIsToldWhereItIsKnown) {
  const auto stands_at = [&](SimTime to) {
    SimTime at{-1};
    Played({.to = to, .stands = [&](const machine::Machine& one) { at = one.time(); }});
    return at;
  };
  EXPECT_EQ(stands_at(SimTime(kOff_ns - 2)), SimTime(kOff_ns - 2));
  EXPECT_EQ(stands_at(SimTime(3 * kOff_ns)), SimTime(kOff_ns));
  EXPECT_EQ(stands_at(SimTime::max()), SimTime(kOff_ns));
}

// LIVE-3.40: what happens at an instant may be told when the machine goes on behind it: an event of
// the last instant that has not come yet is no difference, of one before it is.
TEST_F(ReplayEnds, AnEventOfTheLastInstantMayStillCome) {
  At(kOff_ns).mutable_event()->mutable_resumed();
  EXPECT_EQ(SaidOf(Played()), "the same");
  EXPECT_EQ(SaidOf(Played({.to = SimTime(kOff_ns)})), "the same");
  EXPECT_EQ(SaidOf(Played({.to = SimTime(kOff_ns + 1)})), "3 event: no event");
  At(kOff_ns + 1).mutable_applied()->mutable_input()->set_power(false);
  EXPECT_EQ(SaidOf(Played()), "3 event: no event");
}

// LIVE-3.40: an end of a run that did not end is one.
TEST_F(ReplayEnds, AnEndThatDidNotComeIsADifference) {
  At(kOff_ns).mutable_run_over()->set_run(3);
  EXPECT_EQ(SaidOf(Played()), "3 run_over: no end of a run");
}

// LIVE-3.40: the first difference alone is told, with its entry; nothing is played behind it.
TEST_F(ReplayEnds, TheFirstDifferenceEndsIt) {
  At(kOff_ns + 3).mutable_mark()->set_state_sha256("other");
  At(kOff_ns + 4).mutable_applied()->mutable_input()->set_power(true);
  const Replayed played = Played();
  ASSERT_TRUE(played.difference);
  EXPECT_EQ(played.difference->field, "mark.state_sha256");
  EXPECT_EQ(played.difference->fence, 7);
  EXPECT_EQ(played.difference->sequence, 3);
  EXPECT_EQ(played.difference->at, SimTime(kOff_ns + 3));
  EXPECT_EQ(played.difference->recorded, HexOf("other"));
  EXPECT_EQ(played.inputs, 1);
  EXPECT_EQ(played.until, SimTime(kOff_ns + 3));
}

// LIVE-3.40: nor is it looked for what is missing before it.
TEST_F(ReplayEnds, BehindADifferenceNoEndIsLookedFor) {
  At(kOff_ns).mutable_run_over()->set_run(3);
  At(kOff_ns).mutable_mark()->set_state_sha256("other");
  const Replayed played = Played();
  ASSERT_TRUE(played.difference);
  EXPECT_EQ(played.difference->field, "mark.state_sha256");
  EXPECT_EQ(played.difference->sequence, 4);
  EXPECT_EQ(played.until, SimTime(kOff_ns));
}

// Who has what he wanted is asked before each step, and nothing is missing behind it.
TEST_F(ReplayEnds, ItEndsWhereNobodyWantsMore) {
  At(kOff_ns).mutable_event()->mutable_resumed();
  At(2 * kOff_ns).mutable_applied()->mutable_input()->set_power(true);
  std::vector<SimTime> asked;
  const Replayed played = Played({.goes_on = [&](SimTime time) {
    asked.push_back(time);
    return time < SimTime(kOff_ns);
  }});
  EXPECT_EQ(SaidOf(played), "the same");
  EXPECT_EQ(played.inputs, 1);
  EXPECT_EQ(played.until, SimTime(kOff_ns));
  ASSERT_FALSE(asked.empty());
  EXPECT_EQ(asked.front(), SimTime(0));
  EXPECT_EQ(asked.back(), SimTime(kOff_ns));
}

}  // namespace
}  // namespace rmlcell::recording
