#include "engine/machine/family.h"

#include <algorithm>
#include <set>
#include <utility>

#include "engine/core/keep_finding.h"
#include "engine/core/letters.h"
#include "engine/core/near_words.h"
#include "engine/core/units.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine_status.h"
#include "engine/machine/panel.h"
#include "engine/machine/shape.h"
#include "engine/machine/standing.h"

namespace rmlcell::machine {

Result<std::unique_ptr<Handbox>> MachineFamily::NewHandbox(const Parameters& /*parameters*/,
                                                           std::string_view saved) const {
  if (!saved.empty())
    return Error{ErrorCode::kCellBadText, "a machine without handbox has a state of one", {}};
  return std::unique_ptr<Handbox>();
}

Result<std::string> MachineFamily::UndoEdit(const ProgramEdit& /*edit*/,
                                            std::string_view /*object*/) const {
  return Error{ErrorCode::kCellNotLive, Told("machine", info().title) + " has no handbox", {}};
}

Panel MachineFamily::ShowPanel(const MachineStatus& status) const {
  Panel panel;
  if (status.state != MachineState::kOff) panel.lamps.push_back("POWER");
  return panel;
}

MachineShape MachineFamily::Shape(const Parameters& /*parameters*/) const { return {}; }

Status MachineFamily::CheckWrite(const Parameters& parameters, std::string_view name,
                                 double /*value*/) const {
  const Detail what = "'" + Told("variable", name) + "'";
  return Error{ErrorCode::kCellInvalidArgument,
               HasVariable(parameters, name) ? what + " is written by the machine alone"
                                             : "no variable is called " + what,
               {}};
}

namespace {

class PlainStanding final : public Standing {
 public:
  explicit PlainStanding(std::string_view state) : state_(state) {}
  RunState state() const override { return {.phase = RunPhase::kFinished}; }
  std::optional<VariableValue> ReadVariable(std::string_view /*name*/) const override { return {}; }
  void CyclePower() override {}
  std::string Save() const override { return state_; }

 private:
  std::string state_;
};

}  // namespace

Result<std::unique_ptr<Standing>> MachineFamily::NewStanding(const Parameters& /*parameters*/,
                                                             std::string_view machine_state) const {
  return std::unique_ptr<Standing>(std::make_unique<PlainStanding>(machine_state));
}

Status MachineFamily::CheckBreakpoint(const Breakpoint& breakpoint) const {
  const auto refuse = [&](std::string_view why) {
    return Error{
        ErrorCode::kCellInvalidArgument,
        "the breakpoint behind step " + Told("step", breakpoint.at.step) + " " + std::string(why),
        {}};
  };
  if (!info().has_breakpoints) {
    return Error{
        ErrorCode::kCellNotLive, Told("machine", info().title) + " has no breakpoints", {}};
  }
  if (!IsSlot(breakpoint.at.program) || breakpoint.at.step < 1)
    return refuse("stands in no program: give a slot of 1 to 99 and a step from 1 on");
  if (breakpoint.from_pass < 1 || breakpoint.from_pass > kBreakpointPassMax)
    return refuse("counts passes from 1 to a million millions");
  if (!breakpoint.condition.empty())
    return refuse("has a condition, but the programs of this machine have no expressions");
  if (breakpoint.from_pass > 1)
    return refuse("waits for a later pass, but a stream comes to each command once");
  return {};
}

// A stream is read on the way: what is no program of this machine shows when it is read before.
Status MachineFamily::CheckNeeds(const std::map<int, StoredProgram>& programs,
                                 const std::vector<LaserSchedule>& /*schedules*/,
                                 const Parameters& parameters, int main_slot) const {
  const auto main = programs.find(main_slot);
  if (main == programs.end() || main->second.object == nullptr)
    return Error{info().empty_slot, "program " + Told("program", main_slot), {}};
  if (main->second.source != nullptr) return {};  // it was translated for this machine just now
  const Bytes& object = main->second.object;
  const Translation translation =
      Translate({.name = main->second.name, .bytes = *object, .keeper = object.keeper()},
                parameters, {.advice = false});
  for (const Diagnostic& one : translation.diagnostics) {
    if (!translation.ok && IsError(one.severity)) return Error{one.code, one.detail, one.where};
  }
  return {};
}

TransferPlan MachineFamily::PlanTransfer(const ProjectBundle& project, const Parameters& parameters,
                                         const TransferOptions& /*options*/) const {
  TransferPlan plan{.ok = true};
  const auto refuse = [&plan](Detail detail, const std::string& file, int slot) {
    constexpr ErrorCode kCode = ErrorCode::kCellInvalidArgument;
    Diagnostic finding{.code = kCode,
                       .severity = Lookup(kCode).severity,
                       .detail = std::move(detail),
                       .file = file};
    finding.program = slot;
    plan.diagnostics.push_back(std::move(finding));
    plan.ok = false;
  };
  const Detail title = Told("machine", info().title);
  if (!project.schedules.empty()) refuse(title + " has no laser schedules", {}, 0);
  if (!project.processes.empty()) refuse(title + " has no process definitions", {}, 0);
  std::set<int> slots;
  for (const ProjectProgram& program : project.programs) {
    const std::string& name = program.file.name;
    const int slot = program.slot;
    if (!IsSlot(slot))
      refuse("slot " + Told("program", slot) + " is not one of 1 to 99", name, slot);
    if (!slots.insert(slot).second)
      refuse("slot " + Told("program", slot) + " has two programs", name, slot);
    if (program.inch) refuse("a stream is in units of its machine, not in inches", name, slot);
    Translation translation = Translate(program.file, parameters, {});
    for (Diagnostic& diagnostic : translation.diagnostics) {
      diagnostic.program = slot;
      KeepFinding(std::move(diagnostic), kDiagnosticsMax, plan.diagnostics,
                  plan.diagnostics_dropped);
    }
    translation.diagnostics_dropped.ForEachPlace(
        [slot](Diagnostic& place) { place.program = slot; });
    plan.diagnostics_dropped.Add(translation.diagnostics_dropped);
    plan.ok = plan.ok && translation.ok;
    std::string object = ObjectOf(std::move(translation), program.file.bytes);
    plan.programs.push_back({.slot = slot, .source = object, .object = object});
  }
  if (!plan.ok) plan.programs.clear();  // every program or none
  return plan;
}

namespace {

std::string Plain(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c != '-' && c != '_' && c != ' ') letters += c;
  }
  return UpperCase(letters);
}

