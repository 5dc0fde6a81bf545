#include <google/protobuf/util/time_util.h>

#include <filesystem>
#include <thread>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/request_id.h"
#include "clients/cli/start_words.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/milling.h"
#include "rmlcell/v1/job.grpc.pb.h"

namespace rmlcell::cli {
namespace {

// "234.0 of 868.0 s"; how long it takes is not always known.
std::string TimeText(const v1::JobProgress& at) {
  constexpr double kSeconds = 1e-9;
  std::string text = Fixed(static_cast<double>(at.virtual_time_ns()) * kSeconds, 1);
  if (at.has_planned_time_ns())
    text += " of " + Fixed(static_cast<double>(at.planned_time_ns()) * kSeconds, 1);
  return text + " s";
}

// What a job may bring along in one message; larger programs are stored first.
constexpr std::size_t kInlineBytesMax = 3 << 20;

// Of a target that comes with the job: what a server takes at most, however it is set up.
constexpr std::size_t kTargetBytesMax = 64 << 20;

Status SetTarget(const JobMillingOptions& wanted, bool picture, v1::Milling& milling) {
  const BlockOptions& block = wanted.block;
  if (block.target.empty() && wanted.target_slot == 0) {
    if (!picture && !block.target_tolerance_mm) return {};
    return Error{ErrorCode::kCellUsage,
                 std::string(picture ? "--products target" : "--target-tolerance") +
                     " needs --target or --target-slot",
                 {}};
  }
  v1::MillTarget& target = *milling.mutable_target();
  target.set_picture(picture);
  if (block.target_tolerance_mm) target.set_tolerance_mm(*block.target_tolerance_mm);
  if (block.target.empty()) {
    target.set_slot(wanted.target_slot);
    return {};
  }
  Result<std::string> bytes = bridge::ReadFile(block.target, kTargetBytesMax);
  if (!bytes) return bytes.error();
  bridge::SetTargetFile(bridge::Utf8(std::filesystem::path(block.target).filename().string()),
                        *std::move(bytes), target);
  const Status sound = bridge::CheckTarget(target);
  if (sound) return {};
  return Error{sound.error().code, "--target " + block.target + ": " + sound.error().detail, {}};
}

Status SetMilling(const JobMillingOptions& wanted, v1::Milling& milling) {
  const BlockOptions& block = wanted.block;
  if (const Status set = bridge::SetBlockAndTool(block.stock, block.tool, milling); !set)
    return set.error();
  if (block.cell_mm) milling.set_cell_mm(*block.cell_mm);
  milling.set_material(bridge::Utf8(block.material));
  milling.set_rpm(block.rpm);
  milling.set_stl_tolerance_mm(wanted.stl_tolerance_mm);
  bool difference = false;
  for (const std::string& product : wanted.products) {
    if (product == "relief") milling.set_relief(true);
    if (product == "height-map") milling.set_height_map(true);
    if (product == "height-grid") milling.set_height_grid(true);
    if (product == "stl") milling.set_stl(true);
    if (product == "target") difference = true;
  }
  // What the server would refuse is told before it is asked.
  if (const auto sound = bridge::FromProto(milling); !sound) return sound.error();
  return SetTarget(wanted, difference, milling);
}

// One connection of a watch. Moves `after` on; true: the job ended, and `exit_code` is set.
bool WatchOnce(const Remote& remote, v1::JobService::Stub& stub, const std::string& name,
               bool strict, std::int64_t& after, int& exit_code, grpc::Status& status) {
  grpc::ClientContext context;
  v1::WatchJobRequest request;
  request.set_name(name);
  request.set_after_sequence(after);
  const auto reader = stub.WatchJob(&context, request);
  ProgressLine progress;
  v1::WatchJobResponse message;
  bool ended = false;
  while (reader->Read(&message)) {
    if (message.has_event()) {
      after = message.sequence();
      progress.Clear();
      Print(remote.json ? Json(message) : EventLine(message.event()));
      if (message.event().has_ended()) {
        ended = true;
        exit_code = ExitOf(message.event().ended(), strict);
        // A short job is over before its first position: the bar says all the same how far it came.
        if (!remote.json && exit_code == kGood) progress.Leave(1.0, name);
      }
    } else if (message.has_progress()) {
      const v1::JobProgress& at = message.progress();
      if (remote.json) {
        Print(Json(message));
      } else {
        progress.Show(at.has_progress() ? at.progress() : -1.0,
                      TimeText(at) + "  " + at.instruction() + "  X " +
                          Fixed(at.position().tip().x(), 2) + " Y " +
                          Fixed(at.position().tip().y(), 2) + " Z " +
                          Fixed(at.position().tip().z(), 2));
      }
    } else if (message.has_snapshot()) {
      const v1::Job& job = message.snapshot();
      if (remote.json) Print(Json(message));
      if (job.has_end_time() && job.last_sequence() <= after) {
        ended = true;
        exit_code = ExitOf(job.outcome(), strict);
      }
    }
  }
  status = reader->Finish();
  return ended;
}

const v1::Job& JobOf(const v1::Job& job) { return job; }
const v1::Job& JobOf(const v1::HaltJobResponse& response) { return response.job(); }

// Asks for a change of a job, and says how it is then.
template <class Request, class Response>
int ChangeJob(const Remote& remote,
              grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*, const Request&,
                                                           Response*),
              const Request& request) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  Response response;
  const grpc::Status status = ((*stub).*method)(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  const v1::Job& job = JobOf(response);
  Print(remote.json ? Json(response) : job.name() + " " + StateName(job));
  return kGood;
}

// What a job that waits waits for; nothing but its turn: nothing.
std::string WaitText(const v1::Job& job) {
  const std::string other =
      job.waits_for().substr(std::min<std::size_t>(5, job.waits_for().size()));
  switch (job.wait_reason()) {
    case v1::WAIT_REASON_HELD:
      return "held";
    case v1::WAIT_REASON_NOT_BEFORE:
      return "not before " + When(job.not_before_time());
    case v1::WAIT_REASON_AFTER_JOB:
      return "after " + other;
    case v1::WAIT_REASON_AFTER_JOB_FAILED:
      return "after " + other + ", which did not succeed";
    case v1::WAIT_REASON_MACHINE_BUSY:
      return "its machine runs " + other;
    case v1::WAIT_REASON_CONTROL:
      return Visible(job.waits_for());
    case v1::WAIT_REASON_MACHINE_NOT_READY:
      return "its machine cannot start: rmlcell machine status";
    default:
      return {};
  }
}

// Of a run: where it begins.
Status SetStart(const SubmitRequest& wanted, v1::Job& job) {
  if (!wanted.step.empty()) {
    const auto step = StepOf(wanted.step);
    if (!step)
      return InvalidArgument("'" + wanted.step +
                             "' is no step: PROGRAM/STEP, such as 45/10, or a step");
    *job.mutable_run()->mutable_step() = *step;
    job.mutable_run()->set_occurrence(wanted.occurrence);
    job.mutable_run()->set_off_until_work_on(wanted.off_until_work_on);
  }
  for (const std::string& seen : wanted.seen) {
    const auto confirmation = ConfirmationOf(seen);
    if (!confirmation)
      return InvalidArgument("'" + seen +
                             "' is nothing to look at: clamps, tool, origin-valid, table-clear");
    job.mutable_run()->add_confirmations(*confirmation);
  }
  return {};
}

// When the job may start, and before whom.
Status SetQueue(const SubmitRequest& wanted, v1::Job& job) {
  job.set_priority(wanted.priority);
  job.set_held(wanted.hold);
  for (const std::string& other : wanted.after) job.add_after_jobs(FullName("jobs", other));
  if (wanted.not_before.empty()) return {};
  if (google::protobuf::util::TimeUtil::FromString(wanted.not_before,
                                                   job.mutable_not_before_time()))
    return {};
  return Error{ErrorCode::kCellUsage,
               "--not-before " + wanted.not_before + " is no time such as 2026-11-25T10:00:00Z",
               {}};
}

}  // namespace

