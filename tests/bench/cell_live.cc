// Machines that live: STOP from the call to its answer, which comes when it has acted, the age of
// status as it arrives, answers to what is written to the disk first, the processor time of hosts,
// and how soon a host that was killed is found again. On a cell with nothing else to do, and beside
// 8 clients that check large programs. Ends with 1 when a goal is missed: LIVE-10.20, LIVE-10.21,
// LIVE-10.22, LIVE-10.23, LIVE-10.24, LIVE-10.25.
//   bench_cell_live RMLCELLD [FOLDER [STOPS]]
#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "tests/bench/cell_server.h"
#include "tests/bench/goals.h"

namespace {

using namespace rmlcell::bench;
namespace v1 = rmlcell::v1;

constexpr int kClients = 8;
constexpr int kStandingSeconds = 10;
constexpr int kSettlingSeconds = 10;  // a host that has just come sets its lines up
constexpr int kMachines = 100;
constexpr int kMovingSeconds = 20;

std::string Lines(int count, int longest) {
  std::string text = "PA;PA;VS1;!VZ1;!PZ0,200;!MC1;PU0,0;";
  for (int i = 0; i < count; ++i)
    text += "PD" + std::to_string(i * 37 % longest) + "," + std::to_string(i * 53 % longest) + ";";
  return text + "PU0,0;H;";
}

std::string NewId() {
  static std::atomic<int> made = 0;
  char text[40];
  std::snprintf(text, sizeof text, "00000000-0000-4000-8000-%012d", ++made);
  return text;
}

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

double SecondsOf(const google::protobuf::Timestamp& time) {
  return static_cast<double>(time.seconds()) + time.nanos() * 1e-9;
}

class LiveMachine {
 public:
  LiveMachine(const CellServer& server, std::string name, const std::string& file = "lines.rml",
              const std::string& content = Lines(2'000, 5'000))
      : name_(std::move(name)), calls_(v1::MachineService::NewStub(server.Connect())) {
    v1::EnableMachineRequest enable;
    enable.set_machine(name_);
    enable.set_request_id(NewId());
    Status(&v1::MachineService::Stub::EnableMachine, enable);
    v1::PutProgramRequest put;
    put.set_name(name_ + "/programs/5");
    put.mutable_program()->set_file_name(file);
    put.mutable_program()->set_content(content);
    grpc::ClientContext context;
    v1::Program stored;
    Must(v1::ProgramService::NewStub(server.Connect())->PutProgram(&context, put, &stored));
    TakeControl();
  }
  ~LiveMachine() {
    watching_.TryCancel();
    if (watcher_.joinable()) watcher_.join();
  }

