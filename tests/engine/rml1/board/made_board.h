#pragma once

#include <string>
#include <string_view>

#include "engine/rml1/board/board_stream.h"

namespace rmlcell::rml1 {

// A board with its stream in memory.
struct BoardStream : BoardLines {
  std::string stream;
};
inline Result<BoardStream> StreamOfBoard(const Bitmap& bitmap,
                                         const machine::Parameters& parameters,
                                         const BoardOptions& options) {
  BoardStream made;
  Result<BoardLines> lines = StreamOfBoard(bitmap, parameters, options,
                                           [&](std::string_view part) { made.stream += part; });
  if (!lines) return lines.error();
  static_cast<BoardLines&>(made) = *std::move(lines);
  return made;
}

}  // namespace rmlcell::rml1
