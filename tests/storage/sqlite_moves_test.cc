// What moves and what is let go in the queue, uploads by their size, and executables of an end.
#include <gmock/gmock.h>

#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/tables.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SqliteMoves : public testing::Test {
 protected:
  Store& store() { return bed_.store(); }
  std::int64_t Put(NewJob job) {
    job.kind = "CHECK";
    return Must(store().SubmitAndWait(std::move(job))).job.id;
  }
  std::vector<std::int64_t> InOrder() {
    std::vector<std::int64_t> ids;
    for (const JobRecord& job : Must(store().ListJobs({.order = JobOrder::kQueue, .limit = 99})))
      ids.push_back(job.id);
    return ids;
  }

  SqliteBed bed_;
};

// Each move halves the room in front of the next job that comes: when none is left, those that were
// moved are spread anew, behind all others.
TEST_F(SqliteMoves, WhatIsMovedToTheEndStandsThereHoweverOften) {
  const std::int64_t first = Put({});
  const std::int64_t second = Put({});
  const std::int64_t third = Put({});
  Must(store().Move(second, 0, {}, {}));
  for (int i = 0; i < 70; ++i) {
    Must(store().Move(first, 0, {}, {}));
    ASSERT_THAT(InOrder(), ElementsAre(third, second, first)) << i;
    Must(store().Move(second, 0, {}, {}));
    ASSERT_THAT(InOrder(), ElementsAre(third, first, second)) << i;
  }
}

// Where there is room between two, who is moved there takes half of it and nobody else has another
// place.
TEST_F(SqliteMoves, WhereThereIsRoomNoOtherIsMoved) {
  Put({});
  const std::int64_t back = Put({});
  const std::int64_t moved = Put({});
  const std::int64_t last = Put({});
  Must(store().Move(moved, back, {}, {}));
  EXPECT_EQ(Must(store().GetJob(moved)).place, 1.5);
  const std::uint64_t before = store().JobChanges(moved);
  EXPECT_EQ(Must(store().Move(last, back, {}, {})).place, 1.75);
  EXPECT_EQ(Must(store().GetJob(moved)).place, 1.5);
  EXPECT_EQ(store().JobChanges(moved), before);
}

// Where there is none, those that were moved part the way from 1 to 2 evenly, each counted once.
TEST_F(SqliteMoves, ThoseWithoutRoomPartTheWay) {
  Put({});
  const std::int64_t back = Put({});
  std::int64_t mover = Put({});
  std::int64_t other = Put({});
  Must(store().Move(other, back, {}, {}));
  int spreads = 0;
  for (int i = 0; i < 120; ++i) {
    const double before = Must(store().GetJob(other)).place;
    const double place = Must(store().Move(mover, back, {}, {})).place;
    const double after = Must(store().GetJob(other)).place;
    if (after != before) {
      ++spreads;
      EXPECT_DOUBLE_EQ(after, 4.0 / 3.0);
      EXPECT_DOUBLE_EQ(place, 5.0 / 3.0);
    }
    std::swap(mover, other);
  }
  EXPECT_GE(spreads, 2);
}

// Ready ones come before those that are held back, whatever their priority is.
TEST_F(SqliteMoves, ReadyOnesAreListedBeforeTheOthers) {
  const std::int64_t held = Put({.held = true});
  const std::int64_t low = Put({.priority = -3});
  const std::int64_t high = Put({.priority = 2});
  const std::int64_t held_high = Put({.priority = 7, .held = true});
  EXPECT_THAT(InOrder(), ElementsAre(high, low, held_high, held));
}

