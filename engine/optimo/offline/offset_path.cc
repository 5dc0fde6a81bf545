#include "engine/optimo/offline/offset_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace rmlcell::optimo {
namespace {

constexpr double kTiny = 1e-9;           // lengths and sines that count as zero
constexpr double kTurnsBack = -0.99;     // n1 . n2, OPT-8.19
constexpr double kTangent = 1.0 - 1e-9;  // n1 . n2 of a joint without a corner
constexpr double kNoRadius = 5e-6;       // half of the last decimal written (OPT-8.11)
constexpr double kInPlane = 1.0 - 1e-6;  // cosine between the axis of an arc and the tool

ProgramVector Normalised(const ProgramVector& v) {
  const double norm = v.norm();
  return norm < kTiny ? ProgramVector{} : v * (1.0 / norm);
}
bool IsZero(const ProgramVector& v) { return v == ProgramVector{}; }

using PlaneVector = Eigen::Vector2d;  // in the plane normal to the tool, from the corner

// A leg's offset curve in that plane.
struct PlaneCurve {
  bool circle = false;
  PlaneVector at;         // a point of the line, or the centre
  PlaneVector direction;  // of the line
  double radius = 0.0;
};

// One of the points where both curves meet, the nearest to the origin; nothing when they do not.
// Precondition: one of them is a circle.
std::optional<PlaneVector> NearestMeeting(const PlaneCurve& a, const PlaneCurve& b) {
  PlaneVector middle, to_either;
  if (a.circle != b.circle) {
    const PlaneCurve& line = a.circle ? b : a;
    const PlaneCurve& circle = a.circle ? a : b;
    middle = line.at + line.direction * (circle.at - line.at).dot(line.direction);
    const double half2 = circle.radius * circle.radius - (middle - circle.at).squaredNorm();
    if (half2 < 0.0) return std::nullopt;
    to_either = line.direction * std::sqrt(half2);
  } else {
    const PlaneVector between = b.at - a.at;
    const double distance = motion::LengthOf(between);
    if (distance < kTiny) return std::nullopt;
    const double along =
        (distance * distance + a.radius * a.radius - b.radius * b.radius) / (2.0 * distance);
    const double half2 = a.radius * a.radius - along * along;
    if (half2 < 0.0) return std::nullopt;
    const PlaneVector towards = between / distance;
    middle = a.at + towards * along;
    to_either = PlaneVector(-towards.y(), towards.x()) * std::sqrt(half2);
  }
  const std::array<PlaneVector, 2> points = {middle + to_either, middle - to_either};
  return *std::ranges::min_element(points, {}, motion::LengthOf);
}

// Towards the centre: the offset makes the arc smaller.
double OffsetRadius(const Leg& arc, const ProgramVector& at, const ProgramVector& normal,
                    double offset) {
  const ProgramVector inward = Normalised(arc.centre - at);
  return arc.radius - offset * normal.dot(inward);
}

// The plane about a corner.
struct CornerPlane {
  ProgramVector corner, ex, ey;
  PlaneVector Of(const ProgramVector& v) const { return {v.dot(ex), v.dot(ey)}; }
};

PlaneCurve CurveOf(const Leg& leg, const CornerPlane& plane, const ProgramVector& tangent,
                   const ProgramVector& normal, double offset) {
  if (leg.is_arc) {
    return {.circle = true,
            .at = plane.Of(leg.centre - plane.corner),
            .direction = {},
            .radius = OffsetRadius(leg, plane.corner, normal, offset)};
  }
  return {.at = plane.Of(normal * offset), .direction = plane.Of(tangent)};
}

bool InPlane(const Leg& leg, const ProgramVector& tangent, const ProgramVector& tool) {
  if (leg.is_arc) return std::fabs(leg.axis.dot(tool)) > kInPlane;
  return std::fabs(tangent.dot(tool)) < 1e-6;
}

// The new place of the corner between two legs. OPT-8.16, OPT-8.79, OPT-B.79
std::optional<ProgramVector> Corner(const Leg& before, const Leg& after, double offset) {
  const ProgramVector& tool = before.tool_to;
  ProgramVector n1 = LeftNormal(tool, before.tangent_to),
                n2 = LeftNormal(after.tool_from, after.tangent_from);
  if (IsZero(n1)) n1 = n2;
  if (IsZero(n2)) n2 = n1;
  if (IsZero(n1)) return before.to;
  const double cosine = n1.dot(n2);
  if (cosine < kTurnsBack) return std::nullopt;
  const bool arc = before.is_arc || after.is_arc;
  if (arc && cosine < kTangent && InPlane(before, before.tangent_to, tool) &&
      InPlane(after, after.tangent_from, tool)) {
    const ProgramVector ahead = Normalised(before.tangent_to);
    const CornerPlane plane{.corner = before.to, .ex = ahead, .ey = tool.cross(ahead)};
    const auto meeting = NearestMeeting(CurveOf(before, plane, before.tangent_to, n1, offset),
                                        CurveOf(after, plane, after.tangent_from, n2, offset));
    if (!meeting) return std::nullopt;
    return before.to + plane.ex * meeting->x() + plane.ey * meeting->y();
  }
  return before.to + (n1 + n2) * (offset / (1.0 + cosine));
}

bool ArcIsConsumed(const Leg& leg, double offset) {
  if (!leg.is_arc) return false;
  const auto consumed = [&](const ProgramVector& at, const ProgramVector& tool,
                            const ProgramVector& tangent) {
    return OffsetRadius(leg, at, LeftNormal(tool, tangent), offset) <= kNoRadius;
  };
  return consumed(leg.from, leg.tool_from, leg.tangent_from) ||
         consumed(leg.to, leg.tool_to, leg.tangent_to);
}

}  // namespace

