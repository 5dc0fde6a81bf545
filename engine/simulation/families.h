#pragma once

#include <span>
#include <string_view>

#include "engine/machine/family.h"

// The machine families that this build knows. A new one is one line in families.cc.
namespace rmlcell::simulation {

std::span<const machine::MachineFamily* const> Families();

// Null when there is none.
const machine::MachineFamily* FindFamily(std::string_view id);

// By the extension of a file name, compared without case: "part.SI". Null when no family claims it.
const machine::MachineFamily* FamilyOfFileName(std::string_view name);

// Whether a family reads files with this extension (".si").
bool ClaimsExtension(const machine::FamilyInfo& info, std::string_view extension);

}  // namespace rmlcell::simulation
