// Two hosts that fight for one machine, over the store, while clocks are stepped (live.md 10.05).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/executor.h"
#include "server/records/machine_messages.h"
#include "tests/server/fake_link.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::seconds;

struct OneServer {
  OneServer(storage::Store& store, const std::string& name)
      : feed(store),
        hosts({.store = store,
               .feed = feed,
               .executor = *executor,
               .server = name,
               .join_token = "secret",
               .clock = clock.clock()}) {}

  ~OneServer() {
    hosts.CloseAll();
    executor.reset();  // what was posted is done
  }
  OneServer(const OneServer&) = delete;
  OneServer& operator=(const OneServer&) = delete;

  EventFeed feed;
  TestSteadyClock clock;
  std::unique_ptr<Executor> executor = std::make_unique<Executor>(2);
  Hosts hosts;
};

// A host, with what it believes to have.
struct OneHost {
  std::string name;
  std::shared_ptr<FakeLink> link{};
  OneServer* server = nullptr;
  std::int64_t fence = 0;  // 0: it has the machine no more, or had it never
  std::int64_t told = 0;   // sequence of its newest entry
};

class FightingHosts : public testing::Test {
 protected:
  Status Join(OneHost& host, OneServer& server) {
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/mill-1");
    hello.set_host(host.name);
    hello.set_protocol(1);
    hello.set_fence(host.fence);
    auto link = std::make_shared<FakeLink>();
    const Status joined = server.hosts.Join(link, hello);
    if (!joined) return joined;
    const std::int64_t before = host.fence;
    host.link = link;
    host.server = &server;
    host.fence = link->Newest(v1::HostResponse::kWelcome)->welcome().fence();
    if (host.fence != before) host.told = 0;
    return joined;
  }
  // As a host that moves the machine tells: a run has begun, and where it stands.
  static void Tell(OneHost& host) {
    v1::HostRequest request;
    request.mutable_entries()->set_fence(host.fence);
    v1::JournalEntry& run = *request.mutable_entries()->add_entries();
    run.set_fence(host.fence);
    run.set_sequence(++host.told);
    run.mutable_run_begun()->set_run(host.told);
    v1::JournalEntry& mark = *request.mutable_entries()->add_entries();
    mark.set_fence(host.fence);
    mark.set_sequence(++host.told);
    mark.mutable_mark()->set_fence(host.fence);
    mark.mutable_mark()->set_sequence(host.told);
    host.server->hosts.Receive(*host.link, std::move(request));
  }
  static void Renew(OneHost& host) {
    v1::HostRequest request;
    request.mutable_renew()->set_fence(host.fence);
    host.server->hosts.Receive(*host.link, std::move(request));
  }
  static std::ptrdiff_t TimesTold(const OneHost& host, v1::HostResponse::MessageCase kind) {
    return std::ranges::count_if(host.link->All(),
                                 [kind](const auto& one) { return one.message_case() == kind; });
  }
  storage::MachineLease Lease() {
    const auto leases = Must(bed_.store().MachineLeases());
    EXPECT_EQ(leases.size(), 1U);
    return leases.front();
  }
  // Runs that a fence told of, as the log has them.
  int RunsOf(std::int64_t fence) {
    int runs = 0;
    for (const storage::EventRecord& event : Must(bed_.store().AllEvents(0, 100'000))) {
      v1::MachineEvent told;
      if (event.kind != kMachineEvent || !told.ParseFromString(event.payload)) continue;
      runs += told.has_run_begun() && told.fence() == fence ? 1 : 0;
    }
    return runs;
  }
  // Of both servers alike; that of people is another matter.
  void Pass(seconds time) {
    a_.clock.Advance(time);
    b_.clock.Advance(time);
    unrenewed_ += time;
  }

  ServerBed bed_;
  OneServer a_{bed_.store(), "a"};
  OneServer b_{bed_.store(), "b"};
  seconds unrenewed_{0};  // since the holder renewed its lease, or got it
};

// LIVE-10.05, LIVE-3.02: whichever server they ask, and however the clock of people is stepped: one
// has the machine, and the other one is told so and changes nothing, until the first has not
// renewed its lease for as long as it holds. One that was overtaken stores nothing more.
TEST_F(FightingHosts, OneHasTheMachineAndTheOtherTouchesNothing) {
  b_.clock.Advance(std::chrono::hours(1));
  std::mt19937 random(1);
  std::array<OneHost, 2> hosts = {OneHost{.name = "elsewhere/1"}, OneHost{.name = "other/2"}};
  std::size_t holder = 0;
  ASSERT_TRUE(Join(hosts[0], a_));
  int refused = 0, taken = 0;
  for (int round = 0; round < 300; ++round) {
    OneHost& has = hosts[holder];
    OneHost& wants = hosts[1 - holder];
    OneServer& server = random() % 2 == 0 ? a_ : b_;
    switch (random() % 8) {
      case 0:
        bed_.clock().Advance(std::chrono::hours(1));
        break;
      case 1:
        bed_.clock().Advance(-std::chrono::hours(1));
        break;
      case 2:
      case 3:  // it renews in time, and moves the machine; or is not heard for a while
        if (random() % 4 != 0) {
          const int before = RunsOf(has.fence);
          const auto renewed = TimesTold(has, v1::HostResponse::kRenewed);
          Renew(has);
          ASSERT_TRUE(Eventually([&] {
            return TimesTold(has, v1::HostResponse::kRenewed) > renewed;
          })) << round;
          unrenewed_ = seconds(0);
          Tell(has);
          ASSERT_TRUE(Eventually([&] { return RunsOf(has.fence) == before + 1; })) << round;
        }
        break;
      case 4:
      case 5:
        Pass(seconds(random() % 90));
        break;
      default: {
        const storage::MachineLease before = Lease();
        const std::size_t events = Must(bed_.store().AllEvents(0, 100'000)).size();
        const Status joined = Join(wants, server);
        if (!joined) {
          ++refused;
          ASSERT_EQ(joined.error().code, ErrorCode::kCellMachineTaken) << round;
          ASSERT_EQ(Lease(), before) << round;
          ASSERT_EQ(Must(bed_.store().AllEvents(0, 100'000)).size(), events) << round;
          break;
        }
        ++taken;
        ASSERT_GE(unrenewed_, Hosts::kLease) << round << ": the first one is alive";
        ASSERT_GT(wants.fence, before.fence) << round;
        ASSERT_EQ(Lease().host, wants.name) << round;
        const int runs = RunsOf(has.fence);  // the first one speaks as if nothing had been
        if (has.server != wants.server) {
          Tell(has);
          ASSERT_TRUE(Eventually([&] { return TimesTold(has, v1::HostResponse::kLeaseLost) > 0; }))
              << round;
        } else {
          ASSERT_TRUE(has.link->closed()) << round;
        }
        ASSERT_EQ(RunsOf(has.fence), runs) << round;
        ASSERT_EQ(Lease().fence, wants.fence) << round;
        has.fence = 0;
        holder = 1 - holder;
        unrenewed_ = seconds(0);
      }
    }
  }
  EXPECT_GT(refused, 30);
  EXPECT_GT(taken, 3);
}

}  // namespace
}  // namespace rmlcell::server
