#include "engine/rml1/device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// A device without a clock that a test can feed, and whose findings it keeps.
class TestDevice final : public DeviceListener {
 public:
  explicit TestDevice(const machine::Parameters& parameters)
      : profile_(MakeProfile(parameters).value()), device_(profile_) {}

  void Feed(std::string_view bytes) {
    for (const char c : bytes) {
      device_.Receive(static_cast<unsigned char>(c), offset_++, *this);
      Work();
    }
  }
  void Work() {
    for (;;) {
      while (!device_.actions().empty()) {
        if (device_.paused()) return;
        device_.actions().Pop();
      }
      if (!device_.Step(*this)) return;
    }
  }
  void OnFinding(const Finding& finding) override { findings_.push_back(finding); }

  Device& operator*() { return device_; }
  Device* operator->() { return &device_; }
  const std::vector<Finding>& findings() const { return findings_; }
  int CountOf(FindingKind kind) const {
    int count = 0;
    for (const Finding& finding : findings_) count += finding.kind == kind ? 1 : 0;
    return count;
  }

 private:
  Profile profile_;
  Device device_;
  std::int64_t offset_ = 0;
  std::vector<Finding> findings_;
};

// RML1-3C.15: the machine has both ends of its range, 4500 to 15000 rpm, and nothing beside them.
TEST(Device, HasBothEndsOfTheSpindleRange) {
  TestDevice device(ParametersOf("t1"));
  const auto limit = [&](const char* command) {
    device.Feed(command);
    const SpeedLimit& found = device->registers().rpm_limit;
    return std::pair(found.asked, found.used);
  };
  EXPECT_EQ(limit("!RC4499;"), std::pair(4499.0, 4500.0));
  EXPECT_EQ(limit("!RC4500;"), std::pair(0.0, 0.0));
  EXPECT_EQ(limit("!RC15001;"), std::pair(15001.0, 15000.0));
  EXPECT_EQ(limit("!RC15000;"), std::pair(0.0, 0.0));
  EXPECT_EQ(limit("!RC99;").first, 0.0);  // a stage
  EXPECT_EQ(limit("!RC100;"), std::pair(100.0, 4500.0));
}

// RML1-3C.29, RML1-3C.35: both ends of the Z travel, -60 to 0 mm, may be named; what lies beyond
// changes nothing.
TEST(Device, TakesBothEndsOfTheZTravel) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("!ZO-6000;");
  EXPECT_EQ(device->registers().z0, -6000.0);
  device.Feed("!ZO0;");
  EXPECT_EQ(device->registers().z0, 0.0);
  EXPECT_TRUE(device.findings().empty());
  device.Feed("!ZO-6001;!ZO1;");
  EXPECT_EQ(device->registers().z0, 0.0);
  EXPECT_EQ(device.CountOf(FindingKind::kTravelRange), 2);

  device.Feed("!ZM-6000;!ZM0;");
  EXPECT_EQ(device.CountOf(FindingKind::kTravelRange), 2);
  device.Feed("!ZM-6001;!ZM1;");
  EXPECT_EQ(device.CountOf(FindingKind::kTravelRange), 4);
}

// How far !ZO takes Z0 up and down, by what goes by it, and which one began it: from -2000.
TEST(Device, TellsHowFarZ0IsMoved) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("!ZO-1000;!ZO-500;!ZO-1200;PU1,1;!ZO-2000;PU2,2;");
  EXPECT_EQ(device->raised().by, 800.0);
  EXPECT_EQ(device->raised().at.number, 3U);
  EXPECT_EQ(device->lowered().by, 0.0);
  EXPECT_EQ(device->lowered().at.number, 0U);
  device.Feed("!ZO-2100;PU3,3;!ZO-2300;PU4,4;");
  EXPECT_EQ(device->lowered().by, 300.0);
  EXPECT_EQ(device->lowered().at.number, 7U);
  EXPECT_EQ(device->raised().by, 800.0);
}

