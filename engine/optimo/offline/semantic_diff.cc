#include "engine/optimo/offline/semantic_diff.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/alignment.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/language/printer.h"
#include "engine/optimo/offline/semantic_step.h"

namespace rmlcell::optimo {
namespace {

constexpr double kSameFigure = 1e-9;  // relative

using Steps = std::vector<SemanticStep>;

std::vector<std::uint64_t> Keys(const Steps& steps, std::string SemanticStep::*of,
                                std::size_t first, std::size_t last) {
  std::vector<std::uint64_t> keys;
  keys.reserve(last - first);
  for (std::size_t s = first; s < last; ++s) keys.push_back(HashObject(steps[s].*of));
  return keys;
}

class Differ {
 public:
  Differ(const Module& a, const Module& b)
      : a_(a),
        b_(b),
        fold_(CanFold(a, b)),
        steps_a_(StepsOf(a, fold_)),
        steps_b_(StepsOf(b, fold_)),
        index_a_(a),
        index_b_(b) {}

  std::vector<StepChange> Run() {
    Pair();
    std::size_t next_a = 0;
    const auto removed_up_to = [&](std::size_t end) {
      for (; next_a < end; ++next_a) {
        if (!partner_of_a_[next_a]) changes_.push_back(Gone(next_a));
      }
    };
    for (std::size_t s = 0; s < steps_b_.size(); ++s) {
      if (!partner_of_b_[s]) {
        changes_.push_back(Come(s));
        continue;
      }
      removed_up_to(*partner_of_b_[s]);
      AddIfChanged(*partner_of_b_[s], s);
      next_a = *partner_of_b_[s] + 1;
    }
    removed_up_to(steps_a_.size());
    return std::move(changes_);
  }

 private:
  // First what is equal, then between two equal stretches what one may have been made from the
  // other.
  void Pair() {
    partner_of_a_.resize(steps_a_.size());
    partner_of_b_.resize(steps_b_.size());
    const auto equal = Align(Keys(steps_a_, &SemanticStep::meaning, 0, steps_a_.size()),
                             Keys(steps_b_, &SemanticStep::meaning, 0, steps_b_.size()));
    std::size_t a = 0, b = 0;
    const auto pair_gap = [&](std::size_t end_a, std::size_t end_b) {
      for (const AlignedPair& pair : Align(Keys(steps_a_, &SemanticStep::kind, a, end_a),
                                           Keys(steps_b_, &SemanticStep::kind, b, end_b))) {
        Join(a + pair.a, b + pair.b);
      }
    };
    for (const AlignedPair& pair : equal) {
      pair_gap(pair.a, pair.b);
      Join(pair.a, pair.b);
      a = pair.a + 1;
      b = pair.b + 1;
    }
    pair_gap(steps_a_.size(), steps_b_.size());
  }
  void Join(std::size_t a, std::size_t b) {
    partner_of_a_[a] = b;
    partner_of_b_[b] = a;
  }

  StepChange Begin(StepChange::Kind kind) const {
    StepChange change;
    change.kind = kind;
    return change;
  }
  StepChange Gone(std::size_t s) const {
    StepChange change = Begin(StepChange::Kind::kRemoved);
    const Instruction& i = a_.instructions[steps_a_[s].instruction];
    change.aspects = steps_a_[s].aspects;
    change.step_a = static_cast<int>(i.step);
    PrintStatement(a_, i, change.before);
    return change;
  }
  StepChange Come(std::size_t s) const {
    StepChange change = Begin(StepChange::Kind::kAdded);
    const Instruction& i = b_.instructions[steps_b_[s].instruction];
    change.aspects = steps_b_[s].aspects;
    change.step_b = static_cast<int>(i.step);
    PrintStatement(b_, i, change.after);
    return change;
  }

  void AddIfChanged(std::size_t sa, std::size_t sb) {
    const Instruction& i = a_.instructions[steps_a_[sa].instruction];
    const Instruction& j = b_.instructions[steps_b_[sb].instruction];
    StepDifference difference = Compare(a_, steps_a_[sa], b_, steps_b_[sb]);
    CompareTargets(i, j, difference);
    if (difference.what.empty() && steps_a_[sa].meaning == steps_b_[sb].meaning) return;
    StepChange change = Begin(StepChange::Kind::kChanged);
    change.aspects = difference.aspects;
    change.step_a = static_cast<int>(i.step);
    change.step_b = static_cast<int>(j.step);
    PrintStatement(a_, i, change.before);
    PrintStatement(b_, j, change.after);
    change.what = std::move(difference.what);
    change.target_moved_mm = difference.target_moved_mm;
    changes_.push_back(std::move(change));
  }

