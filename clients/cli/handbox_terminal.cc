// rmlcell handbox: the handbox of a machine on a terminal.
//
// One loop reads keyboard and mouse, presses keys, says that they are held, and draws. It waits for
// nothing but that: when it is kept from going round, by a terminal that takes no more or by a
// SIGSTOP, no heartbeat is sent, and the machine stops. LIVE-7.05
#include "clients/cli/handbox_terminal.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/full_screen.h"
#include "clients/cli/handbox_hands.h"
#include "clients/cli/handbox_screen.h"
#include "clients/cli/handbox_watch.h"
#include "clients/cli/held_keys.h"
#include "clients/cli/machine_call.h"
#include "clients/cli/terminal.h"
#include "clients/cli/terminal_bytes.h"

namespace rmlcell::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenFlashes{400};
constexpr milliseconds kBetweenDraws{50};
// What has begun as a sequence of a terminal and does not go on is none. Longer than a slow line
// holds up half a sequence, shorter than a person is between two keys.
constexpr milliseconds kSequenceWithin{300};
// Control of one that is killed runs out behind that.
constexpr std::chrono::seconds kControlTime{9};

// Says to the loop that there is something for it, from any thread.
class Bell {
 public:
  Bell() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  ~Bell() { ::close(descriptor_); }
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  int descriptor() const { return descriptor_; }
  void Ring() const {
    const std::uint64_t one = 1;
    static_cast<void>(::write(descriptor_, &one, sizeof one));
  }
  void Silence() const {
    std::uint64_t rung = 0;
    static_cast<void>(::read(descriptor_, &rung, sizeof rung));
  }

 private:
  const int descriptor_;
};

// Nothing that is pressed from here on would be heard. What a server says of a machine that is OFF
// is no end of that.
bool IsOver(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
      return status.error_details().empty();
    case grpc::StatusCode::DEADLINE_EXCEEDED:
    case grpc::StatusCode::PERMISSION_DENIED:
    case grpc::StatusCode::NOT_FOUND:
      return true;
    default:
      return false;
  }
}

class HandboxLoop {
 public:
  HandboxLoop(HandboxHands& hands, const HandboxWatch& watch, const Bell& bell, int signals)
      : hands_(hands), watch_(watch), bell_(bell), signals_(signals) {
    view_.marks = true;
    Measure();
  }

  // Until a person, a signal or the server ends it; then no key is down. What the server said,
  // where it did.
  std::optional<grpc::Status> Run();

 private:
  void Measure();
  void Await();
  void ReadTerminal();
  void ReadSignals();
  void Take(const TerminalEvent& event);
  bool Acts(const HandboxKey& key) const;
  void Do(const std::vector<KeyStroke>& strokes);
  void HearAnswers();
  void KeepHeld();
  void Draw();

  FullScreen screen_;
  HandboxHands& hands_;
  const HandboxWatch& watch_;
  const Bell& bell_;
  const int signals_;
  TerminalBytes bytes_;
  HeldKeys held_;
  HandboxView view_;
  std::vector<std::string> drawn_;
  std::int64_t beeps_ = -1;
  bool ends_ = false;
  std::optional<grpc::Status> lost_;
  Clock::time_point now_ = Clock::now();
  Clock::time_point read_at_ = now_;
  Clock::time_point beat_at_ = now_;
  Clock::time_point drawn_at_ = now_ - kBetweenDraws;
};

std::optional<grpc::Status> HandboxLoop::Run() {
  while (!ends_ && !lost_) {
    Await();
    now_ = Clock::now();
    ReadSignals();
    if (!ends_) ReadTerminal();
    KeepHeld();
    HearAnswers();
    if (now_ - drawn_at_ >= kBetweenDraws) Draw();
  }
  Do(held_.LetGo());
  return lost_;
}

void HandboxLoop::Measure() {
  const FullScreen::Size size = FullScreen::Now();
  view_.rows = size.rows;
  view_.columns = size.columns;
  drawn_.clear();
  if (!screen_.Write("\x1b[2J")) ends_ = true;
}

void HandboxLoop::Await() {
  constexpr int kSoon_ms = 20;
  constexpr int kIdle_ms = 100;
  std::array<pollfd, 3> awaited = {pollfd{STDIN_FILENO, POLLIN, 0},
                                   pollfd{bell_.descriptor(), POLLIN, 0},
                                   pollfd{signals_, POLLIN, 0}};
  const bool soon = !held_.down().empty() || bytes_.begun();
  static_cast<void>(::poll(awaited.data(), awaited.size(), soon ? kSoon_ms : kIdle_ms));
  bell_.Silence();
  if ((awaited[0].revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) ends_ = true;
}

void HandboxLoop::ReadSignals() {
  for (int signal = TakeSignal(signals_); signal != 0; signal = TakeSignal(signals_)) {
    if (signal != SIGWINCH) ends_ = true;
    Measure();
  }
}

void HandboxLoop::ReadTerminal() {
  std::array<char, 1024> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count < 0 && errno != EAGAIN && errno != EINTR) ends_ = true;  // it has gone
  if (count > 0) {
    read_at_ = now_;
    for (const TerminalEvent& event :
         bytes_.Read(std::string_view(bytes.data(), static_cast<std::size_t>(count))))
      Take(event);
  } else if (bytes_.begun() && now_ - read_at_ > kSequenceWithin) {
    bytes_.GiveUp();
  }
}

