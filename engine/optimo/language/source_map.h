#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/optimo/language/program.h"

// The source map of an object: what the object itself does not hold. It lies beside the object,
// outside of its size limit, and gives the programmer his own text back (comments, layout, long
// names, spelling) as long as the object is the one that was made from it.
namespace rmlcell::optimo {

struct SourceMap {
  std::uint64_t object_hash = 0;  // HashObject of the object that the text compiled to
  bool inch = false;              // the text is an inch source; the object is metric
  std::string text;

  bool operator==(const SourceMap&) const = default;
};

// `text` as the programmer stored it, `object` as it was compiled from it.
SourceMap MapSource(std::string_view text, bool inch, std::string_view object);

// Bytes to keep; identical on every platform.
std::string EncodeSourceMap(const SourceMap& map);
// Safe on hostile bytes. Errors: ObjectCorrupt (7034).
Result<SourceMap> DecodeSourceMap(std::string_view bytes);

// The source of an object: the programmer's own text when the map belongs to it, else what the
// decompiler writes. A map that is damaged or of another object is passed over, never an error.
struct RecoveredSource {
  std::string text;
  bool own_text = false;  // from the map
  bool inch = false;
};
// Errors: ObjectCorrupt (7034) of the object, when there is no text of its own.
Result<RecoveredSource> RecoverSource(std::string_view object,
                                      std::optional<std::string_view> source_map);

// The line, from 1, on which each step begins; element 0 is step 1, the last one the implied
// ENDTASK (OPT-6.01, OPT-6.04): the line behind the last statement. Text that does not compile is
// counted as far as it can be read.
std::vector<int> LinesOfSteps(std::string_view text);
// The same for a text that was parsed and checked already.
std::vector<int> LinesOfSteps(const ParsedProgram& program);

}  // namespace rmlcell::optimo
