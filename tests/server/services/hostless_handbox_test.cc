// The handbox on a server where no machine lives (handbox_watch.h): each call says so.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>

#include "server/base/executor.h"
#include "server/events/event_feed.h"
#include "server/services/handbox_service.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class HostlessHandbox : public testing::Test {
 protected:
  HostlessHandbox() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    handbox = v1::HandboxService::NewStub(server_->InProcessChannel({}));
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
  }
  ~HostlessHandbox() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }
  static void ExpectNotLive(const grpc::Status& status, const std::string& text) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
    EXPECT_THAT(status.error_message(), testing::HasSubstr(text));
  }

  grpc::ClientContext context;
  std::unique_ptr<v1::HandboxService::Stub> handbox;

 private:
  ServerBed bed_;
  EventFeed feed_{bed_.store()};
  OpenStreams open_;
  Executor executor_{1};
  Gate gate_{"secret"};
  HandboxService service_{{gate_, executor_, executor_, 1 << 20},
                          {executor_, open_, bed_.store(), feed_, nullptr}};
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(HostlessHandbox, NothingIsTakenBack) {
  v1::UndoTeachEntriesRequest request;
  request.set_program("machines/optimo-1/programs/45");
  request.set_down_to(1);
  request.set_control_token("t");
  request.set_request_id("u");
  v1::UndoTeachEntriesResponse response;
  ExpectNotLive(handbox->UndoTeachEntries(&context, request, &response),
                "the machine has no host: enable it");
}

TEST_F(HostlessHandbox, EachKeyOfAStreamIsRefused) {
  const auto stream = handbox->HandboxStream(&context);
  v1::HandboxStreamRequest key;
  key.mutable_key()->set_session("machines/optimo-1/handboxSessions/3");
  v1::HandboxStreamResponse response;
  for (int time = 0; time < 2; ++time) {
    ASSERT_TRUE(stream->Write(key) && stream->Read(&response));
    EXPECT_EQ(response.refusal().code(), "CELL-E9424");
    EXPECT_THAT(response.refusal().message(),
                testing::HasSubstr("the machine has no host: enable it"));
  }
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(HostlessHandbox, ThereIsNothingToWatch) {
  v1::WatchHandboxRequest request;
  request.set_machine("machines/optimo-1");
  const auto watch = handbox->WatchHandbox(&context, request);
  v1::WatchHandboxResponse nothing;
  EXPECT_FALSE(watch->Read(&nothing)) << nothing.ShortDebugString();
  ExpectNotLive(watch->Finish(), "it has no handbox, or does not live: enable it");
}

}  // namespace
}  // namespace rmlcell::server
