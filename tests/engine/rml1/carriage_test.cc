// What motions of the carriage are for, how fast they are, and what is counted beyond the range.
#include "engine/rml1/carriage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "engine/motion/geometry/path.h"
#include "engine/rml1/timing.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::MotionUse;
using ::testing::ElementsAre;

// "cut 2": what each motion is for, with the programmed speed; 0 is as fast as the axes can.
std::vector<std::string> UsesOf(const std::string& stream, std::string_view profile = "t1") {
  TestRun run(ParametersOf(profile), "!MC0;" + stream);
  run.AdvanceToEnd();
  std::vector<std::string> uses;
  for (const RunRecord::Motion& motion : run.seen().motions()) {
    const char* name = motion.use == MotionUse::kCut       ? "cut "
                       : motion.use == MotionUse::kPlunge  ? "plunge "
                       : motion.use == MotionUse::kRetract ? "retract "
                                                           : "travel ";
    uses.push_back(name + std::to_string(static_cast<int>(motion.programmed_mm_s)));
  }
  return uses;
}

// RML1-3B.19, RML1-9.44: V to the heights, VS with the tool down, the travel speed with it up.
TEST(Carriage, MovesByToolState) {
  EXPECT_THAT(UsesOf("V5;VS7;PU10,0;PD20,0;PU30,0;"),
              ElementsAre("travel 5", "travel 0", "plunge 5", "cut 7", "retract 5", "travel 0"));
}

// RML1-3A.37, RML1-3B.03, RML1-9.24: H goes up and home as fast as it can; IN moves at the default
// of V, and down it is no plunge.
TEST(Carriage, GoesHome) {
  EXPECT_THAT(UsesOf("V5;PD10,0;H;"), ElementsAre("plunge 5", "cut 2", "retract 0", "travel 0"));
  EXPECT_THAT(UsesOf("V5;PD;IN;"), ElementsAre("plunge 5", "retract 2"));
  EXPECT_THAT(UsesOf("V5;IN;"), ElementsAre("travel 2"));
}

// RML1-3A.64: a three-axis motion cuts where it comes below Z0, from either side.
TEST(Carriage, CutsBelowZ0) {
  EXPECT_THAT(UsesOf("V5;Z10,0,1,20,0,0,30,0,-1,40,0,-1,50,0,0,60,0,1;"),
              ElementsAre("travel 5", "travel 5", "cut 5", "cut 5", "cut 5", "travel 5"));
}

// RML1-3A.64: Z alone plunges to below Z0 and is drawn back from there; the rest is travel.
TEST(Carriage, PlungesBelowZ0) {
  EXPECT_THAT(
      UsesOf("V5;Z0,0,0,0,0,-1,0,0,-2,0,0,-1,0,0,0,0,0,1;"),
      ElementsAre("travel 5", "plunge 5", "plunge 5", "retract 5", "retract 5", "travel 5"));
  EXPECT_THAT(UsesOf("V5;!ZM-2000;!ZM-2001;!ZM-2000;!ZM-1999;"),
              ElementsAre("travel 5", "plunge 5", "retract 5", "travel 5"));
}

// RML1-5A.29, RML1-9.28: a recovery is drawn back and crosses at the travel speed; it goes down at
// V, into the work only where its end lies below Z0.
TEST(Carriage, RecoversByTheSameRules) {
  EXPECT_THAT(UsesOf("V5;Z19000,0,-100,21000,0,-100,21000,500,-100,19000,500,-100;"),
              ElementsAre("cut 5", "cut 5", "retract 0", "travel 0", "plunge 5", "cut 5"));
  EXPECT_THAT(UsesOf("V5;Z19000,0,0,21000,0,0,21000,500,0,19000,500,0;"),
              ElementsAre("travel 5", "travel 5", "retract 0", "travel 0", "travel 5", "travel 5"));
}

// RML1-5A.30, RML1-5A.31, RML1-9.26: the tool goes up at the boundary at V, crosses, and goes down
// as its state asks.
TEST(Carriage, LeavesAndReturnsInTwoAxes) {
  EXPECT_THAT(
      UsesOf("V5;PD19000,0,21000,0,21000,500,19000,500;"),
      ElementsAre("plunge 5", "cut 2", "cut 2", "retract 5", "travel 0", "plunge 5", "cut 2"));
  EXPECT_THAT(UsesOf("V5;Z19000,0,1000,21000,0,1000;PU21000,500,19000,500;"),
              ElementsAre("travel 5", "travel 5", "retract 0", "travel 0", "travel 5", "travel 0"));
}

