#include "engine/rml1/offline/stream_walk.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using Kind = Phrase::Kind;

struct Seen {
  Kind kind;
  std::string text;
  std::vector<double> values;
  std::size_t motions = 0;
  std::size_t findings = 0;
  bool first = true;

  bool operator==(const Seen&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Seen& seen) {
  out << '{' << static_cast<int>(seen.kind) << " '" << seen.text << "'";
  for (const double value : seen.values) out << ' ' << value;
  return out << " motions " << seen.motions << " findings " << seen.findings << " first "
             << seen.first << '}';
}

class Recorder final : public PhraseListener {
 public:
  explicit Recorder(std::string_view stream) : stream_(stream) {}
  bool OnPhrase(const Phrase& phrase) override {
    Seen one{
        .kind = phrase.kind,
        .text = std::string(stream_.substr(static_cast<std::size_t>(phrase.begin),
                                           static_cast<std::size_t>(phrase.end - phrase.begin))),
        .findings = phrase.findings.size(),
        .first = phrase.first};
    for (const Phrase::Value& value : phrase.values) {
      one.values.push_back(value.number.single);
      // The bytes of a number are those that it was read from.
      numbers.push_back(
          std::string(stream_.substr(static_cast<std::size_t>(value.begin),
                                     static_cast<std::size_t>(value.end - value.begin))));
    }
    for (const Action& action : phrase.actions) one.motions += action.kind == Action::Kind::kMotion;
    seen.push_back(one);
    return true;
  }

  std::vector<Seen> seen;
  std::vector<std::string> numbers;

