#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "server/base/config.h"
#include "server/base/executor.h"
#include "server/base/steady_clock.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/jobs/running_heights.h"
#include "server/jobs/running_toolpath.h"
#include "server/machines/machine_statuses.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/services/cell_watch.h"
#include "server/services/job_streams.h"
#include "server/services/machine_watch.h"
#include "server/services/open_stream.h"
#include "tests/server/refusing_store.h"
#include "tests/server/server_bed.h"

// Streams of jobs over a channel of this process, with the log of a real store behind them.
namespace rmlcell::server {

// A stream as a client sees it. A message that does not come within kPatience ends it with
// DEADLINE_EXCEEDED.
template <class Message>
class OpenedStream {
 public:
  template <class Open>
  explicit OpenedStream(Open open) : context_(std::make_unique<grpc::ClientContext>()) {
    context_->set_deadline(std::chrono::system_clock::now() + kPatience);
    reader_ = open(context_.get());
  }
  OpenedStream(OpenedStream&&) = default;
  ~OpenedStream() {
    if (context_) context_->TryCancel();
  }

  // The next message; an empty one when the stream has ended.
  Message Next() {
    Message message;
    if (!reader_->Read(&message)) message.Clear();
    return message;
  }
  // What is left of the stream, up to its end.
  std::vector<Message> Rest() {
    std::vector<Message> rest;
    for (Message message; reader_->Read(&message);) rest.push_back(message);
    return rest;
  }
  // After the last message: how it ended.
  grpc::Status End() {
    Message message;
    EXPECT_FALSE(reader_->Read(&message)) << message.ShortDebugString();
    return reader_->Finish();
  }
  void ExpectGoodEnd() {
    const grpc::Status status = End();
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  void ExpectRefused(grpc::StatusCode code, const std::string& text) {
    const grpc::Status status = End();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_NE(status.error_message().find(text), std::string::npos) << status.error_message();
  }
  void Cancel() { context_->TryCancel(); }

 private:
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReader<Message>> reader_;
};

class StreamBed {
 public:
  static constexpr const char* kInstance = "this server";
  static constexpr const char* kCaller = "local";  // of every watch

