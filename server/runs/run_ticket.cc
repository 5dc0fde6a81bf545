#include "server/runs/run_ticket.h"

#include <string>

#include "server/base/names.h"
#include "server/records/job_messages.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

Error NoTicket(std::string_view simulation, std::string_view why) {
  return {ErrorCode::kCellTicket, std::string(simulation) + " " + std::string(why), {}};
}

// "" where it came to a good end.
std::string WhyNoProof(const storage::JobRecord& job, const v1::Job& asked) {
  if (asked.kind() != v1::JOB_KIND_SIMULATE) return "is no simulation";
  if (asked.simulation().has_simul()) return "ran dry up to a step";
  if (!storage::IsFinal(job.state)) return "has not come to its end";
  if (job.state != storage::JobState::kSucceeded || !job.outcome) return "did not succeed";
  if (ToProto(*job.outcome).verdict() == v1::VERDICT_GOOD) return {};
  return "is " + (job.outcome->verdict.empty() ? "without a verdict" : job.outcome->verdict) +
         ", not GOOD";
}

}  // namespace

Result<v1::RunTicket> TicketOf(storage::Store& store, std::string_view simulation) {
  const auto id = ParseJobName(simulation);
  if (!id) return NoTicket(simulation, "is no job");
  const auto job = store.GetJob(*id);
  if (!job) {
    if (storage::IsTroubleOfTheStore(job.error())) return job.error();
    return NoTicket(simulation, "is not kept");
  }
  v1::Job asked;
  if (!asked.ParseFromString(job->specification))
    return Error{ErrorCode::kCellStoreCorrupt, "the specification of " + JobName(*id), {}};
  if (const std::string why = WhyNoProof(*job, asked); !why.empty())
    return NoTicket(simulation, why);
  const auto bytes = store.ReadArtifact(*id, "report");
  if (!bytes && storage::IsTroubleOfTheStore(bytes.error())) return bytes.error();
  v1::RunReport report;
  if (!bytes || !report.ParseFromString(*bytes) || report.inputs().empty())
    return NoTicket(simulation, "does not say what it depended on: simulate it again");
  v1::RunTicket ticket;
  ticket.set_job(std::string(simulation));
  ticket.set_main_program(MainSlotOf(asked));
  ticket.set_family(report.family());
  *ticket.mutable_parameters() = report.parameters();
  *ticket.mutable_inputs() = report.inputs();
  ticket.set_engine_version(report.engine_version());
  return ticket;
}

}  // namespace rmlcell::server