// What did not succeed is waited for no more by the one that a person let go.
TEST_F(SqliteMoves, WhatIsLetGoWaitsForNothingThatIsOver) {
  const std::int64_t other = Put({.held = true});
  const std::int64_t awaited = Put({});
  const std::int64_t waits = Put({.after = {awaited}});
  const std::int64_t waits_twice = Put({.after = {other, awaited}});
  Must(store().RequestCancel(awaited, {}));
  EXPECT_THAT(Must(store().GetJob(waits)).after, ElementsAre(awaited));
  EXPECT_THAT(Must(store().LetGo(waits, {})).after, IsEmpty());
  EXPECT_THAT(Must(store().GetJob(waits)).after, IsEmpty());
  Must(store().LetGo(waits_twice, {}));
  EXPECT_THAT(Must(store().GetJob(waits_twice)).after, ElementsAre(other));
}

// Told with the piece that is too much, not at the end alone.
TEST_F(SqliteMoves, AnUploadTakesNoMoreThanItsSize) {
  const std::string all = "0123456789";
  const auto writer = [&] { return Must(store().WriteBlob(HexOf(Sha256(all)), all.size())); };
  const auto one = writer();
  ASSERT_TRUE(one->Append("012345"));
  const Status more = one->Append("67890");
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error().code, ErrorCode::kCellTooLarge);
  const auto other = writer();
  ASSERT_TRUE(other->Append("012345"));
  ASSERT_TRUE(other->Append("6789"));
  EXPECT_TRUE(other->Finish(std::chrono::hours(1)));
  EXPECT_EQ(Must(store().ReadBlob(HexOf(Sha256(all)))), all);
}

