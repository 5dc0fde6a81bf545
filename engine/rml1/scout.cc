#include "engine/rml1/scout.h"

#include "engine/core/check.h"

namespace rmlcell::rml1 {

bool Scout::Read(std::string_view stream, const CommandHalts& halts, std::size_t sent_max,
                 LookAhead& ahead) {
  RMLCELL_CHECK(!over_);
  DeviceListener silent;
  for (;;) {
    while (device_.Step(silent)) {
      bool found = TakeActions(stream, ahead);
      if (device_.commands_done() != commands_seen_) {
        commands_seen_ = device_.commands_done();
        if (halts.After(static_cast<int>(device_.command().number))) {
          ahead.EndChain();
          found = true;
        }
      }
      if (found) return true;
    }
    if (sender_.done(stream)) {
      over_ = true;
      ahead.EndChain();
      return true;
    }
    if (sender_.sent() >= sent_max) return false;
    sender_.SendByte(device_, stream, silent);
  }
}

// Everything but a motion needs a tool that stands: a dwell, the spindle, a pause.
bool Scout::TakeActions(std::string_view stream, LookAhead& ahead) {
  if (device_.actions().empty()) return false;
  DeviceListener silent;
  do {
    const Action& action = device_.actions().front();
    if (action.kind == Action::Kind::kMotion) {
      ahead.Add(action);
    } else {
      ahead.EndChain();
      // The sender goes on while the run is paused here.
      if (action.kind == Action::Kind::kPause) sender_.FillBuffer(device_, stream, silent);
    }
    device_.actions().Pop();
  } while (!device_.actions().empty());
  return true;
}

}  // namespace rmlcell::rml1
