// A process that works with a store and tells, line by line on standard output, what was
// acknowledged; until somebody kills it, or it kills itself:
//
//   crash_child PATH RUN KEEP COUNT [kill|power OPERATION]
//
// RUN goes into the request ids, KEEP is keep_finished_jobs, COUNT the number of jobs of each
// client.
//
//   S <request id> <job>      submitted
//   E <job> <sequence>        its events up to this one are written
//   F <job> <state>           ended
//   P <slot> <revision>       program put
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "storage/sqlite/sqlite_store.h"
#include "tests/storage/crash_scenario.h"
#include "tests/storage/faulty_disk.h"

namespace rmlcell::storage {
namespace {

// One write(2) for a line: it arrives whole, or not at all.
void Tell(const std::string& line) {
  const std::string text = line + "\n";
  if (write(STDOUT_FILENO, text.data(), text.size()) < 0) _exit(3);
}

void SubmitJobs(Store& store, const std::string& run, int client, int count) {
  for (int i = 0; i < count; ++i) {
    const std::string id = crash::RequestId(run, client, i);
    const auto submitted = store.SubmitAndWait(crash::JobOf(id));
    if (!submitted) _exit(4);
    Tell("S " + id + " " + std::to_string(submitted->job.id));
  }
}

// Some jobs are finished, some given back, some left to their fate.
void Work(Store& store, unsigned seed, const std::atomic<bool>& done) {
  std::mt19937 random(seed);
  const LossPolicy policy{.outcome = {.state = JobState::kFailed},
                          .requeued = {{.kind = "requeued"}},
                          .ended = {{.kind = "ended"}}};
  for (;;) {
    const bool last = done;
    const auto leased =
        store.Acquire("child", {"SIMULATE"}, std::chrono::milliseconds(20), {{.kind = "running"}});
    if (!leased) _exit(5);
    if (!*leased) {
      if (last) return;
      if (!store.Expire(policy)) _exit(6);
      continue;
    }
    const Lease& lease = (*leased)->lease;
    const std::string job = std::to_string(lease.job);
    const auto appended = store.AppendAndWait(
        lease, {{.kind = "step", .payload = job}, {.kind = "step", .payload = job}});
    if (appended) Tell("E " + job + " " + std::to_string(*appended));
    switch (random() % 4) {
      case 0:
        break;
      case 1:
        static_cast<void>(store.HandBack(lease, policy));
        break;
      default: {
        const auto ended = store.Finish(
            lease, {.artifacts = {{.name = "report", .bytes = crash::ReportOf(lease.job)}},
                    .events = {{.kind = "ended"}}});
        if (ended) Tell("F " + job + " " + std::to_string(static_cast<int>(ended->state)));
      }
    }
  }
}

void PutPrograms(Store& store, const std::atomic<bool>& done) {
  if (!store.PutMachine({.id = "m"}, kAnyRevision)) _exit(7);
  for (int i = 0; !done; ++i) {
    const int slot = 1 + i % 3;
    const auto before = store.GetProgram("m", slot);
    const Revision next = before ? before->revision + 1 : 1;
    const auto put =
        store.PutPrograms("m", {{.slot = slot, .object = crash::ObjectOf(slot, next)}}, {});
    if (!put) _exit(8);
    Tell("P " + std::to_string(slot) + " " + std::to_string(put->front().revision));
  }
}

int Main(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::string run = argv[2];
  const int count = std::atoi(argv[4]);
  SqliteOptions options{.path = argv[1]};
  options.keep_finished_jobs = std::atoll(argv[3]);
  if (argc > 6) {
    faulty_disk::Register();
    options.vfs = faulty_disk::kName;
    faulty_disk::CrashAt(std::atoll(argv[6]), std::string(argv[5]) == "power"
                                                  ? faulty_disk::Crash::kPowerCut
                                                  : faulty_disk::Crash::kKill);
  }
  Result<std::unique_ptr<Store>> store = OpenSqliteStore(options);
  if (!store) {
    Tell("! " + store.error().detail);
    return 9;
  }
  std::atomic<bool> done = false;
  constexpr int kClients = 4;
  std::jthread programs([&] { PutPrograms(**store, done); });
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < 2; ++i) {
    workers.emplace_back([&, i] { Work(**store, i, done); });
  }
  {
    std::vector<std::jthread> submitters;
    for (int i = 0; i < kClients; ++i) {
      submitters.emplace_back([&, i] { SubmitJobs(**store, run, i, count); });
    }
  }
  done = true;
  workers.clear();
  programs.join();
  store->reset();
  Tell("D " + std::to_string(faulty_disk::Operations()));
  return 0;
}

}  // namespace
}  // namespace rmlcell::storage

int main(int argc, char** argv) { return rmlcell::storage::Main(argc, argv); }
