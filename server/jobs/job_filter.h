#pragma once

#include <string_view>

#include "storage/store.h"

namespace rmlcell::server {

// "state = FAILED AND machine = machines/optimo-1": comparisons with "=" joined by AND, a subset of
// the common filter grammar. Fields: state, machine, kind, caller, finished. Each at most once;
// words are compared without case, a text in double quotes is one word. An empty filter asks for
// all. Error: CellBadFilter; `query` is unchanged then.
Status ApplyFilter(std::string_view filter, storage::JobQuery& query);

}  // namespace rmlcell::server
