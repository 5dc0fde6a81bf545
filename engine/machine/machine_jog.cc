#include <string>

#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

// The machine moved by its jog keys, while no run goes on. LIVE-8.01 to 8.05
namespace rmlcell::machine {
namespace {

std::string AxisOf(const JogKey& key) {
  return std::string(1, "XYZABC"[static_cast<std::size_t>(key.axis)]);
}

}  // namespace

std::string Name(const JogKey& key) { return AxisOf(key) + (key.plus ? '+' : '-'); }

// LIVE-2.10, x7
Status Machine::MayJog(const JogKey& key) const {
  const FamilyInfo& info = family_.info();
  if (info.jog_axes.empty()) {
    return Error{ErrorCode::kCellNotLive,
                 Told("machine", info.title) + " has no keys that move its axes",
                 {}};
  }
  if (info.jog_axes.find(AxisOf(key)) == std::string_view::npos)
    return Error{
        ErrorCode::kCellInvalidArgument,
        "there is no jog key " + Told("key", Name(key)) + ", only " + Told("axes", info.jog_axes),
        {}};
  StateGuards now = guards();
  now.manual = mode_ == Mode::kManual || !info.jogs_in_manual;
  const Transition next = Next(state(), MachineEvent::kMoveByHand, now);
  if (next.code == ErrorCode::kCellMode)
    return Error{ErrorCode::kCellMode,
                 "the mode is " + Told("mode", Name(mode_)) + ": jog keys work in MANUAL",
                 {}};
  if (next.code) return Refusal(*next.code);
  if (run_ != nullptr && !run_->may_be_moved())
    return NotNow(state(), "a run is open; end it first");
  if (jog_.way() != nullptr) return NotNow(state(), kReleaseKeys);
  if (jog_.IsSpent(key)) return NotNow(state(), "the key was down when it stopped; release it");
  if (cover_open_) return Error{ErrorCode::kCellDoorOpen, "the cover is open", {}};
  return {};
}

Status Machine::Act(const PressJog& input) {
  if (const Status may = MayJog(input.key); !may) return may.error();
  const FamilyInfo& info = family_.info();
  PressJog press = input;
  if (info.jogs_in_manual) {
    press.fast = false;
  } else {
    press.reference = JogReference::kRobot;
  }
  const std::optional<HandMotion> how = ByHand(press.fast);
  const auto axis = static_cast<int>(press.key.axis);
  if (!how || (press.key.axis != JogAxis::kC && how->plus[axis] == 0.0))
    return Error{ErrorCode::kCellInvalidArgument,
                 "the machine has no axis " + Told("axis", AxisOf(press.key)),
                 {}};
  viewed_from_.reset();
  jog_.Press(press, *how, status().run.axes, now_);
  return {};
}

Status Machine::Act(const ReleaseJog& input) {
  if (const auto how = ByHand(jog_.fast())) jog_.Release(input.key, *how);
  return {};
}

Status Machine::Act(const ReleaseJogs& /*input*/) {
  jog_.ReleaseAll();
  if (run_ != nullptr && note_.by_hand && note_.hand == HandRun::kHome) return Act(AbortRun{});
  return {};
}

// The override is another one.
void Machine::AskJog() {
  if (!jog_.asks()) return;
  if (HandWay* way = jog_.way(); way != nullptr && way->what())
    way->ChangeOverride(OverrideOf(way->what()));
  if (const auto how = ByHand(jog_.fast())) jog_.Ask(*how);
}

void Machine::AdvanceJog(SimTime until) {
  if (!jog_.moves()) return;
  jog_.Advance(until);
  const motion::AxisPose axes = jog_.axes();
  const bool zeroed = jog_.way() != nullptr && jog_.way()->zeroed();
  jog_.Settle();
  MoveTo(axes);
  if (zeroed && run_ != nullptr && !run_->state().zeroed) run_->SetZeroed();
}

std::optional<RunOn> Machine::run_on(JogReference reference, bool fast) const {
  const std::optional<HandMotion> how = ByHand(fast);
  if (!how) return std::nullopt;
  return RunOnOf(*how, family_.info().jogs_in_manual ? reference : JogReference::kRobot,
                 status().run.axes);
}

}  // namespace rmlcell::machine
