#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

// One phrase of a stream in words (stream_walk.h): a command, or one set of a command with many.
struct ExplainedPhrase {
  std::int64_t offset = 0;           // of its first byte in the stream
  std::uint64_t command = 0;         // number of its command, from 1; 0: no command
  std::string name;                  // "PD", "!ZZ"; empty for what is no command
  std::string text;                  // as it is written, the first kShownBytes of it
  std::string words;                 // what it does
  std::vector<Diagnostic> findings;  // as a check says them
};
inline constexpr std::size_t kShownBytes = 120;

// Tells a stream phrase by phrase, for a machine with these parameters; bytes that are no command
// and follow each other come as one. The consumer returns false to end it. Memory does not depend
// on the length of the stream. Errors: as MakeProfile (CellParameterRange), CellEmptyProgram.
Status Explain(std::string_view stream, const machine::Parameters& parameters,
               const std::function<bool(const ExplainedPhrase&)>& consumer);

}  // namespace rmlcell::rml1
