// What it costs to ask how things stand, against calls that do nothing: rows A1 and Q7 of the
// goals. All in one run, turn by turn, so that only ratios count.
//   bench_cell_status RMLCELLD [FOLDER [ROUNDS]]
#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "tests/bench/cell_server.h"
#include "tests/bench/goals.h"

namespace {

using namespace rmlcell;
using namespace rmlcell::bench;

constexpr auto kTime = std::chrono::milliseconds(1500);
constexpr int kSubmitters = 64;
constexpr int kReaders = 4;  // beside them

// A server of gRPC in a process of its own whose calls do nothing.
class BareServer {
 public:
  BareServer() {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) Serve(ends[1]);
    int port = 0;
    if (read(ends[0], &port, sizeof port) != sizeof port) throw std::runtime_error("no port");
    close(ends[0]);
    close(ends[1]);
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;
  ~BareServer() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  std::shared_ptr<grpc::Channel> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments);
  }

 private:
  class Nothing final : public v1::JobService::CallbackService {
    grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context, const v1::GetJobRequest*,
                                     v1::Job*) override {
      grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
      reactor->Finish(grpc::Status::OK);
      return reactor;
    }
  };
  [[noreturn]] static void Serve(int tell) {
    Nothing nothing;
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&nothing);
    const auto server = builder.BuildAndStart();
    if (write(tell, &port, sizeof port) != sizeof port) _exit(1);
    server->Wait();
    _exit(0);
  }
  std::string address_;
  pid_t process_ = 0;
};

v1::SubmitJobRequest Simulation(double pace) {
  v1::SubmitJobRequest request;
  v1::Job& job = *request.mutable_job();
  job.set_kind(v1::JOB_KIND_SIMULATE);
  job.set_machine("machines/mill-1");
  if (pace > 0.0) job.mutable_simulation()->set_pace(pace);
  job.mutable_inline_program()->set_file_name("square.rml");
  std::string program = "PA;PA;VS8;!VZ4;!PZ0,200;!MC1;";
  for (int i = 0; i < 50; ++i) program += "PU100,100;PD9000,100,9000,9000;PU0,0;";
  job.mutable_inline_program()->set_content(program + "H;");
  return request;
}

std::string Submit(v1::JobService::Stub& jobs, const v1::SubmitJobRequest& request) {
  grpc::ClientContext context;
  v1::Job made;
  Must(jobs.SubmitJob(&context, request, &made));
  return made.name();
}

v1::Job Get(v1::JobService::Stub& jobs, const std::string& name) {
  grpc::ClientContext context;
  v1::GetJobRequest request;
  request.set_name(name);
  v1::Job job;
  Must(jobs.GetJob(&context, request, &job));
  return job;
}

struct Calls {
  double per_second = 0.0;
  double p99 = 0.0;  // seconds
};

// So many clients, each with a connection of its own, each asking again when it has its answer.
Calls Ask(
    const std::function<std::shared_ptr<grpc::Channel>()>& connect, int clients,
    const std::function<void(const std::shared_ptr<grpc::Channel>&,
                             const std::function<void(const std::function<void()>&)>&)>& one) {
  std::vector<std::vector<double>> took(static_cast<std::size_t>(clients));
  const auto start = Clock::now();
  {
    std::vector<std::jthread> threads;
    for (std::vector<double>& times : took) {
      threads.emplace_back([&] {
        one(connect(), [&](const std::function<void()>& call) {
          call();  // which connects
          while (Clock::now() - start < kTime) {
            const auto asked = Clock::now();
            call();
            times.push_back(SecondsSince(asked));
          }
        });
      });
    }
  }
  std::vector<double> all;
  for (const std::vector<double>& times : took) all.insert(all.end(), times.begin(), times.end());
  const double count = static_cast<double>(all.size());
  return {count / SecondsSince(start), Quantile(std::move(all), 0.99)};
}

template <class Connect>
Calls AskJob(const Connect& connect, int clients, const std::string& name) {
  return Ask(connect, clients, [&](const auto& channel, const auto& repeat) {
    const auto jobs = v1::JobService::NewStub(channel);
    repeat([&] { Get(*jobs, name); });
  });
}

