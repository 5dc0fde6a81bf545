// Pages of what was taught at a machine, by number and size (ListTeachEntriesRequest).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/machines/teach_book.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// At whose machine 1,001 steps were taught.
class TaughtStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::TeachRecord>> ListTeachRecords(std::string_view machine, int,
                                                             std::int64_t before,
                                                             int limit) override {
    std::vector<storage::TeachRecord> records;
    for (std::int64_t number = before == 0 ? kTaught : before - 1;
         number >= 1 && static_cast<int>(records.size()) < limit; --number)
      records.push_back({.machine = std::string(machine), .number = number, .program = 12});
    return records;
  }

 private:
  static constexpr std::int64_t kTaught = 1'001;
};

class PagesOfTeaching : public testing::Test {
 protected:
  v1::ListTeachEntriesResponse Page(int size, const std::string& token = "") {
    v1::ListTeachEntriesRequest request;
    request.set_machine("machines/optimo-1");
    request.set_page_size(size);
    request.set_page_token(token);
    return Must(TeachBook(many).List(request));
  }

  ServerBed bed;
  TaughtStore many{bed.store()};
  TeachBook book{bed.store()};
};

// A hundred where nothing is said, at most a thousand, newest first.
TEST_F(PagesOfTeaching, HaveAHundredOrSoManyAsWantedUpToAThousand) {
  const v1::ListTeachEntriesResponse usual = Page(0);
  ASSERT_EQ(usual.entries_size(), 100);
  EXPECT_EQ(usual.entries(0).number(), 1'001);
  EXPECT_EQ(usual.entries(99).number(), 902);
  EXPECT_EQ(usual.next_page_token(), "902");
  EXPECT_EQ(Page(0, "902").entries(0).number(), 901);
  for (const int size : {1'000, 1'001}) {
    const v1::ListTeachEntriesResponse most = Page(size);
    EXPECT_EQ(most.entries_size(), 1'000) << size;
    EXPECT_EQ(most.next_page_token(), "2") << size;
  }
  EXPECT_EQ(Page(999).entries_size(), 999);
  EXPECT_EQ(Page(1'000, "2").entries_size(), 1);
  EXPECT_EQ(Page(1'000, "2").next_page_token(), "");
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  request.set_page_size(-1);
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellInvalidArgument);
  request.set_page_size(1);
  request.set_machine("optimo-1");
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellInvalidArgument);
}

// Of a machine whose family this version does not know nothing is taken back.
TEST_F(PagesOfTeaching, AMachineOfAnotherVersionTakesNothingBack) {
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  Must(bed.store().AddTeachRecord({.machine = "odd", .program = 12, .entry = ""}));
  v1::UndoTeachEntriesRequest undo;
  undo.set_program("machines/odd/programs/12");
  undo.set_down_to(1);
  const auto undone = book.TakeBack(undo, "anna");
  ASSERT_FALSE(undone);
  EXPECT_EQ(undone.error().code, ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(undone.error().detail, "'lathe'; there are optimo rml1");
}

// What cannot be read is told, whatever is asked of it.
TEST_F(PagesOfTeaching, ADamagedEntryIsToldOf) {
  Must(bed.store().AddTeachRecord({.machine = "optimo-1", .program = 12, .entry = "\xFF\xFF"}));
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  const auto listed = book.List(request);
  ASSERT_FALSE(listed);
  EXPECT_EQ(listed.error().code, ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(listed.error().detail, "what was taught at optimo-1");
  v1::UndoTeachEntriesRequest undo;
  undo.set_program("machines/optimo-1/programs/12");
  undo.set_down_to(1);
  EXPECT_EQ(CodeOf(book.TakeBack(undo, "anna")), ErrorCode::kCellStoreCorrupt);
  undo.set_program("machines/none/programs/12");
  EXPECT_EQ(CodeOf(book.TakeBack(undo, "anna")), ErrorCode::kCellUnknownMachine);
  undo.set_program("programs/12");
  EXPECT_EQ(CodeOf(book.TakeBack(undo, "anna")), ErrorCode::kCellInvalidArgument);
}

}  // namespace
}  // namespace rmlcell::server
