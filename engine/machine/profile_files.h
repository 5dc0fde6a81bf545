#pragma once

#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {

// A profile as a file (TOML): `title`; [parameters] with numbers and words by the names of the
// family; [sources] with where each of them is from, "estimate" where it is a guess. Its name is
// that of the profile: "srm-20".
struct ProfileText {
  std::string_view id;
  std::string_view text;  // outlives what is made of it
};

// Profiles as their files have them, in that order.
class ProfileFiles {
 public:
  // Error: CellBadText with file and line: no TOML, another key, a figure without its source.
  static Result<ProfileFiles> Read(std::span<const ProfileText> files);
  // Precondition: Read is well. Files that were built in.
  explicit ProfileFiles(std::span<const ProfileText> files);

  ProfileFiles(ProfileFiles&&) = default;
  ProfileFiles& operator=(ProfileFiles&&) = default;

  std::span<const MachineProfile> all() const { return profiles_; }

 private:
  ProfileFiles() = default;
  Status Add(const ProfileText& file);
  std::string_view Kept(std::string text);

  std::deque<std::string> texts_;  // what the profiles refer to
  std::vector<MachineProfile> profiles_;
};

}  // namespace rmlcell::machine
