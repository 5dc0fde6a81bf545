#include "server/services/foreign_calls.h"

#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>

#include <chrono>
#include <mutex>

#include "grpc/health/v1/health.grpc.pb.h"
#include "rmlcell/v1/handbox.grpc.pb.h"

namespace rmlcell::server {
namespace {

// A server of gRPC's own services, with a gate that the test opens and closes.
class ForeignCalls : public testing::Test {
 protected:
  ForeignCalls() {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    // gRPC answers its own health calls only where a service of callbacks stands beside them.
    builder.RegisterService(&beside_);
    AdmitForeignCalls(builder, [this](const CallFacts& call) -> Result<Caller> {
      const std::lock_guard lock(mutex_);
      calls_.push_back(call);
      if (!open_) return Error{ErrorCode::kCellPermission, {}, {}};
      return Caller{};
    });
    server_ = builder.BuildAndStart();
    channel_ = grpc::CreateChannel("127.0.0.1:" + std::to_string(port),
                                   grpc::InsecureChannelCredentials());
  }

  grpc::Status Check() {
    grpc::ClientContext context;
    context.AddMetadata("x-request-id", "one");
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    const grpc::health::v1::HealthCheckRequest request;
    grpc::health::v1::HealthCheckResponse response;
    return grpc::health::v1::Health::NewStub(channel_)->Check(&context, request, &response);
  }
  std::vector<CallFacts> calls() {
    const std::lock_guard lock(mutex_);
    return calls_;
  }
  void Close() {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }

 protected:
  std::shared_ptr<grpc::Channel> channel_;

 private:
  std::mutex mutex_;
  bool open_ = true;
  v1::HandboxService::CallbackService beside_;
  std::vector<CallFacts> calls_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ForeignCalls, PassTheGateWithWhatIsKnownOfThem) {
  ASSERT_TRUE(Check().ok());
  ASSERT_EQ(calls().size(), 1U);
  const CallFacts call = calls().front();
  EXPECT_EQ(call.method, "/grpc.health.v1.Health/Check");
  EXPECT_TRUE(call.peer.starts_with("ipv4:127.0.0.1:")) << call.peer;
  ASSERT_EQ(call.metadata.count("x-request-id"), 1U);
  EXPECT_EQ(call.metadata.find("x-request-id")->second, "one");
}

TEST_F(ForeignCalls, AreNotAnsweredWhenTheyAreRefused) {
  Close();
  EXPECT_EQ(Check().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_EQ(calls().size(), 1U);
}

// Ours pass it in their own services.
TEST_F(ForeignCalls, AreNotOurs) {
  grpc::ClientContext context;
  context.set_wait_for_ready(true);
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  google::protobuf::Empty nothing;
  EXPECT_EQ(v1::HandboxService::NewStub(channel_)
                ->DeleteHandboxSession(&context, v1::DeleteHandboxSessionRequest(), &nothing)
                .error_code(),
            grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_EQ(calls().size(), 0U);
}

}  // namespace
}  // namespace rmlcell::server
