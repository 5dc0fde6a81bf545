// The fuzz target as an ordinary test: seeds, and changes of them from a fixed random sequence.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "server/web/envelope.h"
#include "tests/server/web/decode_target.h"

namespace rmlcell::web::testing {
namespace {

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  const std::filesystem::path folder =
      std::filesystem::path(RMLCELL_SOURCE_DIR) / "tests/server/web/corpus";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::ranges::sort(seeds);
  for (char type = 0; type < 9; ++type) {
    const std::string head{'\1', type, type};
    seeds.push_back(head + "\n" + R"({"job":{"kind":"JOB_KIND_CHECK","machine":"machines/a"}})");
    seeds.push_back(head + "message=%7B%7D\n1S\n100\n7\nBearer x\ntext/event-stream\n\n" +
                    MakeEnvelope(0, R"({"name":"jobs/1"})"));
  }
  return seeds;
}

TEST(DecodeReplay, SeedsAndTheirChanges) {
  const std::vector<std::string> seeds = Seeds();
  ASSERT_GT(seeds.size(), 18U);
  std::mt19937 random(20250101);
  const auto pick = [&](std::size_t count) { return static_cast<std::size_t>(random()) % count; };
  for (const std::string& seed : seeds) {
    DecodeAnything(seed);
    for (int i = 0; i < 300; ++i) {
      std::string text = seed;
      for (std::size_t change = 0; change < 1 + pick(4) && !text.empty(); ++change) {
        const std::size_t at = pick(text.size());
        switch (pick(4)) {
          case 0:
            text[at] = static_cast<char>(random());
            break;
          case 1:
            text.erase(at, 1 + pick(8));
            break;
          case 2:
            text.insert(at, text.substr(pick(text.size()), pick(16)));
            break;
          default:
            text.resize(at);
            break;
        }
      }
      DecodeAnything(text);
    }
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
