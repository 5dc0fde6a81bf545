#pragma once

#include <functional>

#include "engine/motion/planner/planner.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/language/start_modes.h"

namespace rmlcell::optimo {

// The machine whose corners are looked at; standard: the defaults of optimo.md B.1.
struct ContourMachine {
  motion::MachineLimits limits;
  double head_length_mm = 300.0;
  StartModes start{};

  static ContourMachine Standard();
};

// What the path of a checked program shows before it runs, where coordinates, speed and OVERSH
// stand in the text and nothing jumps in between:
//   7317  a contour turns by more than 60 degrees at a /FLY with the beam on and OVERSH above 0,
//         with the distance from the corner (OPT-2.62, motion.md 4.4)
//   7318  a short neighbour limits a bend, with the speed that it costs; advice
//   7319  a contour move comes within 1 degree of B = 0 while A turns by more than 30 (motion.md
//         2.5)
// SYSDEF does not matter: it moves a contour as a whole. Programs of more than 40,000 instructions,
// longer than any that the control could hold, are left out. Precondition: Check found no errors.
void AdviseOnContours(const ParsedProgram& program, const ContourMachine& machine,
                      Findings& findings);

// The same for CompileOptions::further_advice: whatever compiles for a programmer says it, so that
// check, compile, put and transfer have the same findings.
std::function<void(const ParsedProgram&, Findings&)> ContourAdvice(const ContourMachine& machine);

}  // namespace rmlcell::optimo
