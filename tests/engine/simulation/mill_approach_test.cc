// How a mill comes to its work, and where it passes without touching it: ways down that something
// else must have cleared, and strokes along the surface. docs/verdict.md lists the rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/run/simulate.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/mill.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

// T1 has 200 x 150 x 60 mm in steps of 0.01 mm, Z0 20 mm below the top; Z travels at 60 mm/s.
std::vector<machine::Figure> FiguresOf(const std::string& stream) {
  return Mill()
      .Translate({.name = "part.rml", .bytes = stream}, *machine::MakeParameters(Mill(), "t1", {}),
                 {})
      .figures;
}

std::string SaidOfApproach(const std::string& stream) {
  return TextOf(JudgeFigures(Mill(), FiguresOf(stream)));
}

// With the work origin 10 mm to the right and 20 mm up.
std::string SaidFromOrigin(const std::string& stream) {
  const auto parameters =
      *machine::MakeParameters(Mill(), "t1", {{"ORIGIN_X", "10"}, {"ORIGIN_Y", "20"}});
  return TextOf(JudgeFigures(
      Mill(), Mill().Translate({.name = "a.rml", .bytes = stream}, parameters, {}).figures));
}

double FigureOf(const std::string& stream, std::string_view name) {
  const auto figures = FiguresOf(stream);
  const auto found = std::ranges::find(figures, name, &machine::Figure::name);
  return found == figures.end() ? -1.0 : found->value;
}

std::string RunInBlock(const std::string& stream) {
  machine::RunSetup setup(*machine::MakeParameters(Mill(), "t1", {}));
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Of(stream);
  SimulationRequest request;
  request.products.milling =
      Milling{.stock = *ParseStock("20x20x10"), .tool = *ParseTool("flat:6")};
  const auto result = Simulate(Mill(), std::move(setup), std::move(request));
  EXPECT_TRUE(result);
  return result ? TextOf(result->report.judgement) : std::string();
}

const std::string kTooFast = " mm down to where the tool cuts, nearly as fast as Z travels @4";

// 4 mm down at 60 mm/s, then slower, then across at 5 mm/s.
std::string Approach(const std::string& slow) {
  return "!MC1;V60;Z500,500,200;Z500,500,-400;V5;" + slow + "Z1500,500,-500;Z1500,500,200;!MC0;";
}

// To slow down 0.2 mm before the cut is an approach; less is a plunge with a brake. What nothing
// of the program has cleared is taken for granted.
TEST(MillApproach, SlowsDownBeforeItReachesTheMaterial) {
  EXPECT_EQ(SaidOfApproach(Approach("Z500,500,-420;")), "GOOD");
  EXPECT_EQ(FigureOf(Approach("Z500,500,-420;"), "assumed_cleared"), 4.0);
  EXPECT_EQ(SaidOfApproach(Approach("Z500,500,-419;")), "DOUBTFUL; RML1-E8017 4.000" + kTooFast);
  EXPECT_EQ(FigureOf(Approach("Z500,500,-419;"), "assumed_cleared"), 0.0);
  // In two steps of 0.1 mm.
  EXPECT_EQ(SaidOfApproach(Approach("Z500,500,-410,500,500,-420;")), "GOOD");
  // A hole that ends there.
  EXPECT_EQ(
      SaidOfApproach("!MC1;V60;Z500,500,200;Z500,500,-400;V5;Z500,500,-401;V60;Z500,500,200;!MC0;"),
      "DOUBTFUL; RML1-E8017 4.000" + kTooFast);
  EXPECT_EQ(SaidOfApproach("!MC1;V60;Z500,500,200;Z500,500,-400;V5;Z500,500,-401;"),
            "DOUBTFUL; RML1-E8017 4.000" + kTooFast +
                "; RML1-E8011 the tool stays 4.010 mm deep in the work at the end; RML1-E8012 the "
                "spindle turns on at the end");
}

// Behind a cut 3 mm deep 1 mm of the way is new; behind one of 4 mm none is.
TEST(MillApproach, CountsWhatLiesDeeperThanTheCutsBefore) {
  const auto behind = [](const std::string& depth, const std::string& slow) {
    return "!MC1;V5;Z500,500,200;Z500,500,-" + depth + ",1500,500,-" + depth +
           ";V60;Z1500,500,200;" + Approach(slow).substr(5);
  };
  const std::string later = " mm down to where the tool cuts, nearly as fast as Z travels @9";
  EXPECT_EQ(SaidOfApproach(behind("300", "Z500,500,-401;")), "DOUBTFUL; RML1-E8017 1.000" + later);
  EXPECT_EQ(SaidOfApproach(behind("400", "Z500,500,-401;")), "GOOD");
  EXPECT_EQ(FigureOf(behind("300", "Z500,500,-420;"), "assumed_cleared"), 9.0);
  EXPECT_EQ(FigureOf(behind("400", "Z500,500,-420;"), "assumed_cleared"), 0.0);
}

