// Figures and registers of a run, each from what the program and the rules say.
#include "engine/rml1/figures.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// From rest to rest at 200 mm/s2, where the speed is reached.
double TimeFor(double length_mm, double speed_mm_s) {
  return length_mm / speed_mm_s + speed_mm_s / 200.0;
}

machine::Parameters WithSpindle(double up_s, double down_s) {
  machine::Parameters parameters = ParametersOf("t1");
  EXPECT_TRUE(parameters.Set("SPIN_UP", up_s).ok());
  EXPECT_TRUE(parameters.Set("SPIN_DOWN", down_s).ok());
  EXPECT_TRUE(parameters.Set("ORIGIN_X", 10.0).ok());
  EXPECT_TRUE(parameters.Set("ORIGIN_Y", 20.0).ok());
  return parameters;
}

// RML1-9.33, RML1-9.45, RML1-3A.56: times by tool state. The origin is 10, 20 mm; Z0 20 mm below
// the top: 15 mm down to Z2, 30 mm across, [0.1 s] 7 mm down to Z1, [0.1 s] 40 mm of cut.
TEST(Figures, OfTimesAndWays) {
  TestRun run(WithSpindle(2.0, 1.0), "@-2,500;@-200,500;VS20;V10;PU3000,0;W100;PD3000,4000;!MC0;");
  ASSERT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished);
  const Figures f = run.figures();
  const double up = 2.0 + TimeFor(15, 10) + TimeFor(30, 60);
  const double down = 0.1 + TimeFor(7, 10) + 0.1 + TimeFor(40, 20) + 1.0;
  EXPECT_EQ(f.at("commands"), 8);
  EXPECT_EQ(f.at("motions"), 4);
  EXPECT_EQ(f.at("plunges"), 1);
  EXPECT_NEAR(f.at("cut_length"), 7 + 40, 1e-9);
  EXPECT_NEAR(f.at("travel_length"), 15 + 30, 1e-9);
  EXPECT_NEAR(f.at("tool_up_time"), up, 1e-7);
  EXPECT_NEAR(f.at("tool_down_time"), down, 1e-7);
  EXPECT_NEAR(f.at("motion_time"), up + down - 3.0 - 0.2, 1e-7);
  EXPECT_NEAR(f.at("dwell_time"), 0.2, 1e-9);
  EXPECT_NEAR(f.at("spindle_time"), 3.0, 1e-9);
  EXPECT_EQ(f.at("halted_time"), 0.0);
  EXPECT_NEAR(run.time_s(), up + down, 1e-7);
}

// RML1-1.08, RML1-9.12: the box that the tool went through, from the work origin, in units and mm;
// with the place where it began. 40 units are one mm.
TEST(Figures, OfTheBox) {
  machine::Parameters parameters = ParametersOf("mdx-15");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 10.0).ok());
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 5.0).ok());
  TestRun run(parameters, "@-8,40;PU-80,0;PD-80,120;PU40,0;");
  run.AdvanceToEnd();
  const Figures f = run.figures();
  const std::pair<const char*, double> units[] = {{"xmin", -80}, {"xmax", 40}, {"ymin", 0},
                                                  {"ymax", 120}, {"zmin", -8}, {"zmax", 800}};
  for (const auto& [name, value] : units) {
    EXPECT_NEAR(f.at("box." + std::string(name)), value, 1e-9) << name;
    EXPECT_NEAR(f.at("box_mm." + std::string(name)), value / 40.0, 1e-9) << name;
  }
  EXPECT_FALSE(f.contains("box.amin"));
  TestRun still(parameters, "PA;");
  still.AdvanceToEnd();
  EXPECT_FALSE(still.figures().contains("box.xmin"));
  TestRun turns(ParametersOf("t1a"), "!ZE A30;!ZE A-40;");
  turns.AdvanceToEnd();
  EXPECT_EQ(turns.figures().at("box.amin"), -40.0);
  EXPECT_EQ(turns.figures().at("box.amax"), 30.0);
}

