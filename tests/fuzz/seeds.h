#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

// What a fuzz target starts from, for the tests that replay it.
namespace rmlcell::fuzz {

// The committed seeds of a target, by the names of their files.
inline std::vector<std::string> SeedsOf(const std::string& target) {
  std::vector<std::filesystem::path> paths;
  const std::string folder = RMLCELL_SOURCE_DIR "/tests/fuzz/corpus/" + target;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<std::string> seeds;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return seeds;
}

// With so many changes: a byte is another one, or a few are missing. The first `kept` bytes choose
// what is tried, and stay.
inline std::string Damaged(std::string bytes, int changes, std::size_t kept, std::mt19937& random) {
  for (int k = 0; k < changes && bytes.size() > kept; ++k) {
    const std::size_t at = kept + random() % (bytes.size() - kept);
    if (random() % 4 == 0 && bytes.size() > 8) {
      bytes.erase(at, random() % 4);
    } else {
      bytes[at] = static_cast<char>(random() % 256);
    }
  }
  return bytes;
}

}  // namespace rmlcell::fuzz
