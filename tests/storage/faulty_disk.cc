#include "tests/storage/faulty_disk.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/types.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <mutex>
#include <new>
#include <string_view>
#include <vector>

namespace rmlcell::storage::faulty_disk {
namespace {

// How one write or truncation is undone.
struct Undo {
  sqlite3_int64 offset;
  std::string bytes;   // what was there before
  sqlite3_int64 size;  // of the file before
};

struct Disk {
  sqlite3_vfs* system = nullptr;
  std::mutex mutex;
  Failure failure;
  std::string only_ending_with;
  std::int64_t operations = 0;
  std::int64_t syncs = 0;
  std::int64_t crash_at = 0;  // 0: never
  Crash crash = Crash::kKill;
  std::map<std::string, std::vector<Undo>> unsynced;  // by path
};

Disk& TheDisk() {
  static Disk disk;  // SQLite's callbacks have no other place to find it
  return disk;
}

struct File {
  sqlite3_file base;
  const char* path;  // SQLite keeps it while the file is open
  sqlite3_file* system() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File& Of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }

void UndoAll(Disk& disk) {
  for (auto& [path, undos] : disk.unsynced) {
    const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0) continue;
    for (auto undo = undos.rbegin(); undo != undos.rend(); ++undo) {
      if (pwrite(file, undo->bytes.data(), undo->bytes.size(), undo->offset) < 0) break;
      if (ftruncate(file, undo->size) != 0) break;
    }
  }
}

// Returns the failure of this operation, or 0. `end`: where a write ends, 0 for what is no write.
// `half` does a part of it when it is the last one.
template <class Half>
int Count(const char* path, int Failure::*kind, sqlite3_int64 end, Half half) {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  ++disk.operations;
  if (disk.crash_at > 0 && disk.operations == disk.crash_at) {
    if (disk.crash == Crash::kPowerCut) {
      UndoAll(disk);
    } else {
      half();
    }
    kill(getpid(), SIGKILL);
    for (;;) pause();
  }
  const bool meant = path != nullptr && std::string_view(path).ends_with(disk.only_ending_with);
  if (!meant || disk.failure.*kind == 0) return 0;
  if (disk.failure.beyond > 0 && end <= disk.failure.beyond) return 0;
  if (disk.failure.after > 0) {
    --disk.failure.after;
    return 0;
  }
  return disk.failure.*kind;
}

void NoteUndo(File& file, sqlite3_int64 offset, int amount) {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  if (disk.crash_at == 0 || disk.crash != Crash::kPowerCut || file.path == nullptr) return;
  Undo undo{.offset = offset, .bytes = {}, .size = 0};
  file.system()->pMethods->xFileSize(file.system(), &undo.size);
  const sqlite3_int64 known = undo.size > offset ? undo.size - offset : 0;
  undo.bytes.resize(static_cast<std::size_t>(known < amount ? known : amount));
  if (!undo.bytes.empty()) {
    file.system()->pMethods->xRead(file.system(), undo.bytes.data(),
                                   static_cast<int>(undo.bytes.size()), offset);
  }
  disk.unsynced[file.path].push_back(std::move(undo));
}

int Close(sqlite3_file* file) { return Of(file).system()->pMethods->xClose(Of(file).system()); }

int Read(sqlite3_file* file, void* into, int amount, sqlite3_int64 offset) {
  return Of(file).system()->pMethods->xRead(Of(file).system(), into, amount, offset);
}

int Write(sqlite3_file* file, const void* from, int amount, sqlite3_int64 offset) {
  sqlite3_file* system = Of(file).system();
  const int failure = Count(Of(file).path, &Failure::on_write, offset + amount,
                            [&] { system->pMethods->xWrite(system, from, amount / 2, offset); });
  if (failure != 0) return failure;
  NoteUndo(Of(file), offset, amount);
  return system->pMethods->xWrite(system, from, amount, offset);
}

int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  const int failure = Count(Of(file).path, &Failure::on_write, 0, [] {});
  if (failure != 0) return failure;
  sqlite3_int64 before = 0;
  Of(file).system()->pMethods->xFileSize(Of(file).system(), &before);
  NoteUndo(Of(file), size, static_cast<int>(before > size ? before - size : 0));
  return Of(file).system()->pMethods->xTruncate(Of(file).system(), size);
}

