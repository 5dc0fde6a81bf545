#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_machine.h"
#include "server/host/host_process.h"
#include "server/host/journal.h"

namespace rmlcell::server {

// The newest state that is durable, and what was told before it that the store does not have.
struct Recovered {
  bool known = false;
  v1::MachineMark mark{};
  std::vector<v1::JournalEntry> untold{};
  // Requests that were answered before the mark, as far as the journal has them. LIVE-3.27
  std::vector<v1::JournalEntry> answered{};
};

// Where the journal ends with the begin of a job that the store does not have: up to the mark
// before, and that it was about to begin. False: it does not, or somebody did something since.
// LIVE-5.20
bool TakeBack(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry>& journal);

Recovered RecoveredFrom(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry> journal);

// What a host told here before another one had the machine, of which nobody can say how much is in
// the log: it is kept beside the journal. Returns where; empty: there is none. LIVE-3.05
Result<std::string> KeepOfEarlierHost(const v1::HostWelcome& welcome,
                                      const std::vector<v1::JournalEntry>& entries,
                                      const std::string& journal);

// That of this journal, without the state, where it has one, and the job that was about to begin.
void AddNewestMark(const std::string& journal, v1::HostHello& hello);

// All that a host takes over of it.
HostMachine::Setup SetupOf(Recovered found);

// What is there of the newest run of a job (RecordingFile), and true of a machine that is taken
// back to the mark; the file is cut there. Nothing: not all of it, or of another run; then it is
// gone.
std::optional<MachineRecorder::OfJob> RecoverRecording(const Recovered& found,
                                                       const std::string& path);

// The machine as server and journal have it. Errors: CellUnknownFamily; those of Journal::Open and
// HostMachine::Make.
struct OpenedMachine {
  std::unique_ptr<HostMachine> machine;
  std::unique_ptr<Journal> journal;
};
Result<OpenedMachine> OpenMachine(const v1::HostWelcome& welcome, const HostOptions& options,
                                  const std::string& host, const HostTime& now);

}  // namespace rmlcell::server
