#include "engine/machine/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::machine {
namespace {

int DecimalsOf(std::string_view unit) {
  if (unit.empty()) return 0;
  return unit == "%" ? 1 : 3;
}

// "# mm/s in place of #{name}" with its numbers.
Detail Filled(const VerdictRule& rule, const Figure& figure, std::span<const Figure> figures) {
  std::string_view said = rule.said;
  Detail text;
  for (std::size_t mark = said.find('#'); mark != std::string_view::npos; mark = said.find('#')) {
    text += said.substr(0, mark);
    said.remove_prefix(mark + 1);
    if (!said.starts_with('{')) {
      text += Told(rule.figure, figure.value, figure.unit,
                   FixedText(figure.value, DecimalsOf(figure.unit)));
      continue;
    }
    const std::size_t end = said.find('}');
    const auto named = std::ranges::find(figures, said.substr(1, end - 1), &Figure::name);
    if (named != figures.end()) {
      const double digits = std::abs(named->value) < 1e-3 ? 1e6 : 1e3;
      text += Told(named->name, named->value, named->unit,
                   ShortestText(std::round(named->value * digits) / digits));
    }
    said.remove_prefix(end + 1);
  }
  return text + said;
}

}  // namespace

std::string_view VerdictText(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "GOOD";
    case Verdict::kDoubtful:
      return "DOUBTFUL";
    case Verdict::kBad:
      return "BAD";
  }
  return "BAD";
}

void Judgement::Add(Reason reason) {
  verdict = std::max(verdict, reason.verdict);
  const auto behind = std::ranges::find_if(
      reasons, [&](const Reason& there) { return there.verdict < reason.verdict; });
  reasons.insert(behind, std::move(reason));
}

Reason ReasonOf(const VerdictRule& rule, const Figure& figure, std::span<const Figure> figures) {
  return {.code = rule.code,
          .verdict = rule.verdict,
          .said = Filled(rule, figure, figures),
          .amount = figure.value,
          .limit = rule.limit,
          .unit = figure.unit,
          .first = figure.first};
}

Judged JudgedBy(const Judgement& judgement, ErrorCode code) {
  Judged worst = Judged::kNo;
  for (const Reason& reason : judgement.reasons) {
    if (reason.code != code) continue;
    worst = std::max(worst, reason.verdict == Verdict::kBad ? Judged::kBad : Judged::kDoubtful);
  }
  return worst;
}

void MarkJudged(const Judgement& judgement, std::span<Diagnostic> findings) {
  for (Diagnostic& finding : findings) finding.judged = JudgedBy(judgement, finding.code);
}

void MarkJudged(const Judgement& judgement, UntoldFindings& findings) {
  findings.Mark([&](ErrorCode code) { return JudgedBy(judgement, code); });
}

}  // namespace rmlcell::machine
