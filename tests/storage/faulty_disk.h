#pragma once

#include <atomic>
#include <cstdint>
#include <string>

// A disk for tests: a SQLite VFS over that of the system which fails when it is told to, or takes
// the whole process down in the middle of a write, with or without what was not synced.
namespace rmlcell::storage::faulty_disk {

inline constexpr const char* kName = "faulty";  // for SqliteOptions::vfs

void Register();  // once, before the first store is opened

// What a write, sync, truncation or removal gives. SQLite's codes: SQLITE_FULL, SQLITE_IOERR_WRITE
// ...
struct Failure {
  int on_write = 0;  // 0: none
  int on_sync = 0;
  std::int64_t after = 0;  // operations that still go well
  std::int64_t beyond =
      0;  // only writes that end beyond this offset fail: a disk with so much room
};
void Fail(const Failure& failure);
void Heal();

// Only files whose name ends with this fail, as "-wal"; empty: all.
void OnlyFilesEndingWith(const std::string& end);

enum class Crash {
  kKill,      // what was written stays, the write under way is done by half
  kPowerCut,  // what was written since the last sync of its file is undone
};
// At the operation of this number, counted from now; the process is gone then.
void CrashAt(std::int64_t operation, Crash crash);

// Operations since Register(), CrashAt() or Fail().
std::int64_t Operations();
std::int64_t Syncs();  // of these

}  // namespace rmlcell::storage::faulty_disk
