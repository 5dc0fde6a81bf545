// Verdicts of whole runs of the laser. For each rule the smallest program that breaks it, and one
// that just does not. docs/verdict.md lists the rules, decision 0021 has their reasons. Lengths and
// times are worked out from the machine of motion.md section 1: at SPEED 10, 50 mm/s, a ramp from
// rest takes 2 sqrt(50 / 40000) = 0.0707 s and 1.7678 mm.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/report/facts.h"
#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

using machine::Judgement;
using machine::Verdict;

const machine::MachineFamily& Optimo() { return *families::FindFamily("optimo"); }

struct Cell {
  std::string profile = "standard";
  std::map<std::string, std::string> parameters{};
  std::map<int, std::string> programs{};  // sources besides the main one, by slot
  std::optional<machine::ProgramStep> simul{};
  AtHalt at_halt = AtHalt::kStart;
};

// A program that does not compile has the verdict of its findings.
RunReport ReportOfCut(const std::string& source, const Cell& cell = {}) {
  const machine::Parameters parameters =
      *machine::MakeParameters(Optimo(), cell.profile, cell.parameters);
  machine::RunSetup setup(parameters);
  std::map<int, std::string> programs = cell.programs;
  programs[1] = source;
  for (const auto& [slot, text] : programs) {
    const machine::Translation made =
        Optimo().Translate({.name = std::to_string(slot) + ".S", .bytes = text}, parameters, {});
    if (!made.ok) {
      RunReport report;
      report.judgement = JudgeFindings(made.diagnostics);
      return report;
    }
    setup.programs[slot].object = machine::Bytes::Of(made.object);
  }
  setup.main_program = 1;
  setup.forecast = true;
  setup.simul = cell.simul;
  SimulationRequest request;
  request.options.at_halt = cell.at_halt;
  const auto result = Simulate(Optimo(), std::move(setup), std::move(request));
  EXPECT_TRUE(result);
  return result ? result->report : RunReport{};
}

std::string VerdictOfCut(const std::string& source, const Cell& cell = {}) {
  return TextOf(ReportOfCut(source, cell).judgement);
}

// Four steps: the tip stands at (X, 1000, -400).
std::string From(const std::string& x) {
  return "COORD ABSOL\nPATH LIN\nMOVE (" + x + ", 1000., -400., 0., 0.)\nSPEED 10\n";
}
std::string To(const std::string& x, const std::string& a = "0.", const std::string& b = "0.") {
  return "MOVE (" + x + ", 1000., -400., " + a + ", " + b + ")\n";
}
// Power by speed: neither hot nor weak, and none at standstill.
const std::string kRamp = "WORKDEF 1,0 (10., 75., 0., 0.)\nWORK 1,0 /ON\n";
const std::string kRampOff = "WORK 1,0 /OFF\n";
const std::string kOn = "WORK 0,0 /ON\n";  // constant power
const std::string kOff = "WORK 0,0 /OFF\n";

TEST(LaserVerdict, OfAnOrderlyContourIsGood) {
  EXPECT_EQ(VerdictOfCut(From("100.") + kOn + To("200.") + kOff), "GOOD");
  EXPECT_EQ(VerdictOfCut(From("100.") + kRamp + To("200.") + kRampOff), "GOOD");
}

// OPT-3.24, OPT-3.25: WORK 2 OFF takes the beam away, and the process counts as ON. 1/128 mm of it
// is rounding, 1/64 mm is not.
TEST(LaserVerdict, OfAContourWithoutBeam) {
  const std::string begin = From("0.") + kOn + To("50.") + "WORK 2,5 /OFF\n";
  EXPECT_EQ(VerdictOfCut(begin + To("60.") + kOff),
            "BAD; OPT-E7414 10.000 mm of a process that is ON with the beam off @8");
  EXPECT_EQ(VerdictOfCut(begin + To("50.0078125") + kOff), "GOOD");
  EXPECT_EQ(VerdictOfCut(begin + To("50.015625") + kOff),
            "BAD; OPT-E7414 0.016 mm of a process that is ON with the beam off @8");
  EXPECT_EQ(VerdictOfCut(begin + kOn + To("60.") + kOff), "GOOD");
  EXPECT_EQ(VerdictOfCut(begin + kOff + To("60.")), "GOOD");
}

