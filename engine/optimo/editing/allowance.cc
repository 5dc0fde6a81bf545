#include "engine/optimo/editing/allowance.h"

#include <algorithm>
#include <string>

#include "engine/core/catalogue.h"

namespace rmlcell::optimo::editing {

std::optional<Fix> Allowance(std::string_view text, const Diagnostic& finding) {
  const CatalogueEntry& entry = Lookup(finding.code);
  if (IsError(finding.severity) || entry.family != ErrorFamily::kOptimo) return std::nullopt;
  if (finding.where.byte_offset < 0) return std::nullopt;
  const auto begin = std::min(static_cast<std::size_t>(finding.where.byte_offset), text.size());
  if (begin < text.size() && text[begin] == ';') return std::nullopt;  // of a directive itself
  const std::size_t line_end = std::min(text.find('\n', begin), text.size());
  const std::size_t line = begin == 0 ? 0 : text.rfind('\n', begin - 1) + 1;
  std::size_t end = line_end;
  while (end > line && (text[end - 1] == '\r' || text[end - 1] == ' ' || text[end - 1] == '\t'))
    --end;
  const std::string_view row = text.substr(line, end - line);
  const std::size_t comment = row.find(';');
  // Only one comment can stand on a line, and a directive ends at its first word.
  if (comment != std::string_view::npos &&
      (row.find("rmlcell: allow", comment) == std::string_view::npos ||
       row.find_last_of("0123456789") + 1 != row.size()))
    return std::nullopt;
  const std::string number = std::to_string(entry.number);
  return Fix{static_cast<std::int64_t>(end), 0,
             comment == std::string_view::npos ? "  ; rmlcell: allow " + number : " " + number};
}

}  // namespace rmlcell::optimo::editing
