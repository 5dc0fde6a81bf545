// Events that were removed before they were read: whatever they told is seen all the same, and
// once.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/machines/machine_statuses.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

// Which has removed all of its events, as long as it is told so.
class StoreWithoutEvents final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> gone = false;

  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t after, int limit) override {
    if (gone) return Error{ErrorCode::kCellEventsGone, "they are gone", {}};
    return store_.AllEvents(after, limit);
  }
  Result<std::int64_t> EventsGoneUntil() override {
    return gone ? store_.LastPosition() : store_.EventsGoneUntil();
  }
};

class GoneEvents : public HostsTest {
 protected:
  StoreWithoutEvents store{bed.store()};
  EventFeed own_feed{store};
};

// A machine that was removed is not told of any more.
TEST_F(GoneEvents, AMachineIsSeenToBeRemoved) {
  const auto is_told = [this](const std::string& machine) {
    return own_feed.LatestAfter("machines/" + machine, 0).has_value();
  };
  const MachineStatuses statuses(store, own_feed, *executor);
  ASSERT_TRUE(Eventually([&] { return is_told("mill-1") && is_told("optimo-1"); }));
  Settle();
  store.gone = true;
  Must(bed.store().DeleteMachine("optimo-1", storage::kAnyRevision));
  EXPECT_TRUE(Eventually([&] { return !is_told("optimo-1"); }));
  EXPECT_TRUE(is_told("mill-1"));
}

// LIVE-5.03: its host is sent all of the memory, and not again with the next look.
TEST_F(GoneEvents, AMemoryIsSentOnce) {
  Hosts others({.store = store,
                .feed = own_feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()});
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(link, Hello()));
  const auto sent = [&link] {
    const auto all = link->All();
    return std::ranges::count(all, v1::HostResponse::kMemory, &v1::HostResponse::message_case);
  };
  store.gone = true;
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = "PA;"}}, {}, "anna"));
  EXPECT_TRUE(Eventually([&] { return sent() == 2; }));
  Settle();
  store.gone = false;
  others.TakeStored();
  EXPECT_EQ(sent(), 2);
  others.CloseAll();
  Settle();
}

}  // namespace
}  // namespace rmlcell::server