// OPT-3.32: of two processes one OFF is enough.
TEST(LaserVerdict, OfAContourWithOneOfTwoProcesses) {
  const std::string begin = From("0.") + kOn + "WORKDEF 0,1\nWORK 0,1 /ON\n" + To("50.") + kOff;
  EXPECT_EQ(VerdictOfCut(begin + To("60.") + "WORK 0,1 /OFF\n"),
            "BAD; OPT-E7414 10.000 mm of a process that is ON with the beam off @10");
  EXPECT_EQ(VerdictOfCut(begin + "WORK 0,1 /OFF\n" + To("60.")), "GOOD");
}

// OPT-2.49: in a chain of /FLY moves the beam changes where the tip passes, not where the program
// has run ahead to.
TEST(LaserVerdict, OfABeamThatChangesInPassing) {
  EXPECT_EQ(VerdictOfCut(From("0.") + "MOVE (50., 1000., -400., 0., 0.) /FLY\n" + kOn +
                         "MOVE (150., 1000., -400., 0., 0.) /FLY\n" + kOff + To("200.")),
            "GOOD");
}

// OPT-3.15: with the EFA-51 the shutter goes with the beam.
TEST(LaserVerdict, OfAContourWithoutShutter) {
  const std::string begin = From("0.") + kOn + To("50.") + "WORK 2,5 /OFF\n";
  EXPECT_EQ(VerdictOfCut(begin + To("60.") + kOff, {.profile = "efa-51"}),
            "BAD; OPT-E7415 10.000 mm of a process that is ON with the shutter closed @8");
  EXPECT_EQ(VerdictOfCut(begin + kOn + To("60.") + kOff, {.profile = "efa-51"}), "GOOD");
}

// OPT-5.40: the second gas is refused, and stays so until the program takes its wish back, or asks
// again and gets it.
TEST(LaserVerdict, OfAContourWithAnotherGas) {
  const Cell cell{.parameters = {{"GAS_CHANNELS", "3"}}};
  const std::string refused = From("0.") + "OL[8] = ON\nOL[9] = ON\n";
  const std::string cut = kOn + To("10.") + kOff;
  const std::string bad =
      "BAD; OPT-E7409 10.000 mm are cut with another assist gas than the program asks for @";
  EXPECT_EQ(VerdictOfCut(refused + cut, cell), bad + "8");
  EXPECT_EQ(VerdictOfCut(refused + "OL[8] = OFF\n" + cut, cell), bad + "9");
  EXPECT_EQ(VerdictOfCut(refused + "OL[9] = OFF\n" + cut, cell), "GOOD");
  EXPECT_EQ(VerdictOfCut(refused + "OL[8] = OFF\nOL[9] = ON\n" + cut, cell), "GOOD");
  EXPECT_EQ(VerdictOfCut(refused + To("10."), cell), "GOOD");  // nothing is cut
}

TEST(LaserVerdict, OfABeamWithoutPower) {
  const auto with_power = [](const std::string& percent) {
    return VerdictOfCut(From("0.") + "WORKDEF 1,0 (10., " + percent + ", 0., 0.)\nWORK 1,0 /ON\n" +
                        To("10.") + kRampOff);
  };
  EXPECT_EQ(with_power("0."), "DOUBTFUL; OPT-E7416 10.000 mm with the beam on and no power @7");
  EXPECT_EQ(with_power("0.1"), "GOOD");
}

// OPT-3.34; the end that is not written is no step (OPT-1.07). A schedule that stays selected does
// no harm.
TEST(LaserVerdict, OfAProgramThatEndsWithItsProcess) {
  EXPECT_EQ(VerdictOfCut(From("0.") + kOn + To("10.")),
            "DOUBTFUL; OPT-E7408 programs that end with the beam's process ON: 1 @6");
  const RunReport schedule =
      ReportOfCut(From("0.") + "WORKDEF 2,0 (11)\nWORK 2,0 /ON\n" + kOn + To("10.") + kOff);
  EXPECT_EQ(TextOf(schedule.judgement), "GOOD");
  // The finding that goes with the verdict.
  const auto severity = [](const RunReport& report) {
    for (const Finding& finding : report.findings) {
      if (finding.diagnostic.code == ErrorCode::kWorkActiveAtEnd)
        return finding.diagnostic.severity;
    }
    return Severity::kFatal;
  };
  EXPECT_EQ(severity(schedule), Severity::kAdvice);
  EXPECT_EQ(severity(ReportOfCut(From("0.") + kOn + To("10."))), Severity::kWarning);
  EXPECT_EQ(
      severity(ReportOfCut(From("0.") + "WORKDEF 2,0 (11)\nWORK 2,0 /ON\n" + kOn + To("10."))),
      Severity::kWarning);
}

