#include "engine/optimo/language/source_map.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kText =
    "; a bracket\r\n"
    "declare positionA = vr[7]   ; too long a name\r\n"
    "  10 speed 20.0;slow\r\n"
    "MOVE (positionA, 0,0,\r\n"
    "      0,0)\r\n";

// OPT-1.05: the object has no comments, the map has. It belongs to this one object.
TEST(SourceMap, GivesTheTextBackWhileTheObjectIsUnchanged) {
  const std::string object = MustCompile(kText).object;
  const std::string map = EncodeSourceMap(MapSource(kText, false, object));
  const Result<RecoveredSource> own = RecoverSource(object, map);
  ASSERT_TRUE(own);
  EXPECT_TRUE(own->own_text);
  EXPECT_EQ(own->text, kText);
  EXPECT_EQ(MustCompile(own->text).object, object);

  const std::string other = MustCompile("SPEED 5\n").object;
  const Result<RecoveredSource> changed = RecoverSource(other, map);
  ASSERT_TRUE(changed);
  EXPECT_FALSE(changed->own_text);
  EXPECT_EQ(changed->text, "     SPEED 5\n");
}

// OPT-8.69: an inch source comes back in inches.
TEST(SourceMap, RemembersTheUnit) {
  const std::string object = MustCompile("VR[0] = 25.4\n").object;
  const std::string map = EncodeSourceMap(MapSource("VR[0] = 1.0\n", true, object));
  EXPECT_TRUE(RecoverSource(object, map)->inch);
}

// OPT-B.71: every flipped bit and every cut is found; then the decompiler speaks.
TEST(SourceMap, DamagedMapsArePassedOver) {
  const std::string object = MustCompile(kText).object;
  const std::string map = EncodeSourceMap(MapSource(kText, false, object));
  for (std::size_t at = 0; at < map.size(); ++at) {
    std::string damaged = map;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    EXPECT_FALSE(DecodeSourceMap(damaged)) << at;
    EXPECT_FALSE(DecodeSourceMap(map.substr(0, at))) << at;
  }
  const Result<RecoveredSource> source = RecoverSource(object, map.substr(1));
  ASSERT_TRUE(source);
  EXPECT_FALSE(source->own_text);
  EXPECT_FALSE(RecoverSource("LMR", std::nullopt));
}

// OPT-6.01, OPT-1.20, OPT-6.04
TEST(SourceMap, KnowsTheLinesOfTheSteps) {
  EXPECT_EQ(LinesOfSteps(kText), (std::vector<int>{3, 4, 6}));
  EXPECT_EQ(Compile(kText, "", {.source = true}).step_lines, (std::vector<int>{3, 4, 6}));
  EXPECT_TRUE(Compile(kText, "", {}).step_lines.empty());
  EXPECT_TRUE(Compile("SPEED 101\n", "", {.source = true}).step_lines.empty());
  EXPECT_EQ(LinesOfSteps("DECLARE X = VR[0]\n; text\n10\nDEFINE PAR[0] = INT\nX = 1.\nENDTASK\n"),
            (std::vector<int>{4, 5, 6, 7}));
  EXPECT_EQ(LinesOfSteps(""), (std::vector<int>{1}));
}

// OPT-2.04: what the decompiler writes is metric, with no map or with that of another object.
TEST(SourceMap, WhatIsDecompiledIsMetric) {
  const std::string object = MustCompile("VR[0] = 25.4\n").object;
  const std::string other =
      EncodeSourceMap(MapSource("VR[0] = 2.0\n", true, MustCompile("VR[0] = 50.8\n").object));
  const Result<RecoveredSource> bare = RecoverSource(object, std::nullopt);
  ASSERT_TRUE(bare);
  EXPECT_FALSE(bare->inch);
  const Result<RecoveredSource> beside = RecoverSource(object, other);
  ASSERT_TRUE(beside);
  EXPECT_FALSE(beside->inch);
  EXPECT_EQ(beside->text, "     LET VR[0] = 25.4\n");
}

}  // namespace
}  // namespace rmlcell::optimo
