#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "engine/machine/machine.h"
#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// What a machine did, as files that can be played again (proto/recording): from the beginning of a
// run, or of the host, to that of the next one. The newest ones are kept in memory. LIVE-3.40
class MachineRecorder {
 public:
  static constexpr std::size_t kKept = 8;
  // Of one: what comes behind that is not recorded, and what does not fit at all is none.
  static constexpr std::size_t kBytesMax = std::size_t{64} << 20;
  static constexpr std::size_t kPartBytes = std::size_t{1} << 20;

  // `head`: without the memory. `mark`: with the state of the machine.
  void Begin(v1::MachineRecording head, const machine::MachineMemory& memory,
             const v1::JournalEntry& mark);
  void Add(const v1::JournalEntry& entry);

  // What an earlier host recorded of the run of a job.
  struct OfJob {
    std::string job{};  // "jobs/17"
    std::string file{};
    bool whole = false;  // else what comes next belongs to it: how the run ended
  };
  void Recover(OfJob recorded);

  // What came since the last call to the recording of the newest run, where it is one of a job: for
  // a file that outlives the host.
  struct Fresh {
    bool begins = false;  // another recording
    std::string bytes{};
  };
  Fresh TakeFresh() { return std::exchange(fresh_, {}); }

  // Error: CellNotFound, with why.
  Result<v1::HostRecordingPart> Part(const v1::HostRecordingRequest& request) const;

 private:
  struct Kept {
    std::string job{};
    std::string file{};  // empty: it was too large from the beginning
    bool full = false;
    bool over = false;  // nothing belongs to it any more
  };
  std::deque<Kept> kept_;      // the newest last
  bool goes_to_file_ = false;  // the newest
  Fresh fresh_{};
};

}  // namespace rmlcell::server
