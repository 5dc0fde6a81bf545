#include "engine/optimo/language/findings.h"

#include <algorithm>
#include <utility>

#include "engine/core/keep_finding.h"

namespace rmlcell::optimo {

Detail ToldSize(std::string_view name, std::uint64_t bytes) {
  return Told(name, static_cast<double>(bytes), "bytes", std::to_string(bytes));
}

void Findings::Add(ErrorCode code, Place place, Detail detail, std::string_view rule,
                   std::vector<Fix> fixes) {
  AddAs(Lookup(code).severity, code, place, std::move(detail), rule, std::move(fixes));
}

void Findings::AddAs(Severity severity, ErrorCode code, Place place, Detail detail,
                     std::string_view rule, std::vector<Fix> fixes) {
  if (IsError(severity)) ++errors_;
  Diagnostic diagnostic{.code = code, .severity = severity};
  diagnostic.where.byte_offset = place.offset;
  diagnostic.where.length = place.length;
  diagnostic.step = place.step;
  diagnostic.detail = std::move(detail);
  diagnostic.rule = rule;
  diagnostic.fixes = std::move(fixes);
  KeepFinding(std::move(diagnostic), limit_, found_, dropped_);
}

std::vector<Diagnostic> Findings::Take(std::string_view text, std::string_view file) {
  std::ranges::stable_sort(found_, {},
                           [](const Diagnostic& found) { return found.where.byte_offset; });
  int line = 1;
  std::size_t line_begin = 0;
  for (Diagnostic& diagnostic : found_) {
    diagnostic.file = file;
    if (diagnostic.where.byte_offset < 0) continue;
    const auto offset =
        std::min(static_cast<std::size_t>(diagnostic.where.byte_offset), text.size());
    for (std::size_t end; (end = text.find('\n', line_begin)) < offset; line_begin = end + 1)
      ++line;
    diagnostic.where.line = line;
    diagnostic.where.column = static_cast<int>(offset - line_begin) + 1;
  }
  dropped_.ForEachPlace([&](Diagnostic& place) {
    place.file = file;
    if (place.where.byte_offset < 0) return;
    const std::string_view before =
        text.substr(0, static_cast<std::size_t>(place.where.byte_offset));
    const std::size_t line_end = before.rfind('\n');  // none: npos, which is one before 0
    place.where.line = static_cast<int>(std::ranges::count(before, '\n')) + 1;
    place.where.column = static_cast<int>(before.size() - (line_end + 1)) + 1;
  });
  return std::exchange(found_, {});
}

}  // namespace rmlcell::optimo
