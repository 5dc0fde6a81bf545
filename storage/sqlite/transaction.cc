#include "storage/sqlite/transaction.h"

namespace rmlcell::storage::sqlite {
namespace {

// Undoing may fail when SQLite has undone more on its own; whoever goes on sees that by alive() or
// by the commit, so there is nothing to tell here.
void RunIgnoringErrors(Statement& statement) { static_cast<void>(statement.With().Run()); }

}  // namespace

TransactionStatements::TransactionStatements(Database& database)
    : database_(database),
      begin_read_(database, "BEGIN DEFERRED"),
      begin_write_(database, "BEGIN IMMEDIATE"),
      commit_(database, "COMMIT"),
      rollback_(database, "ROLLBACK"),
      savepoint_(database, "SAVEPOINT operation"),
      release_(database, "RELEASE operation"),
      rollback_to_(database, "ROLLBACK TO operation") {}

Result<Transaction> Transaction::Begin(TransactionStatements& statements, Kind kind) {
  Statement& begin = kind == Kind::kWrite ? statements.begin_write_ : statements.begin_read_;
  if (const Status begun = begin.With().Run(); !begun) return begun.error();
  return Transaction(&statements);
}

Transaction::~Transaction() {
  if (statements_ != nullptr && alive()) RunIgnoringErrors(statements_->rollback_);
}

Status Transaction::Commit() {
  const Status committed = statements_->commit_.With().Run();
  if (!committed && alive()) RunIgnoringErrors(statements_->rollback_);
  statements_ = nullptr;
  return committed;
}

Result<Savepoint> Savepoint::Begin(TransactionStatements& statements) {
  if (const Status begun = statements.savepoint_.With().Run(); !begun) return begun.error();
  return Savepoint(&statements);
}

Savepoint::~Savepoint() {
  if (statements_ != nullptr) static_cast<void>(Undo());
}

Status Savepoint::Undo() {
  TransactionStatements& statements = *std::exchange(statements_, nullptr);
  if (const Status undone = statements.rollback_to_.With().Run(); !undone) return undone.error();
  return statements.release_.With().Run();
}

Status Savepoint::Keep() {
  const Status released = statements_->release_.With().Run();
  if (released) statements_ = nullptr;
  return released;
}

}  // namespace rmlcell::storage::sqlite
