#pragma once

#include <string>

#include "engine/core/result.h"

namespace rmlcell::storage::sqlite {

// Held while a process has the store open for writing: an advisory lock (flock) on a file beside
// the database, which the kernel gives back however the process ends. The file itself stays.
class StoreLock {
 public:
  // CellStoreBusy when another process, or another store in this one, holds it.
  static Result<StoreLock> Take(const std::string& path);

  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&&) = delete;
  ~StoreLock();

 private:
  explicit StoreLock(int file) : file_(file) {}
  int file_;  // -1: moved away
};

// Makes the directory of `path` and those above it where they are missing, with mode 0700, and has
// their names on the disk before it returns. Directories that exist are left as they are.
Status MakeDirectoryOf(const std::string& path);

// Makes the file with mode 0600 where it is missing and sets that mode where it is not. SQLite
// gives its log and index files the mode of the database file.
Status MakePrivateFile(const std::string& path);

}  // namespace rmlcell::storage::sqlite
