#include "engine/simulation/picture/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "engine/simulation/picture/plot_page.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

struct Drawn {
  std::string svg;
  SimTime duration{0};
};
Drawn Draw(const Script& script, const machine::MachineShape& shape, const std::string& curves) {
  PlotRecorder recorder(shape);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  RunReport report;
  report.title = "part";
  report.cycle_time = run.state().time;
  const auto parsed = ParsePlotCurves(curves);
  EXPECT_TRUE(parsed);
  return {recorder.Svg(report, {.curves = *parsed}), report.cycle_time};
}

// A long name ends before the time of the cycle begins, on the narrowest page too; the document has
// all of it.
TEST(Plot, ALongNameDoesNotRunIntoTheTime) {
  PlotRecorder recorder(Laser());
  RunReport report;
  report.title = std::string(90, 'W') + ".S";
  report.cycle_time = std::chrono::seconds(3723);
  for (const int width : {640, 1200, 4000}) {
    const std::string svg = recorder.Svg(report, {.width_px = width});
    EXPECT_NE(svg.find("<title>" + report.title + "</title>"), std::string::npos) << width;
    const std::size_t shown = svg.find(">WWW", svg.find("</title>"));
    ASSERT_NE(shown, std::string::npos) << width;
    const std::string text = svg.substr(shown + 1, svg.find('<', shown) - shown - 1);
    // W is 0.944 wide, at 24 px, in the widest font and bold: 27.911 px.
    const double w_px = 0.944 * 24.0 * 1.12 * 1.1;
    const auto letters = static_cast<double>(std::ranges::count(text, 'W'));
    const double room = width - 2 * 36.0 - 24.0;
    if (width < 4000) {
      EXPECT_TRUE(text.ends_with("…")) << text;
      EXPECT_LT(letters * w_px, room);
      EXPECT_GT(letters * w_px, 0.5 * room);  // and no shorter than it must
    } else {
      EXPECT_EQ(text, report.title);  // 90 letters are 2512 px
    }
  }
}

// The corners of the nth curve of the picture, in pixels.
std::vector<ScreenPoint> Curve(const std::string& svg, int number) {
  std::size_t at = 0;
  for (int k = 0; k <= number; ++k) at = svg.find("<path d=\"", at + 1);
  EXPECT_NE(at, std::string::npos);
  const char* text = svg.c_str() + at + 9;
  std::vector<ScreenPoint> points;
  ScreenPoint here;
  char command = 'M';
  while (*text != '"') {
    if (std::isalpha(static_cast<unsigned char>(*text)) != 0) {
      command = *text++;
      continue;
    }
    if (*text == ' ' || *text == ',') {
      ++text;
      continue;
    }
    char* end = nullptr;
    const double first = std::strtod(text, &end);
    text = end;
    const bool pair = command == 'M' || command == 'm' || command == 'L' || command == 'l';
    double second = 0.0;
    if (pair) {
      while (*text == ' ' || *text == ',') ++text;
      second = std::strtod(text, &end);
      text = end;
    }
    switch (command) {
      case 'M':
      case 'L':
        here = {first, second};
        break;
      case 'm':
      case 'l':
        here = {here.x + first, here.y + second};
        break;
      case 'H':
        here.x = first;
        break;
      case 'h':
        here.x += first;
        break;
      case 'V':
        here.y = first;
        break;
      case 'v':
        here.y += first;
        break;
      default:
        ADD_FAILURE() << "unknown " << command;
        return points;
    }
    points.push_back(here);
  }
  return points;
}

// The height of a curve at a share of the time across the picture.
double HeightAt(const std::vector<ScreenPoint>& points, double share) {
  const double x = points.front().x + share * (points.back().x - points.front().x);
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (points[k].x < x) continue;
    const double part = (x - points[k - 1].x) / std::max(points[k].x - points[k - 1].x, 1e-9);
    return points[k - 1].y + part * (points[k].y - points[k - 1].y);
  }
  return points.back().y;
}

TEST(Plot, NamesOfCurves) {
  const auto curves = ParsePlotCurves("axes,speed");
  ASSERT_TRUE(curves);
  EXPECT_EQ(*curves, (std::vector{PlotCurve::kAxes, PlotCurve::kSpeed}));
  for (const char* wrong : {"", "speed,", "speed,speed", "torque", ",power"}) {
    const auto refused = ParsePlotCurves(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::kCellUsage);
  }
}

