#pragma once

#include <cstdint>
#include <deque>
#include <utility>

#include "engine/optimo/control/actuators.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

struct PassageEffectState {
  std::deque<std::pair<std::uint64_t, PassageEffect>> effects{};  // to come, by the tag of the mark
};

// What a program that runs ahead of /FLY motions asks for happens when the tip passes the corner
// that it stands at: half way through its bend. OPT-2.49
class PassageEffects {
 public:
  PassageEffects(PassageEffectState& state, Actuators& actuators, Ride& ride)
      : s_(state), actuators_(actuators), ride_(ride) {}

  // At the passage that the program has run ahead to, or now: a WORK that goes on in the
  // background.
  enum class When { kPassage, kNow };
  void Show(const PassageEffect& effect, When when = When::kPassage);
  // Behind what was appended, also where no passage is open.
  void ShowBehind(const PassageEffect& effect);
  // The ride has passed it.
  void OnMark(std::uint64_t tag);

 private:
  PassageEffectState& s_;
  Actuators& actuators_;
  Ride& ride_;
};

}  // namespace rmlcell::optimo