  // Where a jump comes to: the first step from there on that both programs have, as a step of b;
  // the number of steps of b for the end.
  std::size_t AnchorFromA(std::uint32_t instruction) const {
    for (std::size_t s = StepAt(steps_a_, instruction); s < steps_a_.size(); ++s) {
      if (partner_of_a_[s]) return *partner_of_a_[s];
    }
    return steps_b_.size();
  }
  std::size_t AnchorFromB(std::uint32_t instruction) const {
    for (std::size_t s = StepAt(steps_b_, instruction); s < steps_b_.size(); ++s) {
      if (partner_of_b_[s]) return s;
    }
    return steps_b_.size();
  }
  static std::size_t StepAt(const Steps& steps, std::uint32_t instruction) {
    return static_cast<std::size_t>(
        std::ranges::lower_bound(steps, instruction, {}, &SemanticStep::instruction) -
        steps.begin());
  }
  static std::string StepText(const Module& module, const std::optional<std::uint32_t>& at,
                              std::uint16_t label) {
    if (!at) return "missing " + std::to_string(label);
    return *at < module.instructions.size()
               ? "step " + std::to_string(module.instructions[*at].step)
               : "the end";
  }

  void CompareTargets(const Instruction& i, const Instruction& j, StepDifference& to) const {
    for (std::uint32_t t = 0; t < i.target_count && t < j.target_count; ++t) {
      const std::uint16_t label_a = a_.targets[i.first_target + t];
      const std::uint16_t label_b = b_.targets[j.first_target + t];
      const auto at_a = index_a_.FindLabel(label_a), at_b = index_b_.FindLabel(label_b);
      const bool same = at_a && at_b ? AnchorFromA(*at_a) == AnchorFromB(*at_b)
                                     : !at_a && !at_b && label_a == label_b;
      if (same) continue;
      to.aspects |= kAspectFlow;
      to.what.push_back("goes to " + StepText(a_, at_a, label_a) + " -> " +
                        StepText(b_, at_b, label_b));
    }
  }

  const Module& a_;
  const Module& b_;
  bool fold_;
  Steps steps_a_, steps_b_;
  ModuleIndex index_a_, index_b_;
  std::vector<std::optional<std::size_t>> partner_of_a_, partner_of_b_;
  std::vector<StepChange> changes_;
};

std::vector<FigureChange> CompareFigures(const std::vector<machine::Figure>& a,
                                         const std::vector<machine::Figure>& b) {
  std::map<std::string, FigureChange> by_name;
  for (const machine::Figure& figure : a)
    by_name[figure.name] = {figure.name, figure.unit, figure.value, 0.0};
  for (const machine::Figure& figure : b) {
    FigureChange& change = by_name[figure.name];
    change.name = figure.name;
    change.unit = figure.unit;
    change.after = figure.value;
  }
  std::vector<FigureChange> changes;
  for (auto& [name, change] : by_name) {
    const double size = std::max(std::fabs(change.before), std::fabs(change.after));
    if (std::fabs(change.after - change.before) > kSameFigure * size)
      changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace

std::string AspectText(unsigned aspects) {
  constexpr std::array<std::pair<Aspect, std::string_view>, 6> kNames = {
      {{kAspectPath, "path"},
       {kAspectTime, "time"},
       {kAspectPower, "power"},
       {kAspectOutputs, "outputs"},
       {kAspectData, "data"},
       {kAspectFlow, "flow"}}};
  std::string text;
  for (const auto& [aspect, name] : kNames) {
    if ((aspects & aspect) == 0) continue;
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

ProgramDiff Diff(const Module& a, const Module& b, const std::vector<machine::Figure>& figures_a,
                 const std::vector<machine::Figure>& figures_b) {
  ProgramDiff diff;
  diff.steps = Differ(a, b).Run();
  diff.figures = CompareFigures(figures_a, figures_b);
  for (const StepChange& step : diff.steps) diff.aspects |= step.aspects;
  return diff;
}

}  // namespace rmlcell::optimo
