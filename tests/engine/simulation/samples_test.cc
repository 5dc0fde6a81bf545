#include "engine/simulation/report/samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using Row = std::vector<std::string>;

// Lines, cut at commas.
std::vector<Row> Cut(const std::string& text) {
  std::vector<Row> rows(1, Row(1));
  for (const char c : text) {
    if (c == '\n') {
      rows.emplace_back(1);
    } else if (c == ',') {
      rows.back().emplace_back();
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

// Lines of a run, cut at commas; the headings first.
std::vector<Row> Sampled(const Script& script, double rate_hz,
                         const machine::MachineShape& shape = {}) {
  std::string text;
  SampleRecorder recorder(shape, rate_hz, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  return Cut(text);
}

double Number(const Row& row, std::size_t column) { return *ParseDouble(row[column]); }

TEST(Samples, RateHasLimits) {
  EXPECT_EQ(*ParseSampleRate("1000"), 1000.0);
  EXPECT_EQ(*ParseSampleRate("1"), 1.0);
  EXPECT_EQ(*ParseSampleRate("10000"), 10000.0);
  for (const char* wrong : {"0.5", "10001", "", "fast", "nan"}) {
    const auto refused = ParseSampleRate(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, ErrorCode::kCellUsage);
    EXPECT_EQ(refused.error().detail, "'" + std::string(wrong) + "': samples a second, 1 to 10000");
  }
}

// motion.md 12, S01: 100 mm at 50 mm/s take 2.0707 s; after the ramp of 0.0707 s the place is 50
// mm/s times the time less half of the ramp.
TEST(Samples, LineAtEvenTimes) {
  Script script;
  script.Step(7, 3).Line({0, 0, 0}, {100, 0, 0});
  const std::vector<Row> rows = Sampled(script, 10.0);
  EXPECT_EQ(rows[0][0], "t_s");
  ASSERT_EQ(rows.size(), 1u + 21u + 1u);  // 0.0 to 2.0, and the end
  const double ramp = 2.0 * std::sqrt(50.0 / 40000.0);
  EXPECT_EQ(rows[1][0], "0.000000000");
  EXPECT_EQ(Number(rows[1], 1), 0.0);
  EXPECT_EQ(rows[11][0], "1.000000000");
  EXPECT_NEAR(Number(rows[11], 1), 50.0 * (1.0 - 0.5 * ramp), 1e-6);
  EXPECT_NEAR(Number(rows[11], 6), 50.0 * (1.0 - 0.5 * ramp), 1e-6);
  EXPECT_EQ(rows[11][9], "50.000000");
  EXPECT_EQ(rows[11][11], "7");
  EXPECT_EQ(rows[11][12], "3");
  EXPECT_EQ(rows[22][13], "end");
  EXPECT_EQ(Number(rows[22], 1), 100.0);
  EXPECT_EQ(Number(rows[22], 9), 0.0);
}

// C01: through a corner at 50 mm/s: no sample between the ramps is slower, wherever motions meet.
TEST(Samples, CornerIsPassedWithoutADip) {
  Script script;
  script.Step(1, 1);
  for (const motion::PlannedMotion& each :
       PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}})) {
    script.Motion(each);
  }
  const std::vector<Row> rows = Sampled(script, 10'000.0);
  for (std::size_t k = 1001; k < 39'000; ++k) ASSERT_NEAR(Number(rows[k], 9), 50.0, 1e-5) << k;
}

// A third of a second is no number of nanoseconds: the thousandth sample is still at 1000 / 3.
TEST(Samples, TimesAreNotAddedUp) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {1, 0, 0}).Wait(machine::WaitKind::kDwell, 400.0);
  const std::vector<Row> rows = Sampled(script, 3.0);
  EXPECT_EQ(rows[1001][0], FixedText(1000.0 / 3.0, 9));
}

// motion.md 8.1: standing with the beam on at 50 %, then off; an output in between has a line of
// its own.
TEST(Samples, WaitsAndEventsHaveTheirLines) {
  Script script;
  script.Step(1, 1)
      .Line({0, 0, 0}, {1, 2, 3})
      .Wait(machine::WaitKind::kPierce, 1.0, true, 50.0)
      .Signal(machine::Signal::kOutput, 1.0, 0.0, 16)
      .Nothing(1.0);
  const std::vector<Row> rows = Sampled(script, 4.0);
  int at_fifty = 0;
  int events = 0;
  for (const Row& row : rows) {
    if (row[10] == "50.0000" && row[13].empty()) ++at_fifty;
    if (row[13] == "output 16 = 1") {
      ++events;
      EXPECT_EQ(Number(row, 3), 3.0);
    }
  }
  EXPECT_EQ(at_fifty, 4);
  EXPECT_EQ(events, 1);
  EXPECT_EQ(rows.back()[10], "0.0000");
}

// motion.md 8.1: what nobody tells about before a wait is no part of it: the beam is off, and the
// step is the one before.
TEST(Samples, TimeBeforeAWaitIsNotTheWaits) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {1, 0, 0}).Nothing(1.0);
  script.Step(1, 2).Wait(machine::WaitKind::kPierce, 1.0, true, 50.0);
  int dark = 0, bright = 0;
  for (const Row& row : Sampled(script, 10.0)) {
    if (row[12] == "2" && row[10] == "50.0000") ++bright;
    if (row[12] != "1") continue;
    EXPECT_EQ(row[10], "0.0000");
    ++dark;
  }
  EXPECT_EQ(bright, 10);
  EXPECT_GE(dark, 10);
}

