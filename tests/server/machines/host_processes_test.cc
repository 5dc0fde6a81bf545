// Hosts as processes: started, started again, given up, and never more than there is room for
// (live.md 3.01).
#include "server/machines/host_processes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/base/restart_delay.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// A host in place of the real one: a shell script that notes that it lives, and as which process,
// then does `what`.
class HostProcessesTest : public testing::Test {
 protected:
  HostProcesses::Options Options(const std::string& what, std::size_t most = 100) {
    const std::string path = folder_.File("host");
    std::ofstream(path) << "#!/bin/sh\necho $2 $$ >> " << lives() << "\n" << what << "\n";
    ::chmod(path.c_str(), 0700);
    return {.program = path,
            .server = "127.0.0.1:1",
            .join_token = "secret",
            .journals = folder_.File("journals"),
            .most = most,
            .log_level = "info",
            .log_format = "json",
            .gave_up =
                [this](const std::string& machine, const std::string& why) {
                  const std::lock_guard lock(mutex_);
                  given_up_.push_back(machine + ": " + why);
                },
            .clock = steady_.clock()};
  }
  std::string lives() { return folder_.File("lives"); }
  // The processes that were started of this machine.
  std::vector<pid_t> Processes(const std::string& machine) {
    std::ifstream file(lives());
    std::vector<pid_t> processes;
    pid_t process = 0;
    for (std::string name; file >> name >> process;)
      if (name == "machines/" + machine) processes.push_back(process);
    return processes;
  }
  std::size_t Lives(const std::string& machine) { return Processes(machine).size(); }
  // The first one that is not counted yet lives, and its end is noticed.
  bool LivesAndDies(const std::string& machine) {
    ++died_;
    return Eventually([&] { return Lives(machine) >= died_; }) &&
           Eventually([&] { return ::kill(Processes(machine)[died_ - 1], 0) != 0; });
  }
  std::vector<std::string> GivenUp() {
    const std::lock_guard lock(mutex_);
    return given_up_;
  }
  // The clock stands while one lives, and goes on until the next one may begin.
  bool LivesBecome(const std::string& machine, std::size_t count) {
    RestartDelay delay;
    while (died_ + 1 < count) {
      if (!LivesAndDies(machine)) return false;
      steady_.Advance(delay.AfterLife({}));
    }
    return Eventually([&] { return Lives(machine) >= count; });
  }

  TestSteadyClock steady_;
  storage::TestDirectory folder_;
  std::mutex mutex_;
  std::vector<std::string> given_up_;
  std::size_t died_ = 0;  // of those that lived, the first so many
};

// LIVE-3.01: five that died within a minute are enough, and a person lets it live again.
TEST_F(HostProcessesTest, OneThatDiesAndDiesIsGivenUp) {
  HostProcesses processes(Options("exit 4"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(LivesBecome("mill-1", 5));
  ASSERT_TRUE(Eventually([&] { return !GivenUp().empty(); }));
  EXPECT_THAT(GivenUp()[0], HasSubstr("mill-1: its host ended 5 times within a minute"));
  EXPECT_THAT(GivenUp()[0], HasSubstr("code 4"));
  EXPECT_FALSE(processes.IsEnabled("mill-1"));
  EXPECT_EQ(Lives("mill-1"), 5U);
  ASSERT_TRUE(LivesAndDies("mill-1"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  EXPECT_TRUE(LivesBecome("mill-1", 9));
  EXPECT_TRUE(processes.IsEnabled("mill-1"));
}

// LIVE-3.01: whoever enables it again has it begin at once and die as often as at first, though it
// was not given up yet.
TEST_F(HostProcessesTest, OneThatIsEnabledAgainBeginsAnew) {
  HostProcesses processes(Options("exec sleep 60"));
  const auto killed = [&](std::size_t life) {
    return Eventually([&] { return Lives("mill-1") >= life; }) &&
           ::kill(Processes("mill-1")[life - 1], SIGKILL) == 0 && LivesAndDies("mill-1");
  };
  ASSERT_TRUE(processes.Enable("mill-1"));
  RestartDelay delay;
  for (std::size_t life = 1; life <= 4; ++life) {
    ASSERT_TRUE(killed(life)) << life;
    if (life < 4) steady_.Advance(delay.AfterLife({}));
  }
  ASSERT_TRUE(processes.Enable("mill-1"));
  ASSERT_TRUE(killed(5));
  steady_.Advance(RestartDelay().AfterLife({}));
  ASSERT_TRUE(killed(6));
  EXPECT_THAT(GivenUp(), IsEmpty());
  EXPECT_TRUE(processes.IsEnabled("mill-1"));
}

// LIVE-3.01: an end in order counts for nothing, and neither do deaths that lie apart.
TEST_F(HostProcessesTest, EndsThatAreNoTroubleAreNotCounted) {
  HostProcesses processes(Options("exit 0"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  EXPECT_TRUE(LivesBecome("mill-1", 8));
  EXPECT_THAT(GivenUp(), IsEmpty());
}

TEST_F(HostProcessesTest, DeathsThatLieApartAreNotCounted) {
  HostProcesses processes(Options("exit 4"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  for (int lives = 1; lives <= 8; ++lives) {
    ASSERT_TRUE(LivesAndDies("mill-1"));
    steady_.Advance(std::chrono::seconds(20));
  }
  EXPECT_THAT(GivenUp(), IsEmpty());
}

// As many as there is room for; one that is there already is no further one.
TEST_F(HostProcessesTest, NoMoreThanThereIsRoomFor) {
  HostProcesses processes(Options("exec sleep 60", 2));
  ASSERT_TRUE(processes.Enable("a"));
  ASSERT_TRUE(processes.Enable("b"));
  EXPECT_EQ(CodeOf(processes.Enable("c")), ErrorCode::kCellResourceExhausted);
  EXPECT_TRUE(processes.Enable("a"));
  ASSERT_TRUE(Eventually([&] { return Lives("a") == 1U && Lives("b") == 1U; }));
  EXPECT_EQ(Lives("c"), 0U);
  for (const char* machine : {"a", "b"})
    for (const pid_t process : Processes(machine)) ::kill(process, SIGKILL);
}

}  // namespace
}  // namespace rmlcell::server
