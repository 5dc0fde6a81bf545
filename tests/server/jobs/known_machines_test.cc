#include "server/records/known_machines.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class CountedLists final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::MachineRecord>> ListMachines() override {
    ++lists;
    if (fails) return Error{ErrorCode::kCellStoreFailed, "the disk", {}};
    auto machines = store_.ListMachines();
    if (afterwards) std::exchange(afterwards, {})();
    return machines;
  }
  std::uint64_t MachineChanges() const override {
    return being_changed ? 0 : store_.MachineChanges();
  }
  int lists = 0;
  bool fails = false;
  bool being_changed = false;
  std::function<void()> afterwards;  // once
};

class KnownMachinesTest : public testing::Test {
 protected:
  void Rename(const std::string& title) {
    storage::MachineRecord machine = Must(bed.store().GetMachine("mill-1"));
    machine.title = title;
    Must(bed.store().PutMachine(machine, machine.revision));
  }
  ServerBed bed;
  CountedLists store{bed.store()};
  KnownMachines known{store};
};

TEST_F(KnownMachinesTest, TheyAreReadOnceForEachChange) {
  EXPECT_EQ(known.ListAtOnce(), nullptr);
  EXPECT_EQ(Must(known.List())->size(), 2U);
  EXPECT_EQ(Must(known.Get("optimo-1")).id, "optimo-1");
  EXPECT_NE(known.ListAtOnce(), nullptr);
  EXPECT_EQ(store.lists, 1);
  Rename("by the window");
  EXPECT_EQ(known.ListAtOnce(), nullptr);
  EXPECT_EQ(Must(known.Get("mill-1")).title, "by the window");
  EXPECT_EQ(store.lists, 2);
  Must(bed.store().DeleteMachine("mill-1", storage::kAnyRevision, {}));
  EXPECT_EQ(CodeOf(known.Get("mill-1")), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(store.lists, 3);
}

TEST_F(KnownMachinesTest, AChangeBehindTheReadingIsNotMissed) {
  store.afterwards = [&] { Rename("meanwhile"); };
  Must(known.List());
  EXPECT_EQ(known.ListAtOnce(), nullptr);
  EXPECT_EQ(Must(known.Get("mill-1")).title, "meanwhile");
}

// Store::MachineChanges: what was read while one is being changed does not stand.
TEST_F(KnownMachinesTest, WhileOneIsBeingChangedEachIsAskedFor) {
  store.being_changed = true;
  EXPECT_EQ(Must(known.List())->size(), 2U);
  EXPECT_EQ(known.ListAtOnce(), nullptr);
  Must(known.List());
  EXPECT_EQ(store.lists, 2);
  store.being_changed = false;
  Must(known.List());
  EXPECT_NE(known.ListAtOnce(), nullptr);
}

TEST_F(KnownMachinesTest, WhatCannotBeReadIsSaidAndAskedForAgain) {
  store.fails = true;
  EXPECT_EQ(CodeOf(known.Get("mill-1")), ErrorCode::kCellStoreFailed);
  store.fails = false;
  EXPECT_EQ(Must(known.Get("mill-1")).id, "mill-1");
}

}  // namespace
}  // namespace rmlcell::server
