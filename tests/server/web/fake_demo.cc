#include "tests/server/web/fake_demo.h"

#include "engine/core/catalogue.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/cell.pb.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::int64_t kBegin_s = 1'780'000'000;
constexpr int kTicksOfJob = 60;

v1::Job& AddJob(v1::CellSnapshot& snapshot, int number, const std::string& machine,
                const std::string& title, v1::Job::State state) {
  v1::Job& job = *snapshot.add_jobs();
  job.set_name("jobs/" + std::to_string(number));
  job.set_machine("machines/" + machine);
  job.set_title(title);
  job.set_kind(number % 4 == 0 ? v1::JOB_KIND_CHECK : v1::JOB_KIND_SIMULATE);
  job.set_state(state);
  job.set_attempts(state == v1::Job::STATE_QUEUED ? 0 : 1);
  job.mutable_create_time()->set_seconds(kBegin_s + number * 60);
  if (state != v1::Job::STATE_QUEUED)
    job.mutable_start_time()->set_seconds(kBegin_s + number * 60 + 1);
  const bool ended = state != v1::Job::STATE_QUEUED && state != v1::Job::STATE_RUNNING;
  if (ended) {
    job.mutable_end_time()->set_seconds(kBegin_s + number * 60 + 4);
    for (const auto& [name, type] :
         {std::pair{"report", "application/json"}, std::pair{"picture.svg", "image/svg+xml"}}) {
      v1::Artifact& artifact = *job.add_artifacts();
      artifact.set_name(name);
      artifact.set_media_type(type);
      artifact.set_size(4096);
      artifact.set_url_path("/v1/" + job.name() + "/artifacts/" + name);
    }
  }
  return job;
}

void SetOutcome(v1::Job& job, ErrorCode code, v1::Outcome::Kind kind, const std::string& message,
                int step) {
  v1::Outcome& outcome = *job.mutable_outcome();
  outcome.set_kind(kind);
  outcome.set_code(CodeText(code));
  outcome.set_symbol(ConstantName(code));
  outcome.set_message(message);
  outcome.set_advice(std::string(Lookup(code).advice));
  outcome.mutable_place()->set_program(45);
  outcome.mutable_place()->set_step(step);
}

void AddJobs(v1::CellSnapshot& snapshot) {
  AddJob(snapshot, 19, "mill-1", "", v1::Job::STATE_QUEUED);
  AddJob(snapshot, 18, "optimo-1", "Bracket, left", v1::Job::STATE_RUNNING);
  SetOutcome(AddJob(snapshot, 17, "optimo-1", "Elbow 40 mm", v1::Job::STATE_FAILED),
             ErrorCode::kHoleRadiusZero, v1::Outcome::KIND_FAILED, "radius is 0", 28);
  AddJob(snapshot, 16, "mill-1", "Circuit board, traces", v1::Job::STATE_SUCCEEDED)
      .mutable_outcome()
      ->set_kind(v1::Outcome::KIND_COMPLETED);
  AddJob(snapshot, 15, "optimo-1",
         "Flange with a name so long that it has to be cut off somewhere in a row",
         v1::Job::STATE_SUCCEEDED)
      .mutable_outcome()
      ->set_kind(v1::Outcome::KIND_COMPLETED);
  SetOutcome(AddJob(snapshot, 14, "mill-1", "Endless pocket", v1::Job::STATE_FAILED),
             ErrorCode::kCellStepBudget, v1::Outcome::KIND_BUDGET_EXCEEDED, "1000000000 steps", 3);
  SetOutcome(AddJob(snapshot, 13, "optimo-1", "<b>Trial</b> & error", v1::Job::STATE_CANCELLED),
             ErrorCode::kCellCancelled, v1::Outcome::KIND_CANCELLED, "cancelled by local", 7);
}

void AddMachines(v1::CellSnapshot& snapshot) {
  for (const auto& [id, family, title] : {std::tuple{"mill-1", "rml1", "Virtual SRM-20"},
                                          std::tuple{"optimo-1", "optimo", "Virtual Optimo"}}) {
    v1::Machine& machine = *snapshot.add_machines();
    machine.set_name(std::string("machines/") + id);
    machine.set_family(family);
    machine.set_title(title);
    machine.mutable_connection()->set_kind(v1::MachineConnection::KIND_VIRTUAL);
    machine.mutable_status()->set_state(v1::MACHINE_STATE_IDLE);
    machine.mutable_status()->set_jobs_active(1);
  }
}

}  // namespace

bool DemoStory::Next(v1::WatchCellResponse& response) {
  response.set_instance_id("demo");
  response.set_log_id("d3");
  const int tick = tick_++;
  if (tick == 0) {
    response.set_sequence(sequence_);
    response.add_subscriptions("jobs");
    AddJobs(*response.mutable_snapshot());
    return true;
  }
  if (tick == 1) {
    response.set_sequence(sequence_);
    response.add_subscriptions("machines");
    AddMachines(*response.mutable_snapshot());
    return true;
  }
  if (tick % 2 == 1 || tick > 2 * kTicksOfJob + 2) return false;  // waits between two messages
  const int n = tick / 2 - 1;
  if (n == kTicksOfJob) {
    response.set_sequence(++sequence_);
    response.add_subscriptions("jobs");
    response.mutable_event()->set_resource("jobs/18");
    v1::JobEvent& event = *response.mutable_event()->mutable_job();
    event.set_job("jobs/18");
    event.set_sequence(9);
    event.mutable_ended()->set_kind(v1::Outcome::KIND_COMPLETED);
    return true;
  }
  response.set_sequence(sequence_);
  response.add_subscriptions("jobs");
  v1::JobProgress& progress = *response.mutable_progress();
  progress.set_job("jobs/18");
  progress.set_progress(static_cast<double>(n) / kTicksOfJob);
  progress.set_instruction("MOVE");
  progress.mutable_place()->set_program(45);
  progress.mutable_place()->set_step(n * 3 + 1);
  progress.set_virtual_time_ns(n * 730'000'000LL);
  progress.set_speed_mm_s(48.5);
  progress.set_tool_on(n % 5 != 0);
  progress.mutable_position()->mutable_tip()->set_x(100.0 + n);
  progress.mutable_position()->mutable_tip()->set_y(250.25);
  progress.mutable_position()->mutable_tip()->set_z(12.5);
  return true;
}

void EndOfDemoJob(v1::Job& job) {
  v1::CellSnapshot snapshot;
  job = AddJob(snapshot, 18, "optimo-1", "Bracket, left", v1::Job::STATE_SUCCEEDED);
  job.mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
}

void Explain(const std::string& code, v1::ExplainErrorResponse& response) {
  for (const CatalogueEntry* entry : FindByText(code))
    *response.add_errors() = bridge::Explain(*entry);
}

}  // namespace rmlcell::web::testing
