#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/machine/parameters.h"
#include "engine/rml1/board/bitmap.h"
#include "engine/rml1/offline/byte_sink.h"

namespace rmlcell::rml1 {

struct BoardOptions {
  double pixel_mm = 0.0;
  double tool_mm = 0.4;   // diameter where it cuts: of a vee at its depth
  double depth_mm = 0.1;  // below Z 0
  double step_mm = 0.0;   // of the depth at a time, a unit of the machine at least; 0: all at once
  int passes = 1;         // lines around the copper, side by side
  double overlap = 0.5;   // of neighbouring passes, share of the diameter
  // Cuts the board out along the edge of the light area, once around, holes first; else traces are
  // isolated.
  bool outline = false;
  double feed_mm_s = 4.0;
  double plunge_mm_s = 1.0;
  double rpm = 0.0;  // 0: as the machine has it
  double clearance_mm = 2.0;
  double tolerance_mm = 0.005;  // of points that are left out
  double at_x_mm = 0.0;         // of the lower left corner of the picture
  double at_y_mm = 0.0;
  std::size_t bytes_max = 256 << 20;  // of the stream
};
inline constexpr int kPassesMax = 100;

struct BoardLines {
  std::vector<Diagnostic> findings;  // Rml1GapTooNarrow (8125), Rml1SpeedRounded (8106)
  std::size_t loops = 0;
  std::size_t joined = 0;  // traces that the tool does not part from a neighbour (8125)
  double width_mm = 0.0;   // of the picture
  double height_mm = 0.0;
};

// A stream that mills a board: the spindle turns, the tool goes around the copper at its radius,
// loop after loop in the order of a short way, lifted between them, and at the end it is lifted and
// the spindle is off. No copper is cut: lines keep the radius and, beyond it, half the diagonal of
// a pixel, the tolerance and half a unit of the machine away from the centres of the outermost
// pixels of copper. Traces that the tool cannot part are counted and said. Whether the lines are on
// the travel tells CheckWork (work_check.h). Errors: as MakeProfile; CellInvalidArgument for an
// option out of range; Rml1NothingToMill (8124) for a picture without copper, or of copper alone
// unless it is an outline; Rml1PictureTooLarge (8122) with its margin; Rml1ProductTooLarge (8108).
Result<BoardLines> StreamOfBoard(const Bitmap& bitmap, const machine::Parameters& parameters,
                                 const BoardOptions& options, const ByteSink& sink);

// What CheckWork found about its stream, in the terms of the picture: work beyond the travel is
// Rml1PictureBeyondTravel (8126). Stays as it is otherwise.
Error InTermsOfPicture(Error found, const BoardLines& board);

}  // namespace rmlcell::rml1
