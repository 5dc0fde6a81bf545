#include "engine/rml1/cut_watch.h"

#include <algorithm>
#include <cmath>

#include "engine/machine/shape.h"
#include "engine/motion/geometry/frames.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kAsAsked = 0.01;  // a speed within 1 % is the one asked for

// A rapid is several times as fast as a cut; feeds of one part for corners and finishing are not.
constexpr double kSlowShare = 0.5;

// Programs slow down 0.5 to 2 mm before they reach the material: less than this is no such
// approach.
constexpr double kApproach_mm = 0.2;
constexpr double kSummed_mm = 1e-6;  // rounding of lengths that are added up

constexpr double kSameHeight = 0.5 * Registers::kSameHeight;

// The share of a line that is not above a height.
double ShareNotAbove(const Point& from, const Point& to, double height) {
  const double low = std::min(from.z, to.z) - kSameHeight;
  const double high = std::max(from.z, to.z) - kSameHeight;
  if (high <= height) return 1.0;
  return std::max(0.0, (height - low) / (high - low));
}

// By V, which lifts have, too; F (VS) is of cuts alone.
bool Fast(const CutWatch::Ride& ride) {
  return !ride.by_xy_speed && ride.speed_mm_s >= machine::kTravelShareOfZ * ride.fastest_z_mm_s;
}

double Across(const CutWatch::Ride& ride) {
  return motion::LengthOf({ride.to.x - ride.from.x, ride.to.y - ride.from.y});
}

// A run has what rounding leaves of a place behind an oblique motion: straight up is no way across.
bool GoesAcross(const CutWatch::Ride& ride) { return Across(ride) > kSameHeight; }

// More down than across.
bool DropsSteeply(const CutWatch::Ride& ride) {
  if (ride.plunge) return true;
  if (!ride.in_work || ride.from.a != ride.to.a) return false;
  const double drop = ride.from.z - ride.to.z;
  // No way is shorter across than along one axis: most cuts need no more than that.
  if (drop <= std::abs(ride.to.x - ride.from.x)) return false;
  return drop > Across(ride);
}

bool RisesSteeply(const CutWatch::Ride& ride) { return ride.to.z - ride.from.z > Across(ride); }

double Below_mm(const CutWatch::Ride& ride, double height) {
  return ShareNotAbove(ride.from, ride.to, height - 2.0 * kSameHeight) * ride.length_mm;
}

// Along the surface nothing is cut: pens and drag knives go there with the spindle off.
double BelowSurface_mm(const CutWatch::Ride& ride, const Registers& registers) {
  return Below_mm(ride, registers.surface_z);
}

}  // namespace

void CutWatch::OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  const bool down = DropsSteeply(ride);
  if (!down && (fast_so_far_.mm > 0.0 || slow_mm_ > 0.0)) EndWayDown(ride);
  OnVisit(ride, registers, command, down);
  OnPlace(ride, registers, command);
  if (ride.in_work) {
    if (!(down && Fast(ride))) EndAlong(ride.speed_mm_s);
    if (!down) cut_mm_s_ = std::max(cut_mm_s_, ride.speed_mm_s);
    if (down) OnWayDown(ride, registers, command);
    OnCut(ride, registers, command);
    cutting_ = !down || cutting_;
    deepest_ = std::min({deepest_, ride.from.z, ride.to.z});
    return;
  }
  cutting_ = false;
  if (GoesAcross(ride)) OnTravel(ride, registers, command);
}

void CutWatch::OnCut(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  has_cut_ = true;
  from_work_ = {};
  if (ride.spindle_turns && ride.along_surface) Add(skims_, ride.length_mm, command);
  const bool given = ride.by_xy_speed ? registers.xy_speed_given : registers.z_speed_given;
  const SpeedLimit& limit = ride.by_xy_speed ? registers.xy_limit : registers.z_limit;
  const bool limited = limit.off() > kAsAsked || registers.rpm_limit.off() > kAsAsked;
  const bool sure = ride.spindle_turns && registers.rotation_given && given && !limited;
  if (sure && !ride.plunge) return;
  const double mm = BelowSurface_mm(ride, registers);
  if (!ride.spindle_turns) Add(spindle_stands_, mm, command);
  if (!given) Add(feed_not_given_, mm, command);
  if (!registers.rotation_given) Add(rotation_not_given_, mm, command);
  const bool slower_down = ride.plunge && limit.used < limit.asked;
  if (!slower_down) AddLimited(feed_limited_, limit, mm, command);
  if (ride.spindle_turns) AddLimited(rpm_limited_, registers.rpm_limit, mm, command);
}

void CutWatch::OnWayDown(const Ride& ride, const Registers& registers,
                         const CommandPlace& command) {
  const double mm = BelowSurface_mm(ride, registers);
  if (Fast(ride) && !cutting_) {
    Add(fast_so_far_, mm, command);
    Add(uncleared_, Below_mm(ride, std::min(registers.surface_z, deepest_)), command);
    fast_mm_s_ = ride.speed_mm_s;
  } else {
    fast_so_far_ = {};
    slow_mm_ += ride.length_mm;
    if (slow_mm_ < kApproach_mm - kSummed_mm) return;
    Join(taken_for_cleared_, uncleared_);
    uncleared_ = {};
  }
}

