// What a person presses at a machine that lives.
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "clients/cli/handbox_hands.h"
#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "proto/bridge/machine_inputs.h"

namespace rmlcell::cli {
namespace {

using google::protobuf::util::TimeUtil;

// The keys of a panel of a mill: what is shown is the machine.
class PanelKeys {
 public:
  PanelKeys(const Remote& remote, const std::string& machine, const std::string& token)
      : remote_(remote), stub_(Service::NewStub(Connect(remote))) {
    key_.set_machine(machine);
    key_.set_control_token(token);
    beat_.set_machine(machine);
    beat_.set_control_token(token);
  }

  v1::PressPanelKeyRequest& key() { return key_; }
  v1::HeartbeatPanelRequest& beat() { return beat_; }
  void SetFast(bool fast) { key_.set_fast(fast); }
  grpc::Status Press(grpc::ClientContext& context) {
    return stub_->PressPanelKey(&context, key_, &status_);
  }
  grpc::Status Beat(grpc::ClientContext& context, v1::HeartbeatResponse& heard) {
    return stub_->HeartbeatPanel(&context, beat_, &heard);
  }
  int Show() const { return cli::Show(remote_, status_); }

 private:
  const Remote& remote_;
  std::unique_ptr<Service::Stub> stub_;
  v1::PressPanelKeyRequest key_;
  v1::HeartbeatPanelRequest beat_;
  v1::MachineStatus status_;
};

// Those of a handbox: what is shown is its display.
class HandboxKeys {
 public:
  HandboxKeys(const Remote& remote, const v1::HandboxSession& session, const std::string& token)
      : remote_(remote), stub_(v1::HandboxService::NewStub(Connect(remote))) {
    key_.set_session(session.name());
    key_.set_control_token(token);
    beat_.set_session(session.name());
    beat_.set_control_token(token);
  }

  v1::PressKeyRequest& key() { return key_; }
  v1::HeartbeatHandboxRequest& beat() { return beat_; }
  void SetFast(bool /*fast*/) {}
  grpc::Status Press(grpc::ClientContext& context) {
    return stub_->PressKey(&context, key_, &pressed_);
  }
  grpc::Status Beat(grpc::ClientContext& context, v1::HeartbeatResponse& heard) {
    return stub_->HeartbeatHandbox(&context, beat_, &heard);
  }
  int Show() const {
    if (remote_.json) {
      Print(Json(pressed_));
    } else {
      const v1::HandboxPanel& panel = pressed_.panel();
      std::string lamps;
      for (const std::string& lamp : panel.lamps()) lamps += " " + Visible(lamp);
      Print("[" + Visible(panel.display()) + "]" + (panel.flashing() ? " flashing" : "") + lamps);
    }
    if (!pressed_.has_message()) return kGood;
    Complain(pressed_.message().code() + ": " + Visible(pressed_.message().message()));
    return kProgramErrors;
  }

 private:
  const Remote& remote_;
  std::unique_ptr<v1::HandboxService::Stub> stub_;
  v1::PressKeyRequest key_;
  v1::HeartbeatHandboxRequest beat_;
  v1::PressKeyResponse pressed_;
};

template <class Keys>
grpc::Status PressOne(Keys& keys, const std::string& name, v1::KeyAction action) {
  keys.key().set_key(name);
  keys.key().set_action(action);
  keys.key().set_sequence(keys.key().sequence() + 1);
  grpc::ClientContext context;
  Prepare(context);
  return keys.Press(context);
}

// Whoever holds a key says so again and again, or the machine stops.
template <class Keys>
grpc::Status HoldOne(Keys& keys, const std::string& name, double seconds) {
  if (const grpc::Status pressed = PressOne(keys, name, v1::KEY_ACTION_PRESS); !pressed.ok())
    return pressed;
  keys.beat().add_keys_down(name);
  const auto first = std::chrono::steady_clock::now();
  const auto until = first + std::chrono::duration<double>(seconds);
  for (auto next = first; next < until; next += kBetweenBeats) {
    std::this_thread::sleep_until(next);
    keys.beat().set_number(keys.beat().number() + 1);
    *keys.beat().mutable_sent() = SentNow();
    grpc::ClientContext context;
    Prepare(context);
    v1::HeartbeatResponse heard;
    const auto begun = std::chrono::steady_clock::now();
    if (const grpc::Status held = keys.Beat(context, heard); !held.ok()) return held;
    const std::chrono::nanoseconds took = std::chrono::steady_clock::now() - begun;
    *keys.beat().mutable_round_trip() = TimeUtil::NanosecondsToDuration(took.count());
  }
  return PressOne(keys, name, v1::KEY_ACTION_RELEASE);
}

// One after the other; the last one is held where that was asked for.
template <class Keys>
int PressAll(const Remote& remote, const MachineAct& act, const Control& control, Keys keys) {
  keys.SetFast(act.fast);
  for (std::size_t i = 0; i < act.values.size(); ++i) {
    const bool held = act.held_s > 0.0 && i + 1 == act.values.size();
    const grpc::Status done = held ? HoldOne(keys, act.values[i], act.held_s)
                                   : PressOne(keys, act.values[i], v1::KEY_ACTION_TAP);
    if (!done.ok()) return Refused(done, remote);
    // A step of one key is over before the next one.
    const bool steps = bridge::JogKeyOf(act.values[i]).has_value();
    if (held || (steps && i + 1 < act.values.size())) AwaitRest(remote, act.machine);
  }
  constexpr std::chrono::seconds kRenewalPatience{5};
  // HOME, ZERO and FUNCTION go on by themselves; giving control back would stop what jogs.
  constexpr std::chrono::milliseconds kBetweenLooks{100};
  constexpr int kLooksBetweenRenewals = 100;
  const auto by_hand = [](const v1::MachineStatus& status) {
    return status.state() == v1::MACHINE_STATE_JOGGING ||
           (status.state() == v1::MACHINE_STATE_RUNNING && status.run().program() == 0);
  };
  for (int look = 1;; ++look) {
    const auto now = StatusNow(remote, act.machine);
    if (!now || !by_hand(*now)) break;
    if (look % kLooksBetweenRenewals == 0 && !control.Renew(kRenewalPatience).ok()) break;
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return keys.Show();
}

}  // namespace

int PressKeys(const Remote& remote, const MachineAct& act) {
  constexpr int kControl_s = 60;
  const Control control(remote, act, kControl_s);
  if (!control.status().ok()) return Refused(control.status(), remote);
  const std::string machine = FullName("machines", act.machine);
  const HandboxSession handbox(Connect(remote), machine, control.token(), remote.short_patience);
  if (handbox.status().ok())
    return PressAll(remote, act, control, HandboxKeys(remote, handbox.session(), control.token()));
  return PressAll(remote, act, control, PanelKeys(remote, machine, control.token()));
}

}  // namespace rmlcell::cli
