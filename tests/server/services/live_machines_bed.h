#pragma once

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/machines/host_processes.h"
#include "server/machines/hosts.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/records/machine_options.h"
#include "server/results/job_results.h"
#include "server/runs/run_queue.h"
#include "server/services/handbox_service.h"
#include "server/services/job_service.h"
#include "server/services/machine_service.h"
#include "tests/server/jobs/dispatcher_bed.h"
#include "tests/server/refusing_store.h"

namespace rmlcell::server {

inline constexpr const char* kLaser = "machines/optimo-1";

// A host that answers each order at once, and goes when it is told to.
class AnsweringHost final : public HostLink {
 public:
  explicit AnsweringHost(Hosts& hosts) : hosts_(hosts) {}

  void Send(v1::HostResponse message) override {
    if (message.has_order()) {
      v1::HostRequest request;
      bool leaves = false;
      {
        const std::lock_guard lock(mutex_);
        orders_.push_back(message.order());
        *request.mutable_answer() = answer_;
        leaves = leaves_;
      }
      if (leaves) return hosts_.Leave(*this);
      request.mutable_answer()->set_number(message.order().number());
      hosts_.Receive(*this, std::move(request));
    } else if (message.has_stop()) {
      {
        const std::lock_guard lock(mutex_);
        stopped_ = message.stop().reason();
      }
      v1::HostRequest request;
      request.mutable_hand_back();
      hosts_.Receive(*this, std::move(request));
      hosts_.Leave(*this);
    } else if (message.has_memory()) {
      const std::lock_guard lock(mutex_);
      memory_ = message.memory();
    }
  }
  void Close(const Error&) override {}

  // Its line breaks when an order comes, before it has answered.
  void LeaveOnOrder() {
    const std::lock_guard lock(mutex_);
    leaves_ = true;
  }
  // What it was told last of the memory of its machine.
  v1::HostMemory memory() const {
    const std::lock_guard lock(mutex_);
    return memory_;
  }

  void Answer(const v1::HostOrderAnswer& answer) {
    const std::lock_guard lock(mutex_);
    answer_ = answer;
  }
  std::vector<v1::HostOrder> TakeOrders() {
    const std::lock_guard lock(mutex_);
    return std::exchange(orders_, {});
  }
  // Why it was told to go; empty: it was not.
  std::string stopped() const {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }

 private:
  Hosts& hosts_;
  mutable std::mutex mutex_;
  v1::HostOrderAnswer answer_;
  std::vector<v1::HostOrder> orders_;
  std::string stopped_;
  bool leaves_ = false;
  v1::HostMemory memory_;
};

// A value into each field that is one value, and into those of its messages.
inline void Fill(google::protobuf::Message& message, int depth = 2) {
  using google::protobuf::FieldDescriptor;
  const auto& of = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    if (field->is_repeated() || field->containing_oneof() != nullptr) continue;
    const std::string& name = field->name();
    if (name == "machine") {
      of.SetString(&message, field, "machines/optimo-1");
    } else if (name == "session" || name == "name") {
      of.SetString(&message, field, "machines/optimo-1/handboxSessions/3");
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      of.SetString(&message, field, name + " of the test");
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_INT32) {
      of.SetInt32(&message, field, field->number() + 1);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_INT64) {
      of.SetInt64(&message, field, field->number() + 2);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE) {
      of.SetDouble(&message, field, field->number() + 0.5);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      of.SetBool(&message, field, true);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && depth > 0) {
      Fill(*of.MutableMessage(&message, field), depth - 1);
    }
  }
}

// Services over a channel of this process, and a host of optimo-1.
class LiveMachines : public testing::Test {
 protected:
  // `patience`: of calls that wait for a host.
  explicit LiveMachines(std::chrono::milliseconds patience = std::chrono::minutes(1))
      : machine_service_(
            needs_, {*executor_, open_, refusing, feed_, "instance"},
            {.hosts = &hosts, .processes = &processes, .runs = &runs_, .patience = patience}) {
    grpc::ServerBuilder builder;
    for (grpc::Service* service :
         std::initializer_list<grpc::Service*>{&job_service_, &machine_service_, &handbox_service_})
      builder.RegisterService(service);
    builder.SetMaxReceiveMessageSize(80 << 20);
    server_ = builder.BuildAndStart();
    const auto channel = server_->InProcessChannel({});
    jobs = v1::JobService::NewStub(channel);
    machines = v1::MachineService::NewStub(channel);
    handbox = v1::HandboxService::NewStub(channel);
  }
  ~LiveMachines() override {
    hosts.CloseAll();
    server_->Shutdown(std::chrono::system_clock::now());
    server_->Wait();
    executor_.reset();  // what was posted is done
    bed_.End();
  }

