#include "tests/fuzz/motion_planner_input.h"

#include <cmath>
#include <cstring>

#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  bool empty() const { return left_.empty(); }
  std::uint8_t Byte() {
    if (left_.empty()) return 0;
    const std::uint8_t byte = left_[0];
    left_ = left_.subspan(1);
    return byte;
  }
  // A tame number, or any 64 bits at all.
  double Number() {
    const std::uint8_t how = Byte();
    if (how < 200) return (static_cast<double>(how) - 100.0) * std::pow(10.0, Byte() % 9 - 5);
    std::uint64_t bits = 0;
    for (int k = 0; k < 8; ++k) bits = bits << 8 | Byte();
    double number = 0.0;
    std::memcpy(&number, &bits, sizeof number);
    return number;
  }

 private:
  std::span<const std::uint8_t> left_;
};

bool Sound(const PlannedMotion& motion) {
  const bool numbers = std::isfinite(motion.duration_s()) && std::isfinite(motion.path.length()) &&
                       std::isfinite(motion.speed.end().speed) &&
                       std::isfinite(motion.corner.deviation_mm);
  return numbers && motion.duration_s() >= 0.0 && motion.speed.end().speed >= 0.0;
}

}  // namespace

std::string PlanBytes(std::span<const std::uint8_t> data) {
  Bytes bytes(data);
  MachineLimits machine = StandardMachine();
  const std::uint8_t mode = bytes.Byte();
  if ((mode & 1) != 0) machine.tip_jerk_mm_s3 = HUGE_VAL;
  if ((mode & 2) != 0) {
    machine.corners = MachineLimits::Corners::kThrough;
    machine.junction_jump_mm_s = 3.0;
  }
  Planner planner(machine, 64);
  std::string wrong;
  const auto drain = [&] {
    while (const std::optional<PlannedItem> item = planner.Next()) {
      const auto* motion = std::get_if<PlannedMotion>(&*item);
      if (motion != nullptr && !Sound(*motion)) {
        wrong = "duration " + std::to_string(motion->duration_s()) + ", length " +
                std::to_string(motion->path.length()) + ", end speed " +
                std::to_string(motion->speed.end().speed) + ", deviation " +
                std::to_string(motion->corner.deviation_mm) + ", kind " +
                std::to_string(static_cast<int>(motion->path.kind())) + ", limits " +
                std::to_string(motion->limits.speed) + " " +
                std::to_string(motion->limits.acceleration);
      }
    }
  };
  TipPose at;
  while (!bytes.empty() && wrong.empty()) {
    const std::uint8_t what = bytes.Byte();
    if (what % 16 == 0) planner.Stop();
    if (what % 16 == 1) planner.Mark(what);
    const TipPose to{{at.tip.x() + bytes.Number(), at.tip.y() + bytes.Number(), at.tip.z()},
                     what % 3 == 0 ? bytes.Number() : at.a_rad,
                     at.b_rad};
    MoveCommand move;
    move.path = PathPiece::Line(at, to);
    if (what % 5 == 0) {
      const Result<PathPiece::Arc3> arc =
          PathPiece::ArcThrough(at, {bytes.Number(), bytes.Number(), bytes.Number()}, to);
      if (arc) move.path = arc->path;
    }
    if (what % 7 == 0) {
      move.kind = MoveCommand::Kind::kPointToPointAxes;
      move.path = PathPiece::Joint({at.tip, at.a_rad, at.b_rad}, {to.tip, to.a_rad, to.b_rad});
    }
    move.speed_fraction = what % 11 == 0 ? bytes.Number() : 0.3;
    move.acceleration_fraction = what % 13 == 0 ? bytes.Number() : 1.0;
    move.overshoot_fraction = what % 17 == 0 ? bytes.Number() : 1.0;
    move.fly = (what & 1) != 0;
    if (planner.Append(move)) at = to;
    drain();
  }
  planner.Stop();
  drain();
  return wrong;
}

}  // namespace rmlcell::motion
