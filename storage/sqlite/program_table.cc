#include "storage/sqlite/program_table.h"

#include "engine/core/hex.h"
#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectProgram(const std::string& which) {
  return "SELECT slot, name, source_name, revision, created_at, updated_at, object_blob, "
         "source_blob,"
         " executable_blob FROM program WHERE machine = ?1 " +
         which;
}

std::string SelectSummary(const std::string& which) {
  return "SELECT program.slot, program.name, program.source_name, program.revision,"
         " program.created_at, program.updated_at, object.sha256, object.size, source.size,"
         " executable.size FROM program"
         " LEFT JOIN blob AS object ON object.id = program.object_blob"
         " LEFT JOIN blob AS source ON source.id = program.source_blob"
         " LEFT JOIN blob AS executable ON executable.id = program.executable_blob"
         " WHERE program.machine = ?1 " +
         which;
}

Result<ProgramSummary> ReadSummary(const Query& row) {
  if (row.IsNull(7)) {
    return Error{
        ErrorCode::kCellStoreCorrupt, "the object of slot " + row.Text(0) + " is not there", {}};
  }
  return ProgramSummary{.slot = row.Small(0),
                        .name = row.Text(1),
                        .source_name = row.Text(2),
                        .object_bytes = row.Integer(7),
                        .source_bytes = row.OptionalInteger(8).value_or(-1),
                        .executable_bytes = row.OptionalInteger(9).value_or(-1),
                        .object_sha256 = HexOf(row.View(6)),
                        .revision = row.Integer(3),
                        .created_at = row.Time(4),
                        .updated_at = row.Time(5)};
}

}  // namespace

ProgramTable::ProgramTable(Database& database, BlobTable& blobs)
    : blobs_(blobs),
      find_(database, SelectProgram("AND slot = ?2")),
      get_(database, SelectProgram("AND slot = ?2")),
      memory_(database, SelectProgram("ORDER BY slot")),
      list_(database, SelectSummary("AND program.slot > ?2 ORDER BY program.slot LIMIT ?3")),
      summary_(database, SelectSummary("AND program.slot = ?2")),
      put_(database,
           "INSERT OR REPLACE INTO program"
           " (machine, slot, name, source_name, revision, created_at, updated_at, object_blob,"
           " source_blob, executable_blob) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)"),
      put_executable_(database,
                      "UPDATE program SET executable_blob = ?3 WHERE machine = ?1 AND slot = ?2"),
      remove_(database, "DELETE FROM program WHERE machine = ?1 AND slot = ?2") {}

Result<std::optional<ProgramTable::Row>> ProgramTable::Find(std::string_view machine, int slot) {
  return FirstRow<Row>(find_.With(machine, slot), [](const Query& row) {
    return Row{.revision = row.Integer(3),
               .created_at = row.Time(4),
               .updated_at = row.Time(5),
               .object_blob = row.Integer(6),
               .source_blob = row.OptionalInteger(7),
               .executable_blob = row.OptionalInteger(8)};
  });
}

Result<std::optional<ProgramRecord>> ProgramTable::Get(std::string_view machine, int slot) {
  return FirstRow<ProgramRecord>(get_.With(machine, slot),
                                 [&](const Query& row) { return Read(row, machine, Parts::kAll); });
}

Result<std::vector<ProgramRecord>> ProgramTable::Memory(std::string_view machine, Parts parts) {
  return AllRows<ProgramRecord>(memory_.With(machine),
                                [&](const Query& row) { return Read(row, machine, parts); });
}

Result<std::vector<ProgramSummary>> ProgramTable::List(std::string_view machine, int after_slot,
                                                       int limit) {
  return AllRows<ProgramSummary>(list_.With(machine, after_slot, limit), ReadSummary);
}

Result<std::optional<ProgramSummary>> ProgramTable::Summary(std::string_view machine, int slot) {
  return FirstRow<ProgramSummary>(summary_.With(machine, slot), ReadSummary);
}

Status ProgramTable::Put(std::string_view machine, int slot, std::string_view name,
                         std::string_view source_name, const Row& row) {
  return put_
      .With(machine, slot, name, source_name, row.revision, row.created_at, row.updated_at,
            row.object_blob, row.source_blob, row.executable_blob)
      .Run();
}

Status ProgramTable::PutExecutable(std::string_view machine, int slot,
                                   std::optional<std::int64_t> blob) {
  return put_executable_.With(machine, slot, blob).Run();
}

Status ProgramTable::Remove(std::string_view machine, int slot) {
  return remove_.With(machine, slot).Run();
}

Result<ProgramRecord> ProgramTable::Read(const Query& row, std::string_view machine, Parts parts) {
  Result<std::string> object = blobs_.Read(row.Integer(6));
  if (!object) return object.error();
  ProgramRecord program{.machine = std::string(machine),
                        .slot = row.Small(0),
                        .name = row.Text(1),
                        .object = *std::move(object),
                        .source = {},
                        .source_name = row.Text(2),
                        .executable = {},
                        .revision = row.Integer(3),
                        .created_at = row.Time(4),
                        .updated_at = row.Time(5)};
  if (parts == Parts::kAll && !row.IsNull(7)) {
    Result<std::string> source = blobs_.Read(row.Integer(7));
    if (!source) return source.error();
    program.source = *std::move(source);
  }
  if (!row.IsNull(8)) {
    Result<std::string> executable = blobs_.Read(row.Integer(8));
    if (!executable) return executable.error();
    program.executable = *std::move(executable);
  }
  return program;
}

}  // namespace rmlcell::storage::sqlite
