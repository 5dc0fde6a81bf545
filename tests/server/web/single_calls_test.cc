// Calls of the gateway to its server, one by one: a server that does what no good one does, and
// clients that go at any moment.
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "server/web/rpc_call.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

// Answers every call with so many jobs, "jobs/1" and on, and with metadata; below 0: it goes on
// until the client leaves.
class CountedAnswers final : public grpc::ServerGenericBidiReactor {
 public:
  CountedAnswers(grpc::GenericCallbackServerContext* context, int answers, bool garbled)
      : left_(answers), garbled_(garbled) {
    for (const char* name : {"x-one", "x-raw-bin", "rmlcell-inner", "date", "te", "user-agent",
                             "connection", "transfer-encoding"})
      context->AddTrailingMetadata(
          name, std::string("v\xFF").substr(0, std::string(name).ends_with("-bin") ? 2 : 1));
    StartRead(&asked_);
  }
  void OnReadDone(bool /*ok*/) override { Next(); }
  void OnWriteDone(bool ok) override {
    if (ok) return Next();
    Finish(grpc::Status::CANCELLED);
  }
  void OnCancel() override {}
  void OnDone() override { delete this; }

 private:
  void Next() {
    if (left_ == 0) return Finish(grpc::Status::OK);
    --left_;
    v1::Job job;
    job.set_name("jobs/" + std::to_string(++number_));
    const grpc::Slice slice(garbled_ ? std::string("\xFF\xFF") : job.SerializeAsString());
    answer_ = grpc::ByteBuffer(&slice, 1);
    StartWrite(&answer_);
  }

  int left_;
  const bool garbled_;
  int number_ = 0;
  grpc::ByteBuffer asked_;
  grpc::ByteBuffer answer_;
};

class CountingService final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    return new CountedAnswers(context, answers, garbled);
  }
  std::atomic<int> answers = 1;
  std::atomic<bool> garbled = false;  // what it answers is no message of any type
};

class SingleCalls : public ::testing::Test {
 protected:
  SingleCalls() {
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&service_);
    server_ = builder.BuildAndStart();
    channel_ = server_->InProcessChannel({});
    web_ = *WebServer::Start(AnyPort(), channel_, resources_);
  }
  ~SingleCalls() override {
    web_->Stop(std::chrono::milliseconds(0));
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  // How a call ends that is left after so many messages, while another one is waited for or not.
  RpcStatus Left(int messages, bool waiting) {
    std::promise<void> seen;
    std::promise<RpcStatus> ended;
    std::atomic<int> count = 0;
    std::shared_ptr<RpcCall> call;
    std::promise<void> started;
    const auto is_started = started.get_future().share();
    call =
        RpcCall::Start(channel_, {.method = "/a.B/C", .message = {}, .metadata = {}, .timeout = {}},
                       {.on_message =
                            [&, is_started](const std::string&) {
                              is_started.wait();
                              if (++count == messages) return seen.set_value();
                              call->ReadNext();
                            },
                        .on_end = [&](RpcCallEnd end) { ended.set_value(end.status); }});
    started.set_value();
    call->ReadNext();
    seen.get_future().wait();
    if (waiting) call->ReadNext();
    call->Cancel();
    call->Cancel();
    if (!waiting) call->ReadNext();  // nothing comes any more, and nothing is waited for
    auto end = ended.get_future();
    if (end.wait_for(std::chrono::minutes(1)) != std::future_status::ready) std::abort();
    return end.get();
  }

  CountingService service_;
  FakeResources resources_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<WebServer> web_;
};

// A call with one answer has one: neither none nor two are given on as if they were.
TEST_F(SingleCalls, HaveOneAnswer) {
  const auto asked = [&](int answers) {
    service_.answers = answers;
    return Exchange(web_->port(), Post(kGetJob, "application/json", "{}"));
  };
  const RawResponse good = asked(1);
  EXPECT_EQ(good.status, 200);
  EXPECT_EQ(nlohmann::json::parse(good.body)["name"], "jobs/1");
  for (const int answers : {0, 2, 3}) {
    const RawResponse bad = asked(answers);
    EXPECT_EQ(bad.status, 500) << answers;
    EXPECT_EQ(nlohmann::json::parse(bad.body)["details"][1]["code"], "CELL-E9001") << answers;
  }
}

// What gRPC and the server say to each other is not for browsers; bytes come as base64.
TEST_F(SingleCalls, MetadataOfOursStaysInside) {
  const RawResponse response = Exchange(web_->port(), Post(kGetJob, "application/json", "{}"));
  EXPECT_EQ(response.Header("trailer-x-one"), "v");
  EXPECT_EQ(response.Header("trailer-x-raw-bin"), Base64("v\xFF", false));
  for (const char* inner :
       {"trailer-rmlcell-inner", "trailer-date", "trailer-te", "trailer-content-type",
        "content-type2", "user-agent", "trailer-grpc-status", "trailer-user-agent",
        "trailer-connection", "trailer-transfer-encoding"})
    EXPECT_EQ(response.headers.count(inner), 0U) << inner;
}

