// `rmlcell machine` where it is turned away: nothing is done without control, and nobody waits for
// who does not answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "clients/cli/machine_call.h"
#include "clients/cli/machine_log.h"
#include "clients/cli/remote_machines.h"
#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/handbox.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/clients/cli/fake_machine.h"

namespace rmlcell::cli {
namespace {

using testing::HasSubstr;

bool EndsByItself(const grpc::ServerContext& context) {
  return context.deadline() < std::chrono::system_clock::now() + std::chrono::hours(24);
}

// What was taught, and the taking back of it.
struct TeachBook final : v1::HandboxService::Service {
  grpc::Status ListTeachEntries(grpc::ServerContext* /*context*/,
                                const v1::ListTeachEntriesRequest* /*request*/,
                                v1::ListTeachEntriesResponse* response) override {
    v1::TeachEntry& entry = *response->add_entries();
    entry.set_number(10);
    entry.mutable_step()->set_program(45);
    return grpc::Status::OK;
  }
  grpc::Status UndoTeachEntries(grpc::ServerContext* context,
                                const v1::UndoTeachEntriesRequest* /*request*/,
                                v1::UndoTeachEntriesResponse* /*response*/) override {
    ++undone;
    ends = EndsByItself(*context);
    return refusal;
  }
  int undone = 0;
  bool ends = false;
  grpc::Status refusal{};
};

struct Decisions final : v1::JobService::Service {
  grpc::Status DecideInterrupted(grpc::ServerContext* context,
                                 const v1::DecideInterruptedRequest* /*request*/,
                                 v1::DecideInterruptedResponse* /*response*/) override {
    ++decided;
    ends = EndsByItself(*context);
    return grpc::Status::OK;
  }
  int decided = 0;
  bool ends = false;
};

// As soon as nobody listens any more; only a failing test has the patience.
bool IsLeft(const grpc::ServerContext& context) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!context.IsCancelled() && std::chrono::steady_clock::now() < until)
    std::this_thread::yield();
  return context.IsCancelled();
}

struct EndlessLog final : v1::CellService::Service {
  grpc::Status WatchCell(grpc::ServerContext* context, const v1::WatchCellRequest* /*request*/,
                         grpc::ServerWriter<v1::WatchCellResponse>* writer) override {
    v1::WatchCellResponse message;
    message.set_sequence(2);
    message.mutable_event()->mutable_machine()->mutable_run_begun()->set_run(3);
    writer->Write(message);
    left = IsLeft(*context);
    return grpc::Status::OK;
  }
  std::atomic<bool> left = false;
};

class EndlessStatus final : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  grpc::Status WatchMachine(Context context, const v1::WatchMachineRequest* /*request*/,
                            grpc::ServerWriter<v1::WatchMachineResponse>* writer) override {
    v1::WatchMachineResponse message;
    message.set_sequence(2);
    writer->Write(message);
    left = IsLeft(*context);
    return grpc::Status::OK;
  }
  std::atomic<bool> left = false;
};

// What keys ask for, with a star where it may take for ever.
class TimedPanel final : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  grpc::Status PressPanelKey(Context context, const v1::PressPanelKeyRequest* request,
                             v1::MachineStatus* response) override {
    asked.insert(request->key() + (EndsByItself(*context) ? "" : "*"));
    return FakeMachine::PressPanelKey(context, request, response);
  }
  grpc::Status HeartbeatPanel(Context context, const v1::HeartbeatPanelRequest* request,
                              v1::HeartbeatResponse* response) override {
    asked.insert(EndsByItself(*context) ? "beat" : "beat*");
    return FakeMachine::HeartbeatPanel(context, request, response);
  }
  std::set<std::string> asked{};
};

class MachineTurnedAway : public MachineWords {
 protected:
  MachineTurnedAway() {
    server_.reset();
    server_ = std::make_unique<FakeServer>(
        folder_, std::vector<grpc::Service*>{&machine_, &book_, &decisions_, &log_});
    machine_.statuses[0].set_machine("machines/m");
    machine_.preview.set_preview_token("p");
  }
  // A call may still be answered: the server goes before its services.
  ~MachineTurnedAway() override { server_.reset(); }
  void CutOff() {
    machine_.statuses[0].set_state(v1::MACHINE_STATE_INSPECT);
    machine_.statuses[0].set_cut_off_job("jobs/17");
  }

  TeachBook book_;
  Decisions decisions_;
  EndlessLog log_;
};

constexpr const char* kGoesOn = "start-at m 45/10 --seen inspected";

