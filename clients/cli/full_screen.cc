#include "clients/cli/full_screen.h"

#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <optional>

#include "clients/cli/terminal.h"

namespace rmlcell::cli {
namespace {

// A screen of its own, no cursor; the mouse: down and up (1000), as numbers (1006); when another
// window is typed into (1004); what is pasted in brackets (2004).
constexpr std::string_view kEnter =
    "\x1b[?1049h\x1b[2J\x1b[?25l\x1b[?1000h\x1b[?1006h\x1b[?1004h\x1b[?2004h";
constexpr std::string_view kLeave =
    "\x1b[?2004l\x1b[?1004l\x1b[?1006l\x1b[?1000l\x1b[0m\x1b[?25h\x1b[?1049l";

constexpr std::array kEndSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

sigset_t SetOf(std::optional<int> another) {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : kEndSignals) ::sigaddset(&set, signal);
  if (another) ::sigaddset(&set, *another);
  return set;
}

bool WriteAll(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// What was typed and not read is not for whoever reads next.
void GiveBack(const termios& before) {
  WriteAll(kLeave);
  ::tcflush(STDIN_FILENO, TCIFLUSH);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &before);
}

// Hands orders to end on. Whoever does not follow one in time is killed.
int WaitFor(pid_t child) {
  constexpr std::chrono::seconds kPatience{15};
  const sigset_t awaited = SetOf(SIGCHLD);
  std::optional<std::chrono::steady_clock::time_point> asked;
  for (;;) {
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    const timespec a_while{.tv_sec = 1, .tv_nsec = 0};
    const int signal = ::sigtimedwait(&awaited, nullptr, &a_while);
    if (signal > 0 && signal != SIGCHLD) {
      if (!asked) asked = std::chrono::steady_clock::now();
      ::kill(child, signal);
    }
    if (asked && std::chrono::steady_clock::now() - *asked > kPatience) ::kill(child, SIGKILL);
  }
}

}  // namespace

Status FullScreen::Check() {
  termios now{};
  if (::isatty(STDOUT_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &now) == 0) return {};
  return Error{ErrorCode::kCellInvalidArgument, "standard input and output are no terminal", {}};
}

FullScreen::FullScreen() {
  ::tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  ::cfmakeraw(&raw);
  raw.c_cc[VMIN] = 0;  // a read says what is there, and never waits
  raw.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  WriteAll(kEnter);
}

FullScreen::~FullScreen() { GiveBack(before_); }

bool FullScreen::Write(std::string_view text) const { return WriteAll(text); }

FullScreen::Size FullScreen::Now() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return {};
  return {.rows = size.ws_row, .columns = size.ws_col};
}

int WithTerminalGuarded(const std::function<int()>& work) {
  termios before{};
  ::tcgetattr(STDIN_FILENO, &before);
  // Also of who lost the terminal to a shell: it is not to stop before it has given it back.
  ::signal(SIGTTOU, SIG_IGN);
  ::signal(SIGTTIN, SIG_IGN);
  const sigset_t blocked = SetOf(SIGCHLD);
  sigset_t unblocked;
  ::sigprocmask(SIG_BLOCK, &blocked, &unblocked);
  const pid_t guard = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != guard) return kConnection;  // killed meanwhile
    return work();
  }
  if (child < 0) {
    Complain("no process can be made");
    return kConnection;
  }
  const int status = WaitFor(child);
  ::sigprocmask(SIG_SETMASK, &unblocked, nullptr);
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  GiveBack(before);
  Complain("killed by signal " + std::to_string(WTERMSIG(status)) +
           "; axes stand by themselves, and control runs out");
  return kConnection;
}

int EndSignals() {
  const sigset_t set = SetOf(SIGWINCH);
  ::sigprocmask(SIG_BLOCK, &set, nullptr);
  return ::signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
}

int TakeSignal(int descriptor) {
  signalfd_siginfo info{};
  if (::read(descriptor, &info, sizeof info) != static_cast<ssize_t>(sizeof info)) return 0;
  return static_cast<int>(info.ssi_signo);
}

}  // namespace rmlcell::cli
