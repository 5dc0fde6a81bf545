// What comes of an answer however large it is or however it comes, and of files that cannot be
// written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/program_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/remote_machines.h"
#include "engine/families/families.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/project.grpc.pb.h"
#include "tests/clients/cli/fake_jobs.h"
#include "tests/clients/cli/fake_machine.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using WholeAnswers = RemoteJobs;

// gRPC by itself takes 4 MiB.
TEST_F(WholeAnswers, AreTakenHoweverLarge) {
  jobs.job.set_name("jobs/17");
  jobs.job.set_title(std::string(std::size_t{5} << 20, 'x'));
  const Told told = Hear([&] { return ShowJob(server.remote(true), "17"); });
  EXPECT_EQ(told.exit_code, 0) << told.errors;
  EXPECT_GT(told.output.size(), std::size_t{5} << 20);
}

// From the first connection on, once.
TEST_F(WholeAnswers, AServerThatIsAwayAtFirstIsToldOnce) {
  const Watched away{{}, {grpc::StatusCode::UNAVAILABLE, "away"}};
  jobs.connections = {away, away, {{End(2, v1::Outcome::KIND_COMPLETED)}, {}}};
  const Told told = Watch();
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "rmlcell: the server is away; watching again when it is back\n");
  EXPECT_EQ(jobs.watches.size(), 3U);
}

// What a server would refuse is told before it is asked.
TEST_F(WholeAnswers, ABlockThatCannotBeIsRefusedHere) {
  SubmitRequest wanted;
  wanted.machine = "m";
  wanted.slot = 1;
  wanted.milling.block = {.stock = "10x10x10", .tool = "flat:3", .material = "wax", .target = {}};
  EXPECT_THAT(Refusal(wanted), HasSubstr("tool.flutes is missing"));
  wanted.milling.block.stock = "10x10";
  EXPECT_THAT(Refusal(wanted), HasSubstr("'10x10' is no block"));
}

