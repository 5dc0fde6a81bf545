// Ways that begin elsewhere than at zero, that only touch the travel, or that are none; and streams
// that end where they end.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rml1/carriage.h"
#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// A device that reads a stream in one go or byte by byte, with what it was told.
class WayDevice final : public DeviceListener {
 public:
  WayDevice(std::string_view stream, bool at_once, std::string_view profile_id = "t1")
      : profile_(MakeProfile(ParametersOf(profile_id)).value()), device_(profile_) {
    for (std::size_t at = 0; at < stream.size();) {
      const auto offset = static_cast<std::int64_t>(at);
      if (at_once) {
        at += device_.Read(stream.substr(at), offset, Device::kAnyCommands, *this).bytes;
      } else {
        device_.Receive(static_cast<unsigned char>(stream[at++]), offset, *this);
      }
      do {
        while (!device_.actions().empty()) device_.actions().Pop();
      } while (device_.Step(*this));
    }
  }
  void OnFinding(const Finding& finding) override {
    found += std::to_string(finding.offset) + "+" + std::to_string(finding.length) + " ";
  }
  const Device* operator->() const { return &device_; }
  std::string State() const {
    const Point& at = device_.carriage().logical();
    return found + std::to_string(device_.commands_done()) + " at " + std::to_string(at.x) + "," +
           std::to_string(at.y) + "," + std::to_string(at.z) + " foreign " +
           std::to_string(device_.foreign_percent()) + (device_.pending() ? " pending" : "");
  }

  std::string found;

 private:
  Profile profile_;
  Device device_;
};

// motion.md section 7: each axis by how far it goes, wherever the way begins. T1 has 60 mm/s in
// each axis, the rotary one 60 degrees a second.
TEST(WaysSides, SpeedsOfAxesFromAnywhere) {
  const Profile t1 = MakeProfile(ParametersOf("t1")).value();
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {1000, 5000, -40}, {1300, 5400, -40}, 90.0), 75.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {1000, 5000, -40}, {1400, 5300, -40}, 90.0), 75.0);
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1, {1000, 5000, -40}, {1000, 5300, 360}, 90.0), 75.0);
  const Profile t1a = MakeProfile(ParametersOf("t1a")).value();
  EXPECT_DOUBLE_EQ(LimitedSpeed(t1a, {500, 700, -40, 300}, {500, 1700, -40, 330}, 50.0), 20.0);
}

// RML1-5A.26, RML1-9.55: a line that has a corner of the travel alone in common leads nowhere, and
// a height that the tool has is no motion, nor anything else.
TEST(WaysSides, WaysThatLeadNowhere) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers(profile);
  ActionQueue queue;
  Carriage carriage(profile);
  const Carriage::Context context{profile, registers, queue};
  carriage.Place({5000, 5000, 0, 0});
  carriage.MoveXY(context, -1000, 5000);
  carriage.MoveXY(context, -1000, 1000);
  EXPECT_EQ(carriage.physical().y, 5000.0);
  while (!queue.empty()) queue.Pop();
  carriage.MoveXY(context, 1000, -1000);  // over (0, 0)
  EXPECT_EQ(carriage.physical().y, 5000.0);
  EXPECT_EQ(carriage.logical().x, 1000.0);
  EXPECT_TRUE(queue.empty());

  const auto heights = [](const std::string& between) {
    TestRun run(ParametersOf("t1"), "!MC0;PU21000,0;" + between + "PU21000,1000,19000,1000;");
    run.AdvanceToEnd();
    std::vector<double> found;
    for (const machine::MoveDone& move : run.seen().moves())
      found.push_back(move.program_point.z());
    return found;
  };
  EXPECT_EQ(heights("!ZM-1500;"), heights(""));
  EXPECT_NE(heights("!ZM-1501;"), heights(""));
}

// RML1-9.23: a tool that goes down beyond the travel does not cut as deep as Z1 says.
TEST(WaysSides, TheDepthThatIsLostBeyondTheTravel) {
  const WayDevice fed("!PZ-300,200;PU21000,100;PD;", false);
  EXPECT_NEAR(fed->carriage().lost().length, 300.0, 1e-9);
  EXPECT_NEAR(fed->carriage().lost().z.low, -2300.0, 1e-9);
  EXPECT_NEAR(fed->carriage().lost().z.high, -2000.0, 1e-9);
}

