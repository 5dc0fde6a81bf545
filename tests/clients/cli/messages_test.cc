// What people read of jobs, without colours.
#include "clients/cli/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "clients/cli/findings_text.h"

namespace rmlcell::cli {
namespace {

void AddTurned(const std::string& axis, double rad, v1::Position& position) {
  v1::AxisValue& turned = *position.add_turned();
  turned.set_axis(axis);
  turned.set_value(rad);
  turned.set_unit(v1::UNIT_RADIAN);
}

using testing::HasSubstr;
using testing::Not;

class Messages : public testing::Test {
 protected:
  Messages() { ::setenv("NO_COLOR", "1", 1); }
};

v1::JobEvent Event(int sequence) {
  v1::JobEvent event;
  event.set_sequence(sequence);
  return event;
}

TEST_F(Messages, StatesAreWords) {
  EXPECT_EQ(StateName(v1::Job::STATE_RUNNING), "running");
  EXPECT_EQ(StateName(v1::Job::STATE_SUCCEEDED), "succeeded");
  EXPECT_EQ(StateName(v1::Job::STATE_INTERRUPTED), "interrupted");
  v1::Job job;
  job.set_state(v1::Job::STATE_FAILED);
  EXPECT_EQ(StateName(job), "failed");
  job.mutable_outcome()->set_kind(v1::Outcome::KIND_STOPPED);
  EXPECT_EQ(StateName(job), "stopped");
}

TEST_F(Messages, AnOutcomeIsOneLine) {
  v1::Outcome outcome;
  EXPECT_EQ(OutcomeLine(outcome), "not ended");
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  outcome.mutable_place()->set_step(9);
  EXPECT_EQ(OutcomeLine(outcome), "completed");  // its end is no place to look at
  outcome.set_kind(v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(OutcomeLine(outcome), "cancelled (step 9)");
  outcome.set_kind(v1::Outcome::KIND_STOPPED);
  outcome.mutable_place()->set_program(44);
  EXPECT_EQ(OutcomeLine(outcome), "stopped (program 44 step 9)");
  outcome.set_kind(v1::Outcome::KIND_BUDGET_EXCEEDED);
  outcome.clear_place();
  outcome.set_code("CELL-E9304");
  EXPECT_EQ(OutcomeLine(outcome), "budget exceeded, CELL-E9304");
  outcome.set_kind(v1::Outcome::KIND_FAILED);
  outcome.set_code("OPT-E348");
  outcome.set_message("radius\nis 0");
  outcome.set_advice("give PATH HOLE a radius");
  outcome.mutable_place()->set_line(3);
  EXPECT_EQ(OutcomeLine(outcome),
            "failed, OPT-E348: radius\\x0Ais 0 (line 3); give PATH HOLE a radius");
}

TEST_F(Messages, AnEventIsOneLine) {
  v1::JobEvent event = Event(1);
  event.set_state(v1::Job::STATE_QUEUED);
  EXPECT_EQ(EventLine(event), "#1  queued");
  event = Event(12);
  event.set_virtual_time_ns(1'500'000'000);
  event.mutable_message()->set_text("a\tb");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  a\\x09b");
  event.mutable_halted()->set_message("STOP");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  halted: STOP");
  event.mutable_resumed();
  EXPECT_EQ(EventLine(event), "#12  1.500 s  resumed");
  event.mutable_program_loaded()->set_program(44);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  program 44");
  event.mutable_executable_made()->set_program(44);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  compiling program 44");
  event.mutable_input_applied()->set_caller("local");
  event.mutable_input_applied()->mutable_input()->set_override_percent(55.0);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  local: override 55 %");
  event.mutable_run_begun()->set_run(3);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  run 3 begins");
  event.mutable_queue()->set_priority(7);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  priority 7");
  event.mutable_queue()->set_held(true);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  held back");
  v1::Signal& signal = *event.mutable_signal();
  signal.set_kind(v1::SIGNAL_KIND_LOGICAL_OUTPUT);
  signal.set_name("output");
  signal.set_index(20);
  signal.set_value(1.0);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  output 20 = 1");
  signal.set_kind(v1::SIGNAL_KIND_BEAM);
  signal.set_name("beam");
  signal.set_detail(80.0);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  beam = 1 (80.0)");
  v1::GatheredFindings& gathered = *event.mutable_gathered();
  gathered.set_code("RML1-E8002");
  gathered.set_message("beyond the travel");
  gathered.set_count(195);
  gathered.mutable_first()->set_line(12);
  gathered.mutable_last()->set_line(300);
  EXPECT_EQ(EventLine(event),
            "#12  1.500 s  and 195 more RML1-E8002, lines 12 to 300: beyond the travel");
  event.mutable_ended()->set_kind(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  ended: completed");
  EXPECT_EQ(EventLine(Event(3)), "#3  ");
}

// Of a check, too, which ran nothing.
TEST_F(Messages, AReportNamesItsMachineAndWhatWasChangedOfIt) {
  v1::RunReport report;
  report.set_family("optimo");
  report.set_profile("efa-51");
  report.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  const std::string outcome = "outcome       completed\n";
  EXPECT_EQ(ReportText(report),
            outcome + "machine       Optimo with EFA-51 laser (efa-51): no profile was named\n");
  report.set_profile_named(true);
  const std::string machine = outcome + "machine       Optimo with EFA-51 laser (efa-51)\n";
  EXPECT_EQ(ReportText(report), machine);
  report.set_profile_changed_by("my\tfile.toml");
  EXPECT_EQ(ReportText(report), machine + "changed       nothing, by my\\x09file.toml\n");
  v1::ParameterChange& change = *report.add_profile_changes();
  change.set_name("VMAX");
  change.set_value("300");
  change.set_of_profile("500");
  EXPECT_EQ(ReportText(report),
            machine + "changed       VMAX 300 (profile: 500); by my\\x09file.toml\n");
}

TEST_F(Messages, AReportOfALaserHasItsFigures) {
  v1::RunReport report;
  report.set_family("optimo");
  report.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(ReportText(report), "outcome       completed\n");  // of a check: nothing ran
  v1::WorkFigures& total = *report.mutable_total();
  total.set_steps(17);
  total.mutable_times()->set_cycle_s(61.5);
  total.mutable_times()->set_motion_s(60.0);
  total.mutable_times()->set_dwell_s(1.5);
  total.set_path_length_mm(30.0);
  total.set_cut_length_mm(20.0);
  total.set_travel_length_mm(10.0);
  total.set_beam_on_s(2.0);
  total.set_beam_switches(3);
  total.set_pierces(4);
  total.set_energy_j(5000.0);
  report.mutable_final_position()->mutable_tip()->set_x(1.0);
  AddTurned("A", 0.5, *report.mutable_final_position());
  AddTurned("B", 0.0, *report.mutable_final_position());
  report.mutable_corners()->set_blended(6);
  report.mutable_corners()->set_stopped(7);
  report.set_lookahead_starved(8);
  report.set_motion_check("up to step 9");
  report.set_diagnostics_dropped(2);
  const std::string text = ReportText(report);
  EXPECT_THAT(text, HasSubstr("cycle time    1 min 1.500 s\n"));
  EXPECT_THAT(text, HasSubstr("motion 60.000 s, dwell 1.500 s\n"));
  EXPECT_THAT(text, HasSubstr("path          30.000 mm: cut 20.000, travel 10.000\n"));
  EXPECT_THAT(text,
              HasSubstr("beam          on 2.000 s, switched on 3 times, 4 pierces, 5000 J\n"));
  EXPECT_THAT(text, HasSubstr("corners       7 stops, 6 blended\n"));
  EXPECT_THAT(text, HasSubstr("look-ahead was too short 8 times\n"));
  EXPECT_THAT(text, HasSubstr("steps         17\n"));
  EXPECT_THAT(text, HasSubstr("final tip     1.000, 0.000, 0.000\n"));
  EXPECT_THAT(text, HasSubstr("final column  0.000, 0.000, 0.000  A 0.500000  B 0.000000\n"));
  EXPECT_THAT(text, HasSubstr("motion        checked up to step 9\n"));
  EXPECT_THAT(text, HasSubstr("and 2 more findings\n"));
  EXPECT_THAT(text, Not(HasSubstr("plunges")));
  EXPECT_THAT(text, Not(HasSubstr("J/mm")));
  EXPECT_THAT(text, Not(HasSubstr("travel        ")));  // no violation
}

TEST_F(Messages, AReportOfAMillHasItsOwn) {
  v1::RunReport report;
  report.set_family("rml1");
  report.mutable_total()->set_plunges(3);
  const auto figure = [&](const char* name, double value) {
    v1::Figure& made = *report.add_figures();
    made.set_name(name);
    made.set_value(value);
  };
  figure("tool_down_time", 4.0);
  figure("tool_up_time", 5.0);
  figure("clipped_length", 6.0);
  figure("speed_clamps", 7.0);
  report.mutable_milling()->set_removed_mm3(8.0);
  const std::string text = ReportText(report);
  EXPECT_THAT(text, HasSubstr("plunges       3\n"));
  EXPECT_THAT(text, HasSubstr("tool          up 5.000 s, down 4.000 s\n"));
  EXPECT_THAT(text, HasSubstr("clipped       6.000 mm beyond the cutting range\n"));
  EXPECT_THAT(text, HasSubstr("speeds        7 limited to those of the machine\n"));
  EXPECT_THAT(text, HasSubstr("material      8.000 mm3 removed\n"));
  EXPECT_THAT(text, Not(HasSubstr("motions at travel speed")));
  EXPECT_THAT(text, Not(HasSubstr("beam")));
}

// Of lists that may be long five are shown, and how many more there are.
TEST_F(Messages, LongListsAreCutAfterFive) {
  const auto text_of = [](int slow, int beyond) {
    v1::RunReport report;
    report.mutable_total();
    report.mutable_shortfall()->set_moves(slow);
    for (int i = 1; i <= slow; ++i) report.add_slow_moves()->mutable_place()->set_step(100 + i);
    for (int i = 1; i <= beyond; ++i) {
      v1::AxisViolation& violation = *report.add_violations();
      violation.mutable_place()->set_step(200 + i);
      violation.set_axis("X");
      violation.set_excess(1.5);
    }
    return ReportText(report);
  };
  const std::string five = text_of(5, 5);
  EXPECT_THAT(five, HasSubstr("step 105: "));
  EXPECT_THAT(five, HasSubstr("step 205: X by 1.500 mm on the way, at 0.000 s"));
  EXPECT_THAT(five, HasSubstr("travel        5 violations\n"));
  EXPECT_THAT(five, Not(HasSubstr("more")));
  const std::string seven = text_of(7, 7);
  EXPECT_THAT(seven, Not(HasSubstr("step 106: ")));
  EXPECT_THAT(seven, Not(HasSubstr("step 206: ")));
  EXPECT_THAT(seven, HasSubstr("and 2 more steps\n"));
  EXPECT_THAT(seven, HasSubstr("and 2 more\n"));
  EXPECT_THAT(text_of(0, 1), HasSubstr("travel        1 violation\n"));
}

void AddVariable(const std::string& name, const std::string& text, v1::RunReport& report) {
  v1::Variable& variable = *report.add_variables();
  variable.set_name(name);
  variable.set_text(text);
}

TEST_F(Messages, VariablesStandInOrder) {
  v1::RunReport report;
  report.mutable_total();
  for (const char* name : {"VR[10]", "VI[1]", "VR[2]"}) AddVariable(name, "0.", report);
  const std::string text = ReportText(report);
  EXPECT_LT(text.find("VI[1]"), text.find("VR[2]"));
  EXPECT_LT(text.find("VR[2]"), text.find("VR[10]"));
}

// All that the report of a laser can say, in its order. Each figure has a value of its own.
void SetEachTime(v1::RunTimes& times) {
  times.set_cycle_s(45.0);
  times.set_motion_s(1.0);
  times.set_settling_s(2.0);
  times.set_dwell_s(3.0);
  times.set_pierce_s(4.0);
  times.set_condition_s(5.0);
  times.set_operator_s(6.0);
  times.set_spin_up_s(7.0);
  times.set_load_s(8.0);
  times.set_standstill_s(9.0);
}

TEST_F(Messages, AWholeReportOfALaser) {
  v1::RunReport report;
  report.set_family("optimo");
  report.mutable_outcome()->set_kind(v1::Outcome::KIND_STOPPED);
  v1::WorkFigures& total = *report.mutable_total();
  SetEachTime(*total.mutable_times());
  total.set_path_length_mm(21.0);
  total.set_cut_length_mm(11.5);
  total.set_travel_length_mm(9.5);
  total.set_beam_on_s(12.25);
  total.set_beam_switches(13);
  total.set_pierces(14);
  total.set_energy_j(1516.4);
  total.set_energy_j_per_mm(17.125);
  total.set_energy_j_per_mm_max(18.25);
  total.set_steps(19);
  v1::CornerFigures& corners = *report.mutable_corners();
  corners.set_stopped(1);
  corners.set_stopped_with_fly(2);
  corners.set_reversed(3);
  corners.set_through(4);
  corners.set_blended(5);
  corners.set_capped(6);
  corners.set_deviation_mm_max(0.125);
  corners.mutable_deviation_place()->set_program(44);
  corners.mutable_deviation_place()->set_step(22);
  corners.mutable_deviation_place()->set_line(23);
  corners.mutable_deviation_point()->set_x(1.0);
  corners.mutable_deviation_point()->set_y(2.0);
  corners.mutable_deviation_point()->set_z(3.0);
  v1::SpeedShortfall& shortfall = *report.mutable_shortfall();
  shortfall.set_moves(10);
  shortfall.set_by_axis(1);
  shortfall.set_by_radius(2);
  shortfall.set_too_short(3);
  shortfall.set_by_acceleration(4);
  report.set_slow_moves_dropped(7);
  v1::SlowMove& slow = *report.add_slow_moves();
  slow.mutable_place()->set_step(24);
  slow.set_reached_mm_s(25.5);
  slow.set_wanted_mm_s(26.5);
  slow.set_cause(v1::SlowMove::CAUSE_AXIS);
  slow.set_axis("A");
  slow.set_count(27);
  v1::SlowMove& once = *report.add_slow_moves();
  once.mutable_place()->set_line(28);
  once.set_reached_mm_s(1.0);
  once.set_wanted_mm_s(2.0);
  once.set_cause(v1::SlowMove::CAUSE_RADIUS);
  once.set_count(1);
  const auto axis = [&](const std::string& name, bool rotary, double speed, double share,
                        double acceleration) {
    v1::AxisFigures& made = *report.add_axes();
    made.set_axis(name);
    made.set_rotary(rotary);
    made.set_peak_speed(speed);
    made.set_peak_speed_share(share);
    made.set_peak_acceleration(acceleration);
  };
  axis("X", false, 100.5, 0.5, 200.5);
  axis("Y", false, 0.0, 0.0, 0.0);  // never moved
  axis("A", true, 1.25, 0.0, 2.5);
  report.mutable_axes(2)->set_peak_acceleration_share(0.25);
  v1::AxisViolation& violation = *report.add_violations();
  violation.mutable_place()->set_step(31);
  violation.set_axis("B");
  violation.set_rotary(true);
  violation.set_excess(0.5);
  violation.set_at_target(true);
  violation.set_time_s(32.5);
  report.set_violations_dropped(5);
  v1::Position& end = *report.mutable_final_position();
  end.mutable_tip()->set_x(33.0);
  end.mutable_tip()->set_y(34.0);
  end.mutable_tip()->set_z(35.0);
  end.mutable_column()->set_x(36.0);
  end.mutable_column()->set_y(37.0);
  end.mutable_column()->set_z(38.0);
  AddTurned("A", 0.25, end);
  AddTurned("B", 0.75, end);
  report.mutable_tip_box()->mutable_low()->set_x(-1.0);
  report.mutable_tip_box()->mutable_high()->set_y(2.0);
  AddVariable("VR[2]", "39.", report);
  report.set_motion_check("only up to step 2");
  EXPECT_EQ(
      ReportText(report),
      "outcome       stopped\n"
      "machine       Amada OPTIMO 5-axis laser\n"
      "cycle time    45.000 s\n"
      "              motion 1.000 s, settling 2.000 s, dwell 3.000 s, pierce 4.000 s, condition 5.000 s, "
      "operator 6.000 s, spin-up 7.000 s, loading 8.000 s, standstill 9.000 s\n"
      "path          21.000 mm: cut 11.500, travel 9.500\n"
      "beam          on 12.250 s, switched on 13 times, 14 pierces, 1516 J\n"
      "              17.125 J/mm, of a step at most 18.250\n"
      "corners       1 stops, 2 stops with /FLY, 3 reversals with /FLY, 4 straight on, 5 blended, "
      "6 blended slower\n"
      "              deviation up to 0.125 mm at program 44 step 22 line 23, 1.000, 2.000, 3.000\n"
      "too slow      10 moves below their SPEED: axis 1, radius 2, too short 3, acceleration 4\n"
      "              step 24: 25.500 of 26.500 mm/s, axis A (27 times)\n"
      "              line 28: 1.000 of 2.000 mm/s, radius\n"
      "              and 4 more steps\n"
      "peak speed    X 100.5 (50 %), A 1.250\n"
      "peak accel.   X 200.5, A 2.500 (25 %)\n"
      "travel        6 violations\n"
      "              step 31: B by 0.500 rad at the target, at 32.500 s\n"
      "              and 1 more\n"
      "steps         19\n"
      "final tip     33.000, 34.000, 35.000\n"
      "final column  36.000, 37.000, 38.000  A 0.250000  B 0.750000\n"
      "tip box       -1.000, 0.000, 0.000  to  0.000, 2.000, 0.000\n"
      "VR[2]         39.\n"
      "motion        checked only up to step 2\n");
}

// What did not happen is not spoken of, and a mill has no head.
TEST_F(Messages, AWholeReportOfAMill) {
  v1::RunReport report;
  report.set_family("rml1");
  report.set_profile("srm-20");
  report.set_profile_named(true);
  v1::Outcome& outcome = *report.mutable_outcome();
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  outcome.set_verdict(v1::VERDICT_BAD);
  v1::VerdictReason& first = *outcome.add_reasons();
  first.set_message("3 motions");
  first.set_code("CELL-E9601");
  first.set_advice("lift the tool");
  first.mutable_first()->set_step(4);
  v1::VerdictReason& second = *outcome.add_reasons();
  second.set_message("deep");
  second.set_code("RML1-E8002");
  report.mutable_total()->set_plunges(2);
  v1::MillingFigures& milling = *report.mutable_milling();
  milling.set_removed_mm3(1.5);
  milling.set_gouges(3);
  milling.set_gouge_depth_mm(0.25);
  milling.mutable_gouge_place()->set_step(4);
  milling.set_gouge_time_s(5.5);
  EXPECT_EQ(
      ReportText(report),
      "verdict       BAD\n"
      "              3 motions (CELL-E9601, step 4); lift the tool\n"
      "              deep (RML1-E8002)\n"
      "outcome       completed\n"
      "machine       Roland monoFab SRM-20 (srm-20)\n"
      "cycle time    0.000 s\n"
      "path          0.000 mm: cut 0.000, travel 0.000\n"
      "plunges       2\n"
      "material      1.500 mm3 removed\n"
      "              3 motions at travel speed through material, up to 0.250 mm deep at step 4, at 5.500 s\n"
      "steps         0\n"
      "final tip     0.000, 0.000, 0.000\n");
}

TEST_F(Messages, AnAxisHasItsUnit) {
  v1::AxisValue axis;
  axis.set_axis("A");
  axis.set_value(0.123456);
  axis.set_unit(v1::UNIT_RADIAN);
  EXPECT_EQ(AxisText(axis), "A 0.1235 rad");
  axis.set_unit(v1::UNIT_MILLIMETRE);
  EXPECT_EQ(AxisText(axis), "A 0.123 mm");
}

TEST_F(Messages, AnEndHasItsVerdict) {
  v1::JobEvent event = Event(9);
  event.mutable_ended()->set_kind(v1::Outcome::KIND_COMPLETED);
  event.mutable_ended()->set_verdict(v1::VERDICT_BAD);
  event.mutable_ended()->add_reasons()->set_message("too deep");
  EXPECT_EQ(EventLine(event), "#9  ended: completed; verdict BAD, too deep");
  event.mutable_products_made()->set_verdict(v1::VERDICT_GOOD);
  EXPECT_EQ(EventLine(event), "#9  report and pictures are made; verdict GOOD");
}

// A name that is longer than its column keeps a blank behind it.
TEST_F(Messages, LongNamesKeepABlank) {
  v1::RunReport report;
  report.mutable_total();
  AddVariable("VARIABLE[123]", "a", report);
  AddVariable("VARIABLE[123456]", "b", report);
  EXPECT_THAT(ReportText(report), HasSubstr("VARIABLE[123] a\nVARIABLE[123456] b\n"));
}

// While a program runs nothing is judged: advice may be what makes its verdict BAD.
TEST_F(Messages, AnEventCallsNothingMereAdvice) {
  v1::JobEvent event = Event(1);
  v1::Diagnostic& finding = *event.mutable_diagnostic();
  finding.set_code("RML1-E8002");
  finding.set_severity(v1::SEVERITY_ADVICE);
  finding.set_message("lost");
  finding.mutable_place()->set_file("a.rml");
  EXPECT_EQ(EventLine(event), "#1  a.rml: RML1-E8002: lost");
  finding.set_verdict(v1::VERDICT_BAD);
  EXPECT_EQ(EventLine(event), "#1  a.rml: BAD RML1-E8002: lost");
  finding.clear_verdict();
  finding.set_severity(v1::SEVERITY_WARNING);
  EXPECT_EQ(EventLine(event), "#1  a.rml: warning RML1-E8002: lost");
}

TEST_F(Messages, AFindingIsOneLineWithItsCount) {
  v1::Diagnostic finding;
  finding.set_code("OPT-E7004");
  finding.set_message("x");
  finding.set_count(1);
  const std::string once = FindingLine(finding);
  EXPECT_THAT(once, HasSubstr("OPT-E7004"));
  EXPECT_THAT(once, Not(HasSubstr("times")));
  finding.set_count(2);
  EXPECT_EQ(FindingLine(finding), once + " (2 times)");
  v1::JobEvent event = Event(4);
  *event.mutable_diagnostic() = finding;
  EXPECT_EQ(EventLine(event), "#4  " + once + " (2 times)");
  v1::RunReport report;
  *report.add_diagnostics() = finding;
  EXPECT_EQ(ReportText(report), "outcome       not ended\n" + once + " (2 times)\n");
}

// However little there is of it, it is told: nothing alone is left out.
TEST_F(Messages, TheLeastThatIsTold) {
  v1::JobEvent event = Event(1);
  event.set_virtual_time_ns(1);
  event.mutable_signal()->set_name("beam");
  event.mutable_signal()->set_detail(1.0);
  EXPECT_EQ(EventLine(event), "#1  0.000 s  beam = 0 (1.0)");
  v1::RunReport laser;
  laser.set_family("optimo");
  v1::Outcome& outcome = *laser.mutable_outcome();
  outcome.set_kind(v1::Outcome::KIND_FAILED);
  outcome.mutable_place()->set_program(1);
  outcome.mutable_place()->set_step(1);
  outcome.mutable_place()->set_line(1);
  laser.mutable_total()->set_energy_j_per_mm(0.5);
  laser.set_lookahead_starved(1);
  laser.set_diagnostics_dropped(1);
  laser.mutable_shortfall()->set_moves(1);
  laser.mutable_shortfall()->set_too_short(1);
  laser.set_slow_moves_dropped(6);
  v1::AxisFigures& axis = *laser.add_axes();
  axis.set_axis("Z");
  axis.set_peak_speed(0.5);
  axis.set_peak_speed_share(0.01);
  axis.set_peak_acceleration(0.5);
  const std::string text = ReportText(laser);
  EXPECT_THAT(text, HasSubstr("outcome       failed (program 1 step 1 line 1)\n"));
  EXPECT_THAT(text, HasSubstr("0.500 J/mm, of a step at most 0.000\n"));
  EXPECT_THAT(text, HasSubstr("look-ahead was too short 1 times\n"));
  EXPECT_THAT(text, HasSubstr("too slow      1 moves below their SPEED: too short 1\n"));
  EXPECT_THAT(text, HasSubstr("and 1 more steps\n"));
  EXPECT_THAT(text, HasSubstr("peak speed    Z 0.5 (1 %)\n"));
  EXPECT_THAT(text, HasSubstr("peak accel.   Z 0.5\n"));
  EXPECT_THAT(text, HasSubstr("and 1 more finding\n"));
  v1::RunReport mill;
  mill.set_family("rml1");
  mill.mutable_total();
  for (const char* name : {"clipped_length", "speed_clamps"}) {
    v1::Figure& figure = *mill.add_figures();
    figure.set_name(name);
    figure.set_value(1.0);
  }
  mill.mutable_milling()->set_gouges(1);
  EXPECT_THAT(ReportText(mill), HasSubstr("clipped       1.000 mm beyond the cutting range\n"));
  EXPECT_THAT(ReportText(mill), HasSubstr("speeds        1 limited to those of the machine\n"));
  EXPECT_THAT(ReportText(mill), HasSubstr("1 motions at travel speed through material"));
}

// Of many findings of one kind five are shown, and the others told in one line.
TEST_F(Messages, FindingsOfOneKindAreCounted) {
  v1::RunReport report;
  for (int line = 1; line <= 7; ++line) {
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code("RML1-E1");
    finding.set_message("here");
    finding.mutable_place()->set_line(line);
  }
  report.add_diagnostics()->set_code("RML1-E2");
  const std::string text = ReportText(report);
  EXPECT_NE(text.find("\n5: "), std::string::npos) << text;
  EXPECT_EQ(text.find("\n6: "), std::string::npos) << text;
  EXPECT_NE(text.find("RML1-E2"), std::string::npos);
  EXPECT_NE(text.find("\nand 2 more RML1-E1, lines 6 to 7\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace rmlcell::cli
