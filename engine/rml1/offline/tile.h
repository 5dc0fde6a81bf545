#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

struct TileOptions {
  int columns = 1;  // copies in X and in Y; the first one stays where it is
  int rows = 1;
  double gap_mm = 1.0;                // between the paths of the tool in the work
  std::size_t bytes_max = 256 << 20;  // of the stream that is made
};
inline constexpr int kTilesMax = 1000;  // columns, and rows

struct TiledStream {
  std::string stream;
  double pitch_x_mm = 0.0;  // from copy to copy
  double pitch_y_mm = 0.0;
};

// A program repeated: what comes before its first motion in X and Y or into the work stands once,
// and so does what follows its last motion in the work and the lift behind it. Between two copies
// the tool is lifted, to its tool-up height where that is above the work, else to the top, and the
// settings that the program changed on its way are set as they were. Row by row, X first.
// Errors: as MoveStream, CellInvalidArgument for counts outside 1 to kTilesMax and for a gap below
// 0 or no number; Rml1NotRewritten (8111) also for a program that never goes into the work, or
// whose settings at the end cannot be undone; Rml1DoesNotFit (8112), which says how many fit;
// Rml1ProductTooLarge (8108).
Result<TiledStream> TileStream(std::string_view stream, const machine::Parameters& parameters,
                               const TileOptions& options);

}  // namespace rmlcell::rml1