// A run may compile more than one program.
TEST_F(SqliteMoves, AllExecutablesOfAnEndAreKept) {
  Must(store().PutMachine({.id = "m", .family = "optimo"}, 0));
  std::vector<NewExecutable> made;
  for (const int slot : {3, 4, 5}) {
    const auto put = Must(store().PutPrograms("m", {{.slot = slot, .object = "o"}}, {}));
    made.push_back({.slot = slot,
                    .object_revision = put.front().revision,
                    .bytes = "executable " + std::to_string(slot)});
  }
  const std::int64_t job = Put({.machine = "m"});
  const auto leased = Must(store().Acquire("w", {"CHECK"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  ASSERT_EQ(leased->job.id, job);
  Must(store().Finish(leased->lease,
                      {.outcome = {.state = JobState::kSucceeded}, .executables = made}));
  for (const NewExecutable& one : made)
    EXPECT_EQ(Must(store().GetProgram("m", one.slot)).executable, one.bytes) << one.slot;
}

// A second program of the same large content leaves nothing behind at others.
TEST_F(SqliteMoves, AContentThatComesTwiceHoldsNoOther) {
  Must(store().PutMachine({.id = "m", .family = "optimo"}, 0));
  const std::string large = Noise((std::size_t{1} << 20) + 5, 1);
  Must(store().PutPrograms("m", {{.slot = 1, .object = Noise(2'000, 2)}}, {}));
  Must(store().PutPrograms("m", {{.slot = 2, .object = large}}, {}));
  Must(store().PutPrograms("m", {{.slot = 3, .object = large}}, {}));
  EXPECT_TRUE(
      Eventually([&] { return NumberIn(bed_.path(), "SELECT sum(holds) FROM blob") == 0; }));
  Must(store().DeleteProgram("m", 1, kAnyRevision));
  EXPECT_TRUE(Eventually([&] { return NumberIn(bed_.path(), "SELECT count(*) FROM blob") == 1; }));
}

// Of a submission that fails behind its first rows nothing is counted: its machine may go.
TEST_F(SqliteMoves, ASubmissionThatFailsCountsForNoMachine) {
  Must(store().PutMachine({.id = "m", .family = "optimo"}, 0));
  const auto twice = store().SubmitAndWait({.machine = "m",
                                            .kind = "CHECK",
                                            .attachments = {{.name = "main", .bytes = "1"},
                                                            {.name = "more", .bytes = "2"},
                                                            {.name = "more", .bytes = "3"}}});
  EXPECT_EQ(CodeOf(twice), ErrorCode::kCellInvalidArgument);
  EXPECT_TRUE(Must(store().UnfinishedJobs()).empty());
  Must(store().DeleteMachine("m", kAnyRevision));
}

// What is cancelled is ready or not no more: those that are held back are counted without it.
TEST_F(SqliteMoves, ACancelledOneIsHeldBackNoMore) {
  const auto blocked = [&] {
    return NumberIn(bed_.path(), "SELECT value FROM mark WHERE name = 'blocked jobs'");
  };
  const std::int64_t held = Put({.held = true});
  const std::int64_t gone = Put({.held = true});
  EXPECT_EQ(blocked(), 2);
  EXPECT_TRUE(Must(store().GetJob(gone)).blocked);
  Must(store().RequestCancel(gone, {}));
  EXPECT_FALSE(Must(store().GetJob(gone)).blocked);
  EXPECT_EQ(blocked(), 1);
  const std::int64_t ready = Put({});
  const auto leased = Must(store().Acquire("w", {"CHECK"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  EXPECT_EQ(leased->job.id, ready);
  EXPECT_EQ(blocked(), 1);
  Must(store().LetGo(held, {}));
  EXPECT_EQ(blocked(), 0);
}

// An answer that writes does so in one commit with what was queued before it: a job that came with
// it keeps its machine, and one that ended with it does not.
TEST_F(SqliteMoves, JobsOfTheSameCommitCountForTheirMachine) {
  Must(store().PutMachine({.id = "made"}, 0));
  Must(store().PutMachine({.id = "over"}, 0));
  const std::int64_t over = Put({.machine = "over"});
  std::promise<std::vector<std::optional<ErrorCode>>> deleted;
  store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>&) {
    store().Submit({.machine = "made", .kind = "CHECK"}, [](const Result<SubmittedJob>&) {});
    const auto made = CodeOf(store().DeleteMachine("made", kAnyRevision));
    store().SendRequestCancel(over, {}, [](const Result<JobRecord>&) {});
    deleted.set_value({made, CodeOf(store().DeleteMachine("over", kAnyRevision))});
  });
  EXPECT_THAT(deleted.get_future().get(),
              ElementsAre(std::optional(ErrorCode::kCellPrecondition), std::nullopt));
}

// queue_table.h: where nobody stands is nothing, which is not the place 0.
TEST_F(SqliteMoves, WhereNobodyStandsIsNoPlace) {
  const std::int64_t job = Put({});
  bed_.Close();
  Connection connection(Must(Database::Open(bed_.path(), Database::Access::kReadWrite, {})));
  QueueTable& queue = connection.tables.queue;
  EXPECT_EQ(Must(queue.LastPlace("", "ORDER", 0)), std::nullopt);
  EXPECT_EQ(Must(queue.PlaceBefore("", "ORDER", {.job = job, .place = 99.0})), std::nullopt);
}

// records.h kTeachRecordsKept: the newest of each machine, here of numbers far apart.
TEST_F(SqliteMoves, TheOldestOfWhatWasTaughtGoes) {
  const auto teach = [&](const std::string& machine) {
    return Must(store().AddTeachRecord({.machine = machine, .program = 1, .entry = "e"}));
  };
  for (const char* machine : {"m", "n"}) {
    Must(store().PutMachine({.id = machine}, 0));
    for (int i = 0; i < 3; ++i) teach(machine);
  }
  bed_.Close();
  ExecuteIn(bed_.path(), "UPDATE taught SET number = " + std::to_string(kTeachRecordsKept) +
                             " WHERE machine = 'm' AND number = 3");
  bed_.Reopen();
  EXPECT_EQ(teach("m"), kTeachRecordsKept + 1);
  const auto numbers = [&](const std::string& machine) {
    std::vector<std::int64_t> found;
    for (const TeachRecord& one : Must(store().ListTeachRecords(machine, 0, 0, 99)))
      found.push_back(one.number);
    return found;
  };
  EXPECT_THAT(numbers("m"), ElementsAre(kTeachRecordsKept + 1, kTeachRecordsKept, 2));
  EXPECT_THAT(numbers("n"), ElementsAre(3, 2, 1));
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
