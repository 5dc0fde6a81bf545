#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <sstream>
#include <utility>

#include "server/base/config.h"
#include "server/base/version.h"
#include "tests/storage/sqlite_bed.h"

// The program itself, asked for its configuration: what is set where, and what it says about
// mistakes.
namespace rmlcell::server {
namespace {

using testing::HasSubstr;

struct Answer {
  int status = -1;
  std::string text;  // of both streams
};

std::string PathOf(const std::string& program) {
  const char* programs = std::getenv("RMLCELL_BIN");  // CTest sets it
  return programs == nullptr ? program : std::string(programs) + "/" + program;
}

// `words` go through the shell; the environment is empty but for `variables`. `heard` is called
// with each line that the program writes.
Answer Ask(const std::string& variables, const std::string& words,
           const std::string& program = "rmlcelld",
           const std::function<void(const std::string&)>& heard = {}) {
  const std::string line =
      "exec env -i HOME=/home/nobody " + variables + " " + PathOf(program) + " " + words + " 2>&1";
  std::FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  Answer answer;
  char room[4096];
  while (std::fgets(room, sizeof room, pipe) != nullptr) {
    answer.text += room;
    if (heard) heard(room);
  }
  const int status = ::pclose(pipe);
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return answer;
}

Config Printed(const std::string& variables, const std::string& words) {
  const Answer answer = Ask(variables, "--print-config " + words);
  EXPECT_EQ(answer.status, 0) << answer.text;
  Config config;
  const Status read = ReadConfigText(answer.text, "printed", config);
  EXPECT_TRUE(read) << read.error().detail << "\n" << answer.text;
  EXPECT_EQ(PrintConfig(config), answer.text);
  return config;
}

TEST(CommandLine, PrintsTheDefaultsWithTheStateDirectoryOfTheUser) {
  EXPECT_EQ(Printed("", "").state_directory, "/home/nobody/.local/state/rmlcell");
  EXPECT_EQ(Printed("XDG_STATE_HOME=/x", "").state_directory, "/x/rmlcell");
  EXPECT_EQ(Printed("XDG_STATE_HOME=/x", "--state.directory \"\"").state_directory, "/x/rmlcell");
}

// conventions.md, command line: a flag goes over the environment, that over the file, that over the
// default.
TEST(CommandLine, AFlagGoesOverTheEnvironmentAndThatOverTheFile) {
  const storage::TestDirectory folder;
  const std::string file = folder.File("a.toml");
  std::ofstream(file) << "[jobs]\nattempts = 3\nqueued_max = 4\nkeep_finished = 5\n";
  const Config config = Printed("RMLCELL_JOBS_ATTEMPTS=6 RMLCELL_JOBS_QUEUED_MAX=7",
                                "--config " + file + " --jobs.attempts 8");
  EXPECT_EQ(config.jobs_attempts, 8);
  EXPECT_EQ(config.jobs_queued_max, 7);
  EXPECT_EQ(config.jobs_keep_finished, 5);
  EXPECT_EQ(config.workers_count, -1);
  EXPECT_EQ(Printed("RMLCELL_CONFIG=" + file, "").jobs_attempts, 3);
}

TEST(CommandLine, EveryKeyIsAFlag) {
  const std::string help = Ask("", "--help").text;
  for (const ConfigKey& key : ConfigKeys())
    EXPECT_THAT(help, HasSubstr("--" + std::string(key.name)));
  const Config config =
      Printed("", "--listen.grpc 127.0.0.1:0,unix:/tmp/x --listen.web \"\" --log.level off");
  EXPECT_EQ(config.listen_grpc, (std::vector<std::string>{"127.0.0.1:0", "unix:/tmp/x"}));
  EXPECT_EQ(config.listen_web, "");
  EXPECT_EQ(config.log_level, "off");
}

// sysexits.h: 64 wrong use, 78 wrong configuration.
TEST(CommandLine, AMistakeIsNamedAndEndsTheProgram) {
  const std::vector<std::tuple<std::string, std::string, int, std::string>> cases = {
      {"", "--jobs.attempts 11", 78, "--jobs.attempts is 11, allowed are 1 to 10"},
      {"", "--log.level loud", 78, "--log.level is 'loud'"},
      {"", "--log.level loud", 78, "CELL-E9201"},
      {"RMLCELL_JOBS_ATTEMPTS=x", "", 78, "RMLCELL_JOBS_ATTEMPTS takes a whole number"},
      {"", "--config /nowhere.toml", 78, "/nowhere.toml"},
      {"", "--config /tmp", 78, "/tmp"},
      {"", "--listen.grpc 0.0.0.0:1", 78, "0.0.0.0:1"},
      {"", "--listen.web 127.0.0.1.example.com:1", 78, "127.0.0.1.example.com:1"},
      {"", "--listen.grpc \"\"", 78, "listen.grpc is empty"},
      {"", "--web.connections_max 3", 78, "CELL-E9201"},
      {"", "--jobs.attempt 1", 64, "--jobs.attempt"},
      {"", "something", 64, "something"},
  };
  for (const auto& [variables, words, status, text] : cases) {
    const Answer answer = Ask(variables, words + " --print-config");
    EXPECT_EQ(answer.status, status) << words;
    EXPECT_THAT(answer.text, HasSubstr(text)) << words;
  }
}

// A file that is not ours stops the start; nothing of it is served, and it stays as it is.
TEST(CommandLine, AStoreOfAnotherProgramStopsTheStart) {
  const storage::TestDirectory folder;
  const std::string path = folder.File("cell.db");
  const std::string foreign = "<html>not a database</html>" + std::string(2'000, ' ');
  std::ofstream(path) << foreign;
  const Answer answer = Ask("", "--listen.grpc 127.0.0.1:0 --listen.web \"\" --state.directory " +
                                    std::filesystem::path(path).parent_path().string());
  EXPECT_EQ(answer.status, 69) << answer.text;
  EXPECT_THAT(answer.text, HasSubstr("CELL-E9104"));
  EXPECT_THAT(answer.text, HasSubstr(path));
  EXPECT_THAT(answer.text, HasSubstr("the server does not start"));
  EXPECT_THAT(answer.text, testing::Not(HasSubstr("still served")));
  std::ostringstream now;
  now << std::ifstream(path).rdbuf();
  EXPECT_EQ(now.str(), foreign);
}

TEST(CommandLine, BothProgramsTellVersionAndUse) {
  for (const char* program : {"rmlcelld", "rmlcell-worker"}) {
    EXPECT_EQ(Ask("", "--version", program).text, std::string(kVersion) + "\n");
    EXPECT_EQ(Ask("", "--version", program).status, 0);
    EXPECT_EQ(Ask("", "--help", program).status, 0);
    EXPECT_THAT(Ask("", "--help", program).text, HasSubstr(program));
    EXPECT_EQ(Ask("", "--no-such-flag", program).status, 64);
  }
  EXPECT_THAT(Ask("", "--help").text, HasSubstr("RMLCELL_WORKERS_COUNT"));
  EXPECT_THAT(Ask("", "--help", "rmlcell-worker").text, HasSubstr("RMLCELL_JOIN_TOKEN"));
}

// A recording that cannot be played ends with 1 and says why; nowhere to put its products is wrong
// use.
TEST(CommandLine, ARecordingThatThereIsNotCannotBePlayed) {
  const storage::TestDirectory folder;
  const std::string into = std::filesystem::path(folder.File("cell.db")).parent_path().string();
  const Answer played =
      Ask("", "--products " + folder.File("none") + " --into " + into, "rmlcell-worker");
  EXPECT_EQ(played.status, 1) << played.text;
  EXPECT_THAT(played.text, HasSubstr("error [products of " + folder.File("none") + " "));
  EXPECT_THAT(played.text, HasSubstr(CodeText(ErrorCode::kCellFileUnreadable)));
  EXPECT_EQ(Ask("", "--products " + folder.File("none"), "rmlcell-worker").status, 64);
}

// A worker of a pool that is none would wait for ever.
TEST(CommandLine, AWorkerIsOfAPoolThatThereIs) {
  const auto answer = Ask("", "--pool pacd", "rmlcell-worker");
  EXPECT_EQ(answer.status, 64);
  EXPECT_THAT(answer.text, HasSubstr("paced"));
}

// The address of gRPC in what a server has written so far.
std::string AddressIn(const std::string& text) {
  const std::size_t at = text.find("gRPC on ");
  const std::size_t begin = at + std::string("gRPC on ").size();
  return at == std::string::npos ? "" : text.substr(begin, text.find('\n', begin) - begin);
}

// It says where it listens, that it is ready, and what stops it; a variable that is nearly one of
// its own is told. Until then a worker with another token is refused.
TEST(CommandLine, TheServerTellsItsLifeAndEndsOnASignal) {
  const storage::TestDirectory folder;
  const std::string state = std::filesystem::path(folder.File("cell.db")).parent_path().string();
  std::string told;
  Answer refused;
  Answer refused_twice;
  const Answer life =
      Ask("RMLCELL_JOBS_ATEMPTS=3",
          "--listen.grpc 127.0.0.1:0 --listen.web 127.0.0.1:0 --workers.count 0 "
          "--log.format text --state.directory " +
              state,
          "rmlcelld", [&](const std::string& line) {
            told += line;
            if (line.find(" is ready, store in " + state) == std::string::npos) {
              return;
            }
            refused = Ask("RMLCELL_JOIN_TOKEN=other", "--name odd --server " + AddressIn(told),
                          "rmlcell-worker");
            refused_twice =
                Ask("RMLCELL_JOIN_TOKEN=other",
                    "--name odd --server " + AddressIn(told) + " --server " + AddressIn(told),
                    "rmlcell-worker");
            const std::size_t process = line.find("[rmlcelld ") + 10;
            ::kill(std::stoi(line.substr(process)), SIGTERM);
          });
  EXPECT_EQ(life.status, 0) << life.text;
  EXPECT_THAT(life.text, HasSubstr("RMLCELL_JOBS_ATEMPTS"));
  EXPECT_THAT(life.text, HasSubstr("gRPC on 127.0.0.1:"));
  EXPECT_THAT(life.text, HasSubstr("web on http://127.0.0.1:"));
  EXPECT_THAT(life.text, HasSubstr("rmlcelld " + std::string(kVersion) + " is ready"));
  EXPECT_THAT(life.text, HasSubstr("stopping on Terminated"));
  EXPECT_THAT(life.text, HasSubstr("] stopped\n"));
  EXPECT_EQ(refused.status, 69);
  EXPECT_THAT(refused.text, HasSubstr("CELL-E9310"));
  // Of several servers each that does not take it is told; of one it is told once.
  EXPECT_THAT(refused.text, testing::Not(HasSubstr("warning [odd ")));
  EXPECT_EQ(refused_twice.status, 69);
  EXPECT_THAT(refused_twice.text, HasSubstr("warning [odd "));
  EXPECT_THAT(refused_twice.text, HasSubstr("error [odd "));
}

// The end of a worker of a server that takes it; the next one that it is told of does not.
// `joined`: with the process of each, and what becomes of the worker.
Answer LifeOfAWorker(const std::function<void(pid_t server, pid_t worker,
                                              const std::future<Answer>& life)>& joined) {
  const storage::TestDirectory folder;
  const std::string state = std::filesystem::path(folder.File("cell.db")).parent_path().string();
  const auto process_behind = [](const std::string& line, const std::string& mark) {
    const std::size_t at = line.find(mark);
    return at == std::string::npos ? 0 : std::stoi(line.substr(at + mark.size()));
  };
  std::string told;
  pid_t server = 0;
  pid_t worker = 0;
  std::future<Answer> life;
  Ask("",
      "--listen.grpc 127.0.0.1:0 --listen.web \"\" --workers.count 0 --workers.join_token word "
      "--log.format text --state.directory " +
          state,
      "rmlcelld", [&](const std::string& line) {
        told += line;
        if (line.find(" is ready, store in " + state) != std::string::npos) {
          server = process_behind(line, "[rmlcelld ");
          const std::string words =
              "--name odd --server " + AddressIn(told) + " --server unix:" + state + "/nobody";
          life = std::async(std::launch::async, [words] {
            return Ask("RMLCELL_JOIN_TOKEN=word", words, "rmlcell-worker");
          });
        }
        worker = std::max(worker, process_behind(line, "worker odd joined (process "));
        if (worker > 0 && server > 0) joined(std::exchange(server, 0), worker, life);
      });
  if (!life.valid()) return {};
  if (life.wait_for(storage::kPatience) != std::future_status::ready) ::kill(worker, SIGKILL);
  return life.get();
}

// It joins the first server that takes it, and ends in order when it is told to.
TEST(CommandLine, AWorkerEndsOnASignal) {
  bool ended = false;
  const Answer life =
      LifeOfAWorker([&](pid_t server, pid_t worker, const std::future<Answer>& end) {
        ::kill(worker, SIGTERM);
        ended = end.wait_for(storage::kPatience) == std::future_status::ready;
        ::kill(server, SIGTERM);
      });
  EXPECT_TRUE(ended);
  EXPECT_EQ(life.status, 0) << life.text;
}

// Whose server is gone has nobody to work for. One that was gone before its welcome came shows
// nothing: it is tried again.
TEST(CommandLine, AWorkerEndsWithItsServer) {
  Answer life;
  for (int left = 5; left > 0; --left) {
    life = LifeOfAWorker([](pid_t server, pid_t /*worker*/, const std::future<Answer>& /*end*/) {
      ::kill(server, SIGKILL);
    });
    if (life.status != 69) break;
  }
  EXPECT_EQ(life.status, 0) << life.text;
}

TEST(CommandLine, WhatCannotBeOpenedStopsTheStart) {
  const storage::TestDirectory folder;
  const std::string state = std::filesystem::path(folder.File("cell.db")).parent_path().string();
  const Answer log = Ask("",
                         "--listen.grpc 127.0.0.1:0 --listen.web \"\" --log.file /proc/no/file "
                         "--state.directory " +
                             state);
  EXPECT_EQ(log.status, 69);
  EXPECT_THAT(log.text, HasSubstr("/proc/no/file"));
  const Answer address =
      Ask("", "--listen.grpc unix:/proc/no/cell.sock --listen.web \"\" --state.directory " + state);
  EXPECT_EQ(address.status, 69);
  EXPECT_THAT(address.text, HasSubstr("rmlcelld: CELL-E9202"));
  EXPECT_THAT(address.text, HasSubstr("cannot listen on unix:/proc/no/cell.sock"));
  const Answer nobody =
      Ask("", "--server unix:" + state + "/nobody --name lonely", "rmlcell-worker");
  EXPECT_EQ(nobody.status, 69);
  EXPECT_THAT(nobody.text, HasSubstr("error [lonely "));
  const Answer nameless =
      Ask("", "--server unix:" + state + "/nobody --name \"\"", "rmlcell-worker");
  EXPECT_EQ(nameless.status, 69);
}

}  // namespace
}  // namespace rmlcell::server
