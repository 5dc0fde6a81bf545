#pragma once

#include <span>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/family.h"

// The machine families that this build knows. A new one is one line in registry.cc.
namespace rmlcell::families {

std::span<const machine::MachineFamily* const> Families();

// Null when there is none.
const machine::MachineFamily* FindFamily(std::string_view id);

// CellUnknownFamily: no family has this id; it tells which there are.
Error UnknownFamily(std::string_view id);

// By the extension of a file name, compared without case: "part.SI". Null when no family claims it.
const machine::MachineFamily* FamilyOfFileName(std::string_view name);

// The family whose tools (machine::Tools) a text is for: that of its file name; of a name that says
// nothing the first one that has any. Error: CellInvalidArgument for a family without tools.
Result<const machine::MachineFamily*> FamilyWithTools(std::string_view name);

// How two programs of a family are compared that are streams; one of texts has tools for that.
using StreamDiff = Result<machine::ProgramDiff> (*)(const machine::ComparedObject& a,
                                                    const machine::ComparedObject& b,
                                                    const machine::Parameters& parameters);
struct StreamComparison {
  const machine::MachineFamily* family = nullptr;
  StreamDiff diff = nullptr;
};
std::span<const StreamComparison> StreamComparisons();  // registry.cc

// The family whose programs are compared under this name; as FamilyWithTools, and those whose
// streams can be. Error: CellInvalidArgument.
Result<const machine::MachineFamily*> FamilyThatCompares(std::string_view name);

// What two programs of such a family do differently. Errors: those of its comparison.
Result<machine::ProgramDiff> Diff(const machine::MachineFamily& family,
                                  const machine::ComparedObject& a,
                                  const machine::ComparedObject& b,
                                  const machine::Parameters& parameters);

// The family whose tools an object without a name is for: the one that knows these bytes as an
// object of its own; where none does the first one with tools, which tells what is wrong with them.
// Error: CellInvalidArgument where no family has tools.
Result<const machine::MachineFamily*> FamilyOfObject(std::string_view object);

// The family that has laser schedules and processes; null when there is none.
const machine::MachineFamily* FamilyWithSchedules();

// The greatest override that any family takes, percent.
double OverrideMax();

// Whether the name says that the bytes are an object of some family.
bool IsObjectFileName(std::string_view name);

// Whether a family reads files with this extension (".si").
bool ClaimsExtension(const machine::FamilyInfo& info, std::string_view extension);

}  // namespace rmlcell::families
