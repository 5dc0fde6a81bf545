#pragma once

#include <optional>
#include <vector>

#include "engine/core/result.h"
#include "engine/motion/geometry/frames.h"

// The sideways offset of a cut path in space (optimo.md 8.1). Private to the folder. mm; directions
// are unit vectors.
namespace rmlcell::optimo {

using motion::ProgramVector;

// One cutting move, as programmed.
struct Leg {
  ProgramVector from, to;
  std::optional<ProgramVector> via;  // an arc, when the three points are no line
  ProgramVector tool_from, tool_to, tool_via;

  // Filled by Prepare.
  ProgramVector tangent_from, tangent_to, tangent_via;  // zero when there is no motion
  bool is_arc = false;
  ProgramVector centre;
  ProgramVector axis;  // the arc runs counter-clockwise about it
  double radius = 0.0;
};
void Prepare(Leg& leg);
// Share of a prepared leg's length that lies before its via point.
double ShareAtVia(const Leg& leg);

// Side of the path at a point: u x d, to the left of the cut; zero when d is zero or along u.
// OPT-8.15
ProgramVector LeftNormal(const ProgramVector& tool, const ProgramVector& tangent);

// Where a hole ends: the point of its circle nearest to `from`, for the axis from `centre` to
// `beside` (OPT-2.23, OPT-B.10). Nothing without an axis, or on it.
std::optional<ProgramVector> HoleEnd(const ProgramVector& from, const ProgramVector& centre,
                                     const ProgramVector& beside, double radius);

struct OffsetLeg {
  ProgramVector to;
  std::optional<ProgramVector> via;
};

// Offsets a chain of legs by `offset`, positive to the left; the first leg starts at its programmed
// point (OPT-8.17). Errors: CompArc 7806, CompCorner 7808; `failed` tells the leg.
Result<std::vector<OffsetLeg>> OffsetChain(const std::vector<Leg>& legs, double offset,
                                           std::size_t& failed);

}  // namespace rmlcell::optimo
