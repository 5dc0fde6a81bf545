// The process of a host, as its server sees it (live.md 3.06, 3.07, 5.09).
#include "server/host/host_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "server/host/host_name.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {
namespace {

class HostProcessTest : public testing::Test {
 protected:
  HostProcessTest() : folder_(testing::TempDir() + "/host-process-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/a");
    server_->Welcome(WelcomeOf("rml1", 7));
  }
  ~HostProcessTest() override {
    stopping_ = true;
    if (host_.valid()) host_.wait();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  static v1::HostWelcome WelcomeOf(const std::string& family, std::int64_t fence) {
    v1::HostWelcome welcome;
    welcome.set_fence(fence);
    welcome.mutable_lease()->set_seconds(60);
    welcome.set_family(family);
    welcome.set_profile("srm-20");
    return welcome;
  }
  void Run() {
    host_ = std::async(std::launch::async, [this] {
      return RunHost({.server = server_->address(),
                      .join_token = "let me in",
                      .machine = "machines/mill-1",
                      .journal = folder_ + "/mill-1.journal",
                      .patience = PatientHost()},
                     stopping_);
    });
  }
  void Live() {
    v1::HostResponse memory;
    memory.mutable_memory()->set_whole(true);
    server_->Tell(memory);
    server_->Told(v1::HostRequest::kStatus, 1);
  }
  void Start() {
    Run();
    Live();
  }
  v1::HostOrderAnswer AnswerTo(std::int64_t number) {
    v1::HostResponse order;
    order.mutable_order()->set_number(number);
    v1::AcquireControlRequest& acquire = *order.mutable_order()->mutable_acquire_control();
    acquire.mutable_ttl()->set_seconds(60);
    acquire.set_client("a test");
    server_->Tell(order);
    const auto answers = server_->Told(v1::HostRequest::kAnswer, static_cast<std::size_t>(number));
    EXPECT_EQ(answers.back().answer().number(), number);
    return answers.back().answer();
  }
  void TellStop() {
    v1::HostResponse stop;
    stop.mutable_stop()->set_reason("a test");
    server_->Tell(stop);
  }
  void TellLeaseLost() {
    v1::HostResponse lost;
    lost.mutable_lease_lost()->set_holder("workshop/2");
    server_->Tell(lost);
  }
  std::size_t HandedBack() { return server_->Told(v1::HostRequest::kHandBack, 0).size(); }

  const std::string folder_;
  std::unique_ptr<FakeHostServer> server_;
  std::atomic<bool> stopping_ = false;
  std::future<int> host_;
};

// It says who it is, refuses orders until it has its machine, and hands it back.
TEST_F(HostProcessTest, AHostLivesAndHandsItsMachineBack) {
  Run();
  const v1::HostHello hello = server_->Told(v1::HostRequest::kHello, 1)[0].hello();
  EXPECT_EQ(hello.join_token(), "let me in");
  EXPECT_EQ(hello.machine(), "machines/mill-1");
  const std::string name = NameOfHost();  // its end is another one each time
  const std::size_t fixed = name.rfind('/') + 1;
  EXPECT_EQ(hello.host().substr(0, fixed), name.substr(0, fixed));
  EXPECT_EQ(hello.fence(), 0);
  EXPECT_FALSE(hello.has_journal_mark());
  const v1::HostOrderAnswer early = AnswerTo(1);
  EXPECT_EQ(early.refusal().symbol(), "CELL_NOT_LIVE");
  EXPECT_EQ(early.refusal().message(), "the machine is starting");
  Live();
  EXPECT_EQ(server_->Told(v1::HostRequest::kStatus, 1)[0].status().state(), v1::MACHINE_STATE_IDLE);
  const v1::HostOrderAnswer control = AnswerTo(2);
  EXPECT_FALSE(control.has_refusal()) << control.refusal().message();
  EXPECT_FALSE(control.control().control_token().empty());
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/mill-1.journal"));
  EXPECT_EQ(HandedBack(), 0U);
  const auto entries = server_->Told(v1::HostRequest::kEntries, 1);
  EXPECT_EQ(entries[0].entries().entries(0).fence(), 7);
  EXPECT_EQ(entries[0].entries().entries(0).sequence(), 1);
  TellStop();
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(server_->Told(v1::HostRequest::kHandBack, 1)[0].hand_back().fence(), 7);
}

TEST_F(HostProcessTest, OneThatIsToldToStopHandsItsMachineBack) {
  Start();
  stopping_ = true;
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(server_->Told(v1::HostRequest::kHandBack, 1)[0].hand_back().fence(), 7);
}

// Where it has none yet there is nothing to hand back.
TEST_F(HostProcessTest, OneWithoutAMachineJustEnds) {
  Run();
  TellStop();
  EXPECT_EQ(host_.get(), 0);
  server_->AwaitEnds(1);
  stopping_ = true;
  Run();
  EXPECT_EQ(host_.get(), 0);
  server_->AwaitEnds(2);
  stopping_ = false;
  Run();
  TellLeaseLost();
  EXPECT_EQ(host_.get(), 3);
  EXPECT_EQ(HandedBack(), 0U);
}

TEST_F(HostProcessTest, OneThatIsNotTakenEnds) {
  server_->Refuse({grpc::StatusCode::ABORTED, "it is taken"});
  Run();
  EXPECT_EQ(host_.get(), 3);
  server_->Refuse({grpc::StatusCode::UNAUTHENTICATED, "who are you"});
  Run();
  EXPECT_EQ(host_.get(), 69);
  server_->Refuse({grpc::StatusCode::FAILED_PRECONDITION, "of another version"});
  Run();
  EXPECT_EQ(host_.get(), 69);
}

TEST_F(HostProcessTest, AFamilyThatItDoesNotKnowEndsIt) {
  server_->Welcome(WelcomeOf("rml9", 7));
  Run();
  v1::HostResponse memory;
  memory.mutable_memory();
  server_->Tell(memory);  // not whole: it waits for the rest
  EXPECT_TRUE(AnswerTo(1).has_refusal());
  memory.mutable_memory()->set_whole(true);
  server_->Tell(memory);
  EXPECT_EQ(host_.get(), 69);
}

TEST_F(HostProcessTest, AMachineThatIsLostIsLeft) {
  Start();
  TellLeaseLost();
  EXPECT_EQ(host_.get(), 3);
  EXPECT_EQ(HandedBack(), 0U);
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/mill-1.journal.orphan"));
}

// By its fence it is known; under another one the machine is another host's.
TEST_F(HostProcessTest, ALineThatEndsIsTakenUpAgain) {
  Start();
  EXPECT_FALSE(AnswerTo(1).has_refusal());
  server_->EndLine();
  EXPECT_EQ(server_->Told(v1::HostRequest::kHello, 2)[1].hello().fence(), 7);
  EXPECT_EQ(AnswerTo(2).refusal().symbol(), "CELL_LEASE_HELD");
  server_->Welcome(WelcomeOf("rml1", 8));
  server_->EndLine();
  EXPECT_EQ(host_.get(), 3);
  EXPECT_EQ(HandedBack(), 0U);
}

}  // namespace
}  // namespace rmlcell::server
