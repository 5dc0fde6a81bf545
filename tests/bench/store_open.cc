// Opening a store, against SQLite that opens the same file and reads the newest job of it: row Q8
// of the goals. With a thousand jobs and with a million, finished or waiting.
//   bench_store_open [FOLDER [JOBS [ROUNDS]]]
#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "storage/sqlite/sqlite_store.h"

namespace {

using namespace rmlcell;
using namespace rmlcell::storage;
using SteadyClock = std::chrono::steady_clock;

constexpr int kTogether = 2'000;
constexpr double kGoal = 1.5;

double SecondsSince(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::unique_ptr<Store> Open(const std::string& path) {
  auto store = OpenSqliteStore({.path = path});
  if (!store) throw std::runtime_error(store.error().detail);
  return *std::move(store);
}

void Fill(const std::string& path, int jobs, bool finished) {
  const auto store = Open(path);
  for (int made = 0; made < jobs; made += kTogether) {
    std::atomic<int> answered = 0;
    for (int i = 0; i < kTogether; ++i) {
      store->Submit({.machine = "mill-1",
                     .family = "rml1",
                     .kind = "SIMULATE",
                     .specification = "what is to be done, in two hundred bytes or so of a message",
                     .events = {{.kind = "state", .payload = "queued"}},
                     .more_come = true},
                    [&](const Result<SubmittedJob>&) {
                      ++answered;
                      answered.notify_one();
                    });
    }
    for (int had = answered; had < kTogether; had = answered) answered.wait(had);
    if (!finished) continue;
    std::vector<std::int64_t> ids(kTogether);
    std::iota(ids.begin(), ids.end(), made + 1);
    const auto ended = store->ActOn(ids, QueueAct::kCancel, [](const JobRecord&) {
      return NewEvent{.kind = "ended", .payload = "cancelled"};
    });
    if (!ended) throw std::runtime_error(ended.error().detail);
  }
}

// Until the newest job has been read.
double OurSeconds(const std::string& path, std::int64_t newest) {
  const auto start = SteadyClock::now();
  const auto store = Open(path);
  if (!store->GetJob(newest)) throw std::runtime_error("the newest job is not there");
  return SecondsSince(start);
}

double SqliteSeconds(const std::string& path) {
  const auto start = SteadyClock::now();
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_exec(database, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr);
  int rows = 0;
  sqlite3_exec(
      database, "SELECT * FROM job ORDER BY id DESC LIMIT 1",
      [](void* count, int, char**, char**) { return ++*static_cast<int*>(count), 0; }, &rows,
      nullptr);
  const double seconds = SecondsSince(start);
  sqlite3_close(database);
  if (rows != 1) throw std::runtime_error("SQLite does not find the newest job");
  return seconds;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "bench-state";
  const int many = argc > 2 ? std::atoi(argv[2]) : 1'000'000;
  const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 7;
  bool reached = true;
  for (const bool finished : {true, false}) {
    for (const int jobs : {kTogether, many}) {
      std::filesystem::remove_all(folder);
      std::filesystem::create_directories(folder);
      const std::string path = (folder / "cell.db").string();
      const auto begun = SteadyClock::now();
      Fill(path, jobs, finished);
      const double filled = SecondsSince(begun);
      std::vector<double> ours, sqlite, ratio;
      for (int round = 0; round < rounds; ++round) {
        ours.push_back(OurSeconds(path, jobs) * 1e3);
        sqlite.push_back(SqliteSeconds(path) * 1e3);
        ratio.push_back(ours.back() / sqlite.back());
      }
      const bool good = Median(ratio) <= kGoal;
      std::printf(
          "%7d jobs that %s (made in %.0f s): opened in %.2f ms, by SQLite in %.2f ms: %.2f   goal: at most %.2f%s\n",
          jobs, finished ? "ended" : "wait", filled, Median(ours), Median(sqlite), Median(ratio),
          kGoal, good ? "" : "   MISSED");
      std::fflush(stdout);
      if (jobs == many) reached = reached && good;
    }
  }
  std::filesystem::remove_all(folder);
  return reached ? 0 : 1;
}
