#pragma once

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/machines/hosts.h"
#include "server/programs/language_tools.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "server/results/job_results.h"
#include "server/runs/run_queue.h"
#include "server/services/job_service.h"
#include "server/services/machine_service.h"
#include "server/services/program_service.h"
#include "server/services/project_service.h"
#include "tests/server/failing_store.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {

// Of machines, schedules and orders as well.
class FailingCellStore final : public FailingStore {
 public:
  using FailingStore::FailingStore;
  Result<storage::MachineRecord> PutMachine(const storage::MachineRecord& machine,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    return Or([&] { return store_.PutMachine(machine, expected, caller); });
  }
  Status DeleteMachine(std::string_view id, storage::Revision expected,
                       std::string_view caller) override {
    return Or([&] { return store_.DeleteMachine(id, expected, caller); });
  }
  Result<storage::ScheduleRecord> PutSchedule(const storage::ScheduleRecord& schedule,
                                              storage::Revision expected,
                                              std::string_view caller) override {
    return Or([&] { return store_.PutSchedule(schedule, expected, caller); });
  }
  Status DeleteSchedule(std::string_view machine, int number, std::string_view caller) override {
    return Or([&] { return store_.DeleteSchedule(machine, number, caller); });
  }
  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    return Or([&] { return store_.UnfinishedJobs(); });
  }
  Status DeleteJob(std::int64_t job, std::string_view caller) override {
    return Or([&] { return store_.DeleteJob(job, caller); });
  }
  Result<storage::JobRecord> Move(std::int64_t job, std::int64_t before,
                                  std::optional<int> priority,
                                  const std::vector<storage::NewEvent>& events) override {
    return Or([&] { return store_.Move(job, before, priority, events); });
  }
  Result<std::vector<storage::JobRecord>> ActOn(std::span<const std::int64_t> jobs,
                                                storage::QueueAct act,
                                                const EventOf& event) override {
    return Or([&] { return store_.ActOn(jobs, act, event); });
  }
  Result<std::unique_ptr<storage::BlobWriter>> WriteBlob(std::string_view sha256,
                                                         std::size_t size) override {
    return Or([&] { return store_.WriteBlob(sha256, size); });
  }
};

template <class Request>
Request FromText(const std::string& text) {
  Request request;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
  return request;
}

class UnaryCalls : public testing::Test {
 protected:
  UnaryCalls() {
    grpc::ServerBuilder builder;
    for (grpc::Service* service :
         std::initializer_list<grpc::Service*>{&jobs_, &machines_, &programs_, &projects_})
      builder.RegisterService(service);
    builder.SetMaxReceiveMessageSize(80 << 20);
    server_ = builder.BuildAndStart();
    channel = server_->InProcessChannel({});
    jobs = v1::JobService::NewStub(channel);
    machines = v1::MachineService::NewStub(channel);
    programs = v1::ProgramService::NewStub(channel);
    projects = v1::ProjectService::NewStub(channel);
  }
  ~UnaryCalls() override {
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
    bed_.End();
  }

  // The answer of a call, and in `status` how it ended.
  template <class Stub, class Request, class Response>
  Response Call(const std::unique_ptr<Stub>& stub,
                grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                const std::string& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    Response response;
    status = (stub.get()->*method)(&context, FromText<Request>(request), &response);
    return response;
  }
  // The same while one call of the store fails, then another, until it comes through.
  template <class Stub, class Request, class Response>
  Response InSpiteOfAll(const std::unique_ptr<Stub>& stub,
                        grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                     Response*),
                        const std::string& request) {
    for (int call = 1;; ++call) {
      store_.FailAt(call);
      Response response = Call(stub, method, request);
      if (!store_.failed()) {
        EXPECT_GT(call, 1) << Request::descriptor()->name();
        EXPECT_TRUE(status.ok()) << Request::descriptor()->name() << status.error_message();
        store_.FailAt(0);
        return response;
      }
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INTERNAL)
          << Request::descriptor()->name() << ", call " << call;
      EXPECT_THAT(status.error_message(), testing::HasSubstr("the disk is full"));
      if (status.ok()) return response;
    }
  }
  void ExpectRefused(grpc::StatusCode code, const std::string& text) {
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_THAT(status.error_message(), testing::HasSubstr(text));
  }

  // Of mill-1, whose memory has no limit, with an object of so many bytes.
  void PutObject(int slot, std::size_t bytes) {
    Must(store_.PutPrograms("mill-1", {{.slot = slot, .object = std::string(bytes, 'o')}}, {}, {}));
  }
  std::int64_t EndedJob(const std::vector<storage::NewArtifact>& artifacts) {
    const std::int64_t job = bed_.server.SubmitCheck();
    Must(bed_.server.store().Finish(bed_.server.Lease(), {.artifacts = artifacts}));
    return job;
  }

  grpc::Status status;  // of the newest call
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::MachineService::Stub> machines;
  std::unique_ptr<v1::ProgramService::Stub> programs;
  std::unique_ptr<v1::ProjectService::Stub> projects;

 protected:
  static constexpr std::size_t kWaitingMax = 100;  // calls that wait for the one lane of all
  DispatcherBed bed_;
  FailingCellStore store_{bed_.server.store()};

 private:
  Config config_;
  EventFeed feed_{bed_.server.store()};
  Gate gate_{"secret"};
  OpenStreams open_;

 protected:
  Executor executor_{1, kWaitingMax};

 private:
  CallNeeds needs_{gate_, executor_, executor_, 8 << 20};
  Hosts hosts_{{.store = bed_.server.store(), .feed = feed_, .executor = executor_}};
  RunQueue runs_{{.store = store_, .hosts = hosts_, .config = config_, .executor = executor_}};

 protected:
  ProgramBook program_book_{store_, config_};

 private:
  ProjectBook project_book_{store_};
  ProjectTransfer transfer_{store_, project_book_, program_book_};
  MemoryTools tools_{store_, program_book_};
  LanguageTools language_{store_, program_book_};
  JobBook book_{store_, config_};
  JobResults results_{store_, book_, tools_};
  JobService jobs_{needs_, executor_, book_, results_,  bed_.dispatcher(),
                   runs_,  feed_,     open_, "instance"};
  MachineService machines_{needs_, {executor_, open_, store_, feed_, "instance"}, {}};
  ProgramService programs_{needs_, store_, program_book_, tools_, language_, open_};
  ProjectService projects_{needs_, project_book_, transfer_, open_};
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace rmlcell::server
