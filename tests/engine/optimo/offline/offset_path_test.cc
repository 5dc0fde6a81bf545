#include "engine/optimo/offline/offset_path.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>

namespace rmlcell::optimo {
namespace {

using motion::ToolDirection;

// A right-handed plane somewhere in space; the tool stands on it.
struct Plane {
  ProgramVector origin, ex, ey, ez;
  ProgramVector At(double x, double y) const { return origin + ex * x + ey * y; }
};

const std::array<Plane, 3> kPlanes = {
    Plane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    Plane{{100, -50, 30}, {0, 0, 1}, {0.6, 0.8, 0}, {-0.8, 0.6, 0}},
    Plane{{7, 8, -9}, {0.8, 0, 0.6}, {0, 1, 0}, {-0.6, 0, 0.8}},
};

Leg LineOf(const Plane& plane, double x1, double y1, double x2, double y2) {
  Leg leg;
  leg.from = plane.At(x1, y1);
  leg.to = plane.At(x2, y2);
  leg.tool_from = leg.tool_to = leg.tool_via = plane.ez;
  Prepare(leg);
  return leg;
}

// About (cx, cy), between two angles of the plane.
Leg ArcOf(const Plane& plane, double cx, double cy, double radius, double from, double to) {
  const auto at = [&](double angle) {
    return plane.At(cx + radius * std::cos(angle), cy + radius * std::sin(angle));
  };
  Leg leg;
  leg.from = at(from);
  leg.to = at(to);
  leg.via = at(from + (to - from) * 0.4);
  leg.tool_from = leg.tool_to = leg.tool_via = plane.ez;
  Prepare(leg);
  return leg;
}

std::vector<OffsetLeg> MustOffset(const std::vector<Leg>& legs, double offset) {
  std::size_t failed = 99;
  auto moved = OffsetChain(legs, offset, failed);
  EXPECT_TRUE(moved) << failed;
  return moved ? *moved : std::vector<OffsetLeg>(legs.size());
}

void ExpectNear(const ProgramVector& a, const ProgramVector& b) { EXPECT_LT((a - b).norm(), 1e-9); }

// OPT-2.19: centre, radius and directions of arcs either way round, over half a turn and more.
TEST(OffsetPath, ArcsGoThroughTheirThreePoints) {
  for (const Plane& plane : kPlanes) {
    for (const double sweep : {0.5, 2.0, 4.5, -0.5, -2.0, -4.5}) {
      const Leg leg = ArcOf(plane, 3.0, -2.0, 5.0, 0.3, 0.3 + sweep);
      ASSERT_TRUE(leg.is_arc);
      ExpectNear(leg.centre, plane.At(3.0, -2.0));
      EXPECT_NEAR(leg.radius, 5.0, 1e-9);
      const double turn = sweep > 0.0 ? 1.0 : -1.0;
      ExpectNear(leg.axis, plane.ez * turn);
      const auto tangent = [&](double angle) -> ProgramVector {
        return plane.ex * (-std::sin(angle) * turn) + plane.ey * (std::cos(angle) * turn);
      };
      ExpectNear(leg.tangent_from, tangent(0.3));
      ExpectNear(leg.tangent_via, tangent(0.3 + 0.4 * sweep));
      ExpectNear(leg.tangent_to, tangent(0.3 + sweep));
      EXPECT_NEAR(ShareAtVia(leg), 0.4, 1e-9);
    }
    const Leg line = LineOf(plane, 1, 2, 4, 6);
    EXPECT_FALSE(line.is_arc);
    EXPECT_EQ(ShareAtVia(line), 0.5);
    for (const ProgramVector& tangent : {line.tangent_from, line.tangent_via, line.tangent_to})
      ExpectNear(tangent, plane.ex * 0.6 + plane.ey * 0.8);
  }
}

// Three points on a line are a line, and one point has no direction.
TEST(OffsetPath, PointsOnALineMakeNoArc) {
  Leg leg = LineOf(kPlanes[1], 0, 0, 10, 0);
  leg.via = kPlanes[1].At(3, 0);
  Prepare(leg);
  EXPECT_FALSE(leg.is_arc);
  ExpectNear(leg.tangent_from, kPlanes[1].ex);
  Leg straightened = ArcOf(kPlanes[1], 3.0, -2.0, 5.0, 0.3, 1.3);  // prepared once more
  ASSERT_TRUE(straightened.is_arc);
  straightened.via = ProgramVector((straightened.from + straightened.to) * 0.5);
  Prepare(straightened);
  EXPECT_FALSE(straightened.is_arc);
  const Leg none = LineOf(kPlanes[1], 5, 5, 5, 5);
  EXPECT_EQ(none.tangent_to, ProgramVector{});
  EXPECT_EQ(LeftNormal({0, 0, 1}, {}), ProgramVector{});
  EXPECT_EQ(LeftNormal({0, 0, 1}, {0, 0, -1}), ProgramVector{});
  ExpectNear(LeftNormal({0, 0, 1}, {1, 0, 0}), {0, 1, 0});
}

// OPT-B.03: u(A, B) for a quarter turn of each.
TEST(OffsetPath, TheToolStandsAsTheHeadDoes) {
  ExpectNear(ToolDirection(0.0, 0.0), {0, 0, 1});
  ExpectNear(ToolDirection(0.0, M_PI / 2), {0, -1, 0});
  ExpectNear(ToolDirection(M_PI / 2, M_PI / 2), {1, 0, 0});
  ExpectNear(ToolDirection(0.7, 0.3),
             {std::sin(0.7) * std::sin(0.3), -std::cos(0.7) * std::sin(0.3), std::cos(0.3)});
}

// OPT-8.16, OPT-8.17: lines meet at the point that lies beside both of them; a chain ends beside
// its last point.
TEST(OffsetPath, CornersOfLinesLieBesideBoth) {
  for (const Plane& plane : kPlanes) {
    for (double turn = -2.9; turn < 2.95; turn += 0.29) {
      for (const double offset : {1.5, -0.7}) {
        const double dx = std::cos(turn), dy = std::sin(turn);
        const Leg first = LineOf(plane, -20, 0, 0, 0);
        const Leg second = LineOf(plane, 0, 0, 20 * dx, 20 * dy);
        const auto moved = MustOffset({first, second}, offset);
        // Beside the first: y = offset; beside the second: its left normal is (-dy, dx).
        const double x = std::fabs(dy) < 1e-12 ? 0.0 : (offset * dx - offset) / dy;
        ExpectNear(moved[0].to, plane.At(x, offset));
        ExpectNear(moved[1].to, plane.At(20 * dx - offset * dy, 20 * dy + offset * dx));
        EXPECT_FALSE(moved[0].via);
      }
    }
  }
}

// OPT-8.18, OPT-B.79: where an arc is met at a corner, the new corner lies on the concentric circle
// and beside the line, and of the two such points it is the one near the old corner.
TEST(OffsetPath, CornersWithArcsLieOnTheConcentricCircle) {
  std::mt19937 random(5);
  const auto dice = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random() % 10'000) / 10'000.0;
  };
  for (int round = 0; round < 300; ++round) {
    const Plane& plane = kPlanes[static_cast<std::size_t>(round) % kPlanes.size()];
    const double radius = dice(8, 20), offset = dice(-1, 1), heading = dice(0, 6.28);
    const double sweep = (round % 2 == 0 ? 1.0 : -1.0) * dice(0.5, 2.5), start = dice(0, 6.28);
    const double turn = sweep > 0.0 ? 1.0 : -1.0;
    // The arc begins in the origin of the plane.
    const double cx = -radius * std::cos(start), cy = -radius * std::sin(start);
    const Leg arc = ArcOf(plane, cx, cy, radius, start, start + sweep);
    const Leg line = LineOf(plane, -30 * std::cos(heading), -30 * std::sin(heading), 0, 0);
    const double along = std::cos(heading) * -std::sin(start) * turn +
                         std::sin(heading) * std::cos(start) * turn;  // 1: tangent, -1: back
    if (along < -0.5 || along > 0.95) continue;
    const auto moved = MustOffset({line, arc}, offset);
    const ProgramVector corner = moved[0].to;
    const ProgramVector normal = plane.ex * -std::sin(heading) + plane.ey * std::cos(heading);
    EXPECT_NEAR((corner - plane.origin).dot(normal), offset, 1e-9);
    const double new_radius = radius - turn * offset;  // left of a left turn is inside
    EXPECT_NEAR((corner - plane.At(cx, cy)).norm(), new_radius, 1e-9);
    EXPECT_NEAR((corner - plane.origin).dot(plane.ez), 0.0, 1e-9);
    EXPECT_LT((corner - plane.origin).norm(), 4.0 * std::fabs(offset) + 1e-9);
    EXPECT_NEAR((moved[1].to - plane.At(cx, cy)).norm(), new_radius, 1e-9);
    ASSERT_TRUE(moved[1].via);
    EXPECT_NEAR((*moved[1].via - plane.At(cx, cy)).norm(), new_radius, 1e-9);
    // The same corner, run the other way: left becomes right.
    Leg back = ArcOf(plane, cx, cy, radius, start + sweep, start);
    const auto again = MustOffset(
        {back, LineOf(plane, 0, 0, -30 * std::cos(heading), -30 * std::sin(heading))}, -offset);
    ExpectNear(again[0].to, corner);
  }
}

// OPT-B.79: two arcs that meet at a corner: the point lies on both concentric circles, near it.
TEST(OffsetPath, CornersOfTwoArcsLieOnBothCircles) {
  for (const Plane& plane : kPlanes) {
    for (const double offset : {0.8, -0.8}) {
      for (const double turn_1 : {1.0, -1.0}) {
        for (const double turn_2 : {1.0, -1.0}) {
          // The first heads along x into the origin, the second leaves it 60 degrees to the left.
          const double heading = M_PI / 3;
          const double r1 = 10.0, r2 = 14.0;
          const double c1x = 0.0, c1y = turn_1 * r1;
          const double c2x = -turn_2 * r2 * std::sin(heading),
                       c2y = turn_2 * r2 * std::cos(heading);
          const double end_1 = -turn_1 * M_PI / 2, begin_2 = heading - turn_2 * M_PI / 2;
          const Leg first = ArcOf(plane, c1x, c1y, r1, end_1 - turn_1 * 1.2, end_1);
          const Leg second = ArcOf(plane, c2x, c2y, r2, begin_2, begin_2 + turn_2 * 1.2);
          ASSERT_LT((first.to - second.from).norm(), 1e-9);
          const ProgramVector corner = MustOffset({first, second}, offset)[0].to;
          EXPECT_NEAR((corner - plane.At(c1x, c1y)).norm(), r1 - turn_1 * offset, 1e-9);
          EXPECT_NEAR((corner - plane.At(c2x, c2y)).norm(), r2 - turn_2 * offset, 1e-9);
          EXPECT_LT((corner - plane.origin).norm(), 1.2);  // offset / cos 30 is 0.92
          EXPECT_NEAR((corner - plane.origin).dot(plane.ez), 0.0, 1e-9);
        }
      }
    }
  }
}

// OPT-8.19, OPT-E.7806, OPT-E.7808: what cannot be offset, and which leg it is.
TEST(OffsetPath, WhatCannotBeOffsetIsRefused) {
  const Plane& plane = kPlanes[2];
  const auto refused = [&](const std::vector<Leg>& legs, double offset) {
    std::size_t failed = 99;
    const auto moved = OffsetChain(legs, offset, failed);
    return moved ? std::string()
                 : std::to_string(Lookup(moved.error().code).number) + " " + std::to_string(failed);
  };
  const Leg line = LineOf(plane, -20, 0, 0, 0), back = LineOf(plane, 0, 0, -20, 0.5),
            sharp = LineOf(plane, 0, 0, -20, 4);  // 178.6 and 168.7 degrees
  EXPECT_EQ(refused({line, back}, 1.0), "7808 0");
  EXPECT_EQ(refused({LineOf(plane, -20, -9, -20, 0), line, back}, -1.0), "7808 1");
  EXPECT_EQ(refused({line, sharp}, 1.0), "");
  // A left turn of radius 2 has room for an offset to the left below 2, and any to the right.
  const Leg arc = ArcOf(plane, 0, 2, 2, -M_PI / 2, 0);
  EXPECT_EQ(refused({line, arc}, 1.999), "");
  EXPECT_EQ(refused({line, arc}, 2.0), "7806 1");
  EXPECT_EQ(refused({line, arc}, 2.5), "7806 1");
  EXPECT_EQ(refused({line, arc}, -5.0), "");
  // An arc so small that the offset line passes by its concentric circle.
  EXPECT_EQ(refused({line, ArcOf(plane, -1, 0, 1, 0, M_PI / 2)}, 0.9), "7808 0");
}

// OPT-8.79, OPT-B.79: curves meet as circles only where both legs lie across the tool, to a cosine
// of 1 - 1e-6 of the arc and a sine of 1e-6 of the line; else the corner is that of their tangents.
TEST(OffsetPath, LegsThatLeanMeetByTheirTangents) {
  const double heading = M_PI / 3, offset = 0.5, radius = 2.0;
  const ProgramVector tool{0, 0, 1}, out{std::cos(heading), std::sin(heading), 0};
  const ProgramVector by_tangents =
      (ProgramVector{0, 1, 0} + ProgramVector{-out.y(), out.x(), 0}) * (offset / 1.5);
  const auto corner = [&](double line_sine, double arc_cosine) {
    Leg line;
    line.from = {-20, 0, -20 * line_sine};
    line.tool_from = line.tool_to = line.tool_via = tool;
    Prepare(line);
    const ProgramVector across = tool.cross(out);
    const ProgramVector axis =
        tool * arc_cosine + across * std::sqrt(1.0 - arc_cosine * arc_cosine);
    const ProgramVector to_centre = axis.cross(out) * radius;
    const auto at = [&](double angle) -> ProgramVector {
      return to_centre - to_centre * std::cos(angle) + out * (radius * std::sin(angle));
    };
    Leg arc;
    arc.via = at(0.4);
    arc.to = at(1.0);
    arc.tool_from = arc.tool_to = arc.tool_via = tool;
    Prepare(arc);
    return MustOffset({line, arc}, offset)[0].to;
  };
  for (const auto& [sine, cosine] : {std::pair{0.0, 1.0 - 1.5e-6}, {1.5e-6, 1.0}, {-1.5e-6, 1.0}}) {
    EXPECT_LT((corner(sine, cosine) - by_tangents).norm(), 1e-4) << sine << " " << cosine;
  }
  // On the concentric circle, to which the line beside the first leg leads.
  const ProgramVector centre = tool.cross(out) * radius;
  for (const auto& [sine, cosine] : {std::pair{0.0, 1.0 - 0.7e-6}, {0.7e-6, 1.0}, {-0.7e-6, 1.0}}) {
    const ProgramVector point = corner(sine, cosine);
    EXPECT_NEAR(point.y(), offset, 1e-3);
    EXPECT_NEAR((point - centre).norm(), radius - offset, 1e-3);
    EXPECT_GT((point - by_tangents).norm(), 0.02);
  }
}

// What counts as nothing: a way of a nanometre, a tangent that leaves the tool by a sine of 1e-6,
// an arc that is left with half of the last decimal (OPT-8.11), a bend of 1e-9 square millimetres.
TEST(OffsetPath, HowLittleIsNothing) {
  EXPECT_EQ(LineOf(kPlanes[0], 0, 0, 0.7e-9, 0).tangent_to, ProgramVector{});
  ExpectNear(LineOf(kPlanes[0], 0, 0, 1.5e-9, 0).tangent_to, {1, 0, 0});
  EXPECT_EQ(LeftNormal({0, 0, 1}, {0.7e-6, 0, 1}), ProgramVector{});
  ExpectNear(LeftNormal({0, 0, 1}, {1.5e-6, 0, 1}), {0, 1, 0});
  const Leg arc = ArcOf(kPlanes[2], 0, 2, 2, -M_PI / 2, 0);
  std::size_t failed{};
  EXPECT_TRUE(OffsetChain({arc}, 2.0 - 7e-6, failed));
  EXPECT_FALSE(OffsetChain({arc}, 2.0 - 3e-6, failed));
  const auto bends = [](double size) {  // two ways that span twice its square
    Leg leg = LineOf(kPlanes[0], 0, 0, 2.0 * size, 0);
    leg.via = ProgramVector(size, size, 0);
    Prepare(leg);
    return leg.is_arc;
  };
  EXPECT_FALSE(bends(2e-5));
  EXPECT_TRUE(bends(3e-5));
}

// OPT-2.23, OPT-B.10: the nearest point of the circle, at the height of its centre.
TEST(OffsetPath, AHoleEndsWhereItsCircleIsNearest) {
  ExpectNear(*HoleEnd({30, 40, 7}, {0, 0, 2}, {0, 0, 9}, 5.0), {3, 4, 2});
  ExpectNear(*HoleEnd({1, 4, 9}, {1, 1, 1}, {5, 1, 1}, 2.0),
             ProgramVector{1, 1, 1} + ProgramVector{0, 3, 8} * (2.0 / std::hypot(3.0, 8.0)));
  EXPECT_FALSE(HoleEnd({0, 0, 7}, {0, 0, 2}, {0, 0, 9}, 5.0));    // on the axis
  EXPECT_FALSE(HoleEnd({30, 40, 7}, {0, 0, 2}, {0, 0, 2}, 5.0));  // no axis
}

}  // namespace
}  // namespace rmlcell::optimo
