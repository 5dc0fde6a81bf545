#include <gtest/gtest.h>

#include <map>
#include <string>
#include <tuple>

#include "engine/core/number_text.h"
#include "engine/simulation/report/facts.h"
#include "tests/engine/core/untold.h"

// Which figure of a report stands under which key: every figure has a value of its own, so none can
// stand for another.
namespace rmlcell::simulation {
namespace {

using Expected = std::map<std::string, std::string>;

void ExpectFacts(const RunReport& report, const Expected& expected) {
  std::map<std::string, std::string> facts;
  for (const Fact& fact : Facts(report)) facts.emplace(fact.key, fact.value);
  for (const auto& [key, value] : expected) {
    ASSERT_TRUE(facts.contains(key)) << key;
    EXPECT_EQ(facts.at(key), value) << key;
  }
}

TEST(FactsValues, Run) {
  RunReport report;
  report.family = "optimo";
  report.title = "plate.S";
  report.inputs_hash = "ab12";
  report.engine_version = "9.8.7";
  report.finished = true;
  report.outcome = {.kind = machine::OutcomeKind::kStopped,
                    .code = ErrorCode::kCellWaitsForever,
                    .detail = "a\tb\x7F",
                    .place = {.program = 12, .step = 34, .line = 1}};
  report.steps_executed = 56;
  report.halts = 7;
  report.lookahead_starved = 8;
  report.machine = {.profile = "efa-51",
                    .named = true,
                    .changes = {{"CYCLE", "0.1", "0.064"}, {"VMAX", "300", "500"}},
                    .changed_by = "mine.toml"};
  ExpectFacts(report, {{"family", "optimo"},
                       {"profile", "efa-51"},
                       {"profile_named", "yes"},
                       {"profile_changes", "CYCLE=0.1 VMAX=300"},
                       {"profile_changed_by", "mine.toml"},
                       {"title", "plate.S"},
                       {"inputs_hash", "ab12"},
                       {"engine_version", "9.8.7"},
                       {"changed_parameters", "none"},
                       {"outcome", "stopped"},
                       {"outcome_code", "CELL-E9308"},
                       {"outcome_detail", "a b "},
                       {"outcome_program", "12"},
                       {"outcome_step", "34"},
                       {"outcome_line", "1"},
                       {"steps_executed", "56"},
                       {"halts", "7"},
                       {"lookahead_starved", "8"}});
  using machine::OutcomeKind;
  for (const auto& [kind, text] :
       std::map<OutcomeKind, std::string>{{OutcomeKind::kCompleted, "completed"},
                                          {OutcomeKind::kStopped, "stopped"},
                                          {OutcomeKind::kFailed, "failed"},
                                          {OutcomeKind::kCancelled, "cancelled"},
                                          {OutcomeKind::kBudgetExceeded, "budget_exceeded"}}) {
    report.outcome.kind = kind;
    ExpectFacts(report, {{"outcome", text}});
  }
}

// What is not known or not there is none: no line, no code, no verdict of a run that is under way.
TEST(FactsValues, RunWithoutWords) {
  ExpectFacts(RunReport{}, {{"profile", "none"},
                            {"profile_named", "no"},
                            {"profile_changes", "none"},
                            {"machine_name", "none"},
                            {"profile_changed_by", "none"},
                            {"title", "none"},
                            {"outcome", "running"},
                            {"outcome_code", "none"},
                            {"outcome_detail", "none"},
                            {"outcome_program", "0"},
                            {"outcome_step", "0"},
                            {"outcome_line", "none"},
                            {"verdict", "running"},
                            {"verdict_reasons", "0"},
                            {"verdict_codes", "none"},
                            {"verdict_because", "none"},
                            {"corners_deviation_at", "none"},
                            {"work_origin_x_mm", "none"},
                            {"work_origin_z_mm", "none"},
                            {"tip_x_min_mm", "none"},
                            {"programmed_z_max", "none"}});
}

TEST(FactsValues, Verdict) {
  RunReport report;
  report.finished = true;
  report.machine.own_name = "The old one";
  report.changed_parameters = {{"CYCLE", "0.1"}, {"VMAX", "300"}};
  ExpectFacts(report, {{"verdict", "GOOD"}, {"verdict_codes", "none"}});
  report.judgement.Add({.code = ErrorCode::kCellContourSlow,
                        .verdict = machine::Verdict::kDoubtful,
                        .said = "slow"});
  report.judgement.Add(
      {.code = ErrorCode::kCellBeamStands, .verdict = machine::Verdict::kBad, .said = "it stands"});
  ExpectFacts(report, {{"verdict", "BAD"},
                       {"verdict_reasons", "2"},
                       {"verdict_codes", "CELL-E9621 CELL-E9622"},
                       {"verdict_because", "it stands"},
                       {"machine_name", "The old one"},
                       {"changed_parameters", "CYCLE=0.1 VMAX=300"}});
}

// motion.md 8.2: times in seconds, to 1e-6.
TEST(FactsValues, Times) {
  RunReport report;
  report.cycle_time = FromSeconds(45.0);
  report.total.time = {.motion = FromSeconds(1.0),
                       .settling = FromSeconds(2.0),
                       .dwell = FromSeconds(3.0),
                       .pierce = FromSeconds(4.0),
                       .condition = FromSeconds(5.0),
                       .operator_wait = FromSeconds(6.0),
                       .spin_up = FromSeconds(7.0),
                       .load = FromSeconds(8.0),
                       .standstill = FromSeconds(0.123456789)};
  EXPECT_EQ(report.total.time.total(), FromSeconds(36.123456789));
  ExpectFacts(report, {{"cycle_time_s", "45.0"},
                       {"motion_time_s", "1.0"},
                       {"settling_time_s", "2.0"},
                       {"dwell_time_s", "3.0"},
                       {"pierce_time_s", "4.0"},
                       {"condition_time_s", "5.0"},
                       {"operator_time_s", "6.0"},
                       {"spin_up_time_s", "7.0"},
                       {"load_time_s", "8.0"},
                       {"standstill_time_s", "0.123457"}});
}

// motion.md 8.2: energy of the cuts by cut length: 120 J / 30 mm.
TEST(FactsValues, Work) {
  RunReport report;
  report.total.tip_path_mm = 70.0;
  report.total.cut_mm = 30.0;
  report.total.travel_mm = 40.0;
  report.total.plunge_mm = 5.0;
  report.total.plunges = 2;
  report.total.beam_on = FromSeconds(11.0);
  report.total.beam_switches = 3;
  report.total.pierces = 4;
  report.total.shutter_open = FromSeconds(12.0);
  report.total.cut_energy_j = 120.0;
  report.total.pierce_energy_j = 13.0;
  report.total.energy_j_per_mm_max = 6.5;
  report.shortfall = {
      .moves = 14, .by_axis = 1, .by_radius = 2, .too_short = 3, .by_acceleration = 8};
  ExpectFacts(report, {{"tip_path_mm", "70.0"},
                       {"cut_length_mm", "30.0"},
                       {"travel_length_mm", "40.0"},
                       {"plunge_length_mm", "5.0"},
                       {"plunges", "2"},
                       {"beam_on_s", "11.0"},
                       {"beam_switches", "3"},
                       {"pierces", "4"},
                       {"shutter_open_s", "12.0"},
                       {"energy_j", "133.0"},
                       {"cut_energy_j", "120.0"},
                       {"pierce_energy_j", "13.0"},
                       {"energy_j_per_mm", "4.0"},
                       {"energy_max_j_per_mm", "6.5"},
                       {"feed_not_reached", "14"},
                       {"feed_held_by_axis", "1"},
                       {"feed_held_by_radius", "2"},
                       {"feed_held_by_length", "3"},
                       {"feed_held_by_acceleration", "8"}});
  ExpectFacts(RunReport{}, {{"energy_j_per_mm", "0.0"}});
}

// motion.md 8.2: classes of 5 %, by their upper bound.
TEST(FactsValues, BeamTimes) {
  RunReport report;
  for (int k = 0; k < kSpeedBins; ++k) {
    report.beam.by_speed[static_cast<std::size_t>(k)] = FromSeconds(100.0 + k);
  }
  for (int k = 0; k < kPowerBins; ++k) {
    report.beam.by_power[static_cast<std::size_t>(k)] = FromSeconds(200.0 + k);
  }
  ExpectFacts(report, {{"beam_on_standing_s", "100.0"},
                       {"beam_on_speed_005_s", "101.0"},
                       {"beam_on_speed_010_s", "102.0"},
                       {"beam_on_speed_095_s", "119.0"},
                       {"beam_on_speed_100_s", "120.0"},
                       {"beam_on_power_005_s", "200.0"},
                       {"beam_on_power_010_s", "201.0"},
                       {"beam_on_power_095_s", "218.0"},
                       {"beam_on_power_100_s", "219.0"}});
  for (const FactKey& key : FactKeys()) {
    if (key.key == "beam_on_speed_010_s") {
      EXPECT_EQ(key.text, "beam on at up to 10 % of the highest tip speed, above the class before");
    }
    if (key.key == "beam_on_power_010_s") {
      EXPECT_EQ(key.text, "beam on at a power from 5 to 10 %");
    }
  }
}

// docs/verdict.md: what a beam is judged by, at the worst place.
TEST(FactsValues, Contours) {
  RunReport report;
  const auto most = [](double value) { return Extreme{.value = value, .place = {.step = 9}}; };
  report.cut_figures = {.contours = 3,
                        .longest = FromSeconds(4.5),
                        .energy_max_j = 5.5,
                        .slow_percent = most(6.5),
                        .hot_mm = most(7.5),
                        .weak_mm = most(8.5),
                        .uncontrolled_mm = most(9.5),
                        .standing_s = most(10.5),
                        .singular_rad = most(0.5 * kPi),
                        .near_end = {most(1.5), most(2.5), most(3.5), most(0.5), most(0.25)}};
  ExpectFacts(report, {{"contours", "3"},
                       {"contour_time_max_s", "4.5"},
                       {"contour_energy_max_j", "5.5"},
                       {"slow_contour_max_percent", "6.5"},
                       {"hot_stretch_max_mm", "7.5"},
                       {"weak_stretch_max_mm", "8.5"},
                       {"ptp_cut_length_mm", "9.5"},
                       {"standing_beam_max_s", "10.5"},
                       {"singular_swing_max_deg", "90.0"},
                       {"near_end_x_mm", "1.5"},
                       {"near_end_y_mm", "2.5"},
                       {"near_end_z_mm", "3.5"},
                       {"near_end_a_rad", "0.5"},
                       {"near_end_b_rad", "0.25"}});
}

// motion.md 8.2: knots by how they were passed; no deviation has no place.
TEST(FactsValues, Corners) {
  RunReport report;
  report.corners = {.stops = 1,
                    .stops_with_fly = 2,
                    .reversals = 3,
                    .through = 4,
                    .blended = 5,
                    .capped = 6,
                    .deviation_mm_max = 0.75,
                    .deviation_place = {.program = 45, .step = 9}};
  ExpectFacts(report, {{"corners_stopped", "1"},
                       {"corners_stopped_with_fly", "2"},
                       {"corners_reversed", "3"},
                       {"corners_through", "4"},
                       {"corners_blended", "5"},
                       {"corners_capped", "6"},
                       {"corners_deviation_max_mm", "0.75"},
                       {"corners_deviation_at", "45/9"}});
  report.corners.deviation_mm_max = 0.0;
  ExpectFacts(report, {{"corners_deviation_at", "none"},
                       {"removed_volume_mm3", "none"},
                       {"gouges", "none"},
                       {"gouge_depth_mm", "none"}});
  report.milling = MillingFigures{.removed_mm3 = 1.5,
                                  .gouges = 2,
                                  .gouge_depth_mm = 0.25,
                                  .below_mm = 0.125,
                                  .remaining_mm3 = 7.5,
                                  .deepest_cut_mm = 3.5,
                                  .deepest_pass_mm = 1.25,
                                  .shank_depth_mm = 0.75,
                                  .beside_mm = 8.25};
  ExpectFacts(report, {{"removed_volume_mm3", "1.5"},
                       {"gouges", "2"},
                       {"gouge_depth_mm", "0.25"},
                       {"below_block_mm", "0.125"},
                       {"beside_block_mm", "8.25"},
                       {"remaining_volume_mm3", "7.5"},
                       {"deepest_cut_mm", "3.5"},
                       {"deepest_pass_mm", "1.25"},
                       {"shank_depth_mm", "0.75"},
                       {"target_left_mm", "none"},
                       {"target_good_share", "none"}});
  report.milling->target = TargetFigures{
      .left_mm = 1.5, .left_mm3 = 2.5, .deep_mm = 3.5, .deep_mm3 = 4.5, .good_percent = 5.5};
  ExpectFacts(report, {{"target_left_mm", "1.5"},
                       {"target_left_volume_mm3", "2.5"},
                       {"target_deep_mm", "3.5"},
                       {"target_deep_volume_mm3", "4.5"},
                       {"target_good_share", "0.055"}});
}

TEST(FactsValues, Positions) {
  RunReport report;
  report.final_position = {
      .tip = {{1, 2, 3}, 8.0, 9.0}, .axes = {{4, 5, 6}, 0.5, 0.25}, .program_point = {7, 8, 9}};
  ExpectFacts(report, {{"final_tip_x_mm", "1.0"},
                       {"final_tip_y_mm", "2.0"},
                       {"final_tip_z_mm", "3.0"},
                       {"final_column_x_mm", "4.0"},
                       {"final_column_y_mm", "5.0"},
                       {"final_column_z_mm", "6.0"},
                       {"final_a_rad", "0.5"},
                       {"final_b_rad", "0.25"},
                       {"final_point_x", "7.0"},
                       {"final_point_y", "8.0"},
                       {"final_point_z", "9.0"}});
  report.work_origin = motion::MachinePoint{11, 12, 13};
  ExpectFacts(
      report,
      {{"work_origin_x_mm", "11.0"}, {"work_origin_y_mm", "12.0"}, {"work_origin_z_mm", "13.0"}});
}

TEST(FactsValues, Boxes) {
  RunReport report;
  const auto box = [](double first) {
    machine::Box made;
    made.Add(motion::MachineVector{first, first + 1, first + 2});
    made.Add(motion::MachineVector{first + 3, first + 4, first + 5});
    return made;
  };
  report.programmed.Add(motion::ProgramPoint(10, 11, 12));
  report.programmed.Add(motion::ProgramPoint(13, 14, 15));
  report.tip = box(20);
  report.cut = box(30);
  report.column = box(40);
  for (const auto& [name, first, unit] : {std::tuple{"programmed", 10.0, ""},
                                          {"tip", 20.0, "_mm"},
                                          {"cut", 30.0, "_mm"},
                                          {"column", 40.0, "_mm"}}) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string key = std::string(name) + '_' + "xyz"[i];
      const double low = first + static_cast<double>(i);
      ExpectFacts(report, {{key + "_min" + unit, ShortestText(low) + ".0"},
                           {key + "_max" + unit, ShortestText(low + 3.0) + ".0"}});
    }
  }
}

