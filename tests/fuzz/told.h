#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/machine/machine_status.h"
#include "engine/machine/observer.h"

// What runs of fuzz targets tell, as text, so that two of them can be compared.
namespace rmlcell::machine {

// What a run tells, a line each.
class Teller final : public RunObserver {
 public:
  void OnRunBegun(const RunNote& run) override { Tell(run.begun, {}, "begun", run.program); }
  void OnStep(SimTime at, const Place& place, std::string_view name) override {
    Tell(at, place, name, 0);
  }
  void OnMotion(const MotionDone& done) override {
    Tell(done.start, done.place, "motion", done.end.count());
  }
  void OnSignal(const SignalChange& change) override {
    Tell(change.at, change.place, "signal", static_cast<int>(change.signal) * 1'000 + change.index);
  }
  void OnWait(const Wait& wait) override { Tell(wait.start, wait.place, "wait", wait.end.count()); }
  void OnHalt(const Halt& halt) override { Tell(halt.at, halt.place, "halt", 0); }
  void OnResume(SimTime at, const Place& place) override { Tell(at, place, "resume", 0); }
  void OnDiagnostic(SimTime at, const Diagnostic& finding) override {
    Tell(at, {}, CodeText(finding.code), 0);
  }
  std::string told;

 private:
  void Tell(SimTime at, const Place& place, std::string_view what, std::int64_t with) {
    told += std::to_string(at.count()) + " " + std::to_string(place.program) + "/" +
            std::to_string(place.step) + " " + std::string(what) + " " + std::to_string(with) +
            "\n";
  }
};

// ": this, in place of that": where two texts are not alike any more.
inline std::string Apart(std::string_view given, std::string_view expected) {
  constexpr std::size_t kShown = 200;
  std::size_t at = 0;
  while (at < given.size() && at < expected.size() && given[at] == expected[at]) ++at;
  const std::size_t line = at == 0 ? 0 : expected.rfind('\n', at - 1) + 1;
  return ": " + std::string(given.substr(line, kShown)) + ", in place of " +
         std::string(expected.substr(line, kShown));
}

}  // namespace rmlcell::machine
