#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// A stretch of way with limits of its own, and the speed at its end when every stretch is timed by
// itself, with acceleration zero between them (level 1).
struct RampCell {
  double length = 0.0;
  PathLimits limits;
  double end_speed = 0.0;
  double end_cap = kNoCap;  // of the speed at its end, besides the limits on both sides
  // In a bend the highest speeds at equal steps from its beginning to its end. Ramps of this
  // stretch alone, with acceleration zero at both ends, keep them without being asked; others are
  // looked at. Empty: limits.speed everywhere.
  std::span<const double> most{};

  static constexpr double kNoCap = std::numeric_limits<double>::infinity();
};

// Ramps that run across the ends of stretches: level 2 of motion.md 5.4. First the two passes
// again, with every stretch free to change its speed, curves too. Between the ends that are then
// passed as fast as they may be, one ramp takes the place of several wherever it keeps the limits
// of each: up to kExactMax stretches all ways to join neighbours are tried, longer ways are split
// at the stretch that one ramp breaks most. Never slower than level 1, and no speed at the ends of
// the whole way changes. Without a limit on jerk every stretch is timed by itself. Reused for many
// ways: it keeps its memory.
class RampPlan {
 public:
  RampPlan();
  ~RampPlan();
  RampPlan(const RampPlan&);
  RampPlan& operator=(const RampPlan&);

  // Stretches looked at together: 1 m of lines of 2 mm with their curves, more than any ramp takes.
  static constexpr std::size_t kCellsMax = 2560;

  struct Timing {
    std::size_t ramp = 0;  // of ramps()
    double from = 0.0;     // where the stretch lies on it
    double to = 0.0;
  };

  // Preconditions: 1 to kCellsMax cells of length above 0; level 1 is feasible from `start_speed`.
  void Plan(std::span<const RampCell> cells, double start_speed) {
    Begin(cells, start_speed);
    while (!done()) GoOn();
  }

  // The same a little at a time: GoOn until done(). Each returns about how many ramps it has tried.
  // The cells are looked at until then.
  void Begin(std::span<const RampCell> cells, double start_speed);
  int GoOn();
  bool done() const { return done_; }
  // The same cells are elsewhere now: who copies both says so.
  void FindCellsAt(std::span<const RampCell> cells) { cells_ = cells; }

  // When done():
  const std::vector<SpeedProfile>& ramps() const { return ramps_; }
  const std::vector<Timing>& timing() const { return timing_; }  // one for each cell

 private:
  static constexpr std::size_t kExactMax = 8;  // the work grows with the cube

  struct Try;
  struct SpeedBetween;
  // Cells that shall become the fastest ramps, on a stack: what they fall into lies above them.
  struct Task;
  void NextPart();
  void End();
  int Start(Task& task);
  int Return(double time);
  bool Pass();
  void LevelOne();
  void FindWay(std::size_t first, std::size_t begin, std::size_t end);
  double TakeWays(std::size_t first, std::size_t last);
  struct Look;
  bool BeginLook(Look& look) const;
  void LookAtCell(Look& look);
  static void EndLook(Look& look);
  Try Together(std::size_t first, std::size_t last);
  double LeastOfMost(std::size_t cell);
  double CapAfter(std::size_t cell) const;
  struct Excess;
  void LookAlong(const SpeedProfile& ramp, std::size_t cell, double from, double to,
                 Excess& excess) const;
  void Append(const SpeedProfile& ramp, std::size_t last);
  double SpeedBefore(std::size_t cell) const {
    return cell == 0 ? start_speed_ : speeds_[cell - 1];
  }

  std::span<const RampCell> cells_;
  double start_speed_ = 0.0;
  std::vector<double> speeds_;  // at the end of each cell
  std::vector<double> least_;   // of RampCell::most of each, once that was asked
  static constexpr double kNotAsked = -1.0;
  std::vector<SpeedProfile> ramps_;
  std::vector<std::size_t> last_cell_;  // of each ramp
  struct Way {
    double time = std::numeric_limits<double>::infinity();
    std::size_t begin = 0;  // cell at which its last ramp begins
    SpeedProfile ramp;
  };
  std::array<Way, kExactMax> ways_;  // to the end of each cell of the last task, where it has few
  std::vector<Task> tasks_;
  std::vector<Look> look_;    // the one of the last task, where it has many
  std::size_t part_ = 0;      // the first cell of the present part; those before have their ramps
  double time_ = 0.0;         // of those
  double level_one_ = 0.0;    // of the cells before level_next_, each by itself
  double level_speed_ = 0.0;  // and then
  std::size_t level_next_ = 0;
  bool done_ = true;
  std::vector<Timing> timing_;
};

}  // namespace rmlcell::motion
