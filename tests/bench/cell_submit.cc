// What a durable job costs over gRPC, against what it cannot be cheaper than: a commit of SQLite
// that waits for the disk, and a call that does nothing. All in one run, turn by turn, so that only
// ratios count.
//   bench_cell_submit RMLCELLD [FOLDER [ROUNDS]]
#include <grpcpp/grpcpp.h>
#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <latch>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "grpc/health/v1/health.grpc.pb.h"
#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/bench/cell_server.h"
#include "tests/bench/goals.h"

namespace {

using namespace rmlcell::bench;

constexpr int kCallsOfARound = 150;
constexpr int kClients = 64;
constexpr auto kRateTime = std::chrono::milliseconds(1000);
constexpr int kJobsToTheEnd = 1000;

// One durable row of the size of a small job.
class RawStore {
 public:
  explicit RawStore(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    sqlite3_open((folder / "raw.db").c_str(), &handle_);
    Execute(
        "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; CREATE TABLE IF NOT EXISTS row (content BLOB)");
    sqlite3_prepare_v2(handle_, "INSERT INTO row VALUES (zeroblob(400))", -1, &insert_, nullptr);
  }
  RawStore(const RawStore&) = delete;
  RawStore& operator=(const RawStore&) = delete;
  ~RawStore() {
    sqlite3_finalize(insert_);
    sqlite3_close(handle_);
  }
  void Commit() {
    if (sqlite3_step(insert_) != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(handle_));
    sqlite3_reset(insert_);
  }
  // So many rows in one transaction.
  void CommitMany(int rows) {
    Execute("BEGIN IMMEDIATE");
    for (int i = 0; i < rows; ++i) Commit();
    Execute("COMMIT");
  }

 private:
  void Execute(const char* sql) {
    if (sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
      throw std::runtime_error(sqlite3_errmsg(handle_));
    }
  }
  sqlite3* handle_ = nullptr;
  sqlite3_stmt* insert_ = nullptr;
};

struct Client {
  explicit Client(const std::shared_ptr<grpc::Channel>& channel)
      : jobs(rmlcell::v1::JobService::NewStub(channel)),
        health(grpc::health::v1::Health::NewStub(channel)) {}

