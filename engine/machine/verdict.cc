#include "engine/machine/verdict.h"

#include <algorithm>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::machine {
namespace {

int DecimalsOf(std::string_view unit) {
  if (unit.empty()) return 0;
  return unit == "%" ? 1 : 3;
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

Reason ReasonOf(const VerdictRule& rule, const Figure& figure) {
  std::string said(rule.said);
  if (const std::size_t mark = said.find('#'); mark != std::string::npos)
    said.replace(mark, 1, FixedText(figure.value, DecimalsOf(figure.unit)));
  return {.code = rule.code,
          .verdict = rule.verdict,
          .said = std::move(said),
          .amount = figure.value,
          .unit = figure.unit,
          .first = figure.first};
}

}  // namespace rmlcell::machine
