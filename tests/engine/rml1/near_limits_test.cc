// The ends of ranges, however a stream is read; what a run tells at its end; spindles that are
// stopped from outside.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/rml1/device.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::RunPhase;

// A device that read a stream as a whole, or byte by byte.
class ReadDevice final : public DeviceListener {
 public:
  explicit ReadDevice(const std::string& stream, bool whole)
      : profile_(MakeProfile(ParametersOf("t1")).value()), device_(profile_) {
    for (std::size_t at = 0; at < stream.size();) {
      const std::string_view part(stream.data() + at, whole ? stream.size() - at : 1);
      at += device_.Read(part, static_cast<std::int64_t>(at), Device::kAnyCommands, *this).bytes;
      do {
        while (!device_.actions().empty()) device_.actions().Pop();
      } while (device_.Step(*this));
    }
  }
  void OnFinding(const Finding& finding) override { findings.push_back(finding); }
  const Device* operator->() const { return &device_; }

  std::vector<Finding> findings;

 private:
  Profile profile_;
  Device device_;
};

// RML1-2.35: what leads out of the range from near its end is dropped, on each axis, in one go as
// byte by byte.
TEST(NearLimits, RelativeSetsEndAtTheRange) {
  const std::string behind(40, ';');
  for (const bool whole : {true, false}) {
    for (const char* sign : {"", "-"}) {
      const std::string far = std::string(sign) + "8000000", more = std::string(sign) + "999999";
      const double at = *sign == '-' ? -8e6 : 8e6;
      const ReadDevice x("PA;Z" + far + ",0,0;PR;Z" + more + ",0,0;" + behind, whole);
      EXPECT_EQ(x->carriage().logical().x, at) << whole;
      EXPECT_EQ(x->command_errors().count(3), 1U) << whole;
      const ReadDevice y("PA;Z0," + far + ",0;PR;Z0," + more + ",0;" + behind, whole);
      EXPECT_EQ(y->carriage().logical().y, at) << whole;
      EXPECT_EQ(y->command_errors().count(3), 1U) << whole;
      const ReadDevice z("PA;Z0,0," + far + ";PR;Z0,0," + more + ";" + behind, whole);
      EXPECT_EQ(z->carriage().logical().z, at - 2000.0) << whole;
      EXPECT_EQ(z->command_errors().count(3), 1U) << whole;
    }
  }
}

// RML1-2.32: 8388607 is in the range and 9999999 is not, of numbers with as many digits.
TEST(NearLimits, NumbersOfSevenDigits) {
  const std::string behind(40, ';');
  for (const bool whole : {true, false}) {
    const ReadDevice in("PU8388607,-8388608;" + behind, whole);
    EXPECT_EQ(in->carriage().logical().x, 8388607.0);
    EXPECT_EQ(in->carriage().logical().y, -8388608.0);
    EXPECT_EQ(in->command_errors().total(), 0U);
    const ReadDevice beyond("PU5,5;PU9999999,1;" + behind, whole);
    EXPECT_EQ(beyond->carriage().logical().x, 5.0);
    EXPECT_EQ(beyond->command_errors().count(3), 1U);
    const ReadDevice below("PU5,5;PU1,-9999999;" + behind, whole);
    EXPECT_EQ(below->carriage().logical().y, 5.0);
    EXPECT_EQ(below->command_errors().count(3), 1U);
  }
}

// RML1-3A.46, RML1-3A.51: T1 cuts at 0.5 to 60 mm/s: those ends are no limit, what lies beyond is.
TEST(NearLimits, TheEndsOfTheSpeedsAreSpeeds) {
  for (const char* stream : {"VS0.5;!VZ0.5;PU1,1;", "VS60;!VZ60;PU1,1;"})
    EXPECT_TRUE(ReadDevice(stream, false).findings.empty()) << stream;
  for (const char* stream : {"VS0.4;PU1,1;", "VS60.1;PU1,1;", "!VZ0.4;PU1,1;", "!VZ60.1;PU1,1;"}) {
    const ReadDevice device(stream, false);
    ASSERT_EQ(device.findings.size(), 1U) << stream;
    EXPECT_EQ(device.findings[0].kind, FindingKind::kSpeedLimited) << stream;
  }
}

// RML1-9.10: the top of Z is 0, and a travel has an extent.
TEST(NearLimits, ATravelWithoutDepthIsNone) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("Z0", 0.0));
  ASSERT_TRUE(parameters.Set("Z_MIN", 0.0));
  EXPECT_FALSE(MakeProfile(parameters));
  ASSERT_TRUE(parameters.Set("Z_MIN", -0.5));
  EXPECT_TRUE(MakeProfile(parameters));
}

// A command without numbers goes to the height of its tool state, too: that one was asked for.
TEST(NearLimits, ABareCommandAsksForItsHeight) {
  const ReadDevice down("!PZ-100,200;PD;PU;", false);
  EXPECT_EQ(down->programmed().z().low, -100.0);
  EXPECT_EQ(down->programmed().z().high, 200.0);
  const ReadDevice relied("PD;", false);
  EXPECT_EQ(relied->assumed().heights.number, 1U);
  EXPECT_EQ(ReadDevice("!PZ-100,200;PD;", false)->assumed().heights.number, 0U);
}

// !ZE counts as the mode says that is in force.
TEST(NearLimits, AGroupOfAxesHangsOnTheMode) {
  EXPECT_EQ(ReadDevice("VS5;!ZE X5;", false)->assumed().mode.number, 2U);
  EXPECT_EQ(ReadDevice("PA;!ZE X5;", false)->assumed().mode.number, 0U);
}

// 1 or 0, whatever is counted.
TEST(NearLimits, WhatIsSoAtTheEndIsOne) {
  TestRun spins(ParametersOf("t1"), "!MC1;PU100,0;PD200,0;PU100,1");
  ASSERT_EQ(spins.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(spins.figures().at("spindle_on_at_end"), 1.0);
  EXPECT_EQ(spins.figures().at("incomplete_at_end"), 1.0);
  TestRun stops(ParametersOf("t1"), "!MC1;PU100,0;PD200,0;PU100,1;!MC0;");
  ASSERT_EQ(stops.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(stops.figures().at("spindle_on_at_end"), 0.0);
  EXPECT_EQ(stops.figures().at("incomplete_at_end"), 0.0);
}

std::size_t EventsOf(const TestRun& run, const std::string& event) {
  std::size_t count = 0;
  for (const std::string& one : run.seen().Events()) count += one == event ? 1U : 0U;
  return count;
}

// A key and an end from outside each stop a spindle that turns, and say so once.
TEST(NearLimits, WhoeverStopsTheSpindleSaysSo) {
  TestRun key(ParametersOf("t1"), "!MC1;PU100,0;PD200,0;!NR;PU300,0;");
  ASSERT_EQ(key.AdvanceToEnd(), RunPhase::kHalted);
  const std::size_t before = EventsOf(key, "stop");
  ASSERT_TRUE(key->SwitchSpindle());
  EXPECT_EQ(EventsOf(key, "stop"), before + 1);
  ASSERT_TRUE(key->SwitchSpindle());
  EXPECT_EQ(EventsOf(key, "stop"), before + 1);
  EXPECT_TRUE(key->state().spindle_on);
  key->End(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  EXPECT_EQ(EventsOf(key, "stop"), before + 2);
  EXPECT_FALSE(key->state().spindle_on);
}

}  // namespace
}  // namespace rmlcell::rml1
