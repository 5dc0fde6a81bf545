// A session on two descriptors, as an editor has it: what comes through, and how it ends.
#include "clients/lsp/stdio.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "clients/lsp/framing.h"
#include "clients/lsp/protocol.h"

namespace rmlcell::lsp {
namespace {

constexpr int kNobodyWaitsLonger_ms = 60'000;

std::ptrdiff_t OpenDescriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// The time of a processor that it has used so far.
std::int64_t CpuTimeOf(std::thread& thread) {
  clockid_t of_thread{};
  EXPECT_EQ(::pthread_getcpuclockid(thread.native_handle(), &of_thread), 0);
  timespec used{};
  EXPECT_EQ(::clock_gettime(of_thread, &used), 0);
  return std::int64_t{used.tv_sec} * 1'000'000'000 + used.tv_nsec;
}

// Both ends of two wires; the session has the other two of the four.
class Wires {
 public:
  enum class Kind { kPipes, kSocket };

  explicit Wires(Kind kind = Kind::kPipes) {
    if (kind == Kind::kPipes) {
      EXPECT_EQ(::pipe(to_.data()), 0);
      EXPECT_EQ(::pipe(from_.data()), 0);
      return;
    }
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    to_ = {ends[0], ends[1]};
    from_ = {::dup(ends[1]), ::dup(ends[0])};
  }
  Wires(const Wires&) = delete;
  Wires& operator=(const Wires&) = delete;
  ~Wires() {
    for (const int end : {to_[0], to_[1], from_[0], from_[1]}) Close(end);
  }

  int input() const { return to_[0]; }
  int output() const { return from_[1]; }
  void HangUp() { Close(std::exchange(to_[1], -1)); }
  void StopListening() { Close(std::exchange(from_[0], -1)); }

  void Write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t size = ::write(to_[1], bytes.data(), bytes.size());
      ASSERT_GT(size, 0);
      bytes.remove_prefix(static_cast<std::size_t>(size));
    }
  }
  // The next body; nothing at the end, or when nothing comes.
  std::optional<std::string> Next() {
    while (frames_.empty()) {
      pollfd wire{from_[0], POLLIN, 0};
      if (::poll(&wire, 1, kNobodyWaitsLonger_ms) != 1) return std::nullopt;
      std::array<char, 4096> bytes{};
      const ssize_t size = ::read(from_[0], bytes.data(), bytes.size());
      if (size <= 0) return std::nullopt;
      reader_.Feed({bytes.data(), static_cast<std::size_t>(size)}, frames_);
    }
    const Frame first = frames_.front();
    frames_.erase(frames_.begin());
    return first.body;
  }

 private:
  static void Close(int end) {
    if (end >= 0) ::close(end);
  }

  std::array<int, 2> to_{};
  std::array<int, 2> from_{};
  MessageReader reader_;
  std::vector<Frame> frames_;
};

class Stdio : public testing::Test {
 protected:
  explicit Stdio(Wires::Kind kind = Wires::Kind::kPipes) : wires_(kind) {}
  ~Stdio() override {
    wires_.HangUp();
    wires_.StopListening();
    if (session_.joinable()) session_.join();
  }

  // `patience`: with a test that stands still behind the end of the session.
  void Begin(std::chrono::milliseconds patience = std::chrono::minutes(1)) {
    std::packaged_task<int()> run(
        [this, patience] { return RunOnDescriptors(wires_.input(), wires_.output(), patience); });
    code_ = run.get_future();
    session_ = std::thread(std::move(run));
  }
  int Code() { return code_.get(); }
  void Send(const std::string& method, const Json& parameters, std::optional<int> id = {}) {
    Json message = {{"jsonrpc", "2.0"}, {"method", method}, {"params", parameters}};
    if (id) message["id"] = *id;
    wires_.Write(Framed(message.dump()));
  }
  Json Answer() {
    const auto body = wires_.Next();
    return body ? Json::parse(*body) : Json("nothing came");
  }
  // Its answer has come.
  void Initialize(const Json& process = nullptr) {
    Send("initialize", {{"processId", process}, {"capabilities", Json::object()}}, 1);
    const Json answer = Answer();
    ASSERT_TRUE(answer.contains("result")) << answer;
  }
  void ExpectItAnswers(int id) {
    Send("nothing/of/this", Json::object(), id);
    const Json answer = Answer();
    ASSERT_TRUE(answer.is_object()) << answer;
    EXPECT_EQ(answer["id"], id);
  }

