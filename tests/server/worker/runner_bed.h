#pragma once

#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/report.pb.h"
#include "rmlcell/v1/worker.grpc.pb.h"
#include "server/worker/job_runner.h"
#include "server/worker/server_line.h"

namespace rmlcell::server {

// A server that says what the test wants and notes what it hears.
class FakeServer final : public v1::WorkerService::Service {
 public:
  FakeServer() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    builder.SetMaxReceiveMessageSize(-1);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~FakeServer() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
  }

  const std::string& address() const { return address_; }

  // Set before a worker joins.
  grpc::Status refusal = grpc::Status::OK;
  bool welcomes = true;  // else it says something else, and no more
  std::int64_t lease_ms = 60'000;
  int window = 256;
  std::function<void(const v1::WorkRequest&)> heard;  // what to do on a message; may call Send

  void Send(const v1::WorkResponse& message) {
    const std::lock_guard lock(mutex_);
    stream_->Write(message);
  }
  // Ends the line without a word.
  void HangUp() {
    const std::lock_guard lock(mutex_);
    context_->TryCancel();
  }

  std::vector<v1::WorkRequest> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

  grpc::Status Work(grpc::ServerContext* context,
                    grpc::ServerReaderWriter<v1::WorkResponse, v1::WorkRequest>* stream) override {
    v1::WorkRequest message;
    if (!stream->Read(&message) || !refusal.ok()) return refusal;
    if (!welcomes) {
      stream->Write(v1::WorkResponse());
      return grpc::Status::OK;
    }
    {
      const std::lock_guard lock(mutex_);
      context_ = context;
      stream_ = stream;
      requests_ = {message};  // of this worker alone
    }
    v1::WorkResponse welcome;
    *welcome.mutable_welcome()->mutable_lease() =
        google::protobuf::util::TimeUtil::MillisecondsToDuration(lease_ms);
    welcome.mutable_welcome()->set_events_window(window);
    Send(welcome);
    std::int64_t events = 0;
    while (stream->Read(&message)) {
      {
        const std::lock_guard lock(mutex_);
        requests_.push_back(message);
      }
      if (message.has_events() && stores) {
        events += message.events().events_size();
        v1::WorkResponse stored;
        *stored.mutable_events_stored()->mutable_lease() = message.events().lease();
        stored.mutable_events_stored()->set_count(events);
        Send(stored);
      }
      if (heard) heard(message);
    }
    return grpc::Status::OK;
  }

  bool stores = true;  // events are said to be durable at once

 private:
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  std::mutex mutex_;
  grpc::ServerContext* context_ = nullptr;
  grpc::ServerReaderWriter<v1::WorkResponse, v1::WorkRequest>* stream_ = nullptr;
  std::vector<v1::WorkRequest> requests_;
};

