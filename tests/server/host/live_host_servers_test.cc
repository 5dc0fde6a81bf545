// A host with several servers, as each of them sees it (live.md 3.06, 3.31).
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/host/live_host_bed.h"

namespace rmlcell::server {
namespace {

// Welcomes a host, and says nothing more.
class SilentServer final : public v1::HostService::Service {
 public:
  explicit SilentServer(const std::string& address) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address, CredentialsOfServer());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~SilentServer() override { server_->Shutdown(std::chrono::system_clock::now()); }
  grpc::Status Host(grpc::ServerContext*,
                    grpc::ServerReaderWriter<v1::HostResponse, v1::HostRequest>* stream) override {
    v1::HostRequest request;
    stream->Read(&request);
    v1::HostResponse response;
    response.mutable_welcome()->set_fence(7);
    response.mutable_welcome()->set_family("rml1");
    response.mutable_welcome()->set_profile("srm-20");
    response.mutable_welcome()->mutable_lease()->set_seconds(600);
    const std::lock_guard lock(mutex_);
    stream->Write(response);
    ++hellos_;
    come_.notify_all();
    while (stream->Read(&request)) continue;
    return grpc::Status::OK;
  }
  bool AwaitHellos(int count) {
    std::unique_lock lock(looking_);
    return come_.wait_for(lock, kComesWithin, [&] { return hellos_ >= count; });
  }

 private:
  std::mutex mutex_;  // one line at a time
  std::mutex looking_;
  std::condition_variable_any come_;
  std::atomic<int> hellos_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

class LiveHostServers : public LiveHost {
 protected:
  LiveHostServers() {
    other_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/b");
    other_->Welcome(WelcomeTo("rml1"));
  }
  ~LiveHostServers() override {
    stopping_ = true;
    if (host_.valid()) host_.wait();
    other_.reset();
  }
  void LiveWithBoth(const std::string& family = "rml1") {
    v1::HostWelcome welcome = WelcomeTo(family);
    welcome.add_servers(server_->address());
    welcome.add_servers(other_->address());
    Live(welcome);
    other_->Told(v1::HostRequest::kStatus, 1);
  }
  v1::HostOrderAnswer AskOther(v1::HostOrder order) {
    v1::HostResponse message;
    order.set_number(++asked_);
    order.set_caller("bert");
    *message.mutable_order() = std::move(order);
    other_->Tell(message);
    return other_->Told(v1::HostRequest::kAnswer, static_cast<std::size_t>(asked_)).back().answer();
  }
  // The other one does not take its place: it keeps the line that it has.
  void LoseTheOneThatStores() {
    for (FakeHostServer* server : {server_.get(), other_.get()})
      server->Refuse({grpc::StatusCode::UNAVAILABLE, "away"});
    server_->EndLine();
  }
  std::unique_ptr<FakeHostServer> other_;
  std::int64_t asked_ = 0;
};

// LIVE-3.06: whichever server asks is answered, by the number that it gave; each sees all of it.
TEST_F(LiveHostServers, EachServerMayAsk) {
  LiveWithBoth();
  TakeControl();
  v1::HostOrder where;
  where.mutable_run_state();
  const v1::HostOrderAnswer answer = AskOther(where);
  EXPECT_EQ(answer.number(), 1);
  EXPECT_EQ(answer.run_state().fence(), 7);
  const v1::HostOrderAnswer started = AskOther(StartOf());
  EXPECT_EQ(started.number(), 2);
  EXPECT_FALSE(started.has_refusal()) << started.refusal().message();
  AwaitState(v1::MACHINE_STATE_RUNNING);
  EXPECT_TRUE(AskOther(StopOrder()).has_halt());
  const v1::MachineStatus held = AwaitState(v1::MACHINE_STATE_HELD);
  EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_STOP);
  EXPECT_EQ(server_->Told(v1::HostRequest::kAnswer, 1).size(), 1U);  // its own alone
  EXPECT_EQ(other_->Told(v1::HostRequest::kEntries, 0).size(), 0U);
}

// LIVE-3.31: as long as another server hears it, a run goes on though the one that stores is lost.
TEST_F(LiveHostServers, ARunGoesOnWithTheOtherServer) {
  LiveWithBoth();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitState(v1::MACHINE_STATE_RUNNING);
  LoseTheOneThatStores();
  // More than a second of statuses, while nothing but the other line stands.
  const std::size_t before = other_->Told(v1::HostRequest::kStatus, 0).size();
  for (const v1::HostRequest& told : other_->Told(v1::HostRequest::kStatus, before + 40))
    EXPECT_NE(told.status().state(), v1::MACHINE_STATE_HELD);
}

// LIVE-3.06, LIVE-6.01: a start that is looked at for one server is told to that, though the one
// that stores is lost meanwhile.
TEST_F(LiveHostServers, AStartIsLookedAtForTheOtherServer) {
  LiveWithBoth();
  v1::HostResponse memory;
  v1::AssignedProgram& program = *memory.mutable_memory()->add_programs();
  program.set_slot(6);
  std::string text = "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;";
  for (int turn = 0; turn < 100; ++turn) text += "PD3000,1000,3000,3000,1000,1000;";
  program.set_content(text + "PU0,0;");
  server_->Tell(memory);
  AskWhereItIs();  // it has that by now
  const auto ask = [this](v1::HostOrder order, std::int64_t number) {
    v1::HostResponse message;
    order.set_number(number);
    order.set_caller("bert");
    *message.mutable_order() = std::move(order);
    other_->Tell(message);
  };
  const auto answer_to = [this](std::int64_t number) {
    return AwaitAt(*other_, v1::HostRequest::kAnswer,
                   [number](const v1::HostRequest& one) { return one.answer().number() == number; })
        .answer();
  };
  ask(PreviewOf(6, 200), 1);
  v1::HostOrder where;
  where.mutable_run_state();
  ask(where, 2);
  EXPECT_TRUE(answer_to(2).has_run_state());  // the first is looked at
  LoseTheOneThatStores();
  const v1::HostOrderAnswer preview = answer_to(1);
  EXPECT_TRUE(preview.has_preview()) << preview.refusal().message();
}

// LIVE-3.06, LIVE-7.02: keys are pressed over the other server as well, which sees what they led
// to; what they teach cannot be stored meanwhile, and is refused.
TEST_F(LiveHostServers, TheHandboxGoesOnWithTheOtherServer) {
  LiveWithBoth("optimo");
  v1::HostOrder acquire;
  acquire.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  token_ = AskOther(acquire).control().control_token();
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = AskOther(open).session().name();
  LoseTheOneThatStores();
  server_->Told(v1::HostRequest::kHello, 2);
  std::int64_t keys = 0;
  for (const char* name :
       {"MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "JOB", "1", "2", "ENT", "REC"}) {
    const v1::HostOrderAnswer answer = AskOther(HandboxKey(session, name, ++keys));
    ASSERT_TRUE(answer.has_key()) << name << answer.refusal().message();
  }
  const auto says_so = [](const v1::HostRequest& one) {
    return one.panel().message_code() == CodeText(ErrorCode::kCellStoreUnavailable);
  };
  EXPECT_EQ(AwaitAt(*other_, v1::HostRequest::kPanel, says_so).panel().holder(), "bert");
  EXPECT_TRUE(AskOther(HandboxKey(session, "PREV", ++keys)).has_key());
  EXPECT_EQ(Count(v1::HostRequest::kEdit), 0U);
}

// LIVE-7.02: whichever server comes again sees the handbox, though nothing of it has changed.
TEST_F(LiveHostServers, AServerThatComesAgainSeesTheHandbox) {
  LiveWithBoth("optimo");
  for (FakeHostServer* server : {other_.get(), server_.get()}) {
    server->Told(v1::HostRequest::kPanel, 1);
    const std::size_t before = server->Told(v1::HostRequest::kPanel, 0).size();
    server->EndLine();
    server->Told(v1::HostRequest::kHello, 2);
    const auto shown = server->Told(v1::HostRequest::kPanel, before + 1);
    EXPECT_EQ(shown.back().panel().display(), shown.front().panel().display());
  }
}

// LIVE-3.31: a run that nobody sees is held after a second, and the log says why.
TEST_F(LiveHostServers, ARunThatNobodySeesIsHeld) {
  Live();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitState(v1::MACHINE_STATE_RUNNING);
  server_->Refuse({grpc::StatusCode::UNAVAILABLE, "away"});
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 8);  // 200 ms apart at least
  server_->Refuse(grpc::Status::OK);
  const v1::MachineStatus held = AwaitState(v1::MACHINE_STATE_HELD);
  EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_SERVER_LOST);
  const v1::JournalEntry why =
      AwaitEntry([](const v1::JournalEntry& one) { return one.event().has_message(); });
  EXPECT_THAT(why.event().message().text(),
              testing::HasSubstr(CodeText(ErrorCode::kCellServerLost)));
}

