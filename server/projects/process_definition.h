#pragma once

#include "engine/machine/family.h"
#include "rmlcell/v1/project.pb.h"

namespace rmlcell::server {

inline machine::ProcessDefinition DefinitionOf(const v1::ProjectProcess& process) {
  return {.kind = process.kind(),
          .process = process.process(),
          .values = {process.values().begin(), process.values().end()},
          .note = process.note()};
}

}  // namespace rmlcell::server
