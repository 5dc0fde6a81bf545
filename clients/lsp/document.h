#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "clients/lsp/text_position.h"
#include "engine/core/line_table.h"

namespace rmlcell::lsp {

// A text that the editor has open, with its lines. The editor is its master: it changes only by
// what the editor says.
class Document {
 public:
  Document(std::string uri, std::string language, std::int64_t version, std::string text,
           Encoding encoding);

  const std::string& uri() const { return uri_; }
  const std::string& language() const { return language_; }
  std::int64_t version() const { return version_; }
  const std::string& text() const { return text_; }
  const LineTable& lines() const { return lines_; }
  Encoding encoding() const { return encoding_; }

  void set_version(std::int64_t version) { version_ = version; }
  void ReplaceAll(std::string text);
  // A place behind the end of a line is its end; a line behind the last is the end of the text; an
  // end before the start is the start.
  void Replace(const Range& range, std::string_view text);

  std::size_t OffsetOf(Position position) const;
  // Precondition: offset <= text().size(). For many places: PositionFinder.
  Position PositionOf(std::size_t offset) const;

  // Every byte is a character, so that offsets need no counting.
  bool ascii() const { return ascii_; }

 private:
  std::string uri_;
  std::string language_;
  std::int64_t version_;
  std::string text_;
  LineTable lines_;
  Encoding encoding_;
  bool ascii_;
};

// Positions of many offsets; linear when they ascend, even when the text is one line.
// The document must outlive it and not change.
class PositionFinder {
 public:
  explicit PositionFinder(const Document& document) : document_(document) {}

  Position At(std::size_t offset);
  Range Span(std::size_t begin, std::size_t end);

 private:
  const Document& document_;
  std::size_t offset_ = 0;  // the last answer
  Position position_;
};

}  // namespace rmlcell::lsp
