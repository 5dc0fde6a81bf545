#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo {

// Compiles a program that must be good.
inline Compilation MustCompile(std::string_view text) {
  Compilation compiled = Compile(text, "", {.advice = false});
  for (const Diagnostic& d : compiled.diagnostics) {
    EXPECT_FALSE(IsError(d.severity)) << FormatDiagnostic(d, text);
  }
  return compiled;
}

// Numbers of the findings, in order of place.
inline std::vector<int> FindingsOf(std::string_view text, bool advice = false) {
  std::vector<int> numbers;
  for (const Diagnostic& d : Compile(text, "", {.advice = advice}).diagnostics) {
    numbers.push_back(Lookup(d.code).number);
  }
  return numbers;
}

}  // namespace rmlcell::optimo
