#include "server/runs/run_products.h"

#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <optional>
#include <utility>

#include "proto/bridge/findings.h"
#include "proto/recording/recording.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "server/base/child_process.h"
#include "server/base/names.h"
#include "server/machines/hosts.h"
#include "server/machines/recordings.h"
#include "server/records/job_messages.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// A host has the recordings of its newest runs alone (MachineRecorder::kKept).
constexpr int kNewest = 4;
constexpr std::chrono::milliseconds kLookAtProcess{20};
constexpr std::chrono::seconds kFetchPatience{30};

struct Product {
  const char* name;
  const char* media_type;
};
constexpr std::array<Product, 4> kProducts = {{{"report", "application/x-protobuf"},
                                               {"toolpath", "application/octet-stream"},
                                               {"picture.svg", "image/svg+xml"},
                                               {"steps", "application/x-protobuf"}}};

std::optional<std::string> ReadWhole(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

bool Has(storage::Store& store, std::int64_t job, std::string_view name) {
  return static_cast<bool>(store.GetArtifact(job, name));
}

// Tried again: it is not the recording's fault.
Error NoDisk(const std::string& what, const std::error_code& why) {
  return {ErrorCode::kCellStoreFailed, what + ": " + why.message(), {}};
}

// Whether what is played has room to write to.
bool IsFull(const std::string& folder) {
  constexpr std::uintmax_t kRoom = std::uintmax_t{1} << 20;
  std::error_code failed;
  const fs::space_info space = fs::space(folder, failed);
  return !failed && space.available < kRoom;
}

Status WriteWhole(const std::string& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  out.close();
  return out ? Status() : Status(NoDisk(file, std::make_error_code(std::errc::io_error)));
}

}  // namespace

RunProducts::RunProducts(Needs needs) : needs_(std::move(needs)) {
  std::error_code none;
  fs::remove_all(needs_.folder, none);  // what a server that was killed left there
  thread_ = std::jthread([this](const std::stop_token& stop) { Work(stop); });
}

RunProducts::~RunProducts() {
  thread_.request_stop();
  thread_.join();
}

void RunProducts::Look(const std::string& machine) {
  const std::lock_guard lock(mutex_);
  due_[machine] = Clock::now();
  changed_.notify_all();
}

// The machine that is due; empty: it is to stop.
std::string RunProducts::Next(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const auto first =
        std::ranges::min_element(due_, {}, [](const auto& row) { return row.second; });
    if (first == due_.end()) {
      changed_.wait(lock, stop, [this] { return !due_.empty(); });
    } else if (first->second > Clock::now()) {
      const auto until = first->second;
      changed_.wait_until(lock, stop, until, [&] {
        return std::ranges::any_of(due_, [&](const auto& row) { return row.second < until; });
      });
    } else {
      return due_.extract(first).key();
    }
  }
  return {};
}

void RunProducts::Work(const std::stop_token& stop) {
  for (std::string machine = Next(stop); !machine.empty(); machine = Next(stop)) {
    bool done = false;
    try {
      done = LookAt(machine, stop);
    } catch (const std::exception& error) {
      spdlog::error("products of the runs of {}: {}", machine, error.what());
    }
    if (done) continue;
    const std::lock_guard lock(mutex_);
    due_.try_emplace(machine, Clock::now() + needs_.looked_at_again_after);
  }
}

bool RunProducts::LookAt(const std::string& machine, const std::stop_token& stop) {
  const auto jobs = needs_.store.ListJobs({.machine = machine,
                                           .kind = std::string(storage::kRunKind),
                                           .finished = true,
                                           .limit = kNewest});
  if (!jobs) {
    spdlog::warn("runs of {}: {}", machine, bridge::ErrorText(jobs.error()));
    return false;
  }
  for (const storage::JobRecord& job : *jobs) {
    if (stop.stop_requested()) return true;
    if (!job.started_at || given_up_.contains(job.id) || Has(needs_.store, job.id, "report"))
      continue;
    const Status made = Make(job, stop);
    if (made || stop.stop_requested()) continue;
    // A host without a line says when it has one again; one that is silent does not.
    if (made.error().code == ErrorCode::kCellNotLive) return !needs_.hosts.IsHeard(machine);
    if (storage::IsTroubleOfTheStore(made.error())) return false;
    given_up_.insert(job.id);
    spdlog::warn("no report of {}: {}", JobName(job.id), bridge::ErrorText(made.error()));
  }
  return true;
}

