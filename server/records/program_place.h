#pragma once

#include <string>
#include <string_view>

#include "engine/machine/family.h"
#include "rmlcell/v1/program.pb.h"
#include "server/base/names.h"
#include "storage/store.h"

namespace rmlcell::server {

// Where a program of a machine is, or would be.
struct ProgramPlace {
  storage::MachineRecord machine;
  const machine::MachineFamily* family = nullptr;  // never null
  int slot = 0;                                    // 1..99
  bool executable = false;                         // named as slot + 100
};

// Errors: CellInvalidArgument for what is no name of a program, CellUnknownMachine,
// CellUnknownFamily, FamilyInfo::no_slot for a number that the machine does not have.
Result<ProgramPlace> FindProgramPlace(storage::Store& store, std::string_view name);

// FamilyInfo::no_slot for a number that machines of the family do not have.
Status CheckNumber(const machine::MachineFamily& family, const ProgramName& name);

// FamilyInfo::no_slot unless the number is 1..99; `field` is where it stands.
Status CheckSlot(const machine::MachineFamily& family, std::int64_t number, std::string_view field);

// CellPrecondition for machines without laser schedules, FamilyInfo::no_schedule for a number that
// is none.
Status CheckSchedule(const machine::MachineFamily& family, std::int64_t number);

// FamilyInfo::empty_slot: there is no program of this name.
Error EmptySlot(const machine::MachineFamily& family, std::string_view name);

// What is known of a program of a machine, without findings.
v1::Program ToProto(const std::string& machine, const storage::ProgramSummary& summary);

}  // namespace rmlcell::server
