#pragma once

#include <memory>

#include "rmlcell/v1/machine.pb.h"
#include "server/services/pull_stream.h"
#include "storage/store.h"

namespace rmlcell::server {

class Hosts;

struct JournalExportNeeds {
  Executor& executor;
  OpenStreams& open;
  storage::Store& store;
  Hosts* hosts = nullptr;  // null: no machine lives
};

// ExportJournal: the file of a recording, in parts. Of a job that has ended it comes from the
// store, as soon as it is there. LIVE-9.16
std::shared_ptr<PullStream<v1::ExportJournalResponse>> MakeJournalExport(
    const JournalExportNeeds& needs, const v1::ExportJournalRequest& request);

}  // namespace rmlcell::server
