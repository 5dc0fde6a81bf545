#include "server/records/machine_capabilities.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "engine/machine/handbox.h"
#include "engine/machine/run.h"
#include "engine/machine/standing.h"
#include "server/records/machine_messages.h"

namespace rmlcell::server {
namespace {

constexpr double kOverrideApart_percent = 15.0;  // OPT-4.34, and the panels of mills have the same
constexpr std::string_view kAxes = "XYZAB";      // as HandMotion counts them

void AddJog(const machine::FamilyInfo& info, const machine::Standing& standing,
            v1::MachineCapabilities& capabilities) {
  const auto slow = standing.ByHand(info.override_max_percent, false);
  const auto fast = standing.ByHand(info.override_max_percent, true);
  if (!slow || !fast) return;
  for (const std::string& name : WordsOf(info.jog_axes)) {
    const std::size_t axis = kAxes.find(name);
    if (axis == std::string_view::npos) continue;  // a key that does nothing
    const auto at = static_cast<Eigen::Index>(axis);
    const double speed =
        std::max({slow->plus[at], slow->minus[at], fast->plus[at], fast->minus[at]});
    if (speed <= 0.0) continue;
    v1::MachineCapabilities::JogAxis& jog = *capabilities.add_jog_axes();
    jog.set_axis(name);
    jog.set_unit(axis < 3 ? v1::UNIT_MILLIMETRE : v1::UNIT_RADIAN);
    jog.set_step(slow->least[at]);
    jog.set_speed_max(speed);
  }
}

void AddPanel(const machine::Standing& standing, v1::MachineCapabilities& capabilities) {
  for (const char* key :
       {"PAUSE", "CONTINUE", "STOP", "BUFFER_CLEAR", "COVER", "POWER", "EMERGENCY_STOP"})
    capabilities.add_panel_keys(key);
  using machine::PanelKey;
  for (const PanelKey key :
       {PanelKey::kView, PanelKey::kSpindle, PanelKey::kZ0, PanelKey::kOrigin, PanelKey::kHome}) {
    if (standing.HasPanelKey(key)) capabilities.add_panel_keys(std::string(machine::Name(key)));
  }
  for (const v1::MachineCapabilities::JogAxis& axis : capabilities.jog_axes()) {
    capabilities.add_panel_keys(axis.axis() + "+");
    capabilities.add_panel_keys(axis.axis() + "-");
  }
}

}  // namespace

v1::MachineCapabilities CapabilitiesOf(const storage::MachineRecord& record) {
  v1::MachineCapabilities capabilities;
  const machine::MachineFamily* family = families::FindFamily(record.family);
  if (family == nullptr) return capabilities;
  const auto parameters = machine::MakeParameters(*family, record.profile, record.parameters);
  if (!parameters) return capabilities;
  const auto standing = family->NewStanding(*parameters, {});
  const auto handbox = family->NewHandbox(*parameters, {});
  if (!standing || !handbox) return capabilities;
  const machine::FamilyInfo& info = family->info();
  for (double step = info.override_max_percent; step >= info.override_min_percent;
       step -= kOverrideApart_percent)
    capabilities.add_override_steps_percent(step);
  std::ranges::reverse(*capabilities.mutable_override_steps_percent());
  AddJog(info, **standing, capabilities);
  capabilities.set_handbox(*handbox != nullptr);
  if (*handbox == nullptr) AddPanel(**standing, capabilities);
  capabilities.set_stop(v1::MachineCapabilities::HALT_ON_PATH);
  capabilities.set_hold(v1::MachineCapabilities::HALT_AFTER_INSTRUCTION);
  capabilities.set_hold_in_remote(info.hold_in_remote
                                      ? v1::MachineCapabilities::HALT_AFTER_INSTRUCTION
                                      : v1::MachineCapabilities::HALT_ON_PATH);
  capabilities.set_emergency_stop(true);
  capabilities.set_variables(true);
  capabilities.set_inputs(family->HasVariable(*parameters, "IL[0]"));
  capabilities.set_reports_position(true);
  capabilities.set_start_at_step(true);
  return capabilities;
}

}  // namespace rmlcell::server