// RML1-6.10: 100,000 entries with their place, the rest counted, the cut told once, the register
// kept.
TEST(Device, BoundsItsErrorLog) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("$");
  device.Feed(std::string(100'004, '5'));
  device.Feed(",");
  const ErrorLog& log = device->command_errors();
  EXPECT_EQ(log.entries().size(), 100'000U);
  EXPECT_EQ(log.entries()[0], (ErrorLog::Entry{.offset = 0, .number = 1}));
  EXPECT_EQ(log.entries()[99'999], (ErrorLog::Entry{.offset = 99'999, .number = 2}));
  EXPECT_EQ(log.total(), 100'006U);
  EXPECT_EQ(log.count(1), 2U);
  EXPECT_EQ(log.count(2), 100'004U);
  EXPECT_TRUE(log.cut());
  EXPECT_EQ(log.value(), 1);
  EXPECT_EQ(device.findings().size(), 100'001U);
  EXPECT_EQ(device.CountOf(FindingKind::kLogCut), 1);
  device.Feed("H;5");
  EXPECT_EQ(log.value(), 2);  // the register works on as ever
}

// RML1-6.10: exactly full is not cut.
TEST(Device, TellsACutLogOnlyWhenSomethingIsMissing) {
  TestDevice device(ParametersOf("t1"));
  device.Feed(std::string(100'000, '5'));
  EXPECT_FALSE(device->command_errors().cut());
  EXPECT_EQ(device.CountOf(FindingKind::kLogCut), 0);
}

// RML1-4.23: a line error that the transport reports is error 15.
TEST(Device, NotesLineErrorsOfTheTransport) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("PU1");
  device->ReportLineError(3, device);
  EXPECT_EQ(device->link_errors().value(), 15);
  device.Feed(",2;");  // the damaged byte is lost, nothing else
  EXPECT_EQ(device->carriage().logical().x, 1.0);
  EXPECT_EQ(device->carriage().logical().y, 2.0);
  EXPECT_EQ(device->command_errors().value(), 0);
}

// RML1-4.23: a sender that ignores flow control overruns the buffer: error 16, the bytes are lost.
TEST(Device, LosesBytesBeyondItsBuffer) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("BUFFER", 256.0).ok());
  TestDevice device(parameters);
  device.Feed("!NR;");  // the semicolon that ended it waits in the buffer
  ASSERT_TRUE(device->paused());
  EXPECT_EQ(device->room(), 255U);
  device.Feed(std::string(249, ';') + "PU1,2;");
  EXPECT_EQ(device->room(), 0U);
  EXPECT_EQ(device->link_errors().value(), 0);
  device.Feed("PD7,8;");
  EXPECT_EQ(device->link_errors().value(), 16);
  EXPECT_EQ(device->link_errors().count(16), 6U);
  device->actions().Pop();  // the resume key
  device.Work();
  EXPECT_EQ(device->carriage().logical().x, 1.0);
  EXPECT_FALSE(device->registers().tool_down);
}

// RML1-4.20: errors 10, 17 and 18 cannot be raised by any byte.
TEST(Device, NeverRaisesTheOtherCommunicationErrors) {
  TestDevice device(ParametersOf("t1"));
  for (int byte = 0; byte < 256; ++byte) {
    device.Feed(std::string("\x1b.") + static_cast<char>(byte));
  }
  EXPECT_EQ(device->link_errors().total(), device->link_errors().count(11));
  EXPECT_EQ(device->link_errors().count(10) + device->link_errors().count(17) +
                device->link_errors().count(18),
            0U);
}

// RML1-9.48: names that the profile skips go with all of their parameters, with advice, and move
// nothing.
TEST(Device, SkipsVendorNames) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SKIP", "VPANEL").ok());
  TestDevice device(parameters);
  device.Feed("J3;!CO1,2,3;!SL;!SP 4 5;!RD.;PU5,5;");
  EXPECT_EQ(device->command_errors().total(), 0U);
  EXPECT_EQ(device.CountOf(FindingKind::kSkippedName), 5);
  EXPECT_EQ(device->carriage().logical().x, 5.0);

  ASSERT_TRUE(parameters.Set("SKIP", "PNC3000").ok());
  TestDevice older(parameters);
  older.Feed("!1;!0;!2;");
  EXPECT_EQ(older->command_errors().count(1), 1U);
  EXPECT_EQ(older.CountOf(FindingKind::kSkippedName), 2);
}

// A PNC-3200 takes all commands but !ZE (rml1-profiles.md): its name is unknown there, RML1-2.19.
TEST(Device, LacksAxisCommandsWhereTheProfileSaysSo) {
  TestDevice device(ParametersOf("pnc-3200"));
  device.Feed("!ZE;!ZZ1,1,-1;");
  EXPECT_EQ(device->command_errors().total(), 1U);
  EXPECT_EQ(device->command_errors().count(1), 1U);
}

// RML1-3D.10: a machine without Y moves nothing there, whatever command asks.
TEST(Device, KeepsYWhereThereIsNone) {
  TestDevice device(ParametersOf("t1n"));
  device.Feed("PU100,200;Z5,6,-7;PR;PD1,1;");
  EXPECT_EQ(device->carriage().logical().y, 0.0);
  EXPECT_EQ(device->carriage().logical().x, 6.0);
}

// RML1-3A.46, RML1-3A.51: a speed beyond the machine is limited and told, not an error.
TEST(Device, AdvisesOnSpeedsBeyondTheMachine) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("F60;V0.5;F61;V0.4;VS-3;");
  EXPECT_EQ(device->command_errors().total(), 0U);
  EXPECT_EQ(device->speeds_limited(), 3U);
  ASSERT_EQ(device.CountOf(FindingKind::kSpeedLimited), 3);
  EXPECT_EQ(device.findings()[0].value, 61.0);
  EXPECT_EQ(device.findings()[0].step, 3);
}

// RML1-3A.47, RML1-3B.29, RML1-3A.49, RML1-3C.23: all four speeds are rounded down, whatever little
// lacks for the step.
TEST(Device, RoundsEverySpeedDown) {
  for (const std::string name : {"F", "VS", "V", "!VZ"}) {
    const auto speed_of = [&](const std::string& written) {
      TestDevice device(ParametersOf("t1"));
      device.Feed(name + written + ";");
      EXPECT_EQ(device->command_errors().total(), 0U) << name << written;
      const Registers& registers = device->registers();
      const bool of_z = name == "V" || name == "!VZ";
      EXPECT_EQ(of_z ? registers.xy_speed : registers.z_speed, 2.0) << name;
      return of_z ? registers.z_speed : registers.xy_speed;
    };
    EXPECT_EQ(speed_of("0.9999999999"), 0.9) << name;
    EXPECT_EQ(speed_of("0." + std::string(30, '9')), 0.9) << name;
    EXPECT_EQ(speed_of("0.7"), 0.7) << name;
    EXPECT_EQ(speed_of("7.9999999999"), 7.0) << name;
    EXPECT_EQ(speed_of("1"), 1.0) << name;
    EXPECT_EQ(speed_of("59.9999999999"), 59.0) << name;
  }
}

// RML1-5A.01: what the tool could not follow is measured. That it was work is told, once a command;
// a lift above the top, or a way beyond the travel with the tool up, is nobody's loss.
TEST(Device, AdvisesOnClippedMotion) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("PU25000,0,26000,0;PU0,0;Z0,0,2500,0,0,2000;");
  EXPECT_EQ(device.CountOf(FindingKind::kClipped), 0);
  EXPECT_EQ(device->carriage().lost().length, 0.0);
  EXPECT_EQ(device->carriage().clipped_sets(), 5U);
  // Out: 5000, 1000; back: 6000; above the top: up 500 and down 500.
  EXPECT_NEAR(device->carriage().clipped_length(), 13000.0, 1e-6);
}

