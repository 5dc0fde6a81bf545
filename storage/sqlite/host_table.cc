#include "storage/sqlite/host_table.h"

namespace rmlcell::storage::sqlite {
namespace {

MachineLease ReadMachineLease(const Query& row) {
  return {.machine = row.Text(0),
          .host = row.Text(1),
          .server = row.Text(2),
          .fence = row.Integer(3),
          .renewals = row.Integer(4),
          .duration = std::chrono::milliseconds(row.Integer(5)),
          .pinned = row.Integer(6) != 0};
}

}  // namespace

HostTable::HostTable(Database& database)
    : find_(database,
            "SELECT machine, host, server, fence, renewals, duration_ms, pinned FROM machine_lock"
            " WHERE machine = ?1"),
      list_(database,
            "SELECT machine, host, server, fence, renewals, duration_ms, pinned FROM machine_lock"
            " ORDER BY machine"),
      put_(database,
           "INSERT OR REPLACE INTO machine_lock"
           " (machine, host, server, fence, renewals, duration_ms, pinned)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)"),
      remove_(database, "DELETE FROM machine_lock WHERE machine = ?1"),
      mark_(database,
            "SELECT fence, sequence, state, note, clean, at FROM machine_mark WHERE machine = ?1"),
      put_mark_(database,
                "INSERT OR REPLACE INTO machine_mark"
                " (machine, fence, sequence, state, note, clean, at)"
                " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)"),
      remove_mark_(database, "DELETE FROM machine_mark WHERE machine = ?1") {}

Result<std::optional<MachineLease>> HostTable::Find(std::string_view machine) {
  return FirstRow<MachineLease>(find_.With(machine), ReadMachineLease);
}

Result<std::vector<MachineLease>> HostTable::List() {
  return AllRows<MachineLease>(list_.With(), ReadMachineLease);
}

Status HostTable::Put(const MachineLease& lease) {
  return put_
      .With(lease.machine, lease.host, lease.server, lease.fence, lease.renewals,
            lease.duration.count(), lease.pinned)
      .Run();
}

Status HostTable::Remove(std::string_view machine) { return remove_.With(machine).Run(); }

Result<std::optional<MachineMark>> HostTable::Mark(std::string_view machine) {
  return FirstRow<MachineMark>(mark_.With(machine), [](const Query& row) {
    return MachineMark{.fence = row.Integer(0),
                       .sequence = row.Integer(1),
                       .state = row.Text(2),
                       .note = row.Text(3),
                       .clean = row.Integer(4) != 0,
                       .at = row.Time(5)};
  });
}

Status HostTable::PutMark(std::string_view machine, const MachineMark& mark) {
  return put_mark_
      .With(machine, mark.fence, mark.sequence, Bytes{mark.state}, Bytes{mark.note}, mark.clean,
            mark.at)
      .Run();
}

Status HostTable::RemoveMark(std::string_view machine) { return remove_mark_.With(machine).Run(); }

}  // namespace rmlcell::storage::sqlite
