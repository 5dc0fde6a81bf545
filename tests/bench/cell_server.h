#pragma once

#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace rmlcell::bench {

using Clock = std::chrono::steady_clock;

inline double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The value that the share `part` of them, 0 to 1, does not exceed.
inline double Quantile(std::vector<double> values, double part) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

inline double Median(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

inline void Must(const grpc::Status& status) {
  if (!status.ok()) throw std::runtime_error(status.error_message());
}

inline double ProcessorSecondsOf(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

// rmlcelld on a free port, with its own state.
class CellServer {
 public:
  CellServer(const std::string& program, const std::filesystem::path& folder, int workers)
      : folder_(folder) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const std::string log = (folder_ / "log").string();
    process_ = fork();
    if (process_ == 0) {
      execl(program.c_str(), program.c_str(), "--state.directory", (folder_ / "store").c_str(),
            "--listen.grpc", "127.0.0.1:0", "--listen.web", "127.0.0.1:0", "--log.file",
            log.c_str(), "--jobs.queued_max", "1000000", "--machines.hosts", "enabled",
            "--workers.count", std::to_string(workers).c_str(), nullptr);
      _exit(127);
    }
    for (int tries = 0; tries < 300 && address_.empty(); ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      std::ifstream in(log);
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      const std::size_t at = text.find("gRPC on ");
      if (text.find("is ready") == std::string::npos || at == std::string::npos) continue;
      address_ = text.substr(at + 8, text.find_first_of(" \n", at + 8) - at - 8);
      const std::size_t web = text.find("http://127.0.0.1:");
      if (web != std::string::npos) web_port_ = std::atoi(text.c_str() + web + 17);
    }
    if (address_.empty()) throw std::runtime_error("the server did not start");
  }
  CellServer(const CellServer&) = delete;
  CellServer& operator=(const CellServer&) = delete;
  ~CellServer() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }

  // A connection of its own, as a client on another machine has.
  std::shared_ptr<grpc::Channel> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    auto channel =
        grpc::CreateCustomChannel(address_, grpc::InsecureChannelCredentials(), arguments);
    // A first try now and then fails beside a busy server; no call is to be lost for it.
    channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(10));
    return channel;
  }

  int web_port() const { return web_port_; }

  // Of itself, without its workers.
  double ProcessorSeconds() const { return ProcessorSecondsOf(process_); }

  // What it holds of the memory of the computer.
  double MemoryKiB() const {
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return std::atof(line.c_str() + 6);
    }
    return 0.0;
  }

 private:
  std::filesystem::path folder_;
  std::string address_;
  int web_port_ = 0;
  pid_t process_ = 0;
};

}  // namespace rmlcell::bench