// LIVE-3.31: over a loss that is shorter than its machine allows a run goes on, however long it was
// seen before.
TEST_F(LiveHostServers, ARunGoesOnOverAShortLoss) {
  v1::HostWelcome welcome = WelcomeTo("rml1");
  welcome.mutable_options()->set_server_lost(v1::MachineOptions::SERVER_LOST_GO_ON);
  welcome.mutable_options()->mutable_server_lost_after()->set_seconds(3);
  Live(welcome);
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitStatus([](const v1::MachineStatus& one) { return one.run().run_time_ns() > 4'000'000'000; });
  server_->EndLine();
  server_->AwaitEnds(1);  // a status that comes behind this is of the new line
  const std::size_t before = Count(v1::HostRequest::kStatus);
  EXPECT_EQ(AwaitStatus([](const v1::MachineStatus&) { return true; }, before).state(),
            v1::MACHINE_STATE_RUNNING);
}

// LIVE-3.04: a lease that nobody renews ends: the machine rests before.
TEST_F(LiveHostServers, ARunIsHeldBeforeItsLeaseEnds) {
  v1::HostWelcome welcome = WelcomeTo("rml1");
  welcome.mutable_lease()->set_seconds(8);
  Live(welcome);
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  EXPECT_EQ(AwaitState(v1::MACHINE_STATE_HELD).hold_reason(), v1::HOLD_REASON_MACHINE_LEASE);
}

// LIVE-3.06: a server that says nothing is left, and looked for again.
TEST_F(LiveHostServers, AServerThatIsSilentIsLeft) {
  server_.reset();
  SilentServer silent("unix:" + folder_ + "/silent");
  host_ = std::async(std::launch::async, [this] {
    return RunHost({.server = "unix:" + folder_ + "/silent",
                    .join_token = "let me in",
                    .machine = "machines/m",
                    .journal = JournalPath()},
                   stopping_);
  });
  EXPECT_TRUE(silent.AwaitHellos(2));
  stopping_ = true;
  EXPECT_EQ(host_.get(), 0);
}

}  // namespace
}  // namespace rmlcell::server