// A move settles 0.048 s; with a dwell of 0.05 s it stands 0.098 s, with one of 0.06 s 0.108 s.
TEST(LaserVerdict, OfABeamThatStands) {
  const auto with_stand = [](const std::string& instruction) {
    return VerdictOfCut(From("0.") + kOn + To("10.") + instruction + To("20.") + kOff);
  };
  EXPECT_EQ(with_stand("DELAY .05\n"), "GOOD");
  EXPECT_EQ(with_stand("DELAY .06\n"),
            "DOUBTFUL; CELL-E9621 the beam stays 0.108 s on a tip that stands @6");
  EXPECT_EQ(with_stand("DELAY .95\n"),
            "DOUBTFUL; CELL-E9621 the beam stays 0.998 s on a tip that stands @6");
  EXPECT_EQ(with_stand("DELAY .96\n"),
            "BAD; CELL-E9621 the beam stays 1.008 s on a tip that stands @6");
  // Two stands are two.
  EXPECT_EQ(with_stand("DELAY .05\n" + To("15.") + "DELAY .05\n"), "GOOD");
  // The head turns about the tip, motion.md 3.5: A by 0.5 rad with up to 0.1 * 2 pi rad/s and 400
  // rad/s3, 0.5 / 0.62832 + 2 sqrt(0.62832 / 400) = 0.875 s, and 0.048 s before and behind it.
  EXPECT_EQ(VerdictOfCut(From("0.") + kOn + To("10.") + To("10.", "0.5") + To("20.", "0.5") + kOff),
            "DOUBTFUL; CELL-E9621 the beam stays 0.971 s on a tip that stands @6");
}

// motion.md 8.1: a dwell behind WORK 0 ON is a piercing. OPT-3.40: no power at standstill.
TEST(LaserVerdict, OfAPiercing) {
  EXPECT_EQ(VerdictOfCut(From("0.") + kOn + "DELAY 2\nDELAY 2\n" + To("10.") + kOff), "GOOD");
  EXPECT_EQ(VerdictOfCut(From("0.") + "WORKDEF 1,0 (10., 75., 3., 95.)\nWORK 1,0 /ON\n" +
                         To("10.") + "DELAY 5\n" + To("20.") + kRampOff),
            "GOOD");
}

// 79 or 81 mm at full speed, then 20 mm in which A has to turn by 5 rad and keeps the tip below
// 6.283 / 5 * 20 = 25 mm/s. Of each ramp 0.72427 mm are below 40 mm/s; of two ramps these are for
// nothing: 20 + 2 * 0.72427 - 2 * 0.72427 = 20 mm are 20.2 % of 99 mm and 19.8 % of 101 mm.
TEST(LaserVerdict, OfAContourBelowItsSpeed) {
  const auto with_straight = [](const std::string& to, const std::string& end) {
    return VerdictOfCut("COORD ABSOL\nPATH LIN\nMOVE (0., 1000., -400., 0., .5)\nSPEED 10\n" +
                        kRamp + To(to, "0.", ".5") + To(end, "5.", ".5") + kRampOff);
  };
  EXPECT_EQ(with_straight("81.", "101."), "GOOD");
  EXPECT_EQ(with_straight("79.", "99."),
            "DOUBTFUL; CELL-E9622 20.2 % of a contour is cut below 0.8 of its SPEED @6");
}

// The way that a contour needs to get up to its speed and down again is no fault of it.
TEST(LaserVerdict, OfAContourThatIsAllRamps) {
  EXPECT_EQ(VerdictOfCut(From("0.") + kRamp + To("3.5") + kRampOff), "GOOD");
}

