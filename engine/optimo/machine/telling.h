#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "engine/core/units.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/optimo/machine/situation.h"

namespace rmlcell::optimo {

// Some codes have more than one severity (optimo.md section C); the catalogue holds the first. This
// is the one in a run.
Severity SeverityInRun(ErrorCode code);

// How the parts of the control tell the observer of a run: with the instant and the place of the
// situation, and without what a comment of the program lets pass (`; rmlcell: allow 7321`).
class Telling {
 public:
  // All must outlive it.
  Telling(const Situation& situation, const machine::RunSetup& setup,
          machine::RunObserver& observer);

  machine::RunObserver& observer() const { return observer_; }

  // A step of a program, with its line where the source is known.
  machine::Place PlaceOf(int slot, std::uint32_t step) const;
  // Of each step from 1 on; none where the source is not known.
  std::span<const int> LinesOf(int slot) const;

  void Warn(ErrorCode code, Detail detail, std::string_view rule) const;
  void WarnAt(const machine::Place& place, ErrorCode code, Detail detail,
              std::string_view rule) const;
  void Tell(const Diagnostic& finding) const;
  void Signal(machine::Signal signal, int index, double value, double detail = 0.0) const;

 private:
  bool Allowed(const Diagnostic& finding) const;

  const Situation& situation_;
  std::array<const machine::SourceNotes*, kSlotMax + 1> sources_{};  // null: not known
  machine::RunObserver& observer_;
};

}  // namespace rmlcell::optimo
