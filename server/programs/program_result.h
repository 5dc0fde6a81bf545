#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"

namespace rmlcell::server {

// An error with what there is to say about the program.
struct ProgramError {
  Error error;
  std::vector<Diagnostic> diagnostics;
  UntoldFindings dropped{};
};

template <class T>
struct ProgramResult {
  std::optional<T> value;
  ProgramError error{};  // when there is no value

  ProgramResult(T made) : value(std::move(made)) {}                // NOLINT: implicit
  ProgramResult(Error wrong) : error{std::move(wrong), {}, {}} {}  // NOLINT: implicit
  ProgramResult(ProgramError wrong) : error(std::move(wrong)) {}   // NOLINT: implicit
  explicit operator bool() const { return value.has_value(); }
};

}  // namespace rmlcell::server