// motion.md 8.1, P = clamp(constant + slope * v, 0, 100): a second up to 10 mm/s and another one
// down, so that each quarter of a second is 2.5 mm/s.
TEST(Samples, PowerGoesWithTheSpeed) {
  const auto powers = [](const MotionOptions& options) {
    Script script;
    script.Step(1, 1).Motion(
        Planned(LineFrom({}, {10, 0, 0}), {.speed = 10.0, .acceleration = 10.0}), options);
    std::vector<double> seen;
    const std::vector<Row> rows = Sampled(script, 4.0);
    for (std::size_t n = 1; n < rows.size(); ++n)
      seen.push_back(std::round(1000.0 * Number(rows[n], 10)) / 1000.0);
    return seen;
  };
  const machine::PowerBySpeed rising{.constant_percent = 40.0, .percent_per_mm_s = 10.0};
  EXPECT_EQ(powers({.beam_on = true, .power = rising}),
            (std::vector<double>{40, 65, 90, 100, 100, 100, 90, 65, 0}));
  const machine::PowerBySpeed falling{.constant_percent = 30.0, .percent_per_mm_s = -10.0};
  EXPECT_EQ(powers({.beam_on = true, .power = falling}),
            (std::vector<double>{30, 5, 0, 0, 0, 0, 0, 5, 0}));
  EXPECT_EQ(powers({.power = rising}), std::vector<double>(9, 0.0));
}

// And so before a motion: the beam is off until it begins, whatever was before.
TEST(Samples, TimeBeforeAMotionIsNotTheMotions) {
  for (const bool bright : {false, true}) {
    Script script;
    script.Step(1, 1).Line({0, 0, 0}, {1, 0, 0});
    if (bright) script.Wait(machine::WaitKind::kPierce, 1.0, true, 50.0);
    script.Step(1, 2).Nothing(1.0);
    script.Step(1, 3).Line({1, 0, 0}, {2, 0, 0});
    int dark = 0, lit = 0;
    for (const Row& row : Sampled(script, 10.0)) {
      if (row[12] != "1") continue;
      ++(row[10] == "50.0000" ? lit : dark);
      EXPECT_TRUE(row[10] == "50.0000" || row[10] == "0.0000") << row[10];
    }
    EXPECT_EQ(lit, bright ? 10 : 0);
    EXPECT_GE(dark, 10);
  }
}

// motion.md 9: an event has the place of its own, and the lines before it keep theirs; a halt is
// one.
TEST(Samples, EventsHaveTheirOwnPlace) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {1, 0, 0}).Nothing(1.0);
  script.Step(1, 2).Signal(machine::Signal::kSpindle, 1.0, 4500.0).Nothing(1.0);
  script.Step(1, 3).Halt("!NR");
  std::vector<std::string> steps;  // of each event, with that of the line before it
  Row before;
  for (const Row& row : Sampled(script, 10.0)) {
    if (!row[13].empty() && row[13] != "event") {
      steps.push_back(before[12] + " " + row[12] + " " + row[13]);
    }
    before = row;
  }
  EXPECT_EQ(steps, (std::vector<std::string>{"1 2 spindle = 1", "2 3 halt", "3 3 end"}));
}

