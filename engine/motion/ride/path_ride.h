#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/motion/planner/planner.h"
#include "engine/motion/ride/interruption.h"
#include "engine/motion/ride/motion_under_way.h"
#include "engine/motion/ride/ride_protocol.h"

namespace rmlcell::motion {

// A command as the planner got it, kept so that it can be planned anew; without a move: a mark.
struct AppendedCommand {
  std::uint64_t tag = 0;
  std::optional<MoveCommand> move{};
};

// What a machine rides: the motion under way, what is planned to follow it, what a STOP interrupted
// and what a HOLD keeps back; with the protocol of the keys. A value: a snapshot is a copy.
//
//                  under way + to come          interrupted           held
//   Stop(plan)     the ramp to rest             the rest, from there  -
//   EndBy(plan)    the same ramp                empty                 empty
//   HoldBehind     the family's: up to a target -                     the commands behind it
//   Resume         interrupted comes first      empty                 the family plans it
//   DropRest       as it is, then nothing       empty                 as they are
//   Finish         nothing                      empty                 empty
//
// How motions are planned, and what belongs to one besides its plan, is the family's. One that
// plans its path anew from wherever it is, as a mill does, has nothing to come here and interrupts
// nothing: it Leaves the motion under way, and begins another.
class PathRide {
 public:
  explicit PathRide(HoldRamp ramp) : protocol_(ramp) {}

  RideProtocol& protocol() { return protocol_; }
  const RideProtocol& protocol() const { return protocol_; }

  // --- one motion after the other ---

  // Null: none. It is over when the machine Leaves it, not by time alone.
  const MotionUnderWay* under_way() const { return rides_ ? &under_way_ : nullptr; }
  MotionUnderWay* under_way() { return rides_ ? &under_way_ : nullptr; }
  const std::deque<PlannedItem>& to_come() const { return to_come_; }
  bool busy() const { return rides_ || !to_come_.empty(); }
  bool waits_to_begin() const { return !rides_ && !to_come_.empty(); }

  void Plan(PlannedItem item) { to_come_.push_back(std::move(item)); }  // behind all to come
  void ReplaceToCome(std::vector<PlannedItem> items);
  // All that would follow the motion under way, of what a STOP interrupted, too.
  void DropRest() {
    to_come_.clear();
    interrupted_.clear();
    ends_ = false;
  }
  // The tag of the mark that is the first to come, and is passed now; nothing: a motion is, or
  // nothing is to come.
  std::optional<std::uint64_t> PassMark();
  // Of the motion under way and those to come that are planned in the axes:
  // PlannedMotion::MeasureBy.
  void MeasureInAxesBy(double factor);

  // The first to come, which is a motion, is under way from now on. Precondition: none is.
  MotionUnderWay& Begin(SimTime now);
  // The one in place(), which the caller has filled.
  void BeginInPlace(SimTime now, SimTime until);
  MotionUnderWay& place() { return under_way_; }
  // No longer under way; its values stay in place().
  void Leave() { rides_ = false; }

  // --- commands whose motions are not over, for who plans them anew ---

  const std::deque<AppendedCommand>& appended() const { return appended_; }
  void Append(AppendedCommand command) { appended_.push_back(std::move(command)); }
  // Those from the nth on, as many as there are, become these.
  void ReplaceAppended(std::size_t n, std::span<const AppendedCommand> commands);
  // Of the move with this tag; null when it is over.
  const MoveCommand* Appended(std::uint64_t tag) const;
  // Those before this tag are over.
  void ForgetBefore(std::uint64_t tag);

  // --- keys ---

  // STOP at `now`: how the machine comes to rest along what is planned. Nothing when that ends
  // before the machine stands. Precondition: a motion is under way.
  struct StopPlan {
    StopOnPath ramp;
    std::vector<PlannedMotion> ahead;                        // from the one under way on
    std::vector<std::pair<std::size_t, PlannedMark>> marks;  // each behind a motion of `ahead`
    std::uint64_t rests_on = 0;                              // tag

    void AddMarks(std::size_t behind, std::deque<PlannedItem>& items) const;
  };
  std::optional<StopPlan> PlanStop(SimTime now, const AxisLimits& axes) const;
  // Nothing is under way then; the ramp is to come.
  void Stop(const StopPlan& plan, const AxisLimits& axes);
  // The same for good: the moves of the ramp have `ended` when the last of it is over.
  void EndBy(const StopPlan& plan);
  bool ends() const { return ends_; }  // by it, until the rest is dropped

  // HOLD at the end of the move with this tag: the commands behind it are held back. What leads to
  // that end is the caller's to plan.
  void HoldBehind(std::uint64_t tag);
  const std::deque<AppendedCommand>& held() const { return held_; }
  template <class Change>  // void(AppendedCommand&)
  void ChangeHeld(Change change) {
    for (AppendedCommand& command : held_) change(command);
  }
  const std::deque<PlannedItem>& interrupted() const { return interrupted_; }
  // The machine was moved while it stood: what a STOP interrupted is of no use. Its commands from
  // this tag on, and those held back, become these, which are held back.
  void HoldBack(std::uint64_t from_tag, std::vector<AppendedCommand> commands);
  // START: they are the caller's to plan, and held back no longer.
  std::deque<AppendedCommand> TakeHeld() { return std::exchange(held_, {}); }

  // START after a STOP: what was interrupted comes first. False: nothing was.
  bool TakeUpInterrupted();

  // The run is over: nothing is left to ride.
  void Finish();

 private:
  void BeginRamp(const StopPlan& plan);

  RideProtocol protocol_;
  bool rides_ = false;
  bool ends_ = false;  // EndBy: what is to come is its ramp
  MotionUnderWay under_way_{};
  std::deque<PlannedItem> to_come_{};
  std::deque<PlannedItem> interrupted_{};
  std::deque<AppendedCommand> appended_{};
  std::deque<AppendedCommand> held_{};
};

}  // namespace rmlcell::motion
