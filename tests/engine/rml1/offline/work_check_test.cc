#include "engine/rml1/offline/work_check.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

std::optional<Error> Checked(std::string_view stream) {
  return CheckWork(machine::Bytes::Borrowed(stream), ParametersOf("t1")).value();
}

// T1: X 0 to 200 mm, Y to 150, Z0 20 mm below the top and 40 mm above the bottom; 100 units in a
// mm.
TEST(CheckWork, WorkBeyondTheTravelIsToldWithItsRemedy) {
  const auto wide = Checked("PU1000,100;\nPD20100,100;PU;");
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->code, ErrorCode::kRml1WorkBeyondTravel);
  EXPECT_EQ(wide->where->line, 2);
  // From X 10 to 201: 10 to the left at most, and 1 at least.
  EXPECT_EQ(wide->detail,
            "1 mm of the work would not be cut: 1 mm beyond the greatest X (200 mm); in X it fits "
            "moved by -10 to -1 mm");
  // 220 mm long, on both sides.
  EXPECT_EQ(Checked("PU-1000,100;PD21000,100;PU;")->detail,
            "20 mm of the work would not be cut: 10 mm beyond the least X (0 mm), 10 mm beyond the "
            "greatest X (200 mm); in X it is 20 mm too large for this machine");
  // From the surface, 20 mm below the top, to 50 below it: 10 to 20 higher.
  EXPECT_EQ(Checked("!MC1;Z100,100,0;Z100,100,-5000;")->detail,
            "10 mm of the work would not be cut: 10 mm below the lowest Z (-40 mm); in Z it fits "
            "moved by 10 to 20 mm");
}

// A face that the work comes up to, and one that it leads beyond by 0.01 mm alone, need no word.
TEST(CheckWork, SaysNothingOfFacesThatAreKept) {
  EXPECT_EQ(Checked("PU1000,0;PD20100,0;PU;")->detail,
            "1 mm of the work would not be cut: 1 mm beyond the greatest X (200 mm); in X it fits "
            "moved by -10 to -1 mm");
  EXPECT_EQ(Checked("PU1000,15000;PD20100,15000;PU;")->detail,
            "1 mm of the work would not be cut: 1 mm beyond the greatest X (200 mm); in X it fits "
            "moved by -10 to -1 mm");
  EXPECT_EQ(Checked("PU20001,100;PD20001,500;PU;")->detail,
            "4 mm of the work would not be cut; in X it fits moved by -200.01 to -0.01 mm");
  // As long as the travel: there is one place for it.
  EXPECT_EQ(Checked("PU-1000,100;PD19000,100;PU;")->detail,
            "10 mm of the work would not be cut: 10 mm beyond the least X (0 mm); in X it fits "
            "moved by 10 to 10 mm");
}

// Y -1 to 151 mm on a travel of 150, and from X -60 to 0 of an origin that stands 50 mm in: 10 mm
// to the right at least, and then up to the 200 of the travel.
TEST(CheckWork, FacesAreThoseOfTheWorkOrigin) {
  EXPECT_EQ(Checked("PU100,-100;PD100,15100;PU;")->detail,
            "2 mm of the work would not be cut: 1 mm beyond the least Y (0 mm), 1 mm beyond the "
            "greatest Y (150 mm); in Y it is 2 mm too large for this machine");
  machine::Parameters moved = ParametersOf("t1");
  EXPECT_TRUE(moved.Set("ORIGIN_X", std::string_view("50")));
  EXPECT_TRUE(moved.Set("ORIGIN_Y", std::string_view("20")));
  const auto left = CheckWork(machine::Bytes::Borrowed("PU-6000,100;PD0,100;PU;"), moved).value();
  ASSERT_TRUE(left);
  EXPECT_EQ(left->detail,
            "10 mm of the work would not be cut: 10 mm beyond the least X (-50 mm); in X it fits "
            "moved by 10 to 150 mm");
  const auto up = CheckWork(machine::Bytes::Borrowed("PU0,0;PD0,13200;PU;"), moved).value();
  ASSERT_TRUE(up);
  EXPECT_EQ(up->detail,
            "2 mm of the work would not be cut: 2 mm beyond the greatest Y (130 mm); in Y it fits "
            "moved by -20 to -2 mm");
}

// A machine that cannot be is told, not taken for another one.
TEST(CheckWork, AMachineThatCannotBe) {
  machine::Parameters wrong = ParametersOf("t1");
  EXPECT_TRUE(wrong.Set("X_MIN", std::string_view("300")));
  const auto refused = CheckWork(machine::Bytes::Borrowed("PU;"), wrong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellParameterRange);
}

// The surface stays where the operator set it, -2000, whatever !ZO makes of Z0: the lowest Z is 40
// mm below it, and the work reaches 50.
TEST(CheckWork, DepthIsToldFromTheSurface) {
  EXPECT_EQ(Checked("!MC1;!ZO-2500;Z100,100,500;Z100,100,-4500;")->detail,
            "10 mm of the work would not be cut: 10 mm below the lowest Z (-40 mm); in Z it fits "
            "moved by 10 to 20 mm");
}

TEST(CheckWork, WhatCutsNothingMayLieThere) {
  EXPECT_FALSE(Checked("PU-1000,0;PU100,100;PD20000,100;PU;!ZM0;Z0,0,9000;"));
  // 0.01 mm is the limit of the verdict.
  EXPECT_FALSE(Checked("PU1000,100;PD20001,100;PU;"));
  EXPECT_TRUE(Checked("PU1000,100;PD20002,100;PU;"));
}

TEST(CheckWork, PartsThatTheMachineRefuses) {
  const auto refused = Checked("PU1,1;\n!PZ-50,-200;PD100,100;PD9,99999999;");
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, ErrorCode::kRml1PartRefused);
  EXPECT_EQ(refused->where->line, 2);
  EXPECT_EQ(refused->detail,
            "coordinates or tool heights that are refused: 2; the tool-up height may be from 0 mm");
  EXPECT_EQ(Checked("PU1,1;PD9,99999999;")->detail,
            "coordinates or tool heights that are refused: 1; a coordinate may be from -83886.08 "
            "to 83886.07 mm");
  EXPECT_EQ(Checked("PU1,1;PD9;")->detail, "coordinates or tool heights that are refused: 1");
}

// Lengths are told to a thousandth of a millimetre: 12.3457 units are 0.123 mm.
TEST(CheckWork, LengthsHaveThreeDecimals) {
  EXPECT_EQ(Checked("PU1000,100;PD20012.3456,100;PU;")->detail,
            "0.123 mm of the work would not be cut: 0.123 mm beyond the greatest X (200 mm); in X "
            "it fits moved by -10 to -0.123 mm");
}

// All of the work lies 5 mm beyond the least Y, 10 mm too deep at its end: nothing of it is done,
// and the remedy is told all the same. 37.5 mm across and 50 mm down are 62.5 mm.
TEST(CheckWork, WorkThatLiesBeyondTheTravelAltogether) {
  const auto lost = Checked("!MC1;Z100,-500,0;Z3850,-500,-5000;");
  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->detail,
            "62.5 mm of the work would not be cut: 5 mm beyond the least Y (0 mm), 10 mm below the "
            "lowest Z (-40 mm); in Y it fits moved by 5 to 155 mm; in Z it fits moved by 10 to 20 "
            "mm");
}

}  // namespace
}  // namespace rmlcell::rml1
