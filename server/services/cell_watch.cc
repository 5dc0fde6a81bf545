#include "server/services/cell_watch.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "server/events/event_feed.h"
#include "server/records/job_messages.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {
namespace {

// A request that names nothing watches everything.
v1::WatchCellRequest Completed(v1::WatchCellRequest request) {
  if (!request.subscriptions().empty()) return request;
  v1::Subscription& jobs = *request.add_subscriptions();
  jobs.set_id("jobs");
  jobs.mutable_jobs();
  v1::Subscription& machines = *request.add_subscriptions();
  machines.set_id("machines");
  machines.mutable_machines();
  v1::Subscription& projects = *request.add_subscriptions();
  projects.set_id("projects");
  projects.mutable_projects();
  return request;
}

using Instant = std::chrono::steady_clock::time_point;

// A subscription of a stream, and how far it was told what stands for now.
struct Told {
  CellSubscription subscription;
  bool snapshot_due = true;
  std::uint64_t seen = 0;  // version of the feed
  Instant next{};          // not before
};

grpc::ByteBuffer BytesOf(const v1::WatchCellResponse& message) {
  const grpc::Slice slice(message.SerializeAsString());
  return grpc::ByteBuffer(&slice, 1);
}

class CellWatch final : public PullStream<grpc::ByteBuffer>, public WatchRegistry::Watch {
 public:
  CellWatch(const CellWatchNeeds& needs, const v1::WatchCellRequest& request, std::string caller)
      : PullStream(needs.executor, needs.open),
        needs_(needs),
        request_(Completed(request)),
        caller_(std::move(caller)) {
    for (const v1::Subscription& subscription : request_.subscriptions())
      ids_.insert(subscription.id());
  }

  Status Change(WatchChange change) override {
    {
      const std::lock_guard lock(changes_mutex_);
      std::set<std::string> ids = ids_;
      for (const std::string& id : change.remove) ids.erase(id);
      for (const CellSubscription& added : change.add) ids.insert(added.id());
      if (ids.size() > kSubscriptionsMax) return InvalidArgument("more than 100 subscriptions");
      ids_ = std::move(ids);
      changes_.push_back(std::move(change));
      has_changes_ = true;
    }
    Wake();
    return {};
  }

 private:
  Next Make(grpc::ByteBuffer& bytes, grpc::Status& status) override {
    v1::WatchCellResponse message;
    message.set_instance_id(needs_.instance_id);
    message.set_log_id(needs_.records.store.LogId());
    const Result<bool> made = MakeAny(message, bytes);
    if (!made) {
      status = ToGrpcStatus(made.error());
      return Next::kEnd;
    }
    if (!*made) return Next::kNothing;
    if (message.has_bookmark()) last_bookmark_ = needs_.clock();
    if (bytes.Length() == 0) {  // else it is a piece of the log
      message.set_sequence(cursor_);
      bytes = BytesOf(message);
    }
    return Next::kMessage;
  }

  // Events that are in memory.
  std::optional<Next> MakeAtOnce(grpc::ByteBuffer& bytes) override {
    const Instant due = std::min(last_bookmark_ + needs_.bookmark_interval, postponed_);
    if (log_ == nullptr || snapshots_due_ || !latest_.empty() || has_changes_ ||
        needs_.clock() >= due)
      return std::nullopt;
    // Who is far behind takes turns on the lane of watches: a hundred of them that went on from
    // write to write would leave nothing to those who submit.
    if (needs_.feed.position() - cursor_ > SharedLog::kEventsAtOnce) return std::nullopt;
    while (const auto piece = log_->AtOnce(cursor_, request_.batched())) {
      cursor_ = piece->end;
      if (!piece->message) continue;
      bytes = grpc::ByteBuffer(&*piece->message, 1);
      return Next::kMessage;
    }
    if (cursor_ < needs_.feed.position() || needs_.feed.version() > version_looked_at_)
      return std::nullopt;
    WakeAt(due);
    return Next::kNothing;
  }

  // False: there is nothing to tell now. A piece of the log comes as bytes.
  Result<bool> MakeAny(v1::WatchCellResponse& message, grpc::ByteBuffer& bytes) {
    if (!begun_) return Begin(message);
    TakeChanges();
    for (Told& told : told_) {
      if (!std::exchange(told.snapshot_due, false)) continue;
      return MakeSnapshot(told, message);
    }
    snapshots_due_ = false;
    // Also between events without a pause: it says what time it is at the server.
    const Instant bookmark_due = last_bookmark_ + needs_.bookmark_interval;
    if (needs_.clock() >= bookmark_due) {
      SetBookmark(message);
      return true;
    }
    const Result<bool> event = MakeEvent(message, bytes);
    if (!event || *event) return event;
    if (MakeLatest(message)) return true;
    WakeAt(bookmark_due);
    return false;
  }