int WatchJob(const Remote& remote, const std::string& job, std::int64_t after, bool strict) {
  // What reads from a pipe wants each event when it happens.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  const auto stub = v1::JobService::NewStub(Connect(remote));
  const std::string name = FullName("jobs", job);
  // A server that restarts is waited for, and nothing is missed or told twice.
  constexpr int kTriesMax = 60;
  for (int tries = 0; tries < kTriesMax; ++tries) {
    int exit_code = kGood;
    grpc::Status status;
    const std::int64_t before = after;
    if (WatchOnce(remote, *stub, name, strict, after, exit_code, status)) return exit_code;
    // A server that stops cancels what it cannot end in time.
    const bool away = status.ok() || status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                      status.error_code() == grpc::StatusCode::CANCELLED;
    if (!away) return Refused(status, remote);
    if (after > before) tries = 0;
    if (tries == 0) Complain("the server is away; watching again when it is back");
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  return Refused({grpc::StatusCode::UNAVAILABLE, "gave up after 30 s"}, remote);
}

int SubmitJob(const Remote& remote, const SubmitRequest& wanted) {
  v1::SubmitJobRequest request;
  v1::Job& job = *request.mutable_job();
  job.set_kind(wanted.kind == "check" ? v1::JOB_KIND_CHECK
               : wanted.kind == "run" ? v1::JOB_KIND_RUN
                                      : v1::JOB_KIND_SIMULATE);
  job.set_machine(FullName("machines", wanted.machine));
  job.set_title(bridge::Utf8(wanted.title));
  for (const std::string& label : wanted.labels) job.add_labels(bridge::Utf8(label));
  if (wanted.file.empty()) {
    job.set_program(job.machine() + "/programs/" + std::to_string(wanted.slot));
  } else {
    Result<std::string> bytes = bridge::ReadFile(wanted.file, kFileBytesMax);
    if (!bytes) return Refuse(bytes.error());
    if (bytes->size() > kInlineBytesMax) {
      return Refuse({ErrorCode::kCellTooLarge,
                     wanted.file + " has " + std::to_string(bytes->size()) +
                         " bytes, a job takes " + std::to_string(kInlineBytesMax) +
                         " with it: put it into a slot first, then submit with --slot",
                     {}});
    }
    job.mutable_inline_program()->set_file_name(
        bridge::Utf8(std::filesystem::path(wanted.file).filename().string()));
    job.mutable_inline_program()->set_content(std::move(*bytes));
    job.set_inline_slot(wanted.slot);
    if (job.title().empty()) job.set_title(job.inline_program().file_name());
  }
  v1::SimulationOptions& options = *job.mutable_simulation();
  options.set_override_percent(wanted.override_percent);
  options.set_pace(wanted.pace);
  options.set_trace(wanted.trace);
  if (!wanted.milling_project.empty())
    options.set_milling_project(FullName("projects", wanted.milling_project));
  if (!wanted.milling.block.stock.empty()) {
    if (const Status set = SetMilling(wanted.milling, *options.mutable_milling()); !set)
      return Refuse(set.error());
  }
  if (!wanted.inputs_file.empty()) {
    const Result<std::string> text = bridge::ReadFile(wanted.inputs_file, kFileBytesMax);
    if (!text) return Refuse(text.error());
    // Which machine it is the server knows; a file tells it mostly.
    const machine::MachineFamily* family = families::FamilyOfFileName(wanted.file);
    const double most =
        family == nullptr ? families::OverrideMax() : family->info().override_max_percent;
    if (const Status parsed = bridge::ParseInputFile(*text, wanted.inputs_file, most, options);
        !parsed)
      return Refuse(parsed.error());
  }
  if (job.kind() == v1::JOB_KIND_RUN && options.ByteSizeLong() == 0) job.clear_simulation();
  if (wanted.unzeroed) job.mutable_run()->set_unzeroed(true);
  if (!wanted.ticket.empty()) job.mutable_run()->set_ticket(FullName("jobs", wanted.ticket));
  if (const Status set = SetStart(wanted, job); !set) return Refuse(set.error());
  if (const Status set = SetQueue(wanted, job); !set) return Refuse(set.error());
  request.set_request_id(wanted.request_id.empty() ? NewRequestId() : wanted.request_id);

  const auto stub = v1::JobService::NewStub(Connect(remote));
  v1::Job made;
  grpc::Status status;
  // Repeating is safe: the request id gives the same job.
  for (int tries = 0; tries < 3; ++tries) {
    grpc::ClientContext context;
    Prepare(context);
    status = stub->SubmitJob(&context, request, &made);
    if (status.error_code() != grpc::StatusCode::UNAVAILABLE) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  if (!status.ok()) return Refused(status, remote);
  Print(remote.json ? Json(made) : made.name());
  return wanted.watch ? WatchJob(remote, made.name(), 0, wanted.strict) : kGood;
}

int Jobs(const Remote& remote, const std::string& filter, const std::string& order, int limit) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::ListJobsRequest request;
  request.set_filter(filter);
  request.set_order_by(order == "queue" ? "queue" : order == "oldest" ? "create_time" : "");
  request.set_page_size(limit);
  v1::ListJobsResponse response;
  const grpc::Status status = stub->ListJobs(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    for (const v1::Job& job : response.jobs()) Print(Json(job));
    return kGood;
  }
  std::vector<std::vector<std::string>> rows = {
      {"JOB", "STATE", "VERDICT", "KIND", "MACHINE", "TITLE", "SUBMITTED", "CODE"}};
  for (const v1::Job& job : response.jobs()) {
    const std::string kind = v1::JobKind_Name(job.kind());
    rows.push_back({job.name().substr(5), StateName(job), VerdictName(job.outcome().verdict()),
                    kind.substr(std::min<std::size_t>(9, kind.size())),
                    job.machine().substr(std::min<std::size_t>(9, job.machine().size())),
                    job.title().empty() ? job.program() : job.title(), When(job.create_time()),
                    job.state() == v1::Job::STATE_QUEUED ? WaitText(job) : job.outcome().code()});
  }
  PrintRaw(Table(rows));
  return kGood;
}

int ShowJob(const Remote& remote, const std::string& job) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::GetJobRequest request;
  request.set_name(FullName("jobs", job));
  v1::Job response;
  const grpc::Status status = stub->GetJob(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    Print(Json(response));
    return kGood;
  }
  Print(response.name() + "  " + StateName(response) + "  " + response.machine() + "  " +
        response.title());
  if (const std::string why = WaitText(response); !why.empty()) Print("waits     " + why);
  if (response.has_outcome()) {
    const v1::Outcome& outcome = response.outcome();
    Print("outcome   " + OutcomeLine(outcome));
    if (outcome.verdict() != v1::VERDICT_UNSPECIFIED)
      Print("verdict   " + VerdictText(outcome.verdict()));
    for (const v1::VerdictReason& reason : outcome.reasons())
      Print("          " + ReasonLine(reason));
  }
  for (const v1::Artifact& artifact : response.artifacts()) {
    Print("product   " + artifact.name() + "  " + Bytes(artifact.size()) + "  " +
          artifact.url_path());
  }
  return kGood;
}