int Sync(sqlite3_file* file, int) {
  const int failure = Count(Of(file).path, &Failure::on_sync, 0, [] {});
  if (failure != 0) return failure;
  // The disk of this machine need not be waited for: a process that is killed loses nothing that it
  // has written, and what a power cut takes is undone from the notes.
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  ++disk.syncs;
  if (Of(file).path != nullptr) disk.unsynced.erase(Of(file).path);
  return SQLITE_OK;
}

int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  return Of(file).system()->pMethods->xFileSize(Of(file).system(), size);
}
int Lock(sqlite3_file* file, int kind) {
  return Of(file).system()->pMethods->xLock(Of(file).system(), kind);
}
int Unlock(sqlite3_file* file, int kind) {
  return Of(file).system()->pMethods->xUnlock(Of(file).system(), kind);
}
int CheckReservedLock(sqlite3_file* file, int* held) {
  return Of(file).system()->pMethods->xCheckReservedLock(Of(file).system(), held);
}
int FileControl(sqlite3_file* file, int what, void* argument) {
  return Of(file).system()->pMethods->xFileControl(Of(file).system(), what, argument);
}
int SectorSize(sqlite3_file* file) {
  return Of(file).system()->pMethods->xSectorSize(Of(file).system());
}
int Characteristics(sqlite3_file* file) {
  return Of(file).system()->pMethods->xDeviceCharacteristics(Of(file).system());
}
int ShmMap(sqlite3_file* file, int page, int size, int extend, void volatile** map) {
  return Of(file).system()->pMethods->xShmMap(Of(file).system(), page, size, extend, map);
}
int ShmLock(sqlite3_file* file, int offset, int count, int flags) {
  return Of(file).system()->pMethods->xShmLock(Of(file).system(), offset, count, flags);
}
void ShmBarrier(sqlite3_file* file) { Of(file).system()->pMethods->xShmBarrier(Of(file).system()); }
int ShmUnmap(sqlite3_file* file, int remove) {
  return Of(file).system()->pMethods->xShmUnmap(Of(file).system(), remove);
}

constexpr sqlite3_io_methods kMethods = {2,
                                         Close,
                                         Read,
                                         Write,
                                         Truncate,
                                         Sync,
                                         FileSize,
                                         Lock,
                                         Unlock,
                                         CheckReservedLock,
                                         FileControl,
                                         SectorSize,
                                         Characteristics,
                                         ShmMap,
                                         ShmLock,
                                         ShmBarrier,
                                         ShmUnmap,
                                         nullptr,
                                         nullptr};

int Open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags, int* out_flags) {
  sqlite3_vfs* system = TheDisk().system;
  File& made = *new (file) File{};
  made.path = path;
  const int opened = system->xOpen(system, path, made.system(), flags, out_flags);
  made.base.pMethods = opened == SQLITE_OK ? &kMethods : nullptr;
  return opened;
}

int Delete(sqlite3_vfs*, const char* path, int sync_directory) {
  sqlite3_vfs* system = TheDisk().system;
  const int failure = Count(path, &Failure::on_write, 0, [] {});
  if (failure != 0) return failure;
  {
    const std::lock_guard lock(TheDisk().mutex);
    TheDisk().unsynced.erase(path);
  }
  return system->xDelete(system, path, sync_directory);
}

}  // namespace

void Register() {
  static sqlite3_vfs vfs;
  if (TheDisk().system != nullptr) return;
  TheDisk().system = sqlite3_vfs_find(nullptr);
  vfs = *TheDisk().system;
  vfs.szOsFile = static_cast<int>(sizeof(File)) + TheDisk().system->szOsFile;
  vfs.zName = kName;
  vfs.pNext = nullptr;
  vfs.xOpen = Open;
  vfs.xDelete = Delete;
  sqlite3_vfs_register(&vfs, 0);
}

void Fail(const Failure& failure) {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  disk.failure = failure;
  disk.operations = 0;
  disk.syncs = 0;
}

void Heal() {
  Fail({});
  OnlyFilesEndingWith("");
}

void OnlyFilesEndingWith(const std::string& end) {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  disk.only_ending_with = end;
}

void CrashAt(std::int64_t operation, Crash crash) {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  disk.crash_at = operation;
  disk.crash = crash;
  disk.operations = 0;
  disk.syncs = 0;
}

std::int64_t Operations() {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  return disk.operations;
}

std::int64_t Syncs() {
  Disk& disk = TheDisk();
  const std::lock_guard lock(disk.mutex);
  return disk.syncs;
}

}  // namespace rmlcell::storage::faulty_disk
