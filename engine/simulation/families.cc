#include "engine/simulation/families.h"

#include <algorithm>
#include <vector>

#include "engine/core/letters.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/rml1/rml1_family.h"

namespace rmlcell::simulation {
namespace {

// "part.SI" of "jobs/old.d/part.SI" -> ".SI"; empty when the name has no extension.
std::string_view ExtensionOf(std::string_view name) {
  const std::size_t folder = name.find_last_of("/\\");
  if (folder != std::string_view::npos) name.remove_prefix(folder + 1);
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : name.substr(dot);
}

}  // namespace

// The registration of the machine families: one line each.
std::span<const machine::MachineFamily* const> Families() {
  static const std::vector<const machine::MachineFamily*> families = {
      &optimo::OptimoFamily(),
      &rml1::Rml1Family(),
  };
  return families;
}

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

const machine::MachineFamily* FamilyOfFileName(std::string_view name) {
  const std::string_view extension = ExtensionOf(name);
  for (const machine::MachineFamily* family : Families()) {
    if (ClaimsExtension(family->info(), extension)) return family;
  }
  return nullptr;
}

}  // namespace rmlcell::simulation
