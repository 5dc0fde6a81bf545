#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "engine/core/catalogue.h"
#include "engine/core/check.h"
#include "engine/core/detail.h"

namespace rmlcell {

// A place in program text. Lines and columns count from 1, columns in bytes; 0 means "not known".
struct SourceSpan {
  int line = 0;
  int column = 0;
  int length = 0;                 // bytes, for the caret line; 0 when only the start is known
  std::int64_t byte_offset = -1;  // from the start of the file or stream; -1 when not known

  bool operator==(const SourceSpan&) const = default;
};

// What went wrong: a row of the catalogue, what was observed, and where.
struct Error {
  ErrorCode code;
  Detail detail{};                    // "radius is 0": lower case, no full stop
  std::optional<SourceSpan> where{};  // when there is program text

  bool operator==(const Error&) const = default;
};

// What a caller gave and must not have given; the detail says which part and what is allowed.
inline Error InvalidArgument(Detail detail) {
  return {ErrorCode::kCellInvalidArgument, std::move(detail), {}};
}

// A value or an error. Member names as in std::expected, which replaces it when the toolchain has
// it (docs/decisions/0001-result-type.md). Reading the wrong side is a bug of ours and stops the
// process.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: implicit by design
  Result(Error error)
      : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by design

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  const T& value() const& {
    RMLCELL_CHECK(has_value());
    return *std::get_if<0>(&state_);
  }
  T& value() & {
    RMLCELL_CHECK(has_value());
    return *std::get_if<0>(&state_);
  }
  T&& value() && {
    RMLCELL_CHECK(has_value());
    return std::move(*std::get_if<0>(&state_));
  }
  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

  const Error& error() const {
    RMLCELL_CHECK(!has_value());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

// An operation that returns nothing: good, or an error.
class [[nodiscard]] Status {
 public:
  Status() {}  // not defaulted: `return {};` would set all of its bytes to zero first
  Status(Error error) : error_(std::move(error)) {}  // NOLINT: implicit by design

  bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const {
    RMLCELL_CHECK(!ok());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace rmlcell
