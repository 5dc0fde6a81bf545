#include "clients/lsp/text_edits.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clients/lsp/program_folder.h"
#include "engine/core/text_fixes.h"

namespace rmlcell::lsp {
namespace {

constexpr std::string_view kQuickFix = "quickfix";
constexpr std::string_view kFixAll = "source.fixAll.rmlcell";
constexpr std::size_t kActionsMax = 100;  // of one request; a selection may hold a whole program

// Lines with their ends.
std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    lines.push_back(text.substr(0, end + 1));
    text.remove_prefix(end + 1);
  }
  return lines;
}

// Whether an action kind is asked for: the kind itself or one above it ("source" for
// "source.fixAll").
bool Wanted(const Json* only, std::string_view kind) {
  if (only == nullptr || !only->is_array() || only->empty()) return true;
  return std::ranges::any_of(*only, [&](const Json& one) {
    if (!one.is_string()) return false;
    const std::string_view asked = one.get_ref<const std::string&>();
    return asked.empty() || (std::string(kind) + '.').starts_with(std::string(asked) + '.');
  });
}

// Edits of fixes, in order of place; what touches an earlier one or does not fit is left out.
Json EditsOf(std::vector<Fix> fixes, PositionFinder& positions, std::size_t text_size) {
  std::ranges::stable_sort(fixes, {}, &Fix::byte_offset);
  Json edits = Json::array();
  std::size_t at = 0;
  bool first = true;
  for (const Fix& fix : fixes) {
    if (fix.byte_offset < 0 || fix.length < 0) continue;
    const auto begin = static_cast<std::size_t>(fix.byte_offset);
    const auto end = begin + static_cast<std::size_t>(fix.length);
    if ((!first && begin < at) || end > text_size) continue;
    edits.push_back(TextEdit(positions.Span(begin, end), fix.text));
    at = end;
    first = false;
  }
  return edits;
}

std::string TitleOf(const Diagnostic& finding, std::string_view text) {
  const Fix& fix = finding.fixes.front();
  const std::string_view old =
      text.substr(std::min(static_cast<std::size_t>(fix.byte_offset), text.size()),
                  static_cast<std::size_t>(fix.length));
  constexpr std::size_t kQuotedMax = 30;
  const auto quoted = [](std::string_view piece) {
    std::string line = "'";
    for (const char c : piece.substr(0, kQuotedMax)) line += c == '\n' || c == '\r' ? ' ' : c;
    return line + (piece.size() > kQuotedMax ? "...'" : "'");
  };
  const std::size_t begin = std::min(old.find_first_not_of(" \t"), old.size());
  if (fix.text.empty()) return "Remove " + quoted(old.substr(begin));
  if (fix.length == 0) return "Insert " + quoted(fix.text);
  return "Replace " + quoted(old.substr(begin)) + " by " + quoted(fix.text);
}

class Actions {
 public:
  Actions(const Document& document, const machine::Editing* editing, const Json* only)
      : document_(document), editing_(editing), only_(only) {}

  Json Make(const Findings& findings, const Range& range) {
    const std::size_t from = document_.OffsetOf(range.start);
    const std::size_t to = std::max(from, document_.OffsetOf(range.end));
    for (const Diagnostic& finding : findings.list) {
      const Marked marked = PlaceOf(finding, document_.text());
      const bool here = finding.where.byte_offset >= 0 && marked.begin <= to && marked.end >= from;
      if (!here || actions_.size() >= kActionsMax || !Wanted(only_, kQuickFix)) continue;
      if (!finding.fixes.empty())
        Add(TitleOf(finding, document_.text()), kQuickFix, finding.fixes, &finding);
      AddAllowance(finding);
    }
    if (!Wanted(only_, kFixAll)) return std::move(actions_);
    std::vector<Fix> all;
    for (const std::size_t at : RepairableFindings(document_.text(), findings.list)) {
      const std::vector<Fix>& fixes = findings.list[at].fixes;
      all.insert(all.end(), fixes.begin(), fixes.end());
    }
    if (!all.empty()) Add("Apply all fixes of rmlcell", kFixAll, all, nullptr);
    return std::move(actions_);
  }

 private:
  void Add(std::string title, std::string_view kind, std::vector<Fix> fixes,
           const Diagnostic* finding) {
    PositionFinder positions(document_);
    Json edits = EditsOf(std::move(fixes), positions, document_.text().size());
    if (edits.empty()) return;
    Json action = {{"title", std::move(title)},
                   {"kind", kind},
                   {"edit", {{"changes", {{document_.uri(), std::move(edits)}}}}}};
    if (finding != nullptr) {
      PositionFinder of_finding(document_);
      action["diagnostics"] = Json::array({ToJson(*finding, of_finding, document_)});
      action["isPreferred"] = !finding->fixes.empty() && finding->fixes.front().text != "";
    }
    actions_.push_back(std::move(action));
  }

  void AddAllowance(const Diagnostic& finding) {
    const auto change =
        editing_ == nullptr ? std::nullopt : editing_->Allow(document_.text(), finding);
    if (!change) return;
    const std::string number = std::to_string(Lookup(finding.code).number);
    Add("Allow " + number + " on this line", kQuickFix, {*change}, &finding);
    if (!actions_.empty()) actions_.back()["isPreferred"] = false;
  }

  const Document& document_;
  const machine::Editing* editing_;
  const Json* only_;
  Json actions_ = Json::array();
};

}  // namespace

Json FormattingEdits(const Document& document) {
  Json edits = Json::array();
  const machine::Tools* tools = FamilyOf(document).tools();
  if (tools == nullptr) return edits;
  const machine::FormattedText formatted =
      tools->Format({.name = FileNameOfUri(document.uri()), .bytes = document.text()});
  if (!formatted.changed) return edits;
  const std::vector<std::string_view> before = LinesOf(document.text());
  const std::vector<std::string_view> after = LinesOf(formatted.text);
  std::size_t head = 0;
  while (head < std::min(before.size(), after.size()) && before[head] == after[head]) ++head;
  std::size_t tail = 0;
  while (tail < std::min(before.size(), after.size()) - head &&
         before[before.size() - 1 - tail] == after[after.size() - 1 - tail])
    ++tail;
  PositionFinder positions(document);
  const auto offset_of = [&](std::size_t line) {
    return line == before.size()
               ? document.text().size()
               : static_cast<std::size_t>(before[line].data() - document.text().data());
  };
  const auto replace = [&](std::size_t from, std::size_t to, std::size_t new_from,
                           std::size_t new_to) {
    std::string text;
    for (std::size_t line = new_from; line < new_to; ++line) text += after[line];
    // A whole line ends where the next one begins.
    edits.push_back(TextEdit(positions.Span(offset_of(from), offset_of(to)), text));
  };
  if (before.size() != after.size()) {
    replace(head, before.size() - tail, head, after.size() - tail);
    return edits;
  }
  for (std::size_t line = head; line < before.size() - tail; ++line) {
    if (before[line] == after[line]) continue;
    std::size_t last = line;
    while (last + 1 < before.size() - tail && before[last + 1] != after[last + 1]) ++last;
    replace(line, last + 1, line, last + 1);
    line = last;
  }
  return edits;
}

Json CodeActions(const Document& document, const Findings& findings, const Range& range,
                 const Json* only) {
  return Actions(document, FamilyOf(document).editing(), only).Make(findings, range);
}

}  // namespace rmlcell::lsp