  void Start() {
    v1::StartMachineRequest start;
    start.set_machine(name_);
    start.set_control_token(token_);
    start.set_request_id(NewId());
    start.set_program(5);
    Status(&v1::MachineService::Stub::StartMachine, start);
  }
  double SecondsToStop() {
    v1::StopMachineRequest stop;
    stop.set_machine(name_);
    const auto begin = Clock::now();
    grpc::ClientContext context;
    v1::HaltResponse answer;
    Must(calls_->StopMachine(&context, stop, &answer));
    return SecondsSince(begin);
  }
  double SecondsToResume() {
    v1::ResumeMachineRequest resume;
    resume.set_machine(name_);
    resume.set_control_token(token_);
    resume.set_request_id(NewId());
    const auto begin = Clock::now();
    Status(&v1::MachineService::Stub::ResumeMachine, resume);
    return SecondsSince(begin);
  }
  v1::MachineStatus Now() {
    v1::GetMachineRequest request;
    request.set_name(name_);
    grpc::ClientContext context;
    v1::Machine machine;
    Must(calls_->GetMachine(&context, request, &machine));
    return machine.status();
  }
  void Await(v1::MachineState state) {
    while (Now().state() != state) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  // From the last heartbeat of a jog key that is down until the machine brakes, by the clock that
  // both processes have. It stands then.
  double SecondsToBrake() {
    v1::PressPanelKeyRequest press;
    press.set_machine(name_);
    press.set_control_token(token_);
    press.set_key(++keys_ % 4 < 2 ? "X+" : "X-");
    press.set_action(v1::KEY_ACTION_PRESS);
    press.set_sequence(keys_);
    Status(&v1::MachineService::Stub::PressPanelKey, press);
    double sent = 0.0;
    for (int beat = 0; beat < 6; ++beat) {
      v1::HeartbeatPanelRequest heartbeat;
      heartbeat.set_machine(name_);
      heartbeat.set_control_token(token_);
      heartbeat.set_number(++beats_);
      heartbeat.add_keys_down(press.key());
      sent = WallSeconds();
      *heartbeat.mutable_sent() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
          static_cast<std::int64_t>(sent * 1e6));
      grpc::ClientContext context;
      v1::HeartbeatResponse heard;
      Must(calls_->HeartbeatPanel(&context, heartbeat, &heard));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    double braked = 0.0;
    for (;;) {
      const v1::MachineStatus now = Now();
      if (now.state() == v1::MACHINE_STATE_JOGGING) continue;
      braked = SecondsOf(now.send_time());
      break;
    }
    Await(v1::MACHINE_STATE_IDLE);
    press.set_action(v1::KEY_ACTION_RELEASE);
    press.set_sequence(++keys_);
    Status(&v1::MachineService::Stub::PressPanelKey, press);
    return braked - sent;
  }
  pid_t host() {
    const std::string host = Now().host();
    return std::atoi(host.substr(host.find('/') + 1).c_str());
  }
  // Collects how old each status is that arrives, by the clock that both processes have.
  void Watch() {
    v1::WatchMachineRequest request;
    request.set_name(name_);
    events_ = calls_->WatchMachine(&watching_, request);
    watcher_ = std::thread([this] {
      v1::WatchMachineResponse message;
      while (events_->Read(&message)) {
        if (message.status().state() != v1::MACHINE_STATE_RUNNING) continue;
        const double age = WallSeconds() - SecondsOf(message.status().send_time());
        const std::lock_guard lock(mutex_);
        ages_.push_back(age);
      }
    });
  }
  std::vector<double> TakeAges() {
    const std::lock_guard lock(mutex_);
    return std::exchange(ages_, {});
  }
  void TakeControl() {
    v1::AcquireControlRequest acquire;
    acquire.set_machine(name_);
    acquire.mutable_ttl()->set_seconds(60);
    acquire.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
    acquire.set_take_over(true);
    acquire.set_reason("a bench");
    acquire.set_request_id(NewId());
    grpc::ClientContext context;
    v1::AcquireControlResponse answer;
    Must(calls_->AcquireControl(&context, acquire, &answer));
    token_ = answer.control_token();
    keys_ = beats_ = 0;  // they are counted by whoever has control
  }

 private:
  template <class Method, class Request>
  void Status(Method method, const Request& request) {
    grpc::ClientContext context;
    v1::MachineStatus status;
    Must((calls_.get()->*method)(&context, request, &status));
  }

  const std::string name_;
  std::unique_ptr<v1::MachineService::Stub> calls_;
  std::string token_;
  std::int64_t keys_ = 0;
  std::int64_t beats_ = 0;
  grpc::ClientContext watching_;
  std::unique_ptr<grpc::ClientReader<v1::WatchMachineResponse>> events_;
  std::thread watcher_;
  std::mutex mutex_;
  std::vector<double> ages_;  // guarded by mutex_
};

double SharedMibOf(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/smaps_rollup");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("Pss:")) return std::atof(line.c_str() + 4) / 1024.0;
  }
  return 0.0;
}

struct Times {
  std::vector<double> stops, resumes, ages;
};

Times Measure(LiveMachine& machine, int stops) {
  Times times;
  machine.TakeControl();
  static_cast<void>(machine.TakeAges());
  for (int i = 0; i < stops; ++i) {
    if (i % 100 == 99) machine.TakeControl();
    times.stops.push_back(machine.SecondsToStop() * 1e3);
    machine.Await(v1::MACHINE_STATE_HELD);
    times.resumes.push_back(machine.SecondsToResume() * 1e3);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
  }
  // On its way, with a hold from time to time; above it stands more than it moves.
  machine.TakeControl();
  static_cast<void>(machine.TakeAges());
  for (int i = 0; i < 8; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    machine.SecondsToStop();
    machine.Await(v1::MACHINE_STATE_HELD);
    machine.SecondsToResume();
  }
  for (const double age : machine.TakeAges()) times.ages.push_back(age * 1e3);
  return times;
}

Times MeasureBesideClients(const CellServer& server, LiveMachine& machine, int stops) {
  std::atomic<bool> enough = false;
  std::vector<std::thread> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.emplace_back([&] {
      const auto programs = v1::ProgramService::NewStub(server.Connect());
      v1::CheckProgramRequest request;
      request.set_family("rml1");
      request.mutable_program()->set_file_name("large.rml");
      request.mutable_program()->set_content(Lines(100'000, 5'000));
      while (!enough) {
        grpc::ClientContext context;
        v1::CheckProgramResponse response;
        Must(programs->CheckProgram(&context, request, &response));
      }
    });
  }
  const Times busy = Measure(machine, stops);
  enough = true;
  for (std::thread& client : clients) client.join();
  return busy;
}

