#include <algorithm>
#include <span>
#include <vector>

#include "engine/motion/ride/interruption.h"
#include "engine/optimo/ride/ride.h"

// STOP, and START after it. motion.md 6, OPT-4.18
namespace rmlcell::optimo {

bool Ride::Stop() {
  std::vector<motion::PlannedMotion> ahead{s_.active->motion};
  std::vector<std::pair<std::size_t, motion::PlannedMark>> marks;  // each behind a motion
  for (const motion::PlannedItem& item : s_.timeline) {
    if (const auto* planned = std::get_if<motion::PlannedMotion>(&item)) {
      ahead.push_back(*planned);
    } else {
      marks.emplace_back(ahead.size() - 1, std::get<motion::PlannedMark>(item));
    }
  }
  const motion::StopOnPath stop = motion::StopAlong(
      ahead, ToSeconds(situation_.now - s_.active->start), parameters_.limits.axes);
  if (!stop.complete) return false;
  TellMotion(situation_.now);
  situation_.machine.axes = axes();
  s_.active.reset();
  s_.timeline.clear();
  const auto add_marks = [&](std::size_t behind, std::deque<motion::PlannedItem>& items) {
    for (const auto& [place, mark] : marks) {
      if (place == behind) items.emplace_back(mark);
    }
  };
  const std::size_t first = stop.index + 1 - std::min(stop.motions.size(), stop.index + 1);
  for (std::size_t n = 0; n < stop.motions.size(); ++n) {
    s_.timeline.emplace_back(stop.motions[n]);
    if (first + n < stop.index) add_marks(first + n, s_.timeline);
  }
  const std::span<const motion::PlannedMotion> left = std::span(ahead).subspan(stop.index);
  std::vector<motion::PlannedMotion> restart =
      motion::RestartAlong(left, stop.s, parameters_.limits.axes);
  if (!stop.motions.empty() && stop.motions.back().ends_move && !restart.empty()) {
    motion::PlannedMotion& settling = restart.front();  // all that is left of that move
    if (!(settling.path.length() > 0.0)) settling.ends_move = false;
  }
  s_.interrupted.clear();
  // RestartAlong leaves out the first motion when the machine stands at its end.
  const std::size_t dropped = left.size() - restart.size();
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (k >= dropped) s_.interrupted.emplace_back(restart[k - dropped]);
    add_marks(stop.index + k, s_.interrupted);
  }
  s_.halted_behind = situation_.place;  // beside a motion of /NEXT
  if (const MoveNote* note = NoteOf(left.front().tag); note != nullptr && !beside()) {
    s_.halted_behind = note->place;
  }
  s_.protocol.Stop();
  Start();
  return true;
}

machine::Place Ride::Rest() {
  s_.protocol.Rest();
  return s_.halted_behind;
}

void Ride::Resume() {
  const bool interrupted = !s_.interrupted.empty();
  s_.timeline.insert(s_.timeline.begin(), s_.interrupted.begin(), s_.interrupted.end());
  s_.interrupted.clear();
  PlanHeld();
  if (!busy()) s_.beside = Beside::kNo;
  const bool overridden = s_.protocol.Resume();
  if (interrupted && overridden) {
    Start();
    AdaptMotions();
  }
}

}  // namespace rmlcell::optimo
