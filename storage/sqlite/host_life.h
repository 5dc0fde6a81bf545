#pragma once

#include <string_view>

#include "storage/sqlite/write_context.h"
#include "storage/store.h"

// Hosts of machines: each function is a part of one write, and the contract of those that are named
// as methods of Store is that of the method.
namespace rmlcell::storage::sqlite {

Result<MachineLease> TakeMachine(WriteContext& context, const MachineClaim& claim);
Result<MachineLease> RenewMachine(WriteContext& context, const MachineLease& lease,
                                  std::string_view server);
Status ReleaseMachine(WriteContext& context, const MachineLease& lease);
// As Store::AppendMachine.
Status WriteMachine(WriteContext& context, const MachineLease& lease, const MachineWrite& write);
// With the machine itself: nobody hosts it any more.
Status ForgetHost(WriteContext& context, std::string_view machine);

}  // namespace rmlcell::storage::sqlite
