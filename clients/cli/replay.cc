// rmlcell replay: what a machine did, played again.
#include "clients/cli/replay.h"

#include <filesystem>
#include <utility>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/terminal.h"
#include "clients/cli/version.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/recording/replay.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"

namespace rmlcell::cli {
namespace {

constexpr std::int64_t kRecordingBytesMax = std::int64_t{1} << 30;

// Of what a server has; an exit code where it does not give it.
struct Fetched {
  std::string file{};
  int exit_code = kGood;
};

Fetched FetchFrom(const Remote& remote, const v1::ExportJournalRequest& request) {
  const auto stub = v1::MachineService::NewStub(Connect(remote));
  grpc::ClientContext context;
  const auto reader = stub->ExportJournal(&context, request);
  Fetched fetched;
  v1::ExportJournalResponse message;
  while (reader->Read(&message)) fetched.file += message.chunk();
  if (const grpc::Status status = reader->Finish(); !status.ok())
    fetched.exit_code = Refused(status, remote);
  return fetched;
}

Fetched FetchOfJob(const Remote& remote, const std::string& job) {
  const auto stub = v1::JobService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::GetJobRequest asked;
  asked.set_name(FullName("jobs", job));
  v1::Job known;
  if (const grpc::Status status = stub->GetJob(&context, asked, &known); !status.ok())
    return {.exit_code = Refused(status, remote)};
  v1::ExportJournalRequest request;
  request.set_machine(known.machine());
  request.set_job(known.name());
  return FetchFrom(remote, request);
}

Fetched Fetch(const Remote& remote, const std::string& what) {
  if (std::filesystem::exists(what)) {
    Result<std::string> bytes = bridge::ReadFile(what, kRecordingBytesMax);
    if (!bytes) return {.exit_code = Refuse(bytes.error())};
    return {.file = *std::move(bytes)};
  }
  const bool is_job =
      what.starts_with("jobs/") || what.find_first_not_of("0123456789") == std::string::npos;
  if (is_job) return FetchOfJob(remote, what);
  const bool is_path = what.find('/') != std::string::npos && !what.starts_with("machines/");
  if (what.ends_with(".rmlj") || is_path)
    return {.exit_code = Refuse({ErrorCode::kCellFileUnreadable, what + ": no such file", {}})};
  v1::ExportJournalRequest request;
  request.set_machine(FullName("machines", what));
  return FetchFrom(remote, request);
}

// Where it stood, and what it did there.
void TellStand(const machine::Machine& machine) {
  const machine::MachineStatus now = machine.status();
  std::string text = "at " + Duration(ToSeconds(now.time)) +
                     " of the machine: " + std::string(machine::Name(now.state));
  if (now.open && now.run.place.step > 0)
    text +=
        " at " + std::to_string(now.run.place.program) + "/" + std::to_string(now.run.place.step);
  for (const v1::AxisValue& axis : bridge::AxesOf(machine.family().info().axes, now.run.axes)) {
    text += "  " + AxisText(axis);
  }
  Print(text);
}

void TellResult(const recording::Recording& recording, const recording::Replayed& replayed) {
  const v1::MachineRecording& head = recording.head;
  Print(head.machine() + (head.job().empty() ? "" : ", " + head.job()) + ": played again, " +
        std::to_string(replayed.inputs) + " inputs, " + std::to_string(replayed.events) +
        " events and " + std::to_string(replayed.marks) + " marks are the same, until " +
        Duration(ToSeconds(replayed.until)) + " of the machine");
}

}  // namespace

int Replay(const Remote& remote, const ReplayRequest& request) {
  Fetched fetched = Fetch(remote, request.what);
  if (fetched.exit_code != kGood) return fetched.exit_code;
  Result<recording::Recording> recording = recording::ReadFile(fetched.file);
  if (!recording) return Refuse(recording.error());
  if (!request.output.empty()) {
    if (const Status written = WriteWholeFile(request.output, fetched.file); !written)
      return Refuse(written.error());
  }
  if (request.from) *recording = recording::From(*std::move(recording), SimTime(*request.from));
  const std::string& version = recording->head.engine_version();
  if (version != kVersion)
    Complain("it was recorded by version " + version + ", and this is " + std::string(kVersion));
  recording::ReplayOptions options;
  if (request.to) {
    options.to = SimTime(*request.to);
    options.stands = TellStand;
  }
  const Result<recording::Replayed> replayed = recording::Replay(*recording, options);
  if (!replayed) return Refuse(replayed.error());
  if (!replayed->difference) {
    TellResult(*recording, *replayed);
    return kGood;
  }
  const recording::Difference& found = *replayed->difference;
  Complain(bridge::ErrorText({ErrorCode::kCellReplayDiffers,
                              "entry " + std::to_string(found.sequence) + " at " +
                                  std::to_string(found.at.count()) + " ns, " + found.field +
                                  "\n  recorded " + found.recorded + "\n  played   " + found.played,
                              {}}));
  return kProgramErrors;
}

}  // namespace rmlcell::cli