  static rmlcell::v1::SubmitJobRequest SmallJob() {
    rmlcell::v1::SubmitJobRequest request;
    rmlcell::v1::Job& job = *request.mutable_job();
    job.set_kind(rmlcell::v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("square.rml");
    job.mutable_inline_program()->set_content(
        "PA;PA;VS8;!VZ4;!PZ0,200;!MC1;PU100,100;PD900,100,900,900;PU0,0;H;");
    return request;
  }

  std::string Submit() {
    const rmlcell::v1::SubmitJobRequest request = SmallJob();
    grpc::ClientContext context;
    rmlcell::v1::Job made;
    Must(jobs->SubmitJob(&context, request, &made));
    return made.name();
  }
  void Empty() {
    grpc::ClientContext context;
    grpc::health::v1::HealthCheckResponse response;
    Must(health->Check(&context, {}, &response));
  }

  std::unique_ptr<rmlcell::v1::JobService::Stub> jobs;
  std::unique_ptr<grpc::health::v1::Health::Stub> health;
};

double MedianSeconds(const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i < kCallsOfARound; ++i) {
    const auto start = Clock::now();
    work();
    times.push_back(SecondsSince(start));
  }
  return Median(std::move(times));
}

double RateOfClients(std::vector<Client>& clients, const std::function<void(Client&)>& work) {
  std::vector<std::thread> threads;
  std::vector<std::int64_t> counts(clients.size());
  const auto start = Clock::now();
  for (std::size_t i = 0; i < clients.size(); ++i) {
    threads.emplace_back([&, i] {
      while (Clock::now() - start < kRateTime) {
        work(clients[i]);
        ++counts[i];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::int64_t all = 0;
  for (const std::int64_t count : counts) all += count;
  return static_cast<double>(all) / SecondsSince(start);
}

double RateOfCommits(RawStore& raw) {
  const auto start = Clock::now();
  int count = 0;
  while (Clock::now() - start < kRateTime) {
    raw.Commit();
    ++count;
  }
  return count / SecondsSince(start);
}

constexpr int kInOneTransaction = 32;

// Rows a second, so many in each transaction.
double RateOfRows(RawStore& raw) {
  const auto start = Clock::now();
  int count = 0;
  while (Clock::now() - start < kRateTime) {
    raw.CommitMany(kInOneTransaction);
    count += kInOneTransaction;
  }
  return count / SecondsSince(start);
}

// Jobs a second over one SubmitJobs, each acknowledged when it is durable; the next one is sent
// when the server reads on.
double RateOfStream(const CellServer& server) {
  Client client(server.Connect());
  grpc::ClientContext context;
  const auto stream = client.jobs->SubmitJobs(&context);
  std::int64_t answered = 0;
  const auto start = Clock::now();
  std::thread reader([&] {
    rmlcell::v1::SubmitJobsResponse response;
    while (stream->Read(&response)) {
      if (!response.job().empty()) ++answered;
    }
  });
  rmlcell::v1::SubmitJobsRequest request;
  *request.mutable_submission() = Client::SmallJob();
  for (std::int64_t number = 1; Clock::now() - start < kRateTime; ++number) {
    request.set_number(number);
    if (!stream->Write(request)) break;
  }
  stream->WritesDone();
  reader.join();
  const double seconds = SecondsSince(start);
  Must(stream->Finish());
  return static_cast<double>(answered) / seconds;
}

// One watcher of all jobs; what it is told of ends.
class Ends {
 public:
  explicit Ends(const CellServer& server) {
    const auto stub = rmlcell::v1::CellService::NewStub(server.Connect());
    rmlcell::v1::WatchCellRequest request;
    rmlcell::v1::Subscription& jobs = *request.add_subscriptions();
    jobs.set_id("jobs");
    jobs.mutable_jobs()->set_events_only(true);
    request.set_batched(true);
    std::latch ready(1);
    reader_ = std::thread([this, &ready, stream = stub->WatchCell(&context_, request)] {
      rmlcell::v1::WatchCellResponse response;
      stream->Read(&response);
      ready.count_down();
      while (stream->Read(&response)) {
        for (const auto& event : response.events().events()) Note(event);
        if (response.has_event()) Note(response.event());
      }
    });
    ready.wait();
  }
  Ends(const Ends&) = delete;
  Ends& operator=(const Ends&) = delete;
  ~Ends() {
    context_.TryCancel();
    reader_.join();
  }
  void WaitFor(std::int64_t count) const {
    for (std::int64_t had = ended_; had < count; had = ended_) ended_.wait(had);
  }

 private:
  void Note(const rmlcell::v1::CellEvent& event) {
    if (!event.job().has_ended()) return;
    ++ended_;
    ended_.notify_all();
  }
  grpc::ClientContext context_;
  std::thread reader_;
  std::atomic<std::int64_t> ended_ = 0;
};

// From the submission until a watcher is told of the end, report and picture included.
double LoneJob(const CellServer& server) {
  Client client(server.Connect());
  std::vector<double> times;
  const Ends ends(server);
  for (int i = 0; i < kCallsOfARound; ++i) {
    const auto start = Clock::now();
    client.Submit();
    ends.WaitFor(i + 1);
    times.push_back(SecondsSince(start));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return Median(std::move(times));
}

// From the first submission, over one stream, to the end of the last job.
double JobsToTheEnd(const CellServer& server) {
  Client client(server.Connect());
  const Ends ends(server);
  const auto start = Clock::now();
  grpc::ClientContext context;
  const auto stream = client.jobs->SubmitJobs(&context);
  std::thread reader([&] {
    for (rmlcell::v1::SubmitJobsResponse response; stream->Read(&response);) {
    }
  });
  rmlcell::v1::SubmitJobsRequest request;
  *request.mutable_submission() = Client::SmallJob();
  for (int i = 1; i <= kJobsToTheEnd; ++i) {
    request.set_number(i);
    stream->Write(request);
  }
  stream->WritesDone();
  reader.join();
  Must(stream->Finish());
  ends.WaitFor(kJobsToTheEnd);
  return kJobsToTheEnd / SecondsSince(start);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RMLCELLD [FOLDER [ROUNDS]]\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argc > 2 ? argv[2] : "bench-state";
  const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 7;
  RawStore raw(folder / "raw");
  std::vector<double> latency, share_of_empty, share_of_commits, share_of_rows, to_the_end, lone;
  {
    const CellServer server(argv[1], folder / "cell", 0);
    Client one(server.Connect());
    std::vector<Client> many;
    for (int i = 0; i < kClients; ++i) many.emplace_back(server.Connect());
    std::printf(
        "round  commit us  empty us  submit us  ratio | 64 clients: empty/s  submit/s  commits/s  ratio\n");
    for (int round = 0; round < rounds; ++round) {
      const double commit = MedianSeconds([&] { raw.Commit(); });
      const double empty = MedianSeconds([&] { one.Empty(); });
      const double submit = MedianSeconds([&] { one.Submit(); });
      const double empties = RateOfClients(many, [](Client& client) { client.Empty(); });
      const double submits = RateOfClients(many, [](Client& client) { client.Submit(); });
      const double commits = RateOfCommits(raw);
      const double rows = RateOfRows(raw);
      const double streamed = RateOfStream(server);
      share_of_rows.push_back(streamed / rows);
      std::printf("       by stream: submit/s %8.0f  rows/s, 32 a transaction %8.0f  ratio %5.2f\n",
                  streamed, rows, streamed / rows);
      latency.push_back(submit / (commit + empty));
      share_of_empty.push_back(submits / empties);
      share_of_commits.push_back(submits / commits);
      std::printf("%5d  %9.0f  %8.0f  %9.0f  %5.2f | %19.0f  %8.0f  %9.0f  %5.2f\n", round + 1,
                  commit * 1e6, empty * 1e6, submit * 1e6, latency.back(), empties, submits,
                  commits, share_of_empty.back());
    }
  }
  for (int round = 0; round < rounds; ++round) {
    const CellServer server(argv[1], folder / "cell", 2);
    const double commits = RateOfCommits(raw);
    lone.push_back(LoneJob(server) * 1e3);
    to_the_end.push_back(JobsToTheEnd(server));
    std::printf("round %d: %.0f durable jobs/s to the end, a lone one %.2f ms, %.0f commits/s\n",
                round + 1, to_the_end.back(), lone.back(), commits);
  }
  const bool reached[] = {
      Row("Q1: submit latency / (commit + empty call)", latency, 1.2, false),
      Row("Q2: submit rate / empty calls, 64 clients", share_of_empty, 0.8, true),
      Row("Q2: submit rate / single commits, 64 clients", share_of_commits, 1.2, true),
      Row("Q3: submit by stream / rows, 32 a transaction", share_of_rows, 0.5, true),
      Row("E1: small jobs to the end, a second", to_the_end, 1000.0, true),
      Row("E1: a lone small job, from submission to its end, ms", lone, 2.0, false)};
  std::filesystem::remove_all(folder);
  return std::ranges::all_of(reached, [](bool one) { return one; }) ? 0 : 1;
}