void HandboxLoop::Take(const TerminalEvent& event) {
  switch (event.kind) {
    case TerminalEvent::Kind::kTyped:
      if (Acts(*event.key)) Do(held_.Typed(*event.key, now_));
      return;
    case TerminalEvent::Kind::kMouseDown:
      if (Acts(*event.key)) Do(held_.MouseDown(*event.key, now_));
      return;
    case TerminalEvent::Kind::kMouseUp:
      return Do(held_.MouseUp());
    case TerminalEvent::Kind::kAnswers:
      return held_.TerminalAnswers(now_);
    case TerminalEvent::Kind::kLeft:
      return Do(held_.LetGo());
    case TerminalEvent::Kind::kQuit:
      ends_ = true;
      return;
  }
}

// Whoever sees nothing may halt the machine, and nothing else.
bool HandboxLoop::Acts(const HandboxKey& key) const {
  return HasRoom(view_) || key.name == "STOP" || key.name == "HOLD" || key.name == "EMERGENCY_STOP";
}

void HandboxLoop::Do(const std::vector<KeyStroke>& strokes) {
  for (const KeyStroke& stroke : strokes) {
    if (stroke.action != v1::KEY_ACTION_RELEASE) view_.note.clear();
    // From the press on, and at once: the next beat is a whole time away.
    if (stroke.action == v1::KEY_ACTION_PRESS) beat_at_ = now_ - kBetweenBeats;
    hands_.Do(stroke);
  }
}

void HandboxLoop::HearAnswers() {
  for (const KeyAnswer& answer : hands_.TakeAnswers()) {
    const grpc::Status& status = answer.status;
    if (status.ok()) {
      const v1::Diagnostic& message = answer.response.message();
      if (answer.response.has_message())
        view_.note = answer.key + ": " + message.code() + ": " + message.message();
      continue;
    }
    if (IsOver(status) && !lost_) lost_ = status;
    view_.note = (answer.key.empty() ? "" : answer.key + ": ") + status.error_message();
  }
  HandboxSeen seen = watch_.seen();
  if (seen.lost && !lost_) lost_ = std::move(seen.lost);
  view_.panel = std::move(seen.panel);
  view_.status = std::move(seen.status);
}

void HandboxLoop::KeepHeld() {
  Do(held_.Expire(now_));
  if (held_.unanswered() && held_.down().empty() && view_.note.empty())
    view_.note = "let go: the terminal did not answer in time";
  if (held_.down().empty() || now_ - beat_at_ < kBetweenBeats) return;
  beat_at_ = now_;
  if (held_.by_mouse() && !screen_.Write(kAskTerminal)) ends_ = true;
  hands_.Beat(held_.down());
}

void HandboxLoop::Draw() {
  drawn_at_ = now_;
  if (view_.status.machine().empty()) return;  // not heard yet
  view_.down = held_.down();
  view_.flash = now_.time_since_epoch() / kBetweenFlashes % 2 == 1;
  std::vector<std::string> lines = HandboxLines(view_);
  std::string text = Redrawn(drawn_, lines);
  const std::int64_t beeps = view_.panel.beeps();
  if (beeps_ >= 0 && beeps > beeps_) text += '\a';
  beeps_ = view_.panel.display().empty() ? -1 : beeps;
  if (!text.empty() && !screen_.Write(text)) ends_ = true;
  drawn_ = std::move(lines);
}

int OnTerminal(const Remote& remote, const HandboxRequest& request) {
  const int signals = EndSignals();  // before any thread is there
  MachineAct act;
  act.machine = request.machine;
  act.take_over = request.take_over;
  const Control control(remote, act, static_cast<int>(kControlTime.count()), "rmlcell handbox");
  if (!control.status().ok()) return Refused(control.status(), remote);
  const std::string machine = FullName("machines", request.machine);
  const auto channel = Connect(remote);
  std::optional<grpc::Status> lost;
  {
    const HandboxSession session(channel, machine, control.token());
    if (!session.status().ok()) return Refused(session.status(), remote);
    const Bell bell;
    const auto ring = [&bell] { bell.Ring(); };
    const HandboxWatch watch(channel, machine, control, kControlTime, ring);
    HandboxHands hands(channel, session.session().name(), control.token(), ring);
    lost = HandboxLoop(hands, watch, bell, signals).Run();
    if (!lost) AwaitRest(remote, machine);
  }
  return lost ? Refused(*lost, remote) : kGood;
}

}  // namespace

int Handbox(const Remote& remote, const HandboxRequest& request) {
  if (const Status terminal = FullScreen::Check(); !terminal) {
    Complain("a handbox needs a terminal: " + terminal.error().detail);
    return kUsage;
  }
  return WithTerminalGuarded([&] { return OnTerminal(remote, request); });
}

}  // namespace rmlcell::cli
