#include "clients/lsp/stdio.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "clients/lsp/program_folder.h"
#include "clients/lsp/server.h"

namespace rmlcell::lsp {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// More waiting than one message of the largest size: the client is not read any further.
constexpr std::size_t kWaitingBytesMax = 2 * kMessageBytesMax;
// A client that does not read gets no more answers computed.
constexpr std::size_t kOutputBytesMax = std::size_t{64} << 20;
constexpr std::size_t kReadBytes = std::size_t{1} << 16;
// A check begins when nothing came for as long as the last one took, so that typing in a large
// program is not held up by checks that are out of date when they end.
constexpr milliseconds kQuietMax{400};

// Writing does not wait for a pipe or a socket; others (a file, a terminal) are shared with other
// processes and stay as they are. What it was comes back at the end.
class WithoutWaiting {
 public:
  explicit WithoutWaiting(int descriptor) : descriptor_(descriptor) {
    struct stat state {};
    if (fstat(descriptor, &state) != 0) return;
    if (!S_ISFIFO(state.st_mode) && !S_ISSOCK(state.st_mode)) return;
    flags_ = fcntl(descriptor, F_GETFL);
    if (flags_ >= 0) fcntl(descriptor, F_SETFL, flags_ | O_NONBLOCK);
  }
  ~WithoutWaiting() {
    if (flags_ >= 0) fcntl(descriptor_, F_SETFL, flags_);
  }
  WithoutWaiting(const WithoutWaiting&) = delete;
  WithoutWaiting& operator=(const WithoutWaiting&) = delete;

 private:
  int descriptor_;
  int flags_ = -1;
};

// The parent process, as a descriptor that can be read when it is gone. A number that no process
// has here comes from another world of processes and says nothing; the end of the input still does.
class Parent {
 public:
  Parent() = default;
  ~Parent() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Parent(const Parent&) = delete;
  Parent& operator=(const Parent&) = delete;

  // Only the first call counts.
  void Watch(std::int64_t process) {
    if (watched_ || !std::in_range<pid_t>(process)) return;
    watched_ = true;
    descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, static_cast<pid_t>(process), 0U));
  }
  int descriptor() const { return descriptor_; }  // negative: nothing to wait for

 private:
  bool watched_ = false;
  int descriptor_ = -1;
};

class Session {
 public:
  Session(int input, int output, milliseconds patience)
      : input_(input), output_(output), patience_(patience), server_(folder_) {}

  int Run() {
    while (!server_.exit_code()) {
      if (!Wait()) return 1;
      if (ended_ && !server_.waiting()) return Finish(1);
      if (pending() > kOutputBytesMax) continue;
      if (server_.waiting()) {
        server_.HandleNext();
        quiet_since_ = Clock::now();
      } else if (server_.unchecked() && Clock::now() >= quiet_since_ + quiet_) {
        const auto begin = Clock::now();
        server_.CheckNext();
        quiet_ =
            std::min(kQuietMax, std::chrono::duration_cast<milliseconds>(Clock::now() - begin));
      }
      unsent_ += server_.TakeOutput();
    }
    return Finish(*server_.exit_code());
  }

 private:
  std::size_t pending() const { return unsent_.size() - sent_; }

  // Time until there is something to do besides reading and writing.
  int Timeout() const {
    if (pending() > kOutputBytesMax) return -1;  // until the client reads
    if (server_.waiting() || ended_) return 0;
    milliseconds wait{-1};
    if (server_.unchecked()) {
      const auto left = std::chrono::ceil<milliseconds>(quiet_since_ + quiet_ - Clock::now());
      wait = std::clamp(left, milliseconds(0), kQuietMax);
    }
    return static_cast<int>(wait.count());
  }

  // Reads and writes what can be without waiting. False: the client or its process is gone.
  bool Wait() {
    if (server_.parent_process()) parent_.Watch(*server_.parent_process());
    const bool reads = !ended_ && server_.waiting_bytes() < kWaitingBytesMax;
    std::array<pollfd, 3> wires{{{reads ? input_ : -1, POLLIN, 0},
                                 {pending() > 0 ? output_ : -1, POLLOUT, 0},
                                 {ended_ ? -1 : parent_.descriptor(), POLLIN, 0}}};
    const int ready = poll(wires.data(), wires.size(), Timeout());
    if (ready < 0) return errno == EINTR;
    if (wires[2].revents != 0) return false;
    if (wires[0].revents != 0 && !Read()) ended_ = true;
    return wires[1].revents == 0 || Write();
  }

  bool Read() {
    std::array<char, kReadBytes> bytes{};
    const ssize_t size = read(input_, bytes.data(), bytes.size());
    if (size < 0) return errno == EINTR || errno == EAGAIN;
    server_.Receive(std::string_view(bytes.data(), static_cast<std::size_t>(size)));
    if (size > 0) quiet_since_ = Clock::now();
    return size > 0;
  }

  bool Write() {
    const ssize_t size = write(output_, unsent_.data() + sent_, pending());
    if (size < 0) return errno == EINTR || errno == EAGAIN;
    sent_ += static_cast<std::size_t>(size);
    if (sent_ == unsent_.size()) {
      unsent_.clear();
      sent_ = 0;
    }
    return true;
  }

  // What is answered is still sent, as long as somebody reads.
  int Finish(int code) {
    unsent_ += server_.TakeOutput();
    while (pending() > 0) {
      pollfd wire{output_, POLLOUT, 0};
      if (poll(&wire, 1, static_cast<int>(patience_.count())) <= 0 || !Write()) return 1;
    }
    return code;
  }

  int input_;
  int output_;
  milliseconds patience_;
  DiskFolder folder_;
  Server server_;
  Parent parent_;
  std::string unsent_;
  std::size_t sent_ = 0;
  bool ended_ = false;
  Clock::time_point quiet_since_ = Clock::now();
  milliseconds quiet_{0};
};

}  // namespace

int RunOnDescriptors(int input, int output, milliseconds patience) {
  // A client that went away is an error of write, not the end of the process.
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &before);
  int code = 1;
  {
    const WithoutWaiting scope(output);
    code = Session(input, output, patience).Run();
  }
  sigaction(SIGPIPE, &before, nullptr);
  return code;
}

}  // namespace rmlcell::lsp
