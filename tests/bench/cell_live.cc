// Machines that live: STOP from the call to its answer, which comes when it has acted, the age of
// status as it arrives, answers to what is written to the disk first, the processor time of hosts,
// and how soon a host that was killed is found again. On a cell with nothing else to do, and beside
// 8 clients that check large programs, at factor 10 as well, and with the store stopped. Ends with
// 1 when a goal is missed: LIVE-10.20, LIVE-10.21, LIVE-10.22, LIVE-10.23, LIVE-10.24, LIVE-10.25.
//   bench_cell_live RMLCELLD [FOLDER [STOPS]]
#include <sqlite3.h>

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

#include "tests/bench/goals.h"
#include "tests/bench/live_machine.h"

namespace {

using namespace rmlcell::bench;

constexpr int kClients = 8;
constexpr int kStandingSeconds = 10;
constexpr int kSettlingSeconds = 10;  // a host that has just come sets its lines up
constexpr int kMachines = 100;
constexpr int kMovingSeconds = 20;

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

// What `measure` tells while clients keep the server busy.
Times BesideClients(const CellServer& server, const std::function<Times()>& measure) {
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
  const Times busy = measure();
  enough = true;
  for (std::thread& client : clients) client.join();
  return busy;
}

// Another program has the file of the store to itself, for as long as this lives.
class StoreStopped {
 public:
  explicit StoreStopped(const std::filesystem::path& file) {
    const bool locked =
        sqlite3_open(file.c_str(), &database_) == SQLITE_OK &&
        sqlite3_busy_timeout(database_, 5'000) == SQLITE_OK &&
        sqlite3_exec(database_, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr) == SQLITE_OK;
    if (!locked) throw std::runtime_error(sqlite3_errmsg(database_));
  }
  ~StoreStopped() { sqlite3_close(database_); }
  StoreStopped(const StoreStopped&) = delete;
  StoreStopped& operator=(const StoreStopped&) = delete;

 private:
  sqlite3* database_ = nullptr;
};

// STOPs alone, while the store takes nothing: for three seconds at a time, then it does.
Times MeasureStopped(LiveMachine& machine, const std::filesystem::path& store, int stops) {
  constexpr int kAtATime = 10;
  Times times;
  for (int i = 0; i < stops; i += kAtATime) {
    machine.TakeControl();
    const StoreStopped stopped(store);
    for (int k = 0; k < kAtATime; ++k) {
      times.stops.push_back(machine.SecondsToStop() * 1e3);
      machine.Await(v1::MACHINE_STATE_HELD);
      machine.SecondsToResume();
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
  }
  return times;
}

// A laser that cuts corner by corner for as long as anybody looks.
std::string Rounds() {
  return "COORD ABSOL\nPATH LIN\nSPEED 20\nVI[1] = 0\nWORK 0,0/ON\n"
         "10 MOVE (1000., 500., -400., 0., 0.)\nMOVE (1060., 510., -390., 0.1, 0.)\n"
         "MOVE (1020., 580., -410., 0., 0.1)\nMOVE (990., 540., -400., 0.1, 0.1)\n"
         "VI[1] = VI[1] + 1\nIF VI[1] < 10000 THEN 10\nWORK 0,0/OFF\n";
}

// A hundred machines that all move, at the speed of the clock: mills and lasers in turn.
struct Hundred {
  double cores = 0.0;   // of hosts and server
  double lost_s = 0.0;  // of virtual time, of the one that lost most
};

Hundred MoveAHundred(const CellServer& server) {
  const auto calls = v1::MachineService::NewStub(server.Connect());
  std::vector<std::unique_ptr<LiveMachine>> machines;
  for (int i = 0; i < kMachines; ++i) {
    const bool mill = i % 2 == 0;
    v1::CreateMachineRequest create;
    create.set_machine_id("m-" + std::to_string(i));
    create.mutable_machine()->set_family(mill ? "rml1" : "optimo");
    if (mill) create.mutable_machine()->set_profile("srm-20");
    grpc::ClientContext context;
    v1::Machine made;
    Must(calls->CreateMachine(&context, create, &made));
    const std::string name = "machines/" + create.machine_id();
    machines.push_back(mill ? std::make_unique<LiveMachine>(server, name)
                            : std::make_unique<LiveMachine>(server, name, "round.S", Rounds()));
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

void Print(const char* when, const Times& times) {
  std::printf("%s:\n", when);
  Print("STOP, call to its answer", times.stops);
  Print("RESUME, written to the disk first", times.resumes);
  Print("status, age as it arrives", times.ages);
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
    Print("nothing else", idle);
    const Times busy = BesideClients(server, [&] { return Measure(machine, stops); });
    Print("beside clients that check", busy);
    const Times stopped = BesideClients(
        server, [&] { return MeasureStopped(machine, folder / "store" / "cell.db", stops); });
    Print("STOP, the store stopped", stopped.stops);
    machine.SetFactor(10.0);
    const Times fast = BesideClients(server, [&] { return Measure(machine, stops / 4); });
    machine.SetFactor(1.0);
    Print("status at factor 10, age as it arrives", fast.ages);

    const std::vector<double> found = KillHosts(machine);
    Print("host killed to its successor", found);
    Print("last heartbeat of a jog key to braking", brakes);

    row("10.21: age of status, p99 beside 8 clients, ms", Quantile(busy.ages, 0.99), 100.0);
    row("10.21: the same, p50", Quantile(busy.ages, 0.5), 10.0);
    row("10.21: age of status at factor 10, p99 beside 8 clients, ms", Quantile(fast.ages, 0.99),
        100.0);
    row("10.21: the same, p50", Quantile(fast.ages, 0.5), 10.0);
    row("10.22: STOP, p99 beside 8 clients with the store stopped, ms",
        Quantile(stopped.stops, 0.99), 50.0);
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
