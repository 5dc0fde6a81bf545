#include "server/jobs/worker_processes.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::Not;

// A worker in place of the real one: a shell script that notes that it lives, then does `what`.
class WorkerProcessesTest : public testing::Test {
 protected:
  WorkerProcesses::Options Options(const std::string& what, int count = 1) {
    const std::string path = folder_.File("worker");
    std::ofstream(path) << "#!/bin/sh\necho $$ >> " << lives() << "\n" << what << "\n";
    ::chmod(path.c_str(), 0700);
    return {.program = path,
            .server = "127.0.0.1:1",
            .join_token = "secret",
            .log_level = "info",
            .log_format = "json",
            .count = count,
            .clock = steady_.clock()};
  }
  std::string lives() { return folder_.File("lives"); }
  std::string Text(const std::string& name) {
    std::ifstream file(folder_.File(name));
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  // Process ids of all that were started, in order.
  std::vector<pid_t> Lives() {
    std::istringstream text(Text("lives"));
    std::vector<pid_t> lives;
    for (pid_t process = 0; text >> process;) lives.push_back(process);
    return lives;
  }
  static bool IsAlive(pid_t process) { return ::kill(process, 0) == 0; }

  storage::TestDirectory folder_;
  TestSteadyClock steady_;  // stands still, unless a test moves it
};

TEST_F(WorkerProcessesTest, StartsSoManyAndEndsThemInOrder) {
  auto processes = Must(WorkerProcesses::Start(Options("exec sleep 60", 3)));
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 3; }));
  for (const pid_t process : Lives()) EXPECT_TRUE(IsAlive(process));
  processes->Stop(std::chrono::seconds(10));  // SIGTERM is enough: its patience never ends
  for (const pid_t process : Lives()) EXPECT_FALSE(IsAlive(process));
  EXPECT_EQ(Lives().size(), 3U);
}

// Each is told its pool.
TEST_F(WorkerProcessesTest, StartsFurtherOnesOfAPool) {
  WorkerProcesses::Options options =
      Options("echo \"[$*]\" >> " + folder_.File("said") + "\nexec sleep 60", 1);
  options.pool = "computing";
  options.further_pool = "paced";
  options.further_count = 2;
  auto processes = Must(WorkerProcesses::Start(std::move(options)));
  const auto said = [&](const std::string& what) {
    const std::string text = Text("said");
    int count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
      ++count;
    return count;
  };
  ASSERT_TRUE(Eventually([&] { return said("]\n") == 3; }));
  EXPECT_EQ(said(" --pool computing]"), 1);
  EXPECT_EQ(said(" --pool paced]"), 2);
  processes->Stop(std::chrono::seconds(10));
}

// Issue "Server and workers": restarts what dies.
TEST_F(WorkerProcessesTest, StartsAnotherForOneThatWasKilled) {
  auto processes = Must(WorkerProcesses::Start(Options("exec sleep 60")));
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 1; }));
  steady_.Advance(std::chrono::seconds(5));  // a healthy life: at once
  ASSERT_TRUE(steady_.GoneRound());
  ::kill(Lives()[0], SIGKILL);
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 2; }));
  EXPECT_NE(Lives()[0], Lives()[1]);
  steady_.Advance(std::chrono::seconds(5));
  ASSERT_TRUE(steady_.GoneRound());
  ::kill(Lives()[1], SIGKILL);
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 3; }));
  processes->Stop(std::chrono::seconds(10));
  EXPECT_FALSE(IsAlive(Lives()[2]));
}

TEST_F(WorkerProcessesTest, StartsOneThatFailsAtOnceMoreAndMoreSlowly) {
  auto processes = Must(WorkerProcesses::Start(Options("exit 3")));
  std::size_t lives = 1;
  for (const int delay_ms : {100, 300, 700}) {
    // A process that was looked after is gone altogether.
    ASSERT_TRUE(Eventually([&] { return Lives().size() == lives && !IsAlive(Lives().back()); }));
    steady_.Advance(std::chrono::milliseconds(delay_ms - 1));
    ASSERT_TRUE(steady_.GoneRound());
    EXPECT_EQ(Lives().size(), lives);
    steady_.Advance(std::chrono::milliseconds(1));
    ++lives;
  }
  ASSERT_TRUE(Eventually([&] { return Lives().size() == lives; }));
}

// What is there and cannot be begun is tried once a second.
TEST_F(WorkerProcessesTest, TriesOneThatCannotBeStartedEachSecond) {
  const WorkerProcesses::Options options = Options("exec sleep 60");
  std::ofstream(options.program) << "#!/no/such/interpreter\n";
  auto processes = Must(WorkerProcesses::Start(options));
  ASSERT_TRUE(steady_.GoneRound());
  Options("exec sleep 60");  // by now it could be
  steady_.Advance(std::chrono::milliseconds(999));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_TRUE(Lives().empty());
  steady_.Advance(std::chrono::milliseconds(1));
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 1; }));
  processes->Stop(std::chrono::seconds(10));
}