// motion.md 12, S01: 100 mm at 50 mm/s take 2.0707 s, with ramps of 0.0707 s. In the picture the
// speed curve stands at its top for all but the ramps, and the axis goes evenly from end to end.
TEST(Plot, SpeedAndPlaceOfALineAreWhereTheProfileHasThem) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {100, 0, 0}, {.programmed_mm_s = 50.0});
  machine::MachineShape mill;
  const Drawn drawn = Draw(script, mill, "speed,axes");
  EXPECT_EQ(XmlFault(drawn.svg), "");
  const std::vector<ScreenPoint> feed = Curve(drawn.svg, 0);
  const std::vector<ScreenPoint> speed = Curve(drawn.svg, 1);
  const std::vector<ScreenPoint> x = Curve(drawn.svg, 2);
  const double rest = speed.front().y;
  EXPECT_NEAR(speed.back().y, rest, 0.02);
  const double top = HeightAt(speed, 0.5);
  EXPECT_LT(top, rest - 100.0);
  EXPECT_NEAR(HeightAt(feed, 0.5), top, 0.02);  // it is reached
  // Half way through the first ramp, 0.0354 s of 2.0707 s, half of the speed is reached.
  EXPECT_NEAR(HeightAt(speed, 0.5 * std::sqrt(50.0 / 40000.0) * 2.0 / 2.070710678),
              0.5 * (rest + top), 1.5);
  EXPECT_NEAR(HeightAt(x, 0.5), 0.5 * (x.front().y + x.back().y), 0.1);
}

// motion.md 8.1: WORKDEF 1 (8, 75): 40 mm/s are 75 %, 20 mm/s 37.5 %; on a standing tip 0.
TEST(Plot, PowerFollowsTheSpeedAndIsOffWhenNothingHappens) {
  const motion::PathLimits limits{.speed = 20.0, .acceleration = 2000.0, .jerk = 40000.0};
  Script script;
  script.Step(1, 1)
      .Wait(machine::WaitKind::kPierce, 1.0, true, 50.0)
      .Motion(Planned(LineFrom({0, 0, 0}, {40, 0, 0}), limits),
              {.beam_on = true, .power = {.percent_per_mm_s = 75.0 / 40.0}})
      .Nothing(1.0);
  const Drawn drawn = Draw(script, Laser(), "power");
  const std::vector<ScreenPoint> power = Curve(drawn.svg, 0);
  const double whole = ToSeconds(drawn.duration);
  const double off = HeightAt(power, (whole - 0.5) / whole);
  const double pierce = HeightAt(power, 0.5 / whole);
  const double cut = HeightAt(power, 2.0 / whole);
  EXPECT_GT(off - pierce, 50.0);
  EXPECT_NEAR((off - cut) / (off - pierce), 37.5 / 50.0, 1e-3);
}

// C01: through a corner at 50 mm/s without a dip, although times are told in whole nanoseconds and
// the motions do not last a whole number of them.
TEST(Plot, SpeedDoesNotDipWhereMotionsMeet) {
  Script script;
  script.Step(1, 1);
  for (const motion::PlannedMotion& each :
       PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}})) {
    script.Motion(each);
  }
  const Drawn drawn = Draw(script, machine::MachineShape{}, "speed");
  const std::vector<ScreenPoint> speed = Curve(drawn.svg, 0);
  const double top = HeightAt(speed, 0.2);
  for (const ScreenPoint& point : speed) {
    const double share = (point.x - speed.front().x) / (speed.back().x - speed.front().x);
    if (share > 0.05 && share < 0.95) {
      EXPECT_NEAR(point.y, top, 0.05) << share;
    }
  }
}