// motion.md 9: where the machine stands is known from the start on: what is told before the first
// motion has its lines, with the place, the power of the beam, and the events.
TEST(Samples, BeginBeforeTheFirstMotion) {
  std::string text;
  SampleRecorder recorder({}, 2.0, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  recorder.StandsAt({{1, 2, 3}, 0.25, 0.0}, {});
  Script script;
  script.Step(1, 1).Wait(machine::WaitKind::kDwell, 1.0);
  script.Step(1, 2).Signal(machine::Signal::kBeam, 1.0, 100.0);
  script.Step(1, 3).Wait(machine::WaitKind::kDwell, 1.0, true, 100.0);
  script.Step(1, 4).Signal(machine::Signal::kBeam, 0.0);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  const std::vector<Row> rows = Cut(text);
  ASSERT_EQ(rows.size(), 1u + 4u + 3u);  // 0.0 to 1.5; two signals, the end
  std::vector<std::string> seen;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    seen.push_back(rows[n][0].substr(0, 3) + ' ' + rows[n][10] + ' ' + rows[n][13]);
    EXPECT_EQ(Number(rows[n], 1), 1.0);
    EXPECT_EQ(Number(rows[n], 2), 2.0);
    EXPECT_EQ(Number(rows[n], 3), 3.0);
    EXPECT_EQ(Number(rows[n], 4), 0.25);  // a mill's rotary axis
    EXPECT_EQ(Number(rows[n], 6), 1.0);
    EXPECT_EQ(Number(rows[n], 9), 0.0);
  }
  EXPECT_EQ(seen, (std::vector<std::string>{"0.0 0.0000 ", "0.5 0.0000 ", "1.0 0.0000 beam = 1",
                                            "1.0 100.0000 ", "1.5 100.0000 ",
                                            "2.0 100.0000 beam = 0", "2.0 0.0000 end"}));
}

// motion.md 9, 8.1: the same of a program without a motion: dwelling, then with the beam on.
TEST(Samples, OfAProgramWithoutAMotion) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(family.parameters())};
  machine::Translation made =
      family.Translate({.name = "test.S", .bytes = "DELAY 1\nWORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n"},
                       setup.parameters, {});
  ASSERT_TRUE(made.ok);
  setup.programs[1].object = machine::Bytes::Of(std::move(made.object));
  setup.main_program = 1;
  std::string text;
  SimulationRequest request;
  request.products.samples_hz = 2.0;
  request.products.samples = [&](std::string_view lines) {
    text += lines;
    return true;
  };
  ASSERT_TRUE(Simulate(family, std::move(setup), std::move(request)));
  std::vector<std::string> seen;
  for (const Row& row : Cut(text)) {
    if (row[0] == "t_s") continue;
    seen.push_back(row[0].substr(0, 3) + ' ' + row[10] + ' ' + row[12] + ' ' + row[13]);
    EXPECT_EQ(row[1], "21.020000");  // home, the tip 300 mm below the column
    EXPECT_EQ(row[3], "-50.000000");
    EXPECT_EQ(row[8], "-350.000000");
  }
  EXPECT_EQ(seen,
            (std::vector<std::string>{"0.0 0.0000 1 ", "0.5 0.0000 1 ", "1.0 0.0000 2 shutter = 1",
                                      "1.0 0.0000 2 beam = 1", "1.0 100.0000 3 ", "1.5 100.0000 3 ",
                                      "2.0 100.0000 4 beam = 0", "2.0 100.0000 4 shutter = 0",
                                      "2.0 0.0000 4 end"}));
}

