// The committed corpus of the fuzz target, as an ordinary test: RML1-9.05, RML1-9.06.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "tests/engine/rml1/run_support.h"
#include "tests/fuzz/rml1_device_fuzz.h"

namespace rmlcell::rml1 {
namespace {

std::vector<std::string> CorpusFiles() {
  std::vector<std::string> files;
  const std::string folder = RMLCELL_SOURCE_DIR "/tests/fuzz/corpus/rml1";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  return files;
}

void Replay(const std::string& bytes) {
  std::vector<std::uint8_t> data(bytes.begin(), bytes.end());
  FuzzDevice(data.data(), data.size());
}

TEST(Rml1FuzzCorpus, KeepsEveryPromise) {
  const std::vector<std::string> files = CorpusFiles();
  ASSERT_GE(files.size(), 15U);
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    Replay(ReadFile(file));
  }
}

// Each seed on every machine, cut short anywhere, and with single bytes changed.
TEST(Rml1FuzzCorpus, KeepsEveryPromiseOnVariations) {
  for (const std::string& file : CorpusFiles()) {
    SCOPED_TRACE(file);
    const std::string seed = ReadFile(file);
    if (seed.size() < 4 || seed.size() > 400) continue;  // options alone have no byte to change
    for (std::size_t size = 3; size < seed.size(); size += 7) Replay(seed.substr(0, size));
    for (int option = 0; option < 256; option += 5) {
      std::string changed = seed;
      changed[0] = static_cast<char>(option / 5);
      changed[1] = static_cast<char>(option);
      changed[3 + static_cast<std::size_t>(option) % (seed.size() - 3)] ^=
          static_cast<char>(1 << (option % 8));
      Replay(changed);
    }
  }
}

}  // namespace
}  // namespace rmlcell::rml1
