// Chip loads: the table by hand, what a run has of them, and what a verdict says.
#include "engine/simulation/material/chip_load.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

constexpr const char* kTin =
    "[tin]\nsource = 'measured'\ndiameter_mm = [1, 3]\nleast_mm = [0.01, 0.02]\n"
    "most_mm = [0.1, 0.3]\nspeed_most_m_min = 100\nplunge_share = 0.4\n";

// Half way between two rows half of each; below the first row and above the last in proportion.
TEST(ChipLoad, GoesByTheDiameter) {
  const auto tables = ReadChipTables(kTin);
  ASSERT_TRUE(tables);
  ASSERT_EQ(tables->size(), 1U);
  const ChipTable& tin = tables->front();
  EXPECT_EQ(tin.material, "tin");
  EXPECT_EQ(tin.source, "measured");
  const auto expect = [&](double diameter, double least, double most) {
    EXPECT_NEAR(tin.For(diameter).least_mm, least, 1e-12) << diameter;
    EXPECT_NEAR(tin.For(diameter).most_mm, most, 1e-12) << diameter;
    EXPECT_EQ(tin.For(diameter).speed_most_m_min, 100.0);
    EXPECT_NEAR(tin.For(diameter).plunge_most_mm, 0.4 * most, 1e-12) << diameter;
  };
  expect(1, 0.01, 0.1);
  expect(2, 0.015, 0.2);
  expect(3, 0.02, 0.3);
  expect(0.5, 0.005, 0.05);
  expect(6, 0.04, 0.6);
}

TEST(ChipLoad, TellsWhatIsWrongWithATable) {
  const auto fault = [](std::string text, const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
    const auto read = ReadChipTables(text);
    EXPECT_FALSE(read) << text;
    EXPECT_TRUE(!read && read.error().code == ErrorCode::kCellBadText) << text;
    return read ? Detail() : read.error().detail;
  };
  EXPECT_EQ(fault(kTin, "source = 'measured'\n", ""), "chip_loads.toml:1: tin has no source");
  EXPECT_EQ(fault(kTin, "'measured'", "''"), "chip_loads.toml:1: tin has no source");
  EXPECT_EQ(fault(kTin, "speed_most_m_min = 100", ""),
            "chip_loads.toml:1: tin has no speed_most_m_min above 0");
  const std::string share = "chip_loads.toml:1: tin has no plunge_share above 0 and up to 1";
  EXPECT_EQ(fault(kTin, "plunge_share = 0.4", ""), share);
  EXPECT_EQ(fault(kTin, "0.4", "0"), share);
  EXPECT_EQ(fault(kTin, "0.4", "1.01"), share);
  EXPECT_EQ(fault(kTin, "= 100", "= 0"), "chip_loads.toml:1: tin has no speed_most_m_min above 0");
  const std::string lists =
      "chip_loads.toml:1: tin: diameter_mm, least_mm and most_mm are lists of one length, of "
      "numbers that rise";
  EXPECT_EQ(fault(kTin, "[1, 3]", "[3, 1]"), lists);
  EXPECT_EQ(fault(kTin, "[1, 3]", "[1, 1]"), lists);
  EXPECT_EQ(fault(kTin, "[1, 3]", "[1, 3, 6]"), lists);
  EXPECT_EQ(fault(kTin, "[1, 3]", "[0, 3]"), lists);
  EXPECT_EQ(fault(kTin, "[1, 3]", "3"), lists);
  EXPECT_EQ(fault(kTin, "[0.01, 0.02]", "[0.01, 0.02, 0.03]"), lists);
  EXPECT_EQ(fault(kTin, "[0.1, 0.3]", "[0.1, 0.3, 0.5]"), lists);
  EXPECT_EQ(fault(kTin, "[0.1, 0.3]", "[0.1, 'much']"), lists);
  EXPECT_EQ(fault(kTin, "[0.1, 0.3]", "[0.001, 0.3]"),
            "chip_loads.toml:1: tin has a least above its most");
  EXPECT_EQ(fault(kTin, "[tin]\n", ""), "chip_loads.toml:2: no key diameter_mm");
  EXPECT_EQ(fault(kTin, "[tin]", "[tin").substr(0, 17), "chip_loads.toml:1");
}

// What just is no fault: all of the most for a plunge, one figure that is usual, one row.
TEST(ChipLoad, LimitsOfATable) {
  const auto tables = ReadChipTables(
      "[tin]\nsource = 'measured'\ndiameter_mm = [2]\nleast_mm = [0.25]\nmost_mm = [0.25]\n"
      "speed_most_m_min = 100\nplunge_share = 1\n");
  ASSERT_TRUE(tables);
  const ChipRange range = tables->front().For(4.0);
  EXPECT_EQ(range.least_mm, 0.5);
  EXPECT_EQ(range.most_mm, 0.5);
  EXPECT_EQ(range.plunge_most_mm, 0.5);
}

// Every material of the table has a source and a range for the tools of small mills.
TEST(ChipLoad, TheTableIsWhole) {
  for (const std::string material : {"foam", "wax", "plastic", "wood", "pcb", "aluminium"}) {
    for (const double diameter : {0.1, 0.4, 0.8, 1.0, 3.0, 3.175, 6.0, 12.0}) {
      const auto range = ChipsOf(material, diameter);
      ASSERT_TRUE(range) << material;
      EXPECT_GT(range->least_mm, 0.0);
      EXPECT_LT(range->least_mm, range->most_mm);
      EXPECT_GT(range->plunge_most_mm, 0.0);
      EXPECT_LE(range->plunge_most_mm, range->most_mm);
    }
  }
  EXPECT_EQ(ChipTables().size(), 6U);
  const auto none = ChipsOf("cheese", 3.0);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().detail,
            "'cheese' is no material: aluminium, foam, pcb, plastic, wax, wood");
}

