#include "server/services/handbox_watch.h"

#include <optional>
#include <string>
#include <utility>

#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/machines/hosts.h"

namespace rmlcell::server {
namespace {

class HandboxWatch final : public PullStream<v1::WatchHandboxResponse> {
 public:
  HandboxWatch(const HandboxWatchNeeds& needs, const v1::WatchHandboxRequest& request)
      : PullStream(needs.executor, needs.open), needs_(needs), request_(request) {}

 private:
  Next Make(v1::WatchHandboxResponse& message, grpc::Status& status) override {
    if (!subscription_) {
      if (const Status begun = Begin(message); !begun) {
        status = ToGrpcStatus(begun.error());
        return Next::kEnd;
      }
      message.set_sequence(++sequence_);
      return Next::kMessage;
    }
    const auto latest = needs_.feed.LatestAfter(Hosts::HandboxOf(id_), seen_);
    if (!latest) return Next::kNothing;
    seen_ = latest->version;
    if (!message.mutable_panel()->ParseFromString(*latest->bytes)) return Next::kNothing;
    // The feed may tell a moment later of what the stream began with.
    if (const std::string panel = message.panel().SerializeAsString();
        std::exchange(shown_, panel) == panel)
      return Next::kNothing;
    message.set_sequence(++sequence_);
    return Next::kMessage;
  }

  Status Begin(v1::WatchHandboxResponse& message) {
    const Result<std::string> id = ParseMachineName(request_.machine());
    if (!id) return id.error();
    if (const auto known = needs_.store.GetMachine(*id); !known) return known.error();
    id_ = *id;
    // Subscribed before it is looked at: what comes in between wakes us again.
    subscription_ = needs_.feed.Subscribe(Hosts::HandboxOf(id_), [this] { Wake(); });
    seen_ = needs_.feed.version();
    const auto panel = needs_.hosts != nullptr ? needs_.hosts->HandboxPanelOf(id_) : std::nullopt;
    if (!panel)
      return Error{ErrorCode::kCellNotLive, "it has no handbox, or does not live: enable it", {}};
    *message.mutable_panel() = *panel;
    shown_ = panel->SerializeAsString();
    return {};
  }

  void Closed() override { subscription_.reset(); }

  const HandboxWatchNeeds needs_;
  const v1::WatchHandboxRequest request_;
  std::string id_;
  std::int64_t sequence_ = 0;
  std::uint64_t seen_ = 0;
  std::string shown_;  // the panel that was told last
  std::unique_ptr<EventFeed::Subscription> subscription_;
};

}  // namespace

std::shared_ptr<PullStream<v1::WatchHandboxResponse>> MakeHandboxWatch(
    const HandboxWatchNeeds& needs, const v1::WatchHandboxRequest& request) {
  return std::make_shared<HandboxWatch>(needs, request);
}

}  // namespace rmlcell::server
