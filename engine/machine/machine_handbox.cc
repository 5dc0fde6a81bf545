#include <utility>

#include "engine/core/check.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/refusal.h"

// The machine and the handbox on it: keys become what they ask for. LIVE-7.01
namespace rmlcell::machine {

namespace {

// Of the run. An executable takes no time here; whoever looks 20 times a second still sees that it
// was made, at the speed of the machine.
constexpr SimTime kCompilingIsShown = std::chrono::milliseconds(250);

}  // namespace

MachineView Machine::View() const {
  MachineView view{.status = status(),
                   .programs = memory_.programs,
                   .modal_values = modal_values(),
                   .loaded = {}};
  if (run_ == nullptr) return view;
  view.compiles = !note_.by_hand && view.status.run.time < kCompilingIsShown &&
                  !run_->made_executables().empty();
  view.loaded.insert(note_.program);
  for (const Place& place : run_->stack()) view.loaded.insert(place.program);
  return view;
}

Panel Machine::panel() const {
  if (handbox_ == nullptr) return family_.ShowPanel(status());
  Panel panel = handbox_->panel(View());
  if (on_ && mode_ == Mode::kManual) panel.run_on = run_on(handbox_->jog_reference());
  return panel;
}

bool Machine::settles() const {
  const bool edits = handbox_ != nullptr && handbox_->open_edit() != nullptr;
  return edits || (jog_.moves() && !jog_.asks());
}

// While a run stands, what it stands at is not what is looked at any more.
void Machine::Select(ShownStep shown) {
  shown_ = std::move(shown);
  selected_ = run_ != nullptr;
}

Result<KeyAnswer> Machine::PressKey(std::string_view key, KeyAction action) {
  if (handbox_ == nullptr)
    return Error{
        ErrorCode::kCellNotLive, Told("machine", family_.info().title) + " has no handbox", {}};
  Result<HandboxAnswer> asked = handbox_->Press(key, action, View());
  if (!asked) return asked.error();
  Status done;
  for (const MachineInput& request : asked->requests) {
    done = Apply(request);
    if (!done) break;
  }
  if (done && asked->run) done = BeginByHand(*asked->run);
  if (done && asked->setting) standing_->SetModal(asked->setting->name, asked->setting->values);
  if (done && asked->shown) Select(*std::move(asked->shown));
  const std::optional<ErrorCode> refused = handbox_->Done(done);
  return KeyAnswer{.message = refused ? refused : asked->message,
                   .beeps = asked->beeps,
                   .edit = std::move(asked->edit)};
}

// LIVE-2.10 x7
Status Machine::MayMoveByHand(bool manual) const {
  StateGuards now = guards();
  now.manual = manual;
  const Transition next = Next(state(), MachineEvent::kMoveByHand, now);
  if (next.code == ErrorCode::kCellMode)
    return Error{ErrorCode::kCellMode,
                 "ZERO works in MANUAL, and from the console in REMOTE while no run is open",
                 {}};
  if (next.code) return Refusal(*next.code);
  if (jog_.moves()) return NotNow(state(), kReleaseKeys);
  if (run_ != nullptr && !run_->may_be_moved())
    return NotNow(state(), "a run is open; end it first");
  return {};
}

double Machine::OverrideOf(std::optional<HandRun> hand) const {
  if (!hand || *hand == HandRun::kZero || handbox_ == nullptr) return override_percent_;
  return handbox_->OverrideOf(*hand, override_percent_);
}

// Its text lies where no program is that it may call.
Status Machine::BeginByHand(const RunByHand& asked) {
  if (const Status may = MayMoveByHand(mode_ == Mode::kManual); !may) return may.error();
  if (!status().run.zeroed)
    return Error{family_.info().not_zeroed, "the axes have no reference", {}};
  if (run_ != nullptr) {
    if (asked.what != HandRun::kFunction) return SendByHand(asked);
    return NotNow(state(), "a run is open; end it first");
  }
  int slot = kSlotMax;
  while (slot > kSlotMin && memory_.programs.contains(slot)) --slot;
  Translation made = family_.Translate({.bytes = asked.text}, parameters_, {.advice = false});
  RMLCELL_CHECK(made.ok);
  return Begin(
      {.program = slot,
       .source = StartSource::kPanel,
       .brought = StoredProgram{.name = "HANDBOX", .object = Bytes::Of(std::move(made.object))}},
      Mode::kCycle, asked.what);
}

Status Machine::Act(const PressedKey& input) {
  const Result<KeyAnswer> answer = PressKey(input.key, input.action);
  if (!answer) return answer.error();
  return {};
}

Status Machine::Act(const RefuseEdit& input) {
  if (handbox_ != nullptr && handbox_->open_edit() != nullptr) handbox_->EditRefused(input.code);
  return {};
}

// The program of this slot is this one now; nothing: there is none.
void Machine::EndEdit(int slot, std::string_view object) {
  const ProgramEdit* edit = handbox_ != nullptr ? handbox_->open_edit() : nullptr;
  if (edit == nullptr || edit->program != slot || edit->object != object) return;
  if (std::optional<ShownStep> shown = handbox_->EditStored()) Select(*std::move(shown));
}

}  // namespace rmlcell::machine
