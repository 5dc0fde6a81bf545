#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/optimo/offline/offset_path.h"

// Whether a compensated path cuts into the part. Private to the folder. mm.
namespace rmlcell::optimo {

// What is looked for:
//   - a place of the compensated path that is nearer to an edge of the contour than the radius of
//     the beam, or crosses it. The beam reaches that far across the edge, into the part. Where the
//     compensated path crosses itself there is always such a place nearby.
//   - a compensated move that runs against the programmed one: the move is shorter than the
//     compensation at its corners needs, and the beam cuts behind it.
//
// Edges are the programmed moves, without a lead-in and a lead-out: when the contour comes back to
// itself (or would within a tab's width, had it gone on straight), what lies before that point and
// behind it is in the scrap. They are looked for in the first and the last kLeadLegs moves.
// A beam that starts on an edge damages it: that is what was programmed, so what lies within two
// radii of such a start is left out.
//
// While the head keeps its direction the path is looked at along it, at any height. Where the head
// turns, distances are those in space: the path lies in the surface of the part, to which the head
// is perpendicular, and a surface is flat at the scale of the beam. Parts of the contour that are
// cut with the beam off in between are not looked at together.
struct Gouge {
  enum class Kind { kTooNear, kRunsBack };
  std::size_t leg = 0;  // of the compensated path
  Kind kind = Kind::kTooNear;
  double distance = 0.0;  // kTooNear: of the path from the edge; 0 when it crosses it
};
struct GougeSearch {
  std::vector<Gouge> found;  // the worst of each leg, ascending
  // From here on the path was not looked at: it is too long, or too much of it lies in one place.
  std::optional<std::size_t> unchecked_from;
};

inline constexpr std::size_t kLeadLegs = 4;
// Nearer than the radius by more than this is a gouge. The rounding to five decimals and the chords
// of arcs make up a third of it; programs have three decimals.
inline constexpr double kGougeTolerance_mm = 0.003;

// `offset_legs` as OffsetChain makes them of `legs`, by `offset`. Near linear: neighbours are found
// by a grid.
GougeSearch FindGouges(const std::vector<Leg>& legs, const std::vector<OffsetLeg>& offset_legs,
                       double offset);

}  // namespace rmlcell::optimo
