#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace rmlcell::storage::sqlite {

// Which small contents came not long ago. A program that is run again and again makes the same
// products: those are worth sharing, one that comes once is not. A guess, in memory: a content that
// was forgotten costs its bytes once more.
class RecentContents {
 public:
  // Whether it came before; from now on it did. `sha256`: 32 bytes.
  bool CameBefore(std::string_view sha256) {
    std::uint64_t name = 0;
    std::memcpy(&name, sha256.data(), sizeof(name));
    std::uint64_t& newest = newest_[name % newest_.size()];
    const bool came = newest == name;
    newest = name;
    return came;
  }

 private:
  std::array<std::uint64_t, 1'024> newest_{};  // of those whose names end alike
};

}  // namespace rmlcell::storage::sqlite
