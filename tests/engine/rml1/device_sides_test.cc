// Commands without their parameters, names of two letters, places of what is
// refused, and the faces of the travel.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

machine::Parameters ParametersWith(std::string_view profile_id, const std::string& commands) {
  machine::Parameters parameters = ParametersOf(profile_id);
  if (!commands.empty()) {
    EXPECT_TRUE(parameters.Set("COMMAND", std::string_view(commands)));
  }
  return parameters;
}

// A device that was given a stream byte by byte.
class FedDevice final : public DeviceListener {
 public:
  explicit FedDevice(std::string_view stream, std::string_view profile_id = "t1",
                     const std::string& commands = {})
      : profile_(MakeProfile(ParametersWith(profile_id, commands)).value()), device_(profile_) {
    for (std::size_t at = 0; at < stream.size(); ++at) {
      device_.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at), *this);
      do {
        while (!device_.actions().empty()) device_.actions().Pop();
      } while (device_.Step(*this));
    }
  }
  void OnFinding(const Finding& finding) override { findings.push_back(finding); }
  void OnReading(const Reading& reading, const CommandReader&, std::int64_t offset) override {
    readings.emplace_back(reading.kind, offset);
  }
  const Device* operator->() const { return &device_; }

  std::vector<Finding> findings;
  std::vector<std::pair<Reading::Kind, std::int64_t>> readings;

 private:
  Profile profile_;
  Device device_;
};

