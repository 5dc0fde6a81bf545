#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/core/line_table.h"
#include "engine/core/result.h"
#include "engine/machine/editing.h"
#include "rmlcell/v1/language.pb.h"

namespace rmlcell::server {

// Places of a text between bytes, as the engine counts, and lines and columns, as clients do.
class TextPlaces {
 public:
  // `text` outlives this.
  explicit TextPlaces(std::string_view text) : text_(text), lines_(text) {}

  // A column behind the end of its line is its end. Error: CellInvalidArgument.
  Result<std::size_t> OffsetOf(const v1::TextPosition& position) const;
  v1::TextPosition PositionOf(std::size_t offset) const;
  v1::TextRange RangeOf(machine::TextSpan span) const;

 private:
  std::string_view Line(std::size_t line) const;

  std::string_view text_;
  LineTable lines_;
};

}  // namespace rmlcell::server