// Its own words first, where they are of another kind than what is wrong with the program.
TEST(WholeRefusals, SayWhatTheCallIsRefusedFor) {
  const std::vector<Diagnostic> findings = {{.code = ErrorCode::kNameUndeclared,
                                             .severity = Severity::kCompile,
                                             .detail = "SPEDE",
                                             .file = "12.S",
                                             .where = {.line = 3, .column = 1}}};
  const google::rpc::Status rich =
      bridge::ToRpcStatus({ErrorCode::kCellPrecondition, "it has errors", {}}, findings, {});
  const grpc::Status status(static_cast<grpc::StatusCode>(rich.code()), rich.message(),
                            rich.SerializeAsString());
  const Told told = Hear([&] { return Refused(status, {.server = "127.0.0.1:1"}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors,
              StartsWith("rmlcell: " + rich.message() + "\nrmlcell: 12.S:3:1: error "));
}

// Of a kind of which no finding came along its words, how many there are, and where.
TEST(WholeRefusals, AKindThatIsOnlyCountedHasItsWords) {
  v1::Findings findings;
  v1::GatheredFindings& kind = *findings.add_gathered();
  kind.set_code("OPT-E7011");
  kind.set_severity(v1::SEVERITY_COMPILE);
  kind.set_message("no such name");
  kind.set_count(2);
  kind.mutable_first()->set_line(20);
  kind.mutable_last()->set_line(21);
  findings.set_diagnostics_dropped(2);
  EXPECT_EQ(FindingsText(findings),
            "error OPT-E7011: no such name; declare the name before its first use, or correct the "
            "word (2 times, lines 20 to 21)\n");
}

struct SmallExport final : v1::ProjectService::Service {
  grpc::Status ExportProject(grpc::ServerContext* /*context*/,
                             const v1::ExportProjectRequest* /*request*/,
                             grpc::ServerWriter<v1::ExportProjectResponse>* writer) override {
    v1::ExportProjectResponse part;
    part.set_chunk("archive");
    writer->Write(part);
    return grpc::Status::OK;
  }
};

TEST(WholeFiles, AnArchiveThatCannotBeWritten) {
  const CliFolder folder;
  SmallExport project;
  const FakeServer server(folder, {&project});
  const std::string file = folder.File("none/door.zip");
  const Told told = Hear([&] { return ExportProject(server.remote(), "door", file); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr(file + ": No such file or directory"));
  const Told good =
      Hear([&] { return ExportProject(server.remote(), "door", folder.File("d.zip")); });
  EXPECT_EQ(good.output, "projects/door is in " + folder.File("d.zip") + "\n");
  EXPECT_EQ(folder.Read("d.zip"), "archive");
}

std::ptrdiff_t OpenFilesNow() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// No file stays open, whatever comes of it, and nothing is left of what failed.
TEST(WholeFiles, AreClosedBehindTheirBytes) {
  const CliFolder folder;
  const std::ptrdiff_t before = OpenFilesNow();
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(WriteWholeFile(folder.File("f"), "text"));
  const Status none = WriteWholeFile(folder.File("none/f"), "text");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellFileUnwritable);
  EXPECT_EQ(none.error().detail, folder.File("none/f") + ": No such file or directory");
  EXPECT_EQ(OpenFilesNow(), before);
  EXPECT_THAT(folder.Names(), ElementsAre("f"));
}

// Numbers that a machine does not have are refused by the machine that the file is for.
TEST(WholeFiles, ASlotIsOneOfItsMachine) {
  const CliFolder folder;
  const auto refused = [&](const std::string& name, const char* family) {
    const auto loaded = LoadFiles({}, {"100=" + folder.Put(name, "PU;")}, 0, "");
    ASSERT_FALSE(loaded) << name;
    EXPECT_EQ(loaded.error().code, families::FindFamily(family)->info().no_slot) << name;
    EXPECT_THAT(loaded.error().detail, HasSubstr("program number is 100")) << name;
  };
  refused("a.rml", "rml1");
  refused("a.S", "optimo");
  refused("text", "optimo");
}

// Control is kept for this machine while its axes look for their reference.
class RenewedMachine final : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  grpc::Status RenewControl(Context /*context*/, const v1::RenewControlRequest* request,
                            v1::RenewControlResponse* /*response*/) override {
    renewed = request->machine() + " " + request->control_token();
    return grpc::Status::OK;
  }
  std::string renewed{};
};

TEST(WholeMachines, ControlIsKeptWhileAxesAreZeroed) {
  const CliFolder folder;
  CallNotes calls;
  RenewedMachine machine(calls);
  v1::MachineStatus jogs;
  jogs.set_state(v1::MACHINE_STATE_JOGGING);
  machine.statuses = {jogs, v1::MachineStatus()};
  const FakeServer server(folder, {&machine});
  MachineAct act;
  act.machine = "m";
  EXPECT_EQ(Hear([&] { return ZeroMachine(server.remote(), act); }).exit_code, 0);
  EXPECT_EQ(machine.renewed, "machines/m t");
}

// On a terminal the last line gives way to a new state, and to what is said at the end.
TEST(WholeMachines, TheLineOfAWatchGivesWay) {
  const CliFolder folder;
  CallNotes calls;
  FakeMachine machine(calls);
  const auto tell = [&](v1::MachineState state) {
    machine.watched.emplace_back().mutable_status()->set_state(state);
  };
  tell(v1::MACHINE_STATE_IDLE);
  tell(v1::MACHINE_STATE_RUNNING);
  tell(v1::MACHINE_STATE_RUNNING);
  machine.refused["WatchMachine"] = {grpc::StatusCode::NOT_FOUND, "gone"};
  const FakeServer server(folder, {&machine});
  MachineAct act;
  act.machine = "m";
  std::string output;
  std::string shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    EXPECT_EQ(WatchMachine(server.remote(), act), 3);
    output = testing::internal::GetCapturedStdout();
  });
  EXPECT_EQ(output, "IDLE\nRUNNING\n");
  // Shown three times, taken away before RUNNING and before the end.
  std::size_t cleared = 0;
  for (std::size_t at = 0; (at = shown.find("\r\x1b[K", at)) != std::string::npos; at += 4)
    ++cleared;
  EXPECT_EQ(cleared, 5U) << shown;
  const std::size_t said = shown.find("gone");
  ASSERT_NE(said, std::string::npos);
  EXPECT_LT(shown.rfind("\r\x1b[K"), said);
}

}  // namespace
}  // namespace rmlcell::cli
