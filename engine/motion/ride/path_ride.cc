#include "engine/motion/ride/path_ride.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "engine/core/check.h"

namespace rmlcell::motion {

void PathRide::ReplaceToCome(std::vector<PlannedItem> items) {
  to_come_.assign(std::make_move_iterator(items.begin()), std::make_move_iterator(items.end()));
}

std::optional<std::uint64_t> PathRide::PassMark() {
  const auto* mark = to_come_.empty() ? nullptr : std::get_if<PlannedMark>(&to_come_.front());
  if (mark == nullptr) return std::nullopt;
  const std::uint64_t tag = mark->tag;
  to_come_.pop_front();
  return tag;
}

void PathRide::MeasureInAxesBy(double factor) {
  if (rides_ && under_way_.motion.path.in_axes()) under_way_.motion.MeasureBy(factor);
  for (PlannedItem& item : to_come_) {
    auto* planned = std::get_if<PlannedMotion>(&item);
    if (planned != nullptr && planned->path.in_axes()) planned->MeasureBy(factor);
  }
}

void PathRide::ReplaceAppended(std::size_t n, std::span<const AppendedCommand> commands) {
  RMLCELL_CHECK(n + commands.size() == appended_.size());
  std::ranges::copy(commands, appended_.begin() + static_cast<std::ptrdiff_t>(n));
}

MotionUnderWay& PathRide::Begin(SimTime now) {
  RMLCELL_CHECK(waits_to_begin());
  under_way_.motion = std::get<PlannedMotion>(std::move(to_come_.front()));
  under_way_.ended = ends_;
  to_come_.pop_front();
  under_way_.Begin(now);
  rides_ = true;
  return under_way_;
}

void PathRide::BeginInPlace(SimTime now, SimTime until) {
  under_way_.Begin(now, until);
  rides_ = true;
}

const MoveCommand* PathRide::Appended(std::uint64_t tag) const {
  const auto found = std::ranges::lower_bound(appended_, tag, {}, &AppendedCommand::tag);
  return found != appended_.end() && found->tag == tag && found->move ? &*found->move : nullptr;
}

void PathRide::ForgetBefore(std::uint64_t tag) {
  while (!appended_.empty() && appended_.front().tag < tag) appended_.pop_front();
}

std::optional<PathRide::StopPlan> PathRide::PlanStop(SimTime now, const AxisLimits& axes) const {
  RMLCELL_CHECK(rides_);
  StopPlan plan;
  plan.ahead.push_back(under_way_.motion);
  for (const PlannedItem& item : to_come_) {
    if (const auto* planned = std::get_if<PlannedMotion>(&item)) {
      plan.ahead.push_back(*planned);
    } else {
      plan.marks.emplace_back(plan.ahead.size() - 1, std::get<PlannedMark>(item));
    }
  }
  plan.ramp = StopAlong(plan.ahead, ToSeconds(now - under_way_.start), axes);
  if (!plan.ramp.complete) return std::nullopt;
  plan.rests_on = plan.ahead[plan.ramp.index].tag;
  return plan;
}

void PathRide::StopPlan::AddMarks(std::size_t behind, std::deque<PlannedItem>& items) const {
  for (const auto& [place, mark] : marks) {
    if (place == behind) items.emplace_back(mark);
  }
}

// The ramp and the marks on it are what is to come.
void PathRide::BeginRamp(const StopPlan& plan) {
  const StopOnPath& ramp = plan.ramp;
  rides_ = false;
  to_come_.clear();
  std::size_t passed = 0;
  // At the very end of the motion under way the ramp begins behind it.
  for (std::size_t left = ramp.index + 1; left > ramp.motions.size() && passed < ramp.index; --left)
    plan.AddMarks(passed++, to_come_);
  for (const PlannedMotion& motion : ramp.motions) {
    to_come_.emplace_back(motion);
    if (passed != ramp.index) plan.AddMarks(passed++, to_come_);
  }
}

void PathRide::Stop(const StopPlan& plan, const AxisLimits& axes) {
  const StopOnPath& ramp = plan.ramp;
  BeginRamp(plan);
  const std::span<const PlannedMotion> left = std::span(plan.ahead).subspan(ramp.index);
  std::vector<PlannedMotion> restart = RestartAlong(left, ramp.s, axes);
  // The move is over where its settling is all that is left.
  if ((ramp.motions.empty() || ramp.motions.back().ends_move) && !restart.empty()) {
    PlannedMotion& settling = restart.front();
    if (!(settling.path.length() > 0.0)) settling.ends_move = false;
  }
  interrupted_.clear();
  // RestartAlong leaves out the first motion when the machine stands at its end.
  const std::size_t dropped = left.size() - restart.size();
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (k >= dropped) interrupted_.emplace_back(restart[k - dropped]);
    plan.AddMarks(ramp.index + k, interrupted_);
  }
  protocol_.Stop();
}

void PathRide::EndBy(const StopPlan& plan) {
  BeginRamp(plan);
  if (plan.ramp.motions.empty()) {  // it stands already
    PlannedMotion standing = plan.ahead[plan.ramp.index];
    standing.path = standing.path.Standing(plan.ramp.s);
    standing.speed = SpeedProfile();
    standing.settling_s = 0.0;
    to_come_.emplace_back(standing);
  }
  PlannedMotion& last = std::get<PlannedMotion>(to_come_.back());
  last.ends_move = true;
  last.corner = {};
  interrupted_.clear();
  held_.clear();
  ends_ = true;
}

void PathRide::HoldBehind(std::uint64_t tag) {
  std::erase_if(appended_, [&](AppendedCommand& command) {
    if (command.tag <= tag) return false;
    held_.push_back(std::move(command));
    return true;
  });
  protocol_.Hold();
}

void PathRide::HoldBack(std::uint64_t from_tag, std::vector<AppendedCommand> commands) {
  std::erase_if(appended_, [&](const AppendedCommand& command) { return command.tag >= from_tag; });
  interrupted_.clear();
  held_.assign(std::make_move_iterator(commands.begin()), std::make_move_iterator(commands.end()));
}

bool PathRide::TakeUpInterrupted() {
  if (interrupted_.empty()) return false;
  to_come_.insert(to_come_.begin(), interrupted_.begin(), interrupted_.end());
  interrupted_.clear();
  return true;
}

void PathRide::Finish() {
  protocol_.Finish();
  rides_ = false;
  DropRest();
  held_.clear();
}

}  // namespace rmlcell::motion