// RML1-3C.18: !RC without a parameter is ignored, whatever number came before
// it.
TEST(DeviceSides, ASpindleSpeedWithoutANumber) {
  EXPECT_EQ(FedDevice("!RC15;W7;!RC;")->registers().rpm, 15'000);
  EXPECT_EQ(FedDevice("!RC3;W0;!RC;")->registers().rpm, 6600);
  EXPECT_TRUE(FedDevice("!RC15;W7;!RC;").findings.empty());
}

// RML1-3C.32, RML1-3C.33: the number of !ZO and of !ZM is one in the mode that
// is in force; without a number nothing hangs on it.
TEST(DeviceSides, WhatHangsOnTheMode) {
  const auto assumed = [](std::string_view stream) {
    return FedDevice(stream)->assumed().mode.number;
  };
  EXPECT_EQ(assumed("V5;!ZO-500;"), 2U);
  EXPECT_EQ(assumed("V5;!ZM-500;"), 2U);
  EXPECT_EQ(assumed("PA;!ZO-500;!ZM-500;"), 0U);
  EXPECT_EQ(assumed("PR;!ZO-500;!ZM-500;"), 0U);
  EXPECT_EQ(assumed("V5;!ZO;!ZM;"), 0U);
}

// A byte with which nothing is complete is no reading; one that ends a list is offered again, and
// ends its statement.
TEST(DeviceSides, ABytesReadingIsWhatItCompletes) {
  using Kind = Reading::Kind;
  EXPECT_EQ(FedDevice("!RC15;W7;").readings,
            (std::vector<std::pair<Kind, std::int64_t>>{{Kind::kCommand, 2},
                                                        {Kind::kParameter, 5},
                                                        {Kind::kEnd, 5},
                                                        {Kind::kStatementEnd, 5},
                                                        {Kind::kCommand, 6},
                                                        {Kind::kParameter, 8},
                                                        {Kind::kEnd, 8},
                                                        {Kind::kStatementEnd, 8}}));
}

// RML1-2.14, RML1-2.15: two letters that are no name of two are two of one,
// where both are.
TEST(DeviceSides, TwoLettersAreTwoCommands) {
  FedDevice both("DH;");
  EXPECT_EQ(both->commands_done(), 2U);
  EXPECT_TRUE(both.findings.empty());
  FedDevice one("PU1,1;DQ;");
  ASSERT_EQ(one.findings.size(), 1U);
  EXPECT_EQ(one.findings[0].offset, 6);
  EXPECT_EQ(one.findings[0].length, 2);
}

// What is refused stands where it begins and is as long as it is.
TEST(DeviceSides, PlacesOfUnknownNames) {
  const auto place = [](std::string_view stream, const std::string& commands) {
    const FedDevice fed(stream, "t1", commands);
    EXPECT_EQ(fed.findings.size(), 1U) << stream;
    return std::pair(fed.findings.at(0).offset, fed.findings.at(0).length);
  };
  EXPECT_EQ(place("M1,1;;Q;", "MODE1"), std::pair(std::int64_t{6}, 1));
  EXPECT_EQ(place("PU1,1;QR;", "MODE2"), std::pair(std::int64_t{6}, 2));
  EXPECT_EQ(place("PU1,1;Q R;", "MODE2"), std::pair(std::int64_t{6}, 3));
  EXPECT_EQ(place("PU1,1;^QR;", ""), std::pair(std::int64_t{7}, 2));
  EXPECT_EQ(place("PU1,1;#;", ""), std::pair(std::int64_t{6}, 1));
}

// RML1-3D.08: of axes that a group leaves out the way goes on from where they
// are, in the figures as on the machine.
TEST(DeviceSides, FiguresOfAxisGroups) {
  const FedDevice fed("PA;!ZEX100Y400Z-30:X700:Y900:Z-70;", "t1");
  const Programmed& programmed = fed->programmed();
  EXPECT_EQ(programmed.x().low, 100.0);
  EXPECT_EQ(programmed.x().high, 700.0);
  EXPECT_EQ(programmed.y().low, 400.0);
  EXPECT_EQ(programmed.y().high, 900.0);
  EXPECT_EQ(programmed.z().low, -70.0);
  // 600 along X, 500 along Y and 40 down, all with an end below Z 0.
  EXPECT_NEAR(programmed.cut_length() + programmed.travel_length() -
                  (FedDevice("PA;!ZEX100Y400Z-30;")->programmed().cut_length() +
                   FedDevice("PA;!ZEX100Y400Z-30;")->programmed().travel_length()),
              1140.0, 1e-6);
  EXPECT_NEAR(programmed.cut_length() - FedDevice("PA;!ZEX100Y400Z-30;")->programmed().cut_length(),
              1140.0, 1e-6);
}

// RML1-5A.01: the tool never leaves the travel, by the least bit neither: what
// lies beyond a face is cut off on it, however near, in two axes and in three.
TEST(DeviceSides, NearestPlacesBeyondAFace) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  for (const double beyond : {0.5e-6, 1.5e-6, 3.0e-6}) {
    for (const bool in_space : {false, true}) {
      const auto stops = [&](double x, double y, double z) {
        Registers registers(profile);
        registers.z0 = registers.surface_z = -3000.0;
        registers.z1 = 0.0;
        registers.tool_down = true;
        ActionQueue queue;
        Carriage carriage(profile);
        carriage.Place({9000, 7000, -3000, 0});
        const Carriage::Context context{profile, registers, queue};
        in_space ? carriage.MoveXYZ(context, {x, y, z, 0}) : carriage.MoveXY(context, x, y);
        return carriage.physical();
      };
      EXPECT_EQ(stops(-beyond, 7000, -3000).x, 0.0) << beyond;
      EXPECT_EQ(stops(20'000 + beyond, 7000, -3000).x, 20'000.0) << beyond;
      EXPECT_EQ(stops(9000, -beyond, -3000).y, 0.0) << beyond;
      EXPECT_EQ(stops(9000, 15'000 + beyond, -3000).y, 15'000.0) << beyond;
      if (!in_space) continue;
      EXPECT_EQ(stops(9000, 7000, beyond).z, 0.0) << beyond;
      EXPECT_EQ(stops(9000, 7000, -6000 - beyond).z, -6000.0) << beyond;
    }
  }
}

// cut_watch.h: a step down on the way of a cut is part of the cut, however
// fast; behind a lift it is a plunge again.
TEST(DeviceSides, AStepDownOfACutIsNoPlunge) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers(profile);
  registers.surface_z = registers.z0 = 0.0;
  CutWatch watch;
  std::uint64_t number = 0;
  const auto ride = [&](double from_z, Point to, double speed, bool in_work) {
    CutWatch::Ride way{.from = {.z = from_z},
                       .to = to,
                       .length_mm = std::hypot(to.x, to.z - from_z),
                       .in_work = in_work,
                       .spindle_turns = true,
                       .plunge = in_work && to.x == 0.0,
                       .speed_mm_s = speed,
                       .fastest_z_mm_s = 10.0};
    watch.OnRide(way, registers, {.number = ++number, .offset = 0, .op = Op::kCall});
  };
  ride(5, {.z = -1}, 1.0, true);
  ride(-1, {.x = 10, .z = -1}, 1.0, true);
  ride(-1, {.z = -2}, 9.0, true);
  ride(-2, {.x = 10, .z = -2}, 1.0, true);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);
  ride(-2, {.z = 5}, 9.0, false);
  ride(5, {.z = -3}, 9.0, true);
  ride(-3, {.x = 10, .z = -3}, 1.0, true);
  EXPECT_NEAR(watch.fast_plunge().mm, 3.0, 1e-3);
}

}  // namespace
}  // namespace rmlcell::rml1
