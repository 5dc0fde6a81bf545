#include "engine/simulation/picture/path_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/picture/box_tree.h"
#include "engine/simulation/picture/picture_difference.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

class Path {
 public:
  Path& Line(const motion::MachinePoint& from, const motion::MachinePoint& to,
             MotionUse use = MotionUse::kCut) {
    return Add(LineFrom(from, to), use);
  }
  // Counter-clockwise about Z, or clockwise where `sweep` is below zero.
  Path& Arc(const motion::MachinePoint& centre, double radius, double begin, double sweep) {
    const motion::MachinePoint from =
        centre + MachineVector{radius * std::cos(begin), radius * std::sin(begin), 0};
    return Add(PathPiece::Circle({from}, centre, {0, 0, sweep < 0 ? -1.0 : 1.0}, std::abs(sweep),
                                 0.0, 0.0),
               MotionUse::kCut);
  }
  // Whole, from its end in the XZ plane.
  Path& Circle(const motion::MachinePoint& centre, double radius, const MachineVector& normal) {
    const MachineVector spoke = MachineVector{normal.z(), 0, -normal.x()} * radius;
    return Add(PathPiece::Circle({centre + spoke}, centre, normal, kTurn, 0.0, 0.0),
               MotionUse::kCut);
  }
  const PathSketch& sketch() const { return sketch_; }

