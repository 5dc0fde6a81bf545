#include "engine/simulation/report/work_table.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

// Energy by length says nothing on less: a rest of a motion that was told in parts.
constexpr double kMeanLengthMin_mm = 1e-3;

}  // namespace

SimTime TimeParts::total() const {
  return motion + settling + dwell + pierce + condition + operator_wait + spin_up + load +
         standstill;
}

void WorkTable::Sum::Add(const WorkFigures& work) {
  counts.steps += work.steps;
  counts.time.motion += work.time.motion;
  counts.time.settling += work.time.settling;
  counts.time.dwell += work.time.dwell;
  counts.time.pierce += work.time.pierce;
  counts.time.condition += work.time.condition;
  counts.time.operator_wait += work.time.operator_wait;
  counts.time.spin_up += work.time.spin_up;
  counts.time.load += work.time.load;
  counts.time.standstill += work.time.standstill;
  counts.beam_on += work.beam_on;
  counts.shutter_open += work.shutter_open;
  counts.beam_switches += work.beam_switches;
  counts.pierces += work.pierces;
  counts.plunges += work.plunges;
  // Nothing is added most of the time, to most of them.
  const auto add = [](motion::LongSum& sum, double value) {
    if (value != 0.0) sum.Add(value);
  };
  add(tip_path, work.tip_path_mm);
  add(cut, work.cut_mm);
  add(travel, work.travel_mm);
  add(plunge, work.plunge_mm);
  add(cut_energy, work.cut_energy_j);
  if (work.cut_mm >= kMeanLengthMin_mm) {
    counts.energy_j_per_mm_max = std::max(counts.energy_j_per_mm_max, work.energy_j_per_mm());
  }
  add(pierce_energy, work.pierce_energy_j);
}

WorkFigures WorkTable::Sum::Total() const {
  WorkFigures figures = counts;
  figures.tip_path_mm = tip_path.value();
  figures.cut_mm = cut.value();
  figures.travel_mm = travel.value();
  figures.plunge_mm = plunge.value();
  figures.cut_energy_j = cut_energy.value();
  figures.pierce_energy_j = pierce_energy.value();
  return figures;
}

WorkTable::Sum* WorkTable::StepOf(const machine::Place& place) {
  const std::pair key{place.program, place.step};
  if (key == last_step_) return last_sum_;
  const bool behind = steps_.empty() || key > steps_.rbegin()->first;
  auto found = behind ? steps_.end() : steps_.find(key);
  if (found == steps_.end() && steps_.size() < kReportedStepsMax)
    found = steps_.emplace_hint(steps_.end(), key, Step{.line = place.line, .sum = {}});
  last_step_ = key;
  last_sum_ = found != steps_.end() ? &found->second.sum : nullptr;
  return last_sum_;
}

void WorkTable::AddStep(const machine::Place& place) {
  ++total_.counts.steps;
  Sum* step = StepOf(place);
  ++(step != nullptr ? *step : rest_).counts.steps;
  if (Sum* program = ProgramOf(place.program); program != nullptr) ++program->counts.steps;
}

WorkTable::Sum* WorkTable::ProgramOf(int program) {
  if (last_program_sum_ != nullptr && program == last_program_) return last_program_sum_;
  if (!programs_.contains(program) && programs_.size() >= kReportedProgramsMax) return nullptr;
  last_program_ = program;
  last_program_sum_ = &programs_[program];
  return last_program_sum_;
}

void WorkTable::Add(const machine::Place& place, const WorkFigures& work) {
  total_.Add(work);
  Sum* step = StepOf(place);
  (step != nullptr ? *step : rest_).Add(work);
  if (Sum* program = ProgramOf(place.program); program != nullptr) program->Add(work);
}

void WorkTable::WriteTo(RunReport& report) const {
  report.total = total_.Total();
  report.rest = rest_.Total();
  for (const auto& [program, sum] : programs_) {
    report.programs[program].total = sum.Total();
    report.programs[program].total.energy_j_per_mm_max = 0.0;
  }
  report.steps.clear();
  report.steps.reserve(steps_.size());
  double& highest = report.total.energy_j_per_mm_max;
  highest = report.rest.energy_j_per_mm();
  for (const auto& [key, step] : steps_) {
    report.steps.push_back(
        {.program = key.first, .step = key.second, .line = step.line, .figures = step.sum.Total()});
    const double mean = report.steps.back().figures.energy_j_per_mm();
    highest = std::max(highest, mean);
    const auto program = report.programs.find(key.first);
    if (program == report.programs.end()) continue;
    double& of_program = program->second.total.energy_j_per_mm_max;
    of_program = std::max(of_program, mean);
  }
}

}  // namespace rmlcell::simulation
