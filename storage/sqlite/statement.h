#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/result.h"
#include "storage/records.h"
#include "storage/sqlite/database.h"

namespace rmlcell::storage::sqlite {

// Bytes that are no text. Text is bound as it is, whatever it holds.
struct Bytes {
  std::string_view view;
};

// What the store notes about a record when it is put.
struct Stamp {
  Revision revision = 0;
  WallTime created_at{};
  WallTime updated_at{};
};

class Statement;

// One execution of a statement: bind, step, read; the destructor makes the statement free again.
// Bound text and bytes are not copied and must live until then.
class Query {
 public:
  Query(Query&& other) noexcept : statement_(std::exchange(other.statement_, nullptr)) {}
  Query& operator=(Query&&) = delete;
  ~Query();

  Result<bool> Step();  // true: a row is ready; false: done
  Status Run();         // to the end; rows are dropped

  // Of the row that is ready; columns count from 0. A column of another type reads as 0 or empty.
  bool IsNull(int column) const;
  std::int64_t Integer(int column) const;
  int Small(int column) const { return static_cast<int>(Integer(column)); }
  std::optional<std::int64_t> OptionalInteger(int column) const {  // nothing: NULL
    return IsNull(column) ? std::nullopt : std::optional(Integer(column));
  }
  double Real(int column) const;
  std::string_view View(int column) const;  // text or bytes, until the next step
  std::string Text(int column) const { return std::string(View(column)); }
  WallTime Time(int column) const { return WallTime(std::chrono::microseconds(Integer(column))); }
  std::optional<WallTime> OptionalTime(int column) const {
    return IsNull(column) ? std::nullopt : std::optional(Time(column));
  }

 private:
  friend class Statement;
  explicit Query(Statement* statement) : statement_(statement) {}

  void Bind(int index, std::nullopt_t);
  void Bind(int index, std::int64_t value);
  void Bind(int index, double value);
  void Bind(int index, std::string_view text);
  void Bind(int index, Bytes bytes);
  void Bind(int index, WallTime time) {
    Bind(index, std::int64_t{time.time_since_epoch().count()});
  }
  template <std::integral Integer>
  void Bind(int index, Integer value) {
    Bind(index, static_cast<std::int64_t>(value));
  }
  template <class Value>
  void Bind(int index, const std::optional<Value>& value) {
    if (value) {
      Bind(index, *value);
    } else {
      Bind(index, std::nullopt);
    }
  }

  Statement* statement_;
};

// One SQL statement, prepared at its first use and finalised by the destructor. Executed any number
// of times, one after the other. Not for two threads at once.
class Statement {
 public:
  // The database must outlive the statement.
  Statement(Database& database, std::string sql) : database_(database), sql_(std::move(sql)) {}
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Binds ?1, ?2 ... in this order. What goes wrong here is told by the first step.
  template <class... Values>
  Query With(Values&&... values) {
    static_assert((!std::is_same_v<std::remove_const_t<Values>, std::string> && ...),
                  "a temporary text would be gone before the first step");
    Start(static_cast<int>(sizeof...(Values)));
    Query query(this);
    if (!failure_) {
      int index = 0;
      (query.Bind(++index, values), ...);
    }
    return query;
  }

  // Rows inserted, changed or deleted by the newest execution.
  std::int64_t changes() const { return sqlite3_changes64(database_.handle()); }

 private:
  friend class Query;
  struct Finalise {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  void Start(int parameters);
  void Note(int sqlite_code) {
    if (sqlite_code != SQLITE_OK && !failure_) failure_ = database_.LastError();
  }

  Database& database_;
  std::string sql_;
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
  std::optional<Error> failure_;  // of preparing or binding, told by Step
  bool in_use_ = false;
};

// What `read`, from a Query to a T or a Result<T>, makes of the first row; nothing when there is
// none.
template <class T, class Read>
Result<std::optional<T>> FirstRow(Query query, Read read) {
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row) return std::optional<T>();
  Result<T> value = read(query);
  if (!value) return value.error();
  return std::optional<T>(*std::move(value));
}

// The first column of the first row, 0 when there is none.
Result<std::int64_t> FirstInteger(Query query);

// What `read` makes of every row.
template <class T, class Read>
Result<std::vector<T>> AllRows(Query query, Read read) {
  std::vector<T> values;
  for (;;) {
    const Result<bool> row = query.Step();
    if (!row) return row.error();
    if (!*row) return values;
    Result<T> value = read(query);
    if (!value) return value.error();
    values.push_back(*std::move(value));
  }
}

}  // namespace rmlcell::storage::sqlite
