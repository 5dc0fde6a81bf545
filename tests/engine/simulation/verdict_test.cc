// Verdicts of whole runs. For each rule the smallest program that breaks it, and one that just does
// not. docs/verdict.md lists the rules.
#include "engine/simulation/verdict/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/simulation/mill.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

using machine::Judgement;
using machine::Verdict;

machine::Parameters MillOf(const std::string& profile) {
  return *machine::MakeParameters(Mill(), profile, {});
}

Judgement VerdictOf(const machine::MachineFamily& family, const machine::Parameters& parameters,
                    const std::string& object, SimulationRequest request = {}) {
  machine::RunSetup setup(parameters);
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(object);
  setup.forecast = true;
  const auto result = Simulate(family, std::move(setup), std::move(request));
  EXPECT_TRUE(result);
  return result ? result->report.judgement : Judgement{.verdict = Verdict::kBad, .reasons = {}};
}

double FigureOf(const std::vector<machine::Figure>& figures, std::string_view name) {
  const auto found = std::ranges::find(figures, name, &machine::Figure::name);
  return found == figures.end() ? -1.0 : found->value;
}

// On the test profile T1: 0..200 x 0..150 x -60..0 mm, Z0 20 mm below the top, 100 units a mm.
Judgement OfStream(const std::string& stream) { return VerdictOf(Mill(), MillOf("t1"), stream); }

Judgement OfStreamInBlock(const std::string& stream, const std::string& stock) {
  SimulationRequest request;
  request.products.milling = Milling{.stock = *ParseStock(stock), .tool = *ParseTool("flat:3")};
  return VerdictOf(Mill(), MillOf("t1"), stream, std::move(request));
}

// Feed rates, heights of 1 mm down and 2 mm up, a spindle; then the work; then an orderly end.
std::string Work(const std::string& commands) {
  return "VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;" + commands + "PU0,0;!MC0;";
}

TEST(Verdict, OfAnOrderlyProgramIsGood) {
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100;"))), "GOOD");
  // A lift above the top and a parking place beyond the travel cost nothing.
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100;Z200,100,9000;PU0,90000;"))), "GOOD");
}

