// Clients that leave while somebody works for them: the work ends without anybody who is told of
// it, others are served, and nothing of an upload remains.
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>

#include "server/web/web_server.h"
#include "tests/server/web/fake_cell.h"
#include "tests/server/web/raw_client.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::string_view kPlaceContent = "/v1/machines/optimo-1/programs/45/content";
constexpr std::string_view kPlacePicture = "/v1/machines/optimo-1/programs/45/picture.svg";
constexpr std::string_view kPlaceReport = "/v1/jobs/17/artifacts/report";
constexpr std::string_view kPiece = "piece";

enum class WaitingWork { kFind, kMake, kRead, kBegin, kAppend };

// Where one kind of work waits until it is let go on. Thread-safe.
class WaitingPlace {
 public:
  explicit WaitingPlace(WaitingWork waits) : waits_(waits) {}
  void Pass(WaitingWork work) {
    if (work != waits_) return;
    std::unique_lock lock(mutex_);
    reached_ = true;
    changed_.wait(lock, [this] { return open_; });
  }
  bool reached() const {
    const std::lock_guard lock(mutex_);
    return reached_;
  }
  void Open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }

 private:
  const WaitingWork waits_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool reached_ = false;  // guarded by mutex_
  bool open_ = false;     // guarded by mutex_
};

class PlaceReader final : public ResourceReader {
 public:
  explicit PlaceReader(WaitingPlace& place) : place_(place) {}
  Result<std::string> Read(std::size_t) override {
    place_.Pass(WaitingWork::kRead);
    return std::exchange(read_, true) ? std::string() : std::string(kPiece);
  }

 private:
  WaitingPlace& place_;
  bool read_ = false;
};

class PlaceSink final : public UploadSink {
 public:
  PlaceSink(WaitingPlace& place, std::atomic<int>& finished) : place_(place), finished_(finished) {}
  Status Append(std::string_view) override {
    place_.Pass(WaitingWork::kAppend);
    return {};
  }
  UploadEnd Finish() override {
    ++finished_;
    return {.message_type = "rmlcell.v1.Program", .message = {}, .status = {}};
  }

 private:
  WaitingPlace& place_;
  std::atomic<int>& finished_;
};

class PlaceSource final : public ResourceSource {
 public:
  explicit PlaceSource(WaitingWork waits) : place(waits) {}
  Result<Resource> Find(const ResourcePath& path, const WebCallerMetadata&) override {
    ++asked;
    place.Pass(WaitingWork::kFind);
    Resource resource;
    resource.media_type = "text/plain";
    if (std::holds_alternative<ProgramPicturePath>(path)) {
      resource.make = [this]() -> Result<std::string> {
        ++made;
        place.Pass(WaitingWork::kMake);
        return std::string(kPiece);
      };
    } else {
      resource.size = static_cast<std::int64_t>(kPiece.size());
      resource.reader = std::make_unique<PlaceReader>(place);
    }
    return resource;
  }
  Result<std::unique_ptr<UploadSink>> BeginUpload(const UploadHeader&,
                                                  const WebCallerMetadata&) override {
    place.Pass(WaitingWork::kBegin);
    return std::unique_ptr<UploadSink>(std::make_unique<PlaceSink>(place, finished));
  }

  WaitingPlace place;
  std::atomic<int> asked = 0;  // for resources
  std::atomic<int> made = 0;   // of those that are made: begun
  std::atomic<int> finished = 0;
};

// The client goes while this work is under way, which is seen before the work ends.
void ExpectLeftAt(WaitingWork work, const std::string& request) {
  PlaceSource source(work);
  std::atomic<int> unfinished = 0;
  WebOptions options = AnyPort();
  options.linger_timeout = std::chrono::hours(1);
  options.quiet_interval = std::chrono::hours(1);
  const std::unique_ptr<WebServer> web =
      *WebServer::Start(options, nullptr, source,
                        [&](const WebLogEntry& entry) { unfinished += entry.finished ? 0 : 1; });
  RawClient client(web->port());
  client.Send(request);
  EXPECT_TRUE(FakeCell::Eventually([&] { return source.place.reached(); })) << request;
  client.Reset();
  EXPECT_TRUE(FakeCell::Eventually([&] { return unfinished == 1; })) << request;
  source.place.Open();
  EXPECT_TRUE(FakeCell::Eventually([&] { return web->connections() == 0; })) << request;
  EXPECT_EQ(source.finished, 0) << request;
  EXPECT_EQ(Exchange(web->port(), Get("/favicon.svg")).status, 200) << request;
}