// "SRM-20", "srm20", "srm_20" and "Roland monoFab SRM-20" are the srm-20.
const MachineProfile* FindProfile(std::span<const MachineProfile> profiles,
                                  std::string_view wanted) {
  const std::string plain = Plain(wanted);
  const auto found = std::ranges::find_if(profiles, [&](const MachineProfile& one) {
    return Plain(one.id) == plain || Plain(one.title) == plain;
  });
  return found == profiles.end() ? nullptr : &*found;
}

Error NoProfile(std::span<const MachineProfile> profiles, const std::string& wanted) {
  const std::string plain = Plain(wanted);
  Detail known;
  std::vector<std::string> near;
  for (const MachineProfile& one : profiles) {
    const std::string id = Plain(one.id);
    known += " " + Told("known", one.id);
    if (plain.size() > 1 && (id.find(plain) != std::string::npos ||
                             (id.size() > 1 && plain.find(id) != std::string::npos)))
      near.emplace_back(one.id);
  }
  if (near.empty()) {
    std::vector<std::string_view> ids;
    for (const MachineProfile& one : profiles) ids.push_back(one.id);
    near = NearestTo(wanted, ids).words;
  }
  Detail detail = "no profile '" + Told("name", wanted) + "'";
  if (EqualIgnoringCase(std::string_view(plain).substr(plain.find_last_of('.') + 1), "toml")) {
    detail += ": a file of one's own goes to --machine";
  } else if (!near.empty()) {
    detail += DidYouMean(near);
  } else {
    detail += "; there are" + known;
  }
  return {ErrorCode::kCellInvalidArgument, std::move(detail), {}};
}

}  // namespace

std::string MachineTitle(const MachineFamily& family, std::string_view profile, bool named,
                         std::string_view own_name) {
  const std::string own(own_name);
  const auto profiles = family.profiles();
  const auto found = std::ranges::find(profiles, profile, &MachineProfile::id);
  const std::string based = own.empty() ? "" : own + ", based on ";
  if (found == profiles.end()) return based + std::string(family.info().title);
  const std::string title = based + std::string(found->title) + " (" + std::string(profile) + ")";
  if (named) return title;
  return title + (own.empty() ? ": no profile was named" : ": the default, as it names no profile");
}

Result<Parameters> MakeParameters(const MachineFamily& family, const std::string& profile,
                                  const std::map<std::string, std::string>& parameters) {
  Parameters made(family.parameters());
  const std::string wanted(profile.empty() ? family.info().default_profile : profile);
  if (!wanted.empty()) {
    const auto profiles = family.profiles();
    const MachineProfile* found = FindProfile(profiles, wanted);
    if (found == nullptr) return NoProfile(profiles, wanted);
    if (const Status applied = profile.empty() ? made.ApplyUnnamed(*found) : made.Apply(*found);
        !applied)
      return applied.error();
  }
  for (const auto& [name, value] : parameters) {
    if (const Status set = made.Set(name, std::string_view(value)); !set) return set.error();
  }
  if (const Status fit = family.CheckParameters(made); !fit) return fit.error();
  return made;
}

}  // namespace rmlcell::machine
