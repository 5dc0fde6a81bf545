#include "engine/simulation/path/curve_cutter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/simulation/path/part_shape.h"

namespace rmlcell::simulation {
namespace {

const motion::Head kSwingArm = motion::GantryHead{.length_mm = 300.0};

// COORD ROBOT: the tip swings on a circle of 300 mm about a standing column.
motion::PathPiece SwingOf(double angle_rad) {
  return motion::PathPiece::Joint({{0, 0, 300}, 0.0, 0.0}, {{0, 0, 300}, 0.0, angle_rad});
}

// A tolerance that nothing keeps leaves chords of 1/65536 of the part, and what is left at the end
// is no more than one and a half of them.
TEST(CurveCutter, ChordsHaveALeastLength) {
  const motion::PathPiece path = SwingOf(0.4);
  PartShape shape({path, kSwingArm, 0.0, path.length()});
  const PartCurve& curve = shape.curve();
  const CurveCutter cutter(curve, shape.chords(), 0.0);
  const double shortest = (curve.end() - curve.begin()) / 65536.0;
  const auto cut_from = [&](double p) { return cutter.NextCut({p, curve.Tip(p)}); };
  EXPECT_EQ(cut_from(curve.begin()).p, curve.begin() + shortest);
  EXPECT_EQ(cut_from(0.5).p, 0.5 + shortest);
  EXPECT_EQ(cut_from(curve.end() - 1.6 * shortest).p, curve.end() - 1.6 * shortest + shortest);
  EXPECT_EQ(cut_from(curve.end() - 1.4 * shortest).p, curve.end());
  EXPECT_EQ(cut_from(curve.end() - 1.4 * shortest).tip, curve.Tip(curve.end()));
}

// A swing of up to half a radian is one chord if the tolerance allows; of a longer one the first
// chord tried has half a radian. A chord of an angle bows by 300 (1 - cos(angle / 2)), and a
// quarter of that is added.
TEST(CurveCutter, ChordsAreAsLongAsTheToleranceAllows) {
  const auto first_chord = [](double swing, double tolerance_mm) {
    const motion::PathPiece path = SwingOf(swing);
    PartShape shape({path, kSwingArm, 0.0, path.length()});
    const PartCurve& curve = shape.curve();
    const CurveCutter cutter(curve, shape.chords(), tolerance_mm);
    return cutter.NextCut({curve.begin(), curve.Tip(curve.begin())}).p / curve.end() * swing;
  };
  const auto bow = [](double angle) { return 1.25 * 300.0 * (1.0 - std::cos(0.5 * angle)); };
  EXPECT_NEAR(first_chord(0.49, 1000.0), 0.49, 1e-12);
  EXPECT_NEAR(first_chord(2.0, 1000.0), 0.5, 1e-12);
  EXPECT_NEAR(first_chord(0.4, 1.001 * bow(0.4)), 0.4, 1e-12);
  EXPECT_NEAR(first_chord(0.4, 0.999 * bow(0.4)), 0.2, 1e-12);
  EXPECT_NEAR(first_chord(0.4, 0.999 * bow(0.2)), 0.1, 1e-12);
}

// Who cuts the same curve again gets the same chords from the list, and from another place on
// others.
TEST(CurveCutter, ChordsAreFoundAgain) {
  const ChordList::Chord first{.begin = 0.0, .end = {0.5, {1, 2, 3}}, .bow_mm = 4.0};
  const ChordList::Chord second{.begin = 0.5, .end = {1.0, {5, 6, 7}}, .bow_mm = 8.0};
  ChordList chords;
  EXPECT_EQ(chords.Find(0.0, 0.5), nullptr);
  chords.Keep(first);
  EXPECT_EQ(chords.Find(0.5, 1.0), nullptr);
  chords.Keep(second);
  chords.Rewind();
  EXPECT_EQ(chords.Find(0.5, 1.0), nullptr);  // not the next one
  EXPECT_EQ(chords.Find(0.0, 1.0), nullptr);
  const ChordList::Chord* found = chords.Find(0.0, 0.5);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->bow_mm, 4.0);
  EXPECT_EQ(found->end.tip, (motion::MachinePoint{1, 2, 3}));
  found = chords.Find(0.5, 1.0);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->bow_mm, 8.0);
  EXPECT_EQ(chords.Find(0.5, 1.0), nullptr);
}

// Once another chord is looked at, what is kept behind it is of no use any more.
TEST(CurveCutter, AnotherChordEndsTheList) {
  const ChordList::Chord first{.begin = 0.0, .end = {0.5, {}}, .bow_mm = 4.0};
  const ChordList::Chord second{.begin = 0.5, .end = {1.0, {}}, .bow_mm = 8.0};
  ChordList chords;
  chords.Keep(first);
  chords.Keep(second);
  chords.Rewind();
  EXPECT_EQ(chords.Find(0.0, 0.25), nullptr);
  chords.Keep({.begin = 0.0, .end = {0.25, {}}, .bow_mm = 1.0});
  EXPECT_EQ(chords.Find(0.0, 0.5), nullptr);
  EXPECT_EQ(chords.Find(0.5, 1.0), nullptr);
  // Sixteen are kept.
  ChordList long_list;
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(long_list.Find(k, k + 1), nullptr);
    long_list.Keep({.begin = 1.0 * k, .end = {k + 1.0, {}}, .bow_mm = 1.0});
  }
  long_list.Rewind();
  for (int k = 0; k < 20; ++k) EXPECT_EQ(long_list.Find(k, k + 1) != nullptr, k < 16) << k;
}

// A head that hangs straight down turns A without moving the tip: one chord, whatever is allowed.
TEST(CurveCutter, ATipThatStandsIsOneChord) {
  const motion::PathPiece path =
      motion::PathPiece::Joint({{0, 0, 300}, 0.0, 0.0}, {{0, 0, 300}, 0.4, 0.0});
  PartShape shape({path, kSwingArm, 0.0, path.length()});
  const PartCurve& curve = shape.curve();
  const CurveCutter cutter(curve, shape.chords(), 0.0);
  const CurvePlace begin{curve.begin(), curve.Tip(curve.begin())};
  ASSERT_EQ(curve.Tip(curve.end()), begin.tip);
  EXPECT_EQ(cutter.NextCut(begin).p, curve.end());
}

}  // namespace
}  // namespace rmlcell::simulation
