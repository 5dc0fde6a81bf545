// What streams say beside the plain case: whole spans with stray separators, places of numbers that
// are refused, work beyond the travel on both sides of the surface, travel at the clamps.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// A device that is given a stream byte by byte or as a whole.
class SidesDevice final : public DeviceListener {
 public:
  explicit SidesDevice(std::string_view profile_id)
      : profile_(MakeProfile(ParametersOf(profile_id)).value()), device_(profile_) {}

  void ByteByByte(std::string_view stream) {
    for (std::size_t at = 0; at < stream.size(); ++at) {
      device_.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at), *this);
      Work();
    }
  }
  void Whole(std::string_view stream) {
    for (std::size_t at = 0; at < stream.size();) {
      at += device_
                .Read(stream.substr(at), static_cast<std::int64_t>(at), Device::kAnyCommands, *this)
                .bytes;
      Work();
    }
  }
  void OnFinding(const Finding& finding) override { findings.push_back(finding); }
  void OnReading(const Reading& reading, const CommandReader& reader, std::int64_t) override {
    if (reading.kind == Reading::Kind::kAxisValue) axis_numbers.push_back(reader.number_offset());
  }
  const Device& operator*() const { return device_; }
  const Device* operator->() const { return &device_; }

  std::vector<Finding> findings;
  std::vector<std::int64_t> axis_numbers;

 private:
  void Work() {
    do {
      while (!device_.actions().empty()) device_.actions().Pop();
    } while (device_.Step(*this));
  }

  Profile profile_;
  Device device_;
};

struct Separated {
  const char* stream;
  double x;
  double y;
  std::size_t findings;
};

// rml1.md 0.4 rule 1: blanks as many as one likes and one comma part two numbers; in front of the
// first one and behind another one a comma ends the list, and what follows is no command. Enough
// stands behind each for it to be read at once.
TEST(StreamSeparators, OneCommaPartsTwoNumbers) {
  const std::string behind(40, ';');
  for (const Separated& one :
       {Separated{"PU  100 200", 100, 200, 0}, Separated{"PU   100  200", 100, 200, 0},
        Separated{"PU 100 200 300 400", 300, 400, 0}, Separated{"PU 123 456", 123, 456, 0},
        Separated{"Z 12 34 -5", 12, 34, 0}, Separated{"PU100 ,200 , 300,400", 300, 400, 0},
        Separated{"PU100,200  300\t,\t400", 300, 400, 0}, Separated{"PU,100,200", 0, 0, 4},
        Separated{"PU ,100,200", 0, 0, 4}, Separated{"PU100,200,,300,400", 100, 200, 4},
        Separated{"PU100,200, ,300,400", 100, 200, 4}, Separated{"PU100,,200", 0, 0, 2},
        Separated{"PU100 , , 200", 0, 0, 2}, Separated{"Z100,200,-3  400,500,-6", 400, 500, 0},
        Separated{"Z,100,200,-3", 0, 0, 6}, Separated{"PU100-200", 0, 0, 5},
        Separated{"PU 100-200,300", 0, 0, 9}, Separated{"Z1 2-3", 0, 0, 3}}) {
    SidesDevice bytes("t1");
    bytes.ByteByByte(one.stream + behind);
    SidesDevice whole("t1");
    whole.Whole(one.stream + behind);
    for (const SidesDevice* device : {&bytes, &whole}) {
      EXPECT_EQ((*device)->carriage().logical().x, one.x) << one.stream;
      EXPECT_EQ((*device)->carriage().logical().y, one.y) << one.stream;
    }
    EXPECT_EQ(whole.findings.size(), bytes.findings.size()) << one.stream;
    EXPECT_EQ(bytes.findings.empty(), one.findings == 0) << one.stream;
  }
}

// RML1-2.34: a number out of the range drops what is left of its list, but no list behind it.
TEST(StreamSeparators, ANumberOutOfRangeDropsItsList) {
  const std::string behind(40, ';');
  for (const char* stream : {"PU99999999,100,200,300,400,500", "PU99999999,100,200,300",
                             "PU99999999,100,200", "Z99999999,1,2,3,4,5,6"}) {
    for (const bool at_once : {false, true}) {
      SidesDevice device("t1");
      const auto feed = [&](const std::string& text) {
        at_once ? device.Whole(text) : device.ByteByByte(text);
      };
      feed(stream + behind);
      EXPECT_EQ(device->carriage().logical().x, 0.0) << stream;
      EXPECT_EQ(device->carriage().logical().y, 0.0) << stream;
      EXPECT_EQ(device->positions_refused(), 1U) << stream;
      feed("PU7,8" + behind);
      EXPECT_EQ(device->carriage().logical().x, 7.0) << stream;
      EXPECT_EQ(device->carriage().logical().y, 8.0) << stream;
    }
  }
}

