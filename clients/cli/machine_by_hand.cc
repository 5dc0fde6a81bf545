// What a person does at a machine that lives: a start at a step, keys.
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

namespace rmlcell::cli {
namespace {

// "45/10", or "10" of the main program; nothing for what is none.
std::optional<v1::StepPlace> StepOf(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto step = ParseInteger(slash == std::string::npos ? text : text.substr(slash + 1));
  const auto program = slash == std::string::npos ? std::optional<long long>(0)
                                                  : ParseInteger(text.substr(0, slash));
  if (!step || !program || *step < 1 || *step > INT32_MAX || *program < 0 || *program > 99)
    return std::nullopt;
  v1::StepPlace place;
  place.set_program(static_cast<int>(*program));
  place.set_step(static_cast<int>(*step));
  return place;
}

std::string PlaceText(const v1::StepPlace& place) {
  return std::to_string(place.program()) + "/" + std::to_string(place.step());
}

// What is different there, how the machine goes there, and why it may not.
void PrintPreview(const v1::PreviewStartResponse& preview) {
  std::vector<std::vector<std::string>> rows = {{"ITEM", "THERE", "NOW", "DONE ABOUT IT"}};
  for (const v1::StartDifference& one : preview.differences()) {
    rows.push_back({one.item(), Visible(one.there()), Visible(one.now()),
                    Short(v1::StartAction_Name(one.action()), "START_ACTION_")});
  }
  if (rows.size() > 1) PrintRaw(Table(rows));
  for (const v1::ApproachMotion& motion : preview.approach()) {
    std::string to;
    for (const v1::AxisValue& axis : motion.to())
      to += "  " + axis.axis() + " " + Fixed(axis.value(), axis.unit() == v1::UNIT_RADIAN ? 4 : 3);
    Print("approach  " + motion.path() + to);
  }
  if (!preview.approach().empty()) Print("          not checked against the part");
  if (preview.missing_cut_mm() > 0.0)
    Print("left out  " + Fixed(preview.missing_cut_mm(), 3) + " mm of cut");
  for (const v1::Diagnostic& refusal : preview.refusals())
    Complain(refusal.code() + ": " + Visible(refusal.message()));
  if (preview.refusals().empty()) return;
  if (preview.has_clean_before()) Print("clean before: " + PlaceText(preview.clean_before()));
  if (preview.has_clean_after()) Print("clean behind: " + PlaceText(preview.clean_after()));
}

std::string SeenName(v1::Confirmation confirmation) {
  std::string name = Short(v1::Confirmation_Name(confirmation), "CONFIRMATION_");
  std::ranges::transform(name, name.begin(), [](char c) { return c == '_' ? '-' : LowerCase(c); });
  return name;
}

// Of what a person must see to, that which was not said; empty: all of it was.
std::vector<std::string> Unseen(const v1::PreviewStartResponse& preview,
                                const std::vector<std::string>& seen,
                                v1::StartAtStepRequest& request) {
  std::vector<std::string> unseen;
  for (const v1::StartDifference& one : preview.differences()) {
    if (one.action() != v1::START_ACTION_ASK) continue;
    const std::string name = SeenName(one.confirmation());
    if (std::ranges::find(seen, name) != seen.end()) {
      request.add_confirmations(one.confirmation());
    } else if (std::ranges::find(unseen, name) == unseen.end()) {
      unseen.push_back(name);
    }
  }
  return unseen;
}

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

// Whoever holds a key says so every 50 ms, or the machine stops.
template <class Keys>
grpc::Status HoldOne(Keys& keys, const std::string& name, double seconds) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kBetweenBeats{50};
  if (const grpc::Status pressed = PressOne(keys, name, v1::KEY_ACTION_PRESS); !pressed.ok())
    return pressed;
  keys.beat().add_keys_down(name);
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  for (auto next = Clock::now(); next < until; next += kBetweenBeats) {
    std::this_thread::sleep_until(next);
    keys.beat().set_number(keys.beat().number() + 1);
    *keys.beat().mutable_sent() = SentNow();
    grpc::ClientContext context;
    Prepare(context);
    v1::HeartbeatResponse heard;
    if (const grpc::Status held = keys.Beat(context, heard); !held.ok()) return held;
  }
  return PressOne(keys, name, v1::KEY_ACTION_RELEASE);
}

// One after the other; the last one is held where that was asked for.
template <class Keys>
int PressAll(const Remote& remote, const MachineAct& act, Keys keys) {
  keys.SetFast(act.fast);
  for (std::size_t i = 0; i < act.values.size(); ++i) {
    const bool held = act.held_s > 0.0 && i + 1 == act.values.size();
    const grpc::Status done = held ? HoldOne(keys, act.values[i], act.held_s)
                                   : PressOne(keys, act.values[i], v1::KEY_ACTION_TAP);
    if (!done.ok()) return Refused(done, remote);
    if (held) AwaitRest(remote, act.machine);
  }
  return keys.Show();
}

}  // namespace

int StartAtStep(const Remote& remote, const MachineAct& act) {
  const auto step = StepOf(act.step);
  if (!step) {
    Complain("'" + Visible(act.step) + "' is no step: PROGRAM/STEP, such as 45/10, or a step");
    return kUsage;
  }
  auto asked = For<v1::PreviewStartRequest>(act);
  *asked.mutable_step() = *step;
  asked.set_program(act.program);
  asked.set_occurrence(act.occurrence);
  asked.set_approach(act.direct ? v1::APPROACH_DIRECT : v1::APPROACH_SAFE);
  asked.set_off_until_work_on(act.off_until_work_on);
  const auto stub = Service::NewStub(Connect(remote));
  grpc::ClientContext context;  // it takes as long as the way there does
  v1::PreviewStartResponse preview;
  const grpc::Status status = stub->PreviewStart(&context, asked, &preview);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    Print(Json(preview));
  } else {
    PrintPreview(preview);
  }
  if (preview.preview_token().empty()) return kProgramErrors;
  auto request = For<v1::StartAtStepRequest>(act);
  const std::vector<std::string> unseen = Unseen(preview, act.seen, request);
  if (act.look) return kGood;
  if (!unseen.empty()) {
    std::string names;
    for (const std::string& name : unseen) names += (names.empty() ? "" : ",") + name;
    Complain("look at " + names + " and say so: --seen " + names);
    return kProgramErrors;
  }
  request.set_preview_token(preview.preview_token());
  if (act.halt) request.set_halt_at_entry(true);
  return ShowWithControl(remote, act, &Service::Stub::StartAtStep, std::move(request));
}

int PressKeys(const Remote& remote, const MachineAct& act) {
  constexpr int kControl_s = 60;
  const Control control(remote, act, kControl_s);
  if (!control.status().ok()) return Refused(control.status(), remote);
  const std::string machine = FullName("machines", act.machine);
  const HandboxSession handbox(Connect(remote), machine, control.token());
  if (handbox.status().ok())
    return PressAll(remote, act, HandboxKeys(remote, handbox.session(), control.token()));
  return PressAll(remote, act, PanelKeys(remote, machine, control.token()));
}

}  // namespace rmlcell::cli
