#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// What stands between the moves of a chain comes once and where the tip passes its place, whatever
// halts the chain or changes its speed on the way. OPT-2.49, OPT-4.17, OPT-4.18, OPT-4.37
namespace rmlcell::optimo::testing::passage_effects {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;

constexpr int kMoves = 24;
constexpr double kStep_mm = 10.0;

// Moves of 10 mm along X from 0 on at 250 mm/s, which brakes within 24 mm; OL[20 + k] behind the
// k-th.
std::string Chain() {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 50\n";
  for (int k = 1; k <= kMoves; ++k) {
    text += "MOVE (" + std::to_string(kStep_mm * k) + ",1000.,-400.,0.,0.)";
    text += k < kMoves ? "/FLY\nOL[" + std::to_string(20 + k) + "]=ON\n" : "\n";
  }
  return text;
}

// Where the tip is on its way at a time at which it moves, by X; before it moves on when it stands.
double XAt(const Ran& ran, double time_s) {
  double x = 0.0;
  for (const Ran::Part& part : ran.parts) {
    if (part.motion.path.in_axes()) continue;
    const double begin = ToSeconds(part.done.start);
    if (begin > time_s) break;
    const double into = std::min(time_s, ToSeconds(part.done.end)) - begin;
    const double s = part.motion.speed.At(part.done.profile_start_s + into).s;
    x = part.motion.path.At(std::min(s, part.motion.path.length())).point.x();
  }
  return x;
}

void ExpectEachAtItsPlace(const Ran& ran, bool held) {
  ASSERT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  for (int k = 1; k < kMoves; ++k) {
    const std::string output = "OL[" + std::to_string(20 + k) + "] 1";
    EXPECT_EQ(ran.Count(output), 1) << output;
    EXPECT_NEAR(XAt(ran, ran.First(output).at_s), kStep_mm * k, 2e-3) << output;
    EXPECT_EQ(ran.First(output).step, 4 + 2 * k) << output;
  }
  EXPECT_EQ(ran.moves.size(), kMoves + 1U);
  EXPECT_EQ(ran.Count("halt HOLD"), held ? 1 : 0);
}

TEST(PassageEffects, ComeOnceAndAtTheirPlace) {
  const std::string text = Chain();
  const Ran free = RunText(text);
  ExpectEachAtItsPlace(free, false);
  const double begin = ToSeconds(free.moves.front().at);
  const double whole = free.time_s - kSettle_s - begin;
  for (int n = 0; n < 20; ++n) {
    const double at = begin + whole * (n + 0.37) / 20.0;
    SCOPED_TRACE(at - begin);
    ExpectEachAtItsPlace(
        RunText(text, {.inputs = {{At(at), InputKind::kStop}, {At(at + 10.0), InputKind::kStart}}}),
        false);
    const Ran held =
        RunText(text, {.inputs = {{At(at), InputKind::kHold}, {At(at + 10.0), InputKind::kStart}}});
    ExpectEachAtItsPlace(held, held.Told("halt HOLD"));
    for (const double percent : {25.0, 130.0}) {
      ExpectEachAtItsPlace(RunText(text, {.inputs = {{At(at), InputKind::kOverride, 0, percent}}}),
                           false);
    }
    ExpectEachAtItsPlace(RunText(text, {.inputs = {{At(at), InputKind::kOverride, 0, 55.0},
                                                   {At(at + 0.11), InputKind::kStop},
                                                   {At(at + 10.0), InputKind::kOverride, 0, 100.0},
                                                   {At(at + 11.0), InputKind::kStart}}}),
                         false);
  }
}

// OPT-4.18: a second STOP, on the way to rest and behind START.
TEST(PassageEffects, OverTwoStops) {
  const std::string text = Chain();
  const double begin = ToSeconds(RunText(text).moves.front().at);
  for (const double first : {0.2, 0.37, 0.61}) {
    for (const double second : {0.03, 10.02, 10.1, 10.3}) {
      ExpectEachAtItsPlace(
          RunText(text, {.inputs = {{At(begin + first), InputKind::kStop},
                                    {At(begin + first + std::min(second, 10.0)),
                                     second < 10.0 ? InputKind::kStop : InputKind::kStart},
                                    {At(begin + first + second), InputKind::kStop},
                                    {At(begin + 20.0), InputKind::kStart}}}),
          false);
    }
  }
}

// The door opened shortly before a corner with a WORK, closed again and START: what was told of
// beam and shutter, once the machine has come to rest behind the corner.
std::vector<std::string> ToldOverADoor(const std::string& before, const std::string& at_corner) {
  const std::string text = "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 50\n" +
                           before + "MOVE (300.,1000.,-400.,0.,0.)/FLY\n" + at_corner +
                           "MOVE (600.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  // 300 mm at 250 mm/s take more than 1.2 s; the way to rest is 24 mm, of which this is a part.
  for (double at = begin + 1.1; at < begin + 1.5; at += 0.01) {
    const Ran ran = RunText(text, {.inputs = {{At(at), InputKind::kDoor, 0, 1.0},
                                              {At(at + 5.0), InputKind::kDoor, 0, 0.0},
                                              {At(at + 6.0), InputKind::kStart}}});
    const double x = XAt(ran, ran.First("halt STOP").at_s);
    if (x < 305.0 || x > 320.0) continue;
    std::vector<std::string> told;
    for (const Ran::Event& event : ran.events) {
      if (event.what.starts_with("beam") || event.what.starts_with("shutter") ||
          event.what.starts_with("halt")) {
        told.push_back(event.what);
      }
    }
    return told;
  }
  return {};
}

// OPT-3.62, OPT-B.34: a beam that the program switches off on the way to rest does not come back.
TEST(PassageEffects, OffBehindAnOpenDoor) {
  EXPECT_THAT(ToldOverADoor("WORK 0,0/ON\n", "WORK 0,0/OFF\n"),
              ElementsAre("shutter open", "beam on 100.0", "beam off", "shutter closed",
                          "halt STOP", "shutter open", "shutter closed"));
}

// OPT-3.17, OPT-3.19: one that it switches on there comes on with START, behind the closed door.
TEST(PassageEffects, OnBehindAnOpenDoor) {
  EXPECT_THAT(
      ToldOverADoor("", "WORK 0,0/ON\n"),
      ElementsAre("halt STOP", "shutter open", "beam on 100.0", "beam off", "shutter closed"));
}

// OPT-3.38: what is told of the way has a duration, also where the beam comes on as the motion
// begins.
TEST(PassageEffects, NoPartOfNothing) {
  const Ran ran =
      RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\nWORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n");
  ASSERT_EQ(ran.parts.size(), 3U);
  for (const Ran::Part& part : ran.parts) EXPECT_GT(part.duration_s(), 0.0);
  EXPECT_TRUE(ran.parts[1].done.beam_on);
  EXPECT_EQ(ran.parts[1].done.use, machine::MotionUse::kCut);
  EXPECT_EQ(ran.parts[2].done.use, machine::MotionUse::kTravel);
  EXPECT_NEAR(ran.parts[1].duration_s(), 1.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::passage_effects
