#include "storage/sqlite/reader_pool.h"

#include <algorithm>

namespace rmlcell::storage::sqlite {

Result<std::unique_ptr<ReaderPool>> ReaderPool::Open(const std::string& path,
                                                     const ConnectionOptions& options, int count) {
  auto pool = std::make_unique<ReaderPool>();
  for (int i = 0; i < std::max(count, 1); ++i) {
    Result<Database> database = Database::Open(path, Database::Access::kReadOnly, options);
    if (!database) return database.error();
    pool->idle_.push_back(std::make_unique<Connection>(*std::move(database)));
  }
  return pool;
}

std::unique_ptr<Connection> ReaderPool::Take() {
  std::unique_lock lock(mutex_);
  returned_.wait(lock, [this] { return !idle_.empty(); });
  // The one used last: its pages are in the cache.
  std::unique_ptr<Connection> connection = std::move(idle_.back());
  idle_.pop_back();
  return connection;
}

void ReaderPool::Return(std::unique_ptr<Connection> connection) {
  {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(connection));
  }
  returned_.notify_one();
}

}  // namespace rmlcell::storage::sqlite