// T1 has X and Y from 0 to 20000 and 15000, Z 0 to -6000 with Z0 at -2000.
TEST(Device, TellsWhatIsLostOfTheWork) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("PD25000,0,26000,0;PU0,0;");
  EXPECT_EQ(device.CountOf(FindingKind::kClipped), 1);
  EXPECT_NEAR(device->carriage().lost().length, 6000.0, 1e-6);
  EXPECT_NEAR(device->carriage().lost().x_high, 6000.0, 1e-6);
  EXPECT_EQ(device->carriage().lost().x_low, 0.0);
  EXPECT_EQ(device->first_lost().number, 1U);
  // Above Z 0 nothing is lost, below it from there on: half of a slope of 5000 along and 200 down.
  device.Feed("Z20000,100,100,25000,100,-100;");
  EXPECT_EQ(device.CountOf(FindingKind::kClipped), 2);
  EXPECT_NEAR(device->carriage().lost().length, 6000.0 + std::hypot(2500.0, 100.0), 1e-6);
  // Straight up beyond the travel cuts nothing; down it would have.
  device.Feed("Z25000,100,100;");
  EXPECT_NEAR(device->carriage().lost().length, 6000.0 + std::hypot(2500.0, 100.0), 1e-6);
  // Below the travel, 500 deep: the way there, and along it.
  device.Feed("PU100,100;Z100,100,-4500,200,100,-4500;");
  EXPECT_NEAR(device->carriage().lost().z_low, 500.0, 1e-6);
  EXPECT_NEAR(device->carriage().lost().length, 6000.0 + std::hypot(2500.0, 100.0) + 600.0, 1e-6);
}