// motion.md 8.2: peaks in units, and by their limits; an axis without a limit has no share.
TEST(FactsValues, Axes) {
  RunReport report;
  report.tip_figures = {.name = "tip",
                        .peak_speed = 50.0,
                        .peak_acceleration = 900.0,
                        .speed_limit = 200.0,
                        .acceleration_limit = 1000.0};
  report.axes = {{.name = "Y",
                  .travel = 1.0,
                  .peak_speed = 2.0,
                  .peak_acceleration = 3.0,
                  .peak_jerk = 4.0,
                  .speed_limit = 8.0,
                  .acceleration_limit = 6.0,
                  .reversals = 5},
                 {.name = "B",
                  .rotary = true,
                  .travel = 1.5,
                  .minimum = -0.5,
                  .maximum = 0.75,
                  .peak_speed = 2.5,
                  .peak_acceleration = 3.5,
                  .peak_jerk = 4.5,
                  .reversals = 6}};
  ExpectFacts(report, {{"tip_peak_speed_mm_s", "50.0"},
                       {"tip_peak_acceleration_mm_s2", "900.0"},
                       {"tip_peak_speed_share", "0.25"},
                       {"tip_peak_acceleration_share", "0.9"},
                       {"axis_y_travel_mm", "1.0"},
                       {"axis_y_reversals", "5"},
                       {"axis_y_peak_speed_mm_s", "2.0"},
                       {"axis_y_peak_acceleration_mm_s2", "3.0"},
                       {"axis_y_peak_jerk_mm_s3", "4.0"},
                       {"axis_y_peak_speed_share", "0.25"},
                       {"axis_y_peak_acceleration_share", "0.5"},
                       {"axis_b_min_rad", "-0.5"},
                       {"axis_b_max_rad", "0.75"},
                       {"axis_b_travel_rad", "1.5"},
                       {"axis_b_reversals", "6"},
                       {"axis_b_peak_speed_rad_s", "2.5"},
                       {"axis_b_peak_acceleration_rad_s2", "3.5"},
                       {"axis_b_peak_jerk_rad_s3", "4.5"},
                       {"axis_b_peak_speed_share", "none"},
                       {"axis_x_travel_mm", "none"},
                       {"axis_z_travel_mm", "none"},
                       {"axis_a_travel_rad", "none"}});
}

