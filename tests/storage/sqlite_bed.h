#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "storage/sqlite/sqlite_store.h"
#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {

// A directory that is made empty and removed with all that is in it.
class TestDirectory {
 public:
  TestDirectory();
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;
  ~TestDirectory();
  std::string File(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// An embedded store in a directory of its own. At the end the file is looked at: ExpectSound().
class SqliteBed final : public StoreBed {
 public:
  // `options.path` is set here.
  explicit SqliteBed(SqliteOptions options = {});
  SqliteBed(const SqliteBed&) = delete;
  SqliteBed& operator=(const SqliteBed&) = delete;
  ~SqliteBed() override;
  Store& store() override { return *store_; }
  void Reopen() override;
  void Close() { store_.reset(); }
  void LeaveUnchecked() { checked_ = false; }  // the test damages the file
  Result<std::unique_ptr<Store>> Open();       // another one on the same file
  SqliteOptions& options() { return options_; }
  const std::string& path() const { return options_.path; }

 private:
  TestDirectory directory_;
  SqliteOptions options_;
  std::unique_ptr<Store> store_;
  bool checked_ = true;
};

// The first column of the first row, read from the file beside the store.
std::int64_t NumberIn(const std::string& path, const std::string& sql);
std::string TextIn(const std::string& path, const std::string& sql);
// Changes the file behind the store's back. The store must be closed.
void ExecuteIn(const std::string& path, const std::string& sql);

std::string ReadFile(const std::string& path);
void WriteFile(const std::string& path, const std::string& bytes);

// What must hold for every store file at rest: SQLite finds it whole; every blob counts exactly the
// columns that name it, and no chunk or row hangs in the air; sequence numbers have no gap.
void ExpectSound(const std::string& path);

}  // namespace rmlcell::storage
