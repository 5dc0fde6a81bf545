#pragma once

namespace rmlcell {

// Prints the place and the condition to standard error and ends the process.
[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);

}  // namespace rmlcell

// For our own mistakes only, never for input. Stays on in release builds: a worker that stops is
// restarted and its job attempted again; one that goes on wrong moves a machine wrong.
#define RMLCELL_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::rmlcell::CheckFailed(#condition, __FILE__, __LINE__))