// RML1-9.54: the way back of a two-axis exit leads across at Z2; a set of three axes or a !ZM in
// between makes it an ordinary recovery, over the top, 20 mm above Z0.
TEST(Carriage, ReturnsOverTheTopWhenSomethingElseCameBetween) {
  const auto heights = [](const std::string& between) {
    TestRun run(ParametersOf("t1"), "!MC0;PU21000,0;" + between + "PU21000,1000,19000,1000;");
    run.AdvanceToEnd();
    std::vector<int> found;  // in work coordinates
    for (const machine::MoveDone& move : run.seen().moves()) {
      found.push_back(static_cast<int>(std::lround(move.program_point.z())));
    }
    return found;
  };
  EXPECT_THAT(heights(""), ElementsAre(500, 500, 500, 500));
  EXPECT_THAT(heights("!ZM-1400;"), ElementsAre(500, 500, 600, 2000, 2000, 500, 500));
  EXPECT_THAT(heights("Z21000,500,600;"), ElementsAre(500, 500, 2000, 2000, 500, 500));
  EXPECT_THAT(heights("@0,900;"), ElementsAre(500, 500, 900, 900, 900));
}

// RML1-9.30: a turn that catches up is a cut only where the tool stands in the work.
TEST(Carriage, TurnsInTheWorkOrAboveIt) {
  EXPECT_THAT(UsesOf("V5;!ZE Z-1:X21000A90;", "t1a"), ElementsAre("plunge 5", "cut 5", "cut 5"));
  EXPECT_THAT(UsesOf("V5;!ZE Z0:X21000A90;", "t1a"),
              ElementsAre("travel 5", "travel 5", "travel 5"));
  // By itself it is neither a plunge nor drawn back, and at Z0 it touches nothing.
  EXPECT_THAT(UsesOf("V5;!ZE Z-1:A90:Z-2:A0:Z-1;", "t1a"),
              ElementsAre("plunge 5", "cut 5", "plunge 5", "cut 5", "retract 5"));
  EXPECT_THAT(UsesOf("V5;!ZE Z0:A90:X1000A0;", "t1a"),
              ElementsAre("travel 5", "travel 5", "travel 5"));
}

// motion.md section 7: no axis beyond its own maximum, and a rotary axis in step. T1 has 60 mm/s in
// each axis, a PNC-3200 30 in Z; 60 deg/s for 30 degrees take half a second.
TEST(Carriage, LimitsTheSpeedOfEachAxis) {
  const Profile t1 = MakeProfile(ParametersOf("t1")).value();
  const Profile pnc = MakeProfile(ParametersOf("pnc-3200")).value();
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {300, 0, 0}, 100.0), 60.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {0, -300, 0}, 100.0), 60.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {0, 0, -300}, 100.0), 60.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {300, 400, 0}, 100.0), 75.0);  // Y has 4/5 of it
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {300, 400, 0}, 70.0), 70.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(pnc, {}, {300, 0, 400}, 60.0), 37.5);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {1000, 0, 0, -30}, 60.0), 20.0);  // 10 mm in 0.5 s
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {}, {0, 0, 0, 30}, 60.0), 60.0);      // a turn has no mm/s
  // What an axis has is not touched, to the last bit.
  for (int tenths = 1; tenths < 100; ++tenths)
    EXPECT_EQ(LimitedSpeed(t1, {}, {0.1 * tenths, 0, 0}, 60.0), 60.0) << tenths;
  machine::Parameters fast = ParametersOf("t1");
  ASSERT_TRUE(fast.Set("TRAVEL_SPEED", 80.0).ok());
  EXPECT_DOUBLE_EQ(LimitedSpeed(MakeProfile(fast).value(), {}, {300, 0, 0}, 100.0), 80.0);
}