// motion.md 5.2: from rest to rest over L the tip comes to cbrt(40000 L^2 / 4) mm/s: over 0.5 mm to
// 13.6, over 2.5 mm to 39.7, over 2.6 mm to 40.736 and over 2.8 mm to 42.80 mm/s. Below 40 mm/s,
// 0.8 of SPEED 10, there is no ramp to leave out. Of 2.6 mm 2.109 mm are slow, and 1.44854 mm of
// that are for nothing: 25.4 %; of 2.8 mm 1.809 mm: 12.9 %.
TEST(LaserVerdict, OfAContourThatNeverComesToItsSpeed) {
  const auto slow = [](const std::string& way) {
    return VerdictOfCut(From("0.") + kRamp + way + kRampOff);
  };
  const std::string all =
      "DOUBTFUL; CELL-E9622 100.0 % of a contour is cut below 0.8 of its SPEED @6";
  EXPECT_EQ(slow(To(".5") + To("1.") + To("1.5") + To("2.") + To("2.5")), all);
  EXPECT_EQ(slow(To(".5") + To("1.")), all);
  EXPECT_EQ(slow(To("2.5")), all);
  EXPECT_EQ(slow(To("2.6")),
            "DOUBTFUL; CELL-E9622 25.4 % of a contour is cut below 0.8 of its SPEED @6");
  EXPECT_EQ(slow(To("2.8")), "GOOD");
  // A point has no speed to keep.
  EXPECT_EQ(slow(To("0.0078125")), "GOOD");
  EXPECT_EQ(slow(To("0.015625")), all);
}

// Constant power, and below 33.3 mm/s it is hot: the last 0.48477 mm of the straight line and all
// of the 4.5 or 4.6 mm in which A turns by 5 rad.
TEST(LaserVerdict, OfTooMuchEnergyByLength) {
  const auto with_turn = [](const std::string& end, const std::string& on, const std::string& off) {
    return VerdictOfCut("COORD ABSOL\nPATH LIN\nMOVE (0., 1000., -400., 0., .5)\nSPEED 10\n" + on +
                        To("100.", "0.", ".5") + To(end, "5.", ".5") + off);
  };
  EXPECT_EQ(with_turn("104.5", kOn, kOff), "GOOD");
  EXPECT_EQ(with_turn("104.6", kOn, kOff),
            "DOUBTFUL; CELL-E9623 5.085 mm on end with more than 1.5 times the energy by length of "
            "the process @6");
  EXPECT_EQ(with_turn("104.6", kRamp, kRampOff), "GOOD");  // power goes with the speed
}

// 80 % at 50 mm/s is 100 % at 62.5, and 0.8 of the energy by length at 78.125 mm/s: SPEED 15 is 75
// mm/s. At SPEED 16 each ramp of 3.57771 mm has 0.76855 mm above that: 100 - 2 * 2.80916 mm.
TEST(LaserVerdict, OfTooLittleEnergyByLength) {
  const auto at_speed = [](const std::string& percent) {
    return VerdictOfCut(From("0.") + "WORKDEF 1,0 (10., 80., 0., 0.)\nWORK 1,0 /ON\nSPEED " +
                        percent + "\n" + To("100.") + kRampOff);
  };
  EXPECT_EQ(at_speed("15"), "GOOD");
  EXPECT_EQ(at_speed("16"),
            "DOUBTFUL; CELL-E9624 94.382 mm on end with less than 0.8 of the energy by length of "
            "the process @8");
}

// OPT-5.45
TEST(LaserVerdict, OfACutInPtp) {
  EXPECT_EQ(VerdictOfCut(From("0.") + kOn + "PATH PTP\n" + To("10.") + kOff),
            "DOUBTFUL; CELL-E9625 10.000 mm cut in PATH PTP @7");
  EXPECT_EQ(VerdictOfCut(From("0.") + "PATH PTP\n" + To("10.")), "GOOD");
}

