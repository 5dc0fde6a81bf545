// What computers and their boots are called in names of workers and hosts.
#include "server/base/this_computer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace rmlcell::server {
namespace {

TEST(ThisComputer, HasItsOwnName) {
  std::string name(256, '\0');
  ASSERT_EQ(::gethostname(name.data(), name.size() - 1), 0);
  name.resize(name.find('\0'));
  EXPECT_EQ(NameOfComputer(), name);
}

// proc(5): another one after each boot; the first eight digits tell them apart.
TEST(ThisComputer, HasANameForItsBoot) {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  ASSERT_GT(id.size(), 8U);
  EXPECT_EQ(NameOfBoot(), id.substr(0, 8));
}

}  // namespace
}  // namespace rmlcell::server
