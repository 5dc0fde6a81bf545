// Chains of motions through whole runs: motion.md section 7, corners.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/engine/rml1/chain_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::OutcomeKind;
using machine::RunPhase;
using ::testing::ElementsAre;

// Down to -1 mm at the origin, without the spindle: where the cases of motion.md section 12 begin.
const std::string kDown = "!MC0;@-100,200;PD;";

// The motions of a run that began at `start_s` or later.
std::vector<RunRecord::Motion> MotionsFrom(const TestRun& run, std::size_t first) {
  const auto& all = run.seen().motions();
  return {all.begin() + static_cast<std::ptrdiff_t>(first), all.end()};
}

double TimeOf(const std::vector<RunRecord::Motion>& motions) {
  return motions.back().end_s - motions.front().start_s;
}

double SpeedAtEnd(const RunRecord::Motion& motion) {
  return VelocityAt(motion, motion.planned.speed.duration_s()).tip.norm();
}

// R01 to R03 of motion.md section 12: speed words below, within and between the steps.
TEST(MillChain, RoundsSpeedWords) {
  const std::vector<std::pair<std::string, std::string>> words = {
      {"0", "0.5"}, {"0.37", "0.5"}, {"12.9", "12"}};
  for (const auto& [word, speed] : words) {
    TestRun run(MotionTestProfile(), kDown + "VS" + word + ";PD1000,0;");
    run.AdvanceToEnd();
    EXPECT_EQ(run.variable("VS"), speed);
    EXPECT_NEAR(run.seen().motions().back().planned.speed.peak_speed(), std::stod(speed), 1e-9);
  }
}

// R04: one line of 10 mm at 15 mm/s.
TEST(MillChain, RidesOneLine) {
  TestRun run(MotionTestProfile(), kDown + "VS15;PD1000,0;");
  run.AdvanceToEnd();
  EXPECT_NEAR(TimeOf(MotionsFrom(run, 1)), 0.741666666667, 2e-9);
}

// R05: a right angle is passed at 3 mm/s, for one axis starts and the other stops.
TEST(MillChain, PassesARightAngle) {
  TestRun run(MotionTestProfile(), kDown + "VS15;PD1000,0,1000,1000;");
  run.AdvanceToEnd();
  const std::vector<RunRecord::Motion> chain = MotionsFrom(run, 1);
  ASSERT_EQ(chain.size(), 2U);
  EXPECT_NEAR(TimeOf(chain), 1.45633333333, 2e-9);
  EXPECT_NEAR(SpeedAtEnd(chain[0]), 3.0, 1e-3);
  EXPECT_NEAR(chain[1].planned.speed.At(0.0).speed, 3.0, 1e-9);
}

// R06: with a dwell every cutting motion begins from rest after its wait.
TEST(MillChain, StandsForEveryDwell) {
  TestRun run(MotionTestProfile(), kDown + "VS15;W500;PD1000,0,1000,1000;");
  run.AdvanceToEnd();
  const std::vector<RunRecord::Motion> chain = MotionsFrom(run, 1);
  ASSERT_EQ(chain.size(), 2U);
  EXPECT_NEAR(TimeOf(chain) + 0.5, 2.48333333333, 3e-9);
  EXPECT_EQ(chain[0].planned.speed.end().speed, 0.0);
}

// R07: short lines that bend; the speeds at their vertices.
TEST(MillChain, PassesShortLines) {
  TestRun run(MotionTestProfile(), kDown + "VS10;PD10,0,20,1,30,3,500,120;");
  run.AdvanceToEnd();
  const std::vector<RunRecord::Motion> chain = MotionsFrom(run, 1);
  ASSERT_EQ(chain.size(), 4U);
  EXPECT_NEAR(TimeOf(chain), 0.564591800746, 5e-9);
  EXPECT_NEAR(chain[0].planned.speed.end().speed, 6.32455532034, 1e-8);
  EXPECT_NEAR(chain[1].planned.speed.end().speed, 8.95541749359, 1e-8);
  EXPECT_NEAR(chain[2].planned.speed.end().speed, 10.0, 1e-8);
  EXPECT_NEAR(SpeedAtEnd(chain[0]), 6.32455532034, 1e-3);
}