  Wires wires_;
  std::thread session_;
  std::future<int> code_;
};

TEST_F(Stdio, ExitEndsItWellBehindShutdown) {
  Begin();
  Initialize();
  Send("shutdown", nullptr, 2);
  EXPECT_EQ(Answer()["id"], 2);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 0);
}

TEST_F(Stdio, BytesMayComeOneByOne) {
  Begin();
  const Json message = {{"jsonrpc", "2.0"}, {"id", 1}, {"method", "nothing/of/this"}};
  const std::string bytes = Framed(message.dump());
  for (const char& byte : bytes) {
    wires_.Write({&byte, 1});
    for (int unread = 1; unread > 0; std::this_thread::yield())
      ASSERT_EQ(::ioctl(wires_.input(), FIONREAD, &unread), 0);
  }
  EXPECT_EQ(Answer()["id"], 1);
}

TEST_F(Stdio, ExitAloneIsAnError) {
  Begin();
  Initialize();
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
}

// What came before the end of the input is still answered, all of it and in its order.
TEST_F(Stdio, TheEndOfTheInputEndsIt) {
  for (int id = 1; id <= 50; ++id) Send("nothing/of/this", Json::object(), id);
  wires_.HangUp();
  Begin();
  for (int id = 1; id <= 50; ++id) EXPECT_EQ(Answer()["id"], id);
  EXPECT_EQ(Code(), 1);
}

// Findings are told without being asked for, when the client has been quiet; changes again.
TEST_F(Stdio, FindingsComeByThemselves) {
  Begin();
  Initialize();
  Send("textDocument/didOpen", {{"textDocument",
                                 {{"uri", "file:///nowhere/12.S"},
                                  {"languageId", "optimo-rml"},
                                  {"version", 1},
                                  {"text", "SPEED 101\n"}}}});
  Json told = Answer();
  EXPECT_EQ(told["method"], "textDocument/publishDiagnostics");
  EXPECT_EQ(told["params"]["diagnostics"].size(), 1U);
  Send("textDocument/didChange", {{"textDocument", {{"uri", "file:///nowhere/12.S"}}},
                                  {"contentChanges", {{{"text", "SPEED 100\n"}}}}});
  told = Answer();
  EXPECT_EQ(told["method"], "textDocument/publishDiagnostics");
  EXPECT_EQ(told["params"]["diagnostics"].size(), 0U);
  ExpectItAnswers(2);
}

// More than a pipe holds, to a client that reads it in small parts: byte for byte, also behind its
// exit.
TEST_F(Stdio, LongAnswersComeWhole) {
  Begin();
  Initialize();
  const std::string long_name(300'000, 'm');
  for (int id = 2; id <= 5; ++id) Send(long_name, Json::object(), id);
  for (int id = 2; id <= 5; ++id) {
    const Json answer = Answer();
    EXPECT_EQ(answer["id"], id);
    EXPECT_EQ(answer["error"]["message"], "there is no method " + long_name);
  }
  ExpectItAnswers(6);
  Send(long_name, Json::object(), 7);
  Send("shutdown", nullptr, 8);
  Send("exit", nullptr);
  EXPECT_EQ(Answer()["error"]["message"], "there is no method " + long_name);
  EXPECT_EQ(Answer()["id"], 8);
  EXPECT_EQ(Code(), 0);
}

// It ends, and not by the signal that such a write is; who handled that before does so again.
TEST_F(Stdio, AClientThatHearsNothingMoreEndsIt) {
  struct sigaction mine {};
  mine.sa_handler = [](int) {};
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGPIPE, &mine, &before), 0);
  Begin();
  Initialize();
  wires_.StopListening();
  Send("nothing/of/this", Json::object(), 2);
  EXPECT_EQ(Code(), 1);
  struct sigaction after {};
  ASSERT_EQ(::sigaction(SIGPIPE, &before, &after), 0);
  EXPECT_EQ(after.sa_handler, mine.sa_handler);
}