// motion.md 9: of a five-axis machine the columns of the axes are those of the column.
TEST(Samples, StandStillAtTheColumn) {
  machine::MachineShape gantry;
  gantry.five_axis = true;
  std::string text;
  SampleRecorder recorder(gantry, 1.0, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  recorder.StandsAt({{1, 2, 3}, 0.25, 0.5}, {{4, 5, 6}, 0.25, 0.5});
  recorder.Finish(FromSeconds(0.5));
  const std::vector<Row> rows = Cut(text);
  ASSERT_EQ(rows.size(), 3u);
  for (const std::size_t n : {1u, 2u}) {
    const double expected[] = {4, 5, 6, 0.25, 0.5, 1, 2, 3};
    for (std::size_t column = 0; column < 8; ++column) {
      EXPECT_EQ(Number(rows[n], column + 1), expected[column]) << column;
    }
  }
  // To a nanometre and a nanoradian, the power to a ten thousandth of a percent.
  EXPECT_EQ(rows[1],
            (Row{"0.000000000", "4.000000", "5.000000", "6.000000", "0.250000000", "0.500000000",
                 "1.000000", "2.000000", "3.000000", "0.000000", "0.0000", "0", "0", ""}));
  EXPECT_EQ(rows[2][0], "0.500000000");
}

// motion.md 9: an event between two motions that pass into each other has the speed there.
TEST(Samples, EventsOnTheWayHaveTheirSpeed) {
  motion::Planner planner(motion::StandardMachine());
  motion::MoveCommand move;
  move.speed_fraction = 0.1;
  move.fly = true;
  move.path = motion::PathPiece::Line({}, {{100, 0, 0}});
  ASSERT_TRUE(planner.Append(move));
  move.path = motion::PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  ASSERT_TRUE(planner.Append(move));
  planner.Stop();
  Script script;
  script.Step(1, 1);
  int motions = 0;
  while (const auto item = planner.Next()) {
    if (++motions == 3) script.Signal(machine::Signal::kOutput, 1.0, 0.0, 16);
    script.Motion(std::get<motion::PlannedMotion>(*item));
  }
  int events = 0;
  for (const Row& row : Sampled(script, 10.0)) {
    if (row[13] != "output 16 = 1") continue;
    ++events;
    EXPECT_NEAR(Number(row, 9), 50.0, 1e-6);
  }
  EXPECT_EQ(events, 1);
}

// motion.md 9: until the first motion begins the machine stands where that does, though it begins
// at its speed.
TEST(Samples, BeforeTheFirstMotionItStands) {
  motion::PlannedMotion steady;
  steady.path = motion::PathPiece::Line({{3, 4, 5}}, {{103, 4, 5}});
  steady.speed = motion::SpeedProfile::Steady(100.0, 50.0);
  Script script;
  script.Step(1, 1).Nothing(0.5).Motion(steady);
  const std::vector<Row> rows = Sampled(script, 10.0);
  ASSERT_GT(rows.size(), 7u);
  for (std::size_t n = 1; n <= 5; ++n) {  // 0.0 to 0.4
    EXPECT_EQ(Number(rows[n], 1), 3.0) << n;
    EXPECT_EQ(Number(rows[n], 9), 0.0) << n;
  }
  EXPECT_NEAR(Number(rows[7], 9), 50.0, 1e-6);
}

// The head of the gantry: axes and tip are different points; K03 has L = 300 along u.
TEST(Samples, AxesOfTheGantryAreThoseOfTheColumn) {
  machine::MachineShape gantry;
  gantry.five_axis = true;
  Script script;
  const auto path =
      motion::PathPiece::Line({{0, 0, 0}, 0.0, 0.5 * kPi}, {{10, 0, 0}, 0.0, 0.5 * kPi});
  script.Step(1, 1).Motion(Planned(path));
  const std::vector<Row> rows = Sampled(script, 1.0, gantry);
  // u(0, pi/2) = (0, -1, 0): motion.md 2.1.
  EXPECT_NEAR(Number(rows.back(), 1), 10.0, 1e-6);
  EXPECT_NEAR(Number(rows.back(), 2), -300.0, 1e-6);
  EXPECT_NEAR(Number(rows.back(), 7), 0.0, 1e-6);
  EXPECT_NEAR(Number(rows.back(), 5), 0.5 * kPi, 1e-9);
}

TEST(Samples, EndsWhenTheSinkTakesNoMore) {
  int calls = 0;
  SampleRecorder recorder({}, 10'000.0, [&](std::string_view) { return ++calls < 2; });
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {100, 0, 0}).Wait(machine::WaitKind::kDwell, 100.0);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  const std::uint64_t lines = recorder.lines();
  recorder.Finish(run.state().time);
  EXPECT_EQ(recorder.lines(), lines);  // its end has none any more
  EXPECT_EQ(calls, 2);
  EXPECT_FALSE(recorder.complete());
}

// motion.md 9: lines begin when the first position is known, whatever is told before it.
TEST(Samples, BeginWhereThePlaceIsKnown) {
  std::string text;
  SampleRecorder recorder({}, 10.0, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  recorder.OnWait({.end = FromSeconds(1.0)});
  recorder.OnSignal({.at = FromSeconds(1.0), .signal = machine::Signal::kShutter, .value = 1.0});
  recorder.OnMotion({.start = FromSeconds(1.0), .end = FromSeconds(2.0)});  // of nothing
  EXPECT_EQ(recorder.lines(), 0u);
  recorder.Finish(FromSeconds(2.0));
  EXPECT_EQ(Cut(text).size(), 1u);  // the headings
}

// Whole lines are handed out together, as soon as they are 64 KiB.
TEST(Samples, LinesAreHandedOutInBlocks) {
  std::vector<std::string> blocks;
  SampleRecorder recorder({}, 1000.0, [&](std::string_view lines) {
    blocks.emplace_back(lines);
    return true;
  });
  recorder.StandsAt({{1, 2, 3}, 0.25, 0.0}, {});
  recorder.Finish(FromSeconds(3.0));
  ASSERT_GE(blocks.size(), 3u);  // 3001 lines of some 100 bytes
  for (std::size_t k = 0; k + 1 < blocks.size(); ++k) {
    EXPECT_TRUE(blocks[k].ends_with('\n'));
    EXPECT_GE(blocks[k].size(), 65'536u);
    EXPECT_LT(blocks[k].size(), 65'536u + 200u);
  }
}

}  // namespace
}  // namespace rmlcell::simulation
