// A whole server in this process: what keeps it from starting, and what is left when it has ended.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/types.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "grpc/health/v1/health.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/project.grpc.pb.h"
#include "server/base/log.h"
#include "server/cell/cell.h"
#include "server/records/machine_options.h"
#include "storage/opening/open_store.h"
#include "tests/storage/store_conformance.h"

namespace rmlcell::server {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

class CellStartTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(::mkdtemp(folder_.data()), nullptr); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // A store of its own, any port, no worker, no machine that lives.
  Config Alone(const std::string& name) const {
    Config config;
    config.listen_grpc = {"127.0.0.1:0"};
    config.listen_web = "";
    config.state_directory = folder_ + "/" + name;
    config.machines_hosts = "enabled";
    config.workers_count = 0;
    config.workers_program = "/bin/true";
    config.machines = {{"mill-1", "rml1", "srm-20", "A mill"},
                       {"mill-2", "rml1", "srm-20", "Another"}};
    return config;
  }
  static Error Refusal(const Config& config) {
    const auto cell = Cell::Start(config);
    return cell ? Error{ErrorCode::kCellInternal, "it has started", {}} : cell.error();
  }
  // While no server has it.
  static Result<std::unique_ptr<storage::Store>> StoreOf(const Config& config) {
    storage::StoreChoice choice;
    choice.directory = config.state_directory;
    choice.keep_record_events = 100;
    return storage::OpenStore(choice);
  }
  // Hosts had these machines when the server of before ended.
  static void PutLeases(const Config& config, bool pinned) {
    const auto store = StoreOf(config);
    ASSERT_TRUE(store) << store.error().detail;
    for (const MachineConfig& machine : config.machines) {
      ASSERT_TRUE((*store)->PutMachine({.id = machine.id,
                                        .family = machine.family,
                                        .title = machine.title,
                                        .profile = machine.profile},
                                       0));
      ASSERT_TRUE((*store)->TakeMachine({.machine = machine.id,
                                         .host = "a host",
                                         .server = "a server",
                                         .duration = std::chrono::minutes(1),
                                         .pinned = pinned}));
    }
  }
  static std::shared_ptr<grpc::Channel> ChannelTo(const Cell& cell) {
    return grpc::CreateChannel(cell.grpc_addresses().front(), grpc::InsecureChannelCredentials());
  }
  static void BePatient(grpc::ClientContext& context) {
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(1));
  }
  // As whoever asks the server hears it.
  static v1::MachineStatus StatusOf(const Cell& cell, const std::string& machine) {
    grpc::ClientContext context;
    BePatient(context);
    v1::GetMachineRequest request;
    request.set_name("machines/" + machine);
    v1::Machine told;
    const grpc::Status status =
        v1::MachineService::NewStub(ChannelTo(cell))->GetMachine(&context, request, &told);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return told.status();
  }
  // As whoever watches the machine hears it first.
  static v1::MachineStatus WatchedStatusOf(const Cell& cell, const std::string& machine) {
    grpc::ClientContext context;
    BePatient(context);
    v1::WatchMachineRequest request;
    request.set_name("machines/" + machine);
    const auto stub = v1::MachineService::NewStub(ChannelTo(cell));
    const auto watch = stub->WatchMachine(&context, request);
    v1::WatchMachineResponse first;
    EXPECT_TRUE(watch->Read(&first));
    context.TryCancel();
    static_cast<void>(watch->Finish());
    return first.status();
  }
  // What it warns of from its start to its end, as far as it says this.
  std::vector<std::string> Warnings(const Config& config, const std::string& of) const {
    const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
    EXPECT_TRUE(StartLog("cell-warns", "warn", "text", folder_ + "/log"));
    EXPECT_TRUE(Cell::Start(config));
    spdlog::drop("cell-warns");
    spdlog::set_default_logger(before);
    std::vector<std::string> told;
    std::ifstream log(folder_ + "/log");
    for (std::string line; std::getline(log, line);) {
      if (line.find(of) != std::string::npos) told.push_back(line.substr(line.find("] ") + 2));
    }
    return told;
  }
  // In place of rmlcell-worker, whether it is to work or to be a host.
  std::string Program(const std::string& what) const {
    const std::string path = folder_ + "/program";
    std::ofstream(path) << "#!/bin/sh\n" << what << "\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

  std::string folder_ = testing::TempDir() + "cell_XXXXXX";
};

