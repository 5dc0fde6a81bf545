// What people read of jobs, without colours.
#include "clients/cli/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace rmlcell::cli {
namespace {

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
  event.set_message("a\tb");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  a\\x09b");
  event.set_halted("STOP");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  halted: STOP");
  event.set_resumed("START");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  resumed");
  event.set_milestone("call program 44");
  EXPECT_EQ(EventLine(event), "#12  1.500 s  call program 44");
  v1::TraceRecord& signal = *event.mutable_signal();
  signal.set_text("output");
  signal.set_index(20);
  signal.set_value(1.0);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  output 20 = 1");
  signal.set_text("beam");
  signal.set_detail(80.0);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  beam = 1 (80.0)");
  event.mutable_ended()->set_kind(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(EventLine(event), "#12  1.500 s  ended: completed");
  EXPECT_EQ(EventLine(Event(3)), "#3  ");
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
  report.mutable_final_position()->set_a(0.5);
  report.mutable_corners()->set_blended(6);
  report.mutable_corners()->set_stopped(7);
  report.set_lookahead_starved(8);
  report.set_motion_check("up to step 9");
  report.set_diagnostics_dropped(2);
  const std::string text = ReportText(report);
  EXPECT_THAT(text, HasSubstr("cycle time    1 min 1.500 s\n"));
  EXPECT_THAT(text, HasSubstr("motion 60.000 s, dwell 1.500 s\n"));
  EXPECT_THAT(text, HasSubstr("path          30.000 mm: cut 20.000, travel 10.000\n"));
  EXPECT_THAT(text, HasSubstr("beam          on 2.000 s, switched on 3 times, 4 pierces, 5000 J\n"));
  EXPECT_THAT(text, HasSubstr("corners       7 stops, 6 blended\n"));
  EXPECT_THAT(text, HasSubstr("look-ahead was too short 8 times\n"));
  EXPECT_THAT(text, HasSubstr("steps         17\n"));
  EXPECT_THAT(text, HasSubstr("final tip     1.000, 0.000, 0.000\n"));
  EXPECT_THAT(text, HasSubstr("final column  0.000, 0.000, 0.000  A 0.500000  B 0.000000\n"));
  EXPECT_THAT(text, HasSubstr("motion        checked up to step 9\n"));
  EXPECT_THAT(text, HasSubstr("and 2 more findings\n"));
  EXPECT_THAT(text, Not(HasSubstr("plunges")));
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
  EXPECT_THAT(text, HasSubstr("tool          down 4.000 s, up 5.000 s\n"));
  EXPECT_THAT(text, HasSubstr("clipped       6.000 mm beyond the cutting range\n"));
  EXPECT_THAT(text, HasSubstr("speeds        7 limited to those of the machine\n"));
  EXPECT_THAT(text, HasSubstr("material      8.000 mm3 taken off\n"));
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

TEST_F(Messages, VariablesStandInOrder) {
  v1::RunReport report;
  report.mutable_total();
  for (const char* name : {"VR[10]", "VI[1]", "VR[2]"}) (*report.mutable_variables())[name] = "0.";
  const std::string text = ReportText(report);
  EXPECT_LT(text.find("VI[1]"), text.find("VR[2]"));
  EXPECT_LT(text.find("VR[2]"), text.find("VR[10]"));
}

}  // namespace
}  // namespace rmlcell::cli