// Advice is bounded: RML1-9.06.
TEST(Device, BoundsItsAdvice) {
  TestDevice device(ParametersOf("t1"));
  for (int i = 0; i < 5000; ++i) device.Feed("F99;");
  EXPECT_EQ(device.CountOf(FindingKind::kSpeedLimited), 1000);
  EXPECT_EQ(device->speeds_limited(), 5000U);
}

// RML1-4.08: a copy of a device is a snapshot and goes on by itself.
TEST(Device, IsAValue) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("PU100,2");
  Device copy = *device;
  device.Feed("00;");
  copy.Receive(';', 7, device);
  while (copy.Step(device)) {
    while (!copy.actions().empty()) copy.actions().Pop();
  }
  EXPECT_EQ(device->carriage().logical().y, 200.0);
  EXPECT_EQ(copy.carriage().logical().y, 2.0);
}

// RML1-2.34: in relative mode it is the place led to that has the range, in work coordinates: from
// (700, 400, -300) with the origin elsewhere. One unit decides, for sets and for groups of axes.
TEST(Device, RelativeValuesHaveTheRangeOfTheirPlace) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 50.0).ok());
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 30.0).ok());
  const auto error = [&](const std::string& command) {
    TestRun run(parameters, "!MC0;Z700,400,-300;PR;" + command);
    run.AdvanceToEnd();
    return run.variable("ERR");
  };
  const auto value = [](std::int64_t number) { return std::to_string(number); };
  EXPECT_EQ(error("Z" + value(kFloatMax - 700) + ",0,0;"), "0");
  EXPECT_EQ(error("Z" + value(kFloatMax - 699) + ",0,0;"), "3");
  EXPECT_EQ(error("Z0," + value(kFloatMax - 400) + ",0;"), "0");
  EXPECT_EQ(error("Z0," + value(kFloatMax - 399) + ",0;"), "3");
  EXPECT_EQ(error("Z0,0," + value(kFloatMin + 300) + ";"), "0");
  EXPECT_EQ(error("Z0,0," + value(kFloatMin + 299) + ";"), "3");
  EXPECT_EQ(error("!ZE X" + value(kFloatMax - 700) + ";"), "0");
  EXPECT_EQ(error("!ZE X" + value(kFloatMax - 699) + ";"), "3");
  EXPECT_EQ(error("!ZE Y" + value(kFloatMax - 400) + ";"), "0");
  EXPECT_EQ(error("!ZE Y" + value(kFloatMax - 399) + ";"), "3");
  EXPECT_EQ(error("!ZE Z" + value(kFloatMin + 300) + ";"), "0");
  EXPECT_EQ(error("!ZE Z" + value(kFloatMin + 299) + ";"), "3");
  // The same values by themselves, in absolute mode, at both ends.
  EXPECT_EQ(error("PA;PU" + value(kFloatMin) + "," + value(kFloatMax) + ";"), "0");
  EXPECT_EQ(error("PA;PU" + value(kFloatMin - 1) + ",0;"), "3");
  EXPECT_EQ(error("PA;PU0," + value(kFloatMax + 1) + ";"), "3");
}

