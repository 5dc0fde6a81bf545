#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "storage/sqlite/tables.h"

namespace rmlcell::storage::sqlite {

// Read-only connections, one for each read that runs at the same time, opened when they are wanted
// first. Each read sees one snapshot: what was committed when it began, whatever the writer does
// meanwhile. Thread-safe.
class ReaderPool {
 public:
  ReaderPool(std::string path, ConnectionOptions options, int count);

  // What `work`, from Tables& to a Result, gives. Waits while all connections are in use.
  template <class Work>
  auto Read(Work work) -> std::invoke_result_t<Work&, Tables&> {
    Result<Borrowed> borrowed = Borrow();
    if (!borrowed) return borrowed.error();
    Connection& connection = **borrowed;
    const Result<Transaction> snapshot =
        Transaction::Begin(connection.transactions, Transaction::Kind::kRead);
    if (!snapshot) return snapshot.error();
    return work(connection.tables);
  }

 private:
  struct GiveBack {
    ReaderPool* pool = nullptr;
    void operator()(Connection* connection) const { pool->Return(connection); }
  };
  using Borrowed = std::unique_ptr<Connection, GiveBack>;

  Result<Borrowed> Borrow();
  Result<std::unique_ptr<Connection>> Open() const;
  void Return(Connection* connection);

  const std::string path_;
  const ConnectionOptions options_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Connection>> idle_;  // guarded by mutex_
  int unopened_;                                   // guarded by mutex_
};

}  // namespace rmlcell::storage::sqlite