  // Where to begin; the answer is the first message, with the watch's id.
  Result<bool> Begin(v1::WatchCellResponse& message) {
    begun_ = true;
    last_bookmark_ = needs_.clock();
    auto subscriptions = MakeSubscriptions(request_.subscriptions());
    if (!subscriptions) return subscriptions.error();
    if (request_.has_after_sequence() && request_.after_sequence() < 0)
      return InvalidArgument("after_sequence is below 0");
    // Subscribed before the log is read: what comes in between wakes us again.
    subscription_ = needs_.feed.Subscribe(std::string(EventFeed::kEverything), [this] { Wake(); });
    for (CellSubscription& subscription : *subscriptions)
      told_.push_back({.subscription = std::move(subscription)});
    ShareLog();
    watch_id_ =
        needs_.registry.Add(std::static_pointer_cast<CellWatch>(this->shared_from_this()), caller_);
    message.set_watch_id(watch_id_);
    if (!request_.has_after_sequence()) {
      if (const Status now = BeginNow(); !now) return now.error();
      told_.front().snapshot_due = false;
      return MakeSnapshot(told_.front(), message);
    }
    const Result<std::optional<v1::Gap::Reason>> gap = ComeBack();
    if (!gap) return gap.error();
    if (*gap) {
      if (const Status now = BeginNow(); !now) return now.error();
      message.mutable_gap()->set_reason(**gap);
    } else {
      SetBookmark(message);
    }
    return true;
  }

  // Behind what the store has now, with snapshots: what comes between this and their reads is told
  // twice, never left out.
  Status BeginNow() {
    const Result<std::int64_t> last = needs_.records.store.LastPosition();
    if (!last) return last.error();
    cursor_ = *last;
    for (Told& told : told_) told.snapshot_due = true;
    snapshots_due_ = true;
    return {};
  }

  // Behind the number that the client has; why not, where that cannot be.
  Result<std::optional<v1::Gap::Reason>> ComeBack() {
    storage::Store& store = needs_.records.store;
    const std::int64_t after = request_.after_sequence();
    const Result<std::int64_t> gone = store.EventsGoneUntil();
    if (!gone) return gone.error();
    if (after == 0) {  // from the first event that is kept
      cursor_ = *gone;
      return NoSnapshots();
    }
    const std::string log_id = request_.log_id().empty() ? store.LogId() : request_.log_id();
    const Result<bool> known = store.HasPosition(log_id, after);
    if (!known) return known.error();
    if (!*known) return std::optional(v1::Gap::REASON_OTHER_LOG);
    if (after < *gone) return std::optional(v1::Gap::REASON_GONE);
    cursor_ = after;
    return NoSnapshots();
  }

  std::optional<v1::Gap::Reason> NoSnapshots() {
    for (Told& told : told_) told.snapshot_due = false;
    return std::nullopt;
  }

  void TakeChanges() {
    std::vector<WatchChange> changes;
    {
      const std::lock_guard lock(changes_mutex_);
      changes.swap(changes_);
      has_changes_ = false;
    }
    if (changes.empty()) return;
    snapshots_due_ = true;
    version_looked_at_ = 0;  // they were told of nothing that stands
    for (WatchChange& change : changes) {
      const auto replaced = [&](const Told& told) {
        return std::ranges::find(change.remove, told.subscription.id()) != change.remove.end() ||
               std::ranges::find(change.add, told.subscription.id(), &CellSubscription::id) !=
                   change.add.end();
      };
      std::erase_if(told_, replaced);
      for (CellSubscription& added : change.add)
        told_.push_back({.subscription = std::move(added)});
    }
    ShareLog();
  }

  void ShareLog() {
    std::vector<const CellSubscription*> subscriptions;
    for (const Told& told : told_) subscriptions.push_back(&told.subscription);
    log_ = needs_.logs.Of(subscriptions);
  }

  Result<bool> MakeSnapshot(Told& told, v1::WatchCellResponse& message) {
    // Machines have their status in it.
    if (told.subscription.wanted().has_machines()) told.seen = needs_.feed.version();
    Result<v1::CellSnapshot> snapshot = SnapshotOf(needs_.records, told.subscription);
    if (!snapshot) return snapshot.error();
    message.add_subscriptions(told.subscription.id());
    *message.mutable_snapshot() = *std::move(snapshot);
    return true;
  }

  Result<bool> MakeEvent(v1::WatchCellResponse& message, grpc::ByteBuffer& bytes) {
    for (;;) {
      const auto piece = log_->After(cursor_, request_.batched());
      if (!piece && piece.error().code == ErrorCode::kCellEventsGone) {
        if (const Status now = BeginNow(); !now) return now.error();
        message.mutable_gap()->set_reason(v1::Gap::REASON_TOO_SLOW);
        return true;
      }
      if (!piece) return piece.error();
      if (!*piece) return false;
      cursor_ = (*piece)->end;
      if (!(*piece)->message) continue;
      bytes = grpc::ByteBuffer(&*(*piece)->message, 1);
      return true;
    }
  }

