#include "tests/engine/motion/plan_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace rmlcell::motion {
namespace {

constexpr std::size_t kEnough = 10;
constexpr std::array<std::string_view, kAxisCount> kAxisSpeed = {
    "speed of X", "speed of Y", "speed of Z", "speed of A", "speed of B"};
constexpr std::array<std::string_view, kAxisCount> kAxisAcceleration = {
    "acceleration of X", "acceleration of Y", "acceleration of Z", "acceleration of A",
    "acceleration of B"};

class Checker {
 public:
  explicit Checker(const PlanCheck& plan) : plan_(plan) {}

  std::vector<std::string> Run() {
    std::size_t move = 0;  // of the chain
    for (std::size_t k = 0; k < plan_.motions.size() && found_.size() < kEnough; ++k) {
      const PlannedMotion& motion = plan_.motions[k];
      while (move < plan_.chain.size() && plan_.chain[move].tag != motion.tag) ++move;
      if (move == plan_.chain.size()) {
        Say(motion, "a tag out of order", 0, 0);
        break;
      }
      Seam(k);
      Inside(motion, plan_.chain[move]);
      if (motion.ends_move) Target(motion, plan_.chain[move]);
    }
    return std::move(found_);
  }

 private:
  void Say(const PlannedMotion& motion, std::string_view what, double value, double limit) {
    found_.push_back("move " + std::to_string(motion.tag) + ": " + std::string(what) + " " +
                     std::to_string(value) + " against " + std::to_string(limit));
  }
  void Most(const PlannedMotion& motion, std::string_view what, double value, double limit,
            double room) {
    if (!(value <= limit * (1 + 1e-6) + room)) Say(motion, what, value, limit);
  }

  // Each motion begins where and how the last one ended.
  void Seam(std::size_t k) {
    const PlannedMotion& here = plan_.motions[k];
    const MotionView view(here);
    const TrajectoryPoint begin = view.At(0.0);
    if (k > 0) {
      const PlannedMotion& before = plan_.motions[k - 1];
      // Relative to 1 m: chains may wander far from the origin.
      const double far = std::max(1.0, begin.tip.tip.norm() / 1000.0);
      Most(here, "jump of place in nm", 1e6 * (last_.tip.tip - begin.tip.tip).norm(), 0.0,
           1e-3 * far);
      Most(here, "jump of A", std::abs(last_.tip.a_rad - begin.tip.a_rad), 0.0, 1e-10);
      Most(here, "jump of velocity", (last_.tip_velocity - begin.tip_velocity).norm(), 0.0,
           1e-6 + 1e-6 * begin.tip_speed());
      const bool stood = begin.tip_speed() == 0.0;
      if (std::isfinite(plan_.machine.tip_jerk_mm_s3) && !stood) {
        Most(here, "jump of acceleration", (last_.tip_acceleration - begin.tip_acceleration).norm(),
             0.0, 1e-3 + 1e-6 * plan_.machine.tip_acceleration_mm_s2);
      }
      Most(here, "jump of path speed",
           std::abs(before.speed.end().speed - here.speed.At(0.0).speed), 0.0, 1e-6);
    } else {
      Most(here, "speed at the start", begin.tip_speed(), 0.0, 0.0);
    }
    last_ = view.At(here.speed.duration_s());
    if (here.settling_s > 0.0) Most(here, "speed before settling", last_.tip_speed(), 0.0, 0.0);
  }

  // The ramps are those that ACCEL of the move allows and the motion says it is bound by, in both
  // halves of a bend too. OPT-2.16
  void Ramps(const PlannedMotion& motion, const MoveCommand& move) {
    const MachineLimits& m = plan_.machine;
    const double share = motion.path.by_sigma() ? HUGE_VAL : move.acceleration_fraction;
    const double most = std::min(motion.limits.acceleration, share * m.tip_acceleration_mm_s2);
    const double jerk = std::min(motion.limits.jerk, share * m.tip_jerk_mm_s3);
    for (int k = 0; k < motion.speed.phase_count(); ++k) {
      const SpeedProfile::Phase& phase = motion.speed.phase(k);
      const double begin = phase.start.acceleration;
      const double end = begin + phase.duration_s * phase.jerk;
      Most(motion, "ramp", std::max(std::abs(begin), std::abs(end)), most, 1e-6);
      Most(motion, "jerk of a ramp", std::abs(phase.jerk), jerk, 1e-3);
    }
  }

