#include "engine/families/families.h"

#include <algorithm>
#include <string>

#include "engine/core/letters.h"

namespace rmlcell::families {
namespace {

// "jobs/old.d/part.SI" -> "part.SI"
std::string_view WithoutFolder(std::string_view name) {
  const std::size_t folder = name.find_last_of("/\\");
  return folder == std::string_view::npos ? name : name.substr(folder + 1);
}

// "part.SI" -> ".SI"; empty when the name has no extension.
std::string_view ExtensionOf(std::string_view name) {
  name = WithoutFolder(name);
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : name.substr(dot);
}

}  // namespace

bool ClaimsExtension(const machine::FamilyInfo& info, std::string_view extension) {
  std::string_view left = info.extensions;
  while (!left.empty()) {
    const std::size_t end = std::min(left.find(' '), left.size());
    if (!extension.empty() && EqualIgnoringCase(left.substr(0, end), extension)) return true;
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  return false;
}

const machine::MachineFamily* FindFamily(std::string_view id) {
  for (const machine::MachineFamily* family : Families()) {
    if (family->info().id == id) return family;
  }
  return nullptr;
}

Error UnknownFamily(std::string_view id) {
  std::string known;
  for (const machine::MachineFamily* one : Families()) known += " " + std::string(one->info().id);
  return {ErrorCode::kCellUnknownFamily, "'" + std::string(id) + "'; there are" + known, {}};
}

const machine::MachineFamily* FamilyOfFileName(std::string_view name) {
  const std::string_view extension = ExtensionOf(name);
  for (const machine::MachineFamily* family : Families()) {
    if (ClaimsExtension(family->info(), extension)) return family;
  }
  return nullptr;
}

Result<const machine::MachineFamily*> FamilyWithTools(std::string_view name) {
  const machine::MachineFamily* family = FamilyOfFileName(name);
  if (family == nullptr) {
    const auto with_tools = std::ranges::find_if(
        Families(), [](const machine::MachineFamily* one) { return one->tools() != nullptr; });
    if (with_tools != Families().end()) return *with_tools;
  } else if (family->tools() != nullptr) {
    return family;
  }
  return Error{ErrorCode::kCellInvalidArgument,
               Told("file", name) + " is a program for " +
                   (family == nullptr ? "no machine with" : Told("machine", family->info().title)) +
                   ": there are no tools for its streams",
               {}};
}

namespace {

StreamDiff DiffOfStreams(const machine::MachineFamily* family) {
  const auto found = std::ranges::find(StreamComparisons(), family, &StreamComparison::family);
  return found == StreamComparisons().end() ? nullptr : found->diff;
}

}  // namespace

Result<const machine::MachineFamily*> FamilyThatCompares(std::string_view name) {
  const machine::MachineFamily* family = FamilyOfFileName(name);
  if (family != nullptr && DiffOfStreams(family) != nullptr) return family;
  return FamilyWithTools(name);
}

Result<machine::ProgramDiff> Diff(const machine::MachineFamily& family,
                                  const machine::ComparedObject& a,
                                  const machine::ComparedObject& b,
                                  const machine::Parameters& parameters) {
  if (const StreamDiff diff = DiffOfStreams(&family)) return diff(a, b, parameters);
  return family.tools()->Diff(a, b);
}

Result<const machine::MachineFamily*> FamilyOfObject(std::string_view object) {
  for (const machine::MachineFamily* family : Families()) {
    const machine::Tools* tools = family->tools();
    if (tools != nullptr && tools->FormOf({}, object) == machine::FileForm::kObject) return family;
  }
  return FamilyWithTools({});
}

const machine::MachineFamily* FamilyWithSchedules() {
  const auto found = std::ranges::find_if(
      Families(), [](const machine::MachineFamily* one) { return one->info().schedules > 0; });
  return found == Families().end() ? nullptr : *found;
}

bool IsObjectFileName(std::string_view name) {
  const std::string_view extension = ExtensionOf(name);
  // ".O" is a name alone.
  if (extension.empty() || extension.size() == WithoutFolder(name).size()) return false;
  return std::ranges::any_of(Families(), [extension](const machine::MachineFamily* family) {
    const machine::Tools* tools = family->tools();
    return tools != nullptr && EqualIgnoringCase(extension, tools->extensions().object);
  });
}

double OverrideMax() {
  double most = 0.0;
  for (const machine::MachineFamily* family : Families())
    most = std::max(most, family->info().override_max_percent);
  return most;
}

}  // namespace rmlcell::families
