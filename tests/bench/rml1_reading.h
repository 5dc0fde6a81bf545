#pragma once

#include <string>
#include <string_view>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/rml1/device.h"
#include "engine/rml1/rml1_family.h"

namespace rmlcell::bench {

// What is done with a text of RML-1, on a machine whose travel all of rml1_texts.h lies within.
inline Result<machine::Parameters> WideMachine() {
  return machine::MakeParameters(
      rml1::Rml1Family(), "t1",
      {{"X_MIN", "-200"}, {"X_MAX", "200"}, {"Y_MIN", "-200"}, {"Y_MAX", "200"}});
}

// To `take` each move of a device, whose place was checked against the travel. False: the device
// has told of an error.
template <class Take>
bool ForEachMove(const rml1::Profile& profile, std::string_view text, Take take) {
  rml1::Device device(profile);
  rml1::DeviceListener nobody;
  for (std::size_t at = 0; at < text.size();) {
    at += device
              .Read(text.substr(at), static_cast<std::int64_t>(at), rml1::Device::kAnyCommands,
                    nobody)
              .bytes;
    do {
      for (; !device.actions().empty(); device.actions().Pop()) {
        const rml1::Action& action = device.actions().front();
        if (action.kind == rml1::Action::Kind::kMotion) take(action);
      }
    } while (device.Step(nobody));
  }
  return device.command_errors().total() == 0;
}

// How many there are, and the sum of their X, Y, Z.
struct Places {
  int moves = 0;
  double sum = 0.0;
};
inline Places ReadPlaces(const rml1::Profile& profile, std::string_view text) {
  Places places;
  const bool good = ForEachMove(profile, text, [&places](const rml1::Action& action) {
    places.sum += action.to.x + action.to.y + action.to.z;
    ++places.moves;
  });
  return good ? places : Places{};
}

// By the family, with all that a check tells. False: it is refused.
inline bool CheckText(const machine::Parameters& parameters, std::string_view text) {
  return rml1::Rml1Family().Translate({.name = "p.rml", .bytes = text}, parameters, {}).ok;
}

// In virtual time, with nobody to tell. Returns how long it takes there, in seconds.
inline double RunText(const machine::Parameters& parameters, const std::string& text) {
  machine::RunSetup setup(parameters);
  setup.main_program = 1;
  setup.programs[1].object = machine::Bytes::Borrowed(text);
  machine::RunObserver nobody;
  const auto run = rml1::Rml1Family().NewRun(std::move(setup), nobody);
  if (!run) return 0.0;
  while ((*run)->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  return ToSeconds((*run)->state().time);
}

}  // namespace rmlcell::bench
