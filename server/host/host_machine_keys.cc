// Keys of a mill's panel and of a handbox: in their order, held by somebody who is heard, and none
// beyond control.
#include <google/protobuf/util/time_util.h>

#include <utility>

#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"
#include "server/host/host_machine.h"
#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

// What a key is, on whatever it is.
struct Pressed {
  std::string key{};
  v1::KeyAction action{};
  std::int64_t number = 0;
};
std::optional<Pressed> PressedBy(const v1::HostOrder& order) {
  const auto of = [](const auto& request) {
    return Pressed{request.key(), request.action(), request.sequence()};
  };
  if (order.has_panel_key()) return of(order.panel_key());
  if (order.has_key()) return of(order.key());
  return std::nullopt;
}

// It waits for no key before it. What slows down does not wait for the disk, but has its place
// among the keys. LIVE-7.04
bool LetsGo(const v1::HostOrder& order) {
  return ClassOf(order) == OrderClass::kActsFirst ||
         PressedBy(order)->action == v1::KEY_ACTION_RELEASE;
}

v1::TeachEntry::Act ActOf(machine::ProgramEdit::Kind kind) {
  switch (kind) {
    case machine::ProgramEdit::Kind::kCreate:
      return v1::TeachEntry::ACT_CREATE;
    case machine::ProgramEdit::Kind::kInsert:
      return v1::TeachEntry::ACT_INSERT;
    case machine::ProgramEdit::Kind::kDelete:
      return v1::TeachEntry::ACT_DELETE;
    case machine::ProgramEdit::Kind::kRemove:
      break;
  }
  return v1::TeachEntry::ACT_REMOVE;
}

// HOME moves as long as it is down, too.
bool IsHeld(const std::string& key) { return bridge::JogKeyOf(key) || key == "HOME"; }

template <class Beat>
std::set<std::string> KeysOf(const Beat& beat) {
  return {beat.keys_down().begin(), beat.keys_down().end()};
}

template <class Beat>
std::chrono::nanoseconds SentAt(const Beat& beat) {
  return std::chrono::nanoseconds(TimeUtil::TimestampToNanoseconds(beat.sent()));
}

}  // namespace

bool HostMachine::WaitsForKeys(const v1::HostOrder& order, const HostTime& now) const {
  const auto pressed = PressedBy(order);
  if (!pressed || !CheckControl(order, now)) return false;
  const bool begins = !desk_.lease() || desk_.lease()->number() != keys_of_;
  const KeyDesk none;
  const KeyDesk::Turn turn = (begins ? none : keys_).Look(pressed->number, LetsGo(order));
  if (turn != KeyDesk::Turn::kActs) return turn == KeyDesk::Turn::kWaits;
  return Settles() && !LetsGo(order) && !IsHeld(pressed->key);
}

std::optional<v1::HostOrderAnswer> HostMachine::AnsweredKey(const v1::HostOrder& order) const {
  const auto pressed = PressedBy(order);
  if (!pressed || !desk_.lease() || desk_.lease()->number() != keys_of_) return std::nullopt;
  if (keys_.Look(pressed->number, LetsGo(order)) != KeyDesk::Turn::kAnswered) return std::nullopt;
  v1::HostOrderAnswer again = keys_.AnswerOf(pressed->number);
  again.set_number(order.number());
  return again;
}

// Nobody without control uses up a number of who has it.
void HostMachine::PassKey(const v1::HostOrder& order, const v1::HostOrderAnswer& refused,
                          const HostTime& now) {
  const auto pressed = PressedBy(order);
  if (!pressed || !CheckControl(order, now)) return;
  BeginPanelKeys(order);
  if (desk_.lease()->number() != keys_of_) return;
  if (keys_.Look(pressed->number, LetsGo(order)) == KeyDesk::Turn::kActs)
    keys_.Take(pressed->number, refused);
}

// Keys of a panel count anew with each lease, from the first of them on.
void HostMachine::BeginPanelKeys(const v1::HostOrder& order) {
  if (order.has_panel_key() && desk_.lease()->number() != keys_of_) EndKeys();
}

