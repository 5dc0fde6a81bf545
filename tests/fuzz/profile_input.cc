#include "tests/fuzz/profile_input.h"

#include <cctype>

#include "engine/families/families.h"
#include "engine/machine/profile_files.h"

namespace rmlcell::machine {
namespace {

constexpr std::string_view kFile = "mine.toml:";

std::string TryRefusal(const Error& error) {
  if (error.code != ErrorCode::kCellBadText) return "refused with another code";
  const std::string_view detail = error.detail;
  const bool has_line = detail.starts_with(kFile) && detail.size() > kFile.size() &&
                        std::isdigit(static_cast<unsigned char>(detail[kFile.size()])) != 0;
  return has_line ? "" : "no file and line: " + error.detail;
}

std::string TryOnMachine(const MachineProfile& profile) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  Parameters parameters(mill.parameters());
  if (!parameters.Apply(profile))
    return parameters.Changed().empty() ? "" : "a profile was taken in part";
  for (const ParameterInfo& info : mill.parameters()) {
    if (!info.choices.empty()) continue;
    const double number = parameters.Number(info.name);
    if (!(number >= info.minimum && number <= info.maximum))
      return std::string(info.name) + " is out of its range";
  }
  return {};
}

}  // namespace

std::string TryProfile(std::string_view bytes) {
  const ProfileText files[] = {{"mine", bytes}};
  const Result<ProfileFiles> read = ProfileFiles::Read(files);
  if (!read) return TryRefusal(read.error());
  if (read->all().size() != 1) return "one file made other than one profile";
  const MachineProfile& profile = read->all().front();
  for (const ParameterValue& value : profile.values) {
    if (value.name.data() == nullptr || value.source.data() == nullptr)
      return "a figure without name or source";
  }
  return TryOnMachine(profile);
}

}  // namespace rmlcell::machine
