// How wide the cells of a block may be, and what the verdict says when they are wider.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/standard_cell.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

using machine::Judgement;
using machine::Verdict;

// On the test profile T1: 100 units a mm, Z0 20 mm below the top.
Judgement JudgedInCells(const std::string& stream, SimulationRequest request) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(stream);
  setup.forecast = true;
  const auto result = Simulate(mill, std::move(setup), std::move(request));
  EXPECT_TRUE(result);
  return result ? result->report.judgement : Judgement{.verdict = Verdict::kBad, .reasons = {}};
}

// A groove 1 mm deep and 3 mm wide: a cell may have 1 mm.
TEST(CellRules, CellsThatAreTooWide) {
  const auto with_cell = [](const std::string& stream, const std::string& tool, double cell_mm,
                            const std::string& stock = "20x20x10") {
    SimulationRequest request;
    request.products.milling = Milling{.stock = *ParseStock(stock), .tool = *ParseTool(tool)};
    request.products.milling->stock.cell = cell_mm;
    return TextOf(JudgedInCells(stream, std::move(request)));
  };
  const std::string groove = "VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD1000,100;PU0,0;!MC0;";
  const auto told = [](const std::string& percent, const std::string& fitting) {
    return "DOUBTFUL; CELL-E9619 a cell is as wide as " + percent +
           " % of the tool at the top of its deepest cut, so that cuts and faults are missed: give "
           "--cell " +
           fitting + " @6";
  };
  EXPECT_EQ(with_cell(groove, "flat:3", 1.0), "GOOD");
  EXPECT_EQ(with_cell(groove, "flat:3", 1.01), told("33.7", "1"));
  // A ball of 3 mm is 2 sqrt(1 (3 - 1)) = 2.828 mm wide 1 mm above its end, a third is 0.943 mm.
  EXPECT_EQ(with_cell(groove, "ball:3", 0.942), "GOOD");
  EXPECT_EQ(with_cell(groove, "ball:3", 0.95), told("33.6", "0.942"));
  // Flanks of 90 degrees are 2 mm apart there, and 2.3 mm with a tip of 0.3 mm.
  EXPECT_EQ(with_cell(groove, "vee:6:90", 0.666), "GOOD");
  EXPECT_EQ(with_cell(groove, "vee:6:90", 1.0), told("50.0", "0.666"));
  EXPECT_EQ(with_cell(groove, "vee:6:90:0.3", 1.0), told("43.5", "0.766"));
  // 10 degrees and 0.1 mm deep, between the rows of cells: 0.2 tan(5 degrees) = 0.0175 mm. Nothing
  // is taken off, and the place of the block is not to blame.
  const std::string scratch = "VS10;!VZ10;!PZ-10,200;!MC1;PU100,100;PD1000,100;PU0,0;!MC0;";
  EXPECT_EQ(with_cell(scratch, "vee:3.175:10", 0.1, "12x2x10"), told("571.5", "0.005"));
  EXPECT_EQ(with_cell(scratch, "vee:3.175:10", 0.005, "12x2x10"), "GOOD");
  // Beside the block no cell could notice it.
  EXPECT_EQ(with_cell(groove, "flat:3", 2.0, "5x5x10@0,10,0").find("E9619"), std::string::npos);
}

// Cells of 4 mm miss a travel of 1 mm through the block: the verdict says that they do.
TEST(CellRules, GougesThatNoCellNotices) {
  const auto of_cell = [](double cell_mm) {
    SimulationRequest request;
    request.products.milling =
        Milling{.stock = *ParseStock("20x20x3@0,0,0.5"), .tool = *ParseTool("flat:1")};
    request.products.milling->stock.cell = cell_mm;
    return JudgedInCells("VS5;!VZ2;!PZ-100,10;!MC1;PU100,100;PD1000,100;PU0,0;!MC0;",
                         std::move(request));
  };
  EXPECT_EQ(of_cell(0.1).verdict, Verdict::kBad);
  const Judgement coarse = of_cell(4.0);
  EXPECT_EQ(coarse.verdict, Verdict::kDoubtful);
  EXPECT_TRUE(std::ranges::any_of(coarse.reasons, [](const machine::Reason& reason) {
    return reason.code == ErrorCode::kCellTooWide;
  }));
}

// A quarter of the narrowest that the tool cuts, at most 0.1 mm; 4,194,304 cells are 2048 by 2048.
TEST(StandardCell, FitsTheTool) {
  const auto of = [](const std::string& stock, const std::string& tool) {
    return StandardCell(*ParseStock(stock), *ParseTool(tool));
  };
  EXPECT_EQ(of("20x20x2", "flat:3"), 0.1);
  EXPECT_EQ(of("20x20x2", "flat:0.4"), 0.1);
  EXPECT_EQ(of("20x20x2", "flat:0.2"), 0.05);
  EXPECT_EQ(of("20x20x2", "ball:0.2"), 0.05);
  EXPECT_EQ(of("20x20x2", "vee:3:60:0.2"), 0.05);
  EXPECT_NEAR(of("20x20x2", "vee:3:60"), 0.1 * std::tan(0.5235987755982988) / 2.0, 1e-12);
  EXPECT_EQ(of("20x20x2", "vee:3:150"), 0.1);
  EXPECT_EQ(of("163.84x163.84x2", "flat:0.2"), 0.08);
  EXPECT_EQ(of("2000x1000x2", "flat:0.2"), 0.1);
}

}  // namespace
}  // namespace rmlcell::simulation
