// What a host is started with, when it is not started, and what is left of it (live.md 3.01).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/restart_delay.h"
#include "server/machines/host_processes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

// Shell scripts in place of hosts.
class HostsAsProcesses : public testing::Test {
 protected:
  HostProcesses::Options Options(const std::string& what) {
    const std::string path = folder_.File("host");
    std::ofstream(path) << "#!/bin/sh\necho $$ >> " << folder_.File("lives") << "\n"
                        << what << "\n";
    ::chmod(path.c_str(), 0700);
    return {.program = path,
            .server = "127.0.0.1:1",
            .join_token = "secret",
            .journals = folder_.File("journals"),
            .log_level = "info",
            .log_format = "json",
            .is_heard = [this](const std::string&) { return heard_.load(); },
            .gave_up =
                [this](const std::string&, const std::string& why) {
                  const std::lock_guard lock(mutex_);
                  gave_up_ = why;
                },
            .clock = steady_.clock()};
  }
  std::string Text(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(folder_.File(name)).rdbuf();
    return text.str();
  }
  std::vector<pid_t> Lives() {
    std::istringstream text(Text("lives"));
    std::vector<pid_t> lives;
    for (pid_t process = 0; text >> process;) lives.push_back(process);
    return lives;
  }
  std::string Kept(const std::string& name) { return folder_.File("journals") + "/" + name; }
  // One that is started has its log before that returns.
  bool IsStarted() { return std::filesystem::exists(Kept("mill-1.log")); }
  bool LivesAre(std::size_t count) {
    return Eventually([&] { return Lives().size() >= count; });
  }
  bool IsGone(std::size_t life) {
    return Eventually([&] { return ::kill(Lives()[life], 0) != 0; });
  }
  // Until it is given up: the clock goes on when one is gone.
  std::string WhyGivenUp() {
    RestartDelay delay;
    const auto why = [this] {
      const std::lock_guard lock(mutex_);
      return gave_up_;
    };
    for (std::size_t life = 1; life <= 5; ++life) {
      if (!LivesAre(life) || !IsGone(life - 1)) return "no life";
      steady_.Advance(delay.AfterLife({}));
    }
    Eventually([&] { return !why().empty(); });
    return why();
  }

  TestSteadyClock steady_;
  storage::TestDirectory folder_;
  std::atomic<bool> heard_ = false;
  std::mutex mutex_;
  std::string gave_up_;
};

TEST_F(HostsAsProcesses, AHostIsToldItsMachineAndItsServer) {
  HostProcesses processes(Options("echo \"$@\" > " + folder_.File("said") + "\nenv > " +
                                  folder_.File("environment") + "\nexec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(Eventually([&] {
    return Text("environment").find("RMLCELL_JOIN_TOKEN=secret\n") != std::string::npos;
  }));
  EXPECT_EQ(Text("said"), "--host machines/mill-1 --server 127.0.0.1:1 --journal " +
                              Kept("mill-1.journal") + " --log-level info --log-format json\n");
  struct stat folder {};
  ASSERT_EQ(::stat(folder_.File("journals").c_str(), &folder), 0);
  EXPECT_EQ(folder.st_mode & 0777, 0700U);
  ::kill(Lives()[0], SIGKILL);
}