 private:
  std::string_view stream_;
};

Recorder Walk(std::string_view stream, std::string_view profile_id = "t1") {
  static Profile profile;
  profile = MakeProfile(ParametersOf(profile_id)).value();
  Recorder recorder(stream);
  StreamWalk walk(profile, recorder);
  EXPECT_TRUE(walk.Run(stream));
  return recorder;
}

// Every set acts by itself: the first one brings the tool to its height, RML1-3B.13.
TEST(StreamWalk, TellsEachSetOfACommand) {
  const Recorder got = Walk("PD100,0,100,200;PU;");
  EXPECT_EQ(got.seen, (std::vector<Seen>{{Kind::kSet, "PD100,0", {100, 0}, 2, 0, true},
                                         {Kind::kSet, ",100,200", {100, 200}, 1, 0, false},
                                         {Kind::kBare, "PU", {}, 1, 0, true}}));
  EXPECT_EQ(got.numbers, (std::vector<std::string>{"100", "0", "100", "200"}));
}

TEST(StreamWalk, NumbersKeepTheirBytes) {
  EXPECT_EQ(Walk("Z +1.50 ,-.5\t7.;").numbers, (std::vector<std::string>{"+1.50", "-.5", "7."}));
  EXPECT_EQ(Walk("!ZE x 12 Z-3.0;").numbers, (std::vector<std::string>{"12", "-3.0"}));
}

// RML1-3A.14: the complete pairs run, the rest is an error. RML1-2.34: so is all behind a bad
// value.
TEST(StreamWalk, WhatIsNotCarriedOutIsNoSet) {
  EXPECT_EQ(Walk("D100,0,200;").seen,
            (std::vector<Seen>{{Kind::kSet, "D100,0", {100, 0}, 2, 0, true},
                               {Kind::kLeftOver, ",200", {200}, 0, 1, false}}));
  EXPECT_EQ(Walk("PU100,0,8388608,0,200,0,5;").seen,
            (std::vector<Seen>{
                {Kind::kSet, "PU100,0", {100, 0}, 2, 0, true},
                {Kind::kLeftOver, ",8388608,0,200,0,5", {8388608, 0, 200, 0}, 0, 1, false}}));
  EXPECT_EQ(Walk("PU0,8388608;").seen,
            (std::vector<Seen>{{Kind::kLeftOver, "PU0,8388608", {0, 8388608}, 0, 1, true}}));
}

// RML1-3D.12: an error drops its group and all up to the terminator.
TEST(StreamWalk, GroupsOfAxes) {
  EXPECT_EQ(Walk("!ZE X100Y200:Z300A:X0;PU;", "t1a").seen,
            (std::vector<Seen>{{Kind::kGroup, "!ZE X100Y200", {100, 200}, 1, 0, true},
                               {Kind::kGroup, ":Z300A:X0", {300}, 0, 1, false},
                               {Kind::kBare, "PU", {}, 1, 0, true}}));
}

// RML1-3A.28: the caret belongs to the command that it calls. RML1-4.01, RML1-4.08: sequences.
TEST(StreamWalk, CallsAndControlSequences) {
  EXPECT_EQ(Walk("^ PU1,2;").seen,
            (std::vector<Seen>{{Kind::kSet, "^ PU1,2", {1, 2}, 2, 0, true}}));
  EXPECT_EQ(Walk("PD1\x1b.KPU;").seen, (std::vector<Seen>{{Kind::kAbort, "\x1b.K", {}, 0, 0, true},
                                                          {Kind::kBare, "PU", {}, 1, 0, true}}));
  // Behind ESC.K nothing is open any more, neither a list nor a call.
  EXPECT_EQ(Walk("PU1\x1b.K$PU;").seen, (std::vector<Seen>{{Kind::kAbort, "\x1b.K", {}, 0, 0, true},
                                                           {Kind::kDiscarded, "$", {}, 0, 1, true},
                                                           {Kind::kBare, "PU", {}, 1, 0, true}}));
  EXPECT_EQ(Walk("^\x1b.KPU1,2;").seen,
            (std::vector<Seen>{{Kind::kAbort, "\x1b.K", {}, 0, 0, true},
                               {Kind::kSet, "PU1,2", {1, 2}, 2, 0, true}}));
  // RML1-3A.31: what is called and is no command goes with its call.
  EXPECT_EQ(Walk("^QX;").seen, (std::vector<Seen>{{Kind::kDiscarded, "^QX", {}, 0, 1, true}}));
  EXPECT_EQ(Walk("^P").seen, (std::vector<Seen>{{Kind::kIncomplete, "^P", {}, 0, 0, true}}));
  const Recorder refused = Walk("PU1,2\x1b.;");
  ASSERT_EQ(refused.seen.size(), 2U);
  EXPECT_EQ(refused.seen[0].kind, Kind::kLinkError);
  EXPECT_EQ(refused.seen[1], (Seen{Kind::kSet, "PU1,2\x1b.", {1, 2}, 2, 0, true}));
}

TEST(StreamWalk, BytesThatAreNoCommandAndTheEndInsideOne) {
  EXPECT_EQ(Walk("5PU1,2").seen,
            (std::vector<Seen>{{Kind::kDiscarded, "5", {}, 0, 1, true},
                               {Kind::kIncomplete, "PU1,2", {1}, 0, 0, true}}));
  EXPECT_EQ(Walk("VS4;J1 2;", "mdx-540").seen,
            (std::vector<Seen>{{Kind::kFixed, "VS4", {4}, 0, 0, true},
                               {Kind::kSkipped, "J1 2", {1, 2}, 0, 1, true}}));
}

TEST(StreamWalk, AListenerMayEndIt) {
  class One final : public PhraseListener {
   public:
    bool OnPhrase(const Phrase&) override { return ++told < 2; }
    int told = 0;
  } listener;
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  EXPECT_FALSE(StreamWalk(profile, listener).Run("PU;PD;PU;"));
  EXPECT_EQ(listener.told, 2);
}

// RML1-3A.31, RML1-3A.34: what was called and is no command closes the call, and so does the
// command that is called: what comes behind begins at its own name.
TEST(StreamWalk, ACallIsOverWithWhatItCalls) {
  EXPECT_EQ(Walk("^QX;PU;").seen, (std::vector<Seen>{{Kind::kDiscarded, "^QX", {}, 0, 1, true},
                                                     {Kind::kBare, "PU", {}, 1, 0, true}}));
  EXPECT_EQ(Walk("^QX;$").seen, (std::vector<Seen>{{Kind::kDiscarded, "^QX", {}, 0, 1, true},
                                                   {Kind::kDiscarded, "$", {}, 0, 1, true}}));
  EXPECT_EQ(Walk("^PU;PD;").seen, (std::vector<Seen>{{Kind::kBare, "^PU", {}, 1, 0, true},
                                                     {Kind::kBare, "PD", {}, 1, 0, true}}));
}

// The listener may end it wherever it is told something: at a sequence that is refused, and at
// ESC.K.
TEST(StreamWalk, AListenerMayEndItAtASequence) {
  class One final : public PhraseListener {
   public:
    bool OnPhrase(const Phrase&) override { return ++told < 2; }
    int told = 0;
  };
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  for (const std::string stream : {"PU;\x1b.B;PD;PU;", "PU;\x1b.KPD;PU;", "PU;$PD;PU;"}) {
    One listener;
    EXPECT_FALSE(StreamWalk(profile, listener).Run(stream)) << stream;
    EXPECT_EQ(listener.told, 2) << stream;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