// RML1-3D.12, RML1-3D.25: axes that cannot move together drop all up to the terminator, later
// groups too, and without further errors; the command behind it runs.
TEST(Device, DropsTheGroupsBehindAxesThatCannotMoveTogether) {
  TestDevice device(ParametersOf("t1a"));
  device.Feed("!ZE X100:Y200A90:X300:Z400;");
  EXPECT_EQ(device.CountOf(FindingKind::kAxesTogether), 1);
  EXPECT_EQ(device.findings().size(), 1U);
  EXPECT_EQ(device->carriage().logical().x, 100.0);
  EXPECT_EQ(device->carriage().logical().y, 0.0);
  EXPECT_EQ(device->carriage().logical().z, 0.0);
  device.Feed("!ZE X700;");
  EXPECT_EQ(device.findings().size(), 1U);
  EXPECT_EQ(device->carriage().logical().x, 700.0);
}

// What a device tells on its way, of a stream that is read byte by byte.
class Heard final : public DeviceListener {
 public:
  explicit Heard(const machine::Parameters& parameters)
      : profile_(MakeProfile(parameters).value()), device_(profile_) {}
  void Feed(std::string_view bytes) {
    for (const char c : bytes) {
      device_.Receive(static_cast<unsigned char>(c), offset_++, *this);
      while (device_.Step(*this)) {
        while (!device_.actions().empty()) device_.actions().Pop();
      }
    }
  }
  void OnLost(const Carriage::LostLine& line) override { lost.push_back(line); }
  void OnAbort(std::int64_t offset) override { aborts.push_back(offset); }
  void OnReading(const Reading& reading, const CommandReader& reader,
                 std::int64_t /*offset*/) override {
    const bool number =
        reading.kind == Reading::Kind::kParameter || reading.kind == Reading::Kind::kAxisValue;
    if (number) numbers.push_back(reader.number_offset());
  }

  std::vector<Carriage::LostLine> lost;
  std::vector<std::int64_t> aborts;
  std::vector<std::int64_t> numbers;

 private:
  Profile profile_;
  Device device_;
  std::int64_t offset_ = 0;
};

// RML1-2.25, RML1-3D.16: every number has the byte where it begins, and ESC.K, RML1-4.08, that of
// its K.
TEST(Device, TellsWhereNumbersAndSequencesAre) {
  Heard heard(ParametersOf("t1"));
  heard.Feed("PU10, 20;!ZE X12 Y-3;PU1\x1b.KPD;");
  EXPECT_EQ(heard.numbers, (std::vector<std::int64_t>{2, 6, 14, 18}));
  EXPECT_EQ(heard.aborts, (std::vector<std::int64_t>{26}));
}

// RML1-5A.01: each line that is lost is told once, by the command that lost it. T1 has 200 mm in X.
TEST(Device, TellsEveryLostLineOnce) {
  Heard heard(ParametersOf("t1"));
  heard.Feed("PD25000,0;PD25000,100;");
  ASSERT_EQ(heard.lost.size(), 2U);
  EXPECT_EQ(heard.lost[0].from.x, 20000.0);
  EXPECT_EQ(heard.lost[0].to.x, 25000.0);
  EXPECT_EQ(heard.lost[1].from.y, 0.0);
  EXPECT_EQ(heard.lost[1].to.y, 100.0);
}

// How far work leads beyond each face of 200 by 150 mm, and where it lies.
TEST(Device, TellsHowFarWorkLeadsBeyondEachFace) {
  const auto lost_of = [](std::string_view stream) {
    TestDevice device(ParametersOf("t1"));
    device.Feed(stream);
    return device->carriage().lost();
  };
  const LostCut left = lost_of("PU100,100;PD-300,100;");
  EXPECT_EQ(left.x_low, 300.0);
  EXPECT_EQ(left.x_high + left.y_low + left.y_high + left.z_low, 0.0);
  EXPECT_EQ(left.x.low, -300.0);
  EXPECT_NEAR(left.x.high, 0.0, 1e-9);
  const LostCut front = lost_of("PU100,100;PD100,-400;");
  EXPECT_EQ(front.y_low, 400.0);
  EXPECT_EQ(front.x_low + front.x_high + front.y_high + front.z_low, 0.0);
  EXPECT_EQ(front.y.low, -400.0);
  EXPECT_NEAR(front.y.high, 0.0, 1e-9);
  const LostCut back = lost_of("PU100,14000;PD100,15500;");
  EXPECT_EQ(back.y_high, 500.0);
  EXPECT_EQ(back.x_low + back.x_high + back.y_low + back.z_low, 0.0);
}

