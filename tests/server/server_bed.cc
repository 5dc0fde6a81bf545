#include "tests/server/server_bed.h"

#include "rmlcell/v1/job.pb.h"
#include "server/jobs/job_book.h"
#include "server/records/program_memory.h"

namespace rmlcell::server {
namespace {

// As the server has its store.
storage::SqliteOptions WithMemoryLimits(storage::SqliteOptions options) {
  options.program_memory = LimitOfMemory;
  return options;
}

}  // namespace

ServerBed::ServerBed(storage::SqliteOptions options) : bed_(WithMemoryLimits(std::move(options))) {
  Must(store().PutMachine({.id = "optimo-1", .family = "optimo", .title = "Laser"}, 0));
  Must(store().PutMachine({.id = "mill-1", .family = "rml1", .title = "Mill"}, 0));
}

std::int64_t ServerBed::SubmitCheck(const std::string& source, int attempts_max) {
  v1::Job job;
  job.set_kind(v1::JOB_KIND_CHECK);
  job.set_machine("machines/optimo-1");
  job.mutable_inline_program()->set_file_name("part.S");
  storage::NewJob made{.machine = "optimo-1",
                       .kind = "CHECK",
                       .specification = job.SerializeAsString(),
                       .attempts_max = attempts_max,
                       .attachments = {{.name = std::string(kMainAttachment),
                                        .media_type = "application/octet-stream",
                                        .bytes = source}},
                       .events = {{.kind = "state", .payload = {}}}};
  return Must(store().SubmitAndWait(std::move(made))).job.id;
}

storage::Lease ServerBed::Lease(const std::string& kind) {
  const auto leased = Must(store().Acquire("bed", {kind}, std::chrono::hours(1), {}));
  if (!leased) throw std::runtime_error("no job is queued");
  return leased->lease;
}

void ServerBed::Append(const storage::Lease& lease, int count, const std::string& payload) {
  Must(store().AppendAndWait(lease,
                             std::vector<storage::NewEvent>(static_cast<std::size_t>(count),
                                                            {.kind = "step", .payload = payload})));
}

}  // namespace rmlcell::server
