#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/translate.h"

namespace rmlcell::optimo {
namespace {

// What is said of one number in a program that cuts in ABSOL and LIN, in order of place.
std::vector<std::string> SaidAt(ErrorCode code, const std::string& text,
                                const std::string& speed = "SPEED 10\n") {
  std::vector<std::string> said;
  const machine::Translation made =
      TranslateOptimo({"a.S", "COORD ABSOL\nPATH LIN\n" + speed +
                                  "MOVE (0,0,0,0,0)\nWORK 0,0/ON\n" + text + "WORK 0,0/OFF\n"},
                      {});
  EXPECT_TRUE(made.ok) << text;
  for (const Diagnostic& d : made.diagnostics) {
    if (d.code == code) said.push_back(d.detail);
  }
  return said;
}

std::size_t SharpOnes(const std::string& text) { return SaidAt(ErrorCode::kFlySharp, text).size(); }

const std::string kAlong = "MOVE (100,0,0,0,0)", kUp = "MOVE (100,100,0,0,0)\n";

// OPT-2.62: a corner is told where it is known where both of its moves begin: not behind a new
// system, or a move that may end elsewhere.
TEST(ContourChain, CornersFromNowhereAreNotTold) {
  EXPECT_EQ(SharpOnes(kAlong + "/FLY\n" + kUp), 1U);
  EXPECT_EQ(SharpOnes(kAlong + "/FLY\nMOVE (100,0,100,0,0)\n"), 1U);  // in the plane of X and Z
  EXPECT_EQ(SharpOnes("SYSDEF (1,2,3,0,0,0)\n" + kAlong + "/FLY\n" + kUp), 0U);
  EXPECT_EQ(SharpOnes("MOVE (50,0,0,0,0)/END (VL[1])\n" + kAlong + "/FLY\n" + kUp), 0U);
}

// OPT-2.10: between two moves with a known speed one without is no passage of theirs.
TEST(ContourChain, AMoveOfUnknownSpeedParts) {
  const std::string between = "SPEED VR[1]\nMOVE (100,0,0,0,0)/FLY\nSPEED 10\n";
  EXPECT_EQ(SharpOnes("MOVE (50,0,0,0,0)/FLY\n" + between + kUp), 0U);
  EXPECT_EQ(SharpOnes("MOVE (50,0,0,0,0)/FLY\nMOVE (100,0,0,0,0)/FLY\n" + kUp), 1U);
}

// OPT-2.20: the angles of a via point lead nowhere: an arc is one without them. It comes to (100,0)
// along -Y, and goes on along +X.
TEST(ContourChain, AnglesOfAViaPointNeedNoNumbers) {
  for (const std::string angles : {"0,0", "VR[1],0", "0,VR[1]"}) {
    const std::string arc = "PATH CIR\nMOVE (100,0,0,0,0)/FLY/VIA (50,50,0," + angles +
                            ")\nPATH LIN\nMOVE (200,0,0,0,0)\n";
    EXPECT_EQ(SharpOnes(arc), 1U) << angles;
  }
  EXPECT_EQ(SharpOnes("PATH CIR\nMOVE (100,0,0,0,0)/FLY/VIA (VR[1],50,0,0,0)\nPATH LIN\n"
                      "MOVE (200,0,0,0,0)\n"),
            0U);
}

// OPT-E.7319: A turns from where it was, in contours as short as half a millimetre.
TEST(ContourChain, TheSwingIsCountedFromWhereAWas) {
  const auto told = [](const std::string& from, const std::string& to, const std::string& x) {
    return SaidAt(ErrorCode::kHeadSingular, "PATH PTP\nMOVE (0,0,5," + from +
                                                ",0)\nPATH LIN\nMOVE (" + x + ",0,5," + to +
                                                ",0)\n")
        .size();
  };
  EXPECT_EQ(told("-1", "1", "100"), 1U);
  EXPECT_EQ(told("1", "-1", "100"), 1U);
  EXPECT_EQ(told("0.4", "0.5", "100"), 0U);
  EXPECT_EQ(told("-0.4", "-0.5", "100"), 0U);
  EXPECT_EQ(told("0", "1", "0.5"), 1U);
}

// OPT-E.7318: 100 mm are short for a corner at SPEED 70, which is 350 mm/s; 2 m are not, and at
// SPEED 10 100 mm are not.
TEST(ContourChain, ShortNeighboursCapABlend) {
  const std::string far = "MOVE (2000,0,0,0,0)/FLY\nMOVE (2000,2000,0,0,0)\n";
  const auto capped = SaidAt(ErrorCode::kFlyCapped, kAlong + "/FLY\n" + kUp, "SPEED 70\n");
  ASSERT_EQ(capped.size(), 1U);
  const std::string begin = "a short neighbour makes the blend tighter: ",
                    end = " mm/s in its middle instead of 350.0";
  EXPECT_TRUE(capped[0].starts_with(begin) && capped[0].ends_with(end)) << capped[0];
  EXPECT_EQ(capped[0].find('.', begin.size()) + 2, capped[0].size() - end.size()) << capped[0];
  EXPECT_EQ(SaidAt(ErrorCode::kFlyCapped, far, "SPEED 70\n"), std::vector<std::string>{});
  EXPECT_EQ(SaidAt(ErrorCode::kFlyCapped, kAlong + "/FLY\n" + kUp), std::vector<std::string>{});
}

// OPT-2.10: nothing said is SPEED 70 and OVERSH 100; each has a part in how far a corner is cut.
TEST(ContourChain, WhatHoldsWhereNothingIsSaid) {
  const auto cut = [](const std::string& modes) {
    return SaidAt(ErrorCode::kFlySharp, "MOVE (400,0,0,0,0)/FLY\nMOVE (400,400,0,0,0)\n", modes);
  };
  ASSERT_EQ(cut("OVERSH 10\n").size(), 1U);
  EXPECT_EQ(cut("OVERSH 10\n"), cut("OVERSH 10\nSPEED 70\n"));
  EXPECT_NE(cut("OVERSH 10\n"), cut("OVERSH 10\nSPEED 100\n"));
  EXPECT_EQ(cut("SPEED 10\n"), cut("SPEED 10\nACCEL 100\nOVERSH 100\n"));
  EXPECT_NE(cut("SPEED 10\n"), cut("SPEED 10\nOVERSH 50\n"));
}

// OPT-B.22: a MOVE at SPEED 0 never ends: nothing is said of corners that are never reached.
TEST(ContourChain, NothingIsSaidBehindAMoveThatNeverEnds) {
  const auto sharp = [](const std::string& speed) {
    return SharpOnes(kAlong + "/FLY\nSPEED " + speed +
                     "\nMOVE (100,100,0,0,0)/FLY\nSPEED 10\nMOVE (200,200,0,0,0)\n");
  };
  EXPECT_EQ(sharp("10"), 1U);
  EXPECT_EQ(sharp("0"), 0U);
}

}  // namespace
}  // namespace rmlcell::optimo
