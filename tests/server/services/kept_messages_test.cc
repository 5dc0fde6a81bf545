// What is kept of the messages of the log, and for how long (shared_log.h).
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/jobs/job_book.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

class KeptMessages : public testing::Test {
 protected:
  storage::EventRecord Deleted(std::int64_t position, std::size_t name_bytes) {
    storage::EventRecord event;
    event.position = position;
    event.kind = storage::kDeleted;
    event.resource = "jobs/" + std::string(name_bytes, '7');
    return event;
  }
  std::shared_ptr<SharedLog> LogOfJobs() {
    v1::Subscription wanted;
    wanted.set_id("jobs");
    wanted.mutable_jobs()->set_events_only(true);
    return std::make_shared<SharedLog>(
        SharedLogNeeds{records, room.feed, facts, "instance"},
        std::make_shared<ToldEvents>(records),
        std::vector<CellSubscription>{Must(CellSubscription::Make(wanted))});
  }
  std::int64_t Last() { return Must(room.bed.store().LastPosition()); }
  // Until who looks into the log sees it.
  void Say(const std::vector<std::string>& texts) {
    room.Say(lease, texts);
    AwaitTold();
  }
  void AwaitTold() {
    EXPECT_TRUE(Eventually([&] { return room.feed.position() == Last(); }));
  }
  // As long a text as makes a message of one event that is kept with so many bytes.
  std::string TextOf(std::size_t bytes) {
    const std::int64_t before = Last();
    const std::string text(bytes - 1000, 'x');
    Say({text});
    const auto piece = Must(LogOfJobs()->After(before, false));
    return std::string(text.size() + bytes - sizeof(LogPiece) - piece->message->size(), 'x');
  }
  // As long a text as makes an event of so many bytes.
  std::string EventOfBytes(std::size_t bytes) {
    const std::int64_t before = Last();
    const std::string text(bytes - 1000, 'x');
    Say({text});
    const auto event = Must(room.bed.store().AllEvents(before, 1)).at(0);
    return std::string(text.size() + bytes - ToldEvents(records).Of(event).bytes->size(), 'x');
  }
  static v1::WatchCellResponse Read(const std::optional<LogPiece>& piece) {
    v1::WatchCellResponse message;
    EXPECT_TRUE(
        piece && piece->message &&
        message.ParseFromArray(piece->message->begin(), static_cast<int>(piece->message->size())));
    return message;
  }

  StreamBed room;
  JobBook book{room.bed.store(), room.config};
  JobFactsBook facts{room.bed.store()};
  CellRecords records{room.bed.store(), book, room.programs, room.projects};
  std::int64_t job = room.Submit();
  storage::Lease lease = room.bed.Lease();
};

// So many bytes of events are kept, the newest ones; one alone however large it is.
TEST_F(KeptMessages, EventsAreSerialisedOnce) {
  constexpr std::size_t kHalf = ToldEvents::kKeptBytes / 2;
  const std::size_t rest =
      ToldEvents(records).Of(Deleted(9, kHalf - 100)).bytes->size() + 100 - kHalf;
  ToldEvents told(records);
  const auto one = told.Of(Deleted(1, kHalf - rest));
  ASSERT_EQ(one.bytes->size(), kHalf);
  EXPECT_TRUE(one.whole);
  const auto two = told.Of(Deleted(2, kHalf - rest));
  EXPECT_EQ(told.Of(Deleted(1, 1)).bytes, one.bytes);
  EXPECT_EQ(told.Of(Deleted(2, 1)).bytes, two.bytes);
  const auto three = told.Of(Deleted(3, 1));
  EXPECT_NE(told.Of(Deleted(1, kHalf - rest)).bytes, one.bytes);
  EXPECT_EQ(told.Of(Deleted(2, 1)).bytes, two.bytes);
  EXPECT_EQ(told.Of(Deleted(3, 2)).bytes, three.bytes);
  ToldEvents large(records);
  const auto alone = large.Of(Deleted(1, 3 * kHalf));
  EXPECT_EQ(large.Of(Deleted(1, 1)).bytes, alone.bytes);
  // Of two that are too large the newest.
  const auto newest = large.Of(Deleted(2, 3 * kHalf));
  EXPECT_EQ(large.Of(Deleted(2, 1)).bytes, newest.bytes);
  EXPECT_NE(large.Of(Deleted(1, 1)).bytes, alone.bytes);
}