 private:
  Path& Add(const PathPiece& piece, MotionUse use) {
    motion::PlannedMotion planned;
    planned.path = piece;
    sketch_.Add({.use = use, .motion = &planned, .travelled = planned.path.length()});
    return *this;
  }
  PathSketch sketch_{{}, 10'000};
};

struct Lengths {
  double common, removed, added;
};
Lengths CutsOf(const Path& before, const Path& after) {
  const PathDifference difference = Compare(before.sketch(), after.sketch());
  EXPECT_TRUE(difference.exact);
  return {difference.common.cut_mm, difference.removed.cut_mm, difference.added.cut_mm};
}

// The same place, divided elsewhere, run along backwards, and twice.
TEST(PathDifference, DivisionDirectionAndRepetitionDoNotCount) {
  Path before, after;
  before.Line({0, 0, 0}, {30, 40, 0});
  after.Line({30, 40, 0}, {15, 20, 0}).Line({15, 20, 0}, {0, 0, 0}).Line({0, 0, 0}, {30, 40, 0});
  const Lengths lengths = CutsOf(before, after);
  EXPECT_NEAR(lengths.removed, 0.0, 1e-9);
  EXPECT_NEAR(lengths.added, 0.0, 1e-9);
  EXPECT_NEAR(lengths.common, 100.0, 1e-9);
}

// As many pairs are looked at as may be, and not one more: what is left counts as different.
TEST(PathDifference, PairsHaveALimit) {
  Path before;
  before.Line({0, 0, 0}, {10, 0, 0}).Line({0, 50, 0}, {10, 50, 0}).Line({0, 90, 0}, {10, 90, 0});
  const auto cuts = [&](std::uint64_t pairs) {
    const PathDifference difference = Compare(before.sketch(), before.sketch(), pairs);
    EXPECT_EQ(difference.exact, pairs >= 3) << pairs;
    return difference.common.cut_mm;
  };
  EXPECT_NEAR(cuts(0), 0.0, 1e-9);
  EXPECT_NEAR(cuts(1), 10.0, 1e-9);
  EXPECT_NEAR(cuts(2), 20.0, 1e-9);
  EXPECT_NEAR(cuts(3), 30.0, 1e-9);
  EXPECT_NEAR(cuts(4), 30.0, 1e-9);
}

// Once one element covers another, no more of those that lie there are looked at.
TEST(PathDifference, WhatIsCoveredIsLookedAtOnce) {
  Path thrice;
  for (int k = 0; k < 3; ++k) thrice.Line({0, 0, 0}, {10, 0, 0});
  for (const std::uint64_t pairs : {2U, 3U}) {
    const PathDifference difference = Compare(thrice.sketch(), thrice.sketch(), pairs);
    EXPECT_EQ(difference.exact, pairs == 3) << pairs;
    EXPECT_NEAR(difference.common.cut_mm, 10.0 * static_cast<double>(pairs), 1e-9) << pairs;
  }
}

// A line that became shorter at one end and longer at the other: 10 mm gone, 5 mm new, 40 mm kept.
TEST(PathDifference, LinesAreDividedWhereTheyPart) {
  Path before, after;
  before.Line({0, 0, 7}, {50, 0, 7});
  after.Line({10, 0, 7}, {55, 0, 7});
  const PathDifference difference = Compare(before.sketch(), after.sketch());
  ASSERT_EQ(difference.removed.elements.size(), 1U);
  EXPECT_NEAR((difference.removed.elements[0].to - motion::MachinePoint{10, 0, 7}).norm(), 0.0,
              1e-9);
  ASSERT_EQ(difference.added.elements.size(), 1U);
  EXPECT_NEAR((difference.added.elements[0].from - motion::MachinePoint{50, 0, 7}).norm(), 0.0,
              1e-9);
  EXPECT_NEAR(difference.common.cut_mm, 40.0, 1e-9);
}

// On both sides of kSamePlace_mm.
TEST(PathDifference, NearIsTheSameFarIsNot) {
  Path before, near, far;
  before.Line({0, 0, 0}, {100, 0, 0});
  near.Line({0, 0.9 * kSamePlace_mm, 0}, {100, 0, 0});
  far.Line({0, 1.1 * kSamePlace_mm, 0}, {100, 1.1 * kSamePlace_mm, 0});
  EXPECT_NEAR(CutsOf(before, near).removed, 0.0, 1e-9);
  EXPECT_NEAR(CutsOf(before, far).removed, 100.0, 1e-9);
  Path beside;
  beside.Line({0, kSamePlace_mm, 0}, {100, kSamePlace_mm, 0});
  EXPECT_EQ(CutsOf(before, beside).removed, 0.0);
}

// Gaps and remains that are no longer than kSamePlace_mm go with what they touch, in common and
// apart.
TEST(PathDifference, WhatIsTooShortGoesWithItsNeighbour) {
  constexpr double k = kSamePlace_mm;
  Path before, gap, wide_gap, late, too_late;
  before.Line({0, 0, 0}, {10, 0, 0});
  gap.Line({0, 0, 0}, {4, 0, 0}).Line({4 + k, 0, 0}, {10, 0, 0});
  wide_gap.Line({0, 0, 0}, {4, 0, 0}).Line({4 + 1.5 * k, 0, 0}, {10, 0, 0});
  late.Line({k, 0, 0}, {10, 0, 0});
  too_late.Line({1.5 * k, 0, 0}, {10, 0, 0});
  EXPECT_EQ(CutsOf(before, gap).removed, 0.0);
  EXPECT_NEAR(CutsOf(before, wide_gap).removed, 1.5 * k, 1e-9);
  EXPECT_EQ(CutsOf(before, late).removed, 0.0);
  EXPECT_NEAR(CutsOf(before, too_late).removed, 1.5 * k, 1e-9);
  for (const bool at_begin : {true, false}) {
    const auto longer = [&](double by) {
      Path after;
      after.Line({at_begin ? -by : 0.0, 0, 0}, {at_begin ? 10.0 : 10.0 + by, 0, 0});
      return CutsOf(before, after);
    };
    EXPECT_NEAR(longer(0.9 * k).common, 10 + 0.9 * k, 1e-9);
    EXPECT_EQ(longer(0.9 * k).added, 0.0);
    EXPECT_NEAR(longer(1.5 * k).common, 10, 1e-9);
    EXPECT_NEAR(longer(1.5 * k).added, 1.5 * k, 1e-9);
  }
}

// What is no longer than kSamePlace_mm is a place: nothing to have in common, to remove or to add.
TEST(PathDifference, PlacesAreNoPath) {
  const auto common = [](double overlap) {
    Path before, after;
    before.Line({0, 0, 0}, {10, 0, 0});
    after.Line({-5, 0, 0}, {overlap, 0, 0});
    return CutsOf(before, after).common;
  };
  EXPECT_EQ(common(kSamePlace_mm), 0.0);
  EXPECT_NEAR(common(1.5 * kSamePlace_mm), 1.5 * kSamePlace_mm, 1e-9);
  const auto whole = [](double length) {
    Path before, after;
    before.Line({0, 0, 0}, {length, 0, 0});
    return CutsOf(before, after).removed;
  };
  EXPECT_EQ(whole(kSamePlace_mm), 0.0);
  EXPECT_NEAR(whole(1.5 * kSamePlace_mm), 1.5 * kSamePlace_mm, 1e-9);
}

// Circles are the same up to kSamePlace_mm in every respect, and not a bit beyond: the place of the
// centre, the radius, and how far the rim of one leans out of the plane of the other.
TEST(PathDifference, CirclesAreTheSameUpToTheTolerance) {
  const auto in_common = [](const motion::MachinePoint& centre, double radius,
                            const MachineVector& normal) {
    Path before, after;
    before.Circle({0, 0, 0}, 1.0, {0, 0, 1});
    after.Circle(centre, radius, normal);
    const Lengths lengths = CutsOf(before, after);
    EXPECT_TRUE(lengths.common == 0.0 || lengths.removed == 0.0);
    return lengths.common > 0.0;
  };
  const auto leaning = [](double sine) {
    return MachineVector{sine, 0, std::sqrt(1.0 - sine * sine)};
  };
  const MachineVector up{0, 0, 1};
  EXPECT_TRUE(in_common({kSamePlace_mm, 0, 0}, 1.0, up));
  EXPECT_FALSE(in_common({1.001 * kSamePlace_mm, 0, 0}, 1.0, up));
  EXPECT_TRUE(in_common({0, 0, 0}, 1.0 - 0.999 * kSamePlace_mm, up));
  EXPECT_TRUE(in_common({0, 0, 0}, 1.0 + 0.999 * kSamePlace_mm, up));
  EXPECT_FALSE(in_common({0, 0, 0}, 1.0 - 1.001 * kSamePlace_mm, up));
  EXPECT_FALSE(in_common({0, 0, 0}, 1.0 + 1.001 * kSamePlace_mm, up));
  EXPECT_TRUE(in_common({0, 0, 0}, 1.0, leaning(kSamePlace_mm)));
  EXPECT_FALSE(in_common({0, 0, 0}, 1.0, leaning(1.001 * kSamePlace_mm)));
  // So small that the difference of the radii is exact.
  Path small, twice;
  small.Circle({0, 0, 0}, kSamePlace_mm, up);
  twice.Circle({0, 0, 0}, 2.0 * kSamePlace_mm, up);
  EXPECT_GT(CutsOf(small, twice).common, 0.0);
}

// Parallel, crossing and end to end: no length in common.
TEST(PathDifference, LinesThatOnlyTouchDiffer) {
  Path before, after;
  before.Line({0, 0, 0}, {100, 0, 0});
  after.Line({50, -50, 0}, {50, 50, 0}).Line({100, 0, 0}, {150, 0, 0}).Line({0, 1, 0}, {100, 1, 0});
  const Lengths lengths = CutsOf(before, after);
  EXPECT_NEAR(lengths.common, 0.0, 1e-9);
  EXPECT_NEAR(lengths.removed, 100.0, 1e-9);
  EXPECT_NEAR(lengths.added, 250.0, 1e-9);
}

// A cut where the other one only travels is a cut removed and travel added.
TEST(PathDifference, CutsAndTravelAreComparedApart) {
  Path before, after;
  before.Line({0, 0, 0}, {10, 0, 0}, MotionUse::kCut);
  after.Line({0, 0, 0}, {10, 0, 0}, MotionUse::kTravel);
  const PathDifference difference = Compare(before.sketch(), after.sketch());
  EXPECT_NEAR(difference.removed.cut_mm, 10.0, 1e-9);
  EXPECT_NEAR(difference.added.travel_mm, 10.0, 1e-9);
  EXPECT_NEAR(difference.common.cut_mm + difference.common.travel_mm, 0.0, 1e-9);
}

// Arcs of one circle: a quarter more at the end, against the clock, over the beginning of the
// other.
TEST(PathDifference, ArcsAreDividedWhereTheyPart) {
  const double quarter_mm = 10.0 * kTurn / 4;
  Path half, most, backwards, over, other;
  half.Arc({5, 5, 0}, 10, 0.0, kTurn / 2);
  most.Arc({5, 5, 0}, 10, 0.0, 0.75 * kTurn);
  backwards.Arc({5, 5, 0}, 10, kTurn / 2, -kTurn / 2);
  over.Arc({5, 5, 0}, 10, -kTurn / 4, kTurn / 2);
  other.Arc({5, 5, 0}, 11, 0.0, kTurn / 2);
  EXPECT_NEAR(CutsOf(half, most).added, quarter_mm, 1e-6);
  EXPECT_NEAR(CutsOf(half, most).removed, 0.0, 1e-6);
  EXPECT_NEAR(CutsOf(half, backwards).removed, 0.0, 1e-6);
  EXPECT_NEAR(CutsOf(half, over).common, quarter_mm, 1e-6);
  EXPECT_NEAR(CutsOf(half, over).removed, quarter_mm, 1e-6);
  EXPECT_NEAR(CutsOf(half, other).common, 0.0, 1e-6);
  const PathDifference difference = Compare(half.sketch(), most.sketch());
  ASSERT_EQ(difference.added.elements.size(), 1U);
  EXPECT_NEAR((difference.added.elements[0].to - motion::MachinePoint{5, -5, 0}).norm(), 0.0, 1e-6);
}

// A full circle against another start of it.
TEST(PathDifference, CirclesMayBeginAnywhere) {
  Path before, after;
  before.Arc({0, 0, 0}, 10, 0.0, kTurn);
  after.Arc({0, 0, 0}, 10, 1.0, kTurn);
  EXPECT_NEAR(CutsOf(before, after).removed, 0.0, 1e-6);
  EXPECT_NEAR(CutsOf(before, after).added, 0.0, 1e-6);
}

// Property: what both have and what one has alone add up to the whole, whatever the paths are.
TEST(PathDifference, PartsAddUpToTheWhole) {
  std::mt19937 random(7);
  const auto grid = [&] { return static_cast<double>(random() % 12); };
  for (int round = 0; round < 50; ++round) {
    Path before, after;
    double before_mm = 0.0, after_mm = 0.0;
    for (int k = 0; k < 40; ++k) {
      for (Path* path : {&before, &after}) {
        const double x = grid(), y = grid(), length = 1.0 + grid();
        const bool across = random() % 2 == 0;
        path->Line({x, y, 0},
                   across ? MachineVector{x + length, y, 0} : MachineVector{x, y + length, 0});
        (path == &before ? before_mm : after_mm) += length;
      }
    }
    const Lengths lengths = CutsOf(before, after);
    EXPECT_NEAR(lengths.common + lengths.added, after_mm, 1e-6);
    EXPECT_LE(lengths.removed, before_mm + 1e-6);
    const Lengths same = CutsOf(before, before);
    EXPECT_NEAR(same.common, before_mm, 1e-6);
    EXPECT_EQ(same.removed + same.added, 0.0);
  }
}

// What is left of a line or an arc lies where it lay: ends, middle, sweep and length.
TEST(PathDifference, PartsKeepTheirPlace) {
  const PathDifference lines = Compare(Path().Line({0, 0, 3}, {30, 40, 3}).sketch(),
                                       Path().Line({6, 8, 3}, {24, 32, 3}).sketch());
  ASSERT_EQ(lines.removed.elements.size(), 2u);
  EXPECT_NEAR((lines.removed.elements[0].from - motion::MachinePoint{0, 0, 3}).norm(), 0.0, 1e-12);
  EXPECT_NEAR((lines.removed.elements[0].to - motion::MachinePoint{6, 8, 3}).norm(), 0.0, 1e-9);
  EXPECT_NEAR((lines.removed.elements[1].from - motion::MachinePoint{24, 32, 3}).norm(), 0.0, 1e-9);
  EXPECT_NEAR((lines.removed.elements[1].to - motion::MachinePoint{30, 40, 3}).norm(), 0.0, 1e-12);
  EXPECT_NEAR(lines.removed.cut_mm, 20.0, 1e-9);
  const PathDifference arcs = Compare(Path().Arc({1, 2, 0}, 10.0, 0.0, kPi).sketch(),
                                      Path().Arc({1, 2, 0}, 10.0, 0.0, kPi / 2).sketch());
  ASSERT_EQ(arcs.removed.elements.size(), 1u);
  ASSERT_EQ(arcs.removed.circles.size(), 1u);
  const SketchElement& arc = arcs.removed.elements[0];
  EXPECT_EQ(arc.arc, 0);
  EXPECT_NEAR((arc.from - motion::MachinePoint{1, 12, 0}).norm(), 0.0, 1e-9);
  EXPECT_NEAR((arc.to - motion::MachinePoint{-9, 2, 0}).norm(), 0.0, 1e-9);
  EXPECT_NEAR(
      (arc.middle - motion::MachinePoint{1 - 10 * std::sqrt(0.5), 2 + 10 * std::sqrt(0.5), 0})
          .norm(),
      0.0, 1e-9);
  EXPECT_NEAR(arcs.removed.circles[0].sweep_rad, kPi / 2, 1e-9);
  EXPECT_EQ(arcs.removed.circles[0].radius_mm, 10.0);
  EXPECT_NEAR(arcs.removed.cut_mm, 10.0 * kPi / 2, 1e-9);
  EXPECT_EQ(arcs.removed.travel_mm, 0.0);
  machine::Box seen;
  for (const motion::MachinePoint& p : {arc.from, arc.to, arc.middle}) seen.Add(p);
  EXPECT_EQ(arcs.removed.box(), seen);
}

// Dots are the same where they are of one kind and within kSamePlace_mm, along whichever axis; of
// several at one X each is looked at.
TEST(PathDifference, DotsOfOneKindAtOnePlaceAreTheSame) {
  struct Dot {
    motion::MachinePoint at;
    bool pierce = true;
  };
  const auto sketch_of = [](const std::vector<Dot>& dots) {
    PathSketch sketch({}, 100);
    for (const Dot& dot : dots) {
      motion::PlannedMotion planned;
      planned.path = LineFrom(dot.at + MachineVector{0, 0, 9}, dot.at);
      sketch.Add({.use = dot.pierce ? MotionUse::kTravel : MotionUse::kPlunge,
                  .motion = &planned,
                  .travelled = planned.path.length()});
      if (dot.pierce) sketch.AddPierce();
    }
    return sketch;
  };
  // "common removed added"
  const auto counts = [&](const std::vector<Dot>& before, const std::vector<Dot>& after) {
    const PathDifference difference = Compare(sketch_of(before), sketch_of(after));
    return std::to_string(difference.common.dots.size()) + " " +
           std::to_string(difference.removed.dots.size()) + " " +
           std::to_string(difference.added.dots.size());
  };
  const Dot here{{5, 6, 7}};
  EXPECT_EQ(counts({here}, {here}), "1 0 0");
  EXPECT_EQ(counts({here}, {}), "0 1 0");
  EXPECT_EQ(counts({}, {here}), "0 0 1");
  EXPECT_EQ(counts({here}, {{{5, 6, 7}, false}}), "0 1 1");
  EXPECT_EQ(counts({{{5, 6, 7}, false}}, {{{5, 6, 7}, false}}), "1 0 0");
  for (const MachineVector& axis :
       {MachineVector{1, 0, 0}, MachineVector{0, 1, 0}, MachineVector{0, 0, 1}}) {
    for (const double side : {-1.0, 1.0}) {
      const MachineVector way = axis * (side * kSamePlace_mm);
      EXPECT_EQ(counts({here}, {{here.at + way * 0.99}}), "1 0 0");
      EXPECT_EQ(counts({here}, {{here.at + way * 1.01}}), "0 1 1");
    }
  }
  // Beside the one that is meant stand others: before it, behind it, and of the other kind.
  const std::vector<Dot> many = {{{4, 6, 7}}, {{5, 1, 7}}, {{5, 6, 7}, false},
                                 {{5, 9, 7}}, {{6, 6, 7}}, here};
  EXPECT_EQ(counts({here}, many), "1 0 5");
  EXPECT_EQ(counts(many, {here}), "1 5 0");
  const PathDifference difference = Compare(sketch_of({here}), sketch_of({{{1, 2, 3}}, here}));
  EXPECT_EQ(difference.added.dots[0].at, (MachineVector{1, 2, 3}));
  EXPECT_TRUE(difference.added.dots[0].pierce);
  EXPECT_EQ(difference.common.dots[0].at, here.at);
  PathShare dots;
  dots.dots = {{.at = {1, 2, 3}}, {.at = {-1, 5, 0}}};
  EXPECT_EQ(dots.box().min, (MachineVector{-1, 2, 0}));
  EXPECT_EQ(dots.box().max, (MachineVector{1, 5, 3}));
}

// Against looking at every box.
TEST(BoxTree, FindsWhatTouches) {
  std::mt19937 random(11);
  const auto number = [&] { return static_cast<double>(random() % 1000); };
  std::vector<machine::Box> boxes(500);
  for (machine::Box& box : boxes) {
    box.Add(MachineVector{number(), number(), number()});
    box.Add(box.min + MachineVector{number() * 0.1, number() * 0.1, number() * 0.1});
  }
  const BoxTree tree(boxes, 0.5);
  for (int round = 0; round < 100; ++round) {
    const machine::Box& wanted = boxes[static_cast<std::size_t>(round)];
    std::vector<bool> found(boxes.size());
    tree.Visit(wanted, [&](std::size_t index) {
      EXPECT_FALSE(found[index]);
      return found[index] = true;
    });
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const machine::Box& b = boxes[i];
      const bool touches = b.min.x() <= wanted.max.x() + 0.5 && wanted.min.x() <= b.max.x() + 0.5 &&
                           b.min.y() <= wanted.max.y() + 0.5 && wanted.min.y() <= b.max.y() + 0.5 &&
                           b.min.z() <= wanted.max.z() + 0.5 && wanted.min.z() <= b.max.z() + 0.5;
      EXPECT_EQ(found[i], touches) << i;
    }
  }
  int visits = 0;
  tree.Visit(boxes[0], [&](std::size_t) { return ++visits < 1; });
  EXPECT_EQ(visits, 1);
  BoxTree({}, 1.0).Visit(boxes[0], [](std::size_t) {
    ADD_FAILURE();
    return true;
  });
}