  explicit StreamBed(storage::SqliteOptions options = {},
                     std::chrono::milliseconds bookmark_interval = std::chrono::hours(1),
                     SteadyClock clock = SteadyTime)
      : bed(std::move(options)),
        service_({.executor = executor_,
                  .open = open,
                  .book = book_,
                  .feed = feed,
                  .running_toolpath =
                      [this](std::int64_t job) {
                        ++toolpaths_looked_for;
                        return Running(running_, job);
                      },
                  .running_heights =
                      [this](std::int64_t job) {
                        ++heights_looked_for;
                        return Running(mills_, job);
                      },
                  .instance_id = kInstance}),
        cell_({.executor = executor_,
               .open = open,
               .records = {store, book_, programs, projects},
               .feed = feed,
               .logs = logs_,
               .facts = facts_,
               .registry = registry,
               .instance_id = kInstance,
               .clock = std::move(clock),
               .bookmark_interval = bookmark_interval},
              CallNeeds{gate, executor_, executor_, 1 << 20}),
        machines_({executor_, open, store, feed, kInstance}) {
    gate.OnChange([this] { open.AskAgain(); });
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    builder.RegisterService(&cell_);
    builder.RegisterService(&machines_);
    server_ = builder.BuildAndStart();
    stub_ = v1::JobService::NewStub(server_->InProcessChannel({}));
    cell_stub_ = v1::CellService::NewStub(server_->InProcessChannel({}));
    machine_stub_ = v1::MachineService::NewStub(server_->InProcessChannel({}));
  }
  StreamBed(const StreamBed&) = delete;
  StreamBed& operator=(const StreamBed&) = delete;
  ~StreamBed() {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  // A queued job whose log has its state as event 1: its number.
  std::int64_t Submit(const v1::Job& specification = {});
  // An event each that says this.
  void Say(const storage::Lease& lease, const std::vector<std::string>& texts);
  // Ends the job with one more event.
  void Finish(const storage::Lease& lease, const std::vector<storage::NewArtifact>& artifacts = {});
  // A job that has ended with a product: its number.
  std::int64_t Ended(const std::string& artifact, const std::string& bytes,
                     const v1::Job& specification = {});
  // A position of a job, as its watchers see it now: the number of steps tells them apart.
  void TellSteps(std::int64_t job, int steps);

  OpenedStream<v1::WatchJobResponse> Watch(std::int64_t job, std::int64_t after = 0,
                                           bool events_only = false);
  OpenedStream<v1::WatchJobResponse> Watch(const v1::WatchJobRequest& request);
  OpenedStream<v1::WatchCellResponse> WatchCell(const v1::WatchCellRequest& request);
  OpenedStream<v1::WatchMachineResponse> WatchMachine(const v1::WatchMachineRequest& request);
  OpenedStream<v1::StreamJobToolpathResponse> Toolpath(const std::string& name, int level,
                                                       bool with_levels = false);
  OpenedStream<v1::StreamJobToolpathResponse> Toolpath(const v1::StreamJobToolpathRequest& request);
  OpenedStream<v1::StreamJobHeightsResponse> Heights(const v1::StreamJobHeightsRequest& request);
  // A job that runs here has a toolpath that can be followed.
  std::shared_ptr<RunningToolpath> Run(std::int64_t job);
  std::shared_ptr<RunningHeights> RunMill(std::int64_t job);
  std::atomic<int> toolpaths_looked_for = 0;
  std::atomic<int> heights_looked_for = 0;
  // Of those who watch the cell.
  Gate gate{"secret"};
  OpenedStream<v1::StreamJobTraceResponse> Trace(const std::string& name);
  OpenedStream<v1::StreamJobArtifactResponse> Artifact(const std::string& name,
                                                       const std::string& artifact);

  ServerBed bed;
  RefusingStore store{bed.store()};  // what the streams read
  EventFeed feed{store};
  OpenStreams open;
  Config config;
  ProgramBook programs{store, config};
  ProjectBook projects{store};
  WatchRegistry registry;

 private:
  class CellService final
      : public v1::CellService::WithRawCallbackMethod_WatchCell<v1::CellService::CallbackService> {
   public:
    CellService(CellWatchNeeds needs, CallNeeds call) : needs_(std::move(needs)), call_(call) {}
    grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchCell(
        grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) override {
      return OpenCellWatch(call_, needs_, *context, *request);
    }

   private:
    CellWatchNeeds needs_;
    CallNeeds call_;
  };
  class MachineService final : public v1::MachineService::CallbackService {
   public:
    explicit MachineService(MachineWatchNeeds needs) : needs_(std::move(needs)) {}
    grpc::ServerWriteReactor<v1::WatchMachineResponse>* WatchMachine(
        grpc::CallbackServerContext*, const v1::WatchMachineRequest* request) override {
      return MakeMachineWatch(needs_, *request)->Begin();
    }

   private:
    MachineWatchNeeds needs_;
  };
  class Service final : public v1::JobService::CallbackService {
   public:
    explicit Service(JobStreamNeeds needs) : needs_(std::move(needs)) {}
    grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(
        grpc::CallbackServerContext*, const v1::WatchJobRequest* request) override {
      return MakeJobWatch(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::StreamJobToolpathResponse>* StreamJobToolpath(
        grpc::CallbackServerContext*, const v1::StreamJobToolpathRequest* request) override {
      return MakeToolpathStream(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::StreamJobHeightsResponse>* StreamJobHeights(
        grpc::CallbackServerContext*, const v1::StreamJobHeightsRequest* request) override {
      return MakeHeightsStream(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::StreamJobTraceResponse>* StreamJobTrace(
        grpc::CallbackServerContext*, const v1::StreamJobTraceRequest* request) override {
      return MakeTraceStream(needs_, request->name())->Begin();
    }
    grpc::ServerWriteReactor<v1::StreamJobArtifactResponse>* StreamJobArtifact(
        grpc::CallbackServerContext*, const v1::StreamJobArtifactRequest* request) override {
      return MakeArtifactStream(needs_, *request)->Begin();
    }

   private:
    JobStreamNeeds needs_;
  };

  template <class Followed>
  using ByJob = std::map<std::int64_t, std::shared_ptr<Followed>>;
  template <class Followed>
  std::shared_ptr<Followed> Running(const ByJob<Followed>& running, std::int64_t job) {
    const std::lock_guard lock(running_mutex_);
    const auto found = running.find(job);
    return found == running.end() ? nullptr : found->second;
  }

  std::mutex running_mutex_;
  ByJob<RunningToolpath> running_;  // guarded by running_mutex_
  ByJob<RunningHeights> mills_;     // likewise
  JobBook book_{store, config};
  JobFactsBook facts_{store};
  SharedLogs logs_{{{store, book_, programs, projects}, feed, facts_, kInstance}};
  Executor executor_{2};
  Service service_;
  CellService cell_;
  MachineService machines_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::JobService::Stub> stub_;
  std::unique_ptr<v1::CellService::Stub> cell_stub_;
  std::unique_ptr<v1::MachineService::Stub> machine_stub_;
};

}  // namespace rmlcell::server
