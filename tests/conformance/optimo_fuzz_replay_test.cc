// The seeds of the fuzz targets, and what they found, as ordinary tests.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "tests/fuzz/optimo_language_input.h"

namespace rmlcell::optimo {
namespace {

void Replay(const std::string& folder, const std::function<std::string(std::string_view)>& input) {
  const std::filesystem::path path =
      std::filesystem::path(RMLCELL_SOURCE_DIR) / "tests/fuzz/corpus" / folder;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    std::ifstream file(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    const std::string seed = bytes.str();
    EXPECT_EQ(input(seed), "") << entry.path();
    // The seed cut short, as a broken transfer leaves it.
    for (std::size_t length = 0; length < seed.size(); length += 1 + seed.size() / 64)
      EXPECT_EQ(input(std::string_view(seed).substr(0, length)), "") << entry.path() << length;
    ++count;
  }
  EXPECT_GE(count, 8) << folder;
}

// OPT-1.06, OPT-B.35
TEST(OptimoFuzzReplay, Texts) { Replay("optimo-text", TryText); }
// OPT-B.69, OPT-B.71
TEST(OptimoFuzzReplay, Objects) { Replay("optimo-object", TryObject); }
// OPT-8.26, OPT-8.52
TEST(OptimoFuzzReplay, Conversions) { Replay("optimo-convert", TryConvert); }
// OPT-8.05, OPT-8.11
TEST(OptimoFuzzReplay, Compensations) { Replay("optimo-compensate", TryCompensate); }

}  // namespace
}  // namespace rmlcell::optimo
