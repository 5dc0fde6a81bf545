#include "tests/server/web/fake_cell.h"

#include <google/protobuf/any.pb.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <set>
#include <thread>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "rmlcell/v1/worker.grpc.pb.h"
#include "tests/server/web/fake_demo.h"
#include "tests/server/web/fake_stream.h"

namespace rmlcell::web::testing {
namespace {

// A status with two details, as the real server sends it. The text has what headers cannot carry.
grpc::Status Rich(grpc::StatusCode code, const std::string& text, const std::string& error_code) {
  google::rpc::Status rich;
  rich.set_code(static_cast<int>(code));
  rich.set_message(text);
  google::rpc::ErrorInfo info;
  info.set_reason("HOLE_RADIUS_ZERO");
  info.set_domain("rmlcell");
  (*info.mutable_metadata())["code"] = error_code;
  rich.add_details()->PackFrom(info);
  v1::ErrorDetail detail;
  detail.set_code(error_code);
  detail.set_number(348);
  detail.mutable_place()->set_line(12);
  rich.add_details()->PackFrom(detail);
  return {code, text, rich.SerializeAsString()};
}

// The streams that are open, which a test lets go on or stops. Thread-safe.
class OpenFakes {
 public:
  template <class Response>
  void Own(FakeStream<Response>* stream) {
    stream->on_done = [this, stream] {
      const std::lock_guard lock(mutex_);
      streams_.erase(stream);
    };
    {
      const std::lock_guard lock(mutex_);
      streams_[stream] = [stream] { stream->Advance(); };
    }
    stream->Advance();
  }
  // Lets every stream that waits look again.
  void Wake() {
    const std::lock_guard lock(mutex_);
    std::vector<void*> streams;
    for (const auto& [stream, advance] : streams_) streams.push_back(stream);
    for (void* stream : streams) {
      const auto found = streams_.find(stream);  // it may have ended since
      if (found != streams_.end()) std::function<void()>(found->second)();
    }
  }
  void Stop() {
    stopping_ = true;
    Wake();
  }
  bool stopping() const { return stopping_; }

 private:
  std::atomic<bool> stopping_ = false;
  std::recursive_mutex mutex_;  // an ended stream may leave from inside Wake
  std::map<void*, std::function<void()>> streams_;
};

class Jobs : public v1::JobService::CallbackService {
 public:
  Jobs(Counters& counters, OpenFakes& open) : counters_(counters), open_(open) {}

  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context,
                                   const v1::GetJobRequest* request, v1::Job* response) override {
    if (request->name() == "jobs/slow") return new Slow(counters_);
    ++counters_.calls;
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    response->set_name(request->name());
    response->set_last_sequence(9007199254740993);  // more than a double holds
    if (request->name() == "jobs/meta") {
      for (const auto& [key, value] : context->client_metadata()) {
        response->mutable_title()->append(std::string(key.data(), key.size()) + "=" +
                                          std::string(value.data(), value.size()) + "\n");
      }
      context->AddInitialMetadata("x-first", "one");
      context->AddTrailingMetadata("x-last", "two");
      context->AddTrailingMetadata("x-last", "three");
      context->AddTrailingMetadata("x-raw-bin", std::string("\0\xFF", 2));
    } else if (request->name() == "jobs/big") {
      response->set_title(std::string(1 << 20, 'b'));
    } else if (request->name() == "jobs/huge") {
      response->set_title(std::string(6 << 20, 'h'));
    } else if (request->name() == "jobs/18") {
      EndOfDemoJob(*response);
    } else if (request->name() != "jobs/1") {
      reactor->Finish(
          Rich(grpc::StatusCode::NOT_FOUND, "no job für 100 %\n" + request->name(), "CELL-E9004"));
      return reactor;
    }
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }

  grpc::ServerUnaryReactor* SubmitJob(grpc::CallbackServerContext* context,
                                      const v1::SubmitJobRequest* request,
                                      v1::Job* response) override {
    ++counters_.submitted;
    *response = request->job();
    response->set_name("jobs/2");
    response->set_state(v1::Job::STATE_QUEUED);
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }

  grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(
      grpc::CallbackServerContext*, const v1::WatchJobRequest* request) override {
    const std::string name = request->name();
    std::int64_t sequence = request->after_sequence();
    bool begun = false;
    auto* stream = new FakeStream<v1::WatchJobResponse>(
        counters_, [=, this](v1::WatchJobResponse& response, grpc::Status& end) mutable {
          response.set_instance_id("instance");
          if (!std::exchange(begun, true)) {
            response.mutable_snapshot()->set_name(name);
            return Step::kMessage;
          }
          if (name == "jobs/idle") return Step::kWait;
          if (name == "jobs/stop") {
            if (!open_.stopping()) return Step::kWait;
            end = {grpc::StatusCode::UNAVAILABLE, "the server stops"};
            return Step::kEnd;
          }
          ++sequence;
          if (name == "jobs/fail" && sequence > 2) {
            end = Rich(grpc::StatusCode::FAILED_PRECONDITION, "radius is 0", "OPT-E348");
            return Step::kEnd;
          }
          if (name == "jobs/1" && sequence > 5) return Step::kEnd;
          response.set_sequence(sequence);
          response.mutable_event()->set_sequence(sequence);
          response.mutable_event()->mutable_message()->set_text(
              name == "jobs/flood" ? std::string(kFloodBytes, 'f') : "event");
          if (name == "jobs/flood") ++counters_.produced;
          return Step::kMessage;
        });
    open_.Own(stream);
    return stream;
  }

