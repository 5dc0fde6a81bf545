#pragma once

#include "engine/machine/editing.h"

namespace rmlcell::optimo {

// What an editor asks about RML sources, behind the interface of machine families.
const machine::Editing& OptimoEditing();

}  // namespace rmlcell::optimo
