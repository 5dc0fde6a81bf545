#include "storage/sqlite/schedule_table.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectSchedule(const std::string& which) {
  return "SELECT machine, number, name, mode, power_percent, revision, updated_at FROM schedule"
         " WHERE machine = ?1 " +
         which;
}

ScheduleRecord ReadSchedule(const Query& row) {
  return ScheduleRecord{.machine = row.Text(0),
                        .number = row.Small(1),
                        .name = row.Text(2),
                        .mode = row.Text(3),
                        .power_percent = row.Real(4),
                        .revision = row.Integer(5),
                        .updated_at = row.Time(6)};
}

}  // namespace

ScheduleTable::ScheduleTable(Database& database)
    : get_(database, SelectSchedule("AND number = ?2")),
      list_(database, SelectSchedule("ORDER BY number")),
      put_(database,
           "INSERT OR REPLACE INTO schedule"
           " (machine, number, name, mode, power_percent, revision, updated_at)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)"),
      remove_(database, "DELETE FROM schedule WHERE machine = ?1 AND number = ?2") {}

Result<std::optional<ScheduleRecord>> ScheduleTable::Get(std::string_view machine, int number) {
  return FirstRow<ScheduleRecord>(get_.With(machine, number), ReadSchedule);
}

Result<std::vector<ScheduleRecord>> ScheduleTable::List(std::string_view machine) {
  return AllRows<ScheduleRecord>(list_.With(machine), ReadSchedule);
}

Status ScheduleTable::Put(const ScheduleRecord& schedule) {
  return put_
      .With(schedule.machine, schedule.number, schedule.name, schedule.mode, schedule.power_percent,
            schedule.revision, schedule.updated_at)
      .Run();
}

Status ScheduleTable::Remove(std::string_view machine, int number) {
  return remove_.With(machine, number).Run();
}

}  // namespace rmlcell::storage::sqlite