// motion.md section 7: what a mill can do.
TEST(Carriage, TellsTheLimitsOfTheMill) {
  const motion::MachineLimits limits = MillLimits(MakeProfile(ParametersOf("mdx-40a")).value());
  EXPECT_EQ(limits.tip_speed_mm_s, 50.0);
  EXPECT_EQ(limits.tip_acceleration_mm_s2, 200.0);
  EXPECT_TRUE(std::isinf(limits.tip_jerk_mm_s3));
  EXPECT_EQ(limits.settling_s, 0.0);
  EXPECT_EQ(limits.junction_jump_mm_s, 3.0);
  // As long as 3 mm/s at 200 mm/s2, so 3 degrees a second at 200 deg/s2.
  EXPECT_DOUBLE_EQ(limits.junction_jump_a_rad_s, 3.0 * kRadPerDegree);
  const std::array<double, 5> speed = {50.0, 50.0, 30.0, 60.0 * kRadPerDegree, 0.0};
  const std::array<double, 5> acceleration = {200.0, 200.0, 200.0, 200.0 * kRadPerDegree, 0.0};
  for (std::size_t i = 0; i < speed.size(); ++i) {
    EXPECT_DOUBLE_EQ(limits.axes.speed[i], speed[i]) << i;
    EXPECT_DOUBLE_EQ(limits.axes.acceleration[i], acceleration[i]) << i;
  }
  machine::Parameters fast = ParametersOf("mdx-40a");
  ASSERT_TRUE(fast.Set("TRAVEL_SPEED", 70.0).ok());
  EXPECT_EQ(MillLimits(MakeProfile(fast).value()).axes.speed[1], 70.0);
}

// Ways beyond the range in mm, and the sets that had one.
struct Clipped {
  double length_mm;
  double sets;
  // Lengths to a thousandth of what a device unit is.
  bool operator==(const Clipped& other) const {
    return sets == other.sets && std::abs(length_mm - other.length_mm) < 1e-5;
  }
};
void PrintTo(const Clipped& c, std::ostream* out) { *out << c.length_mm << " in " << c.sets; }
Clipped ClippedOf(const std::string& stream, std::string_view profile = "t1") {
  TestRun run(ParametersOf(profile), stream);
  run.AdvanceToEnd();
  return {run.figures().at("clipped_length"), run.figures().at("clipped_sets")};
}

// RML1-5A.01: the way beyond the range, out of two axes and of three, back, through and past it.
TEST(Carriage, MeasuresWhatItCannotFollow) {
  EXPECT_EQ(ClippedOf("PU20000,15000,0,0;Z20000,15000,-4000;"), (Clipped{0, 0}));
  EXPECT_EQ(ClippedOf("PU20100,0;"), (Clipped{1, 1}));
  EXPECT_EQ(ClippedOf("PU20100,0,20300,0,19000,0;"), (Clipped{1 + 2 + 3, 3}));
  EXPECT_EQ(ClippedOf("PU20100,0,-300,0;"), (Clipped{1 + 1 + 3, 2}));
  EXPECT_EQ(ClippedOf("PU20300,400;PU20000,800;"), (Clipped{std::hypot(203, 4) * 3 / 203 + 5, 2}));
  EXPECT_EQ(ClippedOf("Z0,0,2100,0,0,2300,0,0,0;"), (Clipped{1 + 2 + 3, 3}));
  EXPECT_EQ(ClippedOf("Z0,0,-4100,-200,0,-4100,-200,0,0;"), (Clipped{1 + 2 + 41, 3}));
  EXPECT_EQ(ClippedOf("PU800,0,820,0;", "mdx-15"), (Clipped{0, 0}));
  EXPECT_EQ(ClippedOf("PU6136,0;", "mdx-15"), (Clipped{1, 1}));  // 40 units of 1/40 mm
}

// The carriage by itself, with Z 0 at the top of the travel.
class LoneCarriage : public testing::Test {
 protected:
  explicit LoneCarriage(std::string_view id = "t1")
      : profile(MakeProfile(ParametersOf(id)).value()) {
    registers.rotation = false;
    registers.surface_z = registers.z0 = 0.0;
  }
  void MoveXY(double x) { carriage.MoveXY({profile, registers, queue}, x, 0.0); }
  void MoveXYZ(const Point& to) { carriage.MoveXYZ({profile, registers, queue}, to); }
  void MoveZ(double z) { carriage.MoveZ({profile, registers, queue}, z); }
  const Action& last() const { return queue.all().back(); }

  const Profile profile;
  Registers registers{profile};
  ActionQueue queue;
  Carriage carriage{profile};
  // What is no longer than that is no way: RML1-9.49.
  const double nothing = motion::kTipLengthZero_mm * profile.units_per_mm;
};

TEST_F(LoneCarriage, StaysWhereItIsForNothing) {
  MoveXY(nothing);
  MoveXYZ({nothing, 0.0, 0.0});
  MoveZ(-nothing);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(carriage.logical(), Point{});
  MoveZ(-2.0 * nothing);
  EXPECT_EQ(queue.all().size(), 1U);
  EXPECT_EQ(carriage.logical().z, -2.0 * nothing);
}