  void Inside(const PlannedMotion& motion, const MoveCommand& move) {
    Ramps(motion, move);
    const MotionView view(motion);
    const bool blend = motion.path.kind() == PathPiece::Kind::kBlend;
    const bool contour = move.kind == MoveCommand::Kind::kContour && !motion.path.by_sigma();
    const double moving = motion.speed.duration_s();
    if (!(moving >= 0.0)) Say(motion, "duration", moving, 0.0);
    const MachineLimits& m = plan_.machine;
    // Second differences of places near 1e3 mm are good to 1e-12 / h^2: leave out what is shorter.
    const double h = std::min(1e-4, moving / 8);
    if (h < 2e-6) return;
    const double room = 8e-12 / (h * h);
    const bool planar = !plan_.arcs;
    double phase_start = 0.0;
    double last_s = -1.0;
    for (int k = 0; k < motion.speed.phase_count(); ++k) {
      const double duration = motion.speed.phase(k).duration_s;
      // Path jerk, from places within one phase of a line: there it is constant.
      const double step = std::min(duration / 8, 2e-3);
      if (contour && motion.path.kind() == PathPiece::Kind::kLine && step >= 2e-4) {
        const auto at = [&](double t) { return view.PoseAt(phase_start + 0.5 * duration + t).tip; };
        const MachineVector third = at(3 * step) - at(step) * 3.0 + at(-step) * 3.0 - at(-3 * step);
        Most(motion, "path jerk", third.norm() / (8 * step * step * step),
             move.acceleration_fraction * m.tip_jerk_mm_s3, 8e-12 / (step * step * step));
      }
      const int last = k + 1 == motion.speed.phase_count() ? plan_.samples_per_phase
                                                           : plan_.samples_per_phase - 1;
      for (int i = 0; i <= last; ++i) {
        const double t =
            std::clamp(phase_start + duration * i / plan_.samples_per_phase, h, moving - h);
        const TipPose p0 = view.PoseAt(t - h), p1 = view.PoseAt(t), p2 = view.PoseAt(t + h);
        const double s = motion.speed.At(t).s;
        Most(motion, "way back", last_s - s, 0.0, 1e-9);
        last_s = s;
        const double speed = 0.5 / h * (p2.tip - p0.tip).norm();
        const double acceleration = (p2.tip - p1.tip * 2.0 + p0.tip).norm() / (h * h);
        if (contour) {
          Most(motion, "tip speed", speed,
               std::min(move.speed_fraction * m.tip_speed_mm_s, motion.limits.speed),
               1e-6 + 1e-12 / h);
          Most(motion, "tip acceleration", acceleration, m.tip_acceleration_mm_s2, room);
        }
        if (blend && Varies(motion.speed)) {
          const MachineVector along =
              (p2.tip - p0.tip) * (1.0 / std::max((p2.tip - p0.tip).norm(), 1e-300));
          const MachineVector second = (p2.tip - p1.tip * 2.0 + p0.tip) * (1.0 / (h * h));
          const double tangential = second.dot(along);
          Most(motion, "acceleration across a blend", (second - along * tangential).norm(),
               m.normal_acceleration(), room);
          // The chord between two places is not quite the tangent: 0.1 % where the bend is tight.
          const double along_most = m.curve_tangential * m.tip_acceleration_mm_s2;
          Most(motion, "acceleration along a blend", std::abs(tangential), along_most,
               room + 1e-3 * along_most);
          if (planar && std::isfinite(m.tip_jerk_mm_s3)) CurveJerk(motion, s, speed);
        } else if (blend) {
          Most(motion, "acceleration in a blend", acceleration, m.normal_acceleration(), room);
          // Third differences over four places; the tip's jerk at constant speed. Out of a plane
          // the curve's torsion adds what motion.md 4.3 does not count.
          const double q = 5e-5;
          if (planar && std::isfinite(m.tip_jerk_mm_s3) && t > 3 * q && t + 3 * q < moving) {
            const MachineVector third = view.PoseAt(t + 3 * q).tip - view.PoseAt(t + q).tip * 3.0 +
                                        view.PoseAt(t - q).tip * 3.0 - view.PoseAt(t - 3 * q).tip;
            Most(motion, "jerk in a blend", third.norm() / (8 * q * q * q), m.normal_jerk(),
                 8e-12 / (q * q * q));
          }
        }
        const AxisPose a0 = motion.head.ColumnOf(p0), a1 = motion.head.ColumnOf(p1),
                       a2 = motion.head.ColumnOf(p2);
        const auto axis = [](const AxisPose& a, std::size_t n) {
          return n < 3 ? a.column[n] : n == 3 ? a.a_rad : a.b_rad;
        };
        for (std::size_t n = 0; n < kAxisCount; ++n) {
          const double v = 0.5 / h * std::abs(axis(a2, n) - axis(a0, n));
          const double w = std::abs(axis(a2, n) - 2 * axis(a1, n) + axis(a0, n)) / (h * h);
          const double digits = n < 3 ? 1.0 : 1e-3;
          Most(motion, kAxisSpeed[n], v, m.axes.speed[n], 1e-6);
          Most(motion, kAxisAcceleration[n], w, m.axes.acceleration[n], room * digits);
        }
      }
      phase_start += duration;
    }
  }

