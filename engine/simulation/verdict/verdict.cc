#include "engine/simulation/verdict/verdict.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/families/families.h"

namespace rmlcell::simulation {
namespace {

using machine::Verdict;

// A figure of every machine; nothing where the run has none of it.
struct Measured {
  double value = 0.0;
  machine::Place first{};
};
struct CommonRule {
  VerdictRuleInfo info;
  Measured (*measure)(const RunReport&);
};

Measured Gouges(const RunReport& r) {
  if (!r.milling) return {};
  return {static_cast<double>(r.milling->gouges), r.milling->gouge_place};
}
Measured BelowBlock(const RunReport& r) {
  if (!r.milling) return {};
  return {r.milling->below_mm, r.milling->below_place};
}
Measured BlockUntouched(const RunReport& r) {
  return {r.milling && !(r.milling->removed_mm3 > 0.0) ? 1.0 : 0.0, {}};
}
Measured TravelLeft(const RunReport& r) {
  if (r.violations.empty()) return {};
  return {static_cast<double>(r.violations.size() + r.violations_dropped),
          r.violations.front().place};
}

constexpr double kThroughTheBlock_mm = 1.0;  // deeper than a cut that is to go through
constexpr double kRounding_mm = 0.01;

// clang-format off
constexpr std::array kRules = {
    CommonRule{{{ErrorCode::kCellTravelLeft, "travel_violations", 0.0, Verdict::kBad, "motions that leave the travel of an axis: #"}, "", "motions that leave the travel of an axis"}, TravelLeft},
    CommonRule{{{ErrorCode::kCellGouge, "gouges", 0.0, Verdict::kBad, "motions at travel speed through material: #"}, "", "motions at travel speed through the block that was given"}, Gouges},
    CommonRule{{{ErrorCode::kCellBelowBlock, "below_block", kThroughTheBlock_mm, Verdict::kBad, "the tool goes # mm below the block"}, "mm", "how far the tool goes below the block that was given"}, BelowBlock},
    CommonRule{{{ErrorCode::kCellBelowBlock, "below_block", kRounding_mm, Verdict::kDoubtful, "the tool goes # mm below the block"}, "mm", "how far the tool goes below the block that was given"}, BelowBlock},
    CommonRule{{{ErrorCode::kCellBlockUntouched, "block_untouched", 0.0, Verdict::kDoubtful, "the tool takes nothing off the block"}, "", "1 when nothing is taken off the block that was given"}, BlockUntouched},
};
// clang-format on

// One figure may have several limits: the most serious rule speaks for all of them.
bool Told(const machine::Judgement& judgement, const machine::VerdictRule& rule) {
  return std::ranges::any_of(judgement.reasons, [&](const machine::Reason& reason) {
    return reason.code == rule.code && reason.verdict > rule.verdict;
  });
}

void AddFamilyRules(const machine::MachineFamily& family, std::span<const machine::Figure> figures,
                    machine::Judgement& judgement) {
  for (const machine::VerdictRule& rule : family.verdict_rules()) {
    const auto figure = std::ranges::find(figures, rule.figure, &machine::Figure::name);
    if (figure != figures.end() && figure->value > rule.limit && !Told(judgement, rule))
      judgement.Add(machine::ReasonOf(rule, *figure));
  }
}

}  // namespace

std::span<const VerdictRuleInfo> CommonVerdictRules() {
  static const auto infos = [] {
    std::array<VerdictRuleInfo, kRules.size()> made;
    std::ranges::transform(kRules, made.begin(), &CommonRule::info);
    return made;
  }();
  return infos;
}

machine::Judgement JudgeOutcome(const machine::Outcome& outcome) {
  machine::Judgement judgement;
  if (outcome.kind == machine::OutcomeKind::kCompleted) return judgement;
  const bool stopped = outcome.kind == machine::OutcomeKind::kStopped;
  machine::Reason reason{.code = outcome.code.value_or(ErrorCode::kCellWaitsForever),
                         .verdict = stopped ? Verdict::kDoubtful : Verdict::kBad,
                         .said = outcome.detail,
                         .first = outcome.place};
  if (reason.said.empty()) reason.said = std::string(Lookup(reason.code).when);
  judgement.Add(std::move(reason));
  return judgement;
}

machine::Judgement Judge(const RunReport& report) {
  machine::Judgement judgement = JudgeOutcome(report.outcome);
  const machine::MachineFamily* const family = families::FindFamily(report.family);
  for (const CommonRule& rule : kRules) {
    machine::VerdictRule what = rule.info.rule;
    if (family != nullptr && what.code == ErrorCode::kCellTravelLeft)
      what.code = family->info().travel_left;
    const Measured measured = rule.measure(report);
    // The outcome may have said it.
    const bool said = report.outcome.code == what.code || Told(judgement, what);
    if (measured.value > what.limit && !said) {
      judgement.Add(machine::ReasonOf(
          what,
          {.unit = std::string(rule.info.unit), .value = measured.value, .first = measured.first}));
    }
  }
  if (family != nullptr) AddFamilyRules(*family, report.figures, judgement);
  return judgement;
}

machine::Judgement JudgeFigures(const machine::MachineFamily& family,
                                std::span<const machine::Figure> figures) {
  machine::Judgement judgement;
  AddFamilyRules(family, figures, judgement);
  return judgement;
}

machine::Judgement JudgeFindings(std::span<const Diagnostic> findings) {
  machine::Judgement judgement;
  const auto first = std::ranges::find_if(
      findings, [](const Diagnostic& finding) { return IsError(finding.severity); });
  if (first == findings.end()) return judgement;
  const auto& where = first->where;
  judgement.Add(
      {.code = first->code,
       .verdict = Verdict::kBad,
       .said = first->detail.empty() ? std::string(Lookup(first->code).when) : first->detail,
       .first = {.program = first->program,
                 .step = first->step,
                 .line = where.line,
                 .byte_offset = where.byte_offset}});
  return judgement;
}

}  // namespace rmlcell::simulation
