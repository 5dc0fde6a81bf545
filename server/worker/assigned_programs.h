#pragma once

#include <map>
#include <vector>

#include "engine/simulation/run/milled_target.h"
#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/spooled_bytes.h"
#include "rmlcell/v1/worker.pb.h"

namespace rmlcell::server {

// The program memory of an assignment, and its target. Programs that were too large for its message
// follow in parts.
class AssignedPrograms {
 public:
  // Must outlive this.
  explicit AssignedPrograms(const v1::WorkerAssignment& assignment);

  bool complete() const;
  void Add(const v1::WorkerBlob& part);

  // Which machine it is, for the report of a program that is not run.
  machine::MachineUsed Machine() const;

  // Once, when complete: the machine as it stands before the program is started.
  simulation::ProgramMemory Memory();

  // Once, when complete, of an assignment with a target: heights of cells of the block of `milling`
  // (simulation::Target), by the file or by the program that is the target; that is run with
  // `options`, the slot aside. Errors: those of simulation::ReadTarget and MilledTarget.
  Result<std::vector<float>> TargetHeights(const simulation::Milling& milling,
                                           simulation::RunOptions options,
                                           const simulation::StillWanted& wanted);

 private:
  simulation::ProgramMemory EmptyMemory() const;
  bool IsComplete(const v1::AssignedProgram& program) const;

  const v1::WorkerAssignment& assignment_;
  std::map<int, bridge::SpooledBytes> bytes_;  // by slot; 0: of the target
};

}  // namespace rmlcell::server