// A standalone document with all three kinds, a legend with their lengths, and names escaped.
TEST(PictureOfDifference, ShowsWhatIsRemovedAddedAndCommon) {
  Path before, after;
  before.Line({0, 0, 0}, {50, 0, 0});
  after.Line({10, 0, 0}, {55, 0, 0});
  const std::string svg =
      PictureOfDifference({.path = before.sketch(), .title = "<a>&.S"},
                          {.path = after.sketch(), .title = "b.S", .note = "stopped at 1/7"},
                          Laser(), {{"cycle_time", "s", 1.5, 2.5}, {"pierces", "", 1.0, 1.0}}, {});
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_EQ(CountOf(svg, "<script"), 0u);
  EXPECT_EQ(CountOf(svg, "nan"), 0u);
  EXPECT_EQ(CountOf(svg, "<a>"), 0u);
  for (const char* kind : {"removed", "added", "common"}) {
    EXPECT_EQ(CountOf(svg, std::string("<g class=\"") + kind), 4u) << kind;  // one for each panel
    EXPECT_EQ(CountOf(svg, std::string(">") + kind + "<"), 1u) << kind;      // in the legend
  }
  EXPECT_EQ(CountOf(svg, ">10.000 mm cut, 0.000 mm travel<"), 1u);
  EXPECT_EQ(CountOf(svg, ">5.000 mm cut, 0.000 mm travel<"), 1u);
  EXPECT_EQ(CountOf(svg, ">40.000 mm cut, 0.000 mm travel<"), 1u);
  EXPECT_EQ(CountOf(svg, ">1.5 → 2.5 s<"), 1u);
  EXPECT_EQ(CountOf(svg, ">1<"), 1u);  // the same in both
  EXPECT_EQ(CountOf(svg, "stopped at 1/7"), 1u);
}

