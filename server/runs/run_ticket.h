#pragma once

#include <string_view>

#include "engine/core/result.h"
#include "rmlcell/v1/worker.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

// What the simulation of this name depended on, for the run of its program. Errors: CellTicket
// where it proves nothing: it is no SIMULATE, has not come to its end, is not GOOD, ran dry, or is
// not kept any more; those of the store. LIVE-5.02
Result<v1::RunTicket> TicketOf(storage::Store& store, std::string_view simulation);

}  // namespace rmlcell::server
