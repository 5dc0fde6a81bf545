#include "server/services/machine_watch.h"

#include <chrono>

#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/machines/hosts.h"
#include "server/services/rates.h"

namespace rmlcell::server {
namespace {

class MachineWatch final : public PullStream<v1::WatchMachineResponse> {
 public:
  MachineWatch(const MachineWatchNeeds& needs, const v1::WatchMachineRequest& request)
      : PullStream(needs.executor, needs.open), needs_(needs), request_(request) {}

 private:
  Next Make(v1::WatchMachineResponse& message, grpc::Status& status) override {
    const Result<bool> made = MakeStatus(message);
    if (!made) {
      status = ToGrpcStatus(made.error());
      return Next::kEnd;
    }
    if (!*made) return Next::kNothing;
    message.set_instance_id(needs_.instance_id);
    next_ = needs_.clock() + interval_;
    return Next::kMessage;
  }

  // False: there is nothing to tell now.
  Result<bool> MakeStatus(v1::WatchMachineResponse& message) {
    if (!subscription_) return Begin(message);
    const auto latest = needs_.feed.LatestAfter(request_.name(), seen_);
    if (!latest) {
      // It has nothing new to say, or is there no more.
      const auto machine = needs_.store.GetMachine(id_);
      if (!machine) return machine.error();
      return false;
    }
    if (needs_.clock() < next_) {
      WakeAt(next_);
      return false;
    }
    seen_ = latest->version;
    return message.mutable_status()->ParseFromString(*latest->bytes);
  }

  Result<bool> Begin(v1::WatchMachineResponse& message) {
    const Result<std::string> id = ParseMachineName(request_.name());
    if (!id) return id.error();
    const Result<std::chrono::microseconds> interval = IntervalOf(request_.max_rate_hz());
    if (!interval) return interval.error();
    id_ = *id;
    interval_ = *interval;
    // Subscribed before the store is read: what comes in between wakes us again.
    subscription_ = needs_.feed.Subscribe(request_.name(), [this] { Wake(); });
    seen_ = needs_.feed.version();
    const auto position = needs_.store.LastPosition();
    if (!position) return position.error();
    const auto machine = needs_.store.GetMachine(id_);
    if (!machine) return machine.error();
    const auto unfinished = needs_.store.UnfinishedJobs();
    if (!unfinished) return unfinished.error();
    *message.mutable_status() = StatusOf(needs_.hosts, *machine, *unfinished);
    message.set_sequence(*position);
    message.set_log_id(needs_.store.LogId());
    return true;
  }

  void Closed() override { subscription_.reset(); }

  MachineWatchNeeds needs_;
  v1::WatchMachineRequest request_;
  std::string id_;
  std::chrono::microseconds interval_{0};
  std::chrono::steady_clock::time_point next_{};
  std::uint64_t seen_ = 0;
  std::unique_ptr<EventFeed::Subscription> subscription_;
};

}  // namespace

std::shared_ptr<PullStream<v1::WatchMachineResponse>> MakeMachineWatch(
    const MachineWatchNeeds& needs, const v1::WatchMachineRequest& request) {
  return std::make_shared<MachineWatch>(needs, request);
}

}  // namespace rmlcell::server
