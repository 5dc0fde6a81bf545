#pragma once

#include <array>
#include <string>
#include <string_view>

#include "engine/rml1/offline/from_gcode.h"
#include "engine/rml1/offline/rewrite.h"
#include "engine/rml1/offline/tile.h"
#include "engine/rml1/offline/to_gcode.h"

// The tools for streams on texts that lie in memory.
namespace rmlcell::rml1 {

struct GcodeText : ToGcodeNotes {
  std::string text;
};
inline Result<GcodeText> ToGcode(std::string_view stream, const machine::Parameters& parameters) {
  GcodeText made;
  Result<ToGcodeNotes> notes = ToGcode(machine::Bytes::Borrowed(stream), parameters,
                                       [&](std::string_view part) { made.text += part; });
  if (!notes) return notes.error();
  static_cast<ToGcodeNotes&>(made) = *std::move(notes);
  return made;
}

struct StreamOfGcode : FromGcodeOutcome {
  std::string stream;  // empty unless `ok`
};
inline Result<StreamOfGcode> FromGcode(std::string_view text, const machine::Parameters& parameters,
                                       const FromGcodeOptions& options = {}) {
  StreamOfGcode made;
  Result<FromGcodeOutcome> outcome = FromGcode(machine::Bytes::Borrowed(text), parameters, options,
                                               [&](std::string_view part) { made.stream += part; });
  if (!outcome) return outcome.error();
  static_cast<FromGcodeOutcome&>(made) = *std::move(outcome);
  if (!made.ok) made.stream.clear();
  return made;
}

struct RewrittenStream {
  std::string stream;
  std::array<double, 3> moved_mm{};
};
inline Result<RewrittenStream> MoveStream(std::string_view stream,
                                          const machine::Parameters& parameters,
                                          const std::array<double, 3>& by_mm) {
  RewrittenStream made;
  const auto moved = MoveStream(machine::Bytes::Borrowed(stream), parameters, by_mm,
                                [&](std::string_view part) { made.stream += part; });
  if (!moved) return moved.error();
  made.moved_mm = *moved;
  return made;
}
inline Result<RewrittenStream> ScaleStream(std::string_view stream,
                                           const machine::Parameters& parameters,
                                           double from_units_per_mm, double to_units_per_mm) {
  RewrittenStream made;
  const Status scaled =
      ScaleStream(machine::Bytes::Borrowed(stream), parameters, from_units_per_mm, to_units_per_mm,
                  [&](std::string_view part) { made.stream += part; });
  if (!scaled) return scaled.error();
  return made;
}

struct TiledStream : Tiling {
  std::string stream;
};
inline Result<TiledStream> TileStream(std::string_view stream,
                                      const machine::Parameters& parameters,
                                      const TileOptions& options) {
  TiledStream made;
  const auto tiling = TileStream(machine::Bytes::Borrowed(stream), parameters, options,
                                 [&](std::string_view part) { made.stream += part; });
  if (!tiling) return tiling.error();
  static_cast<Tiling&>(made) = *tiling;
  return made;
}

}  // namespace rmlcell::rml1
