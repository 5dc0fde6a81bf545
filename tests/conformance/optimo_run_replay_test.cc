// Objects and executables that are run: the seeds of the fuzz target, programs of the other seeds,
// and changes of both.
#include <gtest/gtest.h>

#include "engine/optimo/language/compiler.h"
#include "tests/fuzz/optimo_run_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kHead = 4;  // of an object; its checksum is as long

std::string BodyOf(const std::string& object) {
  if (object.size() < 2 * kHead || !object.starts_with("LM")) return object;
  return object.substr(kHead, object.size() - 2 * kHead);
}

void Replay(const std::string& object, int changes, std::mt19937& random) {
  ASSERT_EQ(TryObjectRun(object), "");
  const std::string body = BodyOf(object);
  for (int round = 0; round < changes; ++round) {
    const std::string changed = fuzz::Damaged(body, 1 + round % 3, 0, random);
    ASSERT_EQ(TryObjectRun(changed), "") << ::testing::PrintToString(changed);
  }
}

// LIVE-10.06
TEST(OptimoRunReplay, TheCorpusAndItsChangesHoldWhatTheyMust) {
  std::mt19937 random(41);  // NOLINT: the same every time
  for (const char* target : {"optimo-run", "optimo-object"}) {
    const auto seeds = fuzz::SeedsOf(target);
    EXPECT_GE(seeds.size(), 8U);
    for (const std::string& seed : seeds) Replay(seed, 150, random);
  }
}

// LIVE-10.06
TEST(OptimoRunReplay, ProgramsAndTheirChangesHoldWhatTheyMust) {
  std::mt19937 random(42);  // NOLINT: the same every time
  int programs = 0;
  for (const std::string& text : fuzz::SeedsOf("optimo-text")) {
    const Compilation compiled = Compile(text, {}, {.object_limit = 0, .advice = false});
    if (!compiled.ok) continue;
    ++programs;
    Replay(compiled.object, 150, random);
  }
  EXPECT_GE(programs, 5);
}

}  // namespace
}  // namespace rmlcell::optimo
