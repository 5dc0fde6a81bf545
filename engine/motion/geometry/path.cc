#include "engine/motion/geometry/path.h"

#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/geometry/blend_curve.h"

namespace rmlcell::motion {
namespace {

constexpr double kCollinear_mm = kArcPointTolerance_mm;

}  // namespace

PathPiece PathPiece::Line(const TipPose& from, const TipPose& to) {
  PathPiece piece;  // a line of no length
  piece.from_ = from;
  piece.to_ = to;
  const double distance = (from.tip - to.tip).norm();
  if (distance > kTipLengthZero_mm) {
    piece.length_ = distance;
    piece.tangent_ = (to.tip - from.tip) * (1.0 / distance);
  } else if (from.a_rad != to.a_rad || from.b_rad != to.b_rad) {
    piece.kind_ = Kind::kRotary;
    piece.length_ = 1.0;
  } else if (std::isnan(distance)) {
    piece.length_ = distance;  // keep it visible
  }
  return piece;
}

PathPiece PathPiece::Joint(const AxisPose& from, const AxisPose& to) {
  PathPiece piece;
  piece.kind_ = Kind::kJoint;
  piece.from_ = from;
  piece.to_ = to;
  piece.length_ = from == to ? 0.0 : 1.0;
  return piece;
}

Result<PathPiece::Arc3> PathPiece::ArcThrough(const TipPose& from, const MachinePoint& via,
                                              const TipPose& to) {
  const MachineVector a = via - from.tip;
  const MachineVector b = to.tip - from.tip;
  const double chord = b.norm();
  const double to_via = a.norm();
  if (!std::isfinite(chord) || !std::isfinite(to_via)) {
    return Error{ErrorCode::kCellArcUndefined, "a coordinate is not a number", {}};
  }
  if (chord <= kArcPointTolerance_mm) {
    if (to_via > kArcPointTolerance_mm) {
      return Error{ErrorCode::kCellArcUndefined, "the arc ends where it begins", {}};
    }
    return Arc3{ArcCase::kNoTipMotion, Line(from, to)};
  }
  if (to_via <= kArcPointTolerance_mm || (via - to.tip).norm() <= kArcPointTolerance_mm) {
    return Arc3{ArcCase::kLineWarned, Line(from, to)};
  }
  // In the plane of the three points, with the chord as abscissa: the via point lies at (along,
  // -height) and the centre at (chord / 2, rise). Both ends are equally far from it by
  // construction, so the arc ends at the target however large the radius; motion.md 3.2 gives the
  // same circle.
  const MachineVector chord_unit = b * (1.0 / chord);
  const double along = a.dot(chord_unit);
  const MachineVector offset = a - chord_unit * along;
  const double height = offset.norm();
  if (height <= kCollinear_mm) {
    if (along > 0.0 && along < chord) return Arc3{ArcCase::kLineWarned, Line(from, to)};
    return Error{ErrorCode::kCellArcUndefined,
                 "the via point is on the line through start and target, outside them",
                 {}};
  }
  const MachineVector up = offset * (-1.0 / height);
  const double rise = (along * (chord - along) - height * height) / (2.0 * height);
  const double radius = std::hypot(0.5 * chord, rise);
  const double sine = 0.5 * chord / radius;  // of half the sweep
  const double cosine = rise / radius;

  Arc3 arc{ArcCase::kArc, {}};
  PathPiece& piece = arc.path;
  piece.kind_ = Kind::kArc;
  piece.from_ = from;
  piece.to_ = to;
  piece.tangent_ = chord_unit * cosine - up * sine;
  const ArcShape shape{.centre = from.tip + chord_unit * (0.5 * chord) + up * rise,
                       .normal = chord_unit.cross(up),
                       .inward = chord_unit * sine + up * cosine,
                       .radius_mm = radius,
                       .sweep_rad = 2.0 * std::atan2(0.5 * chord, rise)};
  piece.length_ = radius * shape.sweep_rad;
  piece.shape_ = shape;
  return arc;
}

PathPiece PathPiece::Circle(const TipPose& from, const MachinePoint& centre,
                            const MachineVector& normal, double sweep_rad, double a_to_rad,
                            double b_to_rad) {
  const MachineVector inward = centre - from.tip;
  const double radius = inward.norm();
  const ArcShape shape{.centre = centre,
                       .normal = normal,
                       .inward = inward * (1.0 / radius),
                       .radius_mm = radius,
                       .sweep_rad = sweep_rad};
  PathPiece piece;
  piece.kind_ = Kind::kArc;
  piece.length_ = radius * sweep_rad;
  piece.from_ = from;
  piece.to_ = {from.tip, a_to_rad, b_to_rad};
  piece.tangent_ = shape.inward.cross(normal);
  piece.shape_ = shape;
  if (sweep_rad != kTurn) piece.to_.point = piece.ArcPoint(sweep_rad);
  return piece;
}

PathPiece PathPiece::StraightFrom(const PathPose& place) const {
  return in_axes() ? Joint(place.axes(), to_.axes()) : Line(place.tip(), to_.tip());
}

PathPiece PathPiece::Part(double s_from, double s_to) const {
  PathPiece part;
  part.AssignPart(*this, s_from, s_to);
  return part;
}

void PathPiece::AssignPartOffLine(const PathPiece& whole, double s_from, double s_to) {
  kind_ = whole.kind_;
  length_ = s_to - s_from;
  from_ = whole.At(s_from);
  to_ = whole.At(s_to);
  tangent_ = whole.tangent_;
  if (kind_ == Kind::kArc) {
    shape_ = whole.shape_;
    ArcShape& part = *std::get_if<ArcShape>(&shape_);
    tangent_ = whole.Tangent(s_from);
    part.inward = whole.Curvature(s_from) * part.radius_mm;
    part.sweep_rad = length_ / part.radius_mm;
  } else if (kind_ == Kind::kBlend) {
    AssignShape(whole);
    if (auto* plain = std::get_if<PlainPart>(&shape_)) {
      plain->start += s_from;
    } else {
      std::get_if<CurvePart>(&shape_)->start += s_from;
    }
  }
}

double PathPiece::tip_length_mm() const { return by_sigma() ? 0.0 : length_; }

MachineVector PathPiece::ArcPoint(double angle) const {
  // From the start point, not from the centre: a radius of 1e8 mm then costs no digits.
  const double half_sine = std::sin(0.5 * angle);
  const double radius = arc().radius_mm;
  return from_.point + tangent_ * (radius * std::sin(angle)) +
         arc().inward * (radius * 2.0 * half_sine * half_sine);
}

PathPose PathPiece::OffLine(double s) const {
  if (!(s > 0.0)) return from_;
  if (s >= length_) return to_;
  if (kind_ == Kind::kBlend) {
    const BlendCurve blend(*this);
    return blend.curve().At(blend.ParameterAt(s));
  }
  PathPose pose = OnLine(s);
  if (kind_ == Kind::kArc) pose.point = ArcPoint(s / radius_mm());
  return pose;
}

PathDerivatives PathPiece::FirstOffLine(double s) const {
  if (kind_ == Kind::kBlend) {
    const BlendCurve blend(*this);
    return blend.curve().FirstByLength(blend.ParameterAt(s));
  }
  MachinePoint tip = length_ > 0.0 ? (to_.point - from_.point) * (1.0 / length_) : MachineVector{};
  if (kind_ == Kind::kArc) {
    const double angle = s / radius_mm();
    tip = tangent_ * std::cos(angle) + arc().inward * std::sin(angle);
  }
  return {tip, a_rate(), b_rate()};
}

PathDerivatives PathPiece::Second(double s) const {
  if (kind_ == Kind::kBlend) {
    const BlendCurve blend(*this);
    return blend.curve().SecondByLength(blend.ParameterAt(s));
  }
  if (kind_ != Kind::kArc) return {};
  const double angle = s / radius_mm();
  return {(arc().inward * std::cos(angle) - tangent_ * std::sin(angle)) * (1.0 / radius_mm()), 0.0,
          0.0};
}

PathPiece::OnArc PathPiece::ArcAt(double s) const {
  const double angle = s / radius_mm();
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const MachineVector& inward = arc().inward;
  const PathPose pose = OnLine(s);
  return {.a_rad = pose.a_rad,
          .b_rad = pose.b_rad,
          .first = {tangent_ * cosine + inward * sine, a_rate(), b_rate()},
          .second = {(inward * cosine - tangent_ * sine) * (1.0 / radius_mm()), 0.0, 0.0}};
}

}  // namespace rmlcell::motion
