#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <future>
#include <memory>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/executor.h"
#include "server/machines/hosts.h"
#include "server/records/machine_messages.h"
#include "server/records/machine_options.h"
#include "tests/server/fake_link.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {

// Hosts as the server hears of them, over lines of the test.
class HostsTest : public testing::Test {
 protected:
  static v1::HostHello Hello(const std::string& host = "elsewhere/1", std::int64_t fence = 0) {
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/mill-1");
    hello.set_host(host);
    hello.set_protocol(1);
    hello.set_fence(fence);
    return hello;
  }
  std::shared_ptr<FakeLink> Joined(const v1::HostHello& hello = Hello()) {
    auto link = std::make_shared<FakeLink>();
    const Status joined = hosts.Join(link, hello);
    EXPECT_TRUE(joined) << (joined ? "" : joined.error().detail);
    return link;
  }
  ErrorCode Refused(const v1::HostHello& hello) {
    const Status joined = hosts.Join(std::make_shared<FakeLink>(), hello);
    EXPECT_FALSE(joined);
    return joined ? ErrorCode::kCellInternal : joined.error().code;
  }
  static std::int64_t Fence(const FakeLink& link) {
    const auto welcome = link.Newest(v1::HostResponse::kWelcome);
    return welcome ? welcome->welcome().fence() : 0;
  }
  void Tell(const FakeLink& link, v1::MachineState state, std::int64_t time_ns = 5) {
    v1::HostRequest request;
    request.mutable_status()->set_machine("machines/mill-1");
    request.mutable_status()->set_state(state);
    request.mutable_status()->set_virtual_time_ns(time_ns);
    hosts.Receive(link, std::move(request));
  }
  void Beat(const FakeLink& link) {
    v1::HostRequest beat;
    beat.mutable_heartbeat()->set_number(1);
    hosts.Receive(link, std::move(beat));
  }
  // A RUN of mill-1 that this host was given; its number.
  std::int64_t RunGivenTo(const std::string& host) {
    v1::Job run;
    run.set_kind(v1::JOB_KIND_RUN);
    const std::int64_t job =
        Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                        .kind = "RUN",
                                        .specification = run.SerializeAsString(),
                                        .attempts_max = 1}))
            .job.id;
    Must(bed.store().AcquireJobs(
        {.worker = host, .kinds = {"RUN"}, .duration = std::chrono::hours(1)}));
    return job;
  }
  // An entry that is told, and a mark.
  static v1::HostRequest Entries(std::int64_t fence, std::int64_t first, bool clean) {
    v1::HostRequest request;
    v1::HostEntries& entries = *request.mutable_entries();
    entries.set_fence(fence);
    v1::JournalEntry& run = *entries.add_entries();
    run.set_sequence(first);
    run.set_fence(fence);
    run.mutable_run_begun()->set_run(1);
    v1::JournalEntry& mark = *entries.add_entries();
    mark.set_sequence(first + 1);
    mark.set_fence(fence);
    mark.mutable_mark()->set_state("where it stands");
    mark.mutable_mark()->set_clean(clean);
    mark.mutable_mark()->set_virtual_time_ns(77);
    return request;
  }
  void TearDown() override {
    hosts.CloseAll();
    executor.reset();  // what was posted is done
  }

  // Waits until what was posted before is done: each thread of the executor has come here.
  void Settle() {
    const auto together = std::make_shared<std::barrier<>>(kThreads + 1);
    for (int thread = 0; thread < kThreads; ++thread)
      executor->Post([together] { together->arrive_and_wait(); });
    together->arrive_and_wait();
  }

  // The events of the machine in the log of the cell.
  std::vector<v1::MachineEvent> Told() {
    std::vector<v1::MachineEvent> told;
    for (const storage::EventRecord& event : Must(bed.store().AllEvents(0, 10'000))) {
      if (event.kind != kMachineEvent) continue;
      EXPECT_EQ(event.resource, "machines/mill-1");
      told.emplace_back().ParseFromString(event.payload);
    }
    return told;
  }

  static constexpr int kThreads = 2;

  ServerBed bed;
  EventFeed feed{bed.store()};
  TestSteadyClock clock;
  std::unique_ptr<Executor> executor = std::make_unique<Executor>(kThreads);
  Hosts hosts{{.store = bed.store(),
               .feed = feed,
               .executor = *executor,
               .server = "this server",
               .join_token = "secret",
               .clock = clock.clock()}};
};

}  // namespace rmlcell::server
