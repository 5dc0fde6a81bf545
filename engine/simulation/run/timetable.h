#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/simulation/run/drive.h"

namespace rmlcell::simulation {

// When a program has executed how many steps, so that a run of it that people watch knows how much
// of its time lies behind it: a byte, or a step, may take a millisecond or an hour.
class Timetable {
 public:
  static constexpr std::size_t kEntriesMax = 1024;  // beyond that it becomes coarser

  // So many steps at that time; neither goes back.
  void Note(std::uint64_t steps, SimTime time);
  // The program is over. From here on there is nothing to note.
  void End(SimTime time) { total_ = time; }

  std::optional<SimTime> total() const { return total_; }

  // Share of the time planned that lies behind a run that has executed so many steps and is at that
  // time of its own; 0 to 1, and it never goes back. It may take longer than planned (another
  // override, a HOLD): then it waits where it should be at the next step that is known. Calls in
  // the order of the run. Precondition: total().
  double ShareAt(std::uint64_t steps, SimTime time);

 private:
  struct Entry {
    std::uint64_t steps = 0;
    SimTime time{0};
  };

  std::vector<Entry> entries_{Entry{}};
  SimTime spacing_{0};  // between two entries, at least
  std::optional<SimTime> total_{};
  std::size_t here_ = 0;  // entry that the run has reached
  SimTime reached_{0};    // and when, by its own time
};

// Makes a timetable: a run that nobody watches, with the inputs of the setup and START at every
// halt, some of it with each call.
class TimetableRun {
 public:
  // Errors: those of MachineFamily::NewRun.
  static Result<std::unique_ptr<TimetableRun>> Of(const machine::MachineFamily& family,
                                                  machine::RunSetup setup);

  // A tenth of a second of virtual time more. True: the timetable has its end.
  bool Advance();

  Timetable& timetable() { return timetable_; }

 private:
  TimetableRun() = default;

  machine::RunObserver nobody_;
  std::vector<SimTime> input_times_;
  std::unique_ptr<machine::Run> run_;
  std::optional<Drive> drive_;
  Timetable timetable_;
};

}  // namespace rmlcell::simulation
