#include "engine/simulation/path/peak_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "engine/core/units.h"
#include "engine/motion/geometry/corner_table.h"
#include "engine/simulation/path/part_curve.h"
#include "engine/simulation/path/profile_phases.h"

namespace rmlcell::simulation {
namespace {

using motion::AxisValues;
using motion::MachineVector;
using motion::PathPiece;

// Peaks are looked for in double precision, and places along a bend are known to 3e-9 of it.
constexpr double kRoundingShare = 1e-6;
// An acceleration is known to this share of its bound; the jerk between two samples is their
// difference by the time between them.
constexpr double kAccelerationShare = 1e-13;
constexpr double kSamplesOfPhase = 512.0;

// What a phase of the profile does, at most.
struct PhaseBounds {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double rounding_per_s = 0.0;  // shares of an acceleration that rounding makes a jerk of
};

PhaseBounds BoundsOf(const PhasePart& part) {
  const double end = part.duration_s;
  return {.speed = std::max({std::abs(part.start.speed), std::abs(part.SpeedAt(end)),
                             std::abs(part.SpeedAt(part.LevelAt()))}),
          .acceleration =
              std::max(std::abs(part.start.acceleration), std::abs(part.AccelerationAt(end))),
          .jerk = std::abs(part.jerk),
          .rounding_per_s = kAccelerationShare * kSamplesOfPhase / end};
}

bool Within(double bound, double known) { return bound * (1.0 + kRoundingShare) <= known; }

// A curve in a plane, passed as the axes go. `along` and `across` are what a unit tangent and a
// unit normal have of each axis at most; `turn` is what the rotary axis of a mill does along it.
struct FlatBend {
  double curvature = 0.0;
  double jerk_per_cube = 0.0;  // sqrt(kappa'^2 + kappa^4)
  MachineVector along;
  MachineVector across;
  double turn = 0.0;  // rad by mm
};

bool BendStaysWithin(const MotionPeaks& known, const FlatBend& bend, const PhaseBounds& by) {
  const double square = by.speed * by.speed;
  const double inward = square * bend.curvature;
  const double acceleration = std::sqrt(by.acceleration * by.acceleration + inward * inward);
  const double rounding = by.rounding_per_s * acceleration;
  const double cube_jerk = square * by.speed * bend.jerk_per_cube;
  const double cross_jerk = 3.0 * by.acceleration * by.speed * bend.curvature;
  // The speed of the tip is that of the profile, and rounding alone is no peak beyond it.
  if (!Within(by.speed, known.tip_speed) || !Within(acceleration, known.tip_acceleration) ||
      !Within(by.jerk + cross_jerk + cube_jerk + rounding, known.tip_jerk)) {
    return false;
  }
  for (int i = 0; i < 3; ++i) {
    const double along = bend.along[i];
    const double across = bend.across[i];
    const double either = std::sqrt(along * along + across * across);
    if (!Within(by.speed * along, known.axis_speed[i]) ||
        !Within(by.acceleration * along + inward * across, known.axis_acceleration[i]) ||
        !Within(by.jerk * along + cross_jerk * across + cube_jerk * either + rounding * either,
                known.axis_jerk[i])) {
      return false;
    }
  }
  const double turn = std::abs(bend.turn);
  return turn == 0.0 || (Within(turn * by.speed, known.axis_speed[3]) &&
                         Within(turn * by.acceleration, known.axis_acceleration[3]) &&
                         Within(turn * (by.jerk + rounding), known.axis_jerk[3]));
}

// What a unit vector that turns from one direction to another in their plane has of each axis at
// most: at an end, or between them where it turns towards the axis and away again.
MachineVector MostAlong(const MachineVector& from, const MachineVector& to,
                        const MachineVector& change_from, const MachineVector& change_to) {
  MachineVector most;
  for (int i = 0; i < 3; ++i) {
    most[i] = std::max(std::abs(from[i]), std::abs(to[i]));
    if (change_from[i] * change_to[i] >= 0.0) continue;
    most[i] = std::sqrt(from[i] * from[i] + change_from[i] * change_from[i]);
  }
  return most;
}

// Half the angle of a corner below which its plane is not known well enough.
constexpr double kHalfSineMin = 1e-6;

std::optional<FlatBend> BendOf(const motion::PlainCorner& corner) {
  const MachineVector& in = corner.tangent_in;
  const MachineVector& out = corner.tangent_out;
  const double half_sine = 0.5 * (out - in).norm();
  const double half_cosine = 0.5 * (out + in).norm();
  if (!(half_sine > kHalfSineMin && half_cosine > kHalfSineMin)) return std::nullopt;
  const double cosine = in.dot(out);
  const double sine = 2.0 * half_sine * half_cosine;
  const MachineVector inward_in = (out - in * cosine) * (1.0 / sine);
  const MachineVector inward_out = (out * cosine - in) * (1.0 / sine);
  const double curvature =
      motion::CornerCurvature(half_sine, half_cosine, motion::CornerRho(half_cosine));
  const double per_mm = 1.0 / corner.cut_mm;
  return FlatBend{
      .curvature = curvature * per_mm,
      .jerk_per_cube = motion::CornerJerk(half_sine, half_cosine, curvature) * per_mm * per_mm,
      .along = MostAlong(in, out, inward_in, inward_out),
      .across = MostAlong(inward_in, inward_out, -in, -out),
      .turn = 0.0};
}

FlatBend BendOf(const PathPiece& path) {
  const MachineVector along = path.Tangent(0.0);
  const double curvature = 1.0 / path.radius_mm();
  const MachineVector inward = path.Curvature(0.0) * path.radius_mm();
  FlatBend bend{.curvature = curvature,
                .jerk_per_cube = curvature * curvature,
                .along = {},
                .across = {},
                .turn = path.a_rate()};
  for (int i = 0; i < 3; ++i)
    bend.along[i] = bend.across[i] = std::sqrt(along[i] * along[i] + inward[i] * inward[i]);
  return bend;
}

// The same on a piece of a path on which the head turns. With u(t) the place on the curve,
// q' = dq/du and w = |p'|: du/dt = v/w, and so on.
bool PieceStaysWithin(const MotionPeaks& known, const AxisPieces::Piece& piece, bool stands,
                      const PhaseBounds& by) {
  const double v = by.speed;
  const double per = 1.0 / piece.slowest;
  const double square = v * v * per * per * per;
  const double u1 = v * per;
  const double u2 = by.acceleration * per + square * piece.change;
  const double u3 = by.jerk * per + 3.0 * by.acceleration * u1 * per * per * piece.change +
                    square * u1 * (piece.second_change + 3.0 * piece.change * piece.change * per);
  const double inward = v * v * piece.curvature;
  const double acceleration = std::sqrt(by.acceleration * by.acceleration + inward * inward);
  const double jerk = piece.tip_third * u1 * u1 * u1 + 3.0 * piece.tip_second * u1 * u2 +
                      piece.fastest * u3 + by.rounding_per_s * acceleration;
  if (!stands && !(Within(v, known.tip_speed) && Within(acceleration, known.tip_acceleration) &&
                   Within(jerk, known.tip_jerk))) {
    return false;
  }
  for (int i = 0; i < motion::kAxisCount; ++i) {
    const double second = piece.second[i] * u1 * u1 + piece.first[i] * u2;
    const double third = piece.third[i] * u1 * u1 * u1 + 3.0 * piece.second[i] * u1 * u2 +
                         piece.first[i] * u3 + by.rounding_per_s * second;
    if (!Within(piece.first[i] * u1, known.axis_speed[i]) ||
        !Within(second, known.axis_acceleration[i]) || !Within(third, known.axis_jerk[i])) {
      return false;
    }
  }
  return true;
}

// The pieces that a phase may pass, between two places of the part. How long the pieces are is
// known between bounds alone.
class PassedPieces {
 public:
  explicit PassedPieces(const AxisPieces& pieces) : pieces_(pieces) {
    for (std::size_t k = 0; k < pieces.pieces().size(); ++k) {
      const AxisPieces::Piece& piece = pieces.pieces()[k];
      least_[k + 1] = least_[k] + piece.slowest * pieces.width();
      most_[k + 1] = most_[k] + piece.fastest * pieces.width();
    }
  }

