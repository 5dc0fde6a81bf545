// Each line around the copper is a closed one, at every depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/rml1/offline/stream_walk.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// Where the tool goes in the work, from one plunge to the next: the place of
// the plunge first.
class Rounds final : public PhraseListener {
 public:
  bool OnPhrase(const Phrase& phrase) override {
    for (const Action& action : phrase.actions) {
      if (action.kind != Action::Kind::kMotion || action.to.z >= phrase.before->z0) continue;
      if (action.use == machine::MotionUse::kPlunge) all.emplace_back();
      if (!all.empty()) all.back().push_back(action.to);
    }
    return true;
  }
  std::vector<std::vector<Point>> all;
};

Bitmap OnePad() { return {.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}}; }

// board_stream.h: the tool goes around the copper, once for each step of the
// depth: each round ends where it began, and nowhere else is the tool lower or
// higher than its step.
TEST(BoardRounds, ARoundEndsWhereItBegan) {
  const Profile profile = MakeProfile(ParametersOf("srm-20")).value();
  const auto made = StreamOfBoard(OnePad(), ParametersOf("srm-20"),
                                  {.pixel_mm = 1.0,
                                   .tool_mm = 1.0,
                                   .depth_mm = 0.5,
                                   .step_mm = 0.2,
                                   .at_x_mm = 20,
                                   .at_y_mm = 30});
  ASSERT_TRUE(made) << made.error().detail;
  ASSERT_EQ(made->loops, 1U);
  Rounds rounds;
  ASSERT_TRUE(StreamWalk(profile, rounds).Run(made->stream));
  ASSERT_EQ(rounds.all.size(), 3U);
  const double depths[] = {-20, -40, -50};
  for (std::size_t step = 0; step < 3; ++step) {
    const std::vector<Point>& round = rounds.all[step];
    ASSERT_GE(round.size(), 4U) << made->stream;
    EXPECT_EQ(round.back(), round.front()) << made->stream;
    EXPECT_NE(round[1], round.front());
    for (const Point& p : round) EXPECT_EQ(p.z - profile.z0, depths[step]);
    EXPECT_EQ(round.front().x, rounds.all[0].front().x);
    EXPECT_EQ(round.front().y, rounds.all[0].front().y);
  }
}

// A speed that the machine has not is told, however near it is to one that it
// has.
TEST(BoardRounds, ASpeedThatIsNearlyThere) {
  const auto findings = [](double feed_mm_s) {
    return StreamOfBoard(OnePad(), ParametersOf("srm-20"),
                         {.pixel_mm = 1.0, .feed_mm_s = feed_mm_s, .at_x_mm = 20})
        .value()
        .findings.size();
  };
  EXPECT_EQ(findings(4.0), 0U);
  EXPECT_EQ(findings(4.0 * (1.0 + 1e-7)), 1U);
  EXPECT_EQ(findings(4.0 * (1.0 - 1e-7)), 1U);
}

// board_stream.h: the tool goes to the depth that was asked for, however little the last step is:
// 1.0053 mm are 101 units of 0.01 mm, two steps of 0.5023 mm no more than 100.
TEST(BoardRounds, TheLastStepMayBeThin) {
  const Profile profile = MakeProfile(ParametersOf("srm-20")).value();
  const auto made = StreamOfBoard(
      OnePad(), ParametersOf("srm-20"),
      {.pixel_mm = 1.0, .depth_mm = 1.0053, .step_mm = 0.5023, .at_x_mm = 20, .at_y_mm = 30});
  ASSERT_TRUE(made) << made.error().detail;
  Rounds rounds;
  ASSERT_TRUE(StreamWalk(profile, rounds).Run(made->stream));
  std::vector<double> depths;
  for (const std::vector<Point>& round : rounds.all) depths.push_back(round.front().z - profile.z0);
  EXPECT_EQ(depths, (std::vector<double>{-50, -100, -101})) << made->stream;
}

// board_stream.h: no copper is cut, also where a coarse tolerance leaves few points of a line: it
// keeps the radius and half the diagonal of a pixel away from the middle of the only one, and each
// of its points counts for that.
TEST(BoardRounds, ACoarseLineCutsNoCopper) {
  const Profile profile = MakeProfile(ParametersOf("srm-20")).value();
  const auto made = StreamOfBoard(
      OnePad(), ParametersOf("srm-20"),
      {.pixel_mm = 1.0, .tool_mm = 10.0, .tolerance_mm = 0.9, .at_x_mm = 20, .at_y_mm = 30});
  ASSERT_TRUE(made) << made.error().detail;
  Rounds rounds;
  ASSERT_TRUE(StreamWalk(profile, rounds).Run(made->stream));
  ASSERT_EQ(rounds.all.size(), 1U);
  const std::vector<Point>& round = rounds.all[0];
  ASSERT_GE(round.size(), 5U) << made->stream;
  const double x = profile.origin_x + 21.5 * profile.units_per_mm;
  const double y = profile.origin_y + 31.5 * profile.units_per_mm;
  for (std::size_t k = 1; k < round.size(); ++k) {
    const Point& a = round[k - 1];
    const double dx = round[k].x - a.x;
    const double dy = round[k].y - a.y;
    const double share =
        std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    EXPECT_GE(std::hypot(x - a.x - share * dx, y - a.y - share * dy),
              (5.0 + M_SQRT1_2) * profile.units_per_mm)
        << k << " of " << made->stream;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
