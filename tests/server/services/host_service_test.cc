// Lines of those that are no host of this cell (proto/rmlcell/v1/host.proto).
#include "server/services/host_service.h"

#include <gtest/gtest.h>

#include "server/events/event_feed.h"
#include "server/machines/hosts.h"
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

}  // namespace
}  // namespace rmlcell::server
