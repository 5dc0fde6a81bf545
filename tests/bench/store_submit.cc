// Claim: submitting to the embedded store costs one caller about as much as one bare commit of
// SQLite, and 64 callers together get many times the rate of bare commits, because they share them.
//
// The peer is measured in the same run: a table with one small row a commit, WAL, synchronous=FULL.
// Rounds are interleaved; medians are told. Usage: store_submit [SECONDS_PER_PART] [ROUNDS]
#include <sqlite3.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/check.h"
#include "storage/sqlite/sqlite_store.h"

namespace rmlcell::storage {
namespace {

using Seconds = std::chrono::duration<double>;
using SteadyClock = std::chrono::steady_clock;

struct Rate {
  double per_second = 0.0;
  double median_us = 0.0;  // of one call
  double processor_us =
      0.0;  // of this process for each call: says more than the rate on a busy machine
};

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double ProcessorSeconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// `call` again and again from `callers` threads, for `duration`.
Rate Measure(int callers, Seconds duration, const std::function<void(int caller, int turn)>& call) {
  std::vector<std::vector<double>> times(static_cast<std::size_t>(callers));
  const double processor = ProcessorSeconds();
  const auto start = SteadyClock::now();
  {
    std::vector<std::jthread> threads;
    for (int caller = 0; caller < callers; ++caller) {
      threads.emplace_back([&, caller] {
        for (int turn = 0; SteadyClock::now() - start < duration; ++turn) {
          const auto begin = SteadyClock::now();
          call(caller, turn);
          times[static_cast<std::size_t>(caller)].push_back(
              std::chrono::duration<double, std::micro>(SteadyClock::now() - begin).count());
        }
      });
    }
  }
  const double elapsed = Seconds(SteadyClock::now() - start).count();
  std::vector<double> all;
  for (const std::vector<double>& own : times) all.insert(all.end(), own.begin(), own.end());
  const auto calls = static_cast<double>(all.size());
  return {.per_second = calls / elapsed,
          .median_us = Median(all),
          .processor_us = (ProcessorSeconds() - processor) * 1e6 / calls};
}

class BareSqlite {
 public:
  explicit BareSqlite(const std::string& path) {
    RMLCELL_CHECK(sqlite3_open(path.c_str(), &database_) == SQLITE_OK);
    Run("PRAGMA journal_mode = WAL");
    Run("PRAGMA synchronous = FULL");
    Run("CREATE TABLE job (id INTEGER PRIMARY KEY, specification BLOB)");
    RMLCELL_CHECK(sqlite3_prepare_v2(database_, "INSERT INTO job (specification) VALUES (?1)", -1,
                                     &insert_, nullptr) == SQLITE_OK);
  }
  BareSqlite(const BareSqlite&) = delete;
  BareSqlite& operator=(const BareSqlite&) = delete;
  ~BareSqlite() {
    sqlite3_finalize(insert_);
    sqlite3_close(database_);
  }
  void Insert(const std::string& bytes) {
    sqlite3_bind_blob64(insert_, 1, bytes.data(), bytes.size(), nullptr);
    RMLCELL_CHECK(sqlite3_step(insert_) == SQLITE_DONE);
    sqlite3_reset(insert_);
  }

 private:
  void Run(const char* sql) {
    RMLCELL_CHECK(sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  }
  sqlite3* database_ = nullptr;
  sqlite3_stmt* insert_ = nullptr;
};

// As the server makes them: a program attached, one event.
NewJob JobOf(int round, int caller, int turn) {
  const std::string number =
      std::to_string(round) + "-" + std::to_string(caller) + "-" + std::to_string(turn);
  return NewJob{.request_id = "",
                .request_hash = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
                .machine = "optimo-1",
                .kind = "SIMULATE",
                .title = "part " + number,
                .caller = "local",
                .specification = std::string(200, 's'),
                .attachments = {{.name = "program",
                                 .media_type = "application/octet-stream",
                                 .bytes = std::string(300, 'p') + number,
                                 .existing_sha256 = {}}},
                .events = {{.kind = "state", .payload = std::string("\x08\x01")}}};
}

int Main(int argc, char** argv) {
  const Seconds part(argc > 1 ? std::atof(argv[1]) : 1.0);
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / ("store_submit-" + std::to_string(getpid()));
  std::filesystem::create_directories(directory);
  {
    BareSqlite bare((directory / "bare.db").string());
    const Result<std::unique_ptr<Store>> store =
        OpenSqliteStore({.path = (directory / "cell.db").string()});
    if (!store) {
      std::fprintf(stderr, "%s\n", store.error().detail.c_str());
      return 1;
    }
    const std::string small(200, 's');
    std::vector<double> bare_us;
    std::vector<double> one_us;
    std::vector<double> latency_ratio;
    std::vector<double> many_rate;
    std::vector<double> rate_ratio;
    for (int round = 0; round < rounds; ++round) {
      const auto submit = [&](int caller, int turn) {
        RMLCELL_CHECK((*store)->SubmitAndWait(JobOf(round, caller, turn)).has_value());
      };
      const Rate commits = Measure(1, part, [&](int, int) { bare.Insert(small); });
      const Rate one = Measure(1, part, submit);
      const Rate many = Measure(64, part, submit);
      std::printf(
          "round %d: bare commit %.0f us (%.0f/s), one caller %.0f us (%.0f/s), 64 callers %.0f/s\n"
          "  processor time of a call: %.1f, %.1f, %.1f us\n",
          round + 1, commits.median_us, commits.per_second, one.median_us, one.per_second,
          many.per_second, commits.processor_us, one.processor_us, many.processor_us);
      bare_us.push_back(commits.median_us);
      one_us.push_back(one.median_us);
      latency_ratio.push_back(one.median_us / commits.median_us);
      many_rate.push_back(many.per_second);
      rate_ratio.push_back(many.per_second / commits.per_second);
    }
    std::printf(
        "{\"bench\":\"store_submit\",\"rounds\":%d,\"bare_commit_us\":%.1f,"
        "\"one_caller_us\":%.1f,\"one_caller_to_bare\":%.3f,"
        "\"submits_per_s_64\":%.0f,\"rate_64_to_bare\":%.2f}\n",
        rounds, Median(bare_us), Median(one_us), Median(latency_ratio), Median(many_rate),
        Median(rate_ratio));
  }
  std::filesystem::remove_all(directory);
  return 0;
}

}  // namespace
}  // namespace rmlcell::storage

int main(int argc, char** argv) { return rmlcell::storage::Main(argc, argv); }
