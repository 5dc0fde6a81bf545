#pragma once

#include <span>
#include <string>

#include "rmlcell/v1/host.pb.h"
#include "storage/store.h"

// What hosts tell, on its way into the store: events of the machine and where it stands, and, while
// it runs a job, what that job tells and how it ends. May block. Errors everywhere: those of the
// store.
namespace rmlcell::server {

struct StoredEntries {
  std::size_t count = 0;  // of the first ones: they are stored, and the others are not
  Status how{};
};
// In order, and each once: who calls leaves out what is stored. The end of a job and the state in
// which it left the machine are one transaction. LIVE-3.25, 5.07
StoredEntries StoreEntries(storage::Store& store, const storage::MachineLease& lease,
                           std::span<const v1::JournalEntry> entries);

// Of jobs that an earlier host of the machine was given: one that it had begun has been told by now
// to be over; any other has moved nothing, and waits again. `begun`: "jobs/17", which it had taken
// and perhaps been told to stop; that one is held, and a person lets it go (LIVE-3.35). One that
// goes on where another was cut off is over: that is decided again. LIVE-5.20
Status GiveBackUnbegun(storage::Store& store, const std::string& machine, const std::string& host,
                       const std::string& begun);

// Of a machine that no host comes for any more: a job that ran there, or was given to its host, is
// cut off where the newest mark has it, and nobody waits for it. A host that comes later may know
// more; the job stays as it is.
Status EndWithoutHost(storage::Store& store, const std::string& machine);

// It waits again, since it never began; `held`: until a person lets it go. `why`: for people, in
// its log.
Status GiveBack(storage::Store& store, const storage::Lease& lease, const std::string& why,
                bool held = false);

}  // namespace rmlcell::server
