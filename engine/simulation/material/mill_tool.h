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

// A tool on a straight move, seen from a point: `along` the move from its start and `across` it.
// The least height that the tool's surface has over the point on the way, in closed form; infinite
// where the tool does not come over it.
class ToolPass {
 public:
  ToolPass(const MillTool& tool, const motion::MachinePoint& from, const motion::MachinePoint& to);

  const motion::MachinePoint& from() const { return from_; }
  const motion::MachinePoint& to() const { return to_; }
  double radius_mm() const { return radius_; }

  // Of a point at (x, y) from the start of the move. A plunge: all of its distance is across. By
  // single coordinates: whoever asks goes along a row of cells, and only x changes.
  double AlongOf(double x, double y) const { return x * way_.x() + y * way_.y(); }
  double AcrossOf(double x, double y) const {
    return upright_ ? std::sqrt(x * x + y * y) : std::abs(y * way_.x() - x * way_.y());
  }

  double LeastOfFlat(double along, double across) const {
    const Reach r = ReachOf(along, across);
    return r.hit ? z_ + slope_ * (slope_ > 0.0 ? r.low : r.high) : HUGE_VAL;
  }
  double LeastOfBall(double along, double across) const {
    const Reach r = ReachOf(along, across);
    const double t = std::clamp(along - lead_ * r.half, r.low, r.high);
    const double rise_2 = r.half * r.half - (along - t) * (along - t);
    return r.hit ? z_ + slope_ * t + radius_ - std::sqrt(std::max(0.0, rise_2)) : HUGE_VAL;
  }
  double LeastOfVee(double along, double across) const;

  // Of what is as wide as this pass and follows a cutter: its own least height over the point while
  // the cutter has not been there. Infinite where it never comes, or comes behind the cutter on a
  // plunge, whose cutting part has taken everything on its way down.
  double LeastBefore(double along, double across, double cutter_radius) const;

 private:
  // The tool is over the point while its own place along the move lies in low..high.
  struct Reach {
    double half;
    double low;
    double high;
    bool hit;
  };
  Reach ReachOf(double along, double across) const {
    const double half_2 = radius_ * radius_ - across * across;
    const double half = std::sqrt(std::max(0.0, half_2));
    const double low = std::max(0.0, along - half);
    const double high = std::min(length_, along + half);
    return {half, low, std::max(low, high), half_2 >= 0.0 && low <= high};
  }

  motion::MachinePoint from_;
  motion::MachinePoint to_;
  double radius_;
  double tip_radius_;
  double rise_ = 0.0;  // of a vee tool by its radius
  double length_;      // seen from above
  bool upright_;       // a plunge
  PlanVector way_;     // of length 1; zero on a plunge
  double z_;
  double slope_ = 0.0;  // of z along the move
  double lead_ = 0.0;   // of a ball: how far ahead of the point its axis is, by half a chord
};

// The same for any shape, at a point of the plane; nothing where the tool does not come over it.
std::optional<double> SweptHeight(const MillTool& tool, const motion::MachinePoint& from,
                                  const motion::MachinePoint& to, double x, double y);

}  // namespace rmlcell::simulation
