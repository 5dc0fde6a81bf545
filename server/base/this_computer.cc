#include "server/base/this_computer.h"

#include <unistd.h>

#include <array>
#include <fstream>

namespace rmlcell::server {

std::string NameOfComputer() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string NameOfBoot() {
  constexpr std::size_t kDigits = 8;
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id.substr(0, kDigits);
}

}  // namespace rmlcell::server
