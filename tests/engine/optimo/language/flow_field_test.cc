#include "engine/optimo/language/flow_field.h"

#include <gtest/gtest.h>

namespace rmlcell::optimo {
namespace {

enum class Lamp : std::uint8_t { kDark, kRed, kGreen };
using Lamps = Choice<Lamp>;

// What a piece of a program does is the same whether its parts are put together first or last.
TEST(FlowField, ChoicesKeepWhatAPieceDoesNotTouch) {
  Lamps state = Lamps::Of(Lamp::kRed);
  state.Then(Lamps::Kept());
  EXPECT_TRUE(state.Is(Lamp::kRed));
  state.Then(Lamps::Of(Lamp::kGreen));
  EXPECT_TRUE(state.Is(Lamp::kGreen));

  Lamps maybe = Lamps::Kept();  // IF: green, or as before
  maybe.Join(Lamps::Of(Lamp::kGreen));
  Lamps red = Lamps::Of(Lamp::kRed), green = Lamps::Of(Lamp::kGreen);
  red.Then(maybe);
  green.Then(maybe);
  EXPECT_TRUE(red.MayBe(Lamp::kRed));
  EXPECT_TRUE(red.MayBe(Lamp::kGreen));
  EXPECT_FALSE(red.MayBe(Lamp::kDark));
  EXPECT_TRUE(red.IsAmong(Lamps::Bits({Lamp::kRed, Lamp::kGreen})));
  EXPECT_FALSE(red.IsAmong(Lamps::Bit(Lamp::kRed)));
  EXPECT_TRUE(green.Is(Lamp::kGreen));  // on both paths
}

// Each value goes its own way, in a state as in what a subroutine does.
TEST(FlowField, ChoicesAreMappedByTheirValue) {
  const std::array<Lamps::Values, 8> next = {Lamps::Bit(Lamp::kRed), Lamps::Bit(Lamp::kGreen),
                                             Lamps::Bit(Lamp::kDark)};
  Lamps twice = Lamps::Kept();
  twice.Map(next);
  twice.Map(next);
  Lamps dark = Lamps::Of(Lamp::kDark), red = Lamps::Of(Lamp::kRed);
  dark.Then(twice);
  red.Then(twice);
  EXPECT_TRUE(dark.Is(Lamp::kGreen));
  EXPECT_TRUE(red.Is(Lamp::kDark));
  EXPECT_FALSE(Lamps().IsAmong(0xFF));  // no path comes here
}

TEST(FlowField, FactsAreMadeKeptAndLost) {
  Facts<unsigned> state{0b0011, 0};
  state.Then({0b0100, 0b0001});  // makes the third, keeps the first
  EXPECT_EQ(state.made, 0b0101U);
  Facts<unsigned> joined{0b1000, 0};
  joined.Join(state);
  EXPECT_EQ(joined.made, 0b1101U);
  Facts<unsigned> both{0b0010, 0b0101};
  both.Then({0b1000, 0b0110});
  EXPECT_EQ(both, (Facts<unsigned>{0b1010, 0b0100}));
}

TEST(FlowField, SingleValuesAreKnownWhenAllPathsAgree) {
  Single<int> five(5), piece = Single<int>::Kept();
  EXPECT_FALSE(piece.known());
  piece.Join(Single<int>(5));  // as before, or 5
  Single<int> seven(7), unknown;
  five.Then(piece);
  seven.Then(piece);
  unknown.Then(piece);
  EXPECT_EQ(five.known(), 5);
  EXPECT_FALSE(seven.known());
  EXPECT_FALSE(unknown.known());
  seven.Then(Single<int>(9));
  EXPECT_EQ(seven.known(), 9);
  piece.Join(Single<int>(6));
  EXPECT_EQ(piece, Single<int>());
}

// OPT-2.08: COORD and PATH matter together.
TEST(FlowField, ModesAreThoseOfTheSamePath) {
  Modes robot = Modes::AtStart(), contour = Modes::AtStart();
  robot.SetCoord(CoordType::kRobot);
  robot.SetPath(PathType::kPtp);
  contour.SetCoord(CoordType::kAbsol);
  contour.SetPath(PathType::kLin);
  Modes either = robot;
  either.Join(contour);
  EXPECT_FALSE(either.MayBeRobotContour());
  EXPECT_FALSE(either.coord());
  EXPECT_FALSE(either.path());
  EXPECT_TRUE(either.MayBe(PathType::kLin));
  either.SetPath(PathType::kCir);
  EXPECT_TRUE(either.MayBeRobotContour());
  EXPECT_FALSE(either.IsRobotContour());
  EXPECT_EQ(either.path(), PathType::kCir);

  Modes piece = Modes::Kept();  // a subroutine that sets PATH LIN
  piece.SetPath(PathType::kLin);
  EXPECT_FALSE(piece.coord());
  robot.Then(piece);
  EXPECT_TRUE(robot.IsRobotContour());
  EXPECT_EQ(robot.coord(), CoordType::kRobot);
  Modes start = Modes::AtStart();
  EXPECT_TRUE(start.IsDefaultPath());
  start.Then(Modes::Kept());
  EXPECT_EQ(start, Modes::AtStart());
  EXPECT_FALSE(start.IsContour());
}

// OPT-2.12: a subroutine that sets PATH on one of its ways.
TEST(FlowField, ModesMayBeAsBefore) {
  Modes maybe = Modes::Kept();
  Modes set = Modes::Kept();
  set.SetPath(PathType::kLin);
  maybe.Join(set);
  Modes start = Modes::AtStart();
  start.Then(maybe);
  EXPECT_TRUE(start.MayBe(PathType::kLin));
  EXPECT_FALSE(start.path());
  EXPECT_TRUE(start.IsDefaultCoord());
  Modes straight = Modes::AtStart();
  straight.SetPath(PathType::kLin);
  straight.Then(maybe);
  EXPECT_EQ(straight.path(), PathType::kLin);
  Modes twice = maybe;
  twice.Then(maybe);
  EXPECT_EQ(twice, maybe);
}

// OPT-2.12
TEST(FlowField, ModesKnowTheirContours) {
  for (const PathType path : {PathType::kPtp, PathType::kLin, PathType::kCir, PathType::kHole}) {
    Modes modes = Modes::AtStart();
    modes.SetPath(path);
    EXPECT_EQ(modes.path(), path);
    EXPECT_TRUE(modes.MayBe(path));
    EXPECT_EQ(modes.IsContour(), path != PathType::kPtp) << static_cast<int>(path);
    EXPECT_TRUE(modes.IsDefaultCoord());
    EXPECT_FALSE(modes.IsDefaultPath());
  }
  const Modes nowhere;  // no path comes here
  EXPECT_FALSE(nowhere.coord());
  EXPECT_FALSE(nowhere.path());
  EXPECT_FALSE(nowhere.IsContour());
  EXPECT_FALSE(nowhere.IsDefaultCoord());
  EXPECT_FALSE(nowhere.IsDefaultPath());
}

}  // namespace
}  // namespace rmlcell::optimo
