// The parameters of a family as a machine file: what can be set, what it means, what it is now.
#include <nlohmann/json.hpp>
#include <utility>

#include "clients/cli/findings_text.h"
#include "clients/cli/local.h"
#include "clients/cli/program_files.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "engine/families/families.h"
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

// Where the profile has its figure from; empty where it has none of its own.
std::string_view SourceOf(const machine::MachineFamily& family, std::string_view profile,
                          std::string_view parameter) {
  for (const machine::MachineProfile& one : family.profiles()) {
    if (one.id != profile) continue;
    for (const machine::ParameterValue& value : one.values) {
      if (value.name == parameter) return value.source;
    }
  }
  return {};
}

std::string MachineFile(const machine::MachineFamily& family, const std::string& profile,
                        const machine::Parameters& parameters) {
  std::string text =
      "# " + std::string(family.info().title) + "\nfamily = " + Quoted(family.info().id) + "\n";
  text += !profile.empty() ? "profile = " + Quoted(profile) + "\n" : ProfileLines(family);
  text +=
      "# name = \"My machine\"   # what reports call it; [sources] says where figures are from\n";
  text += "\n[parameters]\n";
  for (const machine::ParameterInfo& parameter : family.parameters()) {
    text += "# " + std::string(parameter.text) + " (" + RangeText(parameter) + "; " +
            std::string(parameter.rule) + ")\n";
    if (const std::string_view source = SourceOf(family, parameters.profile(), parameter.name);
        !source.empty())
      text += "# source: " + std::string(source) + "\n";
    text += std::string(parameter.name) + " = " +
            (parameter.choices.empty() ? ShortestText(parameters.Number(parameter.name))
                                       : Quoted(parameters.Word(parameter.name))) +
            "\n";
  }
  return text;
}

nlohmann::ordered_json FamilyJson(const machine::MachineFamily& family) {
  nlohmann::ordered_json profiles = nlohmann::ordered_json::array();
  for (const machine::MachineProfile& profile : family.profiles())
    profiles.push_back({{"id", profile.id}, {"title", profile.title}});
  return {{"family", family.info().id},
          {"title", family.info().title},
          {"profiles", std::move(profiles)}};
}

nlohmann::ordered_json ParametersJson(const machine::MachineFamily& family,
                                      const machine::Parameters& parameters) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const machine::ParameterInfo& parameter : family.parameters()) {
    nlohmann::ordered_json one = {
        {"name", parameter.name}, {"text", parameter.text}, {"rule", parameter.rule}};
    if (parameter.choices.empty()) {
      one["value"] = parameters.Number(parameter.name);
      one["minimum"] = parameter.minimum;
      one["maximum"] = parameter.maximum;
      if (!parameter.unit.empty()) one["unit"] = parameter.unit;
    } else {
      one["value"] = parameters.Word(parameter.name);
      one["choices"] = parameter.choices;
    }
    if (const std::string_view source = SourceOf(family, parameters.profile(), parameter.name);
        !source.empty())
      one["source"] = source;
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

int ListParameters(const std::string& family_id, const std::string& profile_id, bool json) {
  if (family_id.empty()) {
    nlohmann::ordered_json families = nlohmann::ordered_json::array();
    for (const machine::MachineFamily* family : families::Families()) {
      if (json) {
        families.push_back(FamilyJson(*family));
        continue;
      }
      Print(std::string(family->info().id) + "  " + std::string(family->info().title));
      PrintRaw(ProfileLines(*family));
    }
    if (json) Print(nlohmann::ordered_json{{"families", std::move(families)}}.dump());
    return kGood;
  }
  const auto family = FamilyFor(family_id, {});
  if (!family) return Refuse(family.error());
  const Result<machine::Parameters> parameters = machine::MakeParameters(**family, profile_id, {});
  if (!parameters) return Refuse(parameters.error());
  if (json) {
    nlohmann::ordered_json answer = FamilyJson(**family);
    if (!profile_id.empty()) answer["profile"] = profile_id;
    answer["parameters"] = ParametersJson(**family, *parameters);
    Print(answer.dump());
    return kGood;
  }
  PrintRaw(MachineFile(**family, profile_id, *parameters));
  return kGood;
}

}  // namespace rmlcell::cli
