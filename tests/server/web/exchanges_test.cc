// What answers a request, at the seam to its connection (connection.h): what it says there and
// when, and that to a client who is gone it says nothing more and keeps nothing.
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/job.pb.h"
#include "server/web/gateway.h"
#include "server/web/health_exchange.h"
#include "server/web/resource_exchange.h"
#include "server/web/rpc_exchange.h"
#include "server/web/rpc_request.h"
#include "tests/server/web/fake_cell.h"

namespace rmlcell::web::testing {
namespace {

using Said = std::vector<std::string>;

// Notes what is said. What is posted waits until the test has it run: the test is the strand.
class NotedConnection final : public Connection {
 public:
  void Send(HttpResponse response) override {
    said.push_back("send " + std::to_string(response.status));
  }
  void Begin(HttpResponse) override { said.emplace_back("begin"); }
  void Write(std::string bytes) override { said.push_back("write " + bytes); }
  void Finish() override { said.emplace_back("finish"); }
  void Abort() override { said.emplace_back("abort"); }
  void ReadBody() override { said.emplace_back("read"); }
  void Post(std::function<void()> work) override {
    const std::lock_guard lock(mutex_);
    posted_.push_back(std::move(work));
    changed_.notify_all();
  }

  // False: nothing was posted within a minute.
  bool AwaitPosted() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), [this] { return !posted_.empty(); });
  }
  bool RunPosted() {
    if (!AwaitPosted()) return false;
    std::function<void()> work;
    {
      const std::lock_guard lock(mutex_);
      work = std::move(posted_.front());
      posted_.pop_front();
    }
    work();
    return true;
  }

  Said said;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> posted_;  // guarded by mutex_
};

// A call that is answered as the test says.
class ToldCall final : public grpc::ServerGenericBidiReactor {
 public:
  void Tell(const std::string& bytes) {
    const grpc::Slice slice(bytes);
    answer_ = grpc::ByteBuffer(&slice, 1);
    StartWrite(&answer_);
  }
  void End() { EndWith(grpc::Status::OK); }
  void OnCancel() override { EndWith(grpc::Status::CANCELLED); }
  void OnDone() override {}  // it stays, for whoever ends it once more

 private:
  void EndWith(const grpc::Status& status) {
    if (!ended_.exchange(true)) Finish(status);
  }

  grpc::ByteBuffer answer_;
  std::atomic<bool> ended_ = false;
};

// One call only; it stays as long as this does.
class ToldCalls final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(grpc::GenericCallbackServerContext*) override {
    begun.set_value(&call_);
    return &call_;
  }
  std::promise<ToldCall*> begun;

 private:
  ToldCall call_;
};

class KeptReader final : public ResourceReader {
 public:
  explicit KeptReader(int& open) : open_(open) { ++open_; }
  ~KeptReader() override { --open_; }
  KeptReader(const KeptReader&) = delete;
  KeptReader& operator=(const KeptReader&) = delete;
  Result<std::string> Read(std::size_t) override { return std::string("piece"); }

 private:
  int& open_;
};

class KeptSink final : public UploadSink {
 public:
  explicit KeptSink(int& open) : open_(open) { ++open_; }
  ~KeptSink() override { --open_; }
  KeptSink(const KeptSink&) = delete;
  KeptSink& operator=(const KeptSink&) = delete;
  Status Append(std::string_view) override { return {}; }
  UploadEnd Finish() override {
    return {.message_type = "rmlcell.v1.Program", .message = {}, .status = {}};
  }

 private:
  int& open_;
};

class KeptSource final : public ResourceSource {
 public:
  Result<Resource> Find(const ResourcePath&, const WebCallerMetadata&) override {
    Resource resource;
    resource.media_type = "text/plain";
    resource.size = 100;
    resource.reader = std::make_unique<KeptReader>(open);
    return resource;
  }
  Result<std::unique_ptr<UploadSink>> BeginUpload(const UploadHeader&,
                                                  const WebCallerMetadata&) override {
    return std::unique_ptr<UploadSink>(std::make_unique<KeptSink>(open));
  }

  int open = 0;  // readers and sinks
};

class Exchanges : public ::testing::Test {
 protected:
  Exchanges() {
    grpc::EnableDefaultHealthCheckService(false);  // it would answer at once
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&calls_);
    server_ = builder.BuildAndStart();
    gateway_.options.health_timeout = std::chrono::hours(1);
    gateway_.channel = server_->InProcessChannel({});
    gateway_.resources = &source_;
    gateway_.run_blocking = [this](std::function<void()> task) {
      blocking_.push_back(std::move(task));
    };
  }
  ~Exchanges() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  static HttpRequest Asking(std::string_view path) {
    HttpRequest request;
    request.method = "POST";
    request.path = std::string(path);
    request.headers = {{"content-type", "application/json"}};
    request.body = R"({"name":"jobs/1"})";
    return request;
  }
  static std::string Event(std::int64_t sequence) {
    v1::WatchJobResponse response;
    response.set_sequence(sequence);
    return response.SerializeAsString();
  }
  ToldCall& Begun() { return *calls_.begun.get_future().get(); }
  // What waits for a thread on which it may block.
  void RunBlocking() {
    ASSERT_FALSE(blocking_.empty());
    const std::function<void()> task = std::move(blocking_.front());
    blocking_.pop_front();
    task();
  }

  ToldCalls calls_;
  std::unique_ptr<grpc::Server> server_;
  KeptSource source_;
  std::deque<std::function<void()>> blocking_;
  Gateway gateway_;
  std::shared_ptr<NotedConnection> connection_ = std::make_shared<NotedConnection>();
};