// A number of !ZE stands where it begins, each by itself.
TEST(StreamSeparators, PlacesOfAxisNumbers) {
  SidesDevice device("t1a");
  device.ByteByByte("PU1,2;!ZE X1 Y-23:A4;");
  EXPECT_EQ(device.axis_numbers, (std::vector<std::int64_t>{11, 14, 19}));
}

// Heights of whole units have a common part; one of half a unit has none with them.
TEST(ProgrammedSides, PartsOfAUnitHaveNoGrain) {
  const auto grain = [](const std::string& stream) {
    SidesDevice device("t1");
    device.ByteByByte(stream);
    return device->programmed().z_grain();
  };
  EXPECT_EQ(grain("Z1,1,-50;Z2,2,-150;Z3,3,-100;"), 50U);
  EXPECT_EQ(grain("Z1,1,-50;Z2,2,-150.5;Z3,3,-100;"), 1U);
  EXPECT_EQ(grain("Z1,1,-50.5;Z2,2,-150;Z3,3,-100;"), 1U);
}

// Beyond X 200 mm with the surface at -200: of an oblique way down and one up again, 500 each from
// Z -100 to -500, three quarters lie below it.
TEST(CarriageSides, WorkIsLostBelowTheSurfaceOnly) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers(profile);
  registers.surface_z = -200.0;
  ActionQueue queue;
  Carriage carriage(profile);
  const auto go = [&](const Point& to) {
    carriage.MoveXYZ({profile, registers, queue}, to);
    while (!queue.empty()) queue.Pop();
  };
  go({20'100, 50, -100});
  EXPECT_EQ(carriage.lost().length, 0.0);
  go({20'100, 350, -500});
  EXPECT_NEAR(carriage.lost().length, 375.0, 1e-6);
  EXPECT_NEAR(carriage.lost().y.low, 125.0, 1e-6);
  EXPECT_NEAR(carriage.lost().y.high, 350.0, 1e-6);
  EXPECT_NEAR(carriage.lost().z.low, -500.0, 1e-6);
  EXPECT_NEAR(carriage.lost().z.high, -200.0, 1e-6);
  go({20'100, 650, -100});
  EXPECT_NEAR(carriage.lost().length, 750.0, 1e-6);
  EXPECT_NEAR(carriage.lost().y.high, 575.0, 1e-6);
  EXPECT_NEAR(carriage.lost().z.high, -200.0, 1e-6);
  EXPECT_EQ(carriage.lost().x_high, 100.0);
  EXPECT_EQ(carriage.lost().y_high, 0.0);
}

// At the height of the clamps, but for what rounding may take, is not below them.
TEST(CutWatchSides, TravelAtTheClampsIsNotBelowThem) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers(profile);
  registers.surface_z = registers.z0 = -7.0;
  constexpr double kSlack = Registers::kSameHeight;
  const auto below = [&](double from, double to) {
    CutWatch watch;
    CutWatch::Ride ride{.from = {.z = from}, .to = {.x = 10, .z = to}, .rapid = true};
    ride.length_mm = 10.0;
    ride.clamps_height = 3.0;
    watch.OnRide(ride, registers, {.number = 1, .offset = 0, .op = Op::kCall});
    return watch.below_clamps().mm;
  };
  EXPECT_EQ(below(-4.0, -4.0), 0.0);
  EXPECT_EQ(below(-4.0 - 0.25 * kSlack, -4.0 - 0.25 * kSlack), 0.0);
  EXPECT_NEAR(below(-4.0 - kSlack, -4.0 - kSlack), 10.0, 1e-9);
  EXPECT_NEAR(below(-3.0, -7.0), 7.5, 1e-4);
  EXPECT_NEAR(below(-6.0, -2.0), 5.0, 1e-4);
}

// Where the work fits as it is, nothing is said of a machine of another step.
TEST(FigureSides, NoOtherStepWhereTheWorkFits) {
  TestRun run(ParametersOf("t1"), "!PZ-50,200;PU100,100;PD500,100;PU0,0;");
  run.AdvanceToEnd();
  const Figures figures = run.figures();
  for (const char* name : {"step_fits_x", "step_fits_y", "step_fits_z"})
    EXPECT_FALSE(figures.contains(name)) << name << ' ' << figures.at(name);
}

}  // namespace
}  // namespace rmlcell::rml1