// For one watch alone so many bytes of messages, the newest ones; for two that share them more.
TEST_F(KeptMessages, MessagesAreMadeOnceForThoseThatShareThem) {
  const std::string text = TextOf(SharedLog::kBytesOfOne / 2);
  const std::int64_t before = Last();
  Say({text, text, text});
  const auto made = [](const std::shared_ptr<SharedLog>& log, std::int64_t position) {
    return *Must(log->After(position, false))->message;
  };
  const auto log = LogOfJobs();
  const grpc::Slice first = made(log, before);
  ASSERT_EQ(first.size() + sizeof(LogPiece), SharedLog::kBytesOfOne / 2);
  const grpc::Slice second = made(log, before + 1);
  const grpc::Slice third = made(log, before + 2);
  EXPECT_EQ(made(log, before + 1).begin(), second.begin());
  EXPECT_EQ(made(log, before + 2).begin(), third.begin());
  EXPECT_NE(made(log, before).begin(), first.begin());
  const auto shared = LogOfJobs();
  const auto other = shared;
  const grpc::Slice kept = made(shared, before);
  made(shared, before + 2);
  EXPECT_EQ(made(other, before).begin(), kept.begin());
}

// Of two that are too large for one watch the newest is kept.
TEST_F(KeptMessages, OfTwoLargeOnesTheNewestIsKept) {
  const std::string text(SharedLog::kBytesOfOne, 'x');
  const std::int64_t before = Last();
  Say({text, text});
  const auto log = LogOfJobs();
  const auto made = [&](std::int64_t position) {
    return *Must(log->After(position, false))->message;
  };
  const grpc::Slice first = made(before);
  const grpc::Slice second = made(before + 1);
  EXPECT_EQ(made(before + 1).begin(), second.begin());
  EXPECT_NE(made(before).begin(), first.begin());
}

// What is there already takes its room once, also where somebody asks for it from further back.
TEST_F(KeptMessages, WhatIsThereAlreadyTakesItsRoomOnce) {
  const std::string text(SharedLog::kBytesOfOne * 2 / 5, 'x');  // two find room, three do not
  const std::int64_t before = Last();
  Say({"small", text, text});
  const auto log = LogOfJobs();
  const auto made = [&](std::int64_t position) {
    return *Must(log->After(position, false))->message;
  };
  const grpc::Slice second = made(before + 1);
  const grpc::Slice third = made(before + 2);
  made(before);
  EXPECT_EQ(made(before + 1).begin(), second.begin());
  EXPECT_EQ(made(before + 2).begin(), third.begin());
}

// A message of several events ends where it has its bytes, and where what is read at once ends.
TEST_F(KeptMessages, AMessageOfSeveralEventsIsNotTooLarge) {
  constexpr std::size_t kHalf = SharedLog::kMessageBytes / 2;
  const std::string text = EventOfBytes(kHalf);
  std::int64_t before = Last();
  Say({text, text, "more"});
  EXPECT_EQ(Read(Must(LogOfJobs()->After(before, true))).events().events_size(), 2);
  before = Last();
  Say({text, text.substr(1), "more"});
  EXPECT_EQ(Read(Must(LogOfJobs()->After(before, true))).events().events_size(), 3);
}

// Where the log goes on without an event that is wanted, its end is told without a message.
TEST_F(KeptMessages, WhatIsNotWantedHasNoMessage) {
  const std::int64_t before = Last();
  Must(
      room.bed.store().PutMachine({.id = "mill-2", .family = "rml1", .profile = "mdx-20"}, 0, "c"));
  AwaitTold();
  const auto log = LogOfJobs();
  const auto piece = Must(log->After(before, false));
  ASSERT_TRUE(piece);
  EXPECT_FALSE(piece->message);
  EXPECT_EQ(piece->end, before + 1);
  EXPECT_FALSE(Must(log->After(before + 1, false)));
}

