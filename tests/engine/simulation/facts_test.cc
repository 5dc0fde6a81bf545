#include "engine/simulation/report/facts.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "engine/families/families.h"

namespace rmlcell::simulation {
namespace {

RunReport SomeReport() {
  RunReport report;
  report.family = "rml1";
  report.title = "two\nlines";
  report.finished = true;
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kHoleRadiusZero,
                    .detail = "radius is 0",
                    .place = {.program = 45, .step = 7, .line = 9}};
  report.cycle_time = FromSeconds(12.5);
  report.total.time.motion = FromSeconds(10.25);
  report.total.cut_mm = 264.1421356237;
  report.total.pierces = 3;
  report.total.cut_energy_j = 5625.0;
  report.total.pierce_energy_j = 750.0;
  report.tip.Add(motion::MachineVector{-1, 2, 3});
  report.changed_parameters = {{"LASER", "EFA51"}, {"VMAX", "423.333"}};
  AxisFigures a{.name = "A", .rotary = true, .travel = 6.28, .minimum = -3.14, .maximum = 3.14};
  report.axes = {a};
  Finding finding;
  finding.diagnostic.code = ErrorCode::kSpeedLimited;
  finding.diagnostic.severity = Severity::kWarning;
  finding.diagnostic.program = 45;
  finding.diagnostic.step = 2;
  finding.count = 4;
  report.findings = {finding};
  report.figures = {{"programmed.cut_length", "mm", 617.412}};
  return report;
}

std::map<std::string, std::string> MapOf(const RunReport& report) {
  std::map<std::string, std::string> map;
  for (const Fact& fact : Facts(report)) {
    EXPECT_TRUE(map.emplace(fact.key, fact.value).second) << fact.key << " twice";
    EXPECT_FALSE(fact.value.empty()) << fact.key;
    EXPECT_EQ(fact.value.find('\n'), std::string::npos) << fact.key;
  }
  return map;
}

TEST(Facts, ValuesInTheUnitsOfTheirKeys) {
  auto facts = MapOf(SomeReport());
  EXPECT_EQ(facts["outcome"], "failed");
  EXPECT_EQ(facts["outcome_code"], "OPT-E348");
  EXPECT_EQ(facts["outcome_program"], "45");
  EXPECT_EQ(facts["outcome_step"], "7");
  EXPECT_EQ(facts["outcome_line"], "9");
  EXPECT_EQ(facts["cycle_time_s"], "12.5");
  EXPECT_EQ(facts["motion_time_s"], "10.25");
  EXPECT_EQ(facts["cut_length_mm"], "264.142136");
  EXPECT_EQ(facts["pierces"], "3");
  EXPECT_EQ(facts["energy_j"], "6375.0");
  EXPECT_EQ(facts["tip_x_min_mm"], "-1.0");
  EXPECT_EQ(facts["cut_x_min_mm"], "none");
  EXPECT_EQ(facts["axis_a_max_rad"], "3.14");
  EXPECT_EQ(facts["axis_b_max_rad"], "none");
  EXPECT_EQ(facts["warnings"], "4");
  EXPECT_EQ(facts["errors"], "0");
  EXPECT_EQ(facts["findings"], "OPT-E7320@45/2x4");
  EXPECT_EQ(facts["changed_parameters"], "LASER=EFA51 VMAX=423.333");
  EXPECT_EQ(facts["title"], "two lines");
  EXPECT_EQ(facts["rml1.programmed.cut_length"], "617.412");
}

// motion.md 8.2: every figure of the report has a key.
TEST(Facts, FiguresOfSection82) {
  RunReport report;
  report.finished = true;
  report.beam.by_speed[0] = FromSeconds(1.048);
  report.beam.by_speed[2] = FromSeconds(4.5);
  report.beam.by_power[19] = FromSeconds(2.0);
  report.corners.deviation_mm_max = 1.5;
  report.corners.deviation_place = {.program = 45, .step = 9};
  report.lookahead_starved = 2;
  report.shortfall = {.moves = 4, .by_axis = 1, .by_radius = 1, .too_short = 2};
  report.tip_figures = {.name = "tip", .peak_speed = 125.0, .speed_limit = 500.0};
  report.axes = {{.name = "X", .peak_speed = 50.0, .peak_jerk = 40000.0, .speed_limit = 200.0}};
  report.violations = {{.place = {.program = 45, .step = 3}, .axis = "X", .excess = 12.5}};
  auto facts = MapOf(report);
  EXPECT_EQ(facts["beam_on_standing_s"], "1.048");
  EXPECT_EQ(facts["beam_on_speed_010_s"], "4.5");
  EXPECT_EQ(facts["beam_on_power_100_s"], "2.0");
  EXPECT_EQ(facts["corners_deviation_at"], "45/9");
  EXPECT_EQ(facts["lookahead_starved"], "2");
  EXPECT_EQ(facts["feed_not_reached"], "4");
  EXPECT_EQ(facts["feed_held_by_length"], "2");
  EXPECT_EQ(facts["tip_peak_speed_share"], "0.25");
  EXPECT_EQ(facts["axis_x_peak_speed_share"], "0.25");
  EXPECT_EQ(facts["axis_x_peak_acceleration_share"], "none");
  EXPECT_EQ(facts["axis_x_peak_jerk_mm_s3"], "40000.0");
  EXPECT_EQ(facts["violations"], "1");
  EXPECT_EQ(facts["violation_list"], "X@45/3:12.5");
}

TEST(Facts, RunOnTheWay) {
  auto facts = MapOf(RunReport{});
  EXPECT_EQ(facts["outcome"], "running");
  EXPECT_EQ(facts["outcome_code"], "none");
  EXPECT_EQ(facts["outcome_line"], "none");
}

TEST(Facts, TextIsOneFactALine) {
  const std::string text = FactsText(SomeReport());
  EXPECT_NE(text.find("\ncycle_time_s: 12.5\n"), std::string::npos);
  EXPECT_EQ(text.back(), '\n');
}

std::string PageOfTheDocuments() {
  std::ifstream file(RMLCELL_SOURCE_DIR "/docs/facts.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

// Issue 2: keys and units stand in docs/facts.md. The page lists exactly the keys that can be
// printed: those of the table and those that families declare.
TEST(Facts, DocumentListsExactlyTheKeys) {
  std::set<std::string> printed;
  for (const Fact& fact : Facts(RunReport{})) printed.insert(fact.key);
  for (const machine::MachineFamily* family : families::Families()) {
    for (const machine::FigureInfo& figure : family->figures()) {
      printed.insert(std::string(family->info().id) + '.' + std::string(figure.name));
    }
  }
  std::set<std::string> listed;
  const std::string page = PageOfTheDocuments();
  const std::string begin = "\n| `";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at + 1)) {
    const std::size_t key = at + begin.size();
    EXPECT_TRUE(listed.insert(page.substr(key, page.find('`', key) - key)).second);
  }
  EXPECT_EQ(listed, printed);
  EXPECT_GT(listed.size(), 100u);
}

// The page is made from the table. When this fails, facts.md beside the test binary is the new
// page.
TEST(Facts, DocumentIsUpToDate) {
  const std::string page = FactsPage();
  const bool same = PageOfTheDocuments() == page;
  if (!same) std::ofstream("facts.md") << page;
  EXPECT_TRUE(same) << "copy facts.md from the folder of this run to docs/";
}

// The unit of a key is the end of its name, so that a reader cannot mix them up.
TEST(Facts, UnitsEndTheKeys) {
  const std::map<std::string_view, std::string_view> endings = {
      {"s", "_s"},         {"mm", "_mm"},         {"J", "_j"},         {"J/mm", "_j_per_mm"},
      {"rad", "_rad"},     {"mm3", "_mm3"},       {"mm/s", "_mm_s"},   {"mm/s2", "_mm_s2"},
      {"rad/s", "_rad_s"}, {"rad/s2", "_rad_s2"}, {"mm/s3", "_mm_s3"}, {"rad/s3", "_rad_s3"},
      {"bytes", "_bytes"}, {"%", "_percent"},     {"deg", "_deg"}};
  for (const FactKey& key : FactKeys()) {
    if (key.unit.empty()) continue;
    ASSERT_TRUE(endings.contains(key.unit)) << key.unit;
    EXPECT_TRUE(key.key.ends_with(endings.at(key.unit))) << key.key;
  }
}

}  // namespace
}  // namespace rmlcell::simulation
