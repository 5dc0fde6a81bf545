// What a person does at a machine that lives: a start at a step, keys.
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

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

// Whoever holds a key says so every 50 ms, or the machine stops.
int PressPanelKey(const Remote& remote, const MachineAct& act) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kBetweenBeats{50};
  const Control control(remote, act);
  if (!control.status().ok()) return Refused(control.status(), remote);
  const auto stub = Service::NewStub(Connect(remote));
  v1::PressPanelKeyRequest key;
  key.set_machine(FullName("machines", act.machine));
  key.set_control_token(control.token());
  key.set_key(act.word);
  key.set_fast(act.fast);
  v1::MachineStatus status;
  const auto press = [&](v1::KeyAction action) {
    key.set_action(action);
    key.set_sequence(key.sequence() + 1);
    grpc::ClientContext context;
    Prepare(context);
    return stub->PressPanelKey(&context, key, &status);
  };
  if (act.held_s <= 0.0) {
    const grpc::Status tapped = press(v1::KEY_ACTION_TAP);
    return tapped.ok() ? Show(remote, status) : Refused(tapped, remote);
  }
  if (const grpc::Status pressed = press(v1::KEY_ACTION_PRESS); !pressed.ok())
    return Refused(pressed, remote);
  v1::HeartbeatPanelRequest beat;
  beat.set_machine(key.machine());
  beat.set_control_token(control.token());
  beat.add_keys_down(act.word);
  const auto until = Clock::now() + std::chrono::duration<double>(act.held_s);
  for (auto next = Clock::now(); next < until; next += kBetweenBeats) {
    std::this_thread::sleep_until(next);
    beat.set_number(beat.number() + 1);
    // Not TimeUtil::GetCurrentTime(), which knows whole seconds alone.
    *beat.mutable_sent() = google::protobuf::util::TimeUtil::NanosecondsToTimestamp(
        std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count());
    grpc::ClientContext context;
    Prepare(context);
    v1::HeartbeatResponse heard;
    if (const grpc::Status held = stub->HeartbeatPanel(&context, beat, &heard); !held.ok())
      return Refused(held, remote);
  }
  const grpc::Status released = press(v1::KEY_ACTION_RELEASE);
  return released.ok() ? Show(remote, status) : Refused(released, remote);
}

}  // namespace rmlcell::cli