// What was made of a job goes with it.
TEST_F(KeptMessages, WhatWasMadeOfAJobGoesWithIt) {
  const auto log = LogOfJobs();
  const auto other = log;
  const std::int64_t before = Last();
  Say({"one"});
  const auto first = Must(log->After(before, false));
  EXPECT_EQ(Must(other->After(before, false))->message->begin(), first->message->begin());
  room.Finish(lease);
  Must(room.bed.store().DeleteJob(job, "c"));
  AwaitTold();
  for (std::int64_t at = before + 1;;) {
    const auto next = Must(log->After(at, false));
    if (!next) break;
    at = next->end;
  }
  const auto again = log->AtOnce(before, false);
  EXPECT_TRUE(!again || again->message->begin() != first->message->begin());
}

// What could not be read is told by its name alone, and is looked at again for the next who asks.
TEST_F(KeptMessages, WhatTheStoreRefusedIsNotKept) {
  const CellRecords refused{room.store, book, room.programs, room.projects};
  const std::int64_t before = Last();
  storage::MachineRecord mill = Must(room.bed.store().GetMachine("mill-1"));
  mill.title = "By the window";
  Must(room.bed.store().PutMachine(mill, mill.revision));
  AwaitTold();
  const auto title = [](const v1::CellEvent& event) {
    EXPECT_EQ(event.resource(), "machines/mill-1");
    return event.machine().changed().machine().title();
  };
  const storage::EventRecord event = Must(room.bed.store().AllEvents(before, 1)).at(0);
  ToldEvents told(refused);
  const auto of_event = [&](bool whole) {
    const ToldEvents::Told made = told.Of(event);
    EXPECT_EQ(made.whole, whole);
    v1::CellEvent message;
    EXPECT_TRUE(message.ParseFromString(*made.bytes));
    return title(message);
  };
  v1::Subscription wanted;
  wanted.set_id("machines");
  wanted.mutable_machines()->set_events_only(true);
  const auto log = std::make_shared<SharedLog>(
      SharedLogNeeds{refused, room.feed, facts, "instance"}, std::make_shared<ToldEvents>(refused),
      std::vector<CellSubscription>{Must(CellSubscription::Make(wanted))});
  room.store.Refuse("GetMachine");
  EXPECT_EQ(of_event(false), "");
  EXPECT_EQ(title(Read(Must(log->After(before, false))).event()), "");
  room.store.Heal();
  EXPECT_EQ(of_event(true), "By the window");
  EXPECT_EQ(title(Read(Must(log->After(before, false))).event()), "By the window");
}

// Behind the first events of all, that were there before the feed.
TEST_F(KeptMessages, WhatIsNotInMemoryIsNotThereAtOnce) {
  EXPECT_FALSE(LogOfJobs()->AtOnce(1, false));
}

// shared_log.h, AtOnce: what a record is by now the store knows, which is not asked; an event of a
// job has all in it.
TEST_F(KeptMessages, EventsOfRecordsAreNotThereAtOnce) {
  v1::Subscription wanted;
  wanted.set_id("machines");
  wanted.mutable_machines()->set_events_only(true);
  const auto log = std::make_shared<SharedLog>(
      SharedLogNeeds{records, room.feed, facts, "instance"}, std::make_shared<ToldEvents>(records),
      std::vector<CellSubscription>{Must(CellSubscription::Make(wanted))});
  storage::Store& store = room.bed.store();
  const std::int64_t before = Last();
  Must(store.PutMachine({.id = "mill-2", .family = "rml1", .profile = "mdx-20"}, 0, "c"));
  AwaitTold();
  EXPECT_FALSE(log->AtOnce(before, false));
  EXPECT_TRUE(Must(log->After(before, false)));
  EXPECT_TRUE(log->AtOnce(before, false));  // it was made
  EXPECT_TRUE(store.DeleteMachine("mill-2", storage::kAnyRevision, "c"));
  AwaitTold();
  EXPECT_FALSE(log->AtOnce(before + 1, false));
  const std::int64_t behind = Last();
  Say({"a"});
  EXPECT_EQ(Read(LogOfJobs()->AtOnce(behind, false)).event().job().message().text(), "a");
}