// motion.md 2.5: 0.5235 rad are 29.994 degrees, 0.5237 rad 30.006; 0.0174 rad are 0.997 degrees,
// 0.0175 rad 1.003.
TEST(LaserVerdict, OfAHeadThatTurnsStraightDown) {
  const auto swing = [](const std::string& a, const std::string& b, const std::string& to_b) {
    return VerdictOfCut("COORD ABSOL\nPATH LIN\nMOVE (0., 1000., -400., 0., " + b +
                        ")\nSPEED 10\n" + kOn + To("100.", a, to_b) + kOff);
  };
  const std::string said =
      "DOUBTFUL; CELL-E9626 A turns 30.006 degrees in a contour within 1 degree of B = 0 @6";
  EXPECT_EQ(swing("0.5235", "0.", "0."), "GOOD");
  EXPECT_EQ(swing("0.5237", "0.", "0."), said);
  EXPECT_EQ(swing("0.5237", "0.0174", "0.0174"), said);
  EXPECT_EQ(swing("0.5237", "-0.0174", "-0.0174"), said);
  EXPECT_EQ(swing("0.5237", "0.0175", "0.0175"), "GOOD");
  // 20 degrees and 20 degrees: on end, and with the head away from there in between.
  const auto twice = [](const std::string& between) {
    return VerdictOfCut(From("0.") + kOn + To("100.", "0.349") + between + To("500.", "0.698") +
                        kOff);
  };
  EXPECT_EQ(twice(""),
            "DOUBTFUL; CELL-E9626 A turns 39.992 degrees in a contour within 1 degree of B = 0 @6");
  EXPECT_EQ(twice(To("200.", "0.349", "0.1") + To("300.", "0.349", "0.1") + To("400.", "0.349")),
            "GOOD");
  // Across: of the 1 rad that A turns, 10 degrees while B comes from 1 degree and goes to -1.
  EXPECT_EQ(swing("1.", "0.1", "-0.1"), "GOOD");
}

