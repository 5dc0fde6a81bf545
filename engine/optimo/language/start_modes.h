#pragma once

#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo {

// COORD and PATH that a program has before it sets them: a parameter of the machine. OPT-2.09
struct StartModes {
  CoordType coord = CoordType::kRobot;
  PathType path = PathType::kPtp;
};

}  // namespace rmlcell::optimo