 private:
  // Ends when its client leaves.
  class Slow : public grpc::ServerUnaryReactor {
   public:
    explicit Slow(Counters& counters) : counters_(counters) {
      ++counters_.calls;
      ++counters_.open;
    }
    void OnCancel() override {
      ++counters_.cancelled;
      Finish(grpc::Status::CANCELLED);
    }
    void OnDone() override {
      --counters_.open;
      delete this;
    }

   private:
    Counters& counters_;
  };

  Counters& counters_;
  OpenFakes& open_;
};

class Cells : public v1::CellService::CallbackService {
 public:
  Cells(Counters& counters, OpenFakes& open) : counters_(counters), open_(open) {}

  grpc::ServerWriteReactor<v1::WatchCellResponse>* WatchCell(
      grpc::CallbackServerContext*, const v1::WatchCellRequest* request) override {
    auto demo = std::make_shared<DemoStory>(request->after_sequence());
    auto* stream = new FakeStream<v1::WatchCellResponse>(
        counters_, [this, demo](v1::WatchCellResponse& response, grpc::Status& end) {
          if (open_.stopping()) {
            end = {grpc::StatusCode::UNAVAILABLE, "the server stops"};
            return Step::kEnd;
          }
          return demo->Next(response) ? Step::kMessage : Step::kWait;
        });
    open_.Own(stream);
    return stream;
  }

 private:
  Counters& counters_;
  OpenFakes& open_;
};

class Machines : public v1::MachineService::CallbackService {
 public:
  grpc::ServerUnaryReactor* ListMachines(grpc::CallbackServerContext* context,
                                         const v1::ListMachinesRequest*,
                                         v1::ListMachinesResponse* response) override {
    response->add_machines()->set_name("machines/optimo-1");
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }
};

class Programs : public v1::ProgramService::CallbackService {
 public:
  grpc::ServerUnaryReactor* ExplainError(grpc::CallbackServerContext* context,
                                         const v1::ExplainErrorRequest* request,
                                         v1::ExplainErrorResponse* response) override {
    Explain(request->code(), *response);
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }
};

class Workers : public v1::WorkerService::CallbackService {};

}  // namespace

struct FakeCell::Services {
  explicit Services(Counters& counters) : jobs(counters, open), cells(counters, open) {}
  OpenFakes open;
  Jobs jobs;
  Cells cells;
  Machines machines;
  Programs programs;
  Workers workers;
  std::atomic<bool> ending = false;
  std::thread clock;  // moves the story of WatchCell on
};

FakeCell::FakeCell(WebOptions options) : services_(std::make_unique<Services>(counters_)) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::ServerBuilder builder;
  builder.RegisterService(&services_->jobs);
  builder.RegisterService(&services_->cells);
  builder.RegisterService(&services_->machines);
  builder.RegisterService(&services_->programs);
  builder.RegisterService(&services_->workers);
  builder.SetMaxReceiveMessageSize(-1);
  int grpc_port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &grpc_port);
  server_ = builder.BuildAndStart();
  SetServing(true);
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  // A window of a known size; gRPC would have it grow with what it measures.
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kGrpcWindowBytes);
  options.secret = std::string(kSecret);
  Result<std::unique_ptr<WebServer>> web =
      WebServer::Start(options,
                       grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(grpc_port),
                                                 grpc::InsecureChannelCredentials(), arguments),
                       resources_, [this](const WebLogEntry& entry) {
                         const std::lock_guard lock(mutex_);
                         log_.push_back(entry);
                       });
  RMLCELL_CHECK(web.has_value());
  web_ = *std::move(web);
  services_->clock = std::thread([this] {
    while (!services_->ending) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      services_->open.Wake();
    }
  });
}

FakeCell::~FakeCell() {
  web_->Stop(std::chrono::milliseconds(0));
  services_->ending = true;
  services_->clock.join();
  server_->Shutdown(std::chrono::system_clock::now());
  server_->Wait();
}

void FakeCell::StopStreams() { services_->open.Stop(); }

void FakeCell::SetServing(bool serving) {
  server_->GetHealthCheckService()->SetServingStatus(serving);
}

std::vector<WebLogEntry> FakeCell::log() const {
  const std::lock_guard lock(mutex_);
  return log_;
}

}  // namespace rmlcell::web::testing
