// Simulations that cannot be read, and names that are those of no job (live.md 5.02).
#include <gtest/gtest.h>

#include "server/base/names.h"
#include "server/runs/run_ticket.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

TEST(DamagedTickets, ANameOfNoJobProvesNothing) {
  ServerBed bed;
  const auto ticket = TicketOf(bed.store(), "machines/mill-1");
  ASSERT_FALSE(ticket);
  EXPECT_EQ(ticket.error().code, ErrorCode::kCellTicket);
  EXPECT_EQ(ticket.error().detail, "machines/mill-1 is no job");
}

// It is no reason to end the job that it would prove: CellTicket would.
TEST(DamagedTickets, ASimulationThatCannotBeReadIsADamageOfTheStore) {
  ServerBed bed;
  const std::int64_t job =
      Must(bed.store().SubmitAndWait(
               {.machine = "mill-1", .kind = "SIMULATE", .specification = "\xFF"}))
          .job.id;
  const auto ticket = TicketOf(bed.store(), JobName(job));
  EXPECT_EQ(CodeOf(ticket), ErrorCode::kCellStoreCorrupt);
}

}  // namespace
}  // namespace rmlcell::server
