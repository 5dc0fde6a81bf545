// Which executables an altered FUNCTION makes stale, whatever was looked at before them.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/optimo/language/staleness.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::stale_neighbours {
namespace {

// OPT-1.13, OPT-9.13: 33 is looked at behind 32, which has one FUNCTION more, and 34 behind 33.
TEST(StaleNeighbours, OnlyWhatContainsAnAlteredFunctionIsStale) {
  std::map<int, std::string> objects;
  const auto store = [&](int slot, const std::string& text) {
    objects[slot] = MustCompile(text).object;
  };
  const ObjectLookup lookup = [&](int slot) -> std::optional<std::string_view> {
    const auto found = objects.find(slot);
    if (found == objects.end()) return std::nullopt;
    return found->second;
  };
  for (const int slot : {44, 45, 46}) store(slot, "SPEED 6\n");
  store(32, "FUNCTION 44\nFUNCTION 45\nFUNCTION 46\n");
  store(33, "FUNCTION 44\nFUNCTION 45\n");
  store(34, "FUNCTION 44\n");
  std::map<int, std::string> made;
  for (const int slot : {32, 33, 34}) made[slot] = EncodeExecutable(*Link(slot, lookup, {}));
  const std::map<int, std::string_view> executables(made.begin(), made.end());
  EXPECT_TRUE(FindStaleExecutables(executables, {lookup, {}}).empty());
  store(46, "SPEED 7\n");
  const std::vector<StaleExecutable> one = {{32, {{46, StaleReason::kFunctionChanged}}}};
  EXPECT_EQ(FindStaleExecutables(executables, {lookup, {}}), one);
  store(45, "SPEED 7\n");
  const std::vector<StaleExecutable> two = {
      {32, {{45, StaleReason::kFunctionChanged}, {46, StaleReason::kFunctionChanged}}},
      {33, {{45, StaleReason::kFunctionChanged}}}};
  EXPECT_EQ(FindStaleExecutables(executables, {lookup, {}}), two);
}

}  // namespace
}  // namespace rmlcell::optimo::stale_neighbours
