// A server that never answers keeps nobody for ever: each call with one answer has its time.
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "clients/cli/remote.h"
#include "clients/cli/replay.h"
#include "clients/cli/verbs.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

// Refuses whatever is asked for, and notes the method, with a star where it may take for ever.
class RefusesAll final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    const bool ends =
        context->deadline() < std::chrono::system_clock::now() + std::chrono::hours(24);
    {
      const std::lock_guard lock(mutex_);
      asked_ += context->method().substr(context->method().rfind('/') + 1) + (ends ? " " : "* ");
    }
    return new Refusal;
  }
  std::string Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(asked_, {});
  }

 private:
  struct Refusal final : grpc::ServerGenericBidiReactor {
    Refusal() { Finish({grpc::StatusCode::NOT_FOUND, "none"}); }
    void OnDone() override { delete this; }
  };

  std::mutex mutex_;
  std::string asked_;
};

class CallDeadlines : public testing::Test {
 protected:
  CallDeadlines() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(remote_.server, grpc::InsecureServerCredentials());
    builder.RegisterCallbackGenericService(&service_);
    server_ = builder.BuildAndStart();
  }
  ~CallDeadlines() override { server_->Shutdown(); }

  // What it asks for until it is refused.
  std::string Asked(const std::function<int()>& act) {
    EXPECT_NE(Hear(act).exit_code, 0);
    return service_.Take();
  }
  std::string Said(const std::vector<std::string>& words) {
    return Asked([&] {
      CLI::App app;
      int exit_code = -1;
      AddMachineVerbs(app, remote_, exit_code);
      AddSpecialVerb(app, remote_, exit_code);
      std::vector<std::string> reversed(words.rbegin(), words.rend());
      app.parse(reversed);
      return exit_code;
    });
  }

  CliFolder folder_;
  Remote remote_{.server = "unix:" + folder_.File("s")};
  RefusesAll service_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(CallDeadlines, OfJobs) {
  EXPECT_EQ(Asked([&] { return ShowJob(remote_, "17"); }), "GetJob ");
  EXPECT_EQ(Asked([&] { return Jobs(remote_, "", "", 5); }), "ListJobs ");
  EXPECT_EQ(Asked([&] { return CancelJob(remote_, "17"); }), "CancelJob ");
  EXPECT_EQ(Asked([&] { return HoldJob(remote_, "17"); }), "HoldJob ");
  EXPECT_EQ(Asked([&] { return JobReport(remote_, "17", false); }), "GetJobReport ");
  EXPECT_EQ(Asked([&] { return JobPicture(remote_, "17", ""); }), "GetJobPicture ");
  EXPECT_EQ(Asked([&] { return Replay(remote_, {.what = "17"}); }), "GetJob ");
  SubmitRequest wanted;
  wanted.machine = "m";
  wanted.slot = 7;
  EXPECT_EQ(Asked([&] { return SubmitJob(remote_, wanted); }), "SubmitJob ");
  // What is watched goes on for as long as it takes.
  EXPECT_EQ(Asked([&] { return WatchJob(remote_, "17", 0, false); }), "WatchJob* ");
}

TEST_F(CallDeadlines, OfPrograms) {
  EXPECT_EQ(Asked([&] { return Machines(remote_); }), "ListMachines ");
  EXPECT_EQ(Asked([&] { return Programs(remote_, "m"); }), "ListPrograms ");
  const std::string file = folder_.Put("12.S", "SPEED 5\n");
  EXPECT_EQ(Asked([&] { return PutProgram(remote_, "m", 12, file, {}); }), "PutProgram ");
  EXPECT_EQ(Asked([&] { return DeleteProgram(remote_, "m", 12); }), "DeleteProgram ");
  EXPECT_EQ(Asked([&] { return StaleExecutables(remote_, "m"); }), "ListStaleExecutables ");
  EXPECT_EQ(Said({"special", "m"}), "StoreSpecialPrograms ");
}

TEST_F(CallDeadlines, OfProjects) {
  const std::string file = folder_.Put("door.json", "{\"title\": \"Door\"}");
  EXPECT_EQ(Asked([&] { return Projects(remote_); }), "ListProjects ");
  EXPECT_EQ(Asked([&] { return GetProject(remote_, "door"); }), "GetProject ");
  EXPECT_EQ(Asked([&] { return CreateProject(remote_, "door", file); }), "CreateProject ");
  EXPECT_EQ(Asked([&] { return UpdateProject(remote_, "door", file); }), "UpdateProject ");
  EXPECT_EQ(Asked([&] { return DeleteProject(remote_, "door"); }), "DeleteProject ");
  EXPECT_EQ(Asked([&] { return TransferProject(remote_, "door", "m", false, false); }),
            "TransferProject ");
  EXPECT_EQ(Asked([&] { return TakeProject(remote_, "door", "m", {}, false); }),
            "TransferProjectFromMachine ");
}

TEST_F(CallDeadlines, OfMachines) {
  EXPECT_EQ(Said({"machine", "status", "m"}), "GetMachine ");
  EXPECT_EQ(Said({"machine", "stop", "m"}), "StopMachine ");
  EXPECT_EQ(Said({"machine", "mode", "m", "cycle"}), "AcquireControl ");
  EXPECT_EQ(Said({"machine", "taught", "m"}), "ListTeachEntries ");
  EXPECT_EQ(Said({"machine", "watch", "m"}), "WatchMachine* ");
}

}  // namespace
}  // namespace rmlcell::cli
