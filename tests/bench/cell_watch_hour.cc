// A thousand watchers for an hour beside a cell that works: what they cost in memory and processor
// time, minute by minute, and whether each was told of everything.
//   bench_cell_watch_hour RMLCELLD [FOLDER [MINUTES]]
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "tests/bench/cell_watchers.h"

namespace {

using namespace rmlcell;
using namespace rmlcell::bench;

constexpr int kWatchers = 1000;
constexpr auto kJobEvery = std::chrono::seconds(5);
// From the tenth part of the time to the end: what the caches of the store may still take, 64 MiB
// of its writer and 8 MiB of each of four readers. They fill with what jobs leave.
constexpr double kGrowthMaxKiB = 96 * 1024;

void Submit(v1::JobService::Stub& jobs) {
  grpc::ClientContext context;
  v1::SubmitJobRequest request;
  v1::Job& job = *request.mutable_job();
  job.set_kind(v1::JOB_KIND_SIMULATE);
  job.set_machine("machines/mill-1");
  job.mutable_inline_program()->set_content("PA;PU100,100;PD900,100,900,900;PU0,0;");
  v1::Job made;
  Must(jobs.SubmitJob(&context, request, &made));
}

// As a watcher that comes later is told: all there is in the log.
std::int64_t EventsInLog(const CellServer& server, std::int64_t after, std::int64_t expected) {
  const auto stub = v1::CellService::NewStub(server.Connect());
  grpc::ClientContext context;
  const auto stream = stub->WatchCell(&context, AllJobs(after, true));
  v1::WatchCellResponse response;
  std::int64_t events = 0;
  while (events < expected && stream->Read(&response)) events += EventsIn(response);
  context.TryCancel();
  return events;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RMLCELLD [FOLDER [MINUTES]]\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argc > 2 ? argv[2] : "bench-state";
  const int minutes = argc > 3 ? std::max(1, std::atoi(argv[3])) : 60;
  const CellServer server(argv[1], folder / "cell", 1);
  const double before = server.MemoryKiB();
  const Watchers watchers(server, kWatchers, false, false);
  const auto jobs = v1::JobService::NewStub(server.Connect());
  double idle = server.ProcessorSeconds();
  std::this_thread::sleep_for(std::chrono::minutes(1));
  idle = server.ProcessorSeconds() - idle;
  std::printf("%d watchers: %.1f KiB each; a minute without events takes %.3f s of the processor\n",
              kWatchers, (server.MemoryKiB() - before) / kWatchers, idle);
  double first = 0.0, last = 0.0;
  std::int64_t submitted = 0;
  for (int minute = 1; minute <= minutes; ++minute) {
    const double used = server.ProcessorSeconds();
    const std::int64_t told = watchers.told();
    const auto until = Clock::now() + std::chrono::minutes(1);
    while (Clock::now() < until) {
      Submit(*jobs);
      ++submitted;
      std::this_thread::sleep_for(kJobEvery);
    }
    last = server.MemoryKiB();
    if (first == 0.0 && minute * 10 >= minutes) first = last;
    const double took = server.ProcessorSeconds() - used;
    const auto messages = static_cast<double>(watchers.told() - told);
    std::printf("minute %3d: %.0f KiB, %.2f s of the processor, %.0f messages, %.1f us each\n",
                minute, last, took, messages, messages > 0 ? took / messages * 1e6 : 0.0);
    std::fflush(stdout);
  }
  std::this_thread::sleep_for(std::chrono::seconds(5));
  const std::int64_t each = watchers.told() / kWatchers;
  const bool all = watchers.told() == each * kWatchers && EventsInLog(server, 0, each) == each;
  const bool steady = last - first <= kGrowthMaxKiB;
  std::printf(
      "%lld jobs, %lld events; every watcher was told of each: %s; memory grew by %.0f KiB%s\n",
      static_cast<long long>(submitted), static_cast<long long>(each), all ? "yes" : "NO",
      last - first, steady ? "" : "   MISSED");
  return all && steady ? 0 : 1;
}
