#include "proto/bridge/report.h"

#include <gtest/gtest.h>

#include <string>

#include "proto/bridge/findings.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "tests/engine/core/untold.h"
#include "tests/proto/bridge/message_text.h"

// Every figure of a report has its field: each has a value of its own here.
namespace rmlcell::bridge {
namespace {

using simulation::RunReport;

SimTime Seconds(int count) { return std::chrono::seconds(count); }

simulation::WorkFigures Figures() {
  simulation::WorkFigures figures;
  figures.steps = 1;
  figures.time = {.motion = Seconds(2),
                  .settling = Seconds(3),
                  .dwell = Seconds(4),
                  .pierce = Seconds(5),
                  .condition = Seconds(6),
                  .operator_wait = Seconds(7),
                  .spin_up = Seconds(8),
                  .load = Seconds(9),
                  .standstill = Seconds(10)};
  figures.tip_path_mm = 11.0;
  figures.cut_mm = 12.5;
  figures.travel_mm = 13.0;
  figures.plunge_mm = 14.0;
  figures.beam_on = Seconds(16);
  figures.beam_switches = 16;
  figures.pierces = 17;
  figures.plunges = 18;
  figures.shutter_open = Seconds(19);
  figures.cut_energy_j = 25.0;
  figures.pierce_energy_j = 30.0;
  figures.energy_j_per_mm_max = 22.0;
  return figures;
}
// 54 s in all; 25 J of cut and 30 J of piercing, 25 / 12.5 J/mm.
const std::string kFigures =
    "steps: 1 times { cycle_s: 54 motion_s: 2 settling_s: 3 dwell_s: 4 pierce_s: 5 condition_s: 6 "
    "operator_s: 7 spin_up_s: 8 load_s: 9 standstill_s: 10 } path_length_mm: 11 cut_length_mm: "
    "12.5 "
    "travel_length_mm: 13 plunge_length_mm: 14 beam_on_s: 16 beam_switches: 16 pierces: 17 "
    "plunges: 18 energy_j: 55 energy_j_per_mm: 2 energy_j_per_mm_max: 22 shutter_open_s: 19 ";

template <class Point = motion::MachinePoint>
machine::BoxOf<Point> Spanning(double low, double high) {
  machine::BoxOf<Point> box;
  box.Add(Point(low, low + 1, low + 2));
  box.Add(Point(high, high + 1, high + 2));
  return box;
}

simulation::ScopeFigures Scope() {
  simulation::ScopeFigures scope;
  scope.total = Figures();
  scope.beam.by_speed[2] = Seconds(1);
  scope.beam.by_power[19] = Seconds(2);
  scope.corners = {.stops = 1,
                   .stops_with_fly = 2,
                   .reversals = 3,
                   .through = 4,
                   .blended = 5,
                   .capped = 6,
                   .deviation_mm_max = 0.5,
                   .deviation_place = {.program = 7, .step = 8, .line = 9},
                   .deviation_point = {10, 11, 12}};
  scope.shortfall = {.moves = 10,
                     .by_axis = 1,
                     .by_radius = 2,
                     .too_short = 3,
                     .by_acceleration = 4,
                     .worst = {.program = 1, .step = 2, .line = 3, .byte_offset = 4},
                     .wanted_mm_s = 100.0,
                     .reached_mm_s = 25.0};
  scope.programmed = Spanning<motion::ProgramPoint>(1, 10);
  scope.tip = Spanning(2, 20);
  scope.cut = Spanning(3, 30);
  scope.column = Spanning(4, 40);
  scope.tip_figures = {.name = "tip", .travel = 5.0, .peak_speed = 6.0};
  scope.axes = {{.name = "A",
                 .rotary = true,
                 .travel = 1.0,
                 .minimum = 2.0,
                 .maximum = 3.0,
                 .peak_speed = 4.0,
                 .peak_acceleration = 5.0,
                 .peak_jerk = 6.0,
                 .speed_limit = 8.0,
                 .acceleration_limit = 20.0,
                 .jerk_limit = 9.0,
                 .reversals = 10}};
  return scope;
}
const std::string kScope =
    "corners { stopped: 1 stopped_with_fly: 2 reversed: 3 through: 4 blended: 5 capped: 6 "
    "deviation_mm_max: 0.5 deviation_place { program: 7 step: 8 line: 9 } "
    "deviation_point { x: 10 y: 11 z: 12 } } "
    "shortfall { moves: 10 by_axis: 1 by_radius: 2 too_short: 3 by_acceleration: 4 "
    "worst { program: 1 step: 2 line: 3 byte_offset: 4 } wanted_mm_s: 100 reached_mm_s: 25 } "
    "program_box { low { x: 1 y: 2 z: 3 } high { x: 10 y: 11 z: 12 } } "
    "tip_box { low { x: 2 y: 3 z: 4 } high { x: 20 y: 21 z: 22 } } "
    "cut_box { low { x: 3 y: 4 z: 5 } high { x: 30 y: 31 z: 32 } } "
    "column_box { low { x: 4 y: 5 z: 6 } high { x: 40 y: 41 z: 42 } } "
    "axes { axis: 'tip' travel: 5 peak_speed: 6 } "
    "axes { axis: 'A' rotary: true travel: 1 minimum: 2 maximum: 3 peak_speed: 4 speed_limit: 8 "
    "peak_acceleration: 5 acceleration_limit: 20 reversals: 10 peak_speed_share: 0.5 "
    "peak_acceleration_share: 0.25 peak_jerk: 6 jerk_limit: 9 } ";

std::string Beam() {
  std::string text = "beam { ";
  for (int bin = 0; bin < 21; ++bin) text += bin == 2 ? "by_speed_s: 1 " : "by_speed_s: 0 ";
  for (int bin = 0; bin < 20; ++bin) text += bin == 19 ? "by_power_s: 2 " : "by_power_s: 0 ";
  return text + "} ";
}

const std::string kNothing = "times {} ";
const std::string kStill =
    "final_position { tip {} column {} turned { axis: 'A' unit: UNIT_RADIAN } "
    "turned { axis: 'B' unit: UNIT_RADIAN } } final_program_point {} "
    "final_program_axes { axis: 'A' unit: UNIT_RADIAN } "
    "final_program_axes { axis: 'B' unit: UNIT_RADIAN } ";
constexpr machine::FamilyInfo kGantry = {.axes = "X Y Z A B"};

TEST(ReportMessage, OfARunThatDidNothing) {
  ExpectMessage(
      ToProto(kGantry, RunReport{}, {}),
      "outcome { kind: KIND_COMPLETED place {} verdict: VERDICT_GOOD } total { times {} } " +
          kStill +
          "corners {} axes {} trace { complete: true } toolpath { complete: true } "
          "picture { complete: true } collisions: 'not modelled'");
}

const std::string kGathered = "diagnostics_dropped: 7 gathered { code: 'RML1-E8002' symbol: '" +
                              std::string(ConstantName(ErrorCode::kRml1Clipped)) +
                              "' severity: SEVERITY_ADVICE message: '" +
                              std::string(Lookup(ErrorCode::kRml1Clipped).when) + "' advice: '" +
                              std::string(Lookup(ErrorCode::kRml1Clipped).advice) +
                              "' count: 7 first { line: 40 } last { line: 46 } } ";

const machine::NamedVariable kVariables[] = {{"VR[1]", {machine::VariableKind::kReal, "2.5"}}};

TEST(ReportMessage, EveryFigureHasItsField) {
  RunReport report;
  static_cast<simulation::ScopeFigures&>(report) = Scope();
  report.family = "optimo";
  report.title = "part";
  report.engine_version = "1.2";
  report.inputs_hash = "abc";
  report.changed_parameters = {{"VMAX", "400"}};
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kHoleRadiusZero,
                    .detail = "radius is 0",
                    .place = {.program = 1, .step = 2, .line = 3, .byte_offset = 4}};
  report.halts = 5;
  report.final_position = {.tip = {{1, 2, 3}, 0.5, 0.25},
                           .axes = {{4, 5, 6}, 0.75, 0.125},
                           .program_point = {7, 8, 9},
                           .program_a = 10.0,
                           .program_b = 11.0};
  report.lookahead_starved = 12;
  report.programs[45] = Scope();
  report.steps = {{.program = 1, .step = 2, .line = 3, .figures = Figures()}};
  report.rest = Figures();
  report.findings = {{.diagnostic = {.code = ErrorCode::kFlyReversal,
                                     .severity = Severity::kWarning,
                                     .detail = "turns",
                                     .rule = "OPT-2.48"},
                      .first_at = Seconds(1),
                      .count = 6}};
  report.findings_dropped = Untold(7, ErrorCode::kRml1Clipped, 40);
  report.slow_moves = {{.place = {.program = 1, .step = 2},
                        .cause = simulation::SlowCause::kAxis,
                        .axis = "A",
                        .wanted_mm_s = 3.0,
                        .allowed_mm_s = 2.0,
                        .reached_mm_s = 1.0,
                        .count = 4}};
  report.slow_moves_dropped = 8;
  report.violations = {{.place = {.program = 1, .step = 2},
                        .axis = "X",
                        .rotary = true,
                        .excess = 0.5,
                        .at_target = true,
                        .axes = {{1, 2, 3}, 4, 5},
                        .tip = {6, 7, 8},
                        .first_at = Seconds(9),
                        .count = 10}};
  report.violations_dropped = 9;
  report.figures = {{.name = "programmed.cut_length", .unit = "mm", .value = 2.5}};
  report.trace = {.made = true, .complete = false, .records = 1, .dropped = 2};
  report.toolpath = {.made = true, .records = 3};
  report.picture = {.made = true, .records = 4};
  const CatalogueEntry& hole = Lookup(ErrorCode::kHoleRadiusZero);
  const CatalogueEntry& turn = Lookup(ErrorCode::kFlyReversal);
  ExpectMessage(
      ToProto(kGantry, report, kVariables),
      "family: 'optimo' title: 'part' outcome { kind: KIND_FAILED code: 'OPT-E348' symbol: '" +
          std::string(ConstantName(ErrorCode::kHoleRadiusZero)) +
          "' message: 'radius is 0' advice: '" + std::string(hole.advice) +
          "' place { program: 1 step: 2 line: 3 byte_offset: 4 } verdict: VERDICT_GOOD } total { " +
          kFigures +
          "} final_position { tip { x: 1 y: 2 z: 3 } column { x: 4 y: 5 z: 6 } turned { axis: 'A' value: 0.75 unit: UNIT_RADIAN } turned { axis: 'B' value: 0.125 unit: UNIT_RADIAN } } "
          "final_program_point { x: 7 y: 8 z: 9 } final_program_axes { axis: 'A' value: 10 unit: UNIT_RADIAN } final_program_axes { axis: 'B' value: 11 unit: UNIT_RADIAN } "
          "shutter_open_s: 19 energy_j_per_mm_max: 22 halts: 5 " +
          kScope + Beam() + "programs { program: 45 figures { " + kFigures + "} " + kScope +
          Beam() + "} steps { program: 1 step: 2 line: 3 figures { " + kFigures +
          "} } other_steps { " + kFigures + "} diagnostics { code: '" + CodeText(turn.code) +
          "' symbol: '" + std::string(ConstantName(turn.code)) +
          "' severity: SEVERITY_WARNING message: 'turns' advice: '" + std::string(turn.advice) +
          "' rule: 'OPT-2.48' count: 6 place {} } " + kGathered +
          "slow_moves { place { program: 1 step: 2 } cause: CAUSE_AXIS axis: 'A' wanted_mm_s: 3 "
          "allowed_mm_s: 2 reached_mm_s: 1 count: 4 } slow_moves_dropped: 8 lookahead_starved: 12 "
          "violations { place { program: 1 step: 2 } axis: 'X' rotary: true excess: 0.5 "
          "at_target: true position { tip { x: 6 y: 7 z: 8 } column { x: 1 y: 2 z: 3 } turned { axis: 'A' value: 4 unit: UNIT_RADIAN } turned { axis: 'B' value: 5 unit: UNIT_RADIAN } } "
          "time_s: 9 count: 10 } violations_dropped: 9 "
          "figures { name: 'programmed.cut_length' unit: 'mm' value: 2.5 } "
          "variables { name: 'VR[1]' value { real: 2.5 } text: '2.5' } parameters { key: 'VMAX' value: '400' } "
          "inputs_hash: 'abc' engine_version: '1.2' trace { made: true records: 1 dropped: 2 } "
          "toolpath { made: true complete: true records: 3 } "
          "picture { made: true complete: true records: 4 } collisions: 'not modelled' ");
}

TEST(ReportMessage, EveryFigureOfABlockHasItsField) {
  simulation::RunReport report;
  report.milling = {.removed_mm3 = 1.0,
                    .gouges = 2,
                    .gouge_depth_mm = 3.0,
                    .gouge_place = {.program = 4, .step = 5},
                    .gouge_at = Seconds(6),
                    .below_mm = 7.0,
                    .below_place = {.program = 8, .step = 9},
                    .remaining_mm3 = 10.0,
                    .deepest_cut_mm = 11.0,
                    .tool_diameter_mm = 12.0,
                    .deepest_pass_mm = 13.0,
                    .pass_place = {.program = 14, .step = 15},
                    .shank_depth_mm = 16.0,
                    .shank_place = {.program = 17, .step = 18},
                    .target = simulation::TargetFigures{.tolerance_mm = 19.0,
                                                        .left_mm = 20.0,
                                                        .left_at = {21.0, 22.0},
                                                        .left_mm3 = 23.0,
                                                        .deep_mm = 24.0,
                                                        .deep_at = {25.0, 26.0},
                                                        .deep_mm3 = 27.0,
                                                        .good_percent = 28.0,
                                                        .compared_mm2 = 29.0}};
  ExpectMessage(ToProto(kGantry, report, {}).milling(),
                "removed_mm3: 1 gouges: 2 gouge_depth_mm: 3 gouge_place { program: 4 step: 5 } "
                "gouge_time_s: 6 below_mm: 7 below_place { program: 8 step: 9 } remaining_mm3: 10 "
                "deepest_cut_mm: 11 deepest_pass_mm: 13 pass_place { program: 14 step: 15 } "
                "tool_diameter_mm: 12 shank_depth_mm: 16 shank_place { program: 17 step: 18 } "
                "target { tolerance_mm: 19 left_mm: 20 left_x_mm: 21 left_y_mm: 22 left_mm3: 23 "
                "deep_mm: 24 deep_x_mm: 25 deep_y_mm: 26 deep_mm3: 27 good_percent: 28 "
                "compared_mm2: 29 }");
}

TEST(ReportMessage, EveryFigureOfContoursHasItsField) {
  RunReport report;
  report.contours = {{.place = {.program = 1, .step = 2},
                      .begin = Seconds(3),
                      .time = Seconds(4),
                      .length_mm = 5.0,
                      .slow_mm = 6.0,
                      .cut_energy_j = 7.0,
                      .pierce_energy_j = 8.0}};
  report.contours_dropped = 9;
  report.cut_figures = {.contours = 10,
                        .longest = Seconds(11),
                        .energy_max_j = 12.0,
                        .slow_percent = {.value = 13.0, .place = {.step = 14}},
                        .hot_mm = {.value = 15.0, .place = {.step = 16}},
                        .weak_mm = {.value = 17.0, .place = {.step = 18}},
                        .uncontrolled_mm = {.value = 19.0, .place = {.step = 20}},
                        .standing_s = {.value = 21.0, .place = {.step = 22}},
                        .singular_rad = {.value = 23.0, .place = {.step = 24}}};
  report.cut_figures.near_end[2] = {.value = 25.0, .place = {.step = 26}};
  report.cut_figures.near_end[4] = {.value = 27.0, .place = {.step = 28}};
  ExpectMessage(
      ToProto(kGantry, report, {}),
      ToProto(kGantry, RunReport{}, {}).DebugString() +
          "contours { place { program: 1 step: 2 } begin_s: 3 time_s: 4 length_mm: 5 "
          "slow_length_mm: 6 energy_j: 15 pierce_energy_j: 8 } contours_dropped: 9 "
          "cut { contours: 10 time_s_max: 11 energy_j_max: 12 "
          "slow_percent { value: 13 place { step: 14 } } "
          "hot_stretch_mm { value: 15 place { step: 16 } } "
          "weak_stretch_mm { value: 17 place { step: 18 } } "
          "ptp_mm { value: 19 place { step: 20 } } standing_s { value: 21 place { step: 22 } } "
          "singular_rad { value: 23 place { step: 24 } } "
          "near_ends { axis: 'Z' depth: 25 place { step: 26 } } "
          "near_ends { axis: 'B' rotary: true depth: 27 place { step: 28 } } }");
}

TEST(ReportMessage, AVerdictHasItsReasons) {
  RunReport report;
  report.judgement.Add({.code = ErrorCode::kFlyReversal,
                        .verdict = machine::Verdict::kDoubtful,
                        .said = "2.5 mm too much",
                        .amount = 2.5,
                        .limit = 0.5,
                        .unit = "mm",
                        .first = {.program = 1, .step = 2}});
  report.judgement.Add({.code = ErrorCode::kFlyReversal, .verdict = machine::Verdict::kBad});
  const CatalogueEntry& turn = Lookup(ErrorCode::kFlyReversal);
  const std::string code =
      "code: '" + CodeText(turn.code) + "' symbol: '" + std::string(ConstantName(turn.code)) + "' ";
  const std::string advice = "advice: '" + std::string(turn.advice) + "' ";
  ExpectMessage(
      ToProto(kGantry, report, {}).outcome(),
      "kind: KIND_COMPLETED place {} verdict: VERDICT_BAD reasons { verdict: VERDICT_BAD " + code +
          advice + "} reasons { verdict: VERDICT_DOUBTFUL " + code + "message: '2.5 mm too much' " +
          advice + "amount: 2.5 limit: 0.5 unit: 'mm' first { program: 1 step: 2 } }");
}

TEST(ReportMessage, AToolBelowTheBlockHasItsPlace) {
  RunReport report;
  report.milling = {.below_mm = 7.0, .below_place = {.program = 8, .step = 9}};
  ExpectMessage(ToProto(kGantry, report, {}).milling(),
                "below_mm: 7 below_place { program: 8 step: 9 }");
}

// What did not happen has no place: no gouge, no deviation, no beam, no limit to have a share of.
// Told once: of the same code at the same place; another place, another code, or a place that is
// not known is another finding.
TEST(ReportMessage, FindingsOfTheTextAreNotToldAgain) {
  const auto at = [](ErrorCode code, int line) {
    return Diagnostic{
        .code = code, .severity = Severity::kAdvice, .where = {.line = line, .column = 2}};
  };
  v1::RunReport report;
  *report.add_diagnostics() = ToProto(at(ErrorCode::kRml1Clipped, 3));
  *report.add_diagnostics() = ToProto(at(ErrorCode::kRml1Clipped, 0));
  AddFindingsOfText({at(ErrorCode::kRml1Clipped, 3), at(ErrorCode::kRml1Clipped, 4),
                     at(ErrorCode::kRml1LogCut, 3), at(ErrorCode::kRml1Clipped, 0)},
                    {}, report);
  std::string told;
  for (const v1::Diagnostic& finding : report.diagnostics())
    told += finding.code() + "@" + std::to_string(finding.place().line()) + " ";
  EXPECT_EQ(told, "RML1-E8002@3 RML1-E8002@0 RML1-E8002@4 RML1-E8004@3 RML1-E8002@0 ");
}

// What there was no room for, too: a kind that the run counted is that of the text.
TEST(ReportMessage, KindsOfTheTextAreNotCountedAgain) {
  v1::RunReport report;
  SetUntold(Untold(40, ErrorCode::kRml1Clipped, 7), report);
  UntoldFindings of_text = Untold(40, ErrorCode::kRml1Clipped, 7);
  of_text.Add(Untold(2, ErrorCode::kShortFly, 3));
  AddFindingsOfText({}, of_text, report);
  EXPECT_EQ(report.diagnostics_dropped(), 42);
  ASSERT_EQ(report.gathered_size(), 2);
  EXPECT_EQ(report.gathered(0).count(), 40);
  EXPECT_EQ(report.gathered(1).code(), "OPT-E7314");
  EXPECT_EQ(report.gathered(1).count(), 2);
  EXPECT_EQ(report.gathered(1).last().line(), 4);
}

TEST(ReportMessage, WhatDidNotHappenIsNotThere) {
  RunReport report;
  report.milling = {.removed_mm3 = 1.0};
  report.tip_figures = {.name = "tip", .peak_speed = 5.0, .peak_acceleration = 6.0};
  const v1::RunReport message = ToProto(kGantry, report, {});
  EXPECT_FALSE(message.milling().has_gouge_place());
  EXPECT_FALSE(message.milling().has_below_place());
  EXPECT_FALSE(message.milling().has_pass_place());
  EXPECT_FALSE(message.milling().has_shank_place());
  EXPECT_FALSE(message.corners().has_deviation_place());
  EXPECT_FALSE(message.has_beam());
  EXPECT_FALSE(message.has_shortfall());
  EXPECT_FALSE(message.has_other_steps());
  EXPECT_FALSE(message.has_cut_box());
  EXPECT_EQ(message.axes(0).peak_speed_share(), 0.0);
  EXPECT_EQ(message.axes(0).peak_acceleration_share(), 0.0);
  report.programs[1] = {};
  EXPECT_FALSE(ToProto(kGantry, report, {}).programs(0).has_beam());
  report.cut_figures.contours = 1;
  ExpectMessage(ToProto(kGantry, report, {}).cut(), "contours: 1");
}

TEST(ReportMessage, ExtremesAreToldHoweverSmallTheyAre) {
  RunReport report;
  report.cut_figures.contours = 1;
  report.cut_figures.slow_percent.value = 0.5;
  report.cut_figures.near_end[3].value = 0.25;
  const v1::CutFigures cut = ToProto(kGantry, report, {}).cut();
  EXPECT_EQ(cut.slow_percent().value(), 0.5);
  EXPECT_FALSE(cut.has_hot_stretch_mm());
  ASSERT_EQ(cut.near_ends_size(), 1);
  EXPECT_EQ(cut.near_ends(0).axis(), "A");
  EXPECT_TRUE(cut.near_ends(0).rotary());
  EXPECT_EQ(cut.near_ends(0).depth(), 0.25);
}

TEST(ReportMessage, EachCauseOfASlowMoveHasItsWord) {
  using simulation::SlowCause;
  for (const auto& [cause, word] :
       {std::pair(SlowCause::kAxis, v1::SlowMove::CAUSE_AXIS),
        std::pair(SlowCause::kRadius, v1::SlowMove::CAUSE_RADIUS),
        std::pair(SlowCause::kShort, v1::SlowMove::CAUSE_SHORT),
        std::pair(SlowCause::kAcceleration, v1::SlowMove::CAUSE_ACCELERATION)}) {
    RunReport report;
    report.slow_moves = {{.cause = cause}};
    EXPECT_EQ(ToProto(kGantry, report, {}).slow_moves(0).cause(), word);
  }
}

simulation::TraceRecord Record(simulation::TraceKind kind) {
  return {.number = 3,
          .kind = kind,
          .at = Seconds(2),
          .place = {.program = 4, .step = 5, .line = 6, .byte_offset = 0},
          .text = "words",
          .tip = {{1, 2, 3}, 0.1, 0.2},
          .axes = {{4, 5, 6}, 0.5, 0.25},
          .program_point = {7, 8, 9},
          .program_a = 10.0,
          .program_b = 11.0,
          .feed_mm_s = 12.0,
          .signal = machine::Signal::kSpindle,
          .index = 13,
          .value = 14.0,
          .detail = 15.0,
          .wait = machine::WaitKind::kPierce,
          .duration = Seconds(16),
          .code = ErrorCode::kFlyReversal,
          .severity = Severity::kWarning,
          .outcome = machine::OutcomeKind::kStopped};
}

// Each kind of record carries its own fields and no others.
TEST(TraceMessage, EachKindHasItsFields) {
  using simulation::TraceKind;
  const auto expect = [](TraceKind kind, const std::string& more) {
    ExpectMessage(
        ToProto(kGantry, Record(kind)),
        "number: 3 virtual_time_ns: 2000000000 place { program: 4 step: 5 line: 6 byte_offset: 0 } " +
            more);
  };
  const std::string code = CodeText(ErrorCode::kFlyReversal);
  expect(
      TraceKind::kMove,
      "kind: KIND_MOVE text: 'words' point { x: 7 y: 8 z: 9 } program_axes { axis: 'A' value: 10 unit: UNIT_RADIAN } program_axes { axis: 'B' value: 11 unit: UNIT_RADIAN } position { tip "
      "{ x: 1 y: 2 z: 3 } column { x: 4 y: 5 z: 6 } turned { axis: 'A' value: 0.5 unit: UNIT_RADIAN } turned { axis: 'B' value: 0.25 unit: UNIT_RADIAN } } feed_mm_s: 12");
  expect(TraceKind::kSignal, "kind: KIND_SIGNAL text: 'spindle' index: 13 value: 14 detail: 15");
  expect(TraceKind::kWait, "kind: KIND_WAIT text: 'pierce' duration_ns: 16000000000");
  expect(TraceKind::kProgram, "kind: KIND_PROGRAM text: 'words' index: 13");
  expect(TraceKind::kHalt, "kind: KIND_HALT text: 'words'");
  expect(TraceKind::kResume, "kind: KIND_RESUME text: 'words'");
  expect(TraceKind::kMessage, "kind: KIND_MESSAGE text: 'words'");
  expect(TraceKind::kFinding,
         "kind: KIND_FINDING text: 'words' code: '" + code + "' severity: SEVERITY_WARNING");
  expect(TraceKind::kEnd, "kind: KIND_END text: 'stopped' code: '" + code + "'");
  simulation::TraceRecord end = Record(TraceKind::kEnd);
  end.code.reset();
  EXPECT_EQ(ToProto(kGantry, end).code(), "");
  // What says neither what it is nor why is a mistake of ours.
  simulation::TraceRecord finding = Record(TraceKind::kFinding);
  finding.code.reset();
  finding.text = {};
  EXPECT_EQ(ToProto(kGantry, finding).code(), "");
  EXPECT_EQ(ToProto(kGantry, finding).text(), "an internal error");
}

// A mill has one axis that turns, and its stream counts it in degrees; a machine may have none.
TEST(TraceMessage, NamesTheAxesThatTurn) {
  const simulation::TraceRecord move = Record(simulation::TraceKind::kMove);
  const v1::TraceRecord mill = ToProto({.axes = "X Y Z A", .turns_in_degrees = true}, move);
  ASSERT_EQ(mill.program_axes_size(), 1);
  ExpectMessage(mill.program_axes(0), "axis: 'A' value: 10 unit: UNIT_DEGREE");
  ASSERT_EQ(mill.position().turned_size(), 1);
  ExpectMessage(mill.position().turned(0), "axis: 'A' value: 0.5 unit: UNIT_RADIAN");
  const v1::TraceRecord flat = ToProto({.axes = "X Y Z"}, move);
  EXPECT_EQ(flat.program_axes_size() + flat.position().turned_size(), 0);
}

TEST(ProgressMessage, EveryFieldIsThere) {
  machine::RunState state{.time = std::chrono::nanoseconds(1),
                          .phase = machine::RunPhase::kHalted,
                          .place = {.program = 2, .step = 3},
                          .instruction = "MOVE",
                          .tip = {{4, 5, 6}, 0.5, 0.25},
                          .axes = {{7, 8, 9}, 0.75, 0.125},
                          .tip_speed_mm_s = 10.0,
                          .override_percent = 55.0,
                          .beam_on = true,
                          .progress = 0.0};
  ExpectMessage(
      ToProto(kGantry, state, 11),
      "virtual_time_ns: 1 steps: 11 place { program: 2 step: 3 } instruction: 'MOVE' "
      "position { tip { x: 4 y: 5 z: 6 } column { x: 7 y: 8 z: 9 } turned { axis: 'A' value: 0.75 unit: UNIT_RADIAN } turned { axis: 'B' value: 0.125 unit: UNIT_RADIAN } } "
      "speed_mm_s: 10 override_percent: 55 tool_on: true held: true progress: 0");
  state.phase = machine::RunPhase::kRunning;
  state.beam_on = false;
  state.progress = -1.0;
  EXPECT_FALSE(ToProto(kGantry, state, 0).held());
  EXPECT_FALSE(ToProto(kGantry, state, 0).tool_on());
  EXPECT_FALSE(ToProto(kGantry, state, 0).has_progress());
  state.spindle_on = true;
  EXPECT_TRUE(ToProto(kGantry, state, 0).tool_on());
}

}  // namespace
}  // namespace rmlcell::bridge
