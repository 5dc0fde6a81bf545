// Processes that a server starts, and work that waits for a thread.
#include "server/base/child_process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <semaphore>
#include <string>

#include "server/base/executor.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::Not;

class ChildProcessTest : public testing::Test {
 protected:
  ChildProcessTest()
      : folder_(testing::TempDir() + "/child-process-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ChildProcessTest() override { std::filesystem::remove_all(folder_); }
  std::string File(const std::string& name) const { return folder_ + "/" + name; }
  std::string Script(const std::string& what) const {
    std::ofstream(File("script")) << "#!/bin/sh\n" << what << "\n";
    ::chmod(File("script").c_str(), 0700);
    return File("script");
  }
  std::string Told(const std::string& name) const {
    std::ifstream file(File(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Its exit code.
  static int Run(const std::vector<std::string>& words, const std::vector<std::string>& secrets,
                 const std::string& log = {}) {
    const Result<pid_t> process = StartChild(words, secrets, log);
    EXPECT_TRUE(process);
    int how = 0;
    if (!process || ::waitpid(*process, &how, 0) != *process) return -1;
    return WIFEXITED(how) ? WEXITSTATUS(how) : -1;
  }
  const std::string folder_;
};

// It has what it was told, and its secrets, and no file of the server but the first three.
TEST_F(ChildProcessTest, HasWhatItIsGiven) {
  ::setenv("RMLCELL_SECRET", "of the server", 1);
  ::setenv("RMLCEL", "is no secret", 1);
  const int open = ::open(File("kept").c_str(), O_RDWR | O_CREAT, 0600);  // without O_CLOEXEC
  ASSERT_GE(open, 3);
  const std::string script =
      Script("env > $1.env\nls /proc/self/fd > $1.files\necho out\necho err >&2\nexit 7");
  EXPECT_EQ(Run({script, File("it")}, {"RMLCELL_JOIN_TOKEN=secret"}, File("log")), 7);
  EXPECT_THAT(Told("it.env"), HasSubstr("RMLCELL_JOIN_TOKEN=secret\n"));
  EXPECT_THAT(Told("it.env"), HasSubstr("RMLCEL=is no secret\n"));
  EXPECT_THAT(Told("it.env"), Not(HasSubstr("RMLCELL_SECRET")));
  EXPECT_THAT(Told("it.files"), HasSubstr("0\n1\n2\n"));
  EXPECT_THAT(Told("it.files"),
              Not(HasSubstr(std::to_string(open) + "\n" + std::to_string(open + 1))));
  EXPECT_EQ(Told("log"), "err\n");
  EXPECT_EQ(Run({script, File("it")}, {}, File("log")), 7);
  EXPECT_EQ(Told("log"), "err\nerr\n");  // behind what was there
  struct stat log {};
  ASSERT_EQ(::stat(File("log").c_str(), &log), 0);
  EXPECT_EQ(log.st_mode & 0777, 0600U);
  ::close(open);
  ::unsetenv("RMLCELL_SECRET");
  ::unsetenv("RMLCEL");
}

// Ctrl-C at a terminal is for the server alone; what a child is sent it hears, whatever the thread
// that started it does not.
TEST_F(ChildProcessTest, IsInAGroupOfItsOwnAndHearsEachSignal) {
  const std::string script = Script(
      "echo $$ > $1.own\ncut -d ' ' -f 5 /proc/$$/stat > $1.group\n"
      "exec grep SigBlk /proc/self/status > $1.blocked");
  sigset_t blocked;
  sigset_t before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  ASSERT_EQ(pthread_sigmask(SIG_BLOCK, &blocked, &before), 0);
  const int code = Run({script, File("it")}, {});
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(code, 0);
  EXPECT_NE(Told("it.own"), "");
  EXPECT_EQ(Told("it.group"), Told("it.own"));
  EXPECT_EQ(Told("it.blocked"), "SigBlk:\t0000000000000000\n");
}

// As long as it lives a file stands where this process has one of its first three.
class InPlaceOf {
 public:
  InPlaceOf(int number, const std::string& file)
      : number_(number), before_(::fcntl(number, F_DUPFD_CLOEXEC, 10)) {
    const int open = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    EXPECT_EQ(::dup2(open, number), number);
    ::close(open);
  }
  ~InPlaceOf() {
    if (before_ < 0) {
      ::close(number_);
      return;
    }
    ::dup2(before_, number_);
    ::close(before_);
  }
  InPlaceOf(const InPlaceOf&) = delete;
  InPlaceOf& operator=(const InPlaceOf&) = delete;

 private:
  const int number_;
  const int before_;
};

// With a log it reads nothing, and what it says beside goes nowhere, whatever its server has there.
TEST_F(ChildProcessTest, HasNoInputBesideItsLog) {
  const std::string script = Script("cat > $1.input\necho out && touch $1.said\nexit 0");
  std::ofstream(File("typed")) << "for the server\n";
  {
    const InPlaceOf input(STDIN_FILENO, File("typed"));
    const InPlaceOf output(STDOUT_FILENO, File("printed"));
    EXPECT_EQ(Run({script, File("it")}, {}, File("log")), 0);
  }
  EXPECT_TRUE(std::filesystem::exists(File("it.input")));
  EXPECT_EQ(Told("it.input"), "");
  EXPECT_TRUE(std::filesystem::exists(File("it.said")));
  EXPECT_EQ(Told("printed"), "");
  EXPECT_EQ(Told("log"), "");
}

TEST_F(ChildProcessTest, OfNoProgramThereIsNone) {
  const std::string there = Script("exit 0");
  errno = EIO;  // of something that failed before
  EXPECT_TRUE(CheckProgram(there));
  const auto why = [](const std::string& program) {
    const Status checked = CheckProgram(program);
    EXPECT_FALSE(checked);
    EXPECT_TRUE(checked || checked.error().code == ErrorCode::kCellConfiguration);
    return checked ? "" : std::string(checked.error().detail);
  };
  EXPECT_EQ(why(File("none")), "workers.program " + File("none") + ": No such file or directory");
  EXPECT_EQ(why(folder_), "workers.program " + folder_ + ": Permission denied");
  const Result<pid_t> process = StartChild({File("none")}, {});
  ASSERT_FALSE(process);
  EXPECT_EQ(process.error().code, ErrorCode::kCellInternal);
}

// As many may wait as it was told; what was refused does not wait, and what began does not either.
TEST(ExecutorWaits, ForSoManyAndNotMore) {
  std::counting_semaphore<> goes_on(0);
  std::counting_semaphore<> began(0);
  Executor executor(1, 2);
  const auto blocks = [&] {
    began.release();
    goes_on.acquire();
  };
  for (int round = 0; round < 3; ++round) {
    executor.Post(blocks);
    began.acquire();
    EXPECT_TRUE(executor.TryPost(blocks));
    EXPECT_TRUE(executor.TryPost(blocks));
    EXPECT_FALSE(executor.TryPost(blocks));
    EXPECT_FALSE(executor.TryPost(blocks));
    goes_on.release(3);
    began.acquire();
    began.acquire();
    std::binary_semaphore done(0);
    executor.Post([&] { done.release(); });  // all of before is over
    done.acquire();
  }
}

}  // namespace
}  // namespace rmlcell::server
