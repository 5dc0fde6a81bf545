#pragma once

#include <string>

#include "clients/lsp/open_program.h"

// What the project.json beside a program says of its laser schedules and processes (docs/files.md).
// A file that is missing or no project says nothing.
namespace rmlcell::lsp {

// "PULSE, 50 %, fine cut"; empty when there is no such schedule.
std::string ScheduleNote(const OpenProgram& program, int number);

// "8, 75, 0.5, 60 (steel, 2 mm)"; empty when there is no such process.
std::string ProcessNote(const OpenProgram& program, int kind, int process);

}  // namespace rmlcell::lsp
