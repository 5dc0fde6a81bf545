#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/rml1/action.h"
#include "engine/rml1/clipping.h"
#include "engine/rml1/extent.h"
#include "engine/rml1/registers.h"

namespace rmlcell::rml1 {

// What a stream would have cut beyond the travel, and how far it leads beyond each face. Device
// units; 0 where it stays inside.
struct LostCut {
  double length = 0.0;
  double x_low = 0.0;
  double x_high = 0.0;
  double y_low = 0.0;
  double y_high = 0.0;
  double z_low = 0.0;
  Extent x;  // where it lies, from the machine's zero
  Extent y;
  Extent z;
};

// The highest speed up to `wanted` at which no axis exceeds its own; motion.md section 7.
double LimitedSpeed(const Profile& profile, const Point& from, const Point& to, double wanted_mm_s);

// The axes of the device: turns commanded points into physical motions.
//
// It keeps two positions, in device units from the machine's zero. The logical one follows the
// commands and may lie anywhere; the physical one never leaves the cutting range (section 5A).
// Every method appends what happens to the queue of its context, with the start of the spindle (5B)
// and the dwells (RML1-9.34) in their places, and leaves the positions as they are when that is
// done. Motions of length zero are not appended (RML1-9.49), and a point or height that is the
// logical one already changes nothing at all (RML1-9.52, RML1-9.55).
class Carriage {
 public:
  // Power-on: at the XY work origin, as far as the travel reaches, with Z at the top (RML1-9.07).
  explicit Carriage(const Profile& profile);

  struct Context {
    const Profile& profile;
    Registers& registers;
    ActionQueue& queue;
  };

  // Two-dimensional commands: brings the tool to the height of its state. While X or Y lies
  // outside, only the logical height changes (RML1-5A.33, 5A.37).
  void ToToolHeight(const Context& context) {
    const double z = context.registers.tool_z(context.profile);
    if (!free_ || z != logical_.z) return ChangeToolHeight(context, z);
    parked_ = false;
  }
  // Then to one point, at the height and speed of the tool state (RML1-5A.30 to 5A.32).
  [[gnu::always_inline]] void MoveXY(const Context& context, double x, double y) {
    const bool free = free_ && inside_.HasXYWithin(x, y) && IsAside(x, y);
    if (!free) return MoveXYCut(context, x, y);
    logical_.x = x;
    logical_.y = y;
    Drive(context, logical_, StrokeXY(context));
  }

  // Three-axis commands: one set, clipped at the six faces (RML1-5A.01 to 5A.29, 5A.34).
  [[gnu::always_inline]] void MoveXYZ(const Context& context, const Point& to) {
    const bool free = free_ && inside_.HasWithin(to) && IsAside(to.x, to.y);
    if (!free) return MoveXYZCut(context, to);
    parked_ = false;
    const Registers& registers = context.registers;
    const bool cuts = std::min(logical_.z, to.z) < registers.surface_z;
    logical_ = to;
    Drive(context, to,
          {.speed_mm_s = registers.z_speed,
           .use = cuts ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
           .chain = Chain::kThreeAxis,
           .dwells = true});
  }

  // !ZM (RML1-3C.25, 3C.37).
  void MoveZ(const Context& context, double z);

  // IN: to the tool-up height where it is. H: to the top, then to the XY work origin. Both without
  // dwell and without starting the spindle; the logical position becomes the physical one.
  void RaiseForInitialise(const Context& context);
  void GoHome(const Context& context);

  const Point& logical() const { return logical_; }
  const Point& physical() const { return physical_; }
  void Place(const Point& at);  // a machine state of an earlier run; limited to the travel

  // Logical way that the tool could not follow, in device units, and the sets concerned.
  double clipped_length() const { return clipped_length_; }
  std::uint64_t clipped_sets() const { return clipped_sets_; }
  // The part of that which would have been in the work: with the tool down, or below the surface.
  const LostCut& lost() const { return lost_; }
  const CuttingRange& range() const { return range_; }

  // The same of the last command, line by line.
  struct LostLine {
    Point from;
    Point to;
  };
  std::span<const LostLine> lost_lines() const { return {lost_lines_.data(), lost_count_}; }
  void ForgetLostLines() { lost_count_ = 0; }

 private:
  struct Stroke {
    double speed_mm_s = 0.0;
    machine::MotionUse use = machine::MotionUse::kTravel;
    Chain chain = Chain::kAlone;
    bool rapid = false;
    bool dwells = false;  // a wait right before it
    bool starts_spindle = true;
  };