int CancelJob(const Remote& remote, const std::string& job) {
  v1::CancelJobRequest request;
  request.set_name(FullName("jobs", job));
  return ChangeJob(remote, &v1::JobService::Stub::CancelJob, request);
}

int HoldJob(const Remote& remote, const std::string& job) {
  v1::HoldJobRequest request;
  request.set_name(FullName("jobs", job));
  return ChangeJob(remote, &v1::JobService::Stub::HoldJob, request);
}

int ResumeJob(const Remote& remote, const std::string& job) {
  v1::ResumeJobRequest request;
  request.set_name(FullName("jobs", job));
  return ChangeJob(remote, &v1::JobService::Stub::ResumeJob, request);
}

int MoveJob(const Remote& remote, const std::string& job, const std::string& before,
            std::optional<int> priority) {
  v1::MoveJobRequest request;
  request.set_name(FullName("jobs", job));
  if (!before.empty()) request.set_before(FullName("jobs", before));
  if (priority) request.set_priority(*priority);
  return ChangeJob(remote, &v1::JobService::Stub::MoveJob, request);
}

int JobReport(const Remote& remote, const std::string& job, bool machine_coordinates) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::GetJobReportRequest request;
  request.set_name(FullName("jobs", job));
  v1::RunReport report;
  const grpc::Status status = stub->GetJobReport(&context, request, &report);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    PrintJson(report);
  } else {
    PrintRaw(ReportText(report, machine_coordinates ? Zero::kMachine : Zero::kWork));
  }
  return kGood;
}

int JobPicture(const Remote& remote, const std::string& job, const std::string& output) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::GetJobPictureRequest request;
  request.set_name(FullName("jobs", job));
  v1::GetJobPictureResponse response;
  const grpc::Status status = stub->GetJobPicture(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (output.empty() || output == "-") {
    PrintRaw(response.content());
    return kGood;
  }
  if (const Status written = WriteWholeFile(output, response.content()); !written)
    return Refuse(written.error());
  return kGood;
}

int JobArtifact(const Remote& remote, const std::string& job, const std::string& artifact,
                const std::string& output) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::StreamJobArtifactRequest request;
  request.set_name(FullName("jobs", job));
  request.set_artifact(artifact);
  const auto reader = stub->StreamJobArtifact(&context, request);
  std::string content;
  v1::StreamJobArtifactResponse message;
  while (reader->Read(&message)) content += message.chunk();
  if (const grpc::Status status = reader->Finish(); !status.ok()) return Refused(status, remote);
  if (output.empty() || output == "-") {
    PrintRaw(content);
    return kGood;
  }
  if (const Status written = WriteWholeFile(output, content); !written)
    return Refuse(written.error());
  return kGood;
}

}  // namespace rmlcell::cli
