// Programs along a walk, and what is made of their runs: report_instructions.py counts it.
//   report_count PATH-STAGE MOVES
// PATH: mill (RML-1), laser (Optimo, the head stands), five_axis (Optimo, the head turns with each
// move), the beam on with power by speed.
// STAGE: text, the program is written, and no more; plan, it is read and run with nobody to tell;
// report, toolpath, picture, each is made beside it; all, they are made together.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include "engine/families/families.h"
#include "engine/optimo/language/compiler.h"
#include "tests/bench/report_stages.h"
#include "tests/bench/rml1_reading.h"
#include "tests/bench/rml1_texts.h"

namespace rmlcell::bench {
namespace {

// The walk of rml1_texts.h, at 25 mm/s; the head of five_axis turns by about a degree a move.
std::string OptimoWalk(int moves, bool head) {
  std::string text =
      "COORD ABSOL\nPATH LIN\nMOVE (1000.,900.,-400.,0.,0.)\nSPEED 5\n"
      "OL[11]=ON\nWORKDEF 1,0 (10.,75.,0.,0.)\nWORK 1,0 /ON\n";
  std::mt19937_64 dice(12345);
  std::normal_distribution<double> turn(0.0, 0.35);
  std::uniform_real_distribution<double> length(0.05, 2.0);
  std::normal_distribution<double> swing(0.0, 0.02);
  double x = 1000.0, y = 900.0, heading = 0.0, a = 0.0, b = 0.3;
  for (int k = 0; k < moves; ++k) {
    heading += turn(dice);
    const double way = length(dice);
    x = std::clamp(x + way * std::cos(heading), 700.0, 1300.0);
    y = std::clamp(y + way * std::sin(heading), 600.0, 1200.0);
    if (head) {
      a += swing(dice);
      b = std::clamp(b + swing(dice), 0.1, 0.8);
    }
    char line[96];
    std::snprintf(line, sizeof line, "MOVE (%.3f,%.3f,-400.,%.4f,%.4f)/FLY\n", x, y, a,
                  head ? b : 0.0);
    text += line;
  }
  return text + "WORK 1,0 /OFF\nENDTASK\n";
}

bool RunToEnd(const machine::MachineFamily& family, machine::RunSetup setup) {
  machine::RunObserver nobody;
  const auto run = family.NewRun(std::move(setup), nobody);
  if (!run) return false;
  while ((*run)->Advance(kForever) == machine::RunPhase::kRunning) {
  }
  return (*run)->outcome().kind == machine::OutcomeKind::kCompleted;
}

int Main(std::string_view path, std::string_view stage, int moves) {
  const bool mill = path == "mill";
  const machine::MachineFamily& family = *families::FindFamily(mill ? "rml1" : "optimo");
  const auto parameters = mill ? WideMachine() : machine::MakeParameters(family, "", {});
  if (!parameters) return 2;
  const std::string text = mill ? Rml1Walk("sets").Text(moves) : OptimoWalk(moves, path != "laser");
  if (stage == "text") return text.empty() ? 1 : 0;
  machine::Bytes object = machine::Bytes::Borrowed(text);
  if (!mill) {
    optimo::Compilation compiled = optimo::Compile(text, "bench.S", {.advice = false});
    if (!compiled.ok) return 1;
    object = machine::Bytes::Of(std::move(compiled.object));
  }
  machine::RunSetup setup(*parameters);
  setup.main_program = 1;
  setup.programs[1].object = std::move(object);
  setup.budget.steps = 0;
  if (stage == "plan") return RunToEnd(family, std::move(setup)) ? 0 : 1;
  return SimulateStage(stage, family, std::move(setup));
}

}  // namespace
}  // namespace rmlcell::bench

int main(int argc, char** argv) {
  const std::string_view what = argc == 3 ? argv[1] : "";
  const std::size_t dash = what.find('-');
  if (dash == std::string_view::npos) {
    std::fprintf(stderr,
                 "usage: report_count mill|laser|five_axis-text|plan|report|toolpath|picture|all "
                 "MOVES\n");
    return 2;
  }
  return rmlcell::bench::Main(what.substr(0, dash), what.substr(dash + 1), std::atoi(argv[2]));
}
