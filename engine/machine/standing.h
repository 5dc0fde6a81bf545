#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/hand_motion.h"
#include "engine/machine/inputs.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/outputs.h"
#include "engine/machine/panel.h"
#include "engine/machine/run.h"
#include "engine/machine/step_entry.h"
#include "engine/motion/geometry/pose.h"

namespace rmlcell::machine {

// A machine of a family that stands, with no run open: what it keeps from one run to the next,
// looked at and changed. A run begins with it (RunSetup::machine_state) and leaves another
// (Run::SaveMachine). One thread at a time.
class Standing {
 public:
  virtual ~Standing() = default;

  // What its cover does to a run when it is opened. DEV-3.12
  virtual CoverAct cover() const { return CoverAct::kNone; }

  // At time 0, in kFinished.
  virtual RunState state() const = 0;

  // As those of Run.
  virtual std::optional<VariableValue> ReadVariable(std::string_view name) const = 0;
  virtual void WriteVariable(std::string_view /*name*/, double /*value*/) {}
  virtual MachineOutputs outputs() const { return {}; }
  virtual std::vector<ModalValue> modal_values() const { return {}; }

  // What a run left that did not reach the end of its dry run (OPT-6.14): the next one is dry.
  virtual std::optional<ProgramStep> simulation_until() const { return {}; }

  // A program was selected: what is counted since then begins anew.
  virtual void SelectProgram() {}

  // As if the instruction of this name had set it. Nothing where the machine does not keep it.
  virtual void SetModal(std::string_view /*name*/, std::span<const double> /*values*/) {}

  // An input or the door; keys and the override do nothing here.
  virtual void Apply(const InputChange& /*input*/) {}

  // How jog keys move it now, at this override, or fast where it has that; none: they do not.
  virtual std::optional<HandMotion> ByHand(double /*override_percent*/, bool /*fast*/) const {
    return {};
  }
  // Moved by hand it stands here now.
  virtual void MoveTo(const motion::AxisPose& /*axes*/) {}

  // Keys of its panel. Whether somebody has described that one; what Z0 and ORIGIN do here; where
  // VIEW and HOME go to, place by place.
  virtual bool HasPanelKey(PanelKey /*key*/) const { return false; }
  virtual void PressPanel(PanelKey /*key*/) {}
  virtual std::vector<motion::AxisPose> WayOf(PanelKey /*key*/) const { return {}; }

  // A run is over, or nothing may go on: what would by itself stops. LIVE-2.04
  virtual void Rest() {}

  // Off and on again: what the machine keeps only while it has power is as it comes.
  virtual void CyclePower() = 0;

  // All that it keeps, by the names of EnterableRun::items.
  virtual std::vector<StateItem> items() const { return {}; }

  virtual std::string Save() const = 0;
};

}  // namespace rmlcell::machine
