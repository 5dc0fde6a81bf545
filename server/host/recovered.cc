#include "server/host/recovered.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "proto/recording/recording.h"
#include "server/base/secret.h"
#include "server/host/recording_file.h"

namespace rmlcell::server {
namespace {

constexpr std::int64_t kRecordingFileMax = 2 * MachineRecorder::kBytesMax;  // with a last entry

}  // namespace

Recovered RecoveredFrom(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry> journal) {
  using Number = std::pair<std::int64_t, std::int64_t>;
  Recovered found{.known = welcome.has_mark(), .mark = welcome.mark()};
  const Number stored{welcome.mark().fence(), welcome.mark().sequence()};
  Number newest = stored;
  for (const v1::JournalEntry& entry : journal) {
    const Number number{entry.fence(), entry.sequence()};
    if (!entry.has_mark() || (found.known && number <= newest)) continue;
    found.known = true;
    found.mark = entry.mark();
    newest = number;
  }
  for (const v1::JournalEntry& entry : journal) {
    const std::string& job = entry.intent().input().start().job();
    if (Number(entry.fence(), entry.sequence()) <= newest || job.empty()) continue;
    found.begins = job;
    found.begins_at_step = entry.intent().input().start().has_step();
    found.begins_program = entry.intent().input().start().program();
  }
  for (v1::JournalEntry& entry : journal) {
    const Number number{entry.fence(), entry.sequence()};
    if (number > newest) continue;
    if (entry.has_answered()) {
      found.answered.push_back(std::move(entry));
    } else if (number > stored) {
      found.untold.push_back(std::move(entry));
    }
  }
  return found;
}

void AddNewestMark(const std::string& journal, v1::HostHello& hello) {
  const Result<Journal::Found> opened = Journal::Open(journal);
  if (!opened) return;  // OpenMachine says why
  const auto newest = std::ranges::find_if(opened->entries.rbegin(), opened->entries.rend(),
                                           [](const auto& entry) { return entry.has_mark(); });
  if (newest == opened->entries.rend()) return;
  v1::MachineMark& mark = *hello.mutable_journal_mark();
  mark = newest->mark();
  mark.set_fence(newest->fence());
  mark.set_sequence(newest->sequence());
  mark.clear_state();
  mark.clear_base();
}

HostMachine::Setup SetupOf(Recovered found) {
  // It may have begun, and moved the machine, before anything of it was on the disk. LIVE-5.04
  const bool began = !found.begins.empty();
  const bool open = found.mark.has_run_time_ns() || began;
  if (began) {
    found.mark.set_job(found.begins);
    found.mark.set_run_time_ns(0);
    found.mark.clear_place();
    // Of a program that had not begun its first step.
    if (!found.begins_at_step) {
      found.mark.clear_base();
      found.mark.mutable_base()->set_program(found.begins_program);
      found.mark.mutable_base()->set_incomplete(true);
      found.mark.mutable_base()->mutable_place()->set_program(found.begins_program);
      *found.mark.mutable_place() = found.mark.base().place();
    }
  }
  HostMachine::Setup setup;
  setup.state = found.mark.state();
  setup.control_lease = found.mark.control_lease();
  setup.factor = found.mark.factor();
  if (found.mark.has_last_run()) setup.last_run = found.mark.last_run();
  setup.untold = std::move(found.untold);
  setup.answered = std::move(found.answered);
  setup.cut_off = began || (found.known && !found.mark.clean());
  setup.inspect_job = found.mark.job();
  if (found.mark.has_base()) setup.cut_off_base = found.mark.base();
  if (open) setup.open_run = std::move(found.mark);
  return setup;
}

std::optional<MachineRecorder::OfJob> RecoverRecording(const Recovered& found,
                                                       const std::string& path) {
  if (::access(path.c_str(), F_OK) != 0) return {};
  Result<std::string> bytes = bridge::ReadFile(path, kRecordingFileMax);
  const auto durable = bytes
                           ? recording::DurableIn(*bytes, found.mark.fence(), found.mark.sequence())
                           : Result<recording::Durable>(bytes.error());
  const bool of_another =
      durable && !durable->whole && (!found.begins.empty() || durable->job != found.mark.job());
  if (!durable || of_another || ::truncate(path.c_str(), static_cast<off_t>(durable->bytes)) != 0) {
    spdlog::warn("{}: {}", path, !durable ? durable.error().detail : "it is of another run");
    ::unlink(path.c_str());  // no later mark is to find it
    return {};
  }
  bytes->resize(durable->bytes);
  return MachineRecorder::OfJob{
      .job = durable->job, .file = *std::move(bytes), .whole = durable->whole};
}

Result<OpenedMachine> OpenMachine(const v1::HostWelcome& welcome, const HostOptions& options,
                                  const std::string& host, const HostTime& now) {
  const machine::MachineFamily* family = families::FindFamily(welcome.family());
  if (family == nullptr) return Error{ErrorCode::kCellUnknownFamily, welcome.family(), {}};
  Result<Journal::Found> journal = Journal::Open(options.journal);
  if (!journal) return journal.error();
  if (journal->torn_bytes > 0)
    spdlog::warn("{}: {} bytes at its end were torn", options.journal, journal->torn_bytes);
  Recovered found = RecoveredFrom(welcome, std::move(journal->entries));
  auto recording = RecoverRecording(found, RecordingFile::PathBeside(options.journal));
  HostMachine::Setup setup = SetupOf(std::move(found));
  setup.recording = std::move(recording);
  setup.name = options.machine;
  setup.host = host;
  setup.fence = welcome.fence();
  setup.family = family;
  setup.profile = welcome.profile();
  setup.options = welcome.options();
  setup.parameters = {welcome.parameters().begin(), welcome.parameters().end()};
  auto made = HostMachine::Make(std::move(setup), now, RandomText);
  if (!made) return made.error();
  return OpenedMachine{.machine = *std::move(made), .journal = std::move(journal->journal)};
}

}  // namespace rmlcell::server
