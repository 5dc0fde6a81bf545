#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/machine/family.h"
#include "engine/machine/machine.h"
#include "proto/recording/recording.h"

namespace rmlcell::recording {

// Where replay and recording part.
struct Difference {
  std::int64_t fence = 0;
  std::int64_t sequence = 0;  // of the entry
  SimTime at{0};              // of the machine
  std::string field{};        // "mark.state_sha256", "event.halted"
  std::string recorded{};     // as text
  std::string played{};
};

struct Replayed {
  std::int64_t inputs = 0;  // that acted again
  std::int64_t events = 0;  // that came again, begins and ends of runs among them
  std::int64_t marks = 0;   // whose state is the same
  SimTime until{0};
  std::optional<Difference> difference{};  // the first one; the replay ends with it
};

struct ReplayOptions {
  SimTime to = SimTime::max();               // what lies behind it is not played
  machine::RunObserver* observer = nullptr;  // told all that runs do, by the time of each
  // A run stands at its beginning, and is over.
  std::function<void(const machine::Run&)> begun{};
  std::function<void(const machine::RunOver&)> over{};
  // A run was cut off by the end of its host, with this outcome: it is over there, and nothing
  // behind it is played. Empty: the machine stands in the middle of it.
  std::function<void(const machine::RunOver&, const v1::Outcome&)> cut_off{};
  // How it stands at `to`, or with the last entry where that comes first: what came behind it is
  // not known. Told where all before came out the same.
  std::function<void(const machine::Machine&)> stands{};
  // Where it is, once in a while. False: it ends there.
  std::function<bool(SimTime)> goes_on{};
};

// Plays a recording again: the machine as it stood, what acted on it, each at its time. Each event
// and the state at each mark are compared. LIVE-3.40
//
// Errors: CellUnknownFamily; those of machine::MakeParameters, machine::Machine::Make and
// ProgramOf: the recording is of another version, or wrong; CellBadText for an input that is none.
Result<Replayed> Replay(const Recording& recording, const ReplayOptions& options);

// Family and parameters of the machine that was recorded. Errors: as above.
struct RecordedMachine {
  const machine::MachineFamily* family = nullptr;
  machine::Parameters parameters;
};
Result<RecordedMachine> MachineOf(const v1::MachineRecording& head);

}  // namespace rmlcell::recording
