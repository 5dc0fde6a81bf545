#include "engine/optimo/offline/gouge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/optimo/offline/segment_grid.h"

namespace rmlcell::optimo {
namespace {

constexpr double kSameTool = 1.0 - 1e-9;  // cosine
constexpr double kChordError_mm = 0.0005;
constexpr double kChordMin_rad = 0.001;  // a circle has at most some six thousand chords
// Where the head turns, OPT-8.15 takes the offset at both ends of a move across the head as it
// stands there: between them the path comes a little nearer.
constexpr double kTurningShare = 0.02;  // of the radius
// A contour "comes back to itself": within the rounding of three decimals and an arc's end.
constexpr double kTouching_mm = 0.005;
constexpr double kTabMax_mm = 2.0;
// Bound memory, and the time spent on a contour that lies above itself: about a second.
constexpr std::size_t kSegmentsMax = 1'000'000;
constexpr std::size_t kLookupsMax = 50'000'000;

double SweepOf(const Leg& arc) {
  const ProgramVector e = (arc.from - arc.centre) * (1.0 / arc.radius), f = arc.axis.cross(e);
  const ProgramVector end = arc.to - arc.centre;
  const double angle = std::atan2(end.dot(f), end.dot(e));
  return angle > 0.0 ? angle : angle + 2.0 * std::numbers::pi;
}

// Paths as segments: across the head while it keeps its direction, else in space.
class Drawing {
 public:
  explicit Drawing(const std::vector<Leg>& legs) : along_(legs.front().tool_from) {
    for (const Leg& leg : legs) {
      flat_ = flat_ && leg.tool_to.dot(along_) > kSameTool &&
              (!leg.via || leg.tool_via.dot(along_) > kSameTool);
    }
  }
  bool flat() const { return flat_; }
  ProgramVector Flat(const ProgramVector& p) const {
    return flat_ ? p - along_ * p.dot(along_) : p;
  }

  void Add(const Leg& leg, std::size_t index, std::vector<PathSegment>& to) const {
    if (!leg.is_arc) {
      to.push_back({Flat(leg.from), Flat(leg.to), index});
      return;
    }
    const ProgramVector e = (leg.from - leg.centre) * (1.0 / leg.radius), f = leg.axis.cross(e);
    const double sweep = SweepOf(leg);
    const double chord =
        std::max(kChordMin_rad, std::min(2.0 * std::sqrt(2.0 * kChordError_mm / leg.radius), 0.5));
    const int chords = static_cast<int>(std::ceil(sweep / chord));
    ProgramVector before = Flat(leg.from);
    for (int c = 1; c <= chords; ++c) {
      const double at = sweep * c / chords;
      const ProgramVector point =
          c == chords ? Flat(leg.to)
                      : Flat(leg.centre + (e * std::cos(at) + f * std::sin(at)) * leg.radius);
      to.push_back({before, point, index});
      before = point;
    }
  }

