#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "server/host/journal.h"
#include "server/host/recording_file.h"

namespace rmlcell::server {

// Writes the journal on a thread of its own, so that a machine never waits for a disk. What cannot
// be written is tried again until it is: in order, and nothing is left out. Thread-safe.
class JournalWriter {
 public:
  explicit JournalWriter(std::unique_ptr<Journal> journal);
  ~JournalWriter();  // after one more try with what waits
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  // `written` is called on the thread of this when all of it is on the disk.
  // `recorded` is what its recording has of them.
  void Write(std::vector<v1::JournalEntry> entries, MachineRecorder::Fresh recorded,
             std::function<void()> written);
  void Stored(std::int64_t fence, std::int64_t sequence);  // as Journal::Stored

  // Why the newest try failed; nothing: it did not.
  std::optional<Error> trouble() const;

 private:
  struct Batch {
    std::vector<v1::JournalEntry> entries;
    std::function<void()> written;
  };
  void Run();

  std::unique_ptr<Journal> journal_;  // of the thread alone
  RecordingFile recording_;           // likewise
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::deque<Batch> waiting_;                                    // guarded by mutex_
  std::deque<MachineRecorder::Fresh> recorded_;                  // guarded by mutex_
  std::optional<std::pair<std::int64_t, std::int64_t>> stored_;  // guarded by mutex_
  std::optional<Error> trouble_;                                 // guarded by mutex_
  bool ending_ = false;                                          // guarded by mutex_
  std::thread thread_;
};

}  // namespace rmlcell::server
