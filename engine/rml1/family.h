#pragma once

#include "engine/machine/family.h"

namespace rmlcell::rml1 {

// Roland mills and engravers that speak RML-1. A program is its raw stream: nothing is compiled, so
// the object is the stream itself, and the check runs it through a device without its clock. Errors
// of a stream are findings of severity `device`, as on the machine, and never refuse it.
class Rml1Family final : public machine::MachineFamily {
 public:
  const machine::FamilyInfo& info() const override;
  std::span<const machine::ParameterInfo> parameters() const override;
  std::span<const machine::MachineProfile> profiles() const override;

  // Refuses an empty stream (CellEmptyProgram) and parameters that do not fit together. Figures are
  // those of a run, without times. A pause is passed as if the resume key were pressed at once.
  machine::Translation Translate(const machine::SourceFile& file,
                                 const machine::Parameters& parameters,
                                 const machine::CheckOptions& options) const override;

  // Programs only: laser schedules, process definitions and inches are refused.
  machine::TransferPlan PlanTransfer(const machine::ProjectBundle& project,
                                     const machine::Parameters& parameters,
                                     const machine::TransferOptions& options) const override;

  // Errors: see MillRun::Make. A slot without program is none: the run ends with CellNotFound.
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override;
};

}  // namespace rmlcell::rml1
