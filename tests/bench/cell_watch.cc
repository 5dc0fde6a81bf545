// What it costs to tell many watchers, against streams of gRPC that only send the same bytes again
// and again: rows A2 to A5 and A7 of the goals. All in one run, turn by turn, so that only ratios
// count.
//   bench_cell_watch RMLCELLD [FOLDER [ROUNDS]]
#include <grpcpp/grpcpp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <functional>
#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/bench/cell_server.h"
#include "tests/bench/cell_watchers.h"
#include "tests/bench/goals.h"

namespace {

using namespace rmlcell;
using namespace rmlcell::bench;
using Response = v1::WatchCellResponse;

constexpr int kWatchers = 100;
constexpr int kEvents = 2000;  // that each is told
constexpr std::int64_t kUnansweredMax = 256;
constexpr auto kRateTime = std::chrono::seconds(2);
constexpr int kPacedRate = 1000;  // events a second, for their age
constexpr auto kPacedTime = std::chrono::seconds(3);
constexpr int kStopped = 10;
constexpr int kIdle = 1000;

// As many messages as were told of, each the same bytes: what gRPC can do.
class BareWatch final : public grpc::ServerWriteReactor<grpc::ByteBuffer> {
 public:
  BareWatch(const std::string& bytes, int count, std::atomic<bool>& open)
      : left_(count), open_(open) {
    const grpc::Slice slice(bytes);
    message_ = grpc::ByteBuffer(&slice, 1);
    // All begin together, as watchers of one cell are told together.
    starter_ = std::jthread([this] {
      open_.wait(false);
      Next();
    });
  }

 private:
  void Next() {
    if (left_-- > 0) return StartWrite(&message_);
    Finish(grpc::Status::OK);
  }
  void OnWriteDone(bool ok) override {
    if (ok) return Next();
    Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override { delete this; }

  int left_;
  std::atomic<bool>& open_;
  grpc::ByteBuffer message_;
  std::jthread starter_;
};

class BareServer final
    : public v1::CellService::WithRawCallbackMethod_WatchCell<v1::CellService::Service> {
 public:
  explicit BareServer(std::string bytes) : bytes_(std::move(bytes)) {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchCell(grpc::CallbackServerContext*,
                                                        const grpc::ByteBuffer*) override {
    return new BareWatch(bytes_, kEvents, open_);
  }
  std::shared_ptr<grpc::Channel> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments);
  }
  void Begin() {
    open_ = true;
    open_.notify_all();
  }
  void Again() { open_ = false; }

 private:
  std::string bytes_;
  std::string address_;
  std::atomic<bool> open_ = false;
  std::unique_ptr<grpc::Server> server_;
};

// Jobs that are held, one event each, for `time`, or `count` of them; at `rate` a second where one
// is given. How many a second were acknowledged.
double Submit(const CellServer& server, std::optional<std::chrono::milliseconds> time,
              std::int64_t count, double rate = 0.0) {
  const auto stub = v1::JobService::NewStub(server.Connect());
  grpc::ClientContext context;
  const auto stream = stub->SubmitJobs(&context);
  std::atomic<std::int64_t> answered = 0;
  std::thread reader([&] {
    for (v1::SubmitJobsResponse response; stream->Read(&response);) {
      ++answered;
      answered.notify_one();
    }
  });
  const auto start = Clock::now();
  for (std::int64_t number = 1; number <= count; ++number) {
    if (time && Clock::now() - start > *time) break;
    if (rate > 0.0)
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(static_cast<double>(number) / rate)));
    // What lies in buffers on the way would be submitted long after the time.
    for (std::int64_t had = answered; number - had > kUnansweredMax; had = answered)
      answered.wait(had);
    if (!stream->Write(Held(number))) break;
  }
  stream->WritesDone();
  reader.join();
  Must(stream->Finish());
  return static_cast<double>(answered) / SecondsSince(start);
}