TEST_F(CellStartTest, TwoServersShareNoAddress) {
  Config first = Alone("first");
  first.listen_grpc = {"unix:" + folder_ + "/first.sock", "127.0.0.1:0"};
  first.listen_web = "127.0.0.1:0";
  const auto cell = Cell::Start(first);
  ASSERT_TRUE(cell) << cell.error().detail;
  const std::vector<std::string> addresses = (*cell)->grpc_addresses();
  ASSERT_EQ(addresses.size(), 2U);
  EXPECT_EQ(addresses[0], first.listen_grpc[0]);
  EXPECT_THAT(addresses[1], MatchesRegex("127\\.0\\.0\\.1:[1-9][0-9]*"));
  EXPECT_THAT((*cell)->web_address(), MatchesRegex("127\\.0\\.0\\.1:[1-9][0-9]*"));

  Config second = Alone("second");
  second.listen_grpc = {addresses[1]};
  const Error at_port = Refusal(second);
  EXPECT_EQ(at_port.code, ErrorCode::kCellPortUsed);
  EXPECT_EQ(at_port.detail, "cannot listen on " + addresses[1]);
  second.listen_grpc = {"127.0.0.1:0", addresses[1]};
  EXPECT_EQ(Refusal(second).detail, "cannot listen on " + addresses[1]) << "the one that is taken";
  second.listen_grpc = {addresses[0]};
  const Error at_socket = Refusal(second);
  EXPECT_EQ(at_socket.code, ErrorCode::kCellPortUsed);
  EXPECT_EQ(at_socket.detail,
            "cannot listen on " + addresses[0] + ": another server listens there");
  second.listen_grpc = {"127.0.0.1:0"};
  second.listen_web = (*cell)->web_address();
  const Error at_web = Refusal(second);
  EXPECT_EQ(at_web.code, ErrorCode::kCellPortUsed);
  EXPECT_THAT(at_web.detail, StartsWith("web port " + second.listen_web + ": "));
  // None of the three has left anything running.
  second.listen_web = "";
  const auto again = Cell::Start(second);
  ASSERT_TRUE(again) << again.error().detail;
  EXPECT_EQ((*again)->web_address(), "");
}

TEST_F(CellStartTest, TheWebHasAnAddressOfIpv6) {
  std::ifstream file("/proc/net/if_inet6");
  const std::string known{std::istreambuf_iterator<char>(file), {}};
  if (known.find(std::string(31, '0') + "1 ") == std::string::npos) {
    GTEST_SKIP() << "this computer has no ::1";
  }
  Config config = Alone("web");
  config.listen_web = "[::1]:0";
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  EXPECT_THAT((*cell)->web_address(), MatchesRegex("\\[::1\\]:[1-9][0-9]*"));
}