// Errors are all that is neither warning nor advice; each as often as it occurred.
TEST(FactsValues, Findings) {
  RunReport report;
  const auto add = [&](Severity severity, ErrorCode code, int step, std::uint64_t count) {
    Finding finding;
    finding.diagnostic = {.code = code, .severity = severity, .program = 45, .step = step};
    finding.count = count;
    report.findings.push_back(finding);
  };
  add(Severity::kWarning, ErrorCode::kSpeedLimited, 2, 3);
  add(Severity::kAdvice, ErrorCode::kSpeedLimited, 3, 4);
  add(Severity::kProgram, ErrorCode::kHoleRadiusZero, 4, 1);
  add(Severity::kAlarm, ErrorCode::kShutterInterlock, 5, 5);
  report.findings_dropped = Untold(9);
  report.violations = {{.place = {.program = 45, .step = 3}, .axis = "X", .excess = 12.5},
                       {.place = {.program = 46, .step = 4}, .axis = "A", .excess = 0.5}};
  report.violations_dropped = 7;
  ExpectFacts(report, {{"errors", "6"},
                       {"warnings", "3"},
                       {"advice", "4"},
                       {"findings",
                        "OPT-E7320@45/2x3 OPT-E7320@45/3x4 OPT-E348@45/4 "
                        "OPT-E7410@45/5x5"},
                       {"findings_dropped", "9"},
                       {"violations", "9"},
                       {"violation_list", "X@45/3:12.5 A@46/4:0.5"}});
  ExpectFacts(RunReport{}, {{"findings", "none"}, {"violation_list", "none"}, {"violations", "0"}});
}