// A difference that is small in the whole is shown once more, closer.
TEST(PictureOfDifference, SmallDifferencesAreShownCloser) {
  Path before, after;
  before.Line({0, 0, 0}, {500, 0, 0}).Line({500, 0, 0}, {500, 300, 0});
  after.Line({0, 0, 0}, {500, 0, 0}).Line({500, 0, 0}, {500, 301, 0});
  const auto picture = [&](const Path& other) {
    return PictureOfDifference({.path = before.sketch(), .title = "a"},
                               {.path = other.sketch(), .title = "b"}, Laser(), {}, {});
  };
  EXPECT_EQ(CountOf(picture(after), "closer"), 1u);
  EXPECT_EQ(CountOf(picture(after), "<g class=\"added"), 6u);
  EXPECT_EQ(CountOf(picture(before), "closer"), 0u);
  EXPECT_EQ(CountOf(picture(before), "both run along the same path"), 1u);
}

// Below 0.35 of what is shown, margins included, a difference is small: 40 of 159 mm are, 100 of
// 227 mm are seen well enough in the whole.
TEST(PictureOfDifference, AMiddlingDifferenceIsNotShownTwice) {
  const auto closer = [](double longer_mm) {
    Path before, after;
    before.Line({0, 0, 0}, {100, 0, 0});
    after.Line({0, 0, 0}, {100, 0, 0}).Line({100, 0, 0}, {100 + longer_mm, 0, 0});
    return CountOf(PictureOfDifference({.path = before.sketch(), .title = "a"},
                                       {.path = after.sketch(), .title = "b"}, Laser(), {}, {}),
                   ">Where they differ, closer<");
  };
  EXPECT_EQ(closer(40.0), 1u);
  EXPECT_EQ(closer(100.0), 0u);
}

