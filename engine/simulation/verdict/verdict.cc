#include "engine/simulation/verdict/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/families/families.h"
#include "engine/simulation/verdict/cut_rules.h"

namespace rmlcell::simulation {
namespace {

using machine::Verdict;

constexpr double kRounding_mm = 0.01;

// What is told as the limit is not above it: figures are sums of decimals in binary, heights over
// cells have single precision.
bool IsAbove(double value, double limit) {
  constexpr double kSame = 1e-5;
  return value > limit + kSame;
}

Measured Gouges(const RunReport& r) {
  if (!r.milling) return {};
  return {static_cast<double>(r.milling->gouges), r.milling->gouge_place};
}
Measured BelowBlock(const RunReport& r) {
  if (!r.milling) return {};
  return {r.milling->below_mm, r.milling->below_place};
}
// A third of the width: at least three cells lie across the way then, wherever it leads, and the
// one next to its middle is no further off than a sixth of the width.
constexpr double kCellsAcross = 3.0;
constexpr double kCellShare_percent = 33.4;  // and rounding

// The cell to give, in digits that people write, and not rounded up.
double FittingCell(double width_mm) {
  const double cell_mm = width_mm / kCellsAcross;
  const double step_mm = cell_mm < 1e-3 ? 1e-6 : 1e-3;
  constexpr double kLastDigits = 1e-6;
  return std::floor(cell_mm / step_mm + kLastDigits) * step_mm;
}
Measured CellShare(const RunReport& r) {
  if (!r.milling || !(r.milling->reach_width_mm > 0.0)) return {};
  return {100.0 * r.milling->cell_mm / r.milling->reach_width_mm,
          r.milling->reach_place,
          {.name = "fitting_cell", .unit = "mm", .value = FittingCell(r.milling->reach_width_mm)}};
}
// Cells that are too wide to notice the tool are told themselves.
Measured BlockUntouched(const RunReport& r) {
  const bool untouched = r.milling && !(r.milling->removed_mm3 > 0.0);
  return {untouched && !IsAbove(CellShare(r).value, kCellShare_percent) ? 1.0 : 0.0};
}
Measured Beside(const RunReport& r) {
  if (!r.milling) return {};
  return {r.milling->beside_mm, r.milling->beside_place};
}
template <double MillingFigures::*kEdge>
Measured BesideEdge(const RunReport& r) {
  return {IsAbove(Beside(r).value, kRounding_mm) ? *r.milling.*kEdge : 0.0, {}};
}
Measured ShankDepth(const RunReport& r) {
  if (!r.milling) return {};
  return {r.milling->shank_depth_mm, r.milling->shank_place};
}
Measured PassShare(const RunReport& r) {
  if (!r.milling || !(r.milling->tool_diameter_mm > 0.0)) return {};
  return {100.0 * r.milling->deepest_pass_mm / r.milling->tool_diameter_mm, r.milling->pass_place};
}
// What the machine cannot do faster and the program cuts with, too, is its feed.
Measured FastPlunge(const RunReport& r) {
  if (!r.milling || r.milling->pass_mm_s >= r.milling->fast_plunge_mm_s) return {};
  return {r.milling->fast_plunge_mm, r.milling->fast_plunge_place};
}
template <double ChipFigures::*kPercent, machine::Place ChipFigures::*kPlace>
Measured OfChips(const RunReport& r) {
  if (!r.milling || !r.milling->chips) return {};
  return {*r.milling->chips.*kPercent, *r.milling->chips.*kPlace};
}
Measured TargetDeep(const RunReport& r) {
  if (!r.milling || !r.milling->target) return {};
  const TargetFigures& target = *r.milling->target;
  return {IsAbove(target.deep_mm, target.tolerance_mm) ? target.deep_mm : 0.0, {}};
}
Measured TargetLeft(const RunReport& r) {
  if (!r.milling || !r.milling->target) return {};
  const TargetFigures& target = *r.milling->target;
  return {IsAbove(target.left_mm, target.tolerance_mm) ? target.left_mm : 0.0, {}};
}
Measured TravelLeft(const RunReport& r) {
  if (r.violations.empty()) return {};
  return {static_cast<double>(r.violations.size() + r.violations_dropped),
          r.violations.front().place};
}

constexpr double kThroughTheBlock_mm = 1.0;  // deeper than a cut that is to go through
constexpr double kTwiceUsual_percent = 200.0;
constexpr double kHalfUsual_percent = 50.0;
constexpr double kPassShare_percent = 100.1;  // once its diameter, and the rounding of heights

// clang-format off
constexpr std::array kRules = {
    MeasuredRule{{{ErrorCode::kCellTravelLeft, "travel_violations", 0.0, Verdict::kBad, "motions that leave the travel of an axis: #"}, "", "motions that leave the travel of an axis"}, TravelLeft},
    MeasuredRule{{{ErrorCode::kCellGouge, "gouges", 0.0, Verdict::kBad, "motions at travel speed through material: #"}, "", "motions at travel speed through the block that was given"}, Gouges},
    MeasuredRule{{{ErrorCode::kCellBelowBlock, "below_block", kThroughTheBlock_mm, Verdict::kBad, "the tool goes # mm below the block"}, "mm", "how far the tool goes below the block that was given"}, BelowBlock},
    MeasuredRule{{{ErrorCode::kCellBelowBlock, "below_block", kRounding_mm, Verdict::kDoubtful, "the tool goes # mm below the block"}, "mm", "how far the tool goes below the block that was given"}, BelowBlock},
    MeasuredRule{{{ErrorCode::kCellTooWide, "cell_share", kCellShare_percent, Verdict::kDoubtful, "a cell is as wide as # % of the tool at the top of its deepest cut, so that cuts and faults are missed: give --cell #{fitting_cell}"}, "%", "edge of a cell, by the width of the tool at the top of the block where it goes deepest"}, CellShare},
    MeasuredRule{{{ErrorCode::kCellBlockUntouched, "block_untouched", 0.0, Verdict::kDoubtful, "the tool takes nothing off the block"}, "", "1 when nothing is taken off the block that was given"}, BlockUntouched},
    MeasuredRule{{{ErrorCode::kCellBesideBlock, "beside_block", kRounding_mm, Verdict::kDoubtful, "# mm of the work lie beside the block"}, "mm", "way in the work, lower than the top of the block, with the tool beside it by more than its diameter"}, Beside},
    MeasuredRule{{{ErrorCode::kCellBesideBlock, "beside_block_x_low", kRounding_mm, Verdict::kDoubtful, "the work leads # mm beyond the edge of the block at its least X"}, "mm", "how far that leads beyond the least X of the block"}, BesideEdge<&MillingFigures::beside_x_low_mm>},
    MeasuredRule{{{ErrorCode::kCellBesideBlock, "beside_block_x_high", kRounding_mm, Verdict::kDoubtful, "the work leads # mm beyond the edge of the block at its greatest X"}, "mm", "how far it leads beyond the greatest X"}, BesideEdge<&MillingFigures::beside_x_high_mm>},
    MeasuredRule{{{ErrorCode::kCellBesideBlock, "beside_block_y_low", kRounding_mm, Verdict::kDoubtful, "the work leads # mm beyond the edge of the block at its least Y"}, "mm", "how far it leads beyond the least Y"}, BesideEdge<&MillingFigures::beside_y_low_mm>},
    MeasuredRule{{{ErrorCode::kCellBesideBlock, "beside_block_y_high", kRounding_mm, Verdict::kDoubtful, "the work leads # mm beyond the edge of the block at its greatest Y"}, "mm", "how far it leads beyond the greatest Y"}, BesideEdge<&MillingFigures::beside_y_high_mm>},
    MeasuredRule{{{ErrorCode::kCellShankInMaterial, "shank_depth", kRounding_mm, Verdict::kBad, "shank or holder goes # mm into material"}, "mm", "how deep shank or holder of the tool goes into the block that was given"}, ShankDepth},
    MeasuredRule{{{ErrorCode::kCellDeepPass, "pass_share", kPassShare_percent, Verdict::kDoubtful, "one pass is as deep as # % of the width of the tool"}, "%", "most that one motion across takes off in depth, by the diameter of the tool"}, PassShare},
    MeasuredRule{{{ErrorCode::kCellFastPlunge, "fast_plunge_in_material", kRounding_mm, Verdict::kDoubtful, "the tool goes # mm down into material nearly as fast as Z travels, faster than it cuts"}, "mm", "most that one way down takes off at 80 % of the speed at which Z travels or more, when the tool cuts slower across"}, FastPlunge},
    MeasuredRule{{{ErrorCode::kCellChipThick, "chip_thick", kTwiceUsual_percent, Verdict::kDoubtful, "an edge takes off # % of the most that is usual"}, "%", "greatest chip load, by the most that is usual for tool and material"}, OfChips<&ChipFigures::thick_percent, &ChipFigures::thick_place>},
    MeasuredRule{{{ErrorCode::kCellChipThick, "plunge_thick", kTwiceUsual_percent, Verdict::kDoubtful, "an edge takes off # % of the most that is usual straight down"}, "%", "greatest chip load of a plunge, by the most that is usual for tool and material"}, OfChips<&ChipFigures::plunge_percent, &ChipFigures::plunge_place>},
    MeasuredRule{{{ErrorCode::kCellChipThin, "chip_thin", kHalfUsual_percent, Verdict::kDoubtful, "an edge takes off # % less than the least that is usual"}, "%", "how far the least chip load is below the least that is usual"}, OfChips<&ChipFigures::thin_percent, &ChipFigures::thin_place>},
    MeasuredRule{{{ErrorCode::kCellEdgeFast, "edge_speed", kTwiceUsual_percent, Verdict::kDoubtful, "an edge goes at # % of the greatest speed that is usual"}, "%", "greatest speed of an edge, by the greatest that is usual for the material"}, OfChips<&ChipFigures::speed_percent, &ChipFigures::speed_place>},
    MeasuredRule{{{ErrorCode::kCellTargetGouged, "target_deep", 0.0, Verdict::kBad, "the part is cut # mm below its target"}, "mm", "deepest of what is missing below the target, when that is above the tolerance"}, TargetDeep},
    MeasuredRule{{{ErrorCode::kCellTargetLeft, "target_left", 0.0, Verdict::kDoubtful, "# mm stand above the target"}, "mm", "highest of what stands above the target, when that is above the tolerance"}, TargetLeft},
};
// clang-format on

// One figure may have several limits: the most serious rule speaks for all of them.
bool IsSaid(const machine::Judgement& judgement, const machine::VerdictRule& rule) {
  return std::ranges::any_of(judgement.reasons, [&](const machine::Reason& reason) {
    return reason.code == rule.code && reason.verdict > rule.verdict;
  });
}

void AddMeasuredRules(std::span<const MeasuredRule> rules, const RunReport& report,
                      const machine::MachineFamily* family, machine::Judgement& judgement) {
  for (const MeasuredRule& rule : rules) {
    machine::VerdictRule what = rule.info.rule;
    if (family != nullptr && what.code == ErrorCode::kCellTravelLeft)
      what.code = family->info().travel_left;
    const Measured measured = rule.measure(report);
    // The outcome may have said it.
    const bool said = report.outcome.code == what.code || IsSaid(judgement, what);
    if (!IsAbove(measured.value, what.limit) || said) continue;
    judgement.Add(machine::ReasonOf(
        what,
        {.unit = std::string(rule.info.unit), .value = measured.value, .first = measured.first},
        {&measured.beside, 1}));
  }
}

void AddFamilyRules(const machine::MachineFamily& family, std::span<const machine::Figure> figures,
                    machine::Judgement& judgement) {
  for (const machine::VerdictRule& rule : family.verdict_rules()) {
    const auto figure = std::ranges::find(figures, rule.figure, &machine::Figure::name);
    if (figure != figures.end() && IsAbove(figure->value, rule.limit) && !IsSaid(judgement, rule))
      judgement.Add(machine::ReasonOf(rule, *figure, figures));
  }
}

}  // namespace

std::span<const VerdictRuleInfo> CommonVerdictRules() {
  static const auto infos = [] {
    std::vector<VerdictRuleInfo> made;
    for (const MeasuredRule& rule : kRules) made.push_back(rule.info);
    for (const MeasuredRule& rule : CutRules()) made.push_back(rule.info);
    return made;
  }();
  return infos;
}

machine::Judgement JudgeOutcome(const machine::Outcome& outcome) {
  machine::Judgement judgement;
  if (outcome.kind == machine::OutcomeKind::kCompleted) return judgement;
  if (outcome.code == machine::kWaitsForKey.code) {
    judgement.Add(machine::ReasonOf(machine::kWaitsForKey, {.value = 1.0, .first = outcome.place}));
    return judgement;
  }
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
  AddMeasuredRules(kRules, report, family, judgement);
  AddMeasuredRules(CutRules(), report, family, judgement);
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
  judgement.Add({.code = first->code,
                 .verdict = Verdict::kBad,
                 .said = Said(first->code, first->detail),
                 .first = {.program = first->program,
                           .step = first->step,
                           .line = where.line,
                           .byte_offset = where.byte_offset}});
  return judgement;
}

}  // namespace rmlcell::simulation