Status RunProducts::Make(const storage::JobRecord& job, const std::stop_token& stop) {
  Result<std::string> recording = RecordingOf(job);
  if (!recording) return recording.error();
  const std::string folder = needs_.folder + "/" + std::to_string(job.id);
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return NoDisk(folder, failed);
  const std::string file = folder + "/" + std::string(kRecording);
  Status done = WriteWhole(file, *recording);
  if (done) done = Play(file, folder, stop);
  if (!done && IsFull(folder))
    done = NoDisk(folder, std::make_error_code(std::errc::no_space_on_device));
  if (done) done = Store(job, folder);
  fs::remove_all(folder, failed);
  return done;
}

Result<std::string> RunProducts::RecordingOf(const storage::JobRecord& job) {
  if (Has(needs_.store, job.id, kRecording)) return needs_.store.ReadArtifact(job.id, kRecording);
  auto promise = std::make_shared<std::promise<Result<std::string>>>();
  FetchRecording(needs_.hosts, job.machine, JobName(job.id),
                 [promise](Result<std::string> got) { promise->set_value(std::move(got)); });
  std::future<Result<std::string>> answer = promise->get_future();
  if (answer.wait_for(kFetchPatience) != std::future_status::ready)
    return Error{ErrorCode::kCellNotLive, "the host does not answer", {}};
  Result<std::string> got = answer.get();
  if (!got) return got.error();
  if (const auto read = recording::ReadFile(*got); !read) return read.error();
  const auto kept =
      needs_.store.AddProducts(job.id, {.artifacts = {{.name = std::string(kRecording),
                                                       .media_type = "application/octet-stream",
                                                       .bytes = *got}}});
  if (!kept) return kept.error();
  return got;
}

Status RunProducts::Play(const std::string& recording, const std::string& folder,
                         const std::stop_token& stop) {
  const Result<pid_t> process =
      StartChild({needs_.program, "--products", recording, "--into", folder, "--log-level",
                  needs_.log_level, "--log-format", needs_.log_format},
                 {});
  if (!process) return process.error();
  const auto until = std::chrono::steady_clock::now() + needs_.patience;
  int how = 0;
  while (::waitpid(*process, &how, WNOHANG) == 0) {
    if (stop.stop_requested() || std::chrono::steady_clock::now() > until) {
      ::kill(*process, SIGKILL);
      ::waitpid(*process, &how, 0);
      return Error{ErrorCode::kCellProcessorBudget, "it took too long to be played", {}};
    }
    std::this_thread::sleep_for(kLookAtProcess);
  }
  if (WIFEXITED(how) && WEXITSTATUS(how) == 0) return {};
  return Error{ErrorCode::kCellReplayDiffers, "its recording could not be played: see the log", {}};
}

// With what the report says of the part.
Status RunProducts::Store(const storage::JobRecord& job, const std::string& folder) {
  storage::LateProducts products;
  for (const Product& product : kProducts) {
    std::optional<std::string> bytes = ReadWhole(fs::path(folder) / product.name);
    if (!bytes) continue;
    products.artifacts.push_back(
        {.name = product.name, .media_type = product.media_type, .bytes = *std::move(bytes)});
  }
  v1::RunReport report;
  if (products.artifacts.empty() || !report.ParseFromString(products.artifacts.front().bytes))
    return Error{ErrorCode::kCellInternal, "no report was made", {}};
  v1::Outcome outcome;
  if (job.outcome) outcome = ToProto(*job.outcome);
  // A part is not made by a run that did not come to its end.
  if ((outcome.kind() == v1::Outcome::KIND_COMPLETED) !=
      (report.outcome().kind() == v1::Outcome::KIND_COMPLETED))
    return Error{ErrorCode::kCellReplayDiffers, "its recording ends otherwise than the job", {}};
  outcome.set_verdict(report.outcome().verdict());
  *outcome.mutable_reasons() = report.outcome().reasons();
  const storage::JobOutcome judged = OutcomeOf(outcome);
  products.judgement = judged.judgement;
  products.verdict = judged.verdict;
  v1::JobEvent event;
  event.mutable_products_made()->set_verdict(report.outcome().verdict());
  products.events.push_back(ToRecord(event));
  const auto stored = needs_.store.AddProducts(job.id, products);
  return stored ? Status() : Status(stored.error());
}

}  // namespace rmlcell::server
