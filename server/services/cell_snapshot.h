#pragma once

#include "engine/core/result.h"
#include "rmlcell/v1/cell.pb.h"
#include "server/services/subscriptions.h"

namespace rmlcell::server {

class Hosts;
class JobBook;
class ProgramBook;
class ProjectBook;

// Where a watch of the cell reads what things are.
struct CellRecords {
  storage::Store& store;
  JobBook& jobs;
  ProgramBook& programs;
  ProjectBook& projects;
  const Hosts* hosts = nullptr;  // none: machines stand as their jobs tell
};

// What this subscription begins with, as it stands now. Errors: those of the store.
Result<v1::CellSnapshot> SnapshotOf(const CellRecords& records,
                                    const CellSubscription& subscription);

// An event as it is told. Of a record that is no job it is told what it is by now; where it is gone
// meanwhile, or cannot be read, its name alone.
struct ReadEvent {
  v1::CellEvent event{};
  bool whole = true;  // false: it could not be read
};
ReadEvent EventOf(const CellRecords& records, const storage::EventRecord& event);

}  // namespace rmlcell::server