// The work of T1, X 10 to 30 and Y 20 to 25 mm from its origin and 1 mm deep, fits the 200 by 150
// mm and 60 mm of the travel with the origin from -10, -20 to 170, 125 mm, as far as that is on the
// table, and Z0 from -59 mm to 2 mm below the top, by its lift; wherever the origin stands now.
TEST(Figures, OfTheOriginThatTheWorkNeeds) {
  for (const double origin : {0.0, 30.0}) {
    machine::Parameters parameters = ParametersOf("t1");
    ASSERT_TRUE(parameters.Set("ORIGIN_X", origin).ok());
    ASSERT_TRUE(parameters.Set("ORIGIN_Y", 2.0 * origin).ok());
    TestRun run(parameters, "VS10;!VZ10;@-100,200;PU1000,2000;PD3000,2500;PU0,0;!MC0;");
    run.AdvanceToEnd();
    const Figures f = run.figures();
    EXPECT_EQ(f.at("origin.xmin"), 0.0);
    EXPECT_EQ(f.at("origin.xmax"), 170.0);
    EXPECT_EQ(f.at("origin.ymin"), 0.0);
    EXPECT_EQ(f.at("origin.ymax"), 125.0);
    EXPECT_EQ(f.at("origin.zmin"), -59.0);
    EXPECT_EQ(f.at("origin.zmax"), -2.0);
    EXPECT_EQ(f.at("oversize_x") + f.at("oversize_y") + f.at("oversize_z"), 0.0);
  }
}

// Work that fits from no place of the origin on the table has to move itself: X 150 to 210 mm on
// 200. Where it lies within the travel all the same, because the origin is beside the table,
// nothing is said.
TEST(Figures, OfWorkThatHasToMove) {
  const auto figures = [](double origin) {
    machine::Parameters parameters = ParametersOf("t1");
    EXPECT_TRUE(parameters.Set("ORIGIN_X", origin).ok());
    TestRun run(parameters, "VS10;!VZ10;@-100,200;PU15000,100;PD21000,100;PU;!MC0;");
    run.AdvanceToEnd();
    return run.figures();
  };
  const Figures lost = figures(0.0);
  EXPECT_NEAR(lost.at("move_x_less"), 10.0, 1e-9);
  EXPECT_FALSE(lost.contains("move_x_more"));
  EXPECT_FALSE(lost.contains("move_y_more"));
  EXPECT_FALSE(lost.contains("clipped_x_high"));
  EXPECT_FALSE(lost.contains("origin.xmin"));
  EXPECT_FALSE(figures(-100.0).contains("move_x_less"));
}

// Waits count as up with the tool at the surface, and as down below it, by however little. T1: 20
// mm down to Z0.
TEST(Figures, OfWaitsAtTheSurface) {
  const auto down = [](const std::string& z) {
    TestRun run(WithSpindle(2.0, 1.0), "!RC0;V10;Z0,0," + z + ";W100;Z100,0," + z + ";!MC0;");
    run.AdvanceToEnd();
    return run.figures().at("tool_down_time");
  };
  EXPECT_EQ(down("0"), 0.0);
  EXPECT_NEAR(down("-0.5"), TimeFor(20.005, 10) + 0.1 + TimeFor(1, 10) + 1.0, 1e-7);
}

// RML1-6.04, RML1-4.21, RML1-3A.46: registers and counts of errors and advice.
TEST(Figures, OfErrors) {
  TestRun run(ParametersOf("t1"), "F99;V0;XX;5;6;W-1;W-1;W-1;\x1b.k\x1b.j;");
  run.AdvanceToEnd();
  const Figures f = run.figures();
  EXPECT_EQ(f.at("speed_clamps"), 2);
  EXPECT_EQ(f.at("error_register"), 1);
  EXPECT_EQ(f.at("errors"), 7);
  EXPECT_EQ(f.at("errors.1"), 2);  // kj, which the sequences let through (RML1-4.05), is no name
  EXPECT_EQ(f.at("errors.2"), 2);
  EXPECT_EQ(f.at("errors.3"), 3);
  EXPECT_EQ(f.at("errors.cut"), 0);
  EXPECT_EQ(f.at("communication_register"), 11);
  EXPECT_EQ(f.at("communication_errors"), 2);
  EXPECT_EQ(f.at("communication_errors.11"), 2);
  EXPECT_FALSE(f.contains("communication_errors.12"));
  EXPECT_EQ(f.at("communication_errors.cut"), 0);
}