// Brackets belong to an address as a pair.
TEST_F(CellStartTest, AnAddressInHalfABracketIsNone) {
  Config config = Alone("half");
  config.listen_web = "[127.0.0.12:0";
  const Error refused = Refusal(config);
  EXPECT_EQ(refused.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(refused.detail, "web address [127.0.0.12:0 is no literal address with a port");
}

TEST_F(CellStartTest, AMachineThatThereCannotBeStopsTheStart) {
  Config config = Alone("odd");
  config.machines = {{"mill-9", "rml1", "no-such-mill", "Odd"}};
  const Error refused = Refusal(config);
  EXPECT_EQ(refused.code, ErrorCode::kCellConfiguration);
  EXPECT_THAT(refused.detail, StartsWith("machine mill-9: "));
  config.machines = {{"", "rml1", "srm-20", "Nameless"}};  // what the store refuses it says itself
  EXPECT_EQ(Refusal(config).code, ErrorCode::kCellInvalidArgument);
}

TEST_F(CellStartTest, WithoutItsSecretOfHostsThereIsNoServer) {
  const Config config = Alone("secret");
  std::filesystem::create_directories(config.state_directory + "/host.token");
  const Error refused = Refusal(config);
  EXPECT_EQ(refused.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(refused.detail, config.state_directory + "/host.token: Is a directory");
}

// Machines that never lived can wait for it; workers, and machines that had a host, cannot.
TEST_F(CellStartTest, NeedsItsProgramForWhatWasThereAndForWorkers) {
  Config config = Alone("new");
  config.workers_program = folder_ + "/none";
  const std::string missing =
      "workers.program " + config.workers_program + ": No such file or directory";
  config.machines_hosts = "all";
  EXPECT_TRUE(Cell::Start(config));
  config.workers_count = 1;
  const Error worker = Refusal(config);
  EXPECT_EQ(worker.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(worker.detail, missing);

  config.workers_count = 0;
  config.machines_hosts = "enabled";
  config.state_directory = folder_ + "/had";
  PutLeases(config, false);
  const Error host = Refusal(config);
  EXPECT_EQ(host.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(host.detail, missing);
  // The host of a device is no process of this server.
  config.state_directory = folder_ + "/pinned";
  PutLeases(config, true);
  EXPECT_TRUE(Cell::Start(config));
}

// More machines than may live are no reason to serve none; the first of them that does not is told.
TEST_F(CellStartTest, StartsThoughNotAllOfItsMachinesMayLive) {
  Config config = Alone("full");
  config.machines.push_back({"mill-3", "rml1", "srm-20", "A third"});
  config.machines_hosts_max = 1;
  PutLeases(config, false);
  const std::vector<std::string> told = Warnings(config, " does not live: ");
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told.front(), StartsWith("mill-2 does not live: "));
}

// machines.hosts: all of them live, or those whose record says so; what the record says counts. Who
// waits for its host, which never comes here, is starting.
TEST_F(CellStartTest, AMachineLivesWhereItsRecordOrTheConfigurationSaysSo) {
  for (const bool all : {true, false}) {
    Config config = Alone(all ? "all" : "enabled");
    config.machines_hosts = all ? "all" : "enabled";
    v1::MachineOptions otherwise;
    otherwise.set_enabled(!all);
    otherwise.set_disabled(all);
    {
      const auto store = StoreOf(config);
      ASSERT_TRUE(store) << store.error().detail;
      ASSERT_TRUE((*store)->PutMachine({.id = "mill-2",
                                        .family = "rml1",
                                        .title = "Another",
                                        .profile = "srm-20",
                                        .options = BytesOf(otherwise)},
                                       0));
    }
    const auto cell = Cell::Start(config);
    ASSERT_TRUE(cell) << cell.error().detail;
    for (const auto& [machine, lives] : {std::pair("mill-1", all), std::pair("mill-2", !all)}) {
      for (const v1::MachineStatus& told :
           {StatusOf(**cell, machine), WatchedStatusOf(**cell, machine)})
        EXPECT_EQ(told.state() == v1::MACHINE_STATE_STARTING, lives) << machine << all;
    }
  }
}

// A store that is none is not begun anew; the way out is told where there is one.
TEST_F(CellStartTest, ADamagedStoreIsToldWithTheWayOut) {
  const Config damaged = Alone("damaged");
  std::filesystem::create_directories(damaged.state_directory);
  std::ofstream(damaged.state_directory + "/cell.db") << "xy";
  const Error refused = Refusal(damaged);
  EXPECT_EQ(refused.code, ErrorCode::kCellStoreCorrupt);
  EXPECT_THAT(refused.detail, EndsWith("; the server does not start with it. Use another "
                                       "state.directory for an empty store"));
  const auto cell = Cell::Start(Alone("used"));
  ASSERT_TRUE(cell) << cell.error().detail;
  const Error used = Refusal(Alone("used"));
  EXPECT_EQ(used.code, ErrorCode::kCellStoreBusy);
  EXPECT_THAT(used.detail, Not(HasSubstr("state.directory")));
}

// What was made once stays as it is: whoever changes the configuration alone reads that in the log.
TEST_F(CellStartTest, TheLogSaysWhereTheStoreCounts) {
  Config config = Alone("kept");
  config.machines.push_back({"any", "rml1", "", "Any"});
  ASSERT_TRUE(Cell::Start(config));
  config.machines = {{"mill-1", "rml1", "mdx-20", "A mill"},
                     {"mill-2", "rml1", "srm-20", "Another title"},
                     {"any", "optimo", "", "Any"}};
  const std::vector<std::string> wanted = {
      "machine mill-1 is in the store as rml1 srm-20, and the configuration says rml1 mdx-20: "
      "the store counts",
      "machine any is in the store as rml1 , and the configuration says optimo : the store counts"};
  EXPECT_EQ(Warnings(config, ": the store counts"), wanted);
}

// grpc.health.v1: whoever watches over servers hears that this one serves.
TEST_F(CellStartTest, SaysThatItServes) {
  const auto cell = Cell::Start(Alone("serving"));
  ASSERT_TRUE(cell) << cell.error().detail;
  grpc::ClientContext context;
  BePatient(context);
  const grpc::health::v1::HealthCheckRequest request;
  grpc::health::v1::HealthCheckResponse response;
  const grpc::Status status =
      grpc::health::v1::Health::NewStub(ChannelTo(**cell))->Check(&context, request, &response);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.status(), grpc::health::v1::HealthCheckResponse::SERVING);
}

// And that it does so no more, before anything of it ends.
TEST_F(CellStartTest, SaysThatItIsAboutToStop) {
  Config config = Alone("stopping");
  config.shutdown_timeout_s = 60.0;
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  grpc::ClientContext context;
  BePatient(context);
  const auto stub = grpc::health::v1::Health::NewStub(ChannelTo(**cell));
  const auto watch = stub->Watch(&context, grpc::health::v1::HealthCheckRequest());
  grpc::health::v1::HealthCheckResponse told;
  ASSERT_TRUE(watch->Read(&told));
  EXPECT_EQ(told.status(), grpc::health::v1::HealthCheckResponse::SERVING);
  std::jthread stopping([&cell] { (*cell)->Stop(); });
  EXPECT_TRUE(watch->Read(&told));
  EXPECT_EQ(told.status(), grpc::health::v1::HealthCheckResponse::NOT_SERVING);
  context.TryCancel();
  static_cast<void>(watch->Finish());
}

// workers.count and workers.paced: as many of each, and one for each core where nobody says how
// many.
TEST_F(CellStartTest, HasTheWorkersThatAreConfigured) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  struct Case {
    int count, paced, computing, of_all;
  };
  for (const Case& one : {Case{1, 2, 1, 0}, Case{-1, 0, 0, cores}}) {
    Config config = Alone("workers" + std::to_string(one.paced));
    const std::string lives = config.state_directory + ".lives";
    config.workers_program = Program("echo \"[$*]\" >> " + lives + "\nexec sleep 60");
    config.workers_count = one.count;
    config.workers_paced = one.paced;
    const auto cell = Cell::Start(config);
    ASSERT_TRUE(cell) << cell.error().detail;
    int computing = 0;
    int paced = 0;
    int of_all = 0;
    EXPECT_TRUE(storage::Eventually([&] {
      computing = paced = of_all = 0;
      std::ifstream file(lives);
      for (std::string line; std::getline(file, line);) {
        if (line.ends_with(" --pool computing]")) {
          ++computing;
        } else if (line.ends_with(" --pool paced]")) {
          ++paced;
        } else if (line.ends_with("]")) {
          ++of_all;
        }
      }
      return computing + paced + of_all == one.computing + one.paced + one.of_all;
    }));
    EXPECT_EQ(computing, one.computing) << one.count;
    EXPECT_EQ(paced, one.paced) << one.count;
    EXPECT_EQ(of_all, one.of_all) << one.count;
  }
}

// Nothing that works for it goes on behind it.
TEST_F(CellStartTest, ItsWorkersEndWithIt) {
  Config config = Alone("worker");
  const std::string lives = config.state_directory + ".lives";
  config.workers_program = Program("echo $$ > " + lives + "\nexec sleep 60");
  config.workers_count = 1;
  config.workers_paced = 0;
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  pid_t worker = 0;
  ASSERT_TRUE(storage::Eventually([&] {
    std::ifstream file(lives);
    return static_cast<bool>(file >> worker);
  }));
  EXPECT_EQ(::kill(worker, 0), 0);
  (*cell)->Stop();
  EXPECT_EQ(::kill(worker, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

// shutdown.timeout_s: a call that goes on keeps nobody from stopping; it is ended.
TEST_F(CellStartTest, StopsThoughACallGoesOn) {
  Config config = Alone("goes-on");
  config.shutdown_timeout_s = 0.1;
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  grpc::ClientContext context;
  BePatient(context);
  const auto stub = grpc::health::v1::Health::NewStub(ChannelTo(**cell));
  const auto watch = stub->Watch(&context, grpc::health::v1::HealthCheckRequest());
  grpc::health::v1::HealthCheckResponse told;
  ASSERT_TRUE(watch->Read(&told));
  (*cell)->Stop();
  while (watch->Read(&told)) {
  }
  EXPECT_FALSE(watch->Finish().ok());
}

// A host that ends again and again is not begun for ever: whoever looks at its machine reads why.
TEST_F(CellStartTest, AMachineWhoseHostAlwaysEndsIsOff) {
  Config config = Alone("ends");
  config.machines = {{"mill-1", "rml1", "srm-20", "A mill"}};
  config.machines_hosts = "all";
  config.workers_program = Program("exit 1");
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  v1::MachineStatus status;
  EXPECT_TRUE(storage::Eventually([&] {
    status = StatusOf(**cell, "mill-1");
    return status.state() == v1::MACHINE_STATE_OFF;
  }));
  EXPECT_THAT(status.off_reason().message(),
              HasSubstr("its host ended 5 times within a minute, the last time with code 1"));
}

// LIVE-5.02: whoever hands a RUN in is told why it waits.
TEST_F(CellStartTest, ARunThatIsHandedInSaysWhyItWaits) {
  const auto cell = Cell::Start(Alone("waits"));
  ASSERT_TRUE(cell) << cell.error().detail;
  grpc::ClientContext context;
  BePatient(context);
  v1::SubmitJobRequest request;
  request.mutable_job()->set_kind(v1::JOB_KIND_RUN);
  request.mutable_job()->set_machine("machines/mill-1");
  request.mutable_job()->mutable_inline_program()->set_file_name("a.rml");
  request.mutable_job()->mutable_inline_program()->set_content("PA;PU100,0;");
  v1::Job job;
  const grpc::Status status =
      v1::JobService::NewStub(ChannelTo(**cell))->SubmitJob(&context, request, &job);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_GT(job.start_blockers_size(), 0);
  EXPECT_EQ(job.start_blockers(job.start_blockers_size() - 1).code(),
            CodeText(ErrorCode::kCellNotLive));  // it has no host
}

// limits.message_bytes: a call that is longer than 4 MiB, as long as gRPC takes them by itself, is
// heard. Notes are up to 64 KiB.
TEST_F(CellStartTest, HearsMessagesAsLongAsItIsConfigured) {
  Config config = Alone("long");
  config.limit_message_bytes = 8 << 20;
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  grpc::ClientContext context;
  BePatient(context);
  v1::CreateProjectRequest request;
  request.set_project_id("door");
  request.mutable_project()->set_notes(std::string(5 << 20, 'n'));
  v1::Project made;
  const grpc::Status status =
      v1::ProjectService::NewStub(ChannelTo(**cell))->CreateProject(&context, request, &made);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
}

TEST_F(CellStartTest, LeavesNothingBehind) {
  Config config = Alone("one");
  const std::string socket = folder_ + "/one.sock";
  config.listen_grpc = {"unix:" + socket};
  config.listen_web = "127.0.0.1:0";
  config.machines_hosts = "all";  // and are looked at all the time
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  EXPECT_TRUE(std::filesystem::is_socket(socket));
  EXPECT_TRUE(std::filesystem::exists(config.state_directory + "/private"));
  EXPECT_NE((*cell)->web_address(), "");
  (*cell)->Stop();
  EXPECT_FALSE(std::filesystem::exists(socket));
  EXPECT_FALSE(std::filesystem::exists(config.state_directory + "/private"));
  EXPECT_EQ((*cell)->web_address(), "");
  // The store is free, and who stops once more stops nothing of the next one.
  const auto next = Cell::Start(config);
  ASSERT_TRUE(next) << next.error().detail;
  (*cell)->Stop();
  EXPECT_TRUE(std::filesystem::is_socket(socket));
  EXPECT_TRUE(std::filesystem::exists(config.state_directory + "/private"));
}

}  // namespace
}  // namespace rmlcell::server