// cut_watch.h: down more than across, from wherever.
TEST(WaysSides, SteepWaysFromAnywhere) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers(profile);
  registers.surface_z = registers.z0 = 0.0;
  const auto told = [&](const Point& from, const Point& to) {
    CutWatch watch;
    const auto ride = [&](const Point& a, const Point& b, double speed) {
      watch.OnRide({.from = a,
                    .to = b,
                    .length_mm = DistanceXYZ(a, b),
                    .in_work = true,
                    .spindle_turns = true,
                    .speed_mm_s = speed,
                    .fastest_z_mm_s = 10.0},
                   registers, {.number = 1, .offset = 0, .op = Op::kCall});
    };
    ride(from, to, 9.0);
    ride(to, {to.x + 50.0, to.y, to.z}, 1.0);
    return watch.fast_plunge().mm;
  };
  EXPECT_NEAR(told({.x = 100, .y = 200}, {.x = 103, .y = 204, .z = -6}), std::sqrt(61.0), 1e-3);
  EXPECT_NEAR(told({.x = 100}, {.x = 96, .z = -5}), std::sqrt(41.0), 1e-3);
  EXPECT_NEAR(told({.y = 100}, {.y = 96, .z = -5}), std::sqrt(41.0), 1e-3);
  EXPECT_EQ(told({.x = 100, .y = 200}, {.x = 103, .y = 204, .z = -5}), 0.0);
  EXPECT_EQ(told({.x = -3, .y = -4}, {.x = 3, .y = 4, .z = -9}), 0.0);
}

// How much of a stream is no command: of all its bytes but those that the machine takes out.
TEST(WaysSides, TheShareOfForeignBytes) {
  const std::string plain = std::string(990, ';') + std::string(10, '$');
  const std::string with_sequences = "\x1b.I;\x1b.I;" + plain + "\x1b.I;";
  for (const bool at_once : {false, true}) {
    EXPECT_NEAR(WayDevice(plain, at_once)->foreign_percent(), 1.0, 1e-9) << at_once;
    EXPECT_NEAR(WayDevice("$$$$$$$", at_once)->foreign_percent(), 100.0 * 7.0 / 256.0, 1e-9);
    EXPECT_NEAR(WayDevice(with_sequences, at_once)->foreign_percent(),
                WayDevice(with_sequences, false)->foreign_percent(), 1e-9)
        << at_once;
  }
}

// A stream ends where it ends, whatever lies behind it in memory, and is the same in one go.
TEST(WaysSides, NothingBehindTheStreamIsRead) {
  const std::string stream =
      "DF;PA100,200,300,-400;M5,6;Z1,2,-3,4,5.5,-6;!ZZ7,8,-9;V12;DH;!PZ-50,+200;^PU 1 2;XQ;!ZEX5Y6:X7;"
      "PR;PD10,-20;@-12,34;PU.5,1.25;";
  for (std::size_t size = 1; size <= stream.size(); ++size) {
    const std::string alone = stream.substr(0, size);
    const std::string state = WayDevice(alone, false).State();
    for (const std::string behind :
         {"00000000000000000000", "U1,2;AF;Z9,9,9;;;;;;;", "             ", ".5,6.25;7;;;;;;;;;;;;",
          "-,+;ZH;!ZMZE;;;;;;;;;"}) {
      const std::string longer = alone + behind;
      ASSERT_EQ(WayDevice(std::string_view(longer).substr(0, size), true).State(), state)
          << alone << " before " << behind;
    }
  }
}

// Nor is it where many blanks stand before the numbers, so that the last of them ends the stream.
TEST(WaysSides, NothingBehindBlanksIsRead) {
  const std::string blanks(28, ' ');
  for (const std::string& stream : {"PU" + blanks + "1,2", "Z" + blanks + "3,4,5"}) {
    for (std::size_t size = 1; size <= stream.size(); ++size) {
      const std::string alone = stream.substr(0, size);
      const std::string state = WayDevice(alone, false).State();
      for (const std::string behind : {"000000000000", ",5,6,7;;;;;;", ";;;;;;;;;;;;"}) {
        const std::string longer = alone + behind;
        ASSERT_EQ(WayDevice(std::string_view(longer).substr(0, size), true).State(), state)
            << alone << " before " << behind;
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::rml1
