#include "server/programs/special_programs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SpecialProgramsTest : public testing::Test {
 protected:
  Result<v1::StoreSpecialProgramsResponse> Store(std::vector<int> slots = {}, bool replace = false,
                                                 const std::string& machine = "optimo-1") {
    v1::StoreSpecialProgramsRequest request;
    request.set_parent("machines/" + machine);
    request.mutable_slots()->Add(slots.begin(), slots.end());
    request.set_replace(replace);
    return StoreSpecialPrograms(bed.store(), request, "anna");
  }
  std::vector<int> Slots() {
    std::vector<int> slots;
    for (const auto& program : Must(bed.store().ListPrograms("optimo-1", 0, 100)))
      slots.push_back(program.slot);
    return slots;
  }
  void Put(int slot) {
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf("STOP\n")}}, {}));
  }

  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
};

// OPT-B.82
TEST_F(SpecialProgramsTest, AreStoredAsAnyProgramIs) {
  const auto stored = Must(Store());
  ASSERT_EQ(stored.programs_size(), 4);
  EXPECT_THAT(Slots(), ElementsAre(1, 2, 4, 90));
  const v1::Program& up = stored.programs(1);
  EXPECT_EQ(up.name(), "machines/optimo-1/programs/2");
  EXPECT_EQ(up.title(), "Z-UP");
  EXPECT_EQ(up.file_name(), "2.S");
  EXPECT_EQ(up.SerializeAsString(), Must(programs.Get(up.name())).SerializeAsString());
  // The object is that of the text, which comes back with its comments.
  const auto text = Must(programs.Read(up.name(), v1::PROGRAM_FORM_SOURCE));
  EXPECT_THAT(text.bytes, HasSubstr("; Z-UP: raise the head"));
  EXPECT_EQ(Must(programs.Read(up.name(), v1::PROGRAM_FORM_OBJECT)).bytes, ObjectOf(text.bytes));
  // OPT-10.17: whoever stores the same text by hand is not warned of its number.
  const auto again = programs.Store({.name = up.name(), .file_name = "2.S", .bytes = text.bytes});
  ASSERT_TRUE(again);
  EXPECT_EQ(again.value->findings().diagnostics_size(), 0);
}

TEST_F(SpecialProgramsTest, ThoseThatAreAskedFor) {
  const auto stored = Must(Store({90, 2, 90}));
  ASSERT_EQ(stored.programs_size(), 2);
  EXPECT_EQ(stored.programs(0).title(), "Z-UP");
  EXPECT_EQ(stored.programs(1).title(), "TCP");
  EXPECT_THAT(Slots(), ElementsAre(2, 90));
  const auto none = Store({4, 5});
  EXPECT_EQ(CodeOf(none), ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(none.error().detail, HasSubstr("no special program 5; there are 1, 2, 4, 90"));
  EXPECT_THAT(Slots(), ElementsAre(2, 90));
}

TEST_F(SpecialProgramsTest, AFilledSlotIsRefusedUnlessItIsToBeReplaced) {
  Put(2);
  Put(90);
  const auto refused = Store();
  EXPECT_EQ(CodeOf(refused), ErrorCode::kCellAlreadyExists);
  EXPECT_THAT(refused.error().detail, HasSubstr("2, 90; ask to replace them"));
  EXPECT_THAT(Slots(), ElementsAre(2, 90));
  EXPECT_TRUE(Store({1, 4}));
  const std::string before = Must(programs.Get("machines/optimo-1/programs/2")).etag();
  // OPT-1.12: the executable of what was there goes with it.
  ASSERT_TRUE(programs.Store({.name = "machines/optimo-1/programs/102",
                              .form = v1::PROGRAM_FORM_EXECUTABLE,
                              .bytes = ExecutableOf(2, "STOP\n")}));
  const auto replaced = Must(Store({}, true));
  EXPECT_EQ(replaced.programs_size(), 4);
  EXPECT_NE(replaced.programs(1).etag(), before);
  EXPECT_FALSE(replaced.programs(1).has_executable_bytes());
}

// OPT-1.08: one that is longer than an object of the machine may be is refused by its file; what
// was there stays.
TEST_F(SpecialProgramsTest, OneThatIsTooLongForItsMachineIsRefused) {
  const v1::Program stored = Must(Store({2})).programs(0);
  ASSERT_GT(stored.object_bytes(), 100);
  const auto limit = [&](std::int64_t bytes) {
    storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
    machine.parameters = {{"OBJECT_LIMIT", std::to_string(bytes)}};
    Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  };
  limit(stored.object_bytes() - 1);
  const auto refused = Store({2}, true);
  ASSERT_EQ(CodeOf(refused), ErrorCode::kObjectTooLong);
  EXPECT_THAT(refused.error().detail, testing::StartsWith("2.S: "));
  EXPECT_EQ(Must(programs.Get(stored.name())).etag(), stored.etag());
  limit(stored.object_bytes());
  EXPECT_EQ(CodeOf(Store({2}, true)), std::nullopt);
}

TEST_F(SpecialProgramsTest, MachinesThatHaveNone) {
  const auto mill = Store({}, false, "mill-1");
  EXPECT_EQ(CodeOf(mill), ErrorCode::kCellPrecondition);
  EXPECT_THAT(mill.error().detail, HasSubstr("rml1, which has no special programs"));
  EXPECT_EQ(CodeOf(Store({}, false, "none")), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(Store({}, false, "")), ErrorCode::kCellInvalidArgument);
}

// Another client fills a slot between the look at it and the change: the store refuses all.
TEST_F(SpecialProgramsTest, EveryErrorOfTheStoreIsHandedOn) {
  FailingStore store(bed.store());
  v1::StoreSpecialProgramsRequest request;
  request.set_parent("machines/optimo-1");
  ExpectFailuresHandedOn(store, "storing special programs", 3,
                         [&] { return CodeOf(StoreSpecialPrograms(store, request, "anna")); });
}

}  // namespace
}  // namespace rmlcell::server
