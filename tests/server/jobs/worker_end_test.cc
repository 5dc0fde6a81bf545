// A worker process that does not end when it is asked to.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "server/jobs/worker_processes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// It is killed, and nothing is left of it: not even what a parent has to take away; so it is where
// nobody has asked before the last that knows of it goes.
TEST(WorkerEnd, LeavesNothingBehind) {
  for (const bool is_asked : {true, false}) {
    storage::TestDirectory folder;
    const std::string program = folder.File("worker");
    std::ofstream(program) << "#!/bin/sh\ntrap '' TERM\necho $$ > " << folder.File("lives.new")
                           << "\nmv " << folder.File("lives.new") << " " << folder.File("lives")
                           << "\nexec sleep 60\n";
    ::chmod(program.c_str(), 0700);
    TestSteadyClock steady;
    auto processes = Must(WorkerProcesses::Start({.program = program,
                                                  .server = "127.0.0.1:1",
                                                  .join_token = "secret",
                                                  .log_level = "info",
                                                  .log_format = "json",
                                                  .count = 1,
                                                  .clock = steady.clock()}));
    pid_t process = 0;
    ASSERT_TRUE(Eventually([&] {
      std::ifstream lives(folder.File("lives"));
      return static_cast<bool>(lives >> process);
    }));
    if (is_asked) {
      processes->Stop(std::chrono::milliseconds(0));
    } else {
      processes.reset();
    }
    EXPECT_NE(::kill(process, 0), 0) << is_asked;
  }
}

}  // namespace
}  // namespace rmlcell::server