  bool StayWithin(const MotionPeaks& known, bool stands, double from, double to,
                  const PhaseBounds& by) const {
    const std::span<const AxisPieces::Piece> pieces = pieces_.pieces();
    const double rounding = kRoundingShare * most_[pieces.size()];
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (to < least_[k] - rounding || from > most_[k + 1] + rounding) continue;
      if (!PieceStaysWithin(known, pieces[k], stands, by)) return false;
    }
    return true;
  }

 private:
  const AxisPieces& pieces_;
  std::array<double, AxisPieces::kMany + 1> least_{};  // s of the edges, from the part's begin
  std::array<double, AxisPieces::kMany + 1> most_{};
};

// Whether `stays(part, bounds)` of every phase.
template <class Stays>
bool AllPhases(const motion::SpeedProfile& profile, double from_s, double to_s, Stays stays) {
  bool all = true;
  ForEachPhase(profile, from_s, to_s,
               [&](const PhasePart& phase) { all = all && stays(phase, BoundsOf(phase)); });
  return all;
}

// The slices of which `stays` is not true.
template <class Stays>
OpenSlices SlicesBut(const motion::SpeedProfile& profile, double from_s, double to_s, Stays stays) {
  OpenSlices open = OpenSlices::None();
  std::size_t phases = 0;
  ForEachPhase(profile, from_s, to_s, [&](const PhasePart& phase) {
    for (std::size_t k = 0; k < OpenSlices::kOfPhase; ++k) {
      PhasePart part = phase;
      part.duration_s = phase.duration_s / static_cast<double>(OpenSlices::kOfPhase);
      const double t = part.duration_s * static_cast<double>(k);
      part.start = {phase.PlaceAt(t), phase.SpeedAt(t), phase.AccelerationAt(t)};
      if (!stays(part, BoundsOf(part))) open.Open(phases, k);
    }
    ++phases;
  });
  return open;
}

OpenSlices OpenOfTurning(const MotionPeaks& known, const motion::PlannedMotion& motion,
                         PartShape& shape, double from_s, double to_s) {
  const AxisPieces* pieces = shape.pieces();
  if (pieces == nullptr || !pieces->known()) return OpenSlices::All();
  const bool stands = motion.path.kind() == PathPiece::Kind::kRotary;
  const double begin = shape.part().from;
  const auto by_pieces = [&](const PassedPieces& passed) {
    return [&](const PhasePart& part, const PhaseBounds& by) {
      return passed.StayWithin(known, stands, part.start.s - begin,
                               part.PlaceAt(part.duration_s) - begin, by);
    };
  };
  const PassedPieces few(*pieces);
  if (AllPhases(motion.speed, from_s, to_s, by_pieces(few))) return OpenSlices::None();
  const AxisPieces more(shape.curve(), AxisPieces::kMany);
  if (!more.known()) return OpenSlices::All();
  const PassedPieces many(more);
  return SlicesBut(motion.speed, from_s, to_s, by_pieces(many));
}

}  // namespace

OpenSlices MayExceed(const MotionPeaks& known, const motion::PlannedMotion& motion,
                     PartShape& shape, bool five_axis, double from_s, double to_s) {
  const PathPiece& path = motion.path;
  const bool blend = path.kind() == PathPiece::Kind::kBlend;
  const bool arc = path.kind() == PathPiece::Kind::kArc;
  const bool head_turns = five_axis && shape.turns();
  if (path.in_axes() || !(blend || arc || head_turns) || (arc && head_turns))
    return OpenSlices::All();
  const PathPiece::PlainPart* plain = blend ? path.plain_corner() : nullptr;
  if (!arc && plain == nullptr) return OpenOfTurning(known, motion, shape, from_s, to_s);
  const std::optional<FlatBend> bend = arc ? BendOf(path) : BendOf(plain->corner);
  const auto stays = [&](const PhasePart&, const PhaseBounds& by) {
    return BendStaysWithin(known, *bend, by);
  };
  const bool within = bend && AllPhases(motion.speed, from_s, to_s, stays);
  return within ? OpenSlices::None() : OpenSlices::All();
}

}  // namespace rmlcell::simulation
