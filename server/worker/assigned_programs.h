#pragma once

#include <map>

#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/spooled_bytes.h"
#include "rmlcell/v1/worker.pb.h"

namespace rmlcell::server {

// The program memory of an assignment. Programs that were too large for its message follow in
// parts.
class AssignedPrograms {
 public:
  // Must outlive this.
  explicit AssignedPrograms(const v1::WorkerAssignment& assignment);

  bool complete() const;
  void Add(const v1::WorkerBlob& part);

  // Once, when complete: the machine as it stands before the program is started.
  simulation::ProgramMemory Memory();

 private:
  const v1::WorkerAssignment& assignment_;
  std::map<int, bridge::SpooledBytes> bytes_;  // by slot
};

}  // namespace rmlcell::server