// Precondition: whoever presses has control.
Status HostMachine::PressKey(const v1::HostOrder& order, const HostTime& now) {
  const Pressed pressed = *PressedBy(order);
  BeginPanelKeys(order);
  if (pressed.number < 1)
    return Error{ErrorCode::kCellInvalidArgument, "sequence counts from 1", {}};
  if (keys_.Look(pressed.number, LetsGo(order)) != KeyDesk::Turn::kActs)
    return Error{ErrorCode::kCellKeySequence,
                 "sequence " + std::to_string(pressed.number) + " is not the next one",
                 {}};
  key_taken_ = pressed.number;
  const bool held = IsHeld(pressed.key);
  const bool holds = held && pressed.action == v1::KEY_ACTION_PRESS;
  if (pressed.action == v1::KEY_ACTION_RELEASE) {
    keys_.Release(pressed.key, pressed.number);
    dead_man_.Release(pressed.key);
  } else if (held && keys_.IsReleased(pressed.key, pressed.number)) {
    return {};
  } else if (const auto slow = holds ? line_speed_.WhySlow(now) : std::nullopt) {
    return Error{ErrorCode::kCellKeySequence, *slow, {}};
  } else if (held && dead_man_.IsStopped(pressed.key)) {
    if (pressed.action == v1::KEY_ACTION_TAP) dead_man_.Release(pressed.key);
    return Error{ErrorCode::kCellKeySequence,
                 pressed.key + " was stopped, since nobody was heard who held it: release it first",
                 {}};
  }
  by_panel_ = true;
  const Status done = Act(order);
  by_panel_ = false;
  if (done && holds) dead_man_.Press(pressed.key, now);
  return done;
}

// How old a beat is decides whether the machine goes on.
template <class Beat>
Status HostMachine::CheckBeat(const Beat& beat) {
  if (beat.number() < 1) return InvalidArgument("number counts from 1");
  constexpr std::int64_t kSecondsMax = 4'000'000'000;  // their differences fit into 64 bits as ns
  const std::int64_t took_s = beat.round_trip().seconds();
  if (took_s < 0 || took_s > kSecondsMax || beat.round_trip().nanos() < 0)
    return InvalidArgument("round_trip: no time that a line takes");
  if (!beat.has_sent() || beat.sent().seconds() < 0 || beat.sent().seconds() > kSecondsMax)
    return InvalidArgument("sent: when it was sent, by the clock of the client");
  return {};
}

template <class Beat>
Result<v1::HeartbeatResponse> HostMachine::HearBeat(const Beat& beat, const HostTime& now) {
  if (const Status told = CheckBeat(beat); !told) return told.error();
  dead_man_.Hear(beat.number(), KeysOf(beat), SentAt(beat), now);
  std::optional<std::chrono::nanoseconds> round_trip;
  if (beat.has_round_trip())
    round_trip = std::chrono::nanoseconds(TimeUtil::DurationToNanoseconds(beat.round_trip()));
  line_speed_.Hear(now.wall.time_since_epoch() - SentAt(beat), round_trip, now);
  const auto slow = dead_man_.holds() ? line_speed_.WhySlow(now) : std::nullopt;
  if (slow) dead_man_.Lose();
  LetKeysGo(now);
  if (slow) return Error{ErrorCode::kCellKeySequence, *slow, {}};
  v1::HeartbeatResponse heard;
  *heard.mutable_sent() = beat.sent();
  *heard.mutable_received() = Stamp(now.wall);
  return heard;
}

