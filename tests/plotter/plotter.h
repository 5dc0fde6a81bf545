#pragma once

#include "engine/core/catalogue.h"
#include "engine/machine/family.h"

// A pen plotter, the smallest machine family that is one. A program has one command a line: SP n
// takes pen n, 1 to 8, 0 puts it back; PU x,y goes there with the pen up, mm; PD x,y draws a line
// to there; WT s waits.
namespace rmlcell::plotter {

ErrorTable Errors();  // PLT-E1 to PLT-E3
const machine::MachineFamily& PlotterFamily();

}  // namespace rmlcell::plotter