  static bool Varies(const SpeedProfile& speed) {
    return speed.phase_count() != 1 || speed.phase(0).jerk != 0.0 ||
           speed.phase(0).start.acceleration != 0.0;
  }

  // v^3 sqrt(kappa'^2 + kappa^4) of motion.md 4.3, from places along the curve.
  void CurveJerk(const PlannedMotion& motion, double s, double speed) {
    const double q = 5e-5 * speed;
    if (s < 3 * q || s + 3 * q > motion.path.length() || q < 1e-6) return;
    const auto at = [&](double place) { return motion.path.At(place).point; };
    const MachineVector third = at(s + 3 * q) - at(s + q) * 3.0 + at(s - q) * 3.0 - at(s - 3 * q);
    const double cube = speed * speed * speed / (8 * q * q * q);
    Most(motion, "jerk in a blend", third.norm() * cube, plan_.machine.normal_jerk(), 8e-12 * cube);
  }

  // Stops meet their target; the way round a /FLY target keeps the distance that is reported.
  void Target(const PlannedMotion& motion, const MoveCommand& move) {
    const MachinePoint& target = move.path.to().point;
    const double gap = (motion.path.to().point - target).norm();
    if (!IsBlend(motion.corner.passage)) {
      if (motion.path.kind() != PathPiece::Kind::kBlend)
        Most(motion, "distance from the target", gap, 0.0, 1e-9);
      return;
    }
    if (motion.path.kind() != PathPiece::Kind::kBlend) {
      Say(motion, "no blend at the passage", 0, 0);
      return;
    }
    Most(motion, "reported deviation", motion.corner.deviation_mm, gap, 1e-9);
    Most(motion, "deviation", motion.path.curve().DistanceFrom(target), motion.corner.deviation_mm,
         1e-8);
    Most(motion, "speed of the bend", motion.corner.speed,
         move.overshoot_fraction * move.speed_fraction * plan_.machine.tip_speed_mm_s, 0.0);
  }

  const PlanCheck& plan_;
  TrajectoryPoint last_;
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> PlanCheck::Violations() const { return Checker(*this).Run(); }

}  // namespace rmlcell::motion