  storage::Store& store() { return bed_.server.store(); }
  DispatcherBed& bed() { return bed_; }
  EventFeed& feed() { return feed_; }
  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + kPatience);
    return context;
  }
  template <class Stub, class Request, class Response>
  Response Call(const std::unique_ptr<Stub>& stub,
                grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                const Request& request) {
    Response response;
    status = (stub.get()->*method)(Context().get(), request, &response);
    return response;
  }
  void ExpectRefused(grpc::StatusCode code, const std::string& text) {
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_THAT(status.error_message(), testing::HasSubstr(text));
  }

  static v1::HostHello HelloOf(const std::string& computer) {
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/optimo-1");
    hello.set_host(computer + "/1");
    hello.set_computer(computer);
    hello.set_protocol(1);
    return hello;
  }
  // Of optimo-1; null: not yet.
  std::shared_ptr<AnsweringHost> TryJoin(const std::string& computer) {
    auto joined = std::make_shared<AnsweringHost>(hosts);
    if (!hosts.Join(joined, HelloOf(computer))) return nullptr;
    Tell(*joined, v1::MACHINE_STATE_IDLE, {}, computer);
    return joined;
  }
  std::shared_ptr<AnsweringHost> Joined(const std::string& computer = "hall") {
    std::shared_ptr<AnsweringHost> joined;
    EXPECT_TRUE(Eventually([&] {
      joined = TryJoin(computer);
      return joined != nullptr;
    }));
    return joined;
  }
  void Tell(const AnsweringHost& by, v1::MachineState state, const std::string& job = {},
            const std::string& computer = "hall") {
    v1::HostRequest request;
    v1::MachineStatus& told = *request.mutable_status();
    told.set_machine("machines/optimo-1");
    told.set_state(state);
    told.set_host(computer + "/1");
    if (!job.empty()) told.mutable_run()->set_job(job);
    hosts.Receive(by, std::move(request));
  }

  // The host has the request as field `asked` of an order, and the client what it gives as field
  // `given` of the answer; empty: nothing.
  template <class Stub, class Request, class Response>
  void ExpectHandedOn(const std::unique_ptr<Stub>& stub,
                      grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                      const std::string& asked, const std::string& given) {
    SCOPED_TRACE(asked);
    Request request;
    Fill(request);
    v1::HostOrderAnswer answer;
    if (!given.empty()) {
      Fill(*answer.GetReflection()->MutableMessage(
          &answer, v1::HostOrderAnswer::descriptor()->FindFieldByName(given)));
    }
    host->Answer(answer);
    const Response response = Call(stub, method, request);
    EXPECT_TRUE(status.ok()) << status.error_message();
    if (!given.empty()) {
      const google::protobuf::Message& expected = answer.GetReflection()->GetMessage(
          answer, v1::HostOrderAnswer::descriptor()->FindFieldByName(given));
      EXPECT_EQ(response.SerializeAsString(), expected.SerializeAsString());
    }
    const std::vector<v1::HostOrder> orders = host->TakeOrders();
    ASSERT_EQ(orders.size(), 1U);
    EXPECT_EQ(orders[0].caller(), "local");
    const auto* field = v1::HostOrder::descriptor()->FindFieldByName(asked);
    ASSERT_TRUE(orders[0].GetReflection()->HasField(orders[0], field));
    EXPECT_EQ(orders[0].GetReflection()->GetMessage(orders[0], field).SerializeAsString(),
              request.SerializeAsString());
    // A refusal comes back with the code of the host.
    v1::HostOrderAnswer refusal;
    refusal.mutable_refusal()->set_code("CELL-E9409");
    refusal.mutable_refusal()->set_message("not now");
    host->Answer(refusal);
    Call(stub, method, request);
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(status.error_message(), testing::HasSubstr("not now"));
    host->TakeOrders();
  }

  v1::MachineOptions Options() {
    return OptionsOf(Must(store().GetMachine("optimo-1"))).value_or(v1::MachineOptions());
  }

 private:
  DispatcherBed bed_;

 protected:
  RefusingStore refusing{bed_.server.store()};  // what feed, book and services read

 private:
  EventFeed feed_{refusing};
  Config config_;
  TestSteadyClock clock_;
  std::unique_ptr<Executor> executor_ = std::make_unique<Executor>(3);

 protected:
  grpc::Status status;  // of the newest call
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::MachineService::Stub> machines;
  std::unique_ptr<v1::HandboxService::Stub> handbox;
  Hosts hosts{{.store = bed_.server.store(),
               .feed = feed_,
               .executor = *executor_,
               .server = "this server",
               .join_token = "secret",
               .clock = clock_.clock()}};
  storage::TestDirectory folder;
  // Starts none: there is always one that is heard.
  HostProcesses processes{{.program = "/bin/true",
                           .server = "127.0.0.1:1",
                           .journals = folder.File("journals"),
                           .is_heard = [](const std::string&) { return true; }}};
  JobBook book{refusing, config_};
  std::shared_ptr<AnsweringHost> host = Joined();
  Gate gate{"secret"};

 private:
  OpenStreams open_;
  CallNeeds needs_{gate, *executor_, *executor_, 8 << 20};
  RunQueue runs_{{.store = bed_.server.store(),
                  .hosts = hosts,
                  .config = config_,
                  .executor = *executor_,
                  .server = "this server",
                  .clock = clock_.clock()}};
  ProgramBook program_book_{bed_.server.store(), config_};
  MemoryTools tools_{bed_.server.store(), program_book_};
  JobResults results_{bed_.server.store(), book, tools_};
  JobService job_service_{needs_, *executor_, book,  results_,  bed_.dispatcher(),
                          runs_,  feed_,      open_, "instance"};
  MachineService machine_service_;
  HandboxService handbox_service_{needs_, {*executor_, open_, refusing, feed_, &hosts}};
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace rmlcell::server