class JobRunnerTest : public testing::Test {
 protected:
  static v1::WorkerLease Lease(std::int64_t fence = 5) {
    v1::WorkerLease lease;
    lease.set_job(7);
    lease.set_attempt(2);
    lease.set_fence(fence);
    return lease;
  }
  static v1::Milling& MillingOf(v1::WorkerAssignment& assignment) {
    return *assignment.mutable_job()->mutable_simulation()->mutable_milling();
  }
  // A block of 60 x 30 x 5 mm under an end mill of 3 mm.
  static v1::WorkerAssignment Mill(const std::string& source, double cell_mm = 0.2) {
    v1::WorkerAssignment assignment = Assignment(v1::JOB_KIND_SIMULATE, source, "rml1");
    assignment.set_profile("t1");
    v1::Milling& milling = MillingOf(assignment);
    milling.mutable_stock()->set_size_x_mm(60.0);
    milling.mutable_stock()->set_size_y_mm(30.0);
    milling.mutable_stock()->set_size_z_mm(5.0);
    milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
    milling.mutable_tool()->set_diameter_mm(3.0);
    milling.set_cell_mm(cell_mm);
    return assignment;
  }
  static v1::WorkerAssignment Assignment(v1::JobKind kind, const std::string& source,
                                         const std::string& family = "optimo") {
    v1::WorkerAssignment assignment;
    *assignment.mutable_lease() = Lease();
    assignment.mutable_job()->set_kind(kind);
    assignment.set_family(family);
    assignment.set_main_program(45);
    assignment.set_default_schedules(true);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(45);
    program.set_file_name(family == "optimo" ? "part.S" : "part.rml");
    program.set_content(source);
    program.set_size(static_cast<std::int64_t>(source.size()));
    program.set_is_source(true);
    program.set_object_revision(3);
    v1::Budget& budget = *assignment.mutable_budget();
    budget.set_steps(1'000'000'000);
    budget.set_virtual_time_ns(1'000'000'000'000'000);
    budget.set_memory_bytes(std::int64_t{1} << 30);
    budget.set_processor_ns(600'000'000'000);
    budget.set_output_bytes(std::int64_t{1} << 28);
    return assignment;
  }
  static v1::WorkResponse Order(v1::WorkerControl::Kind kind, std::int64_t fence = 5,
                                double value = 0.0) {
    v1::WorkResponse message;
    *message.mutable_control()->mutable_lease() = Lease(fence);
    message.mutable_control()->set_kind(kind);
    message.mutable_control()->set_value(value);
    return message;
  }
  static v1::WorkResponse Release(std::int64_t fence = 5) {
    v1::WorkResponse message;
    *message.mutable_release()->mutable_lease() = Lease(fence);
    return message;
  }
  static bool IsPosition(const v1::WorkRequest& message) {
    return message.has_heartbeat() && message.heartbeat().has_progress();
  }

  // A line to the server, which is there: on a busy computer it may answer too late at first.
  std::unique_ptr<ServerLine> Joined(const std::string& pool = {}) const {
    for (int asked = 0; asked < 10; ++asked) {
      auto joined = ServerLine::Join(
          {.server = server.address(), .join_token = "secret", .name = "w", .pool = pool});
      if (joined) return *std::move(joined);
    }
    throw std::runtime_error("the server does not answer");
  }
  // Works on it; all that the worker says has been heard when this returns.
  bool Work(const v1::WorkerAssignment& assignment,
            const std::vector<v1::WorkResponse>& before = {}) {
    line_ = Joined();
    for (const v1::WorkResponse& message : before) server.Send(message);
    JobRunner runner(*line_, stopping, processor_time);
    const bool go_on = runner.Work(assignment);
    line_->Close();
    while (!line_->gone()) line_->Receive(std::chrono::seconds(60));
    heard_ = server.requests();
    return go_on;
  }
  // The same. The program comes behind what is said before, which is read so before anything of it
  // is done.
  bool WorkBehind(v1::WorkerAssignment assignment, std::vector<v1::WorkResponse> before) {
    v1::AssignedProgram& program = *assignment.mutable_programs(0);
    v1::WorkResponse& rest = before.emplace_back();
    rest.mutable_blob()->set_slot(program.slot());
    rest.mutable_blob()->set_chunk(program.content());
    program.clear_content();
    return Work(assignment, before);
  }
  // The end that the worker told; there is one at most, and nothing follows it.
  std::optional<v1::WorkerFinish> Finished() {
    std::optional<v1::WorkerFinish> finish;
    for (const v1::WorkRequest& message : heard_) {
      EXPECT_FALSE(finish && !message.has_heartbeat());
      if (message.has_finish()) finish = message.finish();
    }
    if (finish) {
      EXPECT_EQ(finish->lease().SerializeAsString(), Lease().SerializeAsString());
    }
    return finish;
  }
  v1::Outcome Outcome() {
    const auto finish = Finished();
    EXPECT_TRUE(finish);
    return finish ? finish->outcome() : v1::Outcome();
  }
  bool HandedBack() {
    return std::ranges::any_of(heard_, [](const v1::WorkRequest& m) {
      return m.has_hand_back() &&
             m.hand_back().lease().SerializeAsString() == Lease().SerializeAsString();
    });
  }
  std::map<std::string, std::string> Artifacts() {
    std::map<std::string, std::string> artifacts;
    for (const v1::WorkerArtifact& artifact : ArtifactMessages())
      artifacts[artifact.name()] += artifact.chunk();
    return artifacts;
  }
  // Those that came by themselves, and those of the end.
  std::vector<v1::WorkerArtifact> ArtifactMessages() {
    std::vector<v1::WorkerArtifact> all;
    for (const v1::WorkRequest& message : heard_) {
      if (message.has_artifact()) all.push_back(message.artifact());
      for (const v1::WorkerArtifact& artifact : message.finish().artifacts())
        all.push_back(artifact);
    }
    for (const v1::WorkerArtifact& artifact : all) {
      EXPECT_EQ(artifact.lease().SerializeAsString(), Lease().SerializeAsString());
      EXPECT_LE(artifact.chunk().size(), std::size_t{1} << 20);
    }
    return all;
  }
  std::vector<std::string> Names() {
    std::vector<std::string> names;
    for (const auto& [name, bytes] : Artifacts()) names.push_back(name);
    return names;
  }
  v1::RunReport Report() {
    v1::RunReport report;
    EXPECT_TRUE(report.ParseFromString(Artifacts()["report"]));
    return report;
  }
  std::vector<v1::JobEvent> Events() {
    std::vector<v1::JobEvent> events;
    for (const v1::WorkRequest& message : heard_) {
      const auto& last = message.finish().events();  // of a finish; else there are none
      events.insert(events.end(), last.begin(), last.end());
      if (!message.has_events()) continue;
      EXPECT_EQ(message.events().lease().SerializeAsString(), Lease().SerializeAsString());
      events.insert(events.end(), message.events().events().begin(),
                    message.events().events().end());
    }
    return events;
  }

  FakeServer server;
  std::atomic<bool> stopping = false;
  ProcessorTime processor_time = ThreadProcessorTime_s;
  std::unique_ptr<ServerLine> line_;
  std::vector<v1::WorkRequest> heard_;
};

}  // namespace rmlcell::server