// Who has control keeps it.
TEST_F(MachineTurnedAway, WhereSomebodyElseHasControl) {
  CutOff();
  machine_.refused["AcquireControl"] = {grpc::StatusCode::FAILED_PRECONDITION, "anna has it"};
  for (const std::string line :
       {"taught m --undo 10", kGoesOn, "start m 7", "mode m cycle", "key m X+"}) {
    const Told told = Say(line);
    EXPECT_EQ(told.exit_code, kConnection) << line;
    EXPECT_EQ(told.errors, "rmlcell: anna has it\n") << line;
    EXPECT_THAT(Calls(), testing::EndsWith("client: \"rmlcell\"\n")) << line;
  }
  EXPECT_EQ(book_.undone, 0);
  EXPECT_EQ(decisions_.decided, 0);
}

TEST_F(MachineTurnedAway, EachAnswerHasItsTime) {
  CutOff();
  EXPECT_EQ(Say(kGoesOn).exit_code, kGood);
  EXPECT_EQ(decisions_.decided, 1);
  EXPECT_TRUE(decisions_.ends);
  EXPECT_EQ(Say("taught m --undo 10").exit_code, kGood);
  EXPECT_EQ(book_.undone, 1);
  EXPECT_TRUE(book_.ends);
}

// Also a key that is held, and each time that somebody says so.
TEST_F(MachineTurnedAway, EachKeyHasItsTime) {
  server_.reset();
  TimedPanel panel(calls_);
  server_ = std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&panel});
  const Told told = Say("key m PAUSE X+ --for 0.2");
  server_.reset();  // before the panel
  EXPECT_EQ(told.exit_code, kGood) << told.errors;
  EXPECT_THAT(panel.asked, testing::ElementsAre("PAUSE", "X+", "beat"));
}

TEST_F(MachineTurnedAway, WhereTheServerRefuses) {
  machine_.refused["GetMachine"] = {grpc::StatusCode::NOT_FOUND, "no such machine"};
  book_.refusal = {grpc::StatusCode::INVALID_ARGUMENT, "not the newest"};
  Told told = Say("start-at m 45/10");
  EXPECT_EQ(told.exit_code, kConnection);
  EXPECT_EQ(told.errors, "rmlcell: no such machine\n");
  EXPECT_EQ(Calls(), "GetMachine name: \"machines/m\"\n");
  told = Say("taught m --undo 10");
  EXPECT_EQ(told.exit_code, kUsage);
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(told.errors, "rmlcell: not the newest\n");
}

// Without words they are shown, and stay as they are.
TEST_F(MachineTurnedAway, OptionsThatAreOnlyShown) {
  EXPECT_THAT(Say("options m").output, HasSubstr("home=off\n"));
  EXPECT_EQ(Calls(), "GetMachine name: \"machines/m\"\n");
}

// Whoever cannot be asked is not waited for.
TEST_F(MachineTurnedAway, NobodyIsAskedTwice) {
  machine_.statuses[0].set_state(v1::MACHINE_STATE_JOGGING);
  machine_.refused["GetMachine"] = {grpc::StatusCode::UNAVAILABLE, "away"};
  EXPECT_FALSE(StatusNow(server_->remote(), "m"));
  EXPECT_EQ(Calls(), "GetMachine name: \"machines/m\"\n");
  AwaitRest(server_->remote(), "m");
  EXPECT_EQ(Calls(), "GetMachine name: \"machines/m\"\n");
  machine_.refused.clear();
  machine_.statuses.resize(3, machine_.statuses[0]);
  machine_.statuses[1].set_state(v1::MACHINE_STATE_STOPPING);
  machine_.statuses[2].set_state(v1::MACHINE_STATE_IDLE);
  AwaitRest(server_->remote(), "m");
  const std::string look = "GetMachine name: \"machines/m\"\n";
  EXPECT_EQ(Calls(), look + look + look);
}

// A log that has no end is left where what has happened is told, and so is the status before it.
TEST_F(MachineTurnedAway, ALogThatGoesOnIsLeft) {
  server_.reset();
  EndlessStatus machine(calls_);
  server_ = std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&machine, &log_});
  const Told told = Say("log m");
  server_.reset();  // behind the last answer
  EXPECT_EQ(told.exit_code, kGood);
  EXPECT_THAT(told.output, testing::EndsWith("  run 3 begins\n"));
  EXPECT_TRUE(machine.left);
  EXPECT_TRUE(log_.left);
}

// What does not belong into a log has no line, whoever did it.
TEST_F(MachineTurnedAway, ALineOfNothingIsNone) {
  v1::CellEvent event;
  event.set_caller("anna");
  event.mutable_machine()->set_virtual_time_ns(5'000'000'000);
  event.mutable_machine()->mutable_changed();
  EXPECT_EQ(MachineLogLine(event), "");
}

}  // namespace
}  // namespace rmlcell::cli
