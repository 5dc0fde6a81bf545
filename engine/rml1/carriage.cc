#include "engine/rml1/carriage.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/geometry/path.h"

namespace rmlcell::rml1 {
namespace {

using machine::MotionUse;

// Z alone: down is a plunge where it goes into the work, and only then.
MotionUse UseOfHeight(double from_z, double to_z, bool into_work) {
  if (to_z > from_z) return MotionUse::kRetract;
  return into_work ? MotionUse::kPlunge : MotionUse::kTravel;
}

// Three-axis motion says nothing about its purpose: below the surface there is material.
MotionUse UseOfThreeAxis(const Point& from, const Point& to, bool same_xy, double surface_z) {
  if (same_xy && to.z < from.z) return to.z < surface_z ? MotionUse::kPlunge : MotionUse::kTravel;
  if (same_xy && to.z > from.z)
    return from.z < surface_z ? MotionUse::kRetract : MotionUse::kTravel;
  return std::min(from.z, to.z) < surface_z ? MotionUse::kCut : MotionUse::kTravel;
}

double FastestXY(const Profile& profile) {
  return std::max(profile.xy_speeds.maximum_mm_s, profile.travel_speed);
}

}  // namespace

double LimitedSpeed(const Profile& profile, const Point& from, const Point& to,
                    double wanted_mm_s) {
  const double xy_highest = FastestXY(profile);
  const double z_highest = profile.z_speeds.maximum_mm_s;
  // No axis goes further than the tool.
  if (wanted_mm_s <= std::min(xy_highest, z_highest) && from.a == to.a) return wanted_mm_s;
  const double length = DistanceXYZ(from, to);
  if (!(length > 0.0)) return wanted_mm_s;
  double speed = wanted_mm_s;
  const auto limit = [&](double way, double highest) {
    if (std::abs(way) * speed > highest * length) speed = highest * length / std::abs(way);
  };
  limit(to.x - from.x, xy_highest);
  limit(to.y - from.y, xy_highest);
  limit(to.z - from.z, z_highest);
  // The rotary axis turns in step: degrees per mm of path, RML1-3D.29.
  limit((to.a - from.a) * profile.units_per_mm, profile.rotary_speed_deg_s);
  return speed;
}

Carriage::Carriage(const Profile& profile)
    : range_{profile.x, profile.y, profile.z},
      inside_(range_.WithoutFaces()),
      zero_(motion::kTipLengthZero_mm * profile.units_per_mm),
      slowest_axis_(std::min(FastestXY(profile), profile.z_speeds.maximum_mm_s)) {
  Place({profile.origin_x, profile.origin_y, profile.z.high, 0.0});
}

void Carriage::Place(const Point& at) {
  physical_ = logical_ = range_.Nearest(at);
  outside_ = parked_ = false;
  Settle();
}

void Carriage::ChangeToolHeight(Context context, double z) {
  const double before = logical_.z;
  logical_.z = z;
  if (context.registers.tool_down) NoteLostDepth(context, before);
  if (!outside_ && logical_ == physical_) {
    parked_ = false;
  } else if (range_.HasXY(logical_)) {
    BringToToolHeight(context);
  }
  Settle();
}

void Carriage::BringToToolHeight(const Context& context) {
  const Registers& registers = context.registers;
  Point to = range_.Nearest(logical_);
  to.a = physical_.a;
  bool no_dwell = false;
  if (!SameXY(physical_, to)) Approach(context, to, {.pass_z = WayAcross(context)}, no_dwell);
  parked_ = false;
  // Here the tool comes in over the top: the operator is asked before it goes down (RML1-9.56).
  PauseAtEntry(context, MayPauseXY(context));
  Go(context, to,
     {.speed_mm_s = registers.z_speed,
      .use = UseOfHeight(physical_.z, logical_.z, registers.tool_down),
      .dwells = true});
}

void Carriage::MoveXYCut(Context context, double x, double y) {
  const Point to{x, y, logical_.z, logical_.a};
  if (SamePoint(logical_, to, zero_)) return;
  FollowXY(context, to);
  Settle();
}

void Carriage::FollowXY(const Context& context, const Point& to) {
  const Registers& registers = context.registers;
  const Point from = logical_;
  logical_ = to;
  if (range_.HasXY(from) && range_.HasXY(to)) return GoTwoAxis(context, to);
  const double length = DistanceXYZ(from, to);
  const Share share = ShareInXY(range_, from, to);
  const bool follows = !share.empty() && (share.high - share.low) * length > zero_;
  if (follows) {
    const Point entry = range_.Nearest(Between(from, to, share.low));
    if (share.low > 0.0) {
      bool no_dwell = false;
      Recover(context, {entry.x, entry.y, entry.z, physical_.a},
              {.pass_z = WayAcross(context), .to_tool_height = true}, no_dwell);
      parked_ = false;
      PauseAtEntry(context, MayPauseXY(context));
    }
    GoTwoAxis(context, Between(from, to, share.high));
  }
  if (registers.tool_down) {
    const double all_of_it = HUGE_VAL;  // whatever its height: a tool that is down cuts
    const double low = follows ? share.low : 1.0;
    NoteLost(from, Between(from, to, low), all_of_it);
    if (follows) NoteLost(Between(from, to, share.high), to, all_of_it);
  }
  if (range_.HasXY(to)) return NoteClipped(share.low * length);
  NoteClipped(follows ? length * (1.0 - share.high + share.low) : length);
  if (follows || range_.HasXY(from)) LeaveXY(context);
}

void Carriage::GoTwoAxis(const Context& context, const Point& to) {
  Point end = range_.Nearest(to);
  end.a = physical_.a;
  Go(context, end, StrokeXY(context));
}

// The tool goes up at the boundary, so that it can come back over the work (RML1-5A.30, 5A.32).
void Carriage::LeaveXY(const Context& context) {
  outside_ = true;
  parked_ = true;
  if (!context.registers.tool_down) return;
  Point up = physical_;
  up.z = std::max(physical_.z, context.registers.up_z(context.profile));
  Go(context, up,
     {.speed_mm_s = context.registers.z_speed, .use = MotionUse::kRetract, .dwells = true});
}

void Carriage::MoveXYZCut(Context context, Point to) {
  if (SamePoint(logical_, to, zero_)) return;
  FollowXYZ(context, to);
  Settle();
}

void Carriage::FollowXYZ(const Context& context, const Point& to) {
  if (free_ && inside_.HasWithin(to)) {
    logical_ = to;
    parked_ = false;
    GoThreeAxis(context, to, true);
    return;
  }
  const Pieces pieces = Pieces::Cut(range_, logical_, to, zero_);
  logical_ = to;
  parked_ = false;
  bool dwell = true;  // one wait before the first motion of the set (RML1-3A.69)
  double beyond = 0.0;
  for (const Piece& piece : pieces.all()) {
    if (piece.region == Region::kInside) {
      Follow(context, piece, dwell);
      continue;
    }
    outside_ = true;
    beyond += DistanceXYZ(piece.from, piece.to);
    NoteLost(piece.from, piece.to, context.registers.surface_z);
    if (piece.region == Region::kBelow) Follow(context, piece, dwell);
  }
  TurnRotary(context, to.a, dwell);
  NoteClipped(beyond);
}

// A piece that the tool follows: inside, or sliding along the bottom.
void Carriage::Follow(const Context& context, const Piece& piece, bool& dwell) {
  const Point begin = range_.Nearest(piece.from);
  const Point end = range_.Nearest(piece.to);
  Recover(context, begin, {.pass_z = range_.top(), .to_tool_height = false}, dwell);
  if (piece.region == Region::kInside) PauseAtEntry(context, true);
  const bool moved = GoThreeAxis(context, end, dwell);
  dwell = dwell && !moved;
}

bool Carriage::GoThreeAxis(const Context& context, const Point& to, bool dwells) {
  const Registers& registers = context.registers;
  return Go(context, to,
            {.speed_mm_s = registers.z_speed,
             .use = UseOfThreeAxis(physical_, to, SameXY(physical_, to), registers.surface_z),
             .chain = Chain::kThreeAxis,
             .dwells = dwells});
}

// While the tool stands outside, A has fallen behind the line; it turns alone (RML1-9.30).
void Carriage::TurnRotary(const Context& context, double a, bool& dwell) {
  Point to = physical_;
  to.a = a;
  const Registers& registers = context.registers;
  const bool moved = Go(context, to,
                        {.speed_mm_s = registers.z_speed,
                         .use = to.z < registers.surface_z ? MotionUse::kCut : MotionUse::kTravel,
                         .dwells = dwell});
  dwell = dwell && !moved;
}

// Recovery of section 5A: Z alone where X and Y are right, else up to the pass height, across, and
// down. Up and across at the travel speed, down at the Z speed (RML1-9.28, RML1-9.53). `dwell`: a
// wait is due before the first motion. Two-dimensional commands wait before the one that ends at
// the tool height.
void Carriage::Recover(const Context& context, const Point& to, const Recovery& recovery,
                       bool& dwell) {
  const Registers& registers = context.registers;
  Approach(context, to, recovery, dwell);
  const bool into_work = recovery.to_tool_height ? registers.tool_down : to.z < registers.surface_z;
  const bool moved = Go(context, to,
                        {.speed_mm_s = registers.z_speed,
                         .use = UseOfHeight(physical_.z, to.z, into_work),
                         .dwells = recovery.to_tool_height || dwell});
  dwell = dwell && !moved;
}

// All of it but the way down. A catches up when the tool has been raised (RML1-9.57).
void Carriage::Approach(const Context& context, const Point& to, const Recovery& recovery,
                        bool& dwell) {
  const auto go = [&](const Point& next, MotionUse use, bool waits) {
    const bool moved = Go(context, next,
                          {.speed_mm_s = context.profile.travel_speed,
                           .use = use,
                           .rapid = true,
                           .dwells = waits || dwell});
    dwell = dwell && !moved;
  };
  const bool aside = !SameXY(physical_, to);
  Point up = physical_;
  up.z = std::max(physical_.z, aside ? recovery.pass_z : to.z);
  go(up, MotionUse::kRetract, recovery.to_tool_height && !aside);
  TurnRotary(context, to.a, dwell);
  go({to.x, to.y, physical_.z, physical_.a}, MotionUse::kTravel, false);
}

// Height of the way across of a two-dimensional command (RML1-5A.31, RML1-9.54).
double Carriage::WayAcross(const Context& context) const {
  return parked_ ? context.registers.up_z(context.profile) : range_.top();
}

// RML1-5A.36.
bool Carriage::MayPauseXY(const Context& context) const {
  return context.registers.z0 + context.registers.z2 <= range_.top();
}

void Carriage::MoveZ(const Context& context, double z) {
  Point to = physical_;
  to.z = z;
  if (SamePoint(physical_, to, zero_) && std::abs(logical_.z - z) <= zero_) return;
  Go(context, to,
     {.speed_mm_s = context.registers.z_speed,
      .use = UseOfThreeAxis(physical_, to, true, context.registers.surface_z)});
  logical_.z = z;
  parked_ = false;
  Settle();
}

void Carriage::RaiseForInitialise(const Context& context) {
  Point to = physical_;
  to.z = context.registers.up_z(context.profile);
  Go(context, to,
     {.speed_mm_s = context.registers.z_speed,
      .use = UseOfHeight(physical_.z, to.z, false),
      .starts_spindle = false});
  Place(physical_);
}

void Carriage::GoHome(const Context& context) {
  const double travel = context.profile.travel_speed;
  Point to = physical_;
  to.z = range_.top();
  Go(context, to,
     {.speed_mm_s = travel, .use = MotionUse::kRetract, .rapid = true, .starts_spindle = false});
  to = range_.Nearest({context.profile.origin_x, context.profile.origin_y, to.z, to.a});
  Go(context, to, {.speed_mm_s = travel, .rapid = true, .starts_spindle = false});
  Place(physical_);
}

// Returns whether there was a motion.
bool Carriage::Go(const Context& context, const Point& to, const Stroke& stroke) {
  if (SamePoint(physical_, to, zero_)) return false;
  Drive(context, to, stroke);
  return true;
}

// The commands are back in the range: RML1-5A.35, RML1-5A.36.
void Carriage::PauseAtEntry(const Context& context, bool allowed) {
  if (outside_ && allowed && context.profile.pause_outside) {
    context.queue.Push(Action::Kind::kPause).outside = true;
  }
  outside_ = false;
}

void Carriage::NoteClipped(double length) {
  if (!(length > zero_)) return;
  clipped_length_ += length;
  ++clipped_sets_;
}

// The part of a line below `surface_z`. Straight up cuts nothing.
void Carriage::NoteLost(const Point& from, const Point& to, double surface_z) {
  const bool up = SameXY(from, to) && to.z >= from.z;
  if (up || std::min(from.z, to.z) >= surface_z) return;
  Point a = from;
  Point b = to;
  if (a.z > surface_z) a = Between(from, to, (surface_z - from.z) / (to.z - from.z));
  if (b.z > surface_z) b = Between(from, to, (surface_z - from.z) / (to.z - from.z));
  const double length = DistanceXYZ(a, b);
  if (!(length > zero_)) return;
  lost_.length += length;
  if (lost_count_ < kLostLinesMax) lost_lines_[lost_count_++] = {a, b};
  for (const Point& p : {a, b}) {
    lost_.x_low = std::max(lost_.x_low, range_.x.low - p.x);
    lost_.x_high = std::max(lost_.x_high, p.x - range_.x.high);
    lost_.y_low = std::max(lost_.y_low, range_.y.low - p.y);
    lost_.y_high = std::max(lost_.y_high, p.y - range_.y.high);
    lost_.z_low = std::max(lost_.z_low, range_.bottom() - p.z);
    lost_.x.Add(p.x);
    lost_.y.Add(p.y);
    lost_.z.Add(p.z);
  }
}

// The tool goes down beyond the travel, or not as deep as the program says (RML1-9.23).
void Carriage::NoteLostDepth(const Context& context, double from_z) {
  const Registers& registers = context.registers;
  const double depth = registers.z0 + registers.z1;
  const double reached = range_.HasXY(logical_) ? range_.bottom() : from_z;
  Point from = logical_;
  Point to = logical_;
  from.z = reached;
  to.z = depth;
  NoteLost(from, to, registers.surface_z);
}

bool Carriage::SameXY(const Point& a, const Point& b) const {
  return DistanceXYZ({a.x, a.y}, {b.x, b.y}) <= zero_;
}

}  // namespace rmlcell::rml1
