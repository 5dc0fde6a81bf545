#include "engine/rml1/scout.h"

#include "engine/core/check.h"

namespace rmlcell::rml1 {

bool Scout::Read(machine::Bytes& stream, const CommandHalts& halts, std::size_t sent_max,
                 LookAhead& ahead) {
  RMLCELL_CHECK(!over_);
  DeviceListener silent;
  const std::uint64_t commands = halts.any() ? 1 : Device::kAnyCommands;
  for (;;) {
    while (device_.Step(silent)) {
      if (TakeWhatHappened(stream, halts, ahead)) return true;
    }
    if (sender_.done(*stream)) {
      over_ = true;
      ahead.EndChain();
      return true;
    }
    if (sender_.given() >= sent_max) return false;
    sender_.Send(device_, *stream, sent_max, commands, silent);
    if (TakeWhatHappened(stream, halts, ahead)) return true;
  }
}

// True: a motion, or a place where the tool must stand.
bool Scout::TakeWhatHappened(machine::Bytes& stream, const CommandHalts& halts, LookAhead& ahead) {
  const bool acts = TakeActions(stream, ahead);
  if (device_.commands_done() == commands_seen_) return acts;
  commands_seen_ = device_.commands_done();
  if (!halts.After(static_cast<int>(device_.command().number))) return acts;
  ahead.EndChain();
  return true;
}

// Everything but a motion needs a tool that stands: a dwell, the spindle, a pause.
bool Scout::TakeActions(machine::Bytes& stream, LookAhead& ahead) {
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