// RML1-3A.64: straight down is what leads nothing aside.
TEST_F(LoneCarriage, PlungesNothingAside) {
  MoveXYZ({nothing, 0.0, -100.0});
  EXPECT_EQ(last().use, MotionUse::kPlunge);
  MoveXYZ({3.0 * nothing, 0.0, -200.0});
  EXPECT_EQ(last().use, MotionUse::kCut);
}

TEST_F(LoneCarriage, CountsNoClippingOfNothing) {
  MoveXY(1000.0);
  MoveXY(3.0 * nothing);
  MoveXY(-nothing);
  EXPECT_EQ(carriage.clipped_sets(), 0U);
  MoveXY(-3.0 * nothing);
  EXPECT_EQ(carriage.clipped_sets(), 1U);
  EXPECT_DOUBLE_EQ(carriage.clipped_length(), 2.0 * nothing);
}

TEST_F(LoneCarriage, DoesNotFollowAPartOfNothing) {
  MoveXY(1000.0);
  MoveXY(nothing);
  queue = {};
  MoveXY(-nothing);
  EXPECT_TRUE(queue.empty());
  EXPECT_DOUBLE_EQ(carriage.clipped_length(), 2.0 * nothing);
}

// Beyond the travel: along the surface, down to it and below it by nothing no work is lost.
TEST_F(LoneCarriage, LosesNoWorkOfNothing) {
  MoveXYZ({-100.0, 0.0, 0.0});
  MoveXYZ({-100.0, 0.0, 100.0});
  MoveXYZ({-100.0, 0.0, nothing});
  MoveXYZ({-100.0, 0.0, -nothing});
  EXPECT_EQ(carriage.lost().length, 0.0);
  EXPECT_TRUE(carriage.lost_lines().empty());
  MoveXYZ({-100.0, 0.0, -4.0 * nothing});
  EXPECT_DOUBLE_EQ(carriage.lost().length, 3.0 * nothing);
  EXPECT_EQ(carriage.lost_lines().size(), 1U);
}

class LoneRotaryCarriage : public LoneCarriage {
 protected:
  LoneRotaryCarriage() : LoneCarriage("t1a") {}
};

// RML1-3A.69, RML1-9.57: one wait for each set, before its first motion: A turns alone to where the
// line comes in, and the rest follows at once.
TEST_F(LoneRotaryCarriage, WaitsOnceBeforeATurnThatCatchesUp) {
  registers.dwell_ms = 10;
  MoveXYZ({21000.0, 0.0, 0.0});
  queue = {};
  MoveXYZ({19000.0, 500.0, 0.0, 90.0});
  ASSERT_EQ(queue.all().size(), 4U);
  EXPECT_EQ(queue.all()[0].kind, Action::Kind::kDwell);
  EXPECT_EQ(queue.all()[1].to, (Point{20000.0, 0.0, 0.0, 45.0}));
  EXPECT_EQ(queue.all()[2].to, (Point{20000.0, 250.0, 0.0, 45.0}));
  EXPECT_EQ(queue.all()[3].to, (Point{19000.0, 500.0, 0.0, 90.0}));
}

// Nor is it where another axis is slower and the speed is just what this one has: 60 mm/s in X, 30
// in Z.
TEST(Carriage, ASpeedThatAnAxisHasIsNotTouched) {
  const Profile pnc = MakeProfile(ParametersOf("pnc-3200")).value();
  for (int tenths = 1; tenths < 100; ++tenths) {
    EXPECT_EQ(LimitedSpeed(pnc, {}, {0.1 * tenths, 0, 0}, 60.0), 60.0) << tenths;
    EXPECT_EQ(LimitedSpeed(pnc, {}, {0, -0.1 * tenths, 0}, 60.0), 60.0) << tenths;
  }
}

// RML1-3A.69: one wait for each set, before its first motion, where the tool goes straight down to
// the place where the line comes in.
TEST_F(LoneCarriage, WaitsOnceBeforeAWayStraightDown) {
  MoveXYZ({19000.0, 0.0, -100.0});
  MoveXYZ({21000.0, 0.0, -100.0});
  MoveXYZ({21000.0, 0.0, -200.0});
  registers.dwell_ms = 10;
  queue = {};
  MoveXYZ({19000.0, 0.0, -200.0});
  ASSERT_EQ(queue.all().size(), 3U);
  EXPECT_EQ(queue.all()[0].kind, Action::Kind::kDwell);
  EXPECT_EQ(queue.all()[1].to, (Point{20000.0, 0.0, -200.0, 0.0}));
  EXPECT_EQ(queue.all()[2].to, (Point{19000.0, 0.0, -200.0, 0.0}));
}

