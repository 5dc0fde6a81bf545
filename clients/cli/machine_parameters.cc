// The parameters of a family as a machine file: what can be set, what it means, what it is now.
#include "clients/cli/local.h"
#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "engine/simulation/families.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"

namespace rmlcell::cli {
namespace {

std::string Quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

std::string RangeText(const machine::ParameterInfo& parameter) {
  if (!parameter.choices.empty()) return "one of " + std::string(parameter.choices);
  return ShortestText(parameter.minimum) + " to " + ShortestText(parameter.maximum) +
         (parameter.unit.empty() ? "" : " " + std::string(parameter.unit));
}

std::string ProfileLines(const machine::MachineFamily& family) {
  std::string lines;
  for (const machine::MachineProfile& profile : family.profiles()) {
    lines += "# profile = " + Quoted(profile.id) + "   # " + std::string(profile.title) + "\n";
  }
  return lines;
}

std::string MachineFile(const machine::MachineFamily& family, const std::string& profile,
                        const machine::Parameters& parameters) {
  std::string text = "# " + std::string(family.info().title) + "\nfamily = " + Quoted(family.info().id) + "\n";
  text += !profile.empty() ? "profile = " + Quoted(profile) + "\n" : ProfileLines(family);
  text += "\n[parameters]\n";
  for (const machine::ParameterInfo& parameter : family.parameters()) {
    text += "# " + std::string(parameter.text) + " (" + RangeText(parameter) + "; " + std::string(parameter.rule) + ")\n";
    text += std::string(parameter.name) + " = " +
            (parameter.choices.empty() ? ShortestText(parameters.Number(parameter.name))
                                       : Quoted(parameters.Word(parameter.name))) + "\n";
  }
  return text;
}

}  // namespace

int ListParameters(const std::string& family_id, const std::string& profile_id) {
  if (family_id.empty()) {
    for (const machine::MachineFamily* family : simulation::Families()) {
      Print(std::string(family->info().id) + "  " + std::string(family->info().title));
      PrintRaw(ProfileLines(*family));
    }
    return kGood;
  }
  const auto family = FamilyFor(family_id, {});
  if (!family) return Refuse(family.error());
  const Result<machine::Parameters> parameters = bridge::MakeParameters(**family, profile_id, {});
  if (!parameters) return Refuse(parameters.error());
  PrintRaw(MachineFile(**family, profile_id, *parameters));
  return kGood;
}

}  // namespace rmlcell::cli
