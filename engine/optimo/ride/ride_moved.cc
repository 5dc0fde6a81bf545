#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "engine/optimo/machine/motion_errors.h"
#include "engine/optimo/ride/ride.h"

// The machine moved by hand while the run stands: what is left is planned anew from there.
// OPT-6.42, LIVE-5.06
namespace rmlcell::optimo {
namespace {

std::uint64_t TagOf(const motion::PlannedItem& item) {
  return std::visit([](const auto& one) { return one.tag; }, item);
}

}  // namespace

// Of a passage that the planner still holds back nobody knows here.
bool Ride::may_be_moved() const {
  return !busy() && (!passing() || !s_.path.interrupted().empty() || !s_.path.held().empty());
}

void Ride::MoveTo(const motion::AxisPose& axes) {
  if (!s_.moved_from) s_.moved_from = s_.axes;
  s_.axes = axes;
  if (s_.path.interrupted().empty() && s_.path.held().empty()) s_.planned_axes = axes;
}

// What of the motions is left to do, as it was appended; of a circle outside of a passage, what a
// STOP left of it.
std::vector<motion::AppendedCommand> Ride::NotOver() const {
  std::vector<motion::AppendedCommand> rest;
  const auto& interrupted = s_.path.interrupted();
  if (!interrupted.empty()) {
    const std::uint64_t first = TagOf(interrupted.front());
    std::ranges::copy_if(
        s_.path.appended(), std::back_inserter(rest),
        [first](const motion::AppendedCommand& command) { return command.tag >= first; });
  }
  if (rest.empty()) {
    for (const motion::PlannedItem& item : interrupted) {
      const std::uint64_t tag = TagOf(item);
      const auto command = std::ranges::find(s_.alone, tag, &motion::AppendedCommand::tag);
      if (command == s_.alone.end()) {
        rest.push_back({.tag = tag, .move = std::nullopt});
      } else if (rest.empty() || rest.back().tag != tag) {
        rest.push_back(*command);
        const motion::PathPiece& left = std::get<motion::PlannedMotion>(item).path;
        if (left.kind() == motion::PathPiece::Kind::kArc) rest.back().move->path = left;
      }
    }
  }
  std::ranges::copy(s_.path.held(), std::back_inserter(rest));
  return rest;
}

Status Ride::GoFromHere() {
  const std::optional<motion::AxisPose> from = std::exchange(s_.moved_from, std::nullopt);
  if (!from || *from == s_.axes) return {};
  std::vector<motion::AppendedCommand> rest = NotOver();
  const auto first = std::ranges::find_if(
      rest, [](const motion::AppendedCommand& command) { return command.move.has_value(); });
  if (first == rest.end()) {
    s_.planned_axes = s_.axes;
    return {};
  }
  const std::uint64_t from_tag = rest.front().tag;
  for (motion::AppendedCommand& item : rest) {
    // ZERO goes by no override: OPT-4.51
    if (item.move && NoteOf(item.tag)->speed_percent > 0.0) AdaptToOverride(item);
  }
  Status begins = BeginHere(rest, static_cast<std::size_t>(first - rest.begin()));
  if (!begins) {
    rest.clear();
    s_.planned_axes = s_.axes;
    s_.program = GoesOn::kNo;
  }
  s_.path.HoldBack(from_tag, std::move(rest));
  s_.planner = motion::Planner(parameters_.limits);
  return begins;
}

// The first command of what is left begins where the machine stands.
Status Ride::BeginHere(std::vector<motion::AppendedCommand>& rest, std::size_t first) {
  motion::MoveCommand& command = *rest[first].move;
  const MoveNote& note = *NoteOf(rest[first].tag);
  const bool arc = command.path.kind() == motion::PathPiece::Kind::kArc;
  if (arc && note.via) {
    const Result<motion::PathPiece::Arc3> through =
        motion::PathPiece::ArcThrough(command.head.TipOf(s_.axes), *note.via,
                                      motion::TipOn(command.path, command.head, command.path.to()));
    if (!through) return OnOptimo(through.error());
    command.path = through->path;
  } else if (arc) {
    LeadBack(rest, first);
  } else {
    const motion::PathPose here = command.path.in_axes()
                                      ? motion::PathPose(s_.axes)
                                      : motion::PathPose(command.head.TipOf(s_.axes));
    command.path = command.path.StraightFrom(here);
  }
  if (note.speed_percent <= 0.0) return {};
  const Result<std::vector<BeyondTravel>> inside = travel_.Look(rest[first].move->path, note.place);
  if (!inside) return inside.error();
  return {};
}

// Straight to where the circle was left. What was before it is over, and with it the tag.
void Ride::LeadBack(std::vector<motion::AppendedCommand>& rest, std::size_t circle) {
  motion::AppendedCommand lead = rest[circle];
  lead.move->tag = --lead.tag;
  lead.move->path = motion::PathPiece::Line(
      lead.move->head.TipOf(s_.axes),
      motion::TipOn(lead.move->path, lead.move->head, lead.move->path.from()));
  lead.move->fly = false;
  lead.move->settles = false;
  MoveNote note = *NoteOf(rest[circle].tag);
  note.last = false;
  note.fly = false;
  while (!s_.notes.empty() && s_.notes.front().first <= lead.tag) s_.notes.pop_front();
  s_.notes.emplace_front(lead.tag, note);
  rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(circle), std::move(lead));
}

}  // namespace rmlcell::optimo