// And where it follows the line in two pieces: down to the bottom of the travel, and along it.
TEST_F(LoneCarriage, WaitsOnceBeforeTwoPieces) {
  registers.dwell_ms = 10;
  MoveXYZ({1000.0, 0.0, -8000.0});
  ASSERT_EQ(queue.all().size(), 3U);
  EXPECT_EQ(queue.all()[0].kind, Action::Kind::kDwell);
  EXPECT_EQ(queue.all()[1].to, (Point{750.0, 0.0, -6000.0, 0.0}));
  EXPECT_EQ(queue.all()[2].to, (Point{1000.0, 0.0, -6000.0, 0.0}));
}

// RML1-3C.37: !ZM moves Z where the tool is, and the logical Z takes the same value: it is enough
// that one of the two is elsewhere.
TEST_F(LoneCarriage, MovesZOfTheToolAndOfTheCommands) {
  MoveXYZ({0.0, 0.0, 1000.0});  // above the travel: the tool stays at its top
  MoveZ(0.0);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(carriage.logical().z, 0.0);
  MoveXYZ({-100.0, 0.0, 0.0});
  registers.tool_down = true;
  registers.z1 = -500.0;
  carriage.ToToolHeight({profile, registers, queue});  // beside the travel: the tool stays up
  ASSERT_TRUE(queue.empty());
  MoveZ(-500.0);
  ASSERT_EQ(queue.all().size(), 1U);
  EXPECT_EQ(last().to.z, -500.0);
}

// Ways and waits of a stream in their order, without the spindle.
std::vector<std::string> WaysAndWaits(const std::string& stream) {
  TestRun run(ParametersOf("t1"), "!MC0;" + stream);
  run.AdvanceToEnd();
  std::vector<std::string> events = run.seen().Events();
  std::erase_if(events, [](const std::string& event) {
    return !event.starts_with("move ") && !event.starts_with("dwell ");
  });
  return events;
}

// RML1-9.34, RML1-9.53: a wait stands right before the way of Z that ends at Z1 or Z2. Above the
// top of the travel the tool has not followed X: that way has none.
TEST(Carriage, WaitsBeforeTheToolHeightBehindAWayAcross) {
  EXPECT_THAT(WaysAndWaits("Z5000,5000,1000,5000,5000,3000,6000,5000,3000;W5;PU;"),
              ElementsAre("move 5000.0,5000.0,1000.0", "move 5000.0,5000.0,2000.0",
                          "move 6000.0,5000.0,2000.0", "dwell 0.005", "move 6000.0,5000.0,500.0"));
}

// RML1-5A.30, RML1-9.34: so does the way up to Z2 where the tool leaves the travel, and the one
// where it is drawn back to Z2 at the edge before it comes in.
TEST(Carriage, WaitsBeforeTheToolHeightAtTheEdge) {
  EXPECT_THAT(WaysAndWaits("PD19000,0;W5;PD21000,0;"),
              ElementsAre("move 0.0,0.0,0.0", "move 19000.0,0.0,0.0", "dwell 0.005",
                          "move 20000.0,0.0,0.0", "dwell 0.005", "move 20000.0,0.0,500.0"));
  EXPECT_THAT(WaysAndWaits("Z19000,0,-1000,21000,0,-1000;W5;PU19000,0;"),
              ElementsAre("move 19000.0,0.0,-1000.0", "move 20000.0,0.0,-1000.0", "dwell 0.005",
                          "move 20000.0,0.0,500.0", "move 19000.0,0.0,500.0"));
}

// RML1-3A.59: each set of three axes waits, straight down in the middle of the travel, too.
TEST(Carriage, WaitsBeforeEachSetStraightDown) {
  EXPECT_THAT(WaysAndWaits("PU100,100;W5;Z100,100,-10,100,100,-20;"),
              ElementsAre("move 0.0,0.0,500.0", "move 100.0,100.0,500.0", "dwell 0.005",
                          "move 100.0,100.0,-10.0", "dwell 0.005", "move 100.0,100.0,-20.0"));
}

}  // namespace
}  // namespace rmlcell::rml1