// With a block it is known what stands in the way: 4 mm, at 60 mm/s and from 48 on (0.8 of that).
TEST(MillApproach, MaterialInTheWayIsSeen) {
  const std::string said =
      "DOUBTFUL; CELL-E9620 the tool goes 4.000 mm down into material nearly as fast as Z travels, "
      "faster than it cuts @4";
  EXPECT_EQ(RunInBlock(Approach("Z500,500,-420;")), said);
  const auto with = [](const std::string& v, const std::string& cut) {
    return RunInBlock("!MC1;V" + v + ";Z500,500,200;Z500,500,-400;V5;Z500,500,-420;V" + cut +
                      ";Z1500,500,-420;V10;Z1500,500,200;!MC0;");
  };
  EXPECT_EQ(with("48", "5"), said);
  EXPECT_EQ(with("47", "5"), "GOOD");
  EXPECT_EQ(with("60", "60"), "GOOD");  // the speed of the cut
  // Where a cut has been nothing stands.
  EXPECT_EQ(RunInBlock("!MC1;V5;Z500,500,200;Z500,500,-400,1500,500,-400;V60;Z1500,500,200;" +
                       Approach("Z500,500,-420;").substr(5)),
            "GOOD");
}

// 20 mm along the surface, beside 10 mm of a cut 1 mm deep. Of a pen it is what it draws.
TEST(MillApproach, StrokesAlongTheSurfaceCutNothing) {
  const auto strokes = [](const std::string& z1, const std::string& spindle = "1") {
    return "VS10;!VZ10;!MC" + spindle + ";!PZ-100,200;PU100,100;PD1100,100;!PZ" + z1 +
           ",200;PU100,500;PD2100,500;PU0,0;!MC0;";
  };
  EXPECT_EQ(SaidOfApproach(strokes("0")),
            "DOUBTFUL; RML1-E8015 20.000 mm with the tool down and the spindle on, but along the "
            "surface: nothing is cut there @9");
  EXPECT_EQ(SaidOfApproach(strokes("-1")), "GOOD");
  const std::string pen = "VS10;!VZ10;!MC0;!PZ0,200;PU100,100;PD2100,100;PU0,0;";
  EXPECT_EQ(SaidOfApproach(pen), "GOOD");
  EXPECT_EQ(FigureOf(pen, "skimmed_length"), 0.0);
}

TEST(MillApproach, AToolThatNeverCutsIsTold) {
  const std::string nothing =
      "DOUBTFUL; RML1-E8015 nothing is cut: the tool never goes below the surface";
  // Along the surface with the spindle turning nothing is cut, either; 0.01 mm below it is.
  const auto at = [](const std::string& z1) {
    return "VS10;!VZ10;!PZ" + z1 + ",200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;";
  };
  EXPECT_EQ(SaidOfApproach("VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PU200,100;PU0,0;!MC0;"), nothing);
  EXPECT_EQ(SaidOfApproach(at("0")), nothing);
  EXPECT_EQ(SaidOfApproach(at("-1")), "GOOD");
}

// 190.02 mm from an origin at 10 are 0.02 mm beyond the travel of 200: from 9.98 on it fits. 199 mm
// of work from 2 mm on fit from no origin, for none lies below 0.
TEST(MillApproach, WorkBeyondTheTravelWantsAnotherOriginOrToMove) {
  const auto work = [](const std::string& from, const std::string& to) {
    return "VS10;!VZ10;!PZ-100,200;!MC1;PU" + from + ";PD" + to + ";PU100,100;!MC0;";
  };
  const std::string lost = " mm of the work lie beyond the travel and are not cut @6; RML1-E8002 ";
  EXPECT_EQ(SaidFromOrigin(work("100,100", "19002,100")),
            "BAD; RML1-E8002 0.020" + lost +
                "the work leads 0.020 mm beyond the greatest X: move the origin to less X");
  EXPECT_EQ(SaidFromOrigin(work("100,100", "100,13002")),
            "BAD; RML1-E8002 0.020" + lost +
                "the work leads 0.020 mm beyond the greatest Y: move the origin to less Y");
  EXPECT_EQ(SaidFromOrigin(work("200,100", "20100,100")),
            "BAD; RML1-E8002 11.000" + lost +
                "no work origin in the travel fits: move the program by 1.000 mm to less X");
}

// Programs of Z commands alone: fast down to above the work, slowly into it, an oblique cut, fast
// straight up. What a run finds of them is what a check finds, wherever they lie.
TEST(MillApproach, CheckAndRunOfLiftsBehindObliqueCutsAgree) {
  const auto run = [](const std::string& stream) {
    machine::RunSetup setup(*machine::MakeParameters(Mill(), "t1", {}));
    setup.main_program = 1;
    setup.programs[1].object = machine::Bytes::Of(stream);
    const auto result = Simulate(Mill(), std::move(setup), {});
    return result ? TextOf(result->report.judgement) : std::string();
  };
  std::mt19937 dice(7);
  const auto place = [&](int most) {
    return std::to_string(100 + static_cast<int>(dice() % static_cast<unsigned>(most)));
  };
  for (int n = 0; n < 200; ++n) {
    const std::string from = place(10'000) + "," + place(10'000);
    const std::string to = place(10'000) + "," + place(10'000);
    const std::string stream = "PA;!MC1;V60;Z" + from + ",400;V2;Z" + from + ",-10;V10;Z" + to +
                               ",-10;V60;Z" + to + ",400;Z0,0,400;!MC0;";
    ASSERT_EQ(SaidOfApproach(stream), "GOOD") << stream;
    ASSERT_EQ(run(stream), "GOOD") << stream;
  }
}

}  // namespace
}  // namespace rmlcell::simulation