// Motions from 1 s to 2 s and from 7 s to 8 s that begin and end at speed, with the beam on, and a
// wait with the beam on from 4 s to 5 s. In between nothing moves, nothing is asked for and the
// beam is off, at once and up to the end; before the first nothing is known.
TEST(Plot, NothingHappensBetweenWhatIsTold) {
  PlotRecorder recorder(Laser());
  const auto move = [&](double x, int from_s) {
    motion::PlannedMotion planned = Planned(LineFrom({x, 0, 0}, {x + 50, 0, 0}));
    planned.speed = motion::SpeedProfile::Steady(50.0, 50.0);
    recorder.OnMotion({.start = std::chrono::seconds(from_s),
                       .end = std::chrono::seconds(from_s + 1),
                       .motion = &planned,
                       .travelled = 50.0,
                       .programmed_mm_s = 60.0,
                       .beam_on = true,
                       .power = {.constant_percent = 80.0}});
  };
  move(100.0, 1);
  recorder.OnWait({.start = std::chrono::seconds(4),
                   .end = std::chrono::seconds(5),
                   .beam_on = true,
                   .power_percent = 40.0});
  // Told late, of a time that is known: nothing new.
  recorder.OnWait({.start = std::chrono::seconds(4), .end = std::chrono::milliseconds(4500)});
  move(150.0, 7);
  RunReport report;
  report.cycle_time = std::chrono::seconds(10);
  const std::string svg =
      recorder.Svg(report, {.curves = {PlotCurve::kSpeed, PlotCurve::kPower, PlotCurve::kAxes}});
  // Pixels above zero, or above the lowest of an axis.
  const auto heights = [&](int curve) {
    const std::vector<ScreenPoint> points = Curve(svg, curve);
    EXPECT_TRUE(std::ranges::is_sorted(points, {}, &ScreenPoint::x));  // time never goes back
    const double zero = std::ranges::max(points, {}, &ScreenPoint::y).y;
    std::vector<double> found;
    for (const double t : {1.01, 1.99, 2.01, 3.99, 4.01, 4.3, 4.99, 5.01, 6.99, 7.01, 7.99, 8.01})
      found.push_back(zero - HeightAt(points, (t - 1.0) / 9.0));
    return found;
  };
  const auto expect = [&](int curve, const std::vector<double>& wanted) {
    const std::vector<double> found = heights(curve);
    for (std::size_t k = 0; k < wanted.size(); ++k)
      EXPECT_NEAR(found[k], wanted[k], 0.6) << curve << " " << k;
  };
  // The greatest has a room of 4 % above it: 60 mm/s in a panel of 220 px, 100 % in one of 130 px.
  const double feed = 220.0 / 1.04, speed = feed * 50.0 / 60.0, power = 130.0 / 1.04;
  expect(0, {feed, feed, 0, 0, 0, 0, 0, 0, 0, feed, feed, 0});
  expect(1, {speed, speed, 0, 0, 0, 0, 0, 0, 0, speed, speed, 0});
  const double cut = 0.8 * power, pierce = 0.4 * power;
  expect(2, {cut, cut, 0, 0, pierce, pierce, pierce, 0, 0, cut, cut, 0});
  // 100 mm and 4 % on both sides in 96 px.
  const double half = 50.0 * 96.0 / 108.0;
  expect(3, {0, half, half, half, half, half, half, half, half, half, 2.0 * half, 2.0 * half});
}

// The axes stand where the first motion begins until it does, whatever is told before.
TEST(Plot, AxesStandAtTheirPlaceBeforeTheFirstMotion) {
  Script script;
  script.Step(1, 1)
      .Wait(machine::WaitKind::kDwell, 2.0, false, 0.0)
      .Nothing(1.0)
      .Line({100, 200, 0}, {150, 200, 0})
      .Nothing(1.0);
  for (const bool five_axis : {false, true}) {
    machine::MachineShape shape;
    shape.five_axis = five_axis;
    const std::string svg = Draw(script, shape, "axes").svg;
    EXPECT_EQ(CountOf(svg, ">X<"), 1u);
    for (const char* still : {">Y<", ">Z<", ">A<", ">B<"})
      EXPECT_EQ(CountOf(svg, still), 0u) << still;
    const std::vector<ScreenPoint> x = Curve(svg, 0);
    EXPECT_NEAR(HeightAt(x, 0.1), x.front().y, 0.01);
    EXPECT_NEAR(x.front().y - x.back().y, 96.0 / 1.08, 0.1);  // 50 mm, with 4 % on both sides
  }
}

// motion.md 8.1: from 0 to 100 %, and nothing with the beam off.
TEST(Plot, PowerIsBetween0And100Percent) {
  const auto power_at = [](double percent, bool beam_on) {
    Script script;
    script.Step(1, 1)
        .Wait(machine::WaitKind::kPierce, 1.0, true, 50.0)
        .Motion(Planned(LineFrom({0, 0, 0}, {50, 0, 0})),
                {.beam_on = beam_on, .power = {.constant_percent = percent}})
        .Nothing(1.0);
    const Drawn drawn = Draw(script, Laser(), "power");
    const std::vector<ScreenPoint> power = Curve(drawn.svg, 0);
    const double off = power.back().y, whole = ToSeconds(drawn.duration);
    return 50.0 * (off - HeightAt(power, 1.5 / whole)) / (off - HeightAt(power, 0.5 / whole));
  };
  EXPECT_NEAR(power_at(150.0, true), 100.0, 0.1);
  EXPECT_NEAR(power_at(99.0, true), 99.0, 0.1);
  EXPECT_NEAR(power_at(0.5, true), 0.5, 0.1);
  EXPECT_NEAR(power_at(-10.0, true), 0.0, 0.1);
  EXPECT_NEAR(power_at(80.0, false), 0.0, 0.1);
}

// Only what moved has a panel, and a mill has no beam.
TEST(Plot, LeavesOutWhatThereIsNot) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {0, 30, 0});
  const std::string svg = Draw(script, machine::MachineShape{}, "speed,power,axes").svg;
  EXPECT_NE(svg.find(">Y<"), std::string::npos);
  EXPECT_EQ(svg.find(">X<"), std::string::npos);
  EXPECT_EQ(svg.find(">power<"), std::string::npos);
  // Nobody asked for a speed of the tip.
  EXPECT_EQ(svg.find(">asked for<"), std::string::npos);
  EXPECT_EQ(XmlFault(Draw(Script(), machine::MachineShape{}, "axes").svg), "");
}