// RML1-3B.01: DF gives the mode, the heights and whether the spindle may turn, as the program's own
// words; the speeds that it sets are those of the machine. So are those of F, VS and V without a
// number (RML1-3A.44, RML1-3A.49).
TEST(Device, KnowsWhatTheProgramGave) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("F99;V99;");
  EXPECT_TRUE(device->registers().xy_speed_given && device->registers().z_speed_given);
  EXPECT_EQ(device->registers().xy_limit.asked, 99.0);
  EXPECT_EQ(device->registers().z_limit.asked, 99.0);
  EXPECT_FALSE(device->registers().mode_given || device->registers().heights_given ||
               device->registers().rotation_given);
  device.Feed("DF;");
  const Registers after = device->registers();
  EXPECT_TRUE(after.mode_given && after.heights_given && after.rotation_given);
  EXPECT_FALSE(after.xy_speed_given || after.z_speed_given);
  EXPECT_EQ(after.xy_limit.asked, 0.0);
  EXPECT_EQ(after.z_limit.asked, 0.0);
  device.Feed("V99;V5;");  // a speed that the machine has takes the place of one that it has not
  EXPECT_EQ(device->registers().z_limit.asked, 0.0);
  device.Feed("VS99;!VZ99;VS;!VZ;");
  EXPECT_FALSE(device->registers().xy_speed_given || device->registers().z_speed_given);
  EXPECT_EQ(device->registers().xy_limit.asked, 0.0);
  EXPECT_EQ(device->registers().z_limit.asked, 0.0);
}

// RML1-3A.37, RML1-3D.08: a place is given by H, and by absolute groups that name X and Y, one
// after the other or, where there is no Y, X alone; not by relative ones.
TEST(Device, KnowsWhoGaveThePlace) {
  const auto given = [](std::string_view stream, std::string_view profile = "t1") {
    TestDevice device(ParametersOf(profile));
    device.Feed(stream);
    return device->registers().place_given_by != 0;
  };
  EXPECT_TRUE(given("H;"));
  EXPECT_FALSE(given("IN;"));
  EXPECT_FALSE(given("!ZE X5;"));
  EXPECT_FALSE(given("!ZE Y5;"));
  EXPECT_TRUE(given("!ZE X5:Y5;"));
  EXPECT_TRUE(given("!ZE X5;", "t1n"));
  EXPECT_FALSE(given("PR;!ZE X5Y5;"));
}

// RML1-3A.03, RML1-3A.52, RML1-3A.55, RML1-3C.15: the last value that each setting takes, and the
// first that it does not.
TEST(Device, SettingsHaveTheirEnds) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("W32767;V32767;V-32768;!RC8388607;!PZ-4000,8388607;");
  EXPECT_EQ(device->command_errors().total(), 0U);
  EXPECT_EQ(device->registers().dwell_ms, 32767);
  EXPECT_EQ(device->registers().z1, -4000.0);
  EXPECT_EQ(device->registers().z2, 8388607.0);
  device.Feed("W32768;V32768;V-32769;!RC8388608;");
  EXPECT_EQ(device.CountOf(FindingKind::kSettingRange), 4);
  device.Feed("!PZ-4001,8388608;");
  EXPECT_EQ(device.CountOf(FindingKind::kHeightRange), 2);
}

