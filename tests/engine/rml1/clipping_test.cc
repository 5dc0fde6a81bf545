#include "engine/rml1/clipping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "engine/motion/geometry/path.h"

namespace rmlcell::rml1 {
namespace {

constexpr CuttingRange kRange{{0.0, 20000.0}, {0.0, 15000.0}, {-6000.0, 0.0}};
constexpr double kZero = 1e-4;

Region RegionOf(const Point& p) {
  const bool in_xy = p.x >= 0.0 && p.x <= 20000.0 && p.y >= 0.0 && p.y <= 15000.0;
  if (!in_xy) return Region::kOutside;
  if (p.z > 0.0) return Region::kAbove;
  return p.z < -6000.0 ? Region::kBelow : Region::kInside;
}

// RML1-5A.01: the pieces of any line join up, and the middle of each lies in its region.
TEST(Pieces, PartitionAnyLineByRegion) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-20000.0, 40000.0);
  std::uniform_real_distribution<double> y(-15000.0, 30000.0);
  std::uniform_real_distribution<double> z(-12000.0, 6000.0);
  for (int i = 0; i < 50000; ++i) {
    const Point from{x(random), y(random), z(random), 0.0};
    const Point to{x(random), y(random), z(random), 90.0};
    const Pieces pieces = Pieces::Cut(kRange, from, to, kZero);
    ASSERT_FALSE(pieces.all().empty());
    EXPECT_EQ(pieces.all().front().from, from);
    EXPECT_EQ(pieces.all().back().to, to);
    double length = 0.0;
    for (std::size_t k = 0; k < pieces.all().size(); ++k) {
      const Piece& piece = pieces.all()[k];
      length += DistanceXYZ(piece.from, piece.to);
      if (k > 0) {
        EXPECT_LT(DistanceXYZ(pieces.all()[k - 1].to, piece.from), 2 * kZero);
        EXPECT_NE(piece.region, pieces.all()[k - 1].region);
      }
      const Point middle = Between(piece.from, piece.to, 0.5);
      EXPECT_EQ(piece.region, RegionOf(middle));
    }
    EXPECT_NEAR(length, DistanceXYZ(from, to), 1e-6);
  }
}

// RML1-5A.26: touching an edge from outside leaves one piece outside.
TEST(Pieces, DropWhatOnlyTouches) {
  const Pieces pieces = Pieces::Cut(kRange, {-1000, 1000, -100, 0}, {1000, -1000, -100, 0}, kZero);
  for (const Piece& piece : pieces.all()) EXPECT_EQ(piece.region, Region::kOutside);
}

// RML1-5A.01: faces belong to the range; a line in a face stays inside.
TEST(Pieces, CountFacesAsInside) {
  const Pieces face = Pieces::Cut(kRange, {0, 0, 0, 0}, {20000, 0, -6000, 0}, kZero);
  ASSERT_EQ(face.all().size(), 1U);
  EXPECT_EQ(face.all()[0].region, Region::kInside);
  // The rounding error of a sum of relative motions does not lose a whole cut.
  const Pieces noisy = Pieces::Cut(kRange, {-1e-9, 5, -100, 0}, {-1e-9, 9000, -100, 0}, kZero);
  ASSERT_EQ(noisy.all().size(), 1U);
  EXPECT_EQ(noisy.all()[0].region, Region::kInside);
}

// RML1-5A.01: as far beyond a face as counts as on it is inside, at each face and at either end of
// a line, and no further. A place beyond the bottom or the top is cut off there.
TEST(Pieces, EndTheToleranceOfAFaceWhereItEnds) {
  constexpr double kBeyond = CuttingRange::kFaceTolerance;
  const Point middle{7000, 7000, -3000, 0};
  struct Face {
    Point at, past;
    Region region;
  };
  const auto with = [&](double Point::*axis, double value) {
    Point p = middle;
    p.*axis = value;
    return p;
  };
  const auto face = [&](double Point::*axis, double value, double outward, Region region) {
    return Face{with(axis, value + outward * kBeyond), with(axis, value + outward), region};
  };
  const Face faces[] = {face(&Point::x, 0.0, -1.0, Region::kOutside),
                        face(&Point::x, 20000.0, 1.0, Region::kOutside),
                        face(&Point::y, 0.0, -1.0, Region::kOutside),
                        face(&Point::y, 15000.0, 1.0, Region::kOutside),
                        face(&Point::z, -6000.0, -1.0, Region::kBelow),
                        face(&Point::z, 0.0, 1.0, Region::kAbove)};
  for (const Face& f : faces) {
    for (const bool out : {true, false}) {
      const auto cut = [&](const Point& end) {
        return out ? Pieces::Cut(kRange, middle, end, kZero)
                   : Pieces::Cut(kRange, end, middle, kZero);
      };
      const Pieces at = cut(f.at);
      ASSERT_EQ(at.all().size(), 1U);
      EXPECT_EQ(at.all()[0].region, Region::kInside);
      const Point& end = out ? at.all()[0].to : at.all()[0].from;
      EXPECT_LE(DistanceXYZ(end, f.at), 1.01 * kBeyond);  // it may be put on the face itself
      const Pieces past = cut(f.past);
      ASSERT_EQ(past.all().size(), 2U);
      EXPECT_EQ(past.all()[out ? 0 : 1].region, Region::kInside);
      EXPECT_EQ(past.all()[out ? 1 : 0].region, f.region);
    }
    // Along the face, all of it so far beyond.
    Point along = f.at;
    (along.x == middle.x ? along.x : along.y) += 500.0;
    const Pieces beside = Pieces::Cut(kRange, f.at, along, kZero);
    ASSERT_EQ(beside.all().size(), 1U);
    EXPECT_EQ(beside.all()[0].region, Region::kInside);
  }
}

