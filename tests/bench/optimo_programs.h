#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "engine/core/check.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"

namespace rmlcell::bench {

// Programs that measure the language alone, and what a run of one needs. The rounds of `loop` are
// those of the other languages: four operations, two assignments, one comparison.
inline std::string OptimoText(std::string_view what, int rounds) {
  const std::string end =
      "VR[1]=VR[1]+1.\nIF VR[1]<" + std::to_string(rounds) + ". THEN 10\nENDTASK\n";
  const std::string begin = "VR[1]=0.\nVR[2]=0.\n";
  if (what == "loop") return begin + "10 VR[2]=VR[2]+VR[1]*3.5-VR[1]/7.\n" + end;
  const std::string moves = "COORD ABSOL\nPATH LIN\n" + begin;
  if (what == "call") return moves + "10 FUNCTION 2 (VR[1],VR[1]*.5)\n" + end;
  return moves + "10 MOVE (900.+VR[1]*.001,900.+VR[1]*.5*.01,-420.,0.,0.)\n" + end;
}
inline constexpr std::string_view kOptimoFunction =
    "MOVE (900.+PAR[0]*.001,900.+PAR[1]*.01,-420.,0.,0.)\nRETURN\n";

// A run of such a program, with an observer that wants nothing.
class OptimoProgram {
 public:
  OptimoProgram(std::string_view what, int rounds) : run_(RunOf(what, rounds, observer_)) {}
  OptimoProgram(const OptimoProgram&) = delete;
  OptimoProgram& operator=(const OptimoProgram&) = delete;

  // False: it failed.
  bool RunToEnd() {
    while (run_->Advance(kForever) == machine::RunPhase::kRunning) {
    }
    return run_->outcome().kind == machine::OutcomeKind::kCompleted;
  }
  std::uint64_t steps() const { return run_->steps_executed(); }

 private:
  static machine::Bytes ObjectOf(std::string_view text) {
    optimo::Compilation compiled = optimo::Compile(text, "bench.S", {.advice = false});
    RMLCELL_CHECK(compiled.ok);
    return machine::Bytes::Of(std::move(compiled.object));
  }
  static std::unique_ptr<machine::Run> RunOf(std::string_view what, int rounds,
                                             machine::RunObserver& observer) {
    const machine::MachineFamily& family = optimo::OptimoFamily();
    const auto parameters = machine::MakeParameters(family, "", {});
    RMLCELL_CHECK(parameters);
    machine::RunSetup setup(*parameters);
    setup.programs[1].object = ObjectOf(OptimoText(what, rounds));
    setup.programs[2].object = ObjectOf(kOptimoFunction);
    setup.main_program = 1;
    setup.budget.steps = 0;
    Result<std::unique_ptr<machine::Run>> run = family.NewRun(std::move(setup), observer);
    RMLCELL_CHECK(run);
    return *std::move(run);
  }

  machine::RunObserver observer_;
  std::unique_ptr<machine::Run> run_;
};

}  // namespace rmlcell::bench