// OPT-B.08: column X up to 3600 mm, A to 12.6 rad, B to 2.4 rad. Behind a contour, or before it,
// the end is a place like others; beyond it is told as that alone.
TEST(LaserVerdict, OfAContourNearTheEndOfAnAxis) {
  EXPECT_EQ(VerdictOfCut(From("3500.") + kOn + To("3594.5") + kOff), "GOOD");
  EXPECT_EQ(VerdictOfCut(From("3500.") + kOn + To("3595.5") + kOff),
            "DOUBTFUL; CELL-E9627 a contour goes 0.500 mm into the last 5 mm of X @6");
  EXPECT_EQ(VerdictOfCut(From("-500.") + kOn + To("-595.5") + kOff),
            "DOUBTFUL; CELL-E9627 a contour goes 0.500 mm into the last 5 mm of X @6");
  EXPECT_EQ(VerdictOfCut(From("3500.") + To("3595.5")), "GOOD");
  EXPECT_EQ(ReportOfCut(From("3500.") + kOn + To("3600.5") + kOff).judgement.reasons[0].code,
            ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(ReportOfCut(From("3500.") + kOn + To("3600.5") + kOff).judgement.reasons.size(), 1U);
  const auto turned = [](const std::string& a, const std::string& b) {
    return VerdictOfCut("COORD ABSOL\nPATH LIN\nMOVE (1000., 1000., -400., " + a + ", " + b +
                        ")\nSPEED 10\n" + kOn + To("1100.", a, b) + kOff);
  };
  EXPECT_EQ(turned("12.58", "0.5"), "GOOD");
  EXPECT_EQ(turned("12.59", "0.5"),
            "DOUBTFUL; CELL-E9627 a contour goes 0.007 rad into the last degree of A @6");
  EXPECT_EQ(turned("0.", "2.38"), "GOOD");
  EXPECT_EQ(turned("0.", "-2.39"),
            "DOUBTFUL; CELL-E9627 a contour goes 0.007 rad into the last degree of B @6");
}

TEST(LaserVerdict, OfAnAxisThatHardlyMoves) {
  // An axis that is clamped has no room to keep (OPT-B.08).
  const Cell clamped{.parameters = {{"TRAVEL_A_MIN", "0"}, {"TRAVEL_A_MAX", "0"}}};
  EXPECT_EQ(VerdictOfCut(From("100.") + kOn + To("200.") + kOff, clamped), "GOOD");
}

// OPT-6.18, OPT-6.20, OPT-6.21: up to a step nothing moves and no beam is wanted; behind it the
// beam stays off until the next WORK ON.
TEST(LaserVerdict, OfADryRunIsNoCutWithoutBeam) {
  const std::string source = From("0.") + kOn + To("50.") + To("100.") + kOff;
  EXPECT_EQ(VerdictOfCut(source, {.simul = machine::ProgramStep{1, 7}}), "GOOD");
  EXPECT_EQ(VerdictOfCut(source, {.simul = machine::ProgramStep{1, 99}}), "GOOD");
}

// Case W03 of motion.md: 200 mm at SPEED 8 with (8, 75, 1, 50).
TEST(Contours, HaveTimeLengthAndEnergy) {
  const RunReport report =
      ReportOfCut(From("0.") + "WORKDEF 1,0 (8., 75., 1., 50.)\nSPEED 8\nWORK 1,0 /ON\n" +
                  To("200.") + kRampOff + To("300.") + "WORK 1,0 /ON\n" + kRampOff);
  ASSERT_EQ(report.contours.size(), 2U);
  const Contour& cut = report.contours[0];
  EXPECT_EQ(cut.place.step, 7);
  EXPECT_NEAR(ToSeconds(cut.time), 6.111245553, 1e-6);
  EXPECT_NEAR(cut.length_mm, 200.0, 1e-6);
  EXPECT_NEAR(cut.cut_energy_j, 5625.0, 1e-3);
  EXPECT_NEAR(cut.pierce_energy_j, 750.0, 1e-6);
  // A piercing alone: 1 s at 50 % of 1500 W.
  const Contour& spot = report.contours[1];
  EXPECT_EQ(spot.length_mm, 0.0);
  EXPECT_NEAR(spot.energy_j(), 750.0, 1e-6);
  EXPECT_EQ(report.cut_figures.contours, 2U);
  EXPECT_EQ(report.cut_figures.longest, cut.time);
  EXPECT_EQ(report.cut_figures.energy_max_j, cut.energy_j());
}

// Of a ramp to 50 mm/s the way above 40 takes sqrt(20 / 40000) = 0.02236 s, 1.043498 mm; the rest
// of 1.767767 mm is slow, at both ends of each move, and left out at both ends of the contour. The
// share is that of the same length.
TEST(Contours, HaveTheirSlowLength) {
  const RunReport report =
      ReportOfCut(From("0.") + kOn + To("200.") + kOff + kOn + To("100.") + To("0.") + kOff);
  ASSERT_EQ(report.contours.size(), 2U);
  EXPECT_NEAR(report.contours[0].slow_mm, 0.0, 1e-5);
  const double slow_mm = 2.0 * (1.767767 - 1.043498);
  EXPECT_NEAR(report.contours[1].slow_mm, slow_mm, 1e-5);
  EXPECT_NEAR(report.cut_figures.slow_percent.value, 100.0 * slow_mm / 200.0, 1e-5);
}

// docs/verdict.md: a figure with its unit is the key of the fact.
TEST(LaserVerdict, LooksAtFiguresThatAreFacts) {
  std::set<std::string> keys;
  for (const FactKey& fact : FactKeys()) keys.emplace(fact.key);
  int looked_at = 0;
  for (const VerdictRuleInfo& info : CommonVerdictRules()) {
    const int number = Lookup(info.rule.code).number;
    if (number < 9621 || number > 9627) continue;  // of a beam
    const std::string unit(info.unit == "%" ? "percent" : info.unit);
    EXPECT_TRUE(keys.contains(std::string(info.rule.figure) + '_' + unit)) << info.rule.figure;
    ++looked_at;
  }
  EXPECT_EQ(looked_at, 12);
}

// OPT-B.34: the machine takes the beam away while it is halted, and gives it back. What the program
// switches is another contour, though it may halt at the same instant.
TEST(Contours, GoOnBehindAHalt) {
  const auto contours = [](const std::string& between) {
    return ReportOfCut(From("0.") + kOn + To("50.") + between + To("100.") + kOff).contours;
  };
  ASSERT_EQ(contours("STOP\n").size(), 1U);
  EXPECT_NEAR(contours("STOP\n")[0].length_mm, 100.0, 1e-6);
  EXPECT_EQ(contours(kOff + "STOP\n" + kOn).size(), 2U);
  EXPECT_EQ(contours(kOff + kOn).size(), 2U);
  EXPECT_EQ(contours("").size(), 1U);
}

TEST(Contours, PastAThousandAreCounted) {
  Script script;
  for (int k = 1; k <= 1001; ++k) {
    script.Step(1, k).Signal(machine::Signal::kBeam, 1.0);
    script.Wait(machine::WaitKind::kDwell, 0.5, true, 100.0).Signal(machine::Signal::kBeam, 0.0);
  }
  ReportRecorder recorder(Laser());
  FakeRun run(script, recorder);
  EXPECT_EQ(run.Advance(kForever), machine::RunPhase::kFinished);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_EQ(report.contours.size(), kReportedContoursMax);
  EXPECT_EQ(report.contours_dropped, 1U);
  EXPECT_EQ(report.cut_figures.contours, 1001U);
  EXPECT_EQ(report.contours[999].place.step, 1000);
}

std::string FileOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}
std::string CorpusFile(const std::string& name) {
  return FileOf(RMLCELL_SHARED_DIR "/corpus/optimo/" + name);
}
std::string Bracket() { return FileOf(RMLCELL_SOURCE_DIR "/deploy/examples/bracket.S"); }

