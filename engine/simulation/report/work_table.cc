#include "engine/simulation/report/work_table.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

// Energy by length says nothing on less: a rest of a motion that was told in parts.
constexpr double kMeanLengthMin_mm = 1e-3;

// Nothing is added most of the time, to most of them.
void AddTo(motion::LongSum& sum, double value) {
  if (value != 0.0) sum.Add(value);
}

// Whether there is anything of what WorkTable::Rest counts.
bool HasRest(const WorkFigures& work) {
  const TimeParts& time = work.time;
  const SimTime::rep times = time.settling.count() | time.dwell.count() | time.pierce.count() |
                             time.condition.count() | time.operator_wait.count() |
                             time.spin_up.count() | time.load.count() | time.standstill.count();
  return times != 0 || (work.beam_switches | work.pierces | work.plunges) != 0 ||
         work.plunge_mm != 0.0 || work.pierce_energy_j != 0.0;
}

}  // namespace

SimTime TimeParts::total() const {
  return motion + settling + dwell + pierce + condition + operator_wait + spin_up + load +
         standstill;
}

void WorkTable::Rest::Add(const WorkFigures& work) {
  time.settling += work.time.settling;
  time.dwell += work.time.dwell;
  time.pierce += work.time.pierce;
  time.condition += work.time.condition;
  time.operator_wait += work.time.operator_wait;
  time.spin_up += work.time.spin_up;
  time.load += work.time.load;
  time.standstill += work.time.standstill;
  beam_switches += work.beam_switches;
  pierces += work.pierces;
  plunges += work.plunges;
  AddTo(plunge, work.plunge_mm);
  AddTo(pierce_energy, work.pierce_energy_j);
}

void WorkTable::Sum::Add(const WorkFigures& work) {
  steps += work.steps;
  motion += work.time.motion;
  beam_on += work.beam_on;
  shutter_open += work.shutter_open;
  AddTo(tip_path, work.tip_path_mm);
  AddTo(cut, work.cut_mm);
  AddTo(travel, work.travel_mm);
  AddTo(cut_energy, work.cut_energy_j);
  if (work.cut_mm >= kMeanLengthMin_mm)
    energy_j_per_mm_max = std::max(energy_j_per_mm_max, work.energy_j_per_mm());
  if (!HasRest(work)) return;
  if (rest == nullptr) rest = std::make_unique<Rest>();
  rest->Add(work);
}

WorkFigures WorkTable::Sum::Total() const {
  WorkFigures figures{.steps = steps,
                      .tip_path_mm = tip_path.value(),
                      .cut_mm = cut.value(),
                      .travel_mm = travel.value(),
                      .beam_on = beam_on,
                      .shutter_open = shutter_open,
                      .cut_energy_j = cut_energy.value(),
                      .energy_j_per_mm_max = energy_j_per_mm_max};
  if (rest != nullptr) {
    figures.time = rest->time;
    figures.beam_switches = rest->beam_switches;
    figures.pierces = rest->pierces;
    figures.plunges = rest->plunges;
    figures.plunge_mm = rest->plunge.value();
    figures.pierce_energy_j = rest->pierce_energy.value();
  }
  figures.time.motion = motion;
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
  ++total_.steps;
  Sum* step = StepOf(place);
  ++(step != nullptr ? *step : rest_).steps;
  if (Sum* program = ProgramOf(place.program); program != nullptr) ++program->steps;
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

void WorkTable::WriteTo(RunReport& report, bool each_step) const {
  report.total = total_.Total();
  report.rest = rest_.Total();
  for (const auto& [program, sum] : programs_) {
    report.programs[program].total = sum.Total();
    report.programs[program].total.energy_j_per_mm_max = 0.0;
  }
  report.steps.clear();
  if (each_step) report.steps.reserve(steps_.size());
  double& highest = report.total.energy_j_per_mm_max;
  highest = report.rest.energy_j_per_mm();
  for (const auto& [key, step] : steps_) {
    const WorkFigures figures = step.sum.Total();
    const double mean = figures.energy_j_per_mm();
    if (each_step)
      report.steps.push_back(
          {.program = key.first, .step = key.second, .line = step.line, .figures = figures});
    highest = std::max(highest, mean);
    const auto program = report.programs.find(key.first);
    if (program == report.programs.end()) continue;
    double& of_program = program->second.total.energy_j_per_mm_max;
    of_program = std::max(of_program, mean);
  }
}

}  // namespace rmlcell::simulation
