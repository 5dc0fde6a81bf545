#include "engine/simulation/report/slow_move_list.h"

namespace rmlcell::simulation {
namespace {

bool IsSlower(double reached, double wanted, double than_reached, double than_wanted) {
  return reached * than_wanted < than_reached * wanted;
}

std::uint64_t& CounterOf(SpeedShortfall& shortfall, SlowCause cause) {
  switch (cause) {
    case SlowCause::kAxis:
      return shortfall.by_axis;
    case SlowCause::kRadius:
      return shortfall.by_radius;
    case SlowCause::kAcceleration:
      return shortfall.by_acceleration;
    case SlowCause::kShort:
      break;
  }
  return shortfall.too_short;
}

}  // namespace

std::string_view SlowCauseText(SlowCause cause) {
  switch (cause) {
    case SlowCause::kAxis:
      return "axis";
    case SlowCause::kRadius:
      return "radius";
    case SlowCause::kAcceleration:
      return "acceleration";
    case SlowCause::kShort:
      break;
  }
  return "short";
}

void Count(const SlowMove& move, SpeedShortfall& shortfall) {
  if (shortfall.moves == 0 || IsSlower(move.reached_mm_s, move.wanted_mm_s, shortfall.reached_mm_s,
                                       shortfall.wanted_mm_s)) {
    shortfall.worst = move.place;
    shortfall.wanted_mm_s = move.wanted_mm_s;
    shortfall.reached_mm_s = move.reached_mm_s;
  }
  ++shortfall.moves;
  ++CounterOf(shortfall, move.cause);
}

void SlowMoveList::Add(const SlowMove& move) {
  const std::pair key{move.place.program, move.place.step};
  const auto found = index_.find(key);
  if (found != index_.end()) {
    SlowMove& known = moves_[found->second];
    const std::uint64_t count = known.count + 1;
    if (IsSlower(move.reached_mm_s, move.wanted_mm_s, known.reached_mm_s, known.wanted_mm_s)) {
      known = move;
    }
    known.count = count;
    return;
  }
  if (moves_.size() >= kReportedSlowMovesMax) {
    ++dropped_;
    return;
  }
  index_.emplace(key, moves_.size());
  moves_.push_back(move);
}

}  // namespace rmlcell::simulation
