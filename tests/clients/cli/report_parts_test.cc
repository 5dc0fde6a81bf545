// What people read of a report: its parts, without colours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "clients/cli/messages.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

class ReportParts : public testing::Test {
 protected:
  ReportParts() { ::setenv("NO_COLOR", "1", 1); }
};

// The five that take longest, in the order of time where they take the same.
TEST_F(ReportParts, ContoursOfALaser) {
  v1::RunReport report;
  report.mutable_total();
  const auto add = [&](int step, double time_s) -> v1::Contour& {
    v1::Contour& contour = *report.add_contours();
    contour.mutable_place()->set_step(step);
    contour.set_time_s(time_s);
    return contour;
  };
  add(1, 2.0).set_length_mm(10.5);
  v1::Contour& longest = add(2, 6.0);
  longest.set_length_mm(100.0);
  longest.set_slow_length_mm(3.25);
  longest.set_energy_j(1500.4);
  longest.set_pierce_energy_j(450.0);
  add(3, 2.0);
  EXPECT_THAT(ReportText(report), Not(HasSubstr("J/mm")));
  EXPECT_THAT(ReportText(report),
              HasSubstr("contours      3\n"
                        "              step 2: 6.000 s, 100.000 mm, 1500 J, 450 of them while it "
                        "stands, 3.250 mm slow\n"
                        "              step 1: 2.000 s, 10.500 mm, 0 J\n"
                        "              step 3: 2.000 s, 0.000 mm, 0 J\n"
                        "steps"));
  for (int step = 4; step <= 5; ++step) add(step, 3.0);
  EXPECT_THAT(ReportText(report), HasSubstr("contours      5\n"));  // all of them are listed
  add(6, 3.0);
  report.set_contours_dropped(2);
  const std::string text = ReportText(report);
  EXPECT_THAT(text, HasSubstr("contours      8, the longest:\n              step 2: "));
  EXPECT_THAT(text, HasSubstr("step 6: 3.000 s, 0.000 mm, 0 J\n              step 1: "));
  EXPECT_THAT(text, Not(HasSubstr("step 3:")));
}

// From the origin of the work, unless those of the machine are wanted.
TEST_F(ReportParts, PositionsAreThoseOfTheWorkOrOfTheMachine) {
  v1::RunReport report;
  report.set_family("rml1");
  report.mutable_total();
  const auto set = [](double x, double y, double z, v1::Point& point) {
    point.set_x(x);
    point.set_y(y);
    point.set_z(z);
  };
  set(11.0, 22.0, 33.0, *report.mutable_final_position()->mutable_tip());
  set(10.0, 20.0, 30.0, *report.mutable_tip_box()->mutable_low());
  set(12.0, 24.0, 36.0, *report.mutable_tip_box()->mutable_high());
  set(10.0, 20.0, 30.0, *report.mutable_work_origin());
  EXPECT_THAT(ReportText(report, Zero::kWork),
              HasSubstr("final tip     1.000, 2.000, 3.000\n"
                        "tip box       0.000, 0.000, 0.000  to  2.000, 4.000, 6.000\n"
                        "work origin   10.000, 20.000, 30.000 on the machine; positions are from "
                        "the work origin\n"));
  EXPECT_THAT(ReportText(report, Zero::kMachine),
              HasSubstr("final tip     11.000, 22.000, 33.000\n"
                        "tip box       10.000, 20.000, 30.000  to  12.000, 24.000, 36.000\n"
                        "work origin   10.000, 20.000, 30.000 on the machine; positions are from "
                        "the zero of the machine\n"));
}

// What is left of a block, and how the cut went, in lines of their own; none for what is not there.
TEST_F(ReportParts, AMillTellsOfItsBlock) {
  v1::RunReport report;
  report.set_family("rml1");
  report.mutable_total()->set_plunges(1);
  v1::MillingFigures& milling = *report.mutable_milling();
  milling.set_removed_mm3(1.5);
  EXPECT_THAT(ReportText(report), Not(HasSubstr("target")));
  milling.set_remaining_mm3(98.5);
  milling.set_deepest_cut_mm(2.5);
  milling.set_deepest_pass_mm(1.25);
  milling.mutable_pass_place()->set_step(4);
  milling.set_shank_depth_mm(0.5);
  milling.mutable_shank_place()->set_step(5);
  v1::TargetFigures& target = *milling.mutable_target();
  target.set_good_percent(97.5);
  target.set_compared_mm2(60.0);
  target.set_tolerance_mm(0.1);
  target.set_deep_mm(0.75);
  target.set_deep_x_mm(1.0);
  target.set_deep_y_mm(2.0);
  target.set_deep_mm3(0.25);
  EXPECT_THAT(
      ReportText(report),
      HasSubstr(
          "material      1.500 mm3 removed\n"
          "              98.500 mm3 left, the deepest cut 2.500 mm below the top\n"
          "              deepest pass 1.250 mm at step 4\n"
          "              shank or holder 0.500 mm in material at step 5\n"
          "target        97.50 % of 60.0 mm2 within 0.100 mm\n"
          "              too deep by up to 0.750 mm at X 1.000, Y 2.000; 0.250 mm3 in all\n"));
  EXPECT_THAT(ReportText(report), Not(HasSubstr("too much left")));
}

}  // namespace
}  // namespace rmlcell::cli
