#pragma once

#include "engine/machine/family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/contour_advice.h"

namespace rmlcell::optimo {

// What the transfer of a project would store (OPT-8.68 to 8.71): inch programs are converted,
// missing WORKDEFs inserted when asked for, every program is compiled; all or nothing.
//
// Refused: a slot outside 1..99 (7101), the same slot, process or schedule twice (7861), a program
// without text or a laser schedule that the project lacks (7862), a process definition that breaks
// OPT-3.01 to 3.08 (7402, 7403, 7004, 7019), a WORK ON with neither WORKDEF nor process definition
// (7401), and whatever the compiler refuses. A program that runs as FUNCTION shares the WORKDEFs of
// its callers (OPT-3.12). Advice on paths is that for `contour_machine`. Warned: WORKDEF and
// process definition that differ (7863), a program of the numbers 1 to 7 (7413), a program without
// SYSDEF where another has one (7033, OPT-7.39).
machine::TransferPlan PlanTransfer(
    const machine::ProjectBundle& project, const machine::TransferOptions& options,
    std::uint32_t object_limit = kObjectLimitStandard,
    const ContourMachine& contour_machine = ContourMachine::Standard());

// Errors of one process definition, as PlanTransfer reports them.
std::vector<Diagnostic> CheckProcess(const machine::ProcessDefinition& definition);

// "WORKDEF 1,0 (6.5, 80.0, 1.5, 95.0)". Precondition: CheckProcess has no errors.
std::string WorkdefText(const machine::ProcessDefinition& definition);

}  // namespace rmlcell::optimo