  static Stroke StrokeXY(const Context& context) {
    if (!context.registers.tool_down) {
      return {.speed_mm_s = context.profile.travel_speed, .chain = Chain::kToolUp, .rapid = true};
    }
    return {.speed_mm_s = context.registers.xy_speed,
            .use = machine::MotionUse::kCut,
            .chain = Chain::kToolDown,
            .dwells = true};
  }

  // Whether X or Y alone is further than what counts as no way: no way is shorter than along an
  // axis, nor its root of a sum of squares, however it is rounded.
  bool IsAside(double x, double y) const {
    return std::abs(x - logical_.x) > zero_ || std::abs(y - logical_.y) > zero_;
  }
  // Behind all that may change what it is.
  void Settle() { free_ = !outside_ && logical_ == physical_ && inside_.HasWithin(logical_); }
  // What they take are values, so that nothing has to be in memory for the lines that are free.
  void ChangeToolHeight(Context context, double z);
  void BringToToolHeight(const Context& context);
  void MoveXYCut(Context context, double x, double y);
  void MoveXYZCut(Context context, Point to);
  void FollowXY(const Context& context, const Point& to);
  void FollowXYZ(const Context& context, const Point& to);

  bool Go(const Context& context, const Point& to, const Stroke& stroke);
  void Drive(const Context& context, const Point& to, const Stroke& stroke);
  void GoTwoAxis(const Context& context, const Point& to);
  bool GoThreeAxis(const Context& context, const Point& to, bool dwells);
  struct Recovery {
    double pass_z = 0.0;          // height of the way across
    bool to_tool_height = false;  // of a two-dimensional command
  };
  void Recover(const Context& context, const Point& to, const Recovery& recovery, bool& dwell);
  void Approach(const Context& context, const Point& to, const Recovery& recovery, bool& dwell);
  double WayAcross(const Context& context) const;
  bool MayPauseXY(const Context& context) const;
  void Follow(const Context& context, const Piece& piece, bool& dwell);
  void TurnRotary(const Context& context, double a, bool& dwell);
  void LeaveXY(const Context& context);
  void PauseAtEntry(const Context& context, bool allowed);
  void NoteClipped(double length);
  void NoteLostDepth(const Context& context, double from_z);
  void NoteLost(const Point& from, const Point& to, double surface_z);
  bool SameXY(const Point& a, const Point& b) const;

  CuttingRange range_;
  CuttingRange inside_;  // of that, clear of its faces
  double zero_;          // device units: shorter motions are none
  double slowest_axis_;  // mm/s, of X, Y and Z at their fastest
  Point logical_;
  Point physical_;
  bool outside_ = false;  // the commands have left the range and not come back to it
  // The tool is where the commands are, and clear of all faces: a line to another place of that
  // kind is what it says. Nearly all lines are.
  bool free_ = false;
  bool parked_ = false;  // a two-axis motion left the tool at its boundary, at a safe height
  double clipped_length_ = 0.0;
  std::uint64_t clipped_sets_ = 0;
  LostCut lost_;
  static constexpr std::size_t kLostLinesMax = 6;  // all pieces of a line, and the way down before
  std::array<LostLine, kLostLinesMax> lost_lines_{};
  std::size_t lost_count_ = 0;
};

// Precondition: it is not there. Always inline: the stroke is known where it is called.
[[gnu::always_inline]] inline void Carriage::Drive(const Context& context, const Point& to,
                                                   const Stroke& stroke) {
  Registers& registers = context.registers;
  if (stroke.starts_spindle && registers.rotation && !registers.spindle_on) {
    registers.spindle_on = true;
    context.queue.Push(Action::Kind::kSpindleStart).rpm = registers.rpm;
  }
  if (stroke.dwells && registers.dwell_ms > 0) {
    context.queue.Push(Action::Kind::kDwell).dwell_ms = registers.dwell_ms;
  }
  // No axis goes further than the tool.
  const bool any_axis_can = stroke.speed_mm_s <= slowest_axis_ && physical_.a == to.a;
  Action& action = context.queue.Push(Action::Kind::kMotion);
  action.to = to;
  action.speed_mm_s = any_axis_can
                          ? stroke.speed_mm_s
                          : LimitedSpeed(context.profile, physical_, action.to, stroke.speed_mm_s);
  action.rapid = stroke.rapid;
  action.use = stroke.use;
  action.chain = stroke.chain;
  physical_ = to;
}

}  // namespace rmlcell::rml1
