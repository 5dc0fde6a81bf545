#pragma once

#include <string>
#include <string_view>

#include "clients/lsp/program_folder.h"

// What the project.json beside a program says of its laser schedules and processes (docs/files.md).
// A file that is missing or no project says nothing. `uri` is that of the program.
namespace rmlcell::lsp {

// "PULSE, 50 %, fine cut"; empty when there is no such schedule.
std::string ScheduleNote(const ProgramFolder& folder, std::string_view uri, int number);

// "8, 75, 0.5, 60 (steel, 2 mm)"; empty when there is no such process.
std::string ProcessNote(const ProgramFolder& folder, std::string_view uri, int kind, int process);

}  // namespace rmlcell::lsp