// One thing at a time is written; what comes meanwhile has its turn when that is taken.
TEST_F(Exchanges, AMessageWaitsForTheLineBeforeIt) {
  const HttpRequest request = Asking(kWatchJob);
  const auto exchange =
      MakeRpcExchange(gateway_, RouteRpc(request).route, request, {}, connection_);
  Said& said = connection_->said;
  exchange->Start();
  EXPECT_EQ(said, Said{"begin"});
  ToldCall& call = Begun();
  exchange->OnTaken();
  exchange->OnQuiet();
  call.Tell(Event(7));
  ASSERT_TRUE(connection_->RunPosted());
  exchange->OnQuiet();
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[1], "write : quiet\n\n");
  exchange->OnTaken();
  ASSERT_EQ(said.size(), 3U);
  EXPECT_TRUE(said[2].starts_with("write id: 7\ndata: {")) << said[2];
  exchange->OnQuiet();
  exchange->OnTaken();
  call.End();
  ASSERT_TRUE(connection_->RunPosted());
  ASSERT_EQ(said.size(), 4U);
  EXPECT_EQ(said[3], "write event: end\ndata: {}\n\n");
  exchange->OnTaken();
  ASSERT_EQ(said.size(), 5U);
  EXPECT_EQ(said[4], "finish");
}

// What was on its way when the client left is for nobody, nor is how the call ended.
TEST_F(Exchanges, AMessageThatComesLateIsForNobody) {
  const HttpRequest request = Asking(kWatchJob);
  const auto exchange =
      MakeRpcExchange(gateway_, RouteRpc(request).route, request, {}, connection_);
  exchange->Start();
  ToldCall& call = Begun();
  exchange->OnTaken();
  call.Tell(Event(7));
  ASSERT_TRUE(connection_->AwaitPosted());
  exchange->OnGone();
  ASSERT_TRUE(connection_->RunPosted());
  ASSERT_TRUE(connection_->RunPosted());
  EXPECT_EQ(connection_->said, Said{"begin"});
}

TEST_F(Exchanges, AnAnswerThatComesLateIsForNobody) {
  const HttpRequest request = Asking(kGetJob);
  const auto exchange =
      MakeRpcExchange(gateway_, RouteRpc(request).route, request, {}, connection_);
  exchange->Start();
  Begun().End();
  ASSERT_TRUE(connection_->AwaitPosted());
  exchange->OnGone();
  ASSERT_TRUE(connection_->RunPosted());
  EXPECT_EQ(connection_->said, Said());
}

TEST_F(Exchanges, HealthThatComesLateIsForNobody) {
  const auto exchange = MakeHealthExchange(gateway_, HttpRequest(), connection_);
  exchange->Start();
  Begun().End();
  ASSERT_TRUE(connection_->AwaitPosted());
  exchange->OnGone();
  ASSERT_TRUE(connection_->RunPosted());
  EXPECT_EQ(connection_->said, Said());
}

// resource_source.h: all of it may block, so a reader is let go where it is read.
TEST_F(Exchanges, AReaderIsClosedWhereItIsRead) {
  auto exchange = MakeDownload(gateway_, ArtifactPath{.job = "17", .artifact = "toolpath"},
                               HttpRequest(), {}, connection_);
  exchange->Start();
  RunBlocking();
  ASSERT_TRUE(connection_->RunPosted());
  exchange->OnTaken();
  RunBlocking();
  exchange->OnGone();
  ASSERT_TRUE(connection_->RunPosted());
  EXPECT_EQ(connection_->said, Said{"begin"});
  EXPECT_TRUE(blocking_.empty());
  exchange.reset();
  EXPECT_EQ(source_.open, 1);
  RunBlocking();
  EXPECT_EQ(source_.open, 0);
}

// So is a sink; and one whose client left before its end is not finished.
TEST_F(Exchanges, ASinkIsClosedWhereItIsFilled) {
  for (const bool finished : {false, true}) {
    connection_->said.clear();
    auto exchange = MakeUpload(gateway_, UploadHeader(), {}, connection_);
    exchange->Start();
    RunBlocking();
    ASSERT_TRUE(connection_->RunPosted());
    exchange->OnBody("MOVE", true);
    RunBlocking();
    if (finished) {
      ASSERT_TRUE(connection_->RunPosted());
      RunBlocking();
    }
    exchange->OnGone();
    ASSERT_TRUE(connection_->RunPosted());
    EXPECT_EQ(connection_->said, Said{"read"}) << finished;
    EXPECT_TRUE(blocking_.empty()) << finished;
    exchange.reset();
    EXPECT_EQ(source_.open, 1) << finished;
    RunBlocking();
    EXPECT_EQ(source_.open, 0) << finished;
  }
}

// Also what was found, or begun, when its client had left already.
TEST_F(Exchanges, WhatComesForNobodyIsClosedThereToo) {
  for (const bool upload : {false, true}) {
    auto exchange = upload
                        ? MakeUpload(gateway_, UploadHeader(), {}, connection_)
                        : MakeDownload(gateway_, ArtifactPath{.job = "17", .artifact = "toolpath"},
                                       HttpRequest(), {}, connection_);
    exchange->Start();
    RunBlocking();
    exchange->OnGone();
    ASSERT_TRUE(connection_->RunPosted());
    EXPECT_EQ(connection_->said, Said()) << upload;
    exchange.reset();
    EXPECT_EQ(source_.open, 1) << upload;
    RunBlocking();
    EXPECT_EQ(source_.open, 0) << upload;
  }
}

}  // namespace
}  // namespace rmlcell::web::testing