// A hundred machines that all move, at the speed of the clock.
struct Hundred {
  double cores = 0.0;   // of hosts and server
  double lost_s = 0.0;  // of virtual time, of the one that lost most
};

Hundred MoveAHundred(const CellServer& server) {
  const auto calls = v1::MachineService::NewStub(server.Connect());
  std::vector<std::unique_ptr<LiveMachine>> machines;
  for (int i = 0; i < kMachines; ++i) {
    v1::CreateMachineRequest create;
    create.set_machine_id("m-" + std::to_string(i));
    create.mutable_machine()->set_family("rml1");
    create.mutable_machine()->set_profile("srm-20");
    grpc::ClientContext context;
    v1::Machine made;
    Must(calls->CreateMachine(&context, create, &made));
    machines.push_back(std::make_unique<LiveMachine>(server, "machines/" + create.machine_id()));
    machines.back()->Start();
  }
  std::this_thread::sleep_for(std::chrono::seconds(5));  // all are on their way
  const auto used = [&] {
    double seconds = server.ProcessorSeconds();
    for (const auto& machine : machines) seconds += ProcessorSecondsOf(machine->host());
    return seconds;
  };
  std::vector<v1::MachineStatus> began;
  const double before = used();
  const auto begin = Clock::now();
  for (const auto& machine : machines) began.push_back(machine->Now());
  std::this_thread::sleep_for(std::chrono::seconds(kMovingSeconds));
  Hundred hundred;
  hundred.cores = (used() - before) / SecondsSince(begin);
  for (std::size_t i = 0; i < machines.size(); ++i) {
    const v1::MachineStatus now = machines[i]->Now();
    const double passed = SecondsOf(now.send_time()) - SecondsOf(began[i].send_time());
    const double lived =
        static_cast<double>(now.virtual_time_ns() - began[i].virtual_time_ns()) * 1e-9;
    hundred.lost_s = std::max(hundred.lost_s, passed - lived);
  }
  return hundred;
}

