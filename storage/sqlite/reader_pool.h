#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <vector>

#include "storage/sqlite/tables.h"

namespace rmlcell::storage::sqlite {

// Read-only connections, one for each read that runs at the same time. Each read sees one snapshot:
// what was committed when it began, whatever the writer does meanwhile. Thread-safe.
class ReaderPool {
 public:
  static Result<std::unique_ptr<ReaderPool>> Open(const std::string& path,
                                                  const ConnectionOptions& options, int count);

  // What `work`, from Tables& to a Result, gives. Waits while all connections are in use.
  template <class Work>
  auto Read(Work work) -> std::invoke_result_t<Work&, Tables&> {
    const Borrowed borrowed(*this);
    const Result<Transaction> snapshot =
        Transaction::Begin(borrowed->transactions, Transaction::Kind::kRead);
    if (!snapshot) return snapshot.error();
    return work(borrowed->tables);
  }

 private:
  class Borrowed {
   public:
    explicit Borrowed(ReaderPool& pool) : pool_(pool), connection_(pool.Take()) {}
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    ~Borrowed() { pool_.Return(std::move(connection_)); }
    Connection* operator->() const { return connection_.get(); }

   private:
    ReaderPool& pool_;
    std::unique_ptr<Connection> connection_;
  };

  std::unique_ptr<Connection> Take();
  void Return(std::unique_ptr<Connection> connection);

  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Connection>> idle_;  // guarded by mutex_
};

}  // namespace rmlcell::storage::sqlite
