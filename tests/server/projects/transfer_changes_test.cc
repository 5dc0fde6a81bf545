// A machine that is changed while its programs go into a project or come from one, and what is too
// large for one.
#include <gtest/gtest.h>

#include <functional>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// One in which others are at work between two calls.
class BusyStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::ProgramSummary>> ListPrograms(std::string_view machine, int after,
                                                            int limit) override {
    ++lists;
    if (before_list) before_list();
    return store_.ListPrograms(machine, after, limit);
  }
  Result<std::vector<storage::ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<storage::ProgramWrite>& programs,
      const std::vector<storage::ScheduleRecord>& schedules, std::string_view caller) override {
    if (refusal) return Error{*refusal, "meanwhile", {}};
    return store_.PutPrograms(machine, programs, schedules, caller);
  }
  int lists = 0;
  std::function<void()> before_list{};
  std::optional<ErrorCode> refusal{};
};

class TransferChanges : public testing::Test {
 protected:
  template <class T>
  static std::optional<ErrorCode> Code(const ProgramResult<T>& result) {
    return result ? std::nullopt : std::optional(result.error.error.code);
  }
  std::optional<ErrorCode> Take(const std::string& machine, const std::string& id) {
    v1::TransferProjectFromMachineRequest request;
    request.set_machine("machines/" + machine);
    request.set_project_id(id);
    return Code(transfer.FromMachine(request, "Thu Mar 04 08:52:34 1993", "anna"));
  }
  ProgramResult<v1::TransferProjectResponse> Bring(const std::string& etag, bool validate_only) {
    v1::TransferProjectRequest request;
    request.set_name("projects/door");
    request.set_machine("machines/optimo-1");
    request.set_etag(etag);
    request.set_validate_only(validate_only);
    return transfer.ToMachine(request, "anna");
  }
  // Somebody else stores it.
  void PutDoor() {
    Must(bed.store().PutPrograms(
        "optimo-1", {{.slot = 7, .object = ObjectOf("STOP\n"), .expected = storage::kAnyRevision}},
        {}));
  }

  ServerBed bed;
  BusyStore store{bed.store()};
  Config config;
  ProjectBook projects{store};
  ProgramBook programs{store, config};
  ProjectTransfer transfer{store, projects, programs};
};

// What was read one by one belongs together: it is read up to three times.
TEST_F(TransferChanges, AMachineThatChangesIsReadAgain) {
  PutDoor();
  // The second of the two looks of a reading finds the program stored anew.
  const auto changes = [this](int readings) {
    store.lists = 0;
    store.before_list = [this, readings] {
      if (store.lists % 2 == 0 && store.lists <= 2 * readings) PutDoor();
    };
  };
  changes(2);
  EXPECT_EQ(Take("optimo-1", "twice"), std::nullopt);
  EXPECT_EQ(store.lists, 6);
  changes(3);
  EXPECT_EQ(Take("optimo-1", "three-times"), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(store.lists, 6);
}

TEST_F(TransferChanges, AMachineOfNoFamilyHasNoProject) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  EXPECT_EQ(Take("odd", "odd"), ErrorCode::kCellUnknownFamily);
}

// A slot that was filled or emptied since it was looked at is a change; other trouble stays what it
// is, and so does a change that nobody asked about.
TEST_F(TransferChanges, ASlotThatWasFilledMeanwhileIsAChange) {
  PutDoor();
  ASSERT_EQ(Take("optimo-1", "door"), std::nullopt);
  const auto asked = Bring("", true);
  ASSERT_TRUE(asked);
  const std::string etag = asked.value->etag();
  ASSERT_FALSE(etag.empty());
  for (const ErrorCode code : {ErrorCode::kCellAlreadyExists, ErrorCode::kCellNotFound}) {
    store.refusal = code;
    EXPECT_EQ(Code(Bring(etag, false)), ErrorCode::kCellEtagMismatch);
    EXPECT_EQ(Code(Bring("", false)), code);
  }
  store.refusal = ErrorCode::kCellStoreFailed;
  EXPECT_EQ(Code(Bring(etag, false)), ErrorCode::kCellStoreFailed);
  store.refusal.reset();
  EXPECT_EQ(Code(Bring(etag, false)), std::nullopt);
}

// 64 MiB of sources are the most that a project has.
TEST_F(TransferChanges, MoreThanAProjectHoldsIsRefused) {
  const std::string half = std::string(32 << 20, ';');
  Must(bed.store().PutPrograms(
      "mill-1",
      {{.slot = 1, .object = half}, {.slot = 2, .object = half}, {.slot = 3, .object = ";"}}, {}));
  EXPECT_EQ(Take("mill-1", "large"), ErrorCode::kCellTooLarge);
}

}  // namespace
}  // namespace rmlcell::server
