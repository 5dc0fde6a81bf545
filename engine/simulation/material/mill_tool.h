#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/result.h"
#include "engine/motion/geometry/frames.h"

namespace rmlcell::simulation {

using motion::LengthOf, motion::PlanOf, motion::PlanVector;

// The cutting end of a milling tool, a body of revolution; its lowest point is the programmed one.
// motion.md section 9.
struct MillTool {
  enum class Shape { kFlat, kBall, kVee };
  Shape shape = Shape::kFlat;
  double radius_mm = 0.0;         // of the shaft: nothing is cut beyond it
  double half_angle_rad = 0.0;    // kVee: between axis and flank, below a quarter turn
  double tip_radius_mm = 0.0;     // kVee: of the flat at its tip
  double flute_mm = 0.0;          // length that cuts, from the lowest point on; 0: all of it
  double shank_radius_mm = 0.0;   // above it; 0: as wide as the cutting part
  double holder_radius_mm = 0.0;  // 0: none that could get in the way
  double holder_from_mm = 0.0;    // where it begins above the lowest point
  int flutes = 0;                 // cutting edges; 0: not told
};

// How high the cutting end reaches before the tool is as wide as its shaft.
double ShapeHeight(const MillTool& tool);

// How wide the tool is at `height_mm` above its lowest point: what a groove of that depth measures
// across at the surface. Precondition: height_mm >= 0.
double WidthAt(const MillTool& tool, double height_mm);

// Error: CellInvalidArgument for a tool that cannot be: a radius that is not above 0, a half angle
// not between 0 and a quarter turn, a tip wider than the shaft, a cutting length that ends in the
// shape, a shank of a tool that cuts all along, a holder that begins below the shank.
Status CheckTool(const MillTool& tool);

// A point this little beyond the edge of a tool is under it: round measures put many centres of
// cells on the very edge, where the last digits of a sum would decide otherwise.
inline constexpr double kOnEdge_mm = 1e-9;

// A tool on a straight move, seen from a point: `along` the move from its start and `across` it.
// The least height that the tool's surface has over the point on the way, in closed form, for a
// point that the tool comes over. Without a branch: whoever asks goes along a row of cells.
class ToolPass {
 public:
  ToolPass(const MillTool& tool, const motion::MachinePoint& from, const motion::MachinePoint& to);

  const motion::MachinePoint& from() const { return from_; }
  const motion::MachinePoint& to() const { return to_; }
  const motion::MachinePoint& lower_end() const { return rises() ? from_ : to_; }
  double radius_mm() const { return radius_; }
  bool rises() const { return slope_ > 0.0; }
  bool is_level() const { return !(slope_ < 0.0) && !(slope_ > 0.0); }  // or straight down
  bool plunges() const { return !(length_ > 0.0); }
  // Of a flat tool, where it comes to stand at its lower end.
  double least_height() const { return z_ + slope_ * (rises() ? 0.0 : length_); }

  // Of a point at (x, y) from the start of the move. By single coordinates: along a row only x
  // changes.
  double AlongOf(double x, double y) const { return x * way_.x() + y * way_.y(); }
  double AcrossOf(double x, double y) const { return y * way_.x() - x * way_.y(); }

  bool Covers(double along, double across) const {
    const double beyond = along - Kept(along);
    const double reach = radius_ + kOnEdge_mm;
    return across * across + beyond * beyond <= reach * reach;
  }

  // Of a flat tool: on the way up where it comes, on the way down where it leaves.
  double LeastOfFlatUp(double along, double across) const {
    return z_ + slope_ * std::max(0.0, along - std::sqrt(HalfChord2(radius_, across)));
  }
  double LeastOfFlatDown(double along, double across) const {
    return z_ + slope_ * std::min(length_, along + std::sqrt(HalfChord2(radius_, across)));
  }
  double LeastOfBall(double along, double across) const {
    const double half = std::sqrt(HalfChord2(radius_, across));
    return BallAt(Kept(along - lead_ * half), half, along);
  }
  double LeastOfLevelBall(double along, double across) const {
    return BallAt(Kept(along), std::sqrt(HalfChord2(radius_, across)), along);
  }
  double LeastOfPlungedBall(double along, double across) const {
    const double distance = std::sqrt(along * along + across * across);
    return z_ + radius_ - std::sqrt(HalfChord2(radius_, distance));
  }
  double LeastOfVee(double along, double across) const;
  double LeastOfLevelVee(double along, double across) const {
    return VeeAt(Kept(along), along, across);
  }

  // Of what is as wide as this pass and follows a cutter: its own least height over the point while
  // the cutter has not been there. Infinite where it comes behind the cutter on a plunge, whose
  // cutting part has taken everything on its way down.
  double LeastBefore(double along, double across, double cutter_radius) const;

 private:
  double Kept(double along) const { return std::min(length_, std::max(0.0, along)); }
  static double HalfChord2(double radius, double across) {
    return std::max(0.0, radius * radius - across * across);
  }
  double BallAt(double place, double half, double along) const {
    const double rise_2 = half * half - (along - place) * (along - place);
    return z_ + slope_ * place + radius_ - std::sqrt(std::max(0.0, rise_2));
  }
  double VeeAt(double place, double along, double across) const {
    const double distance = std::sqrt((along - place) * (along - place) + across * across);
    return z_ + slope_ * place + std::max(0.0, distance - tip_radius_) * rise_;
  }

  motion::MachinePoint from_;
  motion::MachinePoint to_;
  double radius_;
  double tip_radius_;
  double rise_ = 0.0;         // of a vee tool by its radius
  double length_;             // seen from above; 0: a plunge
  PlanVector way_{1.0, 0.0};  // of length 1; a plunge goes any way
  double z_;
  double slope_ = 0.0;  // of z along the move
  double lead_ = 0.0;   // of a ball: how far ahead of the point its axis is, by half a chord
};

// The height over the point is convex in the tool's place: its least is at an end, where it stands
// still, or where the flat tip begins.
inline double ToolPass::LeastOfVee(double along, double across) const {
  const double half = std::sqrt(HalfChord2(radius_, across));
  const double low = Kept(along - half);
  const double high = std::max(low, Kept(along + half));
  const auto at = [&](double place) {
    return VeeAt(std::min(high, std::max(low, place)), along, across);
  };
  double least = std::min(at(low), at(high));
  const double steepness = slope_ / rise_;
  if (std::abs(steepness) < 1.0) {
    const double ahead = std::abs(across) * steepness / std::sqrt(1.0 - steepness * steepness);
    least = std::min(least, at(along - ahead));
  }
  const double flat = std::sqrt(HalfChord2(tip_radius_, across));
  return std::min(least, std::min(at(along - flat), at(along + flat)));
}

// The same for any shape, at a point of the plane; nothing where the tool does not come over it.
std::optional<double> SweptHeight(const MillTool& tool, const motion::MachinePoint& from,
                                  const motion::MachinePoint& to, double x, double y);

}  // namespace rmlcell::simulation
