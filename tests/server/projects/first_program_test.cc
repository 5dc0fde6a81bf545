// A machine whose program stands in slot 1 alone, and what of it becomes a project.
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

TEST(FirstProgram, BecomesAProjectWithTheOthers) {
  ServerBed bed;
  Config config;
  ProgramBook programs(bed.store(), config);
  ProjectBook projects(bed.store());
  ProjectTransfer transfer(bed.store(), projects, programs);
  for (const int slot : {1, 2, 99})
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("STOP\n")}}, {}));
  v1::TransferProjectFromMachineRequest request;
  request.set_machine("machines/optimo-1");
  request.set_project_id("all");
  const auto made = transfer.FromMachine(request, "Thu Mar 04 08:52:34 1993", "anna");
  ASSERT_TRUE(made) << made.error.error.detail;
  std::vector<int> slots;
  for (const v1::ProjectProgram& program : made.value->programs()) slots.push_back(program.slot());
  EXPECT_EQ(slots, (std::vector<int>{1, 2, 99}));
}

}  // namespace
}  // namespace rmlcell::server