// Until another host is heard of, ms.
std::vector<double> KillHosts(LiveMachine& machine) {
  std::vector<double> found;
  for (int i = 0; i < 4; ++i) {  // five within a minute, and the machine would be given up
    const pid_t victim = machine.host();
    const auto killed = Clock::now();
    kill(victim, SIGKILL);
    const auto there = [&] {
      const v1::MachineStatus now = machine.Now();
      return now.state() != v1::MACHINE_STATE_STARTING && now.state() != v1::MACHINE_STATE_LOST &&
             now.host().find("/" + std::to_string(victim) + "/") == std::string::npos;
    };
    while (!there()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    found.push_back(SecondsSince(killed) * 1e3);
    std::this_thread::sleep_for(std::chrono::seconds(6));  // a healthy life: no delay next time
  }
  return found;
}

void Print(const char* what, const std::vector<double>& values) {
  std::printf("  %-40s p50 %7.2f   p99 %7.2f   most %7.2f ms (%zu)\n", what, Quantile(values, 0.5),
              Quantile(values, 0.99), Quantile(values, 1.0), values.size());
}

// In percent.
double ShareOfStanding(LiveMachine& machine) {
  const pid_t host = machine.host();
  std::this_thread::sleep_for(std::chrono::seconds(kSettlingSeconds));
  const double before = ProcessorSecondsOf(host);
  std::this_thread::sleep_for(std::chrono::seconds(kStandingSeconds));
  return (ProcessorSecondsOf(host) - before) / kStandingSeconds * 100.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s RMLCELLD [FOLDER [STOPS]]\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argc > 2 ? argv[2] : "bench-state";
  const int stops = argc > 3 ? std::max(1, std::atoi(argv[3])) : 200;
  bool good = true;
  const auto row = [&good](const std::string& what, double value, double most) {
    good = Row(what, {value}, most, false) && good;
  };
  {
    const CellServer server(argv[1], folder, 2);
    LiveMachine machine(server, "machines/mill-1");
    const double standing = ShareOfStanding(machine);
    std::vector<double> brakes;
    for (int i = 0; i < std::min(stops, 50); ++i) {
      if (i % 20 == 0) machine.TakeControl();
      brakes.push_back(machine.SecondsToBrake() * 1e3);
    }
    machine.TakeControl();
    machine.Watch();
    machine.Start();
    const Times idle = Measure(machine, stops);
    std::printf("nothing else:\n");
    Print("STOP, call to its answer", idle.stops);
    Print("RESUME, written to the disk first", idle.resumes);
    Print("status, age as it arrives", idle.ages);

    const Times busy = MeasureBesideClients(server, machine, stops);
    std::printf("beside %d clients that check:\n", kClients);
    Print("STOP, call to its answer", busy.stops);
    Print("RESUME, written to the disk first", busy.resumes);
    Print("status, age as it arrives", busy.ages);

    const std::vector<double> found = KillHosts(machine);
    Print("host killed to its successor", found);
    Print("last heartbeat of a jog key to braking", brakes);

    row("10.21: age of status, p99 beside 8 clients, ms", Quantile(busy.ages, 0.99), 100.0);
    row("10.21: the same, p50", Quantile(busy.ages, 0.5), 10.0);
    row("10.22: STOP, p99 beside 8 clients, ms", Quantile(busy.stops, 0.99), 50.0);
    row("10.22: STOP, p50 idle, ms", Quantile(idle.stops, 0.5), 5.0);
    row("10.23: last heartbeat of a jog key to braking, most, ms", Quantile(brakes, 1.0), 200.0);
    row("10.24: written first, p99, ms", Quantile(idle.resumes, 0.99), 15.0);
    row("10.25: host killed to its successor, most, ms", Quantile(found, 1.0), 2000.0);
    row("10.20: a mill that stands, share of a core, %", standing, 0.1);
    row("10.20: memory of a host, PSS, MiB", SharedMibOf(machine.host()), 16.0);
  }
  {
    const CellServer server(argv[1], folder, 0);
    LiveMachine laser(server, "machines/optimo-1", "wait.S", "DELAY 1\n");
    row("10.20: a laser that stands, share of a core, %", ShareOfStanding(laser), 0.1);
  }
  {
    const CellServer server(argv[1], folder, 0);
    const Hundred hundred = MoveAHundred(server);
    row("10.20: a hundred machines that move, cores", hundred.cores, 1.6);
    row("10.20: virtual time that one of them lost, ms", hundred.lost_s * 1e3, 1.0);
  }
  std::filesystem::remove_all(folder);
  return good ? 0 : 1;
}