TEST(Plot, MarksHaltsAndErrorsButNoAdvice) {
  Script script;
  script.Step(1, 1)
      .Line({0, 0, 0}, {10, 0, 0})
      .Find(ErrorCode::kHoleRadiusZero, "radius is 0")
      .Line({10, 0, 0}, {0, 0, 0})
      .Halt("STOP <now>");
  const std::string svg = Draw(script, Laser(), "speed").svg;
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_NE(svg.find("OPT-E348"), std::string::npos);
  EXPECT_NE(svg.find("STOP &lt;now&gt;"), std::string::npos);
}

// Of a finding's weight tells its colour: warnings are no errors, advice and messages no marks.
TEST(Plot, MarksAreOfTheColourOfTheirWeight) {
  const std::string dashes = " stroke-width=\"1\" stroke-dasharray=\"2 3\"";
  struct Case {
    Severity severity;
    std::size_t warnings;
    std::size_t errors;
  };
  for (const Case& c : {Case{Severity::kAdvice, 0, 0}, Case{Severity::kMessage, 0, 0},
                        Case{Severity::kWarning, 1, 0}, Case{Severity::kProgram, 0, 1},
                        Case{Severity::kFatal, 0, 1}, Case{Severity::kAlarm, 0, 1}}) {
    Script script;
    script.Step(1, 1).Line({0, 0, 0}, {10, 0, 0});
    PlotRecorder recorder({});
    FakeRun run(script, recorder);
    run.Advance(kForever);
    recorder.OnDiagnostic(FromSeconds(0.005),
                          {.code = ErrorCode::kSpeedLimited, .severity = c.severity});
    RunReport report;
    report.cycle_time = run.state().time;
    const std::string svg = recorder.Svg(report, {.curves = {PlotCurve::kSpeed}});
    EXPECT_EQ(CountOf(svg, "stroke=\"#b4540a\"" + dashes), c.warnings)
        << static_cast<int>(c.severity);
    EXPECT_EQ(CountOf(svg, "stroke=\"#c92a2a\"" + dashes), c.errors)
        << static_cast<int>(c.severity);
  }
}

// Forty marks at most, of halts and findings together; advice is none.
TEST(Plot, MarksAreLimited) {
  for (const bool halts : {true, false}) {
    Script script;
    script.Step(1, 1).Line({0, 0, 0}, {10, 0, 0});
    PlotRecorder recorder({});
    FakeRun run(script, recorder);
    run.Advance(kForever);
    for (int k = 0; k < 41; ++k) {
      if (halts) {
        recorder.OnHalt({.at = FromSeconds(0.005 * k), .why = "PAUSE"});
      } else {
        recorder.OnDiagnostic(FromSeconds(0.005 * k),
                              {.code = ErrorCode::kSpeedLimited, .severity = Severity::kWarning});
      }
    }
    RunReport report;
    report.cycle_time = run.state().time;
    const std::string svg = recorder.Svg(report, {.curves = {PlotCurve::kSpeed}});
    EXPECT_EQ(CountOf(svg, "stroke-dasharray=\"2 3\""), 40u);
  }
}

// Neither narrower than 640 px nor wider than 8192.
TEST(Plot, WidthIsLimited) {
  for (const auto& [asked, made] : {std::pair{1, 640}, {641, 641}, {8191, 8191}, {9000, 8192}}) {
    const std::string svg = PlotRecorder({}).Svg({}, {.width_px = asked});
    EXPECT_EQ(CountOf(svg, "width=\"" + std::to_string(made) + "\" height="), 1u + 2u) << asked;
  }
}

// A hundred thousand short moves: the picture stays small.
TEST(Plot, IsOfBoundedSizeHoweverLongTheRun) {
  PlotRecorder recorder(Laser());
  const motion::PlannedMotion there = Planned(LineFrom({0, 0, 0}, {1, 0, 0}));
  const SimTime length = FromSeconds(there.duration_s());
  SimTime at{0};
  for (int k = 0; k < 100'000; ++k) {
    recorder.OnMotion({.start = at, .end = at + length, .motion = &there, .travelled = 1.0});
    at += length;
  }
  RunReport report;
  report.cycle_time = at;
  const std::string svg = recorder.Svg(report, {});
  EXPECT_LT(svg.size(), 600'000u);
  EXPECT_EQ(XmlFault(svg), "");
}

}  // namespace
}  // namespace rmlcell::simulation
