#pragma once

#include <compare>
#include <cstdint>

#include "engine/core/characters.h"

// Places as editors count them: line and character from 0, characters in the units that client and
// server agreed on.
namespace rmlcell::lsp {

struct Position {
  std::uint32_t line = 0;
  std::uint32_t character = 0;

  auto operator<=>(const Position&) const = default;
};
struct Range {
  Position start{};
  Position end{};  // behind the last character

  bool operator==(const Range&) const = default;
};

}  // namespace rmlcell::lsp
