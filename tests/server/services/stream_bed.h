#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "rmlcell/v1/job.grpc.pb.h"
#include "server/base/config.h"
#include "server/base/executor.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/services/job_streams.h"
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

  explicit StreamBed(storage::SqliteOptions options = {})
      : bed(std::move(options)), service_({executor_, open, book_, feed, kInstance}) {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::JobService::NewStub(server_->InProcessChannel({}));
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
  OpenedStream<v1::WatchJobsResponse> WatchAll(const v1::WatchJobsRequest& request);
  OpenedStream<v1::StreamJobToolpathResponse> Toolpath(const std::string& name, int level);
  OpenedStream<v1::StreamJobTraceResponse> Trace(const std::string& name);
  OpenedStream<v1::StreamJobArtifactResponse> Artifact(const std::string& name,
                                                       const std::string& artifact);

  ServerBed bed;
  EventFeed feed{bed.store()};
  OpenStreams open;

 private:
  class Service final : public v1::JobService::CallbackService {
   public:
    explicit Service(JobStreamNeeds needs) : needs_(std::move(needs)) {}
    grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(
        grpc::CallbackServerContext*, const v1::WatchJobRequest* request) override {
      return MakeJobWatch(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::WatchJobsResponse>* WatchJobs(
        grpc::CallbackServerContext*, const v1::WatchJobsRequest* request) override {
      return MakeJobsWatch(needs_, *request)->Begin();
    }
    grpc::ServerWriteReactor<v1::StreamJobToolpathResponse>* StreamJobToolpath(
        grpc::CallbackServerContext*, const v1::StreamJobToolpathRequest* request) override {
      return MakeToolpathStream(needs_, request->name(), request->level())->Begin();
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

  Config config_;
  JobBook book_{bed.store(), config_};
  Executor executor_{2};
  Service service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::JobService::Stub> stub_;
};

}  // namespace rmlcell::server
