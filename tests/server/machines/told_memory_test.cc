// What a host is told of the memory of its machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "server/machines/host_words.h"
#include "storage/store.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

// OPT-1.13: programs that are gone are told as well as those that are there.
TEST(ToldMemory, SaysWhatIsThereAndWhatIsGone) {
  storage::MachineMemory memory;
  storage::ProgramRecord& program = memory.programs.emplace_back();
  program.slot = 12;
  program.name = "door";
  program.object = "object 12";
  program.revision = 3;
  memory.deleted = {4, 9};
  const v1::HostMemory told = MemoryOf(memory);
  EXPECT_TRUE(told.whole());
  EXPECT_THAT(told.deleted_programs(), testing::ElementsAre(4, 9));
  ASSERT_EQ(told.programs_size(), 1);
  EXPECT_EQ(told.programs(0).slot(), 12);
  EXPECT_EQ(told.programs(0).title(), "door");
  EXPECT_EQ(told.programs(0).content(), "object 12");
  EXPECT_EQ(told.programs(0).object_revision(), 3);
}

// A store whose reading of a memory fails, or is followed by something before it is told.
class ReadMemory final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> fails = false;
  std::function<void()> behind_first;
  std::atomic<bool> behind_due = true;

  Result<storage::MachineMemory> GetMachineMemory(std::string_view machine,
                                                  const WantsPrograms& wants_programs) override {
    if (fails) return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
    auto memory = store_.GetMachineMemory(machine, wants_programs);
    if (behind_first && behind_due.exchange(false)) behind_first();
    return memory;
  }
};

class SentMemory : public HostsTest {
 protected:
  SentMemory() { Put("PA;"); }
  void TearDown() override {
    others.CloseAll();
    HostsTest::TearDown();
  }
  void Put(const std::string& object) {
    Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = object}}, {}, "anna"));
  }
  static std::string Sent(const FakeLink& link) {
    const auto memory = link.Newest(v1::HostResponse::kMemory);
    if (!memory || memory->memory().programs_size() != 1) return {};
    return memory->memory().programs(0).content();
  }

  ReadMemory store{bed.store()};
  Hosts others{{.store = store,
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()}};
};

// LIVE-5.03: what is stored while a host is told its memory, it is told behind that.
TEST_F(SentMemory, OfAHostThatJoinsComesInItsOrder) {
  std::future<void> stored;
  store.behind_first = [this, &stored] {
    Put("PU1,1;");
    stored = std::async(std::launch::async, [this] { others.TakeStored(); });
    // Whoever does not wait for what was read before is through by then.
    stored.wait_for(std::chrono::milliseconds(100));
  };
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(link, Hello()));
  stored.get();
  EXPECT_EQ(Sent(*link), "PU1,1;");
}

// LIVE-5.03: a host that could not be told what is stored begins none of it, and is told when that
// can be read.
TEST_F(SentMemory, WhatCannotBeReadDoesNotBegin) {
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(link, Hello()));
  Tell(*link, v1::MACHINE_STATE_IDLE);
  store.fails = true;
  Put("PU2,2;");
  const auto started = [&] {
    std::promise<ErrorCode> answered;
    v1::HostOrder start;
    start.mutable_start()->set_program(5);
    others.Ask("mill-1", std::move(start), [&answered](const Result<v1::HostOrderAnswer>& answer) {
      answered.set_value(answer ? ErrorCode::kCellInternal : answer.error().code);
    });
    return answered.get_future().get();
  };
  EXPECT_EQ(started(), ErrorCode::kCellStoreFailed);
  for (const v1::HostResponse& message : link->All()) EXPECT_FALSE(message.has_order());
  EXPECT_EQ(Sent(*link), "PA;");
  store.fails = false;
  others.TakeStored();
  EXPECT_EQ(Sent(*link), "PU2,2;");
}

}  // namespace
}  // namespace rmlcell::server
