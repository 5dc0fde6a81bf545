#pragma once

#include "engine/core/result.h"
#include "engine/motion/vec3.h"

namespace rmlcell::motion {

// Tool tip in the machine frame (mm) and the two head angles (rad). Mills use the tip alone, and
// a_rad for their rotary axis.
struct TipPose {
  Vec3 tip;
  double a_rad = 0.0;
  double b_rad = 0.0;

  bool operator==(const TipPose&) const = default;
};

// Tolerances of motion.md section 1, used everywhere and nowhere else.
inline constexpr double kTipLengthZero_mm = 1e-6;
inline constexpr double kArcPointTolerance_mm = 1e-4;

// One piece of path. A value: copy it freely, it owns nothing. motion.md section 3.
// s runs from 0 to length(); for kRotary and kJoint it is the path variable sigma from 0 to 1.
// Rotary axes are linear in s and never reduced by a turn.
class PathPiece {
 public:
  enum class Kind {
    kLine,    // straight tip path
    kArc,     // circle through space
    kRotary,  // the tip stands, A or B turn; s is sigma
    kJoint,   // straight in the five axes of COORD ROBOT; s is sigma, poses hold the column
    kBlend,   // quintic corner of a /FLY passage
  };

  PathPiece() = default;

  // kRotary when the tip does not move but an angle does; length 0 when nothing changes.
  static PathPiece Line(const TipPose& from, const TipPose& to);

  // Straight in the five axes; `from` and `to` hold column positions, not tips.
  static PathPiece Joint(const TipPose& from, const TipPose& to);

  // How three points make a path; motion.md 3.2.
  enum class ArcCase { kArc, kLine, kLineWarned, kNoTipMotion };
  struct Arc3;
  // Errors: ArcUndefined (7305) when no single circle goes through the three points.
  static Result<Arc3> ArcThrough(const TipPose& from, const Vec3& via, const TipPose& to);

  // A turn of `sweep_rad` about `normal` (unit) through `from`; right-handed, sweep above 0.
  // `centre` is the foot of `from` on the axis; a sweep of one turn ends exactly where it began.
  static PathPiece Circle(const TipPose& from, const Vec3& centre, const Vec3& normal,
                          double sweep_rad, double a_to_rad, double b_to_rad);

  // The piece between two values of s, 0 <= s_from < s_to <= length(). Not for sigma pieces.
  PathPiece Part(double s_from, double s_to) const;

  Kind kind() const { return kind_; }
  double length() const { return length_; }  // mm, or 1 for sigma pieces; 0: nothing to do
  double tip_length_mm() const;              // 0 for kRotary; for kJoint not known here, 0
  bool by_sigma() const { return kind_ == Kind::kRotary || kind_ == Kind::kJoint; }
  const TipPose& from() const { return from_; }
  const TipPose& to() const { return to_; }

  // Outside 0..length() the nearer end; the ends are from() and to() to the last bit.
  TipPose At(double s) const;
  Vec3 Tangent(double s) const;    // derivative of the tip by s: unit, or per sigma
  Vec3 Curvature(double s) const;  // second derivative of the tip by s, 1/mm
  double a_rate() const;           // rad per unit of s
  double b_rate() const;

  // Arcs only.
  const Vec3& centre() const { return centre_; }
  const Vec3& normal() const { return normal_; }
  double radius_mm() const { return radius_mm_; }
  double sweep_rad() const { return sweep_rad_; }

 private:
  Vec3 ArcPoint(double angle) const;

  Kind kind_ = Kind::kLine;
  double length_ = 0.0;
  TipPose from_;
  TipPose to_;
  Vec3 centre_;
  Vec3 normal_;
  Vec3 tangent_;  // arcs: unit tangent at the start
  Vec3 inward_;   // arcs: unit vector from the start to the centre
  double radius_mm_ = 0.0;
  double sweep_rad_ = 0.0;
};

struct PathPiece::Arc3 {
  ArcCase kind = ArcCase::kArc;
  PathPiece path;
};

}  // namespace rmlcell::motion
