#include "storage/sqlite/host_life.h"

#include <tuple>
#include <utility>

#include "storage/jobs/job_rules.h"
#include "storage/sqlite/job_changes.h"

namespace rmlcell::storage::sqlite {
namespace {

// The lease as it is kept, while it is this one.
Result<MachineLease> Held(WriteContext& context, const MachineLease& lease) {
  Result<std::optional<MachineLease>> held = context.tables.hosts.Find(lease.machine);
  if (!held) return held.error();
  if (*held && (*held)->fence == lease.fence) return **std::move(held);
  return Error{
      ErrorCode::kCellLeaseLost,
      "machine " + lease.machine + (*held ? " is hosted by " + (*held)->host : " has no host"),
      {}};
}

// A claimant that saw another lease, or one that was renewed meanwhile, saw nothing of this one.
bool IsGone(const MachineLease& held, const MachineClaim& claim) {
  return !held.pinned && claim.seen && claim.seen->fence == held.fence &&
         claim.seen->renewals == held.renewals;
}

}  // namespace

Result<MachineLease> TakeMachine(WriteContext& context, const MachineClaim& claim) {
  if (claim.host.empty() || claim.duration <= std::chrono::milliseconds(0))
    return Error{ErrorCode::kCellInvalidArgument, "a host has a name and a lease a duration", {}};
  const auto machine = context.tables.machines.Find(claim.machine);
  if (!machine) return machine.error();
  if (!*machine) return Error{ErrorCode::kCellUnknownMachine, claim.machine, {}};
  const Result<std::optional<MachineLease>> found = context.tables.hosts.Find(claim.machine);
  if (!found) return found.error();
  MachineLease lease{.machine = claim.machine,
                     .host = claim.host,
                     .server = claim.server,
                     .duration = claim.duration,
                     .pinned = claim.pinned};
  if (*found && (*found)->host == claim.host) {
    lease.fence = (*found)->fence;
    lease.renewals = (*found)->renewals + 1;
  } else if (!*found || claim.by_hand || IsGone(**found, claim)) {
    lease.fence = ++context.counters.fence;
  } else {
    return Error{ErrorCode::kCellMachineTaken,
                 "machine " + claim.machine + " is hosted by " + (*found)->host,
                 {}};
  }
  if (const Status put = context.tables.hosts.Put(lease); !put) return put.error();
  return lease;
}

Result<MachineLease> RenewMachine(WriteContext& context, const MachineLease& lease,
                                  std::string_view server) {
  Result<MachineLease> renewed = Held(context, lease);
  if (!renewed) return renewed;
  renewed->server = server;
  renewed->renewals += 1;
  if (const Status put = context.tables.hosts.Put(*renewed); !put) return put.error();
  return renewed;
}

Status ReleaseMachine(WriteContext& context, const MachineLease& lease) {
  const Result<MachineLease> held = Held(context, lease);
  if (!held) return held.error();
  return context.tables.hosts.Remove(lease.machine);
}

Status WriteMachine(WriteContext& context, const MachineLease& lease, const MachineWrite& write) {
  const Result<MachineLease> held = Held(context, lease);
  if (!held) return held.error();
  if (const Status small_enough = CheckEventSizes(write.events); !small_enough)
    return small_enough.error();
  for (const NewEvent& event : write.events) {
    if (const Status noted = NoteEvent(context, MachineName(lease.machine), event); !noted)
      return noted.error();
  }
  if (!write.mark) return {};
  MachineMark mark = *write.mark;
  mark.fence = lease.fence;
  mark.at = context.now;
  if (mark.state.size() + mark.note.size() > kMachineMarkBytesMax) {
    return Error{ErrorCode::kCellTooLarge,
                 "a mark of " + std::to_string(mark.state.size() + mark.note.size()) + " bytes",
                 {}};
  }
  const Result<std::optional<MachineMark>> before = context.tables.hosts.Mark(lease.machine);
  if (!before) return before.error();
  if (*before &&
      std::tuple(mark.fence, mark.sequence) <= std::tuple((*before)->fence, (*before)->sequence)) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "the mark " + std::to_string(mark.sequence) + " is not newer than " +
                     std::to_string((*before)->sequence),
                 {}};
  }
  return context.tables.hosts.PutMark(lease.machine, mark);
}

Status ForgetHost(WriteContext& context, std::string_view machine) {
  if (const Status removed = context.tables.hosts.Remove(machine); !removed) return removed.error();
  return context.tables.hosts.RemoveMark(machine);
}

}  // namespace rmlcell::storage::sqlite
