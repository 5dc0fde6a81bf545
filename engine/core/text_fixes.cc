#include "engine/core/text_fixes.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "engine/core/indices.h"

namespace rmlcell {

std::vector<std::size_t> RepairableFindings(std::string_view text,
                                            std::span<const Diagnostic> diagnostics) {
  std::map<std::int64_t, std::int64_t> taken;  // begin and end of what changes
  const auto is_free = [&](const Fix& fix) {
    const std::int64_t end = fix.byte_offset + fix.length;
    if (fix.byte_offset < 0 || fix.length < 0 || end > static_cast<std::int64_t>(text.size()))
      return false;
    const auto next = taken.lower_bound(fix.byte_offset);
    if (next != taken.end() && (next->first < end || next->first == fix.byte_offset)) return false;
    return next == taken.begin() || std::prev(next)->second <= fix.byte_offset;
  };
  std::vector<std::size_t> chosen;
  for (const std::size_t d : IndicesOf(diagnostics)) {
    const std::vector<Fix>& fixes = diagnostics[d].fixes;
    if (fixes.empty() || !std::ranges::all_of(fixes, is_free)) continue;
    for (const Fix& fix : fixes) taken[fix.byte_offset] = fix.byte_offset + fix.length;
    chosen.push_back(d);
  }
  return chosen;
}

std::string ApplyFixes(std::string_view text, std::span<const Diagnostic> diagnostics) {
  std::vector<const Fix*> fixes;
  for (const std::size_t d : RepairableFindings(text, diagnostics)) {
    for (const Fix& fix : diagnostics[d].fixes) fixes.push_back(&fix);
  }
  std::ranges::sort(fixes, {}, [](const Fix* fix) { return fix->byte_offset; });
  std::string out;
  std::size_t at = 0;
  for (const Fix* fix : fixes) {
    const auto offset = static_cast<std::size_t>(fix->byte_offset);
    if (offset < at) continue;  // two fixes of one finding
    out += text.substr(at, offset - at);
    out += fix->text;
    at = offset + static_cast<std::size_t>(fix->length);
  }
  out += text.substr(at);
  return out;
}

}  // namespace rmlcell
