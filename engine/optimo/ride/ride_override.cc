#include "engine/optimo/ride/ride.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "engine/motion/ride/interruption.h"
#include "engine/optimo/ride/lead.h"
#include "engine/optimo/ride/motion_place.h"

// The override changed while the machine moves. motion.md 6, OPT-4.38
namespace rmlcell::optimo {

namespace {

constexpr double kLeft = 1e-3;  // mm; of sigma: less of a move is not worth a plan

}  // namespace

void Ride::ChangeOverride(double percent) {
  if (!(percent > 0.0) || percent == s_.override_percent) return;
  s_.override_percent = percent;
  s_.path.ChangeHeld([&](motion::AppendedCommand& item) { AdaptToOverride(item); });
  if (protocol().Override()) AdaptMotions();
}

// The motions planned with another override, from the one under way on.
void Ride::AdaptMotions() {
  s_.override_owed = false;
  if (!moves() || under_way()->ended) return;
  if (ReplanChain()) return;
  motion::MotionUnderWay& active = *s_.path.under_way();
  if (active.motion.speed.end().speed > 0.0) {
    // More may be planned when the next motion begins; in a long chain that would change nothing.
    constexpr std::size_t kFew = 256;
    s_.override_owed = s_.path.to_come().size() <= kFew;
    return;
  }
  if (s_.note.speed_percent <= 0.0) return;
  motion::MoveCommand command;
  command.kind = s_.note.kind;
  command.path = active.motion.path;
  command.head = active.motion.head;
  command.speed_fraction = FractionOf(s_.note);
  command.acceleration_fraction = s_.note.accel_fraction;
  // The axes may have more room at the new speed; until that is reached the old limits hold.
  motion::PathLimits limits = motion::LimitsOf(command, parameters_.limits);
  limits.acceleration = std::min(limits.acceleration, active.motion.limits.acceleration);
  const motion::PathState here = active.At(situation_.now);
  const double length = active.motion.path.length();
  if (!motion::FromFits(here, length, 0.0, limits)) return;
  TellMotion(situation_.now);
  motion::SpeedProfile changed = motion::SpeedProfile::From(here, length, 0.0, limits);
  active.motion.limits = limits;
  active.motion.path = active.motion.path.Part(here.s, length);
  active.motion.speed = changed.Part(here.s, length);
  active.Begin(situation_.now);
}

double Ride::FractionOf(const MoveNote& note) const {
  return std::min(note.speed_percent * s_.override_percent * 1e-4, 1.0);
}

// A command that was appended with another override, and what is told of its feed rate.
void Ride::AdaptToOverride(motion::AppendedCommand& item) {
  MoveNote* note = NoteOf(item.tag);
  if (note == nullptr) return;  // a mark
  item.move->speed_fraction = FractionOf(*note);
  if (note->feed_mm_s > 0.0) {
    note->feed_mm_s = item.move->speed_fraction * parameters_.limits.tip_speed_mm_s;
  }
}

// From the first place on where that is possible; false: there is none.
bool Ride::ReplanChain() {
  std::vector<motion::PlannedItem> kept;  // between the motion under way and that place
  motion::PlannedMotion here = under_way()->motion;
  motion::PathState state = under_way()->At(situation_.now);
  LongLead lead;  // from a motion before that place
  auto next = s_.path.to_come().begin();
  for (bool under_way = true;; under_way = false) {
    if (ReplanFrom({.motion = here, .state = state, .under_way = under_way}, kept)) return true;
    if (here.path.in_axes()) {
      lead.way.reset();
    } else {
      if (lead.way) {
        lead.way->Add(here);
        if (ReplanAlong(lead, here, kept)) return true;
      }
      if (!lead.way && state.s < here.path.length()) {
        lead.way.emplace(here, state);
        lead.under_way = under_way;
        lead.first = kept.size();
        lead.share = 1.0;
      }
    }
    if (!under_way) kept.emplace_back(here);
    state = here.speed.end();
    state.s = 0.0;
    for (; next != s_.path.to_come().end() && std::holds_alternative<motion::PlannedMark>(*next);
         ++next) {
      kept.push_back(*next);
    }
    if (next == s_.path.to_come().end()) return false;
    here = std::get<motion::PlannedMotion>(*next++);
  }
}

// The command of a motion under the override of now; nothing: it is over.
std::optional<motion::AppendedCommand> Ride::UnderOverride(std::uint64_t tag) {
  const motion::MoveCommand* command = s_.path.Appended(tag);
  if (command == nullptr) return std::nullopt;
  motion::AppendedCommand adapted{.tag = tag, .move = *command};
  AdaptToOverride(adapted);
  return adapted;
}

std::size_t Ride::PlaceOfAppended(std::uint64_t tag) const {
  const auto& appended = s_.path.appended();
  const auto own = std::ranges::lower_bound(appended, tag, {}, &motion::AppendedCommand::tag);
  return static_cast<std::size_t>(own - appended.begin());
}

// False: not from this motion. Nothing has changed then.
bool Ride::ReplanFrom(const ChainPlace& place, const std::vector<motion::PlannedItem>& kept) {
  const std::optional<motion::AppendedCommand> rest = UnderOverride(place.motion.tag);
  if (!rest) return false;
  const double speed = motion::LimitsOf(*rest->move, parameters_.limits).speed;
  const std::optional<Onward> onward = OnwardFrom(place, *rest->move, speed);
  return onward && TakeOnward(*onward, *rest, [&] { GoOnward(place, *onward, kept); });
}

// False: the long lead does not end on this motion, its last one; or cannot be taken, then there is
// none any more. Nothing else has changed then.
bool Ride::ReplanAlong(LongLead& lead, const motion::PlannedMotion& last,
                       const std::vector<motion::PlannedItem>& kept) {
  const std::optional<motion::AppendedCommand> rest = UnderOverride(last.tag);
  if (!rest) return false;
  const double speed = motion::LimitsOf(*rest->move, parameters_.limits).speed;
  const bool lower = rest->move->speed_fraction < s_.path.Appended(last.tag)->speed_fraction;
  constexpr double kShareLeast = 0.1;  // four plans, each as dear as what is planned is long
  while (lead.share > kShareLeast && !lead.way->SlowsTo(lead.share * speed)) lead.share *= 0.5;
  if (!lower || lead.share <= kShareLeast) {
    lead.way.reset();
    return false;
  }
  const std::optional<PlaceOnMove> on_move = PlaceOf(last.path, rest->move->path);
  const auto end = lead.way->EndOnLast(lead.share * speed);
  if (!on_move || !end) return false;
  const double begin = on_move->begin + end->s;
  if (begin > rest->move->path.length() - kLeft) return false;
  std::vector<motion::PlannedMotion> motions = lead.way->MotionsTo(*end, parameters_.limits.axes);
  if (motions.empty()) {
    lead.way.reset();
    return false;
  }
  Onward onward{.own = PlaceOfAppended(last.tag),
                .speed = end->speed,
                .speed_on_move = end->speed,
                .first = *rest->move};
  onward.first.path = rest->move->path.Part(begin, rest->move->path.length());
  if (TakeOnward(onward, *rest, [&] { GoAlong(lead, std::move(motions), kept); })) return true;
  lead.share *= 0.5;
  return false;
}

// What is left of its own command, and those behind it, are planned anew, and `go` leads there.
template <class Go>  // void()
bool Ride::TakeOnward(const Onward& onward, const motion::AppendedCommand& rest, Go go) {
  const auto& appended = s_.path.appended();
  std::vector<motion::AppendedCommand> onwards(
      appended.begin() + static_cast<std::ptrdiff_t>(onward.own), appended.end());
  onwards.front() = rest;
  const std::span later = std::span(onwards).subspan(1);
  for (motion::AppendedCommand& item : later) AdaptToOverride(item);
  std::optional<motion::Planner> planner = PlanOnward(onward, later);
  if (!planner) return false;
  if (!passing()) planner->Stop();
  s_.path.ReplaceAppended(onward.own, onwards);
  go();
  s_.planner = *std::move(planner);
  Drain();
  Start();
  return true;
}

// How the chain could go on from here under `command`, not faster than `speed`; nothing when it
// cannot.
std::optional<Ride::Onward> Ride::OnwardFrom(const ChainPlace& place,
                                             const motion::MoveCommand& command,
                                             double speed) const {
  const motion::PlannedMotion& here = place.motion;
  const std::optional<PlaceOnMove> on_move = PlaceOf(here.path, command.path);
  if (!on_move) return std::nullopt;
  const Lead lead = LeadFrom(place.state, here.limits, speed / on_move->scale);
  motion::PathLimits limits = here.limits;
  limits.speed = std::max(limits.speed, lead.speed);
  const double end = place.state.s + lead.length;
  if (!motion::FromFits(place.state, end, lead.speed, limits)) return std::nullopt;
  const double begin = on_move->begin + end * on_move->scale;
  if (end > here.path.length() || begin > command.path.length() - kLeft) return std::nullopt;
  Onward onward{.own = PlaceOfAppended(here.tag),
                .lead_length = lead.length,
                .speed = lead.speed,
                .speed_on_move = lead.speed * on_move->scale,
                .first = command};
  onward.first.path = command.path.Part(begin, command.path.length());
  if (here.path.in_axes()) {  // the planner measures by the time at the new full speed
    onward.measure = on_move->scale / motion::LimitsOf(onward.first, parameters_.limits).speed;
  }
  return onward;
}

// Nothing when what follows cannot be met from there, even if the chain ended with `later`.
std::optional<motion::Planner> Ride::PlanOnward(
    const Onward& onward, std::span<const motion::AppendedCommand> later) const {
  motion::Planner planner(parameters_.limits);
  planner.BeginMoving(onward.speed_on_move);
  if (!planner.Append(onward.first)) return std::nullopt;
  for (const motion::AppendedCommand& item : later) {
    if (!item.move) {
      planner.Mark(item.tag);
    } else if (!planner.Append(*item.move)) {
      return std::nullopt;
    }
  }
  motion::Planner trial = planner;
  trial.Stop();
  if (!trial.Next() || trial.starts_too_fast()) return std::nullopt;
  return planner;
}

// The way to the place where the new plan begins takes the place of what was planned.
void Ride::GoOnward(const ChainPlace& place, const Onward& onward,
                    std::vector<motion::PlannedItem> kept) {
  if (place.under_way) TellMotion(situation_.now);
  s_.path.ReplaceToCome(std::move(kept));
  if (onward.lead_length > 0.0) {
    const motion::PlannedMotion& here = place.motion;
    motion::PlannedMotion lead = here;
    lead.path = here.path.Part(place.state.s, place.state.s + onward.lead_length);
    motion::PathLimits limits = here.limits;
    limits.speed = onward.speed;
    motion::PathState state = place.state;
    state.s = 0.0;
    lead.speed = motion::SpeedProfile::From(state, onward.lead_length, onward.speed, limits);
    lead.settling_s = 0.0;
    lead.ends_move = false;
    lead.corner = {};
    if (place.under_way) {
      s_.path.under_way()->motion = lead;
      s_.path.under_way()->Begin(situation_.now);
    } else {
      s_.path.Plan(lead);
    }
  } else if (place.under_way) {
    s_.axes = axes();
    s_.path.Leave();
  }
  // One measure for the whole chain: a STOP runs from one motion into the next.
  s_.path.MeasureInAxesBy(onward.measure);
}

// The same over several motions.
void Ride::GoAlong(const LongLead& lead, std::vector<motion::PlannedMotion> motions,
                   const std::vector<motion::PlannedItem>& kept) {
  const auto first = kept.begin() + static_cast<std::ptrdiff_t>(lead.first);
  std::vector<motion::PlannedItem> items(kept.begin(), first);
  auto motion = motions.begin();
  if (lead.under_way) {
    TellMotion(situation_.now);
    s_.path.under_way()->motion = *motion++;
    s_.path.under_way()->Begin(situation_.now);
  }
  for (const motion::PlannedItem& item : std::span(first, kept.end())) {
    if (std::holds_alternative<motion::PlannedMark>(item)) {
      items.push_back(item);
    } else {
      items.emplace_back(*motion++);
    }
  }
  items.insert(items.end(), motion, motions.end());
  s_.path.ReplaceToCome(std::move(items));
}

}  // namespace rmlcell::optimo
