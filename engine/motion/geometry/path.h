#pragma once

#include <variant>

#include "engine/core/check.h"
#include "engine/core/result.h"
#include "engine/motion/geometry/corner_curve.h"
#include "engine/motion/geometry/pose.h"

namespace rmlcell::motion {

// Tolerances of motion.md section 1, used everywhere and nowhere else.
inline constexpr double kTipLengthZero_mm = 1e-6;
inline constexpr double kArcPointTolerance_mm = 1e-4;

// One piece of path. A value: copy it freely, it owns nothing; a line, the most frequent kind,
// copies a third of what a blend does. motion.md section 3. s runs from 0 to length(): mm of the
// tip's way, but for kRotary the path variable sigma from 0 to 1, and for kJoint sigma until
// MeasureBy makes it another even measure. Rotary axes are linear in s and never reduced by a turn.
class PathPiece {
 public:
  enum class Kind {
    kLine,    // straight tip path
    kArc,     // circle through space
    kRotary,  // the tip stands, A or B turn; s is sigma
    kJoint,   // straight in the five axes of COORD ROBOT; s is sigma, poses hold the column
    kBlend,   // quintic corner of a /FLY passage, of the tip or in_axes()
  };

  PathPiece() = default;
  PathPiece(const PathPiece& other) { *this = other; }
  PathPiece& operator=(const PathPiece& other);  // only what the kind uses

  // kRotary when the tip does not move but an angle does; length 0 when nothing changes.
  static PathPiece Line(const TipPose& from, const TipPose& to);

  // Straight in the five axes.
  static PathPiece Joint(const AxisPose& from, const AxisPose& to);

  // Pieces in_axes(): s shall run from 0 to this.
  void MeasureBy(double length) {
    if (auto* part = kind_ == Kind::kBlend ? std::get_if<CurvePart>(&shape_) : nullptr) {
      part->start *= length / length_;
      part->curve.MeasureBy(length / length_);
    }
    length_ = length;
  }

  // How three points make a path; motion.md 3.2.
  enum class ArcCase { kArc, kLine, kLineWarned, kNoTipMotion };
  struct Arc3;
  // Errors: CellArcUndefined when no single circle goes through the three points.
  static Result<Arc3> ArcThrough(const TipPose& from, const MachinePoint& via, const TipPose& to);

  // A turn of `sweep_rad` about `normal` (unit) through `from`; right-handed, sweep above 0.
  // `centre` is the foot of `from` on the axis; a sweep of one turn ends exactly where it began.
  static PathPiece Circle(const TipPose& from, const MachinePoint& centre,
                          const MachineVector& normal, double sweep_rad, double a_to_rad,
                          double b_to_rad);

  // To stand at the place `s`: length 0.
  PathPiece Standing(double s) const {
    const PathPose pose = At(s);
    return in_axes() ? Joint(pose.axes(), pose.axes()) : Line(pose.tip(), pose.tip());
  }

  // The straight way from another place of such a path to the end of this one.
  PathPiece StraightFrom(const PathPose& place) const;

  // The piece between two values of s, 0 <= s_from < s_to <= length(). Not for sigma pieces.
  PathPiece Part(double s_from, double s_to) const;

  // Makes this piece that part of `whole`, which must be another one: Part without the copies.
  void AssignPart(const PathPiece& whole, double s_from, double s_to) {
    if (whole.kind_ != Kind::kLine) return AssignPartOffLine(whole, s_from, s_to);
    kind_ = Kind::kLine;
    length_ = s_to - s_from;
    from_ = whole.OnLine(s_from);
    to_ = whole.OnLine(s_to);
    tangent_ = whole.tangent_;
  }

  Kind kind() const { return kind_; }
  double length() const { return length_; }  // of s; 0: nothing to do
  double tip_length_mm() const;              // 0 for kRotary; in_axes() not known here, 0
  // Poses hold the column, and s says nothing of the tip's way: COORD ROBOT.
  bool in_axes() const {
    if (kind_ == Kind::kJoint) return true;
    const auto* part = kind_ == Kind::kBlend ? std::get_if<CurvePart>(&shape_) : nullptr;
    return part != nullptr && part->curve.in_axes();
  }
  bool by_sigma() const { return kind_ == Kind::kRotary || in_axes(); }  // s is no way of the tip
  double a_rate() const {  // rad per unit of s; kBlend: mean
    return RateOf(from_.a_rad, to_.a_rad);
  }
  double b_rate() const { return RateOf(from_.b_rad, to_.b_rad); }
  const PathPose& from() const { return from_; }
  const PathPose& to() const { return to_; }

  // What a place of this path is. Preconditions, checked: not in_axes(); in_axes().
  TipPose TipOf(const PathPose& place) const {
    RMLCELL_CHECK(!in_axes());
    return place.tip();
  }
  AxisPose AxesOf(const PathPose& place) const {
    RMLCELL_CHECK(in_axes());
    return place.axes();
  }
  TipPose TipAt(double s) const { return TipOf(At(s)); }
  TipPose tip_from() const { return TipOf(from_); }
  TipPose tip_to() const { return TipOf(to_); }
  AxisPose axes_from() const { return AxesOf(from_); }
  AxisPose axes_to() const { return AxesOf(to_); }

