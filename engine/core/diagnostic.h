#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"

namespace rmlcell {

// Replace `length` bytes at `byte_offset` of the file by `text`.
struct Fix {
  std::int64_t byte_offset = 0;
  int length = 0;
  std::string text{};

  bool operator==(const Fix&) const = default;
};

// Whether the verdict of a program rests on findings of this kind: then it is no mere advice.
enum class Judged : std::uint8_t { kNo, kDoubtful, kBad };

// A finding about a program, before it runs or while it runs.
struct Diagnostic {
  ErrorCode code;
  Severity severity;   // normally that of the catalogue row; CHECK may lower or raise it
  Detail detail{};     // "radius is 0"
  std::string rule{};  // "OPT-2.27"; empty when the code says all
  std::string file{};  // as the user named it; empty for a stored program
  SourceSpan where{};  // line 0: no text is known
  int program = 0;     // slot; 0 when the program has none
  int step = 0;        // as the control counts; 0 when it belongs to no step
  std::vector<Fix> fixes{};
  std::optional<SimTime> at{};  // virtual time of the run that found it; none: found in the text
  Judged judged = Judged::kNo;

  bool operator==(const Diagnostic&) const = default;
};

// What was observed; where nothing is said of it, what the catalogue says of the code.
Detail Said(ErrorCode code, const Detail& detail);

// An error stops a program from being stored or from going on; warnings and advice do not.
bool IsError(Severity severity);
bool HasErrors(std::span<const Diagnostic> findings);

// The one word that stands before a finding: "error" where it stops a program, else "BAD" or
// "DOUBTFUL" where the verdict rests on it, else the name of its severity.
std::string_view FindingWord(const Diagnostic& finding);

// Findings of one kind that are told singly; more of them are told once, with count and extent.
inline constexpr std::uint64_t kToldOfKindMax = 5;

// "part.S:12:6: error OPT-E7019: MOVE has 4 values, needs 5 [OPT-2.01]", of a run with its time,
// "(step 3, at 1.500 s)", then, when `source` is not empty and the line is known, that line and a
// caret line below it. No line end after the last line.
std::string FormatDiagnostic(const Diagnostic& diagnostic, std::string_view source);

// What an author lets pass: warnings and advice of this number at a line of the text; 0: anywhere.
struct AllowedFinding {
  int line = 0;
  int number = 0;

  bool operator==(const AllowedFinding&) const = default;
};

}  // namespace rmlcell
