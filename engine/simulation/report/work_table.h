#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// Adds up what a run does: in all, by program and by step, in bounded memory. motion.md 8.2.
class WorkTable {
 public:
  WorkTable() = default;
  WorkTable(const WorkTable&) = delete;  // it remembers places within itself
  WorkTable& operator=(const WorkTable&) = delete;

  // A step was executed at `place`, and nothing else yet.
  void AddStep(const machine::Place& place);

  // `work` was done at `place`.
  void Add(const machine::Place& place, const WorkFigures& work);

  // Whether what a program does is counted by program; once it is, it stays so.
  bool HasRoomFor(int program) { return ProgramOf(program) != nullptr; }

  // Writes total, rest and the totals of the programs of the report; with `each_step` its steps.
  void WriteTo(RunReport& report, bool each_step = true) const;

 private:
  // What most steps have nothing of.
  struct Rest {
    TimeParts time;  // but motion
    std::uint64_t beam_switches = 0;
    std::uint64_t pierces = 0;
    std::uint64_t plunges = 0;
    motion::LongSum plunge, pierce_energy;

    void Add(const WorkFigures& work);
  };
  // Sums of a million small lengths keep their digits. There are as many as steps in a report: what
  // is in most of them stands here, the rest where there is any.
  struct Sum {
    std::uint64_t steps = 0;
    SimTime motion{0};
    SimTime beam_on{0};
    SimTime shutter_open{0};
    motion::LongSum tip_path, cut, travel, cut_energy;
    double energy_j_per_mm_max = 0.0;
    std::unique_ptr<Rest> rest;

    void Add(const WorkFigures& work);
    WorkFigures Total() const;
  };
  struct Step {
    int line = 0;
    Sum sum;
  };

  Sum* StepOf(const machine::Place& place);
  Sum* ProgramOf(int program);

  Sum total_;
  Sum rest_;
  std::map<int, Sum> programs_;
  std::map<std::pair<int, int>, Step> steps_;  // by program and step
  // Most work is at the step of the work before it, or at one behind all others.
  std::pair<int, int> last_step_{-1, -1};
  Sum* last_sum_ = nullptr;  // null: counted in rest_, or no step yet
  int last_program_ = -1;
  Sum* last_program_sum_ = nullptr;
};

}  // namespace rmlcell::simulation