  bool MakeLatest(v1::WatchCellResponse& message) {
    if (latest_.empty()) ReadLatest();
    if (latest_.empty()) return false;
    auto [latest, ids] = std::move(latest_.front());
    latest_.pop_front();
    for (const std::string& id : ids) message.add_subscriptions(id);
    if (latest.resource.starts_with("jobs/")) {
      message.mutable_progress()->ParseFromString(*latest.bytes);
    } else {
      message.mutable_status()->ParseFromString(*latest.bytes);
    }
    return true;
  }

  // What stands for now, for those subscriptions whose time has come; the others look later.
  void ReadLatest() {
    const Instant now = needs_.clock();
    version_looked_at_ = needs_.feed.version();
    postponed_ = Instant::max();
    std::map<std::uint64_t, std::pair<Latest, std::vector<std::string>>> wanted;
    for (Told& told : told_) {
      const std::vector<Latest> newer = needs_.feed.AllLatestAfter(told.seen);
      if (newer.empty()) continue;
      if (now < told.next) {
        postponed_ = std::min(postponed_, told.next);
        WakeAt(told.next);
        continue;
      }
      told.seen = newer.back().version;
      bool any = false;
      for (const Latest& latest : newer) {
        if (!told.subscription.WantsLatest(latest.resource, needs_.facts)) continue;
        auto& row = wanted[latest.version];
        row.first = latest;
        row.second.push_back(told.subscription.id());
        any = true;
      }
      if (any) told.next = now + told.subscription.interval();
    }
    for (auto& [version, row] : wanted) latest_.push_back(std::move(row));
  }

  static void SetBookmark(v1::WatchCellResponse& message) {
    *message.mutable_bookmark()->mutable_server_time() =
        ToProto(std::chrono::floor<std::chrono::microseconds>(std::chrono::system_clock::now()));
  }

  bool MakeGoodbye(grpc::ByteBuffer& bytes) override {
    v1::WatchCellResponse message;
    message.set_instance_id(needs_.instance_id);
    message.set_log_id(needs_.records.store.LogId());
    message.set_sequence(begun_ ? cursor_ : request_.after_sequence());
    *message.mutable_reconnect() = ServerStopped();
    bytes = BytesOf(message);
    return true;
  }

  void Closed() override {
    subscription_.reset();
    needs_.registry.Remove(watch_id_);
  }

  CellWatchNeeds needs_;
  v1::WatchCellRequest request_;
  std::string caller_;
  std::string watch_id_;
  std::int64_t cursor_ = 0;
  bool begun_ = false;
  Instant last_bookmark_{};
  std::vector<Told> told_;
  std::shared_ptr<SharedLog> log_;                                  // of told_
  bool snapshots_due_ = true;                                       // of some subscription, perhaps
  std::uint64_t version_looked_at_ = 0;                             // of what stands for now
  Instant postponed_ = Instant::max();                              // when some of it may be told
  std::deque<std::pair<Latest, std::vector<std::string>>> latest_;  // one per resource at most
  std::unique_ptr<EventFeed::Subscription> subscription_;

  std::mutex changes_mutex_;
  std::atomic<bool> has_changes_ = false;
  std::vector<WatchChange> changes_;  // guarded by changes_mutex_; not taken yet
  std::set<std::string> ids_;         // guarded by changes_mutex_; of all subscriptions, those too
};

}  // namespace

std::shared_ptr<PullStream<grpc::ByteBuffer>> MakeCellWatch(const CellWatchNeeds& needs,
                                                            const v1::WatchCellRequest& request,
                                                            std::string caller) {
  return std::make_shared<CellWatch>(needs, request, std::move(caller));
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* OpenCellWatch(
    const CallNeeds& call, const CellWatchNeeds& needs, const grpc::CallbackServerContext& context,
    const grpc::ByteBuffer& request) {
  v1::WatchCellRequest wanted;
  grpc::ByteBuffer bytes(request);
  const grpc::Status read =
      grpc::SerializationTraits<v1::WatchCellRequest>::Deserialize(&bytes, &wanted);
  if (!read.ok()) return new EndedStream<grpc::ServerWriteReactor<grpc::ByteBuffer>>(read);
  return OpenStream<grpc::ByteBuffer>(
      call, context, wanted, "CellService/WatchCell",
      [&](const Caller& caller) { return MakeCellWatch(needs, wanted, caller.identity); });
}

}  // namespace rmlcell::server