// What cannot be sent behind an exit makes it an error.
TEST_F(Stdio, AnExitThatCannotBeAnsweredIsAnError) {
  Begin();
  Initialize();
  Send(std::string(300'000, 'm'), Json::object(), 2);
  Send("shutdown", nullptr, 3);
  Send("exit", nullptr);
  wires_.StopListening();
  EXPECT_EQ(Code(), 1);
}

// A client that lives and reads nothing is not waited for for ever.
TEST_F(Stdio, AClientThatNeverReadsIsLeft) {
  Begin(kLastPatience);
  Initialize();
  Send(std::string(300'000, 'm'), Json::object(), 2);
  Send("shutdown", nullptr, 3);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
}

// Nothing of it is left: the wire is as it was, and no descriptor is open.
TEST_F(Stdio, TheWireIsAsItWas) {
  const int before = ::fcntl(wires_.output(), F_GETFL);
  ASSERT_EQ(before & O_NONBLOCK, 0);
  const std::ptrdiff_t open = OpenDescriptors();
  Begin();
  Initialize(::getpid());
  EXPECT_EQ(::fcntl(wires_.output(), F_GETFL), before | O_NONBLOCK);
  ExpectItAnswers(2);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
  EXPECT_EQ(::fcntl(wires_.output(), F_GETFL), before);
  EXPECT_EQ(OpenDescriptors(), open);
}

// Whose client names no process has none to close.
TEST_F(Stdio, ASessionWithoutAProcessClosesNothing) {
  const std::ptrdiff_t open = OpenDescriptors();
  Begin();
  Initialize();
  ExpectItAnswers(2);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
  EXPECT_EQ(OpenDescriptors(), open);
}

// Whoever waits for its client does nothing at all, however long others work beside it.
TEST_F(Stdio, ASessionThatWaitsDoesNothing) {
  Begin();
  Initialize();
  ExpectItAnswers(2);
  Wires wires;
  std::thread other(
      [&wires] { static_cast<void>(RunOnDescriptors(wires.input(), wires.output())); });
  const Json message = {{"jsonrpc", "2.0"}, {"id", 1}, {"method", "nothing/of/this"}};
  const std::string request = Framed(message.dump());
  bool stands = false;  // from the first time on, unless its last answer is not over yet
  for (int times = 0; times < 20 && !stands; ++times) {
    const std::int64_t before = CpuTimeOf(session_);
    for (int requests = 0; requests < 500; ++requests) {
      wires.Write(request);
      EXPECT_TRUE(wires.Next());
    }
    stands = CpuTimeOf(session_) == before;
  }
  EXPECT_TRUE(stands);
  wires.HangUp();
  other.join();
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
}

TEST_F(Stdio, AWireThatNeverWaitedStaysSo) {
  const int before = ::fcntl(wires_.output(), F_GETFL) | O_NONBLOCK;
  ASSERT_EQ(::fcntl(wires_.output(), F_SETFL, before), 0);
  // Nor does the input wait.
  ASSERT_EQ(::fcntl(wires_.input(), F_SETFL, ::fcntl(wires_.input(), F_GETFL) | O_NONBLOCK), 0);
  Begin();
  Initialize();
  ExpectItAnswers(2);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
  EXPECT_EQ(::fcntl(wires_.output(), F_GETFL), before);
}

// A folder can be opened, and nothing can be read of it.
TEST_F(Stdio, AnInputThatCannotBeReadEndsIt) {
  const int folder = ::open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_GE(folder, 0);
  EXPECT_EQ(RunOnDescriptors(folder, wires_.output()), 1);
  ::close(folder);
}

class StdioOnASocket : public Stdio {
 protected:
  StdioOnASocket() : Stdio(Wires::Kind::kSocket) {}
};

TEST_F(StdioOnASocket, ItIsAWireAsWell) {
  const int before = ::fcntl(wires_.output(), F_GETFL);
  Begin();
  Initialize();
  EXPECT_EQ(::fcntl(wires_.output(), F_GETFL), before | O_NONBLOCK);
  ExpectItAnswers(2);
  Send("shutdown", nullptr, 3);
  EXPECT_EQ(Answer()["id"], 3);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 0);
  EXPECT_EQ(::fcntl(wires_.output(), F_GETFL), before);
}

// A file is shared with others and stays as it is, while it is written to as well.
TEST_F(Stdio, AFileIsNoWire) {
  std::string name = (std::filesystem::temp_directory_path() / "stdio_XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_APPEND);
  ASSERT_GE(file, 0);
  const int before = ::fcntl(file, F_GETFL);
  std::packaged_task<int()> run([&] { return RunOnDescriptors(wires_.input(), file); });
  std::future<int> code = run.get_future();
  std::thread session(std::move(run));
  Send("nothing/of/this", Json::object(), 1);
  while (std::filesystem::file_size(name) == 0) std::this_thread::yield();
  EXPECT_EQ(::fcntl(file, F_GETFL), before);
  Send("exit", nullptr);
  EXPECT_EQ(code.get(), 1);
  EXPECT_EQ(::fcntl(file, F_GETFL), before);
  session.join();
  ::close(file);
  std::filesystem::remove(name);
}

// A child in place of the editor, which ends when it is let go.
class Somebody {
 public:
  Somebody() {
    EXPECT_EQ(::pipe(held_.data()), 0);
    process_ = ::fork();
    if (process_ != 0) return;
    ::close(held_[1]);
    char none = 0;
    static_cast<void>(::read(held_[0], &none, 1));
    ::_exit(0);
  }
  Somebody(const Somebody&) = delete;
  Somebody& operator=(const Somebody&) = delete;
  ~Somebody() {
    LetGo();
    ::waitpid(process_, nullptr, 0);
    ::close(held_[0]);
  }
  pid_t process() const { return process_; }
  void LetGo() {
    if (held_[1] >= 0) ::close(std::exchange(held_[1], -1));
  }

 private:
  std::array<int, 2> held_{};
  pid_t process_ = -1;
};

TEST_F(Stdio, ItDoesNotOutliveWhoStartedIt) {
  Somebody parent;
  Begin();
  Initialize(parent.process());
  ExpectItAnswers(2);
  parent.LetGo();
  EXPECT_EQ(Code(), 1);
}

// With no input of its own the first descriptor is free, and so it is behind the session.
TEST_F(Stdio, TheFirstDescriptorIsGivenBack) {
  const Somebody parent;
  const int kept = ::dup(STDIN_FILENO);
  ::close(STDIN_FILENO);
  Begin();
  Initialize(parent.process());
  ExpectItAnswers(2);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
  EXPECT_EQ(::fcntl(STDIN_FILENO, F_GETFD), -1);
  if (kept >= 0) {
    ::dup2(kept, STDIN_FILENO);
    ::close(kept);
  }
}

// A number that no process can have says nothing, nor does a process of which nothing is known.
TEST_F(Stdio, NumbersOfNoProcessSayNothing) {
  Somebody parent;
  Begin();
  Initialize(std::int64_t{parent.process()} + (std::int64_t{1} << 32));
  parent.LetGo();
  ExpectItAnswers(2);
  ExpectItAnswers(3);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 1);
}
TEST_F(Stdio, AProcessThatIsGoneSaysNothing) {
  pid_t gone = 0;
  {
    const Somebody nobody;
    gone = nobody.process();
  }
  Begin();
  Initialize(gone);
  ExpectItAnswers(2);
  ExpectItAnswers(3);
  Send("shutdown", nullptr, 4);
  EXPECT_EQ(Answer()["id"], 4);
  Send("exit", nullptr);
  EXPECT_EQ(Code(), 0);
}

// A signal that interrupts its wait is no end.
TEST_F(Stdio, ASignalDoesNotEndIt) {
  struct sigaction mine {};
  mine.sa_handler = [](int) {};
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGUSR1, &mine, &before), 0);
  Begin();
  Initialize();
  for (int id = 2; id <= 40; ++id) {
    ASSERT_EQ(::pthread_kill(session_.native_handle(), SIGUSR1), 0);
    ExpectItAnswers(id);
  }
  // Nor does it hide the end of the input.
  for (int times = 0; times < 40; ++times) {
    ASSERT_EQ(::pthread_kill(session_.native_handle(), SIGUSR1), 0);
    std::this_thread::yield();
  }
  wires_.HangUp();
  EXPECT_EQ(Code(), 1);
  ASSERT_EQ(::sigaction(SIGUSR1, &before, nullptr), 0);
}

}  // namespace
}  // namespace rmlcell::lsp
