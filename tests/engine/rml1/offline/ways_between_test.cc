// Where the tool stands when a tool for streams puts something in, or tells
// what happened.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/stream_walk.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

std::string MovedBy(std::string_view stream, double x_mm, double y_mm, double z_mm) {
  const auto made = MoveStream(stream, ParametersOf("t1"), {x_mm, y_mm, z_mm});
  return made ? made->stream : "refused: " + made.error().detail;
}

// stream_mover.h: across above the work alone: where the moved tool stands at
// the surface it rises to the top first, and it does not where it stands 2 mm
// above it.
TEST(WaysBetween, TheMovedToolCrossesAboveTheWork) {
  EXPECT_EQ(MovedBy("!PZ-100,200;PU;PR;PD50,50;", 1, 2, -2),
            "!PZ-300,0;PU;PR;!ZZ0,0,2000,100,200,0,0,0,-2000;PD50,50;");
  EXPECT_EQ(MovedBy("!PZ-300,0;PU;PR;PD50,50;", 1, 2, 2),
            "!PZ-100,200;PU;PR;!ZZ100,200,0;PD50,50;");
}

// A way in from outside of the travel begins where it comes in: 30 mm behind
// where the tool had to wait. What is cut there has no extent in Y, so the rows
// stand one gap apart.
TEST(WaysBetween, AWayInBeginsWhereItComesIn) {
  const auto made = TileStream("!PZ-100,2000;PU-1000,3000;Z1000,3000,-600;PU1000,3000;PU0,0;",
                               ParametersOf("t1"), {.rows = 2, .gap_mm = 1.0});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->pitch_y_mm, 1.0);
}

// phrase_words.h: a millionth of a unit is noise of decimals, two are a way.
TEST(WaysBetween, AMillionthIsNoWay) {
  std::vector<std::string> words;
  const auto told = [&](const std::string& stream) {
    words.clear();
    EXPECT_TRUE(Explain(stream, ParametersOf("t1"), [&](const ExplainedPhrase& phrase) {
      words.push_back(phrase.words);
      return true;
    }));
    return words.back();
  };
  EXPECT_EQ(told("!MC0;PU0,5;PU0.000001,200;"), "go to Y 2 at 60 mm/s");
  EXPECT_EQ(told("!MC0;PU0,5;PU0.000002,200;"), "go to X 0 Y 2 at 60 mm/s");
}

// RML1-4.08: what ESC.K throws away is none of its own.
TEST(WaysBetween, AnAbortHasNoNumbers) {
  class Counting final : public PhraseListener {
   public:
    bool OnPhrase(const Phrase& phrase) override {
      if (phrase.kind == Phrase::Kind::kAbort) values.push_back(phrase.values.size());
      return true;
    }
    std::vector<std::size_t> values;
  } counting;
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  EXPECT_TRUE(StreamWalk(profile, counting).Run("PD1,2,3,\x1b.KZ5,6,\x1b.KPU;"));
  EXPECT_EQ(counting.values, (std::vector<std::size_t>{0, 0}));
}

// stream_mover.h: up to the top only to go across. What is owed in Z alone leads straight to where
// the moved program goes on, also from the surface.
TEST(WaysBetween, AWayInZAloneIsStraight) {
  EXPECT_EQ(MovedBy("!ZM-2000;PR;Z0,0,-10;", 0, 0, -0.5), "!ZM-2000;PR;!ZZ0,0,-50;Z0,0,-10;");
  EXPECT_EQ(MovedBy("!ZM-2000;PR;Z0,0,-10;", 0, 0, 0.5), "!ZM-2000;PR;!ZZ0,0,50;Z0,0,-10;");
}

// What is owed in Z has not moved the tool yet: behind !ZM, a place of the machine, it stands at
// the surface, 20 mm below the top, or a unit above it, whatever the move is.
TEST(WaysBetween, WhatIsOwedInZHasMovedNothing) {
  EXPECT_EQ(MovedBy("!ZM-2000;PR;Z100,0,0;", 1, 2, 0.5),
            "!ZM-2000;PR;!ZZ0,0,2000,100,200,0,0,0,-1950;Z100,0,0;");
  EXPECT_EQ(MovedBy("!ZM-2000;PR;Z100,0,0;", 1, 2, -0.5),
            "!ZM-2000;PR;!ZZ0,0,2000,100,200,0,0,0,-2050;Z100,0,0;");
  EXPECT_EQ(MovedBy("!ZM-1999;PR;Z100,0,0;", 1, 2, -0.5),
            "!ZM-1999;PR;!ZZ100,200,0,0,0,-50;Z100,0,0;");
}

}  // namespace
}  // namespace rmlcell::rml1
