#include <utility>

#include "engine/machine/handbox.h"
#include "engine/machine/machine.h"

// The machine and the handbox on it: keys become what they ask for. LIVE-7.01
namespace rmlcell::machine {

MachineView Machine::View() const {
  MachineView view{.status = status(),
                   .programs = memory_.programs,
                   .modal_values = modal_values(),
                   .loaded = {}};
  if (run_ == nullptr) return view;
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

// While a run stands, what it stands at is not what is looked at any more.
void Machine::Select(ShownStep shown) {
  shown_ = std::move(shown);
  selected_ = run_ != nullptr;
}

Result<KeyAnswer> Machine::Press(const PressKey& key) {
  if (handbox_ == nullptr)
    return Error{
        ErrorCode::kCellNotLive, Told("machine", family_.info().title) + " has no handbox", {}};
  Result<HandboxAnswer> asked = handbox_->Press(key.key, key.action, View());
  if (!asked) return asked.error();
  Status done;
  for (const MachineInput& request : asked->requests) {
    done = Apply(request);
    if (!done) break;
  }
  if (done && asked->setting) standing_->SetModal(asked->setting->name, asked->setting->values);
  if (done && asked->shown) Select(*std::move(asked->shown));
  const std::optional<ErrorCode> refused = handbox_->Done(done);
  return KeyAnswer{.message = refused ? refused : asked->message,
                   .beeps = asked->beeps,
                   .edit = std::move(asked->edit)};
}

Status Machine::Act(const PressKey& input) {
  const Result<KeyAnswer> answer = Press(input);
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
