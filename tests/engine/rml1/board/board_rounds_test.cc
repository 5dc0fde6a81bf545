// Each line around the copper is a closed one, at every depth.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rmlcell::rml1