std::int64_t LastSequence(const CellServer& server) {
  const auto stub = v1::CellService::NewStub(server.Connect());
  grpc::ClientContext context;
  const auto stream = stub->WatchCell(&context, AllJobs(std::nullopt, false));
  Response response;
  stream->Read(&response);
  context.TryCancel();
  return response.sequence();
}

// Events a second that so many watchers were told together, of kEvents each.
double Told(const std::function<std::shared_ptr<grpc::Channel>()>& connect, int watchers,
            const v1::WatchCellRequest& request, const std::function<void()>& begin) {
  std::vector<std::jthread> threads;
  std::latch ready(watchers + 1);
  std::vector<Clock::time_point> first(static_cast<std::size_t>(watchers));
  std::vector<Clock::time_point> last(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    threads.emplace_back([&, i] {
      const auto stub = v1::CellService::NewStub(connect());
      grpc::ClientContext context;
      context.set_wait_for_ready(true);
      ready.arrive_and_wait();
      const auto stream = stub->WatchCell(&context, request);
      Response response;
      int told = 0;
      while (told < kEvents && stream->Read(&response)) {
        const int more = EventsIn(response);
        if (told == 0 && more > 0) first[i] = Clock::now();
        told += more;
      }
      last[i] = Clock::now();
      context.TryCancel();
      if (told < kEvents) std::fprintf(stderr, "a watcher was told %d of %d\n", told, kEvents);
    });
  }
  ready.arrive_and_wait();
  begin();
  threads.clear();
  const double seconds = std::chrono::duration<double>(*std::ranges::max_element(last) -
                                                       *std::ranges::min_element(first))
                             .count();
  return watchers * kEvents / seconds;
}

// What was measured, a value each round.
struct Figures {
  std::vector<double> single, batched, stalled;
  std::vector<double> submit, submit_batched, submit_browsers;
  std::vector<double> alone_age, p50, p99;
  double watcher_kib = 0.0;
  double browser_kib = 0.0;
};

// One message as it is told: the bare stream sends as many bytes.
Response SampleOf(const CellServer& server, std::int64_t after) {
  const auto stub = v1::CellService::NewStub(server.Connect());
  grpc::ClientContext context;
  const auto stream = stub->WatchCell(&context, AllJobs(after, false));
  Response sample;
  while (stream->Read(&sample) && !sample.has_event()) continue;
  context.TryCancel();
  return sample;
}

void MeasureTelling(const char* program, const std::filesystem::path& folder, int rounds,
                    Figures& figures) {
  const CellServer server(program, folder, 0);
  const std::int64_t before = LastSequence(server);
  Submit(server, std::nullopt, kEvents);
  const auto connect = [&] { return server.Connect(); };
  const Response sample = SampleOf(server, before);
  std::printf("an event is a message of %zu bytes\n", sample.ByteSizeLong());
  BareServer bare(sample.SerializeAsString());
  for (int round = 0; round < rounds; ++round) {
    bare.Again();
    const double limit = Told([&] { return bare.Connect(); }, kWatchers, {},
                              [&] {
                                std::this_thread::sleep_for(std::chrono::milliseconds(200));
                                bare.Begin();
                              });
    const double ours = Told(connect, kWatchers, AllJobs(before, false), [] {});
    const double many = Told(connect, kWatchers, AllJobs(before, true), [] {});
    double with_stalled = 0.0;
    {
      std::vector<std::unique_ptr<Stalled>> asleep;
      for (int i = 0; i < kStopped; ++i)
        asleep.push_back(std::make_unique<Stalled>(server, before));
      with_stalled = Told(connect, kWatchers, AllJobs(before, false), [] {});
    }
    figures.single.push_back(ours / limit);
    figures.batched.push_back(many / limit);
    figures.stalled.push_back(with_stalled / ours);
    std::printf(
        "round %d: bare %8.0f/s  ours %8.0f/s  batched %9.0f/s  beside %d that stopped %8.0f/s\n",
        round + 1, limit, ours, many, kStopped, with_stalled);
  }
}

