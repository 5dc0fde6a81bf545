#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optimo/offline/offset_path.h"

namespace rmlcell::optimo {
namespace {

constexpr double kSameTool = 1.0 - 1e-6;                      // cosine
constexpr double kStep_rad = 5.0 * std::numbers::pi / 180.0;  // arcs as chords of this angle
constexpr double kTouch = 1e-9;                               // end points that touch do not cross
// Bounds memory, and the work on contours whose pieces all lie above each other: about a second.
constexpr std::size_t kSegmentsMax = 1'000'000;
constexpr std::size_t kPairsMax = 100'000'000;

struct Segment {
  double x1, y1, x2, y2;
  std::size_t leg;
  bool programmed;
  double min_x() const { return std::min(x1, x2); }
  double max_x() const { return std::max(x1, x2); }
};

class Plane {
 public:
  explicit Plane(const Vec3& tool) {
    const Vec3 other = std::fabs(tool.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    ex_ = motion::Cross(other, tool);
    ex_ = ex_ * (1.0 / motion::Norm(ex_));
    ey_ = motion::Cross(tool, ex_);
  }

  void Add(Leg leg, std::size_t index, bool programmed, std::vector<Segment>& to) const {
    Prepare(leg);
    const auto line = [&](const Vec3& a, const Vec3& b) {
      to.push_back({motion::Dot(a, ex_), motion::Dot(a, ey_), motion::Dot(b, ex_),
                    motion::Dot(b, ey_), index, programmed});
    };
    if (!leg.is_arc) return line(leg.from, leg.to);
    const Vec3 e = (leg.from - leg.centre) * (1.0 / leg.radius), f = motion::Cross(leg.axis, e);
    const Vec3 end = leg.to - leg.centre;
    double angle = std::atan2(motion::Dot(end, f), motion::Dot(end, e));
    if (angle <= 0.0) angle += 2.0 * std::numbers::pi;
    const int steps = std::max(1, static_cast<int>(std::ceil(angle / kStep_rad)));
    Vec3 before = leg.from;
    for (int s = 1; s <= steps; ++s) {
      const double at = angle * s / steps;
      const Vec3 point = leg.centre + (e * std::cos(at) + f * std::sin(at)) * leg.radius;
      line(before, point);
      before = point;
    }
  }

  double x(const Vec3& p) const { return motion::Dot(p, ex_); }
  double y(const Vec3& p) const { return motion::Dot(p, ey_); }

 private:
  Vec3 ex_, ey_;
};

// Where two segments cross inside both; nothing when they only touch.
std::optional<std::pair<double, double>> CrossingPoint(const Segment& a, const Segment& b) {
  const double ax = a.x2 - a.x1, ay = a.y2 - a.y1, bx = b.x2 - b.x1, by = b.y2 - b.y1;
  const double cross = ax * by - ay * bx;
  if (std::fabs(cross) < kTouch) return std::nullopt;
  const double t = ((b.x1 - a.x1) * by - (b.y1 - a.y1) * bx) / cross;
  const double s = ((b.x1 - a.x1) * ay - (b.y1 - a.y1) * ax) / cross;
  if (t <= kTouch || t >= 1.0 - kTouch || s <= kTouch || s >= 1.0 - kTouch) return std::nullopt;
  return std::pair(a.x1 + t * ax, a.y1 + t * ay);
}

}  // namespace

Crossings FindCrossings(const std::vector<Leg>& legs, const std::vector<OffsetLeg>& offset_legs,
                        double offset) {
  Crossings crossings;
  if (legs.empty()) return crossings;
  const Vec3 tool = legs.front().tool_from;
  for (const Leg& leg : legs) {
    if (motion::Dot(leg.tool_to, tool) < kSameTool) return crossings;
  }
  const Plane plane(tool);
  std::vector<Segment> segments;
  Vec3 at = legs.front().from;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (segments.size() >= kSegmentsMax) {
      crossings.complete = false;
      break;
    }
    plane.Add(legs[k], k, true, segments);
    Leg moved = legs[k];
    moved.from = at;
    moved.to = offset_legs[k].to;
    moved.via = offset_legs[k].via;
    plane.Add(moved, k, false, segments);
    at = moved.to;
  }
  // A sweep from left to right: each segment meets those that overlap it in x.
  std::ranges::sort(segments, {}, &Segment::min_x);
  const double px = plane.x(legs.front().from), py = plane.y(legs.front().from);
  const double lead_in = 2.0 * std::fabs(offset) + kTouch;
  std::vector<std::optional<bool>> found(legs.size());
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < segments.size() && crossings.complete; ++i) {
    for (std::size_t j = i + 1; j < segments.size() && segments[j].min_x() <= segments[i].max_x();
         ++j) {
      if (++pairs > kPairsMax) {
        crossings.complete = false;
        break;
      }
      const Segment& a = segments[i];
      const Segment& b = segments[j];
      if (a.programmed && b.programmed) continue;
      const bool itself = !a.programmed && !b.programmed;
      const std::size_t apart = a.leg > b.leg ? a.leg - b.leg : b.leg - a.leg;
      if (itself && apart <= 1) continue;
      const auto point = CrossingPoint(a, b);
      if (!point || std::hypot(point->first - px, point->second - py) <= lead_in) continue;
      const std::size_t leg = itself ? std::max(a.leg, b.leg) : a.programmed ? b.leg : a.leg;
      if (leg == 0 && !itself) continue;  // from the pierce point on the contour to its offset
      if (!found[leg]) found[leg] = itself;
    }
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k]) crossings.found.push_back({k, *found[k]});
  }
  return crossings;
}

}  // namespace rmlcell::optimo