// R08: a whole job: spin-up, raise, travel, plunge, two lines, raise.
TEST(MillChain, RunsAWholeJob) {
  const std::string to_zero = "!MC0;!ZM-2000;!MC1;@-100,200;VS6;V2;";
  TestRun start(MotionTestProfile(), to_zero);
  start.AdvanceToEnd();
  TestRun run(MotionTestProfile(), to_zero + "M1000,1000;D3000,1000,3000,2000;PU;");
  run.AdvanceToEnd();
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(run.time_s() - start.time_s(), 12.0853090416, 1e-8);
}

// motion.md section 7: the chain ends at a change of height, a Z-only or spindle command, and a
// dwell; commands of one kind are one chain, whatever stands between them that needs no standstill.
TEST(MillChain, EndsWhereTheToolMustStand) {
  const auto joints = [](const std::string& stream) {
    TestRun run(ParametersOf("t1"), "!MC0;" + stream);
    run.AdvanceToEnd();
    std::string text;
    for (const RunRecord::Motion& motion : run.seen().motions()) {
      const bool joined = motion.planned.speed.At(0.0).speed > 0.0;
      text += joined ? 'j' : '-';
    }
    return text;
  };
  EXPECT_EQ(joints("PU100,0,200,0;PU300,0;"), "--jj");
  EXPECT_EQ(joints("D100,0;PD200,0;PA300,0;I100,0;PR100,0;"), "--jjjj");
  EXPECT_EQ(joints("M100,0;PU200,0;R100,0;PA500,0;"), "--jjj");
  EXPECT_EQ(joints("PD100,0;VS5;XX;PA;F9;;PD200,0;"), "--j");
  EXPECT_EQ(joints("PD100,0;PU;PD;PD200,0;"), "-----");
  EXPECT_EQ(joints("Z100,0,-10,200,0,-10,200,0,-20;Z300,0,-20;"), "-jjj");
  EXPECT_EQ(joints("Z100,0,-10;!ZM-2500;Z200,0,-500;"), "---");
  EXPECT_EQ(joints("Z100,0,-10;W5;Z200,0,-10,300,0,-10;W0;Z400,0,-10,500,0,-10;"), "---jj");
  EXPECT_EQ(joints("!MC1;PD100,0;!RC15;PD200,0;!RC15;PD300,0;!MC1;PD400,0;"), "---jj");
  EXPECT_EQ(joints("!MC1;PD100,0;!MC0;PD200,0;"), "---");
  EXPECT_EQ(joints("PD100,0;Z200,0,0;PD300,0;"), "----");
  EXPECT_EQ(joints("PU100,0;H;PU100,0,200,0;"), "------j");
}

// motion.md section 7, corners: a straight line costs the same however it is cut, and a chain that
// turns back passes its vertex at half of the speed jump.
TEST(MillChain, CutsNoTimeOutOfALine) {
  TestRun whole(ParametersOf("t1"), "!MC0;VS40;PD8000,0;");
  whole.AdvanceToEnd();
  std::string stream = "!MC0;VS40;PD";
  for (int x = 10; x <= 8000; x += 10) stream += std::to_string(x) + ",0,";
  stream.back() = ';';
  TestRun parts(ParametersOf("t1"), stream);
  parts.AdvanceToEnd();
  EXPECT_EQ(parts.seen().motions().size(), 801U);
  EXPECT_NEAR(parts.time_s(), whole.time_s(), 2e-9);

  TestRun back(ParametersOf("t1"), "!MC0;VS40;PD8000,0,0,0;");
  back.AdvanceToEnd();
  EXPECT_NEAR(back.seen().motions()[1].planned.speed.end().speed, 1.5, 1e-12);
}

