// What is known of a call before it is admitted (server/auth/caller.h, CallFacts).
#include <grpcpp/create_channel_posix.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/server_posix.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <memory>
#include <string>

#include "rmlcell/v1/job.grpc.pb.h"
#include "server/services/call.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class FactsOfCalls : public testing::Test {
 protected:
  // Keeps what is known of the newest call.
  class Jobs final : public v1::JobService::CallbackService {
   public:
    grpc::ServerUnaryReactor* SubmitJob(grpc::CallbackServerContext* context,
                                        const v1::SubmitJobRequest* request,
                                        v1::Job* /*response*/) override {
      known = FactsOfCall(gate_, *context, "JobService/SubmitJob", request);
      of_a_stream = FactsOfCall(gate_, *context, "JobService/SubmitJob", nullptr);
      of_no_method = FactsOfCall(gate_, *context, "JobService/Nothing", request);
      grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
      reactor->Finish(grpc::Status::OK);
      return reactor;
    }
    CallFacts known{};
    CallFacts of_a_stream{};
    CallFacts of_no_method{};

   private:
    const Gate gate_{"secret"};
  };

  FactsOfCalls() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(&jobs);
    server = builder.BuildAndStart();
  }
  ~FactsOfCalls() override {
    server->Shutdown(std::chrono::system_clock::now());
    server->Wait();
  }
  std::shared_ptr<grpc::Channel> OverTcp() const {
    return grpc::CreateChannel("127.0.0.1:" + std::to_string(port_),
                               grpc::InsecureChannelCredentials());
  }
  static void Submit(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    context.AddMetadata("x-request-id", "one");
    v1::SubmitJobRequest request;
    request.mutable_job()->set_machine("machines/mill-1");
    v1::Job response;
    const grpc::Status status =
        v1::JobService::NewStub(channel)->SubmitJob(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  Jobs jobs;
  std::unique_ptr<grpc::Server> server;

 private:
  int port_ = 0;
};

// access.proto, resource_field: a call is about what its request names; nothing is known where
// there is no request, or the method states nothing.
TEST_F(FactsOfCalls, SayWhatTheCallIsAbout) {
  Submit(OverTcp());
  EXPECT_EQ(jobs.known.method, "/rmlcell.v1.JobService/SubmitJob");
  EXPECT_EQ(jobs.known.resource, "machines/mill-1");
  EXPECT_EQ(jobs.of_a_stream.method, "/rmlcell.v1.JobService/SubmitJob");
  EXPECT_EQ(jobs.of_a_stream.resource, "");
  EXPECT_EQ(jobs.of_no_method.method, "/rmlcell.v1.JobService/Nothing");
  EXPECT_EQ(jobs.of_no_method.resource, "");
  const auto id = jobs.known.metadata.find("x-request-id");
  ASSERT_NE(id, jobs.known.metadata.end());
  EXPECT_EQ(id->second, "one");
}

// Of who calls over a unix socket the computer says who he is; over TCP it does not.
TEST_F(FactsOfCalls, SayWhichWayTheCallCame) {
  Submit(OverTcp());
  EXPECT_EQ(jobs.known.transport, Transport::kTcp);
  EXPECT_TRUE(jobs.known.peer.starts_with("ipv4:127.0.0.1:")) << jobs.known.peer;
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
  grpc::AddInsecureChannelFromFd(server.get(), ends[0]);
  Submit(grpc::CreateInsecureChannelFromFd("here", ends[1]));
  EXPECT_EQ(jobs.known.transport, Transport::kUnixSocket);
  EXPECT_EQ(jobs.known.peer, "fd:" + std::to_string(ends[0]));
}

}  // namespace
}  // namespace rmlcell::server