// Nobody is started beside a host that is heard of, and one when it is not any more.
TEST_F(HostsAsProcesses, OneThatIsHeardIsNotStarted) {
  heard_ = true;
  HostProcesses processes(Options("exec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  EXPECT_TRUE(processes.IsEnabled("mill-1"));
  EXPECT_FALSE(processes.IsEnabled("mill-2"));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_FALSE(IsStarted());
  heard_ = false;
  ASSERT_TRUE(LivesAre(1));
  ::kill(Lives()[0], SIGKILL);
}

// LIVE-3.01: one that may come back by itself is waited for.
TEST_F(HostsAsProcesses, OneThatMayComeBackIsWaitedFor) {
  HostProcesses processes(Options("exec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1", milliseconds(500)));
  steady_.Advance(milliseconds(499));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_FALSE(IsStarted());
  steady_.Advance(milliseconds(1));
  ASSERT_TRUE(LivesAre(1));
  ::kill(Lives()[0], SIGKILL);
}

// What is there and cannot be begun is tried once a second.
TEST_F(HostsAsProcesses, OneThatCannotBeBegunIsTriedEachSecond) {
  const HostProcesses::Options options = Options("exec sleep 60");
  std::ofstream(options.program) << "#!/no/such/interpreter\n";
  HostProcesses processes(options);
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(steady_.GoneRound());
  Options("exec sleep 60");  // by now it could be
  steady_.Advance(milliseconds(999));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_TRUE(Lives().empty());
  steady_.Advance(milliseconds(1));
  ASSERT_TRUE(LivesAre(1));
  ::kill(Lives()[0], SIGKILL);
}

// Of many four begin at once: the others follow, round by round.
TEST_F(HostsAsProcesses, FourBeginInOneRound) {
  heard_ = true;
  std::atomic<bool> all_are_wanted = false;
  std::mutex counting;
  std::vector<std::size_t> begun;  // behind each round from which on nobody is heard
  HostProcesses::Options options = Options("exec sleep 60");
  options.look = [&] {
    if (!all_are_wanted || heard_.exchange(false)) return;
    std::size_t logs = 0;
    for (int mill = 1; mill <= 6; ++mill)
      logs += std::filesystem::exists(Kept("mill-" + std::to_string(mill) + ".log")) ? 1 : 0;
    const std::lock_guard lock(counting);
    begun.push_back(logs);
  };
  const auto rounds = [&] {
    const std::lock_guard lock(counting);
    return begun;
  };
  HostProcesses processes(options);
  for (int mill = 1; mill <= 6; ++mill)
    ASSERT_TRUE(processes.Enable("mill-" + std::to_string(mill)));
  all_are_wanted = true;
  ASSERT_TRUE(Eventually([&] { return rounds().size() >= 3; }));
  EXPECT_EQ(rounds()[0], 4U);
  EXPECT_EQ(rounds()[1], 6U);
  EXPECT_EQ(rounds()[2], 6U);
  ASSERT_TRUE(LivesAre(6));
  for (const pid_t life : Lives()) ::kill(life, SIGKILL);
}

// It was told to end, and is wanted again before it has: the next one begins as soon as it has.
TEST_F(HostsAsProcesses, TheNextOneFollowsAtOnce) {
  HostProcesses processes(Options("exec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(LivesAre(1));
  processes.Disable("mill-1");
  EXPECT_FALSE(processes.IsEnabled("mill-1"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  ::kill(Lives()[0], SIGKILL);
  ASSERT_TRUE(LivesAre(2));
  // One that nobody has told so is a failed start, and the next one waits a moment.
  ::kill(Lives()[1], SIGKILL);
  ASSERT_TRUE(IsGone(1));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_EQ(Lives().size(), 2U);
  steady_.Advance(RestartDelay().AfterLife({}));
  ASSERT_TRUE(LivesAre(3));
  ::kill(Lives()[2], SIGKILL);
}

// What failed before it was told to end is forgotten with it.
TEST_F(HostsAsProcesses, TheNextOneBeginsWithItsOwnDelay) {
  HostProcesses processes(Options("exec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  RestartDelay delay;
  for (std::size_t life = 1; life <= 2; ++life) {
    ASSERT_TRUE(LivesAre(life));
    ::kill(Lives()[life - 1], SIGKILL);
    ASSERT_TRUE(IsGone(life - 1));
    steady_.Advance(delay.AfterLife({}));
  }
  ASSERT_TRUE(LivesAre(3));
  processes.Disable("mill-1");
  ASSERT_TRUE(processes.Enable("mill-1"));
  ::kill(Lives()[2], SIGKILL);
  ASSERT_TRUE(LivesAre(4));
  ::kill(Lives()[3], SIGKILL);
  ASSERT_TRUE(IsGone(3));
  steady_.Advance(RestartDelay().AfterLife({}));
  ASSERT_TRUE(LivesAre(5));
  ::kill(Lives()[4], SIGKILL);
}

// One that is wanted no more is not started again, and takes no room.
TEST_F(HostsAsProcesses, OneThatIsDisabledEnds) {
  HostProcesses::Options options = Options("exec sleep 60");
  options.most = 1;
  HostProcesses processes(std::move(options));
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(LivesAre(1));
  processes.Disable("mill-1");
  const Status full = processes.Enable("mill-2");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().detail, "1 machines live, as many as machines.hosts_max allows");
  ::kill(Lives()[0], SIGKILL);
  EXPECT_TRUE(Eventually([&] { return static_cast<bool>(processes.Enable("mill-2")); }));
  ASSERT_TRUE(LivesAre(2));
  steady_.Advance(std::chrono::seconds(60));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_EQ(Lives().size(), 2U);
  ::kill(Lives()[1], SIGKILL);
}

// Of a machine that is deleted nothing is kept, and of another one all.
TEST_F(HostsAsProcesses, NothingIsLeftOfAMachineThatIsForgotten) {
  HostProcesses processes(Options("exec sleep 60"));
  heard_ = true;
  ASSERT_TRUE(processes.Enable("mill-1"));
  for (const char* kept : {".journal", ".journal.run", ".journal.orphan", ".log"}) {
    std::ofstream(Kept("mill-1" + std::string(kept))) << "kept";
    std::ofstream(Kept("mill-2" + std::string(kept))) << "kept";
  }
  processes.Forget("mill-1");
  EXPECT_FALSE(processes.IsEnabled("mill-1"));
  for (const char* kept : {".journal", ".journal.run", ".journal.orphan", ".log"}) {
    EXPECT_FALSE(std::filesystem::exists(Kept("mill-1" + std::string(kept)))) << kept;
    EXPECT_TRUE(std::filesystem::exists(Kept("mill-2" + std::string(kept)))) << kept;
  }
}

// LIVE-3.02: a host whose machine is that of another one ends with 3, and that is no trouble.
TEST_F(HostsAsProcesses, OneWhoseMachineIsNotItsOwnIsNoTrouble) {
  HostProcesses processes(Options("exit 3"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  RestartDelay delay;
  for (std::size_t life = 1; life <= 7; ++life) {
    ASSERT_TRUE(LivesAre(life));
    ASSERT_TRUE(IsGone(life - 1));
    steady_.Advance(delay.AfterLife({}));
  }
  EXPECT_TRUE(LivesAre(8));
  EXPECT_TRUE(processes.IsEnabled("mill-1"));
}

// LIVE-3.01: what ended it is told, and where more is to be read.
TEST_F(HostsAsProcesses, OneThatIsKilledIsToldToBe) {
  HostProcesses processes(Options("kill -9 $$"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  EXPECT_EQ(WhyGivenUp(),
            "its host ended 5 times within a minute, the last time with signal 9; see " +
                Kept("mill-1.log") + ", then enable it");
}

TEST_F(HostsAsProcesses, OneThatCannotBeIsRefused) {
  HostProcesses::Options options = Options("exec sleep 60");
  options.journals = folder_.File("none") + "/journals";
  HostProcesses nowhere(options);
  const Status refused = nowhere.Enable("mill-1");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(refused.error().detail, options.journals + ": No such file or directory");
  EXPECT_FALSE(nowhere.IsEnabled("mill-1"));
  options = Options("exec sleep 60");
  options.program = folder_.File("nothing");
  HostProcesses none(options);
  EXPECT_EQ(CodeOf(none.Enable("mill-1")), ErrorCode::kCellConfiguration);
  EXPECT_FALSE(none.IsEnabled("mill-1"));
}

// LIVE-3.01: each failed start is waited for longer than the one before.
TEST_F(HostsAsProcesses, OneThatFailsAgainIsWaitedForLonger) {
  HostProcesses processes(Options("exec sleep 60"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  const auto killed = [this](std::size_t life) {
    if (!LivesAre(life)) return false;
    std::filesystem::remove(Kept("mill-1.log"));
    return ::kill(Lives()[life - 1], SIGKILL) == 0 && IsGone(life - 1);
  };
  RestartDelay delay;
  const milliseconds first = delay.AfterLife({});
  const milliseconds second = delay.AfterLife({});
  ASSERT_TRUE(killed(1));
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_FALSE(IsStarted());
  steady_.Advance(first);
  ASSERT_TRUE(killed(2));
  steady_.Advance(first);
  ASSERT_TRUE(steady_.GoneRound());
  EXPECT_FALSE(IsStarted());
  steady_.Advance(second - first);
  ASSERT_TRUE(LivesAre(3));
  ::kill(Lives()[2], SIGKILL);
}

}  // namespace
}  // namespace rmlcell::server