// Watches that are apart in the log end their messages of several events at the same places, so
// that what is made for one is there for the other.
TEST_F(KeptMessages, MessagesOfSeveralEventsEndAtTheSamePlaces) {
  const std::int64_t before = Last();
  Say(std::vector<std::string>(150, "x"));
  const auto end_behind = [&](std::int64_t position) {
    return Must(LogOfJobs()->After(position, true))->end;
  };
  const std::int64_t first = end_behind(before);
  const std::int64_t second = end_behind(first);
  EXPECT_GT(first, before);
  EXPECT_EQ(first % SharedLog::kEventsAtOnce, 0);  // whoever was told what before it
  EXPECT_EQ(second, first + SharedLog::kEventsAtOnce);
  for (const int apart : {1, 2, 40}) EXPECT_EQ(end_behind(first + apart), second) << apart;
}

// Equal subscriptions share one log, others have another one.
TEST_F(KeptMessages, EqualSubscriptionsShareALog) {
  v1::Subscription wanted;
  wanted.set_id("a");
  wanted.mutable_jobs();
  const CellSubscription jobs = Must(CellSubscription::Make(wanted));
  const CellSubscription likewise = Must(CellSubscription::Make(wanted));
  wanted.mutable_machines();
  const CellSubscription machines = Must(CellSubscription::Make(wanted));
  SharedLogs logs{SharedLogNeeds{records, room.feed, facts, "instance"}};
  const auto log = logs.Of({&jobs});
  EXPECT_EQ(logs.Of({&likewise}), log);
  EXPECT_NE(logs.Of({&machines}), log);
  EXPECT_NE(logs.Of({&jobs, &machines}), log);
}

// What went with a job that was deleted takes no room any more: as much as one watch alone may have
// is kept behind it, to the last byte.
TEST_F(KeptMessages, WhatWentWithAJobTakesNoRoom) {
  const std::string half = TextOf(SharedLog::kBytesOfOne / 2);
  const auto log = LogOfJobs();
  std::int64_t at = Last();
  const auto next = [&] {
    const LogPiece piece = Must(log->After(at, false)).value();
    at = piece.end;
    return piece;
  };
  const auto size_of = [](const LogPiece& piece) {
    return sizeof(LogPiece) + piece.message.value().size();
  };
  Say({"a", "b", "c", "d", "e", "f", "g", "h"});
  const std::int64_t other = room.Submit();
  room.Finish(room.bed.Lease());
  AwaitTold();
  while (at < Last()) next();
  EXPECT_TRUE(room.bed.store().DeleteJob(other, "anna"));
  AwaitTold();
  const std::size_t of_deletion = size_of(next());
  const std::int64_t before = at;
  Say({half.substr(of_deletion)});
  const LogPiece first = next();
  Say({half});
  ASSERT_EQ(of_deletion + size_of(first) + size_of(next()), SharedLog::kBytesOfOne);
  EXPECT_EQ(Must(log->After(before, false))->message->begin(), first.message->begin());
}

// What was made of the events before a job was deleted is gone already when room is made.
TEST_F(KeptMessages, RoomIsMadeBehindAJobThatWasDeleted) {
  const auto log = LogOfJobs();
  std::int64_t at = Last();
  v1::WatchCellResponse last;
  const auto look = [&] {
    while (at < Last()) {
      const auto piece = Must(log->After(at, false));
      ASSERT_TRUE(piece);
      if (piece->message) last = Read(piece);
      at = piece->end;
    }
  };
  Say({"a", "b", "c"});
  look();
  const std::int64_t other = room.Submit();
  room.Finish(room.bed.Lease());
  EXPECT_TRUE(room.bed.store().DeleteJob(other, "anna"));
  AwaitTold();
  look();
  EXPECT_TRUE(last.event().job_deleted());
  for (const char letter : {'d', 'e', 'f', 'g', 'h'}) {
    const std::string text(SharedLog::kBytesOfOne / 3, letter);
    Say({text});
    look();
    EXPECT_EQ(last.event().job().message().text(), text);
  }
}

}  // namespace
}  // namespace rmlcell::server
