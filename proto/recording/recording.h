#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/machine.h"
#include "rmlcell/v1/host.pb.h"

// What happened at a machine from one instant on, with all that it depends on. LIVE-3.40
namespace rmlcell::recording {

struct Recording {
  v1::MachineRecording head{};
  // In order; the first is a mark with the state of the machine. Later marks have it where no run
  // is open, and its digest always.
  std::vector<v1::JournalEntry> entries{};
};

// The file of a recording (.rmlj): a line that says what it is, then records, the head and each
// entry. Whoever records adds entries at its end.
std::string BeginFile(const v1::MachineRecording& head, const v1::JournalEntry& mark);
void AddEntry(const v1::JournalEntry& entry, std::string& file);
std::string FileOf(const Recording& recording);

// Errors: CellBadText for bytes that are none, with the byte from which on they are not.
Result<Recording> ReadFile(std::string_view file);
// What counts of the file of a job's run whose host is gone, when the machine is taken back to a
// mark: all up to the end of the run where that is not behind the mark, else up to the mark.
struct Durable {
  std::string job{};      // "jobs/17"
  std::size_t bytes = 0;  // of the file
  bool whole = false;     // the run is over
};
// The file may be torn. Errors: as ReadFile; CellBadText too where neither is there.
Result<Durable> DurableIn(std::string_view file, std::int64_t fence, std::int64_t sequence);

// From the newest mark with a state that is not behind this time; all of it where there is none.
Recording From(Recording recording, SimTime time);

// The memory of a machine, as messages and back.
void SetMemory(const machine::MachineMemory& memory, v1::MachineRecording& head);
machine::MachineMemory MemoryOf(const v1::MachineRecording& head);

// A program that somebody brings, translated where it is a source. Errors: the first of its
// translation.
Result<machine::StoredProgram> ProgramOf(const v1::AssignedProgram& message,
                                         const machine::MachineFamily& family,
                                         const machine::Parameters& parameters);

}  // namespace rmlcell::recording
