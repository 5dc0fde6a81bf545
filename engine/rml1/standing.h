#pragma once

#include <memory>

#include "engine/core/result.h"
#include "engine/machine/standing.h"
#include "engine/rml1/device.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1 {

// A mill between two streams: its axes have their reference, and it has no inputs (RML1-7.08). Of
// its cover the machine knows.
class MillStanding final : public machine::Standing {
 public:
  // Errors: CellBadText for a machine state that is none.
  static Result<std::unique_ptr<machine::Standing>> Make(Profile profile,
                                                         std::string_view machine_state);

  machine::RunState state() const override;
  std::optional<machine::VariableValue> ReadVariable(std::string_view name) const override;
  std::vector<machine::ModalValue> modal_values() const override;
  // LIVE-8.03. No override changes it.
  std::optional<machine::HandMotion> ByHand(double override_percent, bool fast) const override;
  void MoveTo(const motion::AxisPose& axes) override;
  bool HasPanelKey(machine::PanelKey /*key*/) const override { return profile_->panel_described; }
  machine::CoverAct cover() const override { return profile_->cover; }
  void PressPanel(machine::PanelKey key) override;
  std::vector<motion::AxisPose> WayOf(machine::PanelKey key) const override;
  void Rest() override;        // the spindle stands
  void CyclePower() override;  // a new machine: RML1-7.08
  std::vector<machine::StateItem> items() const override;
  std::string Save() const override;

 private:
  explicit MillStanding(Profile profile);
  ToolNow tool() const;

  void UseProfile(Profile profile);

  const Profile as_delivered_;              // with the origin of the parameters
  std::unique_ptr<const Profile> profile_;  // of the device
  Device device_;
};

}  // namespace rmlcell::rml1
