#include "storage/sqlite/machine_table.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectMachine(const std::string& which) {
  return "SELECT id, family, title, profile, revision, created_at, updated_at, options"
         " FROM machine " +
         which;
}

}  // namespace

MachineTable::MachineTable(Database& database)
    : find_(database, "SELECT revision, created_at FROM machine WHERE id = ?1"),
      get_(database, SelectMachine("WHERE id = ?1")),
      list_(database, SelectMachine("ORDER BY id")),
      put_(database,
           "INSERT OR REPLACE INTO machine"
           " (id, family, title, profile, revision, created_at, updated_at, options)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)"),
      parameters_(database, "SELECT name, value FROM machine_parameter WHERE machine = ?1"),
      remove_(database, "DELETE FROM machine WHERE id = ?1"),
      remove_parameters_(database, "DELETE FROM machine_parameter WHERE machine = ?1"),
      add_parameter_(database,
                     "INSERT INTO machine_parameter (machine, name, value) VALUES (?1, ?2, ?3)") {}

Result<std::optional<MachineTable::Facts>> MachineTable::Find(std::string_view id) {
  return FirstRow<Facts>(find_.With(id), [](const Query& row) {
    return Facts{.revision = row.Integer(0), .created_at = row.Time(1)};
  });
}

Result<std::optional<MachineRecord>> MachineTable::Get(std::string_view id) {
  return FirstRow<MachineRecord>(get_.With(id), [this](const Query& row) { return Read(row); });
}

Result<std::vector<MachineRecord>> MachineTable::List() {
  return AllRows<MachineRecord>(list_.With(), [this](const Query& row) { return Read(row); });
}

Status MachineTable::Put(const MachineRecord& machine, const Stamp& stamp) {
  if (const Status put =
          put_.With(machine.id, machine.family, machine.title, machine.profile, stamp.revision,
                    stamp.created_at, stamp.updated_at, machine.options)
              .Run();
      !put)
    return put.error();
  if (const Status removed = remove_parameters_.With(machine.id).Run(); !removed)
    return removed.error();
  for (const auto& [name, value] : machine.parameters) {
    if (const Status added = add_parameter_.With(machine.id, name, value).Run(); !added)
      return added.error();
  }
  return {};
}

Status MachineTable::Remove(std::string_view id) {
  if (const Status removed = remove_.With(id).Run(); !removed) return removed.error();
  return remove_parameters_.With(id).Run();
}

Result<MachineRecord> MachineTable::Read(const Query& row) {
  MachineRecord machine{.id = row.Text(0),
                        .family = row.Text(1),
                        .title = row.Text(2),
                        .profile = row.Text(3),
                        .parameters = {},
                        .options = row.Text(7),
                        .revision = row.Integer(4),
                        .created_at = row.Time(5),
                        .updated_at = row.Time(6)};
  Result<std::map<std::string, std::string>> parameters = Parameters(machine.id);
  if (!parameters) return parameters.error();
  machine.parameters = *std::move(parameters);
  return machine;
}

Result<std::map<std::string, std::string>> MachineTable::Parameters(std::string_view machine) {
  std::map<std::string, std::string> parameters;
  Query query = parameters_.With(machine);
  for (;;) {
    const Result<bool> row = query.Step();
    if (!row) return row.error();
    if (!*row) return parameters;
    parameters.emplace(query.Text(0), query.Text(1));
  }
}

}  // namespace rmlcell::storage::sqlite
