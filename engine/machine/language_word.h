#pragma once

#include <string_view>

namespace rmlcell::machine {

// A word of the language of a family, for who writes programs.
struct LanguageWord {
  std::string_view name{};  // "MOVE", "PD"
  std::string_view form{};  // how it is written; empty: as its name
  std::string_view text{};  // what it does
  std::string_view rule{};  // "RML1-3B.13"
};

}  // namespace rmlcell::machine