template <class Connect>
Calls AskMachine(const Connect& connect, int clients) {
  return Ask(connect, clients, [&](const auto& channel, const auto& repeat) {
    const auto machines = v1::MachineService::NewStub(channel);
    repeat([&] {
      grpc::ClientContext context;
      v1::GetMachineRequest request;
      request.set_name("machines/mill-1");
      v1::Machine machine;
      Must(machines->GetMachine(&context, request, &machine));
    });
  });
}

// Those who submit, until it goes.
class Submitters {
 public:
  explicit Submitters(const CellServer& server) {
    for (int i = 0; i < kSubmitters; ++i) {
      threads_.emplace_back([&server](const std::stop_token& stop) {
        const auto jobs = v1::JobService::NewStub(server.Connect());
        v1::SubmitJobRequest request = Simulation(0.0);
        request.mutable_job()->set_held(true);
        while (!stop.stop_requested()) Submit(*jobs, request);
      });
    }
  }
  ~Submitters() {
    for (std::jthread& thread : threads_) thread.request_stop();
  }

 private:
  std::vector<std::jthread> threads_;
};

struct Goal {
  std::string what;
  double goal = 0.0;
  bool at_least = true;
  std::vector<double> values{};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RMLCELLD [FOLDER [ROUNDS]]\n", argv[0]);
    return 2;
  }
  const BareServer bare;  // before anything of gRPC runs in this process
  const std::filesystem::path folder = argc > 2 ? argv[2] : "bench-state";
  const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 5;
  const CellServer server(argv[1], folder / "cell", 1);
  const auto to_bare = [&] { return bare.Connect(); };
  const auto to_cell = [&] { return server.Connect(); };
  const auto jobs = v1::JobService::NewStub(server.Connect());
  const std::string ended = Submit(*jobs, Simulation(0.0));
  while (Get(*jobs, ended).state() != v1::Job::STATE_SUCCEEDED)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  // At its own pace: the worker tells of each move, and the program takes minutes.
  const std::string runs = Submit(*jobs, Simulation(1.0));
  while (Get(*jobs, runs).state() != v1::Job::STATE_RUNNING)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));

  std::vector<Goal> rows;
  constexpr int kClients[] = {1, 8, 64};
  for (const int clients : kClients) {
    const std::string who = ", clients: " + std::to_string(clients);
    rows.push_back({"A1: job that runs / empty call, calls/s" + who, 0.9});
    rows.push_back({"A1: the same, p99" + who, 1.3, false});
    rows.push_back({"A1: machine / empty call, calls/s" + who, 0.9});
  }
  rows.push_back({"Q7: job that ended / empty call, calls/s, beside 64 that submit", 0.7});
  rows.push_back({"Q7: the same, p99", 1.3, false});
  for (int round = 0; round < rounds; ++round) {
    std::size_t row = 0;
    for (const int clients : kClients) {
      const Calls empty = AskJob(to_bare, clients, runs);
      const Calls job = AskJob(to_cell, clients, runs);
      const Calls machine = AskMachine(to_cell, clients);
      rows[row++].values.push_back(job.per_second / empty.per_second);
      rows[row++].values.push_back(job.p99 / empty.p99);
      rows[row++].values.push_back(machine.per_second / empty.per_second);
      std::printf(
          "%2d clients: empty %6.0f/s p99 %6.3f ms  job %6.0f/s p99 %6.3f ms  machine %6.0f/s p99 %6.3f ms\n",
          clients, empty.per_second, empty.p99 * 1e3, job.per_second, job.p99 * 1e3,
          machine.per_second, machine.p99 * 1e3);
    }
    const Submitters load(server);
    const Calls empty = AskJob(to_bare, kReaders, runs);
    const Calls job = AskJob(to_cell, kReaders, ended);
    rows[row++].values.push_back(job.per_second / empty.per_second);
    rows[row++].values.push_back(job.p99 / empty.p99);
    std::printf("beside %d that submit: empty %6.0f/s p99 %6.3f ms  job %6.0f/s p99 %6.3f ms\n",
                kSubmitters, empty.per_second, empty.p99 * 1e3, job.per_second, job.p99 * 1e3);
  }
  bool reached = true;
  for (const Goal& row : rows)
    reached = Row(row.what, row.values, row.goal, row.at_least) && reached;
  return reached ? 0 : 1;
}