// `next` is a cut, or leads up and away.
void CutWatch::EndWayDown(const Ride& next) {
  if (slow_mm_ > 0.0) {
    Join(fast_plunge_, uncleared_);  // what is left: the approach was too short
  } else if (!next.in_work) {
    Add(fast_hole_, fast_so_far_.mm, fast_so_far_.first);
  } else if (next.speed_mm_s < fast_mm_s_) {
    Add(fast_plunge_, fast_so_far_.mm, fast_so_far_.first);
  }
  fast_so_far_ = {};
  uncleared_ = {};
  slow_mm_ = 0.0;
}

CutWatch::Way CutWatch::fast_plunge() const {
  Way way = fast_plunge_;
  if (slow_mm_ > 0.0) Join(way, uncleared_);
  if (cut_mm_s_ < fast_mm_s_) Join(way, fast_hole_);
  return way;
}

void CutWatch::OnVisit(const Ride& ride, const Registers& registers, const CommandPlace& command,
                       bool down) {
  const double mm = ride.in_work ? BelowSurface_mm(ride, registers) : 0.0;
  if (mm > 0.0) {
    const bool enters = down ? !visit_.crosses : !visit_.entered;
    if (enters) visit_.enters_fast = Fast(ride);
    visit_.entered = true;
    if (!down) {
      visit_.crosses = true;
      OnCrossing(ride, mm, command);
    }
  }
  if (!registers.IsBelowSurface(ride.to.z)) EndVisit();
}

void CutWatch::OnCrossing(const Ride& ride, double mm, const CommandPlace& command) {
  if (Fast(ride) && !RisesSteeply(ride)) {
    Add(visit_.fast, mm, command);
    visit_.fast_mm_s = std::min(visit_.fast_mm_s, ride.speed_mm_s);
  } else if (ride.to.z > ride.from.z - kSameHeight) {
    visit_.slowest_mm_s = std::min(visit_.slowest_mm_s, ride.speed_mm_s);
  }
}

void CutWatch::EndVisit() {
  if (visit_.slowest_mm_s <= kSlowShare * visit_.fast_mm_s) {
    Join(fast_among_slow_, visit_.fast);
  } else if (visit_.enters_fast) {
    Join(fast_visits_, visit_.fast);
    fast_visits_mm_s_ = std::min(fast_visits_mm_s_, visit_.fast_mm_s);
  }
  slowest_mm_s_ = std::min(slowest_mm_s_, visit_.slowest_mm_s);
  visit_ = {};
}

CutWatch::Way CutWatch::fast_across() const {
  CutWatch ended = *this;
  ended.EndVisit();
  Way way = ended.fast_among_slow_;
  if (ended.slowest_mm_s_ <= kSlowShare * ended.fast_visits_mm_s_) Join(way, ended.fast_visits_);
  return way;
}

void CutWatch::OnTravel(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  if (ride.rapid) {
    const double share = ShareNotAbove(ride.from, ride.to, registers.surface_z);
    Add(no_clearance_, share * ride.length_mm, command);
  } else if (Fast(ride)) {
    const double share = ShareNotAbove(ride.from, ride.to, registers.surface_z);
    Add(along_, share * ride.length_mm, command);
    if (share > 0.0) along_mm_s_ = std::min(along_mm_s_, ride.speed_mm_s);
  }
  if (ride.clamps_height > 0.0) {
    const double below = registers.surface_z + ride.clamps_height - 2.0 * kSameHeight;
    const double share = ShareNotAbove(ride.from, ride.to, below);
    Add(has_cut_ ? from_work_ : to_work_, share * ride.length_mm, command);
  }
}

// `next_mm_s`: of the cut or slow plunge that follows.
void CutWatch::EndAlong(double next_mm_s) {
  const bool slow = std::max(before_mm_s_, next_mm_s) <= kSlowShare * along_mm_s_;
  if (slow) Join(no_clearance_, along_);
  along_ = {};
  along_mm_s_ = kNone;
  before_mm_s_ = next_mm_s;
}

CutWatch::Way CutWatch::no_clearance() const {
  CutWatch ended = *this;
  if (before_mm_s_ > 0.0) ended.EndAlong(0.0);  // else nothing tells it from a cut
  return ended.no_clearance_;
}

// A way across ends where its set says, and begins where the one before it ended.
void CutWatch::OnPlace(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  if (place_known_) return;
  const std::uint64_t given_by = registers.place_given_by;
  const bool known = given_by != 0 && given_by < registers.act;
  if (ride.in_work && !known) Add(place_not_given_, BelowSurface_mm(ride, registers), command);
  place_known_ = known || (given_by != 0 && GoesAcross(ride));
}

CutWatch::Way CutWatch::below_clamps() const {
  return {.mm = to_work_.mm + from_work_.mm,
          .first = to_work_.mm > 0.0 ? to_work_.first : from_work_.first};
}

void CutWatch::Add(Way& way, double mm, const CommandPlace& command) {
  if (!(mm > 0.0)) return;
  if (!(way.mm > 0.0)) way.first = command;
  way.mm += mm;
}

void CutWatch::Join(Way& way, const Way& other) {
  if (!(other.mm > 0.0)) return;
  if (!(way.mm > 0.0) || other.first.number < way.first.number) way.first = other.first;
  way.mm += other.mm;
}

void CutWatch::AddLimited(LimitedWay& way, const SpeedLimit& limit, double mm,
                          const CommandPlace& command) {
  if (!(mm > 0.0) || !(limit.off() > kAsAsked)) return;
  if (limit.off() > way.worst.off()) way.worst = limit;
  Add(way, mm, command);
}

}  // namespace rmlcell::rml1
