// The committed seeds of the fuzz targets of the tools, as ordinary tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "tests/engine/rml1/run_support.h"
#include "tests/fuzz/rml1_tools_input.h"

namespace rmlcell::rml1 {
namespace {

// Each seed, cut short anywhere, and with single bits changed.
void Replay(const std::string& name, std::string (*try_input)(std::string_view)) {
  const std::string folder = RMLCELL_SOURCE_DIR "/tests/fuzz/corpus/" + name;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path().string());
  std::ranges::sort(files);
  ASSERT_GE(files.size(), 4U);
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const std::string seed = ReadFile(file);
    EXPECT_EQ(try_input(seed), "");
    for (std::size_t size = 0; size < seed.size(); size += 5)
      EXPECT_EQ(try_input(seed.substr(0, size)), "") << size;
    for (std::size_t bit = 0; bit < 8 * seed.size(); bit += 11) {
      std::string changed = seed;
      changed[bit / 8] ^= static_cast<char>(1 << (bit % 8));
      EXPECT_EQ(try_input(changed), "") << "bit " << bit;
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(Rml1ToolsCorpus, Walk) { Replay("rml1-walk", TryWalk); }
TEST(Rml1ToolsCorpus, Gcode) { Replay("rml1-gcode", TryGcode); }
TEST(Rml1ToolsCorpus, Png) { Replay("rml1-png", TryPng); }

}  // namespace
}  // namespace rmlcell::rml1
