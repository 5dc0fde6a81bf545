#include "storage/sqlite/statement.h"

#include "engine/core/check.h"

namespace rmlcell::storage::sqlite {

void Statement::Start(int parameters) {
  RMLCELL_CHECK(!in_use_);  // a query of this statement is still alive
  in_use_ = true;
  failure_.reset();
  if (statement_ == nullptr) {
    sqlite3_stmt* prepared = nullptr;
    Note(sqlite3_prepare_v3(database_.handle(), sql_.data(), static_cast<int>(sql_.size()),
                            SQLITE_PREPARE_PERSISTENT, &prepared, nullptr));
    statement_.reset(prepared);
  }
  if (!failure_) {
    RMLCELL_CHECK(sqlite3_bind_parameter_count(statement_.get()) == parameters);
  }
}

Query::~Query() {
  if (statement_ == nullptr) return;
  if (statement_->statement_ != nullptr) {
    sqlite3_reset(statement_->statement_.get());           // ends its hold on the snapshot
    sqlite3_clear_bindings(statement_->statement_.get());  // the bound bytes may go
  }
  statement_->in_use_ = false;
}

Result<bool> Query::Step() {
  Statement& statement = *statement_;
  if (statement.failure_) return *statement.failure_;
  const int code = sqlite3_step(statement.statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return statement.database_.LastError();
}

Status Query::Run() {
  for (;;) {
    const Result<bool> row = Step();
    if (!row) return row.error();
    if (!*row) return {};
  }
}

bool Query::IsNull(int column) const {
  return sqlite3_column_type(statement_->statement_.get(), column) == SQLITE_NULL;
}

std::int64_t Query::Integer(int column) const {
  return sqlite3_column_int64(statement_->statement_.get(), column);
}

double Query::Real(int column) const {
  return sqlite3_column_double(statement_->statement_.get(), column);
}

std::string_view Query::View(int column) const {
  sqlite3_stmt* statement = statement_->statement_.get();
  // First the bytes, then their number: the order that makes no conversion between the two calls.
  const void* bytes = sqlite3_column_blob(statement, column);
  const int size = sqlite3_column_bytes(statement, column);
  if (bytes == nullptr) return {};
  return {static_cast<const char*>(bytes), static_cast<std::size_t>(size)};
}

void Query::Bind(int index, std::nullopt_t) {
  statement_->Note(sqlite3_bind_null(statement_->statement_.get(), index));
}

void Query::Bind(int index, std::int64_t value) {
  statement_->Note(sqlite3_bind_int64(statement_->statement_.get(), index, value));
}

void Query::Bind(int index, double value) {
  statement_->Note(sqlite3_bind_double(statement_->statement_.get(), index, value));
}

void Query::Bind(int index, std::string_view text) {
  // A null pointer would bind NULL, an empty text has to stay one. No destructor: not copied.
  const char* bytes = text.empty() ? "" : text.data();
  statement_->Note(sqlite3_bind_text64(statement_->statement_.get(), index, bytes, text.size(),
                                       nullptr, SQLITE_UTF8));
}

void Query::Bind(int index, Bytes bytes) {
  const char* data = bytes.view.empty() ? "" : bytes.view.data();
  statement_->Note(
      sqlite3_bind_blob64(statement_->statement_.get(), index, data, bytes.view.size(), nullptr));
}

Result<std::int64_t> FirstInteger(Query query) {
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  return *row ? query.Integer(0) : 0;
}

}  // namespace rmlcell::storage::sqlite