// What is no message of its method is the server's own mistake: of a stream it is the end, whatever
// the server would still send.
TEST_F(SingleCalls, AnAnswerThatIsNoneIsTheServersMistake) {
  service_.garbled = true;
  const RawResponse one = Exchange(web_->port(), Post(kGetJob, "application/json", "{}"));
  EXPECT_EQ(one.status, 500);
  EXPECT_EQ(nlohmann::json::parse(one.body)["details"][1]["code"], "CELL-E9001");
  service_.answers = -1;
  const RawResponse events = Exchange(web_->port(), Post(kWatchJob, "application/json", "{}"));
  EXPECT_TRUE(events.complete);
  EXPECT_TRUE(events.body.starts_with("event: error\ndata: {\"code\":\"internal\"")) << events.body;
  EXPECT_NE(events.body.find("CELL-E9001"), std::string::npos) << events.body;
  const RawResponse connect =
      Exchange(web_->port(), Post(kWatchJob, "application/connect+json", MakeEnvelope(0, "{}")));
  EXPECT_TRUE(connect.complete);
  EXPECT_EQ(connect.body.find("{\"error\":{\"code\":\"internal\""), 5U) << connect.body;
}

// Its last owner must not be the thread of gRPC on which the call ends.
TEST_F(SingleCalls, HoldNoChannelWhenTheirEndIsTold) {
  const long owners = channel_.use_count();
  std::promise<long> at_end;
  const auto call = RpcCall::Start(
      channel_, {.method = "/a.B/C", .message = {}, .metadata = {}, .timeout = {}},
      {.on_message = [](const std::string&) {},
       .on_end = [&](const RpcCallEnd&) { at_end.set_value(channel_.use_count()); }});
  EXPECT_EQ(channel_.use_count(), owners + 1);
  call->Cancel();
  EXPECT_EQ(at_end.get_future().get(), owners);
}

// rpc_call.h: a call lives until it has ended, also where nobody holds it any more.
TEST_F(SingleCalls, GoOnWithoutAnybodyWhoHoldsThem) {
  service_.answers = 0;
  std::promise<RpcStatus> ended;
  auto end = ended.get_future();
  std::shared_ptr<RpcCall> call =
      RpcCall::Start(channel_, {.method = "/a.B/C", .message = {}, .metadata = {}, .timeout = {}},
                     {.on_message = [](const std::string&) {},
                      .on_end = [&](const RpcCallEnd& told) { ended.set_value(told.status); }});
  call->ReadNext();
  call.reset();
  if (end.wait_for(std::chrono::minutes(1)) != std::future_status::ready) std::abort();
  EXPECT_EQ(end.get().code, 0);
}

// What is told of a call may hold the call itself: with its end it is let go of.
TEST_F(SingleCalls, HoldNobodyBehindTheirEnd) {
  service_.answers = 0;
  auto told = std::make_shared<std::atomic<int>>(0);
  const std::weak_ptr<std::atomic<int>> listener = told;
  const std::shared_ptr<RpcCall> call =
      RpcCall::Start(channel_, {.method = "/a.B/C", .message = {}, .metadata = {}, .timeout = {}},
                     {.on_message = [told](const std::string&) { ++*told; },
                      .on_end = [told](const RpcCallEnd&) { ++*told; }});
  told.reset();
  call->ReadNext();
  EXPECT_TRUE(FakeCell::Eventually([&] { return listener.expired(); }));
}

// rpc_call.h: a call that is left ends soon, also when the message that was waited for came just in
// time and nobody asks for another.
TEST_F(SingleCalls, EndWhateverComesJustInTime) {
  service_.answers = -1;
  for (int round = 0; round < 50; ++round) {
    std::promise<void> seen;
    std::promise<RpcStatus> ended;
    auto end = ended.get_future();
    std::atomic<bool> first = true;
    const std::shared_ptr<RpcCall> call =
        RpcCall::Start(channel_, {.method = "/a.B/C", .message = {}, .metadata = {}, .timeout = {}},
                       {.on_message =
                            [&](const std::string&) {
                              if (first.exchange(false)) seen.set_value();
                            },
                        .on_end = [&](const RpcCallEnd& told) { ended.set_value(told.status); }});
    call->ReadNext();
    seen.get_future().wait();
    call->ReadNext();
    call->Cancel();
    if (end.wait_for(std::chrono::minutes(1)) != std::future_status::ready) std::abort();
    EXPECT_EQ(end.get().code, 1) << round;
  }
}

// A call that is left ends, and says that it was cancelled, whether something is waited for or not.
TEST_F(SingleCalls, WhoLeavesEndsThem) {
  service_.answers = -1;
  for (const int messages : {1, 3}) {
    EXPECT_EQ(Left(messages, false).code, 1) << messages;
    EXPECT_EQ(Left(messages, true).code, 1) << messages;
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
