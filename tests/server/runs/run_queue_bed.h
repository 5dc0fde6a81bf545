#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "proto/bridge/milling.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "server/records/machine_options.h"
#include "server/runs/run_queue.h"
#include "tests/server/fake_link.h"

// A queue of runs whose machines are lines of the test.
namespace rmlcell::server {

using storage::JobState;

class RunQueueTest : public testing::Test {
 protected:
  void SetUp() override {
    hosts.OnNews([this](const std::string& machine) { runs.Wake(machine); });
    book.OnRunWaits([this](const std::string& machine) { runs.Wake(machine); });
    book.OnToldToWait([this](v1::Job& job) { runs.TellWhyItWaits(job); });
    ASSERT_TRUE(hosts.Join(link, Hello()));
    fence = link->Newest(v1::HostResponse::kWelcome)->welcome().fence();
  }
  void TearDown() override {
    hosts.CloseAll();
    executor.reset();  // what was posted is done
  }
  static v1::HostHello Hello() {
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/mill-1");
    hello.set_host("hall/1");
    hello.set_protocol(1);
    return hello;
  }
  v1::MachineStatus Idle() {
    v1::MachineStatus status;
    status.set_machine("machines/mill-1");
    status.set_state(v1::MACHINE_STATE_IDLE);
    status.set_host("hall/1");
    status.set_zeroed(true);
    return status;
  }
  static void Block(v1::MachineStatus& status, const std::string& code) {
    status.add_start_blockers()->set_code(code);
  }
  void Tell(const v1::MachineStatus& status) {
    v1::HostRequest request;
    *request.mutable_status() = status;
    hosts.Receive(*link, std::move(request));
  }
  // The queue begins nothing by itself.
  void TellBlocked() {
    v1::MachineStatus status = Idle();
    Block(status, "CELL-E9423");
    Tell(status);
  }
  // What a person asks for who begins a job, or goes on with one that was cut off.
  static v1::HostOrder RunJob() {
    v1::HostOrder order;
    order.set_caller("bert");
    order.mutable_run_job();
    return order;
  }
  static v1::HostOrder ContinueJob() {
    v1::HostOrder order;
    order.set_caller("bert");
    order.mutable_continue_job()->mutable_start()->set_preview_token("a token");
    return order;
  }
  std::int64_t Submit(const std::function<void(v1::Job&)>& change = [](v1::Job&) {}) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("a.rml");
    job.mutable_inline_program()->set_content("PA;PU100,0;");
    change(job);
    std::int64_t id = 0;
    book.Submit(request, "anna", [&](const Result<v1::Job>& made) {
      if (made) id = *ParseJobName(made->name());
    });
    EXPECT_TRUE(Eventually([&] { return id != 0; }));
    return id;
  }
  std::vector<v1::HostOrder> Orders() const {
    std::vector<v1::HostOrder> orders;
    for (const v1::HostResponse& message : link->All()) {
      if (message.has_order()) orders.push_back(message.order());
    }
    return orders;
  }
  v1::HostOrder NewestOrder(std::size_t count) {
    EXPECT_TRUE(Eventually([&] { return Orders().size() >= count; }));
    const auto orders = Orders();
    return orders.empty() ? v1::HostOrder() : orders.back();
  }
  void Refuse(const v1::HostOrder& order, const std::string& code) {
    v1::HostRequest request;
    request.mutable_answer()->set_number(order.number());
    request.mutable_answer()->mutable_refusal()->set_code(code);
    request.mutable_answer()->mutable_refusal()->set_message("why");
    hosts.Receive(*link, std::move(request));
  }
  // What a start at a step would do: with a token, or with why not.
  void Look(const v1::HostOrder& order, const std::string& token, const std::string& code = {}) {
    v1::HostRequest request;
    request.mutable_answer()->set_number(order.number());
    v1::PreviewStartResponse& preview = *request.mutable_answer()->mutable_preview();
    preview.set_preview_token(token);
    if (!code.empty()) preview.add_refusals()->set_code(code);
    hosts.Receive(*link, std::move(request));
  }
  void Accept(const v1::HostOrder& order) {
    v1::HostRequest request;
    request.mutable_answer()->set_number(order.number());
    *request.mutable_answer()->mutable_status() = Idle();
    hosts.Receive(*link, std::move(request));
  }
  // The first that it tells: from here on all of before is in the store.
  void Mark() {
    v1::HostRequest request;
    v1::JournalEntry& entry = *request.mutable_entries()->add_entries();
    request.mutable_entries()->set_fence(fence);
    entry.set_sequence(1);
    entry.set_fence(fence);
    entry.mutable_run_begun()->set_run(1);
    hosts.Receive(*link, request);
    link->Newest(v1::HostResponse::kEntriesStored);
  }
  storage::JobRecord Job(std::int64_t id) { return Must(bed.store().GetJob(id)); }
  // All that was posted until now, and what that posted, is done.
  void Settle() {
    for (int round = 0; round < 5; ++round) {
      std::promise<void> done;
      executor->Post([&] { done.set_value(); });
      done.get_future().wait();
    }
  }

  ServerBed bed;
  EventFeed feed{bed.store()};
  Config config;
  TestSteadyClock clock;
  std::unique_ptr<Executor> executor = std::make_unique<Executor>(1);
  Hosts hosts{{.store = bed.store(),
               .feed = feed,
               .executor = *executor,
               .server = "this server",
               .join_token = "secret",
               .clock = clock.clock()}};
  RunQueue runs{{.store = bed.store(),
                 .hosts = hosts,
                 .config = config,
                 .executor = *executor,
                 .server = "this server",
                 .clock = clock.clock()}};
  JobBook book{bed.store(), config};
  std::shared_ptr<FakeLink> link = std::make_shared<FakeLink>();
  std::int64_t fence = 0;
};

}  // namespace rmlcell::server
