// What is kept of a machine, its shape, and where a tool stops at the end of the travel.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "engine/machine/shape.h"
#include "engine/rml1/device.h"
#include "engine/rml1/receive_path.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// RML1-9.31: a kept speed that the spindle has not, of another machine, becomes its nearest.
TEST(KeptSides, SpindleSpeedsOfAnotherMachine) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  const auto restored = [&](int rpm) {
    Device device(profile);
    Registers registers(profile);
    registers.rpm = rpm;
    device.Restore(registers, {1, 2, 0, 0});
    return device.registers().rpm;
  };
  EXPECT_EQ(restored(99'999), 15'000);
  EXPECT_EQ(restored(15'001), 15'000);
  EXPECT_EQ(restored(6600), 6600);
  EXPECT_EQ(restored(1), 4500);
}

// 0.2 of rml1.md: T1 goes 200 mm in X, 150 in Y and 60 down; the origin is told in its place.
TEST(KeptSides, TheShapeOfAMill) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", std::string_view("50")));
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", std::string_view("20")));
  const machine::MachineShape shape = Rml1Family().Shape(parameters);
  EXPECT_EQ((shape.travel.max - shape.travel.min), (motion::MachineVector{200, 150, 60}));
  EXPECT_EQ(shape.travel.max.z(), 0.0);
  EXPECT_EQ(shape.work_origin.x(), 50.0);
  EXPECT_EQ(shape.work_origin.y(), 20.0);
  EXPECT_EQ(shape.work_origin.z(), -20.0);
}

// RML1-4.19: what is too much in one sequence is so in that one only.
TEST(KeptSides, SurplusParametersAreThoseOfOneSequence) {
  ReceivePath path(false, true);
  int errors = 0;
  const auto feed = [&](std::string_view bytes) {
    errors = 0;
    for (const char c : bytes) {
      const Received received = path.Put(static_cast<unsigned char>(c));
      for (const LinkError error : received.errors) errors += error != LinkError::kNone;
    }
    return errors;
  };
  EXPECT_EQ(feed("\x1b.M1;2;3;4;5;6;7:"), 1);
  EXPECT_EQ(feed("\x1b.M1;2:"), 0);
  EXPECT_EQ(feed("\x1b.M99999999:"), 1);
  EXPECT_EQ(feed("\x1b.M1;2;3;4;5;6;7:"), 1);
  EXPECT_EQ(feed("\x1b.M1;2;3;4;5;6;7:"), 1);
}

// RML1-5A.30: however a line lies, the tool stops on the face that it leaves by, exactly.
TEST(KeptSides, TheToolStopsOnTheFace) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  std::mt19937 random(17);  // NOLINT: the same lines in every run
  const auto within = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 9973) / 9973.0;
  };
  for (int k = 0; k < 300; ++k) {
    const Point inside{within(9000, 11'000), within(7000, 8000), within(-3500, -2500), 0.0};
    const auto stops = [&](Point to) {
      Registers registers(profile);
      ActionQueue queue;
      Carriage carriage(profile);
      carriage.Place(inside);
      carriage.MoveXYZ({profile, registers, queue}, to);
      return carriage.physical();
    };
    EXPECT_EQ(stops({within(20'500, 30'000), within(7000, 8000), within(-3500, -2500)}).x, 20'000);
    EXPECT_EQ(stops({within(-9000, -500), within(7000, 8000), within(-3500, -2500)}).x, 0.0);
    EXPECT_EQ(stops({within(9000, 11'000), within(15'500, 20'000), within(-3500, -2500)}).y,
              15'000);
    EXPECT_EQ(stops({within(9000, 11'000), within(-9000, -500), within(-3500, -2500)}).y, 0.0);
    EXPECT_EQ(stops({within(9000, 11'000), within(7000, 8000), within(500, 3000)}).z, 0.0);
    EXPECT_EQ(stops({within(9000, 11'000), within(7000, 8000), within(-9000, -6500)}).z, -6000.0);
  }
}

// Each set and each command that moves is an act of its own, also one without a number.
TEST(KeptSides, ActsAreCounted) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  class Nobody final : public DeviceListener {
   public:
    void OnFinding(const Finding&) override {}
  } nobody;
  const auto acts = [&](std::string_view stream) {
    Device device(profile);
    std::int64_t offset = 0;
    for (const char c : stream) {
      device.Receive(static_cast<unsigned char>(c), offset++, nobody);
      do {
        while (!device.actions().empty()) device.actions().Pop();
      } while (device.Step(nobody));
    }
    return device.registers().act;
  };
  const std::uint64_t one = acts("PU1,1;") - acts("");
  EXPECT_EQ(one, 1U);
  EXPECT_EQ(acts("PU1,1,2,2;") - acts("PU1,1;"), 1U);
  EXPECT_EQ(acts("PU1,1;PD;") - acts("PU1,1;"), 1U);
  EXPECT_EQ(acts("PU1,1;PD;PU;") - acts("PU1,1;"), 2U);
}

}  // namespace
}  // namespace rmlcell::rml1