 private:
  ProgramVector along_;
  bool flat_ = true;
};

// The segments that are edges of the part, and whether the beam starts on one of them.
struct Edges {
  std::vector<PathSegment> segments;
  bool start = true;
};

// Where the contour comes back to itself: a place on its segment `first`, and on `last`.
struct Closing {
  std::size_t first = 0, last = 0;
  double on_first = 0.0, on_last = 0.0;
};

std::optional<Closing> FindClosing(const std::vector<PathSegment>& contour, std::size_t legs) {
  std::vector<PathSegment> lead;
  for (const PathSegment& segment : contour) {
    if (segment.leg >= kLeadLegs) break;
    lead.push_back(segment);
  }
  const SegmentGrid grid(lead, kTouching_mm);
  std::size_t at = contour.size();
  while (at > 0 && contour[at - 1].leg + kLeadLegs >= legs) --at;
  std::size_t lookups = kLookupsMax;
  for (; at < contour.size(); ++at) {
    std::optional<Closing> closing;
    grid.ForEachNear(contour[at], lookups, [&](std::uint32_t index) {
      if (lead[index].leg + 2 > contour[at].leg || (closing && closing->first <= index)) return;
      const NearestPoints touch = NearestPointsOf(lead[index], contour[at]);
      if (touch.distance <= kTouching_mm) closing = {index, at, touch.on_a, touch.on_b};
    });
    if (closing) return closing;
  }
  // A tab: it would come to the end of a move, had it gone on.
  const PathSegment& last = contour.back();
  const double length = (last.from - last.to).norm();
  if (length < kTouching_mm) return std::nullopt;
  const PathSegment tab{last.to, last.to + (last.to - last.from) * (kTabMax_mm / length)};
  for (std::size_t i = 0; i < lead.size() && lead[i].leg + 2 <= last.leg; ++i) {
    const PathSegment corner{lead[i].to, lead[i].to};
    const bool ends_move = i + 1 == lead.size() || lead[i + 1].leg != lead[i].leg;
    if (ends_move && NearestPointsOf(corner, tab).distance <= kTouching_mm)
      return Closing{i, contour.size() - 1, 1.0, 1.0};
  }
  return std::nullopt;
}

Edges WithoutLeads(std::vector<PathSegment> contour, std::size_t legs) {
  const std::optional<Closing> closing = FindClosing(contour, legs);
  if (!closing) return {std::move(contour), true};
  Edges edges;
  edges.segments.assign(contour.begin() + static_cast<std::ptrdiff_t>(closing->first),
                        contour.begin() + static_cast<std::ptrdiff_t>(closing->last) + 1);
  PathSegment& first = edges.segments.front();
  PathSegment& last = edges.segments.back();
  first.from = first.from + (first.to - first.from) * closing->on_first;
  last.to = last.from + (last.to - last.from) * closing->on_last;
  edges.start = (first.from - contour.front().from).norm() <= kTouching_mm;
  return edges;
}

// Calls `use` for the parts of a segment that lie outside the ball.
template <class Use>
void OutsideOfBall(const PathSegment& s, const ProgramVector& centre, double radius,
                   const Use& use) {
  const ProgramVector along = s.to - s.from, from = s.from - centre;
  const double a = along.dot(along), b = along.dot(from), c = from.dot(from) - radius * radius;
  const double root2 = b * b - a * c;
  if (a <= 0.0 || root2 <= 0.0) {
    if (c > 0.0) use(s);
    return;
  }
  const double enters = (-b - std::sqrt(root2)) / a, leaves = (-b + std::sqrt(root2)) / a;
  if (enters >= 1.0 || leaves <= 0.0) return use(s);
  if (enters > 0.0) use(PathSegment{s.from, s.from + along * enters, s.leg});
  if (leaves < 1.0) use(PathSegment{s.from + along * leaves, s.to, s.leg});
}

// The move leads the other way than the programmed one; of an arc, the long way round.
bool RunsBack(const Leg& leg, const Leg& moved) {
  if (leg.is_arc && moved.is_arc) return SweepOf(moved) > SweepOf(leg) + std::numbers::pi;
  if (leg.is_arc) return false;
  return (moved.to - moved.from).dot(leg.tangent_from) < -kGougeTolerance_mm;
}

}  // namespace

GougeSearch FindGouges(const std::vector<Leg>& legs, const std::vector<OffsetLeg>& offset_legs,
                       double offset) {
  GougeSearch search;
  const double radius = std::fabs(offset);
  if (legs.empty()) return search;
  const Drawing drawing(legs);
  const double allowed =
      radius - kGougeTolerance_mm - (drawing.flat() ? 0.0 : kTurningShare * radius);
  if (allowed <= 0.0) return search;

  std::vector<PathSegment> contour, path;
  std::vector<bool> runs_back(legs.size());
  ProgramVector at = legs.front().from;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (contour.size() + path.size() > kSegmentsMax) {
      search.unchecked_from = k;
      break;
    }
    drawing.Add(legs[k], k, contour);
    Leg moved = legs[k];
    moved.from = at;
    moved.to = offset_legs[k].to;
    moved.via = offset_legs[k].via;
    Prepare(moved);
    drawing.Add(moved, k, path);
    runs_back[k] = k > 0 && RunsBack(legs[k], moved);
    at = moved.to;
  }
  const ProgramVector start = drawing.Flat(legs.front().from);
  const Edges edges = WithoutLeads(std::move(contour), legs.size());
  const SegmentGrid grid(edges.segments, radius);

  std::vector<double> nearest(legs.size(), allowed);
  std::size_t lookups = kLookupsMax;
  bool whole = true;
  const auto look = [&](const PathSegment& piece) {
    const bool all = grid.ForEachNear(piece, lookups, [&](std::uint32_t index) {
      const PathSegment& edge = edges.segments[index];
      const auto [before, behind] = std::minmax(edge.leg, piece.leg);
      const std::size_t apart = behind - before;
      if (apart == 0) return;  // at the radius by construction
      // Two lines with a corner come too near only where one runs back, or at the pierce point.
      if (apart == 1 && !legs[piece.leg].is_arc && !legs[edge.leg].is_arc) {
        if (piece.leg > 0 || edges.start) return;
        nearest[0] = std::min(nearest[0], NearestPointsOf({start, start}, edge).distance);
        return;
      }
      nearest[piece.leg] = std::min(nearest[piece.leg], NearestPointsOf(piece, edge).distance);
    });
    whole = whole && all;
  };
  for (const PathSegment& piece : path) {
    if (edges.start) {
      OutsideOfBall(piece, start, 2.0 * radius, look);
    } else {
      look(piece);
    }
    if (!whole) {
      search.unchecked_from = std::min(piece.leg, search.unchecked_from.value_or(piece.leg));
      break;
    }
  }
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (nearest[k] < allowed) {
      search.found.push_back({k, Gouge::Kind::kTooNear, nearest[k]});
    } else if (runs_back[k]) {
      search.found.push_back({k, Gouge::Kind::kRunsBack, 0.0});
    }
  }
  return search;
}

}  // namespace rmlcell::optimo