std::vector<double> AgesOf(const CellServer& server, int watchers, double rate) {
  Watchers watching(server, watchers, true, true);
  Submit(server, kPacedTime, 1'000'000, rate);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  return watching.Stop();
}

void MeasureSubmitting(const CellServer& server, int round, Figures& figures) {
  figures.alone_age.push_back(Median(AgesOf(server, 1, 50.0)) * 1e3);
  const std::vector<double> ages = AgesOf(server, kWatchers, kPacedRate);
  figures.p50.push_back(Quantile(ages, 0.5) * 1e3);
  figures.p99.push_back(Quantile(ages, 0.99) * 1e3);
  const double alone = Submit(server, kRateTime, 1'000'000);
  const auto beside_watchers = [&](bool batched) {
    Watchers watchers(server, kWatchers, batched, false);
    return Submit(server, kRateTime, 1'000'000);
  };
  const double beside = beside_watchers(false);
  const double beside_batched = beside_watchers(true);
  double beside_browsers = 0.0;
  {
    Browsers browsers(server, kWatchers);
    beside_browsers = Submit(server, kRateTime, 1'000'000);
  }
  figures.submit.push_back(beside / alone);
  figures.submit_batched.push_back(beside_batched / alone);
  figures.submit_browsers.push_back(beside_browsers / alone);
  std::printf(
      "round %d: age, one watcher %.2f ms; %d at %d/s p50 %.2f p99 %.2f ms; submits/s alone %.0f, "
      "beside %d watchers %.0f, batched %.0f, browsers %.0f\n",
      round + 1, figures.alone_age.back(), kWatchers, kPacedRate, figures.p50.back(),
      figures.p99.back(), alone, kWatchers, beside, beside_batched, beside_browsers);
}

void MeasureIdle(const CellServer& server, Figures& figures) {
  const double before = server.MemoryKiB();
  {
    const Watchers watchers(server, kIdle, false, false);
    figures.watcher_kib = (server.MemoryKiB() - before) / kIdle;
  }
  const double between = server.MemoryKiB();
  const Browsers browsers(server, kIdle);
  figures.browser_kib = (server.MemoryKiB() - between) / kIdle;
}

bool Print(const Figures& figures) {
  const bool rows[] = {
      Row("100 watchers, an event a message / bare streams", figures.single, 0.7, true),
      Row("100 watchers, batched, events / bare streams", figures.batched, 3.0, true),
      Row("100 watchers beside 10 that stopped / without them", figures.stalled, 0.95, true),
      Row("age of an event, 1,000/s, 100 watchers: p50, ms", figures.p50, 1.0, false),
      Row("the same: p99, ms", figures.p99, 5.0, false),
      Row("submits/s beside 100 watchers / alone", figures.submit, 0.8, true),
      Row("submits/s beside 100 watchers that take batches / alone", figures.submit_batched, 0.8,
          true),
      Row("submits/s beside 100 browsers / alone", figures.submit_browsers, 0.8, true),
      Row("1,000 idle watchers: KiB each", {figures.watcher_kib}, 64.0, false),
      Row("1,000 idle browsers: KiB each", {figures.browser_kib}, 64.0, false)};
  return std::ranges::all_of(rows, [](bool reached) { return reached; });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RMLCELLD [FOLDER [ROUNDS]]\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argc > 2 ? argv[2] : "bench-state";
  const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 5;
  Figures figures;
  MeasureTelling(argv[1], folder / "cell", rounds, figures);
  for (int round = 0; round < rounds; ++round) {
    const CellServer server(argv[1], folder / "cell", 0);
    MeasureSubmitting(server, round, figures);
  }
  {
    const CellServer server(argv[1], folder / "cell", 0);
    MeasureIdle(server, figures);
  }
  std::filesystem::remove_all(folder);
  return Print(figures) ? 0 : 1;
}
