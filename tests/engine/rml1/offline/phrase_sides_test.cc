#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/rml1/offline/explain.h"
#include "engine/rml1/offline/stream_copy.h"
#include "engine/rml1/offline/stream_diff.h"
#include "engine/rml1/offline/work_check.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// Phrases one behind the other: what parts them, what pairs them, and what is left of them behind
// an error. T1: 100 units in a mm.
namespace rmlcell::rml1 {
namespace {

std::vector<ExplainedPhrase> PhrasesOf(const std::string& stream) {
  std::vector<ExplainedPhrase> phrases;
  EXPECT_TRUE(Explain(stream, ParametersOf("t1"), [&](const ExplainedPhrase& phrase) {
    phrases.push_back(phrase);
    return true;
  }));
  return phrases;
}

// explain.h: what is no command is one run with blanks in between, and another one behind anything
// else.
TEST(PhraseSides, OnlyBlanksJoinForeignBytes) {
  const auto texts = [](const std::string& stream) {
    std::vector<std::string> found;
    for (const ExplainedPhrase& phrase : PhrasesOf(stream)) found.push_back(phrase.text);
    return found;
  };
  EXPECT_EQ(texts("PU;XX;YY;"), (std::vector<std::string>{"PU", "XX", "YY"}));
  EXPECT_EQ(texts("XX \t YY;"), (std::vector<std::string>{"XX \t YY"}));
  EXPECT_EQ(texts("XX\nYY;PU;"), (std::vector<std::string>{"XX", "YY", "PU"}));
}

// 2.5 new units for one: what rounding took of Z0 and of a height above it is made good by the next
// relative way. Down to -15 of the new units in all.
TEST(PhraseSides, RoundingOfZ0AndOfAHeightAddUp) {
  const auto scaled =
      ScaleStream("!ZO-3;Z0,0,-1;PR;Z0,0,-2;", ParametersOf("t1"), 40, 100).value().stream;
  EXPECT_EQ(scaled, "!ZO-8;Z0,0,-3;PR;Z0,0,-4;");
}

// RML1-3A.34: an exclamation mark ends an open call; what the data end in begins with the call.
TEST(PhraseSides, ACallThatNoNameFollows) {
  const std::vector<ExplainedPhrase> phrases = PhrasesOf("^!");
  ASSERT_EQ(phrases.size(), 1U);
  EXPECT_EQ(phrases[0].offset, 0);
  EXPECT_EQ(phrases[0].text, "^!");
}

// phrase_words.h: an axis that goes by more than rounding is told, however little that is.
TEST(PhraseSides, ALittleWayIsTold) {
  const std::vector<ExplainedPhrase> phrases = PhrasesOf("!MC0;PU100,0;PU100.0005,200;");
  ASSERT_EQ(phrases.size(), 3U);
  EXPECT_EQ(phrases[0].name, "!MC");
  EXPECT_EQ(phrases[1].name, "PU");
  EXPECT_NE(phrases[2].words.find(" X 1 Y 2"), std::string::npos) << phrases[2].words;
}

// stream_diff.h: what is of a kind between two that stay is one that changed, and what is over on
// one side has come or gone.
TEST(PhraseSides, AWaitThatChangedBehindAMotionThatWent) {
  const std::string one = "!MC0;PU1,1;PU2,2;!DW100;Z3,3,3;", other = "!MC0;PU1,1;!DW200;Z3,3,3;";
  const auto diff = [](const std::string& a, const std::string& b) {
    return CompareStreams({.object = a}, {.object = b}, ParametersOf("t1")).value().steps;
  };
  const auto less = diff(one, other);
  ASSERT_EQ(less.size(), 2U);
  EXPECT_EQ(less[0].kind, machine::StepChange::Kind::kRemoved);
  EXPECT_TRUE(less[0].before.starts_with("go to X 0.02 Y 0.02")) << less[0].before;
  EXPECT_EQ(less[1].kind, machine::StepChange::Kind::kChanged);
  EXPECT_EQ(less[1].what, std::vector<std::string>{"wait in ms 100 -> 200"});
  const auto more = diff(other, one);
  ASSERT_EQ(more.size(), 2U);
  EXPECT_EQ(more[0].kind, machine::StepChange::Kind::kAdded);
  EXPECT_EQ(more[1].what, std::vector<std::string>{"wait in ms 200 -> 100"});
}

// stream_diff.h: so many changes are told with their texts, and no more.
TEST(PhraseSides, TextsOfTheFirstChanges) {
  std::string many = "!MC0;PU";
  for (std::size_t n = 0; n < kToldChangesMax + 3; ++n)
    many += (n == 0 ? "" : ",") + std::to_string(n % 2 + 1) + "," + std::to_string(n % 1000);
  const auto diff =
      *CompareStreams({.object = "!MC0;"}, {.object = many + ";"}, ParametersOf("t1"));
  std::size_t told = 0;
  for (const machine::StepChange& change : diff.steps) told += !change.after.empty();
  EXPECT_GT(diff.steps.size(), kToldChangesMax);
  EXPECT_EQ(told, kToldChangesMax);
}

// Of an origin 50 mm in and 20 mm up the least X is -50 and the least Y -20 mm.
TEST(PhraseSides, FacesBesideAnOrigin) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 50.0));
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 20.0));
  const auto lost = [&](const std::string& stream) {
    const auto found = CheckWork(machine::Bytes::Borrowed(stream), parameters).value();
    return found ? std::string(found->detail) : std::string();
  };
  EXPECT_NE(lost("PU0,0;PD0,-3000;PU;").find("10 mm beyond the least Y (-20 mm)"),
            std::string::npos);
  EXPECT_NE(lost("PU0,0;PD0,14000;PU;").find("10 mm beyond the greatest Y (130 mm)"),
            std::string::npos);
  EXPECT_NE(lost("PU0,0;PD-6000,0;PU;").find("10 mm beyond the least X (-50 mm)"),
            std::string::npos);
}

// stream_copy.h: the first error is kept, and nothing more is copied, neither of the stream nor of
// what is put in.
TEST(PhraseSides, BehindAnErrorNothingIsCopied) {
  const std::string stream(300'000, ';');
  const machine::Bytes bytes = machine::Bytes::Borrowed(stream);
  std::size_t copied = 0;
  const ByteSink sink = [&](std::string_view part) { copied += part.size(); };
  StreamCopy copy(bytes, 0, sink);
  copy.Refuse("the first", 5);
  copy.Refuse("the second", 7);
  copy.Insert(10, std::string(200'000, 'x'));
  const Status finished = copy.Finish(static_cast<std::int64_t>(stream.size()));
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().code, ErrorCode::kRml1NotRewritten);
  EXPECT_EQ(static_cast<std::string>(finished.error().detail), "the first");
  EXPECT_EQ(finished.error().where, (SourceSpan{1, 6, 1, 5}));
  EXPECT_EQ(copied, 0U);

  StreamCopy good(bytes, 0, sink);
  good.Insert(10, std::string(200'000, 'x'));
  EXPECT_TRUE(good.Finish(static_cast<std::int64_t>(stream.size())));
  EXPECT_EQ(copied, 500'000U);
}

}  // namespace
}  // namespace rmlcell::rml1