ProgramVector LeftNormal(const ProgramVector& tool, const ProgramVector& tangent) {
  const ProgramVector side = tool.cross(tangent);
  return side.norm() < 1e-6 ? ProgramVector{} : Normalised(side);
}

void Prepare(Leg& leg) {
  leg.is_arc = false;
  if (leg.via) {
    // Centre of the circle through three points, from the first one.
    const ProgramVector p = *leg.via - leg.from, q = leg.to - leg.from;
    const ProgramVector normal = p.cross(q);
    const double area2 = normal.dot(normal);
    if (std::sqrt(area2) > kTiny * (1.0 + p.norm() * q.norm())) {
      const ProgramVector to_centre = normal.cross(p * q.dot(q) - q * p.dot(p)) * (0.5 / area2);
      leg.is_arc = true;
      leg.centre = leg.from + to_centre;
      leg.axis = Normalised(normal);
      leg.radius = to_centre.norm();
      const auto tangent = [&](const ProgramVector& at) {
        return Normalised(leg.axis.cross(at - leg.centre));
      };
      leg.tangent_from = tangent(leg.from);
      leg.tangent_via = tangent(*leg.via);
      leg.tangent_to = tangent(leg.to);
      return;
    }
  }
  leg.tangent_from = leg.tangent_to = leg.tangent_via = Normalised(leg.to - leg.from);
}

double ShareAtVia(const Leg& leg) {
  if (!leg.is_arc) return 0.5;
  const ProgramVector e = Normalised(leg.from - leg.centre), f = leg.axis.cross(e);
  const auto angle = [&](const ProgramVector& at) {
    const double turned = std::atan2((at - leg.centre).dot(f), (at - leg.centre).dot(e));
    return turned > 0.0 ? turned : turned + 2.0 * std::numbers::pi;
  };
  return angle(*leg.via) / angle(leg.to);
}

std::optional<ProgramVector> HoleEnd(const ProgramVector& from, const ProgramVector& centre,
                                     const ProgramVector& beside, double radius) {
  const ProgramVector axis = Normalised(beside - centre);
  const ProgramVector out = from - centre;
  const ProgramVector towards = Normalised(out - axis * out.dot(axis));
  if (IsZero(axis) || IsZero(towards)) return std::nullopt;
  return centre + towards * radius;
}

Result<std::vector<OffsetLeg>> OffsetChain(const std::vector<Leg>& legs, double offset,
                                           std::size_t& failed) {
  std::vector<OffsetLeg> result;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    const Leg& leg = legs[k];
    failed = k;
    if (ArcIsConsumed(leg, offset)) {
      return Error{ErrorCode::kCompArc,
                   "the arc of radius " +
                       Told("radius", leg.radius, "mm", std::to_string(leg.radius)) +
                       " is not larger than the offset",
                   {}};
    }
    OffsetLeg moved;
    if (k + 1 < legs.size()) {
      const std::optional<ProgramVector> corner = Corner(leg, legs[k + 1], offset);
      if (!corner)
        return Error{
            ErrorCode::kCompCorner, "the path turns back, or the offset curves do not meet", {}};
      moved.to = *corner;
    } else {
      moved.to = leg.to + LeftNormal(leg.tool_to, leg.tangent_to) * offset;
    }
    if (leg.via) moved.via = *leg.via + LeftNormal(leg.tool_via, leg.tangent_via) * offset;
    result.push_back(moved);
  }
  return result;
}

}  // namespace rmlcell::optimo