// Random chains of all three kinds against the whole plan with arrays, and from the places of the
// tool: no axis jumps by more than 3 mm/s, none accelerates by more than 200 mm/s2, and the tool is
// never faster than programmed (motion.md section 10, property 1).
TEST(MillChain, AgreesWithThePlanThatSeesAll) {
  std::mt19937 random(20);
  const auto draw = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  for (int round = 0; round < 60; ++round) {
    const bool three = round % 3 == 0;
    const int reach = round % 2 == 0 ? 40 : 1500;
    const int count = draw(1, 120);
    int x = 4000;
    int y = 4000;
    int z = three ? -1000 : 0;
    int speed = draw(1, 60);
    // A motion of Z alone in front, so that the chain begins where it is meant to.
    std::string stream = "!MC0;PD4000,4000;";
    stream += three ? "!ZM-3000;" : "!ZM-1500;PD;";
    std::vector<Vertex> chain = {{.at = {40.0, 40.0, -20.0 + z / 100.0}}};
    for (int k = 0; k < count; ++k) {
      if (k == 0 || draw(0, 4) == 0) speed = draw(1, 60);
      const int dx = draw(-reach, reach);
      const int dy = draw(-reach, reach);
      const int dz = three ? draw(-reach / 4, reach / 4) : 0;
      if (dx == 0 && dy == 0 && dz == 0) continue;
      x = std::clamp(x + dx, 0, 15000);
      y = std::clamp(y + dy, 0, 15000);
      z = three ? std::clamp(z + dz, -3900, 1900) : 0;
      const motion::MachinePoint at{x / 100.0, y / 100.0, -20.0 + z / 100.0};
      if (at == chain.back().at) continue;
      const std::string word = std::to_string(speed);
      const std::string xy = std::to_string(x) + "," + std::to_string(y);
      stream += three ? "V" + word + ";Z" + xy + "," + std::to_string(z) + ";"
                      : "VS" + word + ";PD" + xy + ";";
      chain.push_back({.at = at, .speed = static_cast<double>(speed)});
    }
    if (chain.size() < 2) continue;
    TestRun run(ParametersOf("t1"), stream);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    const std::size_t before = run.seen().motions().size() - (chain.size() - 1);
    const std::vector<RunRecord::Motion> motions = MotionsFrom(run, before);
    const ChainPlan plan = PlanOf(chain, 200.0, 3.0);
    EXPECT_NEAR(TimeOf(motions), plan.time_s, 3e-9);
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const RunRecord::Motion& m = motions[k];
      ASSERT_NEAR(m.planned.speed.end().speed, plan.speeds[k + 1], 1e-8);
      const double duration = m.planned.speed.duration_s();
      const Velocity begin = VelocityAt(m, 0.0);
      if (k > 0) {
        const double last = motions[k - 1].planned.speed.duration_s();
        EXPECT_LE(LargestJump(VelocityAt(motions[k - 1], last), begin), 3.0 + 1e-3);
      }
      for (int i = 1; i < 8; ++i) {
        const double t = duration * i / 8.0;
        EXPECT_LE(VelocityAt(m, t).tip.norm(), chain[k + 1].speed * (1.0 + 1e-6));
      }
      const double h = duration / 64.0;
      const auto place = [&](double t) { return m.planned.path.At(m.planned.speed.At(t).s).point; };
      for (int i = 1; i < 64; ++i) {
        const motion::MachineVector bend =
            place(h * (i - 1)) - place(h * i) * 2.0 + place(h * (i + 1));
        EXPECT_LE(bend.norm() / (h * h), 200.0 * (1.0 + 1e-6) + 1e-12 / (h * h));
      }
    }
  }
}

// RML1-3D.29, motion.md section 7: A turns in step and sets the common speed of a group, and may
// jump as far at a vertex as it gets by itself in the time of the jump of the other axes: by
// 200 deg/s2 x 3 mm/s / 200 mm/s2 = 3 deg/s.
TEST(MillChain, KeepsTheJumpOfTheRotaryAxis) {
  machine::Parameters t1a = ParametersOf("t1a");
  TestRun run(t1a, "!MC0;V20;Z0,0,0;!ZE X1000:X2000A5:X3000A5:X4000A35;");
  run.AdvanceToEnd();
  const std::vector<RunRecord::Motion> chain = MotionsFrom(run, 1);
  ASSERT_EQ(chain.size(), 4U);
  // Straight on in X; A starts at 0.5 deg/mm, stops, starts at 3 deg/mm: 3 / 0.5 and 3 / 3 mm/s.
  EXPECT_NEAR(chain[0].planned.speed.end().speed, 6.0, 1e-9);
  EXPECT_NEAR(chain[1].planned.speed.end().speed, 6.0, 1e-9);
  EXPECT_NEAR(chain[2].planned.speed.end().speed, 1.0, 1e-9);
  for (std::size_t k = 1; k < chain.size(); ++k) {
    const Velocity before = VelocityAt(chain[k - 1], chain[k - 1].planned.speed.duration_s());
    const Velocity after = VelocityAt(chain[k], 0.0);
    EXPECT_NEAR(std::abs(after.a_deg_s - before.a_deg_s), 3.0, 1e-3) << k;
  }
  // 30 degrees in 10 mm: 60 deg/s allow 20 mm/s, 200 deg/s2 allow 66.7 mm/s2.
  EXPECT_NEAR(chain[3].planned.limits.acceleration, 200.0 / 3.0, 1e-9);
  // A turn by itself has no length in mm: the tool stands before and behind it.
  TestRun alone(t1a, "!MC0;Z0,0,0;!ZE X1000:A90:X2000;");
  alone.AdvanceToEnd();
  std::vector<double> ends;
  for (const RunRecord::Motion& motion : alone.seen().motions()) {
    ends.push_back(motion.planned.speed.end().speed);
  }
  EXPECT_THAT(ends, ElementsAre(2.0, 0.0, 0.0, 0.0));  // down and across are one chain
}

