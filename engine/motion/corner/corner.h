#pragma once

#include <cmath>

#include "engine/motion/corner/bend_speed.h"
#include "engine/motion/geometry/corner_curve.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "engine/motion/kinematics/machine_limits.h"

namespace rmlcell::motion {

// How the machine gets from one motion to the next. motion.md 3.6, 4.4.
enum class Passage {
  kStop,           // no /FLY, or the program stands here
  kStopNoSpeed,    // /FLY with OVERSH 0: the point is reached, no settling
  kStopReversal,   // /FLY at a turn of more than 175 degrees: warning FlyReversal (7316)
  kStopNeighbour,  // /FLY next to a motion that cannot be blended: rotary only, PTP in COORD ROBOT
  kStopShort,      // /FLY with a blend below 1e-4 mm
  kThrough,        // straight on: passed without a curve
  kBlend,          // passed at the wanted speed
  kBlendCapped,    // a short neighbour or an axis made the curve smaller or slower: lint FlyCapped
                   // (7318)
};
inline bool IsBlend(Passage p) { return p == Passage::kBlend || p == Passage::kBlendCapped; }
inline bool IsStop(Passage p) { return p < Passage::kThrough; }

// The corner between two pieces of path: everything about it that does not depend on speed.
class Corner {
 public:
  Corner() = default;

  // Precondition: `before` ends where `after` begins; neither is by sigma.
  static Corner Between(const PathPiece& before, const PathPiece& after) {
    Corner corner;
    corner.Assign(before, after);
    return corner;
  }
  void Assign(const PathPiece& before, const PathPiece& after);  // in place

  // kStopReversal, kThrough or kBlend.
  Passage passage() const { return passage_; }

  // Both pieces are lines and the head does not start to turn: shape and bounds follow from the
  // angle.
  bool plain() const { return plain_; }

  // Straight on with a steady head: only the curvature jumps.
  bool straight() const { return straight_; }

  // How far from the corner the curve begins for the speed `w`; motion.md 4.3, before the caps by
  // the neighbouring runs.
  double CutFor(double w_mm_s, const MachineLimits& machine) const;

  // The cap by half the radius of a neighbouring arc; infinite without one.
  double cut_max_mm() const { return cut_max_mm_; }

  // Both pieces are lines; the head may turn.
  bool lines() const { return lines_; }

  // Corners of lines: length, distance from the corner, and highest speed of the curve cut at
  // `cut_mm`.
  double PlainLength(double cut_mm) const;
  double PlainDeviation(double cut_mm) const;
  double PlainBow(double cut_mm) const;  // its middle is the corner plus this times (out - in)
  double PlainSpeed(double cut_mm, const MachineLimits& machine) const;
  // The highest speed from place to place, none above `top`. With a limit on jerk.
  BendSpeeds PlainSpeeds(double cut_mm, double top_mm_s, const MachineLimits& machine) const;
  double PlainCurvature(double cut_mm) const { return curvature_ / cut_mm; }

 private:
  Passage passage_ = Passage::kStop;
  bool plain_ = false;
  bool lines_ = false;
  bool straight_ = false;
  double half_sine_ = 0.0;  // of the turn
  double half_cosine_ = 1.0;
  double rho_ = 0.0;        // of motion.md 4.2
  double curvature_ = 0.0;  // K of motion.md 4.2: peak curvature times cut
  double jerk_ = 0.0;       // J of 4.3
  double curvature_jump_ = 0.0;
  double a_jump_ = 0.0;  // of the head rates, rad/mm
  double b_jump_ = 0.0;
  double cut_max_mm_ = 0.0;
};

// The speed at which the direction may change from one to the other when no axis may jump by more
// than `jump_mm_s`; infinite straight on. motion.md section 7.
double JunctionSpeed(const MachineVector& tangent_in, const MachineVector& tangent_out,
                     double jump_mm_s);

// The end of a piece at `s`, as a curve meets it.
CurveEnd EndAt(const PathPiece& path, double s);

// Whether a curve between two lines, whose tip may be as fast as `speed`, can be passed at that
// speed by the axes too: by bounds, so no is only a maybe. `curvature_per_mm` is the peak of its
// curvature.
bool AxesFollow(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                double speed, double curvature_per_mm);

// The highest speed at which a curve can be passed: normal acceleration, jerk and axes.
// motion.md 4.3; to 1e-9. When it is above `enough` that is all that can be told from it.
// `of_lines`: it lies between two lines, and the tip can pass it at `enough`, as Corner knows.
double SpeedOnCurve(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                    double enough = HUGE_VAL, bool of_lines = false);

}  // namespace rmlcell::motion