// RML1-3C.20: a speed that is set by hand is as far as the spindle goes, 4500 to 15000 rpm; below
// 100 it is a stage.
TEST(Device, SpeedsByHandHaveTheEndsOfTheSpindle) {
  TestDevice device(ParametersOf("t1f"));
  const auto limit = [&](const char* command) {
    device.Feed(command);
    const SpeedLimit& found = device->registers().rpm_limit;
    return std::pair(found.asked, found.used);
  };
  EXPECT_EQ(limit("!RC100;"), std::pair(100.0, 4500.0));
  EXPECT_EQ(limit("!RC99;"), std::pair(0.0, 0.0));
  EXPECT_EQ(limit("!RC15001;"), std::pair(15001.0, 15000.0));
  EXPECT_EQ(limit("!RC15000;"), std::pair(0.0, 0.0));
}

// RML1-9.11: a machine state that is kept has its surface where its Z0 is.
TEST(Device, TheSurfaceOfAKeptStateIsItsZ0) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Device device(profile);
  Registers kept(profile);
  kept.z0 = -3000.0;
  device.Restore(kept, {});
  EXPECT_EQ(device.registers().z0, -3000.0);
  EXPECT_EQ(device.registers().surface_z, -3000.0);
}

// RML1-3B.13, RML1-9.11: a command without numbers goes by Z0 as a set does, and what it loses of
// the work is told of it.
TEST(Device, CommandsWithoutNumbersGoByZ0) {
  TestDevice moved(ParametersOf("t1"));
  moved.Feed("!ZO-2500;PD;!ZO-2000;");
  EXPECT_EQ(moved->lowered().by, 500.0);
  EXPECT_EQ(moved->lowered().at.number, 1U);
  TestDevice beyond(ParametersOf("t1"));
  beyond.Feed("!PZ-300,200;PU21000,100;");
  EXPECT_EQ(beyond.CountOf(FindingKind::kClipped), 0);
  beyond.Feed("PD;");
  EXPECT_EQ(beyond.CountOf(FindingKind::kClipped), 1);
  EXPECT_EQ(beyond->first_lost().number, 3U);
}

// RML1-4.02, RML1-4.04: an ESC that begins no sequence is a byte as any other one, with the place
// where it stands, and so is the byte behind it.
TEST(Device, EscapesThatAreDataHaveTheirPlace) {
  for (const char* stream : {"!ZE \x1bX5;", "!ZE \x1b\x1bX5;"}) {
    TestDevice device(ParametersOf("t1"));
    device.Feed(stream);
    ASSERT_EQ(device.findings().size(), 1U);
    EXPECT_EQ(device.findings()[0].kind, FindingKind::kAxisLetter);
    EXPECT_EQ(device.findings()[0].offset, 4);
    EXPECT_EQ(device.findings()[0].byte, 0x1B);
  }
  TestDevice device(ParametersOf("t1"));
  device.Feed("PU;\x1b$");
  ASSERT_EQ(device.findings().size(), 1U);
  EXPECT_EQ(device.findings()[0].kind, FindingKind::kForeignCharacter);
  EXPECT_EQ(device.findings()[0].offset, 4);
  EXPECT_EQ(device.findings()[0].byte, '$');
}

// RML1-9.23: a Z1 below the bottom of the travel, because Z0 was lowered, is 10 mm of work that the
// tool cannot do.
TEST(Device, TellsTheDepthThatIsLostBelowTheTravel) {
  TestDevice device(ParametersOf("t1"));
  device.Feed("!PZ-3000,200;!ZO-4000;PD100,100;");
  EXPECT_EQ(device->carriage().physical().z, -6000.0);
  EXPECT_NEAR(device->carriage().lost().length, 1000.0, 1e-9);
  EXPECT_NEAR(device->carriage().lost().z_low, 1000.0, 1e-9);
  EXPECT_EQ(device.CountOf(FindingKind::kClipped), 1);
  EXPECT_EQ(device->first_lost().number, 3U);
}

// RML1-5A.01: a line that comes in is lost from where it begins to where it is in.
TEST(Device, TellsTheLostLineOfAWayIn) {
  Heard heard(ParametersOf("t1"));
  heard.Feed("PU21000,0;PD19000,0;");
  ASSERT_EQ(heard.lost.size(), 1U);
  EXPECT_EQ(heard.lost[0].from.x, 21000.0);
  EXPECT_NEAR(heard.lost[0].to.x, 20000.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::rml1
