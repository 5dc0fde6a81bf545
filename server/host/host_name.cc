#include "server/host/host_name.h"

#include <unistd.h>

#include <array>
#include <fstream>

#include "server/base/secret.h"

namespace rmlcell::server {

namespace {

std::string NameOfComputer() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "computer";
  return name.data();
}

// Anew with each start of the computer.
std::string BootId() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

}  // namespace

void AddComputer(v1::HostHello& hello) {
  hello.set_boot_id(BootId());
  hello.set_computer(NameOfComputer());
}

// The random part: a number of a process comes again, after a reboot, too.
std::string NameOfHost() {
  return NameOfComputer() + "/" + std::to_string(::getpid()) + "/" + RandomText().substr(0, 8);
}

}  // namespace rmlcell::server