// Contours have all that is done with the beam on, and each of it once.
TEST(Contours, AddUpToTheWholeRun) {
  for (const std::string& source : {Bracket(), CorpusFile("sample2-cylind.S")}) {
    if (source.empty()) continue;  // the shared corpus is not here
    const RunReport report = ReportOfCut(source, {.programs = {{2, "SYSDEF\n"}}});
    SimTime time{0};
    double length = 0.0, energy = 0.0;
    for (const Contour& contour : report.contours) {
      time += contour.time;
      length += contour.length_mm;
      energy += contour.energy_j();
    }
    EXPECT_EQ(report.contours.size(), 3U);
    EXPECT_EQ(time, report.total.beam_on);
    EXPECT_NEAR(length, report.total.cut_mm, 1e-6);
    EXPECT_NEAR(energy, report.total.energy_j(), 1e-6);
  }
}

// Whatever stands in a program: with one of these faults in any line it is not better.
TEST(LaserVerdict, IsNeverBetterWithAFault) {
  const std::string ptp = "PATH PTP\n", dark = "WORK 2,9 /OFF\n", slow = "ACCEL 5\n";
  const std::string cylinder = CorpusFile("sample2-cylind.S");
  const std::string good =
      From("0.") + kOn + To("50.") + To("100.") + kOff + To("0.") + kRamp + To("50.") + kRampOff;
  int worse = 0;
  for (const std::string& source : {good, Bracket(), cylinder}) {
    const Cell cell{.programs = {{2, "SYSDEF\n"}}};
    const Verdict before = ReportOfCut(source, cell).judgement.verdict;
    for (std::size_t at = source.find('\n'); at != std::string::npos;
         at = source.find('\n', at + 1)) {
      for (const std::string& fault : {ptp, dark, slow}) {
        std::string faulty = source;
        faulty.insert(at + 1, fault);
        const Verdict after = ReportOfCut(faulty, cell).judgement.verdict;
        EXPECT_GE(after, before) << fault << " at " << at << " of\n" << source;
        worse += after > before ? 1 : 0;
      }
    }
  }
  EXPECT_GT(worse, 20);
}

// What a person judged of real programs by reading them, before the rules first ran.
TEST(LaserVerdict, OfRealProgramsIsThatOfPeople) {
  if (CorpusFile("README.md").empty()) GTEST_SKIP() << "the shared corpus is not here";
  std::istringstream table(
      FileOf(RMLCELL_SOURCE_DIR "/tests/conformance/optimo_corpus_verdicts.csv"));
  std::string line;
  std::getline(table, line);
  std::set<std::string> files;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string file, with, profile, verdict;
    std::getline(cells, file, ',');
    std::getline(cells, with, ',');
    std::getline(cells, profile, ',');
    std::getline(cells, verdict, ',');
    Cell cell{.profile = profile, .at_halt = AtHalt::kEnd};
    std::istringstream others(with);
    for (std::string other; others >> other;) {
      const std::size_t is = other.find('=');
      cell.programs[std::stoi(other.substr(0, is))] = CorpusFile(other.substr(is + 1));
    }
    const bool own = file.starts_with("deploy/");
    const std::string source =
        FileOf(own ? RMLCELL_SOURCE_DIR "/" + file : RMLCELL_SHARED_DIR "/" + file);
    ASSERT_FALSE(source.empty()) << file;
    const Judgement judgement = ReportOfCut(source, cell).judgement;
    EXPECT_EQ(machine::VerdictText(judgement.verdict), verdict) << file << ' ' << TextOf(judgement);
    files.insert(file);
  }
  EXPECT_EQ(files.size(), 25U);  // 24 of the corpus, and the example
}

}  // namespace
}  // namespace rmlcell::simulation
