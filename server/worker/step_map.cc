#include "server/worker/step_map.h"

#include <vector>

#include "proto/bridge/encoding.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::server {

std::string StepMapOf(const machine::MachineFamily& family, const machine::RunSetup& setup) {
  if (family.tools() == nullptr) return {};
  v1::GetStepMapResponse map;
  for (const auto& [slot, program] : setup.programs) {
    v1::GetStepMapResponse::ProgramSteps& made = *map.add_programs();
    made.set_program(slot);
    made.set_object_sha256(bridge::Sha256Hex(*program.object));
    if (program.source == nullptr) continue;
    const std::vector<int>& lines = program.source->step_lines;
    *made.mutable_lines() = {lines.begin(), lines.end()};
  }
  return bridge::StableBytes(map);
}

}  // namespace rmlcell::server
