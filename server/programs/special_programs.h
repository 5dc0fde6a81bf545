#pragma once

#include <string_view>

#include "engine/core/result.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::storage {
class Store;
}
namespace rmlcell::server {

// Puts special programs of its family into the memory of a machine, all or none. They are
// translated for this machine and stored as any program is: their executables go, and the change is
// told of. Blocks on the store and on compilation.
//
// Errors: CellInvalidArgument for what is no name of a machine, and for a slot without special
// program; CellUnknownMachine; CellPrecondition for a family that has none; CellAlreadyExists for
// slots that are filled, unless they are to be replaced; what keeps a program from being one of
// this machine, such as the longest object that it takes.
Result<v1::StoreSpecialProgramsResponse> StoreSpecialPrograms(
    storage::Store& store, const v1::StoreSpecialProgramsRequest& request, std::string_view caller);

}  // namespace rmlcell::server
