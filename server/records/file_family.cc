#include "server/records/file_family.h"

#include "engine/families/families.h"
#include "server/base/readable.h"

namespace rmlcell::server {

Status CheckFileFamily(const std::string& file_name, const machine::MachineFamily& family) {
  const machine::MachineFamily* named = families::FamilyOfFileName(file_name);
  if (named == nullptr || named == &family) return {};
  return InvalidArgument(Readable(file_name) + " is a program for " +
                         std::string(named->info().title) + ", not for " +
                         std::string(family.info().title));
}

Status CheckFileName(std::string_view file_name, std::string_view field) {
  constexpr std::size_t kLongest = 255;
  if (file_name.size() <= kLongest) return {};
  return InvalidArgument(std::string(field) + " is longer than 255 bytes");
}

}  // namespace rmlcell::server
