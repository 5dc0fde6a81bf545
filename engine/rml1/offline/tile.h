#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "engine/core/result.h"
#include "engine/machine/bytes.h"
#include "engine/machine/parameters.h"
#include "engine/rml1/offline/byte_sink.h"

namespace rmlcell::rml1 {

struct TileOptions {
  int columns = 1;  // copies in X and in Y; the first one stays where it is
  int rows = 1;
  // In place of columns and rows: as many copies as fit into a field so wide and high, and on the
  // travel.
  std::optional<std::array<double, 2>> within_mm{};
  double gap_mm = 1.0;                // between the paths of the tool in the work
  bool force = false;                 // more than fit, too: the machine leaves them out
  std::size_t bytes_max = 256 << 20;  // of the stream that is made
};
inline constexpr int kTilesMax = 1000;  // columns, and rows

struct Tiling {
  int columns = 1;
  int rows = 1;
  double pitch_x_mm = 0.0;  // from copy to copy
  double pitch_y_mm = 0.0;
  bool travel_is_less = false;  // than the field that was asked for
};

// A program repeated: what comes before its first motion in X and Y or into the work stands once,
// and so does what follows its last motion in the work and the lift behind it. Between two copies
// the tool is lifted, to its tool-up height where that is above the work, else to the top, and the
// settings that the program changed on its way are set as they were. Row by row, X first.
// Errors: as MoveStream, CellInvalidArgument for counts outside 1 to kTilesMax and for a gap below
// 0 or a field that are no number; Rml1NotRewritten (8111) also for a program that never goes into
// the work, or whose settings at the end cannot be undone; Rml1DoesNotFit (8112), which says how
// many fit; Rml1ProductTooLarge (8108); Rml1WorkBeyondTravel (8114) for a program that by itself
// leaves the travel, whose size is not known, forced or not.
Result<Tiling> TileStream(const machine::Bytes& stream, const machine::Parameters& parameters,
                          const TileOptions& options, const ByteSink& sink);

}  // namespace rmlcell::rml1
