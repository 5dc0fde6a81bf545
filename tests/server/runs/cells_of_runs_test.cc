// The block that a run mills, and the simulation that proves it (live.md 5.02, 5.10).
#include "server/runs/run_ticket.h"
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

class CellsOfRuns : public RunQueueTest {
 protected:
  std::int64_t Simulation(const v1::Job& asked) {
    return Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                           .kind = "SIMULATE",
                                           .specification = asked.SerializeAsString()}))
        .job.id;
  }
  // Of a run that a simulation of this block and tool proves.
  std::optional<v1::Milling> Milling(const std::string& stock, const std::string& tool) {
    v1::Job asked;
    Must(bridge::SetBlockAndTool(stock, tool, *asked.mutable_simulation()->mutable_milling()));
    v1::Job run;
    run.mutable_run()->set_ticket(JobName(Simulation(asked)));
    return runs.MillingOf(
        Must(bed.store().SubmitAndWait(
                 {.machine = "optimo-1", .kind = "RUN", .specification = run.SerializeAsString()}))
            .job.id);
  }
};

// A block of 128 x 128 mm has 4,194,304 cells of 0.0625 mm: as wide as half a tool of 0.125 mm.
TEST_F(CellsOfRuns, AreAsWideAsHalfTheToolAtMost) {
  EXPECT_TRUE(Milling("128x128x5", "flat:0.125"));
  EXPECT_FALSE(Milling("128x128x5", "flat:0.1245"));
}

// LIVE-5.02
TEST_F(CellsOfRuns, ASimulationThatDoesNotProveItIsNamed) {
  const auto why = [this](const std::string& simulation) {
    const auto ticket = TicketOf(bed.store(), simulation);
    return ticket ? std::string() : std::string(ticket.error().detail);
  };
  v1::Job asked;
  asked.set_kind(v1::JOB_KIND_SIMULATE);
  const std::string job = JobName(Simulation(asked));
  const storage::Lease lease = bed.Lease("SIMULATE");
  v1::Outcome good;
  good.set_kind(v1::Outcome::KIND_COMPLETED);
  good.set_verdict(v1::VERDICT_GOOD);
  Must(bed.store().Finish(lease, {.outcome = OutcomeOf(good)}));
  EXPECT_EQ(why(job), job + " does not say what it depended on: simulate it again");
  EXPECT_EQ(why("jobs/99"), "jobs/99 is not kept");
  EXPECT_EQ(why("simulation"), "simulation is no job");
}

// LIVE-5.02: a RUN that is handed in again tells at once what it waits for, as the first did.
TEST_F(CellsOfRuns, ARunThatIsHandedInAgainTellsWhyItWaits) {
  v1::MachineStatus status = Idle();
  Block(status, "CELL-E9423");
  Tell(status);
  const std::int64_t first = Submit();
  std::promise<v1::Job> again;
  book.Again(JobName(first), "bert", "a request", false,
             [&](const Result<v1::Job>& made) { again.set_value(made ? *made : v1::Job()); });
  const v1::Job job = again.get_future().get();
  EXPECT_NE(job.name(), JobName(first));
  ASSERT_EQ(job.start_blockers_size(), 1);
  EXPECT_EQ(job.start_blockers(0).code(), "CELL-E9423");
}

// LIVE-6.01: one that goes on begins where a preview said, and not where the first began.
TEST_F(CellsOfRuns, ARunThatGoesOnForgetsWhereTheFirstBegan) {
  v1::MachineStatus status = Idle();
  Block(status, "CELL-E9423");
  Tell(status);
  const std::int64_t first = Submit([](v1::Job& asked) {
    asked.mutable_run()->mutable_step()->set_step(2);
    asked.mutable_run()->set_occurrence(3);
    asked.mutable_run()->set_off_until_work_on(true);
    asked.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
  });
  const auto again = [&](bool continues, const std::string& request) {
    std::promise<v1::Job> made;
    book.Again(JobName(first), "bert", request, continues,
               [&](const Result<v1::Job>& job) { made.set_value(job ? *job : v1::Job()); });
    return made.get_future().get();
  };
  const v1::RunOptions same = again(false, "the same").run();
  EXPECT_EQ(same.step().step(), 2);
  EXPECT_EQ(same.occurrence(), 3);
  EXPECT_TRUE(same.off_until_work_on());
  EXPECT_EQ(same.confirmations_size(), 1);
  const v1::Job goes_on = again(true, "goes on");
  EXPECT_EQ(goes_on.continues(), JobName(first));
  EXPECT_FALSE(goes_on.run().has_step());
  EXPECT_EQ(goes_on.run().occurrence(), 0);
  EXPECT_FALSE(goes_on.run().off_until_work_on());
  EXPECT_EQ(goes_on.run().confirmations_size(), 0);
}

}  // namespace
}  // namespace rmlcell::server