// Without a result: the status of the machine is the answer.
Result<v1::HostOrderAnswer> HostMachine::CarryOutKeys(const v1::HostOrder& order,
                                                      const HostTime& now) {
  v1::HostOrderAnswer answer;
  switch (order.request_case()) {
    case v1::HostOrder::kPanelKey:
      if (const Status pressed = PressKey(order, now); !pressed) return pressed.error();
      break;
    case v1::HostOrder::kCreateSession: {
      auto session = OpenSession();
      if (!session) return session.error();
      *answer.mutable_session() = *std::move(session);
      break;
    }
    case v1::HostOrder::kKey: {
      auto pressed = PressHandboxKey(order, now);
      if (!pressed) return pressed.error();
      *answer.mutable_key() = *std::move(pressed);
      break;
    }
    case v1::HostOrder::kDeleteSession:
      if (const Status closed = CloseSession(order.delete_session().name(), order.caller());
          !closed)
        return closed.error();
      break;
    case v1::HostOrder::kUndoTeaching:
      answer.mutable_undone();  // whoever asks has control; the programs are the store's
      break;
    case v1::HostOrder::kHandboxHeartbeat: {
      if (const Status known = CheckSession(order.handbox_heartbeat().session()); !known)
        return known.error();
      auto heard = HearBeat(order.handbox_heartbeat(), now);
      if (!heard) return heard.error();
      *answer.mutable_heartbeat() = *std::move(heard);
      break;
    }
    default: {
      auto heard = HearBeat(order.panel_heartbeat(), now);
      if (!heard) return heard.error();
      *answer.mutable_heartbeat() = *std::move(heard);
      break;
    }
  }
  return answer;
}

// As if it was released.
void HostMachine::LetGo(const std::string& key) {
  if (session_ > 0) {
    static_cast<void>(
        Apply(machine::PressedKey{.key = key, .action = machine::KeyAction::kRelease}, nullptr));
  } else if (const auto jog = bridge::JogKeyOf(key)) {
    static_cast<void>(Apply(machine::ReleaseJog{*jog}, nullptr));
  }
}

void HostMachine::LetKeysGo(const HostTime& now) {
  if (!dead_man_.holds()) return;
  for (const std::string& key : dead_man_.LetGo(now)) LetGo(key);
}

// As a person does it: ERR leaves a mask; what flashes to be recorded gives way to another one.
// OPT-5.06
void HostMachine::DropMask() {
  for (const char* key : {"ERR", "MOV", "ERR"}) {
    if (machine().has_open_mask())
      static_cast<void>(Apply(machine::PressedKey{.key = key}, nullptr));
  }
}

// Another one presses from here on: what is down, and what is half entered, is nobody's.
void HostMachine::EndKeys() {
  for (const std::string& key : dead_man_.down()) LetGo(key);
  DropMask();
  keys_ = {};
  dead_man_ = {};
  line_speed_ = {};
  session_ = 0;
  keys_of_ = desk_.lease() ? desk_.lease()->number() : 0;
}

std::string HostMachine::SessionName() const {
  return setup_.name + "/handboxSessions/" + std::to_string(session_);
}

// One that presses; it ends with its control. LIVE-7.02
Result<v1::HandboxSession> HostMachine::OpenSession() {
  if (!machine().has_handbox())
    return Error{ErrorCode::kCellNotLive, "the machine has no handbox", {}};
  EndKeys();
  session_ = ++sessions_;
  v1::HandboxSession session;
  session.set_name(SessionName());
  *session.mutable_panel() = HandboxNow();
  return session;
}

Status HostMachine::CheckSession(const std::string& name) const {
  const bool its_own = desk_.lease() && desk_.lease()->number() == keys_of_;
  if (session_ > 0 && its_own && name == SessionName()) return {};
  return Error{ErrorCode::kCellNotFound, name + ": open another one, this is over", {}};
}

Status HostMachine::CloseSession(const std::string& name, const std::string& caller) {
  if (const Status known = CheckSession(name); !known) return known.error();
  if (desk_.lease()->holder() != caller)
    return Error{ErrorCode::kCellControlNeeded, desk_.lease()->holder() + " has control", {}};
  EndKeys();
  return {};
}

std::optional<v1::HandboxPanel> HostMachine::Handbox() const {
  return machine().has_handbox() ? std::optional(HandboxNow()) : std::nullopt;
}