// Of a run that did not come to its end the picture does not say that its path is the same.
TEST(PictureOfDifference, APathThatIsCutShortIsNotTheSame) {
  Path path;
  path.Line({0, 0, 0}, {10, 0, 0});
  const ComparedPath whole{.path = path.sketch(), .title = "a"};
  const ComparedPath stopped{.path = path.sketch(), .title = "b", .note = "stopped at 1/7"};
  for (const auto& [before, after] : {std::pair(whole, stopped), {stopped, whole}}) {
    const std::string svg = PictureOfDifference(before, after, Laser(), {}, {});
    EXPECT_EQ(CountOf(svg, "both run along the same path"), 0u);
    EXPECT_EQ(CountOf(svg, "the same path, as far as both of them ran"), 1u);
  }
}

// Nothing to draw is no trouble, and bounds hold.
TEST(PictureOfDifference, EmptyAndLongPathsAreDrawn) {
  const Path empty;
  Path path;
  for (int k = 0; k < 3000; ++k)
    path.Line({k * 0.1, k % 2 * 5.0, 0}, {k * 0.1 + 0.1, (k + 1) % 2 * 5.0, 0});
  const auto picture = [&](std::size_t elements_max) {
    return PictureOfDifference({.path = empty.sketch(), .title = "a"},
                               {.path = path.sketch(), .title = "b"}, Laser(), {}, {},
                               elements_max);
  };
  EXPECT_EQ(XmlFault(picture(kPictureElementsMax)), "");
  EXPECT_LT(picture(120).size(), picture(kPictureElementsMax).size() / 2);
  EXPECT_EQ(XmlFault(PictureOfDifference({.path = empty.sketch(), .title = "a"},
                                         {.path = empty.sketch(), .title = "b"}, {}, {}, {})),
            "");
}

}  // namespace
}  // namespace rmlcell::simulation
