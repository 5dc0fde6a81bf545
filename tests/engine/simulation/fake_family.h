#pragma once

#include <array>
#include <memory>
#include <utility>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {

// A family whose runs do what a script says.
class FakeFamily final : public machine::MachineFamily {
 public:
  // `checked_by_running`: its programs are followed to say what is wrong with them.
  explicit FakeFamily(Script script = {}, bool checked_by_running = false)
      : script_(std::move(script)) {
    info_.checked_by_running = checked_by_running;
  }

  const machine::FamilyInfo& info() const override { return info_; }
  std::span<const machine::ParameterInfo> parameters() const override { return Table(); }
  std::span<const machine::MachineProfile> profiles() const override { return {}; }
  machine::Translation Translate(const machine::SourceFile&, const machine::Parameters&,
                                 const machine::CheckOptions&) const override {
    return {};
  }
  machine::TransferPlan PlanTransfer(const machine::ProjectBundle&, const machine::Parameters&,
                                     const machine::TransferOptions&) const override {
    return {};
  }
  Result<std::unique_ptr<machine::Run>> NewRun(machine::RunSetup setup,
                                               machine::RunObserver& observer) const override {
    if (setup.main_program == 99) return Error{ErrorCode::kCellInvalidArgument, "no", {}};
    return std::unique_ptr<machine::Run>(
        std::make_unique<FakeRun>(script_, observer, std::move(setup.inputs)));
  }

  static std::span<const machine::ParameterInfo> Table() {
    static constexpr std::array<machine::ParameterInfo, 1> table = {
        machine::ParameterInfo{.name = "VMAX",
                               .unit = "mm/s",
                               .standard = 500.0,
                               .minimum = 1.0,
                               .maximum = 1000.0,
                               .choices = "",
                               .text = "highest speed",
                               .rule = "OPT-B.01"}};
    return table;
  }
  static machine::RunSetup Setup() {
    machine::RunSetup setup{machine::Parameters(Table())};
    setup.main_program = 1;
    setup.programs[1] = {
        .name = "part.FK", .object = machine::Bytes::Of("move"), .executable = nullptr};
    return setup;
  }

 private:
  machine::FamilyInfo info_{
      .id = "fake", .title = "Fake machine", .extensions = ".FK .fake", .axes = "X Y Z"};
  Script script_;
};

}  // namespace rmlcell::simulation
