#include "engine/optimo/offline/gouge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/optimo/offline/compensate.h"

namespace rmlcell::optimo {
namespace {

std::string Pose(double x, double y, double z = 0.0, double b = 0.0) {
  return "MOVE (" + FixedText(x, 6) + "," + FixedText(y, 6) + "," + FixedText(z, 6) + ",0," +
         FixedText(b, 6) + ")\n";
}

// A contour with the beam on from its first point to its last.
std::string Cut(const std::string& directives, const std::vector<std::string>& moves) {
  std::string text = directives + "COORD ABSOL\nPATH LIN\n";
  for (std::size_t m = 0; m < moves.size(); ++m) {
    if (m == 1) text += "WORK 0,0/ON\n";
    text += moves[m];
  }
  return text + "WORK 0,0/OFF\n";
}

// The steps of the moves that cut into the part; -1 for anything else that is said.
std::vector<int> GougedSteps(const std::string& text) {
  const Compensation made = Compensate(text);
  EXPECT_TRUE(made.ok) << text;
  std::vector<int> steps;
  for (const Diagnostic& d : made.diagnostics) {
    const bool gouge = d.code == ErrorCode::kCompGouge && d.severity == Severity::kWarning;
    steps.push_back(gouge ? d.step : -1);
  }
  return steps;
}

const std::string kLeft = ";$rad=1\n;$left\n", kRight = ";$rad=1\n;$right\n";
const std::vector<int> kNone;

// Along X, up by the width, and back: steps 3 (pierce point), 5, 6 and 7. The third move may be
// tilted a little.
std::string Slot(double width, double b = 0.0) {
  return Cut(kLeft, {Pose(0, 0), Pose(10, 0), Pose(10, width, 0, b), Pose(0, width)});
}

// OPT-8.16; 7812 is ours: a beam of 2 mm needs a slot of 2 mm. In a narrower one the two long moves
// change places, lie on each other (width 1.2: y = 1 and 0.2), or on the contour (width 1).
TEST(Gouge, SlotsNarrowerThanTheBeamAreFound) {
  for (const double width : {0.5, 1.0, 1.2, 1.5, 1.9, 1.99}) {
    const std::vector<int> steps = GougedSteps(Slot(width));
    EXPECT_NE(std::find(steps.begin(), steps.end(), 5), steps.end()) << width;
    EXPECT_NE(std::find(steps.begin(), steps.end(), 7), steps.end()) << width;
  }
  EXPECT_EQ(GougedSteps(Slot(2.0)), kNone);
  EXPECT_EQ(GougedSteps(Slot(2.5)), kNone);
}

// OPT-8.15: a head that turns does not end the check.
TEST(Gouge, AHeadThatTurnsIsNoReasonNotToLook) {
  for (const double b : {0.002, -0.3}) {
    EXPECT_NE(GougedSteps(Slot(1.5, b)), kNone) << b;
    EXPECT_EQ(GougedSteps(Slot(2.5, b)), kNone) << b;
  }
  // Around a tube of radius 50 about X: u(0, B) is (0, -sin B, cos B), at right angles to it.
  const auto slot_on_tube = [](double width) {
    const auto at = [](double x, double along) {
      return Pose(x, 50.0 * std::sin(along / 50.0), 50.0 * std::cos(along / 50.0), -along / 50.0);
    };
    return Cut(kLeft, {at(0, 0), at(10, 0), at(10, width), at(0, width)});
  };
  EXPECT_NE(GougedSteps(slot_on_tube(1.5)), kNone);
  EXPECT_EQ(GougedSteps(slot_on_tube(3.0)), kNone);
}

// While the head stands 0.003 mm are left to rounding; where it turns 2 % of the radius more, since
// its offset is right at the ends of a move alone.
TEST(Gouge, AHeadThatTurnsComesALittleNearer) {
  const auto way_back = [](double width, double b) {
    const std::vector<int> steps = GougedSteps(Slot(width, b));
    return std::find(steps.begin(), steps.end(), 7) != steps.end();
  };
  EXPECT_TRUE(way_back(1.985, 0.0));
  EXPECT_FALSE(way_back(1.998, 0.0));
  EXPECT_FALSE(way_back(1.985, 0.002));
  EXPECT_FALSE(way_back(1.985, 0.0005));
  EXPECT_TRUE(way_back(1.97, 0.002));
}

// A head that stands is looked along: at which height the other side lies is no matter.
TEST(Gouge, OtherHeightsAreNoOtherPlaces) {
  const auto step_up = [](double width, double height) {
    return Cut(kLeft, {Pose(0, 0), Pose(10, 0), Pose(10, width, height), Pose(0, width, height)});
  };
  for (const double height : {-5.0, 5.0}) {
    EXPECT_NE(GougedSteps(step_up(1.5, height)), kNone) << height;
    EXPECT_EQ(GougedSteps(step_up(2.5, height)), kNone) << height;
  }
}

// How deep the beam cuts is said: in a slot of 1.5 the offset moves are 0.5 from the other side.
TEST(Gouge, TheFindingSaysHowDeepItCuts) {
  const Compensation made = Compensate(Slot(1.5));
  ASSERT_FALSE(made.diagnostics.empty());
  EXPECT_NE(made.diagnostics[0].detail.find("within 0.500 mm"), std::string::npos)
      << made.diagnostics[0].detail;
  EXPECT_NE(made.diagnostics[0].detail.find("0.500 mm into the part"), std::string::npos);
}

// OPT-8.17: contours that close, begun at a corner, in the middle of an edge, in the scrap, with a
// lead-out, with a cut beyond the beginning, or left hanging on a tab.
TEST(Gouge, ContoursThatFitAreLeftAlone) {
  const std::vector<std::vector<std::string>> contours = {
      {Pose(0, 0), Pose(20, 0), Pose(20, 20), Pose(0, 20), Pose(0, 0)},
      {Pose(10, 0), Pose(20, 0), Pose(20, 20), Pose(0, 20), Pose(0, 0), Pose(10, 0)},
      {Pose(10, 0), Pose(20, 0), Pose(20, 20), Pose(0, 20), Pose(0, 0), Pose(12, 0)},
  };
  for (const auto& contour : contours) {
    EXPECT_EQ(GougedSteps(Cut(kLeft, contour)), kNone) << contour.size();
    EXPECT_EQ(GougedSteps(Cut(kRight, contour)), kNone) << contour.size();
  }
  const auto with = [](const std::string& pierce, const std::vector<std::string>& end) {
    std::vector<std::string> moves = {pierce,       Pose(10, 0), Pose(20, 0),
                                      Pose(20, 20), Pose(0, 20), Pose(0, 0)};
    moves.insert(moves.end(), end.begin(), end.end());
    return moves;
  };
  const std::string inside = Pose(10, 8), outside = Pose(10, -8);
  for (const std::vector<std::string>& end : {std::vector<std::string>{Pose(10, 0)},
                                              {Pose(12, 0)},
                                              {Pose(10, 0), Pose(10, 8)},
                                              {Pose(10, 0), Pose(13, 8)},
                                              {Pose(9.5, 0)}}) {
    EXPECT_EQ(GougedSteps(Cut(kLeft, with(inside, end))), kNone) << end.back();
  }
  for (const std::vector<std::string>& end :
       {std::vector<std::string>{Pose(10, 0)}, {Pose(10, 0), Pose(13, -8)}, {Pose(9.5, 0)}}) {
    EXPECT_EQ(GougedSteps(Cut(kRight, with(outside, end))), kNone) << end.back();
  }
}

// gouge.h: the way in and the way out are looked for in the first and the last four moves. A longer
// one is an edge like others, and the cut that leads past it is too near.
TEST(Gouge, LeadsHaveFourMovesAtMost) {
  const auto square = [](int in, int out) {
    std::vector<std::string> moves;
    for (int n = 0; n < in; ++n) moves.push_back(Pose(10, 12.0 * (in - n) / in));
    for (const auto& [x, y] : {std::pair{10, 0}, {20, 0}, {20, 20}, {0, 20}, {0, 0}, {10, 0}})
      moves.push_back(Pose(x, y));
    for (int n = 1; n <= out; ++n) moves.push_back(Pose(10 + 3.0 * n / out, 8.0 * n / out));
    return GougedSteps(Cut(kLeft, moves));
  };
  EXPECT_EQ(square(1, 1), kNone);
  EXPECT_EQ(square(4, 1), kNone);
  EXPECT_NE(square(5, 1), kNone);
  EXPECT_EQ(square(1, 4), kNone);
  EXPECT_NE(square(1, 5), kNone);
}

// gouge.h: "or would within a tab's width": half a circle and the line back, from the middle, left
// hanging 1.5 mm before its corner.
TEST(Gouge, ATabOfTwoMovesIsLeftAlone) {
  const std::vector<std::string> moves = {
      Pose(0, 4), Pose(10, 0), "PATH CIR\nMOVE (-10,0,0,0,0)/VIA (0,10,0,0,0)\nPATH LIN\n",
      Pose(8.5, 0)};
  EXPECT_EQ(GougedSteps(Cut(kLeft, moves)), kNone);
}

// What is shorter than what counts as touching leads nowhere: the way in stays an edge, and the cut
// ends 0.9 beside it.
TEST(Gouge, ATabNeedsAPieceWithADirection) {
  const auto last = [](double length) {
    return GougedSteps(Cut(kRight, {Pose(0.9, -5), Pose(0.9, 0), Pose(20, 0), Pose(20, 20),
                                    Pose(0, 20), Pose(0, 0), Pose(length, 0)}));
  };
  EXPECT_EQ(last(0.005), kNone);
  EXPECT_NE(last(0.004), kNone);
}

// An arc is looked at to its very end: it comes down to (6.5, 1.5), from where the cut turns to the
// right. The corner of the offset moves lies at y = 0.5, over the first edge at y = 0.
TEST(Gouge, ArcsAreLookedAtToTheirEnd) {
  const Compensation made = Compensate(
      Cut(kLeft, {Pose(0, 0), Pose(20, 0), Pose(20, 10), Pose(15, 10),
                  "PATH CIR\nMOVE (6.5,1.5,0,0,0)/VIA (8.98959236,7.51040764,0,0,0)\nPATH LIN\n",
                  Pose(6, 1.5)}));
  ASSERT_TRUE(made.ok);
  std::vector<std::string> of_arc;
  for (const Diagnostic& d : made.diagnostics) {
    if (d.step == 9) of_arc.push_back(d.detail);
  }
  ASSERT_EQ(of_arc.size(), 1U);
  EXPECT_TRUE(of_arc[0].starts_with("the compensated path comes within 0.500 mm")) << of_arc[0];
}

// The beam starts at the pierce point: 0.8 from the first edge, to which its way in leads.
TEST(Gouge, APierceTooNearToItsOwnEdgeIsFound) {
  const auto pierced = [](double y) {
    return GougedSteps(Cut(kLeft, {Pose(13, y), Pose(10, 0), Pose(20, 0), Pose(20, 20), Pose(0, 20),
                                   Pose(0, 0), Pose(10, 0)}));
  };
  EXPECT_EQ(pierced(0.8), (std::vector<int>{5}));
  EXPECT_EQ(pierced(1.2), kNone);
}

// Pierced 0.4 from the edge, in the scrap: the beam of radius 1 reaches across it.
TEST(Gouge, APierceTooNearToAnotherEdgeIsFound) {
  const std::vector<int> steps =
      GougedSteps(Cut(kLeft, {Pose(10, 19.6), Pose(10, 0), Pose(20, 0), Pose(20, 20), Pose(0, 20),
                              Pose(0, 0), Pose(10, 0)}));
  EXPECT_EQ(steps, (std::vector<int>{5}));
}

// OPT-8.17: a hole that ends in its corner without a way out: the last move ends 1 mm along the
// first edge, on it.
TEST(Gouge, AnEndInAnInsideCornerIsFound) {
  const std::vector<std::string> moves = {Pose(10, 10), Pose(0, 0),  Pose(20, 0),
                                          Pose(20, 20), Pose(0, 20), Pose(0, 0)};
  EXPECT_EQ(GougedSteps(Cut(kLeft, moves)), (std::vector<int>{9}));
  std::vector<std::string> way_out = moves;
  way_out.push_back(Pose(10, 10));
  EXPECT_EQ(GougedSteps(Cut(kLeft, way_out)), kNone);
}

// OPT-8.18: circles of two arcs about (0,0), cut from the middle.
TEST(Gouge, ArcsAreLookedAtAsArcs) {
  const auto circle = [](double radius) {
    const auto arc = [&](double sign) {
      const std::string r = FixedText(sign * radius, 6);
      return "MOVE (" + FixedText(-sign * radius, 6) + ",0,0,0,0)/VIA (0," + r + ",0,0,0)\n";
    };
    return Cut(kLeft, {Pose(0, 0), Pose(radius, 0), "PATH CIR\n" + arc(1.0), arc(-1.0)});
  };
  EXPECT_EQ(GougedSteps(circle(300.0)), kNone);
  EXPECT_EQ(GougedSteps(circle(5.0)), kNone);
  // An arc that hangs down to a line: (10,dip) is its lowest point.
  const auto hanging = [](double dip) {
    return Cut(kLeft, {Pose(0, 0), Pose(20, 0), Pose(20, 10), Pose(15, 10),
                       "PATH CIR\nMOVE (5,10,0,0,0)/VIA (10," + FixedText(dip, 6) + ",0,0,0)\n"});
  };
  EXPECT_EQ(GougedSteps(hanging(2.5)), kNone);
  EXPECT_EQ(GougedSteps(hanging(1.5)), (std::vector<int>{5, 9}));
}

// A last move that is shorter than its corner needs: from (9,1) back to (9,0.5), 0.5 from the edge
// before it.
TEST(Gouge, MovesThatRunBackAreFound) {
  EXPECT_EQ(GougedSteps(Cut(kLeft, {Pose(0, 0), Pose(10, 0), Pose(10, 0.5)})),
            (std::vector<int>{6}));
  EXPECT_EQ(GougedSteps(Cut(kLeft, {Pose(0, 0), Pose(10, 0), Pose(10, 1.5)})), kNone);
  // The first one begins where it was programmed, and only its end moves.
  EXPECT_EQ(GougedSteps(Cut(kLeft, {Pose(0, 0), Pose(0.5, 0), Pose(0.5, 10)})), kNone);
}

// gouge.h: a beam of the radius of the tolerance, 0.003 mm, cuts into nothing. At a turn of 150
// degrees its corner lies tan 75 times that back, 0.011 mm; the last move is 0.001 mm long.
TEST(Gouge, ABeamOfTheToleranceCutsNothing) {
  const std::vector<std::string> moves = {Pose(0, 0), Pose(10, 0), Pose(9.999134, 0.0005)};
  EXPECT_EQ(GougedSteps(Cut(";$rad=0.003\n;$left\n", moves)), kNone);
  EXPECT_EQ(GougedSteps(Cut(";$rad=0.004\n;$left\n", moves)), (std::vector<int>{6}));
}

// A spiral of many short moves: nothing is left out, and nothing is found.
TEST(Gouge, LongContoursAreLookedAtWhole) {
  std::vector<std::string> moves;
  for (int n = 0; n < 20'000; ++n) {
    const double angle = 0.05 * n, radius = 20.0 + 3.0 * angle / (2.0 * M_PI);
    moves.push_back(Pose(radius * std::cos(angle), radius * std::sin(angle)));
  }
  EXPECT_EQ(GougedSteps(Cut(kLeft, moves)), kNone);
  EXPECT_GT(GougedSteps(Cut(";$rad=3.2\n;$left\n", moves)).size(), 900U);  // pitch 3: everywhere
}

// What is left out is said: a triangle that is cut over and over lies in one place.
TEST(Gouge, WhatIsNotLookedAtIsSaid) {
  std::vector<std::string> moves = {Pose(2, -3), Pose(2, 0)};
  for (int n = 0; n < 10'000; ++n) {
    moves.push_back(Pose(4, 0));
    moves.push_back(Pose(0, 3));
    moves.push_back(Pose(0, 0));
  }
  const Compensation made = Compensate(Cut(";$rad=0.1\n;$right\n", moves));
  ASSERT_TRUE(made.ok);
  ASSERT_EQ(made.diagnostics.size(), 1U);
  const Diagnostic& said = made.diagnostics[0];
  EXPECT_EQ(said.code, ErrorCode::kCompGouge);
  EXPECT_EQ(said.severity, Severity::kAdvice);
  EXPECT_EQ(said.rule, "OPT-8.19");
  EXPECT_EQ(said.detail, "not checked from step " + std::to_string(said.step) +
                             " to 30005: the contour is too long to be looked through");
  EXPECT_GT(said.step, 5);  // the first were looked at
  EXPECT_LT(said.step, 30'005);
}

// gouge.h: what lies within two radii of a pierce point on an edge is left out, and no more: in a
// slot of 3.5 by 1.5 mm the beam of radius 1 is further than 2 mm from (0,0) at its end, where both
// long moves come within 0.5 mm of the other side.
TEST(Gouge, TwoRadiiAroundAPierceOnAnEdgeAreLeftOut) {
  const std::vector<int> steps =
      GougedSteps(Cut(kLeft, {Pose(0, 0), Pose(3.5, 0), Pose(3.5, 1.5), Pose(0, 1.5)}));
  EXPECT_NE(std::find(steps.begin(), steps.end(), 5), steps.end());
  EXPECT_NE(std::find(steps.begin(), steps.end(), 7), steps.end());
}

// gouge.h: a tab is 2 mm wide at most. What ends 1.99 mm before the point where it began has come
// back, and the way in lies in the scrap; at 2.01 mm the way in is an edge, and a beam of
// radius 3.5 comes as near to it.
TEST(Gouge, ATabIsTwoMillimetresAtMost) {
  const auto with_tab = [](double mm) {
    return GougedSteps(
        Cut(";$rad=3.5\n;$left\n", {Pose(10, 12), Pose(10, 0), Pose(20, 0), Pose(20, 20),
                                    Pose(0, 20), Pose(0, 0), Pose(10.0 - mm, 0)}));
  };
  EXPECT_EQ(with_tab(1.99), kNone);
  EXPECT_NE(with_tab(2.01), kNone);
}

// OPT-7.30, OPT-8.15, OPT-8.23: a system that is turned about X has the head along its Y. The slot
// lies in X and Z, and the head stands: 0.003 mm are left to rounding, and not 2 % of the radius.
TEST(Gouge, AHeadThatStandsInATurnedSystem) {
  const auto way_back = [](const std::string& width) {
    const std::vector<int> steps = GougedSteps(
        ";$rad=1\n;$right\nCOORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\n"
        "SYSDEF (0,0,0,0,0,1.5707963268)\nWORK 0,0/ON\nMOVE (10,0,0,0,0)\nMOVE (10,0," +
        width + ",0,0)\nMOVE (0,0," + width + ",0,0)\nWORK 0,0/OFF\n");
    return std::find(steps.begin(), steps.end(), 8) != steps.end();
  };
  EXPECT_TRUE(way_back("1.985"));
  EXPECT_FALSE(way_back("1.998"));
}

// A million pieces are looked at, of the contour and of the path together, so 500,001 lines of
// each; the next one is told, although another one follows it.
TEST(Gouge, AMillionPiecesAreLookedAt) {
  constexpr std::size_t kLooked = 500'001;
  std::vector<Leg> legs(kLooked + 2);
  for (std::size_t k = 0; k < legs.size(); ++k) {
    const double x = static_cast<double>(k);
    legs[k].from = {x, 0, 0};
    legs[k].to = {x + 1.0, 0, 0};
    legs[k].tool_from = legs[k].tool_to = legs[k].tool_via = {0, 0, 1};
    Prepare(legs[k]);
  }
  std::size_t failed = 0;
  const auto moved = OffsetChain(legs, 0.1, failed);
  ASSERT_TRUE(moved);
  const GougeSearch search = FindGouges(legs, *moved, 0.1);
  EXPECT_TRUE(search.found.empty());
  EXPECT_EQ(search.unchecked_from, kLooked);
}

}  // namespace
}  // namespace rmlcell::optimo
