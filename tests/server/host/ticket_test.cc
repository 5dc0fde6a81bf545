// Jobs that prove that their program was simulated as it is (live.md 5.02).
#include "proto/bridge/ticket.h"

#include "engine/simulation/run/version.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class TicketTest : public HostMachineTest {
 protected:
  // Of the square, with the machine as it is.
  static v1::RunTicket Ticket() {
    const machine::MachineFamily& family = *families::FindFamily("rml1");
    const auto parameters = machine::MakeParameters(family, "srm-20", {});
    const std::map<int, machine::StoredProgram> programs = {
        {5, {.name = "square", .object = machine::Bytes::Of(kSquare)}}};
    v1::RunTicket ticket;
    ticket.set_job("jobs/16");
    ticket.set_main_program(5);
    ticket.set_family("rml1");
    ticket.set_engine_version(std::string(simulation::kEngineVersion));
    for (const auto& [name, value] : parameters->Changed())
      (*ticket.mutable_parameters())[name] = value;
    for (const auto& [name, digest] : bridge::DigestsOf({.family = family,
                                      .parameters = *parameters,
                                      .programs = programs,
                                      .schedules = {},
                                      .main_program = 5}))
      (*ticket.mutable_inputs())[name] = digest;
    return ticket;
  }
  static v1::HostOrder Job(const char* program = kSquare) {
    v1::HostOrder order;
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name("jobs/17");
    assignment.set_main_program(5);
    v1::AssignedProgram& brought = *assignment.add_programs();
    brought.set_slot(5);
    brought.set_file_name("a.rml");
    brought.set_is_source(true);
    brought.set_content(program);
    return order;
  }
  static v1::HostOrder With(v1::RunTicket ticket, const char* program = kSquare) {
    v1::HostOrder order = Job(program);
    *order.mutable_run_job()->mutable_ticket() = std::move(ticket);
    return order;
  }
  std::string Refusal(const v1::HostOrder& order) {
    const v1::HostOrderAnswer answer = Do(order);
    return answer.refusal().code() + " " + answer.refusal().message();
  }
};

// LIVE-5.02: what was simulated runs.
TEST_F(TicketTest, TheProgramThatWasSimulatedRuns) {
  options_.set_ticket_needed(true);
  Make();
  EXPECT_EQ(Do(With(Ticket())).status().run().job(), "jobs/17");
}

// LIVE-5.02: where the machine asks for one, a job without one does not begin.
TEST_F(TicketTest, AJobWithoutOneDoesNotBeginWhereItIsNeeded) {
  options_.set_ticket_needed(true);
  Make();
  EXPECT_THAT(Refusal(Job()), HasSubstr("CELL-E9407"));
  EXPECT_FALSE(host_->StatusAt(now_).has_run());
  options_.set_ticket_needed(false);
  Make();
  EXPECT_EQ(Do(Job()).status().run().job(), "jobs/17");
}

// LIVE-5.02: one that a job has is held against it everywhere, and what is other is said.
TEST_F(TicketTest, AnotherProgramOrMachineIsRefused) {
  Make();
  EXPECT_THAT(Refusal(With(Ticket(), "PA;PU100,0;")),
              testing::AllOf(HasSubstr("CELL-E9407"), HasSubstr("other than in jobs/16: program")));
  v1::RunTicket ticket = Ticket();
  (*ticket.mutable_parameters())["JOG_SLOW"] = "2.5";
  EXPECT_THAT(Refusal(With(ticket)), HasSubstr("other than in jobs/16: parameter JOG_SLOW"));
  ticket = Ticket();
  for (int i = 0; i < 10; ++i) (*ticket.mutable_parameters())["Z" + std::to_string(i)] = "1";
  EXPECT_THAT(Refusal(With(ticket)), HasSubstr("parameter Z7 and 2 more"));
  EXPECT_FALSE(host_->StatusAt(now_).has_run());
  EXPECT_EQ(Do(With(Ticket())).status().run().job(), "jobs/17");
}

}  // namespace
}  // namespace rmlcell::server