TEST(LeftWork, NobodyIsToldOfADownload) {
  ExpectLeftAt(WaitingWork::kFind, Get(kPlaceReport));
  ExpectLeftAt(WaitingWork::kRead, Get(kPlaceReport));
  ExpectLeftAt(WaitingWork::kMake, Get(kPlacePicture));
}

// resource_source.h: making takes seconds of a processor. Pictures are made one after the other:
// of a client that goes while another's is made, none is made.
TEST(LeftWork, WhatNobodyWaitsForIsNotMade) {
  PlaceSource source(WaitingWork::kMake);
  std::atomic<int> unfinished = 0;
  WebOptions options = AnyPort();
  // One thread each: what is found later is taken behind what was found before.
  options.io_threads = 1;
  options.blocking_threads = 1;
  options.linger_timeout = std::chrono::hours(1);
  options.quiet_interval = std::chrono::hours(1);
  const std::unique_ptr<WebServer> web =
      *WebServer::Start(options, nullptr, source,
                        [&](const WebLogEntry& entry) { unfinished += entry.finished ? 0 : 1; });
  RawClient first(web->port());
  first.Send(Get(kPlacePicture));
  EXPECT_TRUE(FakeCell::Eventually([&] { return source.place.reached(); }));
  RawClient second(web->port());
  second.Send(Get(kPlacePicture));
  EXPECT_TRUE(FakeCell::Eventually([&] { return source.asked == 2; }));
  EXPECT_EQ(Exchange(web->port(), Get(kPlaceReport)).body, kPiece);  // behind what it has found
  second.Reset();
  EXPECT_TRUE(FakeCell::Eventually([&] { return unfinished == 1; }));
  source.place.Open();
  EXPECT_EQ(first.Read().body, kPiece);
  EXPECT_EQ(Exchange(web->port(), Get(kPlacePicture)).body, kPiece);  // behind it in line
  EXPECT_EQ(source.made, 2);
}

// resource_source.h: destroyed without Finish, nothing of it remains. Without a body the end of the
// connection is seen from the beginning.
TEST(LeftWork, NothingOfAnUploadRemains) {
  ExpectLeftAt(WaitingWork::kBegin, Post(kPlaceContent, "application/octet-stream", ""));
  ExpectLeftAt(WaitingWork::kAppend, Post(kPlaceContent, "application/octet-stream", "MOVE"));
}

// What OpenCalls count.
struct OpenCounts {
  std::atomic<int> open = 0;
  std::atomic<int> begun = 0;
  std::atomic<int> left = 0;  // by a client that goes, and not by the time that they have
};

// Is left open until its client goes, or until the time is over that it has.
class OpenCall final : public grpc::ServerGenericBidiReactor {
 public:
  OpenCall(OpenCounts& counts, std::chrono::system_clock::time_point deadline)
      : counts_(counts), deadline_(deadline) {
    ++counts_.open;
    ++counts_.begun;
  }
  void OnCancel() override {
    if (std::chrono::system_clock::now() + std::chrono::seconds(1) < deadline_) ++counts_.left;
    Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override {
    --counts_.open;
    delete this;
  }

 private:
  OpenCounts& counts_;
  const std::chrono::system_clock::time_point deadline_;
};

class OpenCalls final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    return new OpenCall(counts, context->deadline());
  }
  OpenCounts counts;
};

// Its call is left as soon as its client goes, long before the time of the call is over.
TEST(LeftWork, NobodyIsToldOfTheHealth) {
  grpc::EnableDefaultHealthCheckService(false);  // it would answer at once
  OpenCalls calls;
  grpc::ServerBuilder builder;
  builder.RegisterCallbackGenericService(&calls);
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  FakeResources resources;
  WebOptions options = AnyPort();
  options.health_timeout = std::chrono::hours(1);
  std::unique_ptr<WebServer> web =
      *WebServer::Start(options, server->InProcessChannel({}), resources);
  const OpenCounts& counts = calls.counts;
  RawClient client(web->port());
  client.Send(Get("/healthz"));
  EXPECT_TRUE(FakeCell::Eventually([&] { return counts.begun == 1; }));
  client.Reset();
  EXPECT_TRUE(FakeCell::Eventually([&] { return counts.open == 0 && web->connections() == 0; }));
  EXPECT_EQ(counts.left, 1);
  EXPECT_EQ(Exchange(web->port(), Get("/favicon.svg")).status, 200);
  web.reset();
  server->Shutdown(std::chrono::system_clock::now());
  server->Wait();
}

}  // namespace
}  // namespace rmlcell::web::testing
