#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/tools.h"
#include "engine/optimo/language/ast.h"

// What two programs do differently: path, time, power, outputs; not lines of text. Layout,
// comments, names for variables, sequence numbers, the spelling of numbers, ENDTASK at the end and
// (in programs without jumps) modal instructions that change nothing do not count.
namespace rmlcell::optimo {

using machine::Aspect;
using enum machine::Aspect;
using machine::FigureChange;
using machine::ProgramDiff;
using machine::StepChange;

// "path, time"
std::string AspectText(unsigned aspects);

// Both modules are checked, without errors. `figures_a`, `figures_b`: of a run of each program,
// when the caller made them (time, lengths, beam-on time): figures differ beyond 1e-9 of their
// size.
ProgramDiff Diff(const Module& a, const Module& b,
                 const std::vector<machine::Figure>& figures_a = {},
                 const std::vector<machine::Figure>& figures_b = {});

}  // namespace rmlcell::optimo
