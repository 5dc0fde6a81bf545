#pragma once

#include <cstdint>
#include <string_view>

#include "engine/core/diagnostic.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// Everything that the device has to say about a stream: the errors of sections 4 and 6, and advice.
enum class FindingKind : std::uint8_t {
  // Command errors.
  kForeignCharacter,
  kUnknownName,
  kStrayNumber,
  kUnknownCall,
  kAxisTwice,
  kAxisValue,
  kAxisLetter,
  kAxesTogether,
  kLeftOver,      // a set lacks numbers
  kValueRange,    // of a coordinate
  kHeightRange,   // Z1 or Z2
  kSettingRange,  // of speed, dwell, spindle speed
  kTravelRange,   // !ZM, !ZO beyond the travel
  // Communication errors.
  kBadSequence,
  kBadSequenceParameter,
  kSequenceParameterRange,
  kTooManySequenceParameters,
  kLineError,
  kBufferOverflow,
  // Advice.
  kSpeedLimited,
  kClipped,
  kSkippedName,
  kLogCut,
};
inline constexpr int kFindingKindCount = static_cast<int>(FindingKind::kLogCut) + 1;

struct Finding {
  FindingKind kind = FindingKind::kForeignCharacter;
  std::int64_t offset = 0;  // of the first byte concerned
  int length = 1;
  int step = 0;            // number of the command; 0: between commands
  unsigned char byte = 0;  // the byte that was refused, where there is one
  Op op = Op::kCall;       // of the command concerned, where there is one
  double value = 0.0;      // the number refused, where there is one
  Travel allowed{};        // kHeightRange: what it may be, device units
};

struct FindingRow {
  FindingKind kind;
  ErrorCode code;
  std::string_view rule;
};
const FindingRow& RowOf(FindingKind kind);
inline bool IsError(FindingKind kind) { return kind < FindingKind::kSpeedLimited; }

// "'X' begins no command", "PD lacks a number of its last set": what was observed.
Detail DetailOf(const Finding& finding);

// The place of a byte in a stream. A step from one question to the next, forward or back, costs
// what lies between them: asked nearly in order, it costs one pass in all.
class LineCounter {
 public:
  // Lines end with LF, as everywhere in the cell; a file with CR alone is one line.
  SourceSpan At(std::string_view stream, std::int64_t offset, int length);

 private:
  std::int64_t at_ = 0;
  std::int64_t line_start_ = 0;
  int line_ = 1;
};

// Code, severity and place alone.
Diagnostic PlainDiagnostic(const Finding& finding, std::string_view stream, LineCounter& lines);

// With line and column where `stream` is known.
Diagnostic ToDiagnostic(const Finding& finding, std::string_view stream, LineCounter& lines);

}  // namespace rmlcell::rml1
