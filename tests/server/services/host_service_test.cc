// Lines of those that are no host of this cell, and of hosts that go (proto/rmlcell/v1/host.proto).
#include "server/services/host_service.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>

#include "server/events/event_feed.h"
#include "server/machines/hosts.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class LinesOfStrangers : public testing::Test {
 protected:
  LinesOfStrangers() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::HostService::NewStub(server_->InProcessChannel({}));
  }
  ~LinesOfStrangers() override {
    hosts_.CloseAll();
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  // How a line ends that begins with this.
  grpc::Status EndOf(const v1::HostRequest& first) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const auto stream = stub_->Host(&context);
    stream->Write(first);
    v1::HostResponse nothing;
    EXPECT_FALSE(stream->Read(&nothing)) << nothing.ShortDebugString();
    return stream->Finish();
  }

 private:
  ServerBed bed_;
  EventFeed feed_{bed_.store()};
  Executor executor_{1};
  Gate gate_{"secret"};
  Hosts hosts_{{.store = bed_.store(),
                .feed = feed_,
                .executor = executor_,
                .server = "this server",
                .join_token = "token"}};
  HostService service_{{gate_, executor_, executor_, 1 << 20}, hosts_};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::HostService::Stub> stub_;
};

TEST_F(LinesOfStrangers, AHostSaysHelloFirst) {
  v1::HostRequest dumb;
  dumb.mutable_hand_back();
  const grpc::Status status = EndOf(dumb);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
  EXPECT_NE(status.error_message().find("the first message must be hello"), std::string::npos);
  EXPECT_NE(status.error_message().find("CELL-E9003"), std::string::npos);
}

TEST_F(LinesOfStrangers, AHostThatMayNotJoinIsToldWhy) {
  v1::HostRequest request;
  v1::HostHello& hello = *request.mutable_hello();
  hello.set_join_token("guessed");
  hello.set_machine("machines/optimo-1");
  hello.set_host("hall/1");
  hello.set_computer("hall");
  hello.set_protocol(1);
  const grpc::Status status = EndOf(request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << status.error_message();
  EXPECT_NE(status.error_message().find("CELL-E9310"), std::string::npos);
}

// Whoever takes a machine waits in it until the test lets it go on.
class SlowlyTakingStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<storage::MachineLease> TakeMachine(const storage::MachineClaim& claim) override {
    taking = true;
    goes_on_.wait();
    return ForwardingStore::TakeMachine(claim);
  }
  std::atomic<bool> taking = false;
  std::promise<void> goes_on;

 private:
  std::shared_future<void> goes_on_{goes_on.get_future()};
};

class LinesThatEnd : public testing::Test {
 protected:
  LinesThatEnd() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server = builder.BuildAndStart();
    stub_ = v1::HostService::NewStub(server->InProcessChannel({}));
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
  }
  ~LinesThatEnd() override {
    hosts.CloseAll();
    server->Shutdown(std::chrono::system_clock::now());
    server->Wait();
    executor_.reset();  // what was posted is done
  }

  // A line on which a host of optimo-1 has said hello.
  std::unique_ptr<grpc::ClientReaderWriter<v1::HostRequest, v1::HostResponse>> Open() {
    auto stream = stub_->Host(&context);
    v1::HostRequest request;
    v1::HostHello& hello = *request.mutable_hello();
    hello.set_join_token("token");
    hello.set_machine("machines/optimo-1");
    hello.set_host("hall/1");
    hello.set_computer("hall");
    hello.set_protocol(1);
    EXPECT_TRUE(stream->Write(request));
    return stream;
  }
  bool IsLeft() const { return hosts.IsHosted("optimo-1") && !hosts.IsHeard("optimo-1"); }

 private:
  ServerBed bed_;

 protected:
  grpc::ClientContext context;
  SlowlyTakingStore store{bed_.store()};

 private:
  EventFeed feed_{store};
  std::unique_ptr<Executor> executor_ = std::make_unique<Executor>(1);
  Gate gate_{"secret"};

 protected:
  Hosts hosts{{.store = store,
               .feed = feed_,
               .executor = *executor_,
               .server = "this server",
               .join_token = "token"}};

 private:
  HostService service_{{gate_, *executor_, *executor_, 1 << 20}, hosts};

 protected:
  std::unique_ptr<grpc::Server> server;

 private:
  std::unique_ptr<v1::HostService::Stub> stub_;
};

// hosts.h, IsHeard: its machine is still hosted, since it may come back.
TEST_F(LinesThatEnd, AHostWhoseLineEndsIsNotHeardAnyMore) {
  store.goes_on.set_value();
  const auto stream = Open();
  v1::HostResponse told;
  ASSERT_TRUE(stream->Read(&told));
  EXPECT_TRUE(told.has_welcome());
  EXPECT_TRUE(Eventually([&] { return hosts.IsHeard("optimo-1"); }));
  stream->WritesDone();
  while (stream->Read(&told)) continue;
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_TRUE(Eventually([&] { return IsLeft(); }));
}

// It may be gone before the store has answered that it has the machine.
TEST_F(LinesThatEnd, AHostThatIsGoneBeforeItHasJoinedIsNotHeard) {
  const auto stream = Open();
  EXPECT_TRUE(Eventually([&] { return store.taking.load(); }));
  context.TryCancel();
  server->Shutdown(std::chrono::system_clock::now());  // the line is over when it comes back
  store.goes_on.set_value();
  EXPECT_TRUE(Eventually([&] { return IsLeft(); }));
}

}  // namespace
}  // namespace rmlcell::server
