// Keys of a mill's panel: in their order, held by somebody who is heard, and none beyond control.
#include <google/protobuf/util/time_util.h>

#include <utility>

#include "proto/bridge/machine_inputs.h"
#include "server/host/host_machine.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

bool LetsGo(const v1::HostOrder& order) { return ClassOf(order) != OrderClass::kWrittenFirst; }

}  // namespace

bool HostMachine::WaitsForKeys(const v1::HostOrder& order) const {
  if (!order.has_panel_key()) return false;
  const bool begins = !desk_.lease() || desk_.lease()->number() != keys_of_;
  const KeyDesk none;
  return (begins ? none : keys_).Look(order.panel_key().sequence(), LetsGo(order)) ==
         KeyDesk::Turn::kWaits;
}

std::optional<v1::HostOrderAnswer> HostMachine::AnsweredKey(const v1::HostOrder& order) const {
  if (!order.has_panel_key() || !desk_.lease() || desk_.lease()->number() != keys_of_)
    return std::nullopt;
  const std::int64_t number = order.panel_key().sequence();
  if (keys_.Look(number, LetsGo(order)) != KeyDesk::Turn::kAnswered) return std::nullopt;
  v1::HostOrderAnswer again = keys_.AnswerOf(number);
  again.set_number(order.number());
  return again;
}

Status HostMachine::MayPressKey(const v1::HostOrder& order) const {
  const v1::PressPanelKeyRequest& key = order.panel_key();
  if (key.sequence() < 1)
    return Error{ErrorCode::kCellInvalidArgument, "sequence counts from 1", {}};
  if (keys_.Look(key.sequence(), LetsGo(order)) == KeyDesk::Turn::kActs) return {};
  return Error{ErrorCode::kCellKeySequence,
               "sequence " + std::to_string(key.sequence()) + " is not the next one",
               {}};
}

// Precondition: whoever presses has control.
Status HostMachine::PressKey(const v1::HostOrder& order, const HostTime& now) {
  const v1::PressPanelKeyRequest& key = order.panel_key();
  if (desk_.lease()->number() != keys_of_) {
    EndKeys();
    keys_of_ = desk_.lease()->number();
  }
  if (const Status may = MayPressKey(order); !may) return may.error();
  const bool moves = bridge::JogKeyOf(key.key()).has_value();
  const bool released = key.action() == v1::KEY_ACTION_RELEASE;
  if (released) {
    keys_.Release(key.key(), key.sequence());
    dead_man_.Release(key.key());
  } else if (moves && keys_.IsReleased(key.key(), key.sequence())) {
    return {};
  }
  by_panel_ = true;
  const Status done = Act(order);
  by_panel_ = false;
  if (done && moves && key.action() == v1::KEY_ACTION_PRESS) dead_man_.Press(key.key(), now);
  return done;
}

v1::HeartbeatResponse HostMachine::HearBeat(const v1::HeartbeatPanelRequest& beat,
                                            const HostTime& now) {
  dead_man_.Hear(beat.number(), {beat.keys_down().begin(), beat.keys_down().end()},
                 std::chrono::nanoseconds(TimeUtil::TimestampToNanoseconds(beat.sent())), now);
  LetKeysGo(now);
  v1::HeartbeatResponse heard;
  *heard.mutable_sent() = beat.sent();
  *heard.mutable_received() = Stamp(now.wall);
  return heard;
}

void HostMachine::LetKeysGo(const HostTime& now) {
  if (!dead_man_.holds()) return;
  for (const std::string& key : dead_man_.LetGo(now)) {
    if (const auto jog = bridge::JogKeyOf(key))
      static_cast<void>(Apply(machine::ReleaseJog{*jog}, nullptr));
  }
}

// Another one presses from here on: what is down is nobody's.
void HostMachine::EndKeys() {
  if (dead_man_.holds()) static_cast<void>(Apply(machine::ReleaseJogs{}, nullptr));
  keys_ = {};
  dead_man_ = {};
}

}  // namespace rmlcell::server
