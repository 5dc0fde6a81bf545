#include "engine/machine/family.h"

#include <algorithm>
#include <set>
#include <utility>

#include "engine/core/letters.h"
#include "engine/core/units.h"
#include "engine/machine/shape.h"

namespace rmlcell::machine {

MachineShape MachineFamily::Shape(const Parameters& /*parameters*/) const { return {}; }

TransferPlan MachineFamily::PlanTransfer(const ProjectBundle& project, const Parameters& parameters,
                                         const TransferOptions& /*options*/) const {
  TransferPlan plan{.ok = true};
  const auto refuse = [&plan](std::string detail, const std::string& file, int slot) {
    constexpr ErrorCode kCode = ErrorCode::kCellInvalidArgument;
    Diagnostic finding{.code = kCode,
                       .severity = Lookup(kCode).severity,
                       .detail = std::move(detail),
                       .file = file};
    finding.program = slot;
    plan.diagnostics.push_back(std::move(finding));
    plan.ok = false;
  };
  const std::string title(info().title);
  if (!project.schedules.empty()) refuse(title + " has no laser schedules", {}, 0);
  if (!project.processes.empty()) refuse(title + " has no process definitions", {}, 0);
  std::set<int> slots;
  for (const ProjectProgram& program : project.programs) {
    const std::string& name = program.file.name;
    const int slot = program.slot;
    if (!IsSlot(slot))
      refuse("slot " + std::to_string(slot) + " is not one of 1 to 99", name, slot);
    if (!slots.insert(slot).second)
      refuse("slot " + std::to_string(slot) + " has two programs", name, slot);
    if (program.inch) refuse("a stream is in units of its machine, not in inches", name, slot);
    Translation translation = Translate(program.file, parameters, {});
    for (Diagnostic& diagnostic : translation.diagnostics) {
      diagnostic.program = slot;
      if (plan.diagnostics.size() < kDiagnosticsMax)
        plan.diagnostics.push_back(std::move(diagnostic));
    }
    plan.ok = plan.ok && translation.ok;
    std::string object = ObjectOf(std::move(translation), program.file.bytes);
    plan.programs.push_back({.slot = slot, .source = object, .object = object});
  }
  if (!plan.ok) plan.programs.clear();  // every program or none
  return plan;
}

namespace {

// "SRM-20", "srm20" and "srm_20" are the srm-20.
bool SameName(std::string_view a, std::string_view b) {
  const auto plain = [](std::string_view name) {
    std::string letters;
    for (const char c : name) {
      if (c != '-' && c != '_' && c != ' ') letters += c;
    }
    return letters;
  };
  return EqualIgnoringCase(plain(a), plain(b));
}

}  // namespace

Result<Parameters> MakeParameters(const MachineFamily& family, const std::string& profile,
                                  const std::map<std::string, std::string>& parameters) {
  Parameters made(family.parameters());
  const std::string wanted(profile.empty() ? family.info().default_profile : profile);
  if (!wanted.empty()) {
    const auto profiles = family.profiles();
    const auto found = std::ranges::find_if(
        profiles, [&](const MachineProfile& candidate) { return SameName(candidate.id, wanted); });
    if (found == profiles.end()) {
      std::string known;
      for (const MachineProfile& candidate : profiles) known += " " + std::string(candidate.id);
      return Error{
          ErrorCode::kCellInvalidArgument, "no profile '" + profile + "'; there are" + known, {}};
    }
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