// The work may lead 0.01 mm, one unit, beyond the travel: that is rounding.
TEST(Verdict, OfWorkBeyondTheTravel) {
  const std::string lost = " mm of the work lie beyond the travel and are not cut @6; ";
  EXPECT_EQ(TextOf(OfStream(Work("PD20001,100;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("PD20002,100;"))),
            "BAD; RML1-E8002 0.020" + lost +
                "RML1-E8002 no work origin in the travel fits: move the program by 0.020 mm to "
                "less X");
  EXPECT_EQ(TextOf(OfStream(Work("PD-1,100;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("PD-2,100;"))),
            "BAD; RML1-E8002 0.020" + lost +
                "RML1-E8002 the work leads 0.020 mm beyond the least X: move the origin to greater "
                "X");
  EXPECT_EQ(TextOf(OfStream(Work("PD100,15001;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("PD100,15002;"))),
            "BAD; RML1-E8002 0.020" + lost +
                "RML1-E8002 no work origin in the travel fits: move the program by 0.020 mm to "
                "less Y");
  EXPECT_EQ(TextOf(OfStream(Work("PD100,-1;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("PD100,-2;"))),
            "BAD; RML1-E8002 0.020" + lost +
                "RML1-E8002 the work leads 0.020 mm beyond the least Y: move the origin to greater "
                "Y");
  EXPECT_EQ(TextOf(OfStream(Work("Z100,100,-4001;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("Z100,100,-4002;"))),
            "BAD; RML1-E8002 0.020" + lost +
                "RML1-E8002 the work leads 0.020 mm below the travel: raise Z0");
}

// Tool heights are lost, too: a hole beyond the travel, and one that a moved Z0 takes below it.
TEST(Verdict, OfHolesThatAreNotDrilled) {
  EXPECT_EQ(
      TextOf(OfStream(Work("PU30000,100;PD;PU;PU200,100;PD300,100;"))),
      "BAD; RML1-E8002 the work is 98.000 mm longer in X than the travel: wherever its origin is, "
      "it does not fit; RML1-E8002 1.000 mm of the work lie beyond the travel and are not cut @7");
  // Z0 55 mm below the top, the tool 10 mm below it: the travel ends at 60 mm.
  const std::string deep = "VS10;!VZ10;!PZ-1000,200;!ZO-5500;!MC1;PU100,100;PD200,100;PU0,0;!MC0;";
  EXPECT_EQ(TextOf(OfStream(deep)),
            "BAD; RML1-E8002 5.000 mm of the work lie beyond the travel and are not cut @7; "
            "RML1-E8002 the work leads 5.000 mm below the travel: raise Z0; RML1-E8010 3.650 mm "
            "across at travel speed, not above the surface of the work @6; RML1-E8020 !ZO lowers "
            "Z0 by 35.000 mm: so much deeper is what follows @4; RML1-E8011 the tool stays 33.000 "
            "mm deep in the work at the end");
}

// Z0 of T1 is 20 mm below the top; 10 mm further up 1 mm down is 9 mm above the surface. The block
// stays where it was, too, and so does what is told of depth. RML1-3C.32, RML1-9.11
TEST(Verdict, OfZ0ThatIsMoved) {
  const auto moved = [](const std::string& zo, const std::string& depth = "100") {
    return "!ZO" + zo + ";VS10;!VZ10;!PZ-" + depth + ",200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;";
  };
  EXPECT_EQ(TextOf(OfStream(moved("-2000"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(moved("-2001"))), "GOOD");
  const std::string raised = "DOUBTFUL; RML1-E8020 !ZO raises Z0 by ";
  EXPECT_EQ(TextOf(OfStream(moved("-1998"))),
            raised + "0.020 mm: so much less deep is what follows @1");
  EXPECT_EQ(TextOf(OfStream(moved("-1000"))),
            raised +
                "10.000 mm: so much less deep is what follows @1; RML1-E8015 nothing is cut: "
                "the tool never goes below the surface");
  EXPECT_EQ(TextOf(OfStreamInBlock(moved("-1000"), "20x20x10")).substr(0, 62),
            "DOUBTFUL; CELL-E9603 the tool takes nothing off the block; RML");
  // 12 mm down from there are 2 mm of the work, in the block and beside it.
  machine::RunSetup setup(MillOf("t1"));
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(moved("-1000", "1200"));
  SimulationRequest request;
  request.products.milling =
      Milling{.stock = *ParseStock("20x20x10"), .tool = *ParseTool("flat:3")};
  const auto result = Simulate(Mill(), std::move(setup), std::move(request));
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->report.milling->deepest_cut_mm, 2.0, 1e-6);
  EXPECT_NEAR(result->report.work_origin->z(), -20.0, 1e-12);
  EXPECT_NEAR(FigureOf(result->report.figures, "box_mm.zmin"), -2.0, 1e-12);
  EXPECT_NEAR(FigureOf(result->report.figures, "z0_raised"), 10.0, 1e-12);
  const auto checked =
      Mill().Translate({.name = "a.rml", .bytes = moved("-1000", "1200")}, MillOf("t1"), {});
  EXPECT_NEAR(FigureOf(checked.figures, "box_mm.zmin"), -2.0, 1e-12);
  // Put back before anything goes by it, it harms nothing; left behind it does to what comes next.
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100;PU;!ZO-1000;!ZO;"))), "GOOD");
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100;") + "!ZO-1000;")),
            raised + "10.000 mm: so much less deep is what follows @9");
  // Where the machine is told to have it there, nothing moves.
  const auto told = *machine::MakeParameters(Mill(), "t1", {{"Z0", "-10"}});
  EXPECT_EQ(TextOf(VerdictOf(Mill(), told, moved("-1000"))), "GOOD");
}

// A machine that was left with another Z0 has its surface, and the block, there.
TEST(Verdict, OfZ0ThatAnEarlierRunLeft) {
  machine::RunSetup first(MillOf("t1"));
  first.main_program = 1;
  first.programs[1].object = machine::Bytes::Of("!ZO-1000;");
  const auto left = Simulate(Mill(), std::move(first), {});
  ASSERT_TRUE(left);
  machine::RunSetup setup(MillOf("t1"));
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(Work("PD200,100;"));
  setup.machine_state = left->machine_state;
  SimulationRequest request;
  request.products.milling =
      Milling{.stock = *ParseStock("20x20x10"), .tool = *ParseTool("flat:3")};
  const auto result = Simulate(Mill(), std::move(setup), std::move(request));
  ASSERT_TRUE(result);
  EXPECT_EQ(TextOf(result->report.judgement), "GOOD");
  EXPECT_NEAR(result->report.milling->deepest_cut_mm, 1.0, 1e-6);
}

TEST(Verdict, OfDataThatEndsInsideACommand) {
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100;") + "PD300,300")),
            "DOUBTFUL; RML1-E8001 the data ends inside a command: the last one is not carried out");
}

// How a stream would have ended is not known of a run that did not get there.
TEST(Verdict, OfAPauseSaysNothingOfTheEnd) {
  const Judgement judgement = OfStream(Work("PD200,100;!NR;"));
  EXPECT_EQ(judgement.verdict, Verdict::kDoubtful);
  ASSERT_EQ(judgement.reasons.size(), 1U);
  EXPECT_EQ(judgement.reasons[0].code, ErrorCode::kCellWaitsForever);
  EXPECT_EQ(judgement.reasons[0].said, "halts that wait for a key to go on: 1");
}

// A pen goes along the surface with the spindle off.
TEST(Verdict, OfAStrokeAlongTheSurfaceIsGood) {
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ0,200;!MC0;PU100,100;PD200,100;PU0,0;")), "GOOD");
}

TEST(Verdict, OfCoordinatesThatAreRefused) {
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100,300;"))),
            "BAD; RML1-E8008 coordinates or heights that were refused: 1 @6; RML1-E8014 places "
            "that are no command, or have wrong parameters: 1");
  EXPECT_EQ(TextOf(OfStream(Work("PD200,100,300,100;"))), "GOOD");
}

TEST(Verdict, OfWhatIsNotUnderstood) {
  EXPECT_EQ(TextOf(OfStream(Work("$PD200,100;"))),
            "DOUBTFUL; RML1-E8014 places that are no command, or have wrong parameters: 1");
  // RML1-4.05: the letter of a sequence that there is not is judged as a command, too.
  EXPECT_EQ(
      TextOf(OfStream(Work("\x1b.B;PD200,100;"))),
      "DOUBTFUL; RML1-E8014 places that are no command, or have wrong parameters: 1; RML1-E8014 "
      "communication errors: 1");
}

TEST(Verdict, OfWhatIsNoRml1) {
  std::string stream = Work("PD200,100;");
  stream += std::string(900 - stream.size(), ';');
  EXPECT_EQ(OfStream(stream + std::string(100, '$')).verdict, Verdict::kDoubtful);
  const Judgement none = OfStream(stream + std::string(101, '$'));
  EXPECT_EQ(none.verdict, Verdict::kBad);
  ASSERT_FALSE(none.reasons.empty());
  EXPECT_EQ(none.reasons[0].said, "10.1 % of the bytes belong to no command");
  EXPECT_EQ(none.reasons[0].unit, "%");
  EXPECT_EQ(none.reasons[0].limit, 10.0);
}

// Down 1 mm and along 1 mm with the spindle off.
TEST(Verdict, OfASpindleThatStands) {
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC0;PU100,100;PD200,100;PU0,0;")),
            "BAD; RML1-E8009 2.000 mm in the work while the spindle stands @6");
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC0;PU100,100;!MC1;PD200,100;PU0,0;!MC0;")),
            "GOOD");
}

TEST(Verdict, OfTravelWithoutClearance) {
  const auto with_height = [](const std::string& up) {
    return OfStream("VS10;!VZ10;!PZ-100," + up + ";!MC1;PU100,100;PD200,100;PU500,500;!MC0;");
  };
  // 1.414 mm before the hole and 5 mm behind the cut.
  EXPECT_EQ(TextOf(with_height("0")),
            "DOUBTFUL; RML1-E8010 6.414 mm across at travel speed, not above the surface of the "
            "work @5");
  EXPECT_EQ(TextOf(with_height("1")), "GOOD");
}

TEST(Verdict, OfTheEnd) {
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;!MC0;")),
            "DOUBTFUL; RML1-E8011 the tool stays 1.000 mm deep in the work at the end");
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;Z200,100,-1;!MC0;")),
            "GOOD");
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;")),
            "DOUBTFUL; RML1-E8012 the spindle turns on at the end");
}

// The plunge of 1 mm goes by the speed of Z, the stroke of 1 mm by that of X and Y.
TEST(Verdict, OfFeedRatesThatNobodyGave) {
  const std::string rest = "!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;";
  const std::string said = " mm in the work at a speed that the program did not set @";
  EXPECT_EQ(TextOf(OfStream(rest)), "DOUBTFUL; RML1-E8013 2.000" + said + "4");
  EXPECT_EQ(TextOf(OfStream("VS10;" + rest)), "DOUBTFUL; RML1-E8013 1.000" + said + "5");
  EXPECT_EQ(TextOf(OfStream("!VZ10;" + rest)), "DOUBTFUL; RML1-E8013 1.000" + said + "5");
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;DF;" + rest)), "DOUBTFUL; RML1-E8013 2.000" + said + "7");
  EXPECT_EQ(TextOf(OfStream("VS10;!VZ10;" + rest)), "GOOD");
}

// Relative ways lead to where the tool stood before, until absolute ones say where; 1 mm of the
// plunge and 1 mm of the stroke are in the work.
TEST(Verdict, OfAPlaceThatNobodyGave) {
  const auto begin = [](const std::string& commands) {
    return TextOf(OfStream("VS10;!VZ10;!PZ-100,200;!MC1;" + commands + "PU;!MC0;"));
  };
  const std::string said = " mm in the work at a place that hangs on where the tool stood before @";
  EXPECT_EQ(begin("PR100,100;PD100,0;"), "DOUBTFUL; RML1-E8021 2.000" + said + "6");
  EXPECT_EQ(begin("PA100,100;PR;PD100,0;"), "GOOD");
  EXPECT_EQ(begin("PA0,0;PR;PD100,0;"), "GOOD");  // where it stands
  EXPECT_EQ(begin("H;PR;PD100,0;"), "GOOD");
  EXPECT_EQ(begin("!ZEX100;PR;PD100,0;"), "DOUBTFUL; RML1-E8021 2.000" + said + "7");
  EXPECT_EQ(begin("!ZEX100Y100;PR;PD100,0;"), "GOOD");
  // A machine without Y asks for none.
  EXPECT_EQ(TextOf(VerdictOf(Mill(), MillOf("t1n"),
                             "VS10;!VZ10;!MC1;!ZEX100Z200;!ZEZ-50;!ZEX200;!ZEZ200;!MC0;")),
            "GOOD");
  // Down where it stands, and from there to a place that is given.
  EXPECT_EQ(begin("PD100,0;"), "DOUBTFUL; RML1-E8021 2.000" + said + "5");
  EXPECT_EQ(begin("Z0,0,200,0,0,-100;"), "GOOD");
}

// What a machine may have otherwise from before is told, and no reason for anything.
TEST(Figures, TellWhatAProgramTakesForGranted) {
  const auto assumed = [](const std::string& stream) {
    const auto checked = Mill().Translate({.name = "a.rml", .bytes = stream}, MillOf("t1"), {});
    std::string text;
    for (const char* name : {"assumed_absolute", "assumed_heights", "assumed_rotation"})
      text += ShortestText(FigureOf(checked.figures, name)) + " ";
    return text;
  };
  EXPECT_EQ(assumed("PU100,100;PD200,100;Z0,0,-10;PU;"), "1 1 3 ");
  EXPECT_EQ(assumed("PA;!PZ-100,200;!MC1;PU100,100;PD200,100;PU;"), "0 0 0 ");
  EXPECT_EQ(assumed("^IN;PU100,100;Z100,100,-10;PU;"), "0 0 0 ");
  EXPECT_EQ(assumed("DF;PD;Z100,100,-10;PU;"), "0 0 0 ");
  EXPECT_EQ(assumed("PR;!ZO5;"), "0 0 0 ");
  EXPECT_EQ(assumed("!ZM-2500;"), "1 0 1 ");
}

// Waits of 32.767 s: 79104 of them are 2,592,000.768 s, and one less 2,591,968.001. RML1-3A.53
TEST(Verdict, OfATimeBeyondTheBudget) {
  const auto waits = [](int count) {
    std::string stream = "VS10;!VZ10;!PZ-100,200;PA;!MC0;W32767;PU100,100;PD100,100;";
    for (int i = 0; i < count; ++i) stream += i % 2 == 0 ? "PD101,100;" : "PD100,100;";
    return TextOf(JudgeFigures(
        Mill(), Mill().Translate({.name = "a.rml", .bytes = stream}, MillOf("t1"), {}).figures));
  };
  EXPECT_EQ(waits(79000).find("CELL-E9305"), std::string::npos);
  EXPECT_NE(waits(79104).find("CELL-E9305 a run takes 30."), std::string::npos);
  EXPECT_NE(waits(79104).find(" days at least, and ends at its budget"), std::string::npos);
}

// A cut may run on beyond an edge by the diameter of the tool, 3 mm: the block ends at X 20 mm and
// at Y 20 mm, the stroke along X at 23 mm; 1 mm deep, from a plunge of which 1 mm counts.
TEST(Verdict, OfWorkBesideTheBlock) {
  const auto stroke = [](const std::string& from, const std::string& to) {
    return TextOf(OfStreamInBlock(Work("PU" + from + ";PD" + to + ";PU500,500;"), "20x20x10"));
  };
  EXPECT_EQ(stroke("500,500", "2300,500"), "GOOD");
  EXPECT_EQ(stroke("500,500", "2301,500"), "GOOD");
  EXPECT_EQ(
      stroke("500,500", "2302,500"),
      "DOUBTFUL; CELL-E9618 0.020 mm of the work lie beside the block @7; CELL-E9618 the work "
      "leads 3.020 mm beyond the edge of the block at its greatest X");
  EXPECT_EQ(stroke("500,500", "500,5000"),
            "DOUBTFUL; CELL-E9618 27.000 mm of the work lie beside the block @7; CELL-E9618 the "
            "work leads 30.000 mm beyond the edge of the block at its greatest Y");
  const auto shifted = [](const std::string& stock) {
    return TextOf(OfStreamInBlock(Work("PU100,100;PD1100,100;PU100,100;"), stock));
  };
  // From X 1 to 11 mm, with 1 mm of plunge: the block from 5 mm on, and from Y 4.5 mm on.
  EXPECT_EQ(shifted("20x20x10@4,0,0"), "GOOD");
  EXPECT_EQ(
      shifted("20x20x10@5,0,0"),
      "DOUBTFUL; CELL-E9618 2.000 mm of the work lie beside the block @7; CELL-E9618 the work "
      "leads 4.000 mm beyond the edge of the block at its least X");
  EXPECT_EQ(
      shifted("20x20x10@0,4.5,0"),
      "DOUBTFUL; CELL-E9603 the tool takes nothing off the block; CELL-E9618 11.000 mm of the "
      "work lie beside the block @7; CELL-E9618 the work leads 3.500 mm beyond the edge of "
      "the block at its least Y");
}

// motion.md 9: the top of the block 3 mm above Z 0 is higher than the tool travels.
TEST(Verdict, OfTravelThroughTheBlock) {
  EXPECT_EQ(TextOf(OfStreamInBlock(Work("PD200,100;"), "20x20x10@0,0,2")), "GOOD");
  const Judgement judgement = OfStreamInBlock(Work("PD200,100;"), "20x20x10@0,0,3");
  EXPECT_EQ(judgement.verdict, Verdict::kBad);
  EXPECT_EQ(judgement.reasons[0].code, ErrorCode::kCellGouge);
  EXPECT_EQ(judgement.reasons[0].first.step, 5);
}

TEST(Verdict, OfABlockThatIsNotThere) {
  EXPECT_EQ(TextOf(OfStreamInBlock(Work("PD200,100;"), "10x10x10@100,100,0")),
            "DOUBTFUL; CELL-E9603 the tool takes nothing off the block; CELL-E9618 2.000 mm of the "
            "work lie beside the block @6; CELL-E9618 the work leads 99.000 mm beyond the edge of "
            "the block at its least X; CELL-E9618 the work leads 99.000 mm beyond the edge of the "
            "block at its least Y");
}

// A block of 10 mm: through it by a little is how one cuts out, by more than 1 mm it is the table.
TEST(Verdict, OfAToolBelowTheBlock) {
  const auto down_to = [](const std::string& z) {
    return TextOf(OfStreamInBlock(Work("Z100,100," + z + ";"), "20x20x10"));
  };
  EXPECT_EQ(down_to("-1000"), "GOOD");
  // Of a hundredth of a millimetre it is told from beyond it on.
  EXPECT_EQ(down_to("-1001"), "GOOD");
  EXPECT_EQ(down_to("-1002"), "DOUBTFUL; CELL-E9602 the tool goes 0.020 mm below the block @6");
  EXPECT_EQ(down_to("-1100"), "DOUBTFUL; CELL-E9602 the tool goes 1.000 mm below the block @6");
  EXPECT_EQ(down_to("-1010"), "DOUBTFUL; CELL-E9602 the tool goes 0.100 mm below the block @6");
  EXPECT_EQ(down_to("-1200"), "BAD; CELL-E9602 the tool goes 2.000 mm below the block @6");
  // Beside the block, by its radius of 1.5 mm and more, the tool may go as deep as it likes.
  const std::string beside = Work("PD200,100;PU2151,100;Z2151,100,-1200,2151,100,200;");
  EXPECT_EQ(TextOf(OfStreamInBlock(Work("PD200,100;PU2149,100;Z2149,100,-1200,2149,100,200;"),
                                   "20x20x10")),
            "BAD; CELL-E9602 the tool goes 2.000 mm below the block @8");
  EXPECT_EQ(TextOf(OfStreamInBlock(beside, "20x20x10")), "GOOD");
}

Judgement OfCutWith(const std::string& commands, const std::string& tool) {
  SimulationRequest request;
  request.products.milling = Milling{.stock = *ParseStock("20x20x10"), .tool = *ParseTool(tool)};
  return VerdictOf(Mill(), MillOf("t1"), Work(commands), std::move(request));
}

// A tool of 3 mm: 3 mm deep is once its width, a hundredth more is too much of it. A plunge is
// none.
TEST(Verdict, OfADeepPass) {
  const auto pass = [](const std::string& depth) {
    return "Z200,500,-" + depth + ",1000,500,-" + depth + ",1000,500,200;";
  };
  EXPECT_EQ(TextOf(OfCutWith(pass("300"), "flat:3")), "GOOD");
  EXPECT_EQ(TextOf(OfCutWith(pass("301"), "flat:3")),
            "DOUBTFUL; CELL-E9612 one pass is as deep as 100.3 % of the width of the tool @6");
  EXPECT_EQ(TextOf(OfCutWith(pass("301"), "flat:3.1")), "GOOD");
  EXPECT_EQ(TextOf(OfCutWith("Z500,500,100,500,500,-800,500,500,200;", "flat:3")), "GOOD");
}

// 4 mm that cut, 4 mm deep, then a hundredth and two more.
TEST(Verdict, OfAShankInMaterial) {
  const auto pass = [](const std::string& depth) {
    return "Z200,500,-" + depth + ",1000,500,-" + depth + ",1000,500,200;";
  };
  EXPECT_EQ(TextOf(OfCutWith(pass("401"), "flat:6:flute=4")), "GOOD");
  EXPECT_EQ(TextOf(OfCutWith(pass("402"), "flat:6:flute=4")),
            "BAD; CELL-E9611 shank or holder goes 0.020 mm into material @6");
  EXPECT_EQ(TextOf(OfCutWith(pass("402"), "flat:6")), "GOOD");
  EXPECT_EQ(TextOf(OfCutWith(pass("402"), "flat:6:flute=4.02:shank=8:holder=30@5")), "GOOD");
  EXPECT_EQ(OfCutWith(pass("402"), "flat:6:holder=30@4").verdict, Verdict::kBad);
}

// What a target has more or less than is left counts from its tolerance on.
TEST(Verdict, OfWhatIsLeftBesideItsTarget) {
  RunReport report;
  report.milling = MillingFigures{.removed_mm3 = 1.0};
  const auto judged = [&](double left_mm, double deep_mm) {
    report.milling->target =
        TargetFigures{.tolerance_mm = 0.1, .left_mm = left_mm, .deep_mm = deep_mm};
    return TextOf(Judge(report));
  };
  EXPECT_EQ(judged(0.1, 0.1), "GOOD");
  EXPECT_EQ(judged(0.100001, 0.100001), "GOOD");
  EXPECT_EQ(judged(0.11, 0.0), "DOUBTFUL; CELL-E9614 0.110 mm stand above the target");
  EXPECT_EQ(judged(0.0, 0.11), "BAD; CELL-E9613 the part is cut 0.110 mm below its target");
}

TEST(Verdict, OfHowARunEnds) {
  RunReport report;
  EXPECT_EQ(TextOf(Judge(report)), "GOOD");
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kHoleRadiusZero,
                    .detail = "radius is 0",
                    .place = {.program = 1, .step = 7}};
  EXPECT_EQ(TextOf(Judge(report)), "BAD; OPT-E348 radius is 0 @7");
  report.outcome = {.kind = machine::OutcomeKind::kStopped, .code = ErrorCode::kCellWaitsForever};
  EXPECT_EQ(Judge(report).verdict, Verdict::kDoubtful);
  report.outcome = {.kind = machine::OutcomeKind::kCancelled, .code = ErrorCode::kCellCancelled};
  EXPECT_EQ(Judge(report).verdict, Verdict::kBad);
  report.outcome = {.kind = machine::OutcomeKind::kBudgetExceeded,
                    .code = ErrorCode::kCellTimeBudget};
  EXPECT_EQ(Judge(report).verdict, Verdict::kBad);
  report.outcome = {.kind = machine::OutcomeKind::kStopped, .detail = "emergency stop"};
  EXPECT_EQ(Judge(report).verdict, Verdict::kDoubtful);
}

// An axis beyond its travel is told once: by the outcome, or, where the run went on, by its rule.
TEST(Verdict, OfAnAxisBeyondItsTravel) {
  RunReport report;
  report.violations = {{.place = {.program = 1, .step = 3}, .axis = "X", .excess = 2.0}};
  report.violations_dropped = 2;
  // With the number that the machine has for it; else in the words of the cell.
  EXPECT_EQ(TextOf(Judge(report)),
            "BAD; CELL-E9605 motions that leave the travel of an axis: 3 @3");
  report.family = "optimo";
  EXPECT_EQ(TextOf(Judge(report)), "BAD; OPT-E7301 motions that leave the travel of an axis: 3 @3");
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kTargetOutOfTravel,
                    .detail = "X by 2 mm"};
  EXPECT_EQ(TextOf(Judge(report)), "BAD; OPT-E7301 X by 2 mm");
}

TEST(Verdict, OfFindingsIsBadWithAnError) {
  Diagnostic warning{.code = ErrorCode::kFlyReversal, .severity = Severity::kWarning};
  Diagnostic error{.code = ErrorCode::kSyntax,
                   .severity = Severity::kCompile,
                   .detail = "MOVE what",
                   .where = {.line = 4}};
  EXPECT_EQ(TextOf(JudgeFindings(std::vector{warning})), "GOOD");
  const Judgement judgement = JudgeFindings(std::vector{warning, error});
  EXPECT_EQ(TextOf(judgement), "BAD; OPT-E7003 MOVE what");
  EXPECT_EQ(judgement.reasons[0].first.line, 4);
}

TEST(Judgement, KeepsTheMostSeriousFirst) {
  Judgement judgement;
  judgement.Add({.verdict = Verdict::kDoubtful, .said = "a"});
  judgement.Add({.verdict = Verdict::kBad, .said = "b"});
  judgement.Add({.verdict = Verdict::kDoubtful, .said = "c"});
  judgement.Add({.verdict = Verdict::kBad, .said = "d"});
  std::string order;
  for (const machine::Reason& reason : judgement.reasons) order += reason.said;
  EXPECT_EQ(order, "bdac");
  EXPECT_EQ(judgement.verdict, Verdict::kBad);
}

// A check, which carries out a stream at once, says the same as a run of it.
TEST(Verdict, OfACheckIsThatOfTheRun) {
  const std::string streams[] = {Work("PD200,100;"), Work("PD20002,100;Z100,100,-4100;"),
                                 Work("PD200,100,300;$$;PU50000,0;"), "PD100,100;",
                                 "!PZ-100,0;PU100,100;PD5,5;!MC0;PU200,200;PD300,200;"};
  for (const std::string& stream : streams) {
    const machine::Translation checked =
        Mill().Translate({.name = "part.rml", .bytes = stream}, MillOf("t1"), {});
    EXPECT_EQ(TextOf(JudgeFigures(Mill(), checked.figures)), TextOf(OfStream(stream))) << stream;
  }
}

std::string FileText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The page has the rules in their order.
TEST(Verdict, DocumentListsExactlyTheRules) {
  std::string listed;
  std::istringstream page(FileText(RMLCELL_SOURCE_DIR "/docs/verdict.md"));
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| `")) listed += line + "\n";
  }
  std::string rules;
  const auto add = [&](const machine::VerdictRule& rule) {
    rules += "| `" + CodeText(rule.code) + "` | `" + std::string(rule.figure) + "` | " +
             ShortestText(rule.limit) + " | " + std::string(machine::VerdictText(rule.verdict)) +
             " | " + std::string(rule.said) + " |\n";
  };
  for (const VerdictRuleInfo& info : CommonVerdictRules()) add(info.rule);
  // What a check alone tells stands in no report.
  const auto checked = Mill().Translate({.name = "a.rml", .bytes = "!NR;"}, MillOf("t1"), {});
  for (const machine::MachineFamily* family : families::Families()) {
    for (const machine::VerdictRule& rule : family->verdict_rules()) {
      add(rule);
      if (std::ranges::find(checked.figures, rule.figure, &machine::Figure::name) !=
          checked.figures.end())
        continue;
      EXPECT_TRUE(std::ranges::any_of(family->figures(), [&](const machine::FigureInfo& info) {
        return info.name == rule.figure;
      })) << rule.figure;
    }
  }
  EXPECT_EQ(listed, rules);
}

// One meaning in check, run and report: docs/facts.md. Steps of one way down are one plunge.
TEST(Figures, MeanOneThingInCheckRunAndReport) {
  const std::pair<std::string, double> streams[] = {
      {Work("PD200,100;"), 1},
      {Work("Z100,100,100,100,100,-10,100,100,-20,300,100,-20;Z300,100,-40;Z300,100,200;"), 2},
      {Work("PD200,100;PU;PD300,100;Z300,100,-150;"), 3},
      {Work("Z100,100,-10;Z100,100,-5;Z100,100,-20;"), 2},
      {"!PZ0,200;!ZO-1900;PU100,100;PD200,100;PD;Z200,100,-50,200,100,-150;PU;", 1},
      {"!PZ0,200;PU100,100;PD200,100;PU;", 0}};
  for (const auto& [stream, plunges] : streams) {
    machine::RunSetup setup(MillOf("t1"));
    setup.main_program = 1;
    setup.programs[1].object = machine::Bytes::Of(stream);
    const auto run = Simulate(Mill(), std::move(setup), {});
    ASSERT_TRUE(run);
    const auto checked = Mill().Translate({.name = "a.rml", .bytes = stream}, MillOf("t1"), {});
    const auto& of_run = run->report.figures;
    EXPECT_EQ(static_cast<double>(run->report.total.plunges), plunges) << stream;
    EXPECT_EQ(FigureOf(of_run, "plunges"), plunges) << stream;
    EXPECT_EQ(FigureOf(checked.figures, "plunges"), plunges) << stream;
    EXPECT_NEAR(FigureOf(of_run, "cut_length"), run->report.total.cut_mm, 1e-9) << stream;
    EXPECT_NEAR(FigureOf(checked.figures, "cut_length"), run->report.total.cut_mm, 1e-9) << stream;
    EXPECT_EQ(FigureOf(checked.figures, "motions"), FigureOf(of_run, "motions")) << stream;
    // What the tool does in the work it does down, by whatever commands.
    EXPECT_GT(FigureOf(of_run, "tool_down_time"), 0.0) << stream;
  }
}

// What people judged of real programs, by hand and before the rules first ran on them.
TEST(Verdict, OfRealProgramsIsThatOfPeople) {
  const std::string corpus = RMLCELL_SHARED_DIR "/corpus/rml1/";
  if (!std::ifstream(corpus + "SOURCES.md")) GTEST_SKIP() << "the shared corpus is not here";
  std::istringstream table(
      FileText(RMLCELL_SOURCE_DIR "/tests/conformance/rml1_corpus_verdicts.csv"));
  std::string line;
  std::getline(table, line);
  int files = 0;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string file, profile, verdict;
    std::getline(cells, file, ',');
    std::getline(cells, profile, ',');
    std::getline(cells, verdict, ',');
    const std::string stream = FileText(corpus + file);
    ASSERT_FALSE(stream.empty()) << file;
    const machine::Translation checked =
        Mill().Translate({.name = file, .bytes = stream}, MillOf(profile), {});
    EXPECT_EQ(machine::VerdictText(JudgeFigures(Mill(), checked.figures).verdict), verdict) << file;
    ++files;
  }
  EXPECT_EQ(files, 25);
}

}  // namespace
}  // namespace rmlcell::simulation
