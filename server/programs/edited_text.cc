#include "server/programs/edited_text.h"

#include <algorithm>

#include "engine/core/characters.h"

namespace rmlcell::server {

std::string_view TextPlaces::Line(std::size_t line) const {
  const std::size_t begin = lines_.Begin(line);
  return text_.substr(begin, lines_.End(text_, line) - begin);
}

Result<std::size_t> TextPlaces::OffsetOf(const v1::TextPosition& position) const {
  if (position.line() < 1 || position.column() < 0 || position.utf16_column() < 0)
    return InvalidArgument("position: lines and columns count from 1, utf16_column from 0");
  const auto line = static_cast<std::size_t>(position.line()) - 1;
  if (line >= lines_.count()) {
    return InvalidArgument("position.line is " + std::to_string(position.line()) +
                           ", the text has " + std::to_string(lines_.count()));
  }
  const std::string_view text = Line(line);
  const std::size_t bytes =
      position.column() > 0
          ? std::min(static_cast<std::size_t>(position.column()) - 1, text.size())
          : BytesOfCharacters(text, static_cast<std::uint32_t>(position.utf16_column()),
                              Encoding::kUtf16);
  return lines_.Begin(line) + bytes;
}

v1::TextPosition TextPlaces::PositionOf(std::size_t offset) const {
  const std::size_t line = lines_.LineOf(offset);
  const std::size_t bytes = offset - lines_.Begin(line);
  v1::TextPosition position;
  position.set_line(static_cast<std::int32_t>(line) + 1);
  position.set_column(static_cast<std::int32_t>(bytes) + 1);
  position.set_utf16_column(static_cast<std::int32_t>(
      CharactersIn(text_.substr(lines_.Begin(line), bytes), Encoding::kUtf16)));
  return position;
}

v1::TextRange TextPlaces::RangeOf(machine::TextSpan span) const {
  v1::TextRange range;
  *range.mutable_begin() = PositionOf(span.begin);
  *range.mutable_end() = PositionOf(span.end);
  return range;
}

}  // namespace rmlcell::server