// RML1-5A.01 to 5A.03: where the path leaves the range the tool stands, slides, or goes on, and its
// end points do not depend on how it is timed.
TEST(MillChain, StandsForRecoveries) {
  TestRun run(ParametersOf("t1"),
              "!MC0;V9;Z19000,0,-1000,21000,0,-1000,21000,1000,-1000,19000,"
              "1000,-1000,18000,1000,-1000;");
  run.AdvanceToEnd();
  std::string joints;
  for (const RunRecord::Motion& motion : run.seen().motions()) {
    joints += motion.planned.speed.At(0.0).speed > 0.0 ? 'j' : '-';
  }
  // There, to the face; up, across, down; on from the face, and straight on.
  EXPECT_EQ(joints,
            "-j---"
            "-j");
  EXPECT_EQ(run.variable("X"), "18000");
}

// RML1-7.05 and what observers are promised: a command is told when it begins to act, although it
// was read long before. 10 mm at 10 mm/s, at whose end the speed is 5, then 10 mm at 5 mm/s: 0.05 +
// 0.95625 + 0.025 s, and 1.9875 + 0.025 s.
TEST(MillChain, TellsCommandsInTheirTime) {
  TestRun run(ParametersOf("t1"), "!MC0;!ZM-2000;VS10;PD1000,0;XX;VS5;PD2000,0;!RC15;");
  run->Advance(FromSeconds(10.05));  // 20 mm down at 2 mm/s take 10.01 s
  EXPECT_EQ(run.variable("VS"), "10");
  EXPECT_EQ(run->state().instruction, "PD");
  EXPECT_EQ(run->steps_executed(), 3U);
  EXPECT_EQ(run.variable("ERR"), "0");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().text(),
            "0.0 step 1 !MC\n0.0 step 2 !ZM\n10.01 move 0.0,0.0,0.0\n10.01 step 3 VS\n"
            "10.01 step 4 PD\n11.04125 move 1000.0,0.0,0.0\n11.04125 diagnostic RML1-E1\n"
            "11.04125 step 5 VS\n11.04125 step 6 PD\n13.05375 move 2000.0,0.0,0.0\n"
            "13.05375 step 7 !RC\n");
}

// motion.md section 7: the tool stands before and behind every chain: one at 0.5 mm/s begins from
// rest, in one motion, whatever came before it.
TEST(MillChain, ASlowChainBehindAnotherIsOneMotion) {
  TestRun run(ParametersOf("t1"), "!MC0;VS10;PD1000,0;PU;VS0.5;PD1010,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  ASSERT_EQ(run.seen().motions().size(), 5U);  // down and across, up, down and across
  const RunRecord::Motion& slow = run.seen().motions().back();
  EXPECT_NEAR(slow.planned.speed.peak_speed(), 0.5, 1e-9);
  EXPECT_EQ(slow.planned.speed.At(0.0).speed, 0.0);
  EXPECT_NEAR(slow.end_s - slow.start_s, 0.1 / 0.5 + 0.5 / 200.0, 2e-9);
}

}  // namespace
}  // namespace rmlcell::rml1
