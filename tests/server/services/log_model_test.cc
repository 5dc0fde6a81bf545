// What watches are told against a plain look into the log: feed, shared log and store by
// themselves, without gRPC calls, so that the race detector sees all of it. Watches have random
// subscriptions, take batches or single events, fall behind, break off and come back, while events
// are written by several threads and the oldest are removed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <semaphore>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/job_book.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/records/job_messages.h"
#include "server/services/shared_log.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

struct Random {
  explicit Random(unsigned seed) : engine(seed) {}
  int Below(int bound) { return static_cast<int>(engine() % static_cast<unsigned>(bound)); }
  std::mt19937 engine;
};

// A set of subscriptions, and the same said plainly.
struct Wish {
  std::vector<v1::Subscription> subscriptions{};
  std::set<std::int64_t> jobs{};  // by number; empty: all, where `any_job`
  bool any_job = false;
  bool projects = false;

  bool Wants(const storage::EventRecord& event) const {
    if (event.job != 0) return any_job || jobs.contains(event.job);
    return projects && event.resource.starts_with("projects/");
  }
};

class LogModel {
 public:
  static constexpr int kJobs = 5;

  explicit LogModel(storage::SqliteOptions options = {}) : bed_(std::move(options)) {
    for (int i = 0; i < kJobs; ++i) {
      jobs_.push_back(bed_.SubmitCheck());
      leases_.push_back(bed_.Lease());
    }
  }

  storage::Store& store() { return bed_.store(); }
  std::int64_t last() { return Must(store().LastPosition()); }
  // All that is kept. The oldest events are removed when their writer has its answer, perhaps
  // between these two looks.
  std::vector<storage::EventRecord> Log() {
    for (;;) {
      auto log = store().AllEvents(Must(store().EventsGoneUntil()), 1'000'000);
      if (CodeOf(log) != ErrorCode::kCellEventsGone) return Must(std::move(log));
    }
  }

  Wish RandomWish(Random& random) {
    Wish wish;
    v1::Subscription& of_jobs = wish.subscriptions.emplace_back();
    of_jobs.set_id("jobs");
    of_jobs.mutable_jobs()->set_events_only(true);
    wish.any_job = random.Below(3) == 0;
    for (int left = 1 + random.Below(3); !wish.any_job && left > 0; --left) {
      const std::int64_t job = jobs_[static_cast<std::size_t>(random.Below(kJobs))];
      if (wish.jobs.insert(job).second) of_jobs.mutable_jobs()->add_names(JobName(job));
    }
    wish.projects = random.Below(2) == 0;
    if (wish.projects) {
      v1::Subscription& projects = wish.subscriptions.emplace_back();
      projects.set_id("projects");
      projects.mutable_projects();
    }
    return wish;
  }

  // Events of one job, and of a project of the writer's own now and then.
  void Write(int writer, int rounds, Random& random) {
    const std::string project = "p" + std::to_string(writer);
    Revision revision = 0;
    for (int round = 0; round < rounds; ++round) {
      bed_.Append(leases_[static_cast<std::size_t>(writer)], 1 + random.Below(30));
      if (random.Below(3) != 0) continue;
      revision = Must(store().PutProject({.id = project}, revision, "caller")).revision;
    }
  }

  std::shared_ptr<SharedLog> LogOf(const Wish& wish) {
    std::vector<CellSubscription> made;
    for (const v1::Subscription& one : wish.subscriptions)
      made.push_back(Must(CellSubscription::Make(one)));
    std::vector<const CellSubscription*> all;
    for (const CellSubscription& one : made) all.push_back(&one);
    return logs_.Of(all);
  }

  EventFeed& feed() { return feed_; }

 private:
  using Revision = storage::Revision;

  ServerBed bed_;
  std::vector<std::int64_t> jobs_;
  std::vector<storage::Lease> leases_;
  Config config_;
  EventFeed feed_{bed_.store()};
  JobBook book_{bed_.store(), config_};
  ProgramBook programs_{bed_.store(), config_};
  ProjectBook projects_{bed_.store()};
  JobFactsBook facts_{bed_.store()};
  SharedLogs logs_{{{bed_.store(), book_, programs_, projects_}, feed_, facts_, "this server"}};
};

// A watch as a stream carries it out: it reads on while there is something, and sleeps until the
// feed wakes it.
class ModelWatch {
 public:
  ModelWatch(LogModel& model, std::int64_t after, unsigned seed)
      : model_(model), random_(seed), wish_(model.RandomWish(random_)), cursor_(after) {}

  const Wish& wish() const { return wish_; }
  const std::vector<std::int64_t>& seen() const { return seen_; }
  std::int64_t skipped_until() const { return skipped_until_; }

  // Up to this position, which is known when all has been written.
  void Follow(const std::atomic<std::int64_t>& end) {
    while (end == 0 || cursor_ < end) Connect(end);
  }

