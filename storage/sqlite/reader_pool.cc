#include "storage/sqlite/reader_pool.h"

#include <algorithm>

namespace rmlcell::storage::sqlite {

ReaderPool::ReaderPool(std::string path, ConnectionOptions options, int count)
    : path_(std::move(path)), options_(std::move(options)), unopened_(std::max(count, 1)) {
  idle_.reserve(static_cast<std::size_t>(unopened_));
}

Result<ReaderPool::Borrowed> ReaderPool::Borrow() {
  {
    std::unique_lock lock(mutex_);
    returned_.wait(lock, [this] { return !idle_.empty() || unopened_ > 0; });
    if (!idle_.empty()) {
      // The one used last: its pages are in the cache.
      Borrowed borrowed(idle_.back().release(), {this});
      idle_.pop_back();
      return borrowed;
    }
    --unopened_;
  }
  Result<std::unique_ptr<Connection>> opened = Open();
  if (opened) return Borrowed(opened->release(), {this});
  {
    const std::lock_guard lock(mutex_);
    ++unopened_;
  }
  returned_.notify_one();
  return opened.error();
}

Result<std::unique_ptr<Connection>> ReaderPool::Open() const {
  Result<Database> database = Database::Open(path_, Database::Access::kReadOnly, options_);
  if (!database) {
    Error error = database.error();
    error.detail = path_ + ": " + error.detail;
    return error;
  }
  return std::make_unique<Connection>(*std::move(database));
}

void ReaderPool::Return(Connection* connection) {
  {
    const std::lock_guard lock(mutex_);
    idle_.emplace_back(connection);
  }
  returned_.notify_one();
}

}  // namespace rmlcell::storage::sqlite
