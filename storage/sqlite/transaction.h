#pragma once

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// The statements that begin and end transactions of one connection, kept prepared.
class TransactionStatements {
 public:
  explicit TransactionStatements(Database& database);

 private:
  friend class Transaction;
  friend class Savepoint;
  Database& database_;
  Statement begin_read_;
  Statement begin_write_;
  Statement commit_;
  Statement rollback_;
  Statement savepoint_;
  Statement release_;
  Statement rollback_to_;
};

// One transaction: rolled back by the destructor unless it was committed.
class Transaction {
 public:
  // kRead: a snapshot, taken by its first statement. kWrite: the lock of the one writer is taken
  // now.
  enum class Kind { kRead, kWrite };
  static Result<Transaction> Begin(TransactionStatements& statements, Kind kind);

  Transaction(Transaction&& other) noexcept
      : statements_(std::exchange(other.statements_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  // On an error the transaction is rolled back.
  Status Commit();

  // After some errors (disk full, I/O) SQLite ends the transaction on its own.
  bool alive() const { return statements_->database_.in_transaction(); }

 private:
  explicit Transaction(TransactionStatements* statements) : statements_(statements) {}
  TransactionStatements* statements_;  // null: over
};

// A part of a transaction that can be undone alone: undone by the destructor unless it was kept.
// One at a time.
class Savepoint {
 public:
  static Result<Savepoint> Begin(TransactionStatements& statements);

  Savepoint(Savepoint&& other) noexcept : statements_(std::exchange(other.statements_, nullptr)) {}
  Savepoint& operator=(Savepoint&&) = delete;
  ~Savepoint();

  Status Keep();
  Status Undo();  // an error: the whole transaction has to go

 private:
  explicit Savepoint(TransactionStatements* statements) : statements_(statements) {}
  TransactionStatements* statements_;  // null: over
};

}  // namespace rmlcell::storage::sqlite
