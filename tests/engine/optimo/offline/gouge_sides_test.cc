#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/gouge.h"

namespace rmlcell::optimo {
namespace {

std::string FlatMove(double x, double y) {
  return "MOVE (" + FixedText(x, 6) + "," + FixedText(y, 6) + ",0,0,0)\n";
}

// The gouged moves of a contour that starts with the beam on at its first point; 0 is the first
// move behind it.
std::vector<int> GougedMoves(const std::string& side, const std::vector<std::string>& moves) {
  std::string text = side + "COORD ABSOL\nPATH LIN\n";
  for (std::size_t m = 0; m < moves.size(); ++m) {
    if (m == 1) text += "WORK 0,0/ON\n";
    text += moves[m];
  }
  const Compensation made = Compensate(text + "WORK 0,0/OFF\n");
  EXPECT_TRUE(made.ok) << text;
  std::vector<int> found;
  for (const Diagnostic& d : made.diagnostics) {
    if (d.code == ErrorCode::kCompGouge && d.severity == Severity::kWarning)
      found.push_back(
          static_cast<int>(
              std::count(text.begin(), text.begin() + static_cast<int>(d.where.byte_offset), 'M')) -
          1);
  }
  return found;
}

bool Holds(const std::vector<int>& moves, int move) {
  return std::find(moves.begin(), moves.end(), move) != moves.end();
}

Leg StraightLeg(ProgramVector from, ProgramVector to) {
  Leg leg;
  leg.from = from;
  leg.to = to;
  leg.tool_from = leg.tool_to = leg.tool_via = {0, 0, 1};
  Prepare(leg);
  return leg;
}

std::vector<std::size_t> FoundLegs(const std::vector<ProgramVector>& points, double offset) {
  std::vector<Leg> legs;
  for (std::size_t p = 1; p < points.size(); ++p)
    legs.push_back(StraightLeg(points[p - 1], points[p]));
  std::size_t failed = 0;
  const auto moved = OffsetChain(legs, offset, failed);
  EXPECT_TRUE(moved) << failed;
  std::vector<std::size_t> found;
  for (const Gouge& gouge : FindGouges(legs, *moved, offset).found) found.push_back(gouge.leg);
  return found;
}

// gouge.h: two radii around a pierce on an edge are left out, and no more, however short the
// moves are that lead out of there.
TEST(GougeSides, ShortMovesLeaveTheBallOfThePierce) {
  const std::vector<int> found =
      GougedMoves(";$rad=0.25\n;$left\n",
                  {FlatMove(0, 0), FlatMove(0.875, 0), FlatMove(0.875, 0.375), FlatMove(0, 0.375)});
  EXPECT_TRUE(Holds(found, 0));
  EXPECT_TRUE(Holds(found, 2));
}

// gouge.h: an arc under a head that stands leaves it standing: 0.003 mm are left to rounding, and
// not 2 % of the radius.
TEST(GougeSides, ArcsLeaveAStandingHeadStanding) {
  const auto way_back = [](double width) {
    return Holds(
        GougedMoves(";$rad=1\n;$left\n",
                    {FlatMove(0, 0), FlatMove(10, 0), FlatMove(10, width), FlatMove(0, width),
                     "PATH CIR\nMOVE (-10," + FixedText(width + 10.0, 6) +
                         ",0,0,0)/VIA (-7.071068," + FixedText(width + 2.928932, 6) + ",0,0,0)\n"}),
        2);
  };
  EXPECT_TRUE(way_back(1.985));
  EXPECT_FALSE(way_back(1.998));
}

// gouge.h: a triangle of three moves comes back to itself where the third crosses the first: what
// lies before that is scrap, which the beam may cut.
TEST(GougeSides, ThreeMovesMayComeBackToThemselves) {
  EXPECT_FALSE(Holds(GougedMoves(";$rad=1\n;$right\n", {FlatMove(-6, 0), FlatMove(20, 0),
                                                        FlatMove(10, 15), FlatMove(-4, -6)}),
                     2));
}

// gouge.h: where the last move crosses the way in twice, the contour begins at the first crossing:
// what lies between them is an edge, and (10,20) to (5,0.8) cuts into it.
TEST(GougeSides, TheContourBeginsAtTheFirstCrossing) {
  const std::vector<std::size_t> found = FoundLegs({{0, -10, 0},
                                                    {0, 0, 0},
                                                    {10, 0, 0},
                                                    {10, -10, 0},
                                                    {40, -10, 0},
                                                    {40, 20, 0},
                                                    {5, 20, 0},
                                                    {5, 0.8, 0},
                                                    {-20, 20, 0},
                                                    {-20, -5, 0},
                                                    {30, -5, 0}},
                                                   1.0);
  EXPECT_NE(std::find(found.begin(), found.end(), 6U), found.end());
}

// gouge.h: so it does where the last move comes to the later one of the two crossings first.
TEST(GougeSides, TheFirstCrossingIsThatOfTheWayIn) {
  const std::vector<std::size_t> found = FoundLegs({{0, -10, 0},
                                                    {0, 0, 0},
                                                    {10, 0, 0},
                                                    {10, -10, 0},
                                                    {40, -10, 0},
                                                    {40, 20, 0},
                                                    {5, 20, 0},
                                                    {5, 0.8, 0},
                                                    {-20, 20, 0},
                                                    {-20, -20, 0},
                                                    {50, -20, 0},
                                                    {50, -5, 0},
                                                    {-20, -5, 0}},
                                                   1.0);
  EXPECT_NE(std::find(found.begin(), found.end(), 6U), found.end());
}

// gouge.h: a tab ends the contour at its corner: neither the way in nor the last move is an edge
// beyond it. Both would be crossed if they went on: the way in to (-5,5), the last move to (17,0).
TEST(GougeSides, ATabClosesAtItsCorner) {
  EXPECT_EQ(GougedMoves(";$rad=1\n;$right\n", {FlatMove(25, -5), FlatMove(10, 0), FlatMove(10, 10),
                                               FlatMove(0, 10), FlatMove(0, 0), FlatMove(8.5, 0)}),
            std::vector<int>{});
}

// gouge.h: an edge of the contour is one to its end, where it came back to itself or was left
// hanging on a tab: (5,20) to (5,0.8) comes too near to the last move.
TEST(GougeSides, TheLastEdgeIsLookedAt) {
  for (const double end : {10.0, 8.5}) {
    const std::vector<std::size_t> found = FoundLegs({{10, 5, 0},
                                                      {10, 0, 0},
                                                      {20, 0, 0},
                                                      {20, 20, 0},
                                                      {5, 20, 0},
                                                      {5, 0.8, 0},
                                                      {-9, 20, 0},
                                                      {-9, 0, 0},
                                                      {end, 0, 0}},
                                                     1.0);
    EXPECT_NE(std::find(found.begin(), found.end(), 4U), found.end()) << end;
  }
}

// gouge.h: what ends before the ball of the pierce is not drawn on into it: the third move comes
// back towards (0,0) at 20 degrees to the first edge, and stops 1.2 mm beside it.
TEST(GougeSides, AMoveEndsWhereItEnds) {
  EXPECT_EQ(FoundLegs({{0, 0, 0}, {40.84, 0, 0}, {35.84, 14.11, 0}, {2.947, 2.137, 0}}, 1.0),
            std::vector<std::size_t>{});
}

// gouge.h: an arc that was to turn by 0.1 and goes the long way round runs back.
TEST(GougeSides, AnArcTheLongWayRoundRunsBack) {
  const auto at = [](double radius, double angle) {
    return ProgramVector(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  };
  std::vector<Leg> legs = {StraightLeg({10, -20, 0}, at(10, 0)),
                           StraightLeg(at(10, 0), at(10, 0.1))};
  legs[1].via = at(10, 0.05);
  Prepare(legs[1]);
  ASSERT_TRUE(legs[1].is_arc);
  const GougeSearch back = FindGouges(legs, {{at(9, 0.2), {}}, {at(9, 0.1), at(9, 0.05)}}, 1.0);
  ASSERT_EQ(back.found.size(), 1U);
  EXPECT_EQ(back.found[0].leg, 1U);
  EXPECT_EQ(back.found[0].kind, Gouge::Kind::kRunsBack);
  EXPECT_EQ(back.found[0].distance, 0.0);
  EXPECT_TRUE(FindGouges(legs, {{at(9, 0), {}}, {at(9, 0.1), at(9, 0.05)}}, 1.0).found.empty());
  // One that has become a line leads where it was to lead.
  EXPECT_TRUE(FindGouges(legs, {{at(9, 0), {}}, {at(9, 0.1), {}}}, 1.0).found.empty());
  EXPECT_TRUE(FindGouges({}, {}, 1.0).found.empty());
}

// gouge.h: the chord of an arc of 4.5 leads against the direction in which the arc begins: one that
// has become a line leads where it was to lead all the same.
TEST(GougeSides, AnArcOfMoreThanHalfATurnThatBecameALine) {
  const auto at = [](double radius, double angle) {
    return ProgramVector(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  };
  std::vector<Leg> legs = {StraightLeg({10, -20, 0}, at(10, 0)),
                           StraightLeg(at(10, 0), at(10, 4.5))};
  legs[1].via = at(10, 2.0);
  Prepare(legs[1]);
  ASSERT_TRUE(legs[1].is_arc);
  EXPECT_TRUE(FindGouges(legs, {{at(9, 0), {}}, {at(9, 4.5), {}}}, 1.0).found.empty());
}

// A head of which the angles are not known stands straight down: at which height the other side of
// the slot lies is no matter.
TEST(GougeSides, HeightsDoNotMatterUnderAnUnknownHead) {
  for (const std::string angles : {"0,0", "VR[1],0"}) {
    const std::vector<int> found =
        GougedMoves(";$rad=1\n;$left\n", {"MOVE (0,0,0," + angles + ")\n", FlatMove(10, 0),
                                          "MOVE (10,1.5,5,0,0)\n", "MOVE (0,1.5,5,0,0)\n"});
    EXPECT_TRUE(Holds(found, 2)) << angles;
  }
}

// gouge.h: the way in may have up to four moves, and a tab ends before the end of any of them.
TEST(GougeSides, ATabEndsBeforeAnyMoveOfTheWayIn) {
  for (int moves = 1; moves <= 4; ++moves) {
    const auto with_tab = [&](double mm) {
      std::vector<std::string> text;
      for (int n = 0; n < moves; ++n) text.push_back(FlatMove(10, 20.0 * (moves - n) / moves));
      for (const auto& [x, y] : {std::pair{10.0, 0.0}, {20, 0}, {20, 40}, {0, 40}, {0, 0}})
        text.push_back(FlatMove(x, y));
      text.push_back(FlatMove(10.0 - mm, 0));
      return GougedMoves(";$rad=3.5\n;$left\n", text);
    };
    EXPECT_EQ(with_tab(1.99), std::vector<int>{}) << moves;
    EXPECT_NE(with_tab(2.01), std::vector<int>{}) << moves;
  }
}

// gouge.h: a tab ends before the end of a move, and not before the middle of one. The way in is a
// half circle about (9,5); the last move leads towards its lowest point, (9,0), and ends 1 mm
// before it. So the way in is an edge, and the last move comes to within 0.88 mm of it.
TEST(GougeSides, ATabDoesNotEndInTheMiddleOfAMove) {
  const std::vector<int> found = GougedMoves(
      ";$rad=1\n;$left\n",
      {FlatMove(4, 5), "PATH CIR\nMOVE (14,5,0,0,0)/VIA (9,0,0,0,0)\nPATH LIN\n", FlatMove(20, 5),
       FlatMove(20, 20), FlatMove(0, 20), FlatMove(0, 0), FlatMove(8, 0)});
  EXPECT_TRUE(Holds(found, 5));
}

// gouge.h: a tab is 2 mm wide at most, wherever the contour lies, and behind an arc as behind a
// line.
TEST(GougeSides, ATabIsAsWideAnywhere) {
  const auto with_tab = [](double mm, const std::string& way_in, double dx, double dy) {
    std::vector<std::string> text = {FlatMove(dx + 10.0, dy + 12.0), way_in};
    for (const auto& [x, y] : {std::pair{20.0, 0.0}, {20.0, 20.0}, {0.0, 20.0}, {0.0, 0.0}})
      text.push_back(FlatMove(dx + x, dy + y));
    text.push_back(FlatMove(dx + 10.0 - mm, dy));
    return GougedMoves(";$rad=3.5\n;$left\n", text);
  };
  const std::string line = FlatMove(110.0, 50.0),
                    arc = "PATH CIR\nMOVE (10,0,0,0,0)/VIA (9,6,0,0,0)\nPATH LIN\n";
  EXPECT_EQ(with_tab(1.99, line, 100.0, 50.0), std::vector<int>{});
  EXPECT_NE(with_tab(2.01, line, 100.0, 50.0), std::vector<int>{});
  EXPECT_EQ(with_tab(1.99, arc, 0.0, 0.0), std::vector<int>{});
  EXPECT_NE(with_tab(2.01, arc, 0.0, 0.0), std::vector<int>{});
}

// gouge.h: a beam that starts on an edge damages it: what lies within two radii of the start is
// left out, the second edge as well, which comes back to within 0.74 mm of it.
TEST(GougeSides, ASecondEdgeMayComeBackToAPierceOnAnEdge) {
  EXPECT_EQ(GougedMoves(";$rad=1\n;$right\n", {FlatMove(0, 0), FlatMove(5, 0), FlatMove(0, 0.75)}),
            std::vector<int>{});
}

// gouge.h: a last move that goes on behind the point where the contour came back to itself leads
// into the scrap: what lies there is no edge, and the way in may cross it.
TEST(GougeSides, TheLastMoveMayGoOnIntoTheScrap) {
  EXPECT_EQ(GougedMoves(";$rad=1\n;$right\n", {FlatMove(-8, -3), FlatMove(0, 0), FlatMove(20, 0),
                                               FlatMove(20, 20), FlatMove(0, 20), FlatMove(0, -5)}),
            std::vector<int>{});
}

// How near a path comes to an edge along X that it passes on an arc whose lowest point lies 0.9 mm
// above it; -1 where it is not told.
double ToldDistance(double radius, double sweep) {
  const double x = radius * std::sin(sweep / 2.0), y = 0.9 + radius * (1.0 - std::cos(sweep / 2.0));
  std::vector<Leg> legs = {
      StraightLeg({-200, 0, 0}, {200, 0, 0}), StraightLeg({200, 0, 0}, {200, 300, 0}),
      StraightLeg({200, 300, 0}, {100, 300, 0}), StraightLeg({100, 300, 0}, {-100, 300, 0})};
  legs[3].via = ProgramVector(0, 290, 0);
  Prepare(legs[3]);
  std::vector<OffsetLeg> moved(4);
  moved[0].to = {199, 1, 0};
  moved[1].to = {199, 299, 0};
  moved[2].to = {x, y, 0};
  moved[3].to = {-x, y, 0};
  moved[3].via = ProgramVector(0, 0.9, 0);
  for (const Gouge& gouge : FindGouges(legs, moved, 1.0).found) {
    if (gouge.leg == 3) return gouge.distance;
  }
  return -1.0;
}

// gouge.h: rounding and the chords of arcs make up a third of the tolerance of 0.003 mm: those of
// path and contour half of that each; of a circle of 16 m, whose chords are a thousandth of a
// radian, all of it. However short an arc is it has a chord.
TEST(GougeSides, ChordsKeepToTheirShareOfTheTolerance) {
  for (int n = 0; n < 20; ++n) {
    const double told = ToldDistance(100.0, 1.0 + 0.01 * n);
    EXPECT_GE(told, 0.9 - 1e-6) << n;
    EXPECT_LE(told, 0.9 + 0.0005 + 1e-6) << n;
  }
  for (const double sweep : {0.0009, 0.030, 0.031, 0.032, 0.033, 0.034, 0.035, 0.036, 0.037}) {
    const double told = ToldDistance(8000.0, sweep);
    EXPECT_GE(told, 0.9 - 1e-6) << sweep;
    EXPECT_LE(told, 0.9 + 0.001 + 1e-6) << sweep;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
