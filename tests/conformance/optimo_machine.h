#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"

namespace rmlcell::optimo::testing {

// One thing that a run told: "beam on 95", "shutter open", "OL[11] 1", "step WORK", "E7408" ...
struct Told {
  double at_s = 0.0;
  int program = 0;
  int step = 0;
  std::string what;
};

// A finished run, or one that waits for a key.
class Ran {
 public:
  Ran();
  ~Ran();
  Ran(Ran&&) noexcept;

  int code() const;  // the machine's number; 0: none
  bool completed() const;
  double time_s() const;
  std::string Var(const std::string& name) const;  // "VR[5]" -> "7.0"
  double Number(const std::string& name) const;
  const machine::Run& run() const { return *run_; }

  // Without steps: what outsiders see, in order.
  std::vector<std::string> Events() const;
  int Count(const std::string& what) const;
  bool Has(const std::string& what) const { return Count(what) > 0; }
  // The first one of this kind.
  std::optional<Told> Find(const std::string& what) const;

  std::vector<Told> told;
  std::vector<machine::MoveDone> moves;
  struct Motion {
    double start_s, end_s;
    double length_mm;
    bool beam;
    machine::PowerBySpeed power;
    double programmed_mm_s;
    int step;
    motion::CornerReport corner;  // at its end
    double end_speed_mm_s;
    std::vector<motion::TipPose> poses;  // along it, both ends among them
  };
  std::vector<Motion> motions;
  double BeamLength() const;  // mm cut with the beam on
  // The nearest that the tip came to a point of the machine frame.
  double NearestTo(const motion::MachinePoint& point) const;

 private:
  friend class OptimoMachine;
  class Listener;
  std::unique_ptr<Listener> listener_;
  std::unique_ptr<machine::Run> run_;
};

// A virtual Optimo with its program memory and what it keeps from run to run.
class OptimoMachine {
 public:
  OptimoMachine();

  OptimoMachine& Set(const std::string& parameter, const std::string& value);
  OptimoMachine& Profile(const std::string& id);
  OptimoMachine& Store(int slot, const std::string& source);  // deletes its executable, OPT-1.12
  OptimoMachine& StoreExecutable(int slot, const std::string& bytes);
  OptimoMachine& Delete(int slot);
  OptimoMachine& Schedules(std::vector<machine::LaserSchedule> stored);
  OptimoMachine& LoseZero();  // as a power cycle does, OPT-B.02
  // Executables that runs made are kept, as the cell does.
  bool HasExecutable(int slot) const;
  std::string Executable(int slot) const;  // precondition: it has one

  struct Options {
    machine::Mode mode = machine::Mode::kCycle;
    machine::InputScript inputs{};
    double override_percent = 100.0;
    std::optional<machine::ProgramStep> breakpoint{};
    std::optional<machine::ProgramStep> simul{};
    machine::RunBudget budget{.steps = 100'000, .virtual_time = std::chrono::hours(1)};
  };
  Ran Run(int slot, const Options& options);
  Ran Run(int slot) { return Run(slot, {}); }
  // Stores as program 1 and runs it.
  Ran Run(const std::string& source, const Options& options);
  Ran Run(const std::string& source) { return Run(source, {}); }

 private:
  machine::Parameters parameters_;
  std::map<int, machine::StoredProgram> programs_;
  std::set<int> deleted_;
  std::vector<machine::LaserSchedule> schedules_;
  std::string state_;
};

SimTime At(double seconds);
// A program of the shared corpus; empty where the corpus is not at hand.
std::string CorpusProgram(const std::string& name);

// How programs begin.
inline const std::string kAbsol = "COORD ABSOL\nPATH LIN\n";
inline const std::string kAbsolSlowly = kAbsol + "SPEED 10\n";

}  // namespace rmlcell::optimo::testing
