// How much of a machine goes into a project.
#include <gtest/gtest.h>

#include <string>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Its programs together have 64 MiB: with just so many they are gathered, and what the project has
// beside them is looked at behind it.
TEST(GatheredRoom, IsThatOfAllPrograms) {
  constexpr std::size_t kHalf = kProjectBytesMax / 2;
  ServerBed bed;
  ProjectBook projects(bed.store());
  Config config;
  ProgramBook programs(bed.store(), config);
  ProjectTransfer transfer(bed.store(), projects, programs);
  const auto why = [&](std::size_t second) {
    Must(bed.store().PutPrograms("mill-1",
                                 {{.slot = 1, .object = std::string(kHalf, ';')},
                                  {.slot = 2, .object = std::string(second, ';')}},
                                 {}));
    v1::TransferProjectFromMachineRequest request;
    request.set_machine("machines/mill-1");
    request.set_project_id("all");
    request.set_validate_only(true);
    const auto gathered = transfer.FromMachine(request, "Thu Mar 04 08:52:34 1993", "anna");
    return gathered ? std::string() : std::string(gathered.error.error.detail);
  };
  const std::string more = "the programs have more than 67108864 bytes";
  EXPECT_NE(why(kHalf), more);
  EXPECT_EQ(why(kHalf + 1), more);
}

}  // namespace
}  // namespace rmlcell::server