TEST_F(WorkerProcessesTest, StartsNoMoreWhenItIsToldSo) {
  auto processes = Must(WorkerProcesses::Start(Options("exec sleep 60", 2)));
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 2; }));
  processes->StartNoMore();
  steady_.Advance(std::chrono::seconds(60));
  ::kill(Lives()[0], SIGKILL);
  processes->Stop(std::chrono::seconds(10));
  EXPECT_EQ(Lives().size(), 2U);
  for (const pid_t process : Lives()) EXPECT_FALSE(IsAlive(process));
}

// What ends as it is asked to is not replaced while the others are waited for.
TEST_F(WorkerProcessesTest, StartsNoneWhileItStops) {
  WorkerProcesses::Options options = Options("case \"$*\" in *stubborn*) trap '' TERM; echo > " +
                                                 folder_.File("ready") + ";; esac\nexec sleep 60",
                                             5);
  options.further_pool = "stubborn";
  options.further_count = 1;
  auto processes = Must(WorkerProcesses::Start(std::move(options)));
  ASSERT_TRUE(Eventually([&] { return Lives().size() == 6 && !Text("ready").empty(); }));
  steady_.Advance(std::chrono::seconds(5));  // a healthy life: the next one starts at once
  std::jthread stopping([&] { processes->Stop(std::chrono::hours(1)); });
  EXPECT_TRUE(Eventually([&] {
    const std::vector<pid_t> all = Lives();
    return std::ranges::count_if(all, IsAlive) == 1;
  }));
  EXPECT_EQ(Lives().size(), 6U);
  steady_.Advance(std::chrono::hours(1));
}

// Patience on both sides of its end, by a clock of the test.
TEST_F(WorkerProcessesTest, KillsWhatDoesNotEnd) {
  auto processes = Must(
      WorkerProcesses::Start(Options("trap 'echo > " + folder_.File("asked") + "' TERM\necho > " +
                                     folder_.File("ready") + "\nwhile :; do sleep 0.05; done")));
  ASSERT_TRUE(Eventually([&] { return !Text("ready").empty(); }));
  std::jthread stopping([&] { processes->Stop(std::chrono::milliseconds(200)); });
  ASSERT_TRUE(Eventually([&] { return !Text("asked").empty(); }));
  steady_.Advance(std::chrono::milliseconds(199));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_TRUE(IsAlive(Lives()[0]));
  steady_.Advance(std::chrono::milliseconds(1));
  stopping.join();
  EXPECT_FALSE(IsAlive(Lives()[0]));
}

TEST_F(WorkerProcessesTest, HandsTheTokenOverInTheEnvironmentAlone) {
  ::setenv("RMLCELL_WORKERS_JOIN_TOKEN", "of the server", 1);
  const auto options = Options("echo \"$@\" > " + folder_.File("arguments") + "\nenv > " +
                               folder_.File("environment") + "\nexec sleep 60");
  auto processes = Must(WorkerProcesses::Start(options));
  ASSERT_TRUE(Eventually([&] {
    return Text("environment").find("RMLCELL_JOIN_TOKEN=secret\n") != std::string::npos;
  }));
  ::unsetenv("RMLCELL_WORKERS_JOIN_TOKEN");
  EXPECT_THAT(Text("arguments"), HasSubstr("--server 127.0.0.1:1"));
  EXPECT_THAT(Text("arguments"), HasSubstr("--log-format json"));
  EXPECT_THAT(Text("arguments"), Not(HasSubstr("secret")));
  EXPECT_THAT(Text("environment"), Not(HasSubstr("of the server")));
}

// A copy of a socket in a worker would keep the port taken, or the line to a client open.
TEST_F(WorkerProcessesTest, AWorkerHasNoFilesOfTheServer) {
  const int file =
      ::open("/dev/null", O_RDONLY);  // without O_CLOEXEC, as some libraries open theirs
  ASSERT_GE(file, 3);
  auto processes =
      Must(WorkerProcesses::Start(Options("ls -l /proc/$$/fd > " + folder_.File("files") +
                                          "\necho > " + folder_.File("done") + "\nexec sleep 60")));
  ASSERT_TRUE(Eventually([&] { return !Text("done").empty(); }));
  ::close(file);
  EXPECT_THAT(Text("files"), Not(HasSubstr(" " + std::to_string(file) + " -> /dev/null")));
}

TEST_F(WorkerProcessesTest, RefusesAProgramThatIsNone) {
  WorkerProcesses::Options options = Options("");
  for (const std::string& path : {folder_.File("nothing"), folder_.File(""), lives()}) {
    std::ofstream(lives()) << "no program";
    options.program = path;
    const auto started = WorkerProcesses::Start(options);
    ASSERT_FALSE(started) << path;
    EXPECT_EQ(started.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(started.error().detail, HasSubstr(path));
  }
  options.count = 0;  // none of its own: it does not matter
  EXPECT_TRUE(WorkerProcesses::Start(options));
}

}  // namespace
}  // namespace rmlcell::server