// As far beyond two faces at once, where so little is a way: with one unit in a millimetre.
TEST(Pieces, KeepBothEndsThatCountAsOnFaces) {
  constexpr double kBeyond = CuttingRange::kFaceTolerance;
  const Point edge{-kBeyond, -kBeyond, -100, 0};
  const Point middle{7000, 7000, -100, 0};
  for (const auto& [from, to] : {std::pair(edge, middle), {middle, edge}}) {
    const Pieces pieces = Pieces::Cut(kRange, from, to, motion::kTipLengthZero_mm);
    ASSERT_EQ(pieces.all().size(), 1U);
    EXPECT_EQ(pieces.all()[0].region, Region::kInside);
  }
}

// RML1-5A.34: angles are shared out along the line.
TEST(Pieces, ShareTheRotaryAxisAlongTheLine) {
  const Pieces pieces = Pieces::Cut(kRange, {0, 0, 0, 0}, {25000, 0, 0, 100}, kZero);
  ASSERT_EQ(pieces.all().size(), 2U);
  EXPECT_NEAR(pieces.all()[0].to.a, 80.0, 1e-9);
}

// RML1-5A.01: what counts as on a face although it is beyond it is put on the face, so that no
// piece inside leaves the travel; along X, Y and Z, at the very end of the tolerance.
TEST(Pieces, PutWhatCountsAsOnAFaceOnTheFace) {
  constexpr double kBeyond = CuttingRange::kFaceTolerance;
  const Pieces x = Pieces::Cut(kRange, {-kBeyond, 1000, -100, 0}, {-kBeyond, 2000, -100, 0}, kZero);
  ASSERT_EQ(x.all().size(), 1U);
  EXPECT_EQ(x.all()[0].from.x, 0.0);
  EXPECT_EQ(x.all()[0].to.x, 0.0);
  const Pieces y = Pieces::Cut(kRange, {500, -kBeyond, -100, 0}, {700, -kBeyond, -100, 0}, kZero);
  ASSERT_EQ(y.all().size(), 1U);
  EXPECT_EQ(y.all()[0].from.y, 0.0);
  EXPECT_EQ(y.all()[0].to.y, 0.0);
  const Pieces z = Pieces::Cut(kRange, {500, 1000, kBeyond, 0}, {500, 2000, kBeyond, 0}, kZero);
  ASSERT_EQ(z.all().size(), 1U);
  EXPECT_EQ(z.all()[0].from.z, 0.0);
  EXPECT_EQ(z.all()[0].to.z, 0.0);
}

// RML1-5A.01: a line of one unit that begins beyond a face is cut there as any other one.
TEST(Pieces, CutALineOfOneUnit) {
  const Pieces aside = Pieces::Cut(kRange, {-0.5, 5000, -100, 0}, {0.5, 5000, -100, 0}, kZero);
  ASSERT_EQ(aside.all().size(), 2U);
  EXPECT_EQ(aside.all()[0].region, Region::kOutside);
  EXPECT_EQ(aside.all()[1].region, Region::kInside);
  EXPECT_EQ(aside.all()[1].from.x, 0.0);
  const Pieces up = Pieces::Cut(kRange, {500, 500, -6000.5, 0}, {500, 500, -5999.5, 0}, kZero);
  ASSERT_EQ(up.all().size(), 2U);
  EXPECT_EQ(up.all()[0].region, Region::kBelow);
  EXPECT_EQ(up.all()[1].region, Region::kInside);
}

}  // namespace
}  // namespace rmlcell::rml1
