#pragma once

#include <string>
#include <vector>

#include "storage/sqlite/machine_tally.h"
#include "storage/sqlite/tables.h"

namespace rmlcell::storage::sqlite {

// The newest numbers given out, and counts that would be dear to look up. Kept by the writer in
// memory and put back when what took them is rolled back.
struct Counters {
  std::int64_t job = 0;
  std::int64_t position = 0;
  std::int64_t fence = 0;
  std::int64_t queued_jobs = 0;
  std::int64_t blocked_jobs = 0;  // of these, not ready
  std::int64_t running_jobs = 0;
  std::int64_t finished_jobs = 0;
  std::int64_t record_events = 0;  // events of what is no job
  std::int64_t events_trimmed_until =
      0;  // a position; all older events were removed for their number

  std::int64_t& JobsIn(JobState state) {
    if (IsFinal(state)) return finished_jobs;
    return state == JobState::kQueued ? queued_jobs : running_jobs;
  }
};

// What one write works with, inside its transaction.
struct WriteContext {
  Tables& tables;
  Counters& counters;
  const ProgramMemoryOf& program_memory;
  const MachineTally& machines;  // as of the newest commit: what `moves` brings is not in it
  WallTime now;                  // of this write: leases, events and records all get this one time
  std::vector<JobMove> moves{};  // added to: for the tally, once they are committed
  bool changed = false;          // set: jobs or events changed, watchers want to know
  bool garbage = false;          // set: a blob may have lost its last reference or hold
  bool ready = false;            // set: a job may have become one that can begin
};

// Also of this transaction.
std::int64_t UnfinishedOf(const WriteContext& context, const std::string& machine);

// An event of a record that is no job: it was made, changed or deleted.
Status NoteRecord(WriteContext& context, std::string_view resource, std::string_view change,
                  std::string_view caller);
// What happened with a record that is no job.
Status NoteEvent(WriteContext& context, std::string_view resource, const NewEvent& event);

// One write. Run() is called by whoever has the turn, inside a transaction, and is undone when it
// gives an error; it may be called again when that transaction could not be committed. Then
// Answer() is called once, after the commit, with an error of Run() or of the commit; of one that
// stands, after the commit that gave it what it waits for, or when it waits no more.
class WriteOperation {
 public:
  virtual ~WriteOperation() = default;
  virtual Status Run(WriteContext& context) = 0;
  virtual void Answer(const Status& status) = 0;
  // Not 0: what it ran for is not there yet. It is not answered, but run again in each transaction
  // in which a job may have become one that can begin, behind what is written there, until it is 0
  // or it is withdrawn by this number.
  virtual std::int64_t StandsAs() const { return 0; }
  // What the newest Run() of one that stands has written is not there.
  virtual void Undone() {}
  // Whether what is not there for it is not there for the other one.
  virtual bool AsksAs(const WriteOperation&) const { return false; }
};

}  // namespace rmlcell::storage::sqlite