 private:
  // One connection: a number of messages, then it breaks off.
  void Connect(const std::atomic<std::int64_t>& end) {
    std::counting_semaphore<> woken(0);
    const auto subscription =
        model_.feed().Subscribe(std::string(EventFeed::kEverything), [&woken] { woken.release(); });
    const std::shared_ptr<SharedLog> log = model_.LogOf(wish_);
    const bool batched = random_.Below(2) == 0;
    for (int left = 1 + random_.Below(60); left > 0;) {
      std::optional<LogPiece> piece;
      if (random_.Below(2) == 0) piece = log->AtOnce(cursor_, batched);
      if (!piece) {
        auto next = log->After(cursor_, batched);
        if (!next) {
          ASSERT_EQ(next.error().code, ErrorCode::kCellEventsGone);
          skipped_until_ = cursor_ = Must(model_.store().EventsGoneUntil());
          continue;
        }
        piece = *std::move(next);
      }
      if (!piece) {
        if (end != 0 && cursor_ >= end) return;
        woken.acquire();
        continue;
      }
      Take(*piece, batched);
      if (piece->message) --left;
      pieces_.push_back(*std::move(piece));
    }
  }

  void Take(const LogPiece& piece, bool batched) {
    ASSERT_GT(piece.end, cursor_);
    cursor_ = piece.end;
    if (!piece.message) return;
    v1::WatchCellResponse message;
    ASSERT_TRUE(
        message.ParseFromArray(piece.message->begin(), static_cast<int>(piece.message->size())));
    ASSERT_TRUE(batched || message.has_event());
    const std::size_t before = seen_.size();
    if (message.has_event()) seen_.push_back(message.event().sequence());
    for (const v1::CellEvent& event : message.events().events()) seen_.push_back(event.sequence());
    ASSERT_GT(seen_.size(), before);
    ASSERT_EQ(message.sequence(), seen_.back());
  }

  LogModel& model_;
  Random random_;
  const Wish wish_;
  std::int64_t cursor_;
  std::int64_t skipped_until_ = 0;
  std::vector<std::int64_t> seen_;
  // Kept to the end: the counts of slices are changed where the race detector does not look.
  std::vector<LogPiece> pieces_;
};

void RunModel(LogModel& model, unsigned seed, int watches, int rounds) {
  const std::int64_t before = model.last();
  std::atomic<std::int64_t> end = 0;
  std::vector<std::unique_ptr<ModelWatch>> all;
  for (int i = 0; i < watches; ++i)
    all.push_back(
        std::make_unique<ModelWatch>(model, before, seed * 1000 + static_cast<unsigned>(i)));
  {
    std::vector<std::jthread> watchers;
    for (const auto& watch : all) watchers.emplace_back([&end, &one = *watch] { one.Follow(end); });
    {
      std::vector<std::jthread> writers;
      for (int writer = 0; writer < 3; ++writer) {
        writers.emplace_back([&model, writer, rounds, seed] {
          Random random(seed * 1000 + 500 + static_cast<unsigned>(writer));
          model.Write(writer, rounds, random);
        });
      }
    }
    // One more event that all come by, after `end` is known to them.
    end = model.last();
    Random random(seed);
    model.Write(3, 1, random);
  }
  const std::vector<storage::EventRecord> log = model.Log();
  for (const auto& watch : all) {
    std::vector<std::int64_t> plain;
    for (const storage::EventRecord& event : log) {
      if (event.position > before && watch->wish().Wants(event)) plain.push_back(event.position);
    }
    std::vector<std::int64_t> seen = watch->seen();
    ASSERT_EQ(std::ranges::adjacent_find(seen, std::greater_equal<>()), seen.end());
    // What is not in the log any more cannot be compared, and what came behind the end is seen by
    // some.
    const std::int64_t first = std::max(log.front().position, watch->skipped_until() + 1);
    const auto outside = [&](std::int64_t position) { return position < first || position > end; };
    std::erase_if(plain, outside);
    std::erase_if(seen, outside);
    EXPECT_EQ(seen, plain);
  }
}

// Everything is kept: each watch sees each of its events once, in order.
TEST(LogModelTest, EachEventOnceAndInOrder) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    LogModel model;
    RunModel(model, seed, 10, 60);
  }
}

// The oldest events are removed while they are read: who comes too late is told so, and misses
// nothing behind that place.
TEST(LogModelTest, WhereHistoryIsGoneItGoesOnBehind) {
  for (unsigned seed = 11; seed <= 12; ++seed) {
    LogModel model(storage::SqliteOptions{.keep_events = 300});
    RunModel(model, seed, 10, 60);
    EXPECT_GT(Must(model.store().EventsGoneUntil()), 0);
  }
}

}  // namespace
}  // namespace rmlcell::server
