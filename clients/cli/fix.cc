#include "clients/cli/fix.h"

#include <algorithm>
#include <span>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::cli {
namespace {

// How far behind a difference the texts are searched for where they agree again. Fixes stay within
// a statement, which seldom has as many lines.
constexpr std::size_t kSearchLines = 200;

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::size_t length = end == std::string_view::npos ? text.size() : end + 1;
    lines.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return lines;
}

// Lines that differ from `a` and `b` on: how many of each until both agree again.
struct Hunk {
  std::size_t removed = 0;
  std::size_t added = 0;
};
Hunk HunkAt(std::span<const std::string_view> a, std::span<const std::string_view> b) {
  for (std::size_t both = 1; both < 2 * kSearchLines; ++both) {
    for (std::size_t removed = 0; removed <= both; ++removed) {
      const std::size_t added = both - removed;
      if (removed < a.size() && added < b.size() && a[removed] == b[added]) return {removed, added};
    }
  }
  return {a.size(), b.size()};
}

std::string RangeText(std::size_t first, std::size_t count) {
  std::string text = std::to_string(count == 0 ? first : first + 1);
  if (count != 1) text += "," + std::to_string(count);
  return text;
}

void AppendLines(std::span<const std::string_view> lines, char sign, std::string& out) {
  for (const std::string_view line : lines) {
    out += sign;
    out += line;
    if (!line.ends_with('\n')) out += "\n\\ No newline at end of file\n";
  }
}

std::string FixedLine(const Diagnostic& finding) {
  Diagnostic plain = finding;
  plain.fixes.clear();
  return FormatDiagnostic(plain, {});
}

}  // namespace

std::string PatchText(const std::string& file, std::string_view before, std::string_view after) {
  const std::vector<std::string_view> a = LinesOf(before), b = LinesOf(after);
  std::string out;
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (i < a.size() && j < b.size() && a[i] == b[j]) {
      ++i;
      ++j;
      continue;
    }
    const auto rest_a = std::span(a).subspan(i), rest_b = std::span(b).subspan(j);
    const Hunk hunk = HunkAt(rest_a, rest_b);
    out += "@@ -" + RangeText(i, hunk.removed) + " +" + RangeText(j, hunk.added) + " @@\n";
    AppendLines(rest_a.first(hunk.removed), '-', out);
    AppendLines(rest_b.first(hunk.added), '+', out);
    i += hunk.removed;
    j += hunk.added;
  }
  return out.empty() ? out : "--- " + file + "\n+++ " + file + "\n" + out;
}

int FixFile(const std::string& file, const std::string& text, const FixCheck& check,
            const FixOptions& options) {
  const auto family = families::FamilyWithTools(file);
  const Status good = family ? (*family)->tools()->CheckIsText(file, text) : Status(family.error());
  if (!good) {
    Complain(bridge::ErrorText(good.error()));
    return kUsage;
  }
  const machine::RepairedText fixing =
      (*family)->tools()->Fix({.name = file, .bytes = text}, check.translate);
  const bool changed = fixing.text != text;
  if (changed && !options.dry_run) {
    if (const Status written = WriteWholeFile(file, fixing.text); !written) {
      Complain(bridge::ErrorText(written.error()));
      return kUsage;
    }
  }
  const Result<FixCheck::Left> judged = check.judge(fixing.left);
  if (!judged) return Refuse(judged.error());
  if (options.json) {
    v1::FixProgramResponse message;
    message.set_content(fixing.text);
    for (const Diagnostic& finding : fixing.fixed) *message.add_fixed() = bridge::ToProto(finding);
    *message.mutable_findings() = judged->found;
    Print(Json(message));
  } else if (options.dry_run) {
    PrintRaw(PatchText(file, text, fixing.text));
  } else {
    for (const Diagnostic& finding : fixing.fixed) {
      Print(Paint("fixed", Colour::kGreen, ColourOnOutput()) + "  " + FixedLine(finding));
    }
    const simulation::CheckedProgram& left = judged->check;
    PrintFindings(left.translation.diagnostics, left.translation.diagnostics_dropped, fixing.text);
    PrintFindings(left.motion.findings, left.motion.findings_dropped, fixing.text);
    Print(Visible(file) + ": " + std::to_string(fixing.fixed.size()) + " fixed, " +
          VerdictText(judged->found.verdict()) + CountText(judged->found));
    for (const v1::VerdictReason& reason : judged->found.reasons()) {
      Print("  " + ReasonLine(reason));
    }
  }
  if (options.dry_run && changed) return kProgramErrors;
  return ExitOf(judged->found, options.strict);
}

}  // namespace rmlcell::cli