  // Makes this piece the half of a corner curve: its arc length, and the poses at its ends. `start`
  // is the arc length of the curve before it.
  void AssignCorner(const CornerCurve& curve, double start, double length, const PathPose& from,
                    const PathPose& to) {
    AssignBlend(length, from, to);
    auto* part = std::get_if<CurvePart>(&shape_);
    if (part == nullptr) part = &shape_.emplace<CurvePart>();
    part->start = start;
    part->curve = curve;
  }
  void AssignCorner(const PlainCorner& corner, double start, double length, const PathPose& from,
                    const PathPose& to) {  // `length` is half of the whole
    AssignBlend(length, from, to);
    auto* part = std::get_if<PlainPart>(&shape_);
    if (part == nullptr) part = &shape_.emplace<PlainPart>();
    part->start = start;
    part->total = 2.0 * length;
    part->corner = corner;
  }

  // Blends only: the corner when it is that of two lines passed with a steady head, and the length
  // of its curve; else null.
  struct PlainPart;
  const PlainPart* plain_corner() const { return std::get_if<PlainPart>(&shape_); }
  struct PlainPart {
    double start = 0.0;
    double total = 0.0;
    PlainCorner corner;
  };

  // Outside 0..length() the nearer end; the ends are from() and to() to the last bit.
  // On a kBlend piece this measures the curve each time; MotionView does it once.
  PathPose At(double s) const { return kind_ == Kind::kLine ? OnLine(s) : OffLine(s); }

  // Derivatives of the pose by s: the unit tangent and the curvature vector (1/mm), or by sigma.
  [[gnu::always_inline]] PathDerivatives First(double s) const {
    return kind_ == Kind::kLine ? PathDerivatives{tangent_, a_rate(), b_rate()} : FirstOffLine(s);
  }
  PathDerivatives Second(double s) const;
  // Arcs only: both, and the angles of At, with the sines worked out once.
  struct OnArc {
    double a_rad, b_rad;
    PathDerivatives first, second;
  };
  OnArc ArcAt(double s) const;
  [[gnu::always_inline]] MachineVector Tangent(double s) const {
    return kind_ == Kind::kLine ? tangent_ : FirstOffLine(s).point;
  }
  MachineVector Curvature(double s) const { return Second(s).point; }

  // The same places by u for kBlend pieces, whose s must be turned into u first: see CornerLength.
  double curve_start() const {
    if (const auto* plain = std::get_if<PlainPart>(&shape_)) return plain->start;
    return std::get_if<CurvePart>(&shape_)->start;
  }

  // Arcs only.
  const MachineVector& centre() const { return arc().centre; }
  const MachineVector& normal() const { return arc().normal; }
  double radius_mm() const { return arc().radius_mm; }
  double sweep_rad() const { return arc().sweep_rad; }

  // Blends only: the whole curve of the corner, of which this piece may be a part. Made anew each
  // time: keep it for many places.
  CornerCurve curve() const {
    if (const auto* plain = std::get_if<PlainPart>(&shape_)) return CornerCurve(plain->corner);
    return std::get_if<CurvePart>(&shape_)->curve;
  }

 private:
  struct ArcShape {
    MachinePoint centre;
    MachineVector normal;
    MachineVector inward;  // unit vector from the start to the centre
    double radius_mm = 0.0;
    double sweep_rad = 0.0;
  };
  struct CurvePart {
    double start = 0.0;  // arc length of the curve before this piece
    CornerCurve curve;
  };
  const ArcShape& arc() const { return *std::get_if<ArcShape>(&shape_); }
  void AssignBlend(double length, const PathPose& from, const PathPose& to) {
    kind_ = Kind::kBlend;
    length_ = length;
    from_ = from;
    to_ = to;
  }
  void AssignShape(const PathPiece& other);
  MachinePoint ArcPoint(double angle) const;
  PathDerivatives FirstOffLine(double s) const;
  PathPose OnLine(double s) const {
    if (!(s > 0.0)) return from_;
    if (s >= length_) return to_;
    const double share = s / length_;
    return {from_.point + (to_.point - from_.point) * share,
            from_.a_rad + (to_.a_rad - from_.a_rad) * share,
            from_.b_rad + (to_.b_rad - from_.b_rad) * share};
  }
  PathPose OffLine(double s) const;
  void AssignPartOffLine(const PathPiece& whole, double s_from, double s_to);
  double RateOf(double from, double to) const {
    return to != from && length_ > 0.0 ? (to - from) / length_ : 0.0;
  }

  Kind kind_ = Kind::kLine;
  double length_ = 0.0;
  PathPose from_;
  PathPose to_;
  MachineVector tangent_;  // lines and arcs: unit tangent at the start
  // Of arcs and blends. Other kinds may hold what the piece was before.
  std::variant<std::monostate, ArcShape, CurvePart, PlainPart> shape_;
};

inline void PathPiece::AssignShape(const PathPiece& other) {
  if (const auto* plain = std::get_if<PlainPart>(&other.shape_)) {
    shape_ = *plain;
  } else {
    shape_ = other.shape_;
  }
}

inline PathPiece& PathPiece::operator=(const PathPiece& other) {
  kind_ = other.kind_;
  length_ = other.length_;
  from_ = other.from_;
  to_ = other.to_;
  tangent_ = other.tangent_;
  if (kind_ == Kind::kArc || kind_ == Kind::kBlend) AssignShape(other);
  return *this;
}

struct PathPiece::Arc3 {
  ArcCase kind = ArcCase::kArc;
  PathPiece path;
};

}  // namespace rmlcell::motion