// RML1-6.10: a log that was cut says so.
TEST(Figures, OfACutLog) {
  const machine::CheckOptions options{.forced = true};
  const auto translation = Rml1Family().Translate({.name = "a", .bytes = std::string(100'001, '5')},
                                                  ParametersOf("t1"), options);
  EXPECT_EQ(ByName(translation.figures).at("errors.cut"), 1);
  EXPECT_EQ(ByName(translation.figures).at("errors"), 100'001);
  EXPECT_EQ(ByName(translation.figures).at("object_bytes"), 100'001);
}

// A check carries out the same motions at once: RML1-9.45.
TEST(Figures, OfACheckAreThoseOfTheRun) {
  const std::string stream = "@-100,300;PU1000,500;PD2000,500;Z0,0,-200,25000,0,-200;H;";
  const auto translation =
      Rml1Family().Translate({.name = "a", .bytes = stream}, ParametersOf("t1"), {});
  const Figures checked = ByName(translation.figures);
  TestRun run(ParametersOf("t1"), stream);
  run.AdvanceToEnd();
  for (const char* name : {"motions", "cut_length", "travel_length", "plunges", "box.xmax",
                           "box.zmin", "clipped_length", "clipped_sets", "commands"}) {
    EXPECT_NEAR(checked.at(name), run.figures().at(name), 1e-9) << name;
  }
}

// What the program asks for, each command under its own name.
TEST(Figures, CountCommandsByName) {
  const std::pair<std::string, std::string> commands[] = {
      {"D", "D;"},     {"F", "F;"},     {"H", "H;"},     {"I", "I;"},     {"M", "M;"},
      {"R", "R;"},     {"V", "V;"},     {"W", "W;"},     {"Z", "Z;"},     {"@", "@;"},
      {"DF", "DF;"},   {"IN", "IN;"},   {"PA", "PA;"},   {"PD", "PD;"},   {"PR", "PR;"},
      {"PU", "PU;"},   {"VS", "VS;"},   {"!DW", "!DW;"}, {"!MC", "!MC;"}, {"!NR", "!NR;"},
      {"!PZ", "!PZ;"}, {"!RC", "!RC;"}, {"!VZ", "!VZ;"}, {"!ZM", "!ZM;"}, {"!ZO", "!ZO;"},
      {"!ZZ", "!ZZ;"}, {"!ZE", "!ZE;"}};
  for (const auto& [name, stream] : commands) {
    const auto translation =
        Rml1Family().Translate({.name = "a", .bytes = stream}, ParametersOf("t1"), {});
    Figures counts = ByName(translation.figures);
    std::erase_if(counts, [](const auto& f) { return !f.first.starts_with("programmed.count."); });
    EXPECT_EQ(counts, (Figures{{"programmed.count." + name, 1.0}}));
  }
}

// RML1-7.08, RML1-9.22: every register by its name, in work units.
TEST(Registers, AreReadByName) {
  machine::Parameters parameters = WithSpindle(0.0, 0.0);
  ASSERT_TRUE(parameters.Set("STEP", 0.05).ok());
  TestRun run(parameters, "!ZO-1000;@-7,40;VS7;V8;W9;!RC15;PR;PD18500,300;!ZE Z-1;XX;\x1b.k;");
  run.AdvanceToEnd();
  // Machine 195, 23 and -10.08 mm, in steps of 0.05 mm.
  const std::pair<const char*, const char*> registers[] = {
      {"X", "18500"},    {"Y", "300"},       {"Z", "-8"},   {"VS", "7"},        {"F", "7"},
      {"VZ", "8"},       {"V", "8"},         {"DW", "9"},   {"W", "9"},         {"MC", "on"},
      {"SPINDLE", "on"}, {"RPM", "15000"},   {"Z1", "-7"},  {"Z0", "-1000"},    {"Z2", "40"},
      {"MODE", "rel"},   {"TOOL", "down"},   {"ERR", "1"},  {"XSTEPS", "3900"}, {"COM", "11"},
      {"YSTEPS", "460"}, {"ZSTEPS", "-202"}, {"A", "none"}, {"ASTEPS", "none"}, {"Q", "none"}};
  for (const auto& [name, value] : registers) EXPECT_EQ(run.variable(name), value) << name;
  TestRun outside(parameters, "!MC0;PU25000,31000;");
  outside.AdvanceToEnd();
  EXPECT_EQ(outside.variable("LX"), "25000");
  EXPECT_EQ(outside.variable("LY"), "31000");
  EXPECT_EQ(outside.variable("LZ"), "500");
  EXPECT_EQ(outside.variable("MC"), "off");
  EXPECT_EQ(outside.variable("SPINDLE"), "off");
  EXPECT_EQ(outside.variable("MODE"), "abs");
  EXPECT_EQ(outside.variable("TOOL"), "up");
  TestRun turns(ParametersOf("t1a"), "!ZE A-0.126;");
  turns.AdvanceToEnd();
  EXPECT_EQ(turns.variable("A"), "-0.126");
  EXPECT_EQ(turns.variable("ASTEPS"), "-13");
  const machine::MachineFamily& family = Rml1Family();
  EXPECT_TRUE(family.HasVariable(parameters, "ZSTEPS"));
  EXPECT_FALSE(family.HasVariable(parameters, "A"));
  EXPECT_TRUE(family.HasVariable(ParametersOf("t1a"), "A"));
  EXPECT_TRUE(family.HasVariable(ParametersOf("t1a"), "ASTEPS"));
  EXPECT_FALSE(family.HasVariable(parameters, "Q"));
}

// RML1-3A.46: T1 cuts at 0.5 to 60 mm/s. Half of what was asked for is as far away as twice as
// much: told is the first of those, which is the place that is shown.
TEST(Figures, OfTwoLimitedSpeedsAsFarAwayTellTheFirst) {
  TestRun fast(ParametersOf("t1"), "@-100,200;V5;VS120;PD1000,0;VS0.25;PD1010,0;");
  fast.AdvanceToEnd();
  EXPECT_EQ(fast.figures().at("feed_limited_asked"), 120.0);
  EXPECT_EQ(fast.figures().at("feed_limited_used"), 60.0);
  EXPECT_NEAR(fast.figures().at("feed_limited_length"), 10.1, 1e-9);
  TestRun slow(ParametersOf("t1"), "@-100,200;V5;VS0.25;PD10,0;VS120;PD1010,0;");
  slow.AdvanceToEnd();
  EXPECT_EQ(slow.figures().at("feed_limited_asked"), 0.25);
  EXPECT_EQ(slow.figures().at("feed_limited_used"), 0.5);
}

// What a check says of time: 2 s of run-up, 15 mm down at 20 mm/s, a dwell of 0.5 s before each of
// 5 mm down at 20 and 10 mm across at 10 mm/s, and 1 s until the spindle stands. IN leads 5 mm up
// at the default of 2 mm/s, and nobody waits for the spindle (RML1-3B.03).
TEST(Figures, OfTheLeastTime) {
  const auto time = [](const std::string& end, const char* name) {
    const auto made = Rml1Family().Translate(
        {.name = "a", .bytes = "V20;VS10;PU;W500;PD1000,0;" + end}, WithSpindle(2.0, 1.0), {});
    return ByName(made.figures).at(name);
  };
  const double cut = 2.0 + 15.0 / 20.0 + 0.5 + 5.0 / 20.0 + 0.5 + 10.0 / 10.0;
  EXPECT_NEAR(time("!MC0;", "least_time"), cut + 1.0, 1e-9);
  EXPECT_NEAR(time("IN;", "least_time"), cut + 5.0 / 2.0, 1e-9);
  EXPECT_NEAR(time("!MC0;", "least_days"), (cut + 1.0) / 86'400.0, 1e-12);
}

// RML1-3C.08: how often a run waits for its key, and where it does first.
TEST(Figures, OfWaitsForTheKey) {
  const auto made =
      Rml1Family().Translate({.name = "a", .bytes = "PU;\n!NR;PD;\n!NR;"}, ParametersOf("t1"), {});
  int found = 0;
  for (const machine::Figure& figure : made.figures) {
    if (figure.name != "waits_for_key") continue;
    ++found;
    EXPECT_EQ(figure.value, 2.0);
    EXPECT_EQ(figure.first.step, 2);
    EXPECT_EQ(figure.first.byte_offset, 4);
    EXPECT_EQ(figure.first.line, 2);
    EXPECT_EQ(figure.first.program, 0);
  }
  EXPECT_EQ(found, 1);
}

// What never happened has no place. The tool draws along the surface and never goes below it: the
// length that it skims counts where it cuts elsewhere.
TEST(Figures, OfNothingHaveNoPlace) {
  TestRun run(ParametersOf("t1"), "PA;PU0,0;!MC1;Z0,0,0;Z100,0,0;");
  run.AdvanceToEnd();
  int found = 0;
  for (const machine::Figure& figure : run->figures()) {
    if (figure.value != 0.0) continue;
    found += figure.name == "skimmed_length" ? 1 : 0;
    EXPECT_EQ(figure.first, machine::Place{}) << figure.name;
  }
  EXPECT_EQ(found, 1);
}

// A tool that ends above the surface is not in the work at all.
TEST(Figures, OfAToolThatEndsAboveTheWork) {
  TestRun run(ParametersOf("t1"), "!MC0;V10;Z0,0,-100;Z0,0,100;");
  run.AdvanceToEnd();
  EXPECT_EQ(run.figures().at("depth_at_end"), 0.0);
}

// What is drawn with the spindle off is a stroke along the surface: neither travel above it nor a
// tool that only touches it.
TEST(Figures, OfAPenThatDrawsNothing) {
  const auto nothing_cut = [](const std::string& stream) {
    TestRun run(ParametersOf("t1"), stream);
    run.AdvanceToEnd();
    return run.figures().at("nothing_cut");
  };
  EXPECT_EQ(nothing_cut("!MC0;PU100,100;"), 1.0);
  EXPECT_EQ(nothing_cut("!MC0;PU100,100;PD;PU;"), 1.0);
  EXPECT_EQ(nothing_cut("!MC0;PU100,100;PD200,100;PU;"), 0.0);
}

// 10 mm along the surface with the spindle on, of a program that cuts half a millimetre elsewhere.
TEST(Figures, OfALittleCutBesideASkim) {
  TestRun run(ParametersOf("t1"), "!MC1;V10;VS10;@0,200;Z0,0,0;Z0,0,-50;PU1000,0;PD2000,0;PU;");
  run.AdvanceToEnd();
  EXPECT_NEAR(run.figures().at("cut_length"), 0.5, 1e-9);
  EXPECT_NEAR(run.figures().at("skimmed_length"), 10.0, 1e-9);
}

// RML1-4.05, RML1-6.10: ESC inside a sequence ends it with error 11 and begins another one; of more
// than 100,000 errors the log of the link is cut, and not that of the commands.
TEST(Figures, OfACutLogOfTheLink) {
  std::string stream;
  for (int k = 0; k < 100'002; ++k) stream += "\x1b.";
  const auto made = Rml1Family().Translate({.name = "a", .bytes = stream}, ParametersOf("t1"), {});
  const Figures figures = ByName(made.figures);
  EXPECT_EQ(figures.at("communication_errors"), 100'001.0);
  EXPECT_EQ(figures.at("communication_errors.cut"), 1.0);
  EXPECT_EQ(figures.at("errors.cut"), 0.0);
}

// The box from the machine's zero: the origin is at 10 and 20 mm, Z0 20 mm below the top, where the
// tool begins.
TEST(Figures, OfTheMachinesCoordinates) {
  TestRun run(WithSpindle(0.0, 0.0), "!MC0;V10;PU1000,500;Z2000,1500,-100;");
  run.AdvanceToEnd();
  const Figures f = run.figures();
  const std::pair<const char*, double> ends[] = {{"xmin", 10.0}, {"xmax", 30.0},  {"ymin", 20.0},
                                                 {"ymax", 35.0}, {"zmin", -21.0}, {"zmax", 0.0}};
  for (const auto& [name, mm] : ends)
    EXPECT_NEAR(f.at("machine_mm." + std::string(name)), mm, 1e-9) << name;
}

// Work that fits the 200 by 150 mm from no origin on the table moves to less or to greater X and Y,
// each by its own way: from 2 to 201 and from 4 to 152.5 mm; from -200.5 to -1 and from -152 to -3
// mm. However little is lost, it is said.
TEST(Figures, OfWorkThatHasToMoveEachWay) {
  const auto figures = [](const std::string& corners) {
    TestRun run(ParametersOf("t1"), "!MC0;VS10;!VZ10;@-100,200;" + corners);
    run.AdvanceToEnd();
    return run.figures();
  };
  const Figures less = figures("PU200,400;PD20100,15250;");
  EXPECT_NEAR(less.at("move_x_less"), 1.0, 1e-9);
  EXPECT_NEAR(less.at("move_y_less"), 2.5, 1e-9);
  EXPECT_FALSE(less.contains("move_x_more") || less.contains("move_y_more"));
  const Figures more = figures("PU-100,-300;PD-20050,-15200;");
  EXPECT_NEAR(more.at("move_x_more"), 0.5, 1e-9);
  EXPECT_NEAR(more.at("move_y_more"), 2.0, 1e-9);
  EXPECT_FALSE(more.contains("move_x_less") || more.contains("move_y_less"));
  EXPECT_NEAR(figures("PU15000,100;PD20000.5,100;").at("move_x_less"), 0.005, 1e-9);
}

// RML1-3A.46: of half a millimetre, too, the speed is told that the machine has not.
TEST(Figures, OfALimitedSpeedOnAShortWay) {
  TestRun run(ParametersOf("t1"), "@-100,200;V5;VS120;PD50,0;");
  run.AdvanceToEnd();
  EXPECT_NEAR(run.figures().at("feed_limited_length"), 0.5, 1e-9);
  EXPECT_EQ(run.figures().at("feed_limited_asked"), 120.0);
  EXPECT_EQ(run.figures().at("feed_limited_used"), 60.0);
}

// RML1-4.20, RML1-6.04: errors are counted by their numbers, also those that the transport reports
// and those of a sender that heeds no flow control.
TEST(Figures, OfEachErrorByItsNumber) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SEQUENCES", "ALL").ok());
  ASSERT_TRUE(parameters.Set("BUFFER", 256.0).ok());
  const Profile profile = MakeProfile(parameters).value();
  Device device(profile);
  DeviceListener nobody;
  std::int64_t offset = 0;
  const auto receive = [&](int times, const std::string& bytes) {
    for (int n = 0; n < times; ++n) {
      for (const char c : bytes) device.Receive(static_cast<unsigned char>(c), offset++, nobody);
    }
  };
  const auto feed = [&](int times, const std::string& bytes) {
    receive(times, bytes);
    while (device.Step(nobody)) {
    }
  };
  feed(3, "QQ;");
  feed(1, "5;");
  feed(2, "W-1;");
  feed(1, "\x1b.\x1b.K");
  feed(2, "\x1b.T1\x1b.K");
  feed(3, "\x1b.T70000:");
  feed(4, "\x1b.T1;2;3;4;5;:");
  for (int n = 0; n < 5; ++n) device.ReportLineError(offset, nobody);
  feed(262, ";");  // the buffer takes 256
  const Figures f = ByName(FiguresOf(device, Physical(profile), true));
  EXPECT_EQ(f.at("errors"), 6.0);
  EXPECT_EQ(f.at("communication_errors"), 21.0);
  const std::pair<const char*, double> counts[] = {{"errors.1", 3},
                                                   {"errors.2", 1},
                                                   {"errors.3", 2},
                                                   {"communication_errors.11", 1},
                                                   {"communication_errors.12", 2},
                                                   {"communication_errors.13", 3},
                                                   {"communication_errors.14", 4},
                                                   {"communication_errors.15", 5},
                                                   {"communication_errors.16", 6}};
  for (const auto& [name, count] : counts) EXPECT_EQ(f.at(name), count) << name;
}

// What happened once has a place as what happened often.
TEST(Figures, OfOneRefusedPlaceTellWhere) {
  TestRun run(ParametersOf("t1"), "PU1,1;\nPU1,99999999;");
  run.AdvanceToEnd();
  int found = 0;
  for (const machine::Figure& figure : run->figures()) {
    if (figure.name != "positions_refused") continue;
    ++found;
    EXPECT_EQ(figure.value, 1.0);
    EXPECT_EQ(figure.first, (machine::Place{.program = 1, .step = 2, .line = 2, .byte_offset = 7}));
  }
  EXPECT_EQ(found, 1);
}

// Steps of one way down are one plunge; a step down behind a cut is another one.
TEST(Figures, OfPlungesBehindACut) {
  const auto plunges = [](const std::string& sets) {
    TestRun run(ParametersOf("t1"), "!MC0;V10;Z" + sets + ";");
    run.AdvanceToEnd();
    return run.figures().at("plunges");
  };
  EXPECT_EQ(plunges("0,0,-100,0,0,-200"), 1.0);
  EXPECT_EQ(plunges("0,0,-100,1000,0,-100,1000,0,-200"), 2.0);
}

// RML1-9.22: what lacks more than rounding for half a step is rounded down: 0.12499999 mm are less
// than two and a half steps of 0.05 mm.
TEST(Registers, LessThanHalfAStepIsNone) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("STEP", 0.05).ok());
  for (const auto& [x, steps] : {std::pair("12.499999", "2"), std::pair("12.5", "3")}) {
    TestRun run(parameters, "!MC0;PU" + std::string(x) + ",0;");
    run.AdvanceToEnd();
    EXPECT_EQ(run.variable("XSTEPS"), steps) << x;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
