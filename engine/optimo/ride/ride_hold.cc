#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "engine/motion/ride/interruption.h"
#include "engine/optimo/ride/motion_place.h"
#include "engine/optimo/ride/ride.h"

// HOLD inside a chain of /FLY passages: the move under way becomes exact. The program has run ahead
// by then; what it appended behind that move waits, and is planned anew at START. motion.md 6,
// OPT-4.17
namespace rmlcell::optimo {

void Ride::Hold() {
  // Behind a move that ends where it is nothing follows.
  if (under_way() == nullptr || under_way()->ended || !protocol().may_hold()) return;
  motion::MotionUnderWay& active = *s_.path.under_way();
  std::vector<motion::PlannedItem> kept;  // between the motion under way and the exact one
  motion::PlannedMotion exact = active.motion;
  motion::PathState state = active.At(situation_.now);
  auto next = s_.path.to_come().begin();
  const std::uint64_t own = exact.tag;
  std::uint64_t following = own;  // the move after it
  for (bool under_way = true;; under_way = false) {
    if (exact.tag != own && following == own) following = exact.tag;
    // Neither of the two is long enough: braking takes more of them.
    if (exact.tag > following) return HoldOverManyMoves();
    const auto& appended = s_.path.appended();
    const bool last = appended.empty() || appended.back().tag <= exact.tag;
    const motion::MoveCommand* command = s_.path.Appended(exact.tag);
    if (last || command == nullptr) return;
    if (exact.speed.end().speed <= 0.0 && NoteOf(exact.tag)->last) {
      // It stands at this target anyway: where the path turns back, before what cannot be passed.
      exact.settling_s = parameters_.limits.settling_s;
      if (under_way) {
        active.motion.settling_s = exact.settling_s;
        active.end = active.arrival + FromSeconds(exact.settling_s);
      } else {
        kept.emplace_back(exact);
      }
      return HoldBehind(exact.tag, std::move(kept));
    }
    if (const std::optional<PlaceOnMove> place = PlaceOf(exact.path, command->path)) {
      const double way = (command->path.length() - place->begin) / place->scale - state.s;
      if (way > 0.0 && motion::FromFits(state, state.s + way, 0.0, exact.limits)) {
        exact.path = RestOfMove(command->path, *place, state.s);
        const double length = exact.path.length();
        exact.speed = motion::SpeedProfile::From(
            {.s = 0.0, .speed = state.speed, .acceleration = state.acceleration}, length, 0.0,
            exact.limits);
        exact.settling_s = parameters_.limits.settling_s;
        exact.ends_move = true;
        exact.corner = {};
        if (under_way) {
          TellMotion(situation_.now);
          active.motion = exact;
          active.Begin(situation_.now);
        } else {
          kept.emplace_back(exact);
        }
        return HoldBehind(exact.tag, std::move(kept));
      }
    }
    if (!under_way) kept.emplace_back(exact);
    state = exact.speed.end();
    state.s = 0.0;
    for (; next != s_.path.to_come().end() && std::holds_alternative<motion::PlannedMark>(*next);
         ++next) {
      kept.push_back(*next);
    }
    if (next == s_.path.to_come().end()) return;
    exact = std::get<motion::PlannedMotion>(*next++);
  }
}

// Where moves are too short to come to rest on one of them: the first target that can be reached at
// rest, over as many of them as that takes.
void Ride::HoldOverManyMoves() {
  std::vector<motion::PlannedItem> kept;
  ChainPlace place{
      .motion = under_way()->motion, .state = under_way()->At(situation_.now), .under_way = true};
  std::optional<Onward> onward;
  for (auto next = s_.path.to_come().begin();; ++next) {
    const motion::MoveCommand* command = s_.path.Appended(place.motion.tag);
    if (command == nullptr) return;
    onward = OnwardFrom(place, *command, motion::kLargest);
    if (onward) break;
    if (!place.under_way) kept.emplace_back(place.motion);
    for (; next != s_.path.to_come().end() && std::holds_alternative<motion::PlannedMark>(*next);
         ++next) {
      kept.push_back(*next);
    }
    if (next == s_.path.to_come().end()) return;
    place = {.motion = std::get<motion::PlannedMotion>(*next), .state = {}, .under_way = false};
    place.state = place.motion.speed.At(0.0);
  }
  // With the chain cut off behind the nth move; the more of them, the easier.
  const auto& appended = s_.path.appended();
  const std::vector<motion::AppendedCommand> later(
      appended.begin() + static_cast<std::ptrdiff_t>(onward->own) + 1, appended.end());
  std::vector<std::size_t> ends;  // behind each move
  for (std::size_t n = 0; n < later.size(); ++n) {
    if (later[n].move) ends.push_back(n + 1);
  }
  const auto planned = [&](std::size_t moves) {
    return PlanOnward(*onward, std::span(later).first(ends[moves - 1]));
  };
  std::size_t too_few = 0;
  std::size_t enough = 1;
  while (enough < ends.size() && !planned(enough)) {
    too_few = enough;
    enough = std::min(2 * enough, ends.size());
  }
  while (enough > too_few + 1) {
    const std::size_t middle = too_few + (enough - too_few) / 2;
    (planned(middle) ? enough : too_few) = middle;
  }
  if (enough >= ends.size()) return;           // it ends by itself as soon
  motion::Planner planner = *planned(enough);  // as it was seen to be
  const std::uint64_t target = later[ends[enough - 1] - 1].tag;
  s_.halted_behind = NoteOf(target)->place;
  GoOnward(place, *onward, std::move(kept));
  planner.Stop();
  while (std::optional<motion::PlannedItem> item = planner.Next()) s_.path.Plan(*std::move(item));
  HoldCommandsBehind(target);
  Start();
}

// The move of this tag is the last one before the halt; everything that was appended behind it is
// held back.
void Ride::HoldBehind(std::uint64_t tag, std::vector<motion::PlannedItem> kept) {
  s_.halted_behind = NoteOf(tag)->place;
  s_.path.ReplaceToCome(std::move(kept));
  HoldCommandsBehind(tag);
}

void Ride::HoldCommandsBehind(std::uint64_t target) {
  s_.path.HoldBehind(target);
  s_.planner = motion::Planner(parameters_.limits);
}

// START after such a HOLD: the moves that were held back, from rest.
void Ride::PlanHeld() {
  if (s_.path.held().empty()) return;
  const bool alone = !s_.alone.empty() && s_.path.held().front().tag <= s_.alone.back().tag;
  for (motion::AppendedCommand& item : s_.path.TakeHeld()) {
    if (!item.move) {
      s_.planner.Mark(item.tag);
    } else {
      // It was accepted before, with the same limits.
      RMLCELL_CHECK(bool(s_.planner.Append(*item.move)));
    }
    if (!alone) s_.path.Append(std::move(item));
  }
  if (!passing()) s_.planner.Stop();
  Drain();
}

}  // namespace rmlcell::optimo
