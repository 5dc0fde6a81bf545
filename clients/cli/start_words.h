#pragma once

#include <optional>
#include <string>

#include "rmlcell/v1/machine_control.pb.h"

// How people write where a run begins, and what they have looked at.
namespace rmlcell::cli {

// "45/10", or "10" of the main program; nothing for what is none.
std::optional<v1::StepPlace> StepOf(const std::string& text);

// "origin-valid"
std::string SeenName(v1::Confirmation confirmation);
// Nothing for a word that is none.
std::optional<v1::Confirmation> ConfirmationOf(const std::string& seen);

}  // namespace rmlcell::cli
