// The keys of a mill's panel. LIVE-2.13, LIVE-8.03
#include <memory>
#include <string>
#include <utility>

#include "engine/machine/hand_travel.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

namespace rmlcell::machine {
namespace {

// While a run is held, too: nothing that it goes on with is changed.
bool WorksInHold(PanelKey key) { return key == PanelKey::kView || key == PanelKey::kSpindle; }

}  // namespace

std::string_view Name(PanelKey key) {
  switch (key) {
    case PanelKey::kView:
      return "VIEW";
    case PanelKey::kSpindle:
      return "SPINDLE";
    case PanelKey::kZ0:
      return "Z0";
    case PanelKey::kOrigin:
      return "ORIGIN";
    case PanelKey::kHome:
      return "HOME";
  }
  return "";
}

// LIVE-2.10, as of a key that moves it by hand.
Status Machine::MayPress(PanelKey key) const {
  if (!standing_->HasPanelKey(key)) {
    return Error{ErrorCode::kCellNotLive,
                 "nobody has described a key " + Told("key", Name(key)) + " of this machine",
                 {}};
  }
  StateGuards now = guards();
  now.manual = true;
  const Transition next = Next(state(), MachineEvent::kMoveByHand, now);
  if (next.code) return Refusal(*next.code);
  if (jog_.moves()) return NotNow(state(), kReleaseKeys);
  if (run_ != nullptr && !WorksInHold(key)) return NotNow(state(), "a run is open; end it first");
  // In no other state that stands a spindle turns. LIVE-2.04
  if (run_ == nullptr && key == PanelKey::kSpindle)
    return NotNow(state(),
                  "SPINDLE stops the spindle of a run that is held, and lets it turn again");
  const bool safe = key == PanelKey::kZ0 || key == PanelKey::kOrigin ||
                    (key == PanelKey::kSpindle && status().run.spindle_on);
  if (cover_open_ && !safe) return Error{ErrorCode::kCellDoorOpen, "the cover is open", {}};
  return {};
}

Status Machine::Act(const PressPanel& input) {
  if (const Status may = MayPress(input.key); !may) return may.error();
  if (input.key == PanelKey::kView || input.key == PanelKey::kHome) {
    SendTo(input.key);
    return {};
  }
  if (run_ == nullptr) {
    standing_->PressPanel(input.key);
    return {};
  }
  const Status switched = run_->SwitchSpindle();
  if (switched) base_.reset();  // a simulation knows nothing of that
  return switched;
}

// VIEW a second time brings it back, as it came.
void Machine::SendTo(PanelKey key) {
  const motion::AxisPose at = status().run.axes;
  std::vector<motion::AxisPose> way =
      run_ != nullptr ? StandingOfRun()->WayOf(key) : standing_->WayOf(key);
  if (key == PanelKey::kHome) {
    viewed_from_.reset();
  } else if (viewed_from_) {
    motion::AxisPose above = *viewed_from_;
    above.column.z() = way.front().column.z();
    way = {way.front(), above, *viewed_from_};
  } else {
    viewed_from_ = at;
  }
  const std::optional<HandMotion> how = ByHand(true);
  if (!how) return;
  jog_.Send(std::make_unique<HandTravel>(way, *how, at, now_));
  AdvanceJog(now_);
}

}  // namespace rmlcell::machine
