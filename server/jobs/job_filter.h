#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "storage/store.h"

namespace rmlcell::server {

// What is done with one comparison of a filter. Error: CellBadFilter.
using ApplyComparison = std::function<Status(const std::string& field, const std::string& value)>;

// "code = RML1-E8002 AND verdict = BAD": comparisons with "=" joined by AND, a subset of the common
// filter grammar. Each field at most once; a text in double quotes is one word. Error:
// CellBadFilter, and those of `apply`.
Status ReadFilter(std::string_view filter, const ApplyComparison& apply);

// "state = FAILED AND machine = machines/optimo-1": fields state, machine, kind, caller, finished,
// family, verdict, label, text (in the title), since and until (when it was submitted); words are
// compared without case. An empty filter asks for all. Error: CellBadFilter; `query` is unchanged
// then.
Status ApplyFilter(std::string_view filter, storage::JobQuery& query);

// "create_time desc" or nothing, "create_time", "queue". Error: CellInvalidArgument.
Result<storage::JobOrder> ReadJobOrder(std::string_view order_by);

// Of page tokens. Error: CellBadPageToken.
std::string WriteJobPlace(const storage::JobPlace& place);
Result<storage::JobPlace> ReadJobPlace(std::string_view token);

}  // namespace rmlcell::server