// Two edges at 6000 rpm are 200 a second: 10 mm/s leaves 0.05 mm to each. The edge of 3 mm goes
// 3 pi mm 6000 times a minute: 56.549 m/min.
machine::Judgement OfChips(const ChipRange& usual, const std::string& tool = "flat:3:flutes=2",
                           const std::string& speeds = "VS10;!VZ10;!RC6000;", double rpm = 0.0) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
  setup.main_program = 1;
  setup.programs[1].object =
      machine::Bytes::Of(speeds + "!PZ-100,200;!MC1;PU300,500;PD1000,500;PU0,0;!MC0;");
  SimulationRequest request;
  request.products.milling = Milling{
      .stock = *ParseStock("20x20x10"), .tool = *ParseTool(tool), .chips = usual, .rpm = rpm};
  const auto result = Simulate(mill, std::move(setup), std::move(request));
  EXPECT_TRUE(result);
  return result ? result->report.judgement : machine::Judgement{};
}

TEST(ChipLoad, BeyondTwiceTheUsualIsDoubtful) {
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 100.0})), "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.0251, 100.0})), "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.02, 100.0})),
            "DOUBTFUL; CELL-E9615 an edge takes off 250.0 % of the most that is usual @7");
  EXPECT_EQ(TextOf(OfChips({0.099, 0.2, 100.0})), "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.125, 0.2, 100.0})),
            "DOUBTFUL; CELL-E9616 an edge takes off 60.0 % less than the least that is usual @7");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 28.3})), "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 28.0})),
            "DOUBTFUL; CELL-E9617 an edge goes at 202.0 % of the greatest speed that is usual @7");
}

// One edge takes twice as much as two; a spindle that is set by hand turns as one says.
TEST(ChipLoad, GoesByEdgesAndSpindle) {
  EXPECT_EQ(TextOf(OfChips({0.01, 0.04, 100.0}, "flat:3:flutes=1")),
            "DOUBTFUL; CELL-E9615 an edge takes off 250.0 % of the most that is usual @7");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.04, 100.0})), "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.04, 100.0}, "flat:3:flutes=2", "VS10;!VZ10;!RC6000;", 3000.0)),
            "DOUBTFUL; CELL-E9615 an edge takes off 250.0 % of the most that is usual @7");
  // Its speed is changed while it turns: from 15000 rpm, where each takes 0.02 mm, to 6000.
  EXPECT_EQ(TextOf(OfChips({0.005, 0.02, 150.0}, "flat:3:flutes=2",
                           "VS10;!VZ10;!RC15000;!MC1;PU100,100;!RC6000;")),
            "DOUBTFUL; CELL-E9615 an edge takes off 250.0 % of the most that is usual @10");
}

// Down at 10 mm/s is 0.05 mm for an edge: 250 % of 0.02 mm. In the same hole again there is nothing
// to take off, and a way down of 45 degrees is a pass.
TEST(ChipLoad, PlungesHaveARangeOfTheirOwn) {
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 100.0, 0.025})), "GOOD");
  EXPECT_EQ(
      TextOf(OfChips({0.01, 0.05, 100.0, 0.02})),
      "DOUBTFUL; CELL-E9615 an edge takes off 250.0 % of the most that is usual straight down "
      "@7");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 100.0, 0.02}, "flat:3:flutes=2", "VS10;!VZ8;!RC6000;")),
            "GOOD");
  EXPECT_EQ(TextOf(OfChips({0.01, 0.05, 100.0, 0.02}, "flat:3:flutes=2",
                           "VS10;!VZ8;!RC6000;!MC1;PU300,500;Z300,500,-100;!VZ20;PU;!PZ-50,200;"
                           "PD;PU;Z300,500,0;Z300,500,-100;!PZ-100,200;")),
            "GOOD");
}

TEST(ChipLoad, CountsPassesInMaterialAlone) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto judged = [&](const std::string& cut) {
    machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
    setup.main_program = 1;
    setup.programs[1].object = machine::Bytes::Of(
        "VS10;!VZ10;!RC6000;!PZ-100,200;!MC1;PU300,500;PD1000,500;" + cut + "PU0,0;!MC0;");
    SimulationRequest request;
    request.products.milling = Milling{.stock = *ParseStock("20x20x10"),
                                       .tool = *ParseTool("flat:3:flutes=2"),
                                       .chips = ChipRange{0.01, 0.05, 100.0}};
    return TextOf(Simulate(mill, std::move(setup), std::move(request))->report.judgement);
  };
  EXPECT_EQ(judged(""), "GOOD");
  // Back in its own groove the tool takes nothing off, however fast; nor beside the block.
  EXPECT_EQ(judged("VS50;PD300,500;"), "GOOD");
  EXPECT_EQ(judged("PU5000,5000;VS50;PD6000,5000;").find("CELL-E9615"), std::string::npos);
  EXPECT_EQ(judged("VS50;PD1000,1500;"),
            "DOUBTFUL; CELL-E9615 an edge takes off 500.0 % of the most that is usual @9");
}

}  // namespace
}  // namespace rmlcell::simulation