v1::HandboxPanel HostMachine::HandboxNow() const {
  const machine::Panel panel = machine().panel();
  v1::HandboxPanel made;
  made.set_display(panel.display);
  made.set_flashing(panel.flashing);
  for (const std::string_view lamp : panel.lamps) made.add_lamps(std::string(lamp));
  made.set_mode(bridge::ToProto(machine().status().mode));
  made.set_beeps(beeps_);
  if (panel.message) made.set_message_code(CodeText(*panel.message));
  const bool its_own = session_ > 0 && desk_.lease() && desk_.lease()->number() == keys_of_;
  if (its_own) made.set_holder(desk_.lease()->holder());
  if (panel.run_on) {
    made.set_run_on_mm(panel.run_on->mm);
    made.set_run_on_rad(panel.run_on->rad);
  }
  return made;
}

// What the control says is no error: a key was pressed, and the machine answered. LIVE-7.10
Result<v1::PressKeyResponse> HostMachine::PressHandboxKey(const v1::HostOrder& order,
                                                          const HostTime& now) {
  const v1::PressKeyRequest& request = order.key();
  if (const Status known = CheckSession(request.session()); !known) return known.error();
  key_message_.reset();
  if (const Status pressed = PressKey(order, now); !pressed) return pressed.error();
  v1::PressKeyResponse response;
  *response.mutable_panel() = HandboxNow();
  response.set_sequence(request.sequence());
  if (key_message_) {
    *response.mutable_message() = bridge::ToProto(
        Diagnostic{.code = *key_message_, .severity = Lookup(*key_message_).severity});
  }
  return response;
}

Status HostMachine::Press(const machine::PressedKey& key, const v1::HostOrder* order) {
  const Result<machine::KeyAnswer> pressed = machine().PressKey(key.key, key.action);
  if (!pressed) return pressed.error();
  key_message_ = pressed->message;
  beeps_ += pressed->beeps;
  if (pressed->edit) Edit(*pressed->edit, order != nullptr ? order->caller() : std::string());
  return {};
}

// LIVE-7.08: what is taught is shown when the store has it.
void HostMachine::Edit(const machine::ProgramEdit& edit, const std::string& caller) {
  v1::HostEdit& made = edits_.emplace_back();
  made.set_fence(setup_.fence);
  made.set_number(++edits_made_);
  made.set_slot(edit.program);
  made.set_object(edit.object);
  made.set_object_revision(revisions_[edit.program]);
  made.set_caller(caller);
  v1::TeachEntry& taught = *made.mutable_taught();
  *taught.mutable_time() = Stamp(now_.wall);
  taught.set_virtual_time_ns(machine().time().count());
  taught.set_caller(caller);
  taught.mutable_step()->set_program(edit.program);
  taught.mutable_step()->set_step(edit.step);
  taught.set_act(ActOf(edit.kind));
  taught.set_before(bridge::Utf8(edit.text_before));
  taught.set_after(bridge::Utf8(edit.text_after));
  const auto value = [&taught](const char* name, const std::string& text) {
    v1::ModalValue& added = *taught.add_values();
    added.set_name(name);
    added.set_value(text);
  };
  value("COORD", edit.note.coord);
  value("TCP", edit.note.tcp);
  value("SYSDEF", edit.note.sysdef_active ? "ON" : "OFF");
  value("MODES", edit.note.modes);
  for (v1::AxisValue& axis : bridge::AxesOf(setup_.family->info().axes, edit.note.axes))
    *taught.add_axes() = std::move(axis);
  taught.mutable_tip()->set_x(edit.note.tip.tip.x());
  taught.mutable_tip()->set_y(edit.note.tip.tip.y());
  taught.mutable_tip()->set_z(edit.note.tip.tip.z());
  taught.set_place(edit.place);
}

void HostMachine::EditAnswered(const v1::HostEditAnswer& answer, const HostTime& now) {
  GoOnTo(now);
  if (answer.number() != edits_made_ || !answer.has_refusal()) return;
  const auto rows = FindByText(answer.refusal().code());
  RefuseEdit(rows.empty() ? ErrorCode::kCellStoreFailed : rows.front()->code, now);
}

void HostMachine::RefuseEdit(ErrorCode code, const HostTime& now) {
  now_ = now;
  if (edits_made_ == 0 || !machine().settles()) return;  // nothing is on its way
  static_cast<void>(Apply(machine::RefuseEdit{.code = code}, nullptr));
}

}  // namespace rmlcell::server