TEST(FactsValues, Products) {
  RunReport report;
  report.trace = {.made = true, .complete = false, .records = 1};
  report.toolpath = {.made = true, .complete = true, .records = 2, .bytes = 3};
  report.picture = {.made = true, .complete = true, .records = 4};
  ExpectFacts(report, {{"trace_records", "1"},
                       {"trace_complete", "no"},
                       {"toolpath_points", "2"},
                       {"toolpath_bytes", "3"},
                       {"toolpath_complete", "yes"},
                       {"picture_elements", "4"},
                       {"picture_exact", "yes"}});
  report.trace.complete = true;
  report.toolpath.complete = false;
  report.picture.complete = false;
  ExpectFacts(report,
              {{"trace_complete", "yes"}, {"toolpath_complete", "no"}, {"picture_exact", "no"}});
}

// Figures of the family: those it declares always, with "none" where a run has none; others behind.
TEST(FactsValues, FiguresOfTheFamily) {
  RunReport report;
  report.family = "optimo";
  report.figures = {{"executables_made", "", 2.0}, {"extra", "mm", 1.5}};
  ExpectFacts(report, {{"optimo.executables_made", "2.0"},
                       {"optimo.lookahead_starved", "none"},
                       {"optimo.extra", "1.5"}});
  int made = 0;
  for (const Fact& fact : Facts(report)) made += fact.key == "optimo.executables_made" ? 1 : 0;
  EXPECT_EQ(made, 1);
}

}  // namespace
}  // namespace rmlcell::simulation
